"""The record of a case: what was written is read, and only a whole record is one."""

import json
import os
import resource
import time

import h5py
import numpy as np
import pint
import pytest

from solver import record, sources
from solver.effects import Effects
from solver.load_path import LoadPath
from solver.models import MODELS
from solver.record import VARIABLES, NoRecord, Solution, unreached
from solver.status import CaseStatus, Flag, StateStatus


@pytest.fixture
def case(make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1, 0.2))
    return make_case(model="solid", path=path, fields_at=(0.1,))


@pytest.fixture
def solution():
    """Two states of three, each variable with values of its own, and the fields of one."""
    states = unreached(3)
    for k, values in enumerate(states.values()):
        values[:2] = [k + 0.1, -k - 1 / 3]
    corners = np.arange(24, dtype=float).reshape(6, 4)
    return Solution(
        status=CaseStatus.STALLED,
        reason="no state found beyond 15 % · ε",
        states=states,
        state_status=[StateStatus.CONVERGED, StateStatus.UNSTABLE, StateStatus.NOT_REACHED],
        flags=[frozenset(), frozenset({Flag.SMOOTHED, Flag.OVERSTRAINED}), frozenset()],
        notes=["", "threads of 3 N · stretched by 1.1", ""],
        fields={1: {"corners": corners, "stress": -corners}},
        log="line 1\nline 2",
    )


@pytest.fixture
def written(tmp_path, case, solution):
    path = tmp_path / "case.h5"
    record.write(path, case, solution)
    return path


def test_round_trip(written, case, solution):
    case_read, read = record.read(written)
    assert case_read.canonical() == case.canonical()
    assert (read.status, read.reason, read.log) == (
        solution.status,
        solution.reason,
        solution.log,
    )
    assert read.state_status == solution.state_status
    assert read.flags == solution.flags
    assert read.notes == solution.notes
    assert read.states.keys() == VARIABLES.keys()
    for name in VARIABLES:
        np.testing.assert_array_equal(read.states[name], solution.states[name])
    assert read.fields.keys() == {1}
    for name in ("corners", "stress"):
        np.testing.assert_array_equal(read.fields[1][name], solution.fields[1][name])


@pytest.mark.parametrize("model", ["geometric", "cylinder", "membrane", "solid"])
@pytest.mark.parametrize("kind", ["isobaric", "isometric", "isotonic"])
def test_every_kind_of_case_can_be_written(tmp_path, make_case, model, kind):
    path = LoadPath(kind=kind, held=0.1, stops=(0.1, 0.2))
    case = make_case(model=model, path=path)
    failed = Solution(
        status=CaseStatus.TIMEOUT,
        reason="late",
        states=unreached(2),
        state_status=[StateStatus.NOT_REACHED] * 2,
    )
    record.write(tmp_path / "a.h5", case, failed)
    assert record.read(tmp_path / "a.h5")[0].key == case.key


def test_a_bare_tube_can_be_written(tmp_path, make_case, bare_tube, solution):
    path = LoadPath(kind="isometric", held=0.0, stops=(0.0, 0.1, 0.2))
    case = make_case(model="solid", muscle=bare_tube, effects=Effects(end="sliding"), path=path)
    record.write(tmp_path / "a.h5", case, solution)
    assert record.read(tmp_path / "a.h5")[0].muscle == bare_tube


def test_the_version_is_said_and_decides_nothing(written, case, solution, monkeypatch):
    """A record of another version is right as long as the sources are the same."""
    with h5py.File(written) as file:
        assert file.attrs["version"] == sources.version()
    monkeypatch.setattr(sources, "version", lambda: "99.0")
    record.write(written.with_name("other.h5"), case, solution)
    with h5py.File(written.with_name("other.h5")) as file:
        assert file.attrs["version"] == "99.0"
    sources.digest.cache_clear()
    for path in (written, written.with_name("other.h5")):
        assert record.code_of(path) == record.code_digest(case.model, law=case.rubber.law())


def test_numbers_have_units(written):
    with h5py.File(written) as file:
        for name, (unit, long_name) in VARIABLES.items():
            assert file["states"][name].attrs["units"] == unit
            assert file["states"][name].attrs["long_name"] == long_name
        parameters = {}
        file["parameters"].visititems(
            lambda name, item: (
                parameters.update({name: item}) if isinstance(item, h5py.Dataset) else None
            )
        )
        units = {n: p.attrs["units"] for n, p in parameters.items() if "units" in p.attrs}
        assert units["muscle/inner_diameter"] == "mm"
        assert units["muscle/braid/layer_diameters"] == "mm"
        assert units["rubber/kappa"] == "MPa"
        assert units["thread/stiffness"] == "N"
        assert units["path/held"] == "MPa"
        assert units["path/stops"] == "1"
        assert units["numerics/clamp/inner_stiffness"] == "N/mm^3"
        assert units["muscle/braid/threads"] == "1"
        assert parameters["muscle/inner_diameter"][()] == 20
        np.testing.assert_array_equal(parameters["path/stops"][()], [0, 0.1, 0.2])


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("kind", ["isobaric", "isometric", "isotonic"])
def test_every_number_of_a_case_has_a_unit_that_can_be_read(make_case, model, kind):
    path = LoadPath(kind=kind, held=0.1, stops=(0.1, 0.2))
    case = make_case(model=model, path=path, fields_at=(0.1,) if MODELS[model].fields else ())
    units, numbers = pint.UnitRegistry(), set()
    for name, (value, attributes) in record.parameters(case).items():
        if isinstance(value, str | bool):
            assert not attributes
        else:
            numbers.add(name)
            units.Unit(attributes["units"])
    assert {"path/held", "path/stops"} < numbers
    assert ("fields_at" in numbers) == bool(MODELS[model].fields)


def test_what_is_a_multiple_says_of_what(make_case):
    """Settings of the meshes scale with the muscle, so they have no length as their unit."""
    path = LoadPath(kind="isobaric", held=0.1, stops=(0.1, 0.2))
    found = {}
    for model in (name for name in MODELS if MODELS[name].mesh):
        found |= record.parameters(make_case(model=model, path=path))
    relative = {name: a["relative_to"] for name, (_, a) in found.items() if "relative_to" in a}
    assert relative == {
        "numerics/meridian/cap_step": "wall thickness",
        "numerics/meridian/body_step": "inner diameter",
        "numerics/section/cap_step": "wall thickness",
        "numerics/section/body_step": "inner diameter",
        "numerics/cell/thread_size": "thread radius",
        "numerics/cell/body_size": "wall thickness",
        "numerics/clamp/ramp": "wall thickness",
        "numerics/spread/radius": "thread diameter",
    }
    assert {found[name][1]["units"] for name in relative} == {"1"}


def test_units_of_states_can_be_read():
    units = pint.UnitRegistry()
    for unit, _ in VARIABLES.values():
        units.Unit(unit)
    assert VARIABLES["volume"][0] == "mm^3"


@pytest.mark.parametrize(
    ("kind", "held", "stops"),
    [("isobaric", "MPa", "1"), ("isometric", "1", "MPa"), ("isotonic", "N", "MPa")],
)
def test_units_of_the_path(tmp_path, make_case, solution, kind, held, stops):
    path = LoadPath(kind=kind, held=0.1, stops=(0.1, 0.2, 0.3))
    record.write(tmp_path / "a.h5", make_case(path=path), solution)
    with h5py.File(tmp_path / "a.h5") as file:
        assert file["parameters/path/held"].attrs["units"] == held
        assert file["parameters/path/stops"].attrs["units"] == stops


def test_the_passport(written, case):
    with h5py.File(written) as file:
        assert file.attrs["key"] == case.key
        assert file.attrs["case"] == case.canonical()
        assert file.attrs["code"] == record.code_digest(case.model)


def test_written_again_the_bytes_are_the_same(tmp_path, written, case, solution):
    time.sleep(1.1)  # HDF5 counts time in seconds
    again = tmp_path / "again.h5"
    record.write(again, case, solution)
    assert again.read_bytes() == written.read_bytes()


def test_a_record_is_whole_or_absent(tmp_path, case, solution):
    """A write that fails half way leaves nothing, and what was there before."""
    path = tmp_path / "case.h5"
    broken = Solution(**vars(solution) | {"states": {"force": np.zeros(3)}})
    with pytest.raises(KeyError):
        record.write(path, case, broken)
    assert list(tmp_path.iterdir()) == []
    record.write(path, case, solution)
    before = path.read_bytes()
    with pytest.raises(KeyError):
        record.write(path, case, broken)
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == before


def test_a_record_is_renamed_into_place(tmp_path, written, case, solution):
    """Whoever reads the old one, reads it to its end."""
    old = tmp_path / "old.h5"
    os.link(written, old)
    before = old.read_bytes()
    record.write(written, case, Solution(**vars(solution) | {"reason": "another"}))
    assert old.read_bytes() == before != written.read_bytes()


# --- what is no record ----------------------------------------------------------------------------


def assert_no_record(path):
    with pytest.raises(NoRecord) as refused:
        record.read(path)
    assert str(path) in str(refused.value)


def test_absent(tmp_path):
    assert_no_record(tmp_path / "absent.h5")


@pytest.mark.parametrize("content", [b"", b"not HDF5", b"\x89HDF\r\n\x1a\n"])
def test_foreign_file(tmp_path, content):
    path = tmp_path / "foreign.h5"
    path.write_bytes(content)
    assert_no_record(path)


def test_foreign_hdf5(tmp_path):
    path = tmp_path / "foreign.h5"
    with h5py.File(path, "w") as file:
        file["states"] = 1
    assert_no_record(path)


@pytest.mark.parametrize("share", [0.01, 0.1, 0.5, 0.9, 0.999])
def test_truncated(written, share):
    content = written.read_bytes()
    written.write_bytes(content[: int(share * len(content))])
    assert_no_record(written)


@pytest.mark.parametrize("place", range(0, 1000, 37))
def test_a_flipped_bit_anywhere(written, place):
    """Also where HDF5 notices nothing, as in the numbers."""
    content = bytearray(written.read_bytes())
    content[place * len(content) // 1000] ^= 1 << place % 8
    written.write_bytes(content)
    assert_no_record(written)


def test_appended_bytes(written):
    with written.open("ab") as file:
        file.write(b"\0")
    assert_no_record(written)


def test_another_layout_is_named(written):
    written.write_bytes(written.read_bytes()[record.BLOCK :])  # as of version 1
    with pytest.raises(NoRecord, match=f"does not begin with 'muscle-case layout {record.LAYOUT}'"):
        record.read(written)


def test_a_record_of_an_older_version_is_refused_by_its_layout(written):
    content = written.read_bytes()
    written.write_bytes(content.replace(b" layout 5 ", b" layout 4 ", 1))
    with pytest.raises(NoRecord, match="is a muscle-case layout 4, of another version"):
        record.read(written)


def test_of_a_state_nothing_is_said_unless_given(tmp_path, case):
    plain = Solution(
        status=CaseStatus.TIMEOUT,
        reason="late",
        states=unreached(3),
        state_status=[StateStatus.NOT_REACHED] * 3,
    )
    record.write(tmp_path / "plain.h5", case, plain)
    _, read = record.read(tmp_path / "plain.h5")
    assert read.flags == [frozenset()] * 3
    assert read.notes == ["late"] * 3  # but why they are missing


def reseal(path):
    """What is wrong then is not the checksum."""
    path.write_bytes(record.sealed(path.read_bytes()))


@pytest.mark.parametrize(
    ("attribute", "value"),
    [
        ("layout", record.LAYOUT + 1),
        ("filetype", "other"),
        ("key", "0123456789abcdef"),
        ("status", "perfect"),
        ("case", "{"),
        ("case", "{}"),
        ("case", json.dumps([1])),
    ],
)
def test_damaged_attribute(written, attribute, value):
    with h5py.File(written, "a") as file:
        file.attrs[attribute] = value
    reseal(written)
    assert_no_record(written)


@pytest.mark.parametrize("attribute", ["layout", "filetype", "key", "case", "status", "reason"])
def test_missing_attribute(written, attribute):
    with h5py.File(written, "a") as file:
        del file.attrs[attribute]
    reseal(written)
    assert_no_record(written)


@pytest.mark.parametrize(
    "name", ["states", "states/force", "states/status", "states/flags", "states/note"]
)
def test_missing_dataset(written, name):
    with h5py.File(written, "a") as file:
        del file[name]
    reseal(written)
    assert_no_record(written)


def test_states_of_another_length(written):
    with h5py.File(written, "a") as file:
        del file["states/force"]
        file["states/force"] = np.zeros(2)
    reseal(written)
    assert_no_record(written)


def test_unknown_word_for_a_state(written):
    with h5py.File(written, "a") as file:
        file["states/status"][0] = b"fine"
    reseal(written)
    assert_no_record(written)


def test_unknown_flag_of_a_state(written):
    with h5py.File(written, "a") as file:
        file["states/flags"][0] = b"odd"
    reseal(written)
    assert_no_record(written)


def compress(file):
    del file["states/force"]
    file.create_dataset("states/force", data=np.zeros(3), chunks=(3,), compression="gzip")


def bomb(file):
    """A field of 8 TB, of which the file holds nothing."""
    file.create_dataset("fields/9/stress", (10**6, 10**6), "f8")


def chunks(file):
    file.create_dataset("fields/9/stress", (10**6, 10**6), "f8", chunks=(10**3, 10**3))


def long_words(file):
    del file["states/note"]
    file.create_dataset("states/note", (3,), "S1000000000")


def long_attribute(file):
    del file.attrs["reason"]
    file.attrs["reason"] = [""] * 1000


def many_links(file):
    """One table by a thousand names."""
    file.create_dataset("fields/9/a", data=np.zeros((1000, 4)))
    for number in range(1000):
        file[f"fields/9/{number}"] = file["fields/9/a"]


def outside(file):
    del file["states/force"]
    file["states/force"] = h5py.ExternalLink("other.h5", "/force")


def raw(file):
    del file["states/force"]
    file.create_dataset("states/force", (3,), "f8", external=[("/dev/zero", 0, 24)])


def objects(file):
    del file["states/note"]
    file.create_dataset("states/note", data=["x"] * 3, dtype=h5py.string_dtype())


@pytest.mark.parametrize(
    "change",
    [compress, bomb, chunks, long_words, long_attribute, many_links, outside, raw, objects],
)
def test_what_is_declared_is_refused_before_it_is_read(written, change):
    with h5py.File(written, "a") as file:
        change(file)
    assert written.stat().st_size < 10**6
    reseal(written)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert_no_record(written)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 20 * 1024  # KB


def test_an_endless_file_is_not_read(written):
    with written.open("ab") as file:
        file.truncate(10**12)
    assert_no_record(written)
    written.unlink()
    os.mkfifo(written)
    assert_no_record(written)
