"""A uniform cylinder: rubber through the wall thickness and stretching threads, no end caps.

Incompressible wall: a point R goes to r(R)^2 = r_i^2 + (R^2 - R_i^2) / lz, with lt = r/R,
lr = 1 / (lt lz). The energy per reference length psi(r_i, lz) of wall and threads gives

    p = psi_r / (2 pi r_i lz),   F = psi_lz - p pi r_i^2

with F the force of the muscle, both explicit in (r_i, lz). A path is followed by solving for
(r_i, lz) at each stop from the stop before.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from solver import thread_law
from solver.case import Case
from solver.load_path import Control, Waypoint
from solver.record import Solution, unreached
from solver.status import CaseStatus, case_status, state_status

Array = NDArray[np.float64]
WALL_POINTS = 16  # Gauss points through the wall: exact to rounding for any wall that is built
SMALLEST_STEP = 1 / 1024


class Cylinder:
    """Energy and forces of one muscle as functions of inner radius and axial stretch."""

    def __init__(self, case: Case) -> None:
        self.case = case
        muscle = case.muscle
        nodes, weights = np.polynomial.legendre.leggauss(WALL_POINTS)
        half = muscle.wall_thickness / 2
        self.inner = muscle.inner_radius
        self.radii = muscle.inner_radius + half * (1 + nodes)
        self.measure = 2 * math.pi * self.radii * half * weights  # 2 pi R dR
        self.layers = np.array(muscle.layer_radii)
        self.angles = np.array(muscle.braid.layer_angles if muscle.braid else ())

    def hoop(self, radii: Array, r: float, lz: float) -> Array:
        """Hoop stretch at reference radii."""
        return np.asarray(np.sqrt(r**2 + (radii**2 - self.inner**2) / lz) / radii)

    def thread_stretch(self, r: float, lz: float) -> Array:
        """Thread stretch of each layer."""
        lt = self.hoop(self.layers, r, lz)
        return np.asarray(np.hypot(np.cos(self.angles) * lz, np.sin(self.angles) * lt))

    def pressure_and_force(self, r: float, lz: float) -> tuple[float, float]:
        """Pressure [MPa] and force [N] that hold the cylinder at (r, lz)."""
        rubber = self.case.rubber
        # d psi by (lt^2, lz^2) at every radius; see solver/edp/rubber_wall.idp
        a, b = self.hoop(self.radii, r, lz) ** 2, lz**2
        by_a = self.measure * (rubber.c10 * (1 - 1 / (a**2 * b)) + rubber.c01 * (b - 1 / a**2))
        by_b = self.measure * (rubber.c10 * (1 - 1 / (a * b**2)) + rubber.c01 * (a - 1 / b**2))
        radii = self.radii
        if self.case.thread is not None and self.case.muscle.braid is not None:
            lf = self.thread_stretch(r, lz)
            count = self.case.muscle.braid.threads * self.case.thread.stiffness
            width = self.case.numerics.slack.width_of(self.case.thread)
            tension = count * thread_law.tension(self.case.effects.threads, width, lf)
            per_square = tension / (2 * lf * np.cos(self.angles))
            by_a = np.append(by_a, per_square * np.sin(self.angles) ** 2)
            by_b = np.append(by_b, per_square * np.cos(self.angles) ** 2)
            radii = np.append(radii, self.layers)
        psi_r = np.sum(by_a * 2 * r / radii**2)
        psi_lz = np.sum(by_b * 2 * lz - by_a * (radii**2 - self.inner**2) / (lz * radii) ** 2)
        pressure = psi_r / (2 * math.pi * r * lz)
        return float(pressure), float(psi_lz - pressure * math.pi * r**2)

    def control(self, kind: Control, r: float, lz: float) -> float:
        """Value of a control, as a share of its size for this muscle."""
        pressure, force = self.pressure_and_force(r, lz)
        modulus = self.case.rubber.c10 + self.case.rubber.c01
        return {
            Control.CONTRACTION: 1 - lz,
            Control.PRESSURE: pressure / modulus,
            Control.FORCE: force / (modulus * math.pi * self.inner**2),
            Control.VOLUME: (r / self.inner) ** 2 * lz,
        }[kind]

    def scale(self, kind: Control) -> float:
        """What ``control`` is a share of."""
        modulus = self.case.rubber.c10 + self.case.rubber.c01
        return {
            Control.CONTRACTION: 1.0,
            Control.PRESSURE: modulus,
            Control.FORCE: modulus * math.pi * self.inner**2,
            Control.VOLUME: math.pi * self.inner**2 * self.case.muscle.length,
        }[kind]


def solve(case: Case) -> Solution:
    """The curve of a case."""
    cylinder = Cylinder(case)
    states = unreached(case.path.states)
    reason = ""
    for way in case.path.ways():
        reason = _follow(cylinder, way, states)
        if not reason:
            break
    checks = states | {"unstable_modes": np.zeros(case.path.states)}
    status = state_status(case.path.kind, checks)
    states["stiffness"][:] = np.nan  # by lz; only its sign means something without a length
    outcome = case_status(status)
    return Solution(
        status=outcome,
        reason="" if outcome is CaseStatus.CONVERGED else reason,
        states=states,
        state_status=status,
    )


def _follow(cylinder: Cylinder, way: list[Waypoint], states: dict[str, Array]) -> str:
    """Record the stops of a way; where it could not be followed to its end, say where it ended."""
    r, lz = cylinder.inner, 1.0
    for point in way:
        kinds = point.first, point.second
        targets = np.array([point.first_target, point.second_target])
        scales = np.array([cylinder.scale(kind) for kind in kinds])
        found = _walk(cylinder, kinds, targets / scales, r, lz)
        if found is None:
            pressure, force = cylinder.pressure_and_force(r, lz)
            return (
                f"no state found beyond contraction {1 - lz:g}, pressure {pressure:g} MPa, "
                f"force {force:g} N"
            )
        r, lz = found
        if point.stop is not None:
            _record(cylinder, states, point.stop, r, lz)
    return ""


def _walk(
    cylinder: Cylinder, kinds: tuple[Control, Control], goal: Array, r: float, lz: float
) -> tuple[float, float] | None:
    """From (r, lz) to the state whose two controls are at ``goal``, in as many steps as needed."""

    def values(unknown: Array) -> Array:
        return np.array(
            [cylinder.control(k, unknown[0] * cylinder.inner, unknown[1]) for k in kinds]
        )

    at = np.array([r / cylinder.inner, lz])
    start = values(at)
    done, step = 0.0, 1.0
    while done < 1:
        share = min(done + step, 1.0)
        target = start + share * (goal - start)
        with np.errstate(all="ignore"):
            found = root(lambda u, t=target: values(u) - t, at, tol=1e-13)
        if np.max(np.abs(found.fun)) < 1e-11 and found.x[0] > 0 and found.x[1] > 0:
            at, done, step = found.x, share, 2 * step
        else:
            step /= 2
            if step < SMALLEST_STEP:
                return None
    return float(at[0] * cylinder.inner), float(at[1])


def _record(cylinder: Cylinder, states: dict[str, Array], stop: int, r: float, lz: float) -> None:
    """Put a state into the record."""
    muscle = cylinder.case.muscle
    pressure, force = cylinder.pressure_and_force(r, lz)
    outer = muscle.outer_radius * cylinder.hoop(np.array([muscle.outer_radius]), r, lz)[0]
    values = {
        "contraction": 1 - lz,
        "pressure": pressure,
        "force": force,
        "force_cap": force,
        "force_midplane": force,
        "inner_diameter_inflated": 2 * r,
        "outer_diameter": 2 * outer,
        "min_det_f": 1.0,  # incompressible by construction
        "min_det_f_nodes": 1.0,
        "margin": min(lz, r / cylinder.inner),
        "stiffness": _stiffness(cylinder, r, lz),
    }
    if muscle.braid is not None:
        stretch = cylinder.thread_stretch(r, lz)
        values |= {"thread_stretch_min": stretch.min(), "thread_stretch_max": stretch.max()}
    for name, value in values.items():
        states[name][stop] = value


def _stiffness(cylinder: Cylinder, r: float, lz: float) -> float:
    """dF/dlz at fixed pressure, by central differences of the explicit forces [N]."""
    h = 1e-6
    (p_r, f_r), (p_z, f_z) = (
        (np.array(cylinder.pressure_and_force(*plus)) - cylinder.pressure_and_force(*minus)) / 2
        for plus, minus in (
            ((r * (1 + h), lz), (r * (1 - h), lz)),
            ((r, lz * (1 + h)), (r, lz * (1 - h))),
        )
    )
    return float((f_z - f_r * p_z / p_r) / (h * lz))
