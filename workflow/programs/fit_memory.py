"""Fit the memory of a muscle's rubber to a measured loop or relaxation; print it to paste."""

import argparse
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from geometry.readable import plain
from solver.history import Start
from workflow.programs import add_study
from workflow.study.errors import StudyError

if TYPE_CHECKING:
    from workflow.answers.memory_fit import MemoryFit


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("file", help="of times, pressures, lengths or contractions, and forces")
    parser.add_argument("--muscle", required=True, help="its name in the study file")
    parser.add_argument("--model", default="membrane", help="what computes it")
    start = "whether it had been at the first row for long, or came there at once"
    parser.add_argument("--start", choices=list(Start), default=Start.RELAXED.value, help=start)
    parser.add_argument("--picture", type=Path, help=".png file; left out: MUSCLE_memory.png")
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Fit, print and draw."""
    from workflow.answers import memory_fit
    from workflow.answers.studies import with_muscle
    from workflow.figures import memory_fit as figure  # late: matplotlib takes a second
    from workflow.figures.style import save

    picture = given.picture or Path(f"{given.muscle}_memory.png")
    if picture.suffix != ".png" or not picture.parent.is_dir():
        raise StudyError(f"--picture {picture} is refused\n  allowed: a .png file in a folder")
    study = with_muscle(given.study, given.muscle)
    with tempfile.TemporaryDirectory() as scratch:
        found = memory_fit.fit(
            study,
            given.muscle,
            given.file,
            Path(scratch),
            model=given.model,
            start=Start(given.start),
        )
    material = study.muscles[given.muscle].material
    for line in lines(found, given.model, material):
        print(line)
    what = found.times, found.pressure, found.contraction, found.measured, found.fitted
    save(figure.draw(*what, f"{given.muscle}: {100 * found.per_decade:.3g} % a decade"), picture)
    print(f"picture: {picture}")
    return 0


def lines(found: "MemoryFit", model: str, material: str) -> Iterator[str]:
    """How it was read, what was found, what speaks against it, and the entry."""
    yield from found.said
    low, high = found.memory.times[0], found.memory.times[-1]
    yield (
        f"{model}, {len(found.times)} rows: relaxation of {found.per_decade:.4g} +- "
        f"{found.interval:.2g} (95 %) of the long-term stiffness per decade, {low:g} to {high:g} s"
    )
    span = found.measured.max() - found.measured.min()
    yield (
        f"left in the mean square: {plain(found.residual, 3)} N, "
        f"{100 * found.residual / span if span else 0:.2g} % of the range of the forces"
    )
    shown = ", ".join(f"{name} {plain(value, 4)}" for name, value in found.curve.items())
    yield f"taken off as elastic (N, by contraction and MPa): {shown}"
    for note in found.notes:
        yield f"warning: {note}"
    yield "to paste into a study file:"
    yield "materials:"
    share = found.per_decade
    yield f"  {material}: {{..., memory: {{per_decade: {share:.4g}, from: {low:g}, to: {high:g}}}}}"
