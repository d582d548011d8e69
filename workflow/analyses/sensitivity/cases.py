"""How much each input moves the muscle's force, threshold pressure and free contraction.

Local: percent of the result per percent of the input at the normal condition (20 mm, 0.3 MPa,
10 %), by central differences, with the cylinder and, to check it, the solid. Global: Sobol's
indices, the share of the variance that an input explains alone (first) and with others (total),
with the cylinder, which takes milliseconds; once over what is not known of the paper's muscle, once
over the factors of the paper's Table 1. Threads slacken and the tube is clamped, as by default.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from geometry.muscle import Braid
from solver.case import Case
from solver.load_path import LoadPath, PathKind
from solver.material import Thread
from workflow.analyses.analysis import AnalysisCase
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.errors import StudyError

MUSCLE, OTHER = "dmsp20", "dmsp20_silicone"  # of the study file; the softest rubber of Table 1
STEP = 0.02  # relative, of local differences
CHECK = "solid"
Point = dict[str, float]


@dataclass(frozen=True)
class Normal:
    """The normal condition: inputs by name, and what they change."""

    muscle: StudiedMuscle
    soft: StudiedMuscle
    braid: Braid
    point: Point

    @classmethod
    def of(cls, study: Study) -> "Normal":
        """Of a study with the paper's muscles."""
        for name in (MUSCLE, OTHER):
            if name not in study.muscles or not isinstance(study.muscles[name].muscle.braid, Braid):
                raise StudyError(f"muscles.{name}: the sensitivities are of this muscle")
        muscle = study.muscles[MUSCLE]
        braid, thread = muscle.muscle.braid, muscle.thread
        assert isinstance(braid, Braid)
        assert thread is not None
        inner, outer = braid.layer_diameters
        point = {
            "contraction": 0.1,
            "pressure": 0.3,  # MPa
            "inner_diameter": muscle.muscle.inner_diameter,
            "wall_thickness": muscle.muscle.wall_thickness,
            "lead": braid.lead,
            "inner_layer": inner / 2,  # mm, radius
            "outer_layer": outer / 2,
            "thread_stiffness": thread.stiffness,
            **muscle.rubber.values(),
            "nbr": 1.0,
        }
        return cls(muscle, study.muscles[OTHER], braid, point)

    @property
    def inputs(self) -> list[str]:
        """What local differences are taken by."""
        return [name for name in self.point if name != "nbr"]

    def cases(self, changes: Mapping[str, float], model: str) -> tuple[Case, Case]:
        """Isobaric case with the free contraction, isometric one with the threshold pressure.

        A wider bore keeps the layers' distance from it and the braid angle.
        """
        p = {**self.point, **changes}
        base = self.muscle.muscle
        shift = (p["inner_diameter"] - base.inner_diameter) / 2
        layers = (2 * (p["inner_layer"] + shift), 2 * (p["outer_layer"] + shift))
        lead = p["lead"] * sum(layers) / sum((2 * p["inner_layer"], 2 * p["outer_layer"]))
        muscle = replace(
            base,
            inner_diameter=p["inner_diameter"],
            wall_thickness=p["wall_thickness"],
            braid=replace(self.braid, lead=lead, layer_diameters=layers),
        )
        soft, share = self.soft.rubber.values(), p["nbr"]
        mixed = {name: share * p[name] + (1 - share) * soft[name] for name in soft}
        rubber = replace(self.muscle.rubber, **mixed)
        thread = Thread(stiffness=p["thread_stiffness"])
        held = {
            PathKind.ISOBARIC: (p["pressure"], p["contraction"]),
            PathKind.ISOMETRIC: (p["contraction"], p["pressure"]),
        }
        first, second = (
            Case(
                muscle=muscle,
                rubber=rubber,
                thread=thread,
                path=LoadPath(kind=kind, held=at, stops=(stop,), zero_force=True),
                model=model,
            )
            for kind, (at, stop) in held.items()
        )
        return first, second


def cases(study: Study) -> list[AnalysisCase]:
    """The normal condition and both neighbours by each input, by the solid."""
    normal = Normal.of(study)
    return [
        AnalysisCase(
            case,
            f"sensitivity to {name}, {case.path.kind}",
            {"input": name, "way": way},
        )
        for name, way, changes in neighbours(normal)
        for case in normal.cases(changes, CHECK)
    ]


def neighbours(normal: Normal) -> Iterator[tuple[str, int, Point]]:
    """Input, direction and changed value; direction 0 is the normal condition."""
    yield "none", 0, {}
    for name in normal.inputs:
        for way in (-1, 1):
            value = normal.point[name] * (1 + way * STEP)
            yield name, way, {name: float(f"{value:.12g}")}
