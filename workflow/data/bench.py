"""The forces that a muscle is fitted to: one of the reference maps, or a CSV file of one's own.

A file may be written in any usual way (workflow/data/measured.py). Its points are used as they are
(``Bench.measured``); the map that is made of them has one curve for each set pressure: the mean of
the ways up and down, whose distance is the width of the loop.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from solver import net
from solver.load_path import PathKind
from workflow.data import headers, measured, reference
from workflow.data.measured import Table
from workflow.data.reference import CONTRACTIONS, ForceMap
from workflow.study import user_file
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.errors import StudyError, choices, shown
from workflow.study.limits import HIGHEST
from workflow.study.schema import FORCE_MAPS, is_path
from workflow.study.units import PRESSURE

FURTHEST = 0.2  # contraction, as in workflow/data/deviation.py
FEW = 5  # points of a curve
SHORTEST, LONGEST = 0.35, 1.25  # lengths under test, as shares of the length at rest
LARGEST_CONTRACTION = 0.65
NOISE = 0.015  # of the largest pressure: two set pressures this close are one
NICE = 0.01  # MPa: what a noisy set pressure is meant to be a multiple of
SWEEP = 0.15  # of the range: values that spread so far are no setting
RARE, WIDEST = 0.1, 5  # bins of a pressure that is held: share of the fullest, and how many
HELD = 0.6  # share of a series in which the pressure is held
SAME_LENGTH = 0.004  # two set contractions this close are one
MOST_SET = 25  # settings of a map
TURN = 0.05  # of the range of a curve: how far back a way goes that is another one
LEAST, MOST = 0.02, 20.0  # measured forces by those of Eq. (1): beyond, in another unit
GRID = 41  # contractions of the mean of several ways, at most
SERIES = 2 * GRID  # points of a way from which on it is a time series
LEVELS = 12  # pressures of a map that is made of sweeps of the pressure, at most
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SetCurve:
    """Measured points of one setting, which is a pressure, or a contraction.

    Attributes
    ----------
    kind : of the path: what was set
    at : its value [MPa or 1]
    points : as they were measured; columns as those of a map
    """

    kind: PathKind
    at: float
    points: Array


@dataclass(frozen=True, eq=False)
class Bench(ForceMap):
    """Measured points, and the map that is made of them.

    Attributes
    ----------
    measured : all points that are used, as they were measured; columns as those of ``points``
    said : what was understood of the file, in lines
    loops : widths of loops by set pressure [N]: the largest distance of two ways
    curves : the measured points by what was set
    """

    measured: NDArray[np.float64]
    said: tuple[str, ...]
    loops: dict[float, float]
    curves: tuple[SetCurve, ...]


def of_muscle(muscle: StudiedMuscle) -> dict[str, ForceMap]:
    """The maps of a muscle by their names: those of this project, and files of one's own."""
    found = [read(name, muscle.muscle.length) for name in muscle.reference]
    return {each.name: each for each in found}


def of_muscles(muscles: Mapping[str, StudiedMuscle]) -> dict[str, dict[str, ForceMap]]:
    """The maps of every muscle that has some."""
    return {name: of_muscle(muscle) for name, muscle in muscles.items() if muscle.reference}


def read(name: str, length: float) -> ForceMap:
    """A map by the name of a reference, or by the path of a file (it contains a dot or slash).

    A file has columns of pressure, force, and one of contraction, stroke (shortening) or length
    under test, of a muscle that is ``length`` [mm] long at rest; in any order, names and units.
    Rows whose ``suspect`` is 1 are not used. A force of 0 at a length means slack and is not used.

    Raises
    ------
    StudyError
        If there is no such map or file, or something in it is missing, no number, or looks wrong.
    """
    if name in FORCE_MAPS:
        return reference.load([name])[name]
    path = Path(name)
    if not is_path(name):
        known = choices(name, FORCE_MAPS)
        raise StudyError(f"{name}: no such reference map; {known}, or a .csv file")
    if not user_file.text_of(path, measured.LARGEST).strip():
        raise StudyError(f"{path}: there is no force in it")
    table = measured.read(path, headers.OF_MUSCLES)
    points, _, said = _points(table, length)
    return _map(path.stem, points, [f"{path}: {table.how}", *said], table)


def history(name: str, length: float) -> tuple[Array, Array, list[str]]:
    """Times [s], points (pressure, contraction, force) and what was read, of a file in time.

    Raises
    ------
    StudyError
        As ``read``; or if there is no column of time, or its times do not rise.
    """
    path = Path(name)
    if not user_file.text_of(path, measured.LARGEST).strip():
        raise StudyError(f"{path}: there is no force in it")
    table = measured.read(path, headers.OF_MUSCLES)
    if "time" not in table.columns:
        raise table.refuse(_missing(table, "time"))
    points, lines, said = _points(table, length, also=("time",))
    used = np.isin(table.lines, lines)
    times = table.numbers("time")[used]
    rises = np.isfinite(times) & (np.diff(times, prepend=-np.inf) > 0)
    if not rises.all():
        at = int(np.argmin(rises))
        here = f"{times[at]:g} s stands" if np.isfinite(times[at]) else "no time stands"
        after = f" after {times[at - 1]:g} s" if at else ""
        text = f"its times do not rise from row to row; {here} here{after}"
        raise table.refuse(text, int(np.array(table.lines)[used][at]))
    return times, points, [f"{path}: {table.how}", table.said("time", times), *said]


def _points(
    table: Table, length: float, also: tuple[str, ...] = ()
) -> tuple[Array, list[int], list[str]]:
    """Pressure, contraction and force of the rows that are used, their lines, and what was read."""
    for quantity in ("pressure", "force"):
        if quantity not in table.columns:
            raise table.refuse(_missing(table, quantity))
    place = next((q for q in PLACES if q in table.columns), None)
    if place is None:
        raise table.refuse(_missing(table, "contraction", ", stroke or length"))
    values = {q: table.numbers(q) for q in ("pressure", "force", place)}
    said = [table.said(q, values[q]) for q in values]
    known = (*values, *also, "suspect")
    others = [table.columns[q].name for q in table.columns if q not in known]
    unused = [*others, *map(shown, table.unused)]
    if unused:
        said.append(f"not used: {', '.join(unused)}")
    pressure, force = values["pressure"], values["force"]
    whole = np.isfinite(pressure) & np.isfinite(force) & np.isfinite(values[place])
    used = whole.copy()
    lines = np.array(table.lines)
    if not whole.all():
        said.append(f"without a value, not used: lines {measured.listed(lines[~whole])}")
    if "suspect" in table.columns:
        marked = np.nan_to_num(table.numbers("suspect")) == 1
        used &= ~marked
        if marked.any():
            said.append(f"marked suspect, not used: lines {measured.listed(lines[marked])}")
    slack = whole & (force == 0) if place == "length" else np.zeros_like(whole)
    slack &= used
    if slack.any():
        said.append(f"slack, without a force, not used: lines {measured.listed(lines[slack])}")
        used &= ~slack
    if not used.any():
        raise table.refuse("there is no force in it")
    _check_pressure(table, pressure[used])
    _check_force(table, force[used])
    contraction = _contraction(table, place, values[place], length, used)
    said.append(f"{used.sum()} of {len(used)} points used")
    points = np.column_stack([pressure, contraction, force])[used]
    return points, [int(n) for n in lines[used]], said


# The first that there is
PLACES = ("contraction", "stroke", "length", "strain", "extension", "stretch")


def _missing(table: Table, quantity: str, more: str = "") -> str:
    there = [column.name for column in table.columns.values()] + [shown(h) for h in table.unused]
    return f"the column {quantity}{more} is missing; there are {', '.join(there)}"


def _check_pressure(table: Table, pressure: Array) -> None:
    header = table.columns["pressure"].header
    if header.is_absolute:
        raise table.refuse(
            f"{shown(header.text)} is an absolute pressure; give that above the surroundings, "
            "0.1013 MPa less"
        )
    if pressure.min() < -0.1:
        raise table.refuse(f"a pressure of {pressure.min():g} MPa is less than none")
    largest = pressure.max()
    if not PRESSURE.low / 10 <= largest <= PRESSURE.high:
        written = largest / header.factor
        others = {
            unit: size
            for unit, size in (("MPa", 1.0), ("bar", 0.1), ("kPa", 1e-3), ("Pa", 1e-6))
            if PRESSURE.low <= written * size <= PRESSURE.high and size != header.factor
        }
        guess = " or ".join(f"{unit}, that is {written * s:.4g} MPa" for unit, s in others.items())
        if not guess and largest <= HIGHEST:
            return
        raise table.refuse(
            f"pressures up to {written:.6g} under {shown(header.text)} would be {largest:.4g} MPa; "
            f"perhaps they are in {guess or 'another unit'}"
        )


def _check_force(table: Table, force: Array) -> None:
    """Muscles pull: forces that are mostly negative have the other sign."""
    name = table.columns["force"].name
    if -force.min() > 2 * max(force.max(), 0.0) and np.mean(force < 0) > 0.5:
        raise table.refuse(
            f"forces under {name} are negative, down to {force.min():.4g} N; a pull is positive "
            "here, so perhaps their sign is the other"
        )
    if force.max() > 1e5:
        raise table.refuse(
            f"forces up to {force.max():.4g} N under {name} are too large; perhaps another unit"
        )


def _contraction(
    table: Table, place: str, values: Array, length: float, used: NDArray[np.bool_]
) -> Array:
    """Contractions of what stands in a file, if they are those of a muscle."""
    column = table.columns[place]
    inside, name, unit = values[used], column.name, column.header.unit
    low, high = float(inside.min()), float(inside.max())
    if place == "contraction":
        if max(high, -low) > LARGEST_CONTRACTION:
            guess = "perhaps %" if not unit and high <= 65 else "perhaps in another unit"
            if not unit and high > 65:
                guess = "perhaps a stroke or a length in mm"
            raise table.refuse(f"contractions of {low:.4g} to {high:.4g} under {name}; {guess}")
        if headers.unit_of(unit) == "%" and 0 < high < 0.006 and len(np.unique(inside)) > 2:
            raise table.refuse(
                f"contractions up to {high / 0.01:.4g} % under {name} are next to none; perhaps "
                "they are fractions"
            )
    if place in ("contraction", "stroke") and -low > 2 * max(high, 0.0):
        raise table.refuse(
            f"values of {low:.4g} to {high:.4g} under {name} are negative; shortening is positive "
            "here, so perhaps their sign is the other"
        )
    if place == "stroke":
        if high > (1 - SHORTEST) * length:
            raise table.refuse(
                f"strokes up to {high:.4g} mm under {name} are not of a muscle {length:g} mm long; "
                "perhaps lengths, or another unit"
            )
        return values / length
    if place == "length":
        if high < SHORTEST * length or high > LONGEST * length or low < 0:
            guess = _length_guess(low, high, column.header.factor, length)
            raise table.refuse(
                f"lengths of {low:.4g} to {high:.4g} mm under {name} are not of a muscle "
                f"{length:g} mm long; perhaps {guess}"
            )
        return np.round(1 - values / length, 12)
    if place == "stretch":
        if not SHORTEST <= low <= high <= LONGEST:
            raise table.refuse(
                f"lengths of {low:.4g} to {high:.4g} of that at rest under {name} are not of a "
                "muscle; perhaps contractions, then call them so"
            )
        return np.round(1 - values, 12)
    if place in ("strain", "extension"):
        strain = values if place == "strain" else values / length
        inside = strain[used.astype(bool)]
        if inside.mean() > 0 or inside.min() < -LARGEST_CONTRACTION:
            raise table.refuse(
                f"values of {low:.4g} to {high:.4g} under {name}: a strain is positive where the "
                "muscle is longer; perhaps contractions, then call them so"
            )
        return -strain
    return values


def _length_guess(low: float, high: float, factor: float, length: float) -> str:
    if low == 0:
        return "strokes"
    for unit in ("mm", "cm", "m", "in"):
        size = headers.UNITS[headers.LENGTH][unit]
        if size != factor and SHORTEST * length <= high * size / factor <= 1.2 * length:
            return f"they are in {unit}"
    return "strokes, or of another muscle" if high < length else "of another muscle"


# --- a map of points -----------------------------------------------------------------------------


def _map(name: str, points: Array, said: list[str], table: Table) -> Bench:
    """The map of some points, in the order in which they were measured."""
    close = NOISE * np.ptp([0, points[:, 0].max()])
    settings = _settings(points[:, 0], close)
    few = [members for members in settings or () if len(members) < FEW]
    if len(points) > SERIES and (settings is None or len(few) > len(settings) / 2):
        plateaus = _plateaus(points[:, 0], close)
        if plateaus is not None:
            held_rows = np.unique(np.concatenate(plateaus))
            between = len(points) - len(held_rows)
            said.append(f"{between} points between set pressures, not used")
            points = points[held_rows]
            settings = [np.searchsorted(held_rows, members) for members in plateaus]
    curves: list[Array] = []
    loops: dict[float, float] = {}
    measured_curves = []
    if settings is not None:
        for members in settings:
            pressure = _set_pressure(points[members, 0])
            measured_curves.append(SetCurve(PathKind.ISOBARIC, pressure, points[members]))
            ways = _ways(points[members, 1], points[members, 2])
            mean, width = _mean(ways)
            curves.append(np.column_stack([np.full(len(mean), pressure), mean]))
            said.append(_curve_said(pressure, points[members], ways, width))
            if len(ways) > 1:
                loops[pressure] = width
    else:
        held = _settings(points[:, 1], SAME_LENGTH)
        if held is None:
            raise table.refuse(
                "neither pressures nor lengths are held: both change from row to row; give curves "
                "at set pressures, or sweeps of the pressure at set lengths"
            )
        curves = _of_sweeps(points, held, said)
        if not curves:
            raise table.refuse("its sweeps of the pressure have no pressure in common")
        for members in held:
            at = round(float(np.median(points[members, 1])), 9)
            measured_curves.append(SetCurve(PathKind.ISOMETRIC, at, points[members]))
    found, none = np.concatenate(curves), np.empty((0, 3))
    return Bench(name, name, found, none, points, tuple(said), loops, tuple(measured_curves))


def set_curves(found: ForceMap) -> tuple[SetCurve, ...]:
    """Measured points by what was set; of a map its own points, by pressure."""
    if isinstance(found, Bench):
        return found.curves
    points = found.points
    return tuple(
        SetCurve(PathKind.ISOBARIC, float(p), points[points[:, 0] == p]) for p in found.pressures
    )


def _settings(values: Array, close: float) -> list[NDArray[np.intp]] | None:
    """Rows by the value at which something was set; None if it was swept."""
    order = np.argsort(values, kind="stable")
    cuts = np.flatnonzero(np.diff(values[order]) > close) + 1
    groups = [np.sort(group) for group in np.split(order, cuts)]
    spread = max(float(np.ptp(values[group])) for group in groups)
    if spread > max(SWEEP * float(np.ptp(values)), 4 * close) and spread > 2 * close:
        return None
    if len(groups) > MOST_SET and len(groups) > len(values) / 3:
        return None
    return groups


def _plateaus(values: Array, close: float) -> list[NDArray[np.intp]] | None:
    """Rows of a time series by the value that was held; those on the way between are of none."""
    bins = np.floor((values - values.min()) / close).astype(int)
    count = np.bincount(bins)
    full = np.append(count >= max(FEW, RARE * count.max()), False)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], full]).astype(int))).reshape(-1, 2)
    # beside the full bins is the rest of the noise
    groups = [np.flatnonzero((bins >= low - 1) & (bins <= high)) for low, high in edges]
    widest = max((high - low for low, high in edges), default=0)
    if widest > WIDEST or sum(map(len, groups)) < HELD * len(values):
        return None
    return groups


def _set_pressure(values: Array) -> float:
    """The pressure that was set: what all have, or the round one in the middle of the noise."""
    middle = float(np.median(values))
    if np.ptp(values) == 0:
        return middle
    near = round(middle / NICE) * NICE
    inside = abs(near - middle) <= NOISE * middle
    return round(near if inside and near > 0 else middle, 6)


def _ways(at: Array, force: Array) -> list[Array]:
    """Ways up and down of one curve, as rows of place and force, each rising in place.

    A way ends where the place goes back by more than a share of its range, which noise does not.
    """
    back, ends, sense, extreme = TURN * float(np.ptp(at)), [0], 0, 0
    for k in range(1, len(at)):
        if sense == 0:
            if abs(at[k] - at[extreme]) > back:
                sense = 1 if at[k] > at[extreme] else -1
                extreme = k
        elif sense * (at[k] - at[extreme]) >= 0:
            extreme = k
        elif sense * (at[extreme] - at[k]) > back:
            ends.append(extreme + 1)
            sense, extreme = -sense, k
    parts = [slice(a, b) for a, b in zip(ends, [*ends[1:], len(at)], strict=True)]
    if len(parts) > max(4, len(at) / 4):  # in no order
        parts = [slice(None)]
    return [_merged(at[part], force[part]) for part in parts if len(at[part])]


def _merged(at: Array, force: Array) -> Array:
    """Points that rise in place; repeated ones, and the many of a time series, are averaged."""
    if len(at) > SERIES and np.ptp(at) > 0:
        bins = np.floor((at - at.min()) / np.ptp(at) * (GRID - 1) + 0.5)
    else:
        bins = at
    _, group, count = np.unique(bins, return_inverse=True, return_counts=True)
    return np.column_stack([np.bincount(group, v) / count for v in (at, force)])


def _mean(ways: list[Array]) -> tuple[Array, float]:
    """The mean of some ways, each of which counts where it is, and their largest distance."""
    places = np.unique(np.concatenate([way[:, 0] for way in ways]))
    if len(ways) == 1:
        return ways[0], 0.0
    if len(places) > GRID:
        places = np.linspace(places[0], places[-1], GRID)
    forces = np.array(
        [np.interp(places, way[:, 0], way[:, 1], left=np.nan, right=np.nan) for way in ways]
    )
    known = np.isfinite(forces).any(axis=0)
    places, forces = places[known], forces[:, known]
    width = np.nanmax(forces, axis=0) - np.nanmin(forces, axis=0)
    return np.column_stack([places, np.nanmean(forces, axis=0)]), float(width.max())


def _curve_said(pressure: float, points: Array, ways: list[Array], width: float) -> str:
    low, high = points[:, 0].min(), points[:, 0].max()
    spread = f", set at {low:.6g} to {high:.6g}" if high > low else ""
    (from_at, from_force), (to_at, to_force) = points[:, 1:].min(axis=0), points[:, 1:].max(axis=0)
    text = (
        f"{pressure:.6g} MPa{spread}: {_count(points)}, contraction {from_at:.4g} to "
        f"{to_at:.4g}, force {from_force:.5g} to {to_force:.5g} N"
    )
    repeated = len(points) - sum(map(len, ways))
    if repeated and len(points) <= SERIES:
        text += f"; {repeated} of them repeated"
    if len(ways) > 1:
        share = width / max(np.abs(points[:, 2]).max(), 1e-300)
        text += f"; {len(ways)} ways, up to {width:.3g} N apart, {100 * share:.2g} % of its largest"
    return text


def _count(points: Array) -> str:
    return "1 point" if len(points) == 1 else f"{len(points)} points"


def _of_sweeps(points: Array, held: list[NDArray[np.intp]], said: list[str]) -> list[Array]:
    """Curves at some pressures, of sweeps of the pressure at held contractions."""
    sweeps = []
    for members in held:
        ways = _ways(points[members, 0], points[members, 2])
        mean, width = _mean(ways)
        at = float(np.median(points[members, 1]))
        sweeps.append((at, mean))
        text = f"contraction {at:.4g}: {len(members)} points, pressure swept"
        if len(ways) > 1:
            text += f"; {len(ways)} ways, up to {width:.3g} N apart"
        said.append(text)
    high = max(float(mean[-1, 0]) for _, mean in sweeps)
    step = next(s for s in (0.005, 0.01, 0.02, 0.025, 0.05, 0.1) if high / s <= LEVELS or s == 0.1)
    curves = []
    for k in range(1, int(high / step + 1e-9) + 1):
        pressure = round(k * step, 6)
        rows = [
            (pressure, at, float(np.interp(pressure, mean[:, 0], mean[:, 1])))
            for at, mean in sweeps
            if mean[0, 0] - 1e-9 <= pressure <= mean[-1, 0] + 1e-9
        ]
        if rows:
            curves.append(np.array(rows))
    if curves:
        last = curves[-1][0, 0]
        said.append(f"forces every {step:g} MPa up to {last:g} MPa are between the points")
    return curves


def stops(found: ForceMap, pressure: float) -> NDArray[np.float64]:
    """Contractions to fit at a pressure, those of the map or, if these are few, some between."""
    own = found.contractions(pressure)
    if np.sum((own >= 0) & (own <= FURTHEST)) < FEW:
        own = np.union1d(own, CONTRACTIONS)
    own = own[(own >= 0) & (own <= FURTHEST)]
    return own[found.inside(own, pressure)]


def _share_of_net(study: Study, name: str, found: ForceMap) -> float:
    """Largest measured force by that of Eq. (1) at its pressure; 0 where that says nothing."""
    muscle = study.muscles[name].muscle
    pressure, _, force = found.points[np.argmax(found.points[:, 2])]
    if muscle.braid is None or pressure <= 0 or force <= 0:
        return 0.0
    return float(force / abs(net.force(muscle, float(pressure), 0.0)))


def understood(study: Study) -> Iterator[str]:
    """What was understood of the files of a study's muscles and calibrations, in lines."""
    for name, muscle in study.muscles.items():
        for file in filter(is_path, muscle.reference):
            found = read(file, muscle.muscle.length)
            if isinstance(found, Bench):
                yield f"muscles.{name} reads"
                yield from (f"  {line}" for line in found.said)
    for name, entry in study.calibration.items():
        assert entry.reference is not None  # the study has named one
        found = read(entry.reference, study.muscles[entry.muscle].muscle.length)
        if isinstance(found, Bench):
            yield f"calibration.{name} reads"
            yield from (f"  {line}" for line in found.said)


def refused(study: Study) -> Iterator[StudyError]:
    """Muscles and calibrations whose forces are not there, or not where they are asked for."""
    for name, muscle in study.muscles.items():
        for file in filter(is_path, muscle.reference):
            found = _found(study, ("muscles", name, "reference"), file, name)
            if isinstance(found, StudyError):
                yield found
    for name in study.calibration:
        yield from _refused(study, name)


def _found(study: Study, place: tuple[str, ...], named: str, muscle: str) -> ForceMap | StudyError:
    """The forces of a muscle that a place of the study names, or why they are none."""
    source = study.source
    if set("{}").intersection(named):
        allowed = "a path without { and }, in which Snakemake sees a pattern"
        return source.refuse(place, named, allowed)
    try:
        found = read(named, study.muscles[muscle].muscle.length)
    except StudyError as error:
        given = f"{source.place(place)} = {shown(named)} is refused"
        where = user_file.sought(source.path, named) if is_path(named) else ""
        return StudyError(f"{given}\n  {error}{where}", source.line(place) or 0, place)
    if (share := _share_of_net(study, muscle, found)) and not LEAST < share < MOST:
        guess = "perhaps kN under N" if share < LEAST else "perhaps another unit"
        allowed = (
            f"forces of this muscle; its largest are {share:.2g} of what Eq. (1) pulls with there, "
            f"{guess}"
        )
        return source.refuse(place, named, allowed)
    return found


def _refused(study: Study, name: str) -> Iterator[StudyError]:
    source, entry, keys = study.source, study.calibration[name], ("calibration", name)
    named = entry.reference
    if entry.muscle not in study.muscles or named is None:
        return  # which the study itself refuses
    found = _found(study, (*keys, "reference"), named, entry.muscle)
    if isinstance(found, StudyError):
        yield found
        return
    count = 0
    pressures = ", ".join(f"{p:g}" for p in found.pressures[:12])
    for key in ("fit_pressure", "report_pressure"):
        for pressure in getattr(entry, key) or ():
            here = len(stops(found, pressure))
            count += here if key == "fit_pressure" else 0
            if not here:
                allowed = (
                    f"pressures within {pressures} MPa; the reference has no force at "
                    f"{pressure:g} MPa between 0 and {100 * FURTHEST:g} %"
                )
                yield source.refuse((*keys, key), pressure, allowed)
    if entry.fit_pressure is None:
        count = sum(len(curve.points) for curve in set_curves(found))
    if 0 < count <= len(entry.fit):
        at = (*keys, "fit") if source.has((*keys, "fit")) else (*keys, "reference")
        allowed = f"fewer values than there are forces; {named} has {count} of them here"
        yield source.refuse(at, list(entry.fit), allowed)
