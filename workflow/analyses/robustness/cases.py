"""Do hard cases stay stable? Named hard cases on three meshes, and Latin hypercubes of muscles.

Named cases run from -5 to 25 % of contraction in steps of 1 %. They end at 25 %, or at a limit that
the three meshes agree on. The hypercube spans what may be built; a sample that cannot be built
(threads closer than their diameter) is drawn again. A tenth of it is solved again on a mesh twice
as fine with steps half as long, and twenty go through a cycle, their rubber with a memory.
Another hypercube is of any muscles (any_muscle.py).
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import qmc

from geometry.mesh_settings import MeridianMesh, SectionMesh
from geometry.muscle import Braid, Muscle
from solver import net, rubber
from solver.case import Case
from solver.effects import Effects, End, ThreadLaw
from solver.history import History, Wave, sampled
from solver.load_path import LoadPath, PathKind
from solver.material import Thread
from solver.memory import Memory
from solver.numerics import Numerics, Spread
from solver.rubber.rubber_law import RubberLaw
from workflow.analyses.analysis import AnalysisCase
from workflow.analyses.random_muscles import Ranges, numbers
from workflow.analyses.robustness import any_muscle
from workflow.study import fit
from workflow.study.contents import Study

MUSCLE, SILICONE = "dmsp20", "dmsp20_silicone"  # of the study file
CONTRACTIONS = tuple(round(-0.05 + 0.01 * k, 2) for k in range(31))
PRESSURE = 0.3  # MPa, where a case does not name one
MESHES = {  # coarse, medium, fine
    1: SectionMesh(cap_step=0.5),
    2: SectionMesh(refinement=2),
    3: SectionMesh(refinement=3),
}
LOW_PRESSURE_MESHES = {  # several elements per wave: a slack tube folds in waves of 20 mm
    number: SectionMesh(body_step=step)
    for number, step in zip(MESHES, (0.14, 0.1, 0.07), strict=True)
}
# Slack tubes pushed far buckle in waves; steps of half a diameter see folds that are not there.
HYPERCUBE_MESH = SectionMesh(cap_step=0.25, growth=1.25, body_step=0.2)

SEED = 20260101
SAMPLES = 200
REPEATED = 10  # every tenth sample is solved again on a finer mesh
LIMITS: Ranges = {  # of the hypercube
    "inner_diameter": (8, 50, False),  # mm
    "wall": (0.04, 0.2, False),  # of the diameter
    "length": (3, 30, False),  # of the diameter
    "angle": (12, 52, False),  # degrees
    "threads": (20, 120, False),
    "stiffness": (50, 20000, True),  # N
    "c10": (0.02, 1, True),  # MPa
    "c01": (0, 0.7, False),  # of c10
    "pressure": (0.01, 0.8, False),  # MPa
    "path": (0, 5, False),  # 0 to 3 isobaric, to 4 isometric, to 5 isotonic
}
MEMORY, PERIOD, CYCLE_STEPS = Memory.flat(0.06, 1e-3, 1e3), 4.0, 40  # of cycles; s
ANY = "any muscle"  # the set of the other hypercube
LAYERS = (0.15, 0.45)  # depth of the layers, shares of the wall


def cases(study: Study) -> list[AnalysisCase]:
    """Named cases by mesh, their membranes, both hypercubes, their repeated tenths, and cycles."""
    samples = _hypercube()[0]
    return [*_named(study), *samples, *_cycles(samples), *_any_muscles()]


@dataclass(frozen=True)
class _Hard:
    """A named hard case, as what differs from the muscle of the paper."""

    pressure: float = PRESSURE
    muscle: Muscle | None = None
    rubber: RubberLaw | None = None
    stiffness: float | None = None
    effects: Effects = field(default_factory=Effects)


def _hard_cases(study: Study) -> dict[str, _Hard]:
    base, nbr = study.muscles[MUSCLE].muscle, study.muscles[MUSCLE].rubber
    silicone = study.muscles[SILICONE].rubber
    assert isinstance(base.braid, Braid)
    braid = base.braid

    def angled(degrees: float) -> Muscle:
        return replace(base, braid=_angled(degrees, braid))

    def wide(diameter: float) -> Muscle:
        shift = diameter - base.inner_diameter
        layers = (braid.layer_diameters[0] + shift, braid.layer_diameters[1] + shift)
        at_angle = Braid.from_angle(
            angle=math.degrees(braid.angle), threads=braid.threads, layer_diameters=layers
        )
        return replace(base, inner_diameter=diameter, braid=at_angle)

    hard = {f"p {p:g} MPa": _Hard(p) for p in (0.01, 0.05, 0.3, 0.6, 0.8)}
    for p in (0.1, 0.3, 0.4):
        for t in (1.5, 2.0, 3.0):
            wall = replace(base, wall_thickness=t, cap_length=4 * t)
            hard[f"silicone {t:g} mm, p {p:g} MPa"] = _Hard(p, muscle=wall, rubber=silicone)
    for stiffness in (20.0, 2e3, 2e4, 2e5):
        hard[f"EA {stiffness:g} N"] = _Hard(stiffness=stiffness)
    for ratio in (1e2, 1e3, 1e5):
        softer = replace(nbr, kappa=ratio * nbr.shear_modulus)
        hard[f"kappa/mu {ratio:g}"] = _Hard(rubber=softer)
    hard |= {
        f"L {length:g} mm": _Hard(muscle=replace(base, length=length)) for length in (60, 1000)
    }
    hard |= {f"D {diameter:g} mm": _Hard(muscle=wide(diameter)) for diameter in (10, 40)}
    hard |= {f"angle {a:g} deg": _Hard(muscle=angled(a)) for a in (10, 17, 35, 50, 60)}
    hard["two-way threads"] = _Hard(effects=Effects(threads=ThreadLaw.TWO_WAY))
    hard["butt ends"] = _Hard(effects=Effects(end=End.BUTT))
    return hard


def _named(study: Study) -> Iterator[AnalysisCase]:
    ours = study.muscles[MUSCLE]
    assert ours.thread is not None
    for name, hard in _hard_cases(study).items():
        meshes = LOW_PRESSURE_MESHES if hard.pressure < 0.1 else MESHES
        for mesh in meshes:
            case = Case(
                muscle=hard.muscle or ours.muscle,
                rubber=hard.rubber or ours.rubber,
                thread=Thread(stiffness=hard.stiffness) if hard.stiffness else ours.thread,
                path=LoadPath(kind=PathKind.ISOBARIC, held=hard.pressure, stops=CONTRACTIONS),
                model="solid",
                effects=hard.effects,
                numerics=Numerics(section=meshes[mesh]),
                fields_at=(CONTRACTIONS[-1],) if mesh == min(MESHES) else (),
            )
            tags: dict[str, str | float] = {"set": "named", "name": name, "mesh": mesh}
            yield AnalysisCase(case, f"{name}, mesh {mesh}", tags)
        membrane = replace(case, model="membrane", fields_at=(), numerics=_membrane_mesh(hard))
        tags = {"set": "named", "name": name, "mesh": max(MESHES)}
        yield AnalysisCase(membrane, f"{name}, membrane", tags)


def _membrane_mesh(hard: _Hard) -> Numerics:
    if hard.pressure < 0.1:
        return Numerics(meridian=MeridianMesh(body_step=LOW_PRESSURE_MESHES[3].body_step))
    return Numerics(meridian=MeridianMesh(refinement=3))


def _hypercube() -> tuple[list[AnalysisCase], int]:
    """The samples, and how many had to be drawn again because they cannot be built."""
    points = qmc.LatinHypercube(len(LIMITS), seed=SEED).random(SAMPLES)
    again = np.random.default_rng(SEED)
    found: list[AnalysisCase] = []
    redrawn = 0
    for number, point in enumerate(points):
        case = _sample(point)
        while case is None:
            redrawn += 1
            case = _sample(again.random(len(LIMITS)))
        found += _of_sample(case, "hypercube", number, HYPERCUBE_MESH)
    return found, redrawn


def _cycles(samples: Sequence[AnalysisCase]) -> Iterator[AnalysisCase]:
    """Every tenth sample at its pressure, to half the contraction of its net and back, in time."""
    for number in range(0, SAMPLES, REPEATED):
        tags: dict[str, str | float] = {"set": "cycle", "name": f"{number}", "mesh": 1}
        case = next(one.case for one in samples if one.label == f"sample {number}, membrane")
        path = case.path
        pressure = path.held if path.kind is PathKind.ISOBARIC else path.stops[-1]
        braid = case.muscle.braid
        assert braid is not None
        end = (1 - 1 / (math.sqrt(3) * math.cos(braid.angle))) / 2
        times, stops = sampled(Wave.TRIANGLE, 0.0, round(end, 4), PERIOD, 1, CYCLE_STEPS)
        history = History(times=times, period=PERIOD)
        cycle = LoadPath(kind=PathKind.ISOBARIC, held=pressure, stops=stops, history=history)
        case = replace(case, path=cycle, memory=MEMORY)
        yield AnalysisCase(case, f"sample {number}, cycle", tags)


def _of_sample(case: Case, of: str, number: int, mesh: SectionMesh) -> Iterator[AnalysisCase]:
    """A sample of a hypercube, its membrane, and every tenth on a finer mesh."""
    tags: dict[str, str | float] = {"set": of, "name": f"{number}", "mesh": 1}
    said = "sample" if of == "hypercube" else of
    yield AnalysisCase(case, f"{said} {number}", tags)
    membrane = replace(case, model="membrane", fields_at=())
    yield AnalysisCase(membrane, f"{said} {number}, membrane", tags)
    if number % REPEATED == 0:
        twice = Numerics(section=replace(mesh, refinement=2))
        finer = replace(case, path=_halved(case.path), numerics=twice)
        yield AnalysisCase(finer, f"{said} {number}, finer", tags | {"mesh": 2})


def _any_muscles() -> Iterator[AnalysisCase]:
    """Samples of sleeves with gaps and of five laws, on the mesh that a study has by default."""
    again = np.random.default_rng(any_muscle.SEED)
    for number, point in enumerate(any_muscle.points(SAMPLES)):
        sample = any_muscle.values(point)
        while (muscle := any_muscle.muscle(sample)) is None:
            sample = any_muscle.values(again.random(len(any_muscle.LIMITS)))
        pressure, choice = sample["pressure"], sample["path"]
        load = float(f"{_load(muscle, pressure, choice):.4g}")
        case = Case(
            muscle=muscle,
            rubber=any_muscle.law(sample),
            thread=Thread(stiffness=any_muscle.stiffness(sample)),
            path=_path(pressure, choice, load),
            model="solid",
        )
        yield from _of_sample(case, ANY, number, SectionMesh())


def _sample(point: np.ndarray) -> Case | None:
    """The case of a point of the unit cube; None if it cannot be built."""
    v = numbers(LIMITS, point)
    diameter, wall = v["inner_diameter"], v["wall"] * v["inner_diameter"]
    layers = (diameter + 2 * LAYERS[0] * wall, diameter + 2 * LAYERS[1] * wall)
    threads = round(v["threads"])
    braid = Braid.from_angle(angle=v["angle"], threads=threads, layer_diameters=layers)
    thread_diameter = fit.diameter(v["stiffness"], Spread().modulus)
    if math.pi * layers[0] * math.cos(braid.angle) / threads <= thread_diameter:
        return None
    muscle = Muscle(
        inner_diameter=diameter,
        wall_thickness=wall,
        length=v["length"] * diameter,
        braid=braid,
        cap_length=4 * wall,
    )
    path = _path(v["pressure"], v["path"], round(_load(muscle, v["pressure"], v["path"]), 3))
    return Case(
        muscle=muscle,
        rubber=rubber.from_dict({"c10": v["c10"], "c01": v["c01"] * v["c10"]}),
        thread=Thread(stiffness=v["stiffness"]),
        path=path,
        model="solid",
        numerics=Numerics(section=HYPERCUBE_MESH),
        fields_at=(path.stops[-1],),
    )


def _load(muscle: Muscle, pressure: float, choice: float) -> float:
    """A share of what the net pulls with before it contracts [N], by where ``choice`` lies."""
    return 0.6 * (choice % 1) * abs(float(net.force(muscle, pressure, 0.0)))


def _path(pressure: float, choice: float, load: float) -> LoadPath:
    """Three in five isobaric; the rest isometric, held where ``choice`` lies, or under a load."""
    rising = tuple(round(pressure * k / 8, 6) for k in range(1, 9))
    if choice < 3:
        stops = tuple(round(-0.05 + 0.025 * k, 3) for k in range(13))
        return LoadPath(kind=PathKind.ISOBARIC, held=round(pressure, 6), stops=stops)
    if choice < 4:
        return LoadPath(kind=PathKind.ISOMETRIC, held=round(0.2 * (choice % 1), 4), stops=rising)
    return LoadPath(kind=PathKind.ISOTONIC, held=load, stops=rising)


def _halved(path: LoadPath) -> LoadPath:
    """The same path with a stop between any two."""
    between = [round((a + b) / 2, 7) for a, b in zip(path.stops, path.stops[1:], strict=False)]
    return replace(path, stops=tuple(sorted((*path.stops, *between))))


def _angled(degrees: float, braid: Braid) -> Braid:
    return Braid.from_angle(
        angle=degrees, threads=braid.threads, layer_diameters=braid.layer_diameters
    )
