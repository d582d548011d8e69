"""A study file is read as it stands or refused with a message that says where and what."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from solver.numerics import KINDS
from workflow.data import bench
from workflow.plan.plan import plan
from workflow.study import schema
from workflow.study.errors import StudyError
from workflow.study.study import load

ROOT = Path(__file__).parents[3]
STUDY = """\
materials:
  nbr: {c10: 0.345083, c01: 0.083805, kappa: 1000}
muscles:
  one:
    inner_diameter: 20
    wall_thickness: 2
    length: 300
    layer_depths: [0.3, 0.9]
    threads: 60
    lead: 144
    thread_stiffness: 315
    material: nbr
  wide: {base: one, inner_diameter: 40, angle_of: one}
  bare: {base: one, threads: none}
variants:
  paper: {effects: {end: butt, threads: two_way}}
numerics:
  newton: {tolerance: 1e-9}
limits: {wall_time: 60, memory: 500}
scenes:
  fig04:
    path: isobaric
    muscles: [one]
    pressure: [0.2, 0.3]
    contraction: {from: 0, to: 0.1, step: 0.05}
    models: [membrane, solid]
    variants: [default, paper]
"""


def study_file(folder, text):
    path = folder / "study.yaml"
    path.write_text(text)
    return path


def changed(old, new):
    assert STUDY.count(old) >= 1, old
    return STUDY.replace(old, new, 1)


def refusal(folder, text):
    with pytest.raises(StudyError) as caught:
        plan(load(study_file(folder, text)))
    return str(caught.value)


ONE = "muscles.one."
FIG = "scenes.fig04."
REFUSED = [
    # (a line of the study, what stands there instead, the key named, what is said of it)
    ("length: 300", "lenght: 300", ONE + "lenght", "nearest: length"),
    ("length: 300", "length: 300\n    colour: red", ONE + "colour", "no key here"),
    ("    length: 300\n", "", ONE + "length", "must be given"),
    ("    material: nbr\n", "", ONE + "material", "must be given"),
    ("    layer_depths: [0.3, 0.9]\n", "", ONE + "layer_depths", "must be given"),
    ("    thread_stiffness: 315\n", "", ONE + "thread_stiffness", "must be given"),
    (
        "length: 300",
        "length: 300 mm",
        ONE + "length",
        "perhaps: 300, with a decimal point and with",
    ),
    ("length: 300", "length: 30 cm", ONE + "length", "perhaps: 30 cm, that is 300 mm"),
    ("wall_thickness: 2", "wall_thickness: 2,5", ONE + "wall_thickness", "perhaps: 2.5, with a"),
    ("pressure: [0.2, 0.3]", "pressure: [2 bar, 3 bar]", FIG, "perhaps: 2 bar, that is 0.2 MPa"),
    ("  fig04:", "  müskel:", "scenes.müskel is no name", "a to z"),
    ("length: 300", 'length: "300"', ONE + "length", "valid number"),
    ("length: 300", "length: true", ONE + "length", "valid number"),
    ("length: 300", "length: .nan", ONE + "length", "finite number"),
    ("length: 300", "length: .inf", ONE + "length", "finite number"),
    ("length: 300", "length: -300", ONE + "length", "> 0 (mm)"),
    ("length: 300", "length: [300]", ONE + "length", "valid number"),
    ("wall_thickness: 2", "wall_thickness: 0", ONE + "wall_thickness", "> 0 (mm)"),
    ("wall_thickness: 2", "wall_thickness: -2", ONE + "wall_thickness", "> 0 (mm)"),
    ("inner_diameter: 20", "inner_diameter: -20", ONE + "inner_diameter", "> 0 (mm)"),
    ("[0.3, 0.9]", "[0.3, 2.1]", ONE + "layer_depths", "less than the wall thickness of 2"),
    ("[0.3, 0.9]", "[0.9, 0.3]", ONE + "layer_depths", "rising"),
    ("[0.3, 0.9]", "[0, 0.9]", ONE + "layer_depths", "more than 0"),
    ("[0.3, 0.9]", "[0.3]", ONE + "layer_depths", "[0.3] is refused\n  allowed: a list of two"),
    ("[0.3, 0.9]", "0.3", ONE + "layer_depths", "0.3 is refused\n  allowed: a list of two"),
    ("[0.3, 0.9]", "[0.3, 0.9, 1.2]", ONE + "layer_depths", "[0.3, 0.9, 1.2] is refused"),
    ("threads: 60", "threads: 0", ONE + "threads", "integer >= 1"),
    ("threads: 60", "threads: 60.5", ONE + "threads", "integer >= 1"),
    ("threads: 60", "threads: many", ONE + "threads", "or none"),
    ("threads: none", "threads: none, lead: 100", "muscles.bare.lead", "threads: none"),
    ("lead: 144", "lead: 0", ONE + "lead", "> 0 (mm)"),
    ("lead: 144", "angle: 0", ONE + "angle", "more than 0 and less than 90"),
    ("lead: 144", "angle: 90", ONE + "angle", "less than 90"),
    ("lead: 144", "lead: 144\n    angle: 24.8", ONE + "angle", "exactly one of"),
    ("    lead: 144\n", "", ONE + "lead", "exactly one of"),
    ("thread_stiffness: 315", "thread_stiffness: 0", ONE + "thread_stiffness", "> 0 (N)"),
    ("material: nbr", "material: nbrr", ONE + "material", "nearest: nbr"),
    ("base: one", "base: won", "muscles.wide.base", "one, wide, bare (nearest: one)"),
    ("base: one, inner", "base: wide, inner", "muscles.wide.base", "wide -> wide"),
    ("angle_of: one", "angle_of: wide", "muscles.wide.angle_of", "wide -> wide"),
    ("angle_of: one", "angle_of: bare", "muscles.wide.angle_of", "with a braid"),
    ("angle_of: one", "angle_of: none", "muscles.wide.angle_of", "nearest"),
    ("  wide:", "  one:", "study.yaml:13", "duplicate key"),
    ("  fig04:", "  'fig 04':", "scenes.fig 04 is no name", "letters, digits"),
    ("  fig04:", "  ../fig04:", "scenes.../fig04 is no name", "letters, digits"),
    ("  fig04:", "  -fig04:", "scenes.-fig04 is no name", "letters, digits"),
    ("  fig04:", "  .fig04:", "scenes..fig04 is no name", "letters, digits"),
    ("  fig04:", "  $(reboot):", "scenes.$(reboot) is no name", "letters, digits"),
    ("  fig04:", '  "a\\nb":', r"scenes.'a\nb' is no name", "letters, digits"),
    ("  fig04:", '  "a\'b":', "is no name", "letters, digits"),
    ("  fig04:", "  " + "a" * 65 + ":", "is no name", "at most 64"),
    ("  fig04:", "  4:", "scenes.4", ""),
    ("  wide:", "  wide one:", "muscles.wide one is no name", "letters, digits"),
    ("end: butt", "end: but", "variants.paper.effects.end", "nearest: butt"),
    ("effects: {end", "effect: {end", "variants.paper.effect", "nearest: effects"),
    ("tolerance: 1e-9", "tolerance: 0", "numerics.newton.tolerance", "from 1e-12"),
    ("tolerance: 1e-9", "tolerances: 1e-9", "numerics.newton.tolerances", "nearest: tolerance"),
    ("newton: {", "newtons: {", "numerics.newtons", "nearest: newton"),
    ("newton: {tolerance: 1e-9}", "section: {rows: [1, 0, 1]}", "numerics.section.rows", ">= 1"),
    ("newton: {tolerance: 1e-9}", "section: {rows: 1}", "numerics.section.rows", "three numbers"),
    ("newton: {tolerance: 1e-9}", "section: {growth: 0.5}", "numerics.section.growth", ">= 1"),
    ("wall_time: 60", "wall_time: 0", "limits.wall_time", "greater than 0"),
    ("memory: 500", "memory: 1 GB", "limits.memory", "integer"),
    ("path: isobaric", "path: isobar", FIG + "path", "nearest: isobaric"),
    ("    path: isobaric\n", "", FIG + "pressure", "without a path"),
    ("[one]", "[]", FIG + "muscles", "at least one name"),
    ("[one]", "1", FIG + "muscles", "a list"),
    ("[one]", "[one, one]", FIG + "muscles", "twice"),
    ("[one]", "[onne]", FIG + "muscles", "nearest: one"),
    ("[default, paper]", "[defualt]", FIG + "variants", "nearest: default"),
    ("[membrane, solid]", "[membran]", FIG + "models", "nearest: membrane"),
    ("[membrane, solid]", "[solid, solid]", FIG + "models", "twice"),
    ("    models: [membrane, solid]\n", "    tolerance: 2\n", FIG + "tolerance", "less than 1"),
    ("[one]\n", "[bare]\n    quantities: [stress]\n", FIG + "quantities", "only by solid"),
    (
        "    muscles:",
        "    quantities: [stres]\n    muscles:",
        FIG + "quantities",
        "nearest: stress",
    ),
    ("[membrane, solid]", "[cylinder]\n    quantities: [threshold_pressure]", FIG, "isometric"),
    ("[0.2, 0.3]", "[]", FIG + "pressure", "at least one value"),
    ("[0.2, 0.3]", "[0.3, 0.30]", FIG + "pressure", "twice"),
    ("[0.2, 0.3]", "high", FIG + "pressure", "a list of finite numbers"),
    ("[0.2, 0.3]", "[0.2, high]", FIG + "pressure", "finite numbers"),
    ("[0.2, 0.3]", "[0.2, true]", FIG + "pressure", "finite numbers"),
    ("[0.2, 0.3]", "[0.2, .nan]", FIG + "pressure", "finite numbers"),
    ("[0.2, 0.3]", "[-0.2, 0.3]", FIG + "pressure", ">= 0 (MPa)"),
    ("    pressure: [0.2, 0.3]\n", "", FIG + "pressure", "must be given"),
    ("pressure: [0.2, 0.3]", "load: [100]", FIG + "pressure", "must be given"),
    ("pressure: [0.2, 0.3]", "pressure: [0.2]\n    load: [9]", FIG + "load", "is not used"),
    ("to: 0.1,", "to: 0.7,", FIG + "contraction", "from -0.5 to 0.6"),
    ("step: 0.05", "step: 0.03", FIG + "contraction", "exactly to 0.1"),
    ("step: 0.05", "step: 0", FIG + "contraction", "step above 0"),
    ("step: 0.05", "step: 1e-9", FIG + "contraction", "at most 1000"),
    ("step: 0.05", "steps: 0.05", FIG + "contraction", "exactly the keys"),
    ("from: 0,", "from: 0.2,", FIG + "contraction", "that rises"),
    ("from: 0,", "from: .nan,", FIG + "contraction", "finite"),
    ("kappa: 1000", "kappa: 1", "materials.nbr.kappa", "at least 50 shear moduli"),
    ("c10: 0.345083", "c10: -1", "materials.nbr.c10", "> 0 (MPa)"),
    ("c10: 0.345083", "C10: 0.345083", "materials.nbr.", ""),
    ("c10: 0.345083", "c10: 0,345083", "materials.nbr.345083", "no key here"),
    ("muscles:\n", "muscles: {}\nmuscels:\n", "muscels", "nearest: muscles"),
    ("limits: {wall_time: 60, memory: 500}", "limits: null", "limits", "a mapping"),
    ("[one]", "[one", "study.yaml:", "expected"),
    ("materials:", "\tmaterials:", "study.yaml:1", "a tab stands here"),
    ("materials:", "materials: !!python/object:os.system", "study.yaml", "tag"),
]


@pytest.mark.parametrize(("old", "new", "key", "said"), REFUSED)
def test_refused(tmp_path, old, new, key, said):
    message = refusal(tmp_path, changed(old, new))
    assert key in message
    assert said in message
    assert "study.yaml" in message
    assert len(message.splitlines()) <= 7
    assert max(map(len, message.splitlines())) < 400


def test_the_line_of_the_key_is_named(tmp_path):
    line = 1 + STUDY.splitlines().index("    lead: 144")
    assert f"study.yaml:{line}: muscles.one.lead" in refusal(tmp_path, changed("144", "-1"))


@pytest.mark.parametrize(
    "text", ["", "- a list", "text", "\x00", "a: *b", "a: &a [*a]", "{" * 5000]
)
def test_what_is_no_study(tmp_path, text):
    assert "study.yaml" in refusal(tmp_path, text)


def test_no_file_and_no_text(tmp_path):
    with pytest.raises(StudyError, match="no such file"):
        load(tmp_path / "study.yaml")
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00\xd8")
    with pytest.raises(StudyError, match="cannot be read"):
        load(tmp_path / "bytes.yaml")
    with pytest.raises(StudyError, match="cannot be read"):
        load(tmp_path)


def test_a_clamp_needs_a_cap(tmp_path):
    text = changed("length: 300", "length: 300\n    cap_length: 0")
    assert "muscles.one.cap_length" in refusal(tmp_path, text)
    plan(load(study_file(tmp_path, text.replace("[default, paper]", "[paper]"))))  # butt end


def test_eq_1_needs_a_braid(tmp_path):
    text = changed("[one]", "[bare]").replace("[membrane, solid]", "[geometric]")
    assert "scenes.fig04.models" in refusal(tmp_path, text)


def test_inheritance(tmp_path):
    muscles = load(study_file(tmp_path, STUDY)).muscles
    one, wide, bare = (muscles[name] for name in ("one", "wide", "bare"))
    assert wide.muscle.braid.angle == pytest.approx(one.muscle.braid.angle, rel=1e-14)
    assert wide.muscle.braid.lead == pytest.approx(279.85, abs=0.005)
    assert wide.muscle.braid.layer_diameters == (40.6, 41.8)  # exact: depths are kept
    assert wide.muscle.wall_thickness == 2
    assert bare.muscle.braid is None
    assert bare.thread is None


def test_an_angle_replaces_an_inherited_lead(tmp_path):
    text = changed("angle_of: one}", "angle: 17.1}")
    braid = load(study_file(tmp_path, text)).muscles["wide"].muscle.braid
    assert braid.layer_angles[0] < 0.2985 < braid.layer_angles[1]  # 17.1 degrees


def test_a_variant_overrides_the_numerics_of_the_study(tmp_path):
    own = "paper: {numerics: {newton: {iterations: 7}}, effects"
    study = load(study_file(tmp_path, changed("paper: {effects", own)))
    newton = study.variants["paper"].numerics.newton
    assert (newton.tolerance, newton.iterations) == (1e-9, 7)
    assert study.variants["default"].numerics.newton.iterations == 15


@pytest.mark.parametrize("program", ["cases", "explain", "gather"])
def test_programs_end_with_the_message_alone(tmp_path, program):
    path = study_file(tmp_path, changed("length: 300", "length: -300"))
    done = subprocess.run(
        [sys.executable, "-m", "workflow", program, "--study", path],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert done.stderr.startswith(f"{path}:7: muscles.one.length = -300")
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("path", ["config/config.yaml", "config/smoke/study.yaml"])
def test_shipped_studies_are_valid(path):
    assert plan(load(ROOT / path)).cases


def test_readme_has_every_key():
    text = (ROOT / "config/README.md").read_text()
    entries = (schema.MaterialEntry, schema.MuscleEntry, schema.LimitsEntry, schema.Scene)
    entries += (schema.CalibrationEntry, schema.BoundsEntry)
    keys = {key for entry in entries for key in entry.model_fields}
    keys |= {f"effects.{key}" for key in schema.EffectsEntry.model_fields}
    keys |= set(schema.QUANTITIES)
    assert {key for key in keys if f"`{key}`" not in text} == set()
    sections = set(re.findall(r"^## (\w+)", text, re.MULTILINE))
    assert sections == set(schema.StudyFile.model_fields)


def test_readme_has_the_defaults_of_numerics():
    text = (ROOT / "config/README.md").read_text()
    rows = dict(re.findall(r"^\| `(\w+\.\w+)` \|[^|]*\|[^|]*\| ([^|]*) \|", text, re.MULTILINE))
    rows = {key: value for key, value in rows.items() if key.partition(".")[0] in KINDS}
    defaults = {
        f"{kind}.{name}": field.default
        for kind, made in KINDS.items()
        for name, field in made.__dataclass_fields__.items()
    }
    with_size = {key for key, value in defaults.items() if value is None}
    assert with_size == {"clamp.thread_stiffness", "clamp.inner_stiffness", "slack.stiffness"}
    shown = {
        key: str(list(value)) if isinstance(value, tuple) else f"{value:g}"
        for key, value in defaults.items()
        if key not in with_size
    }
    assert {key: value for key, value in rows.items() if key not in with_size} == shown
    assert all("mm" in rows[key] for key in with_size)  # which tests/verification/test_scaling has


MEASURED = changed(
    "    material: nbr\n", "    material: nbr\n    reference: [martens2017, festo_musclesim]\n"
)


@pytest.mark.parametrize(
    ("derived", "keeps"),
    [
        ("thread_stiffness: 400", True),  # not measured: a calibration changes it
        ("length: 300", True),  # as it was
        ("length: 280", False),
        ("wall_thickness: 1.5", False),
        ("threads: 48", False),
        ("angle: 20", False),
        ("threads: none", False),
        ("length: 280, reference: [martens2017]", True),  # the user says so
    ],
)
def test_maps_are_of_the_muscle_that_was_measured(derived, keeps, tmp_path):
    text = MEASURED.replace("  wide:", f"  other: {{base: one, {derived}}}\n  wide:")
    muscles = load(study_file(tmp_path, text)).muscles
    assert muscles["one"].reference == ("festo_musclesim", "martens2017")
    assert bool(muscles["other"].reference) is keeps
    assert muscles["wide"].reference == ()


def test_another_rubber_is_another_muscle(tmp_path):
    text = MEASURED.replace("muscles:", "  soft: {c10: 0.028, c01: 0.018}\nmuscles:", 1)
    text = text.replace("  wide:", "  other: {base: one, material: soft}\n  wide:")
    assert load(study_file(tmp_path, text)).muscles["other"].reference == ()


def test_an_unknown_map_is_refused_by_name(tmp_path):
    text = MEASURED.replace("martens2017, ", "martens2071, ")
    message = refusal(tmp_path, text)
    assert "muscles.one.reference" in message
    assert "martens2071" in message
    assert "martens2017" in message


def test_without_a_study_it_says_how_to_name_one(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(StudyError, match=r"config\.yaml: cannot be read.*\n.*--config study=FILE"):
        load("config/config.yaml")
    with pytest.raises(StudyError, match=r"no such file\)$"):
        load("other.yaml")


GOOD = "pressure_MPa,contraction,force_N\n0.3,0,700\n0.3,0.1,400\n0.3,0.2,100\n"


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """A study that names a file of forces and one of muscles, in a folder below that of a run."""
    text = changed("    material: nbr\n", "    material: nbr\n    reference: [forces.csv]\n")
    text = text.replace("  wide:", "  many: {base: one, table: many.csv}\n  wide:")
    text = text.replace(
        "scenes:", "calibration:\n  bench: {muscle: one, reference: forces.csv}\nscenes:"
    )
    (tmp_path / "bench").mkdir()
    study_file(tmp_path / "bench", text)
    monkeypatch.chdir(tmp_path)
    return Path("bench/study.yaml")


@pytest.mark.parametrize(
    ("there", "taken"), [(["bench"], "bench/"), ([""], ""), (["bench", ""], "bench/")]
)
def test_files_are_those_beside_the_study_or_where_the_run_starts(elsewhere, there, taken):
    for folder in there:
        (Path(folder) / "forces.csv").write_text(GOOD)
        (Path(folder) / "many.csv").write_text(f"name,length\n{folder or 'here'},200\n")
    study = load(elsewhere)
    assert study.muscles["one"].reference == (f"{taken}forces.csv",)
    assert study.calibration["bench"].reference == f"{taken}forces.csv"
    assert study.source.groups["many"] == (there[0] or "here",)
    assert not list(bench.refused(study))


def test_a_file_that_is_nowhere_says_where_it_was_looked_for(elsewhere):
    with pytest.raises(
        StudyError, match=r"many\.csv: cannot be read.*\n.*bench, beside the study"
    ) as it:
        load(elsewhere)
    assert str(it.value).endswith("named by bench/study.yaml:14: muscles.many.table")
    Path("many.csv").write_text("name,length\nshort,200\n")
    said = [str(error) for error in bench.refused(load(elsewhere))]
    assert len(said) == 2
    assert all("looked for in bench, beside the study file, and " in each for each in said)
