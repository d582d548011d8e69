"""The cases of the scorecard, and the summary of a stress."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from solver.material import Thread
from solver.rubber.mooney_rivlin.law import MooneyRivlin
from workflow.analyses.claims import cases
from workflow.analyses.claims.stress import summary
from workflow.plan.plan import plan
from workflow.study.errors import StudyError
from workflow.study.study import load

STUDY = load(Path(__file__).parents[4] / "config/config.yaml")


def test_the_study_has_its_own_cases_and_the_fast_ones_with_other_threads():
    found = cases.cases(STUDY)
    own = {case.case.key for case in found if case.own and case.place}
    assert own <= set(plan(STUDY).cases)
    for ea in (50, 150, 315, 594, 650):
        stressed = [c for c in found if c.stiffness == ea and c.case.fields_at]
        assert {c.place.held for c in stressed} == {0.2, 0.3, 0.4}
    others = [case for case in found if not case.own]
    assert {case.stiffness for case in others} == {50, 150, 594, 650}
    for case in others:
        assert case.case.model in ("geometric", "membrane") or case.case.fields_at
        if case.case.model != "geometric":
            assert case.case.thread.stiffness == case.stiffness
    per_stiffness = {sum(c.stiffness == ea for c in others) for ea in (50, 150, 594, 650)}
    assert len(per_stiffness) == 1


def test_claims_are_of_the_papers_muscle_alone():
    """Whatever a study calls it; its threads may have any stiffness."""
    papers = STUDY.muscles["dmsp20"]

    def named_so(**changes):
        return replace(STUDY, muscles=STUDY.muscles | {"dmsp20": replace(papers, **changes)})

    with pytest.raises(StudyError, match="another size, braid or rubber"):
        cases.cases(named_so(muscle=replace(papers.muscle, length=200)))
    with pytest.raises(StudyError, match="another size, braid or rubber"):
        cases.cases(named_so(rubber=MooneyRivlin(c10=0.3, c01=0.1)))
    assert cases.cases(named_so(thread=Thread(stiffness=400)))


def test_single_threads_are_asked_for_silicone_of_all_walls():
    cells = [case for case in cases.cases(STUDY) if not case.place]
    assert {c.case.muscle.wall_thickness for c in cells} == {1.5, 2, 2.5, 3}
    assert {c.case.effects.layers for c in cells} == {"discrete", "smeared"}
    assert all(c.own and c.case.model == "cell" for c in cells)


def triangles(stress_of):
    """Two rows of triangles: mid-length to 100 mm, and 100 mm to the cap at 150 mm."""
    rows = []
    for low, high in ((0, 100), (100, 150)):
        for corners in (((10, low), (12, low), (10, high)), ((12, low), (12, high), (10, high))):
            rows += [(r, z, r, z) for r, z in corners]
    corners = np.array(rows, dtype=float)
    hoop = np.array([stress_of(r, z) for r, z, *_ in rows])
    stress = np.column_stack([hoop - 1, 0 * hoop, hoop - 2, hoop])  # rr, rz, zz, hoop
    return {"corners": corners, "stress": stress}


def test_a_stress_is_summed_up_by_part():
    fields = triangles(lambda r, z: 1.0 if z < 120 else -0.5)
    cylinder, arc, mean, compressed = summary(fields, 20.0, 300.0)
    assert cylinder == 1.0
    assert arc == -0.5
    assert mean == pytest.approx(-0.5)
    assert compressed == 1.0
    assert summary(triangles(lambda r, z: 2.0), 20.0, 300.0).tolist() == [2, 2, 2, 0]
