"""Every figure, from solutions with changes of sign, gaps, marks and all models.

What is in a table is drawn or named; bands lie around their lines; muscles are named; what the
paper says stands beside the paper's muscle alone.
"""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from solver import record
from solver.models import MODELS
from solver.status import Flag, StateStatus
from workflow.data.scene_data import FLAGS, SceneData
from workflow.data.states import GOOD, SHOWN
from workflow.figures import curves, style
from workflow.figures.labels import SERIES
from workflow.plan.plan import plan
from workflow.study.study import load

from .conftest import solve

STUDY = """\
materials:
  nbr: {c10: 0.345083, c01: 0.083805}
  soft: {c10: 0.028, c01: 0.018}
muscles:
  NORMAL
  arm: {base: finger, inner_diameter: 40, angle_of: finger}
  arm_dense: {base: arm, threads: 100}
  thick: {base: finger, wall_thickness: 3}
  soft_finger: {base: finger, material: soft}
variants:
  paper: {effects: {end: butt, threads: two_way}}
scenes:
  fig03: {muscles: [finger, arm]}
  fig04:
    path: isobaric
    muscles: [finger]
    pressure: [0.2, 0.3]
    contraction: CONTRACTION
    models: ALL
    variants: [default, paper]
  fig05:
    path: isobaric
    muscles: [finger, arm]
    pressure: [0.3]
    contraction: [0.05, 0.1]
    models: [solid, cell]
    quantities: [stress]
  fig06:
    path: isometric
    muscles: [finger, arm]
    contraction: [0.1]
    pressure: PRESSURE
    models: ALL
    quantities: [threshold_pressure]
  fig07:
    path: isometric
    muscles: [finger]
    contraction: [0.1]
    pressure: PRESSURE
    models: ALL
  fig08:
    path: isotonic
    muscles: [finger]
    load: [50, 100]
    pressure: PRESSURE
    models: ALL
  fig09:
    path: isobaric
    muscles: [finger, arm]
    pressure: [0.3]
    contraction: CONTRACTION
    models: ALL
  fig10:
    path: isobaric
    muscles: [finger, arm, arm_dense]
    pressure: [0.3]
    contraction: CONTRACTION
    models: ALL
  fig11:
    path: isobaric
    muscles: [finger, arm, arm_dense]
    pressure: [0.3]
    contraction: CONTRACTION
    models: ALL
  fig12:
    path: isobaric
    muscles: [finger, thick, soft_finger]
    pressure: [0.3]
    contraction: [0.1]
    models: ALL
  fig13:
    path: isotonic
    muscles: [finger, thick, soft_finger]
    load: [50]
    pressure: [0.3]
    models: ALL
"""
STUDY = (
    STUDY.replace("ALL", f"[{', '.join(MODELS)}]")
    .replace("CONTRACTION", "{from: 0, to: 0.24, step: 0.02}")
    .replace("PRESSURE", "{from: 0, to: 0.4, step: 0.02}")
)
FOREIGN = """\
finger:
    inner_diameter: 22
    wall_thickness: 1.5
    length: 200
    layer_depths: [0.3, 0.9]
    threads: 48
    angle: 22
    thread_stiffness: 315
    material: nbr"""
PAPERS = """\
finger:
    inner_diameter: 20
    wall_thickness: 2
    length: 300
    layer_depths: [0.3, 0.9]
    threads: 60
    lead: 144
    thread_stiffness: 315
    material: nbr
    reference: [festo_musclesim, martens2017]"""
FIGURES = [f"fig{number:02}" for number in range(3, 14)]
WITH_STATES = FIGURES[1:]
MARKED = ("fig04", "fig06", "fig07", "fig11")  # figures with a number of the paper


def module(name):
    return importlib.import_module(f"workflow.figures.{name}")


def spoil(case, solution):
    """Less force, so that it changes its sign on the way; states of every status and flag."""
    states = {name: values.copy() for name, values in solution.states.items()}
    count = len(solution.state_status)
    status, flags = [StateStatus.CONVERGED] * count, [frozenset()] * count
    if case.path.kind != "isotonic" and count > 1:
        states["force"] = states["force"] - 0.35 * np.nanmax(states["force"])
    if case.model == "membrane" and case.muscle.inner_diameter > 30:
        status = [StateStatus.NOT_REACHED] * count
    elif count > 10:
        status[3], status[4] = StateStatus.NOT_REACHED, StateStatus.INVALID_STATE
        status[6] = StateStatus.UNSTABLE
        flags[1], flags[2] = frozenset({Flag.OVERSTRAINED}), frozenset(Flag)
        if case.model == "solid":
            status[5::2] = [StateStatus.INVALID_STATE] * len(status[5::2])  # lonely ones between
        if case.model == "cylinder" and case.path.zero_force:
            status[-1] = StateStatus.NO_ROOT
    for number, word in enumerate(status):
        if word in (StateStatus.NOT_REACHED, StateStatus.NO_ROOT):
            for name in ("force", "contraction", "pressure"):
                states[name][number] = np.nan
    states["thread_stretch_max"] = np.full(count, 1.12 if case.model == "solid" else 1.01)
    fields = solution.fields
    if case.model == "solid" and case.muscle.inner_diameter < 30:
        for number in fields:
            status[number] = StateStatus.CONVERGED  # has a stress that is drawn
    if case.model == "cell":
        fields = {
            number: {"corners": np.zeros((8, 6)), "stress": np.zeros((8, 6))} for number in fields
        }
    return replace(solution, states=states, state_status=status, flags=flags, fields=fields)


@pytest.fixture(scope="module")
def plans(tmp_path_factory):
    folder, found = tmp_path_factory.mktemp("studies"), {}
    for name, muscle in (("foreign", FOREIGN), ("papers", PAPERS)):
        path = folder / f"{name}.yaml"
        path.write_text(STUDY.replace("NORMAL", muscle))
        found[name] = plan(load(path))
    return found


@pytest.fixture(scope="module", params=FIGURES)
def drawn(request, plans, tmp_path_factory):
    """Name, and by study: table, figure and its words."""
    found = {}
    for study, planned in plans.items():
        folder = tmp_path_factory.mktemp("cases")
        for key in set(planned.scenes.get(request.param, {}).values()):
            case = planned.cases[key].case
            record.write(folder / f"{key}.h5", case, spoil(case, solve(case)))
        data = SceneData.read(planned, request.param, folder)
        table = module(request.param).table(data)
        figure = module(request.param).draw(table)
        style.save(figure, folder / "figure.png")
        found[study] = table, figure, words(figure), data
    return request.param, found


def words(figure):
    """All that is written on a figure, in one line."""
    texts = [*figure.texts]
    for legend in figure.legends:
        texts += legend.get_texts()
    for ax in figure.axes:
        texts += [*ax.texts, ax.title, ax._left_title, ax.xaxis.label, ax.yaxis.label]
        legend = ax.get_legend()
        texts += legend.get_texts() if legend else []
    return " ".join(text.get_text() for text in texts).replace("\n", " ")


def lines(figure):
    """Labels of curves of which something is seen."""
    return [
        line.get_label()
        for ax in figure.axes
        for line in ax.lines
        if np.isfinite(np.asarray(line.get_ydata(), float)).any()
    ]


def test_every_curve_is_drawn_or_named(drawn):
    name, found = drawn
    if name == "fig03":
        return
    for table, figure, text, _ in found.values():
        keys = ["source", SERIES] if SERIES in table else ["source", "variant"]
        labels = lines(figure)
        for key, rows in table[table["point"] != "zero force"].groupby(keys):
            label = style.look_of(key[0])["label"]
            mine = [one for one in labels if label in one]
            if SERIES in table and name not in ("fig05", "fig07"):
                mine = [one for one in mine if key[1] in one]
            seen = name == "fig05" and "solid" in label
            assert mine or seen or f"{label}" in text.partition("Not drawn")[2], key
            if not rows["status"].isin(SHOWN).any():
                assert label in text.partition("Not drawn")[2], key


def test_every_status_and_flag_is_named(drawn):
    name, found = drawn
    for table, _, text, _ in found.values():
        if name == "fig03":
            continue
        for status, said in {
            "not_reached": "not reached",
            "invalid_state": "invalid state",
            "no_root": "no root",
        }.items():
            if (table["status"] == status).any():
                assert said in text, status
        if table[FLAGS].fillna("").str.contains("overstrained").any():
            assert "beyond a limit of the material" in text
            assert "overstrained" in text
        if table[FLAGS].fillna("").str.contains("smoothed").any():
            assert "smoothing of slack threads" in text
        if (table["source"] == "solid").any():
            assert "stretched by up to 12 % (FE solid)" in text


@pytest.mark.parametrize("name", ["fig04", "fig05", "fig12"])
def test_where_the_strength_is_known_no_stretch_is_too_far(name, tmp_path):
    """Then what is beyond it is overstrained, and nothing else."""
    path = tmp_path / "strong.yaml"
    path.write_text(STUDY.replace("NORMAL", f"{PAPERS}\n    thread_strength: 1000"))
    planned = plan(load(path))
    for key in set(planned.scenes[name].values()):
        case = planned.cases[key].case
        record.write(tmp_path / f"{key}.h5", case, spoil(case, solve(case)))
    figure = module(name).draw(module(name).table(SceneData.read(planned, name, tmp_path)))
    assert "Threads are stretched" not in words(figure)


def test_bands_hug_their_lines(drawn):
    _, found = drawn
    for _, figure, _, _ in found.values():
        for ax in figure.axes:
            for band in ax.collections:
                if band.get_label() != curves.BAND:
                    continue
                x, y = (np.asarray(v, float) for v in band.around.get_data())
                known = np.isfinite(y)
                for path in band.get_paths():
                    for at, height in path.vertices:
                        near = np.isclose(x[known], at)
                        assert near.any(), "a band where there is no line"
                        away = np.abs(y[known][near] - height).min()
                        assert away <= 0.05 * np.abs(y[known]).max()
                        assert height > 0 or ax.get_yscale() != "log"


def test_every_muscle_is_named(drawn):
    name, found = drawn
    for _, _, text, data in found.values():
        for muscle in data.muscles:
            assert muscle in text, (name, muscle)


def test_what_the_paper_says_stands_beside_its_muscle_alone(drawn):
    name, found = drawn
    for study, (_, _, text, _) in found.items():
        said = "the paper" in text
        assert said is (study == "papers" and name in MARKED), (study, text)
        maps = any(style.SOURCES[m]["label"] in text for m in ("festo_musclesim", "martens2017"))
        assert maps is (study == "papers" and name in ("fig04", "fig06")), (study, text)


def test_axes_have_names_with_units(drawn):
    name, found = drawn
    if name == "fig03":
        return
    for _, figure, _, _ in found.values():
        for ax in figure.axes:
            for axis in (ax.xaxis, ax.yaxis):
                ticks = [t for t in axis.get_ticklabels() if t.get_visible() and t.get_text()]
                shared = axis is ax.yaxis and not ax.get_subplotspec().is_first_col()
                if ticks and not shared and axis.get_label().get_text():
                    text = axis.get_label().get_text()
                    assert "[" in text or "over" in text, text


def test_every_model_has_a_look_of_its_own():
    assert set(MODELS) <= set(style.SOURCES)
    assert set(MODELS) <= set(style.COMPARED)
    looks = [tuple(sorted((k, str(v)) for k, v in style.COMPARED[m].items())) for m in MODELS]
    assert len(set(looks)) == len(MODELS)


def test_a_source_without_a_look_is_drawn_by_its_name(small_scene):
    from matplotlib.figure import Figure

    from workflow.data.scene_data import CONTRACTION, FORCE, states

    table = states(small_scene(), ["force"]).assign(source="bench", **{SERIES: "only"})
    for draw in (curves.by_source, curves.by_series):
        ax = Figure().add_subplot()
        draw(ax, table, CONTRACTION, FORCE)
        assert "bench" in ax.lines[0].get_label()


def test_a_missing_case_is_named(small_scene):
    from matplotlib.figure import Figure

    from workflow.data.scene_data import CONTRACTION, FORCE, PRESSURE, states

    table = states(small_scene(), ["force"])
    table = table.assign(status="not_solved", **{FORCE: np.nan})
    figure = Figure(figsize=(7, 3))
    curves.by_source(figure.add_subplot(), table, CONTRACTION, FORCE)
    curves.note_gaps(figure, table, [PRESSURE], CONTRACTION, y=FORCE)
    assert "FE solid, 0.3 MPa: 5 states not solved" in words(figure)
    assert GOOD not in words(figure)


def test_curves_that_lie_on_each_other_are_named_and_both_seen(plans, tmp_path):
    planned = plans["papers"]
    for key in set(planned.scenes["fig10"].values()):
        case = planned.cases[key].case
        record.write(tmp_path / f"{key}.h5", case, solve(case))
    table = module("fig10").table(SceneData.read(planned, "fig10", tmp_path))
    figure = module("fig10").draw(table)
    assert "Eq. (1) for 40 mm, 60 threads and 40 mm, 100 threads" in words(figure)
    lines = {line.get_label(): line._unscaled_dash_pattern for line in figure.axes[0].lines}
    for source in ("_Eq. (1)", "_Eq. (1) at the layers"):
        offsets = {offset for label, (offset, _) in lines.items() if label.startswith(f"{source},")}
        assert len(offsets) == 2, source
