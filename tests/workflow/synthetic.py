"""Studies and records without a solver."""

import numpy as np

from solver import record
from solver.record import VARIABLES, Solution
from solver.status import CaseStatus, StateStatus
from workflow.plan.plan import plan
from workflow.study.study import load

MUSCLE = """\
materials:
  nbr: {c10: 0.345083, c01: 0.083805}
muscles:
  one:
    inner_diameter: 20
    wall_thickness: 2
    length: 300
    layer_depths: [0.3, 0.9]
    threads: 60
    lead: 144
    thread_stiffness: 315
    material: nbr
"""  # how most studies of the tests begin
STUDY = f"""\
{MUSCLE}\
    reference: [festo_musclesim, martens2017]
  bare: {{base: one, threads: none}}
variants:
  paper: {{effects: {{end: butt, threads: two_way}}}}
scenes:
  curves:
    path: isobaric
    muscles: [one]
    pressure: [0.2, 0.3]
    contraction: {{from: 0, to: 0.1, step: 0.01}}
    models: [membrane, solid]
  few:
    path: isobaric
    muscles: [one, bare]
    pressure: [0.3]
    contraction: [0.05, 0.2]
    models: [solid]
    variants: [default, paper]
  threshold:
    path: isometric
    muscles: [one]
    contraction: [0.1]
    pressure: [0.1, 0.2]
    models: [geometric, solid]
    quantities: [threshold_pressure]
  loads:
    path: isotonic
    muscles: [one]
    load: [100, 200]
    pressure: [0.2, 0.3]
    models: [membrane]
"""


def planned(folder, text=STUDY):
    path = folder / "study.yaml"
    path.write_text(text)
    return plan(load(path))


def value(key, variable, state):
    """A number that says where it is from: case, variable and state; stretches are below 1."""
    number = int(key[:8], 16) + list(VARIABLES).index(variable) / 64 + state / 4096
    return number / 2**33 if "stretch" in variable else number


def converged(states, **others):
    """A solution in all of whose states there is an equilibrium; ``others`` are said otherwise."""
    count = len(next(iter(states.values())))
    usual = {"status": CaseStatus.CONVERGED, "reason": "", "states": states}
    return Solution(**usual | {"state_status": [StateStatus.CONVERGED] * count} | others)


def write_records(found, folder, failed=()):
    """Records of all cases; of those that failed only the first two states are reached."""
    folder.mkdir(exist_ok=True)
    for key, planned_case in found.cases.items():
        count = planned_case.case.path.states
        reached = 2 if key in failed else count
        states = {
            name: np.array([value(key, name, k) if k < reached else np.nan for k in range(count)])
            for name in VARIABLES
        }
        status = [
            StateStatus.CONVERGED if k < reached else StateStatus.NOT_REACHED for k in range(count)
        ]
        stalled = {"status": CaseStatus.STALLED, "reason": "no step\nworked, at all"}
        others = stalled if key in failed else {}
        solution = converged(states, state_status=status, **others)
        record.write(folder / f"{key}.h5", planned_case.case, solution)
