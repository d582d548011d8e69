"""What smearing the threads costs: single threads in the periodic cell against smeared layers.

Four sets of cases, told apart by the tag ``set``:

correction  single threads and smeared layers of the same radial spread, NBR and silicone, three
            pressures, walls 1.5 to 3 mm, 0 to 20 % of contraction: the weight of the effect
            "discrete threads", and the answer to claim C8 (silicone's maximum at 2 mm)
mesh        the force on finer and finer meshes, for threads, smeared layers, and the wire of zero
            thickness, which has no limit
twist       held and free ends
picture     one state of both rubbers on the finest mesh, with its fields, threads and smeared
"""

from collections.abc import Iterator
from dataclasses import replace

from geometry.mesh_settings import CellMesh
from solver.effects import Effects, Layers, Twist
from solver.load_path import LoadPath, PathKind
from solver.numerics import Numerics
from workflow.analyses.analysis import AnalysisCase
from workflow.study.contents import Study

MUSCLES = {"NBR": "dmsp20", "silicone": "dmsp20_silicone"}  # of the study file
CONTRACTIONS = (0.0, 0.05, 0.1, 0.15, 0.2)
PRESSURES = (0.2, 0.3, 0.4)  # MPa
WALLS = (1.5, 2.0, 2.5, 3.0)  # mm
PRESSURE, WALL, CONTRACTION = 0.3, 2.0, 0.1  # where nothing else is said
THREAD_SIZES = (1.5, 1.0, 0.8, 0.65)  # of the tetrahedra at a thread, in thread radii
BODY_SIZE = 0.25  # wall thicknesses, of the meshes of the set "mesh"


def cases(study: Study) -> list[AnalysisCase]:
    """All cases, by set."""
    return [*_correction(study), *_mesh(study), *_twist(study), *_picture(study)]


def of_claim(study: Study) -> list[AnalysisCase]:
    """Claim C8: silicone at the claim's pressure, by wall, with single threads and smeared."""
    return [
        one
        for one in _correction(study)
        if one.tags["rubber"] == "silicone" and one.tags["pressure [MPa]"] == PRESSURE
    ]


def _case(
    study: Study,
    name: str,
    rubber: str,
    *,
    wall: float = WALL,
    pressure: float = PRESSURE,
    size: float | None = None,
    stops: tuple[float, ...] = CONTRACTIONS,
    fields_at: tuple[float, ...] = (),
    layers: Layers = Layers.DISCRETE,
    twist: Twist = Twist.HELD,
) -> AnalysisCase:
    ours = study.muscles[MUSCLES[rubber]]
    mesh = CellMesh() if size is None else CellMesh(thread_size=size, body_size=BODY_SIZE)
    case = replace(ours, muscle=replace(ours.muscle, wall_thickness=wall)).case(
        LoadPath(kind=PathKind.ISOBARIC, held=pressure, stops=stops),
        "cell",
        effects=Effects(layers=layers, twist=twist),
        numerics=Numerics(cell=mesh),
        fields_at=fields_at,
    )
    tags: dict[str, str | float] = {
        "set": name,
        "rubber": rubber,
        "layers": layers.value,
        "twist": twist.value,
        "wall [mm]": wall,
        "pressure [MPa]": pressure,
        "size": CellMesh().thread_size if size is None else size,
    }
    return AnalysisCase(case, " ".join(map(str, tags.values())), tags)


def _correction(study: Study) -> Iterator[AnalysisCase]:
    for rubber in MUSCLES:
        for pressure in PRESSURES:
            for wall in WALLS:
                for layers in (Layers.DISCRETE, Layers.SMEARED):
                    yield _case(
                        study, "correction", rubber, wall=wall, pressure=pressure, layers=layers
                    )


def _mesh(study: Study) -> Iterator[AnalysisCase]:
    for layers in (Layers.DISCRETE, Layers.SMEARED, Layers.WIRE):
        for size in THREAD_SIZES:
            yield _case(study, "mesh", "NBR", size=size, layers=layers, stops=(0.0, 0.1, 0.2))


def _twist(study: Study) -> Iterator[AnalysisCase]:
    for twist in Twist:
        for layers in (Layers.DISCRETE, Layers.SMEARED):
            yield _case(study, "twist", "NBR", twist=twist, layers=layers)


def _picture(study: Study) -> Iterator[AnalysisCase]:
    at = (CONTRACTION,)
    for rubber in MUSCLES:
        for layers in (Layers.DISCRETE, Layers.SMEARED):
            yield _case(
                study,
                "picture",
                rubber,
                size=min(THREAD_SIZES),
                stops=at,
                fields_at=at,
                layers=layers,
            )
