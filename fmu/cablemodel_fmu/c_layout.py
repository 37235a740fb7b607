"""The block's layout as a C header, written from the Python that defines it.

The FMU recomputes every offset of a block from its sizes by the same rule as cablemodel/block.py,
and refuses a model file where one differs.
"""

from __future__ import annotations

from types import ModuleType

from cablemodel.block import SIZES, Block
from cablemodel.kernels import layout


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


def input_layout() -> dict[str, int]:
    """Places in the input vector of a step (constants of kernels/stepping.py)."""
    from cablemodel.kernels import stepping

    return constants(stepping, ("IN_", "INPUT_WORDS"))


def start_constants() -> dict[str, float]:
    """Numbers by which instance.py and mesh.py derive a block from the lengths of its cables."""
    from cablemodel import instance, mesh
    from cablemodel_fmu import signals

    names = ("STABILISATION", "SHORTEST_LINE", "SHORTEST_PIECE", "RIGID", "SOFTEST", "BENT")
    found = {name: getattr(instance, name) for name in (*names, "REFINEMENTS")}
    return found | {"LIGHT_DAMPING": mesh.LIGHT_DAMPING, "DRUM_ROOM": signals.LONGEST}


def constants(module: ModuleType, prefixes: tuple[str, ...] = ("",)) -> dict[str, int]:
    """The module's whole numbers with names in capitals."""
    return {
        name: value
        for name, value in vars(module).items()
        if name.isupper() and name.startswith(prefixes) and isinstance(value, int)
    }


def header(kernel_hash: str) -> str:
    """Text of layout.h: constants of kernels/layout.py and the rule of Block.arrays."""
    lines = ["/* Written by cablemodel_fmu/c_layout.py; do not edit. */"]
    for name, value in {**constants(layout), **input_layout()}.items():
        if not name.startswith("_"):
            lines.append(f"#define {name} INT64_C({value})")
    for name, number in start_constants().items():
        lines.append(f"#define {name} {number!r}")
    lines.append(f"#define KERNEL_HASH INT64_C({hash_number(kernel_hash)})")
    sizes = {name: Symbol(f"I[{word}]") for name, word in SIZES.items()}
    image, workspace = Block.arrays(**sizes)
    checks = " && ".join(f"I[{word}] >= 0 && I[{word}] <= limit" for word in SIZES.values())
    lines += [
        "static inline int sizes_within(const int64_t *I, int64_t limit) {",
        f"    return {checks};",
        "}",
        "/* Offsets of all arrays, and the words of the image and of the block, from the sizes. */",
        "static inline void arrange(const int64_t *I, int64_t *offset, int64_t *image,",
        "                           int64_t *words) {",
        "    int64_t at = HEADER_WORDS + SCALAR_WORDS;",
    ]
    for arrays in (image, workspace):
        for place, length in arrays:
            lines.append(f"    offset[{place}] = at;")
            lines.append(f"    at += {_text(length)};")
        lines.append("    *image = at;" if arrays is image else "    *words = at;")
    lines += ["}", ""]
    return "\n".join(lines)


def hash_number(kernel_hash: str) -> int:
    """The kernels' hash as a signed 64-bit number."""
    value = int(kernel_hash[:16], 16)
    return value - (1 << 64) if value >= 1 << 63 else value
