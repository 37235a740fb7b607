"""The blocks' layouts as a C header, written from the Python that defines them.

The FMU recomputes every offset of a block from its sizes by the same rule as
cablemodel/solvers/finite_element/block.py and cablemodel/solvers/direct/block.py, and refuses a
model file where one differs. What is the direct solver's own begins with DIRECT.
"""

from __future__ import annotations

import json
from types import ModuleType
from typing import Any

from cablemodel.scene.motion import AT_REST
from cablemodel.solvers import estimating as error_estimate
from cablemodel.solvers.direct import block as direct_block
from cablemodel.solvers.direct import failures as direct_failures
from cablemodel.solvers.direct.kernels import layout as direct_layout
from cablemodel.solvers.finite_element import block, failures
from cablemodel.solvers.shared import layout, numbers
from cablemodel.solvers.shared.record import Record, c_struct, records
from cablemodel_fmu import file_records, shared_numbers

ACCESS = (
    "/* The word of a record at which a field starts. */",
    "#define WORD(record, field) ((int64_t)(offsetof(record, field) / 8))",
    "/* Words as a record. */",
    "#define AS(record, words) ((record *)(words))",
    "static inline Header *header(const int64_t *I) { return (Header *)I; }",
    "static inline Scalars *scalars(const double *M) { return (Scalars *)(M + HEADER_WORDS); }",
    "static inline Edge *edge_of(const int64_t *I, int64_t node) {",
    "    return (Edge *)(I + header(I)->edges + node * EDGE_WORDS);",
    "}",
    "static inline CableRow *cable_of(const int64_t *I, int64_t n) {",
    "    return (CableRow *)(I + header(I)->cables + n * CABLE_WORDS);",
    "}",
    "static inline Winch *winch_of(const int64_t *I, int64_t n) {",
    "    return (Winch *)(I + header(I)->winches + n * WINCH_WORDS);",
    "}",
    "static inline Line *line_of(const int64_t *I, int64_t n) {",
    "    return (Line *)(I + header(I)->lines + n * LINE_WORDS);",
    "}",
    "static inline const FileHeader *file_header(const int64_t *file) {",
    "    return (const FileHeader *)file;",
    "}",
    "#define OWN_WORDS (HEADER_WORDS + SCALAR_WORDS)",
    "static inline OwnHeader *own_header(const int64_t *I) {",
    "    return (OwnHeader *)(I + OWN_WORDS);",
    "}",
    "static inline OwnScalars *own_scalars(const double *M) {",
    "    return (OwnScalars *)(M + OWN_WORDS + sizeof(OwnHeader) / 8);",
    "}",
)
"""The block's records in C: a view each, as in shared/access.py."""


class Symbol:
    """A C expression, made by the arithmetic of Block.arrays."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __mul__(self, other: object) -> Symbol:
        return Symbol(f"{self.text} * {_text(other)}")

    def __add__(self, other: object) -> Symbol:
        return Symbol(f"({self.text} + {_text(other)})")

    def __rmul__(self, other: object) -> Symbol:
        return Symbol(f"{_text(other)} * {self.text}")

    def __radd__(self, other: object) -> Symbol:
        return Symbol(f"({_text(other)} + {self.text})")


def _text(value: object) -> str:
    return value.text if isinstance(value, Symbol) else str(value)


def start_constants() -> dict[str, float]:
    """Numbers by which start/ derives a block from the lengths of its cables, by which what is read
    of a system is placed, and looks ahead, and by which inputs are refused."""
    from cablemodel.solvers.finite_element import stability
    from cablemodel.solvers.finite_element.kernels.outputs import interface
    from cablemodel.solvers.finite_element.start import (
        continuation,
        refinement,
        scales,
        search,
    )
    from cablemodel.systems import tables
    from cablemodel_fmu.signals import LARGEST

    return {
        "BENT": numbers.REFINEMENT_BENT,
        "FAR_TOO_BENT": refinement.FAR_TOO_BENT,
        "LARGE_STRAIN": scales.LARGE_STRAIN,
        "LARGEST_STATIC_MESH": numbers.LARGEST_STATIC_MESH,
        "REFINEMENTS": numbers.REFINEMENT_ROUNDS,
        "SLOWEST": stability.SLOWEST,
        "FEW_STEPS": continuation.FEW_STEPS,
        "SEARCH_STEP": search.SEARCH_STEP,
        "SEARCH_FEWEST": search.SEARCH_FEWEST,
        "PROMISE": numbers.PROMISE,
        "SMALLEST_RADIUS": tables.SMALLEST_RADIUS,
        "AHEAD": interface.RATE_AHEAD,
        "FURTHEST": LARGEST["m"],
        "FASTEST": LARGEST["m/s"],
        "AT_REST": AT_REST,
    }


def input_names() -> list[str]:
    """Of the ten inputs, by value reference."""
    from cablemodel_fmu.signals import inputs

    return [signal.name for signal in inputs([0.0] * 10)]


def start_names() -> list[str]:
    """Of the tow point's position and velocity at the start, by value reference."""
    from cablemodel_fmu.signals import starts

    return [signal.name for signal in starts([0.0] * 10, movable=True)]


def constants(module: ModuleType, prefixes: tuple[str, ...] = ("",)) -> dict[str, int]:
    """The module's whole numbers with names in capitals."""
    return {
        name: value
        for name, value in vars(module).items()
        if name.isupper() and name.startswith(prefixes) and isinstance(value, int)
    }


def header(kernel_hash: str) -> str:
    """Text of layout.h: constants of both layouts, the rules of their blocks, and what the solvers
    say of a step that fails."""
    lines = ["/* Written by cablemodel_fmu/c_layout.py; do not edit. */"]
    for name, value in constants(layout).items():
        if not name.startswith("_"):
            lines.append(f"#define {name} INT64_C({value})")
    for record in [*records(layout), *records(direct_layout), *records(file_records)]:
        lines += [_struct(record), _same_size(record)]
    lines += list(ACCESS)
    for name, value in constants(shared_numbers).items():
        lines.append(f"#define {name} {value if abs(value) < 1 << 31 else f'INT64_C({value})'}")
    for name, number in start_constants().items():
        lines.append(f"#define {name} {number!r}")
    lines.append(f"#define ERROR_PLACES {len(error_estimate.PLACES)}")
    lines.append(f"#define ERROR_FACTOR {error_estimate.FACTOR!r}")
    for macro, names in (("INPUT_NAMES", input_names()), ("START_NAMES", start_names())):
        lines.append(f"#define {macro} {{{', '.join(map(json.dumps, names))}}}")
    lines.append(f"#define LONGEST_STEP {layout.LONGEST_STEP!r}")
    lines.append(f"#define KERNEL_HASH INT64_C({hash_number(kernel_hash)})")
    for name, value in constants(direct_layout).items():
        if not name.startswith("_"):
            lines.append(f"#define DIRECT_{name} INT64_C({value})")
    lines.append(f"#define SIZE_WORDS {', '.join(map(str, block.SIZES.values()))}")
    image, _ = block.Block.arrays(**dict.fromkeys(block.SIZES, 0))
    lines.append(f"#define IMAGE_ARRAYS {', '.join(str(place) for place, _ in image)}")
    lines += _rule("", block.SIZES, block.Block.arrays, "HEADER_WORDS + SCALAR_WORDS")
    lines += _rule(
        "direct_", direct_block.SIZES, direct_block.DirectBlock.arrays, "DIRECT_FIRST_FREE"
    )
    lines += _failures("FAILURES", failures.MEANING)
    lines += _failures("DIRECT_FAILURES", direct_failures.MEANING)
    return "\n".join(lines)


def _failures(macro: str, meaning: dict[int, tuple[str, str]]) -> list[str]:
    """What each status means, and what to do about it, as rows of a `Failure`."""
    lines = [f"#define {macro} \\"]
    for status, words in meaning.items():
        problem, advice = (json.dumps(word) for word in words)
        lines.append(f"    {{{status}, {problem}, {advice}}}, \\")
    return [*lines, "    {0, 0, 0}", ""]


def _name(record: type[Record]) -> str:
    """A record's name in C, where a Cable is an instance with all that belongs to it."""
    return {"Cable": "CableRow"}.get(record.__name__, record.__name__)


def _struct(record: type[Record]) -> str:
    """The record under its name in C."""
    return c_struct(record).replace(f"}} {record.__name__};", f"}} {_name(record)};")


def _same_size(record: type[Record]) -> str:
    """That C gives a record as many words as Python."""
    name = _name(record)
    return f'_Static_assert(sizeof({name}) == 8 * {record.WORDS}, "words of {name}");'


def _rule(prefix: str, words: dict[str, int], arrays: Any, first: str) -> list[str]:
    """C functions for a block: whether its sizes are sane, and where its arrays are."""
    image, workspace = arrays(**{name: Symbol(f"I[{word}]") for name, word in words.items()})
    checks = " && ".join(f"I[{word}] >= 0 && I[{word}] <= limit" for word in words.values())
    lines = [
        f"static inline int {prefix}sizes_within(const int64_t *I, int64_t limit) {{",
        f"    return {checks};",
        "}",
        "/* Offsets of all arrays, and the words of the image and of the block, from the sizes. */",
        f"static inline void {prefix}arrange(const int64_t *I, int64_t *offset, int64_t *image,",
        "                           int64_t *words) {",
        f"    int64_t at = {first};",
    ]
    for part in (image, workspace):
        for place, length in part:
            lines.append(f"    offset[{place}] = at;")
            lines.append(f"    at += {_text(length)};")
        lines.append("    *image = at;" if part is image else "    *words = at;")
    return [*lines, "}"]


def hash_number(kernel_hash: str) -> int:
    """The kernels' hash as a signed 64-bit number."""
    value = int(kernel_hash[:16], 16)
    return value - (1 << 64) if value >= 1 << 63 else value
