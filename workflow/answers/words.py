"""What the solver says of a state, in the words of an engineer who knows muscles and no solver."""

import re

from geometry.readable import plain

WHERE = re.compile(r"at contraction (\S+), pressure (\S+) MPa")
ENDS = {  # how a reason begins: why there is no state
    "crumpling": "its wall, which has no bending stiffness, crumples on the way there",
    "overhang of a wall": "its wall, which has no bending stiffness, folds over the fitting on the "
    "way there",
    "overhang": "its wall folds over the fitting on the way there",
    "fold": "the muscle snaps on the way there: beyond that no state follows from this one",
    "asymptote": "the tube would be blown up without end on the way there",
    "turned inside out": "the state that it finds is wrong: an element of its mesh is turned "
    "inside out; a finer mesh may have one",
    "reached through a state": "what it finds there lies behind a state that is wrong, or behind a "
    "snap of the muscle",
    "no state found beyond": "the solver finds none further on; a finer mesh may",
}
NOTES = {  # parts of notes, as patterns
    r"under a dead load, as its force falls with length": "a weight would run away here, as the "
    "force falls where the muscle is longer",
    r"(\S+) unstable modes at fixed contraction and pressure": r"it would buckle or bulge here, in "
    r"\1 ways, though its ends are held",
    r"the smoothing of slack threads adds": "threads go slack over a small strain and not at once, "
    "which adds",
    r"a slack\.width of (\S+) brings": r"numerics: {slack: {width: \1}} in the study brings",
}


def no_state(why: str) -> str:
    """Why there is no state, from a reason or a note of the solver; what is not known as it is."""
    said = next((words for begins, words in ENDS.items() if why.startswith(begins)), "")
    if not said:
        return why
    place = WHERE.search(why) if not why.startswith("no state") else None
    if place is None:
        return said
    contraction, pressure = map(float, place.groups())
    return f"{said} ({plain(100 * contraction + 0.0, 2)} %, {plain(pressure, 3)} MPa)"


def of_state(note: str) -> str:
    """A note on a state that there is."""
    for pattern, words in NOTES.items():
        note = re.sub(pattern, words, note)
    return note
