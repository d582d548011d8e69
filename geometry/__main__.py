"""Mesh a muscle, or write it whole: ``python -m geometry SPEC OUTPUT``.

SPEC is a JSON file (or - for standard input) that says what to make::

    {"kind": "meridian", "muscle": {...}, "mesh": {...}}                  -> Medit .mesh
    {"kind": "section", "end": "clamp", "muscle": {...}, "mesh": {...}}   -> MSH 2.2
    {"kind": "cell", "thread_radius": 0.3, "thread_lines": false, ...}    -> Medit .mesh
    {"kind": "whole", "muscle": {...}}                                    -> STEP

with the fields of Muscle, MeridianMesh, SectionMesh and CellMesh. Ends with status 2
and one message if that cannot be built.
"""

import argparse
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from geometry import attempt, cell, meridian, section, whole
from geometry.grading import UnbuildableMesh
from geometry.muscle import Muscle
from geometry.refusal import Refusal, build
from geometry.seal import write_why_none

KEYS = {
    "meridian": {"kind", "muscle", "mesh"},
    "section": {"kind", "muscle", "mesh", "end"},
    "cell": {"kind", "muscle", "mesh", "thread_radius", "thread_lines"},
    "whole": {"kind", "muscle"},
}


def make(spec: Mapping[str, Any], output: Path) -> None:
    """Write what a specification describes.

    Raises
    ------
    Refusal
        Naming the field, its value and what is allowed.
    """
    kind = spec.get("kind") if isinstance(spec, Mapping) else None
    if not isinstance(kind, str) or kind not in KEYS:
        raise UnbuildableMesh("kind", kind, ", ".join(KEYS))
    if spec.keys() != KEYS[kind]:
        raise UnbuildableMesh("keys", sorted(spec), f"exactly {sorted(KEYS[kind])}")
    muscle = Muscle.from_dict(spec["muscle"])
    if kind == "meridian":
        mesh = build(meridian.MeridianMesh, spec["mesh"], UnbuildableMesh, "mesh")
        meridian.write(muscle, mesh, output)
    elif kind == "section":
        section_mesh = build(section.SectionMesh, spec["mesh"], UnbuildableMesh, "mesh")
        section.write(muscle, section_mesh, spec["end"], output)
    elif kind == "cell":
        cell_mesh = build(cell.CellMesh, spec["mesh"], UnbuildableMesh, "mesh")
        lines = {"thread_lines": spec["thread_lines"] is True}
        cell.write(muscle, cell_mesh, spec["thread_radius"], output, **lines)
    else:
        whole.write(muscle, output)


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
