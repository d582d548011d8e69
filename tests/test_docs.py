"""What the documentation names exists: files in backticks, targets of links, programs."""

import re
from pathlib import Path

import pytest

from solver.status import CaseStatus, Flag, StateStatus

ROOT = Path(__file__).parent.parent
DOCUMENTS = sorted([*ROOT.glob("*.md"), ROOT / "config/README.md", *(ROOT / "docs").rglob("*.md")])
SOURCES = (".py", ".idp", ".edp", ".smk", ".md", ".toml", ".sh", ".cff", ".lock")
MADE = {"results", ".venv", "my"}  # folders of a run, of setup.sh, and of the reader
PRESENT = [d for d in DOCUMENTS if d.name != "CHANGELOG.md"]  # a history names what is no more


def text_of(document: Path) -> str:
    """The text without blocks of code, whose paths are examples."""
    return re.sub(r"```.*?```", "", document.read_text(encoding="utf-8"), flags=re.S)


def named_files(text: str) -> set[str]:
    """What stands in backticks and has the form of a path of this project, ``<name>`` as ``*``."""
    found = set()
    for quoted in re.findall(r"`([^`\n]+)`", text):
        path = re.sub(r"<[^<>]+>", "*", quoted)
        if not re.fullmatch(r"[\w.*/-]*[\w*/]", path):
            continue
        first, slash, _ = path.partition("/")
        is_source = path.endswith(SOURCES) and path not in SOURCES
        is_below = bool(slash) and (ROOT / first).is_dir()
        if first not in MADE and (is_source or is_below):
            found.add(path)
    return found


def exists(path: str) -> bool:
    """Whether a path, or a file name alone, is that of a file or folder of the project."""
    if "/" in path:
        return any(ROOT.glob(path.rstrip("/")))
    folders = ("config", "docs", "geometry", "solver", "tests", "workflow")
    return any(ROOT.glob(path)) or any(any((ROOT / f).rglob(path)) for f in folders)


@pytest.mark.parametrize("document", PRESENT, ids=lambda d: str(d.relative_to(ROOT)))
def test_named_files_exist(document: Path) -> None:
    missing = {path for path in named_files(text_of(document)) if not exists(path)}
    assert not missing


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda d: str(d.relative_to(ROOT)))
def test_links_resolve(document: Path) -> None:
    targets = re.findall(r"\]\(([^()\s]+)\)", text_of(document))
    relative = [t.partition("#")[0] for t in targets if not re.match(r"[a-z]+:", t)]
    missing = {t for t in relative if t and not (document.parent / t).exists()}
    assert not missing


def test_forms_of_names_are_recognised() -> None:
    text = "`solver/case.py` `line.idp` `docs/decisions` `workflow/figures/<name>.py` `tests/`"
    assert len(named_files(text)) == 5
    assert not named_files("`results/cost.csv` `a / b` `my/study.yaml` `.idp` `EA/2` `wall: none`")
    assert not exists("solver/no_such.py")
    assert not exists("no_such.idp")


def test_theory_names_every_program_of_the_models() -> None:
    theory = (ROOT / "docs/theory.md").read_text(encoding="utf-8")
    programs = {path.relative_to(ROOT) for path in (ROOT / "solver").rglob("*.edp")}
    named = named_files(theory)
    assert {str(p) for p in programs if p.name != "check.edp"} <= named


def test_messages_that_are_explained_are_those_of_the_code() -> None:
    """Every message of the page stands in a source; every status and flag is explained."""
    text = (ROOT / "docs/troubleshooting.md").read_text(encoding="utf-8")
    messages = re.findall(r"^\| `([^`]+)` \|", text[: text.index("## What became of")], re.M)
    assert len(messages) > 10
    files = [*(ROOT / "workflow").rglob("*.py"), *(ROOT / "workflow/rules").glob("*.smk")]
    sources = "".join(path.read_text(encoding="utf-8") for path in [*files, ROOT / "setup.sh"])
    of_others = {"MissingRuleException"}  # Snakemake's
    assert {each for each in messages if each not in sources} == of_others
    for kind in (CaseStatus, StateStatus, Flag):
        assert {word for word in kind if f"`{word}`" not in text} == set()
