"""Force and volume of a muscle over pressure and contraction, between the states of a grid.

In every cell of the grid a quantity is the bicubic that has its value, both derivatives and the
mixed one at the corners. Values and derivatives come from the solver's tangent (dV/de = L dF/dp,
both being the mixed derivative of the potential), the mixed ones are differences of those along the
contraction. What simulators get (netCDF, CSV, .mat, FMU) are these tables.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
FORCE, VOLUME = "force", "volume"
PARTS = ("", "_by_pressure", "_by_contraction", "_mixed")  # of the tables of a quantity
UNITS = {FORCE: "N", VOLUME: "mm^3"}
STEPS, EXACT = 60, 1e-12  # of a search for a pressure [MPa]


@dataclass(frozen=True, eq=False)
class Map:
    """A map.

    Attributes
    ----------
    pressure, contraction : the grid [MPa, 1]
    tables : by quantity and part, of shape (pressure, contraction)
    valid : states that the solver has found
    length : of the muscle at rest [mm]
    """

    muscle: str
    model: str
    length: float
    pressure: Array
    contraction: Array
    tables: dict[str, Array]
    valid: NDArray[np.bool_]

    def __call__(
        self, quantity: str, pressure: ArrayLike, contraction: ArrayLike, by: str = ""
    ) -> Array:
        """A quantity, or its derivative ``by`` pressure or contraction; NaN where it is not valid.

        Valid are states in cells all of whose corners are.
        """
        p, e = np.broadcast_arrays(np.asarray(pressure, float), np.asarray(contraction, float))
        i, s, dp = _cell(self.pressure, p)
        j, t, de = _cell(self.contraction, e)
        a = _basis(s, dp, derivative=by == "pressure")
        b = _basis(t, de, derivative=by == "contraction")
        value, by_p, by_e, mixed = (self.tables[quantity + part] for part in PARTS)
        total = np.zeros(p.shape)
        for k in (0, 1):
            for m in (0, 1):
                at = i + k, j + m
                total += a[k] * b[m] * value[at] + a[2 + k] * b[m] * by_p[at]
                total += a[k] * b[2 + m] * by_e[at] + a[2 + k] * b[2 + m] * mixed[at]
        return np.where(self.is_valid(p, e), total, np.nan)

    def is_valid(self, pressure: ArrayLike, contraction: ArrayLike) -> NDArray[np.bool_]:
        """Whether states lie in the grid, in cells all of whose corners were found."""
        p, e = np.asarray(pressure, float), np.asarray(contraction, float)
        inside = (p >= self.pressure[0]) & (p <= self.pressure[-1])
        inside &= (e >= self.contraction[0]) & (e <= self.contraction[-1])
        i, j = _cell(self.pressure, p)[0], _cell(self.contraction, e)[0]
        whole = self.valid[:-1] & self.valid[1:]
        whole = whole[:, :-1] & whole[:, 1:]
        return np.asarray(inside & whole[i, j])

    def pressure_for(self, force: float, contraction: float) -> float:
        """The pressure at which it has a force > 0 at a contraction [MPa]; NaN if there is none.

        Where threads are slack the force does not rise with the pressure, so that a force below
        zero has no single one.
        """
        if not force > 0:
            return np.nan
        forces = self(FORCE, self.pressure, contraction)
        above = np.flatnonzero((forces[1:] >= force) & (forces[:-1] < force))
        if not above.size:
            return np.nan
        low, high = self.pressure[above[-1]], self.pressure[above[-1] + 1]
        for _ in range(STEPS):
            middle = (low + high) / 2
            if float(self(FORCE, middle, contraction)) < force:
                low = middle
            else:
                high = middle
            if high - low < EXACT:
                break
        return float((low + high) / 2)

    def contraction_for(self, pressure: float, force: float) -> float:
        """The contraction at which it has a force at a pressure; NaN if there is none."""
        forces = self(FORCE, pressure, self.contraction)
        below = np.flatnonzero((forces[:-1] >= force) & (forces[1:] < force))
        if not below.size:
            return np.nan
        low, high = self.contraction[below[0]], self.contraction[below[0] + 1]
        for _ in range(STEPS):
            middle = (low + high) / 2
            if float(self(FORCE, pressure, middle)) >= force:
                low = middle
            else:
                high = middle
        return float((low + high) / 2)

    def dataset(self) -> Any:
        """The tables as a dataset (xarray)."""
        import xarray as xr

        axes = {
            "pressure": ("pressure", self.pressure, {"units": "MPa", "long_name": "pressure"}),
            "contraction": (
                "contraction",
                self.contraction,
                {"units": "1", "long_name": "contraction, 1 - l/L"},
            ),
        }
        long_names = ("", ", derivative by pressure", ", derivative by contraction", ", mixed")
        units = ("", "/MPa", "", "/MPa")
        found = {
            quantity + part: (
                ("pressure", "contraction"),
                self.tables[quantity + part],
                {"units": UNITS[quantity] + unit, "long_name": quantity + said},
            )
            for quantity in UNITS
            for part, unit, said in zip(PARTS, units, long_names, strict=True)
        }
        found["valid"] = (
            ("pressure", "contraction"),
            self.valid.astype("int8"),
            {"units": "1", "long_name": "1 where the solver has found the state"},
        )
        attributes = {"muscle": self.muscle, "model": self.model, "length_mm": self.length}
        return xr.Dataset(found, axes, attributes)

    @classmethod
    def of_dataset(cls, data: Any) -> "Map":
        """The map of such a dataset."""
        names = [quantity + part for quantity in UNITS for part in PARTS]
        return cls(
            muscle=str(data.attrs["muscle"]),
            model=str(data.attrs["model"]),
            length=float(data.attrs["length_mm"]),
            pressure=data["pressure"].values,
            contraction=data["contraction"].values,
            tables={name: data[name].values for name in names},
            valid=data["valid"].values.astype(bool),
        )


def read(path: str) -> Map:
    """The map in a netCDF file."""
    import xarray as xr

    with xr.open_dataset(path, engine="h5netcdf") as data:
        return Map.of_dataset(data.load())


def _cell(grid: Array, x: Array) -> tuple[NDArray[np.intp], Array, Array]:
    """Number of the cell in which x lies, its place there from 0 to 1, and the size of the cell."""
    k = np.clip(np.searchsorted(grid, x, side="right") - 1, 0, grid.size - 2)
    size = grid[k + 1] - grid[k]
    return k, (x - grid[k]) / size, size


def _basis(s: Array, size: Array, *, derivative: bool) -> tuple[Array, Array, Array, Array]:
    """Hermite's cubics: of both values, then of both derivatives; or their derivatives."""
    if derivative:
        slope = 6 * s * (1 - s) / size
        return -slope, slope, (1 - s) * (1 - 3 * s), s * (3 * s - 2)
    return (
        (1 + 2 * s) * (1 - s) ** 2,
        s**2 * (3 - 2 * s),
        size * s * (1 - s) ** 2,
        size * s**2 * (s - 1),
    )
