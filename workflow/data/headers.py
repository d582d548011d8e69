"""What the header of a measured column means: its quantity, its unit, and whether it was set.

Headers are written in many ways: ``Pressure [bar]``, ``p_kPa``, ``Force (N)``, ``Kraft in N``,
``F/N``, ``contraction_%``. The unit decides between quantities of one word: a contraction in mm is
a stroke.
"""

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass

PRESSURE, FORCE, LENGTH, RATIO, TIME = "pressure", "force", "length", "ratio", "time"
PSI, KILOPOND, POUND = 0.00689475729, 9.80665, 4.4482216153
UNITS: dict[str, dict[str, float]] = {  # by dimension, in MPa, N, mm, 1, s
    PRESSURE: {
        **{"mpa": 1.0, "kpa": 1e-3, "pa": 1e-6, "hpa": 1e-4, "gpa": 1e3, "bar": 0.1, "mbar": 1e-4},
        **{"psi": PSI, "ksi": 1e3 * PSI, "atm": 0.101325, "at": 0.0980665, "mmhg": 1.33322e-4},
        **{"torr": 1.33322e-4, "n/mm2": 1.0, "n/m2": 1e-6, "kn/m2": 1e-3, "n/cm2": 0.01},
        **{"kgf/cm2": 0.0980665, "kg/cm2": 0.0980665, "kp/cm2": 0.0980665},
    },
    FORCE: {
        **{"n": 1.0, "newton": 1.0, "newtons": 1.0, "kn": 1e3, "mn": 1e-3, "dan": 10.0, "cn": 0.01},
        **{"lbf": POUND, "lb": POUND, "lbs": POUND, "kgf": KILOPOND, "kp": KILOPOND},
        **{"kg": KILOPOND, "gf": 1e-3 * KILOPOND, "g": 1e-3 * KILOPOND},
    },
    LENGTH: {
        **{"mm": 1.0, "cm": 10.0, "dm": 100.0, "m": 1e3, "um": 1e-3, "millimeter": 1.0},
        **{"in": 25.4, "inch": 25.4, "inches": 25.4, '"': 25.4, "ft": 304.8},
    },
    RATIO: {
        **{"%": 0.01, "percent": 0.01, "pct": 0.01, "prozent": 0.01, "\u2030": 1e-3},
        **{"1": 1.0, "-": 1.0, "--": 1.0, "mm/mm": 1.0, "m/m": 1.0, "in/in": 1.0, "fraction": 1.0},
    },
    TIME: {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0, "hz": 1.0},
}
DIMENSION = {unit: dimension for dimension, units in UNITS.items() for unit in units}
OF_PROJECT = {PRESSURE: "MPa", FORCE: "N", LENGTH: "mm", RATIO: "", TIME: "s"}
GAUGE, NOT_GAUGE = ("gauge", "relative", "rel", "g)", "g", "e"), ("absolute", "abs", "a)", "a")
NOT_GAUGE_WORDS = {"abs", "absolute", "absolut"}
ABSOLUTE = "absolute"  # in place of a unit
SET = {"set", "setpoint", "target", "soll", "sollwert", "command", "commanded", "desired", "demand"}
FILLERS = SET | {
    *("measured", "ist", "istwert", "actual", "mean", "avg", "average", "mittelwert", "sensor"),
    *("signal", "value", "wert", "rel", "relative", "gauge", "supply", "internal", "inner", "air"),
    *("muscle", "muskel", "total", "axial", "tensile", "pulling", "pull", "blocked", "static"),
    *(
        "mess",
        "messwert",
        "gemessen",
        "filtered",
        "raw",
        "corrected",
        "ratio",
        "nominal",
        "engineering",
        "eng",
        "nom",
        "technical",
    ),
    *("in", "the", "of", "at", "under", "test", "current", "isometric", "input", "output", "abs"),
    *("test", "data", "channel", "ch", "y", "x", "z", "cell", "transducer", "working", "operating"),
}
REST = {"initial", "rest", "original", "unloaded", "nominal", "start", "free"}  # of a length
# What a unit by itself does not mean
SELDOM = {"strain", "stretch", "suspect", "test", "extension"}
SCATTER = {  # of a quantity, not itself
    *(
        "std",
        "stdev",
        "sd",
        "sem",
        "error",
        "err",
        "uncertainty",
        "deviation",
        "variance",
        "offset",
    ),
    *("tolerance", "velocity", "speed", "per", "count", "number", "id", "drop"),
}
TRUE = {"true", "cauchy", "wahre", "log", "logarithmic", "hencky"}


@dataclass(frozen=True)
class Word:
    """A name of measured things: its ends, its exact short forms, and what it is by dimension."""

    ends: tuple[str, ...]
    short: tuple[str, ...]
    quantities: Mapping[str, str]  # by dimension; the first is that of a column without a unit


OF_MUSCLES = (  # also in other languages; escaped are Polish, and pressure ... in Japanese, Chinese
    Word(
        (
            *("pressure", "press", "druck", "pression", "presion", "pressione", "druk", "pressao"),
            *("cisnienie", "\u5727\u529b", "\u538b\u529b", "\u538b\u5f3a"),
        ),
        ("p",),
        {PRESSURE: "pressure"},
    ),
    Word(
        (
            *("force", "kraft", "load", "tension", "last", "fuerza", "forza", "effort", "loadcell"),
            *("forca", "kracht", "sila", "si\u0142a", "\u5f35\u529b", "\u62c9\u529b"),
        ),
        ("f", "fz", "fx", "fax"),
        {FORCE: "force"},
    ),
    Word(
        (
            *(
                "contraction",
                "kontraktion",
                "contraccion",
                "contrazione",
                "contracao",
                "contractie",
            ),
            *("shortening", "verkuerzung", "raccourcissement", "accorciamento", "acortamiento"),
            *("skurcz", "\u53ce\u7e2e\u7387", "\u6536\u7f29\u7387"),
        ),
        ("eps", "epsilon", "contr", "kappa", "h", "e", "k"),
        {RATIO: "contraction", LENGTH: "stroke"},
    ),
    Word(
        (
            "stroke",
            "hub",
            "displacement",
            "travel",
            "weg",
            "verschiebung",
            "strokelength",
            "position",
            *("course", "corsa", "carrera", "curso", "slag", "skok", "\u4f4d\u79fb"),
            *("deplacement", "spostamento", "desplazamiento", "\u5909\u4f4d"),
        ),
        ("s", "disp", "dl", "deltal", "dx", "deltall0", "dll0", "deltall", "dll"),
        {LENGTH: "stroke", RATIO: "contraction"},
    ),
    Word(
        ("length", "laenge", "longueur", "longitud", "lunghezza", "lengte", "comprimento"),
        ("l", "len"),
        {LENGTH: "length"},
    ),
    Word(
        ("strain", "dehnung", "elongation", "extension", "stretching"),
        (),
        {RATIO: "strain", LENGTH: "extension"},
    ),
    Word(
        ("stretch", "streckung", "relativelength", "lengthratio"),
        ("ll0", "ll", "lambda", "lam"),
        {RATIO: "stretch"},
    ),
    Word(("suspect",), (), {RATIO: "suspect"}),
    Word(("time", "zeit", "timestamp", "temps", "tiempo", "elapsed"), ("t",), {TIME: "time"}),
)
OF_RUBBER = (
    Word(
        ("stress", "spannung", "contrainte"),
        ("sigma", "p", "p1", "p11", "s11", "pk1", "sig"),
        {PRESSURE: "stress"},
    ),
    Word(("stretch", "streckung", "stretchratio"), ("lambda", "lam"), {RATIO: "stretch"}),
    Word(
        ("strain", "dehnung", "elongation", "extension", "deformation"),
        ("eps", "epsilon", "e"),
        {RATIO: "strain"},
    ),
    Word(("mode", "type", "loading", "experiment", "test"), (), {RATIO: "test"}),
    Word(("time", "zeit", "timestamp", "temps", "tiempo", "elapsed"), ("t",), {TIME: "time"}),
)


@dataclass(frozen=True)
class Header:
    """What a header says.

    Attributes
    ----------
    text : as it is written
    quantity : empty if it is none that is looked for
    unit, factor : as written, and its size in the unit of the project; no unit: as if in that
    unknown : a unit in brackets that is none
    """

    text: str
    quantity: str = ""
    dimension: str = ""
    unit: str = ""
    factor: float = 1.0
    is_set: bool = False
    is_true: bool = False
    is_absolute: bool = False
    unknown: str = ""


def plain(text: str) -> str:
    """A text in one way of writing: without quotes, raised figures, umlauts and Greek letters."""
    text = unicodedata.normalize("NFKC", text.strip().strip("\"'").strip())
    for old, new in (
        *(("\u00e4", "ae"), ("\u00f6", "oe"), ("\u00fc", "ue"), ("\u00df", "ss")),
        *(("\u00c4", "Ae"), ("\u00d6", "Oe"), ("\u00dc", "Ue"), ("\u2212", "-"), ("\u03bc", "u")),
        *(("\u03b5", " eps "), ("\u03c3", " sigma "), ("\u03bb", " lambda "), ("\u0394", " delta")),
    ):
        text = text.replace(old, new)
    text = unicodedata.normalize("NFKD", text)
    return "".join(c for c in text if not unicodedata.combining(c))


def unit_of(text: str) -> str:
    """The key of a unit in ``UNITS``, or ``ABSOLUTE``; empty if it is none."""
    key = re.sub(r"[\s^*]", "", plain(text).lower()).strip("[]{}<>") or "?"
    if key.startswith("(") and key.endswith(")") and len(key) > 2:
        key = key[1:-1]
    if key in DIMENSION:
        return key
    for ends, found in ((GAUGE, ""), (NOT_GAUGE, ABSOLUTE)):
        for end in ends:
            stem = key.removesuffix(end).strip("(),_")
            if key.endswith(end) and DIMENSION.get(stem) == PRESSURE:
                return found or stem
    return ""


def read(text: str, words: tuple[Word, ...]) -> Header:
    """What a header says, in some vocabulary."""
    rest, unit, unknown = plain(text), "", ""
    rest = re.sub(r"\b(m?bar|psi|[kM]?Pa)\s*[(\[]\s*([gae])\s*[)\]]", r"\1\2", rest, flags=re.I)
    for bracket in re.findall(r"[\[({<]([^\])}>]*)[\])}>]", rest):
        if not unit and unit_of(bracket):
            unit = bracket.strip()
            rest = re.sub(r"[\[({<]" + re.escape(bracket) + r"[\])}>]", " ", rest, count=1)
        elif f"[{bracket}]" in rest and bracket.strip():
            unknown = bracket.strip()
            rest = rest.replace(f"[{bracket}]", " ")
    tokens = _tokens(rest)
    if not unit:
        unit, tokens = _unit_among(tokens)
    key = unit_of(unit)
    dimension = PRESSURE if key == ABSOLUTE else DIMENSION.get(key, "")
    lower = [token.lower() for token in tokens]
    if not SCATTER.isdisjoint(lower):
        return Header(text=text)
    quantity, found = _quantity(lower, dimension, words)
    if not quantity and unit and not lower:  # a unit and nothing else
        able = {q for w in words for d, q in w.quantities.items() if d == dimension} - SELDOM
        quantity = able.pop() if len(able) == 1 else ""
        found = dimension
    if not quantity:
        return Header(text=text, unknown=unknown)
    if quantity == "length" and (REST.intersection(lower) or lower == ["l0"]):
        quantity = "rest_length"
    factor = UNITS[dimension].get(key, 1.0) if dimension else 1.0
    if unit == "MN":
        factor = 1e6
    return Header(
        text=text,
        quantity=quantity,
        dimension=dimension or found,
        unit=unit,
        factor=factor,
        is_set=bool(SET.intersection(lower)),
        is_true=bool(TRUE.intersection(lower)),
        is_absolute=key == ABSOLUTE
        or (quantity == "pressure" and not NOT_GAUGE_WORDS.isdisjoint(lower)),
        unknown="" if unit else unknown,
    )


def _unit_among(tokens: list[str]) -> tuple[str, list[str]]:
    """A unit that stands among the words of a header, mostly at the end, and the other words."""
    for last in range(len(tokens), 0, -1):
        for count in (1, 2):
            part = "/".join(tokens[max(last - count, 0) : last])
            first = last - count
            at_end = last == len(tokens) > 1
            known = unit_of(part) and (len(part) > 1 or at_end or part in "N%")
            behind_a_word = first >= 1 if len(tokens) > 1 else first >= 0
            links = part == "in" and last < len(tokens)  # force in kN
            if known and (behind_a_word or part == "%") and not links:
                return part, tokens[:first] + tokens[last:]
    return "", tokens


def _tokens(text: str) -> list[str]:
    area = r"(?<![A-Za-z])(k?N|kgf?|kp)\s*/\s*(mm|cm|m)\s*\^?\s*2(?![A-Za-z])"
    text = re.sub(area, r" \1per\g<2>2 ", text)
    text = re.sub(r"(?<![A-Za-z])(mm/mm|m/m|in/in)(?![A-Za-z])", " fraction ", text)
    text = text.replace("%", " % ").replace("\u2030", " \u2030 ")
    text = re.sub(r"(?<=[a-z]{4})(?=[A-Z])", " ", text)  # ForceN, PressureBar
    text = re.sub(r"(?<=[a-z])(?=(MPa|kPa|hPa|kN)$)", " ", text)
    text = re.sub(r"(?<=[a-jl-z]{2})(?=(Pa|N)$)", " ", text)
    found = re.split(r"[\s_/,:;.|\-\[\](){}<>=]+", text)
    return [re.sub(r"^(k?N|kgf?|kp)per(mm2|cm2|m2)$", r"\1/\2", token) for token in found if token]


def _quantity(lower: list[str], dimension: str, words: tuple[Word, ...]) -> tuple[str, str]:
    """Quantity and dimension of some tokens; of several the one that is named last."""
    core = [token for token in lower if token not in FILLERS | TRUE]
    core = core or [token for token in lower if token in ("test",)]
    best: tuple[int, str, str] = (-1, "", "")
    for word in words:
        if dimension and dimension not in word.quantities:
            continue
        found = dimension or next(iter(word.quantities))
        joined = "".join(core)
        places = [k for k, token in enumerate(core) if token.endswith(word.ends)]
        if joined in word.ends or re.sub(r"\d$", "", joined) in word.short:
            places.append(len(core))
        if places and max(places) > best[0]:
            best = max(places), word.quantities[found], found
    return best[1], best[2]
