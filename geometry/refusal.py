"""How this package says no: one exception, one sentence, the same form everywhere."""

import math
from collections.abc import Mapping
from dataclasses import MISSING, fields
from numbers import Integral, Real
from typing import Any, TypeVar

T = TypeVar("T")


class Refusal(ValueError):
    """A value that cannot be used.

    Parameters
    ----------
    field : name of the value, as the caller wrote it
    value : what was given
    allowed : what would have been accepted, with its unit
    """

    def __init__(self, field: str, value: object, allowed: str) -> None:
        super().__init__(field, value, allowed)
        self.field = field
        self.value = value
        self.allowed = allowed

    def __str__(self) -> str:
        return f"{self.field} = {self.value!r} is refused; allowed: {self.allowed}"


def is_number(value: object) -> bool:
    """Whether this is a finite real number (True and False are none)."""
    if type(value) is float:  # nearly always, and the rest takes its time
        return math.isfinite(value)
    try:
        return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
    except OverflowError:  # an integer that no float can hold
        return False


def is_count(value: object) -> bool:
    """Whether this is an integer of at least 1."""
    return isinstance(value, Integral) and not isinstance(value, bool) and int(value) >= 1


def build(kind: type[T], values: object, error: type[Refusal], name: str) -> T:
    """Make the dataclass ``kind`` from a mapping whose keys are exactly its fields.

    Fields with a default may be left out. ``name`` is what the mapping is called in messages.

    Raises
    ------
    Refusal
        Of class ``error``: no mapping, an unknown key, a missing key, or what ``kind`` refuses.
    """
    known = {f.name: f for f in fields(kind)}  # type: ignore[arg-type]
    if not isinstance(values, Mapping):
        raise error(name, values, f"a mapping with the keys {', '.join(known)}")
    for key in values:
        if key not in known:
            raise error(f"{name}.{key}", values[key], f"no such key; there are {', '.join(known)}")
    for key, entry in known.items():
        if key not in values and entry.default is MISSING:
            raise error(f"{name}.{key}", None, "this key must be given")
    arguments: dict[str, Any] = {
        key: tuple(value) if isinstance(value, list) else value for key, value in values.items()
    }
    return kind(**arguments)
