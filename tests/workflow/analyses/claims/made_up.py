"""Small datasets in which a claim holds, or does not."""

import numpy as np
import xarray as xr

from workflow.analyses.claims.claim import STEPS

HELD = {"isobaric": "pressure", "isometric": "contraction", "isotonic": "load"}
SWEPT = {"isobaric": "contraction", "isometric": "pressure", "isotonic": "pressure"}
FORCE = (670.0, 440.0, 275.0, 140.0, 27.0)  # N, at STEPS: as computed at 0.3 MPa
EQUATION = (787.0, 658.0, 536.0, 420.0, 311.0)  # N, by Eq. (1)
SIZE = {"inner_diameter": 20.0, "length": 300.0, "braid_angle": 24.8}


def group(kind, curves, stops, status="converged"):
    """Curves {(muscle, model, held): {variable: numbers, or one number of the whole curve}}."""
    held, swept = HELD[kind], SWEPT[kind]
    axes = {
        "muscle": sorted({key[0] for key in curves}),
        "model": sorted({key[1] for key in curves}),
        "variant": ["default"],
        held: sorted({key[2] for key in curves}),
        swept: list(stops),
    }
    dims, shape = tuple(axes), tuple(map(len, axes.values()))
    names = {name: np.ndim(v) for curve in curves.values() for name, v in curve.items()}
    data = xr.Dataset(coords=axes)
    for name, wide in names.items():
        data[name] = (dims[: None if wide else -1], np.full(shape if wide else shape[:-1], np.nan))
    data["status"] = (dims, np.full(shape, "", dtype="U16"))
    data["case"] = (dims[:-1], np.full(shape[:-1], "", dtype="U16"))
    for (muscle, model, value), curve in curves.items():
        at = {"muscle": muscle, "model": model, "variant": "default", held: value}
        for name, numbers in curve.items():
            data[name].loc[at] = numbers
        data["status"].loc[at] = status
        data["case"].loc[at] = "key"
    return data.assign_coords({k: ("muscle", [v] * shape[0]) for k, v in SIZE.items()})


def isobaric(forces, stops=STEPS, **options):
    """Forces at ``stops`` by (muscle, model, pressure)."""
    curves = {key: {"force": numbers} for key, numbers in forces.items()}
    found = group("isobaric", curves, stops, **options)
    return xr.DataTree.from_dict({"isobaric": found})


def isometric(threshold=0.15, model="solid", stops=None, **variables):
    """A curve against pressure at 10 %; variables are functions of pressure."""
    pressures = np.round(np.arange(0, 0.41, 0.01), 2) if stops is None else stops
    with np.errstate(all="ignore"):
        curve = {name: call(pressures) for name, call in variables.items()}
    curve["threshold_pressure"] = threshold
    found = group("isometric", {("dmsp20", model, 0.1): curve}, pressures)
    return xr.DataTree.from_dict({"isometric": found})


def isotonic(contraction):
    """``contraction(load, pressure)`` under 100, 200, 300 N, as the model ``solid``."""
    pressures = np.round(np.arange(0, 0.61, 0.02), 2)
    curves = {
        ("dmsp20", "solid", load): {
            "contraction": contraction(load, pressures),
            "stiffness": np.full(pressures.shape, 10.0),
            "inner_diameter_inflated": np.full(pressures.shape, 30.0),
        }
        for load in (100.0, 200.0, 300.0)
    }
    return xr.DataTree.from_dict({"isotonic": group("isotonic", curves, pressures)})


def with_map(tree, points):
    """The same with a manufacturer's map of (pressure, contraction, force)."""
    pressure, contraction, force = np.array(points).T
    data = xr.Dataset(
        {"force": ("point", force), "suspect": ("point", np.zeros(len(force), int))},
        {
            "source": ("point", ["festo_musclesim"] * len(force)),
            "pressure": ("point", pressure),
            "contraction": ("point", contraction),
        },
    )
    groups = {name: node.to_dataset() for name, node in tree.children.items()}
    return xr.DataTree.from_dict(groups | {"reference": data})


def stress(**numbers):
    """The summary of the stress at 0.2, 0.3, 0.4 MPa."""
    dims = ("muscle", "model", "variant", "pressure", "contraction")
    data = xr.Dataset(
        {name: (dims, np.reshape(v, (1, 1, 1, 3, 1))) for name, v in numbers.items()},
        {
            "muscle": ["dmsp20"],
            "model": ["solid"],
            "variant": ["default"],
            "pressure": [0.2, 0.3, 0.4],
            "contraction": [0.1],
        },
    )
    return xr.DataTree.from_dict({"stress": data})
