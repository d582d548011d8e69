"""Energy, pressure, force and torque of a uniform cylinder, with the effects of a case.

Incompressible wall: a point R goes to r(R)^2 = r^2 + (R^2 - R_0^2) / lz, with r and R_0 of the
surface on which the pressure acts, and turns by tau Z. The law of the rubber
(solver/rubber) takes the squared stretches A = lt^2, B = lz^2 and the shear (R tau)^2; a thread has

    lf^2 = B cos^2 + A (sin + or - R tau cos)^2     + clockwise, - counter-clockwise

with A = r(R_c)^2 / R^2 at its own radius R; R_c is where the wall carries it, R itself in the wall
and the outer radius for a sleeve, which is as wide as the wall where it is taut: where it is slack
it has no energy at any width.

The energy per reference length psi(r, lz, tau) gives p = psi_r / (2 pi r lz), F = psi_lz - p pi r^2
and the torque psi_tau. Rigid threads bear tension only: the layer that binds gives r(lz).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geometry.braid import Kind
from solver import rubber
from solver.case import INCOMPRESSIBLE, Case
from solver.effects import Rubber, Stretch, Twist, Wall
from solver.models.cylinder.sleeve_friction import SleeveFriction
from solver.models.cylinder.wall_memory import WallMemory
from solver.threads import thread_law

Array = NDArray[np.float64]
WALL_POINTS = 16  # Gauss points through the wall: exact to rounding for any wall that is built
REACH = 6.0  # r / R_i at which a tube counts as inflating without bound
SLACKEST = 0.2  # share of the net's radius, far below where a slack wall comes to rest


@dataclass(frozen=True)
class State:
    """A state of the cylinder: shape [mm, 1, rad/mm] and loads [MPa, N, N mm]."""

    r: float
    lz: float
    twist: float
    pressure: float
    force: float
    torque: float


class Cylinder:
    """One muscle as a function of the unknowns of its case.

    ``start`` is the unloaded state: the axial stretch; before it the radius, or 1 + the pressure
    where a rigid net gives the radius; after it the twist where that is free. All without unit.
    """

    def __init__(self, case: Case) -> None:
        self.case = case
        muscle, effects = case.muscle, case.effects
        self.rubber = case.rubber
        self.free = int(effects.twist is Twist.FREE)  # unknowns of the twist
        self.rigid = effects.stretch is Stretch.RIGID and muscle.braid is not None
        layers = muscle.layers
        self.layers = np.array([layer.radius for layer in layers])
        self.carriers = np.array([layer.carrier for layer in layers])
        self.inner, self.radii, self.measure = _wall(case)
        if effects.wall is Wall.ONE_RADIUS:
            self.layers = self.carriers = np.full_like(self.layers, self.inner)
        if effects.rubber is Rubber.NONE:
            self.measure = 0 * self.measure
            self.modulus = 1.0
            self.rubber = rubber.from_dict(rubber.anything() | INCOMPRESSIBLE)
        else:
            self.modulus = case.rubber.load_scale
        self.memory: WallMemory | None = None
        if case.remembers:
            assert case.memory is not None
            self.memory = WallMemory(case.memory, case.rubber.branch, self.measure)
            self.measure = case.memory.long_term * self.measure
        self.friction: SleeveFriction | None = None  # from the first stop of a history on
        leads = np.array([layer.lead for layer in layers])
        self.angles = np.arctan(2 * math.pi * self.layers / leads)
        self.senses = np.array([float(layer.sense) for layer in layers])
        self.glue = np.array([float(layer.kind is not Kind.SLEEVE) for layer in layers])
        if case.thread is not None:
            ea = case.thread.stiffness
            self.stiffness = np.array([layer.threads * ea * layer.share for layer in layers])
            self.width = case.numerics.slack.width_of(case.thread)
        self.start = np.array([1.0, 1.0] + [0.0] * self.free)

    @property
    def sleeved(self) -> bool:
        """Whether a layer lies outside."""
        return bool((self.glue == 0).any())

    @property
    def unknowns(self) -> int:
        """Those that are solved for beside contraction and pressure."""
        return (not self.rigid) + self.free

    def state(self, x: Array) -> State:
        """The state at some unknowns."""
        lz, twist = float(x[1]), float(x[2]) / self.inner if self.free else 0.0
        if self.rigid:
            return self._on_net(float(x[0] - 1) * self.modulus, lz)
        r = float(x[0]) * self.inner
        by_r, by_lz, torque = self._forces(r, lz, twist, threads=True)
        pressure = by_r / (2 * math.pi * r * lz)
        return State(r, lz, twist, pressure, by_lz - pressure * math.pi * r**2, torque)

    def contact_pressure(self, state: State) -> float:
        """What the sleeves press with on the tube, psi_A / (pi R^2 lz) [MPa].

        Of a net it is what the tube does not bear; NaN where layers in the wall bear some of that.
        """
        outside = self.glue == 0
        if self.rigid:
            own = self._forces(state.r, state.lz, state.twist, threads=False)[0]
            borne = own / (2 * math.pi * state.r * state.lz)
            return max(state.pressure - borne, 0.0) if outside.all() else math.nan
        axial, hoop = self._along_threads(state.r, state.lz, state.twist)
        per_square = self._tension(np.hypot(axial, hoop)) * hoop**2
        by_a = per_square / self._hoop_of_layers(state.r, state.lz) ** 2
        return float(np.sum((by_a / (math.pi * self.layers**2 * state.lz))[outside]))

    def radius_at(self, radius: float, r: float, lz: float) -> float:
        """Where a reference radius is [mm]."""
        return math.sqrt(r**2 + (radius**2 - self.inner**2) / lz)

    def thread_stretch(self, state: State) -> Array:
        """Thread stretch of each layer."""
        axial, hoop = self._along_threads(state.r, state.lz, state.twist)
        return np.asarray(np.hypot(axial, hoop))

    def rubber_stretch(self, state: State) -> float:
        """Largest principal stretch of the wall."""
        a, b = self._hoop(self.radii, state.r, state.lz) ** 2, state.lz**2
        half = (a * (1 + (self.radii * state.twist) ** 2) + b) / 2  # of the trace on the surface
        largest = half + np.sqrt(np.maximum(half**2 - a * b, 0))
        return float(np.sqrt(max(np.max(largest), np.max(1 / (a * b)))))

    def rubber_margin(self, state: State) -> float:
        """How far the law of the rubber reaches yet, if it ends anywhere."""
        a, b = self._hoop(self.radii, state.r, state.lz) ** 2, state.lz**2
        return self.rubber.margin(a, b, (self.radii * state.twist) ** 2)

    def energy(self, state: State) -> float:
        """Strain energy per reference length [N mm/mm]."""
        a, b = self._hoop(self.radii, state.r, state.lz) ** 2, state.lz**2
        shear = (self.radii * state.twist) ** 2
        total = float(np.sum(self.measure * self.rubber.energy(a, b, shear)))
        if len(self.layers) and not self.rigid:
            stretch = self.thread_stretch(state)
            share = thread_law.energy(self.case.effects.threads, self.width, stretch, self.glue)
            total += float(np.sum(self.stiffness / np.cos(self.angles) * share))
        return total

    def hoop(self, r: float, lz: float) -> Array:
        """Hoop stretch of the points of the wall."""
        return self._hoop(self.radii, r, lz)

    def by_shape(self, r: float, lz: float, *, threads: bool) -> tuple[float, float]:
        """Derivatives of the energy by r and lz, without twist."""
        return self._forces(r, lz, 0.0, threads=threads)[:2]

    def _hoop(self, radii: Array, r: float, lz: float) -> Array:
        """Hoop stretch at reference radii."""
        return np.asarray(np.sqrt(r**2 + (radii**2 - self.inner**2) / lz) / radii)

    def _hoop_of_layers(self, r: float, lz: float) -> Array:
        """Hoop stretch of each layer, from its own radius to that of the wall that carries it."""
        return np.asarray(np.sqrt(r**2 + (self.carriers**2 - self.inner**2) / lz) / self.layers)

    def _along_threads(self, r: float, lz: float, twist: float) -> tuple[Array, Array]:
        """Axial and hoop part of the stretch of each layer's threads."""
        turned = np.sin(self.angles) + self.senses * self.layers * twist * np.cos(self.angles)
        return lz * np.cos(self.angles), self._hoop_of_layers(r, lz) * turned

    def _forces(
        self, r: float, lz: float, twist: float, *, threads: bool
    ) -> tuple[float, float, float]:
        """Derivatives of psi by r, lz and tau."""
        a, b = self._hoop(self.radii, r, lz) ** 2, lz**2
        radii, carriers, shear = self.radii, self.radii, (self.radii * twist) ** 2
        by_a, by_b, by_shear = self.rubber.slopes(a, b, shear)
        torque = np.sum(self.measure * 2 * radii**2 * twist * by_shear)
        by_a, by_b = self.measure * by_a, self.measure * by_b
        if self.memory is not None:
            over_a, over_b = self.memory.slopes(a, b)
            by_a, by_b = by_a + self.memory.measure * over_a, by_b + self.memory.measure * over_b
        if threads and len(self.layers):
            axial, hoop = self._along_threads(r, lz, twist)
            per_square = self._tension(np.hypot(axial, hoop))
            a_layer = self._hoop_of_layers(r, lz) ** 2
            of_a, of_b = per_square * hoop**2 / a_layer, per_square * np.cos(self.angles) ** 2
            if self.friction is not None:
                self.friction.add(a_layer, b, of_a, of_b)
            by_a, by_b = np.append(by_a, of_a), np.append(by_b, of_b)
            turning = np.sqrt(a_layer) * self.senses * self.layers * np.cos(self.angles)
            torque += np.sum(per_square * 2 * hoop * turning)
            radii, carriers = np.append(radii, self.layers), np.append(radii, self.carriers)
        by_r = np.sum(by_a * 2 * r / radii**2)
        by_lz = np.sum(by_b * 2 * lz - by_a * (carriers**2 - self.inner**2) / (lz * radii) ** 2)
        return float(by_r), float(by_lz), float(torque)

    def pressing(self, state: State) -> tuple[Array, float, Array]:
        """A of each layer, B, and the derivative of the energy of its threads by A."""
        axial, hoop = self._along_threads(state.r, state.lz, 0.0)
        a = self._hoop_of_layers(state.r, state.lz) ** 2
        return a, state.lz**2, self._tension(np.hypot(axial, hoop)) * hoop**2 / a

    def _tension(self, stretch: Array) -> Array:
        """Derivative of each layer's energy by lf^2 [N]."""
        share = thread_law.tension(self.case.effects.threads, self.width, stretch, self.glue)
        return np.asarray(self.stiffness * share / (2 * stretch * np.cos(self.angles)))

    def _net(self, lz: float) -> tuple[float, float]:
        """Radius that the binding layer of a rigid net allows, and its derivative by lz."""
        cosine, sine = np.cos(self.angles) ** 2, np.sin(self.angles) ** 2
        offset = self.carriers**2 - self.inner**2
        if not 0 < lz < 1 / math.sqrt(cosine.max()):
            return math.nan, math.nan
        square = self.layers**2 * (1 - cosine * lz**2) / sine - offset / lz
        slope = -2 * self.layers**2 * cosine * lz / sine + offset / lz**2
        k = int(np.argmin(square))
        r = math.sqrt(square[k]) if square[k] > 0 else math.nan  # no hole is left
        return r, float(slope[k]) / (2 * r)

    def _on_net(self, pressure: float, lz: float) -> State:
        """The state at a pressure and an axial stretch, its threads taut or slack."""

        def outward(r: float) -> float:
            return 2 * math.pi * r * lz * pressure - self._forces(r, lz, 0.0, threads=False)[0]

        r, slope = self._net(lz)
        push = outward(r)
        if push < 0:  # the wall comes to rest inside the net
            from scipy.optimize import brentq  # late: it takes half a second to import

            within = SLACKEST * r
            r = brentq(outward, within, r, rtol=1e-14) if outward(within) > 0 else math.nan
            push = 0.0
        by_lz = self._forces(r, lz, 0.0, threads=False)[1]
        force = by_lz - pressure * math.pi * r**2 - push * slope
        return State(r, lz, 0.0, pressure, force, math.nan)


def _wall(case: Case) -> tuple[float, Array, Array]:
    """Radius on which the pressure acts; radii of the wall; the area 2 pi R dR of each."""
    muscle = case.muscle
    middle = muscle.inner_radius + muscle.wall_thickness / 2
    if case.effects.wall is Wall.ONE_RADIUS:
        one = muscle.braid.mean_diameter / 2 if muscle.braid else middle
        return one, np.array([one]), np.array([2 * math.pi * middle * muscle.wall_thickness])
    nodes, weights = np.polynomial.legendre.leggauss(WALL_POINTS)
    half = muscle.wall_thickness / 2
    radii = middle + half * nodes
    return muscle.inner_radius, radii, 2 * math.pi * radii * half * weights
