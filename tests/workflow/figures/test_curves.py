"""Failed states are not drawn as if they had not failed."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from solver.status import StateStatus
from workflow.data.scene_data import CONTRACTION, FORCE, PRESSURE, TOLERANCE, TOTAL_BY, states
from workflow.figures import curves, style
from workflow.figures.labels import SERIES, series


@pytest.fixture
def drawn(small_scene, fail):
    """The lines of a curve of 5 states of which some have a status: label -> finite x values."""

    def lines(status, *numbers):
        table = states(small_scene(lambda solution: fail(solution, status, *numbers)), ["force"])
        ax = Figure().add_subplot()
        curves.by_source(ax, table, CONTRACTION, FORCE)
        found = {}
        for line in ax.lines:
            x, y = np.array(line.get_xdata(), float), np.array(line.get_ydata(), float)
            found[line.get_label()] = x[np.isfinite(y)].tolist()
        return found

    return lines


def test_converged_states_are_one_line(drawn):
    assert drawn(StateStatus.CONVERGED) == {"FE solid": [0, 0.05, 0.1, 0.15, 0.2]}


@pytest.mark.parametrize("status", [StateStatus.NOT_REACHED, StateStatus.INVALID_STATE])
def test_a_gap_stays_a_gap(drawn, status):
    assert drawn(status, 2) == {"FE solid": [0, 0.05, 0.15, 0.2]}


def test_the_line_stops_at_the_gap(small_scene, fail):
    """Its y is NaN there, so that matplotlib joins nothing across."""
    spoiled = small_scene(lambda solution: fail(solution, StateStatus.INVALID_STATE, 2))
    ax = Figure().add_subplot()
    curves.by_source(ax, states(spoiled, ["force"]), CONTRACTION, FORCE)
    assert np.isnan(ax.lines[0].get_ydata()[2])


def test_unstable_states_are_open_circles(small_scene, fail):
    spoiled = small_scene(lambda solution: fail(solution, StateStatus.UNSTABLE, 3, 4))
    ax = Figure().add_subplot()
    curves.by_source(ax, states(spoiled, ["force"]), CONTRACTION, FORCE)
    line, circles = ax.lines
    assert np.isnan(line.get_ydata()[3:]).all()
    assert circles.get_label() == "unstable"
    assert circles.get_linestyle() == "None"
    assert circles.get_markerfacecolor() == "white"
    assert list(circles.get_xdata()) == [0.15, 0.2]


def test_a_state_between_gaps_is_a_dot(drawn):
    assert drawn(StateStatus.NOT_REACHED, 0, 1, 3)["_lonely"] == [0.1, 0.2]


def test_series_without_states_keep_the_look_of_the_others(small_scene, fail):
    scene = small_scene(models=("solid", "membrane"))
    table = states(scene, ["force"]).assign(**{SERIES: "only"})
    ax = Figure().add_subplot()
    curves.by_series(ax, table, CONTRACTION, FORCE)
    colours = {line.get_color() for line in ax.lines}
    assert len(ax.lines) == 2
    assert len(colours) == 1  # the colour tells series apart, the line models
    assert len({line.get_linewidth() for line in ax.lines}) == 2


def test_note_names_curve_status_and_place():
    table = pd.DataFrame(
        {
            "source": ["solid"] * 3 + ["membrane"],
            PRESSURE: [0.2, 0.2, 0.2, 0.3],
            CONTRACTION: [0.23, 0.24, 0.25, 0.25],
            "status": ["converged", "not_reached", "not_reached", "invalid_state"],
        }
    )
    figure = Figure(figsize=(7, 3))
    curves.note_gaps(figure, table, [PRESSURE], CONTRACTION)
    text = figure.texts[0].get_text().replace("\n", " ")
    assert "FE solid, 0.2 MPa: 2 states not reached from 24 % to 25 %" in text
    assert "FE membrane, 0.3 MPa: 1 invalid state at 25 %" in text
    assert figure.get_size_inches()[1] > 3


@pytest.mark.parametrize(("share", "said"), [(0.0015, False), (0.05, True)])
def test_a_band_is_spoken_of_where_it_is_wider_than_its_line(share, said, small_scene):
    table = states(small_scene(), ["force"])
    table = table.assign(**{"force_error [N]": share * table[FORCE].max()})
    figure = Figure(figsize=(7, 3))
    ax = figure.add_subplot()
    curves.by_source(ax, table, CONTRACTION, FORCE)
    curves.note_gaps(figure, table, [PRESSURE], CONTRACTION, y=FORCE)
    text = " ".join(text.get_text() for text in figure.texts)
    assert ("discretisation error" in text) is said
    assert len(ax.collections) == said


def test_no_line_of_a_note_parts_a_number_from_its_unit():
    for filled in range(30):
        figure = Figure(figsize=(2, 2))
        curves.note(figure, f"{'x' * filled} 6 % to 20 % and 0.25 MPa, 12 mm, 30 N; 7 states")
        (text,) = figure.texts
        lines = text.get_text().split("\n")
        assert len(lines) > 1
        assert not any(line.startswith(("%", "MPa", "mm", "N;")) for line in lines)
        assert "\N{NO-BREAK SPACE}" not in text.get_text()


def test_what_was_promised_of_curves_is_said_and_what_was_not(small_scene):
    table = states(small_scene(), ["force"])
    proved = table.assign(**{TOLERANCE: 0.02, TOTAL_BY: "estimated from 112 like muscles"})
    other = table.assign(**{PRESSURE: 0.1, TOLERANCE: 0.02, TOTAL_BY: "not proved; not known"})
    said = []
    for rows in (proved, pd.concat([proved, other])):
        figure = Figure(figsize=(7, 3))
        curves.note_gaps(figure, rows, [PRESSURE], CONTRACTION, y=FORCE)
        said.append(figure.texts[0].get_text().replace("\n", " "))
    assert said[0] == "Proved to be within 2 % of a refined solid."
    assert "Not proved to be within 2 % of a refined solid: FE solid, 0.1 MPa." in said[1]


def test_no_note_without_gaps(small_scene):
    figure = Figure(figsize=(7, 3))
    table = states(small_scene(), ["force"])
    curves.note_gaps(figure, table, [PRESSURE], CONTRACTION, y=FORCE)
    assert figure.texts == []
    assert figure.get_size_inches()[1] == 3


def test_states_that_failed_have_no_numbers_in_the_table(small_scene, fail):
    spoiled = small_scene(lambda solution: fail(solution, StateStatus.INVALID_STATE, 1))
    table = states(spoiled, ["force"])
    assert table[FORCE].isna().tolist() == [False, True, False, False, False]
    assert table["status"].tolist()[1] == "invalid_state"


def test_another_muscle_or_variant_is_another_line(small_scene):
    table = states(small_scene(), ["force"])
    other = table.assign(variant="paper")
    ax = Figure().add_subplot()
    curves.by_source(ax, pd.concat([table, other]), CONTRACTION, FORCE)
    assert [len(line.get_xdata()) for line in ax.lines] == [5, 5]
    labels = [line.get_label() for line in ax.lines]
    assert labels == ["FE solid, default", "FE solid, paper"]
    assert ax.lines[0].get_linestyle() != ax.lines[1].get_linestyle()


def test_muscles_that_a_name_would_mix_are_told_apart(small_scene):
    table = states(small_scene(), ["force"])
    both = pd.concat([table, table.assign(muscle="longer")], ignore_index=True)
    assert set(series(both, [PRESSURE])) == {"0.3 MPa, dmsp20", "0.3 MPa, longer"}
    assert set(series(both, [PRESSURE], apart=False)) == {"0.3 MPa"}
    variants = pd.concat([table, table.assign(variant="paper")], ignore_index=True)
    assert set(series(variants, [PRESSURE])) == {"default", "paper"}


@pytest.mark.parametrize("columns", [1, 2, 3])
def test_a_long_title_stays_beside_the_next(columns):
    figure, axes = style.panels(style.FULL, 3, 1, columns)
    for ax in axes[0]:
        ax.set_title("gripper_finger_of_the_left_hand_number_twenty_two, variant, 0.35 MPa")
    style.fit_titles(figure)
    ends = [ax._left_title.get_window_extent() for ax in axes[0]]
    for near, far in pairwise(ends):
        assert near.x1 < far.x0
    assert ends[-1].x1 < figure.bbox.x1
    short = axes[0, 0].set_title("0.3 MPa")
    short.set_fontsize(8.5)
    style.fit_titles(figure)
    assert short.get_fontsize() == 8.5


def test_curves_that_lie_on_each_other_are_found():
    """At the same places only, to a share of their size, whatever others there are."""
    at = [0.0, 0.1, 0.2]
    line = pd.Series([10.0, 5.0, 1.0], at)
    found = curves._alike(
        {
            "one": line,
            "shorter": line[:2],
            "same": line * (1 + curves.SAME / 2),
            "other": line + 1,
            "elsewhere": pd.Series(line.to_numpy(), [0.0, 0.1, 0.3]),
            "gap": line.where(line != 5.0),
        }
    )
    assert list(found) == [("one", "same")]
