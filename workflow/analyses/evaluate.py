"""From the records of an analysis to its table, notes and figures."""

from pathlib import Path

from geometry.files import atomic_write
from workflow.analyses import analysis
from workflow.data import records
from workflow.figures import style


def evaluate(name: str, study_file: str, table: Path, figures: Path) -> None:
    """Read the records of a study; write its table and figures, each whole or not at all.

    Raises
    ------
    StudyError
        If a record is missing, damaged, or that of another case.
    """
    solved = [
        analysis.Solved(asked, records.read_one(asked.case.key, asked.label)[1])
        for asked in analysis.cases(name, study_file)
    ]
    rows = analysis.module(name).table(solved)
    with atomic_write(table) as beside:
        rows.to_csv(beside, index=False)
    if name in analysis.NOTED:
        with atomic_write(table.with_name(f"{name}_notes.csv")) as beside:
            analysis.module(name).notes(rows).to_csv(beside, index=False, float_format="%.4g")
    for figure, drawing in analysis.module(name).draw(solved, rows).items():
        for suffix in (".svg", ".png"):
            style.save(drawing, (figures / figure).with_suffix(suffix))
