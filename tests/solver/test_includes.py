"""Every include of the FreeFEM programs says at its head what it needs and what it defines.

It needs the files whose names it uses and does not include itself: ``composition.idp`` where these
depend on the effects of a case, ``model`` where every model has its own. It defines what others
use.
"""

import inspect
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from solver import program
from solver.effects import KINDS
from solver.models import MODELS
from solver.rubber import LAWS, default
from solver.rubber.rubber_law import BY_INVARIANTS

TESTS = Path(__file__).parent / "edp"
SOLVER = Path(program.__file__).parent
LAW = default().includes()[0]  # the others are held to what its includes define
PATHS = [p for p in sorted(SOLVER.rglob("*.[ei]dp")) if (SOLVER / "rubber") not in p.parents]
FILES = {path.name: path.read_text(encoding="utf-8") for path in [*PATHS, *LAW.glob("*.idp")]}
USERS = FILES | {path.name: path.read_text(encoding="utf-8") for path in TESTS.glob("*.??p")}
INCLUDES = [name for name in FILES if name.endswith(".idp")]
PREFIXES = tuple(f"{name}_" for name, model in MODELS.items() if model.mesh)
VALUES = "|".join({"none", *(value for kind in KINDS.values() for value in kind)})
COMPOSING = [program.composition, *(model.composition for model in MODELS.values())]
COMPOSED = [  # files that solver/program.py may write into composition.idp
    re.compile(re.sub(r"\{.*?\}", f"({VALUES})", pattern))
    for pattern in re.findall(r'f"(\w+\{.*?\}\.idp)"', "".join(map(inspect.getsource, COMPOSING)))
]

WORD = r"[A-Za-z]\w*"
TYPES = {"real", "int", "string", "bool", "matrix", "mesh", "mesh3", "meshL", "varf"}
TYPES |= {"ofstream", "ifstream"}


def code_of(text: str) -> str:
    """The text without comments and what stands in quotes."""
    return re.sub(r"//.*", "", re.sub(r'"[^"\n]*"', '""', text))


def split(text: str, at: str) -> Iterator[tuple[str, int]]:
    """Parts of a text between characters outside of parentheses, and how many braces are open."""
    begin = inside = depth = 0
    for end, character in enumerate(text + at[0]):
        inside += (character in "([") - (character in ")]")
        if character in at and not inside:
            yield text[begin:end].strip(), depth
            begin = end + 1
        depth += (character == "{") - (character == "}")


@cache
def spaces() -> frozenset[str]:
    """Finite-element spaces, which are types."""
    return frozenset(re.findall(rf"\bfespace\s+({WORD})", "".join(map(code_of, USERS.values()))))


@cache
def declared(file: str) -> tuple[frozenset[str], frozenset[str]]:
    """Names that a file declares for all that comes after it, and all that it declares."""
    code = code_of(USERS[file])
    shared: set[str] = set()
    own: set[str] = set()
    for macro in re.findall(rf"^macro\s+({WORD})", code, re.MULTILINE):
        shared.add(macro)
    code = re.sub(r"^(macro|IFMACRO|ENDIFMACRO).*", "", code, flags=re.MULTILINE)
    code = re.sub(r'^(include|load) ""', "", code, flags=re.MULTILINE)
    for statement, depth in split(code, ";{}"):
        (shared if depth == 0 else own).update(names_of(statement))
        for _, parameters in re.findall(r"\b(func|varf)\b[^(]*\((.*)", statement, re.DOTALL):
            own.update(re.findall(rf"({WORD})\s*[,)\]]", parameters.partition("=")[0]))
        own.update(re.findall(rf"\((?:int|real)\s+({WORD})\s*=", statement))
    return frozenset(shared), frozenset(shared | own)


def names_of(statement: str) -> Iterator[str]:
    """Names that a statement declares."""
    if found := re.match(rf"(?:func\s+\S+|fespace|varf)\s+({WORD})\s*\(", statement):
        yield found[1]
    elif (
        found := re.match(rf"({WORD})((?:\[[\w\s,]*\])*\s+&?\s*)(.*)", statement, re.DOTALL)
    ) and (found[1] in TYPES | spaces()):
        for declarator, _ in split(found[3], ","):
            listed = re.match(r"\[([^\]]*)\]", declarator)
            yield from re.findall(WORD, listed[1]) if listed else re.findall(WORD, declarator)[:1]


@cache
def brought(file: str) -> frozenset[str]:
    """A file and all that it includes."""
    found = {file}
    for name in re.findall(r'^include "(.*?)"', USERS[file], re.MULTILINE):
        if name == "composition.idp":
            found.add(name)
        elif name in USERS:
            found |= brought(name)
    return frozenset(found)


@cache
def used(file: str) -> frozenset[str]:
    """Names that a file uses and does not declare."""
    code = re.sub(r"\bd[xyz]\(", "(", code_of(USERS[file]))  # derivatives in a varf
    words = re.findall(rf"(?<![\w.])({WORD})", code)
    return frozenset(words) - declared(file)[1]


def is_composed(file: str) -> bool:
    composed = [f for f in INCLUDES if any(p.fullmatch(f) for p in COMPOSED)]
    return any(file in brought(each) for each in composed)


def needs_of(file: str) -> set[str]:
    """What the head has to name."""
    found = set()
    for name in used(file):
        definers = {other for other in INCLUDES if name in declared(other)[0]}
        own = next((model for model in PREFIXES if file.startswith(model)), None)
        if own:  # of what each model has, that of its own
            others = tuple(model for model in PREFIXES if model != own)
            definers = {d for d in definers if not d.startswith(others)}
            definers = {d for d in definers if d.startswith(own)} or definers
        if not definers or definers & brought(file):
            continue
        if all(map(is_composed, definers)):
            found.add("composition.idp")
        elif len(definers) > 1:
            found.add("model")
        else:
            found |= definers
    return found - brought(file)


def defined_by(file: str) -> set[str]:
    """What the head has to name."""
    users = frozenset().union(*(used(other) for other in USERS if other != file))
    return set(declared(file)[0] & users)


def said(file: str) -> tuple[set[str], set[str]]:
    """What the head of a file names."""
    return heads_of(FILES[file], file)


def heads_of(text: str, file: str) -> tuple[set[str], set[str]]:
    """What the head of a text names."""
    head = re.match(r"(//.*\n)*", text)[0]
    found = re.search(r"^// Needs:(.*)^// Defines:(.*)\Z", head, re.MULTILINE | re.DOTALL)
    assert found, f"{file}: its head ends without '// Needs:' and '// Defines:'"
    lists = (re.sub(r"^//", "", text, flags=re.MULTILINE).split() for text in found.groups())
    needs, defines = (set(words) - {"nothing"} for words in lists)
    return needs, defines


@pytest.mark.parametrize("file", INCLUDES)
def test_the_head_says_what_a_file_needs_and_defines(file):
    needs, defines = needs_of(file), defined_by(file)
    lists = (" ".join(sorted(words)) or "nothing" for words in (needs, defines))
    right = "// Needs:   {}\n// Defines: {}".format(*lists)
    assert said(file) == (needs, defines), f"{file}: its head should end with\n{right}"


FRAMES = ("biaxial.idp", "axisymmetric.idp", "periodic.idp")


@pytest.mark.parametrize("law", LAWS)
def test_every_law_has_the_frames_and_these_define_the_same(law):
    for frame in FRAMES:
        file = next(p / frame for p in LAWS[law].includes() if (p / frame).is_file())
        text = file.read_text(encoding="utf-8")
        assert heads_of(text, str(file))[1] == said(frame)[1]
        assert heads_of(text, str(file))[0] == said(frame)[0]
        for name in said(frame)[1]:
            assert re.search(rf"^(func|bool)\b.*\b{name}\b", text, re.MULTILINE), name


def test_laws_of_invariants_define_what_their_frames_use():
    wanted = {"invariantSlopes", "invariantModuli", "invariantEnergy"}
    for frame in BY_INVARIANTS.glob("*.idp"):
        assert "invariants.idp" in frame.read_text()
    for file in (SOLVER / "rubber").glob("*/invariants.idp"):
        assert heads_of(file.read_text(), str(file))[1] == wanted


def test_names_are_found():
    """That the reading above reads: some of every kind."""
    shared, every = declared("membrane_model.idp")
    assert {"Th", "Vh", "unknowns", "vEnd", "radial", "U", "evaluate", "position"} <= shared
    assert {"force", "a", "b"} <= every - shared
    assert "fixedUnknowns" in declared("ends_butt.idp")[0]
    assert {"residualNorm", "cutbacks", "newton", "arcShift"} <= declared("newton.idp")[0]
    assert {"kind", "targetA", "it", "a11"} <= declared("newton.idp")[1]
