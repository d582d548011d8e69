"""What does leaving out an effect change, and save? One effect off at a time, in five regimes.

Each effect is compared within the fullest model that can be had with and without it: what only the
solid has, in the solid; what the membrane adds to the cylinder, between these two; single threads
in the cell, against its smeared layers. The regimes are the normal condition and four corners; each
is followed at constant pressure, contraction and load; the cell, which takes minutes for a curve,
at constant pressure only.
"""

from dataclasses import dataclass, field, replace

from solver.case import Case
from solver.effects import Effects, Layers, Rubber, Stretch, ThreadLaw, Twist, Volume, Wall
from solver.load_path import LoadPath, PathKind
from solver.material import Thread
from solver.numerics import Numerics
from workflow.analyses.analysis import AnalysisCase
from workflow.plan.effect_costs import MESHES
from workflow.study.contents import Study

MUSCLE, THICK_SILICONE = "dmsp20", "dmsp20_t3_silicone"  # of the study file
STIFF = 20e3  # N, EA


@dataclass(frozen=True, kw_only=True)
class Regime:
    """A kind of muscle and load: what is held on the three paths, and how far they go."""

    muscle: str = MUSCLE
    stiffness: float | None = None  # EA [N], if not the muscle's
    pressure: float = 0.3  # MPa, of the isobaric path
    contraction: float = 0.1  # of the isometric path
    load: float = 200.0  # N, of the isotonic path
    furthest: float = 0.15  # contraction, of the isobaric path
    highest: float = 0.4  # MPa, of the other two

    def paths(self) -> list[LoadPath]:
        """The curves of this regime."""
        contractions = tuple(round(self.furthest * k / 6, 6) for k in range(7))
        pressures = tuple(round(self.highest * k / 8, 6) for k in range(1, 9))
        return [
            LoadPath(kind=PathKind.ISOBARIC, held=self.pressure, stops=contractions),
            LoadPath(
                kind=PathKind.ISOMETRIC, held=self.contraction, stops=pressures, zero_force=True
            ),
            LoadPath(kind=PathKind.ISOTONIC, held=self.load, stops=pressures),
        ]


REGIMES = {
    "normal": Regime(),
    "low pressure": Regime(pressure=0.1, highest=0.16, load=50.0),
    "high contraction": Regime(furthest=0.24, pressure=0.2, contraction=0.2, load=50.0),
    "thick silicone": Regime(muscle=THICK_SILICONE),
    "stiff threads": Regime(stiffness=STIFF),
}


@dataclass(frozen=True, kw_only=True)
class Setup:
    """A model with its effects and mesh."""

    model: str
    effects: Effects = field(default_factory=Effects)
    mesh: str = "default"


SETUPS = {
    "solid, finer": Setup(model="solid", mesh="finer"),
    "solid": Setup(model="solid"),
    "solid, coarser": Setup(model="solid", mesh="coarser"),
    "solid, incompressible": Setup(model="solid", effects=Effects(volume=Volume.INCOMPRESSIBLE)),
    "solid, two-way": Setup(model="solid", effects=Effects(threads=ThreadLaw.TWO_WAY)),
    "membrane, finer": Setup(model="membrane", mesh="finer"),
    "membrane": Setup(model="membrane"),
    "membrane, one radius": Setup(model="membrane", effects=Effects(wall=Wall.ONE_RADIUS)),
    "cylinder": Setup(model="cylinder"),
    "cylinder, twisting": Setup(model="cylinder", effects=Effects(twist=Twist.FREE)),
    "cylinder, rigid": Setup(model="cylinder", effects=Effects(stretch=Stretch.RIGID)),
    "cylinder, no rubber": Setup(model="cylinder", effects=Effects(rubber=Rubber.NONE)),
    "geometric": Setup(model="geometric"),
    "cell": Setup(model="cell"),
    "cell, smeared": Setup(model="cell", effects=Effects(layers=Layers.SMEARED)),
}


def cases(study: Study) -> list[AnalysisCase]:
    """Every setup along every path of every regime."""
    return [
        AnalysisCase(
            _case(study, regime, setup, path),
            f"{name}, {setup_name}, {path.kind}",
            {"regime": name, "path": path.kind.value, "setup": setup_name},
        )
        for name, regime in REGIMES.items()
        for path in regime.paths()
        for setup_name, setup in SETUPS.items()
        if setup.model != "cell"
        or path.kind is PathKind.ISOBARIC  # the cell takes minutes for a curve
    ]


def _case(study: Study, regime: Regime, setup: Setup, path: LoadPath) -> Case:
    muscle = study.muscles[regime.muscle]
    numerics = replace(Numerics(), **MESHES[setup.mesh])
    if (
        regime.stiffness and muscle.thread
    ):  # of a stiffer fibre, not thicker: thick threads would not fit between the layers
        stiffer = numerics.spread.modulus * regime.stiffness / muscle.thread.stiffness
        numerics = replace(numerics, spread=replace(numerics.spread, modulus=stiffer))
    if setup.model == "geometric" and path.zero_force:
        path = LoadPath(kind=path.kind, held=path.held, stops=path.stops)  # Eq. (1) has none
    if (
        regime.stiffness and setup.model == "cell"
    ):  # beyond, one layer goes slack and the cell needs very small steps
        path = replace(path, stops=path.stops[:3])
    if regime.stiffness:
        muscle = replace(muscle, thread=Thread(stiffness=regime.stiffness))
    return muscle.case(path, setup.model, effects=setup.effects, numerics=numerics)
