"""The memory of a rubber, fitted to measured forces of a muscle in time: a loop, a relaxation.

Pressure and contraction are prescribed as they were measured. Of the forces that a model then has
a flat spectrum, equal relaxation in every decade, is chosen by least squares. It reaches from
the shortest step of the file to its duration, as no test says anything of times beyond. A model is
off in its elastic force too, by more than a loop is wide: so a curve by what varies (contraction,
pressure), the same on both ways, is fitted beside it, and what is left says how wide the loop is
and how it relaxes.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import t as student

from solver.case import Case
from solver.history import History, Start
from solver.load_path import LoadPath, PathKind
from solver.memory import Memory
from solver.models import MODELS
from solver.refusal import UnsolvableCase
from solver.status import CaseStatus
from workflow.answers.store import Store
from workflow.data import bench
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.errors import StudyError

Array = NDArray[np.float64]
MOST_ROWS = 600  # that are used of a file, evenly
FEWEST = 8
SHARES = (1e-4, 1.0)  # relaxation by decade, between which it is looked for
FIRST, STEP = 0.05, 1e-2  # where it begins; of a derivative, as a share
VARIES = {"contraction": 1e-3, "pressure": 1e-3}  # 1, MPa
DEGREE, LEVELS = 3, 8  # of the curve beside a model, where there are so many different values
CONFIDENCE = 0.95
NOTHING = 1e-6  # of the forces, what the solver leaves open


@dataclass(frozen=True, eq=False)
class MemoryFit:
    """A fitted memory.

    Attributes
    ----------
    times, pressure, contraction, measured : of the rows that are used [s, MPa, 1, N]
    fitted : force with the memory, and the curve [N]
    curve : constant and coefficients of what the elastic force is off, by contraction and MPa [N]
    per_decade, interval : share of the long-term stiffness, and half its interval of 95 %
    memory : as it goes into a study file
    said : how the file was read
    notes : what speaks against it
    """

    times: Array
    pressure: Array
    contraction: Array
    measured: Array
    fitted: Array
    curve: dict[str, float]
    per_decade: float
    interval: float
    memory: Memory
    said: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def residual(self) -> float:
        """Root of the mean square of what is left [N]."""
        return float(np.sqrt(np.mean((self.fitted - self.measured) ** 2)))


def fit(
    study: Study,
    name: str,
    file: str,
    folder: Path,
    *,
    model: str = "membrane",
    start: Start = Start.RELAXED,
) -> MemoryFit:
    """Fit the memory of a muscle's rubber; trials are solved in a scratch ``folder``.

    Raises
    ------
    StudyError
        If the file has no times or too few rows, if the model cannot follow it, or if a memory
        changes none of its forces.
    """
    if model not in MODELS or not MODELS[model].in_time:
        able = ", ".join(each for each in MODELS if MODELS[each].in_time)
        raise StudyError(f"--model {model} is refused\n  allowed: {able}")
    muscle = study.muscles[name]
    times, points, said = _rows(file, muscle.muscle.length)
    pressure, contraction, measured = points.T
    span = _span(file, times)
    trial = _Trial(study, muscle, Store(study, folder), model, span, start, times, points)
    share, left, slope = _least_squares(trial, measured)
    if not np.abs(share * slope).max() > NOTHING * np.abs(trial.force(share)).max():
        raise StudyError(
            f"{file}: a memory changes none of its forces\n  allowed: a pressure or contraction "
            f"that varies, or --start {Start.UNLOADED} where the first row was reached at once"
        )
    memory = trial.memory(float(f"{share:.4g}"))
    values = np.linalg.lstsq(trial.columns, measured - trial.force(share), rcond=None)[0]
    interval = _interval(left, slope, 1 + trial.columns.shape[1])
    return MemoryFit(
        times=times,
        pressure=pressure,
        contraction=contraction,
        measured=measured,
        fitted=measured + left,
        curve=dict(zip(trial.names, map(float, values), strict=True)),
        per_decade=share,
        interval=interval,
        memory=memory,
        said=tuple(said),
        notes=tuple(_notes(share, interval, trial)),
    )


def _rows(file: str, length: float) -> tuple[Array, Array, list[str]]:
    """Times from 0 [s], points (pressure, contraction, force) and how a file was read; not all."""
    times, points, said = bench.history(file, length)
    if len(times) < FEWEST:
        raise StudyError(f"{file}: {len(times)} rows with a time; at least {FEWEST} are needed")
    kept = np.unique(np.linspace(0, len(times) - 1, min(len(times), MOST_ROWS)).round().astype(int))
    return times[kept] - times[kept[0]], points[kept], said


def _least_squares(trial: "_Trial", measured: Array) -> tuple[float, Array, Array]:
    """The relaxation per decade that fits best, what is left then [N], and its derivative."""

    def left_by(log_share: Array) -> Array:
        return trial.left(float(np.exp(log_share[0])), measured)

    found = least_squares(
        left_by,
        [np.log(FIRST)],
        bounds=np.log(np.array(SHARES)).reshape(2, 1),
        diff_step=STEP / abs(np.log(FIRST)),
        xtol=1e-3,
        ftol=1e-8,
    )
    share = float(np.exp(found.x[0]))
    left = left_by(found.x)
    return share, left, (left_by(found.x + STEP) - left) / (share * np.expm1(STEP))


def _span(file: str, times: Array) -> tuple[float, float]:
    """Powers of ten next to the shortest step of a file and to its duration [s]."""
    step, duration = float(np.min(np.diff(times))), float(times[-1])
    low, high = (float(f"{10.0 ** round(np.log10(time)):.12g}") for time in (step, duration))
    if not low < high:
        raise StudyError(
            f"{file}: it lasts {duration:g} s in steps of {step:g} s or more\n  allowed: a decade "
            "of times at least"
        )
    return low, high


class _Trial:
    """Forces of a model along a file, by the relaxation per decade."""

    def __init__(
        self,
        study: Study,
        muscle: StudiedMuscle,
        store: Store,
        model: str,
        span: tuple[float, float],
        start: Start,
        times: Array,
        points: Array,
    ) -> None:
        pressure, contraction, _ = points.T
        self.muscle, self.model, self.store, self.span = muscle, model, store, span
        self.variant = study.variants["default"]
        self.unbalanced = ""
        history = History(times=_plain(times), start=start, held=_plain(pressure))
        try:
            self.path = LoadPath(
                kind=PathKind.ISOBARIC,
                held=_plain(pressure)[0],
                stops=_plain(contraction),
                history=history,
            )
            self._case(FIRST)
        except UnsolvableCase as error:
            raise StudyError(f"{model} cannot follow the file: {error}") from None
        varying = {"contraction": contraction, "pressure": pressure}
        kept = {name: v for name, v in varying.items() if np.ptp(v) > VARIES[name]}
        columns = {"constant": np.ones(len(times))}
        for name, values in kept.items():
            levels = len(np.unique(np.round(values / VARIES[name])))
            for power in range(1, 1 + (DEGREE if levels >= LEVELS else 1)):
                columns[name if power == 1 else f"{name}^{power}"] = values**power
        self.names, self.columns = list(columns), np.column_stack(list(columns.values()))
        self._known: dict[float, Array] = {}

    def memory(self, share: float) -> Memory:
        """A flat spectrum over the times of the file."""
        return Memory.flat(share, *self.span)

    def _case(self, share: float) -> Case:
        parts = {"effects": self.variant.effects, "numerics": self.variant.numerics}
        return self.muscle.case(self.path, self.model, memory=self.memory(share), **parts)

    def force(self, share: float) -> Array:
        """At the rows of the file [N]."""
        if share not in self._known:
            solution = self.store.solution(self._case(share))
            if solution.status is CaseStatus.UNBALANCED:
                self.unbalanced = solution.reason
            elif solution.status is not CaseStatus.CONVERGED:
                raise StudyError(
                    f"{self.model} does not follow the file: {solution.status}, {solution.reason}"
                )
            self._known[share] = solution.states["force"]
        return self._known[share]

    def left(self, share: float, measured: Array) -> Array:
        """What is left of the forces beside the best curve [N]."""
        off = self.force(share) - measured
        return np.asarray(off - self.columns @ np.linalg.lstsq(self.columns, off, rcond=None)[0])


def _plain(values: Array) -> tuple[float, ...]:
    return tuple(float(f"{value:.12g}") for value in values)


def _interval(left: Array, slope: Array, fitted: int) -> float:
    """Half the interval of a parameter; neighbours that are off alike count as fewer rows."""
    alike = float(np.clip(np.corrcoef(left[1:], left[:-1])[0, 1], 0, 0.99)) if left.any() else 0.0
    free = max(len(left) * (1 - alike) / (1 + alike) - fitted, 1.0)
    variance = float(left @ left) / free
    return float(student.ppf((1 + CONFIDENCE) / 2, free) * np.sqrt(variance / (slope @ slope)))


def _notes(share: float, interval: float, trial: _Trial) -> Iterator[str]:
    """What speaks against a fit."""
    if interval > share:
        yield "the file does not tell it from none: its interval is wider than it"
    if share < 1.01 * SHARES[0] or share > 0.99 * SHARES[1]:
        yield f"at the end of where it was looked for, {SHARES[0]:g} to {SHARES[1]:g}"
    if trial.unbalanced:
        yield f"too few rows of the file in time: {trial.unbalanced}"
