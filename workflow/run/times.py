"""Where the time of a run goes: whole runs from scratch, in a folder of their own.

Seconds of the processor are those of all processes of a run. Programs of the workflow say what they
took (workflow/__main__.py), a solve what FreeFEM took of that.
"""

import csv
import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from geometry.files import RESULTS, atomic_write
from solver.sources import ROOT
from workflow.study.errors import StudyError
from workflow.study.folders import COST

NOTES = "MUSCLE_TIMES"  # environment variable: file to which programs add a line
PROGRAMS = {"solve": "Python and meshes of the solves", "gather": "dataset", "draw": "figures"}
COLUMNS = ("what", "processor_s", "wall_s")
SWEEP = """\
materials:
  nbr: {{c10: 0.345083, c01: 0.083805}}
muscles:
  many:
    inner_diameter: 20
    wall_thickness: 2
    layer_depths: [0.3, 0.9]
    threads: 60
    lead: 144
    thread_stiffness: 315
    material: nbr
    sweep: {{length: {{from: 200, to: {last:.1f}, step: 0.1}}}}
scenes:
  many:
    path: isobaric
    muscles: [many]
    pressure: [0.3]
    contraction: {{from: 0, to: 0.2, step: 0.01}}
    models: [membrane]
"""
# Seconds of a run on the machine on which this was written, beside those of its solves; a curve of
# the sweep. Only for saying beforehand what it will take.
EXPECTED, EXPECTED_OF_CURVE = 25.0, 0.27
Row = tuple[str, float, float | None]


def make(
    study: Path,
    cores: int,
    muscles: int,
    more: Mapping[str, float],
    table: Path,
    machine: Iterable[str],
    say: Callable[[str], None],
) -> None:
    """Measure, and write a table of it.

    Parameters
    ----------
    muscles : how many there are in a study of one sweep, each a curve by the membrane
    more : rows below these, of seconds of the processor that are known already
    machine : lines above the table
    say : is told every line

    Raises
    ------
    StudyError
        If a run fails; a study whose cases fail is measured all the same.
    """
    with TemporaryDirectory() as scratch:
        bench = _Bench(Path(scratch), cores)
        say(f"running {study} from scratch, and again with nothing to do")
        rows = bench.parts(study.resolve())
        sweep = Path(scratch, "many.yaml")
        sweep.write_text(SWEEP.format(last=200 + (muscles - 1) / 10))
        say(f"running a study of one sweep: {muscles} muscles")
        each = [spent / muscles for spent in bench.run(sweep)]
        rows.append((f"{muscles} curves by the membrane, each", each[0], each[1]))
    rows += [(what, seconds, None) for what, seconds in more.items()]
    with atomic_write(table) as beside, beside.open("w", newline="", encoding="utf-8") as stream:
        stream.writelines(f"# {line}\n" for line in machine)
        writer = csv.writer(stream)
        writer.writerow(COLUMNS)
        writer.writerows((what, f"{s:.3g}", "" if w is None else f"{w:.3g}") for what, s, w in rows)
    for what, seconds, wall in rows:
        unit = "" if what.endswith("[1]") else " s"
        say(f"{what:48} {seconds:8.3g}{unit}{'' if wall is None else f' in {wall:.3g} s'}")
    say(f"written: {table}")


def expected_seconds(of_solves: float, cores: int, muscles: int) -> float:
    """Wall seconds of all that is measured, there; of the study's solves so many one by one."""
    return (of_solves + EXPECTED + muscles * EXPECTED_OF_CURVE) / min(cores, os.cpu_count() or 1)


class _Bench:
    """A folder in which studies are run."""

    def __init__(self, folder: Path, cores: int) -> None:
        self.folder, self.cores = folder, cores
        self.studies = set[Path]()

    def run(self, study: Path) -> tuple[float, float]:
        """Seconds of the processor and on the clock of one run."""
        words = [str(Path(sys.executable).with_name("snakemake"))]
        words += ["--snakefile", str(ROOT / "Snakefile"), "--directory", str(self.folder)]
        words += ["--profile", str(ROOT / "profiles/default"), "--cores", str(self.cores)]
        before, start = _used(), time.monotonic()
        done = subprocess.run(
            [*words, "--config", f"study={study}"],
            env=os.environ | {NOTES: str(self.folder / "notes")},
            capture_output=True,
            text=True,
            check=False,
        )
        self.studies.add(study)
        if len(list((self.folder / RESULTS).rglob("dataset.nc"))) < len(self.studies):
            raise StudyError(f"{study}: the run failed\n{done.stderr[-2000:]}")
        return _used() - before, time.monotonic() - start

    def parts(self, study: Path) -> list[Row]:
        """A study from scratch, its parts, and the study once more."""
        whole, wall = self.run(study)
        noted = dict.fromkeys(PROGRAMS, 0.0)
        for line in (self.folder / "notes").read_text().splitlines():
            program, seconds = line.split()
            noted[program] = noted.get(program, 0.0) + float(seconds)
        costs = [json.loads(path.read_text()) for path in (self.folder / COST).iterdir()]
        freefem = sum(cost.get("freefem_cpu_seconds", 0.0) for cost in costs)
        rest = whole - sum(noted[program] for program in PROGRAMS)
        noted["solve"] -= freefem
        again, soon = self.run(study)
        return [
            ("the study from scratch", whole, wall),
            ("  FreeFEM", freefem, None),
            *((f"  {said}", noted[program], None) for program, said in PROGRAMS.items()),
            ("  Snakemake and the rest", rest, None),
            ("times FreeFEM [1]", whole / freefem if freefem else float("nan"), None),
            ("the study with nothing to do", again, soon),
        ]


def _used() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
