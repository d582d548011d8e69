"""First guesses of effects: of the table, up to date, silent where nothing is known."""

import csv
from dataclasses import replace
from math import isfinite

import numpy as np
import pytest

from solver.effects import EFFECTS
from solver.load_path import LoadPath
from solver.material import Thread
from workflow.analyses.analysis import Solved
from workflow.analyses.like_effects import table
from workflow.analyses.like_effects.cases import COUNT, PAIRS, cases
from workflow.plan import like_effects
from workflow.plan.judged import FOLLOWS

AGAIN = "out of date: run snakemake like_effects, then .venv/bin/muscle likeness --effects"
PATH = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.05, 0.1, 0.15, 0.2))
FIRST = 2  # curves that are solved again


@pytest.fixture(scope="module")
def rows():
    with like_effects.FILE.open(newline="") as stream:
        return list(csv.DictReader(line for line in stream if not line.startswith("#")))


def test_the_table_has_every_effect_but_single_threads(rows):
    assert {row["effect"] for row in rows} == set(PAIRS) == set(EFFECTS) - {"discrete_threads"}
    curves = {row["curve"] for row in rows if row["effect"] == "end_caps"}
    assert len(curves) == COUNT


def test_the_table_is_up_to_date(rows, solve_case):
    """What is quick to solve is solved again."""
    quick = [
        Solved(asked, solve_case(asked.case))
        for asked in cases(None)
        if asked.tags["curve"] < FIRST and asked.case.model == "cylinder"
    ]
    found = table.tables(None, quick)["like_effects"]
    assert set(found["effect"]) >= {"rubber", "thread_stretch", "twist"}
    known = {(row["curve"], row["effect"]): row for row in rows}
    for _, now in found.iterrows():
        row = known[str(now["curve"]), now["effect"]]
        for name in (FOLLOWS, "volume"):
            if isfinite(now[name]):
                assert float(row[name]) == pytest.approx(now[name], rel=0.02, abs=1e-9), AGAIN


@pytest.mark.parametrize("effect", [e for e in PAIRS if e != "twist"])
def test_what_is_said_holds_for_the_muscles_of_the_table(effect):
    """As shares of them, each left out of the fit in its turn."""
    law = like_effects._law(effect, FOLLOWS)
    share = np.mean(law.spread <= law.quantile(like_effects.COVERAGE))
    assert share >= like_effects.COVERAGE


def test_the_paper_s_muscle_is_guessed_as_it_was_measured(make_case):
    """No muscle of the table: caps change its force by 3.8 %, the stretch of threads by 27 %."""
    case = make_case(path=LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.05, 0.1, 0.15)))
    for effect, true in (("end_caps", 0.038), ("thread_stretch", 0.27), ("wall_thickness", 0.032)):
        found = like_effects.guess(case, effect)
        assert true / 3 < found.median < 3 * true
        assert true <= found.high
        assert found.count >= like_effects.FEWEST


def test_where_nothing_is_known_nothing_is_said(make_case, bare_tube):
    case = make_case(path=PATH)
    assert like_effects.guess(case, "discrete_threads") is None
    assert like_effects.guess(case, "end_caps", (FOLLOWS, "zero_force")) is None
    weak = replace(case, thread=Thread(stiffness=2.0))
    tube = make_case(model="solid", muscle=bare_tube, path=PATH)
    for of in (weak, tube):
        assert all(like_effects.guess(of, effect) is None for effect in PAIRS)
