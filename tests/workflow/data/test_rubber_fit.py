"""Laws of rubber fitted to tests: numbers of others, traps, and what is read and written."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from solver import rubber
from workflow.__main__ import main
from workflow.data import rubber_fit, rubber_tests
from workflow.data.rubber_tests import RubberTest
from workflow.study.errors import StudyError
from workflow.study.study import load

MATERIALS = Path(__file__).parents[3] / "config/reference/materials"
FILES = [MATERIALS / f"treloar_{name}.csv" for name in ("UT", "ET", "PS")]


@pytest.fixture(scope="module")
def treloar():
    return rubber_tests.read(FILES)[0]


CHECKED = {  # law, tests: parameters, sum of squares; by another code on scipy
    ("yeoh", 1): ((0.176284, -0.00185474, 4.64103e-5), 0.25294),
    ("yeoh", 3): ((0.184702, -0.00146456, 4.0215e-5), 1.00879),
    ("ogden3", 3): ((0.368133, -0.00489525, 1.05541e-6, 1.89159, -2.2621, 8.44778), 0.20849),
    ("gent", 3): ((0.274483, 84.3046), 1.00287),
    ("arruda_boyce", 3): ((0.270786, 4.62646), 1.16502),
    ("mooney_rivlin", 3): ((0.267578, -0.0018077), 20.9005),
}


@pytest.mark.parametrize(("law", "count"), CHECKED)
def test_fits_of_others_are_met(treloar, law, count):
    parameters, squares = CHECKED[law, count]
    found = rubber_fit.fit(law, treloar[:count])
    numbers = [v for v in found.values.values() if not isinstance(v, str)]
    np.testing.assert_allclose(np.hstack(numbers), parameters, rtol=1e-4)
    assert found.squares == pytest.approx(squares, rel=1e-4)
    assert not found.unstable


def test_mooney_rivlin_of_one_test_is_no_rubber(treloar, tmp_path, capsys):
    found = rubber_fit.fit("mooney_rivlin", treloar[:1])
    assert found.values["c01"] == pytest.approx(-0.751, abs=1e-3)
    assert found.material is None
    assert rubber_fit.entry(found) == {}
    picture = tmp_path / "a.png"
    given = ["fit-rubber", str(FILES[0]), "--law", "mooney_rivlin", "--picture", str(picture)]
    assert main(given) == 1
    said = capsys.readouterr().out
    assert "initial shear modulus would be -0.6845 MPa" in said
    assert "of uniaxial tests alone" in said
    assert "materials:" not in said


def test_terms_of_ogden_are_stable_though_one_test_is_known(treloar):
    found = rubber_fit.fit("ogden3", treloar[:1])
    mu, alpha = np.array(found.values["mu"]), np.array(found.values["alpha"])
    assert (mu * alpha > 0).all()
    assert not found.unstable
    assert found.squares < 0.1


def test_an_unstable_law_is_said_so(treloar):
    found = rubber_fit.fit("rivlin2", treloar[:1])
    assert found.unstable["equibiaxial"] < 1.2


def test_a_fit_to_the_range_that_is_used(treloar):
    found = rubber_fit.fit("yeoh", treloar, 1.8)
    assert found.span[1] <= 1.8
    near = np.concatenate(list(found.residuals.values()))
    all_of_it = rubber_fit.fit("yeoh", treloar)
    far = [all_of_it.residuals[t.kind][: len(found.residuals[t.kind])] for t in treloar]
    assert np.mean(near**2) < 0.5 * np.mean(np.concatenate(far) ** 2)


LAWS = {
    "neo_hooke": {"c10": 0.3},
    "mooney_rivlin": {"c10": 0.3, "c01": 0.05},
    "yeoh": {"c1": 0.3, "c2": -0.01, "c3": 0.002},
    "rivlin": {"c10": 0.3, "c01": 0.05, "c20": 0.01, "c11": 0.002, "c02": 0.001},
    "ogden": {"convention": "textbook", "mu": [0.6, -0.02], "alpha": [1.5, -3.0]},
    "gent": {"mu": 0.5, "jm": 20.0},
    "arruda_boyce": {"mu": 0.5, "lambda_m": 2.5},
}


@pytest.mark.parametrize("law", LAWS)
def test_a_law_is_found_again_in_its_own_stresses(law):
    """And the stress is the slope of the energy."""
    material, step = rubber.from_dict({"law": law} | LAWS[law]), 1e-6
    tests = []
    for kind in rubber_tests.KINDS:
        stretch = np.linspace(1.05, 2.2, 12)
        stress = rubber_tests.stress(material, kind, stretch)
        sides = 2 if kind == "equibiaxial" else 1
        energy = [
            material.energy(*rubber_tests.squares(kind, stretch + d), np.zeros(12))
            for d in (-step, step)
        ]
        np.testing.assert_allclose(
            (energy[1] - energy[0]) / (2 * step), sides * stress, rtol=1e-7, atol=1e-9
        )
        tests.append(RubberTest(kind, stretch, stress))
    name = {"rivlin": "rivlin2", "ogden": "ogden2"}.get(law, law)
    found = rubber_fit.fit(name, tests)
    assert found.squares < 1e-12
    for key, value in LAWS[law].items():
        if key != "convention":
            np.testing.assert_allclose(found.values[key], value, rtol=1e-4, atol=1e-7)
    for test in tests:
        np.testing.assert_allclose(found.stress(test.kind, test.stretch), test.stress, atol=1e-6)


def written(tmp_path, name: str, text: str) -> Path:
    path = tmp_path / name
    path.write_text(text)
    return path


def test_one_file_of_all_tests(treloar, tmp_path):
    """Strains in percent, true stresses in kPa, semicolons, decimal commas, a column of tests."""
    text = "Test;True stress [kPa];Strain [%]\n"
    for test in treloar:
        for stretch, stress in zip(test.stretch, test.stress, strict=True):
            row = f"{test.kind};{1e3 * stress * stretch:.9f};{100 * (stretch - 1):.9f}\n"
            text += row.replace(".", ",")
    found, said = rubber_tests.read([written(tmp_path, "all.csv", text)])
    for test, again in zip(treloar, found, strict=True):
        assert test.kind == again.kind
        np.testing.assert_allclose(again.stretch, test.stretch, rtol=1e-9)
        np.testing.assert_allclose(again.stress, test.stress, rtol=1e-9)
    assert any("53 of 53 points used" in line for line in said)


WRONG = {
    "strains called stretches": ("ut.csv", "stretch,stress_MPa\n0,0\n0.5,0.3\n", "perhaps strains"),
    "percent": ("ut.csv", "strain,stress_MPa\n0,0\n50,0.3\n", "perhaps they are in %"),
    "pascal": ("ut.csv", "strain,stress\n0,0\n0.5,300000\n", "not of a rubber"),
    "sign": ("ut.csv", "strain,stress_MPa\n0.1,-0.1\n0.5,-0.3\n", "sign is the other"),
    "test": ("mine.csv", "strain,stress_MPa\n0.1,0.1\n0.5,0.3\n", "of which test"),
    "tests": ("mine.csv", "strain,stress_MPa,test\n0.1,0.1,torsion\n", "no test 'torsion'"),
    "empty": ("ut.csv", "", "nothing measured is in it"),
    "no stress": ("ut.csv", "strain,area\n0.1,0.1\n", "column stress is missing"),
    "no strain": ("ut.csv", "stress_MPa,area\n0.1,0.1\n", "column stretch or strain is missing"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_looks_wrong_is_refused(tmp_path, name):
    file, text, said = WRONG[name]
    with pytest.raises(StudyError, match=said) as caught:
        rubber_tests.read([written(tmp_path, file, text)])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        *(("UT", "uniaxial"), ("treloar_ET", "equibiaxial"), ("equi-biaxial 2", "equibiaxial")),
        *(("pure shear", "planar"), ("NR_PS_3", "planar"), ("tensile", "uniaxial"), ("rubber", "")),
    ],
)
def test_kinds_by_their_names(name, kind):
    assert rubber_tests.kind_of(name) == kind


def test_the_command_gives_a_material_that_a_study_takes(tmp_path, capsys):
    picture = tmp_path / "nr.png"
    files = list(map(str, FILES))
    given = ["fit-rubber", *files, "--law", "ogden3", "--name", "nr", "--picture", str(picture)]
    assert main(given) == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    said = capsys.readouterr().out
    assert "stable by Drucker's condition in all three tests" in said
    assert "--up-to 1.8 fits that" in said
    entry = yaml.safe_load(said[said.index("materials:") : said.index("picture:")])
    assert entry["materials"]["nr"]["fitted_range"] == [1.0, 7.6]
    study = written(
        tmp_path,
        "study.yaml",
        said[said.index("materials:") : said.index("picture:")]
        + "muscles:\n  tube: {inner_diameter: 20, wall_thickness: 2, length: 100, threads: none, "
        "material: nr}\nscenes: {}\n",
    )
    read = load(study).muscles["tube"]
    assert read.rubber.shear_modulus == pytest.approx(0.35373, rel=1e-4)
    assert read.limits.fitted_range == (1.0, 7.6)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--law", "ogden9"], "--law ogden9 is refused"),
        (["--law", "yeoh", "--up-to", "1"], "--up-to 1 is refused"),
        (["--law", "yeoh", "--up-to", "1.1"], "yeoh has 3 parameters, and there are 1 points"),
        (["--law", "yeoh", "--picture", "a.gif"], "--picture a.gif is refused"),
    ],
)
def test_what_cannot_be_fitted_is_refused(capsys, more, said):
    assert main(["fit-rubber", str(FILES[0]), *more]) == 1
    assert said in capsys.readouterr().err
