"""The dataset holds every state at its labels, says what is missing, and is the same each time."""

import csv
import re
import shutil
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pint
import pytest
import xarray as xr

from solver import record, sources
from solver.record import VARIABLES
from solver.status import Flag
from workflow import data
from workflow.data import dataset, records, tidy
from workflow.data.scene_data import SceneData
from workflow.data.states import Table
from workflow.plan.plan import Place
from workflow.run import failures
from workflow.study.errors import StudyError

from ..synthetic import STUDY, planned, value, write_records


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    found = planned(folder)
    key = found.scenes["loads"][Place("isotonic", "one", "membrane", "default", 200)]
    write_records(found, folder / "cases", failed={key})
    return found, folder / "cases"


def written(study, folder):
    """The files of dataset and states of a study, made anew."""
    found, cases = study
    curves = records.curves_of_study(found, cases)
    files = folder / "dataset.nc", folder / "states.parquet"
    dataset.write(dataset.build(curves, found.study.muscles, study="study.yaml"), files[0])
    tidy.write(Table.of(curves, found.study.muscles), files[1])
    return files


@pytest.fixture(scope="module")
def files(study, tmp_path_factory):
    """Those files, for all tests that change nothing of them."""
    return written(study, tmp_path_factory.mktemp("dataset"))


@pytest.fixture(scope="module")
def tree(files):
    """The dataset as it is read back from its file."""
    with xr.open_datatree(files[0]) as opened:
        return opened.load()


def test_effects_stand_in_the_whole_dataset():
    group = dataset.build([], {}, effects=True)["effects"]
    assert group.sizes == {"regime": 5, "path": 3, "effect": 13}
    assert float(group.force.sel(regime="normal", path="isobaric", effect="end_caps")) > 0.01
    assert group.attrs["origin"].startswith("analysis of effects of ")


def test_groups_and_dimensions(tree):
    labelled = ["isobaric", "isometric", "isotonic"]
    assert sorted(tree.children) == ["curves", *labelled, "muscles", "reference", "states"]
    common = ("muscle", "model", "variant")
    assert tree["isobaric"].force.dims == (*common, "pressure", "contraction")
    assert tree["isometric"].force.dims == (*common, "contraction", "pressure")
    assert tree["isotonic"].contraction.dims == (*common, "load", "pressure")


def test_coordinates_are_the_decimals_of_the_study(tree):
    contraction = [0.0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1, 0.2]
    assert tree["isobaric"].contraction.values.tolist() == contraction
    assert tree["isobaric"].pressure.values.tolist() == [0.2, 0.3]
    assert tree["isotonic"]["load"].values.tolist() == [100, 200]
    at = {"muscle": "one", "model": "solid", "variant": "default", "pressure": 0.3}
    assert np.isfinite(tree["isobaric"].force.sel(at).sel(contraction=0.07))


def test_every_state_is_where_its_labels_say(study, tree):
    found, _ = study
    for places in found.scenes.values():
        for place, key in places.items():
            path = found.cases[key].case.path
            curve = tree[place.group].sel(
                muscle=place.muscle,
                model=place.model,
                variant=place.variant,
                **{str(tree[place.group].force.dims[3]): place.held},
            )
            reached = 2 if curve.case_status == "stalled" else len(path.stops)
            swept = str(curve.force.dims[0])
            for variable in VARIABLES.keys() - curve.coords.keys():
                expected = [value(key, variable, k) for k in range(reached)]
                found_values = curve[variable].sel({swept: list(path.stops[:reached])})
                assert found_values.values.tolist() == expected
            assert curve.case == key


def test_what_nobody_asked_for_is_empty(tree):
    group = tree["isobaric"].sel(muscle="bare", model="membrane")
    assert group.force.isnull().all()
    assert (group.status == "not_asked").all()
    assert (group.case_status == "not_asked").all()
    assert (group.case == "").all()
    finite = np.isfinite(tree["isobaric"].force)
    assert (finite == (tree["isobaric"].status == "converged")).all()


def test_a_failed_case_keeps_what_it_reached_and_says_why(tree):
    curve = tree["isotonic"].sel(muscle="one", model="membrane", variant="default", load=200)
    assert curve.case_status == "stalled"
    assert "no step" in str(curve.case_reason.values)


def test_muscles_are_described(tree):
    muscle = tree["isobaric"].sel(muscle="one")
    assert float(muscle.braid_angle) == pytest.approx(24.82, abs=0.005)
    assert (float(muscle.inner_diameter), float(muscle.wall_thickness)) == (20, 2)
    assert (float(muscle.length), str(muscle.material.values)) == (300, "nbr")
    bare = tree["isobaric"].sel(muscle="bare")
    assert np.isnan(bare.braid_angle)


def test_units_and_long_names(tree):
    for group in ("isobaric", "isometric", "isotonic"):
        for name, (unit, long_name) in VARIABLES.items():
            if name in tree[group].data_vars:
                assert tree[group][name].attrs == {"units": unit, "long_name": long_name}
        assert tree[group].pressure.attrs["units"] == "MPa"
        assert tree[group].contraction.attrs["units"] == "1"
    assert tree["isobaric"].braid_angle.attrs["units"] == "degree"


def test_threshold(study, tree):
    found, _ = study
    at = {"muscle": "one", "model": "solid", "variant": "default", "contraction": 0.1}
    key = found.scenes["threshold"][Place("isometric", "one", "solid", "default", 0.1)]
    group = tree["isometric"].sel(at)
    assert float(group.threshold_pressure) == value(key, "pressure", 2)
    assert group.threshold_pressure_status == "converged"
    assert (group.threshold_pressure_flags, group.threshold_pressure_note) == ("", "")
    eq_1 = tree["isometric"].sel({**at, "model": "geometric"})
    assert np.isnan(eq_1.threshold_pressure)
    assert eq_1.threshold_pressure_status == "not_asked"
    assert "free_contraction" not in tree["isobaric"]


def test_what_is_said_of_a_state_stands_beside_its_status(study):
    """Flags and notes of every state, those of zero force among them."""
    found, folder = study
    key = found.scenes["threshold"][Place("isometric", "one", "solid", "default", 0.1)]
    curve = next(c for c in records.curves_of_study(found, folder) if c.key == key)
    of_case = curve.solution
    marked = replace(
        of_case,
        flags=[frozenset(), frozenset({Flag.SMOOTHED, Flag.OVERSTRAINED}), frozenset()],
        notes=["", "of the second", "of zero force"],
    )
    tree = dataset.build([replace(curve, solution=marked)], found.study.muscles)
    group = tree["isometric"].to_dataset().squeeze()
    assert group.flags.values.tolist() == ["", "overstrained smoothed"]
    assert group.note.values.tolist() == ["", "of the second"]
    assert group.threshold_pressure_note == "of zero force"


def test_maps_that_are_of_no_muscle_of_the_study_are_not_in_its_dataset(tmp_path):
    text = STUDY.replace("    reference: [festo_musclesim, martens2017]\n", "")
    found = planned(tmp_path, text)
    write_records(found, tmp_path / "cases")
    curves = records.curves_of_study(found, tmp_path / "cases")
    assert "reference" not in dataset.build(curves, found.study.muscles)


def test_reference_has_both_maps(tree):
    group = tree["reference"].to_dataset()
    assert set(group.source.values) == {"festo_musclesim", "martens2017"}
    festo = group.where(group.source == "festo_musclesim", drop=True)
    point = festo.where((festo.pressure == 0.3) & (festo.contraction == 0.12), drop=True)
    assert point.force.values.tolist() == [241]
    assert int(group.suspect.sum()) == 1


def test_bytes_are_the_same_each_time(study, files, tmp_path):
    again = written(study, tmp_path)
    for one, other in zip(files, again, strict=True):
        assert one.read_bytes() == other.read_bytes()
    assert sorted(tmp_path.iterdir()) == sorted(again)


def test_all_states_stand_in_one_table_too(study, tree):
    """Those of zero force among them; a row says which curve it is of."""
    found, _ = study
    states, curves = tree["states"].to_dataset(), tree["curves"].to_dataset()
    paths = [planned_case.case.path for planned_case in found.cases.values()]
    places = [len(planned_case.places) for planned_case in found.cases.values()]
    assert states.sizes["row"] == sum(p.states * n for p, n in zip(paths, places, strict=True))
    key = found.scenes["threshold"][Place("isometric", "one", "solid", "default", 0.1)]
    (curve,) = np.flatnonzero(curves.case == key)
    rows = states.isel(row=np.flatnonzero(states.curve == curve))
    assert rows.point.values.tolist() == ["stop", "stop", "zero force"]
    assert rows.contraction.values.tolist() == [0.1] * 3
    assert rows.pressure.values.tolist() == [0.1, 0.2, value(key, "pressure", 2)]
    assert rows.volume.values.tolist() == [value(key, "volume", k) for k in range(3)]
    assert str(curves.code[curve].values) == record.code_digest("solid")


def test_the_file_says_what_it_is(tree):
    assert tree.attrs["title"] == "States of pneumatic muscles of the study study.yaml"
    assert tree.attrs["study"] == "study.yaml"
    assert tree.attrs["Conventions"] == "CF-1.11"
    assert tree.attrs["source"] == f"pneumatic-muscle {sources.version()}"
    digests = {record.code_digest(model) for model in ("geometric", "membrane", "solid")}
    assert tree.attrs["code"].split() == sorted(digests)
    assert (tree.attrs["filetype"], tree.attrs["layout"]) == ("muscle-dataset", 3)


def test_the_version_is_that_of_the_project():
    for file in ("pyproject.toml", "CITATION.cff"):
        text = (Path(__file__).parents[3] / file).read_text()
        assert re.search(r"^version\W+([\d.]+)", text, re.M)[1] == sources.version()


def test_all_units_can_be_read(tree):
    """Those of all groups, as pint reads them."""
    units = pint.UnitRegistry()
    effects = dataset.build([], {}, effects=True)
    found = {
        f"{group.path}/{name}": variable
        for group in (*tree.subtree, *effects.subtree)
        for name, variable in group.variables.items()
    }
    read = {str(units.Unit(v.attrs["units"])) for v in found.values() if "units" in v.attrs}
    assert read > {"megapascal", "millimeter ** 3", "millimeter * newton", "degree"}
    without = {n for n, v in found.items() if v.dtype.kind == "f" and "units" not in v.attrs}
    assert without == {"/curves/held"}  # it goes with the kind of the path


def test_what_is_read_on_demand_is_what_stands_in_the_file(files, tree):
    path, _ = files
    opened = data.open(path)
    for group in ("isobaric", "isometric", "isotonic"):
        xr.testing.assert_identical(opened[group].to_dataset(), tree[group].to_dataset())
    curve = data.curve(path, muscle="one", model="membrane", load=200)
    assert curve.contraction.dims == ("pressure",)
    few = data.curve(path, muscle="one", model="solid", variant="paper", pressure=0.3)
    assert few.contraction.values.tolist() == [0.05, 0.2]


def test_a_scene_has_its_own_stops_alone(study):
    few = SceneData.read(study[0], "few", study[1])
    tree = dataset.build(few.curves, few.studied)
    group = tree["isobaric"]
    assert group.contraction.values.tolist() == [0.05, 0.2]
    assert group.variant.values.tolist() == ["default", "paper"]
    assert set(tree.children) == {"curves", "isobaric", "muscles", "reference", "states"}
    key = study[0].scenes["few"][Place("isobaric", "one", "solid", "default", 0.3)]
    at = {"muscle": "one", "model": "solid", "variant": "default", "pressure": 0.3}
    force = group.force.sel(at).sel(contraction=0.2)
    stop = study[0].cases[key].case.path.stops.index(0.2)
    assert force == value(key, "force", stop)


def test_failures_are_listed(study, tmp_path):
    found, folder = study
    curves = records.curves_of_study(found, folder)
    table = tmp_path / "failures.csv"
    failures.write(found, {curve.key: curve.solution for curve in curves}, table)
    with table.open(newline="") as stream:
        (row,) = csv.DictReader(stream)
    assert row["label"] == "one membrane isotonic 200 N"
    assert (row["status"], row["reason"]) == ("stalled", "no step worked, at all")
    assert row["scenes"] == "loads"
    text, failed = failures.report(table)
    assert failed
    assert "one membrane isotonic 200 N: stalled" in text


def test_no_failures_are_a_header(study, tmp_path):
    failures.write(study[0], {}, tmp_path / "failures.csv")
    assert (tmp_path / "failures.csv").read_text().splitlines() == [",".join(failures.COLUMNS)]
    assert failures.report(tmp_path / "failures.csv") == ("", False)


def test_a_limit_point_is_listed_and_no_failure(study, tmp_path):
    table = tmp_path / "failures.csv"
    table.write_text(
        "label,status,reason,scenes,analyses\n"
        "bare solid isobaric 0.3 MPa,limit_point,at 0.15 MPa,fig04,\n"
    )
    text, failed = failures.report(table)
    assert "limit_point, at 0.15 MPa" in text
    assert not failed


DAMAGE = {
    "missing": lambda path: path.unlink(),
    "empty": lambda path: path.write_bytes(b""),
    "text": lambda path: path.write_text("no record"),
    "cut off": lambda path: path.write_bytes(path.read_bytes()[:-500]),
    "half": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_record_is_reported_by_name(tmp_path, damage):
    found = planned(tmp_path)
    write_records(found, tmp_path / "cases")
    key, case = next(iter(found.cases.items()))
    path = tmp_path / "cases" / f"{key}.h5"
    DAMAGE[damage](path)
    with pytest.raises(StudyError) as caught:
        records.curves_of_study(found, tmp_path / "cases")
    assert str(path) in str(caught.value)
    assert case.label in str(caught.value)


def test_the_record_of_another_case_is_reported(tmp_path):
    found = planned(tmp_path)
    write_records(found, tmp_path / "cases")
    one, other = (tmp_path / "cases" / f"{key}.h5" for key in list(found.cases)[:2])
    one.write_bytes(other.read_bytes())
    with pytest.raises(StudyError, match="holds case"):
        records.curves_of_study(found, tmp_path / "cases")


def test_a_flipped_bit_in_a_number_is_noticed(files, tmp_path):
    """By whatever program reads it: HDF5 checks."""
    path = Path(shutil.copy(files[0], tmp_path))
    with h5py.File(path) as file:
        place = file["isobaric/force"].id.get_chunk_info(0).byte_offset
    content = bytearray(path.read_bytes())
    content[place + 3] ^= 4
    path.write_bytes(content)
    with pytest.raises(OSError, match="filter"), xr.open_datatree(path) as tree:
        tree.load()


def test_every_curve_has_its_discretisation_error(tree):
    at = {"muscle": "one", "variant": "default", "pressure": 0.2}
    force, error = (tree["isobaric"][name].sel(at) for name in ("force", "force_error"))
    assert error.attrs["units"] == "N"
    share = error.max("contraction") / abs(force).max("contraction")
    assert 0 < float(share.sel(model="membrane")) < float(share.sel(model="solid")) < 0.0025
    assert (error.notnull() == force.notnull()).all()
