"""All analyses by name, found by folder. What one of them needs stands in ``analysis``."""

from workflow.analyses.analysis import Analysis, named, names

DATA = ("workflow/analyses/*/analysis.py",)  # found by name

ANALYSES: dict[str, Analysis] = {name: named(name) for name in names()}
