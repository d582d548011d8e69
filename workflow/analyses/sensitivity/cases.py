"""How much each input moves the muscle's force, threshold pressure and free contraction.

Local: percent of the result per percent of the input at the normal condition (20 mm, 0.3 MPa,
10 %), by central differences, with the cylinder and, to check it, the solid. Global: Sobol's
indices, the share of the variance that an input explains alone (first) and with others (total),
with the cylinder, which takes milliseconds; once over what is not known of the paper's muscle, once
over the factors of the paper's Table 1. Threads slacken and the tube is clamped, as by default.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from geometry.muscle import Braid
from solver.case import Case
from solver.load_path import LoadPath, PathKind
from solver.material import Thread
from solver.models.cylinder.mechanics import Cylinder, State
from solver.record import Solution
from solver.status import StateStatus
from workflow.analyses.analysis import Solved, StudyCase
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.errors import StudyError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MUSCLE, OTHER = "dmsp20", "dmsp20_silicone"  # of the study file; the softest rubber of Table 1
STEP = 0.02  # relative, of local differences
SEED, SAMPLES = 20260101, 128  # samples: a power of two, times the number of inputs and two
CHECK = "solid"
RADII = (0.8, 4.0)  # inner radii between which a pressure is looked for
SHORTEST = 0.5  # axial stretch from which on the free contraction is looked for
Ranges = Mapping[str, float | tuple[float, float]]
OUTPUTS = {
    "force": "force at the contraction and pressure",
    "threshold_pressure": "threshold pressure",
    "free_contraction": "free contraction",
}
UNCERTAIN: Ranges = {  # what is not known of the paper's muscle: share of its value, or ends
    "thread_stiffness": (50.0, 650.0),  # N
    "c10": 0.2,
    "c01": 0.2,
    "inner_layer": 0.01,  # 0.1 mm
    "outer_layer": 0.01,
    "wall_thickness": 0.05,  # 0.1 mm
    "lead": 0.04,  # a tenth of a millimetre between threads
}
# Table 1; the contraction without its ends, where there is no threshold or no force
DESIGN: Ranges = {
    "contraction": (0.05, 0.15),
    "pressure": (0.2, 0.4),  # MPa
    "inner_diameter": (20.0, 40.0),  # mm
    "wall_thickness": (1.5, 3.0),  # mm
    "lead": (144.0, 216.0),  # mm: 24.8 to 17.1 degrees
    "nbr": (0.0, 1.0),  # share of NBR between silicone and NBR
}
ANALYSES = {"what is not known": UNCERTAIN, "factors of Table 1": DESIGN}
Point = dict[str, float]


@dataclass(frozen=True)
class Normal:
    """The normal condition: inputs by name, and what they change."""

    muscle: StudiedMuscle
    soft: StudiedMuscle
    braid: Braid
    point: Point

    @classmethod
    def of(cls, study: Study) -> "Normal":
        """Of a study with the paper's muscles."""
        for name in (MUSCLE, OTHER):
            if name not in study.muscles or study.muscles[name].muscle.braid is None:
                raise StudyError(f"muscles.{name}: the sensitivities are of this muscle")
        muscle = study.muscles[MUSCLE]
        braid, thread = muscle.muscle.braid, muscle.thread
        assert braid is not None
        assert thread is not None
        inner, outer = braid.layer_diameters
        point = {
            "contraction": 0.1,
            "pressure": 0.3,  # MPa
            "inner_diameter": muscle.muscle.inner_diameter,
            "wall_thickness": muscle.muscle.wall_thickness,
            "lead": braid.lead,
            "inner_layer": inner / 2,  # mm, radius
            "outer_layer": outer / 2,
            "thread_stiffness": thread.stiffness,
            "c10": muscle.rubber.c10,
            "c01": muscle.rubber.c01,
            "nbr": 1.0,
        }
        return cls(muscle, study.muscles[OTHER], braid, point)

    @property
    def inputs(self) -> list[str]:
        """What local differences are taken by."""
        return [name for name in self.point if name != "nbr"]

    def cases(self, changes: Mapping[str, float], model: str) -> tuple[Case, Case]:
        """Isobaric case with the free contraction, isometric one with the threshold pressure.

        A wider bore keeps the layers' distance from it and the braid angle.
        """
        p = {**self.point, **changes}
        base = self.muscle.muscle
        shift = (p["inner_diameter"] - base.inner_diameter) / 2
        layers = (2 * (p["inner_layer"] + shift), 2 * (p["outer_layer"] + shift))
        lead = p["lead"] * sum(layers) / sum((2 * p["inner_layer"], 2 * p["outer_layer"]))
        muscle = replace(
            base,
            inner_diameter=p["inner_diameter"],
            wall_thickness=p["wall_thickness"],
            braid=replace(self.braid, lead=lead, layer_diameters=layers),
        )
        soft, share = self.soft.rubber, p["nbr"]
        rubber = replace(
            self.muscle.rubber,
            c10=share * p["c10"] + (1 - share) * soft.c10,
            c01=share * p["c01"] + (1 - share) * soft.c01,
        )
        thread = Thread(stiffness=p["thread_stiffness"])
        held = {
            PathKind.ISOBARIC: (p["pressure"], p["contraction"]),
            PathKind.ISOMETRIC: (p["contraction"], p["pressure"]),
        }
        first, second = (
            Case(
                muscle=muscle,
                rubber=rubber,
                thread=thread,
                path=LoadPath(kind=kind, held=at, stops=(stop,), zero_force=True),
                model=model,
            )
            for kind, (at, stop) in held.items()
        )
        return first, second


@dataclass(frozen=True)
class SensitivityCase(StudyCase):
    """A case that checks a local difference."""

    normal: Normal | None = None


def outputs(isobaric: Solution, isometric: Solution) -> dict[str, float]:
    """The results of both cases, NaN where a state is not valid."""

    def state(solution: Solution, number: int, name: str) -> float:
        good = solution.state_status[number] is StateStatus.CONVERGED
        return float(solution.states[name][number]) if good else np.nan

    return {
        "force": state(isobaric, 0, "force"),
        "threshold_pressure": state(isometric, -1, "pressure"),
        "free_contraction": state(isobaric, -1, "contraction"),
    }


def cases(study: Study) -> list[StudyCase]:
    """The normal condition and both neighbours by each input, by the solid."""
    normal = Normal.of(study)
    return [
        SensitivityCase(
            case,
            f"sensitivity to {name}, {case.path.kind}",
            {"input": name, "way": way},
            normal=normal,
        )
        for name, way, changes in _neighbours(normal)
        for case in normal.cases(changes, CHECK)
    ]


def _neighbours(normal: Normal) -> Iterator[tuple[str, int, Point]]:
    """Input, direction and changed value; direction 0 is the normal condition."""
    yield "none", 0, {}
    for name in normal.inputs:
        for way in (-1, 1):
            value = normal.point[name] * (1 + way * STEP)
            yield name, way, {name: float(f"{value:.12g}")}


def table(solved: Sequence[Solved]) -> pd.DataFrame:
    """One row per analysis, model, input and output."""
    first = solved[0].asked
    assert isinstance(first, SensitivityCase)
    assert first.normal is not None
    normal = first.normal
    by_model: dict[str, dict[tuple[str, int], dict[str, float]]] = {"cylinder": {}, CHECK: {}}
    for name, way, changes in _neighbours(normal):
        by_model["cylinder"][name, way] = _by_cylinder(normal, changes)
        found = [s for s in solved if (s.asked.tags["input"], s.asked.tags["way"]) == (name, way)]
        by_model[CHECK][name, way] = outputs(*(s.solution for s in found))
    rows = [row for model, found in by_model.items() for row in _local(model, found, normal)]
    for name, ranges in ANALYSES.items():
        rows += _global(name, normal, ranges)
    return pd.DataFrame(rows)


def _by_cylinder(normal: Normal, changes: Mapping[str, float]) -> dict[str, float]:
    """Roots of the cylinder's explicit forces, bracketed: the zero of force has others far out."""
    case, _ = normal.cases(changes, "cylinder")
    tube, pressure = Cylinder(case), case.path.held

    def state(r: float, lz: float) -> State:
        return tube.state(np.array([r, lz]))

    def radius(lz: float) -> float:
        """In inner radii, at the pressure."""
        return float(brentq(lambda r: state(r, lz).pressure - pressure, *RADII))

    def force(lz: float) -> float:
        return state(radius(lz), lz).force

    lz = 1 - case.path.stops[0]
    found = {"force": force(lz), "threshold_pressure": np.nan, "free_contraction": np.nan}
    if found["force"] > 0:  # so both zeros lie between here and the slack muscle
        empty = brentq(lambda r: state(r, lz).pressure, RADII[0], radius(lz))
        at = brentq(lambda r: state(r, lz).force, empty, radius(lz))
        found["threshold_pressure"] = state(at, lz).pressure
        found["free_contraction"] = 1 - float(brentq(force, SHORTEST, lz))
    return found


def _local(
    model: str, found: Mapping[tuple[str, int], Mapping[str, float]], normal: Normal
) -> Iterator[dict[str, str | float]]:
    for name in normal.inputs:
        for output in OUTPUTS:
            change = found[name, 1][output] - found[name, -1][output]
            value = found["none", 0][output]
            yield {
                "analysis": "local",
                "model": model,
                "input": name,
                "output": output,
                "at the normal condition": value,
                "percent per percent": change / (2 * STEP) / value,
            }


def _global(name: str, normal: Normal, ranges: Ranges) -> Iterator[dict[str, str | float]]:
    """Sobol's indices; samples without a result (counted) are set to the mean of the others."""
    from SALib.analyze import sobol as analysis  # late: a second
    from SALib.sample import sobol as sampling

    names = list(ranges)
    bounds = [_ends(normal.point[key], ranges[key]) for key in names]
    problem = {"num_vars": len(names), "names": names, "bounds": bounds}
    points = sampling.sample(problem, SAMPLES, calc_second_order=False, seed=SEED)
    results = [_by_cylinder(normal, dict(zip(names, map(float, p), strict=True))) for p in points]
    for output in OUTPUTS:
        values = np.array([result[output] for result in results])
        missing = np.isnan(values)
        values[missing] = np.nanmean(values)
        found = analysis.analyze(problem, values, calc_second_order=False, seed=SEED)
        for k, key in enumerate(names):
            yield {
                "analysis": name,
                "model": "cylinder",
                "input": key,
                "output": output,
                "low": bounds[k][0],
                "high": bounds[k][1],
                "first": float(found["S1"][k]),
                "first_95": float(found["S1_conf"][k]),
                "total": float(found["ST"][k]),
                "total_95": float(found["ST_conf"][k]),
                "standard_deviation": float(np.std(values)),
                "samples": len(values),
                "samples_without_result": int(missing.sum()),
            }


def _ends(value: float, given: float | tuple[float, float]) -> tuple[float, float]:
    return given if isinstance(given, tuple) else (value * (1 - given), value * (1 + given))


def draw(solved: Sequence[Solved], table: pd.DataFrame) -> dict[str, "Figure"]:
    """One figure; drawing stands apart."""
    from workflow.analyses.sensitivity import figures

    return {"sensitivity": figures.draw(table)}
