"""Answers to what people ask of a muscle: one state, its data sheet, the muscle they need.

For whoever asks in Python::

    from workflow import answers

    found = answers.ask("dmsp20", pressure="0.25 MPa", contraction="12 %")
    found.force, found.stiffness
"""

from importlib import import_module
from typing import Any

ASKED = {"ask": "workflow.answers.question"}  # functions, and where they are


def __getattr__(name: str) -> Any:
    """A function, imported when it is asked for."""
    if name in ASKED:
        return getattr(import_module(ASKED[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
