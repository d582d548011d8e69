"""The parametric muscle and its gmsh meshes. Lengths in mm; knows no material and no solver."""
