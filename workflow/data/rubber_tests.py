"""Tests of a rubber: nominal stress against stretch, uniaxial, equibiaxial or planar.

The files may be written in any usual way (workflow/data/measured.py), with strain in place of
stretch and true in place of nominal stress. Of which test a row is says a column ``test``, the name
of the file, or the caller.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from solver.rubber.rubber_law import RubberLaw
from workflow.data import headers, measured
from workflow.data.measured import Table
from workflow.study.errors import StudyError, shown

Array = NDArray[np.float64]
UNIAXIAL, EQUIBIAXIAL, PLANAR = KINDS = ("uniaxial", "equibiaxial", "planar")
WORDS = {  # how they are called, in names of files and cells of a column
    UNIAXIAL: r"uni-?axial|simple[ _-]?tension|tensile|tension|zug(versuch)?|ut|uni",
    EQUIBIAXIAL: r"(equi-?)?-?bi-?axial|bulge|inflation|et|eb|ebt|bt|bi",
    PLANAR: r"planar|pure[ _-]?shear|shear|ps|pt",
}
SMALLEST, LARGEST = 0.2, 15.0  # stretches of a rubber
SOFTEST, HARDEST = 1e-4, 200.0  # MPa, of the largest stress


@dataclass(frozen=True, eq=False)
class RubberTest:
    """One kind of test: stretch [1] and nominal stress [MPa] of all its points."""

    kind: str
    stretch: Array
    stress: Array


def squares(kind: str, stretch: Array) -> tuple[Array, Array]:
    """Squared stretches in the plane of a specimen: along the stress, and across it."""
    a = stretch**2
    across = {UNIAXIAL: 1 / stretch, EQUIBIAXIAL: a, PLANAR: np.ones_like(a)}
    return a, across[kind]


def stress(law: RubberLaw, kind: str, stretch: Array) -> Array:
    """Nominal stress of an incompressible rubber [MPa]; none through the thickness."""
    a, b = squares(kind, stretch)
    along: Array = law.slopes(a, b, np.zeros_like(a))[0]  # type: ignore[arg-type]
    return 2 * stretch * along


def read(paths: Sequence[Path], kinds: Sequence[str] = ()) -> tuple[list[RubberTest], list[str]]:
    """All tests of some files, and what was understood of them.

    ``kinds`` says of which test each file is; without, its column ``test`` or its name does.

    Raises
    ------
    StudyError
        If a file cannot be read, its test is not known, or its values look wrong.
    """
    if kinds and len(kinds) != len(paths):
        raise StudyError(f"{len(kinds)} tests for {len(paths)} files\n  allowed: one for each file")
    found: dict[str, list[tuple[Array, Array]]] = {}
    said: list[str] = []
    for number, path in enumerate(paths):
        table = measured.read(path, headers.OF_RUBBER)
        stretch, nominal, lines = _curve(table)
        said += [f"{path}: {table.how}", *lines]
        rows = np.isfinite(stretch) & np.isfinite(nominal)
        if not rows.any():
            raise table.refuse("there is no stress in it")
        of_rows = _kinds(table, kinds[number] if kinds else "")
        _check(table, stretch[rows], nominal[rows])
        for kind in KINDS:
            own = rows & (of_rows == kind)
            if own.any():
                found.setdefault(kind, []).append((stretch[own], nominal[own]))
        said.append(f"{rows.sum()} of {len(rows)} points used")
    tests = [
        RubberTest(kind, *map(np.concatenate, zip(*found[kind], strict=True)))
        for kind in KINDS
        if kind in found
    ]
    return tests, said


def _curve(table: Table) -> tuple[Array, Array, list[str]]:
    """Stretch and nominal stress of a table."""
    if "stress" not in table.columns:
        raise table.refuse(f"the column stress is missing; there are {_there(table)}")
    place = next((q for q in ("stretch", "strain") if q in table.columns), None)
    if place is None:
        raise table.refuse(f"the column stretch or strain is missing; there are {_there(table)}")
    values, nominal = table.numbers(place), table.numbers("stress")
    said = [table.said(place, values), table.said("stress", nominal)]
    column = table.columns[place]
    if place == "stretch":
        stretch = values
        if np.nanmin(values) < SMALLEST:
            raise table.refuse(
                f"stretches from {np.nanmin(values):.4g} under {column.name}: at rest it is 1; "
                "perhaps strains"
            )
    elif column.header.is_true:
        stretch = np.exp(values)
        said.append("strains are logarithmic")
    else:
        stretch = 1 + values
    if np.nanmax(stretch) > LARGEST:
        guess = "another unit" if column.header.unit else "%"
        raise table.refuse(
            f"values up to {np.nanmax(values):.4g} under {column.name} are too large; perhaps they "
            f"are in {guess}"
        )
    if table.columns["stress"].header.is_true:
        nominal = nominal / stretch
        said.append("stresses are true ones, divided by the stretch")
    return stretch, nominal, said


def _check(table: Table, stretch: Array, nominal: Array) -> None:
    """Stresses of a rubber, of the sign of its strain."""
    name, largest = table.columns["stress"].name, float(np.max(np.abs(nominal)))
    if not SOFTEST <= largest <= HARDEST:
        raise table.refuse(
            f"stresses up to {largest:.4g} MPa under {name} are not of a rubber; perhaps another "
            "unit"
        )
    if np.sum(nominal * (stretch - 1)) <= 0:
        raise table.refuse(
            f"stresses under {name} are against the strain; perhaps their sign is the other"
        )


def _kinds(table: Table, given: str) -> NDArray[np.str_]:
    """The kind of test of every row."""
    if "test" in table.columns and not given:
        found = []
        for cell, line in zip(table.texts("test"), table.lines, strict=True):
            kind = kind_of(cell)
            if not kind:
                raise table.refuse(f"no test {shown(cell)}; allowed: {', '.join(KINDS)}", line)
            found.append(kind)
        return np.array(found)
    kind = given or kind_of(table.path.stem)
    if not kind:
        raise table.refuse(
            "of which test it is says neither a column test nor its name; "
            f"allowed: {', '.join(KINDS)}"
        )
    return np.full(len(table.rows), kind)


def kind_of(text: str) -> str:
    """The test that a text names; empty if none or several."""
    text = f" {text.strip().lower()} ".replace("_", " ").replace(".", " ")
    found = [kind for kind, words in WORDS.items() if re.search(rf"[\s-]({words})[\s-]", text)]
    return found[0] if len(found) == 1 else ""


def _there(table: Table) -> str:
    named = [column.name for column in table.columns.values()]
    return ", ".join([*named, *map(shown, table.unused)])
