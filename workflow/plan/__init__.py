"""Scenes become curves, curves become cases: which model, which mesh, and why."""
