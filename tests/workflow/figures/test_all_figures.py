"""What holds for every figure of the study, drawn from made-up solutions."""

import importlib

import pandas as pd
import pytest

from solver.status import StateStatus
from workflow.data.scene_data import SceneData
from workflow.figures import style

FIGURES = [f"fig{number:02}" for number in range(3, 14)]
WITH_STATES = [name for name in FIGURES if name != "fig03"]
MAPS = {style.SOURCES[name]["label"] for name in ("festo_musclesim", "martens2017")}


def module(name):
    return importlib.import_module(f"workflow.figures.{name}")


@pytest.mark.parametrize("name", FIGURES)
def test_same_table_same_bytes(name, scene_data, tmp_path):
    table = module(name).table(scene_data(name))
    for suffix in (".png", ".svg"):
        paths = [tmp_path / f"{run}{suffix}" for run in ("first", "second")]
        for path in paths:
            style.save(module(name).draw(table), path)
        assert paths[0].read_bytes() == paths[1].read_bytes()
        assert len(paths[0].read_bytes()) > 1000


@pytest.mark.parametrize("name", FIGURES)
def test_saving_one_figure_in_both_formats_changes_neither(name, scene_data, tmp_path):
    table = module(name).table(scene_data(name))
    alone, after = module(name).draw(table), module(name).draw(table)
    style.save(alone, tmp_path / "alone.png")
    style.save(after, tmp_path / "after.svg")
    style.save(after, tmp_path / "after.png")
    assert (tmp_path / "alone.png").read_bytes() == (tmp_path / "after.png").read_bytes()


@pytest.mark.parametrize("name", WITH_STATES)
def test_table_is_tidy_with_units(name, scene_data):
    table = module(name).table(scene_data(name))
    assert len(table) > 0
    assert "status" in table
    numbers = table.select_dtypes("number").columns
    assert all(" [" in column for column in numbers), list(numbers)
    assert not table.columns.duplicated().any()


@pytest.mark.parametrize("name", WITH_STATES)
@pytest.mark.parametrize("status", [StateStatus.NOT_REACHED, StateStatus.INVALID_STATE])
def test_nothing_is_drawn_of_a_scene_that_failed(name, status, scene_data, fail):
    """Not of its models, that is; the figure is still made, and says what it lacks."""

    def spoil(case, solution):
        return fail(solution, status, *range(len(solution.state_status)))

    table = module(name).table(scene_data(name, spoil))
    figure = module(name).draw(table)
    curves = [line for ax in figure.axes for line in ax.lines if len(line.get_xdata()) > 2]
    assert {line.get_label() for line in curves} <= MAPS
    assert not any(ax.collections for ax in figure.axes if ax.get_xlabel().startswith("z"))
    text = " ".join(text.get_text() for text in figure.texts).replace("\n", " ")
    assert "Not drawn" in text
    assert status.replace("_", " ") in text


@pytest.mark.parametrize("name", WITH_STATES)
def test_csv_gives_the_table_back(name, scene_data, tmp_path):
    table = module(name).table(scene_data(name))
    table.to_csv(tmp_path / "table.csv", index=False)
    back = pd.read_csv(tmp_path / "table.csv", keep_default_na=True)
    assert list(back.columns) == list(table.columns)
    assert len(back) == len(table)


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("name", WITH_STATES)
def test_every_figure_of_an_unfinished_study(name, first, scene_data, study_plan, tmp_path):
    """Every second case has no record yet; and without any."""
    scene_data(name)
    for files in (sorted(tmp_path.glob("*.h5"))[first::2], list(tmp_path.glob("*.h5"))):
        for path in files:
            path.unlink(missing_ok=True)
        data = SceneData.read(study_plan, name, tmp_path, partial=True)
        assert data.missing > 0 or len(data.curves) == 1
        style.save(module(name).draw(module(name).table(data)), tmp_path / "a.png")
    assert data.missing == len(data.curves)
