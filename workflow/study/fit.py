"""Whether the threads of a layer fit side by side: count times diameter, around the tube."""

import math

from geometry.muscle import Braid
from geometry.refusal import Refusal, is_number
from solver.material import Thread

STIFFEST = 130e3  # MPa, of any fibre that a muscle is braided of


def widest(braid: Braid) -> float:
    """Diameter of the widest threads that fit into both layers [mm]."""
    pairs = zip(braid.layer_diameters, braid.layer_angles, strict=True)
    return min(math.pi * d * math.cos(angle) / braid.threads for d, angle in pairs)


def diameter(thread: Thread, modulus: float) -> float:
    """Diameter of a round thread of a modulus [mm]."""
    return math.sqrt(4 * thread.stiffness / (math.pi * modulus))


def check(braid: Braid, thread: Thread, given: float | None) -> None:
    """Refuse threads that are wider than the tube has room for.

    Raises
    ------
    Refusal
        Naming ``thread_diameter`` if that is given, else ``threads``: then they would not fit if
        they were of the stiffest fibre.
    """
    room = widest(braid)
    if given is not None:
        if not (is_number(given) and given > 0):
            raise Refusal("thread_diameter", given, "a finite number > 0 (mm)")
        if given > room:
            allowed = f"at most {room:.3g} mm, with {braid.threads} threads side by side"
            raise Refusal("thread_diameter", given, allowed)
        return
    least = diameter(thread, STIFFEST)
    if least > room:
        count = math.floor(braid.threads * room / least)
        allowed = (
            f"at most {count}: threads of {thread.stiffness:g} N are {least:.3g} mm wide "
            f"even at {STIFFEST / 1000:g} GPa, and here {room:.3g} mm are left for each"
        )
        raise Refusal("threads", braid.threads, allowed)


def note(braid: Braid, thread: Thread, given: float | None, modulus: float) -> str:
    """What to say of threads whose diameter is not given; empty where they fit as assumed."""
    assumed, room = diameter(thread, modulus), widest(braid)
    if given is not None or assumed <= room:
        return ""
    return (
        f"at {modulus:g} MPa (spread.modulus) the threads would be {assumed:.2g} mm wide, and "
        f"{room:.2g} mm are left for each; no thread_diameter is given"
    )
