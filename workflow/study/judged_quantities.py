"""Quantities of a scene that a tolerance may be about, and the variables of the record."""

VARIABLES = {
    "inner_diameter": "inner_diameter_inflated",
    "outer_diameter": "outer_diameter",
    "volume": "volume",
}
