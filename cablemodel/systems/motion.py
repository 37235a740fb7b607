"""How vessels move and turn: pieces of motion for the frames of kernels/frames.py."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.kernels import layout as at

if TYPE_CHECKING:
    from cablemodel.systems.scene import VesselFrame

FloatArray = NDArray[np.float64]


def turning(vessel: VesselFrame) -> FloatArray:
    """Pieces of roll, pitch and yaw over time, (n, PIECE_WORDS).

    Along a path the yaw is that of the track, and its rate that of the turns; the attitude of the
    scene is added. Else it stays as it is.
    """
    pieces = vessel.motion().pieces
    if vessel.path is None:
        pieces = pieces[:1].copy()
        pieces[0, at.Piece.end] = math.inf
    found = np.zeros((len(pieces), at.PIECE_WORDS))
    heading = 0.0
    for row, piece in zip(found, pieces, strict=True):
        row[at.Piece.start], row[at.Piece.end] = piece[at.Piece.start], piece[at.Piece.end]
        data, own = row[at.Piece.data :], piece[at.Piece.data :]
        data[0:2] = vessel.attitude[:2]
        if vessel.path is None:
            data[2] = vessel.attitude[2]
            continue
        if piece[at.Piece.kind] == 0.0:
            way = own[3:5] if np.hypot(*own[3:5]) > 0.0 else own[6:8]
            if np.hypot(*way) > 0.0:
                heading += math.remainder(math.atan2(way[1], way[0]) - heading, 2.0 * math.pi)
            data[2] = heading + vessel.attitude[2]
            continue
        rate, spin = own[5], own[6]
        ahead = own[4] + math.copysign(0.5 * math.pi, rate or spin)
        heading += math.remainder(ahead - heading, 2.0 * math.pi)
        data[2] = heading + vessel.attitude[2]
        data[5], data[8] = rate, 0.5 * spin
        span = piece[at.Piece.end] - piece[at.Piece.start]
        if math.isfinite(span):
            heading += rate * span + 0.5 * spin * span**2
    return found


def first_angles(vessel: VesselFrame) -> tuple[float, float, float]:
    """Roll, pitch and yaw at t = 0 [rad]."""
    yaw = turning(vessel)[0, at.Piece.data.word + 2]
    return vessel.attitude[0], vessel.attitude[1], float(yaw)
