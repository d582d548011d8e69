"""Hard cases: which cases it asks for, and what its table says of synthetic solutions."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from solver.record import Solution, unreached
from solver.status import CaseStatus, StateStatus
from workflow.analyses.analysis import AnalysisCase, Solved
from workflow.analyses.robustness import cases
from workflow.analyses.robustness import table as tables
from workflow.study.study import load

CONFIG = Path(__file__).parents[3] / "config" / "config.yaml"


@pytest.fixture(scope="module")
def asked() -> list[AnalysisCase]:
    return cases.cases(load(CONFIG))


def of(asked: list[AnalysisCase], **tags: object) -> list[AnalysisCase]:
    return [a for a in asked if tags.items() <= (a.tags | {"model": a.case.model}).items()]


def test_every_named_case_has_three_meshes_and_a_membrane(asked):
    names = {a.tags["name"] for a in of(asked, set="named")}
    assert len(names) == 5 + 9 + 4 + 3 + 2 + 2 + 5 + 2
    for name in names:
        meshes = [a.tags["mesh"] for a in of(asked, set="named", name=name, model="solid")]
        assert sorted(meshes) == [1, 2, 3]
        assert len(of(asked, set="named", name=name, model="membrane")) == 1


def test_named_cases_run_from_minus_5_to_25_percent(asked):
    for case in (a.case for a in of(asked, set="named")):
        assert case.path.stops[0] == -0.05
        assert case.path.stops[-1] == 0.25
        assert np.diff(case.path.stops) == pytest.approx(0.01)


def test_hypercube_is_the_same_every_time_and_large_enough(asked):
    again = cases.cases(load(CONFIG))
    assert [a.case.key for a in asked] == [a.case.key for a in again]
    assert len(of(asked, set="hypercube", model="solid", mesh=1)) == 200
    assert len(of(asked, set="hypercube", model="solid", mesh=2)) == 20


def test_twenty_random_muscles_go_through_a_cycle(asked):
    """To half of what the net could contract by, and back; nothing else has a memory."""
    cycles = of(asked, set="cycle")
    assert len(cycles) == 20
    for one in cycles:
        path, braid = one.case.path, one.case.muscle.braid
        assert one.case.remembers
        assert path.stops[0] == path.stops[-1] == 0
        assert 0.02 < max(path.stops) < 1 - 1 / (np.sqrt(3) * np.cos(braid.angle))
    assert not any(one.case.remembers for one in asked if one not in cycles)


def test_hypercube_fills_its_limits(asked):
    muscles = [a.case.muscle for a in of(asked, set="hypercube", model="solid", mesh=1)]
    for values, (low, high) in (
        ([m.inner_diameter for m in muscles], (8, 50)),
        ([m.wall_thickness / m.inner_diameter for m in muscles], (0.04, 0.2)),
        ([m.length / m.inner_diameter for m in muscles], (3, 30)),
        ([np.degrees(m.braid.angle) for m in muscles], (12, 52)),
    ):
        assert low <= min(values) < low + 0.05 * (high - low)
        assert high - 0.05 * (high - low) < max(values) <= high


def test_threads_of_the_hypercube_are_no_closer_than_their_diameter(asked):
    for case in (a.case for a in of(asked, set="hypercube")):
        braid, stiffness = case.muscle.braid, case.thread.stiffness
        gap = np.pi * braid.layer_diameters[0] * np.cos(braid.angle) / braid.threads
        assert gap > np.sqrt(4 * stiffness / (2100 * np.pi))


def test_any_muscles_fill_their_limits(asked):
    """200 tubes in sleeves, of five laws, from 1 mm of bore, with gaps to 30 % of the radius."""
    found = [a.case for a in of(asked, set="any muscle", model="solid", mesh=1)]
    assert len(found) == 200
    assert len(of(asked, set="any muscle", model="membrane")) == 200
    assert len(of(asked, set="any muscle", model="solid", mesh=2)) == 20
    bores = [case.muscle.inner_diameter for case in found]
    gaps = [case.muscle.layers[0].radius / case.muscle.outer_radius - 1 for case in found]
    assert 1 <= min(bores) < 1.1
    assert 0 <= min(gaps) < 0.01
    assert 0.29 < max(gaps) < 0.3
    laws = Counter(case.rubber.law() for case in found)
    assert len(laws) == 5
    assert min(laws.values()) > 20
    for case in found:
        layer, pressure = case.muscle.layers[0], case.path.held
        if case.path.kind != "isobaric":
            pressure = case.path.stops[-1]
        angle = np.arctan(layer.tangent)
        around = layer.threads * case.thread.stiffness * np.sin(angle) ** 2
        around /= np.pi * layer.radius * np.cos(angle)  # per strain
        assert pressure * layer.radius < 0.1001 * around


def test_the_gap_of_a_sleeve_is_in_the_table(asked):
    one = of(asked, set="any muscle", model="solid", mesh=1)[0]
    row = tables.table([solved(one, np.ones(one.case.path.states))]).iloc[0]
    assert row["gap"] == pytest.approx(
        one.case.muscle.layers[0].radius / one.case.muscle.outer_radius - 1
    )
    assert row["rubber"] == one.case.rubber.law()


def solved(asked: AnalysisCase, force: np.ndarray) -> Solved:
    states = unreached(asked.case.path.states)
    reached = np.isfinite(force)
    states["force"] = force
    for name in ("min_det_f", "min_det_f_nodes", "margin"):
        states[name] = np.where(reached, 0.9, np.nan)
    states["iterations"] = np.where(reached, 3.0, np.nan)
    status = [StateStatus.CONVERGED if r else StateStatus.NOT_REACHED for r in reached]
    case = CaseStatus.CONVERGED if reached.all() else CaseStatus.STALLED
    return Solved(asked, Solution(status=case, reason="", states=states, state_status=status))


@pytest.fixture
def table(asked) -> pd.DataFrame:
    """Forces that fall from 1000 to 0 N; mesh 1 is 5 N off, the membrane 20 N and ends early."""
    falling = np.linspace(1000, 0, 31)
    family = of(asked, set="named", name="p 0.3 MPa")
    shifts = {("solid", 1): 5.0, ("solid", 2): 1.0, ("solid", 3): 0.0, ("membrane", 3): -20.0}
    entries = []
    for a in family:
        force = falling + shifts[a.case.model, a.tags["mesh"]]
        if a.case.model == "membrane":
            force[25:] = np.nan
        entries.append(solved(a, force))
    return tables.table(entries)


def test_differences_are_shares_of_the_largest_force_of_the_finest_mesh(table):
    by = table.set_index(["model", "mesh"])
    assert by.loc[("solid", 1), "difference"] == pytest.approx(0.005)
    assert by.loc[("solid", 2), "difference"] == pytest.approx(0.001)
    assert by.loc[("membrane", 3), "difference"] == pytest.approx(0.02)
    assert np.isnan(by.loc[("solid", 3), "difference"])
    assert by.loc[("solid", 3), "against"] == ""


def test_a_membrane_far_from_its_solid_says_why(asked):
    fine = of(asked, set="named", name="p 0.3 MPa", model="solid", mesh=3)[0]
    membrane = of(asked, set="named", name="p 0.3 MPa", model="membrane")[0]
    force = np.linspace(1000, 0, 31)
    for where, cause in ((0, "drawn out"), (20, "ends bend"), (None, "")):
        ours = force.copy()
        if where is not None:
            ours[where] += 50
        rows = tables.table([solved(fine, force), solved(membrane, ours)]).set_index("model")
        assert rows.loc["membrane", "cause"].startswith(cause)
        assert bool(rows.loc["membrane", "cause"]) == bool(cause)
        assert rows.loc["solid", "cause"] == ""


def test_notes_are_what_ended_early_or_is_far_apart(table):
    noted = tables.notes(table)
    assert set(zip(noted["model"], noted["mesh"], strict=True)) == {("solid", 1)}  # 0.5 % apart
    table.loc[table["model"] == "membrane", "cause"] = "ends bend"
    table.loc[table["mesh"] == 2, "status"] = "limit_point"
    noted = tables.notes(table)
    assert list(noted["model"]) == ["solid", "solid", "membrane"]


def test_states_that_are_missing_are_counted_and_not_compared(table):
    membrane = table.set_index("model").loc["membrane"]
    assert membrane["states reached"] == 25
    assert membrane["status"] == "stalled"
    assert membrane["difference at"] <= 0.19


def test_an_invalid_state_is_not_compared(asked):
    fine, coarse = of(asked, set="named", name="p 0.3 MPa", model="solid")[::2][::-1]
    good, bad = solved(fine, np.full(31, 100.0)), solved(coarse, np.full(31, 100.0))
    bad.solution.states["force"][7] = 1e6
    status = list(bad.solution.state_status)
    status[7] = StateStatus.INVALID_STATE
    bad = replace(bad, solution=replace(bad.solution, state_status=status))
    row = tables.table([good, bad]).set_index("mesh").loc[1]
    assert row["difference"] == 0
    assert row["invalid states"] == 1
