"""Write the fields of a record for ParaView: all its states as one series, or one of them."""

import argparse
from pathlib import Path

from workflow.data import paraview, records
from workflow.data.paraview import View
from workflow.programs import add_study, plan_of
from workflow.study.errors import StudyError, choices
from workflow.study.schema import HELD_KEY

ENDINGS = (".pvd", ".vtu")
SECTORS = 24  # of a section that is turned about the axis
MOST_SECTORS = 720


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("muscle", nargs="?", help="of the study; or --record")
    parser.add_argument("--path", choices=sorted(HELD_KEY), help="of its curve with fields")
    parser.add_argument("--held", type=float, help="the same, where there are several")
    parser.add_argument("--model", help="the same")
    parser.add_argument("--variant", help="the same")
    parser.add_argument("--record", type=Path, help="file of any record, in place of a muscle")
    parser.add_argument("--state", type=int, help="number of one state, from 0; by default all")
    parser.add_argument(
        "--revolve",
        type=int,
        nargs="?",
        const=SECTORS,
        default=0,
        metavar="SECTORS",
        help=f"the section turned about the axis, by default in {SECTORS} sectors",
    )
    parser.add_argument("--whole", action="store_true", help="the whole muscle and its threads")
    parser.add_argument("--unloaded", action="store_true", help="points where they were unloaded")
    parser.add_argument(
        "--output", type=Path, help=".pvd of all states (they are in a folder beside it), or .vtu"
    )


def run(given: argparse.Namespace) -> int:
    """Write them."""
    if given.revolve and not 3 <= given.revolve <= MOST_SECTORS:
        raise StudyError(f"--revolve {given.revolve}: from 3 to {MOST_SECTORS} sectors")
    if given.revolve and given.whole:
        raise StudyError("--revolve turns the section, --whole is the whole muscle: give one")
    path, name = (given.record, "fields") if given.record else _of_muscle(given)
    if not path.exists():
        raise StudyError(f"{path}: there is no such record; run snakemake")
    output = given.output or Path(f"{name}{ENDINGS[given.state is not None]}")
    if output.suffix not in ENDINGS:
        raise StudyError(f"--output {output}: the ending is {' or '.join(ENDINGS)}")
    if (output.suffix == ".vtu") != (given.state is not None):
        raise StudyError(f"--output {output}: .vtu is of one --state, .pvd of all")
    view = View(given.revolve, given.whole, given.unloaded)
    if given.state is not None:
        paraview.write(path, given.state, output, view)
        print(output)
        return 0
    count = paraview.write_series(path, output, view)
    if not count:
        raise StudyError(f"{path}: {paraview.NONE}")
    print(f"{output}: {count} {'state' if count == 1 else 'states'}; open it in ParaView")
    return 0


def _of_muscle(given: argparse.Namespace) -> tuple[Path, str]:
    """The record of the only curve with fields that is meant, and what its files are called."""
    if given.muscle is None:
        raise StudyError("which fields? give a muscle of the study, or --record")
    plan = plan_of(given)
    if given.muscle not in plan.study.muscles:
        allowed = choices(given.muscle, plan.study.muscles)
        raise StudyError(f"{given.muscle}: no such muscle\n  allowed: {allowed}")
    wanted = {"group": given.path, "held": given.held, "model": given.model}
    wanted |= {"variant": given.variant, "muscle": given.muscle}
    found = {
        place: key
        for key, planned in plan.cases.items()
        if planned.case.fields_at
        for place in planned.places
        if all(value in (None, getattr(place, name)) for name, value in wanted.items())
    }
    if not found:
        raise StudyError(f"{given.muscle}: no such curve of it has fields; {paraview.HOW}")
    if len(found) > 1:
        curves = "\n  ".join(sorted(map(str, found)))
        options = "--held, --model, --variant or --path"
        many = f"{len(found)} curves have fields; {options} says which"
        raise StudyError(f"{given.muscle}: {many}\n  {curves}")
    ((place, key),) = found.items()
    return records.path_of(key), paraview.name_of(place)
