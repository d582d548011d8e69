"""One state of a muscle: of pressure, contraction and force two are given, the third is asked for.

The state is a case like any other, so its record is kept and asking again solves nothing.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from geometry.readable import plain
from geometry.refusal import Refusal
from solver.case import Case
from solver.load_path import CONTRACTION_LIMITS, LoadPath, PathKind
from solver.models import MODELS
from solver.record import Solution
from solver.status import VALID
from workflow.answers import words
from workflow.answers.quantities import CONTRACTION, FORCE, KINDS, PRESSURE, UNIT, read
from workflow.answers.quick import Quick
from workflow.answers.store import Store
from workflow.answers.studies import with_muscle
from workflow.data.strain import judged
from workflow.plan import effect_states, like_muscles, model_choice
from workflow.study import units
from workflow.study.contents import StudiedMuscle, Study, Variant
from workflow.study.errors import StudyError, choices
from workflow.study.folders import DEFAULT
from workflow.study.limits import HIGHEST
from workflow.study.schema import Scene

MODEL = "membrane"  # where neither a model nor a tolerance is asked for
ROUNDS, NEAR = 10, 5e-7  # solves for a pressure, and its last change [MPa]
TRIED = (0.1, 0.2, 0.4, 0.7, 1.0, 2.0, 4.0)  # MPa, in search of the largest contraction
DIGITS = 10  # of a contraction or pressure that is computed, not written
GUESS = "its error is a guess: models have not been compared on a muscle like this one"


@dataclass(frozen=True, kw_only=True)
class Answer:
    """A state and how sure it is.

    Attributes
    ----------
    asked : what was not given: pressure, contraction or force
    error : of that, in its unit: what model and mesh are expected to be off; NaN if not known
    length, stroke : of the muscle, and what it is shorter than at rest [mm]
    stiffness : at constant pressure [N/mm]
    force_by_pressure : at constant length [N/MPa]
    volume : enclosed [mm3]
    thread_force, thread_share : largest tension of a thread [N], and share of its strength
    rubber_stretch : largest of the rubber, of the deformed by the first length
    notes : what else to know
    case : key of its record
    solves : cases that had to be solved for it
    """

    muscle: str
    model: str
    asked: str
    pressure: float
    contraction: float
    force: float
    error: float
    length: float
    stroke: float
    stiffness: float
    force_by_pressure: float
    inner_diameter: float
    outer_diameter: float
    volume: float
    thread_force: float
    thread_share: float
    rubber_stretch: float
    notes: tuple[str, ...]
    case: str
    solves: int


def ask(
    muscle: str,
    *,
    pressure: str | float | None = None,
    contraction: str | float | None = None,
    force: str | float | None = None,
    model: str | None = None,
    tolerance: float | None = None,
    variant: str = "default",
    study: Study | Path | str = DEFAULT,
) -> Answer:
    """The state of a muscle at two of pressure, contraction and force.

    Parameters
    ----------
    pressure, contraction, force : as ``0.25 MPa``, ``12 %`` (or ``36 mm``), ``200 N`` (or the mass
        that hangs from it, ``20 kg``), or numbers in MPa, as a fraction, in N
    tolerance : how far the answer may be off, as a share of the largest force at its pressure; the
        cheapest model that keeps it is taken
    study : where the muscle is described

    Raises
    ------
    StudyError
        If the question makes no sense, or there is no such state.
    """
    found = study if isinstance(study, Study) else with_muscle(study, muscle)
    return _Question(found, muscle, variant).answer(
        {PRESSURE: pressure, CONTRACTION: contraction, FORCE: force}, model, tolerance
    )


class _Missing(StudyError):
    """There is no such state by a model."""


class _Question:
    """Questions about one muscle."""

    def __init__(self, study: Study, name: str, variant: str) -> None:
        if name not in study.muscles:
            allowed = choices(name, study.muscles)
            raise StudyError(f"{name}: no such muscle in {study.source.path}\n  allowed: {allowed}")
        if variant not in study.variants:
            allowed = choices(variant, study.variants)
            raise StudyError(f"{variant}: no such variant\n  allowed: {allowed}")
        self.study, self.name, self.variant = study, name, study.variants[variant]
        self.studied: StudiedMuscle = study.muscles[name]
        self.quick, self.store = Quick(self.studied), Store(study)

    def answer(
        self, given: Mapping[str, str | float | None], model: str | None, tolerance: float | None
    ) -> Answer:
        """The answer to one."""
        known = self._known(given)
        asked = next(kind for kind in KINDS if kind not in known)
        about = self._about(known, asked)
        rung, variant, notes = self._rung(model, tolerance, about)
        while True:
            try:
                return self._by(rung, variant, known, about, notes)
            except _Missing as missing:
                fuller = MODELS[_model_of(rung)].fuller
                if model is not None or not fuller:
                    raise StudyError(f"{self._why_none(known)}\n  {missing}") from None
                notes = (*notes, f"by {fuller}, as {missing.args[0]}")
                rung, variant = fuller, self.variant

    def _known(self, given: Mapping[str, str | float | None]) -> dict[str, float]:
        """The two values that are given."""
        length, known = self.studied.muscle.length, {}
        for kind, text in given.items():
            if text is not None:
                known[kind] = read(str(text), length, kind)[1]
        if len(known) != 2:
            what = "all three are given" if len(known) == 3 else "nothing is given"
            what = f"only the {next(iter(known))} is given" if len(known) == 1 else what
            raise StudyError(
                f"{what}\n  allowed: two of pressure, contraction and force, as 0.25MPa 12%; the "
                "third is the answer"
            )
        if not 0 <= known.get(PRESSURE, 0.0) <= HIGHEST:
            guess = units.guess(PRESSURE, known[PRESSURE])
            perhaps = f"\n  perhaps: {guess}" if guess else ""
            allowed = f"0 to {HIGHEST:g} MPa{perhaps}"
            raise StudyError(f"pressure {known[PRESSURE]:g} MPa\n  allowed: {allowed}")
        try:
            LoadPath(kind=PathKind.ISOBARIC, held=0.0, stops=(known.get(CONTRACTION, 0.0),))
        except Refusal:
            value = known[CONTRACTION]
            low, high = (100 * limit for limit in CONTRACTION_LIMITS)
            raise StudyError(
                f"contraction {100 * value:g} %: {value * length:g} mm shorter than at rest, where "
                f"it is {length:g} mm long\n  allowed: {low:g} to {high:g} %"
            ) from None
        if PRESSURE not in known and known[FORCE] < 0:
            raise StudyError(
                f"force {known[FORCE]:g} N\n  allowed: 0 N or more; a muscle that pushes does so "
                "at more than one pressure"
            )
        return known

    def _about(self, known: Mapping[str, float], asked: str) -> dict[str, float]:
        """About what the state is, by the cylinder; the value that is asked for may be NaN."""
        if asked == FORCE:
            value = self.quick.force(known[PRESSURE], known[CONTRACTION])
        elif asked == CONTRACTION:
            value = self.quick.contraction(known[PRESSURE], known[FORCE])
        else:
            value = self.quick.pressure(known[CONTRACTION], known[FORCE])
            if math.isnan(value):
                free = [self.quick.contraction(pressure, 0.0) for pressure in TRIED]
                most = max(filter(math.isfinite, free), default=math.nan)
                raise StudyError(
                    f"no pressure up to {HIGHEST:g} MPa lets {self.name} pull "
                    f"{known[FORCE]:g} N at {100 * known[CONTRACTION]:g} %; "
                    f"without a load it gets shorter by {plain(100 * most, 3)} % at most"
                )
        return {**known, asked: value}

    def _why_none(self, known: Mapping[str, float]) -> str:
        """What stands against a state, in plain words; numbers are those of the cylinder."""
        name, pressure = self.name, known.get(PRESSURE, math.nan)
        if FORCE not in known:
            free = self.quick.contraction(pressure, 0.0)
            if known[CONTRACTION] > free:
                return (
                    f"at {pressure:g} MPa {name} gets shorter by about {plain(100 * free, 2)} % by "
                    f"itself; at {100 * known[CONTRACTION]:g} % it would have to be pushed"
                )
        if CONTRACTION not in known:
            blocked = self.quick.force(pressure, 0.0)
            if known[FORCE] > blocked:
                return (
                    f"at {pressure:g} MPa {name} pulls about {plain(blocked, 3)} N at its length "
                    f"at rest; {plain(known[FORCE], 4)} N would draw it out further than it goes"
                )
            if known[FORCE] < 0:
                return f"{name} would have to be pushed with {-known[FORCE]:g} N, and gives way"
        return f"no such state of {name} is found"

    def _rung(
        self, model: str | None, tolerance: float | None, about: Mapping[str, float]
    ) -> tuple[str, Variant, tuple[str, ...]]:
        """Model and mesh by their name in the ladder, and the variant that has them."""
        if model is not None:
            if model not in MODELS:
                raise StudyError(f"{model}: no such model\n  allowed: {choices(model, MODELS)}")
            return model, self.variant, ()
        if tolerance is None:
            return MODEL, self.variant, ()
        if not 0 < tolerance < 1:
            raise StudyError(f"tolerance {tolerance:g}\n  allowed: a share between 0 and 1")
        choice = model_choice.choose(self.study, self._scene(about, tolerance))
        assert choice.chosen is not None
        numerics = next(iter(choice.variants.values())).numerics
        variant = self.variant
        if choice.chosen.rung.mesh != "default":
            variant = replace(variant, numerics=numerics)
        notes: tuple[str, ...] = ()
        if not model_choice.is_enough(choice.chosen, tolerance):
            within = f"within {plain(100 * tolerance, 3)} %"
            notes = (f"no model is known to be {within}; this is the most exact",)
        return choice.chosen.rung.name, variant, notes

    def _scene(self, about: Mapping[str, float], tolerance: float | None = None) -> Scene:
        """The scene of the curve at the pressure of a state, from rest to it."""
        contraction = about[CONTRACTION] if math.isfinite(about[CONTRACTION]) else 0.0
        return Scene.model_validate(
            {
                "muscles": [self.name],
                "path": PathKind.ISOBARIC.value,
                "pressure": [about[PRESSURE]],
                "contraction": sorted({0.0, contraction}),
                "tolerance": tolerance,
            }
        )

    def _by(
        self,
        rung: str,
        variant: Variant,
        known: Mapping[str, float],
        about: Mapping[str, float],
        notes: tuple[str, ...],
    ) -> Answer:
        """The answer by a model."""
        model = _model_of(rung)
        if CONTRACTION not in known:
            path = self._path(PathKind.ISOTONIC, known[FORCE], known[PRESSURE])
            case, solution = self._solved(model, variant, path)
        elif FORCE not in known:
            path = self._path(PathKind.ISOBARIC, known[PRESSURE], known[CONTRACTION])
            case, solution = self._solved(model, variant, path)
        else:
            case, solution = self._at_force(model, variant, known, about[PRESSURE])
        state = {name: float(values[0]) for name, values in solution.states.items()}
        asked = next(kind for kind in KINDS if kind not in known)
        muscle, strength = self.studied.muscle, self.studied.limits.thread_strength
        found = {**{kind: state[kind] for kind in KINDS}, **known}
        thread = self.studied.thread.stiffness if self.studied.thread else math.nan
        tension = max(thread * (state["thread_stretch_max"] - 1), 0.0)
        error, from_others = self._error(rung, asked, found, state)
        return Answer(
            muscle=self.name,
            model=model,
            asked=asked,
            **found,
            error=error,
            length=muscle.length * (1 - found[CONTRACTION]),
            stroke=muscle.length * found[CONTRACTION],
            stiffness=state["stiffness"],
            force_by_pressure=state["force_by_pressure"],
            inner_diameter=state["inner_diameter_inflated"],
            outer_diameter=state["outer_diameter"],
            volume=state["volume"],
            thread_force=tension,
            thread_share=tension / strength if strength else math.nan,
            rubber_stretch=state["rubber_stretch_max"],
            notes=(
                *notes,
                *self._notes(found),
                *of_threads(case),
                *filter(None, (from_others, *map(words.of_state, solution.notes))),
            ),
            case=case.key,
            solves=sum(self.store.solves.values()),
        )

    def _path(self, kind: PathKind, held: float, stop: float) -> LoadPath:
        return LoadPath(kind=kind, held=held, stops=(stop,))

    def _solved(self, model: str, variant: Variant, path: LoadPath) -> tuple[Case, Solution]:
        """A case of one state, and its solution; raises if there is no such state."""
        studied = self.studied
        try:
            effects = model_choice.readable(model, variant.effects)
            case = studied.case(path, model, effects=effects, numerics=variant.numerics)
        except Refusal as refusal:
            raise StudyError(f"{self.name} by {model}: {refusal}") from None
        solution = self.store.solution(case)
        status = solution.state_status[0]
        if status not in VALID:
            why = solution.notes[0] or solution.reason
            raise _Missing(f"{model} finds no such state: {words.no_state(why)}")
        return case, judged(case, solution, studied.limits)

    def _at_force(
        self, model: str, variant: Variant, known: Mapping[str, float], start: float
    ) -> tuple[Case, Solution]:
        """The state at a contraction and a force: Newton's method over the pressure."""
        pressure = round(start, DIGITS)
        for _ in range(ROUNDS):
            path = self._path(PathKind.ISOMETRIC, known[CONTRACTION], pressure)
            case, solution = self._solved(model, variant, path)
            force = float(solution.states["force"][0])
            missing = known[FORCE] - force
            slope = float(solution.states["force_by_pressure"][0])
            if math.isnan(slope) and pressure:  # of Eq. (1), whose force is proportional to it
                slope = force / pressure
            if not slope > 0:
                break
            change = missing / slope
            if abs(change) <= NEAR:
                return case, solution
            pressure = round(max(pressure + change, 0.0), DIGITS)
        raise _Missing(f"{model} finds no pressure for this force: the threads are slack there")

    def _error(
        self, rung: str, asked: str, found: Mapping[str, float], state: Mapping[str, float]
    ) -> tuple[float, str]:
        """What model and mesh are expected to be off, in the unit of what is asked; and a note."""
        if self.studied.thread is None:
            return math.nan, ""  # never measured
        share, note = self._share(rung, found)
        newtons = share * abs(self.quick.force(found[PRESSURE], 0.0))
        slopes = {
            FORCE: 1.0,
            CONTRACTION: state["stiffness"] * self.studied.muscle.length,
            PRESSURE: state["force_by_pressure"],
        }
        known = bool(slopes[asked] and newtons)
        return (newtons / abs(slopes[asked]), note) if known else (math.nan, "")

    def _share(self, rung: str, found: Mapping[str, float]) -> tuple[float, str]:
        """Expected error as a share of the largest force at its pressure, and a note on it.

        That of the state, where this muscle was measured; else what 95 % of like muscles have at
        most from rest to there; else the most that the muscle of the paper has on such curves.
        """
        scene, model = self._scene(found), _model_of(rung)
        path = replace(
            self._path(PathKind.ISOBARIC, found[PRESSURE], 0.0), stops=tuple(scene.swept)
        )
        case, at = self.studied.case(path, model), found[CONTRACTION]
        measured = effect_states.at(case, at, model_choice.steps(rung))
        if measured is None and (guess := like_muscles.guess(case, rung, pushed=found[FORCE] < 0)):
            return guess.high + model_choice.smearing(self.study, scene), ""
        note = "" if measured else GUESS
        estimates = model_choice.estimates(self.study, scene, measured)
        return next((e.error for e in estimates if e.rung.name == rung), math.nan), note

    def _notes(self, found: Mapping[str, float]) -> list[str]:
        """What the signs of a state mean; what can be reached instead is that of the cylinder."""
        pressure, contraction = found[PRESSURE], found[CONTRACTION]
        if found[FORCE] < 0:
            said = "it does not come here by itself: it has to be pushed"
            free = self.quick.contraction(pressure, 0.0)
            if pressure > 0 and 0 < free < contraction:
                said += (
                    f"; at {pressure:g} MPa it gets shorter by about {plain(100 * free, 2)} % alone"
                )
            from_here = self.quick.pressure(contraction, 0.0)
            if from_here > pressure:
                said += (
                    f"; at {100 * contraction:g} % it pulls from about {plain(from_here, 2)} MPa on"
                )
            return [said]
        if contraction < 0:
            blocked = self.quick.force(pressure, 0.0)
            beside = f"; at its length at rest it pulls about {plain(blocked, 3)} N"
            return ["it is longer than at rest" + (beside if blocked < found[FORCE] else "")]
        return []


def _model_of(rung: str) -> str:
    """The model of a rung of the ladder; models beside it are their own."""
    return model_choice.RUNGS[rung].model if rung in model_choice.RUNGS else rung


def lines(answer: Answer) -> list[str]:
    """The answer as a few lines of text."""
    given = ", ".join(_text(answer, kind) for kind in KINDS if kind != answer.asked)
    shown = f"± {_size(answer.asked, answer.error)}" if math.isfinite(answer.error) else ""
    rows = [
        (answer.asked, f"{_text(answer, answer.asked)}  {shown}".rstrip()),
        (
            "stroke",
            f"{plain(answer.stroke, 4)} mm, to a length of {plain(answer.length, 4)} mm",
        ),
        ("stiffness", f"{plain(answer.stiffness, 4)} N/mm at constant pressure"),
        (
            "force by pressure",
            f"{plain(answer.force_by_pressure / 10, 4)} N/bar at constant length",
        ),
        ("inner diameter", f"{plain(answer.inner_diameter, 4)} mm at mid-length"),
        ("outer diameter", f"{plain(answer.outer_diameter, 4)} mm at its widest"),
        ("volume inside", f"{plain(answer.volume / 1000, 4)} ml"),
        ("load of a thread", f"{plain(answer.thread_force, 3)} N{_share(answer)}"),
        ("rubber stretched to", f"{plain(answer.rubber_stretch, 3)} times its length at most"),
    ]
    width = max(len(name) for name, _ in rows) + 2
    said = [f"{answer.muscle} at {given}, by {answer.model}:"]
    said += [f"  {name:<{width}}{value}" for name, value in rows if "nan" not in value]
    return said + [f"  note: {note}" for note in answer.notes]


def of_threads(case: Case) -> tuple[str, ...]:
    """What the load of a thread is, where that is not its tension."""
    if "discrete_threads" not in case.active_effects:
        return ()
    return (
        "the load of a thread is that of its most stretched point across its width, by which its "
        "stiffness is spread; its tension is less",
    )


def as_dict(answer: Answer) -> dict[str, Any]:
    """The answer for JSON: every number with its unit; what is not known is None."""
    numbers = {
        **{kind: (getattr(answer, kind), UNIT[kind]) for kind in KINDS},
        "error": (answer.error, UNIT[answer.asked]),
        "length": (answer.length, "mm"),
        "stroke": (answer.stroke, "mm"),
        "stiffness": (answer.stiffness, "N/mm"),
        "force_by_pressure": (answer.force_by_pressure, "N/MPa"),
        "inner_diameter": (answer.inner_diameter, "mm"),
        "outer_diameter": (answer.outer_diameter, "mm"),
        "volume": (answer.volume, "mm^3"),
        "thread_force": (answer.thread_force, "N"),
        "thread_share": (answer.thread_share, "1"),
        "rubber_stretch": (answer.rubber_stretch, "1"),
    }
    return {
        "muscle": answer.muscle,
        "model": answer.model,
        "asked": answer.asked,
        **{
            name: {"value": value if math.isfinite(value) else None, "unit": unit}
            for name, (value, unit) in numbers.items()
        },
        "notes": list(answer.notes),
        "case": answer.case,
        "solves": answer.solves,
    }


def _text(answer: Answer, kind: str) -> str:
    """One of the three quantities with its unit."""
    value: float = getattr(answer, kind)
    if kind == CONTRACTION:
        return f"{plain(100 * value, 4)} %"
    return f"{plain(value, 4)} {UNIT[kind]}"


def _size(kind: str, error: float) -> str:
    """An error, in the unit that ``_text`` has."""
    return (
        f"{plain(100 * error, 2)} %" if kind == CONTRACTION else f"{plain(error, 2)} {UNIT[kind]}"
    )


def _share(answer: Answer) -> str:
    share = answer.thread_share
    return f", {plain(100 * share, 2)} % of its strength" if math.isfinite(share) else ""
