"""What the FreeFEM programs are told of small vibrations, and what they have written of them."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from solver import files
from solver.case import DYNAMIC, Case
from solver.load_path import Waypoint

LARGEST_ROW = 100  # bytes


def write(case: Case, work: Path) -> None:
    """Write the files that solver/path/vibrations.idp reads."""
    assert case.memory is not None
    shares = [case.memory.modulus(frequency) for frequency in case.frequencies]
    lines = [str(len(shares)), *(f"{share.real!r} {share.imag!r}" for share in shares)]
    (work / "vibrations.txt").write_text("\n".join(lines) + "\n")
    c10, c01 = case.rubber.branch
    (work / "branches.txt").write_text(f"1 {c10!r} {c01!r} 1.0\n1.0 1.0\n")


def collect(
    case: Case, way: list[Waypoint], work: Path, fields: dict[int, dict[str, NDArray[np.float64]]]
) -> None:
    """Add the answers of all states of a way to their fields."""
    for number, point in enumerate(way):
        path = work / f"vibrations_{number}.txt"
        text = files.read(path, LARGEST_ROW * (len(case.frequencies) + 1))
        if point.stop is None or text is None:
            continue
        answers = np.loadtxt(text.decode().splitlines(), ndmin=2)
        if answers.shape != (len(case.frequencies), 2) or not np.isfinite(answers).all():
            raise ValueError(f"answers to vibrations of shape {answers.shape}, or not finite")
        rows = np.column_stack([case.frequencies, answers])
        fields.setdefault(point.stop, {})[DYNAMIC] = rows
