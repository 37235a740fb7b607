"""The block's records in kernels: by name, without a copy (layout.py declares them)."""

from .compile import record_at, record_in
from .layout import Header, Scalars

header = record_in(Header)
"""header(I): identity, sizes, counters, and the words where arrays start."""

header_at = record_at(Header)
"""header_at(I, word): that of a copy of the block, at a word of the block."""

scalars = record_in(Scalars)
"""scalars(M): the numbers that there is one of."""
