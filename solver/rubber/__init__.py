"""Laws of rubber, one folder each, and what those share that are functions of two invariants.

``LAWS`` finds them by their folders. A law is imported when it is asked for by its name, and the
others are not; going through all of them imports all.
"""

from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from geometry.refusal import build
from solver.refusal import UnsolvableCase
from solver.rubber.rubber_law import RubberLaw

DATA = ("solver/rubber/*/law.py",)  # found by name


class _Laws(Mapping[str, type[RubberLaw]]):
    """Laws by name."""

    def __getitem__(self, name: str) -> type[RubberLaw]:
        if name not in self:
            raise KeyError(name)
        found: type[RubberLaw] = import_module(f"{__name__}.{name}.law").LAW
        return found

    def __contains__(self, name: object) -> bool:
        is_name = isinstance(name, str) and name.isidentifier()
        return is_name and any((Path(room) / str(name) / "law.py").is_file() for room in __path__)

    def __iter__(self) -> Iterator[str]:
        found = (path for room in __path__ for path in Path(room).glob("*/law.py"))
        return iter(sorted(path.parent.name for path in found))

    def __len__(self) -> int:
        return len(list(iter(self)))


LAWS: Mapping[str, type[RubberLaw]] = _Laws()


def default() -> type[RubberLaw]:
    """The law of a rubber that names none."""
    return next(law for law in LAWS.values() if law.unnamed)


def from_dict(values: object) -> RubberLaw:
    """The rubber of a plain mapping as ``RubberLaw.as_dict`` makes it.

    Raises
    ------
    UnsolvableCase
        If there is no such law, or its parameters are not right.
    """
    if not (isinstance(values, Mapping) and "law" in values):
        return build(default(), values, UnsolvableCase, "rubber")
    name = values["law"]
    if name not in LAWS:
        raise UnsolvableCase("rubber.law", name, ", ".join(LAWS))
    own = {key: value for key, value in values.items() if key != "law"}
    return build(LAWS[name], own, UnsolvableCase, "rubber")


def anything() -> dict[str, Any]:
    """A rubber that can be built, for cases that read none."""
    return {p.name: p.usual[1] for p in default().parameters()}
