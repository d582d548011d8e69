"""What leaving out an effect changes and saves, as measured: ``effect_costs.csv`` beside this.

Made by ``snakemake --cores 2 effects`` and ``muscle weigh`` from the analysis of
effects; committed, because a plan must not depend on what was solved before. Its first line says
when and with which code; a test solves some of it again and says if it is out of date.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from math import nan
from pathlib import Path
from typing import Any

from geometry.mesh_settings import MeridianMesh, SectionMesh

MESHES: dict[str, dict[str, Any]] = {  # that were measured: what differs from the default numerics
    "coarser": {"section": SectionMesh(cap_step=2, growth=2, body_step=4)},
    "default": {},
    "finer": {"section": SectionMesh(refinement=2), "meridian": MeridianMesh(refinement=2)},
}
FILE = Path(__file__).with_suffix(".csv")
DATA = ("workflow/plan/effect_costs.csv",)
NUMBERS = {  # that the dataset has: unit, long name
    "force": ("1", "largest change of force, share of the largest"),
    "contraction": ("1", "largest change of contraction under load, share of the largest"),
    "diameter": ("1", "largest change of inner diameter, share of the largest"),
    "threshold": ("1", "change of threshold pressure, share of it"),
    "missing": ("1", "states that are lost without it"),
    "unknowns_with": ("1", "unknowns with it"),
    "unknowns_without": ("1", "unknowns without it"),
    "seconds_with": ("s", "processor time of a curve with it"),
    "seconds_without": ("s", "processor time of a curve without it"),
}


@dataclass(frozen=True, kw_only=True)
class MeasuredEffect:
    """Of one effect in one regime on one path; see workflow/analyses/effects/table.py.

    Shares of the largest value along the path; NaN where a quantity says nothing there. Seconds are
    those of the processor for a curve of the study, from start to record.
    """

    regime: str
    path: str
    effect: str
    force: float
    contraction: float
    diameter: float
    threshold: float
    held: float  # MPa, 1 or N: what the path holds
    largest: float  # N; under a load the contraction
    missing: float  # states that are lost without it
    unknowns_with: float
    unknowns_without: float
    seconds_with: float
    seconds_without: float


MeasuredEffects = Mapping[tuple[str, str, str], MeasuredEffect]  # by regime, path, effect


@cache
def load(file: Path = FILE) -> MeasuredEffects:
    """The measured effects."""
    lines = file.read_text().splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    found: list[dict[str, Any]] = [
        {
            f.name: row[f.name] if f.type is str else float(row[f.name] or nan)
            for f in fields(MeasuredEffect)
        }
        for row in rows
    ]
    measured = [MeasuredEffect(**values) for values in found]
    return {(w.regime, w.path, w.effect): w for w in measured}


def origin(file: Path = FILE) -> str:
    """When and with which code the effects were measured."""
    return file.read_text().splitlines()[0].removeprefix("# ")


def group() -> Any:
    """The measured effects as a dataset (xarray) of dims regime, path, effect."""
    import xarray as xr

    known = load()
    regimes, paths, effects = (list(dict.fromkeys(key[k] for key in known)) for k in range(3))
    data = xr.Dataset(coords={"regime": regimes, "path": paths, "effect": effects})
    for name, (unit, long_name) in NUMBERS.items():
        values = [
            [[getattr(known.get((r, p, e)), name, nan) for e in effects] for p in paths]
            for r in regimes
        ]
        data[name] = (("regime", "path", "effect"), values, {"units": unit, "long_name": long_name})
    data.attrs["origin"] = origin()
    return data
