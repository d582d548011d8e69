"""Which scenes are figures, and what a figure must be given to be drawn."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from solver.load_path import PathKind
from workflow.study.schema import FigureEntry, Scene

FOLDER = Path(__file__).parent.parent / "figures"
EVERY = tuple(PathKind)
GENERAL = "general"  # draws any scene with a path


@dataclass(frozen=True)
class Needs:
    """Paths that a figure can show (none: the muscles themselves), muscles, quantities."""

    paths: tuple[str, ...] = EVERY
    muscles: int = 1
    quantities: tuple[str, ...] = ()


NEEDS = {  # of the figures of the paper
    "fig03": Needs(()),
    "fig04": Needs(("isobaric",)),
    "fig05": Needs(quantities=("stress",)),
    "fig06": Needs(("isometric",)),
    "fig07": Needs(("isometric",)),
    "fig08": Needs(("isotonic",)),
    "fig09": Needs(("isobaric",)),
    "fig10": Needs(("isobaric",)),
    "fig11": Needs(("isobaric",), muscles=2),
    "fig12": Needs(("isobaric", "isometric")),
    "fig13": Needs(("isotonic",)),
}


def module(name: str, scene: Scene) -> str:
    """Name of the module in workflow/figures that draws a scene; empty if it is in no figure.

    One that is named like a figure is drawn as that, unless it says how it is to be drawn.
    """
    if has_own(name) and scene.figure is None:
        return name
    return GENERAL if scene.path is not None else ""


def axes(scene: Scene) -> tuple[str, str]:
    """The quantities that the general drawing of a scene shows, on x and on y."""
    kind, chosen = PathKind(scene.kind), scene.figure or FigureEntry()
    swept = "time" if scene.path == "transient" else kind.swept.key
    return chosen.x or swept, chosen.y or kind.follows


def has_own(name: str) -> bool:
    """Whether there is a figure of that name."""
    return re.match(r"fig\d", name) is not None and (FOLDER / f"{name}.py").exists()


def lacking(name: str, scene: Scene) -> Iterator[tuple[str, object, str]]:
    """Key, value and what is allowed of all that keeps a scene from being its figure."""
    needs = NEEDS.get(name) if module(name, scene) == name else None
    if needs is None:
        return
    if (scene.path or "none") not in (needs.paths or ("none",)):
        if needs.paths:
            yield "path", scene.path, f"{' or '.join(needs.paths)}, which {name} shows"
        else:
            yield "path", scene.path, f"no path: {name} shows the muscles themselves"
    if len(scene.muscles) < needs.muscles:
        yield "muscles", list(scene.muscles), f"at least {needs.muscles} muscles in {name}"
    for quantity in needs.quantities:
        if quantity not in scene.quantities:
            given = list(scene.quantities) or None
            yield "quantities", given, f"with {quantity}, which {name} shows"
