"""Settings of the meshes by kind: what a case says of its mesh; nothing is meshed here."""

from dataclasses import dataclass, field

from geometry.grading import OF_DIAMETER, OF_WALL, Grading, UnbuildableMesh
from geometry.muscle import ONE
from geometry.refusal import is_count, is_number


@dataclass(frozen=True, kw_only=True)
class MeridianMesh(Grading):
    """Numerics of the curve mesh: about 15 segments for the muscle of the paper."""

    cap_step: float = field(default=0.5, metadata=OF_WALL)
    growth: float = field(default=1.35, metadata=ONE)
    body_step: float = field(default=1.0, metadata=OF_DIAMETER)


@dataclass(frozen=True, kw_only=True)
class SectionMesh(Grading):
    """Numerics of the section: 90 triangles for the muscle of the paper with a clamp.

    ``rows`` are rows of elements below, between and above the thread layers in the wall. Above one
    layer are those of two bands, and without any there is one band with their sum.
    """

    rows: tuple[int, int, int] = field(default=(1, 1, 1), metadata=ONE)
    cap_step: float = field(default=1.0, metadata=OF_WALL)
    growth: float = field(default=1.5, metadata=ONE)
    body_step: float = field(default=2.0, metadata=OF_DIAMETER)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (
            isinstance(self.rows, tuple)
            and len(self.rows) == 3
            and all(is_count(row) for row in self.rows)
        ):
            raise UnbuildableMesh("rows", self.rows, "three integers >= 1")

    def bands(self, lines: int) -> tuple[int, ...]:
        """Rows of each band between lines of threads; of fewer than two, bands are one."""
        below, between, above = self.rows
        return {0: (sum(self.rows),), 1: (below, between + above)}.get(lines, self.rows)


@dataclass(frozen=True, kw_only=True)
class CellMesh:
    """Sizes of the tetrahedra: near a thread, and how they grow away from it.

    ``refinement`` m divides all sizes by m. ``repeats`` is the number of cells along the axis that
    are meshed as one: the muscle is the same with any, so it is for tests.

    Raises
    ------
    UnbuildableMesh
        Naming the field, its value and what is allowed.
    """

    thread_size: float = field(default=1.0, metadata=ONE | {"relative_to": "thread radius"})
    body_size: float = field(default=0.3, metadata=OF_WALL)
    growth: float = field(default=0.5, metadata=ONE)  # of the size, with the distance
    refinement: int = field(default=1, metadata=ONE)
    repeats: int = field(default=1, metadata=ONE)

    def __post_init__(self) -> None:
        for name in ("thread_size", "body_size", "growth"):
            value = getattr(self, name)
            if not (is_number(value) and value > 0):
                raise UnbuildableMesh(name, value, "a finite number > 0")
        for name in ("refinement", "repeats"):
            if not is_count(getattr(self, name)):
                raise UnbuildableMesh(name, getattr(self, name), "an integer >= 1")
