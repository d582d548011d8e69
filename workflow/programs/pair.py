"""Draw what two muscles do that pull against each other on a pulley: torque and stiffness.

Each by its map in results/maps; one that is not there is made first. Without a name all pairs of
the study file are drawn.
"""

import argparse

from workflow.programs import add_entries, entries, results_of
from workflow.study.study import load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_entries(parser, "pair", "pairs")


def run(given: argparse.Namespace) -> int:
    """Draw them."""
    from workflow.answers.maps import pair
    from workflow.answers.maps.build import Builder
    from workflow.report import html_page

    study = load(given.study)
    names = entries(given, study.pairs, "pair")
    folder = given.folder or results_of(given) / "pairs"
    for name in names:
        entry = study.pairs[name]
        wanted = dict.fromkeys((entry.agonist, entry.antagonist or entry.agonist))
        maps = {each: Builder(study, each).built().map for each in wanted}
        made = pair.of_entry(entry, maps)
        output = folder / f"{name}.csv"
        pair.write(made, entry, output)
        html_page.write_beside(output, f"Pair {name}", "pair")
        print("\n".join(pair.report(name, made, entry)))
    return 0
