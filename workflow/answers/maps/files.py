"""A map as files: netCDF, CSV, .mat, its measured error, a figure."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from geometry.files import atomic_write
from geometry.readable import plain
from workflow.answers.maps import fmu
from workflow.answers.maps.build import NEAR, Checked
from workflow.answers.maps.table import FORCE, UNITS, Map
from workflow.figures import style
from workflow.figures.style import FULL, panels, percent

LINES = 8  # pressures that are drawn at most
ROOM = 0.13  # left of the curves, for their names, as a share of their width
APART, WIDE = 8, 45  # height and width of a name [points]


def write(found: Checked, output: Path) -> bool:
    """Write ``output`` with the endings .nc, .mat, .csv, .fmu, .json, .png and .svg.

    Whether the FMU is compiled: without a C compiler it is not.
    """
    made = found.map
    data = made.dataset()
    data.attrs |= errors(found)
    with atomic_write(output.with_suffix(".nc"), suffix=".nc") as beside:
        data.to_netcdf(beside, engine="h5netcdf")
    with atomic_write(output.with_suffix(".csv")) as beside:
        table(made).to_csv(beside, index=False)
    with atomic_write(output.with_suffix(".mat"), suffix=".mat") as beside:
        _write_mat(made, beside)
    with atomic_write(output.with_suffix(".json")) as beside:
        beside.write_text(json.dumps(as_dict(found), indent=1) + "\n")
    compiled = fmu.write(made, output.with_suffix(".fmu"))
    figure = draw(found)
    for suffix in (".svg", ".png"):
        style.save(figure, output.with_suffix(suffix))
    return compiled


def errors(found: Checked) -> dict[str, float]:
    """Largest errors, with their units in their names."""
    return {
        "force_error_N": found.error,
        "force_error_near_threshold_N": found.error_near,
        "pressure_error_MPa": found.error_inverse,
    }


def as_dict(found: Checked) -> dict[str, Any]:
    """The error of a map and the states at which it was measured, for JSON."""
    names = ("pressure_MPa", "contraction", "force_by_map_N", "force_N", "near_threshold")
    made = found.map
    return {
        "muscle": made.muscle,
        "model": made.model,
        "pressures": made.pressure.tolist(),
        "contractions": made.contraction.tolist(),
        "valid_share": float(np.mean(made.valid)),
        **errors(found),
        "near_threshold_MPa": NEAR,
        "states": [dict(zip(names, row, strict=True)) for row in found.states.tolist()],
        "solves": found.solves,
    }


def table(made: Map) -> pd.DataFrame:
    """One row per state of the grid; numbers of states that are not valid are left out."""
    p, e = np.meshgrid(made.pressure, made.contraction, indexing="ij")
    columns = {"pressure [MPa]": p.ravel(), "contraction [1]": e.ravel()}
    for name, values in made.tables.items():
        if name.endswith("mixed"):
            continue
        quantity = name.split("_by_")[0]
        unit = UNITS[quantity] + ("/MPa" if name.endswith("pressure") else "")
        shown = np.where(made.valid, values, np.nan)
        columns[f"{name} [{unit}]"] = shown.ravel()
    return pd.DataFrame(columns | {"valid": made.valid.ravel().astype(int)})


def _write_mat(made: Map, path: Path) -> None:
    """The grid and all tables as arrays of MATLAB; of the same map the same bytes."""
    from scipy.io.matlab import savemat

    arrays: dict[str, Any] = {"pressure_MPa": made.pressure, "contraction": made.contraction}
    arrays |= made.tables
    arrays |= {"valid": made.valid.astype(np.uint8), "length_mm": made.length}
    savemat(path, arrays, do_compression=True, oned_as="column")
    with path.open("r+b") as file:  # its first bytes are a text with the time
        file.write(b"MATLAB 5.0 MAT-file".ljust(116))


def draw(found: Checked) -> Figure:
    """Force against contraction at pressures of the grid, and the states that were checked."""
    figure, axes = panels(FULL, 3.2)
    ax, made = axes[0, 0], found.map
    chosen = made.pressure[:: max(1, -(-made.pressure.size // LINES))]
    fine = np.linspace(made.contraction[0], made.contraction[-1], 200)
    starts = []
    for number, pressure in enumerate(chosen):
        grey = str(0.7 * (1 - number / max(len(chosen) - 1, 1)))
        force = made(FORCE, pressure, fine)
        ax.plot(fine, force, color=grey, linewidth=1)
        known = np.flatnonzero(np.isfinite(force))
        if known.size:
            starts.append((fine[known[0]], force[known[0]], f"{pressure:g} MPa"))
    if found.states.size:
        ax.plot(found.states[:, 1], found.states[:, 3], "x", color="#d55e00", markersize=4)
    ax.axhline(0, color="black", linewidth=0.7)
    ax.set_xlabel("contraction [%]")
    ax.set_ylabel("force [N]")
    ax.set_title(_off(found))
    percent(ax.xaxis, 0.05)
    ax.set_xlim(made.contraction[0] - ROOM * np.ptp(made.contraction))
    _name(ax, starts)
    return figure


def _off(found: Checked) -> str:
    """What the crosses say: all of them are drawn, those near the threshold too."""
    said = f"x: states solved for alone, at most {plain(found.error, 2)} N off"
    near = found.error_near
    return f"{said}; near the threshold {plain(near, 2)} N" if near > found.error else said


def _name(ax: Axes, starts: Sequence[tuple[float, float, str]]) -> None:
    """Names left of where curves begin; of those that would lie on each other the last, highest."""
    taken: list[NDArray[np.float64]] = []
    for x, y, name in reversed(starts):
        place = ax.transData.transform((x, y)) * 72 / ax.figure.dpi  # points
        if all(abs(place[1] - y) > APART or abs(place[0] - x) > WIDE for x, y in taken):
            taken.append(place)
            look: dict[str, Any] = {
                "fontsize": 7,
                "ha": "right",
                "va": "center",
                "textcoords": "offset points",
            }
            halo = [withStroke(linewidth=2, foreground="white")]
            ax.annotate(name, (x, y), (-3, 0), path_effects=halo, **look)
