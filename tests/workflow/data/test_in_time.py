"""Scenes in time: from their keys over plan and records to groups of the dataset."""

import numpy as np
import pytest
import xarray as xr

from geometry.readable import plain
from solver import record
from solver.friction import Friction
from solver.history import Start
from workflow.data import dataset, records
from workflow.plan import explain
from workflow.plan.plan import read
from workflow.study.errors import StudyError

from ..synthetic import MUSCLE

MATERIALS = """\
  nbr:
    c10: 0.345083
    c01: 0.083805
    memory: {per_decade: 0.06, from: 1e-2, to: 10, reference_time: 60}
  listed: {c10: 0.345083, c01: 0.083805, memory: {shares: [0.2, 0.1], times: [10, 1]}}
"""
STUDY = (
    MUSCLE.replace("  nbr: {c10: 0.345083, c01: 0.083805}\n", MATERIALS)
    + """\
scenes:
  loops:
    path: cycle
    muscles: [one]
    cycle: {held: pressure, period: [4, 40], cycles: 1, samples: 8}
    pressure: [0.2, 0.3]
    contraction: [0, 0.2]
    models: [cylinder]
  own:
    path: cycle
    muscles: [one]
    cycle:
      held: load
      table: [[0, 0.1], [1, 0.3], [2, 0.1]]
      cycles: 2
      samples: 4
      start: unloaded
      preload: 5
    load: [100]
    models: [cylinder]
  drop:
    path: transient
    muscles: [one]
    load: [49]
    transient:
      supply: [[0, 0], [0, 0.3], [1, 0.3]]
      load: [[0, 49], [0.004, 49], [0.004, 60], [1, 60]]
      mass: 5
      duration: 0.01
      step: 0.002
      valve: {conductance: 1e7, dead_volume: 1000}
    models: [cylinder]
  curve:
    path: isobaric
    muscles: [one]
    pressure: [0.3]
    contraction: [0, 0.2]
    models: [cylinder]
  hum:
    path: isobaric
    muscles: [one]
    pressure: [0.2]
    contraction: [0, 0.1]
    models: [cylinder]
    quantities: [dynamic_stiffness]
    frequency: [1, 10]
  still: # the same curve
    path: isobaric
    muscles: [one]
    pressure: [0.2]
    contraction: [0.05]
    models: [cylinder]
"""
)


def plan_of(tmp_path, old="", new=""):
    assert old in STUDY
    path = tmp_path / "study.yaml"
    path.write_text(STUDY.replace(old, new))
    return read(path)


@pytest.fixture(scope="module")
def solved(tmp_path_factory, solve_case):
    folder = tmp_path_factory.mktemp("time")
    plan = plan_of(folder)
    for key, planned in plan.cases.items():
        record.write(folder / f"{key}.h5", planned.case, solve_case(planned.case))
    return plan, records.curves_of_study(plan, folder)


def test_a_case_for_each_period_and_held_value(solved):
    plan = solved[0]
    places = list(plan.scenes["loops"])
    assert [(place.held, place.period) for place in places] == [
        (0.2, 4),
        (0.2, 40),
        (0.3, 4),
        (0.3, 40),
    ]
    assert str(places[0]) == "one cylinder cycle 0.2 MPa (loops, 4 s)"
    case = plan.cases[plan.scenes["loops"][places[0]]].case
    assert case.path.stops == (0, 0.05, 0.1, 0.15, 0.2, 0.15, 0.1, 0.05, 0)
    assert case.path.history.times[:3] == (0, 0.5, 1)
    assert case.memory.shares == (0.06,) * 4
    assert case.memory.reference_time == 60


def test_a_table_is_gone_through_in_every_cycle(solved):
    plan = solved[0]
    (key,) = plan.scenes["own"].values()
    path = plan.cases[key].case.path
    assert path.kind == "isotonic"
    assert path.stops == (0.1, 0.2, 0.3, 0.2, 0.1, 0.2, 0.3, 0.2, 0.1)
    assert path.history.times == tuple(0.5 * k for k in range(9))
    assert (path.history.start, path.history.preload) == (Start.UNLOADED, 5)


def test_a_supply_jumps_and_a_load_too(solved):
    plan = solved[0]
    (key,) = plan.scenes["drop"].values()
    path = plan.cases[key].case.path
    assert path.stops == (0, *[0.3] * 5)
    assert path.history.held == (49, 49, 49, 60, 60, 60)
    assert path.history.valve.dead_volume == 1000
    assert path.history.mass == 5


def test_a_pressure_that_jumps_is_there_twice(tmp_path):
    table = "table: [[0, 0.1], [1, 0.3], [1, 0.2], [2, 0.2]]"  # and back where a cycle ends
    plan = plan_of(tmp_path, "table: [[0, 0.1], [1, 0.3], [2, 0.1]]", table)
    (key,) = plan.scenes["own"].values()
    path = plan.cases[key].case.path
    assert path.history.times == (0, 0.5, 1, 1, 1.5, 2, 2, 2.5, 3, 3, 3.5, 4)
    assert path.stops == (0.1, 0.2, 0.3, 0.2, 0.2, 0.2, 0.1, 0.2, 0.3, 0.2, 0.2, 0.2)
    assert path.history.cycles() == [(0, 5), (5, 11)]
    supply = "valve: {conductance: 1e7, dead_volume: 1000}\n"
    plan = plan_of(tmp_path, f"      {supply}", "")
    (key,) = plan.scenes["drop"].values()
    path = plan.cases[key].case.path
    assert path.history.times[:3] == (0, 0, 0.002)
    assert path.stops[:2] == (0, 0.3)


def test_a_memory_is_left_out_by_a_scene(tmp_path):
    old = f"    {CYCLE}"
    plan = plan_of(tmp_path, old, f"{old}    effects: {{memory: off}}\n")
    places = plan.scenes["loops"]
    assert {place.variant for place in places} == {"default_memory_off"}
    assert all("memory" not in plan.cases[key].case.as_dict() for key in places.values())
    assert "memory   one: left out by the scene" in "\n".join(explain.lines(plan))
    assert plan_of(tmp_path, old, f"{old}    effects: {{memory: on}}\n").cases


def test_fields_of_all_states(tmp_path):
    wanted = "    models: [membrane]\n    quantities: [deformed_shape]\n  own"
    plan = plan_of(tmp_path, "    models: [cylinder]\n  own", wanted)
    for key in plan.scenes["loops"].values():
        case = plan.cases[key].case
        assert set(case.fields_at) == set(case.path.stops)


def test_a_sleeve_rubs(tmp_path):
    """Its friction is read in time, and nowhere else."""
    path = tmp_path / "study.yaml"
    path.write_text(RUBBING)
    plan = read(path)
    (loop,), (still,) = plan.scenes["loops"].values(), plan.scenes["curve"].values()
    assert plan.cases[loop].case.friction == Friction(coefficient=0.2, contact=0.3)
    assert "friction" not in plan.cases[still].case.as_dict()
    said = "friction one: coefficient 0.2, of crossings with a radius of 0.3 mm"
    assert said in "\n".join(explain.lines(plan))
    path.write_text(RUBBING.replace("kind: sleeve", "kind: embedded, depth: 1"))
    with pytest.raises(StudyError, match="which cross"):
        read(path)
    path.write_text(RUBBING.replace("contact: 0.3", "contact: 30"))
    with pytest.raises(StudyError, match=r"friction\.contact = 30"):
        read(path)


def test_a_curve_out_of_time_knows_no_memory(solved):
    plan = solved[0]
    (key,) = plan.scenes["curve"].values()
    assert "memory" not in plan.cases[key].case.as_dict()


def test_groups_have_a_dimension_time(solved):
    plan, curves = solved
    tree = dataset.build(curves, plan.study.muscles)
    assert set(tree["cycle"].children) == {"loops_4s", "loops_40s", "own"}
    assert set(tree["transient"].children) == {"drop"}
    loops = tree["cycle/loops_4s"].to_dataset()
    assert loops["force"].dims == ("muscle", "model", "variant", "pressure", "time")
    np.testing.assert_allclose(loops.time, np.arange(0, 4.5, 0.5))
    one = loops.sel(muscle="one", model="cylinder", variant="default", pressure=0.3)
    assert one.force.values[2] > 0
    assert one.dissipated.values[-1] > 0
    assert one.dissipated.attrs["units"] == "N*mm"
    assert set(loops.cycle.values) == {1}
    assert loops.period == 4
    assert set(tree["cycle/own"].to_dataset().cycle.values) == {1, 2}
    assert len(tree["states"].to_dataset().row) == 2 + 3  # those out of time


def test_vibrations_are_a_table_and_share_their_curve(solved):
    plan, curves = solved
    (hum,), (still,) = plan.scenes["hum"].values(), plan.scenes["still"].values()
    assert hum == still
    tree = dataset.build(curves, plan.study.muscles)
    rows = tree["dynamic_stiffness"].to_dataset()
    assert list(rows.frequency.values) == [1, 10] * 3
    np.testing.assert_allclose(rows.contraction[::2], [0, 0.05, 0.1], atol=1e-12)
    assert (rows.storage > 5).all()
    assert (rows.loss > 0).all()
    assert rows.loss.attrs["units"] == "N/mm"


def test_groups_are_written_and_read(solved, tmp_path):
    plan, curves = solved
    drops = [curve for curve in curves if curve.place.scene == "drop"]
    tree = dataset.build(drops, plan.study.muscles)
    dataset.write(tree, tmp_path / "dataset.nc")
    with xr.open_dataset(tmp_path / "dataset.nc", group="transient/drop") as found:
        np.testing.assert_array_equal(found.force, tree["transient/drop"].to_dataset().force)
        assert found.time.attrs["units"] == "s"


def test_explain_says_how_and_what_is_remembered(solved):
    text = "\n".join(explain.lines(solved[0]))
    assert "contraction 0 to 0.2 and back (triangle), 1 cycle of 4, 40 s in 8 steps" in text
    assert "one: 4 branches of 0.01 to 10 s, 24 % of the long-term stiffness" in text
    assert "of the supply through a valve, 0.01 s in steps of 0.002 s, mass 5 kg" in text
    assert text.count("nothing is promised") == 3
    assert text.count("errors and seconds are those of the curve at rest") == 3


CYCLE = "cycle: {held: pressure, period: [4, 40], cycles: 1, samples: 8}\n"
RUBBING = """\
materials:
  soft: {c10: 0.2, c01: 0.02}
muscles:
  one:
    inner_diameter: 9.5
    wall_thickness: 1.6
    length: 200
    layers: [{kind: sleeve, sense: both, threads: 30, angle: 30, thread_stiffness: 400}]
    friction: {coefficient: 0.2, contact: 0.3}
    material: soft
scenes:
  loops:
    path: cycle
    muscles: [one]
    cycle: {held: pressure, period: [4], cycles: 1, samples: 8}
    pressure: [0.2]
    contraction: [0, 0.1]
    models: [cylinder]
  curve:
    path: isobaric
    muscles: [one]
    pressure: [0.2]
    contraction: [0, 0.1]
    models: [cylinder]
"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("per_decade: 0.06, ", "", "memory.per_decade is missing"),
        ("per_decade: 0.06", "shares: [0.1], per_decade: 0.06", "memory.per_decade"),
        ("to: 10,", "to: 1e-3,", "memory.to = 0.001 is refused"),
        ("shares: [0.2, 0.1]", "shares: [0.2, -0.1]", "memory.shares = -0.1"),
        ("shares: [0.2, 0.1]", "shares: 0.2", "a list of at least one number"),
        (f"    {CYCLE}", "", "scenes.loops.cycle is missing"),
        (CYCLE, "transient: {supply: [[0, 0], [1, 1]], duration: 1, step: 1}\n", "transient"),
        ("period: [4, 40], ", "", "cycle.period is missing"),
        ("held: pressure, ", "held: volume, ", "cycle.held = 'volume'"),
        (
            "contraction: [0, 0.2]\n    models: [cylinder]\n  own",
            "models: [cylinder]\n  own",
            "scenes.loops.contraction is missing",
        ),
        ("table: [[0, 0.1], [1, 0.3], [2, 0.1]]", "table: [[1, 0.1], [1, 0.3]]", "rising from 0"),
        ("table: [[0, 0.1], [1, 0.3], [2, 0.1]]", "table: [[0, 0.1], [1, -0.3]]", "pressure >= 0"),
        ("load: [100]", "load: [100]\n    pressure: [0.3]", "is not used on this cycle path"),
        ("mass: 5", "mass: -5", "transient.mass = -5"),
        ("period: [4, 40]", "period: [0, 40]", "cycle.period = 0"),
        ("cycles: 1, samples: 8", "cycles: 1, samples: 2", "an even number >= 4"),
        ("cycles: 1, samples: 8", "cycles: 1, samples: 7", "miss where a wave turns"),
        ("step: 0.002", "step: 0.02", "at most duration, 0.01"),
        ("duration: 0.01", "duration: 1000", "at most 20000 steps"),
        ("conductance: 1e7", "conductance: 0", "1 dm^3/(s bar) is 1e7"),
        ("models: [cylinder]\n  own", "models: [geometric]\n  own", "geometric knows no time"),
        ("path: isobaric", f"path: isobaric\n    {CYCLE}", "not used on an isobaric path"),
        ("    frequency: [1, 10]\n", "", "frequency is missing"),
        (
            f"    {CYCLE}",
            f"    {CYCLE}    effects: {{friction: on}}\n",
            "muscle of the scene has none",
        ),
        ("    path: isobaric", "    path: isobaric\n    effects: {memory: off}", "is only in time"),
        ("frequency: [1, 10]", "frequency: [-1, 10]", "frequencies > 0"),
        ("    quantities: [dynamic_stiffness]\n", "", "only used with the quantity"),
        (
            "    memory: {per_decade: 0.06, from: 1e-2, to: 10, reference_time: 60}\n",
            "",
            "nbr of one has none",
        ),
        ("samples: 8}", "samples: 8}\n    quantities: [free_contraction]", "only out of time"),
    ],
    ids=str,
)
def test_what_is_refused(tmp_path, old, new, said):
    with pytest.raises(StudyError) as refused:
        plan_of(tmp_path, old, new)
    assert said in str(refused.value), str(refused.value)


REFUSED = [
    # what stands in the study, what in its place, and what is said of it
    ("duration: 0.01", "duration: 0.011", "duration = 0.011 is refused", "6 of them are 0.012 s"),
    ("load: [49]", "load: [50]", "transient.load = [0.0, 49.0] is refused", "at first, 50 (N)"),
    ("per_decade: 0.06", "per_decades: 0.06", "memory.per_decades is no key", "per_decade, from"),
    ("path: cycle", "path: cycle\n    figure: {x: force, y: force}", "figure.y = ", "than force"),
    ("path: cycle", "path: cycle\n    figure: {x: force}", "figure.x = ", "than force"),
    ("path: cycle", "path: cycle\n    figure: {x: load, y: force}", "figure.y", "a load is one"),
    ("path: cycle", "path: cycle\n    figure: {y: contact_pressure}", "figure.y", "has a sleeve"),
    (
        "    cycle: {held: pressure",
        "    figure: {y: force}\n    # {held: pressure",
        "cycle",
        "given",
    ),
]


@pytest.mark.parametrize(("old", "new", "refused", "allowed"), REFUSED)
def test_what_says_nothing_is_refused_where_it_stands(tmp_path, old, new, refused, allowed):
    text = STUDY.replace(old, new, 1)
    assert text != STUDY
    (tmp_path / "study.yaml").write_text(text)
    with pytest.raises(StudyError) as error:
        read(tmp_path / "study.yaml")
    assert refused in str(error.value)
    assert allowed in str(error.value)


def test_a_refused_memory_is_said_once(tmp_path):
    with pytest.raises(StudyError) as error:
        plan_of(tmp_path, "per_decade: 0.06", "per_decade: -1")
    assert str(error.value).count("is refused") == 1


def test_numbers_for_people_have_no_exponent(tmp_path):
    assert [plain(v, 2) for v in (130, 0.00002, 1.0)] == ["130", "0.00002", "1"]
    assert [plain(v, 4) for v in (12345.6, -1e6, 3e-9, 0.0)] == ["12350", "-1000000", "3e-09", "0"]
    said = list(explain.lines(plan_of(tmp_path)))
    assert "curve: 1 case" in said
    assert "loops: 4 cases" in said
