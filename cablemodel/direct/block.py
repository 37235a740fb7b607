"""Allocation of the direct solver's instance block: the Python side of kernels/layout.py."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.direct.kernels import layout as own
from cablemodel.kernels import layout as at

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_GAUSS_WORDS = 512
_MOTION_WORDS = 64


# Sizes of a block, each with the header word that holds it.
SIZES = {
    "nodes": at.I_CAPACITY,
    "sections": own.D_SECTION_CAPACITY,
    "materials": own.D_MATERIALS,
    "bodies": own.D_BODIES,
    "drum": own.D_DRUM_CAPACITY,
    "pieces": at.I_PIECES,
    "depths": at.I_DEPTHS,
    "times": at.I_TIMES,
    "strain_words": at.I_STRAIN,
    "rates": at.I_RATES,
}

Arrays = list[tuple[int, Any]]


class DirectBlock:
    """One contiguous piece of memory, seen as int64 (``ints``) and as float64 (``reals``)."""

    @staticmethod
    def arrays(
        *,
        nodes: Any,
        sections: Any,
        materials: Any,
        bodies: Any,
        drum: Any,
        pieces: Any,
        depths: Any,
        times: Any,
        strain_words: Any,
        rates: Any,
    ) -> tuple[Arrays, Arrays]:
        """Arrays of the image in order, then those of the workspace: (header word, length).

        kernels/backup.py relies on the order. Sizes are numbers, or the symbols from which the
        FMU's C code of the same rule is written.
        """
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
            (own.O_RHS, slots * own.RHS_WORDS),
            (own.O_SHAPE, slots * own.SHAPE_WORDS),
            (own.O_DELTA, slots * 2 * own.WIDTH),
            (own.O_SWEEP, slots * own.SWEEP_WORDS),
            (own.O_WORK, own.WORK_WORDS),
        ]
        return image, workspace

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
        sizes = {
            "nodes": nodes,
            "sections": sections,
            "materials": materials,
            "bodies": bodies,
            "drum": drum,
            "pieces": pieces,
            "depths": depths,
            "times": times,
            "strain_words": strain_words,
            "rates": rates,
        }
        image, workspace = self.arrays(**sizes)
        image_words = own.FIRST_FREE + sum(length for _, length in image)
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
        for name, word in SIZES.items():
            header[word] = sizes[name]
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
