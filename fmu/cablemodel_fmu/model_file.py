"""``resources/model.bin``: what the shared library needs to know of one scene; ``finer.bin``, where
its errors are estimated: the same of the finer run.

Words of file_records.py; the C side (c/model_file.c) checks all of them.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.library import kernel_hash
from cablemodel.solvers.protocol import Memory
from cablemodel.solvers.shared.record import dtype_of
from cablemodel_fmu import shared_numbers as number
from cablemodel_fmu.c_layout import hash_number
from cablemodel_fmu.file_records import NAME_WORDS, FileHeader, Parameter
from cablemodel_fmu.signals import Coefficient

LARGEST = 1e30
"""Bound of a coefficient that has none."""


@dataclass(frozen=True)
class ModelFile:
    """The contents of a model file."""

    guid: str
    block: Memory
    stations: int
    starts: list[float]
    """Start values of the ten inputs."""
    frame: NDArray[np.float64]
    """Velocity of the static equilibrium in the block's coordinates (2 or 3 words) [m/s]."""
    facts: NDArray[np.float64]
    """Of the line as a whole (FACT_WORDS); see start/tables.py."""
    coefficients: list[Coefficient]
    scene_inputs: bool
    """What use_scene_inputs begins as."""
    ignore: bool
    """Whether inputs are ignored while it is true."""
    movable: bool
    """Whether the start of the tow point, or of a system's vessels, may be set."""
    level: bool
    """Whether it may be moved along a level floor."""
    leaves: bool
    """Whether small motions about the start may grow by themselves."""
    at_start: bool
    """Whether values hold at the start of a step, unless input.timing is set."""
    vessel_input: int
    """What vessel.input begins as."""
    static: bool
    pinned: bool
    estimate: bool = False
    """Whether finer.bin is beside it."""
    system: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype="<i8"))
    """The section of a system (cablemodel_fmu/parts.py); empty for a scene of one line."""
    shape: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    """The first shape of a system whose start may be set; else empty."""
    first: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype="<i8"))
    """The image of its block from there; else empty."""
    search: float = 0.0
    """Work that a search for another start of it may take: iterations times nodes."""

    def to_bytes(self) -> bytes:
        """The file, with its checksum."""
        image = self.block.image
        header = np.zeros(1, dtype_of(FileHeader))[0]
        header["magic"], header["format"] = number.FILE_MAGIC, number.FILE_FORMAT
        header["kernels"] = hash_number(kernel_hash())
        header["guid"] = self.guid.encode()
        header["flags"] = self._flags()
        header["image_words"] = len(image)
        header["block_words"] = int(self.block.header.byte_count) // 8
        header["stations"] = self.stations
        header["parameter_count"] = len(self.coefficients)
        header["inputs"] = self.starts
        header["frame"][: len(self.frame)] = self.frame
        header["facts"][: len(self.facts)] = self.facts
        rows = np.array([_row(item) for item in self.coefficients], dtype_of(Parameter))
        header["system_words"] = len(self.system)
        header["shape_words"], header["first_words"] = len(self.shape), len(self.first)
        header["search"] = self.search
        words = len(rows) * Parameter.WORDS + len(self.system) + len(image)
        words += len(self.shape) + len(self.first)
        header["words"] = FileHeader.WORDS + words
        along = self.shape.astype("<f8"), self.first.astype("<i8")
        parts = rows, self.system, image.astype("<i8"), *along
        behind = b"".join(part.tobytes() for part in parts)
        summed = 8 * FileHeader.kernels.word  # what the checksum is of begins there
        header["checksum"] = zlib.crc32(header.tobytes()[summed:] + behind)
        first: bytes = header.tobytes()
        return first + behind

    def _flags(self) -> int:
        flags = (
            (number.FLAG_SCENE_INPUTS, self.scene_inputs),
            (number.FLAG_STATIC, self.static),
            (number.FLAG_PINNED, self.pinned),
            (number.FLAG_ESTIMATE, self.estimate),
            (number.FLAG_IGNORE, self.ignore),
            (number.FLAG_MOVABLE, self.movable),
            (number.FLAG_LEVEL, self.level),
            (number.FLAG_LEAVES, self.leaves),
            (number.FLAG_AT_START, self.at_start),
        )
        return sum(flag for flag, holds in flags if holds) + (
            number.FLAG_VESSEL_INPUT_UNIT * self.vessel_input
        )


def _row(item: Coefficient) -> tuple[int | float | bytes, ...]:
    """A Parameter."""
    signal = item.signal
    assert signal.start is not None
    least = -LARGEST if signal.minimum is None else signal.minimum
    most = LARGEST if signal.maximum is None else signal.maximum
    place = item.kind, item.word, item.index
    return *place, item.factor, signal.start, least, most, item.reach, name_bytes(signal.name)


def name_bytes(name: str) -> bytes:
    """A variable's name, or its beginning where it is too long."""
    most = 8 * NAME_WORDS - 1
    whole = name.encode()
    if len(whole) > most:
        whole = whole[: most - 3].decode(errors="ignore").encode() + b"..."
    return whole
