"""Allocation of the direct solver's instance block: the Python side of kernels/layout.py."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cablemodel.direct.kernels import layout as own
from cablemodel.direct.kernels.assembly import RHS_WORDS
from cablemodel.kernels import layout as at

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_GAUSS_WORDS = 512
_MOTION_WORDS = 64


class DirectBlock:
    """One contiguous piece of memory, seen as int64 (``ints``) and as float64 (``reals``)."""

    def __init__(
        self,
        *,
        nodes: int,
        sections: int,
        materials: int,
        bodies: int,
        drum: int,
        pieces: int,
        depths: int,
        times: int,
        strain_words: int,
        rates: int,
    ) -> None:
        image = [
            (at.O_PIECES, pieces * at.PIECE_WORDS),
            (at.O_DEPTHS, depths),
            (at.O_TIMES, times),
            (at.O_CURRENT, depths * times * 3),
            (at.O_STRAIN, strain_words),
            (at.O_RATES, rates * at.RATE_WORDS),
            (own.O_SECTION, (sections + 1) * own.SECTION_WORDS),
            (own.O_MATERIAL, materials * own.MATERIAL_WORDS),
            (own.O_BODY, bodies * own.BODY_WORDS),
            (own.O_DRUM, drum * own.DRUM_WORDS),
            (own.O_Y, nodes * own.WIDTH),
            (own.O_RATE, nodes * own.RATES),
            (own.O_LENGTH, nodes),
            (own.O_FLOW, nodes),
            (own.O_SHARE, nodes),
            (own.O_PLACE, nodes * 3),
            (own.O_STRAINS, nodes * 2),
        ]
        image_words = own.FIRST_FREE + sum(length for _, length in image)
        slots = nodes + 1
        workspace = [
            (at.O_BACKUP, image_words),
            (at.O_PROFILE, depths * 3),
            (at.O_GAUSS, _GAUSS_WORDS),
            (at.O_MOTION, _MOTION_WORDS),
            (own.O_PAST, nodes * own.RATES),
            (own.O_START, nodes * own.WIDTH),
            (own.O_OLD_LENGTH, nodes),
            (own.O_CURRENTS, nodes * 3),
            (own.O_LEFT, slots * own.BLOCK),
            (own.O_RIGHT, slots * own.BLOCK),
            (own.O_RHS, slots * RHS_WORDS),
            (own.O_SHAPE, slots * own.SHAPE_WORDS),
            (own.O_DELTA, slots * 2 * own.WIDTH),
            (own.O_SWEEP, slots * own.SWEEP_WORDS),
            (own.O_WORK, own.WORK_WORDS),
        ]
        words = own.FIRST_FREE
        offsets = {}
        for place, length in image + workspace:
            offsets[place] = words
            words += length
        self.ints: IntArray = np.zeros(words, dtype=np.int64)
        self.reals: FloatArray = self.ints.view(np.float64)
        header = self.ints
        header[at.I_MAGIC] = own.MAGIC
        header[at.I_VERSION] = own.VERSION
        header[at.I_BYTES] = 8 * words
        header[at.I_IMAGE_WORDS] = image_words
        header[at.I_CAPACITY] = nodes
        header[own.D_SECTION_CAPACITY] = sections
        header[own.D_BODIES] = bodies
        header[own.D_DRUM] = drum
        header[at.I_PIECES] = pieces
        header[at.I_DEPTHS] = depths
        header[at.I_TIMES] = times
        header[at.I_STRAIN] = strain_words
        header[at.I_RATES] = rates
        # The shared kernels see the earth frame: the vertical plane is this solver's own matter.
        header[at.I_DIMENSION] = 3
        for place, offset in offsets.items():
            header[place] = offset

    def array(self, place: int, *shape: int) -> FloatArray:
        """A view of an array of the block, by its header word."""
        start = int(self.ints[place])
        return self.reals[start : start + int(np.prod(shape))].reshape(shape)

    def integers(self, place: int, *shape: int) -> IntArray:
        """A view of an integer array of the block."""
        start = int(self.ints[place])
        return self.ints[start : start + int(np.prod(shape))].reshape(shape)

    @property
    def image(self) -> IntArray:
        """All that a snapshot keeps: everything before the workspace."""
        return self.ints[: int(self.ints[at.I_IMAGE_WORDS])]
