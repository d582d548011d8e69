"""Names of boundaries and regions: the contract between the meshes and the solver.

The numbers are physical groups of the gmsh files and labels in FreeFEM.
"""

from enum import IntEnum


class Boundary(IntEnum):
    """Lines of the section and faces of the cell.

    MIDPLANE and END are the end points of the meridian, INNER its line.
    """

    MIDPLANE = 1  # Z = 0, mid-length: symmetry
    END = 2  # the tube's end face, which is Z = L/2 or, with a clamp, L/2 + cap_length
    INNER = 3  # inner surface, under pressure
    OUTER = 4  # outer surface
    LAYER_1 = 5  # inner thread layer, clockwise
    LAYER_2 = 6  # outer thread layer, counter-clockwise
    ANGLE_LOW = 7  # periodic faces of the cell: T = 0
    ANGLE_HIGH = 8  # T = 2 pi / sectors
    AXIAL_LOW = 9  # Z = 0
    AXIAL_HIGH = 10  # Z = length of the cell


class Region(IntEnum):
    """Areas of the section, volume of the cell."""

    WALL = 1  # rubber
