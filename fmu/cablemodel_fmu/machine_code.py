"""Object code of the kernels for one processor and operating system, made by LLVM.

This runs in a process of its own (``python -m cablemodel_fmu.machine_code``), so that a build
makes the code of several machines at once.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cablemodel.solvers.library import PREFIX

HOT_KERNELS = (
    "bodies/slopes", "element/assembly", "element/cubic", "element/damping",
    "element/element_pairs", "element/element_planar", "element/element_spatial",
    "element/strain", "floor/contact", "floor/floor_forces", "floor/floor_surface",
    "line/block_solver", "line/elimination", "line/newton", "line/products", "line/system",
    "line/triangular_solver", "time/esdirk", "time/two_step", "water/airy", "water/sea_cells",
    "water/waves", "water/wetting",
)  # fmt: skip
"""Modules of the finite elements' kernels that are most of the work: built for speed. All others
are built for size."""
_KERNELS = "14finite_element7kernels"
"""In a mangled name, what stands before the package and the module of such a kernel."""
RARE_ENTRIES = (
    "arrange",
    "begin_to_hold",
    "bodies",
    "count_from_zero",
    "count_growing",
    "count_leaving",
    "draw_alike",
    "drive",
    "end_search",
    "ends_apart",
    "energy",
    "equilibrium",
    "find_first_shape",
    "floor_of_line",
    "follow_supports",
    "forget_stabilisation",
    "frame_motion",
    "force_rate",
    "force_response",
    "go_on_holding",
    "go_on_settling",
    "halve_bent",
    "hold_supports",
    "measure",
    "measure_bends",
    "motion_matrices",
    "move_start",
    "parts",
    "place_on_shape",
    "resize_line",
    "resize_lines",
    "rest_here",
    "restore_bending",
    "rotate_system",
    "sample",
    "sample_elements",
    "start_flow",
    "start_flowing",
    "stop_flow",
    "stretch_evenly",
    "summary",
    "tension_from_stretch",
    "tension_ranges",
    "worst_of_shape",
    "wrenches_when_moved",
)
"""Entry points that are built for size, of both solvers."""


@dataclass(frozen=True)
class Machine:
    """A processor and operating system: LLVM's and Zig's words for it."""

    triple: str
    cpu: str
    zig: str


def compile_kernels(machine: Machine, part: str, assembly: Path, output: Path) -> None:
    """Write the object code of a solver's LLVM module, in a process of its own.

    Raises RuntimeError with LLVM's words when that fails.
    """
    command = [sys.executable, "-m", "cablemodel_fmu.machine_code", part]
    command += [machine.triple, machine.cpu, str(assembly), str(output)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"no machine code for {machine.triple}:\n{done.stderr}")


def main(part: str, triple: str, cpu: str, assembly: Path, output: Path) -> None:
    """Compile here and now."""
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    module = llvm.parse_assembly(assembly.read_text(encoding="utf-8"))
    target = llvm.Target.from_triple(triple).create_target_machine(
        cpu=cpu, opt=3, reloc="pic", codemodel="default"
    )
    module.triple = triple
    module.data_layout = str(target.target_data)
    for function in module.functions:
        if function.name.startswith(PREFIX) and "windows" not in triple:
            function.visibility = "hidden"  # c/kernels.c gives them by name
    for function in module.functions:
        if not function.is_declaration and _is_rare(function.name):
            function.add_function_attribute("optsize")
    # Level 2 is as fast as 3 here and a quarter smaller; code for AVX2 gains 5 % only.
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = options.slp_vectorization = True
    # Unrolling is a fifth of the size and of the speed. An FMU for all desktops must not exceed a
    # megabyte: the direct solver, and the Intel half of the Mac's library, go without.
    intel_mac = triple.startswith("x86_64-apple")
    options.loop_unrolling = part == "finite_element" and not intel_mac
    builder: Any = llvm.create_pass_builder(target, options)
    builder.getModulePassManager().run(module, builder)
    output.write_bytes(target.emit_object(module))


def _is_rare(name: str) -> bool:
    """Whether a function of a module is built for size; its name is as numba mangles it."""
    if name.startswith(PREFIX):
        return name.removeprefix(PREFIX) in RARE_ENTRIES
    _, kernels, module = name.partition(_KERNELS)
    return kernels != "" and not any(module.startswith(_mangled(hot)) for hot in HOT_KERNELS)


def _mangled(path: str) -> str:
    """Names of a package and a module as numba mangles them."""
    return "".join(f"{len(part)}{part}" for part in path.split("/"))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3], Path(sys.argv[4]), Path(sys.argv[5]))
