"""Many muscles of one entry: by a sweep over values of keys, or the rows of a table."""

import time

import pytest

from workflow.data.states import OF_MUSCLE
from workflow.plan import plan
from workflow.study import sweep
from workflow.study.errors import StudyError
from workflow.study.schema import NOT_SWEPT, SWEPT, MuscleEntry
from workflow.study.study import load

from .test_study import STUDY

BARE_STUDY = STUDY.partition("scenes:")[0].partition("variants:")[0]
SCENES = """\
scenes:
  map:
    path: isobaric
    muscles: [many]
    pressure: 0.3
    contraction: [0, 0.1]
    models: cylinder
"""
SWEEP = """\
  many:
    base: one
    sweep:
      wall_thickness: [2, 1.5]
      inner_diameter: {from: 10, to: 20, step: 5}
"""
TABLE = """\
name,inner_diameter,wall_thickness,layer_depths,threads,angle,material,thread_strength
small,10,1.5,0.2 0.6,30,20,nbr,
large, 40 ,2,,,,,12.5
"""


def study(muscles, scenes=SCENES):
    return BARE_STUDY + muscles + scenes


@pytest.fixture
def planned(tmp_path, monkeypatch):
    """The plan of a text, with a table beside it."""
    monkeypatch.chdir(tmp_path)

    def make(text, table=TABLE):
        (tmp_path / "study.yaml").write_text(text)
        (tmp_path / "many.csv").write_text(table)
        return plan.read("study.yaml")

    return make


@pytest.fixture
def refused(planned):
    """The message about a text."""

    def make(*given):
        with pytest.raises(StudyError) as caught:
            planned(*given)
        return str(caught.value)

    return make


def test_a_sweep_makes_every_combination_with_a_readable_name(planned):
    made = planned(study(SWEEP))
    muscles = made.study.muscles
    names = [f"many-d{d}-t{t}" for d in (10, 15, 20) for t in (1.5, 2)]
    assert [name for name in muscles if name.startswith("many")] == names
    assert {(m.muscle.inner_diameter, m.muscle.wall_thickness) for m in muscles.values()} >= {
        (d, t) for d in (10, 15, 20) for t in (1.5, 2)
    }
    assert [entry.places[0].muscle for entry in made.cases.values()] == sorted(names)
    assert muscles["many-d10-t2"].muscle.length == 300  # of its base


def test_a_muscle_of_a_sweep_is_that_of_an_entry_of_its_own(planned):
    written = "  own: {base: one, wall_thickness: 1.5, inner_diameter: 10}\n"
    alone = planned(study(written, SCENES.replace("many", "own")))
    assert alone.cases.keys() < planned(study(SWEEP)).cases.keys()


def test_single_muscles_of_a_sweep_are_named_like_any_other(planned):
    text = study(SWEEP + "  next: {base: many-d10-t2, length: 100}\n")
    made = planned(text.replace("[many]", "[many-d10-t2, next, one]"))
    assert len(made.cases) == 3
    assert made.study.muscles["next"].muscle.inner_diameter == 10


def test_every_key_that_can_be_swept_is_a_coordinate(planned):
    """The angle by the name that it has there."""
    coordinates = {"braid_angle" if key == "angle" else key for key in SWEPT}
    assert coordinates <= OF_MUSCLE.keys()
    assert SWEPT.keys() <= MuscleEntry.model_fields.keys()
    swept = "{threads: [30, 60.0], angle: [20, 25], material: [nbr, soft]}"
    text = study("  many: {base: one, sweep: " + swept + "}\n")
    made = planned(text.replace("materials:\n", "materials:\n  soft: {c10: 0.03, c01: 0}\n"))
    names = [name for name in made.study.muscles if name.startswith("many")]
    assert names[0] == "many-n30-angle20-nbr"
    assert len(names) == 8
    assert {made.study.muscles[name].material for name in names} == {"nbr", "soft"}


def test_rows_of_a_table_are_muscles(planned):
    made = planned(study("  many: {base: one, table: many.csv}\n"))
    small, large = (made.study.muscles[name] for name in ("small", "large"))
    assert small.muscle.braid.layer_diameters == (10.4, 11.2)
    assert (small.muscle.braid.threads, small.limits.thread_strength) == (30, None)
    assert (large.muscle.inner_diameter, large.muscle.braid.threads) == (40, 60)
    assert large.limits.thread_strength == 12.5
    assert [entry.places[0].muscle for entry in made.cases.values()] == ["large", "small"]


SWEPT_WRONGLY = [
    # (the sweep, the line, the key, the value, what is said)
    ("{inner_diameter: [-1, 20]}", "muscles.many-d-1.inner_diameter = -1.0", "> 0 (mm)"),
    ("{inner_diameter: [20, x]}", "muscles.many.sweep.inner_diameter", "not 'x'"),
    ("{inner_diameter: {from: 1, to: 2}}", "muscles.many.sweep.inner_diameter", "from, to, step"),
    ("{inner_diameter: {from: 1, to: 2, step: 0.3}}", "sweep.inner_diameter", "exactly to 2"),
    ("{inner_diamter: [1]}", "muscles.many.sweep.inner_diamter is no", "nearest: inner_diameter"),
    ("{threads: [30, 30.5]}", "muscles.many.sweep.threads", "integers >= 1, <= 10000; not 30.5"),
    ("{material: [nbr, nbx]}", "muscles.many-nbx.material = 'nbx'", "nearest: nbr"),
    ("{length: [300, 300]}", "muscles.many.sweep.length", "300 is there twice"),
    ("{}", "muscles.many.sweep = {}", "values of some of inner_diameter"),
    ("5", "muscles.many.sweep = 5", "a mapping"),
    ("{wall_thickness: [0.5, 2]}", "muscles.one.layer_depths", "less than the wall thickness"),
]


@pytest.mark.parametrize(("swept", "key", "said"), SWEPT_WRONGLY)
def test_a_wrong_sweep_is_refused_where_it_is_written(refused, swept, key, said):
    text = study(f"  many:\n    base: one\n    sweep: {swept}\n")
    message = refused(text)
    line = text.splitlines().index("    layer_depths: [0.3, 0.9]") + 1
    if "muscles.one" not in key:
        line = next(k for k, x in enumerate(text.splitlines(), 1) if "sweep" in x)
    assert message.startswith(f"study.yaml:{line}: ")
    assert key in message
    assert said in message


@pytest.mark.parametrize(
    ("entry", "key", "said"),
    [
        (
            "length: 100\n    sweep: {length: [1, 2]}",
            "muscles.many.length = 100",
            "in the sweep, or",
        ),
        ("sweep: {length: [1]}\n    table: x.csv", "muscles.many.table", "either sweep or table"),
        (
            "sweep: {length: {from: 1, to: 200, step: 1}, angle: {from: 10, to: 61, step: 1}}",
            "muscles.many.sweep.length = '200 values'",
            "at most 10000 muscles of one entry, not 10400",
        ),
    ],
)
def test_what_stands_beside_a_sweep(refused, entry, key, said):
    message = refused(study(f"  many:\n    base: one\n    {entry}\n"))
    assert key in message
    assert said in message


def test_names_are_free_and_not_too_long(refused):
    taken = refused(study(SWEEP + "  many-d10-t2: {base: one}\n"))
    assert "muscles.many.sweep" in taken
    assert "there is a many-d10-t2 already" in taken
    name = "m" * 60
    long = refused(study(SWEEP, SCENES).replace("many", name))
    assert f"muscles.{name} = " in long
    assert "at most 64" in long


@pytest.mark.parametrize(("key", "said"), NOT_SWEPT.items())
def test_what_is_not_swept_says_where_it_goes(refused, key, said):
    message = refused(study(f"  many: {{base: one, sweep: {{{key}: [1, 2]}}}}\n"))
    assert f"muscles.many.sweep.{key} is no key here" in message
    assert said in message


def test_layers_and_cap_length_stand_beside_a_sweep(planned):
    layer = "{kind: embedded, depth: 0.3, sense: both, lead: 144, threads: 60}"
    entry = f"{{base: one, cap_length: 5, layers: [{layer}], sweep: {{length: [200, 300]}}}}"
    found = planned(study(f"  many: {entry}\n")).study.muscles
    swept = [m.muscle for name, m in found.items() if name.startswith("many-")]
    assert [(m.length, m.cap_length, len(m.layers)) for m in swept] == [(200, 5, 2), (300, 5, 2)]


@pytest.mark.parametrize("entry", ["{base: many}", "{base: one, angle_of: many}"])
def test_what_takes_one_muscle_takes_no_sweep(refused, entry):
    message = refused(study(SWEEP + f"  next: {entry}\n"))
    assert "one muscle; of many there are many-d10-t1.5" in message
    assert "muscles.next." in message


def test_a_calibration_takes_one_muscle(refused):
    text = study(SWEEP) + "calibration:\n  fit: {muscle: many, reference: festo_musclesim}\n"
    message = refused(text)
    assert "calibration.fit.muscle = 'many'" in message
    assert "one muscle; of many there are many-d10-t1.5" in message


ROWS_WRONG = [
    # (the table, the line and place, what is said)
    ("name,length\na,x\n", "many.csv:2: length = 'x' is refused", "a valid number"),
    ("name,length\na,300\nb,-1\n", "many.csv:3: muscles.b.length = -1", "> 0 (mm)"),
    ("name,threads\na,1.5\n", "many.csv:2: threads = 1.5 is refused", "an integer >= 1"),
    ("name,layer_depths\na,0.3\n", "many.csv:2: layer_depths = [0.3]", "a list of two numbers"),
    ("name,material\na,nbx\n", "many.csv:2: muscles.a.material = 'nbx'", "nearest: nbr"),
    ("name,lenght\na,300\n", "many.csv:1: 'lenght' is no column", "nearest: length"),
    ("name;length\na;300\n", "many.csv:1: 'name;length' is no column", "separated by commas"),
    ("length\n300\n", "many.csv:1: no column name", "every column once"),
    ("name,length,length\na,1,2\n", "many.csv:1: the column length is there twice", "once"),
    ("name,length\na,300,4\n", "many.csv:2: 3 values", "one for each of 2 columns"),
    ("name,length\n,300\n", "many.csv:2: name is missing", "letters, digits"),
    ("name,length\na b,300\n", "many.csv:2: name = 'a b' is refused", "letters, digits"),
    ("name,length\na,300\na,200\n", "many.csv:3: name = 'a' is refused", "no other muscle"),
    ("name,length\none,300\n", "many.csv:2: name = 'one' is refused", "no other muscle"),
    ("name,length\n\n", "many.csv: no muscle stands there", "at least one row"),
    ('name,length\n"a,300\n', "many.csv:2: cannot be read", "unexpected end of data"),
    ("", "many.csv:1: no column name", "every column once"),
]


@pytest.mark.parametrize(("table", "place", "said"), ROWS_WRONG)
def test_a_wrong_row_is_refused_where_it_stands(refused, table, place, said):
    message = refused(study("  many: {base: one, table: many.csv}\n"), table)
    assert message.startswith(place)
    assert said in message


def test_all_wrong_rows_are_said_at_once(refused):
    message = refused(
        study("  many: {base: one, table: many.csv}\n"), "name,length\na,x\nb,-1\nc,y\n"
    )
    assert [line.split(" is ")[0] for line in message.splitlines()[::2]] == [
        "many.csv:2: length = 'x'",
        "many.csv:3: muscles.b.length = -1.0",
        "many.csv:4: length = 'y'",
    ]


def test_a_table_that_is_not_there(refused):
    message = refused(study("  many: {base: one, table: nowhere.csv}\n"))
    assert "nowhere.csv: cannot be read (there is no such file)" in message


def test_an_unusual_value_is_said_once(planned):
    """However many muscles have it."""
    text = "  many:\n    base: one\n    sweep: {lead: [0.2, 144], length: [200, 250, 300]}\n"
    with pytest.raises(StudyError):
        planned(study(text))  # no angle of threads
    text = text.replace("lead: [0.2, 144]", "thread_stiffness: [0.3, 315]")
    said = planned(study(text)).study.warnings
    assert len(said) == 1
    assert "thread_stiffness = 0.3 is unusual" in said[0]


def test_ten_thousand_muscles_are_planned_in_linear_time(tmp_path):
    """A case takes less than 1 ms of processor time, on a busy machine more."""

    def seconds(count):
        grid = f"inner_diameter: {{from: 10, to: {9 + count / 100:g}, step: 1}}"
        walls = "wall_thickness: {from: 1.01, to: 2, step: 0.01}"
        text = f"  many: {{base: one, sweep: {{{grid}, {walls}}}}}\n"
        (tmp_path / "study.yaml").write_text(study(text))
        start = time.process_time()
        assert len(plan.read(tmp_path / "study.yaml").cases) == count
        return time.process_time() - start

    few, many = seconds(1000), seconds(4000)
    assert many < 8 * few  # four times, and half of that for a busy machine
    assert many < 8


def test_more_than_so_many_muscles_of_a_table(refused, monkeypatch):
    monkeypatch.setattr(sweep, "MOST", 1)
    message = refused(study("  many: {base: one, table: many.csv}\n"))
    assert "many.csv: more than 1 muscles" in message


def test_a_study_without_sweeps_is_as_it_was(planned):
    assert load("study.yaml" if planned(STUDY) else "").source.groups == {}
