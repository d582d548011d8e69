"""What a study file says, once it is read: muscles, variants, scenes and calibrations by name."""

import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from geometry.muscle import Muscle
from solver.case import Case
from solver.effects import Effects
from solver.friction import Friction
from solver.load_path import LoadPath
from solver.material import Thread
from solver.memory import Memory
from solver.numerics import Numerics
from solver.rubber.rubber_law import RubberLaw
from workflow.study.installation import Installation
from workflow.study.limits import Limits
from workflow.study.schema import (
    CalibrationEntry,
    DesignEntry,
    MapEntry,
    PairEntry,
    PromiseEntry,
    Scene,
    is_path,
)
from workflow.study.source import Source


@dataclass(frozen=True, kw_only=True)
class StudiedMuscle:
    """A muscle of the study with its materials."""

    muscle: Muscle
    material: str
    rubber: RubberLaw
    thread: Thread | None
    memory: Memory | None = None  # of the rubber, in time
    friction: Friction | None = None  # of the crossings of its sleeves, in time
    limits: Limits = field(default_factory=Limits)  # of its materials
    installation: Installation = field(default_factory=Installation)
    reference: tuple[str, ...] = ()  # force maps that are of this muscle: names, paths of files

    def files(self) -> tuple[tuple[str, str], ...]:
        """Files of forces that are its own, with a digest of what stands in each."""
        own = [Path(name) for name in self.reference if is_path(name) and Path(name).is_file()]
        return tuple((str(file), hashlib.sha256(file.read_bytes()).hexdigest()) for file in own)

    def case(self, path: LoadPath, model: str, **others: Any) -> Case:
        """A curve of it by a model; ``others`` are effects, numerics and fields of the case."""
        return Case(
            muscle=self.muscle,
            rubber=self.rubber,
            thread=self.thread,
            path=path,
            model=model,
            **others,
        )


@dataclass(frozen=True, kw_only=True)
class Variant:
    """A set of effects and numerics."""

    effects: Effects
    numerics: Numerics


@dataclass(frozen=True, kw_only=True)
class Study:
    """What a study file says, by name."""

    source: Source
    muscles: dict[str, StudiedMuscle]
    variants: dict[str, Variant]
    scenes: dict[str, Scene]
    calibration: dict[str, CalibrationEntry]
    rubbers: dict[str, RubberLaw] = field(default_factory=dict)
    design: dict[str, DesignEntry] = field(default_factory=dict)
    maps: dict[str, MapEntry] = field(default_factory=dict)
    pairs: dict[str, PairEntry] = field(default_factory=dict)
    promise: PromiseEntry = field(default_factory=PromiseEntry)
    wall_time: int  # s, of one case
    memory: int  # MB, of one case
    warnings: tuple[str, ...] = ()  # what may be meant otherwise
