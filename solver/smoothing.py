"""The force that the smoothing of the slack law adds, and what is said where it is much.

Threads slacken over a width of strain instead of at a kink (solver/numerics.py, Slack). What that
adds to the force of a state is recorded (solver/path/smoothing.idp; the cylinder does it itself).
Here it is judged, as a share of what the curve bears.
"""

import math
from dataclasses import replace

import numpy as np

from geometry.readable import plain
from solver.case import Case
from solver.record import Solution
from solver.status import Flag

MOST = 0.01  # share of the force above which a state is marked
MARGIN = 0.8  # of the width that is named: what smoothing adds is not quite in proportion to it


def scale(case: Case, solution: Solution) -> float:
    """The larger of the curve's largest |F| and of mu0 / 2 times the wall's area [N]."""
    muscle = case.muscle
    area = math.pi * (muscle.outer_radius**2 - muscle.inner_radius**2)
    force = np.abs(solution.states["force"])
    return max(float(np.nanmax(force, initial=0.0)), case.rubber.load_scale * area)


def marked(case: Case, solution: Solution) -> Solution:
    """The solution with the flag and a note at every state that smoothing changes by too much."""
    added, rate = solution.states["smoothing"], solution.states["smoothing_rate"]
    size = scale(case, solution)
    flags, notes = list(solution.flags), list(solution.notes)
    for k in np.flatnonzero(np.abs(added) > MOST * size):
        assert case.thread is not None  # else nothing slackens
        slack = case.numerics.slack
        per_width = max(abs(added[k]) / slack.width_of(case.thread), abs(rate[k]))
        narrower = MARGIN * MOST * size / per_width * slack.width / slack.width_of(case.thread)
        said = (
            f"the smoothing of slack threads adds {plain(added[k], 2)} N, "
            f"{plain(100 * abs(added[k]) / size, 2)} % of what the curve bears; "
            f"a slack.width of {_rounded_down(narrower):g} brings that below {100 * MOST:g} %"
        )
        flags[k] = flags[k] | {Flag.SMOOTHED}
        notes[k] = f"{notes[k]}; {said}" if notes[k] else said
    return replace(solution, flags=flags, notes=notes)


def _rounded_down(value: float) -> float:
    """To one digit."""
    digit = 10.0 ** math.floor(math.log10(value))
    return float(f"{math.floor(value / digit)}e{round(math.log10(digit))}")
