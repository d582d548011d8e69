"""The data sheet of a muscle at a pressure, from one solved curve.

What each row is and by which formula is said in it. Air is in normal litres, isothermal:
[(V + Vd)(p + p0) - (V0 + Vd) p0] / p0 with the dead volume Vd and the air around p0.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometry.readable import plain
from solver.case import Case
from solver.load_path import LoadPath, PathKind
from solver.models import MODELS
from solver.record import Solution
from workflow.answers.curve import Curve
from workflow.answers.quick import Quick
from workflow.answers.store import Store
from workflow.data import bench, deformed, reference
from workflow.plan import model_choice
from workflow.plan.mesh_error import error
from workflow.plan.sheet_stops import stops_to
from workflow.study.contents import StudiedMuscle, Study, Variant
from workflow.study.errors import StudyError

CLOSED = 1e-5  # share of p dV to which the balance of energy must close
HALF = 0.5  # of the blocked force: the load where none is given
ISOTHERMAL, ADIABATIC = 1.0, 1.4  # exponents of the air behind a closed valve, slow and fast
MOST = 0.5  # contraction beyond which no free contraction is looked for
LITRE, JOULE = 1e6, 1e3  # mm3, N mm


@dataclass(frozen=True)
class Row:
    """A quantity of a sheet; NaN where it is not known, and ``note`` says why or how."""

    name: str
    value: float
    unit: str
    note: str = ""


@dataclass(frozen=True, eq=False)
class Sheet:
    """A sheet.

    Attributes
    ----------
    closes : whether the balance of energy does; a sheet whose does not is not to be trusted
    outline : distance from mid-length and outer diameter [mm] at the largest contraction that has
        its shape recorded, and that contraction; empty if none has
    """

    muscle: str
    model: str
    variant: str
    pressure: float
    load: float
    case: str
    rows: tuple[Row, ...]
    closes: bool
    curve: Curve
    outline: NDArray[np.float64]
    outline_at: float

    def value(self, name: str) -> float:
        """Of the row of a name."""
        return next(row.value for row in self.rows if row.name == name)


def solved(
    study: Study,
    name: str,
    pressure: float,
    *,
    model: str = "solid",
    variant: str = "default",
    load: float | None = None,
) -> Sheet:
    """The sheet of a muscle of a study, its curve from the store or solved into it."""
    studied, settings = study.muscles[name], study.variants[variant]
    case = _case(studied, settings, model, pressure)
    solution = Store(study).solution(case)
    return sheet(studied, name, variant, case, solution, load)


def _case(studied: StudiedMuscle, variant: Variant, model: str, pressure: float) -> Case:
    """The curve of a sheet: to about its free contraction, whose state is looked for beyond."""
    free = Quick(studied).contraction(pressure, 0.0)
    last = min(free, MOST) if math.isfinite(free) and free > 0 else 0.1
    stops = stops_to(math.floor(100 * last) / 100)
    return studied.case(
        LoadPath(kind=PathKind.ISOBARIC, held=pressure, stops=stops, zero_force=True),
        model,
        effects=model_choice.readable(model, variant.effects),
        numerics=variant.numerics,
        fields_at=(stops[-1],) if MODELS[model].fields else (),
    )


def sheet(
    studied: StudiedMuscle,
    name: str,
    variant: str,
    case: Case,
    solution: Solution,
    load: float | None = None,
) -> Sheet:
    """The sheet of a solved curve.

    Raises
    ------
    StudyError
        If the curve has too few states, or its model does not know what a sheet is made of.
    """
    curve = Curve(case, solution)
    if curve.contraction.size < 2 or curve.contraction[0] > 0:
        why = solution.reason or "it has no state at its initial length"
        raise StudyError(f"{name} at {case.path.held:g} MPa by {case.model}: no sheet, as {why}")
    for known in ("force", "stiffness", "volume", "force_by_pressure", "energy"):
        if not np.isfinite(curve.values(known)).all():
            raise StudyError(f"{known} is not known of all states of {case.model}: no sheet")
    free = curve.contraction_of(0.0)
    given = load is not None
    weight = HALF * float(curve.force(0.0)) if load is None else load
    outline, outline_at = _outline(curve)
    last = free if math.isfinite(free) else float(curve.contraction[-1])
    ends = (
        "free contraction"
        if math.isfinite(free)
        else f"{plain(100 * last, 4)} %, as far as it goes"
    )
    how = f"(p dV - dU - L int F de) / p dV, from the initial length to {ends}"
    rows = (
        *_forces(curve, free, weight, given),
        *_energies(curve, studied, free, weight),
        *_limits(curve, studied, last, ends),
        *_measures(studied),
        *_measured(curve, studied),
        Row("energy balance", curve.balance(last), "1", how),
    )
    closes = abs(rows[-1].value) <= CLOSED
    found = name, case.model, variant, case.path.held, weight, case.key
    return Sheet(*found, rows, closes, curve, outline, outline_at)


def _forces(curve: Curve, free: float, load: float, given: bool) -> Iterator[Row]:
    at = curve.contraction_of(load)
    errors = error(curve.case, curve.solution, "force")
    mesh = float(np.max(errors[np.isfinite(errors)])) if np.isfinite(errors).any() else math.nan
    off = f"the mesh is off by {plain(mesh, 2)} N at most" if math.isfinite(mesh) else ""
    yield Row("blocked force", float(curve.force(0.0)), "N", "; ".join(filter(None, ["F(0)", off])))
    lacking = "" if math.isfinite(free) else "no state of zero force was found"
    yield Row("free contraction", 100 * free, "%", lacking or "F = 0")
    said = "" if given else "half of the blocked force, as none is given"
    yield Row("load", load, "N", said)
    beyond = "" if math.isfinite(at) else "it does not carry this load"
    yield Row("contraction at the load", 100 * at, "%", beyond)
    yield Row("stroke at the load", curve.length * at, "mm", beyond)
    if not math.isfinite(at):
        return
    yield Row("stiffness, valve open", -float(curve.force(at, 1)) / curve.length, "N/mm", "dF/dl")


def _energies(curve: Curve, studied: StudiedMuscle, free: float, load: float) -> Iterator[Row]:
    installation = studied.installation
    around, dead = installation.ambient_pressure, installation.dead_volume
    absolute, at = curve.pressure + around, curve.contraction_of(load)
    if math.isfinite(at):
        inside = float(curve.volume(at)) + dead
        by_pressure = curve.at("force_by_pressure", at)
        per_pressure = curve.at("volume_by_pressure", at)
        open_valve = -float(curve.force(at, 1)) / curve.length
        for exponent, how in ((ISOTHERMAL, "slow"), (ADIABATIC, "fast")):
            stiff = exponent * absolute
            added = by_pressure**2 * stiff / (inside + stiff * per_pressure)
            note = f"dF/dl + (dF/dp)^2 n P / (V + n P dV/dp), n = {exponent:g}"
            yield Row(f"stiffness, valve closed, {how}", open_valve + added, "N/mm", note)
    yield Row("work to free contraction", curve.work(free) / JOULE, "J", "L int F de")
    if math.isfinite(at):
        yield Row("work at the load", load * curve.length * at / JOULE, "J", "load times stroke")
    empty = math.pi / 4 * curve.case.muscle.inner_diameter**2 * curve.length

    def air(contraction: float) -> float:
        full = (float(curve.volume(contraction)) + dead) * absolute
        return (full - (empty + dead) * around) / around / LITRE

    yield Row("air to free contraction", air(free), "Nl", "isothermal, dead volume with it")
    if math.isfinite(at):
        yield Row("air at the load", air(at), "Nl", "isothermal, dead volume with it")
        spent = absolute * (float(curve.volume(at)) + dead) * math.log(absolute / around)
        done = load * curve.length * at
        note = "work / [(p + p0)(V + Vd) ln((p + p0)/p0)], of air compressed isothermally"
        yield Row("efficiency at the load", 100 * done / spent, "%", note)


def _limits(curve: Curve, studied: StudiedMuscle, last: float, ends: str) -> Iterator[Row]:
    """The largest of what may not be too large up to ``last``, which ``ends`` says in words."""
    limits = studied.limits
    if studied.thread is not None:
        stretch = curve.largest("thread_stretch_max", last)
        tension = studied.thread.stiffness * max(stretch - 1, 0.0)
        yield Row("largest thread force", tension, "N", f"EA (stretch - 1), to {ends}")
        strength = limits.thread_strength
        share = tension / strength if strength else math.nan
        note = f"of {strength:g} N" if strength else "no thread_strength is given"
        yield Row("share of the thread's strength", 100 * share, "%", note)
    rubber = curve.largest("rubber_stretch_max", last)
    limit = limits.stretch_limit
    note, fitted = f"deformed by first length, to {ends}", limits.fitted_range
    if fitted is not None and rubber > fitted[1]:
        note += f"; its law was fitted up to {fitted[1]:g}"
    yield Row("largest rubber stretch", rubber, "1", note)
    share = rubber / limit if limit else math.nan
    note = f"of {limit:g}" if limit else "no stretch_limit is given"
    yield Row("share of the rubber's limit", 100 * share, "%", note)
    widest = curve.largest("outer_diameter", last)
    yield Row("largest outer diameter", widest, "mm", f"the space it needs, to {ends}")


def _measures(studied: StudiedMuscle) -> Iterator[Row]:
    muscle, built = studied.muscle, studied.installation
    yield Row("length between the fittings", muscle.length, "mm")
    fittings = 2 * built.fitting_length if built.fitting_length is not None else math.nan
    note = "" if math.isfinite(fittings) else "no fitting_length is given"
    yield Row("installed length", muscle.length + fittings, "mm", note)
    masses = _masses(studied)
    lacking = [name for name, mass in masses.items() if mass is None]
    note = f"without what is not given: {', '.join(lacking)}" if lacking else ""
    yield Row("mass", mass_of(studied), "g", note)


def mass_of(studied: StudiedMuscle) -> float:
    """Of tube, threads and fittings [g], as far as it is known; NaN where nothing is."""
    known = [mass for mass in _masses(studied).values() if mass is not None]
    return sum(known) if known else math.nan


def _masses(studied: StudiedMuscle) -> dict[str, float | None]:
    """Masses [g] by what they need to be known; None where that is not given."""
    muscle, built = studied.muscle, studied.installation
    area = math.pi / 4 * (muscle.outer_diameter**2 - muscle.inner_diameter**2)
    tube = area * (muscle.length + 2 * muscle.cap_length) / 1000  # cm3
    found = {"density": built.density and tube * built.density}
    if muscle.braid is not None:
        lengths = [n.threads * muscle.length * math.hypot(1, n.tangent) for n in muscle.layers]
        wide, dense = built.thread_diameter, built.thread_density
        found["thread_diameter and thread_density"] = (
            None
            if wide is None or dense is None
            else sum(lengths) * math.pi / 4 * wide**2 / 1000 * dense
        )
    return found | {"fitting_mass": built.fitting_mass}


def _measured(curve: Curve, studied: StudiedMuscle) -> Iterator[Row]:
    """How far the curve is from what was measured at its pressure."""
    for name, found in bench.of_muscle(studied).items():
        measured = measured_points(found, curve.pressure)
        points = measured[measured[:, 0] <= curve.contraction[-1]]
        if points.size:
            off = np.mean(curve.force(points[:, 0]) - points[:, 1]) / np.max(points[:, 1])
            note = f"mean of {_of(points, measured)} measured points, share of the largest force"
            yield Row(f"deviation from {name}", 100 * float(off), "%", note)


def _of(some: NDArray[np.float64], all_: NDArray[np.float64]) -> str:
    """How many of how many: measured points behind the end of the curve are left out."""
    return f"{len(some)} of {len(all_)}" if len(some) < len(all_) else f"{len(some)}"


def measured_points(found: reference.ForceMap, pressure: float) -> NDArray[np.float64]:
    """Contractions from 0 on, and forces, that a map has at a pressure of its own."""
    near = np.abs(found.points[:, 0] - pressure) <= reference.SAME
    points = found.points[near & (found.points[:, 1] >= 0)][:, 1:]
    return points[np.argsort(points[:, 0])]


def _outline(curve: Curve) -> tuple[NDArray[np.float64], float]:
    """Distance from mid-length and outer diameter, from the last state with a deformed shape."""
    outer = curve.case.muscle.outer_radius
    for number in sorted(curve.solution.fields, reverse=True):
        fields = curve.solution.fields[number]
        corners = fields.get("corners")
        if "meridian" in fields:  # of a membrane, whose wall keeps its volume
            (line,) = deformed.lines(curve.case, fields, [outer])
            radius, place = line.places(line.nodes[line.nodes >= 0])
            outline = np.column_stack([place, 2 * radius])
            return outline, float(curve.solution.states["contraction"][number])
        if corners is None or corners.shape[1] != 4:
            continue
        at = float(curve.solution.states["contraction"][number])
        on = np.isclose(corners[:, 0], outer, rtol=1e-9)
        on &= corners[:, 1] <= curve.length / 2 + 1e-9
        _, first = np.unique(corners[on, 1], return_index=True)
        found = corners[on][first]
        return np.column_stack([found[:, 3], 2 * found[:, 2]]), at
    return np.empty((0, 2)), math.nan


def as_dict(found: Sheet) -> dict[str, Any]:
    """A sheet for JSON; what is not known is None."""
    return {
        "muscle": found.muscle,
        "model": found.model,
        "variant": found.variant,
        "pressure": {"value": found.pressure, "unit": "MPa"},
        "case": found.case,
        "energy_balance_closes": found.closes,
        "rows": [
            asdict(row) | {"value": row.value if math.isfinite(row.value) else None}
            for row in found.rows
        ],
        "outline": {
            "contraction": found.outline_at if math.isfinite(found.outline_at) else None,
            "distance_from_middle_mm": found.outline[:, 0].tolist(),
            "outer_diameter_mm": found.outline[:, 1].tolist(),
        },
    }


def lines(found: Sheet) -> list[str]:
    """A sheet as text."""
    variant = "" if found.variant == "default" else f", {found.variant}"
    head = f"{found.muscle} at {found.pressure:g} MPa, by {found.model}{variant}"
    width = max(len(row.name) for row in found.rows) + 2
    return [head, *(_line(row, width) for row in found.rows), *warnings([found])]


def warnings(sheets: Iterable[Sheet]) -> list[str]:
    """What stands against believing sheets."""
    return [
        f"{found.muscle} at {found.pressure:g} MPa: the balance of energy does not close "
        f"({found.rows[-1].value:.1e} of p dV, at most {CLOSED:g}): give stops that lie closer"
        for found in sheets
        if not found.closes
    ]


def _line(row: Row, width: int) -> str:
    value = (
        f"{plain(row.value, 4)} {row.unit if row.unit != '1' else ''}"
        if row.value == row.value
        else ""
    )
    return f"  {row.name:<{width}}{value.strip() or 'not known':<14}{row.note}".rstrip()
