"""What accuracy costs: errors of all models on many meshes, with many steps and tolerances.

The normal condition: the curve at 0.3 MPa, 0 to 20 %, and the threshold pressure at 10 %. Three
errors that are kept apart, all as shares of the curve's largest force:

- discretisation: against what the same model converges to on ever finer meshes;
- modelling: against what the fullest model converges to (``solid``);
- deviation from each reference map, which no mesh and no model removes.

Every curve of the scenes is solved on a mesh twice as fine too: its own discretisation error; that
of the solid also from the planner's coarser and finer meshes.
Where the solution is smooth (a bare tube whose ends slide) the order is that of theory; the ends
of the muscle spoil it. Elements are quadratic only. Costs are measured by benchmark.py beside
this.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from geometry.mesh_settings import MeridianMesh, SectionMesh
from geometry.muscle import Muscle
from solver.case import Case
from solver.effects import Effects, End, ThreadLaw
from solver.load_path import LoadPath, PathKind
from solver.numerics import Newton, Numerics
from workflow.analyses.accuracy.settings import (
    BUTT_FAMILY,
    BUTT_LARGEST,
    CELLS,
    COARSE,
    CONTRACTION,
    FAMILY,
    LARGEST,
    MUSCLE,
    PRESSURE,
    STEP,
    STEPS,
    TOLERANCES,
    TUBE_FAMILY,
)
from workflow.analyses.analysis import AnalysisCase
from workflow.plan.effect_costs import MESHES
from workflow.plan.mesh_error import PART
from workflow.plan.plan import plan
from workflow.study.contents import Study
from workflow.study.schema import is_path


@dataclass(frozen=True)
class _Setting:
    """One row of the table: a model with its numerics."""

    set: str
    model: str
    name: str  # of the mesh
    numerics: Numerics = field(default_factory=Numerics)
    effects: Effects = field(default_factory=Effects)
    refinement: float = 0  # of the family that an order is observed on; 0: of no family
    stops: tuple[float, ...] = ()

    def tags(self, quantity: str) -> dict[str, str | float]:
        """What its row says of it."""
        return {
            "set": self.set,
            "model": self.model,
            "end": str(self.effects.end) if self.model == "solid" else "",
            "mesh": self.name,
            "refinement": self.refinement,
            "tolerance": self.numerics.newton.tolerance,
            "quantity": quantity,
        }


def cases(study: Study) -> list[AnalysisCase]:
    """The curve of every setting, the threshold pressure on every mesh, scenes on finer meshes."""
    return [*_normal(study), *_tube(study), *_scenes(study)]


def stops(step: float = STEP, largest: float = LARGEST) -> tuple[float, ...]:
    """Contractions from 0 to the largest, in exact decimals."""
    return tuple(round(step * k, 4) for k in range(round(largest / step) + 1))


def settings() -> Iterator[_Setting]:
    """All that the normal condition is solved with."""
    yield _Setting("mesh", "geometric", "", stops=stops())
    yield _Setting("mesh", "cylinder", "", stops=stops())
    for model, part in PART.items():
        for name, mesh in COARSE[model].items():
            coarse = _with_mesh(Numerics(), part, mesh)
            yield _Setting("mesh", model, name, coarse, stops=stops())
        for m in FAMILY:
            yield _Setting("mesh", model, f"1/{m}", _refined(part, m), refinement=m, stops=stops())
        for step in STEPS:
            yield _Setting("steps", model, "1/1", stops=stops(step))
        for tolerance in TOLERANCES:
            numerics = Numerics(newton=Newton(tolerance=tolerance))
            yield _Setting("tolerance", model, "1/1", numerics, stops=stops())
    for name, cell in CELLS.items():
        yield _Setting("mesh", "cell", name, Numerics(cell=cell), stops=stops())
    butt = Effects(end=End.BUTT, threads=ThreadLaw.TWO_WAY)
    for m in BUTT_FAMILY:
        numerics, few = _refined("section", m), stops(0.05, BUTT_LARGEST)
        yield _Setting("butt", "solid", f"1/{m}", numerics, butt, refinement=m, stops=few)


def _refined(part: str, refinement: int) -> Numerics:
    """The default mesh of a model, every element cut into so many each way."""
    default = getattr(Numerics(), part)
    return Numerics(**{part: replace(default, refinement=refinement)})


def _normal(study: Study) -> Iterator[AnalysisCase]:
    """The normal condition with every setting."""
    ours = study.muscles[MUSCLE]
    threshold = LoadPath(
        kind=PathKind.ISOMETRIC, held=CONTRACTION, stops=(PRESSURE,), zero_force=True
    )
    for setting in settings():
        path = LoadPath(kind=PathKind.ISOBARIC, held=PRESSURE, stops=setting.stops)
        numerics, effects = setting.numerics, setting.effects
        curve = ours.case(path, setting.model, effects=effects, numerics=numerics)
        label = f"{setting.model} {setting.name}".strip()
        maps = " ".join(name for name in ours.reference if not is_path(name))
        tags = setting.tags("curve") | {"maps": maps}
        yield AnalysisCase(curve, f"{label}, {setting.set}", tags)
        if setting.set == "mesh" and setting.model not in ("geometric", "cell"):
            case = replace(curve, path=threshold)
            yield AnalysisCase(case, f"{label}, threshold", setting.tags("threshold"))


def _tube(study: Study) -> Iterator[AnalysisCase]:
    """A bare tube at a stretch of 0.8 and 0.05 MPa: a smooth solution, known exactly."""
    nbr = study.muscles[MUSCLE].rubber
    tube = Muscle(inner_diameter=20, wall_thickness=2, length=4, braid=None)
    for m in TUBE_FAMILY:
        even = SectionMesh(cap_step=0.5, body_step=0.05, growth=1, refinement=m)
        numerics = Numerics(section=even, newton=Newton(tolerance=1e-11))
        effects = Effects(end=End.SLIDING)
        setting = _Setting("tube", "solid", f"1/{m}", numerics, effects, refinement=m)
        case = Case(
            muscle=tube,
            rubber=replace(nbr, kappa=1e6 * nbr.shear_modulus),
            thread=None,
            path=LoadPath(kind=PathKind.ISOMETRIC, held=0.2, stops=(0.05,)),
            model="solid",
            effects=effects,
            numerics=numerics,
        )
        yield AnalysisCase(case, f"bare tube 1/{m}", setting.tags("curve"))


def _scenes(study: Study) -> Iterator[AnalysisCase]:
    """Every meshed curve of the scenes on its own mesh and on one twice as fine."""
    for planned in plan(study).cases.values():
        case = planned.case
        if case.model not in PART:
            continue
        part = PART[case.model]
        own = getattr(case.numerics, part)
        yield from _pair(planned.label, case, own)
        if own == SectionMesh():
            for name in ("coarser", "finer"):
                yield from _pair(f"{planned.label}, {name}", case, MESHES[name][part])


def _with_mesh(numerics: Numerics, part: str, mesh: MeridianMesh | SectionMesh) -> Numerics:
    """Some settings with another mesh."""
    changed: dict[str, Any] = {part: mesh}
    return replace(numerics, **changed)


def _pair(name: str, case: Case, mesh: MeridianMesh | SectionMesh) -> Iterator[AnalysisCase]:
    """A curve on a mesh and on one twice as fine."""
    finer = replace(mesh, refinement=2 * mesh.refinement)
    for each in (mesh, finer):
        numerics = _with_mesh(case.numerics, PART[case.model], each)
        fields = (
            case.fields_at if numerics == case.numerics else ()
        )  # then it is the record of the scene itself
        setting = _Setting(
            "scenes", case.model, name, numerics, case.effects, refinement=each.refinement
        )
        solved = replace(case, numerics=numerics, fields_at=fields)
        yield AnalysisCase(solved, f"{name}, mesh 1/{each.refinement}", setting.tags("curve"))
