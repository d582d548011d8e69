"""Draw curves that have been solved: one muscle or some, one quantity against another."""

import argparse
from dataclasses import dataclass
from pathlib import Path

from solver.status import CaseStatus
from workflow.data import records
from workflow.data.scene_data import SceneData
from workflow.plan.plan import Plan
from workflow.programs import add_study, settled_plan_of
from workflow.study.errors import StudyError, choices
from workflow.study.folders import DEFAULT
from workflow.study.schema import HELD_KEY, SHOWN, SWEPT_KEY, TIMED, Scene

ENDINGS = (".png", ".svg", ".csv")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("muscles", nargs="+", metavar="muscle", help="of the study")
    parser.add_argument("--path", choices=sorted(HELD_KEY), help="by default the first there is")
    parser.add_argument(
        "--held", type=float, nargs="+", help="values of what is held; by default all"
    )
    parser.add_argument("--model", nargs="+", dest="models", help="by default all")
    parser.add_argument("--variant", nargs="+", dest="variants", help="by default all")
    parser.add_argument("--x", metavar="QUANTITY", help="by default what is swept")
    parser.add_argument("--y", metavar="QUANTITY", help="by default what follows")
    parser.add_argument("--by", choices=("muscle", "held", "variant", "model"), default="muscle")
    parser.add_argument("--output", type=Path, default=Path("plot.png"), help=", ".join(ENDINGS))


@dataclass(frozen=True)
class Chosen(SceneData):
    """Some curves of a study, as a scene that the study file does not have."""

    asked: Scene

    @property
    def scene(self) -> Scene:
        """What is asked for."""
        return self.asked


def chosen(plan: Plan, given: argparse.Namespace) -> Chosen:
    """The solved curves that are meant, of one path.

    Raises
    ------
    StudyError
        If the study has no such muscle, model, variant or held value, or nothing is solved of it.
    """
    curves = [
        curve
        for curve in records.curves_of_study(plan, partial=True)
        if not curve.place.scene and curve.solution.status is not CaseStatus.NOT_SOLVED
    ]
    if not curves:
        raise StudyError(f"{given.study}: nothing of it is solved yet; {_run(given)} does it")
    path = given.path or next(
        (c.place.group for c in curves if c.place.muscle in given.muscles), ""
    )
    groups = list(dict.fromkeys(curve.place.group for curve in curves))
    if path and path not in groups:
        raise StudyError(f"--path {path}: no such curve is solved; there are {', '.join(groups)}")
    curves = [curve for curve in curves if curve.place.group == path or not path]
    for name, key in (
        ("muscles", "muscle"),
        ("models", "model"),
        ("variants", "variant"),
        ("held", "held"),
    ):
        wanted = getattr(given, name)
        if wanted is None:
            continue
        there = list(dict.fromkeys(getattr(curve.place, key) for curve in curves))
        for value in wanted:
            if value not in there:
                of = f"{path} curve" if path else "curve"
                known = choices(str(value), map(str, there))
                raise StudyError(f"{key} {value}: no {of} of it is solved; there are {known}")
        curves = [curve for curve in curves if getattr(curve.place, key) in wanted]
    if not curves:
        raise StudyError(f"{' '.join(given.muscles)}: no curve of all that is asked for is solved")
    stops = sorted({stop for curve in curves for stop in curve.stops})
    axes = {HELD_KEY[path]: sorted({c.place.held for c in curves}), SWEPT_KEY[path]: stops}
    figure = {"x": given.x, "y": given.y, "by": given.by}
    scene = Scene.model_validate({"muscles": given.muscles, "path": path, "figure": figure, **axes})
    return Chosen("plot", plan, curves, scene)


def _run(given: argparse.Namespace) -> str:
    """The command that solves the study."""
    own = "" if given.study == DEFAULT else f" --study {given.study}"
    return f".venv/bin/muscle run{own}"


def run(given: argparse.Namespace) -> int:
    """Draw them."""
    known = [name for name in SHOWN if name not in TIMED]
    for axis in ("x", "y"):
        asked = getattr(given, axis)
        if asked not in (None, *known):
            raise StudyError(f"--{axis} {asked}: no such quantity; {choices(asked, known)}")
    if given.output.suffix not in ENDINGS:
        raise StudyError(f"--output {given.output}: the ending is {', '.join(ENDINGS)}")
    plan = settled_plan_of(given)
    data = chosen(plan, given)
    from workflow.figures import general, style

    table = general.table(data)
    if given.output.suffix == ".csv":
        table.to_csv(given.output, index=False)
    else:
        style.save(general.draw(table), given.output)
    print(f"{given.output}: {len(data.curves)} curves of {', '.join(data.scene.muscles)}")
    return 0
