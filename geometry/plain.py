"""A dataclass as plain values."""

from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any


def plain(part: Any) -> dict[str, Any]:
    """Its fields by name, those that are dataclasses in the same way.

    As ``dataclasses.asdict``, but other values are not copied: a study of ten thousand muscles asks
    for a million of them.
    """
    kind: Any = type(part)
    values = {name: getattr(part, name) for name in _names(kind)}
    for name, value in values.items():
        if is_dataclass(value):
            values[name] = plain(value)
    return values


@cache
def _names(kind: Any) -> tuple[str, ...]:
    return tuple(each.name for each in fields(kind))
