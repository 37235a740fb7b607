"""Large bending of an elastic rod in a plane: closed forms, and the rod with a stretch.

Angles are of the tangent, anticlockwise from x; loads are forces in the plane. `extensible_rod`
is the rod of the theory exactly (M = EI dtheta/ds with s unstretched, r' = e t, stretch from the
tension), so that a numerical solution need not be inextensible to be compared to many digits.
"""

from dataclasses import dataclass

import mpmath as mp
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, newton

Array = NDArray[np.float64]


def cantilever_tip_load(load: float) -> tuple[float, float, float]:
    """(x, y, theta)/L at the tip of a cantilever with a transverse end load P L^2/EI = `load`.

    Bisshopp and Drucker (1945): with k^2 = (1 + sin theta)/2 and sin phi1 = 1/(k sqrt 2),
    K(k) - F(phi1, k) = sqrt(load), x = sqrt(2 sin theta/load), y = 1 - 2 (E - E(phi1))/sqrt(load).
    """
    with mp.workdps(30):
        root = mp.sqrt(load)

        def residual(theta):
            m = (1 + mp.sin(theta)) / 2
            phi = mp.asin(1 / mp.sqrt(2 * m))
            return mp.ellipk(m) - mp.ellipf(phi, m) - root

        theta = mp.mpf(brentq(lambda x: float(residual(mp.mpf(x))), 1e-6, 1.5707963, xtol=1e-15))
        m = (1 + mp.sin(theta)) / 2
        phi = mp.asin(1 / mp.sqrt(2 * m))
        x = mp.sqrt(2 * mp.sin(theta) / load)
        y = 1 - 2 / root * (mp.ellipe(m) - mp.ellipe(phi, m))
        return float(x), float(y), float(theta)


def clamped_end_curvature(bending_stiffness: float, tension: float, angle: float) -> float:
    """Curvature [1/m] at the clamp of a long rod whose far part pulls at `angle` [rad]."""
    layer = np.sqrt(bending_stiffness / tension)
    return float(2.0 / layer * np.sin(angle / 2.0))


def clamped_end_offset(bending_stiffness: float, tension: float, angle: float) -> float:
    """Distance [m] of the clamp from the line on which the far part lies."""
    layer = np.sqrt(bending_stiffness / tension)
    return float(2.0 * layer * np.sin(angle / 2.0))


@dataclass(frozen=True)
class Rod:
    """Columns over s [m]: x, z [m] from the clamp, theta [rad], bending moment EI theta' [N m]."""

    s: Array
    x: Array
    z: Array
    theta: Array
    moment: Array

    @property
    def tip(self) -> Array:
        """(x, z) of the far end relative to the clamp."""
        return np.array([self.x[-1], self.z[-1]])


def extensible_rod(
    length: float,
    bending_stiffness: float,
    axial_stiffness: float,
    clamp_angle: float,
    weight: float = 0.0,
    end_force: tuple[float, float] = (0.0, 0.0),
    steps: int = 20,
) -> Rod:
    """Clamped at s = 0 at `clamp_angle`, free moment and `end_force` at s = L; weight w downwards.

    theta' = M/EI, M' = -e t x n, r' = e t, with n = end_force - w (L - s) e_z the force that the
    part beyond exerts. It is known at every s, so that one number is to be found, the angle of
    the tip. The load is raised from zero in `steps`, which selects the branch that contains the
    unloaded rod: for w L^3/EI = 100 it is not the only one.
    """

    def slope(remaining: float, y: Array, fraction: float) -> list[float]:
        fx = fraction * end_force[0]
        fz = fraction * (end_force[1] - weight * remaining)
        c, sn = np.cos(y[2]), np.sin(y[2])
        stretch = 1.0 + (fx * c + fz * sn) / axial_stiffness
        return [
            -stretch * c, -stretch * sn, -y[3] / bending_stiffness, stretch * (c * fz - sn * fx)
        ]  # fmt: skip

    def from_the_tip(angle: float, fraction: float, dense: bool = False):
        return solve_ivp(
            slope,
            (0.0, length),
            [0.0, 0.0, angle, 0.0],
            "DOP853",
            args=(fraction,),
            rtol=3e-14,
            atol=1e-16,
            dense_output=dense,
        )

    tips = [clamp_angle]
    for step in range(1, steps + 1):
        guess = tips[-1] if len(tips) == 1 else 2 * tips[-1] - tips[-2]
        tips.append(
            newton(
                lambda a, f=step / steps: from_the_tip(a, f).y[2, -1] - clamp_angle,
                guess,
                x1=guess + 1e-7,
                tol=1e-15,
                maxiter=100,
            )
        )
    solution = from_the_tip(tips[-1], 1.0, dense=True)
    s = np.linspace(0.0, length, 201)
    x, z, theta, moment = solution.sol(length - s)
    return Rod(s, x - x[0], z - z[0], theta, moment)
