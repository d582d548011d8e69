"""What the planner chooses, from what was measured; and that a looser choice keeps its promise."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from solver.status import StateStatus
from workflow.analyses.analysis import Solved
from workflow.analyses.effects import table
from workflow.analyses.effects.cases import REGIMES, SETUPS, cases
from workflow.plan import effect_costs, judged, model_choice
from workflow.plan.explain import lines
from workflow.plan.plan import plan
from workflow.study.errors import StudyError
from workflow.study.judged_quantities import VARIABLES
from workflow.study.study import load

STUDY = Path(__file__).parents[3] / "config/config.yaml"
LOOSE, TIGHT = 0.05, 0.001
LADDER = [name for name, rung in model_choice.RUNGS.items() if not rung.only_for]
WITH_PATH = [name for name, scene in load(STUDY).scenes.items() if scene.path]


@pytest.fixture(scope="module")
def study():
    return load(STUDY)


def without_models(study, name, **changes):
    """A scene that leaves its model to the planner."""
    return study.scenes[name].model_copy(
        update={"models": None, "variants": ("default",)} | changes
    )


def choose(study, name, **changes):
    return model_choice.choose(study, without_models(study, name, **changes))


def with_scene(folder, text):
    """The study with one more scene."""
    path = folder / "study.yaml"
    path.write_text(STUDY.read_text().replace("\nscenes:\n", "\nscenes:\n" + text, 1))
    return path


# --- choices --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", WITH_PATH)
def test_a_tolerance_decides_model_or_mesh(study, name):
    loose, tight = (choose(study, name, tolerance=t) for t in (LOOSE, TIGHT))
    assert loose.chosen.rung != tight.chosen.rung
    assert LADDER.index(loose.chosen.rung.name) < LADDER.index(tight.chosen.rung.name)


@pytest.mark.parametrize("name", WITH_PATH)
@pytest.mark.parametrize("tolerance", [0.2, LOOSE, 0.01, TIGHT])
def test_the_choice_is_the_cheapest_that_is_exact_enough(study, name, tolerance):
    choice = choose(study, name, tolerance=tolerance)
    for estimate in choice.estimates:
        if estimate is choice.chosen:
            break
        enough = estimate.error <= tolerance and estimate.mesh_error <= tolerance / 4
        assert estimate.refused or estimate.missing or not enough


def test_the_mesh_takes_a_quarter_of_the_tolerance_and_the_default_is_that_for_a_hundredth(study):
    """The coarsest that does, by the errors in mesh_error.csv."""
    found = {e.rung.mesh: e.mesh_error for e in choose(study, "fig05").estimates[3:6]}
    assert list(found) == ["coarser", "default", "finer"]
    assert found["finer"] < found["default"] <= model_choice.TOLERANCE / 4 < found["coarser"] < 0.01
    for mesh, error in found.items():
        wanted = {"tolerance": 4.001 * error, "quantities": ("stress",)}
        assert choose(study, "fig05", **wanted).chosen.mesh_error <= error, mesh
    default = choose(study, "fig05", quantities=("stress",), tolerance=model_choice.TOLERANCE)
    assert default.chosen.rung.mesh == "default"


def test_errors_fall_along_the_ladder(study):
    errors = [e.error for e in choose(study, "fig04").estimates if e.rung.model != "cell"]
    assert all(np.isfinite(errors))
    assert errors[2] < errors[1] < errors[0]
    assert errors[-1] < errors[-2] < errors[-3]


def test_only_stress_pays_for_the_solid(study):
    force = choose(study, "fig05", quantities=("force",), tolerance=LOOSE)
    stress = choose(study, "fig05", quantities=("stress",), tolerance=LOOSE)
    assert (force.models, stress.models) == (("membrane",), ("solid",))
    asking = [name for name, scene in study.scenes.items() if "stress" in scene.quantities]
    assert asking == ["fig05", "wall"]


@pytest.mark.parametrize(
    ("effects", "model"),
    [
        ({"end_caps": "off"}, "cylinder"),
        ({"twist": "on"}, "cylinder"),
        ({"thread_stretch": "off"}, "cylinder"),
        ({"rubber": "off", "thread_stretch": "off", "wall_thickness": "off"}, "cylinder"),
        ({"cap_geometry": "on"}, "solid"),
        ({"discrete_threads": "on"}, "cell"),
        ({"compressibility": "off", "cap_geometry": "on"}, "solid"),
    ],
)
def test_effects_that_a_scene_forces(study, effects, model):
    scene = without_models(study, "fig04", effects=effects, tolerance=0.3)
    assert model_choice.choose(study, scene).models == (model,)


def test_forced_effects_reach_the_case(tmp_path):
    more = (
        "  turning: {path: isobaric, muscles: [dmsp20], pressure: [0.3], contraction: [0.1],"
        " effects: {twist: on}, tolerance: 0.2}\n"
    )
    path = with_scene(tmp_path, more)
    found = plan(load(path))
    ((place, key),) = found.scenes["turning"].items()
    assert (place.model, place.variant) == ("cylinder", "default_twist_on")
    assert "twist" in found.cases[key].case.active_effects


BAD = {
    "effects: {twist: on}, models: [membrane]": "membrane carries no twist",
    "effects: {twist: on}, quantities: [stress]": "what one model can have",
    "effects: {twist: maybe}": "on, off",
    "effects: {torsion: on}": "effects.torsion",
    "tolerance: 2": "less than 1",
    "effects: {cap_geometry: off}, models: [solid]": "would leave out end_caps too",
}


@pytest.mark.parametrize("keys", BAD)
def test_scenes_that_no_model_can_serve(tmp_path, keys):
    path = with_scene(
        tmp_path,
        "  bad: {path: isobaric, muscles: [dmsp20], pressure: [0.3], contraction: [0.1], "
        + keys
        + "}\n",
    )
    with pytest.raises(StudyError) as refused:
        plan(load(path))
    assert "scenes.bad" in str(refused.value)
    assert BAD[keys] in str(refused.value)


def test_explain_says_it_for_every_scene():
    text = "\n".join(lines(plan(load(STUDY))))
    for name in WITH_PATH:
        assert f"\n{name}: " in text
    assert text.count("  wants ") == text.count("  models ") == len(WITH_PATH)
    assert "effects: analysis of effects of" in text


# --- what was measured ----------------------------------------------------------------------------


def test_measured_effects_are_those_of_the_study():
    asked = {(r, p, e) for r in REGIMES for p in planner_paths() for e in table.SWITCHES}
    dear = {key for key in asked if key[2] == model_choice.DISCRETE and key[1] != "isobaric"}
    assert set(effect_costs.load()) == asked - dear


def test_every_model_but_the_cell_pays_for_smearing(study):
    scene = without_models(study, "fig04")
    smeared = {e.rung.name: e for e in model_choice.choose(study, scene).estimates}
    off = scene.model_copy(update={"effects": {model_choice.DISCRETE: "off"}})
    free = {e.rung.name: e for e in model_choice.choose(study, off).estimates}
    largest = max(effect_costs.load()[r, "isobaric", model_choice.DISCRETE].force for r in REGIMES)
    for name in LADDER:
        assert 0 < smeared[name].error - free[name].error < 10 * largest
    cell = smeared["cell"]
    assert np.isfinite(cell.error)
    assert cell.error < smeared["cylinder"].error
    assert cell.seconds > smeared["solid"].seconds


def planner_paths():
    return ("isobaric", "isometric", "isotonic")


@pytest.mark.parametrize("path", planner_paths())
def test_measured_effects_are_not_out_of_date(study, solve_case, path):
    """What is quick to solve is solved again; run snakemake effects and weigh if this fails."""
    quick = {name for name, setup in SETUPS.items() if setup.model not in ("solid", "cell")}
    solved = {
        asked.tags["setup"]: Solved(asked, solve_case(asked.case))
        for asked in cases(study)
        if asked.tags["regime"] == "normal"
        and asked.tags["path"] == path
        and asked.tags["setup"] in quick
    }
    for effect, pair in table.SWITCHES.items():
        if set(pair) <= quick:
            now = table.row(solved, *pair)
            known = effect_costs.load()["normal", path, effect]
            for name in ("force", "contraction", "diameter", "missing", "unknowns_without"):
                assert now[name] == pytest.approx(
                    getattr(known, name), rel=0.1, abs=2e-5, nan_ok=True
                ), f"{effect}: {name}"


# --- promises -------------------------------------------------------------------------------------


def quick(scene, tolerance):
    """Fewer stops and values held, the same range of stops."""
    swept = scene.swept[:: max(1, (len(scene.swept) - 1) // 4)]
    held = scene.held[:1]
    keys = dict(
        zip((planner_key(scene, True), planner_key(scene, False)), (held, swept), strict=True)
    )
    muscles = (scene.muscles[0], scene.muscles[-1])[: len(scene.muscles)]
    return scene.model_copy(update=keys | {"tolerance": tolerance, "muscles": muscles})


def planner_key(scene, held):
    from workflow.study.schema import HELD_KEY, SWEPT_KEY

    return (HELD_KEY if held else SWEPT_KEY)[scene.path]


@pytest.mark.slow
@pytest.mark.parametrize("name", WITH_PATH)
def test_a_looser_tolerance_moves_the_answer_by_less(study, solve_case, name):
    answers = []
    for tolerance in (LOOSE, TIGHT):
        scene = quick(without_models(study, name, quantities=()), tolerance)
        found = plan(replace(study, scenes={name: scene}))
        variable = "contraction" if scene.path == "isotonic" else "force"
        answers.append(
            {
                (place.muscle, place.held): valid(solve_case(found.cases[key].case), variable)
                for place, key in found.scenes[name].items()
            }
        )
    for curve, loose in answers[0].items():
        tight = answers[1][curve]
        largest = np.nanmax(np.abs(tight))
        assert np.isfinite(loose).sum() >= np.isfinite(tight).sum(), "states are lost"
        assert np.nanmax(np.abs(loose - tight)) < LOOSE * largest, curve


def valid(solution, variable):
    """Values of a variable at the stops, NaN where a state is not one."""
    good = [s in (StateStatus.CONVERGED, StateStatus.UNSTABLE) for s in solution.state_status]
    return np.where(good, solution.states[variable], np.nan)


def test_what_a_figure_shows_is_judged(tmp_path):
    """As if the scene had asked for it."""
    scene = "  a: {path: isobaric, muscles: [dmsp20], pressure: 0.3, contraction: [0, 0.1]%s}\n"
    found = {}
    for said in (", quantities: [volume]", ", figure: {y: volume}", ""):
        study = load(with_scene(tmp_path, scene % said))
        found[said] = study.scenes["a"].quantities, model_choice.choose(study, study.scenes["a"])
    asked, shown, neither = found.values()
    assert asked[0] == shown[0] == ("volume",)
    assert not neither[0]
    assert asked[1].estimates == shown[1].estimates != neither[1].estimates
    named = ", models: [geometric], figure: {y: inner_diameter_inflated}"
    assert not load(with_scene(tmp_path, scene % named)).scenes["a"].quantities
    assert judged.QUANTITIES is VARIABLES  # what is judged is what a figure is asked for
