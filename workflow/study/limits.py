"""What the materials of a muscle bear. No part of a case: nothing is solved again for a limit."""

from dataclasses import dataclass, field

from geometry.refusal import Refusal, is_number

HIGHEST = 20.0  # MPa: no pressure of such a muscle


class UnusableLimit(Refusal):
    """No limit of a material."""


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits of thread and rubber; None where they are not known.

    Attributes
    ----------
    room : what to say of threads that may not fit side by side (workflow/study/fit.py)

    Raises
    ------
    UnusableLimit
        Naming the field, its value and what is allowed.
    """

    thread_strength: float | None = field(default=None, metadata={"unit": "N"})  # tension
    stretch_limit: float | None = field(default=None, metadata={"unit": "1"})  # of the rubber
    fitted_range: tuple[float, float] | None = None  # stretches to which its law was fitted
    room: str = ""

    def __post_init__(self) -> None:
        strength, stretch = self.thread_strength, self.stretch_limit
        if not (strength is None or (is_number(strength) and strength > 0)):
            raise UnusableLimit("thread_strength", strength, "a finite number > 0 (N)")
        if not (stretch is None or (is_number(stretch) and stretch > 1)):
            allowed = "a finite number > 1, of the deformed by the first length"
            raise UnusableLimit("stretch_limit", stretch, allowed)
        if self.fitted_range is not None:
            low, high = self.fitted_range
            if not 0 < low <= 1 < high:
                allowed = "two stretches, from above 0 to 1, and > 1"
                raise UnusableLimit("fitted_range", [low, high], allowed)
