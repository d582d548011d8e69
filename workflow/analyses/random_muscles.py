"""Muscles and curves at random, of the kinds that people build: for what must hold for any muscle.

A scrambled Sobol sequence in the ranges of ``RANGES``; a muscle that cannot be built (threads that
do not fit side by side even of the stiffest fibre) is drawn again. In turn they are pulled at
constant pressure, at constant contraction and under a load; have their braid in the wall or a
sleeve around it; are of Mooney-Rivlin's law or of Yeoh's.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from geometry.braid import AnyBraid, Braid, Kind, LayeredBraid
from geometry.muscle import Muscle
from geometry.refusal import Refusal
from solver import net, rubber
from solver.case import Case
from solver.load_path import LoadPath, PathKind
from solver.material import Thread
from solver.rubber.rubber_law import RubberLaw
from workflow.study import fit

Ranges = Mapping[str, tuple[float, float, bool]]  # name -> (low, high, whether logarithmic)
RANGES: Ranges = {
    "inner_diameter": (6, 45, True),  # mm
    "wall": (0.05, 0.16, False),  # of the diameter
    "length": (4, 22, False),  # of the diameter
    "angle": (14, 34, False),  # degrees, at the mean layer diameter
    "spacing": (0.5, 3, True),  # mm between threads around the tube
    "stiffness": (100, 3000, True),  # EA of a thread [N]
    "modulus": (0.09, 1.2, True),  # initial shear modulus of the rubber [MPa]
    "softening": (0, 0.4, False),  # share of c01 in it; of Yeoh how far it softens
    "pressure": (0.2, 2, True),  # of the modulus
    "first": (-0.6, 1, False),  # begins at this share of 10 % of contraction, or at 0
    "furthest": (0.35, 0.85, False),  # share of the net's free contraction
    "load": (0.05, 0.6, False),  # share of the net's force
    "gap": (-0.1, 0.15, False),  # of a sleeve / outer radius, or none
}
LAYERS = (0.15, 0.45)  # depth of layers in the wall, shares of it
HIGHEST = 0.7  # MPa
KINDS = tuple(PathKind)


@dataclass(frozen=True)
class RandomCurve:
    """A curve of a muscle, by any model."""

    number: int
    muscle: Muscle
    rubber: RubberLaw
    thread: Thread
    path: LoadPath

    def case(self, model: str, **others: object) -> Case:
        """By a model; ``others`` are fields of the case."""
        values = {"muscle": self.muscle, "rubber": self.rubber, "thread": self.thread}
        return Case(path=self.path, model=model, **values, **others)  # type: ignore[arg-type]


def curves(count: int, seed: int) -> Iterator[RandomCurve]:
    """So many of them; the first ones of a seed are the same for any count."""
    points = qmc.Sobol(len(RANGES), seed=seed).random(2 ** math.ceil(math.log2(max(count, 2))))
    for number, point in enumerate(points[:count]):
        again = np.random.default_rng((seed, number))
        found = _curve(number, point)
        while found is None:
            found = _curve(number, again.random(len(RANGES)))
        yield found


def numbers(ranges: Ranges, point: Iterable[float]) -> dict[str, float]:
    """Of a point of the unit cube, by name."""
    return {
        name: float(low * (high / low) ** u if logarithmic else low + (high - low) * u)
        for (name, (low, high, logarithmic)), u in zip(ranges.items(), point, strict=True)
    }


def _curve(number: int, point: np.ndarray) -> RandomCurve | None:
    """Of a point of the unit cube; None if it cannot be built."""
    v = numbers(RANGES, point)
    kind, sleeved, yeoh = KINDS[number % 3], number // 3 % 2 == 1, number // 6 % 2 == 1
    diameter = round(v["inner_diameter"], 2)
    wall = round(v["wall"] * diameter, 3)
    try:
        braid = _braid(v, diameter, wall, sleeved=sleeved)
        thread = Thread(stiffness=float(f"{v['stiffness']:.3g}"))
        muscle = Muscle(
            inner_diameter=diameter,
            wall_thickness=wall,
            length=round(v["length"] * diameter, 1),
            braid=braid,
            cap_length=round(4 * wall, 3),
        )
        fit.check(braid.layers(muscle.outer_radius), thread.stiffness, None)
    except Refusal:
        return None
    pressure = float(f"{min(v['pressure'] * v['modulus'], HIGHEST):.3g}")
    return RandomCurve(
        number=number,
        muscle=muscle,
        rubber=_rubber(v["modulus"], v["softening"], yeoh=yeoh),
        thread=thread,
        path=_path(kind, muscle, pressure, v),
    )


def _braid(v: dict[str, float], diameter: float, wall: float, *, sleeved: bool) -> AnyBraid:
    threads = max(10, round(math.pi * diameter / v["spacing"]))
    if not sleeved:
        inner, outer = (diameter + 2 * depth * wall for depth in LAYERS)
        return Braid.from_angle(angle=v["angle"], threads=threads, layer_diameters=(inner, outer))
    around = (diameter + 2 * wall) * (1 + max(v["gap"], 0.0))
    return LayeredBraid(
        kinds=(str(Kind.SLEEVE),),
        layer_diameters=(around,),
        leads=(math.pi * around / math.tan(math.radians(v["angle"])),),
        threads=(threads,),
        senses=(0,),
        stiffness_shares=(1.0,),
    )


def _rubber(modulus: float, softening: float, *, yeoh: bool) -> RubberLaw:
    half = modulus / 2
    if yeoh:
        second = -0.1 * softening * half
        values = {"c1": half, "c2": second, "c3": -0.1 * second}
    else:
        values = {"c10": half * (1 - softening), "c01": half * softening}
    law: dict[str, object] = {"law": "yeoh"} if yeoh else {}
    return rubber.from_dict(law | {name: float(f"{v:.4g}") for name, v in values.items()})


def _path(kind: PathKind, muscle: Muscle, pressure: float, v: dict[str, float]) -> LoadPath:
    assert muscle.braid is not None
    free = 1 - 1 / (math.sqrt(3) * math.cos(muscle.braid.angle))  # of an inextensible thin net
    furthest = v["furthest"] * free
    rising = tuple(round(pressure * k / 8, 6) for k in range(1, 9))
    if kind is PathKind.ISOBARIC:
        first = 0.1 * max(v["first"], 0.0) * (furthest > 0.15)
        stops = tuple(round(first + (furthest - first) * k / 8, 4) for k in range(9))
        return LoadPath(kind=kind, held=pressure, stops=stops)
    if kind is PathKind.ISOMETRIC:
        return LoadPath(kind=kind, held=round(0.7 * furthest, 4), stops=rising)
    load = v["load"] * abs(float(net.force(muscle, pressure, 0.0)))
    return LoadPath(kind=kind, held=float(f"{load:.4g}"), stops=rising)
