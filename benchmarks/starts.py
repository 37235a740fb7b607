"""How long scenes take to start, beside their run: ``python -m benchmarks.starts``.

Starts and runs of the ready scenes, through the Python interface: of a tow's 200 s the start takes
more than the run. Processor time, best of several, each of a scene that has just been loaded, in a
process that has started others: what is imported and made once for all (sizes of elements, a sea
that was there before) is left out.
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from benchmarks.measure import best
from benchmarks.sections import write_rows

REPEATS = 7


@contextmanager
def kernels_timed() -> Iterator[list[float]]:
    """Processor time of the finite elements' entry points, added up in a list of one number [s]."""
    from cablemodel.solvers import library

    spent = [0.0]

    def timed(kernel: Callable[..., int]) -> Callable[..., int]:
        def call(*arguments: Any) -> int:
            begin = time.process_time()
            try:
                return kernel(*arguments)
            finally:
                spent[0] += time.process_time() - begin

        return call

    kernels = library.entry_points()
    for name, kernel in kernels.items():
        setattr(library, name, timed(kernel))
    try:
        yield spent
    finally:
        for name, kernel in kernels.items():
            setattr(library, name, kernel)


def measure(path: Path) -> list[str]:
    """A row: scene, elements at its start, start, of which kernels, run, of so many seconds."""
    import cablemodel as cm

    scene = cm.load_scene(path)

    def load() -> None:
        nonlocal scene
        scene = cm.load_scene(path)

    start = best(lambda: cm.CableModel(scene), REPEATS, before=load)
    shares = []
    with kernels_timed() as spent:
        for _ in range(REPEATS):
            spent[0] = 0.0
            cm.CableModel(scene)
            shares.append(spent[0])
    model = cm.CableModel(scene)
    elements = model.statistics["elements"]
    beginning = model.snapshot()
    run = best(
        lambda: model.step_to(scene.run.duration), 3, before=lambda: model.restore(beginning)
    )
    finite_element = scene.solver.method == "finite_element"
    return [
        path.name,
        f"{elements}",
        f"{1e3 * start:.1f}",
        f"{1e3 * min(shares):.1f}" if finite_element else "",
        f"{1e3 * run:.1f}",
        f"{scene.run.duration:g}",
    ]


LAYS = tuple(
    (kind, knots, depth, slope)
    for kind in ("light", "armoured", "thin")
    for knots in (1.0, 5.0, 8.0)
    for depth in (20.0, 500.0, 8000.0)
    for slope in (-15.0, 0.0, 5.0)
)
CABLES: dict[str, dict[str, float]] = {
    "light": {"diameter": 0.017, "mass": 0.55, "axial_stiffness": 8e6, "bending_stiffness": 20.0,
              "drag_normal": 1.5, "drag_tangential": 0.005},
    "armoured": {"diameter": 0.04, "mass": 4.3, "axial_stiffness": 50e6,
                 "bending_stiffness": 1000.0, "drag_normal": 1.2, "drag_tangential": 0.01},
    "thin": {"diameter": 0.025, "mass": 1.2, "axial_stiffness": 8e6, "bending_stiffness": 1.0,
             "drag_normal": 1.3, "drag_tangential": 0.01},
}  # fmt: skip


def lay(kind: str, knots: float, depth: float, slope: float) -> dict[str, Any]:
    """A steady lay without slack, the slope of its floor along the vessel's way in degrees."""
    cable, speed, up = CABLES[kind], knots * 1852.0 / 3600.0, math.radians(slope)
    area = 0.25 * math.pi * cable["diameter"] ** 2
    weight = 9.80665 * (cable["mass"] - 1025.0 * area)
    drag = 0.5 * 1025.0 * cable["drag_normal"] * cable["diameter"] * speed**2
    down = math.acos(2.0 * drag / (weight + math.hypot(weight, 2.0 * drag)))
    rate = speed * (math.sin(down) - math.sin(up)) / math.sin(down - up)
    out = {"type": "c", "length": 1.05 * depth * math.cos(up) / math.sin(down - up) + 20.0}
    floor = {"z": -depth, "slope": [math.tan(up), 0.0], "friction": 0.5}
    return {
        "environment": {"floor": floor},
        "cable_types": {"c": cable},
        "line": [{"cable": out}],
        "vessel": {"velocity": [speed, 0, 0]},
        "payout": {"rate": [{"t": 0, "rate": rate}], "drum": [{"cable": out}]},
        "run": {"duration": 10},
    }


def measure_lay(kind: str, knots: float, depth: float, slope: float) -> list[str]:
    """A row: what is laid, elements, start, what was tried."""
    import cablemodel as cm

    scene = cm.load_scene(lay(kind, knots, depth, slope))
    tried: list[str] = []
    handler = logging.Handler()
    handler.emit = lambda record: tried.append(record.getMessage())  # type: ignore[method-assign]
    logger = logging.getLogger("cablemodel")
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    begin = time.process_time()
    try:
        elements = str(cm.CableModel(scene).statistics["elements"])
    except cm.StaticsError:
        elements = "none found"
    spent = time.process_time() - begin
    logger.removeHandler(handler)
    ways = "; ".join(what.removeprefix("start: ") for what in tried)
    return [kind, f"{knots:g}", f"{depth:g}", f"{slope:g}", elements, f"{1e3 * spent:.0f}", ways]


STARTS, STEADY = Path("docs/benchmarks/starts.csv"), Path("docs/benchmarks/steady_lays.csv")
LAY_HEAD = ("cable", "knots", "depth [m]", "slope [deg]", "elements", "start [ms]", "tried")
HEAD = ("scene", "elements", "start [ms]", "of it kernels [ms]", "run [ms]", "of [s]")


def main() -> None:
    """Measure the ready scenes and steady lays; keep the rows."""
    write_rows(STEADY, LAY_HEAD, [measure_lay(*row) for row in LAYS])
    write_rows(STARTS, HEAD, [measure(path) for path in sorted(Path("scenes").glob("*.yaml"))])


if __name__ == "__main__":
    main()
