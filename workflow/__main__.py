"""The programs of the workflow: ``python -m workflow --help``.

Every rule of Snakemake calls one of these or those of geometry and solver. Whatever is wrong with
the input ends with status 1 and a message of a few lines.
"""

import argparse
import sys
from pathlib import Path

from workflow.study.errors import StudyError

STUDY = Path("config/config.yaml")
DATASET = Path("results/dataset.nc")
FAILURES = Path("results/tables/failures.csv")


def main(arguments: list[str] | None = None) -> int:
    """Parse the command line and run one program."""
    given = _parser().parse_args(arguments)
    try:
        return given.program(given)
    except (StudyError, OSError) as error:
        print(error, file=sys.stderr)
        return 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m workflow", description=__doc__)
    programs = parser.add_subparsers(required=True, metavar="PROGRAM")

    def add(program, summary: str, *, study: bool = True) -> argparse.ArgumentParser:
        entry = programs.add_parser(program.__name__.strip("_"), help=summary, description=summary)
        entry.set_defaults(program=program)
        if study:
            entry.add_argument("--study", type=Path, default=STUDY)
        return entry

    entry = add(_gather, "Write the dataset and the tables of failures and deviations.")
    entry.add_argument("--dataset", type=Path, default=DATASET)
    entry.add_argument("--failures", type=Path, default=FAILURES)
    entry.add_argument("--deviation", type=Path, help="table of deviations from the force maps")
    entry = add(_figure, "Draw the figure of a scene and write its numbers.")
    entry.add_argument("--scene", required=True)
    entry.add_argument("--output", type=Path, required=True, help=".png; .svg and .csv beside it")
    entry = add(_fields, "Write the fields of a recorded state for ParaView.", study=False)
    entry.add_argument("--record", type=Path, required=True)
    entry.add_argument("--state", type=int, required=True, help="number of the stop, from 0")
    entry.add_argument("--output", type=Path, required=True, help=".vtu")
    entry = add(_calibrate, "Fit muscles to measured forces, as the study file says.")
    entry.add_argument("--tables", type=Path, default=Path("results/tables"), help="folder")
    entry.add_argument("--figures", type=Path, default=Path("results/figures"), help="folder")
    entry.add_argument("--muscles", type=Path, default=Path("results/calibration"), help="folder")
    entry = add(_page, "Write a page of the report.", study=False)
    entry.add_argument("--title", required=True)
    entry.add_argument("--caption", type=Path, required=True)
    entry.add_argument("--pictures", type=Path, nargs="*", default=[])
    entry.add_argument("--tables", type=Path, nargs="*", default=[])
    entry.add_argument("--output", type=Path, required=True, help=".html")
    add(_explain, "Say what every scene wants, what it gets and why, and which scenes share that.")
    add(_weigh, "Write what the planner knows of effects, from the solved study of effects.")
    of_study = {"metavar": "STUDY", "help": "of this study of the models; else of the scenes"}
    entry = add(_cases, "List the cases: key, status of the record, label.")
    entry.add_argument("--name", **of_study)
    entry = add(_study, "Write the table and the figures of a study of the models.")
    entry.add_argument("--name", required=True)
    entry.add_argument("--table", type=Path, required=True)
    entry.add_argument("--figures", type=Path, default=Path("results/figures"), help="folder")
    entry.add_argument("--dataset", type=Path, default=DATASET)
    entry = add(_benchmark, "Measure what the accuracy study costs on this machine.")
    entry.add_argument("--runs", type=int, default=3, help="of every case; medians are taken")
    entry.add_argument("--costs", type=Path, default=Path("results/cost.csv"))
    entry.add_argument("--table", type=Path, default=Path("results/tables/benchmark.csv"))
    entry = add(_bounds, "Take over the errors that the accuracy study has found.", study=False)
    entry.add_argument("--table", type=Path, default=Path("results/tables/accuracy.csv"))
    entry = add(_failures, "List what failed; status 1 if anything did.", study=False)
    entry.add_argument("--table", type=Path, default=FAILURES)
    entry = add(_retry, "Delete the records of failed cases, so that they are solved again.")
    entry.add_argument("--name", **of_study)
    return parser


def _plan(given: argparse.Namespace):
    from workflow.plan.plan import plan
    from workflow.study.study import load

    return plan(load(given.study))


def _gather(given: argparse.Namespace) -> int:
    from geometry.files import aside
    from workflow.analyses import dataset_groups
    from workflow.data import dataset, deviation, records, reference
    from workflow.run import failures

    plan = _plan(given)
    curves = records.curves_of_study(plan)
    with dataset_groups.alone(given.dataset):
        others = dataset_groups.found(given.failures.parent)
        tree = dataset.build(curves, plan.study.muscles, effects=True, others=others)
        dataset.write(tree, given.dataset)
    failures.write(plan, {curve.key: curve.solution for curve in curves}, given.failures)
    if given.deviation:
        named = {name: muscle.reference for name, muscle in plan.study.muscles.items()}
        rows = deviation.table(tree, reference.of_muscles(named))
        with aside(given.deviation) as beside:
            rows.to_csv(beside, index=False, float_format="%.6g")
    return 0


def _figure(given: argparse.Namespace) -> int:
    from workflow.figures import figure

    figure.make(_plan(given), given.scene, given.output)
    return 0


def _fields(given: argparse.Namespace) -> int:
    from workflow.data import paraview

    paraview.write(given.record, given.state, given.output)
    return 0


def _calibrate(given: argparse.Namespace) -> int:
    from workflow.analyses.calibration import program

    program.run(given.study, given.tables, given.figures, given.muscles)
    return 0


def _page(given: argparse.Namespace) -> int:
    from workflow.report import html_page

    html_page.write(given.output, given.title, given.caption, given.pictures, given.tables)
    return 0


def _explain(given: argparse.Namespace) -> int:
    from workflow.plan import explain

    for line in explain.lines(_plan(given)):
        print(line)
    return 0


def _weigh(given: argparse.Namespace) -> int:
    from workflow.analyses.effects import weigh
    from workflow.plan import effect_costs

    weigh.measure(str(given.study))
    print(f"written: {effect_costs.FILE.name}, {effect_costs.origin()}")
    return 0


def _cases(given: argparse.Namespace) -> int:
    from workflow.data import records

    for key, case in _asked(given).items():
        print(f"{key}  {records.status(key, case.label):13}  {case.label}")
    return 0


def _asked(given: argparse.Namespace):
    """Cases by key: those of the scenes, or those of a study that is named."""
    if given.name is None:
        return _plan(given).cases
    from workflow.analyses import analysis

    return {asked.case.key: asked for asked in analysis.cases(given.name, str(given.study))}


def _study(given: argparse.Namespace) -> int:
    from workflow.analyses import analysis, dataset_groups

    analysis.evaluate(given.name, str(given.study), given.table, given.figures)
    dataset_groups.add(given.name, given.table, given.dataset)
    return 0


def _benchmark(given: argparse.Namespace) -> int:
    from workflow.analyses.accuracy import benchmark

    benchmark.make(given.study, given.runs, given.costs, given.table)
    return 0


def _bounds(given: argparse.Namespace) -> int:
    from workflow.analyses.accuracy.take_over import take_over

    take_over(given.table)
    return 0


def _failures(given: argparse.Namespace) -> int:
    from workflow.run import failures

    if not given.table.exists():
        raise StudyError(f"{given.table}: there is no such table; run snakemake")
    text, failed = failures.report(given.table)
    if text:
        print(text, file=sys.stderr if failed else sys.stdout)
    return 1 if failed else 0


def _retry(given: argparse.Namespace) -> int:
    from workflow.data import records

    for key, case in _asked(given).items():
        status = records.status(key, case.label)
        if status not in ("converged", "limit_point", "not solved"):
            records.path_of(key).unlink()
            if status == "mesh_failed":
                Path("results/meshes", case.mesh).unlink(missing_ok=True)
            print(f"will be solved again (was {status}): {case.label}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
