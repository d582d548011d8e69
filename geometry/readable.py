"""Numbers as people read them."""

import numpy as np

SMALLEST = 1e-6  # below it zeros would have to be counted


def plain(value: float, digits: int) -> str:
    """A number of so many digits at most, without an exponent: 12350, 0.00002.

    Sizes below ``SMALLEST`` keep theirs: 3e-09. Not for files, which have all digits.
    """
    if 0 < abs(value) < SMALLEST:
        return f"{value:.{digits}g}"
    shown = np.format_float_positional(value, digits, unique=False, fractional=False, trim="-")
    return str(shown)
