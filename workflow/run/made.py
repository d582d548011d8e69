"""Of what results were made that carry no passport themselves: meshes, figures, fields.

results/made/<file>           digest of the sources, and of what else they were made of
results/sources/<code>.json   the digest of each of those sources, to say which have changed
"""

import json
from pathlib import Path

from geometry.files import RESULTS, atomic_write
from solver import sources

MADE, SOURCES = RESULTS / "made", RESULTS / "sources"


def note(path: Path, code: str, of: str = "") -> None:
    """Note of what a result was made that is there now."""
    with atomic_write(MADE / path.relative_to(RESULTS), sealed=False) as beside:
        beside.write_text(f"{code} {of}\n")


def known(path: Path) -> tuple[str, str]:
    """Digest of the sources of a result, and of what else; empty if that is not known."""
    try:
        text = (MADE / path.relative_to(RESULTS)).read_text()
    except (OSError, ValueError):
        return "", ""
    code, _, of = text.rstrip("\n").partition(" ")
    return code, of


def keep(files: tuple[str, ...]) -> str:
    """Keep what sources there are, for ``why``; their digest."""
    code = sources.digest(files)
    path = SOURCES / f"{code}.json"
    if not path.exists():
        with atomic_write(path, sealed=False) as beside:
            beside.write_text(json.dumps(_digests(files)))
    return code


def why(code: str, files: tuple[str, ...]) -> str:
    """Which sources have changed since they had a digest, as text; empty if none has."""
    if code == sources.digest(files):
        return ""
    try:
        before = json.loads((SOURCES / f"{code}.json").read_text())
    except (OSError, ValueError):
        return "its sources have changed"
    now = _digests(files)
    return f"changed: {', '.join(k for k in sorted(before | now) if before.get(k) != now.get(k))}"


def _digests(files: tuple[str, ...]) -> dict[str, str]:
    return {file: sources.digest((file,)) for file in files}
