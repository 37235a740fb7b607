"""Elastic catenary between two points: closed form for a linear tension-strain law."""

from dataclasses import dataclass

import mpmath as mp


@dataclass(frozen=True)
class Catenary:
    """A cable from (0, 0) to (X, Z) with Z up, in the plane of the two points.

    horizontal: horizontal force, the same along the cable [N]; low_vertical: upward component of
    the tension at s = 0 [N] (negative where the cable sags below its lower end).
    """

    horizontal: float
    low_vertical: float
    length: float
    weight: float
    axial_stiffness: float

    def tension(self, s: float) -> float:
        """Tension [N] at unstretched arc length s from the lower end [m]."""
        return float(mp.hypot(self.horizontal, self.low_vertical + self.weight * s))

    def position(self, s: float) -> tuple[float, float]:
        """(x, z) [m] at unstretched arc length s from the lower end [m]."""
        x, z = _position(s, self.horizontal, self.low_vertical, self.weight, self.axial_stiffness)
        return float(x), float(z)


def _position(s, horizontal, low_vertical, weight, axial_stiffness):
    """Irvine (1981), Cable Structures, section 2.4: weight per unstretched length."""
    vertical = low_vertical + weight * s
    x = horizontal * s / axial_stiffness + horizontal / weight * (
        mp.asinh(vertical / horizontal) - mp.asinh(low_vertical / horizontal)
    )
    z = (low_vertical * s + weight * s**2 / 2) / axial_stiffness + (
        mp.hypot(horizontal, vertical) - mp.hypot(horizontal, low_vertical)
    ) / weight
    return x, z


def elastic_catenary(
    span: float, rise: float, length: float, weight: float, axial_stiffness: float
) -> Catenary:
    """Solve for the end force of a cable of unstretched `length` [m] between two points."""
    with mp.workdps(30):
        chord = mp.hypot(span, rise)
        if length > chord:
            horizontal = weight * span / (2 * mp.sqrt(3 * (length / chord - 1)))
        else:  # taut: stretched by what is missing, and by its own sag
            sag = mp.cbrt(axial_stiffness * (weight * span) ** 2 / 24)
            horizontal = axial_stiffness * (chord / length - 1) * span / chord + sag
        low_vertical = horizontal * rise / span - weight * mp.mpf(length) / 2

        def residual(log_horizontal, vertical):
            force = mp.e**log_horizontal
            x, z = _position(mp.mpf(length), force, vertical, weight, axial_stiffness)
            return x - span, z - rise

        log_horizontal, low_vertical = mp.findroot(
            residual, (mp.log(horizontal), low_vertical), tol=1e-20, maxsteps=100
        )
        return Catenary(
            float(mp.e**log_horizontal), float(low_vertical), length, weight, axial_stiffness
        )


def pinned_catenary_span(
    horizontal: float, length: float, weight: float, axial_stiffness: float
) -> float:
    """Distance [m] of two level supports between which the horizontal force is as given [N]."""
    x, _ = _position(
        mp.mpf(length), horizontal, -weight * mp.mpf(length) / 2, weight, axial_stiffness
    )
    return float(x)
