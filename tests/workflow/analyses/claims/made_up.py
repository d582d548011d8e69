"""Small tables of states in which a claim holds, or does not."""

from dataclasses import replace

import numpy as np
import pandas as pd

from solver.load_path import PathKind
from workflow.analyses.claims.claim import STEPS, Data
from workflow.data.reference import ForceMap
from workflow.data.states import STOP, ZERO, Table

FORCE = (670.0, 440.0, 275.0, 140.0, 27.0)  # N, at STEPS: as computed at 0.3 MPa
EQUATION = (787.0, 658.0, 536.0, 420.0, 311.0)  # N, by Eq. (1)
SIZE = {"inner_diameter": 20.0, "length": 300.0, "braid_angle": 24.8}
NUMBERS = ("force", "contraction", "stiffness", "inner_diameter_inflated")


def data(path, curves, stops, status="converged", threshold=None, model="solid"):
    """Curves {(muscle, model, held): {variable: numbers at the stops}}, judged by a model."""
    kind, names, states = PathKind(path), [], []
    for number, ((muscle, of, held), numbers) in enumerate(curves.items()):
        names.append((muscle, of, "default", path, held))
        rows = pd.DataFrame(
            dict.fromkeys(NUMBERS, np.nan) | {kind.swept.key: list(stops)} | numbers
        )
        rows = rows.assign(curve=number, point=STOP, status=status)
        if threshold is not None:
            zero = {"curve": number, "point": ZERO, kind.swept.key: threshold, "status": status}
            rows = pd.concat([rows, pd.DataFrame([zero])], ignore_index=True)
        states.append(rows)
    named = pd.DataFrame(names, columns=["muscle", "model", "variant", "path", "held"])
    muscles = pd.DataFrame(SIZE, index=sorted(set(named["muscle"])))
    rows = pd.concat(states, ignore_index=True)
    if "pressure" not in rows:
        rows["pressure"] = named["held"].reindex(rows["curve"]).to_numpy()
    return Data(Table(muscles, named, rows), model)


def isobaric(forces, stops=STEPS, **options):
    """Forces at ``stops`` by (muscle, model, pressure)."""
    return data("isobaric", {key: {"force": f} for key, f in forces.items()}, stops, **options)


def isometric(threshold=0.15, model="solid", stops=None, **variables):
    """A curve against pressure at 10 %; variables are functions of pressure."""
    pressures = np.round(np.arange(0, 0.41, 0.01), 2) if stops is None else stops
    with np.errstate(all="ignore"):
        curve = {name: call(pressures) for name, call in variables.items()}
    return data("isometric", {("dmsp20", model, 0.1): curve}, pressures, threshold=threshold)


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
    return data("isotonic", curves, pressures)


def with_map(found, points):
    """The same with a manufacturer's map of (pressure, contraction, force)."""
    name = "festo_musclesim"
    return replace(found, maps={name: ForceMap(name, name, np.array(points), np.empty((0, 3)))})


def stress(**numbers):
    """The summary of the stress at 0.2, 0.3, 0.4 MPa."""
    place = {"muscle": "dmsp20", "model": "solid", "variant": "default", "contraction": 0.1}
    rows = pd.DataFrame({"pressure": [0.2, 0.3, 0.4], **numbers}).assign(**place)
    return replace(isobaric({("dmsp20", "solid", 0.3): FORCE}), stress=rows)
