"""Where the instructions of a step go: ``python -m benchmarks.profile``.

The kernels are linked once more with their symbols (the shipped library has none), stepped under
callgrind by ``count_steps.c``, and every executed instruction is looked up in the disassembly:
instructions and floating-point operations (a packed one counts twice) by part, an element and a
step. Beside them stand the operations that the algorithm needs at least, see :func:`least`.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.instructions import DRIVER, compiler
from benchmarks.sections import write_rows

ELEMENTS = 64
PARTS = {
    # part: words in the symbols' names, first match counts
    "residuals": ("system8residual", "residual_kernel"),
    "Jacobian": ("system8jacobian", "jacobian_kernel"),
    "factorisation": ("factor_assembled", "system9factorise", "newton8refactor"),
    "solution": ("newton_increment",),
    "tensions and norms": ("recover_tension", "increment_norm"),
    "motion of the tow point": ("impose_motion", "vessel_motion", "evaluate_piece", "set_time"),
    "stepping": ("advance_to", "7attempt", "cablemodel_step"),
}
"""Kernels by part; the rest is summed as `other`."""
OPERATIONS = re.compile(r"^(add|sub|mul|div|sqrt|min|max)(s|p)d$")
"""SSE2's arithmetic on doubles."""


@dataclass
class Profile:
    """Instructions and floating-point operations of each part, and the engine's counts."""

    instructions: dict[str, int]
    operations: dict[str, int]
    counts: dict[str, int]


def linked(folder: Path) -> Path:
    """The kernels as a shared library with their symbols."""
    import cablemodel_fmu
    from cablemodel.solvers.library import platform_name
    from cablemodel_fmu.build import PLATFORMS
    from cablemodel_fmu.intermediate import kernel_module
    from cablemodel_fmu.machine_code import compile_kernels

    name = platform_name()
    if name is None or shutil.which("valgrind") is None:
        raise SystemExit("the profile needs valgrind, on a machine that the library is made for")
    part = "finite_element"
    assembly, _ = kernel_module(part, print)
    compile_kernels(PLATFORMS[name].machines[0], part, assembly, folder / "kernels.o")
    path = folder / "kernels.so"
    (folder / "kernels.h").write_text("#define KERNELS(K) K(step)\n")
    names = Path(cablemodel_fmu.__file__).with_name("c") / "kernels.c"
    parts = [names, folder / "kernels.o", f"-I{folder}"]
    subprocess.run([compiler(), "-shared", "-fPIC", "-o", path, *parts, "-lm"], check=True)
    subprocess.run([compiler(), "-O1", "-o", folder / "steps", DRIVER, "-ldl"], check=True)
    return path


def part_of(symbol: str) -> str:
    """The part that a function belongs to."""
    for part, words in PARTS.items():
        if any(word in symbol for word in words):
            return part
    return "other"


def disassembled(library: Path) -> dict[int, tuple[str, int]]:
    """Part and floating-point operations of every instruction, by its offset in the library."""
    text = subprocess.run(
        ["objdump", "-d", "--no-show-raw-insn", str(library)],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    found, part = {}, "other"
    for line in text.splitlines():
        if symbol := re.match(r"^[0-9a-f]+ <(.*)>:$", line):
            part = part_of(symbol[1])
        elif instruction := re.match(r"^\s*([0-9a-f]+):\s+(\S+)", line):
            arithmetic = OPERATIONS.match(instruction[2])
            lanes = 0 if arithmetic is None else (2 if arithmetic[2] == "p" else 1)
            found[int(instruction[1], 16)] = (part, lanes)
    return found


def executed(output: Path, library: Path) -> dict[int, int]:
    """How often each instruction of the library was executed, by its offset."""
    counts: dict[int, int] = defaultdict(int)
    inside, calls = False, False
    for line in output.read_text().splitlines():
        if line.startswith("ob="):
            inside = line[3:].endswith(library.name)
        elif line.startswith("calls="):
            calls = True  # the next line is the callee's cost
        elif line.startswith("0x"):
            if inside and not calls:
                address, _, cost = line.split()[:3]
                counts[int(address, 16)] += int(cost)
            calls = False
    return counts


def profile(library: Path, folder: Path, planar: bool) -> Profile:
    """The tow S1 on 64 elements to 100 s, in as long steps as the tolerance allows."""
    import cablemodel as cm
    from benchmarks.kernels import towed

    model = cm.CableModel(cm.load_scene(towed(ELEMENTS)), planar=None if planar else False)
    np.asarray(model._solver.memory.ints).tofile(folder / "block")
    model.step_to(100.0)
    output = folder / "out"
    command = ["valgrind", "--tool=callgrind", "--toggle-collect=cablemodel_step"]
    command += ["--dump-instr=yes", "--compress-strings=no", "--compress-pos=no"]
    command += [f"--callgrind-out-file={output}", str(folder / "steps"), str(library)]
    subprocess.run([*command, str(folder / "block"), "100"], check=True, capture_output=True)
    where = disassembled(library)
    instructions: dict[str, int] = defaultdict(int)
    operations: dict[str, int] = defaultdict(int)
    for offset, times in executed(output, library).items():
        part, lanes = where.get(offset, ("other", 0))
        instructions[part] += times
        operations[part] += times * lanes
    return Profile(dict(instructions), dict(operations), model.statistics)


def least(part: str, planar: bool) -> tuple[float, str] | None:
    """Operations that one call of a part needs an element, at least; and what is counted.

    For matrices: blocks of b = 4 or 6 unknowns a node, block-tridiagonal elimination. Pivot block
    2/3 b^3, two products with it 2 x 2 b^3 minus their triangular solves' shares are not less than
    14/3 b^3; a solution 3 products of 2 b^2. For residual and Jacobian: the sums over shape
    functions and Gauss points alone, without the loads and the material in them.
    """
    d = 2 if planar else 3
    b, functions, points = 2 * d, 4, 3
    if part == "factorisation":
        return 14.0 / 3.0 * b**3, "14/3 b^3"
    if part == "solution":
        return 6.0 * b**2, "6 b^2"
    if part == "residuals":
        # r', r'', v, a from nodal values, and forces on dr, dr', dr'' back to them.
        return float(points * 2 * d * functions * (4 + 3)), "sums over shape functions"
    if part == "Jacobian":
        # Symmetric pairs of shape functions and of components, a product for each of dr'.dr',
        # dr''.dr'', and the loads' dr.dr, dr.dr'.
        pairs = functions * (functions + 1) // 2 * d * (d + 1) // 2
        return float(points * 2 * pairs * 4), "sums over pairs of shape functions"
    return None


def calls(part: str, counts: dict[str, int]) -> int | None:
    """How often a part was called in the run; None where the engine does not count it."""
    if part in ("Jacobian", "factorisation"):
        return counts["factorisations"]
    return counts["iterations"] if part in ("residuals", "solution") else None


STORE = Path("docs/benchmarks/profile.csv")
HEAD = (
    "equations", "part", "instructions [%]", "instructions an element and step",
    "flops an element and step", "flops an element and call", "least", "least counts", "ratio",
)  # fmt: skip


def rows_of(name: str, found: Profile, planar: bool) -> list[tuple[str, ...]]:
    """A row for each part of a step, and one for the whole."""
    steps, whole = found.counts["steps"], sum(found.instructions.values())
    rows = []
    for part in (*PARTS, "other"):
        done, flops = found.instructions.get(part, 0), found.operations.get(part, 0)
        times, minimum = calls(part, found.counts), least(part, planar)
        a_call = flops / times / ELEMENTS if times else None
        rows.append(
            (
                name,
                part,
                f"{100.0 * done / whole:.1f}",
                f"{done / steps / ELEMENTS:.0f}",
                f"{flops / steps / ELEMENTS:.0f}",
                f"{a_call:.0f}" if a_call is not None else "",
                f"{minimum[0]:.0f}" if minimum else "",
                minimum[1] if minimum else "",
                f"{a_call / minimum[0]:.1f}" if minimum and a_call is not None else "",
            )
        )
    flops = sum(found.operations.values()) / steps / ELEMENTS
    each = f"{whole / steps / ELEMENTS:.0f}"
    rows.append((name, "all", "100.0", each, f"{flops:.0f}", "", "", "", ""))
    return rows


PLANE, SPACE = "in a plane", "in space"


def write(library: Path, folder: Path) -> None:
    """Measure with that library; keep the rows."""
    rows = rows_of(PLANE, profile(library, folder, planar=True), planar=True)
    rows += rows_of(SPACE, profile(library, folder, planar=False), planar=False)
    write_rows(STORE, HEAD, rows)


def main() -> None:
    """Link the kernels with their symbols; measure."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write(linked(folder), folder)


if __name__ == "__main__":
    main()
