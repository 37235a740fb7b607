"""Lumped masses and springs by SciPy: a towed flexible cable for which two runs are compared.

Second order in the spacing only, so that it does not compete with the reference tables.
It is for *differences*: what a term of the equations changes, to a few parts in a thousand.
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

from tests.verification.references.static_cable import CableProperties

Array = NDArray[np.float64]
Motion = Callable[[float], tuple[Array, Array]]


def towed_cable(
    cable: CableProperties,
    axial_stiffness: float,
    mass: float,
    added_mass: float,
    motion: Motion,
    start: Array,
    breakpoints: ArrayLike,
    times: ArrayLike,
    rtol: float = 1e-8,
) -> tuple[Array, Array]:
    """Free end relative to the vessel (n, 3) [m] and top tension (n,) [N] at `times`.

    motion(t) -> position, velocity of the vessel (3,); start (nodes, 3): positions at t = 0, at
    the vessel's velocity. Bending is left out. Axial waves are damped by a strain-rate force
    EA 5e-4 s, far faster than anything else moves.
    """
    count = len(start) - 1
    h = cable.length / count
    damping = axial_stiffness * 5e-4
    share = np.full(count, h)
    share[-1] = h / 2.0
    weight = np.array([0.0, 0.0, -cable.weight])

    def segments(t: float, y: Array):
        state = y.reshape(count, 6)
        position, velocity = motion(t)
        r = np.vstack((position, state[:, :3]))
        v = np.vstack((velocity, state[:, 3:]))
        chord = np.diff(r, axis=0)
        distance = np.linalg.norm(chord, axis=1)
        direction = chord / distance[:, None]
        rate = np.einsum("ij,ij->i", np.diff(v, axis=0), direction)
        tension = axial_stiffness * (distance / h - 1.0) + damping * rate / h
        return v, direction, distance / h, tension

    def slope(t: float, y: Array) -> Array:
        v, direction, stretch, tension = segments(t, y)
        force = -tension[:, None] * direction
        force[:-1] -= force[1:]
        tangent = direction.copy()
        tangent[:-1] += direction[1:]
        tangent /= np.linalg.norm(tangent, axis=1)[:, None]
        factor = stretch.copy()
        factor[:-1] = (stretch[:-1] + stretch[1:]) / 2.0
        factor = factor**cable.drag_exponent
        u = -v[1:]
        along = np.einsum("ij,ij->i", u, tangent)
        across = u - along[:, None] * tangent
        drag = cable.normal_drag * np.linalg.norm(across, axis=1)[:, None] * across
        drag += (cable.tangential_drag * np.abs(along) * along)[:, None] * tangent
        total = force + share[:, None] * (weight + factor[:, None] * drag)
        lengthwise = np.einsum("ij,ij->i", total, tangent)[:, None] * tangent
        acceleration = lengthwise / mass + (total - lengthwise) / (mass + added_mass)
        acceleration /= share[:, None]
        return np.hstack((v[1:], acceleration)).ravel()

    marks = np.asarray(breakpoints, float)
    times = np.asarray(times, float)
    y = np.hstack((start[1:], np.tile(motion(0.0)[1], (count, 1)))).ravel()
    tip, top = np.empty((len(times), 3)), np.empty(len(times))
    for a, b in pairwise(marks):
        inside = np.flatnonzero((times > a) & (times <= b))
        solution = solve_ivp(
            slope,
            (a, b),
            y,
            "LSODA",
            t_eval=np.unique(np.r_[times[inside], b]),
            rtol=rtol,
            atol=1e-9,
            lband=11,
            uband=11,
        )
        if not solution.success:
            raise ArithmeticError(solution.message)
        for column, index in enumerate(inside):
            state = solution.y[:, column]
            tension = segments(times[index], state)[3]
            tip[index] = state.reshape(count, 6)[-1, :3] - motion(times[index])[0]
            top[index] = 1.5 * tension[0] - 0.5 * tension[1]
        y = solution.y[:, -1]
    return tip, top
