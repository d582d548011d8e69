"""Answer what a muscle does: of pressure, contraction and force two are given.

As ``muscle ask dmsp20 0.25MPa 12%``, ``muscle ask dmsp20 load 5kg stroke 30mm``, or with
--pressure, --contraction (or --stroke) and --force (or --load). A mass is the load that hangs from
the muscle, a length how much shorter it gets; beside a pressure 0.12 is 12%. The record of the
answer is kept in results/cases; asked again, nothing is solved.
"""

import argparse
import json
import re

from workflow.answers import quantities
from workflow.programs import add_study
from workflow.study.errors import StudyError

OTHER_NAMES = {
    quantities.CONTRACTION: ("--stroke",),
    quantities.FORCE: ("--load",),
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser._negative_number_matcher = re.compile(r"-\.?\d")  # -2% is no option
    parser.add_argument("muscle", help="its name in the study file or the library")
    parser.add_argument("quantities", nargs="*", help="two of them, as 0.25MPa 12%% or 2.5bar 20kg")
    for kind in quantities.KINDS:
        example = quantities.EXAMPLES[kind].replace("%", "%%")
        parser.add_argument(f"--{kind}", *OTHER_NAMES.get(kind, ()), help=f"as {example}")
    parser.add_argument("--model", help="what computes it; by default membrane")
    parser.add_argument(
        "--tolerance", type=_share, help="by which it may be off, as 1%%: takes a model for that"
    )
    parser.add_argument("--variant", default="default", help="effects and numerics of the study")
    parser.add_argument("--json", action="store_true", help="print the answer as JSON")
    add_study(parser)


def _share(text: str) -> float:
    """A share, as 0.01 or 1%."""
    number = text.removesuffix("%")
    try:
        return float(number) / (1 if number == text else 100)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no share, as 0.01 or 1%") from None


def run(given: argparse.Namespace) -> int:
    """Print the answer."""
    from workflow.answers.question import as_dict, ask, lines
    from workflow.answers.studies import with_muscle

    study = with_muscle(given.study, given.muscle)
    asked = {kind: getattr(given, kind) for kind in quantities.KINDS}
    length = study.muscles[given.muscle].muscle.length
    words = quantities.named(given.quantities)
    for name, text in sorted(words, key=lambda word: quantities.is_fraction(word[1])):
        if name:
            kind = name
        elif asked[quantities.PRESSURE] is not None and quantities.is_fraction(text):
            kind = quantities.CONTRACTION  # beside a pressure it has one meaning
        else:
            kind, _ = quantities.read(text, length)
        if asked[kind] is not None:
            raise StudyError(f"{text}: there is a {kind} already, {asked[kind]}")
        asked[kind] = text
    found = ask(
        given.muscle,
        **asked,
        model=given.model,
        tolerance=given.tolerance,
        variant=given.variant,
        study=study,
    )
    print(json.dumps(as_dict(found), indent=2) if given.json else "\n".join(lines(found)))
    return 0
