"""A block of words: one piece of memory of a model, and where its arrays stand in it."""

from __future__ import annotations

import math
from typing import Any, ClassVar, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Line, Scalars, Winch

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

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
        self.header.byte_count = 8 * words
        self.header.image_words = first + sum(length for _, length in image)
        for place, value in (header | offsets).items():
            self.ints[place] = value
        for number in range(int(self.header.line_count)):
            line = self.line(number)
            line.since = line.first = line.last = math.nan

    def __getstate__(self) -> IntArray:
        # A copy of both views, as NumPy makes it, would be two pieces of memory.
        return self.ints

    def __setstate__(self, ints: IntArray) -> None:
        self.ints = ints
        self.reals = ints.view(np.float64)

    def array(self, place: SupportsIndex, *shape: int) -> FloatArray:
        """A view of an array of the block, by its header word."""
        start = int(self.ints[place])
        return self.reals[start : start + math.prod(shape)].reshape(shape)

    def integers(self, place: SupportsIndex, *shape: int) -> IntArray:
        """A view of an integer array of the block, by its header word."""
        start = int(self.ints[place])
        return self.ints[start : start + math.prod(shape)].reshape(shape)

    @property
    def header(self) -> Header:
        """Sizes and counters by name, and the words where arrays start."""
        return Header(self.ints)

    @property
    def scalars(self) -> Scalars:
        """The numbers that there is one of, by name."""
        return Scalars(self.reals)

    @property
    def winch(self) -> Winch:
        """The winch at the tow point of one line, by name."""
        return Winch(self.reals, int(self.header.winches))

    def line(self, number: int = 0) -> Line:
        """A line by its number: one line is the first."""
        return Line(self.reals, int(self.header.lines) + number * at.LINE_WORDS)

    @property
    def failed_node(self) -> int:
        """The node at fault in the last step or start that failed: no part of the image."""
        return int(self.integers(Header.failed, 1)[0])

    @property
    def image(self) -> IntArray:
        """All that a snapshot keeps: everything before the workspace."""
        return self.ints[: int(self.header.image_words)]

    @staticmethod
    def arrays(*args: Any, **sizes: Any) -> tuple[Arrays, Arrays]:
        """Arrays of the image in order, then those of the workspace: (header word, length)."""
        raise NotImplementedError

    def sizes_of(self, image: IntArray) -> dict[str, int]:
        """The sizes that an image of a block of this kind says it has."""
        return {name: int(image[word]) for name, word in self.SIZES.items()}

    def fits(self, image: IntArray) -> bool:
        """Whether an image is of such a block as this one is: of another capacity at most."""
        head = Header(image)
        first = int(self.header.image_words) - sum(
            length for _, length in self.arrays(**self.sizes_of(self.ints))[0]
        )
        if len(image) < first or head.capacity < head.nodes:
            return False
        sizes = self.sizes_of(image)
        arrays, workspace = self.arrays(**sizes)
        words = first + sum(length for _, length in arrays)
        expected = self.sizes_of(self.ints) | {
            name: sizes[name] for name, word in self.SIZES.items() if word == Header.capacity.word
        }
        return (
            sizes == expected
            and all(
                image[word] == self.ints[word] for word in (Header.magic.word, Header.version.word)
            )
            and len(image) == words == head.image_words
            and head.byte_count == 8 * (words + sum(length for _, length in workspace))
        )

    def take(self, image: IntArray) -> None:
        """Become what an image says, which `fits`."""
        if len(image) != len(self.image):
            kind: Any = type(self)
            self.__setstate__(kind(**self.sizes_of(image)).ints)
        self.image[:] = image
