"""Any scene has a figure; what it shows is chosen in the scene."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from solver import record
from solver.freefem import Limits
from solver.solve import solve
from workflow.__main__ import main
from workflow.data import bench
from workflow.data.scene_data import COLUMN, CONTRACTION, FORCE, PRESSURE, TIME, SceneData
from workflow.figures import general, style
from workflow.figures.labels import SERIES
from workflow.plan.plan import read
from workflow.study.errors import StudyError

from ..synthetic import MUSCLE, STUDY, planned, write_records

TIMED = (
    MUSCLE.replace(
        "c01: 0.083805}", "c01: 0.083805, memory: {per_decade: 0.06, from: 1e-2, to: 10}}"
    )
    + """\
scenes:
  loops:
    path: cycle
    muscles: [one]
    cycle: {held: pressure, period: [4, 40], cycles: 1, samples: 12}
    pressure: [0.3]
    contraction: [0, 0.2]
    models: [cylinder]
  drop:
    path: transient
    muscles: [one]
    load: [49]
    transient: {supply: [[0, 0.1], [0.01, 0.3], [1, 0.3]], duration: 0.02, step: 0.002}
    models: [cylinder]
    figure: {y: work}
"""
)


@pytest.fixture
def scene(tmp_path):
    """Data of a scene of the small study, with what it says of its figure."""

    def read(name, figure="", text=STUDY):
        if figure:
            head = f"  {name}:\n"
            text = STUDY.replace(head, f"{head}    figure: {figure}\n")
        plan = planned(tmp_path, text)
        write_records(plan, tmp_path / "cases")
        return SceneData.read(plan, name, tmp_path / "cases")

    return read


def texts(figure):
    return [text.get_text() for ax in figure.axes for text in ax.texts] + [
        text.get_text() for text in figure.texts
    ]


def test_a_figure_of_nothing_is_empty(scene):
    table = general.table(scene("curves"))
    (ax,) = general.draw(table.iloc[:0]).axes
    assert not ax.lines or not any(len(line.get_xdata()) for line in ax.lines)


def test_what_follows_stands_against_what_is_swept(scene):
    table = general.table(scene("curves"))
    (ax,) = general.draw(table).axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("contraction [%]", "force [N]")
    assert set(table[SERIES]) == {"0.2 MPa", "0.3 MPa"}
    assert {"membrane", "solid", "festo_musclesim", "martens2017"} == set(table["source"])
    (ax,) = general.draw(general.table(scene("loads"))).axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("pressure [MPa]", "contraction [%]")


@pytest.mark.parametrize("highest", [0.02, 0.1, 0.22, 0.25])
def test_ticks_in_percent_say_where_they_are(highest):
    ax = Figure().add_subplot()
    ax.set_xlim(-0.01, highest)
    style.percent(ax.xaxis)
    said = ax.xaxis.get_major_formatter().format_ticks(ticks := ax.get_xticks())
    found = [float(text.replace("\N{MINUS SIGN}", "-")) / 100 for text in said]
    np.testing.assert_allclose(found, ticks, atol=1e-12)


def test_drawn_numbers_are_those_of_the_states(scene):
    data = scene("curves")
    table = general.table(data)
    states = data.table.joined()
    for held in (0.2, 0.3):
        rows = table[(table["source"] == "solid") & (table[PRESSURE] == held)]
        own = states[(states["model"] == "solid") & (states["held"] == held)]
        np.testing.assert_array_equal(rows[FORCE], own["force"])
        np.testing.assert_array_equal(rows[CONTRACTION], own["contraction"])


def test_other_quantities_colours_and_a_title(scene):
    chosen = "{x: volume, y: outer_diameter, by: model, title: Thick}"
    table = general.table(scene("curves", chosen))
    figure = general.draw(table)
    (ax,) = figure.axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("volume [mm^3]", "outer diameter [mm]")
    assert ax.get_title("left") == "Thick"
    assert set(table["source"]) == {"membrane", "solid"}  # no map has a volume
    assert len({line.get_color() for line in ax.lines if len(line.get_xdata()) > 2}) == 4
    assert COLUMN["volume"] in table
    said = " ".join(" ".join(text.get_text() for text in figure.texts).split())
    assert "one." in said  # what a title of one's own leaves out


def test_muscles_of_a_solid_alone_differ_in_more_than_colour(scene):
    table = general.table(scene("curves", "{x: contraction, y: rubber_stretch_max}"))
    table = table[table["source"] == "solid"]
    (ax,) = general.draw(table).axes
    assert ax.get_ylabel() == "largest rubber stretch [1]"
    curves = [line for line in ax.lines if len(line.get_xdata()) > 2]
    assert len({line.get_marker() for line in curves}) == len(curves) == 2


def test_maps_only_where_they_are_wanted(scene):
    table = general.table(scene("curves", "{compare: none}"))
    assert set(table["source"]) == {"membrane", "solid"}
    isometric = general.table(scene("threshold"))
    assert "festo_musclesim" in set(isometric["source"])


@pytest.fixture(scope="module")
def timed(tmp_path_factory):
    """Scenes in time, solved."""
    folder = tmp_path_factory.mktemp("timed")
    plan = planned(folder, TIMED)
    (folder / "cases").mkdir()
    for key, each in plan.cases.items():
        solution, _ = solve(each.case, None, folder / "log", Limits(wall_time=60, memory=2000))
        record.write(folder / f"cases/{key}.h5", each.case, solution)
    return lambda name: SceneData.read(plan, name, folder / "cases")


def test_a_cycle_is_drawn_as_its_loop(timed):
    data = timed("loops")
    table = general.table(data)
    assert set(table[SERIES]) == {"4 s", "40 s"}
    (ax,) = general.draw(table).axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("contraction [%]", "force [N]")
    drawn = [line for line in ax.lines if len(line.get_xdata()) == 13]
    for curve, line in zip(data.curves, drawn, strict=True):
        for values, name in ((line.get_xdata(), "contraction"), (line.get_ydata(), "force")):
            np.testing.assert_array_equal(values, curve.solution.states[name])
    there, back = drawn[0].get_ydata()[3], drawn[0].get_ydata()[9]
    assert abs(there - back) > 1  # of one contraction: it is a loop


def test_what_follows_a_supply_is_drawn_over_time(timed):
    table = general.table(timed("drop"))
    (ax,) = general.draw(table).axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time [s]", "work [N*mm]")
    assert "49 N" in ax.get_title("left")
    np.testing.assert_allclose(table[TIME], np.arange(11) * 0.002, atol=1e-12)


def test_a_figure_shows_what_its_scene_has(scene):
    with pytest.raises(StudyError, match=r"figure.y = 'work' is refused(?s:.*)out of time"):
        scene("curves", "{y: work}")
    text = STUDY.replace("  few:\n", "  whole: {muscles: [one], figure: {y: force}}\n  few:\n")
    with pytest.raises(StudyError, match="not used without a path"):
        scene("few", text=text)


def test_the_same_table_gives_the_same_bytes(scene, tmp_path):
    table = general.table(scene("few"))
    for name in ("one.svg", "two.svg"):
        style.save(general.draw(table), tmp_path / name)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()


def test_a_scene_that_failed_says_so(scene, tmp_path):
    data = scene("few")
    write_records(data.plan, tmp_path / "cases", failed=list(data.plan.scenes["few"].values()))
    table = general.table(SceneData.read(data.plan, "few", tmp_path / "cases"))
    table.loc[:, "status"] = "not_reached"
    assert any("Not drawn" in text for text in texts(general.draw(table)))


def test_nonsense_is_refused_with_what_there_is(scene):
    with pytest.raises(StudyError, match="colour"):
        scene("curves", "{colour: red}")
    with pytest.raises(StudyError, match="outer_diameter"):
        scene("curves", "{y: outer_diametre}")
    with pytest.raises(StudyError, match="muscle"):
        scene("curves", "{by: weather}")


def test_the_csv_has_what_is_drawn(scene, tmp_path):
    table = general.table(scene("curves"))
    table.to_csv(tmp_path / "it.csv", index=False)
    again = pd.read_csv(tmp_path / "it.csv")
    np.testing.assert_allclose(again[FORCE], table[FORCE])


@pytest.fixture
def plot(tmp_path, monkeypatch):
    """``muscle plot`` in a folder with records."""
    plan = planned(tmp_path)
    (tmp_path / "results").mkdir()
    write_records(plan, tmp_path / "results/cases")
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: main(["plot", *arguments, "--study", "study.yaml"])


def test_one_curve_from_the_shell(plot, tmp_path, capsys):
    asked = ("one", "--path", "isobaric", "--held", "0.3", "--model", "solid", "--variant")
    assert plot(*asked, "default", "--output", "it.csv") == 0
    assert "it.csv: 1 curves of one" in capsys.readouterr().out
    rows = pd.read_csv(tmp_path / "it.csv")
    assert set(rows[PRESSURE]) == {0.3}
    assert {"solid", "festo_musclesim", "martens2017"} == set(rows["source"])
    assert plot(*asked, "default", "--y", "volume", "--output", "it.png") == 0
    assert (tmp_path / "it.png").stat().st_size > 10_000


def test_before_the_first_run_the_command_is_said(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    planned(tmp_path)
    assert main(["plot", "one", "--study", "study.yaml"]) == 1
    said = capsys.readouterr().err
    assert "study.yaml: nothing of it is solved yet; .venv/bin/muscle run --study" in said


def test_of_many_muscles_some_are_drawn_and_the_table_has_all(scene):
    table = general.table(scene("curves"))
    rows = pd.concat([table.assign(**{SERIES: f"muscle {k}"}) for k in range(50)])
    rows.attrs = table.attrs
    figure = general.draw(rows)
    assert any("17 of 50 series are drawn" in " ".join(text.split()) for text in texts(figure))
    named = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {f"muscle {k}" for k in range(0, 50, 3)} <= set(named)
    assert "muscle 1" not in named


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (["one", "--path", "isometric", "--held", "9"], "held 9.0: no isometric curve"),
        (["two"], "muscle two: no curve of it is solved; there are bare, one"),
        (["one", "--held", "0.7"], "held 0.7: no isobaric curve of it is solved; there are 0.2"),
        (["one", "--y", "colour"], "--y colour: no such quantity"),
        (["one", "--output", "it.pdf"], "--output it.pdf: the ending is .png, .svg, .csv"),
    ],
)
def test_what_cannot_be_plotted(plot, capsys, asked, said):
    assert plot(*asked) == 1
    assert said in capsys.readouterr().err


FORCES = "pressure [bar];contraction [%];force [N]\n" + "".join(
    f"3;{e};{700 - 25 * e}\n" for e in range(0, 20, 2)
)


def test_measured_forces_of_ones_own_stand_beside_the_curves(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.csv").write_text(FORCES)
    text = STUDY.replace("[festo_musclesim, martens2017]", "mine.csv")
    plan = planned(tmp_path, text)
    write_records(plan, tmp_path / "cases")
    before = plan.digest("curves")
    table = general.table(SceneData.read(plan, "curves", tmp_path / "cases"))
    own = table[(table["source"] == "mine") & (table["point"] == "tabulated")]
    np.testing.assert_allclose(own[CONTRACTION], [0.0, 0.02, 0.04, 0.06, 0.08, 0.1], atol=1e-12)
    np.testing.assert_allclose(own[FORCE], [700, 650, 600, 550, 500, 450])
    assert set(own[PRESSURE]) == {0.3}
    general.draw(table)
    (tmp_path / "mine.csv").write_text(FORCES.replace("700", "701"))
    assert plan.digest("curves") != before  # and what is made of it is made again


def test_forces_that_are_not_there_or_are_of_no_muscle(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = STUDY.replace("[festo_musclesim, martens2017]", "mine.csv")
    (tmp_path / "study.yaml").write_text(text)
    with pytest.raises(StudyError, match=r"(?s)reference = 'mine.csv' is refused.*no such file"):
        read(tmp_path / "study.yaml", bench.refused)
    with pytest.raises(StudyError, match=r"or the path of a \.csv file"):
        planned(tmp_path, STUDY.replace("festo_musclesim", "festo"))
