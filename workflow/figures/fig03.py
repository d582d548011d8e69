"""The parametric muscle in three dimensions: tube, caps and all threads of both layers.

It replaces the paper's CATIA model; a number changed in the study changes the drawing. Of several
muscles in the scene the first is drawn, and the others are named.
"""

import math
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from geometry.muscle import Braid, Muscle
from workflow.figures.muscle_drawing import draw as draw_muscle

LENGTHS = ("inner_diameter", "wall_thickness", "length", "cap_length")
LAYERS = ["layer_diameter_1 [mm]", "layer_diameter_2 [mm]"]


def table(data: Any) -> pd.DataFrame:
    """The numbers of every muscle, one row each; of a bare tube without those of a braid."""
    rows = []
    for name, muscle in data.muscles.items():
        row: dict[str, Any] = {"muscle": name}
        row |= {f"{length} [mm]": getattr(muscle, length) for length in LENGTHS}
        if braid := muscle.braid:
            row |= dict(zip(LAYERS, braid.layer_diameters, strict=True))
            row |= {"lead [mm]": braid.lead, "threads per layer [1]": braid.threads}
            row["braid_angle [deg]"] = round(math.degrees(braid.angle), 10)
            row["axial_spacing [mm]"] = braid.axial_spacing
        rows.append(row)
    return pd.DataFrame(rows)


def draw(table: pd.DataFrame) -> Figure:
    """The muscle of the first row."""
    row = table.iloc[0]
    braid = None
    if "lead [mm]" in row and row["lead [mm]"] > 0:
        braid = Braid(
            lead=float(row["lead [mm]"]),
            threads=int(row["threads per layer [1]"]),
            layer_diameters=(float(row[LAYERS[0]]), float(row[LAYERS[1]])),
        )
    lengths = {length: float(row[f"{length} [mm]"]) for length in LENGTHS}
    others = [str(name) for name in table["muscle"].iloc[1:]]
    return draw_muscle(Muscle(**lengths, braid=braid), str(row["muscle"]), others)
