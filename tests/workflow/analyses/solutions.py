"""Solutions of an analysis' cases without a solver: smooth, and told apart by key and mesh."""

import numpy as np

from solver.case import DYNAMIC
from solver.record import unreached
from workflow.analyses.analysis import Solved

from ..synthetic import converged

OF_MODEL = {"solid": 1.0, "membrane": 1.004, "cylinder": 1.03, "cell": 1.02, "geometric": 1.3}
WALL = {  # two triangles: a wall from R = 10 to 12 and Z = 0 to 30, a little deformed
    "corners": np.array(
        [
            [r, z, 1.1 * r, 0.9 * z]
            for r, z in ((10, 0), (12, 0), (12, 30), (10, 0), (12, 30), (10, 30))
        ]
    ),
    "stress": np.array([[0.3, 0.1, -0.2, 0.4]] * 3 + [[-0.1, 0, 0.2, -0.4]] * 3),
}


def made_up(asked):
    """Converged, with forces that fall with the contraction and change their sign on the way."""
    case, path = asked.case, asked.case.path
    chance = np.random.default_rng(int(case.key[:8], 16))
    count = path.states
    last = [float("nan")] * (count - len(path.stops))
    swept = np.array([*path.stops, *last])
    held = np.full(count, path.held)
    contraction = {"isobaric": swept, "isometric": held, "isotonic": 0.4 * swept}[path.kind]
    pressure = held if path.kind == "isobaric" else swept
    if last:  # the state of zero force
        contraction = np.where(np.isnan(contraction), 0.24, contraction)
        pressure = np.where(np.isnan(pressure), 0.1, pressure)
    mesh = max(
        getattr(getattr(case.numerics, part), "refinement", 1) for part in ("section", "meridian")
    )
    off = 1 + 0.003 * mesh**-3.0 * (case.model in ("solid", "membrane"))
    states = {name: np.ones(count) for name in unreached(count)}
    states |= {
        "contraction": contraction,
        "pressure": pressure,
        "force": 2400 * pressure * (1 - 5 * contraction) * OF_MODEL.get(case.model, 1.1) * off
        + 0.01 * chance.normal(),
        "inner_diameter_inflated": (20 + 40 * contraction + 5 * np.tanh(9 * pressure)) * off,
        "min_det_f": np.full(count, chance.uniform(0.3, 0.95)),
        "min_det_f_nodes": np.full(count, chance.uniform(-0.4, 0.9)),
        "stiffness": np.full(count, 10.0),
        "iterations": np.full(count, chance.integers(2, 9)).astype(float),
        "cutbacks": np.full(count, chance.integers(0, 2)).astype(float),
    }
    if path.history is not None:
        states |= {"time": np.array(path.history.times), "work": np.linspace(0, 1e4, count)}
        states |= {"dissipated": np.linspace(0, 900, count), "energy": np.ones(count)}
        states["force"] = states["force"] + np.where(np.gradient(swept) < 0, 8.0, 0.0)
    if case.frequencies:
        answers = [[f, 10 + np.log10(f), 0.2] for f in case.frequencies]
        return Solved(asked, converged(states, fields={0: {DYNAMIC: np.array(answers)}}))
    fields = {path.stops.index(stop): WALL for stop in case.fields_at if case.model == "solid"}
    return Solved(asked, converged(states, fields=fields, unknowns=1000 * mesh**2))
