"""Records, what was measured, and what is made of both: dataset, tables of states, fields.

For whoever reads results in Python::

    from workflow import data

    tree = data.open("results/dataset.nc", muscle="dmsp20")    groups at their labels
    curve = data.curve("results/dataset.nc", muscle="dmsp20", model=model, pressure=0.3)
"""

from importlib import import_module
from typing import Any

READERS = ("open", "curve")  # of workflow/data/view.py


def __getattr__(name: str) -> Any:
    """A reader of the dataset, imported when it is asked for: no other module here needs it."""
    if name in READERS:
        return getattr(import_module("workflow.data.view"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
