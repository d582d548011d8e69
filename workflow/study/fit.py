"""Whether the threads of a layer fit side by side: count times diameter, around the tube."""

import math
from collections.abc import Sequence

from geometry.braid import Layer
from geometry.refusal import Refusal, is_number

STIFFEST = 130e3  # MPa, of any fibre that a muscle is braided of


def widest(layers: Sequence[Layer]) -> float:
    """Diameter of the widest threads that fit into all of these layers [mm]."""
    return min(
        2 * math.pi * layer.radius * math.cos(math.atan(layer.tangent)) / layer.threads
        for layer in layers
    )


def diameter(stiffness: float, modulus: float) -> float:
    """Diameter of a round thread of a stiffness EA and a modulus [mm]."""
    return math.sqrt(4 * stiffness / (math.pi * modulus))


def stiffness(modulus: float, diameter: float) -> float:
    """EA of a round thread [N]."""
    return modulus * math.pi * diameter**2 / 4


def check(layers: Sequence[Layer], stiffness: float, given: float | None) -> None:
    """Refuse threads that are wider than the tube has room for.

    Raises
    ------
    Refusal
        Naming ``thread_diameter`` if that is given, else ``threads``: then they would not fit if
        they were of the stiffest fibre.
    """
    room, threads = widest(layers), layers[0].threads
    if given is not None:
        if not (is_number(given) and given > 0):
            raise Refusal("thread_diameter", given, "a finite number > 0 (mm)")
        if given > room:
            allowed = f"at most {room:.3g} mm, with {threads} threads side by side"
            raise Refusal("thread_diameter", given, allowed)
        return
    least = diameter(stiffness, STIFFEST)
    if least > room:
        count = math.floor(threads * room / least)
        allowed = (
            f"at most {count}: threads of {stiffness:g} N are {least:.3g} mm wide "
            f"even at {STIFFEST / 1000:g} GPa, and here {room:.3g} mm are left for each"
        )
        raise Refusal("threads", threads, allowed)


def note(layers: Sequence[Layer], stiffness: float, given: float | None, modulus: float) -> str:
    """What to say of threads whose diameter is not given; empty where they fit as assumed."""
    assumed, room = diameter(stiffness, modulus), widest(layers)
    if given is not None or assumed <= room:
        return ""
    return (
        f"at {modulus:g} MPa (spread.modulus) the threads would be {assumed:.2g} mm wide, and "
        f"{room:.2g} mm are left for each; no thread_diameter is given"
    )
