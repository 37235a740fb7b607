"""Rotations between the vessel's frame and the map (x east, y north, z up)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cablemodel.results.log.messages import quaternion_of

Floats = NDArray[np.float64]


def rotation(quaternion: ArrayLike) -> Floats:
    """Matrix (3, 3) that turns vessel axes into the map's, of a quaternion (x, y, z, w).

    Raises:
        ValueError: the quaternion is not finite or not of unit length (to 1 %).
    """
    q = np.asarray(quaternion, dtype=np.float64)
    size = float(np.linalg.norm(q))
    if not abs(size - 1.0) <= 0.01:
        raise ValueError(f"orientation is {q.tolist()}, not a unit quaternion")
    x, y, z, w = q / size
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def cross(a: Floats, b: Floats) -> Floats:
    """Cross product of two vectors (3,); NumPy's takes ten times as long for one pair."""
    x, y, z = a.tolist()
    u, v, w = b.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def finite(values: Floats) -> bool:
    """Whether all of a few numbers are; NumPy's own test takes several times as long for them."""
    return all(map(math.isfinite, values.tolist()))


def heading_rotation(heading: float) -> Floats:
    """Matrix (3, 3) of a vessel on even keel with its bow `heading` [rad] from the x axis."""
    c, s = math.cos(heading), math.sin(heading)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def turned(matrix: Floats, spin: Floats, dt: float) -> Floats:
    """A rotation matrix (3, 3) after dt [s] of a spin (3,) [rad/s] in map axes."""
    angle = math.sqrt(spin.dot(spin)) * dt
    if angle == 0.0:
        return matrix
    x, y, z = spin * (dt / angle)
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + math.sin(angle) * across + (1.0 - math.cos(angle)) * across @ across
    return rotation(quaternion_of(turn @ matrix))  # round-off does not add up


def axes_of(angles: Floats) -> Floats:
    """Matrix (3, 3) of roll, pitch and yaw (3,) [rad]: Rz Ry Rx, as `SystemModel` has them."""
    (a, b, c), (u, v, w) = np.cos(angles).tolist(), np.sin(angles).tolist()
    return np.array(
        [
            [c * b, c * v * u - w * a, c * v * a + w * u],
            [w * b, w * v * u + c * a, w * v * a - c * u],
            [-v, b * u, b * a],
        ]
    )


def angles_of(matrix: Floats) -> Floats:
    """Roll, pitch and yaw (3,) [rad] of a rotation matrix (3, 3); pitch from -pi/2 to pi/2."""
    m = matrix.tolist()
    level = math.hypot(m[0][0], m[1][0])
    return np.array(
        [
            math.atan2(m[2][1], m[2][2]),
            math.atan2(-m[2][0], level),
            math.atan2(m[1][0], m[0][0]),
        ]
    )


def angle_rates(angles: Floats, spin: Floats) -> Floats:
    """Rates (3,) of roll, pitch and yaw under a spin (3,) [rad/s] in map axes.

    Beyond all limits where the x axis points straight up or down.
    """
    _, pitch, yaw = angles.tolist()
    x, y, z = spin.tolist()
    c, s = math.cos(yaw), math.sin(yaw)
    ahead, level = c * x + s * y, math.cos(pitch)
    roll = ahead / level  # no angle's cosine is zero to the last bit
    return np.array([roll, c * y - s * x, z + roll * math.sin(pitch)])
