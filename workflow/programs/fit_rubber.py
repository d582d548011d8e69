"""Fit a law of rubber to tests: uniaxial, equibiaxial, planar; print the material to paste."""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from geometry.readable import plain
from workflow.data import rubber_fit, rubber_tests
from workflow.data.rubber_fit import Fit
from workflow.data.rubber_tests import KINDS
from workflow.study.errors import StudyError

SMALL = 1e-6  # a strain
OF_MUSCLES = 1.8  # a wall of a muscle is stretched no more


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("files", nargs="+", type=Path, help="of stretch or strain, and stress")
    parser.add_argument("--law", required=True, help=", ".join(rubber_fit.forms()))
    tests = "of each file, if neither its name nor a column says so"
    parser.add_argument("--test", nargs="+", default=[], choices=KINDS, help=tests)
    parser.add_argument("--up-to", type=float, default=np.inf, help="largest stretch to be fitted")
    parser.add_argument("--name", default="rubber", help="of the material in the study file")
    parser.add_argument("--picture", type=Path, help=".png file; left out: NAME_LAW.png")


def run(given: argparse.Namespace) -> int:
    """Fit, print and draw."""
    from workflow.figures import rubber_fit as figure  # late: matplotlib takes a second
    from workflow.figures.style import save

    if not given.up_to > 1:
        raise StudyError(f"--up-to {given.up_to:g} is refused\n  allowed: a stretch > 1")
    picture = given.picture or Path(f"{given.name}_{given.law}.png")
    if picture.suffix != ".png" or not picture.parent.is_dir():
        raise StudyError(f"--picture {picture} is refused\n  allowed: a .png file in a folder")
    tests, said = rubber_tests.read(given.files, given.test)
    found = rubber_fit.fit(given.law, tests, given.up_to)
    for line in [*said, "", *lines(found, given.law, given.name)]:
        print(line)
    save(figure.draw(found, tests, f"{given.name}: {given.law}"), picture)
    print(f"picture: {picture}")
    return 0 if found.material is not None else 1


def lines(found: Fit, law: str, name: str) -> Iterator[str]:
    """What was found, what speaks against it, and the material."""
    yield f"{law}, least squares of nominal stress: sum of squares {plain(found.squares, 6)} MPa2"
    for key, value in found.values.items():
        numbers: list[Any] = value if isinstance(value, list) else [value]
        shown = [each if isinstance(each, str) else plain(each, 6) for each in numbers]
        yield f"  {key} = {', '.join(shown)}"
    for test in found.tests:
        off = np.abs(found.residuals[test.kind])
        mean, most = plain(np.sqrt(np.mean(off**2)), 3), plain(off.max(), 3)
        share = f"{plain(100 * off.max() / np.max(np.abs(test.stress)), 2)} %"
        yield (
            f"  {test.kind}: {len(off)} points, stretch {test.stretch.min():.4g} to "
            f"{test.stretch.max():.4g}; off by {mean} MPa in the mean square, "
            f"{most} at most, {share} of its largest stress"
        )
    yield from warnings(found)
    entry = rubber_fit.entry(found)
    if not entry:
        return
    assert found.material is not None
    yield f"initial shear modulus {plain(found.material.shear_modulus, 4)} MPa"
    written = ", ".join(f"{key}: {value}" for key, value in entry.items())
    yield "to paste into a study file:"
    yield "materials:"
    yield f"  {name}: {{{written}}}"


def warnings(found: Fit) -> Iterator[str]:
    """What speaks for or against a fit."""
    if found.material is None:
        modulus = float(found.stress("uniaxial", np.array([1 + SMALL]))[0]) / (3 * SMALL)
        yield (
            f"warning: no rubber: its initial shear modulus would be {modulus:.4g} MPa, so that it "
            "is unstable at stretch 1; fit more kinds of test, or another law"
        )
    elif found.unstable:
        where = ", ".join(f"{kind} from {at:.4g}" for kind, at in found.unstable.items())
        yield (
            f"warning: unstable by Drucker's condition at stretches {where}; a muscle there has no "
            "state, or a wrong one"
        )
    else:
        yield "stable by Drucker's condition in all three tests, as far as specimens were stretched"
    if len(found.tests) == 1:
        yield (
            f"warning: of {found.tests[0].kind} tests alone; what the law says of the others is "
            "not measured, and a wall is stretched in two directions"
        )
    if found.span[1] > 1.5 * OF_MUSCLES:
        near = [test.stretch <= OF_MUSCLES for test in found.tests]
        off = [found.residuals[t.kind][own] for t, own in zip(found.tests, near, strict=True)]
        of = [t.stress[own] for t, own in zip(found.tests, near, strict=True)]
        if sum(map(len, of)):
            share = np.sqrt(np.mean(np.concatenate(off) ** 2)) / np.max(np.abs(np.concatenate(of)))
            yield (
                f"warning: fitted up to a stretch of {found.span[1]:.4g}, of which a muscle uses "
                f"about {OF_MUSCLES:g}: there it is off by {100 * share:.2g} % of the largest "
                f"stress; --up-to {OF_MUSCLES:g} fits that"
            )
