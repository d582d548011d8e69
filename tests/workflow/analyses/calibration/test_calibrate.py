"""Calibrations of a study: of forces whose origin is known, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from geometry.muscle import Braid
from workflow.analyses.calibration import calibrate, files
from workflow.analyses.calibration.calibrate import thickest
from workflow.analyses.calibration.fit import Fitted, Parameter
from workflow.analyses.calibration.forward_model import ForwardModel
from workflow.data import bench
from workflow.study.errors import StudyError
from workflow.study.study import load

from ...synthetic import MUSCLE

STEPS = (0.0, 0.05, 0.1, 0.15, 0.2)
STUDY = (
    MUSCLE
    + """\
  bare: {base: one, threads: none}
scenes:
  curves:
    path: isobaric
    muscles: [one]
    pressure: [0.3]
    contraction: [0, 0.1]
    models: [membrane]
"""
)
FIT = "calibration: {mine: {muscle: one, reference: REFERENCE, report_pressure: [0.4]}}"


@pytest.fixture
def study(tmp_path):
    def make(calibration=FIT, reference="forces.csv", text=STUDY):
        path = tmp_path / "study.yaml"
        path.write_text(text + calibration.replace("REFERENCE", str(tmp_path / reference)))
        return load(path)

    return make


@pytest.fixture
def forces_of(study, tmp_path):
    """A file of forces computed with known values."""

    def make(values, error=0.0):
        given = study(calibration="")
        forward = ForwardModel(given, given.muscles["one"], tmp_path)
        lines = ["pressure_MPa,contraction,force_N"]
        for pressure in (0.3, 0.4):
            forces = forward.forces(values, "membrane", pressure, STEPS)
            lines += [
                f"{pressure},{e},{f + error * (-1) ** k}"
                for k, (e, f) in enumerate(zip(STEPS, forces, strict=True))
            ]
        (tmp_path / "forces.csv").write_text("\n".join(lines))

    return make


def test_a_known_stiffness_is_found_and_predicts_other_pressures(study, forces_of):
    forces_of({"thread_stiffness": 500.0}, error=1.0)
    found = calibrate.calibrate(study(), "mine")
    (fitted,) = found.fitted
    assert fitted.value == pytest.approx(500, rel=0.01)
    assert fitted.low < 500 < fitted.high
    rows = found.deviations.set_index(["values", "model", "pressure [MPa]"])
    column = "mean_absolute_of_largest_force [1]"
    assert rows.loc[("after", "membrane", 0.4), column] < 0.003
    assert rows.loc[("after", "solid", 0.4), column] < 0.01
    assert rows.loc[("before", "membrane", 0.4), column] > 0.02
    assert rows.loc[("after", "membrane", 0.3), "role"] == "fit"
    assert rows.loc[("after", "membrane", 0.4), "role"] == "report"


def test_rubber_is_fitted_too_and_the_entry_is_a_muscle(study, forces_of):
    forces_of({"thread_stiffness": 400.0, "c10": 0.3})
    fitting = FIT.replace("muscle: one,", "muscle: one, fit: [thread_stiffness, c10],")
    given = study(fitting)
    found = calibrate.calibrate(given, "mine")
    assert found.values == pytest.approx({"thread_stiffness": 400, "c10": 0.3}, rel=0.01)
    written = files.text(given, "mine", found.values).splitlines()
    lines = [line for line in written if not line.startswith("#")]
    text = STUDY
    for heading, line in zip(lines[::2], lines[1::2], strict=True):
        text = text.replace(f"{heading}\n", f"{heading}\n{line}\n")
    pasted = study(calibration="", text=text).muscles["mine"]
    assert pasted.thread.stiffness == found.values["thread_stiffness"]
    assert pasted.rubber.c10 == found.values["c10"]
    assert pasted.rubber.c01 == 0.083805
    assert pasted.muscle == given.muscles["one"].muscle


def test_the_entry_of_a_fitted_rubber_has_what_else_is_known_of_it(study):
    more = "stretch_limit: 4, density: 1.1, memory: {per_decade: 0.05, from: 1.0e-3, to: 100}"
    text = STUDY.replace("c01: 0.083805", f"c01: 0.083805, fitted_range: [0.8, 3], {more}")
    fitting = FIT.replace("muscle: one,", "muscle: one, fit: [c10],")
    written = files.text(study(fitting, text=text), "mine", {"c10": 0.3}).splitlines()
    entry = written[written.index("materials:") + 1]
    assert "fitted_range" not in entry  # of the law that was replaced
    pasted = study(calibration="", text=text.replace("materials:\n", f"materials:\n{entry}\n"))
    assert pasted.source.plain["materials"]["mine"] == {
        **{"c10": 0.3, "c01": 0.083805, "kappa": 1000, "stretch_limit": 4, "density": 1.1},
        "memory": {"per_decade": 0.05, "from": 1e-3, "to": 100},
    }


def test_a_value_beyond_what_fits_between_the_layers_is_said(study):
    braid = Braid(lead=144, threads=60, layer_diameters=(20.6, 21.8))
    assert thickest(braid) == pytest.approx(2100 * np.pi * 0.6**2 / 4)
    assert round(thickest(braid)) == 594
    muscle = study(calibration="").muscles["one"]
    stiffness = Parameter("thread_stiffness", "N", 315, 10, 10000)
    assert "594" in calibrate.note(Fitted(stiffness, 600, 590, 610), muscle)
    assert calibrate.note(Fitted(stiffness, 590, 580, 610), muscle) == ""
    assert "bound" in calibrate.note(Fitted(stiffness, 10, 9, 11), muscle)
    assert "hardly" in calibrate.note(Fitted(stiffness, 300, np.nan, np.nan), muscle)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no force"),
        ("pressure_MPa,force_N\n0.3,1\n", "column contraction, stroke or length is missing"),
        ("pressure_MPa,contraction,force_N\n0.3,x,1\n", ":2: not all of it are numbers"),
        ("pressure_MPa,contraction,force_N\n0.3,0,1\n0.3,0,inf\n", ":3: not all"),
    ],
)
def test_a_file_that_is_no_map_is_refused(tmp_path, text, said):
    path = tmp_path / "forces.csv"
    path.write_text(text)
    with pytest.raises(StudyError, match=said):
        bench.read(str(path), 300.0)


def test_forces_of_another_unit_are_refused(study, tmp_path):
    (tmp_path / "forces.csv").write_text("pressure_MPa,contraction,force\n0.3,0,0.7\n0.3,0.1,0.2\n")
    (error,) = bench.refused(study())
    assert "calibration.mine.reference" in str(error)
    assert "perhaps kN under N" in str(error)


def test_maps_and_files_are_read(tmp_path):
    assert bench.read("martens2017", 300.0).name == "martens2017"
    path = tmp_path / "own.csv"
    path.write_text(
        "pressure_MPa,length_mm,force_N,suspect\n0.3,300,700,0\n0.3,270,250,1\n0.3,240,0,0\n"
        "0.3,285,400,\n"
    )
    found = bench.read(str(path), 300.0)
    np.testing.assert_allclose(found.points, [[0.3, 0, 700], [0.3, 0.05, 400]])
    with pytest.raises(StudyError, match="cannot be read"):
        bench.read(str(tmp_path / "none.csv"), 300.0)
    with pytest.raises(StudyError, match="no such reference map"):
        bench.read("festo", 300.0)


@pytest.mark.parametrize(
    ("calibration", "said"),
    [
        ("{muscle: bare}", "a muscle with a braid"),
        ("{muscle: two}", "one"),
        ("{muscle: one, fit: [lead]}", "thread_stiffness"),
        ("{muscle: one, bounds: {c10: [1, 0.5]}}", "two rising numbers > 0"),
        ("{muscle: one, fit_pressure: [0]}", "pressures > 0"),
        ("{muscle: one, speed: fast}", "is no key here"),
    ],
)
def test_what_cannot_be_calibrated_is_refused(study, calibration, said):
    with pytest.raises(StudyError, match=said):
        study(f"calibration: {{mine: {calibration}}}")


def test_a_muscle_is_fitted_to_its_own_map_unless_another_is_named(study):
    """Never without a word to the map of another muscle."""
    own = STUDY.replace("material: nbr\n", "material: nbr\n    reference: [martens2017]\n", 1)
    left_out = "calibration: {mine: {muscle: one}}"
    assert study(left_out, text=own).calibration["mine"].reference == "martens2017"
    named = "calibration: {mine: {muscle: one, reference: festo_musclesim}}"
    assert study(named, text=own).calibration["mine"].reference == "festo_musclesim"
    with pytest.raises(StudyError) as refused:
        study(f"{left_out}\n")
    assert "study.yaml:21: calibration.mine.reference is missing" in str(refused.value)
    assert "one has no map of its own" in str(refused.value)


def test_a_pressure_without_forces_is_refused(study, tmp_path):
    (tmp_path / "forces.csv").write_text("pressure_MPa,contraction,force_N\n0.2,0,1\n0.2,0.1,1\n")
    asking = FIT.replace("report_pressure: [0.4]", "fit_pressure: [0.3]")
    with pytest.raises(StudyError, match=r"no force at 0\.3 MPa"):
        calibrate.calibrate(study(asking), "mine")


def test_the_study_of_the_paper_asks_for_calibrations():
    study = load(Path(__file__).parents[4] / "config/config.yaml")
    assert {"festo_musclesim", "martens2017"} == {e.reference for e in study.calibration.values()}
