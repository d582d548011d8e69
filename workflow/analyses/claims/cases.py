"""The scorecard of the paper's claims, with threads of other stiffness than the study's.

The cases are those of the study itself, which have its EA, and the same again for every other EA by
the membrane, which is fast and exact enough; the stress by the solid, which alone has it. Every EA
makes one table of states, of which the claims ask everything. What single threads change of the
force of silicone is computed by the cell and stands beside the table of the study's EA.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from solver.material import Thread
from workflow.analyses.analysis import AnalysisCase
from workflow.analyses.claims.claim import GEOMETRIC, MUSCLE
from workflow.analyses.claims.scorecard import SWEPT_MODEL
from workflow.analyses.threads import cases as threads
from workflow.data import paper
from workflow.plan.plan import Place, plan
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.errors import StudyError
from workflow.study.schema import Scene

STIFFNESSES = (50.0, 150.0, 315.0, 594.0, 650.0)  # N; 594 is the thickest thread that has room


@dataclass(frozen=True)
class PlacedCase(AnalysisCase):
    """A case at its place among the states of one EA."""

    place: Place | None = None
    muscle: StudiedMuscle | None = None
    stiffness: float = float("nan")  # N
    own: bool = False  # whether this is the study's EA


def cases(study: Study) -> list[PlacedCase]:
    """All curves of the study, and the fast ones of it with other EA.

    Raises
    ------
    StudyError
        If the study is not about the paper's muscle.
    """
    thread = study.muscles[MUSCLE].thread if MUSCLE in study.muscles else None
    if thread is None:
        raise StudyError(f"muscles.{MUSCLE}: the claims are of this muscle, with threads")
    if not paper.is_normal(study.muscles[MUSCLE]):
        raise StudyError(
            f"muscles.{MUSCLE}: the claims are of the paper's muscle; this one has another size, "
            "braid or rubber\n  allowed: any thread_stiffness; else give your muscle another name"
        )
    own = thread.stiffness
    curves = [
        case
        for stiffness in sorted({own, *STIFFNESSES})
        for case in _with_stiffness(study, stiffness, stiffness == own)
    ]
    cells = threads.of_claim(study) if threads.MUSCLES["silicone"] in study.muscles else []
    return curves + [
        PlacedCase(cell.case, cell.label, cell.tags, stiffness=own, own=True) for cell in cells
    ]


def _with_stiffness(study: Study, stiffness: float, own: bool) -> Iterator[PlacedCase]:
    changed = study if own else _stiffened(study, stiffness)
    for planned in plan(changed).cases.values():
        for place in planned.places:
            stress = bool(planned.case.fields_at)
            swept = place.model in (GEOMETRIC, SWEPT_MODEL) or stress
            if (own or swept) and (place.variant == "default" or stress):
                yield PlacedCase(
                    planned.case,
                    f"{place}, EA {stiffness:g} N",
                    place=place,
                    muscle=changed.muscles[place.muscle],
                    stiffness=stiffness,
                    own=own,
                )


def _stiffened(study: Study, stiffness: float) -> Study:
    """The study with threads of another stiffness, and without other states of the stress."""
    muscles = {
        name: replace(muscle, thread=Thread(stiffness=stiffness)) if muscle.thread else muscle
        for name, muscle in study.muscles.items()
    }
    scenes = {
        name: scene.model_copy(
            update={"models": tuple(m for m in scene.models or () if _fast(scene, m))}
        )
        for name, scene in study.scenes.items()
        if scene.path is not None
    }
    return replace(study, muscles=muscles, scenes={n: s for n, s in scenes.items() if s.models})


def _fast(scene: Scene, model: str) -> bool:
    return model in (GEOMETRIC, SWEPT_MODEL) or "stress" in scene.quantities
