"""A design: what is free, what is required, the muscle that meets it, or what stands in the way."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from geometry.refusal import Refusal
from solver import record
from workflow.answers.design import result, search
from workflow.answers.design.problem import Problem, cover
from workflow.answers.design.search import MISSED, Found, Search, Trial, looked_for
from workflow.answers.store import Store
from workflow.plan.plan import read
from workflow.study.errors import StudyError
from workflow.study.study import load

HEAD = """
materials:
  nbr: {c10: 0.345083, c01: 0.083805}
  silicone: {c10: 0.028, c01: 0.018}
muscles:
  base: {inner_diameter: 12, wall_thickness: 1.2, length: 250, layer_depths: [0.3, 0.9],
    threads: 60, angle: 24, thread_stiffness: 315, thread_strength: 50, material: silicone}
scenes: {}
"""
SMALL = (
    HEAD
    + """
design:
  small:
    base: base
    pressure: 0.3
    free: {inner_diameter: [8, 16]}
    require:
      pull: {quantity: force, at_least: 150, contraction: 0.1}
      bore: {quantity: bore_stretch, at_most: 2}
    minimise: air
  contrary:
    base: base
    pressure: 0.3
    free: {angle: [15, 35]}
    require:
      pull: {quantity: force, at_least: 900, contraction: 0.1}
      slim: {quantity: outer_diameter, at_most: 40}
    minimise: air
"""
)
ALWAYS = """
      thread: {quantity: thread_share, at_most: 0.6}
      bore: {quantity: bore_stretch, at_most: 2}
      cover: {quantity: thread_cover, at_most: 0.9}
    minimise: air
"""
CASES = {  # requirements, ranges, and the air that is enough
    "A": (
        0.4, 250, (8, 32), (1, 4), (24, 160), 45,
        ["at_least: 500, contraction: 0.05", "at_least: 150, contraction: 0.18"], 0.3865,
    ),
    "B": (
        0.25, 150, (5, 20), (1, 3), (12, 120), 25,
        ["at_least: 60, contraction: 0.15", "at_most: 300, contraction: 0"], 0.0442,
    ),
    "C": (
        0.3, 60, (8, 32), (1, 4), (24, 200), 45,
        ["at_least: 300, contraction: 0.05", "at_least: 80, contraction: 0.15"], 0.0549,
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("designs")
    (made / "study.yaml").write_text(SMALL)
    return made


@pytest.fixture
def study(folder, monkeypatch):
    monkeypatch.chdir(folder)
    return load("study.yaml")


def test_a_muscle_that_meets_its_requirements_by_the_solid(study, folder):
    problem = Problem(study, "small")
    found = looked_for(problem, Store(study))
    best = found.best
    assert best is not None
    assert best.worst <= MISSED
    assert 1 <= found.solves <= 5
    assert problem.requirements[0].violation(best.measures) > -2e-3  # decides
    # the record of the solid says the same
    case = problem.case(problem.muscle(best.x), 0.3)
    _, solution = record.read(Path("results/cases", f"{case.key}.h5"))
    number = case.path.stops.index(0.1)
    assert solution.states["force"][number] >= 150 * (1 - MISSED)
    bore = solution.states["inner_diameter_inflated"][: number + 1].max()
    assert bore / case.muscle.inner_diameter <= 2 * (1 + MISSED)
    # no coarse look over the range finds a muscle of less air that the solid-like model allows
    air = problem.objectives[0]
    shares = {k: best.measures[k] / v for k, v in problem.cheap(best.x).items() if v}
    for diameter in np.linspace(8, 16, 33):
        measures = problem.cheap(np.array([diameter]))
        there = {k: v * shares.get(k, 1) for k, v in measures.items()}
        if all(r.violation(there) <= 0 for r in problem.requirements):
            assert there[air] > best.measures[air] * 0.995

    again = looked_for(Problem(study, "small"), Store(study))
    assert again.solves == 0  # all is in the store
    assert np.array_equal(again.best.x, best.x)


def test_what_is_pasted_is_what_was_solved(study, folder):
    results = result.designed(study, "small")
    result.write(study, "small", results, Path("results/design/small.yaml"))
    pasted = yaml.safe_load(Path("results/design/small.yaml").read_text())["muscles"]
    whole = yaml.safe_load(SMALL)
    whole["muscles"] |= pasted
    Path("pasted.yaml").write_text(yaml.safe_dump(whole))
    muscle = load("pasted.yaml").muscles["small"]
    problem = results[0].problem
    solved = problem.muscle(results[0].best.x)
    assert problem.case(muscle, 0.3).key == problem.case(solved, 0.3).key
    told = json.loads(Path("results/design/small.json").read_text())[0]
    assert "pull" in told["active"]
    assert told["best"]["worst"] <= MISSED
    assert told["flat"]["inner_diameter"][0] <= told["best"]["values"]["inner_diameter"]
    table = Path("results/design/small_sheet.csv").read_text()
    assert "stiffness, valve closed" in table
    assert results[0].solves == 0 or len(results[0].trials) == results[0].solves


def test_what_stands_in_the_way_is_named(study):
    found = looked_for(Problem(study, "contrary"), Store(study))
    assert found.best is None
    assert found.solves == 0  # the cylinder is far enough from it
    assert [r.name for r in found.missed[0].requirements] == ["pull"]
    assert found.missed[0].worst == pytest.approx(0.224, abs=0.01)
    result.write(study, "contrary", [found], Path("results/design/contrary.yaml"))
    said = "\n".join(result.report(found, "contrary"))
    assert "no muscle meets all requirements" in said
    assert "without pull (force at 10 %, 0.3 MPa: at least 900 N" in said
    assert "muscles:" not in result.texts("contrary", [found])


def test_objectives_that_agree_have_one_muscle(tmp_path, monkeypatch):
    """Five equal muscles would say nothing."""
    text = SMALL.replace("minimise: air", "minimise: [air, outer_diameter]", 1)
    (tmp_path / "study.yaml").write_text(text)

    def looked_for(problem, store, objective, bound=None):
        x = np.array([12.0])
        return Found(problem, objective, bound, best=Trial(x, problem.cheap(x), 0.0, 0.0))

    monkeypatch.setattr(result, "looked_for", looked_for)
    found = result.designed(load(tmp_path / "study.yaml"), "small")
    assert len(found) == 1
    assert "nothing to trade" in "\n".join(result.report(found[0], "both"))


TRADE = """
design:
  trade:
    base: base
    pressure: 0.3
    free: {inner_diameter: [8, 16], material: [nbr, soft]}
    require: {pull: {quantity: force, at_least: 100, contraction: 0.1}}
    minimise: air
    maximise: force
"""


def test_a_trade_off_has_muscles_between_its_ends(tmp_path, monkeypatch):
    """With two rubbers: where sums of the objectives are least at the ends."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(search, "GENERATIONS", 4)
    monkeypatch.setattr(search.Search, "_tried", _by_cylinder)  # which takes the solid's place
    monkeypatch.setattr(search.Search, "flat", lambda _search, _x: {})
    study = yaml.safe_load(SMALL) | yaml.safe_load(TRADE)
    study["materials"]["soft"] = {"c10": 0.05, "c01": 0.01}
    Path("study.yaml").write_text(yaml.safe_dump(study))
    found = result.designed(load("study.yaml"), "trade")
    air, force = np.array([result._sizes(each, each.best) for each in found]).T
    assert len(found) == 5
    assert (np.diff(air) > 0).all()
    steps = np.diff(-force) / (force[0] - force[-1])
    assert steps == pytest.approx(0.25, abs=5e-3)
    assert "trade-off: force at 10 %: at least" in "\n".join(result.report(found[2], "c"))
    said = result.texts("trade", found)
    assert [line.split(":")[0] for line in said.splitlines() if "states by" in line] == [
        f"# trade_{k}" for k in range(1, 6)
    ]
    assert yaml.safe_load(said)["muscles"].keys() == {f"trade_{k}" for k in range(1, 6)}
    chosen = result.table(found).query("name == 'chosen'").set_index("what")
    assert chosen["unit"].to_dict() == {"inner_diameter": "mm", "material": ""}
    assert found[-1].bound.limit == pytest.approx(force.min(), rel=5e-3)  # an end is refined too
    lines = [f"{each.problem.values(each.best.x)}" for each in found]
    assert len(set(lines)) == 5
    assert len(result.draw(found, []).axes) == 2


def _by_cylinder(self, x):
    measures = self.problem.cheap(x)
    worst = max(r.violation(measures) for r in self.requirements)
    return search.Trial(x, measures, self.objective(measures), worst)


def test_a_reserve_is_on_what_must_be_at_least(tmp_path):
    text = SMALL.replace("minimise: air", "minimise: air\n    reserve: 0.2", 1)
    (tmp_path / "study.yaml").write_text(text)
    problem = Problem(load(tmp_path / "study.yaml"), "small")
    assert [r.limit for r in problem.requirements] == [150 * 1.2, 2]


def test_limits_are_said_as_they_were_given_and_spans_as_they_are(tmp_path):
    text = SMALL.replace("at_least: 150", "at_least: 12345.678", 1)
    (tmp_path / "study.yaml").write_text(text)
    problem = Problem(load(tmp_path / "study.yaml"), "small")
    assert problem.requirements[0].text.endswith("at least 12345.678 N")
    assert problem.bound(problem.objectives[0], 0.123456).text.split()[-2] == "0.1235"
    assert result._span(24.9951, 25.0) == "24.995 to 25"
    assert result._span(8.0, 9.0) == "8 to 9"


def test_every_quantity_is_measured_alike_by_both_models(tmp_path, monkeypatch):
    """Ratios of solid to cylinder near one: no measure means something else there."""
    monkeypatch.chdir(tmp_path)
    require = """
      a: {quantity: force, at_least: 150, contraction: 0.1}
      b: {quantity: stroke, at_least: 20, load: 100}
      c: {quantity: free_contraction, at_least: 0.15}
      d: {quantity: blocked_force, at_most: 3000}
      e: {quantity: outer_diameter, at_most: 60}
      f: {quantity: length, at_most: 260}
      g: {quantity: air, at_most: 1, contraction: 0.1}
      h: {quantity: thread_share, at_most: 0.6}
      i: {quantity: rubber_stretch, at_most: 3}
      j: {quantity: bore_stretch, at_most: 2.5}
      k: {quantity: thread_cover, at_most: 0.9}
    maximise: work
"""
    text = SMALL[: SMALL.index("    require:")] + "    require:" + require
    (tmp_path / "study.yaml").write_text(text)
    study = load("study.yaml")
    problem = Problem(study, "small")
    x = np.array([12.0])
    cheap, studied = problem.cheap(x), problem.muscle(x)
    case = problem.case(studied, 0.3)
    from workflow.answers.curve import Curve

    truth = problem.by_curves(studied, {0.3: Curve(case, Store(study).solution(case))})
    assert cheap.keys() == truth.keys()
    for name, value in truth.items():
        if math.isfinite(value):
            assert cheap[name] == pytest.approx(value, rel=0.12, abs=1e-3), name
    assert cheap["thread_cover"] == pytest.approx(
        60 * math.sqrt(4 * 315 / (2100 * math.pi)) / (math.pi * 12.6 * math.cos(math.radians(24)))
    )
    assert cover(studied) == cheap["thread_cover"]
    lift = next(r for r in problem.requirements if r.name == "b")
    curve = Curve(case, Store(study).solution(case))
    assert truth[lift.measure] == pytest.approx(float(curve.force(20 / 250)), rel=1e-9)


def test_a_candidate_that_cannot_be_built_is_none(study):
    problem = Problem(study, "small")
    assert problem.cheap(np.array([-1.0])) is None
    with pytest.raises(Refusal):
        problem.muscle(np.array([-1.0]))


def test_a_rounded_candidate_can_be_built_if_it_can(tmp_path):
    path = tmp_path / "study.yaml"
    path.write_text(SMALL.replace("inner_diameter: [8, 16]", "wall_thickness: [0.9001, 2]"))
    problem = Problem(load(path), "small")
    assert problem.rounded(np.array([1.23456])).tolist() == [1.235]
    assert problem.rounded(np.array([0.9002])).tolist() == [0.9002]  # 0.9 has no outer layer


def test_a_candidate_without_states_is_no_trial(study):
    search = Search(Problem(study, "small"), Store(study))
    assert search._tried(np.array([-1.0])) is None


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("base: base\n    pressure: 0.3", "base: bass\n    pressure: 0.3"), "nearest: base"),
        (("pressure: 0.3", "pressure: 300"), "at most 20 (MPa)"),
        (("inner_diameter: [8, 16]", "angle: [35, 15]"), "two rising numbers"),
        (("inner_diameter: [8, 16]", "wall_thickness: [0.9, 2]"), "more than 0.9 mm on"),
        (("at_least: 150, ", ""), "exactly one of at_least, at_most"),
        (("at_least: 150", "at_least: 150, at_most: 5"), "exactly one of at_least, at_most"),
        (("150, contraction: 0.1", "150"), "must be given for force"),
        (("quantity: bore_stretch", "quantity: bore_stretches"), "nearest: bore_stretch"),
        (("at_most: 2}", "at_most: 2, load: 5}"), "not used for bore_stretch"),
        (("minimise: air", "reserve: 0.1"), "one objective"),
        (("minimise: air", "minimise: [air, mass, length]"), "one objective, or two"),
        (("minimise: air", "minimise: mass"), "silicone of base has no density"),
        (("{inner_diameter: [8", "{material: [rubber], inner_diameter: [8"), "nbr, silicone"),
        (("thread_strength: 50, ", ""), None),
    ],
)
def test_a_design_that_cannot_be_looked_for_is_refused(tmp_path, change, said):
    assert change[0] in SMALL
    path = tmp_path / "study.yaml"
    path.write_text(SMALL.replace(*change))
    if said is None:  # no requirement reads it
        read(path)
        text = path.read_text().replace("bore_stretch, at_most: 2", "thread_share, at_most: 0.6")
        path.write_text(text)
        said = "has no thread_strength"
    with pytest.raises(StudyError) as refused:
        read(path)
    assert said in str(refused.value)


@pytest.mark.campaign
@pytest.mark.parametrize("name", CASES)
def test_designs_of_separate_scripts_are_reached(name, tmp_path, monkeypatch):
    """Least air of three muscles, against what scripts with the same requirements have found."""
    monkeypatch.chdir(tmp_path)
    pressure, length, bore, wall, threads, widest, forces, enough = CASES[name]
    text = HEAD.replace("length: 250", f"length: {length}") + f"""
design:
  {name}:
    base: base
    pressure: {pressure}
    free: {{inner_diameter: {list(bore)}, wall_thickness: {list(wall)}, angle: [15, 35],
      threads: {list(threads)}, material: [nbr, silicone]}}
    require:
      one: {{quantity: force, {forces[0]}}}
      two: {{quantity: force, {forces[1]}}}
      slim: {{quantity: outer_diameter, at_most: {widest}}}{ALWAYS}"""  # fmt: skip
    Path("study.yaml").write_text(text)
    study = load("study.yaml")
    found = looked_for(Problem(study, name), Store(study))
    assert found.best is not None
    assert found.best.worst <= 1e-3
    assert found.best.measures[found.problem.objectives[0]] <= 1.01 * enough
    assert found.solves <= 5
