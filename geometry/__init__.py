"""The muscle, parametric, and its meshes by gmsh. Lengths in mm; knows no material and no solver."""
