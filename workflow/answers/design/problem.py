"""A design as a problem of optimisation: what is free, the muscle it makes, what is required of it.

A candidate is a vector: numbers between two, integers, and places in lists of names. Everything
that is asked of it is a *measure*, a number by a model; a requirement is a measure and its limit.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from geometry.braid import Braid
from geometry.muscle import Muscle
from geometry.readable import plain
from geometry.refusal import Refusal
from solver.case import Case
from solver.load_path import LoadPath, PathKind
from solver.models.cylinder.direct import direct
from solver.models.cylinder.mechanics import Cylinder
from solver.refusal import UnsolvableCase
from workflow.answers.curve import Curve
from workflow.answers.quick import Quick
from workflow.answers.sheet import mass_of
from workflow.plan.sheet_stops import stops_to
from workflow.study import fit
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.muscles import CAP_PER_WALL
from workflow.study.schema import DesignEntry, RequirementEntry

NUMBERS = ("inner_diameter", "wall_thickness", "length", "angle")
DECIMALS = 3  # of lengths and angles of a muscle that is solved: what is pasted is what was solved
MORE = 6
MOST = 0.5  # contraction beyond which no free contraction is looked for
TRUTH = "solid"
LITRE = 1e6  # mm3
THREAD_MODULUS = 2100.0  # MPa, section 2.2 of the paper: of threads whose diameter is not given
TRADE_OFF = "trade-off"  # the name of an objective that is bounded
GIVEN = 10  # digits of what a user has given
LEAST_SCALE = 0.01  # of the blocked force: what a force is judged against at least
Array = NDArray[np.float64]
Measures = dict[str, float]


@dataclass(frozen=True)
class Requirement:
    """A measure and its limit; ``sense`` is 1 where it must be at least that, -1 at most."""

    name: str
    measure: str
    sense: int
    limit: float
    what: str  # as a user would say it
    unit: str

    def violation(self, measures: Measures) -> float:
        """By how much it is missed, as a share; negative where it is met."""
        scale = max(abs(self.limit), LEAST_SCALE * abs(measures["scale"]) if self.is_force else 0.0)
        return self.sense * (self.limit - measures[self.measure]) / (scale or 1.0)

    @property
    def is_force(self) -> bool:
        """Whether a limit of zero has no size of its own."""
        return self.unit == "N"

    @property
    def text(self) -> str:
        """``force at 5 %, 0.4 MPa: at least 500 N``."""
        turned = -1 if self.measure.startswith("-") else 1
        sign = "at least" if self.sense * turned > 0 else "at most"
        digits = 4 if self.name == TRADE_OFF else GIVEN
        return f"{self.what}: {sign} {plain(turned * self.limit, digits)} {self.unit}".rstrip()

    def value(self, measures: Measures) -> float:
        """What it is, as a user would say it."""
        value = measures[self.measure]
        return -value if self.measure.startswith("-") else value


class Problem:
    """A design of a study."""

    def __init__(self, study: Study, name: str) -> None:
        self.study, self.name = study, name
        self.entry: DesignEntry = study.design[name]
        free = self.entry.free
        self.numbers = [key for key in NUMBERS if getattr(free, key) is not None]
        self.has_threads = free.threads is not None
        self.materials = free.material or ()
        self.bases = free.muscle or (self.entry.base,)
        self.requirements = [self._requirement(k, r) for k, r in self.entry.require.items()]
        self._known: dict[tuple[float, ...], Measures | None] = {}
        self.evaluations = 0

    # --- candidates ---------------------------------------------------------------------------

    @cached_property
    def bounds(self) -> list[tuple[float, float]]:
        """Of every entry of a candidate: numbers, threads, material, base."""
        found = [getattr(self.entry.free, key) for key in self.numbers]
        found += [self.entry.free.threads] if self.has_threads else []
        found += [(0, len(self.materials) - 1)] if len(self.materials) > 1 else []
        found += [(0, len(self.bases) - 1)] if len(self.bases) > 1 else []
        return [(float(low), float(high)) for low, high in found]

    @cached_property
    def integral(self) -> NDArray[np.bool_]:
        """Which entries are integers."""
        return np.arange(len(self.bounds)) >= len(self.numbers)

    def values(self, x: Array) -> dict[str, float | int | str]:
        """What a candidate chooses, by key."""
        rest = [round(v) for v in x[len(self.numbers) :]]
        found: dict[str, float | int | str] = {
            key: float(v) for key, v in zip(self.numbers, x, strict=False)
        }
        if self.has_threads:
            found["threads"] = rest.pop(0)
        if self.materials:
            found["material"] = self.materials[rest.pop(0) if len(self.materials) > 1 else 0]
        if len(self.bases) > 1:
            found["base"] = self.bases[rest.pop(0)]
        return found

    def rounded(self, x: Array) -> Array:
        """A candidate whose numbers have few decimals, as the muscle that is pasted.

        More of them where the rounded one has no such states: it is at the end of what can be
        built, as where the outer layer comes out of the wall.
        """
        found = [np.where(self.integral, np.round(x), np.round(x, d)) for d in (DECIMALS, MORE)]
        return found[0] if self.cheap(found[0]) is not None else found[1]

    def muscle(self, x: Array) -> StudiedMuscle:
        """The muscle of a candidate; raises Refusal if it cannot be built."""
        values = self.values(x)
        base = self.study.muscles[str(values.get("base", self.entry.base))]
        old, braid = base.muscle, base.muscle.braid
        assert isinstance(braid, Braid)  # see workflow/study/design.py
        diameter = float(values.get("inner_diameter", old.inner_diameter))
        wall = float(values.get("wall_thickness", old.wall_thickness))
        depths = [round(d - old.inner_diameter, 9) for d in braid.layer_diameters]  # twice
        angle = float(values.get("angle", math.degrees(braid.angle)))
        new = Braid.from_angle(
            angle=angle,
            threads=int(values.get("threads", braid.threads)),
            layer_diameters=(diameter + depths[0], diameter + depths[1]),
        )
        cap = old.cap_length
        muscle = Muscle(
            inner_diameter=diameter,
            wall_thickness=wall,
            length=float(values.get("length", old.length)),
            braid=new,
            cap_length=CAP_PER_WALL * wall if cap == CAP_PER_WALL * old.wall_thickness else cap,
        )
        material = str(values.get("material", base.material))
        rubber = self.study.rubbers.get(material, base.rubber)
        return replace(base, muscle=muscle, material=material, rubber=rubber, reference=())

    # --- measures -----------------------------------------------------------------------------

    def _requirement(self, name: str, given: RequirementEntry) -> Requirement:
        sense = 1 if given.at_least is not None else -1
        limit = given.at_least if given.at_least is not None else given.at_most
        assert limit is not None
        pressure = self.entry.pressure if given.pressure is None else given.pressure
        reserve = 1 + self.entry.reserve if sense > 0 else 1.0
        at = f"{pressure:g} MPa"
        if given.quantity in ("force", "blocked_force"):
            contraction = given.contraction or 0.0
            what = f"force at {100 * contraction:g} %, {at}"
            measure = f"force {pressure!r} {contraction!r}"
            return Requirement(name, measure, sense, limit * reserve, what, "N")
        if given.quantity == "free_contraction":
            what = f"force at {100 * limit:g} %, {at} (free contraction)"
            return Requirement(name, f"force {pressure!r} {limit!r}", sense, 0.0, what, "N")
        if given.quantity == "stroke":
            load = float(given.load or 0.0) * reserve
            what = f"force after {limit:g} mm, {at} (stroke)"
            return Requirement(name, f"lift {pressure!r} {limit!r}", sense, load, what, "N")
        if given.quantity == "air":
            contraction = given.contraction or 0.0
            what = f"air at {100 * contraction:g} %, {at}"
            return Requirement(name, f"air {pressure!r} {contraction!r}", sense, limit, what, "Nl")
        if given.quantity in ("length", "thread_cover"):
            unit = "mm" if given.quantity == "length" else ""
            return Requirement(
                name, given.quantity, sense, limit, given.quantity.replace("_", " "), unit
            )
        unit = "mm" if given.quantity == "outer_diameter" else ""
        what = f"{given.quantity.replace('_', ' ')}, {at}"
        return Requirement(name, f"{given.quantity} {pressure!r}", sense, limit, what, unit)

    @cached_property
    def wanted(self) -> list[str]:
        """Measures that requirements and objectives read."""
        return list(dict.fromkeys([r.measure for r in self.requirements] + self.objectives))

    @cached_property
    def largest_contraction(self) -> float:
        """That is required, of which the objective is."""
        asked = [r.contraction or 0.0 for r in self.entry.require.values()]
        asked += [r.at_least or 0.0 for r in self.entry.require.values() if _frees(r)]
        return max([*asked, self.entry.contraction or 0.0])

    @cached_property
    def objectives(self) -> list[str]:
        """Their measures; all are to be as small as may be."""
        pressure = self.entry.pressure
        at = self.largest_contraction if self.entry.contraction is None else self.entry.contraction
        named = {
            "air": f"air {pressure!r} {at!r}",
            "force": f"-force {pressure!r} {at!r}",
            "outer_diameter": f"outer_diameter {pressure!r}",
            "work": f"-work {pressure!r} {at!r}",
        }
        chosen = [*self.entry.minimise, *self.entry.maximise]
        return [named.get(key, key) for key in chosen]

    def bound(self, measure: str, limit: float) -> Requirement:
        """An objective that is at most so much (of one that is to be large: at least)."""
        text = self.text_of(measure, limit).split(": ")[0]
        unit = self.text_of(measure, limit).split()[-1]
        return Requirement(TRADE_OFF, measure, -1, limit, text, unit)

    def contractions(self, studied: StudiedMuscle) -> dict[float, list[float]]:
        """At which states are needed, by pressure: from none to the largest that is required."""
        found: dict[float, set[float]] = {}
        for measure in self.wanted:
            kind, *numbers = measure.removeprefix("-").split()
            if not numbers:
                continue
            at = found.setdefault(float(numbers[0]), {0.0})
            if len(numbers) > 1:
                contraction = float(numbers[1])
                at.add(contraction / studied.muscle.length if kind == "lift" else contraction)
            if kind in ("outer_diameter", "thread_share", "rubber_stretch", "bore_stretch"):
                at.add(self.largest_contraction)
            if kind == "work":
                at.update(contraction * k / 4 for k in range(5))
        return {pressure: sorted(at) for pressure, at in found.items()}

    def cheap(self, x: Array) -> Measures | None:
        """The measures of a candidate by the cylinder; None where there is no such muscle."""
        key = tuple(map(float, x))
        if key not in self._known:
            self._known[key] = self._cheap(x)
        return self._known[key]

    def _cheap(self, x: Array) -> Measures | None:
        try:
            studied = self.muscle(x)
            path = LoadPath(kind=PathKind.ISOBARIC, held=0.0, stops=(0.0,))
            cylinder = Cylinder(studied.case(path, "cylinder"))
        except (Refusal, UnsolvableCase):
            return None
        states: dict[tuple[float, float], dict[str, float]] = {}
        for pressure, contractions in self.contractions(studied).items():
            start = 1.0  # the wall widens as the muscle gets shorter
            for contraction in contractions:
                self.evaluations += 1
                at = direct(cylinder, pressure, contraction, start)
                if at is None:
                    return None
                start = float(at[0])
                states[pressure, contraction] = _of_cylinder(cylinder, at)
        return self._measures(studied, states)

    def case(self, studied: StudiedMuscle, pressure: float) -> Case:
        """The curve by which a muscle is judged, and from which its sheet is made."""
        wanted = self.contractions(studied).get(pressure, [0.0])
        free = Quick(studied).contraction(pressure, 0.0)
        most = math.floor(100 * free) / 100 if free < MOST else 0.0
        most = max(most, self.largest_contraction, wanted[-1])
        stops = tuple(sorted({*wanted, *(stops_to(most) if most > 0 else ())}))
        path = LoadPath(kind=PathKind.ISOBARIC, held=pressure, stops=stops, zero_force=True)
        return studied.case(path, TRUTH, fields_at=stops[-1:])

    def by_curves(self, studied: StudiedMuscle, curves: Mapping[float, Curve]) -> Measures | None:
        """The measures by solved curves; None where a state that is needed is missing."""
        states: dict[tuple[float, float], dict[str, float]] = {}
        for pressure, curve in curves.items():
            wanted = self.contractions(studied)[pressure]
            for number, contraction in enumerate(curve.case.path.stops):
                state = {k: float(v[number]) for k, v in curve.solution.states.items()}
                if not math.isfinite(state["force"]):
                    if contraction in wanted:
                        return None
                    continue
                states[pressure, contraction] = state
        return self._measures(studied, states)

    def _measures(
        self, studied: StudiedMuscle, states: Mapping[tuple[float, float], dict[str, float]]
    ) -> Measures:
        """All that is wanted, of some states."""
        muscle, installation = studied.muscle, studied.installation
        around, dead = installation.ambient_pressure, installation.dead_volume
        found = {"length": muscle.length, "mass": mass_of(studied), "thread_cover": cover(studied)}
        forces = [abs(s["force"]) for (_, e), s in states.items() if e == 0]
        found["scale"] = max(forces, default=1.0)
        empty = math.pi / 4 * muscle.inner_diameter**2 * muscle.length + dead
        ranged: dict[str, Callable[[dict[str, float]], float]] = {
            "outer_diameter": lambda s: s["outer_diameter"],
            "rubber_stretch": lambda s: s["rubber_stretch_max"],
            "bore_stretch": lambda s: s["inner_diameter_inflated"] / muscle.inner_diameter,
            "thread_share": lambda s: _tension(studied, s) / (studied.limits.thread_strength or 1),
        }
        for measure in self.wanted:
            plain = measure.removeprefix("-")
            kind, *numbers = plain.split()
            sign = -1 if measure.startswith("-") else 1
            if not numbers:
                continue
            pressure = float(numbers[0])
            here = {e: s for (p, e), s in states.items() if p == pressure}
            if kind in ranged:
                inside = [s for e, s in here.items() if e <= self.largest_contraction + 1e-12]
                found[measure] = max(map(ranged[kind], inside))
                continue
            at = float(numbers[1])
            if kind == "force":
                found[measure] = sign * here[at]["force"]
            elif kind == "lift":
                found[measure] = here[at / muscle.length]["force"]
            elif kind == "air":
                full = (here[at]["volume"] + dead) * (pressure + around)
                found[measure] = (full - empty * around) / around / LITRE
            elif kind == "work":
                weights = np.array([7, 32, 12, 32, 7]) / 90  # Boole's rule
                forces = [here[at * k / 4]["force"] for k in range(5)]
                found[measure] = sign * float(weights @ forces) * at * muscle.length / 1000
        return found

    def text_of(self, measure: str, value: float) -> str:
        """A measure as a user would say it."""
        kind, *numbers = measure.removeprefix("-").split()
        unit = {"air": "Nl", "force": "N", "work": "J", "mass": "g"}.get(kind, "mm")
        value = -value if measure.startswith("-") else value
        at = f" at {100 * float(numbers[1]):g} %" if len(numbers) > 1 else ""
        return f"{kind.replace('_', ' ')}{at}: {plain(value, 4)} {unit}"


def _frees(given: RequirementEntry) -> bool:
    """Whether a contraction is its limit."""
    return bool(given.quantity == "free_contraction")


def _of_cylinder(cylinder: Cylinder, at: Array) -> dict[str, float]:
    """What measures read of a state, without its derivatives."""
    state, muscle = cylinder.state(at), cylinder.case.muscle
    stretch = cylinder.thread_stretch(state)
    return {
        "force": state.force,
        "volume": math.pi * state.r**2 * state.lz * muscle.length,
        "outer_diameter": 2 * cylinder.radius_at(muscle.outer_radius, state.r, state.lz),
        "inner_diameter_inflated": 2 * cylinder.radius_at(muscle.inner_radius, state.r, state.lz),
        "rubber_stretch_max": cylinder.rubber_stretch(state),
        "thread_stretch_max": float(stretch.max()),
    }


def _tension(studied: StudiedMuscle, state: Mapping[str, float]) -> float:
    """Largest force of a thread [N]."""
    assert studied.thread is not None
    return studied.thread.stiffness * max(state["thread_stretch_max"] - 1, 0.0)


def cover(studied: StudiedMuscle) -> float:
    """Share of its circumference that a layer of threads takes; more than 1 does not fit."""
    braid, thread = studied.muscle.braid, studied.thread
    assert isinstance(braid, Braid)
    assert thread is not None
    wide = studied.installation.thread_diameter or fit.diameter(thread.stiffness, THREAD_MODULUS)
    room = math.pi * min(braid.layer_diameters) * math.cos(braid.angle)
    return braid.threads * wide / room
