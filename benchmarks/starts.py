"""How long scenes take to start, beside their run: ``python -m benchmarks.starts`` writes a page.

Starts and runs of the ready scenes, through the Python interface: of a tow's 200 s the start takes
more than the run. Processor time, best of several, each of a scene that has just been loaded, in a
process that has started others: what is imported and made once for all (sizes of elements, a sea
that was there before) is left out.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from benchmarks.machine import describe
from benchmarks.measure import best
from benchmarks.report import table

PAGE = Path("docs/benchmarks/starts.md")
REPEATS = 7


@contextmanager
def kernels_timed() -> Iterator[list[float]]:
    """Processor time of the finite elements' entry points, added up in a list of one number [s]."""
    from cablemodel import library

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


def main() -> None:
    """Measure the ready scenes and write the page."""
    rows = [measure(path) for path in sorted(Path("scenes").glob("*.yaml"))]
    heads = ["scene", "elements", "start [ms]", "of it kernels [ms]", "run [ms]", "of [s]"]
    about = describe()
    PAGE.write_text(
        "# Starts\n\n"
        "Written by `python -m benchmarks.starts`: processor time of a model's start (mesh, static "
        "shape, look for growing motions) from a scene just loaded, and of its run by one call, "
        "the best of several, in a process that has started others before.\n\n"
        f"{table(heads, rows)}\n"
        f"Machine: {about['processor']}, load {about['load']}, revision {about['revision']}.\n"
    )
    print(PAGE.read_text())


if __name__ == "__main__":
    main()
