"""All analyses by name, found by folder. What one of them needs stands in ``analysis``."""

from workflow.analyses.analysis import Analysis, named, names

# Found by their folders.
DATA = ("workflow/analyses/*/__init__.py", "workflow/analyses/*/analysis.py")

ANALYSES: dict[str, Analysis] = {name: named(name) for name in names()}
