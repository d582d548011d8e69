"""Every figure of every analysis, from tables with changes of sign, gaps and outliers.

What has a value is within its axes; what has none is named in words; a series has its label.
"""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection

from workflow.analyses import analysis
from workflow.analyses.registry import ANALYSES
from workflow.analyses.sensitivity import table as sensitivity
from workflow.figures import style
from workflow.study.study import load

from .solutions import made_up

STUDY = str(Path(__file__).parents[3] / "config/config.yaml")
DRAWN = [name for name, each in ANALYSES.items() if each.figures]


def robustness(table):
    """Mesh 1 of one case has no state, another none in common, some are turned inside out."""
    named = table["set"] == "named"
    lost = named & (table["name"] == "p 0.3 MPa") & (table["mesh"] == 1)
    table.loc[lost, ["smallest det F", "smallest det F at nodes", "difference"]] = np.nan
    table.loc[lost, "status"] = "stalled"
    apart = named & (table["name"] == "EA 20 N") & (table["mesh"] == 2)
    table.loc[apart, "difference"] = np.nan
    table.loc[named & (table["name"] == "D 10 mm"), "smallest det F"] = -3.0
    cube = table.index[table["set"] == "hypercube"]
    table.loc[cube[:40:3], "smallest det F"] = -7.0
    table.loc[cube[1:40:3], ["smallest det F", "iterations per state"]] = np.nan
    table.loc[cube[2:40:3], "iterations per state"] = 400
    table.loc[cube[:7], "status"] = [
        *("converged", "limit_point", "invalid_state", "stalled", "timeout", "solver_error"),
        "no_such",
    ]
    solid = (table["set"] == "hypercube") & (table["model"] == "solid") & (table["mesh"] == 1)
    return [
        "p 0.3 MPa mesh 1",
        "EA 20 N mesh 2",
        "muscles of the hypercube",
        "at the ends: and beyond",
        *(f"{status}: " for status in table.loc[solid, "status"].unique()),
    ]


def accuracy(table):
    """One mesh of each model has no error, one an error beyond all, one diverges."""
    mesh = table["set"] == "mesh"
    known = ["total_error [1]", "force_error [1]", "festo_musclesim_relative [1]"]
    for model in ("membrane", "solid"):
        table.loc[mesh & (table["model"] == model) & (table["mesh"] == "1/1"), known] = np.nan
    table.loc[mesh & (table["mesh"] == "1/6"), "total_error [1]"] = 1e-9
    table.loc[mesh & (table["mesh"] == "coarsest"), "total_error [1]"] = 40.0
    table.loc[table["set"] == "butt", "force_order [1]"] = np.nan
    rows = table.index[(table["set"] == "tolerance") & (table["model"] == "solid")]
    table.loc[rows[0], "force_error [1]"] = 7.0
    table.loc[rows[1], "iterations [1]"] = 900
    table.loc[rows[2], "force_error [1]"] = np.nan
    value = table.loc[rows[2], "tolerance"]
    return ["membrane 1/1", "solid 1/1", "no order", f"solid tolerance {value}", "cell", "cylinder"]


def effects(table):
    """No force in one regime, no change in another, states lost."""
    table.loc[(table["effect"] == "twist") & (table["regime"] == "normal"), "force"] = np.nan
    table.loc[table["effect"] == "rubber", "force"] = 0.0
    table.loc[table["effect"] == "end_caps", "missing"] = 3
    return ["twist (normal)", *table["regime"].unique()]


def threads(table):
    """A curve without any force, one with a gap, tensions far apart, a change of sign."""
    correction = table["set"] == "correction"
    discrete = correction & (table["layers"] == "discrete") & (table["wall [mm]"] == 2)
    drawn = ["force [N]", "change [N]"]
    of = discrete & (table["rubber"] == "NBR")
    table.loc[of & (table["pressure [MPa]"] == 0.3), drawn] = np.nan
    gap = of & (table["pressure [MPa]"] == 0.4) & (table["contraction [1]"] == 0.1)
    table.loc[gap, drawn] = np.nan
    table.loc[of & (table["pressure [MPa]"] == 0.2), "change [N]"] *= -30
    alone = discrete & (table["rubber"] == "silicone") & (table["pressure [MPa]"] == 0.2)
    table.loc[alone, "change [N]"] = np.nan
    table.loc[(table["set"] == "mesh") & (table["layers"] == "wire"), "force [N]"] = np.nan
    return [
        "correction NBR discrete 0.3 MPa wall 2.0 mm",
        "correction NBR discrete 0.4 MPa wall 2.0 mm (1 of 5)",
        "change of silicone discrete 0.2 MPa",
        "mesh NBR wire",
        "NBR, 0.2 MPa",
        "silicone, 0.4 MPa",
        "No picture of: NBR, silicone",
    ]


def of_sensitivity(table):
    """Differences and shares that are not known, negative ones, one far beyond 1."""
    local = table["analysis"] == "local"
    lead = local & (table["model"] == "solid") & (table["input"] == "lead")
    table.loc[lead & (table["output"] == "force"), "percent per percent"] = np.nan
    pressure = ~local & (table["input"] == "pressure") & (table["output"] == "free_contraction")
    table.loc[pressure, ["first", "total"]] = np.nan
    table.loc[~local & (table["input"] == "c10"), "first"] = -0.2
    table.loc[local & (table["input"] == "c01"), "percent per percent"] = -40.0
    return ["solid lead on force", "factors of Table 1 pressure on free contraction", "FE solid"]


def calibration(table):
    """Pressures beyond the map, a model without states, forces of both signs."""
    last = table["pressure"] == 0.6
    table.loc[last & (table["calibration"] == "two"), "reference"] = np.nan
    lost = last & (table["model"] == "solid") & (table["calibration"] == "one")
    table.loc[lost, "force"] = np.nan
    gap = (table["values"] == "before") & (table["contraction"] == 0.1)
    table.loc[gap & (table["pressure"] == 0.2) & (table["calibration"] == "two"), "force"] = np.nan
    return [
        "one after by solid at 0.6 MPa",
        "Not measured: two at 0.6 MPa",
        "two before by membrane at 0.2 MPa (1 of 5 states)",
        "after, by the solid",
        "one measured at 0.2 MPa (1 of 5 points)",
        "not fitted",
    ]


def time(table):
    """A loop without a width, one of another sign."""
    of_pressure = table["set"] == "pressure"
    table.loc[of_pressure & (table["label"] == "0.5 MPa"), "width"] = np.nan
    table.loc[of_pressure & (table["label"] == "0.1 MPa"), "width"] = -40.0
    return [
        "pressure 0.5 MPa",
        "1 %/s",
        "sleeve, contacts 0.2 mm (guess)",
        "measured, another muscle",
        "three elements",
        "0.01 Hz",
        "with memory",
        "No picture of: membrane, solid",
    ]


SPOIL = {
    "time": time,
    "robustness": robustness,
    "accuracy": accuracy,
    "effects": effects,
    "threads": threads,
    "sensitivity": of_sensitivity,
    "calibration": calibration,
}


def states_of_calibrations():
    """As of two calibrations, one of them with fewer pressures."""
    rows = [
        {"calibration": name, "fitted_by": "membrane", "values": values, "model": model}
        | {"pressure": pressure, "contraction": eps, "reference": 2000 * pressure * (1 - 6 * eps)}
        | {"force": off * 2000 * pressure * (1 - 6 * eps), "role": "fit"}
        for name, pressures in (("one", (0.2, 0.3, 0.4, 0.6)), ("two", (0.2, 0.6)))
        for values, model, off in (
            ("before", "membrane", 0.9),
            ("after", "membrane", 1.0),
            ("after", "solid", 0.99),
        )
        for pressure in pressures
        for eps in (0.0, 0.05, 0.1, 0.15, 0.2)
    ]
    return pd.DataFrame(rows)


def residuals_of_calibrations():
    """Of the same; one point has no state, one is far off."""
    rows = [
        {"calibration": name, "held": "isobaric", "set_at": p, "pressure": p, "contraction": eps}
        | {"fitted": int(p < 0.6), "residual": (-1) ** k * 100 * p * eps}
        for name in ("one", "two")
        for p in (0.2, 0.6)
        for k, eps in enumerate((-0.03, 0.0, 0.05, 0.1, 0.2))
    ]
    rows[0]["residual"], rows[7]["residual"] = np.nan, 1e4
    return pd.DataFrame(rows)


@pytest.fixture(scope="module", params=sorted(SPOIL))
def drawn(request, tmp_path_factory):
    """Name, what its words must have, and its figures, of a spoilt table."""
    name = request.param
    folder = tmp_path_factory.mktemp("analysis")
    with pytest.MonkeyPatch.context() as patch:  # undone also where what follows fails
        patch.chdir(folder)
        patch.setattr(sensitivity, "SAMPLES", 4)
        each, study, solved = ANALYSES[name], load(STUDY), []
        if each.solves_cases:
            solved = [made_up(asked) for asked in analysis.cases(name, STUDY)]
            tables = each.tabulated(study, solved)
        else:
            tables = {
                "calibration_states": states_of_calibrations(),
                "calibration_residuals": residuals_of_calibrations(),
            }
        main = next(iter(tables)) if name != "calibration" else "calibration_states"
        wanted = SPOIL[name](tables[main])
        write_costs(name, solved)
        figures = each.drawn(solved, tables)
        for stem, figure in figures.items():
            style.save(figure, folder / f"{stem}.png")
        yield name, wanted, figures, folder


def write_costs(name, solved):
    """What accuracy has cost, but for the cell; beside the results, as of a run."""
    folder = Path("results/cost")
    folder.mkdir(parents=True, exist_ok=True)
    for each in solved if name == "accuracy" else ():
        case = each.asked.case
        if case.model == "cell":
            continue
        cost = {"python_cpu_seconds": 0.2, "solve_cpu_seconds": 0.1}
        if each.asked.mesh:
            size = each.solution.unknowns / 1000 * len(case.path.stops)
            cost |= {"freefem_cpu_seconds": 0.3 + 0.1 * size, "freefem_start_seconds": 0.1}
            cost |= {"freefem_unknowns": each.solution.unknowns, "freefem_peak_memory": 60 + size}
            cost |= {f"freefem_{part}_seconds": 0.1 * size for part in ("assembly", "factor")}
        (folder / f"{case.key}.json").write_text(json.dumps(cost))


def words(figure):
    """All that is written on a figure, in one line."""
    texts = [*figure.texts]
    legends = [*figure.legends, *(ax.get_legend() for ax in figure.axes)]
    for ax in figure.axes:
        texts += [*ax.texts, ax.title, ax._left_title, ax.xaxis.label, ax.yaxis.label]
        texts += ax.get_yticklabels() + ax.get_xticklabels()
    for legend in filter(None, legends):
        texts += legend.get_texts()
    return " ".join(text.get_text() for text in texts).replace("\n", " ")


def test_every_analysis_with_figures_is_looked_at():
    assert set(DRAWN) == set(SPOIL) | {"promise"}  # whose rungs are looked at by test_promise.py


def test_what_has_no_value_is_named_and_series_have_labels(drawn):
    _, wanted, figures, _ = drawn
    text = " ".join(words(figure) for figure in figures.values())
    assert [name for name in wanted if name not in text] == []


def test_what_has_a_value_is_within_its_axes(drawn):
    _, _, figures, _ = drawn
    for stem, figure in figures.items():
        if stem == "robustness_worst":
            continue  # walls near the cap, as it says
        for ax in figure.axes:
            limits = [sorted(ax.get_xlim()), sorted(ax.get_ylim())]
            for line in ax.lines:
                if line.get_transform() != ax.transData:
                    continue
                points = np.asarray(line.get_xydata(), float)
                points = points[np.isfinite(points).all(axis=1)]
                for (low, high), values in zip(limits, points.T, strict=True):
                    room = 1e-9 * (high - low)
                    assert (values >= low - room).all(), (ax.get_title("left"), line.get_label())
                    assert (values <= high + room).all(), (ax.get_title("left"), line.get_label())


def test_bars_have_ends(drawn):
    _, _, figures, _ = drawn
    for figure in figures.values():
        for ax in figure.axes:
            low, high = sorted(ax.get_xlim())
            for bar in ax.patches:
                ends = [bar.get_x(), bar.get_x() + bar.get_width()]
                if np.isfinite(ends).all():
                    assert low <= min(ends) + 1e-9
                    assert max(ends) <= high + 1e-9


def test_bands_hug_their_lines(drawn):
    """None of these figures has a band; one that gets some is compared with its line here."""
    _, _, figures, _ = drawn
    bands = [
        band
        for figure in figures.values()
        for ax in figure.axes
        for band in ax.collections
        if isinstance(band, PolyCollection) and hasattr(band, "around")
    ]
    for band in bands:
        heights = np.concatenate([path.vertices[:, 1] for path in band.get_paths()])
        line = np.asarray(band.around.get_ydata(), float)
        assert np.nanmin(line) - 0.05 * np.ptp(line) <= heights.min()
        assert heights.max() <= np.nanmax(line) + 0.05 * np.ptp(line)


def test_nothing_is_beside_the_picture(drawn):
    """Words of a figure end within it."""
    name, _, figures, _ = drawn
    for stem, figure in figures.items():
        renderer = FigureCanvasAgg(figure).get_renderer()
        width, height = figure.get_size_inches() * figure.dpi
        texts = [*figure.texts, *(ax.xaxis.label for ax in figure.axes if ax.axison)]
        texts += [ax._left_title for ax in figure.axes]
        for text in filter(lambda one: one.get_text(), texts):
            box = text.get_window_extent(renderer)
            beside = min(box.x0, box.y0, width - box.x1, height - box.y1)
            assert beside >= -1, (name, stem, text.get_text())
