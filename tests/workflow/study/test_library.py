"""Materials and muscles of the library: whole, marked, and usable by name in any study."""

import re

import pytest

from solver.rubber import default
from workflow.data import reference
from workflow.plan.plan import plan
from workflow.programs.list import lines
from workflow.study import library
from workflow.study.errors import StudyError
from workflow.study.study import load, load_library

STUDY = """\
materials:
  own: {c10: 0.2, c01: 0.02}
muscles:
  short: {base: latex_sleeved, length: 120}
  mine: {base: dmsp_20_300, material: own}
scenes:
  curves: {path: isobaric, muscles: [short, mine, dmsp_10_250], pressure: 0.2, contraction: 0.1,
    models: [cylinder]}
"""


@pytest.fixture
def loaded(tmp_path):
    def made(text=STUDY, **more):
        path = tmp_path / "study.yaml"
        path.write_text(text)
        return load(path, **more)

    return made


def test_every_entry_says_where_it_is_from():
    for section in library.SECTIONS:
        for name in library.names(section):
            known = library.about(section, name)
            wanted = (
                {"source", "mark", "range"} if section == "materials" else {"source", "assumed"}
            )
            assert wanted <= known.keys(), name
            assert known.get("mark", "A") in ("A", "B", "C"), name


def test_every_muscle_is_built_and_compared_with_maps_of_its_own():
    made = load_library()
    assert made.muscles.keys() == set(library.names("muscles"))
    assert not made.warnings
    maps = {name for muscle in made.muscles.values() for name in muscle.reference}
    assert maps == reference.MAPS.keys()
    length = made.muscles["dmsp_10_250"].muscle.length
    assert reference.load(["martens2017_dmsp10"])["martens2017_dmsp10"].contractions(0.3)[0] < 0.05
    assert length == 250


@pytest.mark.parametrize("name", library.names("materials"))
def test_every_material_can_be_used(loaded, name):
    made = loaded(STUDY.replace("material: own", f"material: {name}"))
    rubber = made.muscles["mine"].rubber
    assert rubber.law() == library.values("materials", name).get("law", default().law())
    assert 0.01 < rubber.shear_modulus < 1


def test_a_study_names_what_it_does_not_have(loaded):
    made = loaded()
    assert made.muscles.keys() == {"short", "mine", "latex_sleeved", "dmsp_20_300", "dmsp_10_250"}
    assert made.muscles["short"].material == "treloar_nr_yeoh"
    assert made.muscles["short"].muscle.length == 120
    assert made.muscles["mine"].material == "own"
    assert len(plan(made).cases) == 3


def test_a_changed_value_of_the_library_is_another_case(loaded, monkeypatch):
    before = set(plan(loaded()).cases)
    root = library._root("muscles")
    node = root.value["dmsp_20_300"].value["thread_stiffness"]
    monkeypatch.setattr(node, "value", 400)
    after = set(plan(loaded()).cases)
    assert len(before & after) == 1  # that of latex_sleeved


def test_its_files_are_sources_of_what_reads_a_study():
    from solver.sources import sources

    assert "config/library/muscles.yaml" in sources("workflow.programs.gather")


def test_own_entries_go_first(loaded):
    made = loaded(STUDY.replace("mine:", "dmsp_10_250:").replace("short, mine, ", ""))
    assert made.muscles["dmsp_10_250"].muscle.length == 300


def test_names_that_clash(loaded):
    with pytest.raises(StudyError) as caught:
        loaded(STUDY.replace("own:", "nbr_paper:").replace("material: own", "length: 200"))
    assert "study.yaml:2: materials.nbr_paper is no name here" in str(caught.value)
    assert "dmsp_20_300" in str(caught.value)


def test_refusals_name_the_file_in_which_a_value_stands(loaded):
    with pytest.raises(StudyError) as caught:
        loaded(STUDY.replace("length: 120", "wall_thickness: -1"))
    assert "study.yaml:4: muscles.short" in str(caught.value)
    with pytest.raises(StudyError) as caught:
        loaded(STUDY.replace("material: own", "angle_of: dmsp_30"))
    assert re.search(r"study.yaml:5: .*angle_of = 'dmsp_30'", str(caught.value))
    assert "of the library" in str(caught.value)
    with pytest.raises(StudyError) as caught:
        loaded(STUDY.replace("length: 120", "inner_diameter: 0.1"))
    said = str(caught.value)
    assert re.match(r"config/library/muscles.yaml:\d+: muscles.latex_sleeved.wall_thickness", said)
    assert "in short" in said


def test_asked_for_beside_what_a_study_names(loaded):
    assert "thin_2mm" in loaded(also=("thin_2mm", "nothing")).muscles
    assert "nothing" not in loaded(also=("nothing",)).muscles


def test_the_list_shows_them(loaded):
    text = "\n".join(lines(plan(loaded())))
    for section in library.SECTIONS:
        for name in library.names(section):
            assert name in text
    assert "sleeve of 30 threads at 30 degrees" in text
    assert "mark C" in text
