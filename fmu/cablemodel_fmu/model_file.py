"""``resources/model.bin``: what the shared library needs to know of one scene; ``finer.bin``, where
its errors are estimated: the same of the finer run.

64-bit little-endian words; the C side (c/cable.h, c/model_file.c) checks all of them.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.library import kernel_hash
from cablemodel.solvers.protocol import Memory
from cablemodel_fmu import shared_numbers as number
from cablemodel_fmu.c_layout import hash_number
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

    def to_bytes(self) -> bytes:
        """The file, with its checksum."""
        image = self.block.image
        header = np.zeros(number.F_HEADER_WORDS, dtype="<i8")
        reals = header.view("<f8")
        header[:2] = number.FILE_MAGIC, number.FILE_FORMAT
        header[number.F_KERNELS] = hash_number(kernel_hash())
        header[number.F_GUID : number.F_GUID + 5] = np.frombuffer(
            self.guid.encode().ljust(40, b"\0"), "<i8"
        )
        header[number.F_FLAGS] = sum(
            flag
            for flag, holds in (
                (number.FLAG_SCENE_INPUTS, self.scene_inputs),
                (number.FLAG_STATIC, self.static),
                (number.FLAG_PINNED, self.pinned),
                (number.FLAG_ESTIMATE, self.estimate),
                (number.FLAG_IGNORE, self.ignore),
                (number.FLAG_MOVABLE, self.movable),
                (number.FLAG_LEVEL, self.level),
                (number.FLAG_LEAVES, self.leaves),
                (number.FLAG_AT_START, self.at_start),
                (number.FLAG_VESSEL_INPUT_UNIT * self.vessel_input, True),
            )
            if holds
        )
        header[number.F_IMAGE_WORDS : number.F_PARAMETERS + 1] = (
            len(image),
            int(self.block.header.byte_count) // 8,
            self.stations,
            len(self.coefficients),
        )
        reals[number.F_INPUTS : number.F_INPUTS + number.VR_INPUTS] = self.starts
        reals[number.F_FRAME : number.F_FRAME + len(self.frame)] = self.frame
        reals[number.F_FACTS : number.F_FACTS + len(self.facts)] = self.facts
        rows = np.zeros((len(self.coefficients), 8 + number.NAME_WORDS), dtype="<i8")
        values = rows.view("<f8")
        for row, value, item in zip(rows, values, self.coefficients, strict=True):
            row[:3] = item.kind, item.word, item.index
            least = -LARGEST if item.signal.minimum is None else item.signal.minimum
            most = LARGEST if item.signal.maximum is None else item.signal.maximum
            value[3:8] = item.factor, item.signal.start, least, most, item.reach
            row[8:] = np.frombuffer(name_words(item.signal.name), "<i8")
        header[number.F_SYSTEM_WORDS] = len(self.system)
        header[number.F_WORDS] = number.F_HEADER_WORDS + rows.size + len(self.system) + len(image)
        parts = header[number.F_KERNELS :], rows, self.system, image.astype("<i8")
        body = b"".join(part.tobytes() for part in parts)
        header[number.F_CHECKSUM] = zlib.crc32(body)
        return header[: number.F_KERNELS].tobytes() + body


def name_words(name: str) -> bytes:
    """A variable's name, or its beginning where it is too long, ended by zeros."""
    most = 8 * number.NAME_WORDS - 1
    whole = name.encode()
    if len(whole) > most:
        whole = whole[: most - 3].decode(errors="ignore").encode() + b"..."
    return whole.ljust(8 * number.NAME_WORDS, b"\0")
