"""Load paths: what is held, what is swept, and the way there from the unloaded muscle.

A state is fixed by two of four controls. A path holds one of them and sweeps another through
its stops; between them nothing is skipped, because hyperelastic states do not depend on the way but
Newton's method does.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import IntEnum, StrEnum
from typing import Any

from geometry.plain import plain
from geometry.refusal import build, is_number
from solver.history import History, Valve
from solver.refusal import UnsolvableCase

RAMP_STEPS = 4  # a load is brought from zero to its value in so many waypoints


class Control(IntEnum):
    """What can be prescribed; the numbers are those of solver/path/control.idp."""

    CONTRACTION = 0  # 1 - l/L
    PRESSURE = 1
    FORCE = 2  # positive where the muscle pulls
    VOLUME = 3  # enclosed by the whole muscle

    @property
    def key(self) -> str:
        """Its name in study files and datasets: a force that is prescribed is a load."""
        return ("contraction", "pressure", "load", "volume")[self]

    @property
    def variable(self) -> str:
        """Its name among the variables of a state (solver/record.py)."""
        return ("contraction", "pressure", "force", "volume")[self]

    @property
    def unit(self) -> str:
        """Of its values."""
        return ("1", "MPa", "N", "mm^3")[self]

    def text(self, value: float) -> str:
        """A value as in messages: ``0.3 MPa``; a contraction in per cent."""
        return f"{100 * value:g} %" if self.unit == "1" else f"{value:g} {self.unit}"


@dataclass(frozen=True, kw_only=True)
class _Words:
    """What is said of a kind of path; see the properties of PathKind."""

    held: Control
    swept: Control
    follows: str
    zero_force: str = ""
    by_way: bool = False


class PathKind(StrEnum):
    """The three conditions of the paper."""

    ISOBARIC = "isobaric"  # pressure held, contraction swept
    ISOMETRIC = "isometric"  # contraction held, pressure swept
    ISOTONIC = "isotonic"  # load held, pressure swept

    @property
    def held(self) -> Control:
        """The control that stays as it is."""
        return WORDS[self].held

    @property
    def swept(self) -> Control:
        """The control that goes through the stops."""
        return WORDS[self].swept

    @property
    def follows(self) -> str:
        """The variable of a state that the two controls leave free, and that is asked for."""
        return WORDS[self].follows

    @property
    def zero_force(self) -> str:
        """The name of the swept value at which there is no force; empty if that is not asked."""
        return WORDS[self].zero_force

    @property
    def by_way(self) -> bool:
        """Whether states depend on the way to them.

        Then stops may turn round and repeat, and curves that differ in their stops are not one.
        """
        return WORDS[self].by_way


WORDS = {
    PathKind.ISOBARIC: _Words(
        held=Control.PRESSURE,
        swept=Control.CONTRACTION,
        follows="force",
        zero_force="free_contraction",
    ),
    PathKind.ISOMETRIC: _Words(
        held=Control.CONTRACTION,
        swept=Control.PRESSURE,
        follows="force",
        zero_force="threshold_pressure",
    ),
    PathKind.ISOTONIC: _Words(held=Control.FORCE, swept=Control.PRESSURE, follows="contraction"),
}
ZERO_FORCE = {kind.zero_force: kind for kind in PathKind if kind.zero_force}
CONTRACTION_LIMITS = (-0.5, 0.6)


@dataclass(frozen=True)
class Waypoint:
    """A state on the way: two controls and their targets. ``stop`` is its place in the record."""

    first: Control
    first_target: float
    second: Control
    second_target: float
    stop: int | None = None


@dataclass(frozen=True, kw_only=True)
class LoadPath:
    """One curve: a control held, another swept through ``stops``.

    With ``zero_force`` the state of zero force on the curve is looked for as well (on an
    isometric path the threshold pressure, on an isobaric one the free contraction;
    solver/zero_force.py); it is the record's last state. With a ``history`` the stops are passed in
    time, and may turn round. Units by kind: contraction as a fraction, pressure in MPa, load in N.

    Raises
    ------
    UnsolvableCase
        If a number is not finite, a pressure negative, the stops not rising, or there are none.
    """

    kind: PathKind
    held: float
    stops: tuple[float, ...]
    zero_force: bool = field(default=False)
    history: History | None = None

    def __post_init__(self) -> None:
        if self.kind not in list(PathKind):
            raise UnsolvableCase("kind", self.kind, ", ".join(PathKind))
        object.__setattr__(self, "kind", PathKind(self.kind))
        if not isinstance(self.stops, tuple) or not self.stops:
            raise UnsolvableCase("stops", self.stops, "a list of at least one value")
        if not isinstance(self.zero_force, bool):
            raise UnsolvableCase("zero_force", self.zero_force, "true or false")
        for name, control, values in (
            ("held", self.kind.held, (self.held,)),
            ("stops", self.kind.swept, self.stops),
        ):
            for value in values:
                _check(name, control, value)
        falls = any(b <= a for a, b in zip(self.stops, self.stops[1:], strict=False))
        if falls and not self.by_way:
            raise UnsolvableCase("stops", self.stops, "rising values, each given once")
        if self.zero_force and not self.kind.zero_force:
            allowed = f"an {' or '.join(ZERO_FORCE.values())} path"
            raise UnsolvableCase("zero_force", True, allowed)
        if self.history is not None:
            self._check_history(self.history)

    def _check_history(self, history: History) -> None:
        if self.zero_force:
            allowed = "false in time: the way to no force is no part of the history"
            raise UnsolvableCase("zero_force", True, allowed)
        if len(history.times) != len(self.stops):
            allowed = f"as many as stops, {len(self.stops)}"
            raise UnsolvableCase("times", len(history.times), allowed)
        if history.held is not None:
            if len(history.held) != len(self.stops) or history.held[0] != self.held:
                allowed = f"{len(self.stops)} values, the first {self.held:g}"
                raise UnsolvableCase("held", list(history.held), allowed)
            for value in history.held:
                _check("held", self.kind.held, value)
        controls = self.kind.held, self.kind.swept
        if history.mass and Control.FORCE not in controls:
            allowed = "0 where the length is prescribed; a mass on an isotonic path (kg)"
            raise UnsolvableCase("mass", history.mass, allowed)
        if history.valve is not None and self.kind.swept is not Control.PRESSURE:
            allowed = "none where the pressure of the muscle is held"
            raise UnsolvableCase("valve", history.valve.conductance, allowed)

    @property
    def by_way(self) -> bool:
        """Whether states depend on the way to them."""
        return self.kind.by_way or self.history is not None

    def as_dict(self) -> dict[str, Any]:
        """Plain values; of a path out of time without a history."""
        values = plain(self)
        if self.history is None:
            del values["history"]
        return values

    @classmethod
    def from_dict(cls, values: object) -> "LoadPath":
        """The path of a plain mapping as ``as_dict`` makes it."""
        given = dict(values) if isinstance(values, Mapping) else values
        if isinstance(given, dict) and given.get("history") is not None:
            history = given["history"]
            if isinstance(history, Mapping) and history.get("valve") is not None:
                valve = build(Valve, history["valve"], UnsolvableCase, "path.history.valve")
                history = {**history, "valve": valve}
            given["history"] = build(History, history, UnsolvableCase, "path.history")
        return build(cls, given, UnsolvableCase, "path")

    @property
    def start(self) -> "LoadPath":
        """Of a path in time, the one to its first stop, out of time."""
        return replace(self, stops=self.stops[:1], history=None)

    @property
    def units(self) -> dict[str, str]:
        """Of the numbers, which go with the kind."""
        return {"held": self.kind.held.unit, "stops": self.kind.swept.unit}

    @property
    def states(self) -> int:
        """Number of recorded states."""
        return len(self.stops) + self.zero_force

    def ways(self, *, rubber: bool = True) -> list[list[Waypoint]]:
        """Ways from the unloaded muscle through every stop; a second for what the first missed.

        On an isometric path a slack tube would crumple, so it is pressurised first and the pressure
        then lowered; but where the highest pressure cannot be reached, what lies below it can from
        the side of the slack tube. Under a load the pressure rises from zero; but a net without
        ``rubber`` closes there: it is pressurised and loaded first and the pressure then lowered.
        """
        if self.kind is PathKind.ISOBARIC:
            return [self._isobaric()]
        if self.kind is PathKind.ISOMETRIC:
            return [self._isometric_falling(), self._isometric_rising()]
        return [self._isotonic_rising() if rubber else self._isotonic_falling()]

    def _isobaric(self) -> list[Waypoint]:
        """Pressure first, then shorter from the initial length; longer before, and back."""
        way = _pressurise(self.held)
        if self.zero_force and not way:  # the unloaded muscle is on the curve
            way.append(Waypoint(Control.PRESSURE, 0.0, Control.CONTRACTION, 0.0))
        shorter = [(k, e) for k, e in enumerate(self.stops) if e >= 0]
        longer = [(k, e) for k, e in enumerate(self.stops) if e < 0][::-1]
        home: list[tuple[int | None, float]] = [(None, 0.0)] if longer and shorter else []
        for stop, contraction in [*longer, *home, *shorter]:
            way.append(
                Waypoint(Control.PRESSURE, self.held, Control.CONTRACTION, contraction, stop)
            )
        return way

    def _isometric_falling(self) -> list[Waypoint]:
        """Pressure first, then contraction, then the pressure down."""
        top = self.stops[-1]
        down = [
            Waypoint(Control.CONTRACTION, self.held, Control.PRESSURE, p, stop)
            for stop, p in reversed(list(enumerate(self.stops)))
        ]
        return [*_pressurise(top), *self._contract(top), *down]

    def _isometric_rising(self) -> list[Waypoint]:
        """Contraction first, then the pressure up."""
        up = [
            Waypoint(Control.CONTRACTION, self.held, Control.PRESSURE, p, stop)
            for stop, p in enumerate(self.stops)
        ]
        return [*self._contract(0.0), *up]

    def way_back(self) -> list[Waypoint]:
        """The stops of an isobaric path from the other side: pressurised when already shortened."""
        last = self.stops[-1]
        shortened = replace(self, kind=PathKind.ISOMETRIC, held=last, stops=(self.held,))
        return [
            *shortened._contract(0.0),
            *(
                Waypoint(Control.CONTRACTION, last, Control.PRESSURE, self.held * k / RAMP_STEPS)
                for k in range(1, RAMP_STEPS + 1)
            ),
            *(
                Waypoint(Control.PRESSURE, self.held, Control.CONTRACTION, contraction, stop)
                for stop, contraction in reversed(list(enumerate(self.stops)))
            ),
        ]

    def way_from(self, near: float) -> list[Waypoint]:
        """Through all stops from a state of the curve that lies beyond one of their ends."""
        stops = list(enumerate(self.stops))
        held, swept = self.kind.held, self.kind.swept
        nearest_first = stops if near < self.stops[0] else stops[::-1]
        return [Waypoint(held, self.held, swept, value, stop) for stop, value in nearest_first]

    def way_from_above(self, pressure: float) -> list[Waypoint]:
        """On an isometric path: to the held contraction at a pressure above all stops."""
        return [*_pressurise(pressure), *self._contract(pressure)]

    def _contract(self, pressure: float) -> list[Waypoint]:
        """From the initial length to the held contraction, at a pressure."""
        return [
            Waypoint(Control.PRESSURE, pressure, Control.CONTRACTION, self.held * k / RAMP_STEPS)
            for k in range(1, RAMP_STEPS + 1)
            if self.held != 0
        ]

    def _isotonic_rising(self) -> list[Waypoint]:
        """The load first, on the muscle without pressure, then the pressure up."""
        return [*self._load(0.0), *self._pressures_under_load()]

    def _isotonic_falling(self) -> list[Waypoint]:
        """The highest pressure first, then the load, then the pressure down."""
        top = self.stops[-1]
        return [*_pressurise(top), *self._load(top), *self._pressures_under_load()[::-1]]

    def _load(self, pressure: float) -> list[Waypoint]:
        return [
            Waypoint(Control.PRESSURE, pressure, Control.FORCE, self.held * k / RAMP_STEPS)
            for k in range(1, RAMP_STEPS + 1)
        ]

    def _pressures_under_load(self) -> list[Waypoint]:
        return [
            Waypoint(Control.FORCE, self.held, Control.PRESSURE, p, stop)
            for stop, p in enumerate(self.stops)
        ]


def _pressurise(pressure: float) -> list[Waypoint]:
    """From zero to a pressure at the initial length."""
    return [
        Waypoint(Control.CONTRACTION, 0.0, Control.PRESSURE, pressure * k / RAMP_STEPS)
        for k in range(1, RAMP_STEPS + 1)
        if pressure != 0
    ]


def _check(name: str, control: Control, value: float) -> None:
    if not is_number(value):
        raise UnsolvableCase(name, value, "a finite number")
    low, high = CONTRACTION_LIMITS
    if control is Control.CONTRACTION and not low <= value <= high:
        raise UnsolvableCase(name, value, f"a contraction from {low} to {high}, as a fraction")
    if control is Control.PRESSURE and value < 0:
        raise UnsolvableCase(name, value, "a pressure >= 0 (MPa)")
