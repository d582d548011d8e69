"""The axisymmetric section of the wall, by FreeFEM."""
