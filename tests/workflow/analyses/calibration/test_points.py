"""Fits to measured points: noise, a model that is wrong too, sizes, data that says nothing."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import yaml

from solver.load_path import LoadPath
from workflow.analyses.calibration import calibrate, files
from workflow.analyses.calibration.calibrate import _by_fullest, _parameters
from workflow.analyses.calibration.fit import Fitted, Parameter, fit_by_imperfect_model
from workflow.analyses.calibration.forward_model import ForwardModel, reshaped, shape_of
from workflow.analyses.calibration.points import Points
from workflow.data import bench, reference
from workflow.study.errors import StudyError
from workflow.study.study import load

from ...synthetic import MUSCLE

STUDY = MUSCLE + "scenes: {}\n"
TRUTH = {"thread_stiffness": 400.0, "c10": 0.345083}
AT = (0.2, 0.4)  # MPa
STEPS = (0.0, 0.03, 0.06, 0.09, 0.12)
OFF = {"thread_stiffness": 0.2, "c10": 0.1}  # of logarithms, on both sides of the truth
SEEDS = 40
REPEATED = 4  # measurements of one state


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("points")
    rows = [f"{p},{e},1" for p in AT for e in STEPS]
    (made / "forces.csv").write_text("\n".join(["pressure_MPa,contraction,force_N", *rows]))
    return made


def study(folder, calibration, file="forces.csv"):
    path = folder / "study.yaml"
    text = f"{STUDY}calibration: {{mine: {calibration}}}\n"
    path.write_text(text.replace("FILE", str(folder / file)))
    return load(path)


@pytest.fixture(scope="module")
def models(folder):
    """Forces of membrane, solid and the fullest model as parabolas of the logarithms."""
    given = study(folder, "{muscle: one, reference: FILE, fit: [thread_stiffness, c10]}")
    points = Points.of(bench.read(str(folder / "forces.csv"), 300.0))
    forward = ForwardModel(given, given.muscles["one"], folder)

    def around(computed):
        middle = computed(TRUTH)
        slopes, bends = {}, {}
        for key, off in OFF.items():
            ends = (float(TRUTH[key] * np.exp(sign * off)) for sign in (-1, 1))
            low, high = (computed(TRUTH | {key: end}) for end in ends)
            slopes[key], bends[key] = (high - low) / (2 * off), (high + low - 2 * middle) / off**2

        def forces(values):
            found = middle.copy()
            for key in OFF:
                x = np.log(values.get(key, TRUTH[key]) / TRUTH[key])
                found = found + slopes[key] * x + bends[key] * x**2 / 2
            return np.tile(found, REPEATED)

        return forces

    by = {m: around(lambda v, m=m: points.computed(forward, v, m)) for m in ("membrane", "solid")}
    finer = np.tile(_by_fullest(points, forward, TRUTH), REPEATED) - by["solid"](TRUTH)
    by["fullest"] = lambda values: by["solid"](values) + finer
    parameters = _parameters(given.calibration["mine"], given.muscles["one"])
    return by, {p.name: p for p in parameters}


@pytest.mark.parametrize("names", [["thread_stiffness"], ["thread_stiffness", "c10"]])
def test_intervals_have_the_error_of_the_model_in_them(models, names):
    """Forces of the solid with 1 N of noise, fitted by membrane and solid, forty times."""
    by, known = models
    parameters, truth = [known[name] for name in names], by["solid"](TRUTH)
    inside, widths = np.zeros(len(names)), {"membrane": [], "solid": []}
    for seed in range(SEEDS):
        measured = truth + np.random.default_rng(seed).standard_normal(truth.size)
        for model in widths:
            found = fit_by_imperfect_model(
                parameters,
                lambda v, m=model, y=measured: by[m](v) - y,
                lambda v, m=model: by["fullest"](v) - by[m](v),
            )
            widths[model].append([f.high - f.low for f in found])
            if model == "membrane":
                inside += [f.low < TRUTH[f.parameter.name] < f.high for f in found]
    assert (inside >= 36).all()
    assert (np.array(widths["membrane"]) < 4 * np.array(widths["solid"])).all()
    assert np.max(np.abs(by["solid"](TRUTH) - by["membrane"](TRUTH))) > 1  # there is an error


@pytest.fixture
def cheap(monkeypatch):
    """The membrane on a finer mesh is the fullest model, and checks the others."""
    monkeypatch.setattr(calibrate, "CHECK", "membrane")
    rungs = {"top": replace(calibrate.RUNGS["solid, finer"], model="membrane")}
    monkeypatch.setattr(calibrate, "RUNGS", rungs)


def test_all_points_are_fitted_as_they_were_measured(folder, cheap):
    """At pressures a little off what was set, one of them held out, one without a state."""
    given = study(folder, "{muscle: one, reference: FILE}")
    forward = ForwardModel(given, given.muscles["one"], folder)
    rows = ["pressure_MPa,contraction,force_N"]
    chance = np.random.default_rng(3)
    for p in (0.3, 0.4):
        force = forward.forces({"thread_stiffness": 500.0}, "membrane", p, (0.0, 0.05, 0.1, 0.15))
        slope = forward.along(
            {"thread_stiffness": 500.0}, "membrane",
            LoadPath(kind="isobaric", held=p, stops=(0.0, 0.05, 0.1, 0.15)),
        )["force_by_pressure"]  # fmt: skip
        off = chance.uniform(-0.002, 0.002, 4).round(5)
        rows += [
            f"{p + d:.5f},{e},{f + s * d:.4f}"
            for e, f, s, d in zip((0, 0.05, 0.1, 0.15), force, slope, off, strict=True)
        ]
    rows.append("0.3,0.35,-300")
    (folder / "noisy.csv").write_text("\n".join(rows))
    text = "{muscle: one, reference: FILE, report_pressure: [0.4]}"
    found = calibrate.calibrate(study(folder, text, "noisy.csv"), "mine")
    (fitted,) = found.fitted
    assert fitted.value == pytest.approx(500, rel=1e-3)
    assert fitted.low < 500 < fitted.high
    table = found.residuals
    assert len(table) == 9
    assert table.groupby("why")["measured"].count().to_dict() == {
        "": 4,
        "not asked for": 4,
        "no valid state by membrane": 1,
    }
    assert table["residual"].abs().max() < 0.05
    roles = found.deviations.set_index("pressure [MPa]")["role"].to_dict()
    assert roles == {0.3: "fit", 0.4: "report"}
    said = calibrate.values(found, study(folder, text, "noisy.csv"))["note"].iloc[0]
    assert "1 of 9 measured points not fitted: no valid state by membrane" in said


def test_points_of_a_sweep_of_the_pressure_are_those_of_its_contraction(folder):
    rows = ["pressure_MPa,contraction,force_N"]
    for e in (0.05, 0.1):
        rows += [f"{p:.3f},{e},{1000 * p * (1 - 4 * e):.3f}" for p in np.linspace(0.12, 0.4, 90)]
    (folder / "sweeps.csv").write_text("\n".join(rows))
    points = Points.of(bench.read(str(folder / "sweeps.csv"), 300.0))
    assert [(c.kind.value, c.at, len(c.points)) for c in points.curves] == [
        ("isometric", 0.05, 90),
        ("isometric", 0.1, 90),
    ]
    given = study(folder, "{muscle: one, reference: FILE}")
    forward = ForwardModel(given, given.muscles["one"], folder)
    found = points.computed(forward, {}, "membrane")
    path = LoadPath(kind="isobaric", held=0.321, stops=(0.05,))
    at = points.table.index[(points.table["pressure"] - 0.321).abs() < 2e-3][0]
    path = replace(path, held=float(points.table["pressure"][at]))
    (expected,) = forward.along({}, "membrane", path)["force"]
    assert found[at] == pytest.approx(expected, abs=0.02)  # between the places that are solved


def test_points_of_a_map_are_its_own(folder):
    found = reference.load(["festo_musclesim"])["festo_musclesim"]
    points = Points.of(found)
    assert len(points.table) == len(found.points)
    near = points.near([0.3])
    assert near.sum() == np.sum(found.points[:, 0] == 0.3)
    assert not points.near([0.25]).any()


def test_a_size_is_found_within_its_tolerance(folder, cheap):
    """Another angle than the drawing says, and what is pasted is the muscle that was fitted."""
    text = "{muscle: one, reference: FILE, fit: [thread_stiffness, angle], tolerance: {angle: 2}}"
    given = study(folder, text)
    muscle = given.muscles["one"]
    true = shape_of(muscle.muscle)["angle"] + 0.7
    forward = ForwardModel(given, muscle, folder)
    rows = ["pressure_MPa,contraction,force_N"]
    for p in (0.2, 0.4):
        at = (0.0, 0.05, 0.1)
        forces = forward.forces({"angle": true, "thread_stiffness": 330.0}, "membrane", p, at)
        rows += [f"{p},{e},{f}" for e, f in zip(at, forces, strict=True)]
    (folder / "angled.csv").write_text("\n".join(rows))
    given = study(folder, text, "angled.csv")
    found = calibrate.calibrate(given, "mine")
    thread, angle = found.fitted
    assert angle.value == pytest.approx(true, abs=0.02)
    assert thread.value == pytest.approx(330, rel=0.01)
    assert angle.parameter.low < angle.low < angle.high < angle.parameter.high
    tables = {"calibration_values": calibrate.values(found, given)}
    pasted = yaml.safe_load(files.texts(given, tables)["mine.yaml"])["muscles"]["mine"]
    assert pasted["angle"] == found.values["angle"]
    whole = yaml.safe_load(STUDY)
    whole["muscles"]["mine"] = pasted
    (folder / "pasted.yaml").write_text(yaml.safe_dump(whole))
    made = load(folder / "pasted.yaml").muscles["mine"]
    assert made.muscle == reshaped(muscle.muscle, {"angle": found.values["angle"]})
    assert made.thread.stiffness == found.values["thread_stiffness"]


def test_sizes_that_are_pasted_are_those_that_were_fitted(folder):
    given = study(
        folder,
        "{muscle: one, reference: FILE, fit: [wall_thickness, layer_radius], "
        "tolerance: {wall_thickness: 0.1, layer_radius: 0.1}}",
    )
    values = {"wall_thickness": 2.05, "layer_radius": 10.64}
    whole = yaml.safe_load(STUDY)
    whole["muscles"] |= yaml.safe_load(files.text(given, "mine", values))["muscles"]
    (folder / "pasted.yaml").write_text(yaml.safe_dump(whole))
    made, base = load(folder / "pasted.yaml").muscles["mine"].muscle, given.muscles["one"].muscle
    expected = reshaped(base, values)
    assert made.wall_thickness == expected.wall_thickness == 2.05
    assert made.cap_length == expected.cap_length
    assert made.braid.layer_diameters == pytest.approx((20.68, 21.88))
    assert made.braid.layer_diameters == pytest.approx(expected.braid.layer_diameters)
    assert made.braid.lead == pytest.approx(expected.braid.lead, rel=1e-9)
    assert made.braid.angle == pytest.approx(base.braid.angle)


LARGE = Parameter("thread_stiffness", "N", 315, 10, 10000)


@pytest.mark.parametrize(
    ("fitted", "said"),
    [
        (Fitted(LARGE, 700, 1, 500_000), "hardly says anything"),
        (Fitted(LARGE, 10_000, 9000, 11_000), "stopped by its bound"),
        (Fitted(Parameter("angle", "degree", 25, 24, 26, 1.0), 26, 25.5, 26.5), "its tolerance"),
        (Fitted(LARGE, 700, np.nan, np.nan), "hardly says anything"),
    ],
)
def test_a_fit_that_says_nothing_gives_no_muscle(folder, fitted, said):
    given = study(folder, "{muscle: one, reference: FILE}")
    residuals = pd.DataFrame({"fitted": [1], "why": [""]})
    found = calibrate.Calibration(
        "mine", given.calibration["mine"], [fitted], *[pd.DataFrame()] * 2, residuals
    )
    assert found.says_nothing
    rows = calibrate.values(found, given)
    assert not rows["usable"].any()
    text = files.texts(given, {"calibration_values": rows})["mine.yaml"]
    assert yaml.safe_load(text) is None
    assert "No muscle to paste" in text
    assert said in text


def test_forces_between_the_pressures_of_a_map_are_said(folder):
    given = study(folder, "{muscle: one, reference: martens2017, fit_pressure: [0.3, 0.375]}")
    found = calibrate.Calibration("mine", given.calibration["mine"], [], *[pd.DataFrame()] * 3)
    assert calibrate.of_points(found, given) == "at 0.3 MPa between the pressures of martens2017"


@pytest.mark.parametrize(
    ("calibration", "said"),
    [
        ("{muscle: one, fit: [angle]}", "how well it is known"),
        ("{muscle: one, tolerance: {angle: 1}}", "only where angle is fitted"),
        ("{muscle: one, fit: [angle], tolerance: {angle: 40}}", "less than"),
        ("{muscle: one, fit: [wall_thickness], tolerance: {wall_thickness: 1.5}}", "in the wall"),
        ("{muscle: one, fit: [angle], tolerance: {angle: 0}}", "greater than 0"),
    ],
)
def test_sizes_without_a_sensible_tolerance_are_refused(folder, calibration, said):
    with pytest.raises(StudyError, match=said):
        study(folder, calibration)


def test_all_that_is_held_out_leaves_nothing_to_fit(folder):
    given = study(folder, "{muscle: one, reference: FILE, report_pressure: [0.2, 0.4]}")
    with pytest.raises(StudyError, match="is left to fit"):
        calibrate.calibrate(given, "mine")
