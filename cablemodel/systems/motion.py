"""How vessels move and turn: pieces of motion for the frames of kernels/bodies/frames.py."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.scene.motion import DEGREE, POLYNOMIAL
from cablemodel.solvers.shared import layout as at

if TYPE_CHECKING:
    from cablemodel.systems.vessel_frames import VesselFrame

FloatArray = NDArray[np.float64]

_TRACK_WORDS = 2 + DEGREE + 1


LONGEST_TURN_IN = 4.0
"""Time in which a yaw rate changes where the scene does not say [s]."""
_SAME = 1e-12
"""Jump of a heading [rad] that is rounding."""


def axes_of(attitude: Sequence[float] | FloatArray) -> FloatArray:
    """Axes (3, 3), in columns, from roll, pitch and yaw: Rz Ry Rx."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_euler("xyz", attitude).as_matrix(), dtype=np.float64)


def turning(vessel: VesselFrame) -> FloatArray:
    """Pieces of roll, pitch and yaw over time, (n, PIECE_WORDS).

    Those of the scene's attitude; along a path the heading of the track, averaged over
    `turn_time`, is added to the yaw.
    """
    starts, powers = attitudes(vessel)
    if vessel.path is not None:
        track = averaged(headings(vessel), turn_time(vessel))
        both = np.union1d(starts, track[:, 0])
        powers = _about(both, starts, powers)
        powers[:, :, 2] += _about(both, track[:, 0], track[:, 2:, None])[:, :, 0]
        starts = both
    found = np.zeros((len(starts), at.PIECE_WORDS))
    found[:, at.Piece.start], found[:, at.Piece.end] = starts, np.append(starts[1:], math.inf)
    data = found[:, at.Piece.data :]
    data[:, : 3 * (DEGREE + 1)] = powers.reshape(len(starts), -1)
    return found


def attitudes(vessel: VesselFrame) -> tuple[FloatArray, FloatArray]:
    """Pieces of the scene's roll, pitch and yaw: when they begin (n,) [s], and coefficients of the
    powers of the time since then (n, DEGREE + 1, 3) [rad, rad/s, ...].

    Between the rows of a table a twice differentiable cubic, at rest at its ends, where it is held.
    """
    if vessel.attitude is None:
        return np.zeros(1), np.zeros((1, DEGREE + 1, 3))
    times, angles = vessel.attitude.column("t"), vessel.attitude.column("attitude")
    powers = np.zeros((len(times), DEGREE + 1, 3))
    powers[:, 0] = angles
    if len(times) > 1:
        from scipy.interpolate import CubicSpline

        powers[:-1, :4] = CubicSpline(times, angles, bc_type="clamped").c[::-1].transpose(1, 0, 2)
    first = int(np.searchsorted(times, 0.0, side="right")) - 1
    if first < 0:
        held = np.zeros((1, DEGREE + 1, 3))
        held[0, 0] = angles[0]
        return np.append(0.0, times), np.concatenate([held, powers])
    starts = np.append(0.0, times[first + 1 :])
    return starts, _about(starts, times, powers)


def _about(starts: FloatArray, times: FloatArray, powers: FloatArray) -> FloatArray:
    """Coefficients (n, DEGREE + 1, k) of pieces that begin at `starts` (n,), of others (m, ...)
    that begin at `times` (m,), among them all of those after the first start."""
    which = np.searchsorted(times, starts, side="right") - 1
    found = _moved(np.moveaxis(powers[which], 1, 0), (starts - times[which])[:, None])
    return np.moveaxis(found, 0, 1)


def headings(vessel: VesselFrame) -> FloatArray:
    """Heading of the track of a vessel that has a path, (n, 2 + DEGREE + 1): from when to when [s],
    and the coefficients of the powers of the time since then [rad, rad/s, ...].

    Where it stands still it has the leg's own, or else that of the leg before, at first 0.
    """
    assert vessel.path is not None
    pieces = vessel.motion().pieces
    found = np.zeros((len(pieces), _TRACK_WORDS))
    legs = [leg.straight or leg.turn for leg in vessel.path]
    given = [None if leg is None else leg.heading for leg in legs]
    heading = 0.0
    for row, piece, own_heading in zip(found, pieces, [*given, None], strict=True):
        row[:2] = piece[at.Piece.start], piece[at.Piece.end]
        own = piece[at.Piece.data :]
        if piece[at.Piece.kind] == POLYNOMIAL:
            way = own[3:5] if np.hypot(*own[3:5]) > 0.0 else own[6:8]
            to = math.atan2(way[1], way[0]) if np.hypot(*way) > 0.0 else own_heading
            if to is not None:
                heading += math.remainder(to - heading, 2.0 * math.pi)
            row[2] = heading
            continue
        rate, spin = own[5], own[6]
        ahead = own[4] + math.copysign(0.5 * math.pi, rate or spin)
        heading += math.remainder(ahead - heading, 2.0 * math.pi)
        row[2:5] = heading, rate, 0.5 * spin
        span = row[1] - row[0]
        if math.isfinite(span):
            heading += rate * span + 0.5 * spin * span**2
    return found


def first_turn(vessel: VesselFrame) -> float:
    """When the heading of a path first does not go on as it begins [s]; infinite: never."""
    track = headings(vessel)
    jumps = _jumps(track, 1.0)
    changes = np.flatnonzero(np.any(jumps != 0.0, axis=1))
    return float(track[1 + changes[0], 0]) if changes.size else math.inf


def turn_time(vessel: VesselFrame) -> float:
    """Time over which the heading of a path is averaged [s]: where the scene does not say, 4 s, or
    less where the track turns before half of that."""
    if vessel.turn_time is not None:
        return vessel.turn_time
    return min(LONGEST_TURN_IN, 2.0 * first_turn(vessel))


def averaged(track: FloatArray, span: float) -> FloatArray:
    """A heading in pieces (n, 2 + DEGREE + 1), of powers up to 2, averaged twice over half of a
    span of time around each instant [s]: so are its jumps ramps, and its kinks continuous.

    Before its first piece it is what that continues to.
    """
    half = 0.5 * span
    jumps = _jumps(track, span)
    kept = 1 + np.flatnonzero(np.any(jumps != 0.0, axis=1))
    turns, jumps = track[kept, 0], jumps[kept - 1]
    edges = np.unique(np.concatenate([track[:1, 0], turns - half, turns, turns + half]))
    edges = edges[edges >= track[0, 0]]
    edges = edges[np.append(True, np.diff(edges) > _SAME * span)]
    found = np.zeros((len(edges), _TRACK_WORDS))
    found[:, 0], found[:, 1] = edges, np.append(edges[1:], math.inf)
    for row in found:
        start = row[0] + 0.5 * min(row[1] - row[0], _SAME * span)
        past = int(np.searchsorted(turns + half, start))
        piece = track[kept[past - 1] if past else 0]
        row[2:] = _moved(piece[2:], row[0] - piece[0])
        row[2] += piece[4] * half**2 / 6.0
        for turn, jump in zip(turns[past:], jumps[past:], strict=True):
            since = row[0] - turn
            if start <= turn - half:
                break
            row[2:] += _moved(_ramps(jump, half), _exactly(since + half, span))
            if start > turn:
                row[2:] -= 2.0 * _moved(_ramps(jump, half), _exactly(since, span))
    return found


def _jumps(track: FloatArray, span: float) -> FloatArray:
    """Of the coefficients from piece to piece, (n - 1, 3); what is rounding in a span of time [s]
    is none."""
    weights = span ** np.arange(3.0)
    ends = [_moved(row[2:], row[1] - row[0])[:3] for row in track[:-1]]
    found = track[1:, 2:5] - np.array(ends).reshape(-1, 3)
    found[np.abs(found) * weights <= _SAME] = 0.0
    return found


def _ramps(jump: FloatArray, half: float) -> FloatArray:
    """What jumps of coefficients become when they are averaged, by the powers of the time since the
    average reached them: each two powers higher."""
    found = np.zeros(DEGREE + 1)
    for power, size in enumerate(jump):
        found[power + 2] = size / (half**2 * (power + 1) * (power + 2))
    return found


def _moved(powers: FloatArray, tau: float | FloatArray) -> FloatArray:
    """Coefficients, by powers first, about a time that is tau later."""
    found = np.zeros_like(powers)
    for k, factor in enumerate(powers):
        for n in range(k + 1):
            found[n] += math.comb(k, n) * tau ** (k - n) * factor
    return found


def _exactly(time: float, span: float) -> float:
    """A time, or 0 where it is rounding."""
    return 0.0 if abs(time) <= _SAME * span else time


def first_angles(vessel: VesselFrame) -> tuple[float, float, float]:
    """Roll, pitch and yaw at t = 0 [rad]."""
    roll, pitch, yaw = at.Polynomial(turning(vessel)[0], at.Piece.data.word).position
    return float(roll), float(pitch), float(yaw)
