"""Pressures, contractions and forces as people write them: ``2.5bar``, ``12 %``, ``5 kg``.

Values are exact decimals, so that 12 % is 0.12 and a state that was solved before is found again.
"""

import re
from decimal import Decimal

from workflow.study import units
from workflow.study.errors import StudyError, choices, shown
from workflow.study.values import is_possible

PRESSURE, CONTRACTION, FORCE = "pressure", "contraction", "force"
KINDS = (PRESSURE, CONTRACTION, FORCE)
GRAVITY = Decimal("9.80665")  # N/kg: a mass is the load that hangs from a muscle
UNITS = {  # of each kind, by size; pressures are those above the pressure around the muscle
    PRESSURE: {
        "MPa": "1",
        "N/mm2": "1",
        "bar": "0.1",
        "mbar": "1e-4",
        "kPa": "1e-3",
        "hPa": "1e-4",
        "Pa": "1e-6",
        "psi": "0.006894757293168",
        "atm": "0.101325",
    },
    CONTRACTION: {"%": "0.01"},
    FORCE: {
        "N": "1",
        "kN": "1e3",
        "mN": "1e-3",
        "kg": str(GRAVITY),
        "kgf": str(GRAVITY),
        "g": str(GRAVITY / 1000),
        "lb": "4.4482216152605",
        "lbf": "4.4482216152605",
    },
}
STROKES = {"mm": "1", "cm": "10", "m": "1e3", "in": "25.4"}  # in mm: a contraction by the length
KIND_OF = {unit: kind for kind, sizes in UNITS.items() for unit in sizes} | dict.fromkeys(
    STROKES, CONTRACTION
)
UNIT = {PRESSURE: "MPa", CONTRACTION: "1", FORCE: "N"}  # of a number without one
EXAMPLES = {PRESSURE: "0.25MPa or 2.5bar", CONTRACTION: "12% or 36mm", FORCE: "200N or 5kg"}
NAMES = {  # as words before a quantity: stroke 20mm, p=2.5bar
    **dict.fromkeys(("pressure", "p"), PRESSURE),
    **dict.fromkeys(("contraction", "stroke"), CONTRACTION),
    **dict.fromkeys(("force", "load", "f"), FORCE),
}
LARGEST = Decimal("0.6")  # contraction of a muscle
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
WRITTEN = re.compile(rf"\s*({NUMBER})\s*([^\s\d.,+-][^\s]*)?\s*")
SPELLED = {"percent": "%", "mpa": "MPa", "N/mm^2": "N/mm2", "N/mm²": "N/mm2"}
LOOSELY = {  # in small letters, where these are no other unit: m may be milli or mega
    **{unit.lower(): unit for unit in KIND_OF if unit[0] not in "mM"},
    "bars": "bar",
    "newton": "N",
    "newtons": "N",
    "kgs": "kg",
    "lbs": "lb",
    "inch": "in",
}


def read(text: str, length: float, kind: str = "") -> tuple[str, float]:
    """Kind and value (MPa, fraction or N) of a quantity, for a muscle of a length [mm].

    With ``kind`` a number may stand without a unit; without, its unit says what it is.

    Raises
    ------
    StudyError
        If it is none, with what would have been one.
    """
    found = WRITTEN.fullmatch(text)
    number = Decimal(found[1]) if found else Decimal("nan")
    if found is None or not is_possible(float(number)):
        comma = ""
        if re.search(r"\d,\d", text):
            comma = f"; the decimal sign is a point, perhaps {text.replace(',', '.')}"
        raise StudyError(f"{shown(text)} is no quantity\n  allowed: {_examples(kind)}{comma}")
    unit = _unit(found[2] or "")
    if not unit:
        if kind:
            return kind, _plain(kind, float(number), text)
        per_cent = number if number > LARGEST else 100 * number
        guess = f"; perhaps {per_cent.normalize():f}%" if 0 < per_cent <= 100 * LARGEST else ""
        raise StudyError(f"{shown(text)} has no unit\n  allowed: {_examples('')}{guess}")
    if unit not in KIND_OF:
        known = [u for u, k in KIND_OF.items() if k == kind or not kind]
        raise StudyError(f"{shown(text)}: no such unit\n  allowed: {choices(unit, known)}")
    if kind and KIND_OF[unit] != kind:
        raise StudyError(f"{shown(text)} is no {kind}\n  allowed: {_examples(kind)}")
    if unit in STROKES:
        return CONTRACTION, float(number * Decimal(STROKES[unit]) / Decimal(str(length)))
    return KIND_OF[unit], float(number * Decimal(UNITS[KIND_OF[unit]][unit]))


def _unit(text: str) -> str:
    """The unit that is meant, as it stands in ``KIND_OF``; what is none stays."""
    return text if text in KIND_OF else SPELLED.get(text, LOOSELY.get(text.lower(), text))


def _plain(kind: str, number: float, text: str) -> float:
    """A number in the unit of a study file, unless it looks like one in another."""
    guess = units.guess(kind, number)
    if guess:
        raise StudyError(f"{kind} {text} has no unit; perhaps {guess}\n  give it with its unit")
    return number


def _examples(kind: str) -> str:
    """Quantities as they may be written."""
    return EXAMPLES[kind] if kind else ", ".join(f"{EXAMPLES[k]} ({k})" for k in KINDS)


def is_fraction(text: str) -> bool:
    """Whether it is a number without a unit that can be a contraction: 0.12."""
    found = WRITTEN.fullmatch(text)
    return bool(found and not found[2] and abs(Decimal(found[1])) <= LARGEST)


def named(words: list[str]) -> list[tuple[str, str]]:
    """Quantities of a command line: what they are called, empty if nothing, and as written."""
    apart = [part for word in words for part in re.split(r"(?<=[A-Za-z])[=:]", word) if part]
    found, name = [], ""
    for text in split(apart):
        if not name and text.lower() in NAMES:
            name = text
        else:
            found.append((NAMES[name.lower()] if name else "", text))
            name = ""
    return [*found, ("", name)] if name else found  # a name of nothing is no quantity


def split(words: list[str]) -> list[str]:
    """Words of a command line, those of one quantity joined: ``0.25 MPa`` is one."""
    found: list[str] = []
    for word in words:
        is_number = found and re.fullmatch(r"[-+.,\deE]*\d[.,]?", found[-1])
        if is_number and not re.match(r"[-+.,]?\d", word) and word.lower() not in NAMES:
            found[-1] += word
        else:
            found.append(word)
    return found
