"""Whatever a study file says: it is planned, or refused with file and line; in bounded time."""

import os
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

from geometry.refusal import is_number
from workflow.data import bench
from workflow.plan.plan import Plan, read
from workflow.study import figure_needs, plain_yaml, units
from workflow.study.errors import StudyError
from workflow.study.study import given_settings, load

from .test_study import STUDY, changed

ROOT = Path(__file__).parents[3]
SCREEN = 24  # lines


def written(folder, text):
    path = folder / "study.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def answer(folder, text):
    """The plan, or the message; anything else is an error of the test."""
    try:
        return read(written(folder, text), bench.refused)
    except StudyError as error:
        said = str(error)
    lines = said.splitlines()
    assert said.startswith(str(folder / "study.yaml"))
    assert len(lines) <= SCREEN
    assert max(map(len, lines)) < 500
    assert "Traceback" not in said
    return said


def refusal(folder, text):
    said = answer(folder, text)
    assert isinstance(said, str), "not refused"
    return said


def warnings(folder, text):
    made = answer(folder, text)
    assert isinstance(made, Plan), made
    return made.study.warnings


# What no study has, as it would stand in YAML.
VALUES = [
    "1" + "0" * 399,
    "1" * 5000,
    "1e-300",
    "1e300",
    "-1e300",
    "1e400",
    ".nan",
    ".inf",
    "-.inf",
    "-0.0",
    "0",
    "-1",
    "0x10",
    "0o17",
    "1:30",
    "2020-01-01",
    "yes",
    "true",
    "~",
    "''",
    "'é'",
    '"a\\0b"',
    '"\\ud83d\\ude00"',
    "x" * 10_000,
    "[]",
    "{}",
    "[1, 2, 3]",
    "[[1]]",
    "{a: 1}",
    "!!python/object:os.system x",
    "!!float 20",
    "*nowhere",
    "&a [*a]",
    "{<<: 1}",
    "&b {<<: *b}",
    "{from: 0, to: 1e12, step: 1e-12}",
    "{from: 1e-300, to: 1, step: 1e-300}",
    "<<",
    "? [1]",
    "|\n      text\n      of lines",
    "0.07",
    "one",
    "[one]",
    "[0.1, 0.2]",
    "1000000000000",
    "0.000000000001",
    "89.9999",
]
LINES = STUDY.splitlines()
ENDS = [n for n, line in enumerate(LINES) if ": " in line]


@pytest.mark.parametrize("number", ENDS)
def test_any_value_of_any_key(tmp_path, number):
    head = LINES[number].split(": ")[0]
    for value in VALUES:
        lines = [*LINES[:number], f"{head}: {value}", *LINES[number + 1 :]]
        answer(tmp_path, "\n".join(lines))


@given(
    st.lists(
        st.tuples(st.integers(0, len(STUDY)), st.integers(0, 8), st.text(max_size=6)), max_size=4
    )
)
@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
def test_any_text_near_a_study(tmp_path, edits):
    text = STUDY
    for start, length, new in edits:
        text = text[:start] + new + text[start + length :]
    answer(tmp_path, text.encode("utf-8", "surrogatepass"))


@given(st.binary(max_size=200))
@settings(max_examples=50, deadline=None, suppress_health_check=list(HealthCheck))
def test_any_bytes(tmp_path, data):
    answer(tmp_path, data)


SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.sampled_from(["one", "nbr", "default", "none", "solid", "isobaric", "a b", "fig04"]),
)
TREES = st.recursive(
    SCALARS,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=3)
    ),
    max_leaves=8,
)


@given(place=st.integers(0, 10**6), value=TREES)
@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
def test_any_tree_in_place_of_a_value(tmp_path, place, value):
    study = plain_yaml.read(STUDY).plain()
    places = list(_places(study))
    *keys, last = places[place % len(places)]
    at = study
    for key in keys:
        at = at[key]
    at[last] = value
    path = tmp_path / "study.yaml"
    with path.open("w") as stream:
        YAML(typ="safe").dump(study, stream)
    answer(tmp_path, path.read_bytes())


def _places(node, keys=()):
    for key, value in node.items() if isinstance(node, dict) else enumerate(node):
        yield (*keys, key)
        if isinstance(value, dict | list):
            yield from _places(value, (*keys, key))


def chain(count, link):
    """Muscles of which every one names the one before."""
    names = ["one", *(f"m{k}" for k in range(count))]
    return "".join(f"  {b}: {link.format(a)}\n" for a, b in pairwise(names))


def beside(muscles):
    """The study with more muscles."""
    return STUDY.replace("  wide:", muscles + "  wide:")


BOMB = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]\n" for k in range(1, 12)
)
MERGES = (
    "b: &b {" + ", ".join(f"k{k}: 1" for k in range(2000)) + "}\n"
    "" + "".join(f"c{k}: {{<<: *b}}\n" for k in range(2000))
)
LARGE = {
    # name: text, what is said of it (None: nothing, it is a study)
    "50 MB": ("x" * 50_000_000, "too large"),
    "brackets": ("[" * 100_000, "nested too deeply"),
    "braces": ("{a: " * 100_000, "nested too deeply"),
    "dashes": ("- " * 100_000, "nested too deeply"),
    "aliases": (BOMB, "100000 values"),
    "merges": (MERGES, "100000 keys"),
    "bases": (beside(chain(3000, "{{base: {}}}")), None),
    "angles": (beside(chain(3000, "{{base: one, angle_of: {}}}")), None),
    "circle": (
        beside(chain(3000, "{{base: {}}}").replace("base: one", "base: m2999")),
        "no circle",
    ),
    "nameless bases": (beside(chain(3000, "{{base: not_{}}}")), "nearest"),
    "negative": (beside(chain(3000, "{{base: one, length: -1}}#{}")), "> 0"),
    "values": (changed("[0.2, 0.3]", str([k / 1e4 for k in range(20_000)])), "at most 1000"),
    "names": (changed("[one]", f"[{', '.join(f'o{k}' for k in range(20_000))}]"), "one, wide"),
    "curves": (
        beside(chain(20, "{{base: {}}}"))
        .replace("[one]", f"[{', '.join(f'm{k}' for k in range(20))}]")
        .replace("pressure: [0.2, 0.3]", "pressure: {from: 0, to: 0.999, step: 0.001}"),
        "at most 10000 curves",
    ),
}


@pytest.mark.parametrize("name", LARGE)
def test_large_files_are_answered_soon(tmp_path, name):
    text, said = LARGE[name]
    start = time.process_time()
    found = answer(tmp_path, text)
    assert time.process_time() - start < 20
    assert said in found if said else isinstance(found, Plan)


def test_what_is_no_file(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    for name in (
        "pipe",
        "loop",
        ".",
        "nothing",
        "pipe/study.yaml",
        "n" * 5000,
        "a\0b",
        "/dev/zero",
    ):
        with pytest.raises(StudyError, match="cannot be read"):
            load(tmp_path / name)


@pytest.mark.parametrize("text", ["", "\ufeff" + STUDY, STUDY.replace("\n", "\r\n"), "# nothing"])
def test_line_ends_and_marks(tmp_path, text):
    assert isinstance(answer(tmp_path, text), Plan) == ("muscles" in text)


def test_what_is_no_text_has_its_line(tmp_path):
    assert "study.yaml:2: cannot be read" in refusal(tmp_path, b"materials:\n  a: \xe9\n")


@pytest.mark.parametrize("path", ["config/config.yaml", "config/smoke/study.yaml"])
def test_another_reader_reads_the_same(path):
    text = (ROOT / path).read_text()
    assert repr(plain_yaml.read(text).plain()) == repr(YAML(typ="safe").load(text))


WORDS = {
    "012": 12, "1_000": 1000, "0x1F": 31, "0o17": 15, "1e-9": 1e-9, ".5": 0.5, "1.": 1.0, "+1": 1,
    "on": "on", "yes": "yes", "1:30": "1:30", "2020-01-01": "2020-01-01", "1e": "1e", "-": "-",
    "~": None, "null": None, "True": True, "false": False, "-.inf": -float("inf"),
}  # fmt: skip


@pytest.mark.parametrize("word", WORDS)
def test_yaml_1_2(word):
    found = plain_yaml.read(f"[{word}, '{word}']").plain()
    assert found == [WORDS[word], word]
    assert type(found[0]) is type(WORDS[word])


def test_merges_and_aliases():
    text = "a: &a {x: 1, y: 2}\nb: {<<: *a, y: 3}\nc: {<<: [{x: 0}, *a]}\nd: *a"
    found = plain_yaml.read(text)
    assert found.plain() == {
        "a": {"x": 1, "y": 2},
        "b": {"y": 3, "x": 1},
        "c": {"x": 0, "y": 2},
        "d": {"x": 1, "y": 2},
    }
    assert found.value["b"].lines == {"y": 2, "x": 1}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a: 1\na: 2\nb: !!x 1\nb: 3", ["yaml:2: found", "yaml:3: the tag !!x", "yaml:4: found"]),
        ("a: 1\n---\nb: 2", ["study.yaml:2: a second document"]),
        ("%YAML 1.1\n---\na: 1", ["YAML 1.2 is read"]),
        ("a: &a {<<: *a}", ["study.yaml:1: the alias *a stands within"]),
        ("? [1]\n: 2", ["study.yaml:1: a key is a word"]),
    ],
)  # fmt: skip
def test_the_text_itself(tmp_path, text, said):
    found = refusal(tmp_path, text)
    assert [part for part in said if part not in found] == []


def test_all_errors_of_a_file_at_once(tmp_path):
    text = STUDY
    for old, new in [
        ("kappa: 1000", "kapa: 1000"),
        ("wall_thickness: 2", "wall_thickness: -2"),
        ("length: 300", "length: -300"),
        ("material: nbr", "material: nbrr"),
        ("end: butt", "end: but"),
        ("tolerance: 1e-9", "tolerance: 0"),
        ("[0.2, 0.3]", "[-1]"),
        ("to: 0.1", "to: 0.7"),
    ]:
        assert old in text
        text = text.replace(old, new, 1)
    said = refusal(tmp_path, text)
    named = [
        line.split(": ")[1].split(" ")[0] for line in said.splitlines() if "study.yaml" in line
    ]
    assert named == [
        "materials.nbr.kapa",
        "muscles.one.wall_thickness",
        "muscles.one.length",
        "muscles.one.material",
        "variants.paper.effects.end",
        "numerics.newton.tolerance",
        "scenes.fig04.pressure",
        "scenes.fig04.contraction",
    ]


def test_errors_of_cases_and_of_entries_at_once(tmp_path):
    text = changed("[membrane, solid]", "[geometric]").replace("[one]", "[one, bare]")
    said = refusal(tmp_path, text.replace("c10: 0.345083", "c10: -1"))
    assert "materials.nbr.c10" in said
    text = text.replace("\nlimits:", "\nlimits: {wall_time: 0}\n#")
    said = refusal(tmp_path, text)
    assert "limits.wall_time" in said
    assert "scenes.fig04.models" in said


def test_a_key_that_is_no_word_hides_nothing(tmp_path):
    said = refusal(tmp_path, changed("end: butt", "end: but") + "4: 1\n")
    assert "variants.paper.effects.end" in said
    assert "study.yaml:28: 4 is no key here" in said


def test_a_key_of_a_memory_that_is_none_is_refused_with_those_there_are(tmp_path):
    said = refusal(tmp_path, changed("kappa: 1000", "memory: {per_decade: 0.06, form: 1}"))
    assert "materials.nbr.memory.form is no key here\n  allowed: per_decade, from, to" in said


def test_an_entry_whose_name_is_a_number_is_refused_with_what_is_in_it(tmp_path):
    text = changed("\nmuscles:", "\n  1.5: {c10: 0.3, c01: 0.1, foo: 1}\nmuscles:")
    assert "materials.1.5.foo is no key here" in refusal(tmp_path, text)


def test_of_many_errors_the_first_are_said(tmp_path):
    said = refusal(tmp_path, beside(chain(30, "{{base: one, length: -1}}#{}")))
    assert said.endswith("... and 22 more")


def test_an_error_is_said_once_where_it_was_written(tmp_path):
    said = refusal(tmp_path, changed("length: 300", "length: -300"))  # wide and bare inherit it
    assert said.count("refused") == 1
    said = refusal(tmp_path, changed("inner_diameter: 40,", "wall_thickness: 0.5,"))
    assert "study.yaml:8: muscles.one.layer_depths" in said  # fits one, but not its heir
    assert "in wide: " in said


WRITTEN = [
    # what is written, and the key that is named of it; never one that follows from it
    ("c10: 0.345083, c01: 0.083805, kappa: 1000", "c10: 20, c01: 0.1", "materials.nbr.c10"),
    ("c10: 0.345083, c01: 0.083805, kappa: 1000", "c10: 0.1, c01: 20", "materials.nbr.c01"),
    ("kappa: 1000", "kappa: 1", "materials.nbr.kappa"),
    ("c10: 0.345083", "c10: 200", "materials.nbr.c10"),
    ("length: 300", "length: 190000\n    cap_length: 8", None),
    ("wall_thickness: 2", "wall_thickness: -2", "muscles.one.wall_thickness"),
    ("length: 300", "length: 300\n    cap_length: 1000000", "muscles.one.cap_length"),
    ("newton: {tolerance: 1e-9}", "section: {body_step: 1e-4}", "numerics.section.body_step"),
    ("newton: {tolerance: 1e-9}", "meridian: {growth: 1.00001}", "numerics.meridian.growth"),
    ("lead: 144", "angle: 1e-9", "muscles.one.angle"),
    ("lead: 144", "angle: 89.99999999", "muscles.one.angle"),
    ("[0.3, 0.9]", "[1e-12, 2e-12]", None),
]


@pytest.mark.parametrize(("old", "new", "key"), WRITTEN)
def test_keys_that_were_written_are_named(tmp_path, old, new, key):
    found = answer(tmp_path, changed(old, new))
    if key is not None:
        assert f"{key} = " in found
    if isinstance(found, str):
        assert len(found.splitlines()) <= 3


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("[one]", "one"),
        ("[0.2, 0.3]", "0.2"),
        ("{from: 0, to: 0.1, step: 0.05}", "0.1"),
        ("[membrane, solid]", "solid"),
        ("[default, paper]", "paper"),
        ("[default, paper]", "default\n    quantities: stiffness"),
        ("threads: 60", "threads: 60.0"),
        ("wall_time: 60", "wall_time: 60.0"),
        ("newton: {tolerance: 1e-9}", "section: {refinement: 2.0, rows: [1.0, 2.0, 1]}"),
    ],
)
def test_one_value_is_a_list_of_one_and_30_0_is_30(tmp_path, old, new):
    loose = answer(tmp_path, changed(old, new))
    strict = new.replace(".0", "")
    if ":" not in old or old.startswith("{"):
        key, colon, value = strict.rpartition(": ")
        strict = f"{key}{colon}[{value}]".replace("default\n", "[default]\n")
    assert isinstance(loose, Plan), loose
    assert loose.cases.keys() == answer(tmp_path, changed(old, strict)).cases.keys()


GUESSED = [
    # the unit a value was given in, and the value that may have been meant; refused or warned of
    ("[0.2, 0.3]", "[200, 300]", "200 kPa, that is 0.2"),
    ("[0.2, 0.3]", "300000", "300000 Pa, that is 0.3"),
    ("[0.2, 0.3]", "[2, 3]", "2 bar, that is 0.2"),
    ("[0.2, 0.3]", "45", "45 psi, that is 0.31"),
    ("to: 0.1, step: 0.05", "to: 10, step: 5", "5 %, that is 0.05"),
    ("    models: [membrane, solid]\n", "    tolerance: 2\n", "2 %, that is 0.02"),
    ("length: 300", "length: 0.3", "0.3 m, that is 300"),
    ("length: 300", "length: 0.2", "0.2 m, that is 200"),
    ("length: 300", "length: 300000", "300000 um, that is 300"),
    ("inner_diameter: 20", "inner_diameter: 0.02", "0.02 m, that is 20"),
    ("inner_diameter: 20", "inner_diameter: 20000", "20000 um, that is 20"),
    ("wall_thickness: 2", "wall_thickness: 0.002", "0.002 m, that is 2"),
    ("[0.3, 0.9]", "[0.0003, 0.0009]", "0.0003 m, that is 0.3"),
    ("[0.3, 0.9]", "[300, 900]", "300 um, that is 0.3"),
    ("[0.3, 0.9]", "[20.6, 21.8]", "depths are 0.3, 0.9"),
    ("lead: 144", "lead: 0.144", "0.144 m, that is 144"),
    ("lead: 144", "angle: 0.433", "0.433 rad, that is 24.8"),
    ("thread_stiffness: 315", "thread_stiffness: 0.315", "0.315 kN would be 315 N"),
    ("c10: 0.345083", "c10: 345.083", "345.083 kPa, that is 0.345083"),
    ("c10: 0.345083", "c10: 345083", "345083 Pa, that is 0.345083"),
    ("c10: 0.345083", "c10: 0.000345083", "0.000345083 GPa, that is 0.345083"),
    ("c01: 0.083805", "c01: 83.805", "83.805 kPa, that is 0.083805"),
    ("kappa: 1000", "kappa: 2", "2 GPa, that is 2000"),
    ("kappa: 1000", "kappa: 1000000", "1e+06 kPa, that is 1000"),
    ("memory: 500", "memory: 2", "2 GB, that is 2000"),
]


@pytest.mark.parametrize(("old", "new", "meant"), GUESSED)
def test_another_unit_is_guessed(tmp_path, old, new, meant):
    found = answer(tmp_path, changed(old, new))
    said = found if isinstance(found, str) else "\n".join(found.study.warnings)
    assert meant in said.replace("3e+05", "300000").replace("1000000 kPa", "1e+06 kPa")


LOADS = changed("path: isobaric", "path: isotonic").replace("  fig04:", "  fig08:").replace(
    "contraction: {from: 0, to: 0.1, step: 0.05}", "load: 200"
)  # fmt: skip


@pytest.mark.parametrize(
    ("load", "meant"), [("0.2", "0.2 kN"), ("200000", "200000 mN"), ("200", "")]
)
def test_loads_are_judged_by_what_the_muscle_can_pull(tmp_path, load, meant):
    said = "\n".join(warnings(tmp_path, LOADS.replace("load: 200", f"load: {load}")))
    assert (meant in said.replace("2e+05", "200000")) if meant else not said


def test_usual_values_are_not_warned_of(tmp_path):
    assert warnings(tmp_path, STUDY) == ()
    for path in ("config/config.yaml", "config/smoke/study.yaml"):
        assert read(ROOT / path).study.warnings == ()
    small = STUDY  # a hundredth of the muscle
    for old, new in [
        ("inner_diameter: 20", "inner_diameter: 0.2"),
        ("wall_thickness: 2", "wall_thickness: 0.02"),
        ("length: 300", "length: 3"),
        ("[0.3, 0.9]", "[0.003, 0.009]"),
        ("lead: 144", "lead: 1.44"),
        ("thread_stiffness: 315", "thread_stiffness: 0.0315"),
        ("inner_diameter: 40", "inner_diameter: 0.4"),
    ]:
        small = small.replace(old, new, 1)
    assert warnings(tmp_path, small) == ()


def test_a_guess_is_a_usual_value():
    for key, usual in units.USUAL.items():
        inside = (usual.low * usual.high) ** 0.5 if usual.low else usual.high / 2
        assert units.guess(key, inside) == ""
        assert units.guess(key, [True, "x", None, float("nan"), 10**400]) == ""


def test_is_number_of_anything():
    assert not is_number(10**400)
    assert is_number(10**300)


SCENES = ("curves", "stress", "walls", "states", "style", "labels", "figure", "force_contraction",
          "stress_views", "muscle_drawing", "__init__")  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_only_figures_are_figures(tmp_path, name):
    assert not figure_needs.has_own(name)
    assert isinstance(answer(tmp_path, changed("  fig04:", f"  {name}:")), Plan)


def test_every_figure_of_the_paper_says_what_it_needs():
    figures = {path.stem for path in (ROOT / "workflow/figures").glob("fig[0-9]*.py")}
    assert figures >= set(figure_needs.NEEDS) >= {f"fig{n:02}" for n in range(3, 14)}
    assert all(map(figure_needs.has_own, figures))


UNFIT = [
    # figure, path, what is said
    ("fig03", "isobaric", "no path: fig03"),
    ("fig04", "isometric", "isobaric, which fig04 shows"),
    ("fig05", "isobaric", "with stress, which fig05 shows"),
    ("fig06", "isobaric", "isometric, which fig06 shows"),
    ("fig07", "isobaric", "isometric, which fig07 shows"),
    ("fig08", "isobaric", "isotonic, which fig08 shows"),
    ("fig09", "isometric", "isobaric, which fig09 shows"),
    ("fig10", "isometric", "isobaric, which fig10 shows"),
    ("fig11", "isobaric", "at least 2 muscles in fig11"),
    ("fig13", "isobaric", "isotonic, which fig13 shows"),
]


@pytest.mark.parametrize(("figure", "path", "said"), UNFIT)
def test_a_figure_that_cannot_be_drawn_is_refused(tmp_path, figure, path, said):
    text = changed("  fig04:", f"  {figure}:").replace("path: isobaric", f"path: {path}")
    found = refusal(tmp_path, text)
    assert said in found
    assert f"scenes.{figure}." in found


def test_two_curves_of_one_name_are_refused(tmp_path):
    text = STUDY.replace("[membrane, solid]", "[cylinder]").replace("[default, paper]", "default")
    text = text.replace("  paper:", "  default_twist_on: {effects: {threads: two_way}}\n  paper:")
    scene = text[text.index("  fig04:") :]
    other = scene.replace("fig04", "other").replace("default", "default_twist_on")
    assert isinstance(answer(tmp_path, text + other), Plan)
    said = refusal(
        tmp_path, text + other + scene.replace("fig04", "third") + "    effects: {twist: on}\n"
    )
    assert "scenes.third.variants = ['default'] is refused" in said
    assert "is two curves" in said


@pytest.mark.parametrize("name", ["fig4", "FIG04", "fig04b", "fig99", "figure4"])
def test_a_scene_that_looks_like_a_figure_and_is_none_is_named(tmp_path, name):
    made = answer(tmp_path, changed("  fig04:", f"  {name}:"))
    assert isinstance(made, Plan), made
    assert any(f"scenes.{name} has no figure of its own" in line for line in made.study.warnings)


@pytest.mark.parametrize("text", ["", "null", "[1, 2]", "5", "a: 1"])
def test_a_file_that_is_no_study(tmp_path, text):
    said = refusal(tmp_path, text)
    assert "study.yaml:  " not in said
    assert "materials, muscles, variants" in said or "materials is missing" in said


CALIBRATION = STUDY + "calibration:\n  mine: {muscle: one}\n"
GOOD = "pressure_MPa,contraction,force_N\n0.3,0,700\n0.3,0.1,400\n0.3,0.2,100\n"
REFERENCES = [
    # entry, what is named, what is said
    ("reference: festo", "reference", "festo_musclesim, martens2017, or a .csv"),
    ("reference: none.csv", "reference", "there is no such file"),
    ("reference: .", "reference", "cannot be read"),
    ("reference: ./", "reference", "cannot be read"),
    ('reference: "a\\0b.csv"', "reference", "cannot be read"),
    ("reference: '{b}.csv'", "reference", "a path without { and }"),
    ("reference: FOLDER/empty.csv", "reference", "nothing measured is in it"),
    ("reference: FOLDER/words.csv", "reference", "words.csv:2: not all of it are numbers"),
    ("reference: FOLDER/good.csv, fit_pressure: 0.2", "fit_pressure", "no force at 0.2 MPa"),
    ("reference: FOLDER/good.csv, report_pressure: [0.3, 0.4]", "report_pressure", "at 0.4 MPa"),
    (
        "reference: FOLDER/far.csv, fit_pressure: [0.3]",
        "fit_pressure",
        "no force at 0.3 MPa",
    ),
    ("reference: FOLDER/two.csv, fit: [c10, c01, thread_stiffness]", "fit", "has 2 of them"),
    ("fit_pressure: 300", "fit_pressure", "300 kPa, that is 0.3"),
    ("fit: c10, bounds: {c10: [0.1, 100]}", "bounds.c10", "at least 50 shear moduli"),
    ("muscle: bare", "muscle", "with a braid"),
]


@pytest.mark.parametrize(("entry", "key", "said"), REFERENCES)
def test_calibrations_that_cannot_be_made(tmp_path, entry, key, said):
    (tmp_path / "good.csv").write_text(GOOD)
    (tmp_path / "empty.csv").write_text("pressure_MPa,contraction,force_N\n")
    (tmp_path / "words.csv").write_text(GOOD.replace("700", "many"))
    (tmp_path / "far.csv").write_text(
        GOOD.replace("0.1,", "0.4,").replace(",0,", ",0.3,").replace("0.2,", "0.5,")
    )
    (tmp_path / "two.csv").write_text(
        "pressure_MPa,contraction,force_N\n0.3,0.03,700\n0.3,0.07,400\n"
    )
    entry = entry.replace("FOLDER", str(tmp_path))
    if "reference" not in entry:
        entry += ", reference: festo_musclesim"
    if not entry.startswith("muscle"):
        entry = f"muscle: one, {entry}"
    found = refusal(tmp_path, CALIBRATION.replace("muscle: one}", f"{entry}}}"))
    assert f"study.yaml:29: calibration.mine.{key}" in found
    assert said in found


def test_a_calibration_of_a_muscle_that_is_refused(tmp_path):
    text = CALIBRATION.replace("muscle: one", "muscle: one, reference: nothing.csv")
    said = refusal(tmp_path, text.replace("length: 300", "length: -300"))
    assert said.count("refused") == 1


def test_a_file_of_forces_that_fits(tmp_path):
    (tmp_path / "good.csv").write_text(GOOD)
    entry = f"muscle: one, reference: {tmp_path}/good.csv"
    made = answer(tmp_path, CALIBRATION.replace("muscle: one", entry))
    assert isinstance(made, Plan), made


@pytest.mark.parametrize(
    ("given_config", "said"),
    [
        ({"stduy": "x"}, "allowed: study, batches (nearest: study)"),
        ({"study": 5}, "study = 5 is refused"),
        ({"study": None}, "refused"),
        ({"study": ["a"]}, "refused"),
        ({"study": True}, "refused"),
    ],
)
def test_what_a_run_is_told(given_config, said):
    with pytest.raises(StudyError) as caught:
        given_settings(given_config)
    assert said in str(caught.value)
    assert given_settings({}) == ("config/config.yaml", 1)
    assert given_settings({"study": "-x.yaml"})[0] == "./-x.yaml"


def snakemake(folder, *arguments):
    """Status and the lines of a dry run, but what Snakemake says of its profile."""
    done = subprocess.run(
        [sys.executable, "-m", "snakemake", "-n", "-s", ROOT / "Snakefile", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    return done.returncode, (done.stdout + done.stderr).splitlines()


@pytest.mark.parametrize(
    ("option", "said"),
    [
        ("stduy=x", "nearest: study"),
        ("study=5", "study = 5 is refused"),
        ("study=pipe", "no regular file"),
        ("study=nothing.yaml", "there is no such file"),
        ("study=bad.yaml", "bad.yaml:7: muscles.one.length"),
    ],
)
def test_a_run_ends_with_the_message_alone(tmp_path, option, said):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "bad.yaml").write_text(changed("length: 300", "length: 1" + "0" * 399))
    status, lines = snakemake(tmp_path, "--config", option)
    assert status == 1
    assert said in "\n".join(lines)
    assert len(lines) <= SCREEN
    assert "Traceback" not in "\n".join(lines)


def test_braces_and_blanks_in_the_names_of_files(tmp_path):
    name, forces = "a {muscle} 'q' [x].yaml", "b [c] 'd'.csv"
    (tmp_path / forces).write_text(GOOD)
    entry = f'muscle: one, reference: "{forces}"'
    text = CALIBRATION.replace("[0.2, 0.3]", "[2, 3]").replace("muscle: one", entry)
    (tmp_path / name).write_text(text)
    for targets in ([], ["--", "calibrate"]):
        status, lines = snakemake(tmp_path, "--quiet", "all", "--config", f"study={name}", *targets)
        assert status == 0, lines
        assert sum("is unusual; perhaps 2 bar" in line for line in lines) == 1


def test_no_rule_takes_the_name_of_the_study_for_a_pattern():
    rules = {path.name: path.read_text() for path in (ROOT / "workflow/rules").glob("*.smk")}
    assert [name for name, text in rules.items() if "study=STUDY" in text] == []


NBR = "{c10: 0.345083, c01: 0.083805, kappa: 1000}"
LAWS_WRITTEN = [
    "{law: mooney_rivlin, c10: 0.345083, c01: 0.083805}",
    "{law: neo_hooke, c10: 0.43}",
    "{law: yeoh, c1: 0.4, c2: -0.02, c3: 0.005}",
    "{law: rivlin, c10: 0.345, c01: 0.084, c11: 0.01, c20: -0.01}",
    "{law: ogden, convention: textbook, mu: [0.63, 0.0012, -0.01], alpha: [1.3, 5, -2]}",
    "{law: ogden, convention: abaqus, mu: 0.86, alpha: 2}",
    "{law: gent, mu: 0.86, jm: 30}",
    "{law: arruda_boyce, mu: 0.86, lambda_m: 3}",
]
WRONG_RUBBERS = [  # what stands there, what is said
    ("{law: ogden, mu: [1], alpha: [2]}", ["convention", "must be given"]),
    ("{law: ogden, convention: old, mu: [1], alpha: [2]}", ["convention", "textbook, abaqus"]),
    ("{law: ogden, convention: abaqus, mu: [1], alpha: [2, 3]}", ["alpha", "as many numbers"]),
    ("{law: ogden, convention: textbook, mu: [1], alpha: [0]}", ["alpha", "not 0"]),
    ("{law: ogden, convention: textbook, mu: [1, 1, 1, 1, 1], alpha: [1]}", ["mu", "1 to 4"]),
    ("{law: ogden, convention: textbook, mu: [-1], alpha: [2]}", ["shear modulus, -1 MPa"]),
    ("{law: ogden, convention: textbook, mu: [630, 1], alpha: [1.3, 5]}", ["mu", "kPa"]),
    ("{law: gent, mu: 0.86, jm: 0}", ["jm", "> 0"]),
    ("{law: arruda_boyce, mu0: 0.86, lambda_m: 3}", ["mu0", "nearest: mu"]),
    ("{law: rivlin, c01: 0.3}", ["c10", "must be given"]),
]


@pytest.mark.parametrize("entry", LAWS_WRITTEN)
def test_every_law_can_be_written(tmp_path, entry):
    models = "[cylinder, membrane, solid]"
    text = changed(NBR, entry).replace("[membrane, solid]", models).replace(", paper]", "]")
    assert len(answer(tmp_path, text).cases) == 6


@pytest.mark.parametrize(("entry", "said"), WRONG_RUBBERS)
def test_a_wrong_rubber_is_refused_by_its_key(tmp_path, entry, said):
    found = refusal(tmp_path, changed(NBR, entry))
    assert "materials.nbr" in found
    for each in said:
        assert each in found


@pytest.mark.parametrize("number", [3, 4])
def test_lists_of_terms_are_not_calibrated(tmp_path, number):
    law = LAWS_WRITTEN[number]
    key = "mu" if "ogden" in law else "c01"
    text = changed(NBR, law)
    text += f"calibration: {{a: {{muscle: one, reference: martens2017, fit: [{key}]}}}}\n"
    found = refusal(tmp_path, text)
    assert "calibration.a.fit" in found
    assert "thread_stiffness" in found


def test_the_cell_refuses_ogden(tmp_path):
    text = changed(NBR, LAWS_WRITTEN[4]).replace("[membrane, solid]", "[cell]")
    found = refusal(tmp_path, text.replace(", paper]", "]"))
    assert "scenes.fig04.models" in found
    assert "principal stretches" in found
