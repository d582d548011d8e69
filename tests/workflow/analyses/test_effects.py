"""The analysis of effects: its cases, and how changes and savings are read from solutions."""

import json
from pathlib import Path

import numpy as np
import pytest

from solver.record import unreached
from solver.status import StateStatus
from workflow.analyses.analysis import Solved
from workflow.analyses.effects import weigh
from workflow.analyses.effects.cases import REGIMES, SETUPS, cases
from workflow.analyses.effects.table import SWITCHES, table
from workflow.plan import effect_costs, effect_states
from workflow.study.study import load

from ..synthetic import converged

STUDY = Path(__file__).parents[3] / "config/config.yaml"


@pytest.fixture(scope="module")
def asked():
    return cases(load(STUDY))


def test_every_setup_runs_in_every_regime_on_every_path(asked):
    cells = {name for name, setup in SETUPS.items() if setup.model == "cell"}
    assert len(asked) == len(REGIMES) * (3 * len(SETUPS.keys() - cells) + len(cells))
    assert {setup for pair in SWITCHES.values() for setup in pair} == set(SETUPS)


@pytest.mark.parametrize("effect", SWITCHES)
def test_a_pair_differs_in_one_thing(effect):
    """In the model, in one switch, or in the mesh."""
    on, off = (SETUPS[name] for name in SWITCHES[effect])
    moved = [name for name in vars(on.effects) if vars(on.effects)[name] != vars(off.effects)[name]]
    differences = [*moved, *["model"] * (on.model != off.model)]
    differences += ["mesh"] * (on.mesh != off.mesh)
    assert len(differences) == 1


def solved(entry, force, lost=0):
    """A solution with forces of its own; the last few states are not reached."""
    states = unreached(entry.case.path.states)
    for values in states.values():
        values[:] = 1.0
    stops = len(entry.case.path.stops)
    states["force"][:stops] = force * np.linspace(1, 0.2, stops)
    status = [StateStatus.CONVERGED] * entry.case.path.states
    for k in range(stops - lost, stops):
        status[k] = StateStatus.NOT_REACHED
    return Solved(entry, converged(states, state_status=status, unknowns=10))


def test_changes_and_savings(asked):
    normal = [a for a in asked if (a.tags["regime"], a.tags["path"]) == ("normal", "isobaric")]
    forces = {"solid": 100.0, "membrane": 98.0}
    rows = table(
        [
            solved(a, forces.get(a.tags["setup"], 50.0), lost=2 * (a.tags["setup"] == "membrane"))
            for a in normal
        ]
    ).set_index("effect")
    assert rows.loc["cap_geometry", "force"] == pytest.approx(0.02)
    assert rows.loc["cap_geometry", "missing"] == 2
    assert rows.loc["cap_geometry", "largest"] == 100
    assert rows.loc["end_caps", "force"] == pytest.approx(48 / 98, abs=1e-4)
    assert rows.loc["end_caps", "missing"] == 0
    assert rows.loc["cap_geometry", "work_with"] == 10 * 7
    assert np.isnan(rows.loc["cap_geometry", "contraction"])
    assert np.isnan(rows.loc["cap_geometry", "threshold"])


def test_what_was_weighed_comes_back_to_the_planner(asked, tmp_path, monkeypatch):
    normal = [a for a in asked if (a.tags["regime"], a.tags["path"]) == ("normal", "isobaric")]
    forces = {"solid": 100.0, "membrane": 98.0}
    by_key = {a.case.key: solved(a, forces.get(a.tags["setup"], 50.0)) for a in normal}
    monkeypatch.setattr(weigh.analysis, "cases", lambda *_: normal)
    monkeypatch.setattr(
        weigh.records, "read_one", lambda key, _: (by_key[key].asked.case, by_key[key].solution)
    )
    for key in by_key:
        cost = {"python_cpu_seconds": 0.5, "freefem_cpu_seconds": 1.0}
        (tmp_path / f"{key}.json").write_text(json.dumps(cost))
    states = tmp_path / "states.csv"
    weigh.measure("", costs=tmp_path, file=tmp_path / "found.csv", of_states=states)
    known = effect_costs.load(tmp_path / "found.csv")["normal", "isobaric", "cap_geometry"]
    assert (known.force, known.seconds_with) == (pytest.approx(0.02), 1.5)
    assert "analysis of effects of 20" in effect_costs.origin(tmp_path / "found.csv")
    name = "cap_geometry"
    first, later = (effect_states.at(normal[0].case, at, [name], states) for at in (0.01, 0.06))
    assert first["normal", "isobaric", name].force == pytest.approx(0.02)  # at 0
    assert later["normal", "isobaric", name].force == pytest.approx(0.02 * 22 / 30, abs=1e-5)  # 5 %
    assert later["normal", "isometric", name] == effect_costs.load()["normal", "isometric", name]
    assert effect_states.at(normal[0].case, 0.2, [name], states) is None
    assert effect_states.at(normal[0].case, 0.06, ["twist"], states) is None
