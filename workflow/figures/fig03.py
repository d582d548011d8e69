"""The parametric muscle in three dimensions: tube, caps and all threads of both layers.

It replaces the paper's CATIA model; a number changed in the study changes the drawing. Of several
muscles in the scene the first is drawn, and the others are named.
"""

import math
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from geometry.braid import MOST_LAYERS
from geometry.muscle import AnyBraid, Braid, LayeredBraid, Muscle
from workflow.figures.muscle_drawing import draw as draw_muscle

LENGTHS = ("inner_diameter", "wall_thickness", "length", "cap_length")
COLUMNS = {  # of a layer, by field of its braid
    "kinds": "kind",
    "layer_diameters": "diameter [mm]",
    "leads": "lead [mm]",
    "threads": "threads [1]",
    "senses": "sense [1]",
    "stiffness_shares": "stiffness share [1]",
}
LISTED = "layer_1 kind"
LAYERS = ["layer_diameter_1 [mm]", "layer_diameter_2 [mm]"]


def table(data: Any) -> pd.DataFrame:
    """The numbers of every muscle, one row each; of a bare tube without those of a braid."""
    rows = []
    for name, muscle in data.muscles.items():
        row: dict[str, Any] = {"muscle": name}
        row |= {f"{length} [mm]": getattr(muscle, length) for length in LENGTHS}
        braid = muscle.braid
        if isinstance(braid, LayeredBraid):
            for number, values in enumerate(zip(*_lists(braid).values(), strict=True), 1):
                names = (f"layer_{number} {name}" for name in _lists(braid))
                row |= dict(zip(names, values, strict=True))
        elif braid:
            row |= dict(zip(LAYERS, braid.layer_diameters, strict=True))
            row |= {"lead [mm]": braid.lead, "threads per layer [1]": braid.threads}
            row["braid_angle [deg]"] = round(math.degrees(braid.angle), 10)
            row["axial_spacing [mm]"] = braid.axial_spacing
        rows.append(row)
    return pd.DataFrame(rows)


def draw(table: pd.DataFrame) -> Figure:
    """The muscle of the first row."""
    row = table.iloc[0]
    braid: AnyBraid | None = None
    if "lead [mm]" in row and row["lead [mm]"] > 0:
        braid = Braid(
            lead=float(row["lead [mm]"]),
            threads=int(row["threads per layer [1]"]),
            layer_diameters=(float(row[LAYERS[0]]), float(row[LAYERS[1]])),
        )
    if LISTED in row and isinstance(row[LISTED], str):
        braid = _layered(row)
    lengths = {length: float(row[f"{length} [mm]"]) for length in LENGTHS}
    others = [str(name) for name in table["muscle"].iloc[1:]]
    return draw_muscle(Muscle(**lengths, braid=braid), str(row["muscle"]), others)


def _lists(braid: LayeredBraid) -> dict[str, tuple[Any, ...]]:
    """Values of its layers by the name of their column."""
    return {column: getattr(braid, name) for name, column in COLUMNS.items()}


def _layered(row: "pd.Series[Any]") -> LayeredBraid:
    """The braid of a row with layers."""
    found: dict[str, tuple[Any, ...]] = {}
    for name, column in COLUMNS.items():
        cells = [row.get(f"layer_{number} {column}") for number in range(1, MOST_LAYERS + 1)]
        known = [cell for cell in cells if not pd.isna(cell)]
        whole = name in ("threads", "senses")
        found[name] = tuple(int(cell) for cell in known) if whole else tuple(known)
    return LayeredBraid(**found)
