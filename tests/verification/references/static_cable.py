"""Steady shape of a towed or moored flexible cable: its static ODE, from the far end upwards.

The internal force F = T t (of the part above on the part below) satisfies

    dF/ds' = w e_z - e^p (cn |u_n| u_n + ct |u_t| u_t),     dr/ds' = e F/|F|

with s' the unstretched arc length from the far end, e = 1 + strain(|F|), u the velocity of the
water relative to the cable, cn = rho Cdn d / 2, ct = rho Cdt pi d / 2, and
p = 1/2 (eq. 23: the volume of the cable is kept). In vector form it is
regular wherever the tension is positive, so that with a body at the end it is an initial value
problem, and the far end's position has to be found only where the water's velocity varies.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import root

Array = NDArray[np.float64]
Strain = Callable[[float], float]
Water = Callable[[float], Array]


@dataclass(frozen=True)
class CableProperties:
    """One cable: lengths [m], weight [N/m], strain(T) [-], drag coefficients as in a scene."""

    length: float
    weight: float
    strain: Strain
    diameter: float = 0.0
    drag_normal: float = 0.0
    drag_tangential: float = 0.0
    water_density: float = 1025.0
    drag_exponent: float = 0.5

    @property
    def normal_drag(self) -> float:
        """rho Cdn d / 2 [kg/m2]."""
        return 0.5 * self.water_density * self.drag_normal * self.diameter

    @property
    def tangential_drag(self) -> float:
        """rho Cdt pi d / 2 [kg/m2]."""
        return 0.5 * self.water_density * self.drag_tangential * np.pi * self.diameter


@dataclass(frozen=True)
class EndBody:
    """A point body at the far end: submerged weight [N], drag area times coefficient [m2].

    Its axis is the cable's tangent there; drag goes with the whole speed, across and along it.
    """

    weight: float
    drag_normal: float = 0.0
    drag_axial: float = 0.0
    water_density: float = 1025.0

    def cable_force(self, water: Array) -> Array:
        """Force of the cable on the body at rest in water of relative velocity `water` (3,) [N].

        Weight and drag are balanced by a force along the axis, which turns until that is so.
        """

        def balance(force: Array) -> Array:
            tangent = force / np.linalg.norm(force)
            along = water @ tangent
            across = water - along * tangent
            drag = self.drag_normal * across + self.drag_axial * along * tangent
            drag = 0.5 * self.water_density * np.linalg.norm(water) * drag
            return force + drag - np.array([0.0, 0.0, self.weight])

        found = root(balance, np.array([0.0, 0.0, self.weight]), tol=1e-14)
        if np.linalg.norm(balance(found.x)) > 1e-9 * self.weight:
            raise ArithmeticError(found.message)
        return found.x


@dataclass(frozen=True)
class SteadyShape:
    """Positions are relative to the top; `sample(s)` takes s from the top [m]."""

    top_force: Array
    end_position: Array
    _interpolant: Callable[[ArrayLike], Array] = field(repr=False)
    _length: float = 0.0
    _top: Array = field(default_factory=lambda: np.zeros(3))

    @property
    def top_tension(self) -> float:
        """[N]"""
        return float(np.linalg.norm(self.top_force))

    @property
    def top_angle(self) -> float:
        """Angle of the cable at the top from the horizontal [rad]."""
        return float(np.arcsin(self.top_force[2] / self.top_tension))

    def position(self, s: ArrayLike) -> Array:
        """(n, 3) [m] relative to the top."""
        return self._interpolant(self._length - np.asarray(s, float))[:3].T - self._top

    def tension(self, s: ArrayLike) -> Array:
        """(n,) [N]"""
        force = self._interpolant(self._length - np.asarray(s, float))[3:]
        return np.linalg.norm(force, axis=0)


def linear_strain(axial_stiffness: float) -> Strain:
    """strain(T) = T / EA."""
    return lambda tension: tension / axial_stiffness


def polynomial_strain(coefficients: ArrayLike) -> Strain:
    """strain(T) = c1 T + c2 T^2 + ..., eq. 21 of the paper with its constant term zero."""
    descending = np.r_[np.asarray(coefficients, float)[::-1], 0.0]
    return lambda tension: float(np.polyval(descending, tension))


def _slope(cable: CableProperties, y: Array, water: Water) -> Array:
    force = y[3:]
    tension = np.linalg.norm(force)
    tangent = force / tension
    stretch = 1.0 + cable.strain(tension)
    u = water(y[2])
    along = u @ tangent
    across = u - along * tangent
    drag = cable.normal_drag * np.linalg.norm(across) * across
    drag = drag + cable.tangential_drag * abs(along) * along * tangent
    return np.r_[
        stretch * tangent, np.array([0.0, 0.0, cable.weight]) - stretch**cable.drag_exponent * drag
    ]


def _free_end_start(cable: CableProperties, water: Array, step: float) -> Array:
    """State a short way above a free end, where T = 0 and regularity fixes the direction.

    There the load has no component across the cable: dF/ds' is parallel to t. The direction is
    that of the vertical plane of the water's velocity, at the critical angle; its relative error
    after `step` is of the order of the strain there, and decays upwards.
    """
    speed = np.hypot(water[0], water[1])
    quadratic = cable.normal_drag * speed**2
    if quadratic == 0.0:
        cosine = 0.0
    else:
        ratio = cable.weight / quadratic
        cosine = (-ratio + np.sqrt(ratio**2 + 4.0)) / 2.0
    sine = np.sqrt(1.0 - cosine**2)
    # The tangent upwards points against the flow: the free end trails downstream.
    downstream = np.array([water[0], water[1], 0.0]) / speed if speed > 0 else np.zeros(3)
    tangent = -cosine * downstream + np.array([0.0, 0.0, sine])
    gradient = cable.weight * sine + cable.tangential_drag * (speed * cosine) ** 2
    return np.r_[step * tangent, gradient * step * tangent]


def steady_shape(
    cable: CableProperties,
    body: EndBody | None,
    water: Water,
    *,
    top_depth: float = 0.0,
    rtol: float = 1e-12,
) -> SteadyShape:
    """Steady shape below a top at z = `top_depth`, in water of relative velocity water(z) [m/s].

    Without a body the end is free, and the water's velocity must be horizontal there.
    """

    def integrate(end_depth: float):
        velocity = water(end_depth)
        if body is None:
            start = 1e-9 * cable.length
            y = _free_end_start(cable, velocity, start)
        else:
            start = 0.0
            y = np.r_[np.zeros(3), body.cable_force(velocity)]
        y[2] += end_depth
        return solve_ivp(
            lambda _, state: _slope(cable, state, water),
            (start, cable.length),
            y,
            method="Radau" if body is None else "DOP853",
            rtol=max(rtol, 1e-12),
            atol=1e-13,
            dense_output=True,
        )

    guess = top_depth - cable.length
    found = root(
        lambda z: integrate(float(z[0])).y[2, -1] - top_depth, [guess], method="hybr", tol=1e-13
    )
    end_depth = float(found.x[0])
    solution = integrate(end_depth)
    if abs(solution.y[2, -1] - top_depth) > 1e-9 * cable.length:
        raise ArithmeticError(f"the far end's depth was not found: {found.message}")
    top = solution.y[:3, -1]
    start_position = np.array([0.0, 0.0, end_depth])
    return SteadyShape(
        top_force=solution.y[3:, -1],
        end_position=start_position - top,
        _interpolant=solution.sol,
        _length=cable.length,
        _top=top,
    )


def critical_angle(cable: CableProperties, speed: float) -> float:
    """Angle from the horizontal at which an inextensible free cable is towed straight [rad]."""
    ratio = cable.weight / (cable.normal_drag * speed**2)
    return float(np.arccos((-ratio + np.sqrt(ratio**2 + 4.0)) / 2.0))


def critical_angle_tension(cable: CableProperties, speed: float) -> float:
    """Top tension of the straight, inextensible towed cable [N]."""
    angle = critical_angle(cable, speed)
    along = cable.tangential_drag * (speed * np.cos(angle)) ** 2
    return cable.length * (cable.weight * np.sin(angle) + along)


def hanging_length(
    length: float, weight: float, end_weight: float, coefficients: ArrayLike
) -> float:
    """Stretched length [m] of a vertical cable whose tension is end_weight + w s'."""
    from scipy.integrate import quad

    strain = polynomial_strain(coefficients)
    stretch, _ = quad(
        lambda s: strain(end_weight + weight * s), 0.0, length, epsabs=0.0, epsrel=1e-13
    )
    return length + stretch
