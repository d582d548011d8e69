"""C6 to C9, figures 9 to 13: braid angle, diameter, wall thickness, rubber."""

from functools import partial

import numpy as np

from workflow.analyses.claims.claim import (
    GEOMETRIC,
    MUSCLE,
    PRESSURE,
    STEPS,
    Array,
    Claims,
    Data,
    Finding,
    Verdict,
    graded,
    listed,
    values,
    within,
)
from workflow.analyses.claims.contraction import lacking
from workflow.data import paper

SMALL_ANGLE = "dmsp20_a17.1"
WIDE = {60: "dmsp20_d40", 120: "dmsp20_d40_n120"}  # by threads per layer
RATIO, SURGE = 4.0, paper.RATIO
WALLS = {1.5: "dmsp20_t1.5", 2.0: "dmsp20", 2.5: "dmsp20_t2.5", 3.0: "dmsp20_t3"}  # mm
SILICONE = {thickness: f"{name}_silicone" for thickness, name in WALLS.items()}
BEST = 2.0  # mm, where the paper's silicone muscle pulls most
CONTRACTION, LOAD = 0.1, 200.0
LINEAR = 0.05  # largest distance from the chord, as a share of the range, of a curve called linear
ERROR = 0.01  # share of the largest force by which the ratio's condition is judged
CLAIMS = Claims()


@CLAIMS.add("C6a", "fig09", "a larger braid angle gives less force", paper="less", unit="N")
def larger_angle_less_force(data: Data) -> Finding:
    """C6a."""
    less = _by_angle(data)
    why = f"24.8 instead of 17.1 degrees costs {listed(less)} N at 0 to 20 %"
    return graded(float(less.min()), list(less > 0), why)


@CLAIMS.add("C6b", "fig09", "its effect is greater at low contraction", paper="< 1")
def angle_matters_at_low_contraction(data: Data) -> Finding:
    """C6b."""
    return _fades(_by_angle(data), "the difference")


@CLAIMS.add("C6c", "fig09", "force is below Eq. (1), more so at high contraction", paper="below")
def both_below_equation(data: Data) -> Finding:
    """C6c: both angles against Eq. (1)."""
    muscles = (MUSCLE, SMALL_ANGLE)
    equation = np.array([data.forces(muscle, model=GEOMETRIC) for muscle in muscles])
    return lacking(equation, np.array([data.forces(muscle) for muscle in muscles]))


@CLAIMS.add("C6d", "fig09", "the curves of both angles meet near 20 %", paper="0")
def curves_meet(data: Data) -> Finding:
    """C6d: what is left at 20 % of the difference at no contraction."""
    less = _by_angle(data)
    left = float(less[-1] / less[0])
    why = (
        f"{less[-1]:.0f} N of {less[0]:.0f} N are left at 20 %, so the curves come together but "
        "do not meet"
    )
    if abs(left) <= 0.1:
        why = f"{less[-1]:.0f} N of {less[0]:.0f} N are left at 20 %"
    return within(left, abs(left), 0.1, 0.25, why)


@CLAIMS.add("C7a", "fig10", "the effect of diameter is greater at low contraction", paper="< 1")
def diameter_matters_at_low_contraction(data: Data) -> Finding:
    """C7a."""
    return _fades(data.forces(WIDE[60]) - data.forces(MUSCLE), "the difference")


@CLAIMS.add("C7b", "fig11", "F(40)/F(20) by Eq. (1)", paper=f"{RATIO:g}")
def ratio_of_equation(data: Data) -> Finding:
    """C7b: F(40) / F(20) by Eq. (1)."""
    ratio = data.forces(WIDE[60], model=GEOMETRIC) / data.forces(MUSCLE, model=GEOMETRIC)
    off = float(np.abs(ratio / RATIO - 1).max())
    return within(float(ratio.mean()), off, 0.01, 0.1, f"{listed(ratio, '.3f')} at 0 to 20 %")


def ratio_at_first(data: Data, threads: int) -> Finding:
    """C7c, C7d: F(40) / F(20) up to 15 %."""
    ratio = (data.forces(WIDE[threads]) / data.forces(MUSCLE))[:-1]
    why = f"{listed(ratio, '.2f')} at 0, 5, 10, 15 %: around 4 but rising all the way"
    return within(float(ratio.mean()), float(np.abs(ratio - RATIO).max()), 1.0, 2.0, why)


for _name, _threads in (("C7c", 60), ("C7d", 120)):
    CLAIMS.add(
        _name,
        "fig11",
        f"F(40)/F(20) up to 15 %, 40 mm with {_threads} threads a layer",
        paper=f"{RATIO:g}",
    )(partial(ratio_at_first, threads=_threads))


def ratio_at_last(data: Data, threads: int) -> Finding:
    """C7e, C7f: F(40) / F(20) at 20 %, and how well conditioned it is."""
    wide, narrow = data.forces(WIDE[threads]), data.forces(MUSCLE)
    ratio = wide[-1] / narrow[-1]
    error = ERROR * narrow[0] / narrow[-1]
    needed = wide[-1] / SURGE
    why = (
        f"{wide[-1]:.0f} N over {narrow[-1]:.1f} N, a small difference of large ones: "
        f"{100 * ERROR:.0f} % of the largest force changes it by {100 * error:.0f} %; 34.5 would "
        f"need {needed:.1f} N, {100 * abs(narrow[-1] - needed) / narrow[0]:.1f} % of the largest "
        "force away"
    )
    surges = ratio > 2 * wide[-2] / narrow[-2]
    verdict = Verdict.PARTLY if surges else Verdict.NOT_REPRODUCED
    if surges and max(ratio / SURGE, SURGE / ratio) <= 1.25:
        verdict = Verdict.REPRODUCED
    return Finding(float(ratio), verdict, why)


for _name, _threads in (("C7e", 60), ("C7f", 120)):
    CLAIMS.add(
        _name,
        "fig11",
        f"F(40)/F(20) at 20 %, 40 mm with {_threads} threads a layer",
        paper=f"{SURGE:g}",
    )(partial(ratio_at_last, threads=_threads))


@CLAIMS.add("C8a", "fig12", "NBR: force is linear in wall thickness", paper="linear")
def rubber_is_linear(data: Data) -> Finding:
    """C8a."""
    return _straight(_wall_forces(data, WALLS))


@CLAIMS.add("C8b", "fig12", "NBR: force falls with wall thickness", paper="falls", unit="N/mm")
def rubber_falls(data: Data) -> Finding:
    """C8b."""
    force = _wall_forces(data, WALLS)
    change = float((force[-1] - force[0]) / (list(WALLS)[-1] - next(iter(WALLS))))
    why = f"{listed(force)} N at 1.5, 2, 2.5, 3 mm"
    return graded(change, list(np.diff(force) < 0), why)


@CLAIMS.add("C8c", "fig12", "silicone gives more force than NBR", paper="more", unit="N")
def silicone_pulls_more(data: Data) -> Finding:
    """C8c."""
    more = _wall_forces(data, SILICONE) - _wall_forces(data, WALLS)
    return graded(float(more.min()), list(more > 0), f"by {listed(more)} N at 1.5, 2, 2.5, 3 mm")


@CLAIMS.add(
    "C8d",
    "fig12",
    "silicone: force rises up to a wall of 2 mm and falls beyond",
    paper=f"{BEST:g}",
    unit="mm",
)
def silicone_is_best_at_two(data: Data) -> Finding:
    """C8d: the thickness at which the silicone muscle pulls most, its threads single ones."""
    force = _wall_forces(data, SILICONE)
    why = f"{listed(force)} N at 1.5, 2, 2.5, 3 mm"
    if data.threads is not None:
        change = values(data.threads, list(SILICONE))
        force = force + change
        why += f"; single threads change that by {listed(change, '.2f')} N (cell)"
    best = list(SILICONE)[int(np.argmax(force))]
    if best == next(iter(SILICONE)):
        why += ": it only falls, as soft rubber resists less but never helps (docs/verdict.md)"
    return graded(best, [best == BEST], why)


@CLAIMS.add("C9a", "fig13", "contraction under 200 N is linear in wall thickness", paper="linear")
def contraction_is_linear(data: Data) -> Finding:
    """C9a."""
    both = [_straight(_wall_contractions(data, walls)) for walls in (WALLS, SILICONE)]
    worst = max(both, key=lambda found: found.value)
    parts = [found.verdict is Verdict.REPRODUCED for found in both]
    return graded(worst.value, parts, worst.why)


@CLAIMS.add("C9b", "fig13", "it is steeper for NBR", paper="> 1")
def rubber_is_steeper(data: Data) -> Finding:
    """C9b: slope of contraction by thickness, NBR over silicone."""
    nbr, soft = (np.ptp(_wall_contractions(data, walls)) / 1.5 for walls in (WALLS, SILICONE))
    why = f"{100 * nbr:.2f} against {100 * soft:.2f} % contraction per mm"
    return graded(float(nbr / soft), [nbr > soft], why)


@CLAIMS.add("C9c", "fig13", "silicone contracts more", paper="more")
def silicone_contracts_more(data: Data) -> Finding:
    """C9c."""
    more = _wall_contractions(data, SILICONE) - _wall_contractions(data, WALLS)
    why = f"by {listed(100 * more, '.1f')} % at 1.5, 2, 2.5, 3 mm"
    return graded(float(more.min()), list(more > 0), why)


def _by_angle(data: Data) -> Array:
    """Force that the larger braid angle costs, at STEPS [N]."""
    return data.forces(SMALL_ANGLE) - data.forces(MUSCLE)


def _fades(difference: Array, what: str) -> Finding:
    """Whether an effect is greater at low contraction; value: last over first."""
    why = f"{what} is {listed(difference)} N at {listed(100 * np.array(STEPS))} %"
    size = np.abs(difference)
    return graded(float(size[-1] / size[0]), [size[-1] < size[0], (np.diff(size) < 0).all()], why)


def _straight(numbers: Array) -> Finding:
    """Whether numbers at equal steps lie on a line; value: distance from it over their range."""
    steps = np.arange(len(numbers))
    line = np.polyval(np.polyfit(steps, numbers, 1), steps)
    off = float(np.abs(numbers - line).max() / np.ptp(numbers))
    why = f"the values leave their best line by {100 * off:.1f} % of their range at most"
    return within(off, off, LINEAR, 2 * LINEAR, why)


def _wall_forces(data: Data, walls: dict[float, str]) -> Array:
    """Forces at 10 % by thickness [N]."""
    at = (CONTRACTION,)
    return np.array([data.forces(name, PRESSURE, at)[0] for name in walls.values()])


def _wall_contractions(data: Data, walls: dict[float, str]) -> Array:
    """Contractions under 200 N by thickness."""
    curves = (data.curve("isotonic", "contraction", LOAD, name) for name in walls.values())
    return np.array([values(curve, PRESSURE)[0] for curve in curves])
