"""Maps for controllers: cubics between states, their error, and what is written of them."""

import ctypes
import json
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray as xr
from scipy.io import loadmat

from solver.load_path import LoadPath
from workflow.__main__ import main
from workflow.answers.maps import fmu
from workflow.answers.maps.build import Builder
from workflow.answers.maps.table import FORCE, VOLUME, Map
from workflow.answers.quick import Quick
from workflow.answers.store import Store
from workflow.plan.plan import read
from workflow.study.errors import StudyError
from workflow.study.study import load

STUDY = """
materials: {nbr: {c10: 0.345083, c01: 0.083805}}
muscles:
  dmsp20: {inner_diameter: 20, wall_thickness: 2, length: 300, layer_depths: [0.3, 0.9],
    threads: 60, lead: 144, thread_stiffness: 315, material: nbr}
scenes: {}
map:
  quick:
    muscle: dmsp20
    pressure: [0.02, 0.1, 0.2]
    contraction: [0, 0.02, 0.04]
    model: cylinder
    tolerance: 0.5
    checks: 6
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("maps")
    (made / "study.yaml").write_text(STUDY)
    return made


@pytest.fixture(scope="module")
def built(folder):
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        return Builder(load("study.yaml"), "quick").built()


def _cubic(p, e):
    return 3 + 2 * p - e + p * e - 4 * p**2 * e**3 + p**3


@pytest.fixture
def exact():
    """A map of a bicubic: it is found everywhere, to rounding."""
    p, e = np.array([0.0, 0.1, 0.4, 0.5]), np.array([-0.1, 0.0, 0.05, 0.3])
    pp, ee = np.meshgrid(p, e, indexing="ij")
    parts = {
        "": _cubic(pp, ee),
        "_by_pressure": 2 + ee - 8 * pp * ee**3 + 3 * pp**2,
        "_by_contraction": -1 + pp - 12 * pp**2 * ee**2,
        "_mixed": 1 - 24 * pp * ee**2,
    }
    tables = {q + part: table for q in (FORCE, VOLUME) for part, table in parts.items()}
    return Map("m", "cylinder", 300.0, p, e, tables, np.ones((4, 4), bool))


def test_a_bicubic_is_found_everywhere(exact):
    rng = np.random.default_rng(0)
    p, e = rng.uniform(0, 0.5, 200), rng.uniform(-0.1, 0.3, 200)
    np.testing.assert_allclose(exact(FORCE, p, e), _cubic(p, e), atol=1e-12)
    by_p = 2 + e - 8 * p * e**3 + 3 * p**2
    np.testing.assert_allclose(exact(FORCE, p, e, by="pressure"), by_p, atol=1e-11)
    by_e = -1 + p - 12 * p**2 * e**2
    np.testing.assert_allclose(exact(FORCE, p, e, by="contraction"), by_e, atol=1e-11)


def test_what_is_not_valid_is_no_number(exact):
    exact.valid[0, 3] = False
    assert np.isnan(exact(FORCE, 0.05, 0.2))
    assert np.isfinite(exact(FORCE, 0.2, 0.2))
    assert np.isnan(exact(FORCE, 0.6, 0.1))
    assert np.isnan(exact(FORCE, 0.3, 0.31))


def test_a_map_of_a_muscle_is_right_between_its_states(built, folder):
    quick = Quick(load(folder / "study.yaml").muscles["dmsp20"])
    made, rng = built.map, np.random.default_rng(5)
    assert built.error <= 0.5
    assert 0 < built.error_near <= 2.5
    assert made.contraction.size > 3  # refined
    assert made.pressure.size > 3
    for _ in range(12):
        e = float(rng.uniform(0, 0.04))
        threshold = np.nan_to_num(made.pressure_for(1e-6, e), nan=0.02)  # the lowest of the grid
        p = float(rng.uniform(threshold + 0.02, 0.2))
        state = quick.state(p, e)
        assert made(FORCE, p, e) == pytest.approx(state["force"], abs=0.6)
        assert made(VOLUME, p, e) == pytest.approx(state["volume"], rel=2e-4)
        by_p = made(FORCE, p, e, by="pressure")
        assert by_p == pytest.approx(state["force_by_pressure"], rel=0.02)
        assert made.pressure_for(state["force"], e) == pytest.approx(p, abs=4e-4)
        assert made.contraction_for(p, state["force"]) == pytest.approx(e, abs=4e-4)


def test_200_newtons_hang_where_the_solid_has_them(folder, monkeypatch):
    """Rows of a map by the solid, against isotonic states of its mesh; and of another mesh."""
    monkeypatch.chdir(folder)
    text = STUDY.replace("[0.02, 0.1, 0.2]", "[0.2, 0.3, 0.4, 0.5]")
    text = text.replace("[0, 0.02, 0.04]", "{from: 0, to: 0.22, step: 0.02}")
    Path("solid.yaml").write_text(text.replace("model: cylinder", "model: solid"))
    study = load("solid.yaml")
    builder, pressures = Builder(study, "quick"), (0.2, 0.3, 0.4, 0.5)
    for pressure in pressures:
        builder._solve(pressure)
    made = builder.map()
    path = LoadPath(kind="isotonic", held=200.0, stops=pressures)
    alone = Store(study).solution(study.muscles["dmsp20"].case(path, "solid"))
    published = (0.06218, 0.12664, 0.17018, 0.19788)
    for row, pressure in enumerate(pressures):
        found = made.contraction_for(pressure, 200.0)
        assert found == pytest.approx(alone.states["contraction"][row], abs=1e-5)
        assert found == pytest.approx(published[row], abs=3e-4)


def test_its_error_is_that_of_states_solved_alone(built, folder, monkeypatch):
    monkeypatch.chdir(folder)
    study = load("study.yaml")
    assert len(built.states) >= 3
    for pressure, contraction, by_map, force, _ in built.states:
        path = LoadPath(kind="isobaric", held=pressure, stops=(contraction,))
        store = Store(study)
        solution = store.solution(study.muscles["dmsp20"].case(path, "cylinder"))
        assert not store.solves  # it is in the store
        assert solution.states["force"][0] == force
        assert abs(by_map - force) <= max(built.error, built.error_near)


def test_the_program_writes_it_and_solves_nothing_again(built, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    assert main(["map", "quick", "--study", "study.yaml", "--folder", "maps"]) == 0
    assert "force within" in capsys.readouterr().out
    told = json.loads(Path("maps/quick.json").read_text())
    assert told["solves"] == 0
    assert told["force_error_N"] == built.error
    with xr.open_dataset("maps/quick.nc", engine="h5netcdf") as data:
        again = Map.of_dataset(data.load())
        assert data.attrs["force_error_N"] == built.error
    assert again(FORCE, 0.17, 0.03) == built.map(FORCE, 0.17, 0.03)
    tables = loadmat("maps/quick.mat")
    np.testing.assert_array_equal(tables["force"], built.map.tables["force"])
    lines = Path("maps/quick.csv").read_text().splitlines()
    assert len(lines) == 1 + built.map.valid.size
    assert lines[0].startswith("pressure [MPa],contraction [1],force [N]")
    first = {p.name: p.read_bytes() for p in Path("maps").iterdir()}
    main(["map", "quick", "--study", "study.yaml", "--folder", "maps"])
    changed = [n for n, b in first.items() if Path("maps", n).read_bytes() != b]
    assert changed == []


def test_the_fmu_gives_what_the_map_does(exact, tmp_path):
    """Its library is called as a simulator does; muscle of 300 mm, everything in SI units."""
    exact.valid[3, 3] = False
    assert fmu.write(exact, tmp_path / "m.fmu"), "no C compiler"
    with zipfile.ZipFile(tmp_path / "m.fmu") as archive:
        archive.extractall(tmp_path)
    described = ElementTree.parse(tmp_path / "modelDescription.xml").getroot()
    numbers = {
        v.get("name"): int(v.get("valueReference")) for v in described.iter("ScalarVariable")
    }
    (library,) = (tmp_path / "binaries").rglob("muscle.*")
    call = ctypes.CDLL(str(library))
    call.fmi2Instantiate.restype = call.fmi2GetVersion.restype = ctypes.c_void_p
    assert ctypes.string_at(call.fmi2GetVersion()) == b"2.0"

    def instance(guid):
        return call.fmi2Instantiate(b"m", 1, guid, b"", None, 0, 0)

    assert not instance(b"another")
    made = ctypes.c_void_p(instance(described.get("guid").encode()))
    real = ctypes.c_double

    def outputs(p, length):
        at = (ctypes.c_uint * 2)(numbers["p"], numbers["l"])
        assert call.fmi2SetReal(made, at, ctypes.c_size_t(2), (real * 2)(p, length)) == 0
        assert call.fmi2DoStep(made, real(0), real(0.1), 1) == 0
        names = ("F", "V", "dF_dl", "dF_dp", "valid")
        at, found = (ctypes.c_uint * 5)(*[numbers[n] for n in names]), (real * 5)()
        assert call.fmi2GetReal(made, at, ctypes.c_size_t(5), found) == 0
        return dict(zip(names, found, strict=True))

    rng = np.random.default_rng(3)
    for p, e in zip(rng.uniform(0, 0.4, 50), rng.uniform(-0.1, 0.3, 50), strict=True):
        found = outputs(p * 1e6, 0.3 * (1 - e))
        assert found["F"] == pytest.approx(float(exact(FORCE, p, e)), abs=1e-9)
        assert found["V"] == pytest.approx(float(exact(VOLUME, p, e)) * 1e-9, abs=1e-18)
        by_e, by_p = (float(exact(FORCE, p, e, by=k)) for k in ("contraction", "pressure"))
        assert found["dF_dl"] == pytest.approx(-by_e / 0.3, abs=1e-8)
        assert found["dF_dp"] == pytest.approx(by_p * 1e-6, abs=1e-14)
        assert found["valid"] == 1
    assert outputs(0.45e6, 0.3 * 0.8)["valid"] == 0  # beside a state that was not found
    assert outputs(0.6e6, 0.3)["valid"] == 0
    assert outputs(0.6e6, 0.3)["F"] == pytest.approx(outputs(0.5e6, 0.3)["F"])
    call.fmi2FreeInstance(made)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("muscle: dmsp20", "muscle: dmsp2"), "nearest: dmsp20"),
        (("[0.02, 0.1, 0.2]", "[0, 0.3]"), "at least 3 values"),
        (("[0.02, 0.1, 0.2]", "[0, 0.3, 30]"), "from 0 to 20 (MPa)"),
        (("[0, 0.02, 0.04]", "[0.01, 0.02, 0.04]"), "from 0 or less to more than 0"),
        (("model: cylinder", "model: geometric"), "cylinder, membrane, solid"),
        (("tolerance: 0.5", "tolerance: 0"), "0"),
    ],
)
def test_a_map_that_cannot_be_made_is_refused(tmp_path, change, said):
    assert change[0] in STUDY
    (tmp_path / "study.yaml").write_text(STUDY.replace(*change))
    with pytest.raises(StudyError) as refused:
        read(tmp_path / "study.yaml")
    assert said in str(refused.value)
