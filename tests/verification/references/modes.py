"""Natural frequencies of cables and beams about their equilibrium."""

from collections.abc import Callable

import mpmath as mp
import numpy as np
from scipy.optimize import brentq


def hanging_chain(length: float, count: int, gravity: float = 9.80665) -> list[float]:
    """[rad/s] of a chain hung from its top: j_0n / 2 sqrt(g/L) (Bernoulli)."""
    return [
        float(mp.besseljzero(0, n) / 2 * mp.sqrt(gravity / length)) for n in range(1, count + 1)
    ]


def hanging_elastica(stiffness: float, count: int) -> list[float]:
    """[sqrt(g/L)] of a hanging rod clamped at its top, `stiffness` = EI/(w L^3).

    With x from the free end: stiffness y'''' - (x y')' = omega^2 y, y'' = y''' = 0 at x = 0 and
    y = y' = 0 at x = 1. The solution is entire, so that its power series is exact:
    stiffness (n+4)(n+3)(n+2)(n+1) a_(n+4) = (n+1)^2 a_(n+1) + omega^2 a_n.
    """
    with mp.workdps(60):
        k = mp.mpf(stiffness)

        def series(first, omega2):
            terms = 400
            a = [mp.mpf(0)] * (terms + 5)
            a[0], a[1] = first
            for n in range(terms):
                a[n + 4] = ((n + 1) ** 2 * a[n + 1] + omega2 * a[n]) / (
                    k * (n + 4) * (n + 3) * (n + 2) * (n + 1)
                )
            return mp.fsum(a), mp.fsum(n * c for n, c in enumerate(a))

        def determinant(omega):
            value0, slope0 = series((mp.mpf(1), mp.mpf(0)), omega**2)
            value1, slope1 = series((mp.mpf(0), mp.mpf(1)), omega**2)
            return value0 * slope1 - value1 * slope0

        return _roots(determinant, count, 0.5, 0.1)


def cantilever(count: int) -> list[float]:
    """beta L of the roots of cosh cos = -1; omega = (beta L)^2 sqrt(EI/m)/L^2."""
    return _roots(lambda x: mp.cos(x) + 1 / mp.cosh(x), count, 0.5, 0.1)


def tensioned_beam_pinned(tension: float, count: int) -> list[float]:
    """[rad/s] for EI = m = L = 1: sqrt((n pi)^4 + T (n pi)^2)."""
    return [
        float(mp.sqrt((n * mp.pi) ** 4 + tension * (n * mp.pi) ** 2)) for n in range(1, count + 1)
    ]


def tensioned_beam_clamped(tension: float, count: int) -> list[float]:
    """[rad/s] for EI = m = L = 1, both ends clamped.

    Shapes cosh(p x), cos(q x), ... with p^2, q^2 = sqrt(T^2/4 + w^2) +- T/2; the determinant is
    2 p q (1 - cosh p cos q) + (p^2 - q^2) sinh p sin q = 0.
    """

    def determinant(omega):
        middle = mp.sqrt(mp.mpf(tension) ** 2 / 4 + omega**2)
        p, q = mp.sqrt(middle + tension / 2), mp.sqrt(middle - tension / 2)
        return 2 * p * q * (1 / mp.cosh(p) - mp.cos(q)) + (p * p - q * q) * mp.tanh(p) * mp.sin(q)

    return _roots(determinant, count, 5.0, 1.0)


def irvine_symmetric(parameter: float) -> float:
    """First symmetric in-plane frequency of a sagging cable [sqrt(H/m)/L].

    Irvine and Caughey (1974): tan(w/2) = w/2 - 4/lambda^2 (w/2)^3. Multiplied by cos(w/2) it has
    no poles; at lambda^2 = 4 pi^2 the root is 2 pi.
    """

    def residual(omega):
        half = omega / 2
        return mp.sin(half) - (half - 4 / mp.mpf(parameter) * half**3) * mp.cos(half)

    return _roots(residual, 1, mp.pi - mp.mpf("1e-3"), 0.05)[0]


def axial_with_end_mass(
    length: float, axial_stiffness: float, mass: float, end_mass: float, count: int
) -> list[float]:
    """[rad/s] of a bar fixed at its top with a mass at its end: b tan b = m L/M."""
    ratio = mp.mpf(mass) * length / end_mass
    roots = _roots(lambda b: b * mp.sin(b) - ratio * mp.cos(b), count, 1e-3, 0.1)
    speed = np.sqrt(axial_stiffness / mass)
    return [root * speed / length for root in roots]


def _roots(function: Callable, count: int, start: float, step: float) -> list[float]:
    """First `count` sign changes of `function` above `start`, to full double precision."""
    found: list[float] = []
    with mp.workdps(max(mp.mp.dps, 30)):
        left, value = mp.mpf(start), function(mp.mpf(start))
        while len(found) < count:
            right = left + step
            next_value = function(right)
            if mp.sign(value) != mp.sign(next_value):
                found.append(brentq(lambda x: float(function(mp.mpf(x))), left, right, xtol=1e-15))
            left, value = right, next_value
    return found
