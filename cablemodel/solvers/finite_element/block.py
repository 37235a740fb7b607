"""Allocation of the instance block: the Python side of shared/layout.py."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.block import Arrays, WordBlock
from cablemodel.solvers.shared.layout import Header

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


# Sizes of a block, each with the header word that holds it.
SIZES = {
    "capacity": Header.capacity.word,
    "pieces": Header.piece_count.word,
    "depths": Header.depth_count.word,
    "times": Header.time_count.word,
    "strain_words": Header.strain_words.word,
    "bodies": Header.body_count.word,
    "constraints": Header.constraint_count.word,
    "rates": Header.rate_count.word,
    "cables": Header.cable_count.word,
    "floor_words": Header.floor_words.word,
    "waves": Header.wave_count.word,
    "cell_terms": Header.cell_terms.word,
    "frames": Header.frame_count.word,
    "frame_pieces": Header.frame_piece_count.word,
    "free_bodies": Header.free_count.word,
    "arms": Header.arm_count.word,
    "foils": Header.foil_count.word,
    "foil_words": Header.foil_words.word,
    "cuts": Header.cut_count.word,
    "winches": Header.winch_count.word,
    "rao_words": Header.rao_words.word,
    "feet": Header.foot_count.word,
    "closures": Header.closure_count.word,
    "lines": Header.line_count.word,
}


class Block(WordBlock):
    """The memory of the finite elements."""

    SIZES = SIZES

    @staticmethod
    def arrays(
        *,
        capacity: Any,
        pieces: Any,
        depths: Any,
        times: Any,
        strain_words: Any,
        bodies: Any,
        constraints: Any,
        rates: Any,
        cables: Any,
        floor_words: Any,
        waves: Any,
        cell_terms: Any,
        frames: Any = 0,
        frame_pieces: Any = 0,
        free_bodies: Any = 0,
        arms: Any = 0,
        foils: Any = 0,
        foil_words: Any = 0,
        cuts: Any = 0,
        rao_words: Any = 0,
        feet: Any = 0,
        winches: Any = 1,
        closures: Any = 0,
        lines: Any = 1,
    ) -> tuple[Arrays, Arrays]:
        """Arrays of the image in order, then those of the workspace: (header word, length).

        In the image: tables that no step changes (but for row 0 of `pieces`), from `parent` on the
        state, from `diagonal` on the factorisation; kernels/time/backup.py relies on it.

        Sizes are numbers, or the symbols from which the FMU's C code of the same rule is written.
        """
        image = [
            (Header.pieces.word, pieces * at.PIECE_WORDS),
            (Header.depths.word, depths),
            (Header.times.word, times),
            (Header.current.word, depths * times * 3),
            (Header.strain.word, strain_words),
            (Header.rates.word, rates * at.RATE_WORDS),
            (Header.cables.word, cables * at.CABLE_WORDS),
            (Header.floor.word, floor_words),
            (Header.waves.word, waves * at.WAVE_WORDS),
            (Header.cell_layers.word, (waves + 1) * cell_terms * at.CELL_LAYERS),
            (Header.frame_pieces.word, frame_pieces * at.PIECE_WORDS),
            (Header.foil_table.word, foil_words),
            (Header.raos.word, rao_words),
            (Header.parent.word, capacity),
            (Header.joint.word, capacity),
            (Header.edges.word, capacity * at.EDGE_WORDS),
            (Header.bodies.word, bodies * at.BODY_WORDS),
            # One more for the end of the cable that is awake.
            (Header.constraints.word, constraints * at.CONSTRAINT_WORDS + at.CONSTRAINT_WORDS),
            (Header.frames.word, frames * at.FRAME_WORDS),
            (Header.free_bodies.word, free_bodies * at.FREE_WORDS),
            (Header.foils.word, foils * at.FOIL_WORDS),
            (Header.arms.word, arms * at.ARM_WORDS),
            (Header.cuts.word, cuts * at.CUT_WORDS),
            (Header.feet.word, feet * at.FOOT_WORDS),
            (Header.winches.word, winches * at.WINCH_WORDS),
            (Header.closures.word, closures * at.CLOSURE_WORDS),
            (Header.lines.word, lines * at.LINE_WORDS),
            (Header.position.word, capacity * 6),
            (Header.velocity.word, capacity * 6),
            (Header.acceleration.word, capacity * 6),
            (Header.tension.word, capacity * 2),
            (Header.tension_rate.word, capacity * 2),
            (Header.rest.word, capacity * 6),
            (Header.history.word, capacity * 12),
            (Header.diagonal.word, capacity * 36),
            (Header.upper.word, capacity * 36),
            (Header.lower.word, capacity * 36),
            (Header.gradient.word, capacity * 24),
            (Header.compliance.word, capacity * 3),
            (Header.closure_work.word, closures * capacity * 18 + closures * closures * 9),
        ]
        image_words = at.HEADER_WORDS + at.SCALAR_WORDS + sum(length for _, length in image)
        cell = cell_terms * (at.CELL_WORDS // at.CELL_TERMS)  # words of one; 0: there are none
        workspace = [
            (Header.backup.word, image_words),
            # The first stage is the state, the last one the trial. Both in a row: SPARE_ROWS.
            (Header.stage_velocity.word, capacity * at.STAGE_ROWS),
            (Header.stage_acceleration.word, capacity * at.STAGE_ROWS),
            (Header.base_position.word, capacity * 6),
            (Header.base_velocity.word, capacity * 6),
            (Header.trial_position.word, capacity * 6),
            (Header.trial_velocity.word, capacity * 6),
            (Header.trial_acceleration.word, capacity * 6),
            (Header.trial_tension.word, capacity * 2),
            (Header.stage_tension.word, capacity * 2),
            (Header.stretch.word, capacity * 2),
            (Header.stage_tensions.word, capacity * 6),
            (Header.residual.word, capacity * 6),
            (Header.constraint_residual.word, capacity * 2),
            (Header.increment.word, capacity * 6),
            # Velocities, then their rates.
            (Header.profile.word, depths * 6),
            (Header.gauss.word, at.GAUSS_WORDS),
            (Header.motion.word, waves * at.WATER_COLUMNS + at.MOTION_WORDS),
            # Of three Gauss points to an element, and of every body.
            (Header.cells.word, (capacity * 3 + bodies + at.BODY_CELLS * free_bodies) * cell),
            (Header.matter.word, winches * at.MATTER_WORDS + at.BODY_WORDS),
            (Header.end_force.word, capacity * 6),
            (Header.failed.word, 1),
        ]
        return image, workspace

    def __init__(self, **sizes: int) -> None:
        """Zeros, with the header; sizes: the arguments of `arrays`."""
        image, workspace = self.arrays(**sizes)
        header = {Header.magic.word: at.MAGIC, Header.version.word: at.VERSION}
        header.update({SIZES[name]: size for name, size in sizes.items()})
        super().__init__(at.HEADER_WORDS + at.SCALAR_WORDS, image, workspace, header)

    def make_room(self, capacity: int) -> None:
        """Room for so many nodes, as many as there are or more; all else of the image stays.

        What belongs to nodes is stored node by node: it moves as it is.
        """
        sizes = self.sizes_of(self.ints)
        other = Block(**(sizes | {"capacity": capacity}))
        arrays, workspace = self.arrays(**sizes)
        placed = [place for place, _ in arrays + workspace]
        placed += [Header.byte_count.word, Header.image_words.word, Header.capacity.word]
        own = np.setdiff1d(np.arange(at.HEADER_WORDS + at.SCALAR_WORDS), placed)
        other.ints[own] = self.ints[own]
        others, _ = self.arrays(**other.sizes_of(other.ints))
        for (place, length), (_, room) in zip(arrays, others, strict=True):
            words = min(length, room)
            other.integers(place, words)[:] = self.integers(place, words)
        self.__setstate__(other.ints)

    def grow(self) -> None:
        """Room for twice as many nodes."""
        self.make_room(2 * int(self.header.capacity))
