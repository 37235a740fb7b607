"""Allocation of the instance block: the Python side of kernels/layout.py."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from cablemodel.kernels import layout as at

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


# Sizes of a block, each with the header word that holds it.
SIZES = {
    "capacity": at.I_CAPACITY,
    "pieces": at.I_PIECES,
    "depths": at.I_DEPTHS,
    "times": at.I_TIMES,
    "strain_words": at.I_STRAIN,
    "bodies": at.I_BODIES,
    "constraints": at.I_CONSTRAINTS,
    "rates": at.I_RATES,
    "cables": at.I_CABLES,
    "floor_words": at.I_FLOOR_WORDS,
    "waves": at.I_WAVES,
    "cell_terms": at.I_CELL_TERMS,
    "frames": at.I_FRAMES,
    "frame_pieces": at.I_FRAME_PIECES,
    "free_bodies": at.I_FREE,
    "arms": at.I_ARMS,
    "foils": at.I_FOILS,
    "foil_words": at.I_FOIL_WORDS,
    "cuts": at.I_CUTS,
    "rao_words": at.I_RAO_WORDS,
    "feet": at.I_FEET,
}

Arrays = list[tuple[int, Any]]


class WordBlock:
    """One contiguous piece of memory, seen as int64 (``ints``) and as float64 (``reals``)."""

    SIZES: ClassVar[dict[str, int]]
    """Sizes of a block, each with the header word that holds it."""

    def __init__(
        self, first: int, image: Arrays, workspace: Arrays, header: dict[int, int]
    ) -> None:
        """Zeros, with the header that says where everything is.

        first: words before the first array; image, workspace: header word and length of each array;
        header: values of other header words.
        """
        words = first
        offsets = {}
        for place, length in image + workspace:
            offsets[place] = words
            words += length
        self.ints: IntArray = np.zeros(words, dtype=np.int64)
        self.reals: FloatArray = self.ints.view(np.float64)
        self.ints[at.I_BYTES] = 8 * words
        self.ints[at.I_IMAGE_WORDS] = first + sum(length for _, length in image)
        for place, value in (header | offsets).items():
            self.ints[place] = value

    def __getstate__(self) -> IntArray:
        # A copy of both views, as NumPy makes it, would be two pieces of memory.
        return self.ints

    def __setstate__(self, ints: IntArray) -> None:
        self.ints = ints
        self.reals = ints.view(np.float64)

    def array(self, place: int, *shape: int) -> FloatArray:
        """A view of an array of the block, by its header word."""
        start = int(self.ints[place])
        return self.reals[start : start + math.prod(shape)].reshape(shape)

    def integers(self, place: int, *shape: int) -> IntArray:
        """A view of an integer array of the block, by its header word."""
        start = int(self.ints[place])
        return self.ints[start : start + math.prod(shape)].reshape(shape)

    @property
    def failed_node(self) -> int:
        """The node at fault in the last step or start that failed: no part of the image."""
        return int(self.integers(at.O_FAILED, 1)[0])

    @property
    def image(self) -> IntArray:
        """All that a snapshot keeps: everything before the workspace."""
        return self.ints[: int(self.ints[at.I_IMAGE_WORDS])]

    @staticmethod
    def arrays(*args: Any, **sizes: Any) -> tuple[Arrays, Arrays]:
        """Arrays of the image in order, then those of the workspace: (header word, length)."""
        raise NotImplementedError

    def sizes_of(self, image: IntArray) -> dict[str, int]:
        """The sizes that an image of a block of this kind says it has."""
        return {name: int(image[word]) for name, word in self.SIZES.items()}

    def fits(self, image: IntArray) -> bool:
        """Whether an image is of such a block as this one is: of another capacity at most."""
        first = int(self.ints[at.I_IMAGE_WORDS]) - sum(
            length for _, length in self.arrays(**self.sizes_of(self.ints))[0]
        )
        if len(image) < first or image[at.I_CAPACITY] < image[at.I_NODES]:
            return False
        sizes = self.sizes_of(image)
        arrays, workspace = self.arrays(**sizes)
        words = first + sum(length for _, length in arrays)
        expected = self.sizes_of(self.ints) | {
            name: sizes[name] for name, word in self.SIZES.items() if word == at.I_CAPACITY
        }
        return (
            sizes == expected
            and all(image[word] == self.ints[word] for word in (at.I_MAGIC, at.I_VERSION))
            and len(image) == words == image[at.I_IMAGE_WORDS]
            and image[at.I_BYTES] == 8 * (words + sum(length for _, length in workspace))
        )

    def take(self, image: IntArray) -> None:
        """Become what an image says, which `fits`."""
        if len(image) != len(self.image):
            kind: Any = type(self)
            self.__setstate__(kind(**self.sizes_of(image)).ints)
        self.image[:] = image


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
    ) -> tuple[Arrays, Arrays]:
        """Arrays of the image in order, then those of the workspace: (header word, length).

        In the image: tables that no step changes (but for row 0 of O_PIECES), from O_PARENT on the
        state, from O_DIAGONAL on the factorisation; kernels/backup.py relies on it.

        Sizes are numbers, or the symbols from which the FMU's C code of the same rule is written.
        """
        image = [
            (at.O_PIECES, pieces * at.PIECE_WORDS),
            (at.O_DEPTHS, depths),
            (at.O_TIMES, times),
            (at.O_CURRENT, depths * times * 3),
            (at.O_STRAIN, strain_words),
            (at.O_RATES, rates * at.RATE_WORDS),
            (at.O_CABLES, cables * at.CABLE_WORDS),
            (at.O_FLOOR, floor_words),
            (at.O_WAVES, waves * at.WAVE_WORDS),
            (at.O_CELL_LAYERS, (waves + 1) * cell_terms * at.CELL_LAYERS),
            (at.O_FRAME_PIECES, frame_pieces * at.PIECE_WORDS),
            (at.O_FOIL_TABLE, foil_words),
            (at.O_RAOS, rao_words),
            (at.O_PARENT, capacity),
            (at.O_JOINT, capacity),
            (at.O_EDGE, capacity * at.EDGE_WORDS),
            (at.O_BODY, bodies * at.BODY_WORDS),
            # One more for the end of the cable that is awake.
            (at.O_CONSTRAINT, constraints * at.CONSTRAINT_WORDS + at.CONSTRAINT_WORDS),
            (at.O_FRAMES, frames * at.FRAME_WORDS),
            (at.O_FREE, free_bodies * at.FREE_WORDS),
            (at.O_FOILS, foils * at.FOIL_WORDS),
            (at.O_ARMS, arms * at.ARM_WORDS),
            (at.O_CUTS, cuts * at.CUT_WORDS),
            (at.O_FEET, feet * at.FOOT_WORDS),
            (at.O_POSITION, capacity * 6),
            (at.O_VELOCITY, capacity * 6),
            (at.O_ACCELERATION, capacity * 6),
            (at.O_TENSION, capacity * 2),
            (at.O_TENSION_RATE, capacity * 2),
            (at.O_REST, capacity * 3),
            (at.O_HISTORY, capacity * 12),
            (at.O_DIAGONAL, capacity * 36),
            (at.O_UPPER, capacity * 36),
            (at.O_LOWER, capacity * 36),
            (at.O_GRADIENT, capacity * 24),
            (at.O_COMPLIANCE, capacity * 3),
        ]
        image_words = at.HEADER_WORDS + at.SCALAR_WORDS + sum(length for _, length in image)
        cell = cell_terms * (at.CELL_WORDS // at.CELL_TERMS)  # words of one; 0: there are none
        workspace = [
            (at.O_BACKUP, image_words),
            # The first stage is the state, the last one the trial.
            (at.O_STAGE_V, capacity * 24),
            (at.O_STAGE_A, capacity * 24),
            (at.O_BASE_Q, capacity * 6),
            (at.O_BASE_V, capacity * 6),
            (at.O_TRIAL_Q, capacity * 6),
            (at.O_TRIAL_V, capacity * 6),
            (at.O_TRIAL_A, capacity * 6),
            (at.O_TRIAL_T, capacity * 2),
            (at.O_STAGE_T, capacity * 2),
            (at.O_STRETCH, capacity * 2),
            (at.O_RESIDUAL, capacity * 6),
            (at.O_CONSTRAINT_RESIDUAL, capacity * 2),
            (at.O_INCREMENT, capacity * 6),
            # Velocities, then their rates.
            (at.O_PROFILE, depths * 6),
            (at.O_GAUSS, at.GAUSS_WORDS),
            (at.O_MOTION, waves * at.WATER_COLUMNS + at.MOTION_WORDS),
            # Of three Gauss points to an element, and of every body.
            (at.O_CELLS, capacity * cell * 3 + bodies * cell + free_bodies * cell),
            (at.O_TOP, 24 + at.BODY_WORDS),
            (at.O_END_FORCE, capacity * 6),
            (at.O_FAILED, 1),
            (at.O_PARTS_WORK, free_bodies * at.PARTS_WORDS),
        ]
        return image, workspace

    def __init__(self, **sizes: int) -> None:
        """Zeros, with the header; sizes: the arguments of `arrays`."""
        image, workspace = self.arrays(**sizes)
        header = {at.I_MAGIC: at.MAGIC, at.I_VERSION: at.VERSION}
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
        placed += [at.I_BYTES, at.I_IMAGE_WORDS, at.I_CAPACITY]
        own = np.setdiff1d(np.arange(at.HEADER_WORDS + at.SCALAR_WORDS), placed)
        other.ints[own] = self.ints[own]
        others, _ = self.arrays(**other.sizes_of(other.ints))
        for (place, length), (_, room) in zip(arrays, others, strict=True):
            words = min(length, room)
            other.integers(place, words)[:] = self.integers(place, words)
        self.__setstate__(other.ints)

    def grow(self) -> None:
        """Room for twice as many nodes."""
        self.make_room(2 * int(self.ints[at.I_CAPACITY]))
