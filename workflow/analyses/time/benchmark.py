"""What a step of time costs on this machine, with a memory and without.

results/tables/time_steps.csv   one row per model: ms of a step without memory and with it, their
                                ratio and difference, and seconds of three cycles of 100 steps

Seconds are of the processor, the least of several runs; a step is what three cycles take more than
one, so that start and mesh are not part of it.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd

from geometry.files import atomic_write
from solver.load_path import PathKind
from workflow.analyses.accuracy.benchmark import Bench, machine
from workflow.analyses.accuracy.costs import SOLVE
from workflow.analyses.analysis import AnalysisCase
from workflow.analyses.time.cases import (
    CYCLES,
    FURTHEST,
    MEMORY,
    MUSCLE,
    PRESSURE,
    RATES,
    SAMPLES,
    cycle,
)
from workflow.study.contents import Study

MODELS = ("membrane", "cylinder", "solid")
PERIOD = 2 * FURTHEST / RATES[1]  # s
EXPECTED = 15.0  # s for a run of all, on the machine on which this was written


def cases(study: Study) -> list[AnalysisCase]:
    """One cycle and three, by every model, without memory and with it."""
    found = []
    for model in MODELS:
        for name, memory in (("elastic", None), ("memory", MEMORY)):
            for count in (1, CYCLES):
                path = cycle(PathKind.ISOBARIC, PRESSURE, FURTHEST, PERIOD, count)
                case = study.muscles[MUSCLE].case(path, model, memory=memory)
                tags: dict[str, str | float] = {"model": model, "rubber": name, "cycles": count}
                found.append(AnalysisCase(case, f"{model}, {name}, cycles: {count}", tags))
    return found


def table(cases: Sequence[AnalysisCase], costs: Sequence[float]) -> pd.DataFrame:
    """One row per model, of the seconds of each case."""
    pairs = zip(cases, costs, strict=True)
    known = {(a.tags["model"], a.tags["rubber"], a.tags["cycles"]): cost for a, cost in pairs}
    rows, more = [], (CYCLES - 1) * SAMPLES
    for model in MODELS:
        elastic, remembering = (
            1000 * (known[model, rubber, CYCLES] - known[model, rubber, 1]) / more
            for rubber in ("elastic", "memory")
        )
        rows.append(
            {
                "model": model,
                "step, elastic [ms]": elastic,
                "step, memory [ms]": remembering,
                "ratio [1]": remembering / elastic,
                "difference [ms]": remembering - elastic,
                "three cycles, memory [s]": known[model, "memory", CYCLES],
            }
        )
    return pd.DataFrame(rows)


def make(study: Study, runs: int, path: Path, say: Callable[[str], None]) -> None:
    """Measure it and write the table, with a note on the machine above it."""
    asked = cases(study)
    least = [float("inf")] * len(asked)
    with TemporaryDirectory() as scratch:
        bench = Bench(Path(scratch))
        for number in range(runs):
            say(f"steps of time, run {number + 1} of {runs}")
            least = [min(a, bench.cost(b)[SOLVE]) for a, b in zip(least, asked, strict=True)]
    with atomic_write(path) as beside, beside.open("w", encoding="utf-8") as stream:
        stream.writelines(f"# {line}\n" for line in machine("minima of CPU seconds"))
        table(asked, least).to_csv(stream, index=False, float_format="%.4g")
    say(f"written: {path}")
