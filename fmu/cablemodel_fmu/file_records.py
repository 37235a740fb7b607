"""Records of model files, model.bin and finer.bin: 64-bit little-endian words.

Python writes them (model_file.py, parts.py), C reads them: c_layout.py makes structs of them. A
file is a FileHeader, a Parameter for each, a system's section, and the image of a block; of a
system whose start may be set its first shape, and the block along that before it came to rest.
"""

from cablemodel.solvers.shared.layout import FACT_WORDS
from cablemodel.solvers.shared.record import Record, integer, real, reals, spare, text
from cablemodel_fmu.shared_numbers import VR_INPUTS

NAME_WORDS = 12
"""Of a variable's name, for messages."""


class FileHeader(Record):
    """What a model file begins with."""

    magic = integer("FILE_MAGIC")
    format = integer("FILE_FORMAT")
    words = integer("of the whole file")
    checksum = integer("CRC-32 of all that follows")
    kernels = integer("hash of the kernels, whose library alone can read it")
    guid = text(5, "of the FMU")
    flags = integer("FLAG_..., a sum")
    image_words = integer("of the block")
    block_words = integer("of the whole block, with its workspace")
    stations = integer("outputs along each line")
    parameter_count = integer("parameters")
    system_words = integer("of a system's section (parts.py); 0: a scene of one line")
    inputs = reals(VR_INPUTS, "start values of a line's inputs, by value reference")
    frame = reals(3, "velocity of the static equilibrium, block's coordinates", "m/s")
    _spare_1 = spare(3)
    facts = reals(FACT_WORDS, "of the line as a whole: LineFacts")
    shape_words = integer("of a system's first shape, a FirstShape; 0: there is none")
    first_words = integer("and of the image of the block from which that leads to a start")
    search = real("iterations times nodes that a search for a system's start may take")
    _spare_2 = spare(1)


class Parameter(Record):
    """A coefficient that may be changed, word = factor * value, or a length that is fixed at the
    start. Lengths are in the order of CableLength."""

    kind = integer("OF_CABLES, OF_BODY, OF_FREE: whose coefficient; OF_LINE, OF_DRUM: a length")
    word = integer("of the coefficient in its row; of a length on a drum of a system: the winch")
    index = integer("of the cable type, or row of the table of bodies, free bodies or cables")
    factor = real("of a coefficient; of a length of the line: its part in a typical tension, N/m")
    start = real("value in the scene")
    minimum = real("least value that is allowed")
    maximum = real("largest value that is allowed")
    reach = real(
        "of a length of the line: how far it can reach when stretched, in lengths; of one on a "
        "drum of a system 1: the scene counts its elements"
    )
    name = text(NAME_WORDS, "of the variable")


class PartRow(Record):
    """Of a system: an input, a choice or a number of a vessel's start; of a line or a body its
    name alone."""

    start = real("value at first")
    minimum = real("least value that is allowed")
    maximum = real("largest value that is allowed")
    name = text(NAME_WORDS, "of the variable, the line or the body")
