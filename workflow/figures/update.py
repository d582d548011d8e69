"""Figures and fields of a study: each made again only if what it is made of has changed."""

from pathlib import Path

from geometry.files import seal_of
from solver import sources
from solver.case import digest
from workflow.data import paraview
from workflow.data.settled import settled
from workflow.plan.plan import Plan
from workflow.run import damage, made
from workflow.study import figure_needs
from workflow.study.folders import CASES


def scenes(plan: Plan) -> list[str]:
    """Scenes that have a figure; one without is in the dataset only."""
    return [name for name, scene in plan.study.scenes.items() if figure_needs.module(name, scene)]


def wanted(plan: Plan) -> str:
    """Digest of what all figures and fields are made of but records."""
    codes = [(scene, sources.digest(_figure_sources(plan, scene))) for scene in scenes(plan)]
    plans = [plan.digest(scene) for scene in scenes(plan)]
    return digest(repr((codes, plans, paraview.files(plan), sources.digest(_field_sources()))))


def files(plan: Plan, folder: Path) -> list[Path]:
    """All of them, in the folder of a study."""
    series = [folder / "fields" / name for name in paraview.files(plan)]
    parts = [part for path in series for part in paraview.parts_of(path)]
    return [*series, *parts, *(path for scene in scenes(plan) for path in _files(scene, folder))]


def why_drawn(plan: Plan, scene: str, folder: Path) -> str:
    """Why a figure will be drawn; empty if it is there and made of what there is."""
    plan = settled(plan)
    return _why(_files(scene, folder), _figure_sources(plan, scene), _figure_of(plan, scene))


def figures(plan: Plan, scene: str, folder: Path) -> None:
    """Draw a figure, if there is a reason to."""
    if why_drawn(plan, scene, folder):
        of = _figure_of(plan, scene)
        from workflow.figures import figure  # and pandas, where something is drawn

        path = _files(scene, folder)[0]
        figure.make(plan, scene, path)
        made.note(path, made.keep(_figure_sources(plan, scene)), of)


def fields(plan: Plan, folder: Path) -> None:
    """Write the fields for ParaView that a study asks for, where there is a reason to."""
    for name, key in paraview.files(plan).items():
        path, of = folder / "fields" / name, _made_of(name, [key])
        if _why([path, *paraview.parts_of(path)], _field_sources(), of):
            paraview.write_series(CASES / f"{key}.h5", path)
            made.note(path, made.keep(_field_sources()), of)


def drawn_files(plan: Plan, folder: Path) -> str:
    """Digest of all of them."""
    return digest(repr([seal_of(path) for path in files(plan, folder)]))


def _files(scene: str, folder: Path) -> list[Path]:
    return [folder / "figures" / f"{scene}.{kind}" for kind in ("png", "svg", "csv")]


def _figure_sources(plan: Plan, scene: str) -> tuple[str, ...]:
    module = figure_needs.module(scene, plan.study.scenes[scene])
    return tuple(sources.sources("workflow.figures.figure", f"workflow.figures.{module}"))


def _field_sources() -> tuple[str, ...]:
    return tuple(sources.sources(paraview.__name__))


def _figure_of(plan: Plan, scene: str) -> str:
    """Digest of what a figure is made of, of a plan in which climbs are settled."""
    keys = sorted(set(plan.scenes.get(scene, {}).values()))
    more = sorted({other for key in keys for other in plan.meshes_by.get(key, ()) if other})
    return _made_of((plan.digest(scene), keys), keys + more)


def _made_of(asked: object, keys: list[str]) -> str:
    """Digest of what is asked for and of records."""
    paths = [CASES / f"{key}.h5" for key in keys]
    return digest(repr((asked, [seal_of(path) for path in paths if path.is_file()])))


def _why(paths: list[Path], files: tuple[str, ...], of: str) -> str:
    """Why files that are made together are made again."""
    for path in paths:
        if wrong := damage.at_a_glance(path):
            return f"{path.name} is {wrong}"
    code, before = made.known(paths[0])
    if changed := made.why(code, files):
        return changed
    return "" if of == before else "its records or its scene have changed"
