"""First guesses: what an error is on muscles that are like one, with its spread.

``like_muscles.csv`` beside this module has the errors of every rung of the ladder on random muscles
of all kinds, and the dimensionless groups of these (workflow/plan/likeness.py); ``like_states.csv``
those of the meshes at their states. Both are of the analysis of the ladder:

    snakemake --cores 2 ladder && muscle likeness

An error is a power law of the groups, fitted by least squares with a small ridge. How far a muscle
is from that law is what it was on the muscles of the table, each left out of the fit in its turn
(of states all those of a curve). So of muscles that are drawn as these were a known share has at
most what is said. Of muscles outside of their ranges nothing is said, nor where the law would be
carried further than any of its own muscles carries it (by the variance of its value): a muscle can
be in every range and yet be like none.
"""

import csv
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import ceil, cos, exp, inf, log, nan, radians, sin, sqrt
from pathlib import Path
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from solver.case import Case
from solver.models import MODELS
from solver.record import Solution
from workflow.plan import likeness
from workflow.plan.judged import FOLLOWS, QUANTITIES

CURVES = Path(__file__).with_suffix(".csv")
STATES = CURVES.with_name("like_states.csv")
DATA = ("workflow/plan/like_muscles.csv", "workflow/plan/like_states.csv")
COVERAGE = 0.95  # share of like muscles, or of their states, that have at most what is said
OF_STATES = 0.93  # of states, where the largest is then raised to that of the curve
PASSES = 4  # of a fit: widths of classes hang on it, and it on them
RIDGE = 0.1  # of features whose spread is 1: as a tenth of a muscle that says nothing
MOST = 50.0  # of a logarithm: far from the middle of the table a spread says nothing
LEAST = 1e-7  # share: of smaller errors no law is fitted
BEYOND = 0.1  # of a range (of its logarithm, where it is a ratio): so far a law is believed beyond
STRETCH = 0.2  # of threads: fibres of nylon break there; beyond it they are rubber, not a net
FEWEST = 10  # curves of a kind of path, or of a class: of fewer nothing is said of their own
LOGARITHMIC = ("pressure", "wall", "length", "strain", "lowest")
PLAIN = ("angle", "furthest", "first", "load", "gap", "sleeve")
OF_STATE = ("contraction", "at", "pull")
Array = NDArray[np.float64]


class Bounded(Protocol):
    """A guess of what is at most so much."""

    @property
    def high(self) -> float:
        """So much."""


G = TypeVar("G", bound=Bounded)


@dataclass(frozen=True)
class Guess:
    """Of the largest error of a rung on a curve, as a share (workflow/plan/judged.py).

    Attributes
    ----------
    median, high : half of like muscles have at most this, and COVERAGE of them
    spread : by which factors these have another one than the median, rising
    lost : share of like muscles on which the rung loses states
    seconds : of the processor, of such a curve on average: some take many times the median
    count : of muscles that it is from
    """

    median: float
    high: float
    spread: tuple[float, ...]
    lost: float
    seconds: float
    count: int

    def chance(self, tolerance: float) -> float:
        """That the error is within a tolerance, if no state is lost."""
        within = sum(self.median * factor <= tolerance for factor in self.spread)
        return within / (len(self.spread) + 1)


@dataclass(frozen=True)
class Law:
    """A power law with its spread.

    Attributes
    ----------
    covariance : of the factors
    classes : mean and width of ln(error) less the law, where it was left out of the fit, by class
        (``curve_class``) and by kind of path
    spread : the same, less that mean and in such widths, rising
    reach : largest variance of the law's value at a row, in the same widths
    """

    centre: Array
    scale: Array
    factors: Array
    covariance: Array
    classes: dict[str, tuple[float, float]]
    spread: Array
    reach: float

    @classmethod
    def fit(cls, features: Array, errors: Array, blocks: Array, classes: Array) -> "Law":
        """Of rows of features; rows of one block are left out of the fit together.

        A class is a kind of path, or that and more; what has too few blocks of its own has the
        width of all of its kind. Rows count by the width of their class, or those that are far from
        any law would hide the one of the others.
        """
        centre, scale = features.mean(0), features.std(0)
        scale = np.where(scale > 0, scale, 1.0)
        x = _with_one((features - centre) / scale)
        y = np.log(np.maximum(errors, LEAST))
        ridge = RIDGE * np.eye(x.shape[1])
        ridge[0, 0] = 0.0
        width = np.full(len(y), np.std(y))  # of the class of every row
        for _ in range(PASSES):
            weights = width**-2
            covariance = np.linalg.inv(x.T @ (weights[:, None] * x) + ridge * weights.mean())
            factors = covariance @ x.T @ (weights * y)
            far = weights * _variance(x, covariance)
            off = _left_out(x, y - x @ factors, covariance, weights, blocks) / np.sqrt(1 + far)
            found = _by_class(off, blocks, classes)
            mean, width = np.array([_of(found, str(name)) for name in classes]).T
        spread = np.sort((off - mean) / width)
        return cls(centre, scale, factors, covariance, found, spread, float(far.max()))

    def at(self, features: Array, name: str) -> tuple[Array, Array]:
        """ln(error) of a class, and the width of its spread; both NaN beyond the law's reach."""
        x = _with_one((features - self.centre) / self.scale)
        mean, width = _of(self.classes, name)
        far = _variance(x, self.covariance) / width**2
        far[far > self.reach] = nan
        value = np.where(np.isnan(far), nan, x @ self.factors + mean)
        return value, width * np.sqrt(1 + far)

    def most(self, value: float, wider: float, share: float) -> float:
        """What a share of muscles has at most, where ``at`` gives this value and width."""
        return exp(min(value + wider * self.quantile(share), MOST))

    def quantile(self, share: float) -> float:
        """What a share of new muscles does not exceed, of the spread."""
        rank = ceil(share * (len(self.spread) + 1))
        return float(self.spread[rank - 1]) if rank <= len(self.spread) else inf


def guess(
    case: Case, rung: str, judged: Sequence[str] = (FOLLOWS,), *, pushed: bool | None = None
) -> Guess | None:
    """Of a rung on a curve, of the worst of some quantities; None if no muscles are like it.

    ``pushed`` says whether the muscle is pushed at a state of the curve, where that is known.
    """
    return worst([_guess(case, rung, quantity, pushed) for quantity in judged])


def worst(guesses: Sequence[G | None]) -> G | None:
    """The one of most, of some quantities; None if one of them is not known."""
    known = [each for each in guesses if each is not None]
    whole = known and len(known) == len(guesses)
    return max(known, key=lambda each: each.high) if whole else None


def _guess(case: Case, rung: str, quantity: str, pushed: bool | None) -> Guess | None:
    table = _curves().get(rung)
    if table is None or quantity not in (FOLLOWS, *QUANTITIES) or not is_like(case):
        return None
    law = _law(rung, quantity)
    kind = str(case.path.kind)
    if kind not in law.classes:
        return None
    value, wider = law.at(
        curve_features(likeness.groups(case), kind)[None], curve_class(kind, pushed)
    )
    if np.isnan(value[0]):
        return None
    median = law.most(value[0], wider[0], 0.5)
    near = _nearest(case, rung)
    return Guess(
        median=median,
        high=law.most(value[0], wider[0], COVERAGE),
        spread=tuple(
            float(f) for f in np.exp(np.minimum(wider[0] * (law.spread - law.quantile(0.5)), MOST))
        ),
        lost=float(np.mean([float(table[k]["lost"]) > 0 for k in near])),
        seconds=float(np.mean([float(table[k]["seconds"]) for k in near])),
        count=len(law.spread),
    )


def mesh_errors(case: Case, solution: Solution, rung: str, quantity: str) -> tuple[Array, int]:
    """Errors of a mesh at the states of a curve, and from how many muscles that is known.

    Shares of the largest value along the curve; NaN where no muscles are like it.
    """
    count = case.path.states
    table = _states().get(rung)
    if table is None or quantity not in (FOLLOWS, *QUANTITIES) or not is_like(case):
        return np.full(count, nan), 0
    law = _state_law(rung, quantity)
    groups, kind = likeness.groups(case), str(case.path.kind)
    states = likeness.of_states(case, solution)
    known = _are_like(states, rung) & np.isfinite(list(groups.values())).all()
    found = np.full(count, nan)
    if known.any():
        of_curve = curve_features(groups, kind)
        at = [{name: float(v[k]) for name, v in states.items()} for k in np.flatnonzero(known)]
        features = np.array([_state_features(rung, of_curve, groups | each, kind) for each in at])
        pushed = bool(likeness.is_pushed(solution).any())
        value, wider = law.at(features, curve_class(kind, pushed))
        share = OF_STATES if _is_raised(case) else COVERAGE
        errors = np.exp(np.minimum(value + wider * law.quantile(share), MOST))
        found[known] = _up_to(errors, case, rung, quantity, pushed)
    return found, _count(rung)


def _up_to(errors: Array, case: Case, rung: str, quantity: str, pushed: bool) -> Array:
    """Errors at states with the largest raised to that of the curve, smaller ones by less."""
    if not _is_raised(case):
        return errors
    whole = _guess(case, rung, quantity, pushed)
    largest = np.nanmax(errors, initial=0.0)
    if whole is None or not 0 < largest < whole.high:
        return errors
    return np.asarray(errors * (whole.high / largest) ** (errors / largest))


def _is_raised(case: Case) -> bool:
    """Not where what is known of its curves is of more than its mesh: of what it leaves out too."""
    return not MODELS[case.model].fuller


def origin(table: Path = CURVES) -> str:
    """When and with which code a table was made."""
    return table.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ")


def rungs() -> set[str]:
    """Names of the rungs of the ladder whose errors are in the table."""
    return set(_curves())


@cache
def seconds(rung: str) -> float:
    """Of the processor, of a curve by a rung, on half of the muscles of the table at most."""
    return float(np.median([float(row["seconds"]) for row in _curves()[rung]]))


def ranges() -> dict[str, tuple[float, float]]:
    """Of the groups in the table."""
    rows = [row for table in _curves().values() for row in table]
    names = (*LOGARITHMIC, *PLAIN)
    return {n: (min(float(r[n]) for r in rows), max(float(r[n]) for r in rows)) for n in names}


def is_like(case: Case) -> bool:
    """Whether all groups of a curve are in the ranges of the table, or hardly beyond."""
    groups = likeness.groups(case)
    for name, (low, high) in _ranges().items():
        value = groups[name]
        if name in LOGARITHMIC:
            if not value > 0:
                return False
            low, high, value = log(low), log(high), log(value)
        more = BEYOND * (high - low)
        if not low - more <= value <= high + more:
            return False
    return likeness.thread_stretch(groups) <= STRETCH


def _are_like(states: Mapping[str, Array], rung: str) -> NDArray[np.bool_]:
    """Which states are among those of the table, or hardly beyond."""
    found = np.isfinite(list(states.values())).all(0)
    for name, (low, high) in _state_ranges(rung).items():
        more = BEYOND * (high - low)
        found &= (low - more <= states[name]) & (states[name] <= high + more)
    return np.asarray(found)


@cache
def _count(rung: str) -> int:
    """Curves by a rung of which there are states in the table."""
    return len({row["curve"] for row in _states()[rung]})


@cache
def _state_ranges(rung: str) -> dict[str, tuple[float, float]]:
    values = {name: [float(row[name]) for row in _states()[rung]] for name in OF_STATE}
    return {name: (min(each), max(each)) for name, each in values.items()}


@cache
def _ranges() -> dict[str, tuple[float, float]]:
    return ranges()


def curve_class(kind: str, pushed: bool | None = None) -> str:
    """Of curves that are about equally far from a law: where a muscle is pushed it may fold."""
    return kind if pushed is None else f"{kind}, {'' if pushed else 'not '}pushed"


def _kind(name: str) -> str:
    """The kind of path of a class."""
    return name.partition(",")[0]


def _of(found: Mapping[str, tuple[float, float]], name: str) -> tuple[float, float]:
    """What was found of a class, or of all of its kind of path."""
    return found[name] if name in found else found[_kind(name)]


def _by_class(off: Array, blocks: Array, classes: Array) -> dict[str, tuple[float, float]]:
    """Mean and width by class of enough blocks, and of all of a kind of path."""
    kinds = np.array([_kind(name) for name in classes])
    rows = {str(name): classes == name for name in classes} | {str(k): kinds == k for k in kinds}
    return {
        name: (float(off[of].mean()), float(off[of].std()))
        for name, of in rows.items()
        if name in kinds or len(set(blocks[of])) >= FEWEST
    }


def curve_features(groups: Mapping[str, float], kind: str) -> Array:
    """What a power law of a curve is of: its groups on a kind of path, and terms of these."""
    found = [log(groups[name]) for name in LOGARITHMIC] + [groups[name] for name in PLAIN]
    isometric, isotonic = float(kind == "isometric"), float(kind == "isotonic")
    free = 1 - 1 / (sqrt(3) * cos(radians(groups["angle"])))  # contraction of a thin net
    rubber = groups["wall"] * groups["furthest"] / groups["lowest"]  # of its force, by the net's
    more = [groups["furthest"] / free, rubber, groups["angle"] ** 2, isotonic * groups["load"] ** 2]
    own = [isometric * value for value in (*found, rubber)]  # pushed at low pressures: other slopes
    return np.array([*found, isometric, isotonic, *more, *own])


def _state_features(rung: str, of_curve: Array, row: Mapping[str, float], kind: str) -> Array:
    own = [row[name] for name in OF_STATE]
    ratio = row["at"] / row["pressure"]
    own += [row["pull"] ** 2, row["contraction"] ** 2, ratio, row["contraction"] * row["angle"]]
    if MODELS[rung.partition(",")[0]].crumples:
        own.append(_near_crumpling(row))
    isometric = [float(kind == "isometric") * value for value in own]
    return np.concatenate([of_curve, own, isometric])


def _near_crumpling(row: Mapping[str, float]) -> float:
    """Pressure on the section of the bore by what the wall bears along its axis, at most 10.

    A wall that is pushed bears less than that, and crumples where it bears none; meshes differ most
    before that. The bore is that of a thin net.
    """
    angle, shorter = radians(row["angle"]), 1 - row["contraction"]
    bore = (1 - (cos(angle) * shorter) ** 2) / sin(angle) ** 2  # section, by its first
    pressed = row["at"] * bore
    borne = pressed + row["pull"] * row["pressure"]
    return pressed / max(borne, 0.1 * pressed) if pressed > 0 else 0.0


def _variance(x: Array, covariance: Array) -> Array:
    """Of the value of a law, at rows of its fit and at others: the further out the larger."""
    return np.asarray(np.einsum("ij,jk,ik->i", x, covariance, x))


def _left_out(x: Array, off: Array, covariance: Array, weights: Array, blocks: Array) -> Array:
    """How far rows are from a law that is fitted without their block, by how far from the whole."""
    found = np.empty(len(off))
    for block in np.unique(blocks):
        of = blocks == block
        own = x[of] @ covariance @ (weights[of, None] * x[of]).T
        found[of] = np.linalg.solve(np.eye(int(of.sum())) - own, off[of])
    return found


def _with_one(features: Array) -> Array:
    return np.column_stack([np.ones(len(features)), features])


def _nearest(case: Case, rung: str, count: int = 12) -> list[int]:
    """The muscles of the table that are most like one, on the same kind of path."""
    kind = str(case.path.kind)
    own = curve_features(likeness.groups(case), kind)
    rows, kinds = _rows(rung)
    spread = np.where(rows.std(0) > 0, rows.std(0), 1.0)
    away = (((rows - own) / spread) ** 2).sum(1)
    away += np.where(kinds == kind, 0, 1e6)
    return [int(k) for k in np.argsort(away)[:count]]


@cache
def _rows(rung: str) -> tuple[Array, NDArray[np.str_]]:
    """Features of all muscles of the table, and their kinds of path."""
    table = _curves()[rung]
    kinds = np.array([row["path"] for row in table])
    return np.array([curve_features(groups_of(row), row["path"]) for row in table]), kinds


@cache
def _law(rung: str, quantity: str) -> Law:
    rows = _with_error(_curves()[rung], quantity)
    features = np.array([curve_features(groups_of(row), row["path"]) for row in rows])
    errors = np.array([float(row[quantity]) for row in rows])
    return Law.fit(features, errors, *_blocks_and_classes(rows))


@cache
def _state_law(rung: str, quantity: str) -> Law:
    rows = _with_error(_states()[rung], quantity)
    found = ((groups_of(row), row["path"]) for row in rows)
    features = np.array([_state_features(rung, curve_features(row, k), row, k) for row, k in found])
    errors = np.array([float(row[quantity]) for row in rows])
    return Law.fit(features, errors, *_blocks_and_classes(rows))


def _with_error(rows: Sequence[dict[str, str]], quantity: str) -> list[dict[str, str]]:
    """Rows whose error is known, of kinds of path of which there are enough curves.

    An error of nothing is that of states which no finer mesh has.
    """
    known = [row for row in rows if 0 < float(row[quantity] or nan) < inf]
    curves = {(row["path"], row["curve"]) for row in known}
    counts = Counter(kind for kind, _ in curves)
    return [row for row in known if counts[row["path"]] >= FEWEST]


def _blocks_and_classes(rows: Sequence[Mapping[str, str]]) -> tuple[Array, Array]:
    """Curves of rows, and their classes."""
    blocks = np.array([row["curve"] for row in rows])
    return blocks, np.array([curve_class(r["path"], _pushed().get(r["curve"])) for r in rows])


@cache
def _pushed() -> dict[str, bool]:
    """Whether a muscle is pushed at a state that a mesh has, by curve."""
    found: dict[str, bool] = {}
    for row in (row for of_rung in _states().values() for row in of_rung):
        found[row["curve"]] = found.get(row["curve"], False) or float(row["pull"]) < 0
    return found


def groups_of(row: Mapping[str, str]) -> dict[str, float]:
    """Of a row of a table."""
    names = (*LOGARITHMIC, *PLAIN, *OF_STATE)
    return {name: float(row[name]) for name in names if name in row}


@cache
def _curves() -> dict[str, list[dict[str, str]]]:
    return read(CURVES, "rung")


@cache
def _states() -> dict[str, list[dict[str, str]]]:
    """Rows of states, with the groups of their curves."""
    of_curve = {row["curve"]: row for rows in _curves().values() for row in rows}
    known = {"path", *LOGARITHMIC, *PLAIN}
    groups = {curve: {n: row[n] for n in known} for curve, row in of_curve.items()}
    return {
        rung: [groups[row["curve"]] | row for row in rows]
        for rung, rows in read(STATES, "rung").items()
    }


def read(path: Path, by: str) -> dict[str, list[dict[str, str]]]:
    """Rows of a table by one of its columns."""
    found: dict[str, list[dict[str, str]]] = {}
    with path.open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(line for line in stream if not line.startswith("#")):
            found.setdefault(row[by], []).append(row)
    return found
