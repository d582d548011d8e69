"""What a design has given, as text, files and a figure."""

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from geometry.files import atomic_write
from geometry.readable import plain
from workflow.answers import sheet, sheet_files
from workflow.answers.design.problem import GIVEN, TRUTH, Problem
from workflow.answers.design.search import MISSED, Found, Missed, Trial, looked_for
from workflow.answers.sheet import Sheet
from workflow.answers.store import Store
from workflow.figures import style
from workflow.figures.style import COLUMN_WIDTH, FULL, SERIES, labelled, legend, panels, percent
from workflow.study.contents import Study

ACTIVE = 2e-3  # share of its limit within which a requirement decides the muscle
END = 2 * MISSED  # share by which the end of a trade-off may be off the best by one objective
SHARES = (0.25, 0.5, 0.75)  # of the way from one end of a trade-off to the other
UNITS = {"inner_diameter": "mm", "wall_thickness": "mm", "length": "mm", "angle": "degree"}


def designed(study: Study, name: str) -> list[Found]:
    """What a design gives: one result, or of two objectives those of the trade-off between them.

    Each end is the best by one objective and, of those that are within ``END`` of it, the best
    by the other: where one objective leaves much open it alone would end far from the curve.
    Between its ends the first objective is as small as may be where the second is at most so much,
    in equal steps: unlike the least of a weighted sum that reaches every part of the curve, as the
    curve may be hollow. Muscles that are no better than another by either objective are left out.
    """
    problem, store = Problem(study, name), Store(study)
    if len(problem.objectives) == 1:
        return [looked_for(problem, store)]
    first, last = looked_for(problem, store, 0), looked_for(problem, store, 1)
    if first.best is None or last.best is None:
        return [first if first.best is None else last]
    if np.array_equal(first.best.x, last.best.x):
        return [replace(first, agreed=True)]  # there is nothing between them
    first, last = _ended(problem, store, first, 0), _ended(problem, store, last, 1)
    measure = problem.objectives[1]
    assert first.best is not None
    assert last.best is not None
    start, end = first.best.measures[measure], last.best.measures[measure]
    between = [
        looked_for(problem, store, 0, problem.bound(measure, start + share * (end - start)))
        for share in SHARES
    ]
    return _undominated([first, *between, last])


def _ended(problem: Problem, store: Store, end: Found, objective: int) -> Found:
    """Of the muscles that are as good by an objective as its best the best by the other one."""
    assert end.best is not None
    measure = problem.objectives[objective]
    best = end.best.measures[measure]
    bound = problem.bound(measure, best + END * abs(best))
    found = looked_for(problem, store, 1 - objective, bound)
    return end if found.best is None else found


def _undominated(results: Sequence[Found]) -> list[Found]:
    """Results to which no other one is better or equal by both objectives, in their order."""
    kept: list[Found] = []
    for found in results:
        if found.best is None:
            continue
        size = _sizes(found, found.best)
        others = [_sizes(k, k.best) for k in (*kept, results[-1]) if k.best and k is not found]
        if not any((other <= size).all() for other in others):
            kept = [k for k in kept if k.best and not (size <= _sizes(k, k.best)).all()]
            kept.append(found)
    return kept


def _sizes(found: Found, best: Trial) -> NDArray[np.float64]:
    """The objectives of a muscle."""
    return np.array([best.measures[measure] for measure in found.problem.objectives])


# --- text -----------------------------------------------------------------------------------------


def entry(problem: Problem, best: Trial, name: str) -> str:
    """The muscle as an entry of ``muscles:``."""
    values = problem.values(best.x)
    base = values.pop("base", problem.entry.base)
    said = ", ".join(
        f"{key}: {value:g}" if isinstance(value, float) else f"{key}: {value}"
        for key, value in values.items()
    )
    return f"  {name}: {{base: {base}, {said}}}"


def texts(name: str, results: Sequence[Found]) -> str:
    """The file to paste from; says why where there is nothing to paste."""
    problem = results[0].problem
    named = list(zip(names(name, results), results, strict=True))
    lines = [f"# {line}".rstrip() for own, found in named for line in report(found, own)]
    entries = [entry(problem, found.best, own) for own, found in named if found.best is not None]
    if not entries:
        return "\n".join([*lines, ""])
    lines.append("# Paste the lines below `muscles:` under the same heading of the study file.")
    return "\n".join([*lines, "muscles:", *entries, ""])


def names(name: str, results: Sequence[Found]) -> list[str]:
    """Of the muscles of a design: of a trade-off they are numbered."""
    return [name] if len(results) == 1 else [f"{name}_{k}" for k in range(1, len(results) + 1)]


def report(found: Found, name: str) -> list[str]:
    """A result in lines, as the muscle of a name."""
    problem, best = found.problem, found.best
    cost = f"{found.states} states by the cylinder, {found.solves} curves by the {TRUTH}"
    if best is None:
        lines = [f"{name}: no muscle meets all requirements ({cost})"]
        return lines + _why(found)
    values = ", ".join(f"{k} {v:g}" if isinstance(v, float) else f"{k} {v}" for k, v in (
        problem.values(best.x).items()
    ))  # fmt: skip
    lines = [f"{name}: {values} ({cost})"]
    lines += [
        f"  {problem.text_of(measure, best.measures[measure])}" for measure in problem.objectives
    ]
    if found.agreed:
        lines.append("  no other muscle is better by either objective: there is nothing to trade")
    for requirement in [*problem.requirements, *([found.bound] if found.bound else [])]:
        value = requirement.value(best.measures)
        decides = "  <- decides" if requirement.violation(best.measures) > -ACTIVE else ""
        lines.append(f"  {requirement.name}: {requirement.text}, is {plain(value, 5)}{decides}")
    for key, (low, high) in found.flat.items():
        at = best.x[problem.numbers.index(key)]
        ends = problem.bounds[problem.numbers.index(key)]
        edge = ", at the end of its range" if np.isclose(at, ends).any() else ""
        lines.append(f"  {key} {_span(low, high)} costs at most 1 % of the objective{edge}")
    return lines


def _span(low: float, high: float) -> str:
    """Two numbers, with as many digits as tell them apart."""
    apart = (d for d in range(4, GIVEN) if plain(low, d) != plain(high, d))
    digits = next(apart, 4)
    return f"{plain(low, digits)} to {plain(high, digits)}"


def _why(found: Found) -> list[str]:
    """What stands in the way."""
    lines = []
    if found.trials:
        worst = min(trial.worst for trial in found.trials)
        count = len(found.trials)
        lines = [f"  the nearest of {count} by the {TRUTH} misses by {plain(100 * worst, 2)} %"]
    if not found.missed:
        return [*lines, "  no few of them stand in the way: look at the ranges of what is free"]
    return lines + [_said(missed, first=k == 0) for k, missed in enumerate(found.missed)]


def _said(missed: Missed, *, first: bool) -> str:
    """One set of requirements that stands in the way."""
    each = [
        f"{r.name} ({r.text}; {plain(missed.measures[r.measure], 4)} can be had, missed by "
        f"{plain(100 * max(r.violation(missed.measures), 0), 2)} %)"
        for r in missed.requirements
    ]
    start = "without" if first else "or without"
    return f"  {start} {' and '.join(each)} all others can be met"


def as_dict(found: Found) -> dict[str, Any]:
    """A result for JSON."""
    problem = found.problem

    def trial(each: Trial) -> dict[str, Any]:
        return {
            "values": problem.values(each.x),
            "objectives": {m: each.measures[m] for m in problem.objectives},
            "requirements": {
                r.name: {"is": each.measures[r.measure], "limit": r.limit, "unit": r.unit,
                         "missed": r.violation(each.measures)}
                for r in problem.requirements
            },
            "worst": each.worst,
            "predicted": each.predicted,
        }  # fmt: skip

    return {
        "design": problem.name,
        "objective": problem.objectives[found.objective],
        "bound": found.bound.limit if found.bound else None,
        "best": trial(found.best) if found.best is not None else None,
        "active": [
            r.name
            for r in problem.requirements
            if found.best is not None and r.violation(found.best.measures) > -ACTIVE
        ],
        "flat": {key: list(ends) for key, ends in found.flat.items()},
        "trials": [trial(each) for each in found.trials],
        "in_the_way": [
            {
                "without": [r.name for r in missed.requirements],
                "missed": [max(r.violation(missed.measures), 0) for r in missed.requirements],
            }
            for missed in found.missed
        ],
        "tolerance": MISSED,
        "cylinder_states": found.states,
        "solid_solves": found.solves,
    }


# --- files ----------------------------------------------------------------------------------------


def table(results: Sequence[Found]) -> pd.DataFrame:
    """One row per requirement and objective, one column per muscle that was found."""
    problem = results[0].problem
    rows: list[dict[str, Any]] = [
        {"name": r.name, "what": r.what, "unit": r.unit,
         "limit": ("≥ " if r.sense > 0 else "≤ ") + plain(r.limit, GIVEN)}
        for r in problem.requirements
    ]  # fmt: skip
    rows += [{"name": "objective", "what": problem.text_of(m, 0.0).split(":")[0], "limit": "",
              "unit": problem.text_of(m, 0.0).split()[-1]} for m in problem.objectives]  # fmt: skip
    rows += [{"name": "chosen", "what": key, "limit": "", "unit": UNITS.get(key, "")}
             for key in _keys(problem)]  # fmt: skip
    measures = [r.measure for r in problem.requirements] + problem.objectives
    for number, found in enumerate(results, 1):
        best = found.best
        if best is None:
            continue
        signs = [1] * len(problem.requirements)
        signs += [-1 if m.startswith("-") else 1 for m in problem.objectives]
        values: list[Any] = [
            sign * best.measures[m] for sign, m in zip(signs, measures, strict=True)
        ]
        values += list(problem.values(best.x).values())
        for row, value in zip(rows, values, strict=True):
            row[f"muscle {number}"] = value
    return pd.DataFrame(rows)


def _keys(problem: Problem) -> list[str]:
    return list(problem.values(np.array([low for low, _ in problem.bounds])))


def sheets(study: Study, name: str, results: Sequence[Found]) -> list[Sheet]:
    """Sheets of the muscles that were found, of the curves that have judged them."""
    made = []
    store = Store(study)
    for number, found in enumerate(results, 1):
        if found.best is None:
            continue
        problem = found.problem
        studied = problem.muscle(found.best.x)
        case = problem.case(studied, problem.entry.pressure)
        loads = [
            r.limit
            for r in problem.requirements
            if r.unit == "N" and r.sense > 0 and r.limit > 0
        ]  # fmt: skip
        own = name if len(results) == 1 else f"{name}_{number}"
        load = min(loads) if loads else None
        made.append(sheet.sheet(studied, own, "default", case, store.solution(case), load))
    return made


def draw(results: Sequence[Found], made: Sequence[Sheet]) -> Figure:
    """The curves of what was found, the forces that were required, and a trade-off."""
    found = [(each, each.best) for each in results if each.best is not None]
    trades = len(results[0].problem.objectives) == 2 and len(found) > 1
    width, columns = (FULL, 2) if trades else (COLUMN_WIDTH, 1)
    figure, axes = panels(width, 3.2, 1, columns, gap=(0.75, 0.0))
    ax, problem = axes[0, 0], results[0].problem
    for number, each in enumerate(made):
        contraction = np.linspace(0, each.curve.contraction[-1], 200)
        color = SERIES[number % len(SERIES)]["color"]
        ax.plot(contraction, each.curve.force(contraction), color=color, label=each.muscle)
    for requirement in problem.requirements:
        kind, *numbers = requirement.measure.split()
        if kind == "force" and float(numbers[0]) == problem.entry.pressure:
            marker = "^" if requirement.sense > 0 else "v"
            said = f"{requirement.name}: {'at least' if requirement.sense > 0 else 'at most'}"
            ax.plot([float(numbers[1])], [requirement.limit], marker=marker, color="black",
                    linestyle="none", label=said)  # fmt: skip
    ax.axhline(0, color="black", linewidth=0.7)
    ax.set_xlabel(f"contraction [%], {problem.entry.pressure:g} MPa")
    ax.set_ylabel("force [N]")
    percent(ax.xaxis, 0.05)
    if trades:
        _trade_off(axes[0, 1], problem, [best for _, best in found])
    legend(figure, labelled(axes))
    return figure


def _trade_off(ax: Axes, problem: Problem, best: Sequence[Trial]) -> None:
    """Muscles by both objectives: what more of one costs of the other."""
    signs = [-1 if measure.startswith("-") else 1 for measure in problem.objectives]
    values = np.array([[b.measures[m] for m in problem.objectives] for b in best]) * signs
    ax.plot(*values.T, color="0.6", linewidth=0.8, zorder=1)
    for number, point in enumerate(values):
        ax.plot(*point, marker="o", linestyle="none", color=SERIES[number % len(SERIES)]["color"])
    names = []
    for measure in problem.objectives:
        name, value = problem.text_of(measure, 0.0).split(": ")
        names.append(f"{name} [{value.split()[-1]}]")
    ax.set_xlabel(names[0])
    ax.set_ylabel(names[1])


def write(study: Study, name: str, results: Sequence[Found], output: Path) -> None:
    """Write ``output`` with the endings .yaml, .json, .csv, .png, .svg; and the sheet beside it."""
    made = sheets(study, name, results)
    with atomic_write(output.with_suffix(".json")) as beside:
        text = json.dumps([as_dict(found) for found in results], indent=1, default=_plain)
        beside.write_text(text + "\n")
    with atomic_write(output.with_suffix(".csv")) as beside:
        table(results).to_csv(beside, index=False)
    figure = draw(results, made)
    for suffix in (".svg", ".png"):
        style.save(figure, output.with_suffix(suffix))
    if made:
        with atomic_write(output.with_name(f"{name}_sheet.csv")) as beside:
            sheet_files.table(made).to_csv(beside, index=False)
    with atomic_write(output.with_suffix(".yaml")) as beside:
        beside.write_text(texts(name, results))


def _plain(value: Any) -> Any:
    """Numbers of NumPy for JSON."""
    found = value.item() if hasattr(value, "item") else str(value)
    return None if isinstance(found, float) and not math.isfinite(found) else found
