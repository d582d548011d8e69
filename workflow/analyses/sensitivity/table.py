"""The table of sensitivities: local differences, and Sobol's indices by the cylinder."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from solver.models.cylinder.mechanics import Cylinder, State
from workflow.analyses.analysis import Solved
from workflow.analyses.sensitivity.cases import CHECK, STEP, Normal, neighbours
from workflow.data.states import GOOD
from workflow.study.contents import Study

SEED, SAMPLES = 20260101, 128  # base samples, a power of two; SALib runs SAMPLES * (inputs + 2)
RADII = (0.8, 4.0)  # in initial inner radii: where the radius at a pressure is sought
SHORTEST = 0.5  # axial stretch, lower end of the search for the free contraction
Ranges = Mapping[str, float | tuple[float, float]]
OUTPUTS = ("force", "threshold_pressure", "free_contraction")  # force at both that are given
UNCERTAIN: Ranges = {  # what is not known of the paper's muscle: share of its value, or ends
    "thread_stiffness": (50.0, 650.0),  # N
    "c10": 0.2,
    "c01": 0.2,
    "inner_layer": 0.01,  # 0.1 mm
    "outer_layer": 0.01,
    "wall_thickness": 0.05,  # 0.1 mm
    "lead": 0.04,  # a tenth of a millimetre between threads
}
# of Table 1 of the paper; contraction without its ends, at which threshold or force vanish
DESIGN: Ranges = {
    "contraction": (0.05, 0.15),
    "pressure": (0.2, 0.4),  # MPa
    "inner_diameter": (20.0, 40.0),  # mm
    "wall_thickness": (1.5, 3.0),  # mm
    "lead": (144.0, 216.0),  # mm: 24.8 to 17.1 degrees
    "nbr": (0.0, 1.0),  # share of NBR between silicone and NBR
}
ANALYSES = {"what is not known": UNCERTAIN, "factors of Table 1": DESIGN}


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """One row per analysis, model, input and output."""
    return {"sensitivity": table(Normal.of(study), solved)}


def outputs(isobaric: pd.DataFrame, isometric: pd.DataFrame) -> dict[str, float]:
    """The results of the states of both cases, NaN where one is not valid."""
    (at_stop, free), (_, threshold) = (
        rows.where(rows["status"] == GOOD).to_dict("records") for rows in (isobaric, isometric)
    )
    return {
        "force": at_stop["force"],
        "threshold_pressure": threshold["pressure"],
        "free_contraction": free["contraction"],
    }


def table(normal: Normal, solved: Sequence[Solved]) -> pd.DataFrame:
    """One row per analysis, model, input and output."""
    by_model: dict[str, dict[tuple[str, int], dict[str, float]]] = {"cylinder": {}, CHECK: {}}
    for name, way, changes in neighbours(normal):
        by_model["cylinder"][name, way] = _by_cylinder(normal, changes)
        found = [s for s in solved if (s.asked.tags["input"], s.asked.tags["way"]) == (name, way)]
        by_model[CHECK][name, way] = outputs(*(s.states for s in found))
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
    if found["force"] > 0:  # it has a threshold below this pressure, and contracts further
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
