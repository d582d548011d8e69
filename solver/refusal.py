"""A case that cannot be solved, refused in the same words as an unbuildable muscle."""

from geometry.refusal import Refusal


class UnsolvableCase(Refusal):
    """No such case can be solved."""
