"""Solve one case: ``python -m solver --help``.

Ends with status 0 whenever the case was understood: how the solve went is a status in the record.
Ends with status 2 and one message if the case makes no sense; with status 1 and one message, and
without a record, if it failed for a reason outside the case (a full disk, a signal, no FreeFEM).
"""

import argparse
import sys
import time
from pathlib import Path

from geometry.refusal import Refusal
from solver.case import Case
from solver.freefem import Limits


def main(arguments: list[str] | None = None) -> int:
    """Parse the command line, solve, write record and cost."""
    start = time.monotonic()
    parser = argparse.ArgumentParser(prog="python -m solver", description=__doc__)
    parser.add_argument("--case", required=True, help="the case as JSON text (solver/case.py)")
    parser.add_argument("--mesh", type=Path, help="made by python -m geometry; not for all models")
    parser.add_argument("--record", type=Path, required=True, help="HDF5 file to write")
    parser.add_argument("--cost", type=Path, required=True, help="JSON file: seconds and memory")
    parser.add_argument("--log", type=Path, required=True, help="what FreeFEM prints")
    parser.add_argument("--code", default="", help="digest of the sources (0.1 s if left out)")
    parser.add_argument("--wall-time", type=float, default=3600.0, help="limit [s]")
    parser.add_argument("--memory", type=float, default=4000.0, help="limit [MB]")
    given = parser.parse_args(arguments)
    try:
        case = Case.from_json(given.case)
    except (Refusal, KeyError, TypeError, ValueError) as error:
        print(f"no such case can be solved: {error}", file=sys.stderr)
        return 2
    from solver.job import Job, say  # numpy only once the case is known to make sense

    job = Job(
        case=case,
        mesh=given.mesh,
        record=given.record,
        cost=given.cost,
        log=given.log,
        limits=Limits(wall_time=given.wall_time, memory=given.memory),
        code=given.code,
    )
    if why := job.run(start):
        say(why)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
