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
import time
from collections.abc import Callable
from typing import Any

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
    """The towed cable S1 of the verification plan."""
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


def best(function: Callable[[], object], repeats: int = 7) -> float:
    """Shortest processor time of a call [s]."""
    shortest = float("inf")
    for _ in range(repeats):
        before = time.process_time()
        function()
        shortest = min(shortest, time.process_time() - before)
    return shortest


def kernel_times(names: list[str]) -> None:
    """Print microseconds an element of these kernels, in a plane and in space."""
    import numba

    import cablemodel as cm
    from cablemodel.kernels import block_solver, newton, system
    from cablemodel.kernels import layout as at
    from cablemodel.kernels.compile import OPTIONS, view

    @numba.jit(**OPTIONS)
    def state(I, M):  # type: ignore[no-untyped-def]
        count = 2 * I[at.I_DIMENSION] * I[at.I_NODES]
        return (
            view(M, I[at.O_POSITION], count),
            view(M, I[at.O_VELOCITY], count),
            view(M, I[at.O_ACCELERATION], count),
            view(M, I[at.O_TENSION], 2 * I[at.I_NODES]),
            view(M, I[at.O_RESIDUAL], count),
            view(M, I[at.O_CONSTRAINT_RESIDUAL], 2 * I[at.I_NODES]),
            view(M, I[at.O_INCREMENT], count),
        )

    @numba.jit(**OPTIONS)
    def residual(I, M, n):  # type: ignore[no-untyped-def]
        q, v, a, tension, forces, constraint, x = state(I, M)
        for _ in range(n):
            system.residual(I, M, q, v, a, tension, forces, constraint)

    @numba.jit(**OPTIONS)
    def jacobian(I, M, n):  # type: ignore[no-untyped-def]
        q, v, a, tension, forces, constraint, x = state(I, M)
        for _ in range(n):
            system.jacobian(I, M, q, v, a, tension, 100.0, 10.0)

    @numba.jit(**OPTIONS)
    def factorise(I, M, n):  # type: ignore[no-untyped-def]
        q, v, a, tension, forces, constraint, x = state(I, M)
        for _ in range(n):
            system.factorise(I, M, q, v, a, tension, 100.0, 10.0)

    @numba.jit(**OPTIONS)
    def solve(I, M, n):  # type: ignore[no-untyped-def]
        q, v, a, tension, forces, constraint, x = state(I, M)
        for _ in range(n):
            if I[at.I_DIMENSION] == 2:
                block_solver.solve_planar(I, M, x)
            else:
                block_solver.solve_spatial(I, M, x)

    @numba.jit(**OPTIONS)
    def increment(I, M, n):  # type: ignore[no-untyped-def]
        q, v, a, tension, forces, constraint, x = state(I, M)
        for _ in range(n):
            system.newton_increment(I, M, forces, constraint, x)

    @numba.jit(**OPTIONS)
    def recover(I, M, n):  # type: ignore[no-untyped-def]
        q, v, a, tension, forces, constraint, x = state(I, M)
        for _ in range(n):
            system.recover_tension(I, M, constraint, x, tension)
            newton.increment_norm(I, M, x)

    kernels = {
        "residual": residual,
        "jacobian": jacobian,
        "factorise": factorise,
        "solve": solve,
        "increment": increment,
        "recover": recover,
    }
    print("kernel [us an element]: planar, 3-D")
    for name in names or list(kernels):
        figures = []
        for planar in (True, False):
            model = cm.CableModel(cm.load_scene(towed(ELEMENTS)), planar=planar or None)
            if not planar:
                model = cm.CableModel(cm.load_scene(towed(ELEMENTS)), planar=False)
            model.step(20.0)
            ints, reals = model._block.ints.copy(), None
            reals = ints.view("float64")
            factorise(ints, reals, 1)
            kernels[name](ints, reals, 1)
            n = 300
            figures.append(best(lambda: kernels[name](ints, reals, n)) / n / ELEMENTS * 1e6)  # noqa: B023
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
    if "--kernels" in sys.argv:
        kernel_times(sys.argv[sys.argv.index("--kernels") + 1 :])
        return
    environment = {**os.environ, **PORTABLE}
    subprocess.run(
        [sys.executable, "-m", "benchmarks.kernels", "--kernels", *sys.argv[1:]],
        env=environment,
        check=True,
    )
    step_times()


if __name__ == "__main__":
    main()
