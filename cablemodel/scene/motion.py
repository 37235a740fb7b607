"""Prescribed motion of the tow point: pieces of polynomials and arcs over time.

The pieces are plain numbers in one array, so that the kernels evaluate them without Python;
`VesselMotion.evaluate` is the reference that they must match.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from cablemodel.scene.vessel import Leg

FloatArray = NDArray[np.float64]

COLUMNS = 24
T_START, T_END, KIND, SHAPE = 0, 1, 2, 3
"""Columns of a piece; its shape begins at column 3."""
POLYNOMIAL, ARC = 0.0, 1.0
"""Kinds. Polynomial: c[3 k + i] of tau^k, k = 0...4, i = x, y, z, tau = t - t_start.
Arc in the horizontal plane: centre x, y, z; radius; angle of the position seen from the centre,
its rate and acceleration at tau = 0 [rad, rad/s, rad/s2], counter-clockwise from x."""
DEGREE = 4

_OUT_OF_PLANE = 1e-10
AT_REST = 1e-9
"""Speed that is the rounding of a table [m/s]."""


class VesselMotion:
    """Position, velocity and acceleration of the tow point over time, for t >= 0.

    The velocity is continuous everywhere; the acceleration may jump from piece to piece.

    Attributes:
        pieces: (n_pieces, 24) in order of time, without gaps, from t = 0 to infinity; see the
            constants of this module for the columns.
    """

    def __init__(self, pieces: ArrayLike) -> None:
        self.pieces: FloatArray = np.array(pieces, dtype=np.float64)
        if self.pieces.ndim != 2 or self.pieces.shape[1] != COLUMNS or len(self.pieces) == 0:
            raise ValueError(f"pieces must be (n, {COLUMNS}) with n > 0, not {self.pieces.shape}")
        self.pieces.flags.writeable = False

    @classmethod
    def from_table(
        cls,
        t: ArrayLike,
        velocity: ArrayLike,
        position: Sequence[float],
        interpolation: str = "linear",
    ) -> VesselMotion:
        """Motion by a table of velocity that holds its first and its last value.

        ``cubic`` puts a cubic Hermite curve through the table: its slope at a row is that of the
        parabola through the row and its two neighbours, and zero at the first and last row, which
        are held. It is linear in the data, so a rotated table gives the rotated motion (a limiter
        that forbids overshoot, as in PCHIP, works per axis and would not); a row acts on its four
        neighbouring intervals only (a twice differentiable spline would move a vessel at rest
        before its start); and the acceleration is continuous.

        Args:
            t: times, rising strictly (n,) [s].
            velocity: (n, 3) [m/s].
            position: at t = 0, (3,) [m].
            interpolation: ``linear`` or ``cubic``.
        """
        times = np.asarray(t, dtype=np.float64)
        values = np.asarray(velocity, dtype=np.float64).reshape(-1, 3)
        if len(times) != len(values) or len(times) == 0 or np.any(np.diff(times) <= 0):
            raise ValueError("a table needs as many velocities as times, and times that rise")
        if interpolation not in ("linear", "cubic"):
            raise ValueError(f"interpolation is linear or cubic, not {interpolation!r}")
        pieces = _joined_velocities(times, values, interpolation)
        return cls(_started_at_zero(pieces, np.asarray(position, dtype=np.float64)))

    @classmethod
    def from_path(cls, legs: Sequence[Leg], position: Sequence[float]) -> VesselMotion:
        """Motion along a path of legs (checked by the schema) at constant height."""
        place = np.asarray(position, dtype=np.float64)
        start, heading, speed = 0.0, 0.0, 0.0
        rows = []
        for index, leg in enumerate(legs):
            move = leg.straight or leg.turn
            assert move is not None
            reached = speed if move.speed is None else move.speed
            if index == 0:
                speed = reached
            if move.heading is not None and (index == 0 or speed == 0.0):
                heading = move.heading
            if leg.turn is not None:
                row, duration = _arc(leg.turn.angle, leg.turn.radius, heading, speed, reached)
                row[SHAPE : SHAPE + 3] += place
                heading += leg.turn.angle
            else:
                assert leg.straight is not None
                row, duration = _straight(leg, heading, speed, reached)
                row[SHAPE : SHAPE + 3] = place
            row[T_START], row[T_END] = start, start + duration
            place = evaluate_piece(row, start + duration)[0]
            rows.append(row)
            start, speed = start + duration, reached
        last = np.zeros(COLUMNS)
        last[T_START], last[T_END] = start, math.inf
        last[SHAPE : SHAPE + 3] = place
        last[SHAPE + 3 : SHAPE + 5] = speed * math.cos(heading), speed * math.sin(heading)
        return cls([*rows, last])

    @property
    def breakpoints(self) -> FloatArray:
        """Times at which one piece ends and the next begins, ascending [s]."""
        return self.pieces[1:, T_START]

    def evaluate(self, t: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity, acceleration at a time, each (3,); the right limit at a breakpoint.

        Raises:
            ValueError: t is negative or not finite.
        """
        if not (math.isfinite(t) and t >= 0.0):
            raise ValueError(f"the motion is known for finite t >= 0, not {t}")
        index = int(np.searchsorted(self.pieces[:, T_START], t, side="right")) - 1
        return evaluate_piece(self.pieces[index], t)

    def track(self, times: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Positions [m] and velocities [m/s] at times (n,) [s], each (n, 3): `evaluate` at once.

        Raises:
            ValueError: a time is negative or not finite.
        """
        at = np.atleast_1d(np.asarray(times, dtype=np.float64))
        known = np.isfinite(at) & (at >= 0.0)
        if not known.all():
            raise ValueError(f"the motion is known for finite t >= 0, not {at[~known][0]}")
        index = np.searchsorted(self.pieces[:, T_START], at, side="right") - 1
        rows = self.pieces[index]
        c = rows[:, SHAPE : SHAPE + 15].reshape(-1, DEGREE + 1, 3)
        tau = (at - rows[:, T_START])[:, None]
        place, velocity = _polynomial(c.transpose(1, 0, 2), tau)[:2]
        for n in np.flatnonzero(rows[:, KIND] == ARC):
            place[n], velocity[n] = evaluate_piece(rows[n], float(at[n]))[:2]
        return place, velocity

    def typical_velocities(self) -> FloatArray:
        """Velocities where its pieces begin, and a second later or where they end, (2 n, 3) [m/s].

        n is the number of pieces, of which each begins with what the one before ends with.
        """
        later = np.minimum(self.pieces[:, T_END] - self.pieces[:, T_START], 1.0)
        return np.concatenate([_velocities(self.pieces), _velocities(self.pieces, later)])

    @cached_property
    def typical_speed(self) -> float:
        """The largest of the typical velocities [m/s]."""
        return float(np.linalg.norm(self.typical_velocities(), axis=1).max())

    def is_planar(self) -> bool:
        """Whether the tow point stays in one vertical plane."""
        return self._plane[0]

    def horizontal_direction(self) -> FloatArray | None:
        """Horizontal unit vector (2,) of that plane.

        None if the motion is not planar, or if any plane will do because the tow point rests or
        only rises and falls.
        """
        return self._plane[1]

    @cached_property
    def _plane(self) -> tuple[bool, FloatArray | None]:
        if np.any(self.pieces[:, KIND] == ARC):
            return False, None
        # Velocities lie in one plane at all times if the coefficients of every power do; each is
        # weighed by what it adds to the velocity within its piece.
        shapes = self.pieces[:, SHAPE : SHAPE + 3 * (DEGREE + 1)].reshape(-1, DEGREE + 1, 3)
        spans = np.where(np.isfinite(self.pieces[:, T_END]), np.diff(self.pieces[:, :2])[:, 0], 1.0)
        powers = np.arange(1, DEGREE + 1)
        weights = powers * spans[:, None] ** (powers - 1)
        velocities = (shapes[:, 1:, :2] * weights[:, :, None]).reshape(-1, 2)
        sizes = np.hypot(velocities[:, 0], velocities[:, 1])
        largest = int(np.argmax(sizes))
        if sizes[largest] == 0.0:
            return True, None
        direction: FloatArray = velocities[largest] / sizes[largest]
        direction.flags.writeable = False
        across = velocities @ np.array([-direction[1], direction[0]])
        if np.max(np.abs(across)) > _OUT_OF_PLANE * sizes[largest]:
            return False, None
        return True, direction


def _joined_velocities(times: FloatArray, values: FloatArray, interpolation: str) -> FloatArray:
    """Pieces of a velocity table from its first time on; their positions all begin at zero."""
    n = len(times)
    pieces = np.zeros((n, COLUMNS))
    pieces[:, T_START] = times
    pieces[:-1, T_END] = times[1:]
    pieces[-1, T_END] = math.inf
    shape = pieces[:, SHAPE : SHAPE + 15].reshape(n, DEGREE + 1, 3)
    shape[:, 1] = values
    if n > 1:
        span = np.diff(times)[:, None]
        change = np.diff(values, axis=0)
        if interpolation == "linear":
            shape[:-1, 2] = change / span / 2
        else:
            slope = _slopes(span, change)
            left, right = slope[:-1], slope[1:]
            shape[:-1, 2] = left / 2
            shape[:-1, 3] = (3 * change / span - 2 * left - right) / span / 3
            shape[:-1, 4] = (left + right - 2 * change / span) / span**2 / 4
    pieces[:, SHAPE : SHAPE + 15] = shape.reshape(n, 15)
    return pieces


def _slopes(span: FloatArray, change: FloatArray) -> FloatArray:
    """Slopes of the cubic at the rows of a table: of the parabola inside, zero at its ends."""
    secant = change / span
    slope = np.zeros((len(span) + 1, 3))
    slope[1:-1] = (span[:-1] * secant[1:] + span[1:] * secant[:-1]) / (span[:-1] + span[1:])
    return slope


def _started_at_zero(pieces: FloatArray, position: FloatArray) -> FloatArray:
    """Pieces from t = 0 on, their positions joined so that the motion begins at ``position``."""
    first = pieces[0, T_START]
    if first > 0:
        hold = np.zeros((1, COLUMNS))
        hold[0, T_END] = first
        hold[0, SHAPE + 3 : SHAPE + 6] = pieces[0, SHAPE + 3 : SHAPE + 6]
        pieces = np.concatenate([hold, pieces])
    else:
        pieces = pieces[pieces[:, T_END] > 0]
        if pieces[0, T_START] < 0.0:
            _move_start(pieces[0], -pieces[0, T_START])
        pieces[0, T_START] = 0.0
        pieces[0] += 0.0  # no zero of it is negative
    travel = np.zeros((len(pieces), 3))
    if len(pieces) > 1:
        span = (pieces[:-1, T_END] - pieces[:-1, T_START])[:, None]
        for power in range(DEGREE, 0, -1):
            place = SHAPE + 3 * power
            travel[1:] = (travel[1:] + pieces[:-1, place : place + 3]) * span
    pieces[:, SHAPE : SHAPE + 3] = position + np.cumsum(travel, axis=0)
    return pieces


def _move_start(piece: FloatArray, tau: float) -> None:
    """Expand a polynomial piece anew about a time ``tau`` after its start (in place)."""
    shape = piece[SHAPE : SHAPE + 15].reshape(DEGREE + 1, 3)
    moved = np.zeros_like(shape)
    for power in range(DEGREE + 1):
        for k in range(power, DEGREE + 1):
            moved[power] += math.comb(k, power) * tau ** (k - power) * shape[k]
    piece[SHAPE : SHAPE + 15] = moved.reshape(15)


def _straight(leg: Leg, heading: float, speed: float, reached: float) -> tuple[FloatArray, float]:
    straight = leg.straight
    assert straight is not None
    duration = straight.duration
    if duration is None:
        assert straight.length is not None
        duration = 2 * straight.length / (speed + reached)
    ahead = np.array([math.cos(heading), math.sin(heading), 0.0])
    row = np.zeros(COLUMNS)
    row[KIND] = POLYNOMIAL
    row[SHAPE + 3 : SHAPE + 6] = speed * ahead
    row[SHAPE + 6 : SHAPE + 9] = (reached - speed) / duration / 2 * ahead
    return row, duration


def _arc(
    angle: float, radius: float, heading: float, speed: float, reached: float
) -> tuple[FloatArray, float]:
    """An arc that begins at the origin."""
    duration = 2 * abs(angle) * radius / (speed + reached)
    side = math.copysign(1.0, angle)
    row = np.zeros(COLUMNS)
    row[KIND] = ARC
    # The centre is abeam: to port (heading + 90 deg) when turning to port.
    row[SHAPE] = -side * radius * math.sin(heading)
    row[SHAPE + 1] = side * radius * math.cos(heading)
    row[SHAPE + 3] = radius
    row[SHAPE + 4] = heading - side * math.pi / 2
    row[SHAPE + 5] = side * speed / radius
    row[SHAPE + 6] = side * (reached - speed) / duration / radius
    return row, duration


def evaluate_piece(piece: FloatArray, t: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position, velocity, acceleration by one row of `pieces` at a time, each (3,)."""
    tau = t - piece[T_START]
    if piece[KIND] == ARC:
        centre, radius = piece[SHAPE : SHAPE + 3], piece[SHAPE + 3]
        angle0, rate0, acceleration = piece[SHAPE + 4 : SHAPE + 7]
        angle = angle0 + (rate0 + acceleration * tau / 2) * tau
        rate = rate0 + acceleration * tau
        outward = np.array([math.cos(angle), math.sin(angle), 0.0])
        ahead = np.array([-math.sin(angle), math.cos(angle), 0.0])
        return (
            centre + radius * outward,
            radius * rate * ahead,
            radius * acceleration * ahead - radius * rate**2 * outward,
        )
    return _polynomial(piece[SHAPE : SHAPE + 15].reshape(DEGREE + 1, 3), tau)


def jumps(pieces: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Jumps of velocity [m/s], acceleration [m/s2], jerk [m/s3] from piece to piece, (n - 1,) each.

    A jump of the velocity that is rounding is none.
    """
    spans = pieces[1:, T_START] - pieces[:-1, T_START]
    ends, begins = _rates(pieces[:-1], spans), _rates(pieces[1:])
    size = np.linalg.norm(begins[0], axis=1) + np.linalg.norm(ends[0], axis=1)
    velocity = np.linalg.norm(begins[0] - ends[0], axis=1)
    velocity[velocity <= 1e-9 * size] = 0.0
    acceleration, jerk = (np.linalg.norm(begins[k] - ends[k], axis=1) for k in (1, 2))
    return velocity, acceleration, jerk


def _rates(
    pieces: FloatArray, tau: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Velocities [m/s], accelerations [m/s2] and jerks [m/s3], (n, 3), of pieces at times (n,) from
    their starts [s]; None: where they begin."""
    c = _coefficients(pieces)
    velocity = _velocities(pieces, tau)
    if tau is None:
        acceleration, jerk = 2.0 * c[2], 6.0 * c[3]
    else:
        t = tau[:, None]
        acceleration, jerk = _acceleration(c, t), 6.0 * c[3] + 24.0 * t * c[4]
    for n in np.flatnonzero(pieces[:, KIND] == ARC):
        after = 0.0 if tau is None else tau[n]
        acceleration[n] = evaluate_piece(pieces[n], pieces[n, T_START] + after)[2]
        spin = pieces[n, SHAPE + 6]
        rate = pieces[n, SHAPE + 5] + spin * after
        across = np.array([-velocity[n, 1], velocity[n, 0], 0.0])  # to the left
        jerk[n] = 3.0 * spin * across - rate**2 * velocity[n]
    return velocity, acceleration, jerk


def _velocities(pieces: FloatArray, tau: FloatArray | None = None) -> FloatArray:
    """The first of `_rates`, (n, 3) [m/s]."""
    c = _coefficients(pieces)
    velocity = c[1].copy() if tau is None else _velocity(c, tau[:, None])
    for n in np.flatnonzero(pieces[:, KIND] == ARC):
        after = 0.0 if tau is None else tau[n]
        velocity[n] = evaluate_piece(pieces[n], pieces[n, T_START] + after)[1]
    return velocity


def _coefficients(pieces: FloatArray) -> FloatArray:
    """Of the powers of time in polynomial pieces (n, 24), (DEGREE + 1, n, 3)."""
    shape = pieces[:, SHAPE : SHAPE + 3 * (DEGREE + 1)]
    return shape.reshape(-1, DEGREE + 1, 3).transpose(1, 0, 2)


def _polynomial(c: FloatArray, tau: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Its value and both derivatives, from the coefficients of its powers, (DEGREE + 1, ...)."""
    place = c[0] + tau * (c[1] + tau * (c[2] + tau * (c[3] + tau * c[4])))
    return place, _velocity(c, tau), _acceleration(c, tau)


def _velocity(c: FloatArray, tau: Any) -> FloatArray:
    return np.asarray(c[1] + tau * (2 * c[2] + tau * (3 * c[3] + tau * 4 * c[4])))


def _acceleration(c: FloatArray, tau: Any) -> FloatArray:
    return np.asarray(2 * c[2] + tau * (6 * c[3] + tau * 12 * c[4]))
