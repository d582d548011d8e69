"""What time does to the normal condition: hysteresis, working frequency, a mass on a valve.

The rubber has an assumed memory, equal relaxation in every decade from 1 ms to 1000 s, by 6 % of
the long-term stiffness each: no relaxation test of the rubber of a muscle is known with numbers.
Loops are the third of three, from rest at their first state. Beside it stands the same muscle with
its threads in a sleeve, whose rubber has no memory and whose crossings rub. The loop that the
solid goes through too shows what the wall is and bears at one contraction on both ways.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from geometry.braid import LayeredBraid
from geometry.muscle import Muscle
from solver.case import Case
from solver.friction import Friction
from solver.history import History, Valve, Wave, sampled
from solver.load_path import LoadPath, PathKind
from solver.memory import Memory
from workflow.analyses.analysis import AnalysisCase
from workflow.study.contents import Study

MUSCLE = "dmsp20"
MEMORY = Memory.flat(0.06, 1e-3, 1e3)
PRESSURE, AT = 0.3, 0.1  # MPa, contraction, at which loops are compared
FURTHEST = 0.2  # contraction, of the loops of force
RATES = (0.01, 0.1, 1.0)  # of contraction, 1/s
PRESSURES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)  # MPa
LOAD, HIGHEST = 200.0, 0.4  # N, MPa, of the loops of contraction
FREQUENCIES = (0.01, 0.1, 1.0, 10.0)  # Hz
SAMPLES, CYCLES = 100, 3
FRICTION, CONTACTS = 0.2, (0.2, 0.4)  # 1, mm: a guess for a braid of nylon
MASS, STEP, DURATION = 5.0, 0.004, 0.8  # kg, s, s
GRAVITY = 9.80665  # m/s2
VALVE = Valve(conductance=1e7, critical_ratio=0.3)  # 1 dm3/(s bar)
VIBRATIONS = tuple(float(f"{10 ** (k / 4):.4g}") for k in range(-8, 9))  # Hz


def cases(study: Study) -> list[AnalysisCase]:
    """Loops of force by rate and pressure, of contraction by frequency; a step; vibrations."""
    return [*_loops(study), _wall(study), *_sleeves(study), *_steps(study), *_vibrations(study)]


def _case(study: Study, model: str, path: LoadPath, *, memory: bool = True, **more: Any) -> Case:
    return study.muscles[MUSCLE].case(path, model, memory=MEMORY if memory else None, **more)


def cycle(kind: PathKind, held: float, end: float, period: float, count: int = CYCLES) -> LoadPath:
    """A triangle from 0 and back, several times."""
    times, stops = sampled(Wave.TRIANGLE, 0.0, end, period, count, SAMPLES)
    return LoadPath(kind=kind, held=held, stops=stops, history=History(times=times, period=period))


def _loops(study: Study) -> Iterator[AnalysisCase]:
    tags: dict[str, str | float]
    for rate in RATES:
        path = cycle(PathKind.ISOBARIC, PRESSURE, FURTHEST, 2 * FURTHEST / rate)
        case = _case(study, "membrane", path, fields_at=(AT,) if rate == RATES[1] else ())
        tags = {"set": "rate", "pressure": PRESSURE, "rate": rate}
        yield AnalysisCase(case, f"{100 * rate:g} %/s", tags)
    for pressure in PRESSURES:
        path = cycle(PathKind.ISOBARIC, pressure, FURTHEST, 2 * FURTHEST / RATES[1])
        tags = {"set": "pressure", "pressure": pressure, "rate": RATES[1]}
        yield AnalysisCase(_case(study, "cylinder", path), f"{pressure:g} MPa", tags)
    for frequency in FREQUENCIES:
        path = cycle(PathKind.ISOTONIC, LOAD, HIGHEST, 1 / frequency)
        tags = {"set": "frequency", "pressure": PRESSURE, "frequency": frequency}
        yield AnalysisCase(_case(study, "membrane", path), f"{frequency:g} Hz", tags)


def _wall(study: Study) -> AnalysisCase:
    """The loop at the middle rate, with the fields of the wall."""
    path = cycle(PathKind.ISOBARIC, PRESSURE, FURTHEST, 2 * FURTHEST / RATES[1])
    tags: dict[str, str | float] = {"set": "wall", "pressure": PRESSURE, "rate": RATES[1]}
    case = _case(study, "solid", path, fields_at=(AT,))
    return AnalysisCase(case, f"solid, {100 * RATES[1]:g} %/s", tags)


def sleeved(muscle: Muscle) -> Muscle:
    """The same tube with threads as many and as inclined in a sleeve on its outer surface."""
    assert muscle.braid is not None
    around = muscle.outer_radius / (muscle.braid.mean_diameter / 2)
    braid = LayeredBraid(
        kinds=("sleeve",),
        layer_diameters=(2 * muscle.outer_radius,),
        leads=(muscle.braid.lead * around,),
        threads=(int(muscle.braid.threads_each),),
        senses=(0,),
        stiffness_shares=(1.0,),
    )
    return replace(muscle, braid=braid)


def _sleeves(study: Study) -> Iterator[AnalysisCase]:
    """Loops of force of a sleeve whose crossings rub; no rate enters."""
    studied = study.muscles[MUSCLE]
    studied = replace(studied, muscle=sleeved(studied.muscle))
    for contact in CONTACTS:
        friction = Friction(coefficient=FRICTION, contact=contact)
        for pressure in PRESSURES:
            path = cycle(PathKind.ISOBARIC, pressure, FURTHEST, 2 * FURTHEST / RATES[1], 2)
            case = studied.case(path, "cylinder", memory=None, friction=friction)
            tags: dict[str, str | float] = {"set": "sleeve", "pressure": pressure}
            tags |= {"rate": RATES[1], "contact": contact}
            yield AnalysisCase(case, f"{pressure:g} MPa, contacts of {contact:g} mm", tags)


def _steps(study: Study) -> Iterator[AnalysisCase]:
    """A hanging mass, whose valve opens."""
    times = tuple(round(STEP * k, 9) for k in range(round(DURATION / STEP) + 1))
    history = History(times=times, mass=MASS, valve=VALVE)
    stops = (0.0, *[PRESSURE] * (len(times) - 1))
    path = LoadPath(kind=PathKind.ISOTONIC, held=MASS * GRAVITY, stops=stops, history=history)
    for label, memory in (("without memory", False), ("with memory", True)):
        case = _case(study, "membrane", path, memory=memory)
        yield AnalysisCase(case, label, {"set": "step", "pressure": PRESSURE})


def _vibrations(study: Study) -> Iterator[AnalysisCase]:
    for pressure in (0.2, 0.3, 0.4):
        path = LoadPath(kind=PathKind.ISOBARIC, held=pressure, stops=(AT,))
        case = _case(study, "membrane", path, frequencies=VIBRATIONS)
        tags: dict[str, str | float] = {"set": "vibration", "pressure": pressure}
        yield AnalysisCase(case, f"{pressure:g} MPa", tags)
