"""Allocation of the direct solver's instance block: the Python side of shared/layout.py."""

from __future__ import annotations

from typing import Any

from cablemodel.solvers.direct.kernels import layout as own
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.block import Arrays, WordBlock
from cablemodel.solvers.shared.layout import Header

_GAUSS_WORDS = 512  # room for ElementPoints, and more than that: saved states count on it


# Sizes of a block, each with the header word that holds it.
SIZES = {
    "nodes": Header.capacity.word,
    "sections": own.OwnHeader.section_capacity.place,
    "materials": own.OwnHeader.material_count.place,
    "bodies": own.OwnHeader.body_count.place,
    "drum": own.OwnHeader.drum_capacity.place,
    "pieces": Header.piece_count.word,
    "depths": Header.depth_count.word,
    "times": Header.time_count.word,
    "strain_words": Header.strain_words.word,
    "rates": Header.rate_count.word,
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

        kernels/time/backup.py relies on the order. Sizes are numbers, or the symbols from which the
        FMU's C code of the same rule is written.
        """
        image = [
            (Header.pieces.word, pieces * at.PIECE_WORDS),
            (Header.depths.word, depths),
            (Header.times.word, times),
            (Header.current.word, depths * times * 3),
            (Header.strain.word, strain_words),
            (Header.rates.word, rates * at.RATE_WORDS),
            (own.OwnHeader.sections.place, (sections + 1) * own.SECTION_WORDS),
            (own.OwnHeader.materials.place, materials * own.MATERIAL_WORDS),
            (own.OwnHeader.bodies.place, bodies * own.BODY_WORDS),
            (own.OwnHeader.drum.place, drum * own.DRUM_WORDS),
            (own.OwnHeader.unknowns.place, nodes * own.WIDTH),
            (own.OwnHeader.rate.place, nodes * own.RATES),
            (own.OwnHeader.length.place, nodes),
            (own.OwnHeader.flow.place, nodes),
            (own.OwnHeader.share.place, nodes),
            (own.OwnHeader.place.place, nodes * own.PLACE_WORDS),
            (own.OwnHeader.strains.place, nodes * own.STRAIN_WORDS),
            (Header.winches.word, at.WINCH_WORDS),
            (Header.lines.word, at.LINE_WORDS),
        ]
        image_words = own.FIRST_FREE + sum(length for _, length in image)
        slots = nodes + 1
        workspace = [
            (Header.backup.word, image_words),
            # Velocities, then their rates.
            (Header.profile.word, depths * 6),
            (Header.gauss.word, _GAUSS_WORDS),
            (Header.motion.word, at.MOTION_WORDS),
            (own.OwnHeader.past.place, nodes * own.RATES),
            (own.OwnHeader.start.place, nodes * own.WIDTH),
            (own.OwnHeader.old_length.place, nodes),
            # The water's velocities at the nodes, then its accelerations.
            (own.OwnHeader.currents.place, nodes * 2 * own.WATER_WORDS),
            (own.OwnHeader.left.place, slots * own.BLOCK),
            (own.OwnHeader.right.place, slots * own.BLOCK),
            (own.OwnHeader.rhs.place, slots * own.RHS_WORDS),
            (own.OwnHeader.shape.place, slots * own.SHAPE_WORDS),
            (own.OwnHeader.delta.place, slots * 2 * own.WIDTH),
            (own.OwnHeader.sweep.place, slots * own.SWEEP_WORDS),
            (own.OwnHeader.work.place, own.WORK_WORDS),
            (Header.failed.word, 1),
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
        header[Header.magic.word] = own.MAGIC
        header[Header.version.word] = own.VERSION
        # The shared kernels see the earth frame: the vertical plane is this solver's own.
        header[Header.dimension.word] = 3
        header[Header.winch_count.word] = 1
        header[Header.line_count.word] = 1
        super().__init__(own.FIRST_FREE, image, workspace, header)
