"""From the records of an analysis to its tables, figures and other files."""

from pathlib import Path

from geometry.files import atomic_write
from workflow.analyses import analysis
from workflow.data import records
from workflow.figures import style
from workflow.run import failures
from workflow.study.study import load


def evaluate(name: str, study_file: str, results: Path) -> None:
    """Read the records of an analysis; write all that it makes, each file whole or not at all.

    ``results`` is the folder of the study: tables, figures and other files have theirs in it.

    Raises
    ------
    StudyError
        If a record is missing, damaged, or that of another case.
    """
    asked = analysis.named(name)
    solved = [
        analysis.Solved(case, records.read_one(records.taken(case), case.label)[1])
        for case in analysis.cases(name, study_file)
    ]
    if asked.solves_cases:
        own = [each for each in solved if each.asked.promise is None]
        labels = {each.asked.key: each.asked.label for each in own}
        solutions = {each.asked.key: each.solution for each in own}
        failures.write_analysis(name, labels, solutions, results / "tables" / asked.failures)
    study = load(study_file)
    tables = asked.tabulated(study, solved)
    for stem, rows in tables.items():
        with atomic_write(results / "tables" / f"{stem}.csv") as beside:
            rows.to_csv(beside, index=False, float_format=asked.tables[stem])
    for stem, text in asked.texts(study, tables).items():
        with atomic_write(results / name / stem) as beside:
            beside.write_text(text, encoding="utf-8")
    for stem, drawing in asked.drawn(solved, tables).items():
        for suffix in (".svg", ".png"):
            style.save(drawing, results / "figures" / f"{stem}{suffix}")
