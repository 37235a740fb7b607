"""Allocation of the direct solver's instance block: the Python side of kernels/layout.py."""

from __future__ import annotations

from typing import Any

from cablemodel.block import Arrays, WordBlock
from cablemodel.direct.kernels import layout as own
from cablemodel.kernels import layout as at

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


class DirectBlock(WordBlock):
    """The memory of the direct solver."""

    SIZES = SIZES

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
            # Velocities, then their rates.
            (at.O_PROFILE, depths * 6),
            (at.O_GAUSS, _GAUSS_WORDS),
            (at.O_MOTION, _MOTION_WORDS),
            (own.O_PAST, nodes * own.RATES),
            (own.O_START, nodes * own.WIDTH),
            (own.O_OLD_LENGTH, nodes),
            # The water's velocities at the nodes, then its accelerations.
            (own.O_CURRENTS, nodes * 6),
            (own.O_LEFT, slots * own.BLOCK),
            (own.O_RIGHT, slots * own.BLOCK),
            (own.O_RHS, slots * own.RHS_WORDS),
            (own.O_SHAPE, slots * own.SHAPE_WORDS),
            (own.O_DELTA, slots * 2 * own.WIDTH),
            (own.O_SWEEP, slots * own.SWEEP_WORDS),
            (own.O_WORK, own.WORK_WORDS),
            (at.O_FAILED, 1),
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
        header = {word: sizes[name] for name, word in SIZES.items()}
        header[at.I_MAGIC] = own.MAGIC
        header[at.I_VERSION] = own.VERSION
        # The shared kernels see the earth frame: the vertical plane is this solver's own.
        header[at.I_DIMENSION] = 3
        super().__init__(own.FIRST_FREE, image, workspace, header)
