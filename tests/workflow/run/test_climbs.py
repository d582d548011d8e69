"""Climbs inside a batch: what they leave, what they find again, and what stands in its place."""

import json
import re
from math import isnan
from pathlib import Path

import pytest

from solver.effects import EFFECTS
from solver.freefem import Limits
from workflow.analyses.ladder import take_over
from workflow.data import dataset, records, settled
from workflow.plan.explain import lines
from workflow.plan.plan import plan
from workflow.run import batches, climbs
from workflow.study.errors import StudyError
from workflow.study.study import load

from ..synthetic import MUSCLE

SCENE = "path: isobaric, muscles: [one], pressure: [0.3], contraction"
STUDY = f"""\
{MUSCLE}\
scenes:
  loose: {{{SCENE}: [0, 0.05, 0.1, 0.15], tolerance: 0.05}}
  tight: {{{SCENE}: [0, 0.05, 0.1, 0.15], tolerance: 0.004}}
  named: {{{SCENE}: [0, 0.1], models: [membrane], errors: measured}}
"""
LIMITS = Limits(wall_time=300, memory=4000)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder in which the study is solved once."""
    place = tmp_path_factory.mktemp("climbs")
    (place / "study.yaml").write_text(STUDY)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        found = planned()
        assert batches.solve(found.cases, 2, LIMITS, Path("log.txt")) == 0
        yield place


def planned():
    return plan(load("study.yaml"))


def outcomes(found):
    scene = {asked.scenes[0]: key for key, asked in found.cases.items() if asked.promise}
    return {name: settled.outcome(key) for name, key in scene.items()}


def test_a_plan_knows_climbs_and_no_model_of_theirs(folder):
    found = planned()
    assert len(found.promises) == 2
    (loose,) = found.scenes["loose"]
    assert loose.variant == "default_within_0.05"
    assert found.cases[found.scenes["loose"][loose]].mesh is None


def test_each_comes_to_a_rung_that_is_proved(folder):
    ends = outcomes(planned())
    assert ends["loose"]["holds"]
    assert ends["loose"]["rung"] == "membrane"
    assert ends["tight"]["holds"]
    assert ends["tight"]["rung"].startswith("solid")
    assert ends["tight"]["error"] <= 0.004
    for end in ends.values():
        assert set(end["seconds"]) <= {path.stem for path in Path("results/cases").iterdir()}
        assert all(seconds > 0 for seconds in end["seconds"].values())


def test_nothing_is_done_again(folder):
    found = planned()
    assert batches.to_solve(found.cases) == {}
    before = batches.stamp(found.cases)
    assert batches.solve(found.cases, 1, LIMITS, Path("again.txt")) == 0
    assert Path("again.txt").read_text() == ""
    assert batches.stamp(found.cases) == before


def test_another_tolerance_finds_what_was_tried(folder):
    Path("other.yaml").write_text(STUDY.replace("tolerance: 0.05", "tolerance: 0.03"))
    found = plan(load("other.yaml"))
    records_before = set(Path("results/cases").iterdir())
    (key,) = batches.to_solve(found.cases)
    assert batches.solve(found.cases, 1, LIMITS, Path("other.txt")) == 0
    assert set(Path("results/cases").iterdir()) == records_before
    assert settled.outcome(key)["tried"] == []


def test_the_dataset_has_the_models_that_were_come_to(folder):
    found = settled.settled(planned())
    assert not found.promises
    curves = records.curves_of_study(found)
    tree = dataset.build(curves, found.study.muscles)
    group = tree["isobaric"].to_dataset()
    assert {"membrane", "solid"} == set(group.model.values)
    chosen = group.sel(muscle="one", model="membrane", pressure=0.3, variant="default_within_0.05")
    assert chosen.force.notnull().sum() == 4
    assert float(chosen.tolerance) == 0.05
    assert 0 < float(chosen.total_error) <= 0.05
    assert str(chosen.total_error_by.values).startswith("estimated from")
    named = group.sel(muscle="one", model="membrane", pressure=0.3, variant="default")
    assert named.tolerance.isnull()
    assert str(named.total_error_by.values) == ""


def test_errors_that_are_measured_say_so(folder):
    found = settled.settled(planned())
    table = dataset.build(records.curves_of_study(found), found.study.muscles)[
        "states"
    ].to_dataset()
    frame = table.to_dataframe()
    by = set(frame["error_by"])
    assert "measured here" in by
    assert any(each.startswith("estimated from") for each in by)
    measured = frame[frame["error_by"] == "measured here"]
    assert (measured["force_error"] > 0).all()
    assert (measured["force_error"] < 1).all()
    assert (measured["volume_error"] > 0).all()


def test_what_a_climb_has_tried_is_the_error_bar_of_its_curve(folder):
    """Without the record, which no rule keeps, it is estimated again."""
    text = STUDY.replace("[0.3]", "[0.05]").replace("tolerance: 0.004", "tolerance: 0.0004")
    Path("low.yaml").write_text(text)  # a pressure that no muscles of the table have
    found = plan(load("low.yaml"))
    assert batches.solve(found.cases, 2, LIMITS, Path("low.txt")) == 0

    def tight():
        curves = records.curves_of_scene(settled.settled(found), "tight")
        return dataset.build(curves, found.study.muscles)["states"].to_dataset().to_dataframe()

    end = settled.outcome(found.scenes["tight"][next(iter(found.scenes["tight"]))])
    assert {end["rung"], "solid, coarser"} < set(end["whole"])
    meshes = settled.settled(found).meshes_by[end["record"]]
    assert any(meshes)
    assert set(tight()["error_by"]) == {"measured here by a coarser mesh"}
    assert (tight()["force_error"] > 0).all()
    for key in filter(None, meshes):
        records.path_of(key).unlink()
    assert set(tight()["error_by"]) == {"estimated from the curves of the paper"}


def test_explain_says_what_was_guessed_and_what_was_measured(folder):
    before = "\n".join(lines(planned()))
    assert "95 % of" in before
    assert "like muscles" in before
    assert "begins on membrane, and climbs until it is proved" in before
    assert "leaves out end_caps, cap_geometry" in before
    after = "\n".join(lines(planned(), settled.outcome))
    assert "membrane is proved" in after
    assert "s of the processor" in after


def test_explain_does_not_blame_the_muscle_for_what_was_not_measured(folder):
    """Muscles of the table are like it, but of free contractions it has no errors."""
    asked = "quantities: [free_contraction], tolerance: 0.05"
    Path("free.yaml").write_text(STUDY.replace("tolerance: 0.05", asked))
    said = "\n".join(lines(plan(load("free.yaml"))))
    loose = said.partition("\nloose: ")[2].partition("\n\n")[0]
    assert "of like muscles the error of free contraction is not known" in loose
    assert "no muscles of the table are like it" not in loose


def test_explain_says_what_effects_are_worth_on_this_muscle(folder):
    """Guessed before, and measured where two records differ by them; each scene on one screen."""
    before, after = (
        "\n".join(lines(planned(), settled.outcome, known))
        for known in (lambda key: None, records.found)
    )
    assert before.count("by leaving one out") == 3
    assert before.count("not measured here") == 3 * len(EFFECTS)
    for effect in EFFECTS:
        said = [line for line in before.splitlines() if re.match(rf"    [> ] {effect} ", line)]
        assert len(said) == 3
        known = [re.search(r"of (\d+) like muscles", line) for line in said]
        assert all(known) if effect != "discrete_threads" else not any(known)
    loose = after.partition("\nloose: ")[2].partition("\n\n")[0]
    together = re.search(r"    +cap_geometry .*measured with compressibility (\S+) %", loose)
    assert 0.05 < float(together[1]) < 1  # of the paper's muscle it is 0.25 %
    assert "membrane against solid" in loose
    named = after.partition("\nnamed: ")[2].partition("\n\n")[0]
    assert f"measured with compressibility {together[1]} %" in named  # by records of the others
    assert re.search(r"discrete_threads +not known of like muscles \(on the paper's muscle", loose)
    assert all(len(scene.splitlines()) <= 45 for scene in after.split("\n\n"))


def test_what_has_not_ended_is_asked_for(folder):
    Path("new.yaml").write_text(STUDY.replace("tolerance: 0.05", "tolerance: 0.2"))
    found = settled.settled(plan(load("new.yaml")))
    (key,) = found.promises
    with pytest.raises(StudyError, match="its climb has not ended"):
        records.taken(found.cases[key])
    assert json.loads(climbs.path_of(next(iter(planned().promises))).read_text())["holds"]


def test_a_variant_keeps_its_name_whatever_that_is(folder, monkeypatch):
    """Also one that looks like a mesh of the planner, or like what stands for a climb."""
    name = "on_a_coarser_or_within_a_finer"
    variants = f"variants: {{{name}: {{effects: {{threads: two_way}}}}}}\nscenes:"
    scene = f"  other: {{{SCENE}: [0, 0.1], tolerance: 0.01, variants: [{name}]}}\n"
    Path("named.yaml").write_text(f"{MUSCLE}{variants}\n{scene}")
    found = plan(load("named.yaml"))
    (place,) = found.scenes["other"]
    assert place.variant == f"{name}_within_0.01"
    for rung, added in (("membrane", ""), ("solid, finer", "_finer")):
        end = {"rung": rung, "holds": True, "error": 0.001, "by": "estimated", "whole": []}
        monkeypatch.setattr(settled, "outcome", lambda _, end=end: end)
        (place,) = settled.settled(found).scenes["other"]
        assert place.variant == name + added


def test_a_record_is_one_though_its_cost_was_never_written(folder):
    """As after a job that was killed between the two: nothing is solved again for it."""
    found = planned()
    key = found.scenes["loose"][next(iter(found.scenes["loose"]))]
    for cost in Path("results/cost").iterdir():
        cost.unlink()
    climbs.path_of(key).unlink()
    assert batches.solve(found.cases, 1, LIMITS, Path("costless.txt")) == 0
    end = settled.outcome(key)
    assert end["tried"] == []
    assert isnan(end["seconds"][end["record"]])
    assert "what that took is not known" in "\n".join(lines(planned(), settled.outcome))
    with pytest.raises(StudyError, match=f"{end['record']}.json: .*snakemake ladder"):
        take_over.cost_of(end["record"])


def test_a_lost_record_or_outcome_is_made_again(folder):
    """Last, since a climb that is done again may come to another rung, of those that are there."""
    found = planned()
    key = found.scenes["loose"][next(iter(found.scenes["loose"]))]
    taken = Path("results/cases") / f"{settled.outcome(key)['record']}.h5"
    taken.unlink()
    assert batches.to_solve(found.cases)[key] == "no record"
    climbs.path_of(key).unlink()
    assert batches.to_solve(found.cases)[key] == "no climb yet"
    assert batches.solve(found.cases, 1, LIMITS, Path("made.txt")) == 0
    assert batches.to_solve(found.cases) == {}
