"""The layer of bending at the touchdown of a lay on a rigid floor without friction."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

from cablemodel.scene.line import CableType


def touchdown_layer(
    kind: CableType, tension: float, speed: float, through: float, inertia: float = 1.0
) -> tuple[float, float]:
    """Concentrated reaction [N] and largest curvature [1/m] of cable that lies down steadily.

    An initial value problem from the touchdown up, in the touchdown's frame, by shooting for the
    reaction with which the cable ends straight; in water of 1025 kg/m3.

    tension: at the touchdown [N]; speed: of the touchdown over the floor [m/s]; through: of the
    cable through the touchdown [m/s]; inertia: share of (m + ma) V^2 kappa that counts.
    """
    weight, stiffness = kind.submerged_weight, kind.bending_stiffness
    added = kind.added_mass * 1025.0 * math.pi / 4.0 * kind.diameter**2
    centrifugal = inertia * (kind.mass + added) * through**2
    normal = 0.5 * 1025.0 * kind.diameter * kind.drag_normal * speed**2
    tangential = 0.5 * 1025.0 * kind.drag_tangential * math.pi * kind.diameter

    def rates(_s: float, state: np.ndarray) -> list[float]:
        angle, curvature, pull, shear = state
        slip = through - speed * math.cos(angle)
        return [
            curvature,
            -shear / stiffness,
            shear * curvature + weight * math.sin(angle) - tangential * slip * abs(slip),
            (centrifugal - pull) * curvature
            + weight * math.cos(angle)
            - normal * math.sin(angle) * abs(math.sin(angle)),
        ]

    ratio = normal / weight
    hanging = math.acos(2.0 * ratio / (1.0 + math.sqrt(1.0 + 4.0 * ratio**2)))

    def straight(_s: float, state: np.ndarray) -> float:
        return float(state[1]) + 1e-9

    def rolled_up(_s: float, state: np.ndarray) -> float:
        return float(state[0]) - 0.5 * (hanging + math.pi)

    straight.terminal = rolled_up.terminal = True  # type: ignore[attr-defined]
    layer = math.cbrt(stiffness / weight)
    low, high = 0.5 * weight * layer, 2.0 * weight * layer
    largest = math.nan
    for _ in range(40):
        reaction = 0.5 * (low + high)
        up = solve_ivp(
            rates,
            (0.0, 20.0 * layer),
            [0.0, 0.0, tension, -reaction],
            rtol=1e-9,
            atol=1e-11,
            events=[straight, rolled_up],
        )
        if up.t_events[1].size:
            high = reaction
        else:
            low, largest = reaction, float(up.y[1].max())
    return low, largest
