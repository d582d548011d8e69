"""One periodic cell of the braid, by FreeFEM."""
