"""Motions with few degrees of freedom, and waves, as closed forms or ODEs to rounding error."""

from collections.abc import Callable
from itertools import pairwise

import mpmath as mp
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

Array = NDArray[np.float64]


def pendulum_period(length: float, amplitude: float, gravity: float = 9.80665) -> float:
    """[s] of a point mass on a massless inextensible line: 4 K(sin(a/2)) sqrt(l/g)."""
    return float(4 * mp.ellipk(mp.sin(mp.mpf(amplitude) / 2) ** 2) * mp.sqrt(length / gravity))


def spring_pendulum(
    length: float,
    axial_stiffness: float,
    mass: float,
    weight: float,
    start: tuple[float, float],
    times: ArrayLike,
) -> Array:
    """(n, 2) positions x, z [m] of a mass on a massless elastic line from the origin.

    Released at rest at `start`; the line pulls with EA (|r|/l - 1).
    """

    def slope(_, y):
        distance = np.hypot(y[0], y[1])
        pull = axial_stiffness * (distance / length - 1.0) / distance
        return [y[2], y[3], -pull * y[0] / mass, -(pull * y[1] + weight) / mass]

    times = np.asarray(times, float)
    solution = solve_ivp(
        slope, (0.0, times[-1]), [*start, 0.0, 0.0], "DOP853", times, rtol=1e-12, atol=1e-13
    )
    return solution.y[:2].T


def sinking(
    time: ArrayLike, weight: float, mass: float, added_mass: float, drag: float
) -> tuple[Array, Array]:
    """(velocity, distance) [m/s, m] of a horizontal cable that sinks from rest.

    `drag` = rho Cdn d / 2 [kg/m2], `added_mass` = rho A Ca [kg/m]: v = V tanh(t/tau).
    """
    final = np.sqrt(weight / drag)
    scale = (mass + added_mass) * final / weight
    t = np.asarray(time, float) / scale
    return final * np.tanh(t), final * scale * np.log(np.cosh(t))


def drifting(
    current: Callable[[float], float],
    breakpoints: ArrayLike,
    mass: float,
    added_mass: float,
    drag: float,
    current_inertia: float = 0.0,
) -> Callable[[ArrayLike], tuple[Array, Array]]:
    """Velocity and displacement of a straight weightless cable carried across by a current in time.

    (m + ma) v' = drag |c - v| (c - v) + current_inertia c', from rest; `current` is linear between
    `breakpoints`, where the integration is restarted.
    """
    marks = np.asarray(breakpoints, float)
    pieces, state = [], np.zeros(2)
    for a, b in pairwise(marks):
        first = current(a)
        rate = (current(b) - first) / (b - a)

        def slope(t, y, a=a, rate=rate, start=first):
            u = start + rate * (t - a) - y[0]
            return [(drag * abs(u) * u + current_inertia * rate) / (mass + added_mass), y[0]]

        solution = solve_ivp(
            slope, (a, b), state, "DOP853", rtol=1e-12, atol=1e-14, dense_output=True
        )
        pieces.append(solution.sol)
        state = solution.y[:, -1]

    def evaluate(t: ArrayLike) -> tuple[Array, Array]:
        t = np.atleast_1d(np.asarray(t, float))
        index = np.clip(np.searchsorted(marks, t, side="right") - 1, 0, len(pieces) - 1)
        y = np.array([pieces[i](value) for i, value in zip(index, t, strict=True)])
        return y[:, 0], y[:, 1]

    return evaluate


def rigid_rod(
    length: float,
    mass: float,
    weight: float,
    normal_drag: float,
    added_mass: float,
    current: Callable[[float], float],
    breakpoints: ArrayLike,
    times: ArrayLike,
    start_angle: float = 0.0,
    current_inertia: float = 0.0,
) -> Array:
    """Angle from the downward vertical [rad] of a rigid rod hinged at its top, at rest at t = 0.

    Per length: weight w down, normal drag cn |u| u with u = c cos(theta) - s theta', mass m and
    added mass ma on the normal. `current` c(t) is horizontal and linear between `breakpoints`.
    The drag's moment is integrated piecewise, exactly: u changes sign at most once along the rod.
    """
    inertia = (mass + added_mass) * length**3 / 3.0

    def drag_moment(flow: float, rate: float) -> float:
        def antiderivative(s: float) -> float:  # of s (flow - rate s)^2
            return flow**2 * s**2 / 2 - 2 * flow * rate * s**3 / 3 + rate**2 * s**4 / 4

        change = flow / rate if rate != 0.0 else -1.0
        if not 0.0 < change < length:
            sign = np.sign(flow - rate * length / 2)
            return sign * antiderivative(length)
        inner = antiderivative(change)
        return np.sign(flow) * (inner - (antiderivative(length) - inner))

    marks = np.asarray(breakpoints, float)
    times = np.asarray(times, float)
    angles = np.full(times.shape, start_angle)
    state = np.array([start_angle, 0.0])
    for a, b in pairwise(marks):
        first = current(a)
        acceleration = (current(b) - first) / (b - a)

        def slope(t, y, a=a, acceleration=acceleration, start=first):
            flow = (start + acceleration * (t - a)) * np.cos(y[0])
            moment = normal_drag * drag_moment(flow, y[1])
            moment -= weight * length**2 / 2 * np.sin(y[0])
            moment += current_inertia * acceleration * np.cos(y[0]) * length**2 / 2
            return [y[1], moment / inertia]

        solution = solve_ivp(
            slope, (a, b), state, "DOP853", rtol=1e-11, atol=1e-13, dense_output=True
        )
        inside = (times > a) & (times <= b)
        if inside.any():
            angles[inside] = solution.sol(times[inside])[0]
        state = solution.y[:, -1]
    return angles


def folded_chain_fall_time(length: float, gravity: float = 9.80665) -> float:
    """[s] until the released end of a chain, folded in its middle, is straight below the fixed one.

    Energy with the two arms alone moving (Calkin and March 1989): xdot^2 = g x (2L - x)/(L - x)
    for a fall x of the end from 0 to L. With x = L sin^2(p) both ends of the integral are regular.
    """
    integral = mp.quad(lambda p: 2 * mp.cos(p) ** 2 / mp.sqrt(1 + mp.cos(p) ** 2), [0, mp.pi / 2])
    return float(mp.sqrt(length / gravity) * integral)


def folded_chain_fall(length: float, times: ArrayLike, gravity: float = 9.80665) -> Array:
    """Fall x [m] of the released end at `times` [s], before it is straight."""

    def elapsed(p):
        return mp.sqrt(length / gravity) * mp.quad(
            lambda q: 2 * mp.cos(q) ** 2 / mp.sqrt(1 + mp.cos(q) ** 2), [0, p]
        )

    angles = [
        brentq(lambda p, t=t: float(elapsed(p)) - t, 0.0, np.pi / 2, xtol=1e-14)
        for t in np.asarray(times, float)
    ]
    return np.array([float(length * mp.sin(p) ** 2) for p in angles])


def axial_front(
    axial_stiffness: float, mass: float, velocity: Callable[[ArrayLike], Array], times: ArrayLike
) -> Array:
    """Tension [N] at the end of a bar that is pulled with velocity(t), until the echo returns."""
    return np.sqrt(axial_stiffness * mass) * velocity(np.asarray(times, float))
