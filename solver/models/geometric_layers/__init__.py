"""Eq. (1) at the layers of threads."""
