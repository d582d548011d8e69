"""Where results stand, from the folder of a run.

results/cases, meshes, promises, cost, made, sources   of all studies: named by their content
results/                                      all else of the default study
results/studies/<name>/                       all else of another one
"""

import re
from pathlib import Path

from geometry.files import RESULTS
from workflow.study.errors import StudyError

DEFAULT = Path("config/config.yaml")  # the study of the paper
CASES, COST, MESHES = RESULTS / "cases", RESULTS / "cost", RESULTS / "meshes"
PROMISES = RESULTS / "promises"  # how climbs have ended
NAMED = ("cases", "cost", "logs", "made", "meshes", "promises", "seals", "sources")
STORE = {RESULTS / name for name in NAMED}
LOGS = RESULTS / "logs" / "cases"
SAME = ("study", "config")  # stems that say nothing: such a study is called like its folder
OWNER = "study.txt"  # in the folder of a study: which file it is


def of_study(file: Path | str) -> Path:
    """The folder of a study's dataset, tables, figures and lists of failures."""
    path = Path(file)
    if path.resolve() == DEFAULT.resolve():
        return RESULTS
    name = path.resolve().parent.name if path.stem in SAME else path.stem
    return RESULTS / "studies" / re.sub(r"[^\w.-]", "_", name)  # no pattern of Snakemake, no blank


def check_owner(file: Path | str) -> None:
    """Refuse a study whose folder holds the results of another file of the same name.

    Raises
    ------
    StudyError
        Naming that file. If it is there no more it may have been moved, and nothing is refused.
    """
    owner = of_study(file) / OWNER
    if not owner.is_file():
        return
    other = Path(owner.read_text(encoding="utf-8", errors="replace").rstrip("\n"))
    if other.is_file() and not other.samefile(file):
        raise StudyError(
            f"{file}: {owner.parent} holds the results of {other}, a study of the same name\n"
            "  allowed: another name of the file, or another folder: --directory"
        )


def take(file: Path | str) -> None:
    """Say in the folder of a study whose it is."""
    folder = of_study(file)
    if folder != RESULTS:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / OWNER).write_text(f"{file}\n", encoding="utf-8")
