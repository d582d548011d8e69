"""Mesh a muscle, or write it whole: ``python -m geometry SPEC OUTPUT``.

SPEC is a JSON file (or - for standard input) that says what to make::

    {"kind": "meridian", "muscle": {...}, "mesh": {...}}                  -> Medit .mesh
    {"kind": "section", "end": "butt", "muscle": {...}, "mesh": {...}}    -> MSH 2.2
    {"kind": "cell", "thread_radius": 0.3, "thread_lines": false, ...}    -> Medit .mesh
    {"kind": "whole", "muscle": {...}}                                    -> STEP

with the fields of Muscle, MeridianMesh, SectionMesh and CellMesh; with the end "clamp" also "ramp",
the length over which it takes hold, in wall thicknesses. Ends with status 2 and one message if that
cannot be built.
"""

import argparse
import json
import sys
from pathlib import Path

from geometry import attempt
from geometry.make import make
from geometry.refusal import Refusal
from geometry.seal import write_why_none


def main(arguments: list[str] | None = None) -> int:
    """Parse the command line and make the file."""
    parser = argparse.ArgumentParser(
        prog="python -m geometry",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("spec", help="JSON file, or - for standard input")
    parser.add_argument("output", type=Path, help="file to write, whole or not at all")
    parser.add_argument(
        "--or-why",
        nargs=2,
        type=float,
        metavar=("SECONDS", "MB"),
        help="write why into OUTPUT, with status 0, if it cannot be built within these limits; "
        "status 1 if it failed for a reason outside, as a full disk or a signal",
    )
    given = parser.parse_args(arguments)
    try:
        text = sys.stdin.read() if given.spec == "-" else Path(given.spec).read_text()
        spec = json.loads(text)
        if given.or_why is None:
            make(spec, given.output)
        elif why := attempt.why_not(lambda: make(spec, given.output), *given.or_why):
            write_why_none(given.output, why)
            print(f"cannot be built: {why}", file=sys.stderr)
    except (Refusal, OSError, ValueError) as error:
        print(f"cannot be built: {error}", file=sys.stderr)
        return 2
    except attempt.Failed as error:
        print(f"not built, to be tried again: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
