"""Eq. (1) of the paper."""
