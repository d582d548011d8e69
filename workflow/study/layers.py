"""Layers of threads as a study file lists them: what each is, resolved and put together as a braid.

A layer is ``embedded`` at a depth, or a ``sleeve`` around the tube. What it does not say of its
threads it takes from its muscle. A sleeve may be given as it was braided, with a free radius and
length of its own: drawn over a muscle of another length it has the angle a' with cos a' = cos a
L / L_f, as its threads keep their length, and with their turns the radius R_f sin a' / sin a.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from geometry.braid import AnyBraid, Braid, Kind, Layer, LayeredBraid
from geometry.muscle import Muscle
from geometry.refusal import is_number
from workflow.study import checks, fit
from workflow.study.errors import StudyError
from workflow.study.schema import SENSES

EA, MODULUS, DIAMETER = "thread_stiffness", "thread_modulus", "thread_diameter"
ANGLES = ("lead", "angle", "angle_of")  # exactly one of them
NARROWEST, WIDEST = 0.5, 3.0  # free radius of a sleeve / outer radius of the tube
OF_SLEEVE = ("gap", "free_radius", "free_length", "crimp_radius")
SAME = 1e-9

Refuse = Callable[[int, str, object, str], StudyError]  # of a layer: key, value, what is allowed


@dataclass(frozen=True, kw_only=True)
class Wound:
    """A layer on its muscle: shape, threads, and EA and diameter of one of these."""

    kind: Kind
    diameter: float
    lead: float
    threads: int
    sense: int
    stiffness: float
    thread_diameter: float | None
    crimp: float = 0.0  # radius of a collar that is wider than the tube

    def layer(self) -> Layer:
        """A family of it, for what is asked of its shape alone."""
        return Layer(
            kind=self.kind,
            carrier=self.diameter / 2,
            radius=self.diameter / 2,
            lead=self.lead,
            threads=self.threads,
            sense=self.sense or 1,
        )


def resolved(
    number: int, own: Mapping[str, Any], common: Mapping[str, Any], tube: Muscle, refuse: Refuse
) -> Wound:
    """A layer, by its own entry and what its muscle has for all.

    ``common`` has the angle [rad] of ``angle_of`` in place of a name.

    Raises
    ------
    StudyError
        Made by ``refuse``.
    """
    kind = Kind(own["kind"])
    for key in ("depth",) if kind is Kind.SLEEVE else OF_SLEEVE:
        if key in own:
            raise refuse(number, key, own[key], f"this key is not used by kind: {kind}")
    if "sense" not in own and kind is Kind.EMBEDDED:
        allowed = (
            f"{', '.join(SENSES)}; two layers in the wall are one of each, as `layer_depths` says"
        )
        raise refuse(number, "sense", None, allowed)
    threads = own.get("threads", common.get("threads"))
    if threads is None:
        raise refuse(number, "threads", None, "this key must be given, here or for the muscle")
    place = _depth if kind is Kind.EMBEDDED else _free_radius
    radius = place(number, own, tube, refuse)
    tangent, lead = _wound(number, own, common, radius, refuse)
    radius, lead = _drawn(number, own, tube, (radius, tangent, lead), refuse)
    crimp = _crimp(number, own, tube, radius, refuse) if kind is Kind.SLEEVE else 0.0
    ea, width = _thread(number, own, common, refuse)
    made = Wound(
        kind=kind,
        diameter=float(2 * Decimal(str(radius))),
        lead=lead,
        threads=threads,
        sense=SENSES[own.get("sense", "both")],
        stiffness=ea,
        thread_diameter=width,
        crimp=crimp,
    )
    for allowed in checks.angle(math.atan(made.layer().tangent)):
        said = own if any(key in own for key in ANGLES) else common
        key = next(key for key in ANGLES if key in said)
        raise refuse(number, key, said[key], allowed)
    return made


def braid(layers: Sequence[Wound]) -> AnyBraid:
    """The braid of some layers: two in the wall that are alike are that of the paper."""
    most = max(layer.stiffness for layer in layers)
    if _is_of_paper(layers):
        inner, outer = layers
        return Braid(
            lead=inner.lead,
            threads=inner.threads,
            layer_diameters=(inner.diameter, outer.diameter),
        )
    return LayeredBraid(
        kinds=tuple(str(layer.kind) for layer in layers),
        layer_diameters=tuple(layer.diameter for layer in layers),
        leads=tuple(layer.lead for layer in layers),
        threads=tuple(layer.threads for layer in layers),
        senses=tuple(layer.sense for layer in layers),
        stiffness_shares=tuple(layer.stiffness / most for layer in layers),
        crimp_radii=tuple(layer.crimp for layer in layers)
        if any(each.crimp for each in layers)
        else (),
    )


def thread(given: Mapping[str, Any]) -> tuple[float | None, float | None, str, str]:
    """EA and diameter of a thread by its keys; and which key is refused, and why, if one is."""
    ea, modulus, width = (given.get(key) for key in (EA, MODULUS, DIAMETER))
    either = f"{EA}, or {MODULUS} and {DIAMETER}"
    if modulus is None:
        return ea, width, "" if ea is not None else EA, f"this key must be given; or {MODULUS}"
    if ea is not None:
        return ea, width, MODULUS, f"not beside {EA}; {either}"
    if width is None:
        return ea, width, DIAMETER, f"this key must be given beside {MODULUS}"
    for key, value, unit in ((MODULUS, modulus, "MPa"), (DIAMETER, width, "mm")):
        if not (is_number(value) and value > 0):
            return ea, width, key, f"a finite number > 0 ({unit})"
    return fit.stiffness(modulus, width), width, "", ""


def _is_of_paper(layers: Sequence[Wound]) -> bool:
    if [(layer.kind, layer.sense) for layer in layers] != [(Kind.EMBEDDED, 1), (Kind.EMBEDDED, -1)]:
        return False
    inner, outer = layers
    alike = inner.threads == outer.threads and inner.diameter < outer.diameter
    pairs = (inner.lead, outer.lead), (inner.stiffness, outer.stiffness)
    return alike and all(math.isclose(*pair, rel_tol=SAME) for pair in pairs)


def _depth(number: int, own: Mapping[str, Any], tube: Muscle, refuse: Refuse) -> float:
    """Radius of an embedded layer, in exact decimals [mm]."""
    depth = own.get("depth")
    if depth is None:
        raise refuse(number, "depth", None, "this key must be given with kind: embedded")
    if not 0 < depth < tube.wall_thickness:
        allowed = f"more than 0 and less than the wall thickness of {tube.wall_thickness:g} (mm)"
        raise refuse(number, "depth", depth, allowed)
    return float(Decimal(str(tube.inner_diameter)) / 2 + Decimal(str(depth)))


def _free_radius(number: int, own: Mapping[str, Any], tube: Muscle, refuse: Refuse) -> float:
    """Radius at which the threads of a sleeve have their free length [mm]."""
    key = "free_radius" if "free_radius" in own else "gap"
    if key == "free_radius" and "gap" in own:
        raise refuse(number, "gap", own["gap"], "not beside free_radius: it says the same")
    outer = float(Decimal(str(tube.inner_diameter)) / 2 + Decimal(str(tube.wall_thickness)))
    gap = own.get("gap", 0.0)
    free = own.get("free_radius", float(Decimal(str(outer)) + Decimal(str(gap))))
    if not NARROWEST * outer <= free <= WIDEST * outer:
        low, high = NARROWEST * outer, WIDEST * outer
        if key == "gap":
            low, high = low - outer, high - outer
        allowed = f"from {low:.4g} to {high:.4g} (mm): the tube's outer radius is {outer:g}"
        raise refuse(number, key, own[key], allowed)
    return float(free)


def _crimp(
    number: int, own: Mapping[str, Any], tube: Muscle, radius: float, refuse: Refuse
) -> float:
    """Radius of the collar of a sleeve of some radius; 0 if it is as wide as the tube [mm]."""
    outer = tube.outer_radius
    crimped = own.get("crimp_radius", outer)
    if math.isclose(crimped, outer, rel_tol=SAME):
        return 0.0
    if not outer < crimped <= radius * (1 + SAME):
        allowed = (
            f"from {outer:g}, the tube's outer radius, to {max(radius, outer):.6g}, that of the "
            "sleeve at the muscle's length (mm)"
        )
        raise refuse(number, "crimp_radius", crimped, allowed)
    return float(crimped)


def _wound(
    number: int, own: Mapping[str, Any], common: Mapping[str, Any], radius: float, refuse: Refuse
) -> tuple[float, float]:
    """Tangent of the angle, and lead, of threads at a radius."""
    given = [key for key in ANGLES if key in own]
    values = own if given else common
    given = given or [key for key in ANGLES if key in common]
    if len(given) != 1:
        key = given[1] if given else "angle"
        allowed = "exactly one of lead, angle, here or for the muscle"
        raise refuse(number, key, values.get(key), allowed)
    key, value = given[0], values[given[0]]
    circumference = 2 * math.pi * radius
    if key == "lead":
        if not value > 0:
            raise refuse(number, key, value, "a finite number > 0 (mm)")
        return circumference / value, float(value)
    if key == "angle" and not 0 < value < 90:
        raise refuse(number, key, value, "more than 0 and less than 90 (degrees)")
    tangent = math.tan(math.radians(value) if key == "angle" else value)
    return tangent, circumference / tangent


def _drawn(
    number: int,
    own: Mapping[str, Any],
    tube: Muscle,
    free: tuple[float, float, float],
    refuse: Refuse,
) -> tuple[float, float]:
    """Radius and lead of a sleeve on its muscle, from those that it was braided with [mm]."""
    radius, tangent, lead = free
    length = own.get("free_length")
    if length is None:
        return radius, lead
    if not length > 0:
        raise refuse(number, "free_length", length, "a finite number > 0 (mm)")
    cosine = math.cos(math.atan(tangent)) * tube.length / length
    outer = tube.outer_radius
    drawn = radius * math.sqrt(max(1 - cosine**2, 0)) / math.sin(math.atan(tangent))
    if not (cosine < 1 and NARROWEST * outer <= drawn <= WIDEST * outer):
        allowed = (
            f"a length from which it can be drawn to the {tube.length:g} mm of the muscle, and is "
            f"then from {NARROWEST * outer:.4g} to {WIDEST * outer:.4g} mm in radius"
        )
        raise refuse(number, "free_length", length, allowed)
    steeper = math.sqrt(1 - cosine**2) / cosine
    return drawn, 2 * math.pi * drawn / steeper


def _thread(
    number: int, own: Mapping[str, Any], common: Mapping[str, Any], refuse: Refuse
) -> tuple[float, float | None]:
    """EA and diameter of a thread [N, mm]."""
    has_own = any(key in own for key in (EA, MODULUS))
    keys = (EA, MODULUS) if not has_own else ()
    given = {key: common[key] for key in (*keys, DIAMETER) if key in common}
    given |= {key: own[key] for key in (EA, MODULUS, DIAMETER) if key in own}
    ea, width, key, allowed = thread(given)
    if key:
        raise refuse(number, key, given.get(key), allowed)
    assert ea is not None  # else a key is blamed
    if not ea > 0:
        raise refuse(number, EA, ea, "a finite number > 0 (N)")
    return ea, width
