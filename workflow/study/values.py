"""Values of a factor: a list, or a grid ``{from: 0, to: 0.25, step: 0.01}`` in exact decimals.

One value is a list of one.
"""

from collections.abc import Mapping
from decimal import Decimal
from itertools import pairwise
from typing import TypeGuard

from geometry.refusal import is_number

MOST = 1000  # values of one factor: more is a typing error in the step
KEYS = ("from", "to", "step")
ALLOWED = "a list of finite numbers, or a grid {from: 0, to: 0.25, step: 0.01}"
SMALLEST, LARGEST = 1e-12, 1e12  # sizes of a number; no quantity is beyond, in any unit
POSSIBLE = f"a finite number, 0 or of a size from {SMALLEST:g} to {LARGEST:g}"


def is_possible(value: object) -> TypeGuard[float]:
    """Whether this is a number that a quantity can have."""
    if not (isinstance(value, int | float) and is_number(value)):
        return False
    return value == 0 or SMALLEST <= abs(value) <= LARGEST


def expand(given: object) -> tuple[float, ...]:
    """The values, rising.

    The k-th value of a grid is the double nearest to the decimal number, so that 0.07 is 0.07 and
    not 0.07000000000000001. The order of a list means nothing.

    Raises
    ------
    ValueError
        If there are no values, one is given twice or is no finite number, or the grid does not
        end where it should.
    """
    if isinstance(given, Mapping):
        values = _grid(given)
    else:
        values = _list(given if isinstance(given, list) else [given])
    if not values:
        raise ValueError("at least one value")
    for below, above in pairwise(values):
        if below == above:
            raise ValueError(f"every value once; {below:g} is there twice")
    return values


def _list(given: list[object]) -> tuple[float, ...]:
    if len(given) > MOST:
        raise ValueError(f"at most {MOST} values, not {len(given)}")
    values = [value for value in given if is_possible(value)]
    if len(values) < len(given):
        wrong = next(value for value in given if not is_possible(value))
        raise ValueError(f"{ALLOWED}; not {wrong!r:.40}")
    return tuple(sorted(float(value) + 0.0 for value in values))  # + 0.0: no negative zero


def _grid(given: Mapping[str, object]) -> tuple[float, ...]:
    if set(given) != set(KEYS):
        raise ValueError(f"a grid with exactly the keys {', '.join(KEYS)}")
    for key in KEYS:
        if not is_possible(given[key]):
            raise ValueError(f"a grid of finite numbers; {key} is {given[key]!r:.40}")
    start, end, step = (Decimal(str(given[key])) for key in KEYS)
    if step <= 0:
        raise ValueError(f"a grid with a step above 0, not {step}")
    if end < start:
        raise ValueError(f"a grid that rises, not from {start} to {end}")
    count = (end - start) / step
    if count != int(count):
        raise ValueError(f"a grid whose steps of {step} lead from {start} exactly to {end}")
    if count >= MOST:
        raise ValueError(f"a grid of at most {MOST} values, not {int(count) + 1}")
    return tuple(float(start + step * k) for k in range(int(count) + 1))
