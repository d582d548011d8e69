"""Effects on muscles of all kinds: what is solved, what is compared, and what is taken over."""

import csv

import numpy as np
import pytest

from solver.record import unreached
from workflow.analyses.analysis import Solved
from workflow.analyses.like_effects import table
from workflow.analyses.like_effects.cases import COUNT, PAIRS, cases
from workflow.analyses.like_effects.take_over import take_over
from workflow.study.errors import StudyError

from ..synthetic import converged


@pytest.fixture(scope="module")
def asked():
    return cases(None)


@pytest.fixture
def solved(asked):
    """Two curves, of a braid in the wall and of a sleeve; without slackening all is 2 % off."""

    def made(each):
        count = each.case.path.states
        off = 0.02 * (each.tags["setup"] == "solid, two-way")
        states = {name: np.linspace(1, 0.5, count) + off for name in NAMES}
        return Solved(each, converged(unreached(count) | states))

    return [made(each) for each in asked if each.tags["curve"] in (0, 3)]


NAMES = ("force", "contraction", "inner_diameter_inflated", "outer_diameter", "volume")


def test_what_a_braid_cannot_have_is_not_asked(asked):
    by_setup = {name: sum(each.tags["setup"] == name for each in asked) for name in SETUPS}
    embedded = COUNT // 2 + 1  # 57 of 112, as the sleeves are every other three
    assert all(
        count in (COUNT, embedded, embedded - 1, embedded - 2) for count in by_setup.values()
    )
    assert by_setup["solid, two-way"] == by_setup["membrane, one radius"] < COUNT
    assert len({each.key for each in asked}) == len(asked)


SETUPS = {name for pair in PAIRS.values() for name in pair}


def test_changes_are_shares_of_the_largest_value(solved):
    rows = table.tables(None, solved)["like_effects"].set_index(["curve", "effect"])
    assert rows.loc[(0, "slackening"), "follows"] == pytest.approx(0.02)
    assert rows.loc[(0, "slackening"), "volume"] == pytest.approx(0.02)
    assert rows.loc[(0, "end_caps"), "follows"] == 0
    assert (3, "slackening") not in rows.index
    assert (3, "wall_thickness") not in rows.index
    assert (3, "end_caps") in rows.index


def test_lost_states_are_counted(solved):
    for one in solved:
        if one.asked.tags["setup"] == "cylinder":
            one.solution.state_status[0] = "invalid_state"
    rows = table.tables(None, solved)["like_effects"].set_index(["curve", "effect"])
    assert rows.loc[(0, "end_caps"), "lost"] == 1
    assert rows.loc[(0, "end_caps"), "states"] == 9


def test_the_table_is_taken_over_with_few_digits(tmp_path, solved):
    with pytest.raises(StudyError, match="run snakemake like_effects"):
        take_over(tmp_path)
    table.tables(None, solved)["like_effects"].to_csv(tmp_path / "like_effects.csv", index=False)
    take_over(tmp_path, tmp_path / "taken.csv")
    first, *lines = (tmp_path / "taken.csv").read_text().splitlines()
    assert first.startswith("# analysis of effects on like muscles of 20")
    rows = list(csv.DictReader(lines))
    assert {row["effect"] for row in rows} == set(PAIRS)
    assert all(len(row["pressure"]) <= 8 for row in rows)
