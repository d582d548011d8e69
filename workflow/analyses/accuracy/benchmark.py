"""How long the solves of the analysis of accuracy take on this machine.

results/cost.csv               medians of seconds by purpose, unknowns, memory, one row per case
results/tables/benchmark.csv   exponents: how seconds and memory grow with unknowns and with states

Every case is meshed once and solved several times from scratch, one process at a time, in a
temporary folder and beside all records that there are. Rounds, not runs of one case, follow each
other, so that a slow minute of the machine spoils one run of many cases and not all of one.
"""

import json
import os
import platform
import re
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd

from geometry.files import atomic_write
from geometry.mesh_settings import CellMesh
from solver.case import Case
from solver.freefem import Limits, executable
from solver.load_path import LoadPath, PathKind
from solver.numerics import Numerics
from solver.solve import solve
from workflow.analyses import analysis
from workflow.analyses.accuracy import costs as accuracy_costs
from workflow.analyses.accuracy.settings import MUSCLE, PRESSURE, STEP
from workflow.analyses.analysis import AnalysisCase
from workflow.plan.mesh_error import PART
from workflow.study.contents import Study

SETS = ("mesh", "steps", "tolerance")
# CPU seconds of a curve of 21 states on the machine on which this was written: mesh 1/1, and the
# power of the refinement with which they grow. Only for saying beforehand what a run will take.
EXPECTED = {"membrane": (0.12, 0.2), "solid": (0.3, 2.2), "cell": (40.0, 2.7)}
AROUND = 0.7  # s, for Python and the mesh of one solve, on that machine
STATES = 21
LONG = 10.0  # s there; what takes longer is run once, as it varies less
FIRST = 0.03  # share of a run of all from which is said how long the rest will take
OF_SOLID = {  # rows: refinement of its default mesh
    "26 states by the solid, FreeFEM": 1,
    "26 states by the solid, refinement: 2, FreeFEM": 2,
}
EXPECTED_OF_SOLID = 3.0  # s there, of both
WARM = 5  # repetitions of a model that takes next to nothing


def chosen(study_file: Path) -> list[AnalysisCase]:
    """The curves whose cost is of interest, each case once."""
    asked = analysis.cases("accuracy", str(study_file))
    curves = [a for a in asked if a.tags["set"] in SETS and a.tags["quantity"] == "curve"]
    return list({a.case.key: a for a in reversed(curves)}.values())[::-1]


def run(cases: Sequence[AnalysisCase], runs: int, say: Callable[[str], None]) -> pd.DataFrame:
    """Medians of all costs, one row per case; ``say`` is told how it goes."""
    total = expected_of_all(cases, runs)
    with TemporaryDirectory() as scratch:
        bench = Bench(Path(scratch))
        start, spent = time.monotonic(), 0.0
        found: dict[str, list[dict[str, float]]] = {asked.case.key: [] for asked in cases}
        for number in range(runs):
            for k, asked in enumerate(cases, 1):
                if number >= _runs(asked.case, runs):
                    continue
                cost = bench.cost(asked)
                found[asked.case.key].append(cost)
                spent += expected_seconds(asked.case)
                left = (time.monotonic() - start) * (total / spent - 1)
                more = f"; about {duration(left)} left" if spent > FIRST * total else ""
                say(
                    f"run {number + 1} of {runs}, case {k} of {len(cases)}: {asked.label}: "
                    f"{cost[accuracy_costs.SOLVE]:.3g} s{more}"
                )
    rows = [
        {"case": asked.case.key, "label": asked.label}
        | {name: asked.tags[name] for name in ("set", "model", "mesh", "refinement", "tolerance")}
        | {"states": asked.case.path.states, "runs": _runs(asked.case, runs)}
        | pd.DataFrame(found[asked.case.key]).median().to_dict()
        for asked in cases
    ]
    return pd.DataFrame(rows)


class Bench:
    """A folder in which cases are meshed and solved as the workflow does it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.meshing: dict[str, float] = {}  # CPU seconds by mesh

    def cost(self, asked: AnalysisCase) -> dict[str, float]:
        """Of one solve."""
        if asked.mesh is None:
            return self._direct(asked)
        mesh = self._mesh(asked)
        names = {name: self.folder / name for name in ("record", "cost", "log")}
        outputs = [f"--{name}={path}" for name, path in names.items()]
        _python(["solver", "--case", asked.case.canonical(), "--mesh", str(mesh), *outputs])
        cost = json.loads(names["cost"].read_text())
        return accuracy_costs.of_run(cost) | {"mesh [s]": self.meshing[asked.mesh]}

    def _mesh(self, asked: AnalysisCase) -> Path:
        assert asked.mesh is not None
        path = self.folder / asked.mesh
        if not path.exists():
            self.meshing[asked.mesh] = _python(
                ["geometry", "-", str(path)], asked.case.mesh_spec() or ""
            )
        return path

    def _direct(self, asked: AnalysisCase) -> dict[str, float]:
        """A model that needs no process of its own, imported already."""
        limits = Limits(wall_time=60, memory=1000)
        solve(asked.case, None, self.folder / "log", limits)
        start = time.process_time()
        for _ in range(WARM):
            solve(asked.case, None, self.folder / "log", limits)
        return {accuracy_costs.SOLVE: (time.process_time() - start) / WARM}


def slowness(cases: Iterable[AnalysisCase]) -> float:
    """Wall seconds of the first solid here, as a multiple of what is expected of it."""
    first = next(asked for asked in cases if asked.case.model == "solid")
    with TemporaryDirectory() as scratch:
        start = time.monotonic()
        Bench(Path(scratch)).cost(first)
        return (time.monotonic() - start) / (AROUND + expected_seconds(first.case))


def of_solid(study: Study, runs: int) -> dict[str, float]:
    """CPU seconds of FreeFEM for a curve to 25 % at 0.3 MPa by row, the least of several runs.

    docs/decisions/0009 has the same curve with the mesh and the tangent that were before.
    """
    stops = tuple(round(STEP * number, 10) for number in range(26))
    path = LoadPath(kind=PathKind.ISOBARIC, held=PRESSURE, stops=stops)
    found = dict.fromkeys(OF_SOLID, float("inf"))
    with TemporaryDirectory() as scratch:
        bench = Bench(Path(scratch))
        for _ in range(runs):
            for row, refinement in OF_SOLID.items():
                mesh = replace(Numerics().section, refinement=refinement)
                case = study.muscles[MUSCLE].case(path, "solid", numerics=Numerics(section=mesh))
                spent = bench.cost(AnalysisCase(case, row))[accuracy_costs.SOLVE]
                found[row] = min(found[row], spent)
    return found


def expected_seconds(case: Case) -> float:
    """Of one solve of a case, on the machine on which this was written."""
    if case.model not in EXPECTED:
        return 0.3
    seconds, power = EXPECTED[case.model]
    if case.model == "cell":
        cell = case.numerics.cell
        refinement = cell.refinement * CellMesh().thread_size / cell.thread_size
    else:
        refinement = getattr(case.numerics, PART[case.model]).refinement
    return float(AROUND + seconds * refinement**power * case.path.states / STATES)


def expected_of_all(cases: Iterable[AnalysisCase], runs: int) -> float:
    """Seconds of all runs of all cases, there."""
    return sum(_runs(c.case, runs) * expected_seconds(c.case) for c in cases)


def _runs(case: Case, runs: int) -> int:
    return 1 if expected_seconds(case) > LONG else runs


def _python(arguments: list[str], text: str = "") -> float:
    """Run a program of the project; its CPU seconds.

    Raises
    ------
    subprocess.CalledProcessError
        If it fails.
    """
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-m", *arguments], input=text, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def write(costs: pd.DataFrame, path: Path) -> None:
    """Write a table with a note on the machine above it, whole or not at all."""
    with atomic_write(path) as beside, beside.open("w", encoding="utf-8") as stream:
        stream.writelines(f"# {line}\n" for line in machine())
        costs.to_csv(stream, index=False, float_format="%.6g")


def machine(seconds: str = "medians of CPU seconds") -> list[str]:
    """What seconds depend on, and which they are."""
    model = next(
        (
            line.partition(":")[2].strip()
            for line in _lines(Path("/proc/cpuinfo"))
            if line.startswith("model name")
        ),
        platform.processor() or platform.machine(),
    )
    load = f"{os.getloadavg()[0]:.1f} processes on average in the last minute"
    said = subprocess.run(
        [executable(), "-nw", "-v", "1", os.devnull], capture_output=True, text=True, check=False
    ).stdout
    found = re.search(r"FreeFem\+\+ v(\S+)", said)
    version = found.group(1) if found else "unknown"
    return [
        f"{model}, {os.cpu_count()} cores; {platform.system()} {platform.release()}",
        f"Python {platform.python_version()}, numpy {np.__version__}, FreeFEM {version}",
        f"{time.strftime('%Y-%m-%d')}; {load}; {seconds}",
    ]


def _lines(path: Path) -> list[str]:
    return path.read_text().splitlines() if path.exists() else []


def duration(seconds: float) -> str:
    """A time to wait, roughly."""
    return f"{max(seconds, 1):.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"


def make(cases: Sequence[AnalysisCase], runs: int, costs: Path, table: Path) -> None:
    """Run the benchmark; write the costs of all cases, and how they grow."""
    measured = run(cases, runs, say)
    write(measured, costs)
    write(accuracy_costs.growth(measured), table)
    say(f"written: {costs}, {table}\n")


def say(text: str) -> None:
    """A line of the progress; in a terminal it takes the place of the one before."""
    end = "\r" if sys.stderr.isatty() else "\n"
    print(f"\x1b[2K{text}" if end == "\r" else text, end=end, file=sys.stderr, flush=True)
