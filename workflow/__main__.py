"""The programs of the workflow: ``muscle PROGRAM``, or ``python -m workflow PROGRAM``.

Those that people seldom call stand last: rules of Snakemake call them, or they take over results
into the sources. Whatever is wrong with the input ends with status 1 and a message of a few lines.
"""

import argparse
import ast
import os
import resource
import select
import signal
import sys
from importlib import import_module
from pathlib import Path

from workflow.study.errors import StudyError, choices

FOLDER = Path(__file__).parent / "programs"
INTERRUPTED = 128 + signal.SIGINT  # exit status, as a shell gives it
CUT_OFF = 128 + signal.SIGPIPE
OF_RULES = {  # programs that people seldom call
    *("analysis", "benchmark", "draw", "failures", "gather", "page", "sheets", "solve"),
    *("likeness", "mesh-errors", "numbers", "weigh"),
}
NO_PROGRAMS = ("__init__", "case_options")  # what programs share


def main(arguments: list[str] | None = None) -> int:
    """Run the program that the first argument names; only that is imported."""
    given = sys.argv[1:] if arguments is None else arguments
    os.environ["MPLBACKEND"] = "agg"  # that of a notebook may not be here
    os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")  # files are whole or absent
    name = given[0] if given else ""
    if name not in names():
        if name and not name.startswith("-"):
            seldom = sorted(names(), key=lambda name: name in OF_RULES)
            print(
                f"muscle {name}: no such program\n  allowed: {choices(name, seldom)}",
                file=sys.stderr,
            )
            return 2
        _parser().parse_args(given or ["--help"])
    program = import_module(f"workflow.programs.{_module(name)}")
    parser = argparse.ArgumentParser(prog=f"muscle {name}", description=program.__doc__)
    program.add_arguments(parser)
    try:
        status = int(program.run(parser.parse_intermixed_args(given[1:])))  # options anywhere
        sys.stdout.flush()
        return status
    except (StudyError, OSError) as error:
        if isinstance(error, BrokenPipeError) and _nobody_reads():
            return CUT_OFF
        print(error, file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return INTERRUPTED
    finally:
        _note(name)


def _nobody_reads() -> bool:
    """Whether who reads the output, as ``head``, has had enough; what is left of it is dropped."""
    output = select.poll()
    output.register(sys.stdout.fileno(), 0)
    gone = any(event & select.POLLERR for _, event in output.poll(0))
    if gone:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return gone


def _note(name: str) -> None:
    """Add what a program took of the processor to a file, where one is named (run/times.py)."""
    if path := os.environ.get("MUSCLE_TIMES"):
        kinds = resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN
        seconds = sum(sum(resource.getrusage(kind)[:2]) for kind in kinds)
        with open(path, "a", encoding="utf-8") as stream:
            stream.write(f"{name} {seconds:.3f}\n")


def names() -> list[str]:
    """The programs there are; a name of several words has hyphens."""
    files = (file.stem for file in FOLDER.glob("*.py") if file.stem not in NO_PROGRAMS)
    return sorted(name.replace("_", "-") for name in files)


def _module(name: str) -> str:
    return name.replace("-", "_")


def _parser() -> argparse.ArgumentParser:
    """What answers to --help and to a name that is none."""
    parser = argparse.ArgumentParser(prog="muscle", description=__doc__)
    programs = parser.add_subparsers(required=True, metavar="PROGRAM")
    for name in sorted(names(), key=lambda name: name in OF_RULES):
        text = ast.get_docstring(ast.parse((FOLDER / f"{_module(name)}.py").read_bytes())) or ""
        programs.add_parser(name, help=text.partition("\n")[0])
    return parser


if __name__ == "__main__":
    sys.exit(main())
