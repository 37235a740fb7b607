"""Elastic catenaries that meet at a point, and what swings there: other programs' unknowns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import eigh
from scipy.optimize import root

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Leg:
    """From the junction to where it is held."""

    anchor: tuple[float, float, float]
    """[m]."""
    length: float
    """Unstretched [m]."""
    weight: float
    """[N/m]."""
    stiffness: float
    """EA [N]."""

    def reach(self, force: Floats, s: ArrayLike) -> Floats:
        """Places (n, 3) relative to the junction at unstretched distances (n,) from it [m].

        force: of the leg's tension on the junction (3,) [N] (Irvine 1981, chapter 1: the force
        along it is that plus its weight so far).
        """
        s = np.asarray(s, dtype=np.float64)
        across = float(np.hypot(force[0], force[1]))
        first, here = force[2], force[2] + self.weight * s
        along = (
            s / self.stiffness
            + (np.arcsinh(here / across) - np.arcsinh(first / across)) / self.weight
        )
        up = (first * s + 0.5 * self.weight * s**2) / self.stiffness + (
            np.hypot(across, here) - np.hypot(across, first)
        ) / self.weight
        return np.stack([force[0] * along, force[1] * along, up], axis=-1)

    def end_tension(self, force: Floats) -> float:
        """Where it is held [N]."""
        return float(np.hypot(np.hypot(*force[:2]), force[2] + self.weight * self.length))


def meeting(legs: Sequence[Leg], guess: ArrayLike) -> tuple[Floats, Floats]:
    """Where legs meet in balance (3,) [m], and the forces of their tensions there (n, 3) [N].

    guess: of the place (3,) [m].

    Raises:
        RuntimeError: no balance was found.
    """
    count = len(legs)
    place = np.asarray(guess, dtype=np.float64)
    ways = np.array([leg.anchor for leg in legs]) - place
    pulls = np.array([leg.weight * leg.length for leg in legs])
    forces = pulls[:, None] * ways / np.linalg.norm(ways, axis=1)[:, None]
    scale = float(pulls.max())

    def left(unknowns: Floats) -> Floats:
        at, pull = unknowns[:3], scale * unknowns[3:].reshape(count, 3)
        gaps = [
            at + leg.reach(force, leg.length) - leg.anchor
            for leg, force in zip(legs, pull, strict=True)
        ]
        return np.concatenate([*gaps, pull.sum(axis=0) / scale])

    found = root(left, np.concatenate([place, forces.ravel() / scale]), tol=1e-13)
    if np.abs(left(found.x)).max() > 1e-8:
        raise RuntimeError(f"no balance: {found.message}")
    return found.x[:3], scale * found.x[3:].reshape(count, 3)


def two_masses(upper: float, lower: float, mass: float, hung: float, gravity: float) -> Floats:
    """Frequencies of two masses on light strings one below the other (2,) [rad/s], small angles.

    Args:
        upper, lower: lengths of the strings [m].
        mass: of the upper one, at the junction [kg].
        hung: of the lower one [kg].
        gravity: [m/s2].
    """
    pull, below = (mass + hung) * gravity / upper, hung * gravity / lower
    stiffness = np.array([[pull + below, -below], [-below, below]])
    return np.sqrt(eigh(stiffness, np.diag([mass, hung]), eigvals_only=True))
