"""What a figure gets: the records of its scene and the study around them."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from geometry.muscle import Muscle
from solver.case import Case
from solver.record import Solution
from workflow.data import records
from workflow.plan.plan import Plan
from workflow.study.schema import Scene

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class SceneData:
    """A scene and its solved curves.

    Attributes
    ----------
    curves : with the stops of this scene; their cases may have more
    """

    name: str
    plan: Plan
    curves: list[records.Curve]

    @classmethod
    def read(cls, plan: Plan, scene: str, folder: Path = records.FOLDER) -> "SceneData":
        """Read the records of a scene."""
        return cls(scene, plan, records.curves_of_scene(plan, scene, folder))

    @property
    def scene(self) -> Scene:
        """What the study file says."""
        return self.plan.study.scenes[self.name]

    @property
    def solutions(self) -> list[tuple[str, str, str, float, Case, Solution]]:
        """Muscle, model, variant, held value, case and solution of every curve, sorted."""
        return [
            (c.place.muscle, c.place.model, c.place.variant, c.place.held, c.case, c.solution)
            for c in self.curves
        ]

    @property
    def muscles(self) -> dict[str, Muscle]:
        """Muscles of the scene by name."""
        return {name: self.plan.study.muscles[name].muscle for name in self.scene.muscles}

    @property
    def materials(self) -> dict[str, str]:
        """Names of their rubbers by the muscle's name."""
        return {name: self.plan.study.muscles[name].material for name in self.scene.muscles}

    @cached_property
    def tree(self) -> "xr.DataTree":
        """The curves as in the dataset (workflow/data/dataset.py)."""
        from workflow.data import dataset  # a second, and most figures do without

        return dataset.build(self.curves, self.plan.study.muscles)
