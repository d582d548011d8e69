"""The cases that a program is about: those of the scenes, or those of an analysis that is named."""

import argparse
from collections.abc import Mapping

from workflow.analyses import analysis
from workflow.analyses.analysis import AnalysisCase
from workflow.plan.plan import PlannedCase
from workflow.programs import add_study, plan_of


def add_cases(parser: argparse.ArgumentParser) -> None:
    """The options that say which."""
    add_study(parser)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--name", metavar="ANALYSIS", help="of this analysis; else of the scenes")
    which.add_argument("--scene", help="of this scene only")


def cases_of(given: argparse.Namespace) -> Mapping[str, PlannedCase | AnalysisCase]:
    """Cases by key."""
    if given.name is None:
        plan = plan_of(given)
        return plan.cases if given.scene is None else plan.cases_of(given.scene)
    return {asked.key: asked for asked in analysis.cases(given.name, str(given.study))}
