"""Scenes with made-up solutions: forces of Eq. (1), so that every number can be worked out."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from geometry.muscle import Braid, Muscle
from solver import net, record
from solver.case import Case
from solver.load_path import LoadPath
from solver.material import Thread
from solver.rubber.mooney_rivlin.law import MooneyRivlin
from solver.status import StateStatus
from workflow.data.records import Curve
from workflow.data.scene_data import SceneData
from workflow.data.states import Table
from workflow.plan.plan import Place, plan
from workflow.study.contents import StudiedMuscle
from workflow.study.study import load

KNOCKED_DOWN = 0.8  # force of the made-up finite elements over that of Eq. (1)
SECTION = {  # two triangles: a wall from R = 10 to 12 and Z = 0 to 150, not deformed
    "corners": np.array(
        [[r, z, r, z] for r, z in [(10, 0), (12, 0), (12, 150), (10, 0), (12, 150), (10, 150)]],
        float,
    ),
    "stress": np.array(
        [
            [-0.3, 0, 0.5, 1.0],
            [0, 0, 0.5, 0.9],
            [0, 0, -0.2, -0.1],
            [-0.3, 0, 0.5, 1.0],
            [0, 0, -0.2, -0.1],
            [-0.3, 0, -0.2, -0.1],
        ]
    ),
}


def solve(case: Case) -> record.Solution:
    """What Eq. (1) says of a case; less, with an inflated diameter and fields, for other models."""
    plain = replace(case, model="geometric", fields_at=())
    solution = net.solve(plain)
    states = dict(solution.states)
    if case.model != "geometric":
        states["force"] = KNOCKED_DOWN * states["force"]
    pressure = np.where(states["pressure"] > 0, states["pressure"], np.nan)
    size = np.sqrt(4 * abs(states["force"]) / (np.pi * pressure))
    states["equivalent_diameter"] = np.sign(states["force"]) * size
    fields = {case.path.stops.index(stop): SECTION for stop in case.fields_at}
    return replace(solution, states=states, fields=fields)


@pytest.fixture
def fail():
    """Gives a solution in which some states have another status."""

    def with_status(solution: record.Solution, status: StateStatus, *numbers: int):
        each = list(solution.state_status)
        for number in numbers:
            each[number] = status
        return replace(solution, state_status=each)

    return with_status


@pytest.fixture(scope="session")
def study_plan():
    return plan(load("config/config.yaml"))


@pytest.fixture
def scene_data(study_plan, tmp_path):
    """The data of a scene of the study, from records of made-up solutions."""

    def read(scene: str, spoil=lambda case, solution: solution) -> SceneData:
        for key in set(study_plan.scenes.get(scene, {}).values()):
            case = study_plan.cases[key].case
            record.write(tmp_path / f"{key}.h5", case, spoil(case, solve(case)))
        return SceneData.read(study_plan, scene, tmp_path)

    return read


@pytest.fixture
def small_scene():
    """A scene of one curve, free of the study: 5 stops from 0 to 20 % at 0.3 MPa."""

    def build(spoil=lambda solution: solution, models=("solid",)) -> SimpleNamespace:
        muscle = Muscle(
            inner_diameter=20,
            wall_thickness=2,
            length=300,
            braid=Braid(lead=144, threads=60, layer_diameters=(20.6, 21.8)),
        )
        stops = (0.0, 0.05, 0.1, 0.15, 0.2)
        path = LoadPath(kind="isobaric", held=0.3, stops=stops)
        rubber, thread = MooneyRivlin(c10=0.345083, c01=0.083805), Thread(stiffness=315)
        of_muscle = StudiedMuscle(muscle=muscle, material="nbr", rubber=rubber, thread=thread)
        studied = {"dmsp20": of_muscle}
        solved = []
        for model in models:
            case = Case(
                muscle=muscle,
                rubber=rubber,
                thread=thread,
                path=path,
                model=model,
            )
            place = Place("isobaric", "dmsp20", model, "default", 0.3)
            solved.append(Curve(case, spoil(solve(case)), stops, place))
        return SimpleNamespace(
            name="small",
            scene=SimpleNamespace(path="isobaric", held=(0.3,), swept=stops, quantities=()),
            curves=solved,
            table=Table.of(solved, studied),
            studied=studied,
            muscles={"dmsp20": muscle},
            materials={"dmsp20": "nbr"},
        )

    return build
