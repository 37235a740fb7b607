"""Time of the kernels an element, and of whole steps: ``python -m benchmarks.kernels``.

Kernels are compiled by numba for the processor and with the options of the library that is built
ahead of time (see cablemodel_fmu/intermediate.py), alone: each is called over and over on the
same line of 64 elements. Steps are those of the library itself. Times are of the processor, the
best of several; the machine may be doing other things.
"""

from __future__ import annotations

import os
import subprocess
import sys
from typing import Any

from benchmarks.measure import best

PORTABLE = {
    "NUMBA_DISABLE_INTEL_SVML": "1",
    "NUMBA_CPU_NAME": "generic",
    "NUMBA_CPU_FEATURES": "",
}
ELEMENTS = 64
CABLE = {
    "diameter": 0.01666,
    "mass": 0.4613,
    "submerged_weight": 2.33333,
    "axial_stiffness": 1.0e6,
    "bending_stiffness": 0.1,
    "drag_normal": 1.0,
    "drag_tangential": 0.1586,
    "added_mass": 1.0,
}


def towed(
    elements: int | None = None, tolerance: float = 1e-3, model: str = "elastica"
) -> dict[str, Any]:
    """The towed cable S1 of benchmarks/references.json."""
    cable: dict[str, Any] = {"type": "K", "length": 30.0, "model": model}
    if elements is not None:
        cable["elements"] = elements
    return {
        "cable_types": {"K": CABLE},
        "line": [{"cable": cable}],
        "vessel": {
            "velocity": [
                {"t": 0.0, "velocity": [0.0, 0.0, 0.0]},
                {"t": 30.0, "velocity": [0.8, 0.0, 0.0]},
            ]
        },
        "solver": {"tolerance": tolerance},
    }


KERNELS = ("residual", "jacobian", "factorise", "increment", "recover")
"""What is timed: `factorise` includes the Jacobian, `increment` is condensing and solving,
`recover` the tensions and the norm."""


def kernel_times() -> None:
    """Print microseconds an element of the kernels, in a plane and in space."""
    import numba

    import cablemodel as cm
    from cablemodel.solvers.finite_element.kernels.line import newton, system
    from cablemodel.solvers.shared.compile import OPTIONS, view
    from cablemodel.solvers.shared.layout import Header

    @numba.jit(**OPTIONS)
    def repeat(ints, reals, kernel, times):  # type: ignore[no-untyped-def]
        head = Header(ints)
        nodes = head.nodes
        count = 2 * head.dimension * nodes
        q = view(reals, head.position, count)
        v = view(reals, head.velocity, count)
        a = view(reals, head.acceleration, count)
        x = view(reals, head.increment, count)
        tension = view(reals, head.tension, 2 * nodes)
        forces = view(reals, head.residual, count)
        constraint = view(reals, head.constraint_residual, 2 * nodes)
        for _ in range(times):
            if kernel == 0:
                system.residual(ints, reals, q, v, a, tension, forces, constraint)
            elif kernel == 1:
                system.jacobian(ints, reals, q, v, a, tension, 100.0, 10.0)
            elif kernel == 2:
                system.factorise(ints, reals, q, v, a, tension, 100.0, 10.0)
            elif kernel == 3:
                system.newton_increment(ints, reals, forces, constraint, x)
            else:
                system.recover_tension(ints, reals, constraint, x, tension)
                newton.increment_norm(ints, reals, x)

    blocks = []
    for planar in (None, False):
        model = cm.CableModel(cm.load_scene(towed(ELEMENTS)), planar=planar)
        model.step(20.0)
        blocks.append(model._solver.memory.ints)
    print("us an element: planar, 3-D")
    calls = 300
    for number, name in enumerate(KERNELS):
        figures = []
        for block in blocks:
            ints = block.copy()
            arguments = (ints, ints.view("float64"))
            repeat(*arguments, 2, 1)
            repeat(*arguments, 0, 1)

            def run(arguments: tuple[Any, Any] = arguments, number: int = number) -> None:
                repeat(*arguments, number, calls)

            figures.append(best(run) / calls / ELEMENTS * 1e6)
        print(f"{name:12s} {figures[0]:.3f} {figures[1]:.3f}", flush=True)


def step_times() -> None:
    """Print the cost of whole runs: adaptive steps, and 100 Hz."""
    import cablemodel as cm

    for label, planar in (("planar", None), ("3-D", False)):
        model = cm.CableModel(cm.load_scene(towed()), planar=planar)
        start = model.snapshot()

        def whole() -> None:
            model.restore(start)  # noqa: B023
            model.step_to(200.0)  # noqa: B023

        seconds = best(whole)
        counts = model.statistics
        print(
            f"towed, {label}: {seconds / 200.0:.2e} s/s; {counts['steps']} steps, "
            f"{seconds / counts['steps'] * 1e6:.2f} us each, "
            f"{counts['iterations'] / counts['steps']:.1f} iterations and "
            f"{counts['factorisations'] / counts['steps']:.1f} factorisations a step"
        )

        def often() -> None:
            model.restore(start)  # noqa: B023
            for k in range(4000):
                model.step_to((k + 1) * 0.01)  # noqa: B023

        seconds = best(often) / 4000
        print(f"towed, {label}, 100 Hz from Python: {seconds * 1e6:.2f} us a step")


def main() -> None:
    """Time kernels in a process with the library's options, then steps in this one."""
    if "--kernels" in sys.argv:
        kernel_times()
        return
    command = [sys.executable, "-m", "benchmarks.kernels", "--kernels"]
    subprocess.run(command, env={**os.environ, **PORTABLE}, check=True)
    step_times()


if __name__ == "__main__":
    main()
