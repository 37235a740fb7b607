"""Elastic catenary that partly lies on a level floor, with Coulomb friction: closed form.

Its lower end is anchored at the origin, on the floor. Friction acts towards the anchor on all that
lies: the cable was laid without tension and then pulled at its upper end.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class MooredCatenary:
    """A moored line in equilibrium; arc lengths s count from the anchor, unstretched [m]."""

    weight: float
    axial_stiffness: float
    friction: float
    laid: float
    """Unstretched length on the floor [m]."""
    horizontal: float
    """Horizontal tension where it hangs [N]."""

    def tension(self, s: FloatArray) -> FloatArray:
        """Tension (n,) [N]."""
        rubbed = self.horizontal - self.friction * self.weight * (self.laid - s)
        hanging = np.hypot(self.horizontal, self.weight * (s - self.laid))
        return np.where(s < self.laid, np.maximum(rubbed, 0.0), hanging)

    def position(self, s: FloatArray) -> FloatArray:
        """x from the anchor and z from the floor (n, 2) [m]."""
        w, ea, h = self.weight, self.axial_stiffness, self.horizontal
        free = np.maximum(s - self.laid, 0.0)
        x = np.minimum(s, self.laid)
        x = x + self._stretch(x) + h / w * np.arcsinh(w * free / h) + h * free / ea
        z = h / w * (np.hypot(1.0, w * free / h) - 1.0) + w * free**2 / (2.0 * ea)
        return np.stack([x, z], axis=-1)

    def _stretch(self, s: FloatArray) -> FloatArray:
        """How much of the laid cable up to s is stretch [m]: the integral of T / EA."""
        loss = self.friction * self.weight
        if loss == 0.0:
            return self.horizontal * s / self.axial_stiffness
        slack = max(0.0, self.laid - self.horizontal / loss)
        low = self.horizontal - loss * (self.laid - slack)
        way = np.maximum(s - slack, 0.0)
        return (low * way + loss * way**2 / 2.0) / self.axial_stiffness


def moored_catenary(
    x: float, z: float, length: float, weight: float, axial_stiffness: float, friction: float
) -> MooredCatenary:
    """The line whose upper end is at (x, z) from its anchor."""

    def line(laid: float) -> MooredCatenary:
        def rise(h: float) -> float:
            trial = MooredCatenary(weight, axial_stiffness, friction, laid, h)
            return float(trial.position(np.array([length]))[0, 1]) - z

        # Without bending the horizontal tension for a hanging length follows from the rise.
        h = brentq(rise, 1e-6 * weight * length, 1e6 * weight * length, xtol=1e-12, rtol=1e-14)
        return MooredCatenary(weight, axial_stiffness, friction, laid, h)

    def reach(laid: float) -> float:
        return float(line(laid).position(np.array([length]))[0, 0]) - x

    return line(brentq(reach, 0.0, 0.999 * (length - z), xtol=1e-12, rtol=1e-14))
