"""The comparison with measured muscles, by a cheap model and of one muscle."""

import numpy as np
import pandas as pd
import pytest

from workflow.analyses import analysis
from workflow.analyses.validate import table as validate
from workflow.data import reference
from workflow.study.study import load_library

MUSCLE, MAPS = "dmsp_20_300", ("festo_musclesim", "martens2017")
WIDE = "dmsp_40"


@pytest.fixture(scope="module")
def tables():
    """Of one muscle and a wider one, at two pressures, by the cylinder."""
    patch = pytest.MonkeyPatch()
    made = load_library()
    both = {name: made.muscles[name] for name in (MUSCLE, WIDE)}
    one = type(made)(**{**vars(made), "muscles": both})
    patch.setattr(validate, "load_library", lambda: one)
    patch.setattr(validate, "MODEL", "cylinder")
    patch.setattr(validate, "PRESSURES", (0.3, 0.4))
    patch.setattr(validate, "CONTRACTIONS", (0.0, 0.05, 0.1, 0.15))
    yield validate.tables(one, [])
    patch.undo()


def test_what_it_writes(tables):
    assert tables.keys() == analysis.named("validate").tables.keys()


def test_every_prediction_is_there_once(tables):
    rows = tables["validate"]
    keys = ["muscle", "reference", "fitted to", "pressure [MPa]"]
    assert not rows.duplicated(keys).any()
    assert len(rows[rows["muscle"] == MUSCLE]) == 2 * 3 * 2  # maps, bases, pressures
    # nothing, its own, and two as they are and by construction
    assert len(rows[rows["muscle"] == WIDE]) == 1 * 6 * 2


def test_errors_are_those_of_the_map(tables):
    """Of the uncalibrated muscle, computed here once more."""
    rows = tables["validate"].set_index(["reference", "fitted to", "pressure [MPa]"])
    row = rows.loc[("festo_musclesim", "nothing", 0.4)]
    found = reference.load(["festo_musclesim"])["festo_musclesim"]
    made = load_library().muscles[MUSCLE]
    from solver.load_path import LoadPath
    from solver.models.cylinder.curve import solve

    path = LoadPath(kind="isobaric", held=0.4, stops=(0.0, 0.05, 0.1, 0.15))
    force = solve(made.case(path, "cylinder")).states["force"]
    off = 100 * (force - found.force(path.stops, 0.4)) / reference.largest_force(found, 0.4)
    assert row["mean error [%]"] == pytest.approx(np.mean(off), rel=1e-6)
    assert row["largest |error| [%]"] == pytest.approx(np.max(np.abs(off)), rel=1e-6)


def test_a_fit_is_better_where_it_was_fitted(tables):
    rows = tables["validate"].set_index(["reference", "fitted to", "pressure [MPa]"])
    for name in MAPS:
        own = rows.loc[(name, f"{name} of {MUSCLE}", 0.3), "mean |error| [%]"]
        assert own < rows.loc[(name, "nothing", 0.3), "mean |error| [%]"]


def test_every_row_says_what_it_never_saw(tables):
    said = tables["validate"].set_index(["reference", "fitted to", "pressure [MPa]"])["never saw"]
    assert (said.str.len() > 3).all()
    own = f"festo_musclesim of {MUSCLE}"
    assert said["festo_musclesim", "nothing", 0.3] == "any measured force"
    assert "the fit itself" in said["festo_musclesim", own, 0.3]
    assert "any pressure but 0.3 MPa" in said["festo_musclesim", own, 0.4]
    assert "another source" in said["martens2017", own, 0.4]
    other = validate.never_saw((MUSCLE, MAPS[0]), ("dmsp_40", "festo_musclesim_dmsp40"), 0.4)
    assert "any force of dmsp_40" in other


def test_stiffness_by_construction(tables):
    """Threads as close as those of the 20 mm muscle: as thick as the circumference allows."""
    rows = tables["validate"].set_index(["muscle", "fitted to", "pressure [MPa]"])
    basis = f"festo_musclesim of {MUSCLE}"
    plain = rows.loc[(WIDE, basis, 0.4), "EA [N]"]
    built = rows.loc[(WIDE, f"{basis}, EA by construction", 0.4), "EA [N]"]
    assert built / plain == pytest.approx((41.2 / 21.2) ** 2, rel=1e-5)
    fits = tables["validate_fits"].set_index("muscle")
    column = "largest |error|, EA by construction [%]"
    assert np.isfinite(fits.loc[WIDE, column])
    assert fits.loc[MUSCLE, column].isna().all()
    assert rows.loc[(WIDE, f"{basis}, EA by construction", 0.4), "never saw"].endswith(WIDE)


def test_spread_stands_beside(tables):
    """It is the distance of two maps, and none where there is one."""
    rows = tables["validate"]
    assert rows.loc[rows["muscle"] == MUSCLE, "largest spread [%]"].between(5, 25).all()
    assert rows.loc[rows["muscle"] == WIDE, "largest spread [%]"].isna().all()
    alone = validate._spread(reference.load(), ["sarosi2012"], "sarosi2012", 0.3)
    assert alone.size == 0


def test_fits_have_intervals(tables):
    fits = tables["validate_fits"]
    assert (fits["EA low 95 % [N]"] < fits["EA [N]"]).all()
    assert (fits["C10 [MPa]"] < fits["C10 high 95 % [MPa]"]).all()
    assert isinstance(fits, pd.DataFrame)
