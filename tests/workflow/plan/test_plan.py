"""Which cases a study has, and what changes them."""

from pathlib import Path

import pytest

from workflow.plan.plan import Place, plan
from workflow.study.study import load

from ..synthetic import MUSCLE

SILICONE = "  silicone: {c10: 0.028, c01: 0.018}\n"
STUDY = (
    MUSCLE.replace("muscles:", f"{SILICONE}muscles:")
    + """\
  soft: {base: one, material: silicone}
variants:
  paper: {effects: {end: butt, threads: two_way}}
numerics:
  newton: {tolerance: 1e-9}
  section: {cap_step: 1}
scenes:
  curves:
    path: isobaric
    muscles: [one, soft]
    pressure: [0.2, 0.3]
    contraction: {from: 0, to: 0.1, step: 0.01}
    models: [geometric, cylinder, membrane, solid]
    variants: [default, paper]
  loads:
    path: isotonic
    muscles: [one]
    load: [100, 200]
    pressure: [0.2, 0.3]
    models: [membrane]
"""
)


@pytest.fixture
def planned(tmp_path):
    def make(*changes, text=STUDY):
        for old, new in changes:
            assert text.count(old) >= 1, old
            text = text.replace(old, new, 1)
        path = tmp_path / "study.yaml"
        path.write_text(text)
        return plan(load(path))

    return make


def cases_of(planned, **where):
    """Keys of the cases at the places with these properties."""
    return {
        key
        for key, case in planned.cases.items()
        for place in case.places
        if all(getattr(place, name) in value for name, value in where.items())
    }


ALL = {"model": ("geometric", "cylinder", "membrane", "solid")}
WITH_WALL = {"model": ("cylinder", "membrane", "solid")}
WITH_CAPS = {"model": ("membrane", "solid")}
SOLID = {"model": ("solid",)}
CHANGES = [
    # what is changed, and the cases that contain it
    ("c10: 0.345083", "c10: 0.345", {**WITH_WALL, "muscle": ("one",)}),
    ("c01: 0.018", "c01: 0.02", {**WITH_WALL, "muscle": ("soft",)}),
    ("c01: 0.018}", "c01: 0.018, kappa: 500}", {**SOLID, "muscle": ("soft",)}),
    ("inner_diameter: 20", "inner_diameter: 20.5", ALL),
    ("wall_thickness: 2", "wall_thickness: 2.5", WITH_WALL),
    ("length: 300", "length: 200", WITH_WALL),
    ("    lead: 144", "    lead: 144\n    cap_length: 9", {**SOLID, "variant": ("default",)}),
    ("[0.3, 0.9]", "[0.3, 1]", ALL),
    ("threads: 60", "threads: 61", ALL),
    ("lead: 144", "lead: 145", ALL),
    ("lead: 144", "angle: 17.1", ALL),
    ("thread_stiffness: 315", "thread_stiffness: 300", WITH_WALL),
    ("base: one", "base: one, length: 200", {**WITH_WALL, "muscle": ("soft",)}),
    ("tolerance: 1e-9", "tolerance: 1e-8", WITH_CAPS),
    ("cap_step: 1", "cap_step: 2", SOLID),
    ("cap_step: 1", "refinement: 2", SOLID),
    ("  section:", "  slack: {width: 0.01}\n  section:", {**WITH_WALL, "variant": ("default",)}),
    ("  section:", "  clamp: {ramp: 3}\n  section:", {**SOLID, "variant": ("default",)}),
    ("  section:", "  meridian: {growth: 1.2}\n  section:", {"model": ("membrane",)}),
    ("end: butt", "end: clamp", {**SOLID, "variant": ("paper",)}),
    ("end: butt", "end: sliding", {**SOLID, "variant": ("paper",)}),
    ("pressure: [0.2, 0.3]", "pressure: [0.2, 0.4]", {"group": ("isobaric",), "held": (0.3,)}),
    ("to: 0.1,", "to: 0.2,", {"group": ("isobaric",)}),
    ("load: [100, 200]", "load: [100, 300]", {"group": ("isotonic",), "held": (200,)}),
    ("c01: 0.083805", "c01: 0.083805, kappa: 500", {**SOLID, "muscle": ("one",)}),
]


@pytest.mark.parametrize(("old", "new", "where"), CHANGES)
def test_a_change_reaches_exactly_the_cases_that_contain_it(planned, old, new, where):
    before, after = planned(), planned((old, new))
    assert set(before.cases) - set(after.cases) == cases_of(before, **where)
    assert len(after.cases) == len(before.cases)


SAME = [
    (("inner_diameter: 20", "inner_diameter: 20.0"),),
    (("lead: 144", "lead: 1.44e2"),),
    (("pressure: [0.2, 0.3]", "pressure: [0.30, 0.2]"),),
    (("{from: 0, to: 0.1, step: 0.01}", "{from: 0.0, to: 0.10, step: 1e-2}"),),
    (("pressure: [0.2, 0.3]", "pressure: {from: 0.2, to: 0.3, step: 0.1}"),),
    (("[geometric, cylinder, membrane, solid]", "[solid, membrane, cylinder, geometric]"),),
    (("muscles: [one, soft]", "muscles: [soft, one]"),),
    (
        ("    inner_diameter: 20\n", ""),
        ("    length: 300\n", "    length: 300\n    inner_diameter: 20\n"),
    ),
    (("c01: 0.083805}", "c01: 0.083805, kappa: 1000} # MPa"),),
    (("  newton: {tolerance: 1e-9}\n", ""),),
    (("materials:", "# a comment\nmaterials:"),),
    (("scenes:", "limits: {wall_time: 5}\nscenes:"),),
]


@pytest.mark.parametrize("changes", SAME)
def test_what_means_the_same_is_the_same(planned, changes):
    before, after = planned(), planned(*changes)
    assert list(after.cases) == list(before.cases)
    assert after.meshes == before.meshes
    assert after.digest() == before.digest()
    assert after.digest("curves") == before.digest("curves")


def test_swapped_values_are_a_change(planned):
    before = planned()
    after = planned(("inner_diameter: 20", "inner_diameter: 300"), ("length: 300", "length: 20"))
    assert not cases_of(before, **ALL) & cases_of(after, **ALL)


def test_a_case_holds_what_all_scenes_ask_for(planned):
    more = """\
  stress:
    path: isobaric
    muscles: [one]
    pressure: [0.3]
    contraction: [0.05, 0.2]
    models: [solid]
    quantities: [stress]
  free:
    path: isobaric
    muscles: [one]
    pressure: [0.3]
    contraction: [0]
    models: [solid]
    quantities: [free_contraction]
"""
    alone, together = planned(), planned(text=STUDY + more)
    assert len(alone.cases) == len(together.cases)
    place = Place("isobaric", "one", "solid", "default", 0.3)
    key = together.scenes["curves"][place]
    assert together.scenes["stress"][place] == together.scenes["free"][place] == key
    case = together.cases[key].case
    assert case.path.stops == (*(k / 100 for k in range(11)), 0.2)
    assert case.fields_at == (0.05, 0.2)
    assert case.path.zero_force
    assert together.cases[key].scenes == ("curves", "free", "stress")


def test_equal_content_is_solved_once(planned):
    twin = ("  soft:", "  twin: {base: one}\n  soft:")
    both = planned(twin, ("muscles: [one, soft]", "muscles: [one, twin, soft]"))
    assert set(both.cases) == set(planned().cases)
    label = next(c.label for c in both.cases.values() if len(c.places) == 2)
    assert label == "one cylinder isobaric 0.2 MPa (and 1 more)"


def test_eq_1_is_shared_by_variants_and_materials(planned):
    found = planned()
    assert len(cases_of(found, model=("geometric",))) == 2  # one for each pressure
    assert len(cases_of(found, model=("solid",))) == 8


def test_muscles_that_differ_in_lead_or_material_share_a_mesh(planned):
    found = planned(("material: silicone", "material: silicone, lead: 216"))
    assert len(found.meshes) == 3  # membrane, and solid with both ends
    assert {name.split(".")[1] for name in found.meshes} == {"mesh", "msh"}


def test_eq_1_is_not_asked_for_a_threshold(planned):
    text = STUDY + (
        "  threshold: {path: isometric, muscles: [one], contraction: [0.1], pressure: [0.1],"
        " models: [geometric, membrane], quantities: [threshold_pressure]}\n"
    )
    found = planned(text=text)
    zero = {
        c.case.model: c.case.path.zero_force
        for c in found.cases.values()
        if c.scenes == ("threshold",)
    }
    assert zero == {"geometric": False, "membrane": True}


@pytest.mark.parametrize("to", ["0.25", "0.3"])
def test_grids_are_exact_decimals(planned, to):
    found = planned(("to: 0.1,", f"to: {to},"))
    stops = next(iter(found.cases.values())).case.path.stops
    assert stops == tuple(float(f"{k / 100:.2f}") for k in range(len(stops)))
    assert 0.07 in stops
    assert stops[-1] == float(to)


def test_a_name_is_no_part_of_a_case_but_of_the_dataset(planned):
    renamed = planned(text=STUDY.replace("soft", "weak"))
    assert set(renamed.cases) == set(planned().cases)
    assert renamed.digest() != planned().digest()
    assert renamed.digest("curves") != planned().digest("curves")
    assert renamed.digest("loads") == planned().digest("loads")


def test_the_study_of_the_paper():
    found = plan(load(Path(__file__).parents[3] / "config/config.yaml"))
    assert set(found.study.scenes) == {f"fig{n:02}" for n in range(3, 14)} | {"wall"}
    shared = [c for c in found.cases.values() if len(c.scenes) > 1]
    asked = sum(len(places) for places in found.scenes.values())
    assert len(found.cases) < asked - len(shared) + 1
    muscle = found.study.muscles["dmsp20_d40"].muscle
    assert muscle.braid.lead == pytest.approx(279.85, abs=0.005)
