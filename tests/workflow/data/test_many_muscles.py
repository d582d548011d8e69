"""Hundreds of muscles with stops of their own: the dataset grows with the states, not their square.

No solver: the numbers are made up.
"""

import tracemalloc
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from solver.load_path import LoadPath
from solver.record import VARIABLES
from workflow import data
from workflow.data import dataset, tidy
from workflow.data.records import Curve
from workflow.data.states import Table
from workflow.plan.plan import Place

from ..synthetic import converged, planned

MUSCLES, STATES = 300, 18
MEGABYTE = 2**20


@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    found = planned(tmp_path_factory.mktemp("study"))
    place = Place("isobaric", "one", "solid", "default", 0.3)
    return found.study.muscles["one"], found.cases[found.scenes["curves"][place]].case


def curves_of(case, count):
    """Of each muscle one curve, at a pressure and contractions that no other has."""
    for number in range(count):
        random = np.random.default_rng(number)
        stops = tuple(np.sort(random.uniform(0, 0.3, STATES)).tolist())
        path = LoadPath(kind="isobaric", held=0.2 + number / 1000, stops=stops)
        solution = converged({name: random.normal(size=STATES) for name in VARIABLES})
        place = Place("isobaric", f"m{number}", "solid", "default", path.held)
        made = replace(case, path=path, fields_at=())
        yield Curve(made, solution, stops, place)


@pytest.fixture(scope="module")
def many(studied, tmp_path_factory):
    """Curves, the file of their dataset, and the most memory that making it took [bytes]."""
    muscle, case = studied
    curves = list(curves_of(case, MUSCLES))
    muscles = {curve.place.muscle: replace(muscle, reference=()) for curve in curves}
    path = tmp_path_factory.mktemp("many") / "dataset.nc"
    tracemalloc.start()
    try:
        dataset.write(dataset.build(curves, muscles), path)
        tidy.write(Table.of(curves, muscles), path.with_name("states.parquet"))
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    return curves, path, most


def test_size_and_memory(many):
    _, path, most = many
    assert path.stat().st_size < 10 * MEGABYTE
    assert path.with_name("states.parquet").stat().st_size < 10 * MEGABYTE
    assert most < 200 * MEGABYTE  # beside the 200 MB of Python and its packages


def test_the_labelled_group_is_left_out_and_no_state_is(many):
    curves, path, _ = many
    with xr.open_datatree(path) as tree:
        assert sorted(tree.children) == ["curves", "muscles", "states"]
        assert tree["states"].sizes["row"] == MUSCLES * STATES
        expected = np.concatenate([curve.solution.states["volume"] for curve in curves])
        np.testing.assert_array_equal(tree["states"]["volume"], expected)


def test_any_muscle_can_be_seen_at_its_labels(many):
    curves, path, _ = many
    wanted = curves[137]
    tree = data.open(path, muscle="m137")
    force = tree["isobaric"].force.sel(
        muscle="m137", model="solid", variant="default", pressure=wanted.place.held
    )
    assert force.contraction.values.tolist() == list(wanted.stops)
    np.testing.assert_array_equal(force, wanted.solution.states["force"])
    two = data.open(path, muscle=["m1", "m2"])["isobaric"]
    assert two.force.shape == (2, 1, 1, 2, 2 * STATES)
    assert (two.status == "not_asked").sum() == 3 * 2 * STATES


def test_a_curve_by_its_names(many):
    curves, path, _ = many
    wanted = curves[7]
    found = data.curve(path, muscle="m7", model="solid", pressure=wanted.place.held)
    assert found.force.dims == ("contraction",)
    np.testing.assert_array_equal(found.force, wanted.solution.states["force"])
    assert found.volume.attrs["units"] == "mm^3"
    assert str(found.case.values) == wanted.key


@pytest.mark.parametrize(
    ("names", "message"),
    [
        ({"muscle": "m300", "model": "solid", "pressure": 0.2}, "no muscle 'm300'.* m0, "),
        ({"muscle": "m0", "model": "membrane", "pressure": 0.2}, "no model 'membrane'.* solid"),
        ({"muscle": "m0", "model": "solid", "pressure": 0.25}, "no pressure 0.25 .* 0.2"),
        ({"muscle": "m0", "model": "solid", "load": 0.25}, "no path 'isotonic' .* isobaric"),
        ({"muscle": "m0", "model": "solid"}, "one of pressure, contraction, load"),
    ],
)
def test_a_curve_that_is_not_there_is_named_with_those_that_are(many, names, message):
    with pytest.raises(KeyError, match=message):
        data.curve(many[1], **names)


def test_the_tidy_table_has_every_state_with_its_muscle(many):
    curves, path, _ = many
    rows = pd.read_parquet(path.with_name("states.parquet"))
    assert len(rows) == MUSCLES * STATES
    one = rows[(rows["muscle"] == "m42") & (rows["pressure"] == curves[42].place.held)]
    assert one["contraction"].tolist() == list(curves[42].stops)
    np.testing.assert_array_equal(one["force"], curves[42].solution.states["force"])
    assert one["wall_thickness"].unique().tolist() == [2.0]


def test_a_group_that_is_filled_is_written_however_large(studied, tmp_path, monkeypatch):
    """The two limits: a share of places that are filled, or a size."""
    muscle, case = studied
    curves = list(curves_of(case, 15))
    muscles = {curve.place.muscle: replace(muscle, reference=()) for curve in curves}
    assert "isobaric" in dataset.build(curves, muscles)  # sparse but small
    monkeypatch.setattr(dataset, "LARGE", 1e4)
    assert "isobaric" not in dataset.build(curves, muscles)
    assert "isobaric" in dataset.build(curves[:4], muscles)  # 1 of 16 places
