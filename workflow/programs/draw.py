"""Draw the figures of a study and write the fields for ParaView, all in one process."""

import argparse
import sys
import traceback
from collections.abc import Callable
from functools import partial
from pathlib import Path

from geometry.files import atomic_write
from workflow.figures import update
from workflow.programs import add_study, settled_plan_of
from workflow.study.errors import StudyError
from workflow.study.folders import of_study


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--scene", help="of this one only, and no fields")
    parser.add_argument("--stamp", type=Path, help="what tells that all are drawn")


def run(given: argparse.Namespace) -> int:
    """Draw what is not there or was made of something else; one that fails stops no other one."""
    plan, folder = settled_plan_of(given), of_study(given.study)
    names = [given.scene] if given.scene else update.scenes(plan)
    tasks = {name: partial(update.figures, plan, name, folder) for name in names}
    if not given.scene:
        tasks["fields"] = partial(update.fields, plan, folder)
    if failed := [name for name, task in tasks.items() if not _done(name, task)]:
        print(f"not drawn: {', '.join(failed)}", file=sys.stderr)
        return 1
    if given.stamp:
        with atomic_write(given.stamp, sealed=False) as beside:
            beside.write_text(f"{update.drawn_files(plan, folder)}\n")
    return 0


def _done(name: str, task: Callable[[], object]) -> bool:
    """Whether a task ends well; if not, why."""
    try:
        task()
    except (StudyError, OSError) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return False
    except Exception:  # of the code of one figure
        print(f"{name}:", file=sys.stderr)
        traceback.print_exc()
        return False
    return True
