"""Analyses of the models themselves, one folder each; what they share is in ``analysis``."""
