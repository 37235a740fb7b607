"""What skipping gains: ``python -m benchmarks.skips``.

Each row runs a scene twice, with and without something that the engine leaves out by itself where
a scene does not need it; what is left out is put back by hand. Time is the processor's, the best
of several; the change is that of the last tip position over the length, and of the top tension.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.kernels import CABLE, towed
from benchmarks.measure import best
from benchmarks.sections import read_rows, table, write_part, write_rows

END = 100.0


@dataclass(frozen=True)
class Skip:
    """A part that can be left out, on one scene: `without` leaves it out, `with_it` does not.

    interval: of the caller's steps [s]; None: one call. each: header words that the run with the
    part sets before every step. before: what is done to both models before every step, outside the
    measured time. end: of the run [s]. repeats: of which the best counts.
    """

    name: str
    scene: str
    without: Callable[[], Any]
    with_it: Callable[[], Any]
    interval: float | None = None
    each: dict[str, int] = field(default_factory=dict)
    before: Callable[[Any], None] | None = None
    end: float = END
    repeats: int = 5


def _model(scene: Any, planar: bool | None = None) -> Any:
    import cablemodel as cm

    loaded = scene if isinstance(scene, cm.Scene) else cm.load_scene(scene)
    return cm.CableModel(loaded, planar=planar)


def _with_words(model: Any, **words: float) -> Any:
    """The model with fields of its block's header set."""
    for name, value in words.items():
        if name not in model._header.FIELDS:
            raise AttributeError(f"a block's header has no {name!r}")
        setattr(model._header, name, value)
    return model


def _sheared(scene: dict[str, Any]) -> dict[str, Any]:
    """The same scene in a current of zero velocity, given over depth."""
    depths = {"table": [{"z": z, "velocity": [0.0, 0.0, 0.0]} for z in (-40.0, -20.0, 0.0)]}
    return {**scene, "environment": {"current": depths}}


def _flexible(stiffness: float) -> dict[str, Any]:
    return {"cable_types": {"K": {**CABLE, "bending_stiffness": stiffness}}}


def skips() -> list[Skip]:
    """All rows."""
    fine = towed(16)
    return [
        Skip("plane instead of space", "tow", lambda: _model(fine), lambda: _model(fine, False)),
        Skip(
            "bending, where it is not resolvable (hybrid against elastica)",
            "tow, EI 0.1",
            lambda: _model(towed(16, model="hybrid")),
            lambda: _model(fine),
        ),
        Skip(
            "bending, where it matters (hybrid against elastica)",
            "tow, EI 1000",
            lambda: _model({**towed(16, model="hybrid"), **_flexible(1000.0)}),
            lambda: _model({**fine, **_flexible(1000.0)}),
        ),
        Skip(
            "bending altogether (cable against elastica)",
            "tow, EI 0.1",
            lambda: _model(towed(16, model="cable")),
            lambda: _model(fine),
        ),
        Skip("current", "tow, still water", lambda: _model(fine), lambda: _model(_sheared(fine))),
        Skip(
            "pay-out",
            "tow",
            lambda: _model(fine),
            lambda: _with_words(_model(fine), payout=1),
        ),
        Skip(
            "stages (two-step scheme against one-step)",
            "tow, 100 Hz",
            lambda: _model(fine),
            lambda: _with_words(_model(fine), two_step_wait=1 << 40),
            interval=0.01,
        ),
        Skip(
            "a new matrix in every step (kept from step to step)",
            "tow, 100 Hz",
            lambda: _model(fine),
            lambda: _model(fine),
            interval=0.01,
            each={"factored": 0},
        ),
        Skip(
            "a new matrix in every step (kept from step to step)",
            "turn in space, 100 Hz",
            lambda: _model(_turned()),
            lambda: _model(_turned()),
            interval=0.01,
            each={"factored": 0},
        ),
        Skip(
            "drag and added mass (in a vacuum, of water without density)",
            "swing in a vacuum",
            lambda: _model(_swing()),
            lambda: _with_words(_model(_swing()), drag=1),
            end=10.0,
        ),
        *(
            Skip(
                "the sum over a sea's 100 components (a series in cells of space and time)",
                f"100 m towed at 1.5 m/s in an irregular sea, {called}",
                lambda: _model(_at_sea()),
                _summed_sea,
                interval=interval,
                end=60.0,
            )
            for called, interval in (("60 s in a call", 60.0), ("10 Hz", 0.1), ("100 Hz", 0.01))
        ),
        Skip(
            "floor (none, against one that is never touched)",
            "tow",
            lambda: _model(fine),
            lambda: _model({**fine, "environment": {"floor": {"z": -1000.0}}}),
        ),
        Skip(
            "cable that lies (long elements, against 25 m ones everywhere)",
            "lay of 10 km in 3,000 m",
            lambda: _lay(None),
            lambda: _lay(25.0),
            interval=20.0,
            end=9000.0,
            repeats=1,
        ),
        Skip(
            "cable at rest on the floor (asleep, against awake)",
            "lay of 10 km in 3,000 m, long elements behind the touchdown",
            lambda: _lay(None),
            lambda: _with_words(_lay(None), sleep=0),
            interval=20.0,
            end=9000.0,
            repeats=1,
        ),
        Skip(
            "both (long elements asleep, against 25 m ones awake)",
            "lay of 10 km in 3,000 m",
            lambda: _lay(None),
            lambda: _with_words(_lay(25.0), sleep=0),
            interval=20.0,
            end=9000.0,
            repeats=1,
        ),
        Skip(
            "cable at rest on the floor (asleep, against awake)",
            "lay of 10 km, laid elements as short as they landed",
            _fine_lay,
            lambda: _with_words(_fine_lay(), sleep=0),
            interval=20.0,
            before=_forbid_joining,
            end=10000.0,
            repeats=1,
        ),
        Skip(
            "cable at rest on the floor (asleep, against awake)",
            "2.6 km over a rough floor",
            _rough_lay,
            lambda: _with_words(_rough_lay(), sleep=0),
            interval=20.0,
            end=2600.0,
            repeats=1,
        ),
    ]


def _turned() -> dict[str, Any]:
    """S4 on 16 elements."""
    from benchmarks.contestants import cablemodel_scene
    from benchmarks.scenes import SCENES

    return cablemodel_scene(SCENES["S4"], 1e-3, "elastica", elements=16)


def _swing() -> dict[str, Any]:
    """A cable of 30 m let go 30 degrees from the vertical, in a vacuum."""
    straight = {"straight": [0.5, 0.0, -(0.75**0.5)]}
    return {
        **towed(16),
        "environment": {"water_density": 0.0},
        "vessel": {},
        "initial": straight,
    }


def _at_sea() -> dict[str, Any]:
    """A line of 100 m towed through an irregular sea."""
    return {
        **towed(None),
        "environment": {"waves": {"jonswap": {"hs": 2.0, "tp": 8.0, "seed": 1}}},
        "line": [{"cable": {"type": "K", "length": 100.0}}],
        "vessel": {"velocity": [1.5, 0.0, 0.0]},
    }


def _summed_sea() -> Any:
    """The same with its components summed for every point."""
    from unittest.mock import patch

    with patch("cablemodel.solvers.finite_element.start.waves.SEA_FEWEST", 10**6):
        return _model(_at_sea())


def _lay(element: float | None) -> Any:
    """The steady lay of 10 km, on its own mesh or on elements of that length where it is made."""
    from benchmarks.stress_scenes import long_lay_scene

    return _model(long_lay_scene(10e3, element))


def _fine_lay() -> Any:
    """The steady lay with room for elements that are never joined."""
    from unittest.mock import patch

    from cablemodel.solvers.finite_element.start.from_scene import build

    with patch("cablemodel.solvers.finite_element.solver.build", partial(build, room=150.0)):
        return _lay(None)


def _forbid_joining(model: Any) -> None:
    """Make every element one of a segment of its own: elements of two are not joined."""
    from cablemodel.solvers.shared import layout as at
    from cablemodel.solvers.shared.layout import Header

    nodes = int(model._header.nodes)
    edges = model._solver.memory.array(Header.edges, nodes, at.EDGE_WORDS)
    edges[:, at.Edge.segment] = np.floor(edges[:, at.Edge.segment]) + 1e-6 * np.arange(nodes)


def _rough_lay() -> Any:
    """The steady lay of a stiffer cable over ridges of 2 to 8 m, 200 to 1,100 m apart."""
    from benchmarks.stress_scenes import long_lay_scene

    rows = []
    for x in np.arange(-8e3, 20e3, 50.0):
        ridges = ((2.0, 200.0, 3.1), (4.0, 450.0, 5.7), (8.0, 1100.0, 0.9))
        z = -3000.0 + sum(a * np.sin(2.0 * np.pi * x / way + b) for a, way, b in ridges)
        rows.append({"x": float(x), "z": float(z)})
    scene = long_lay_scene(10e3).to_dict()
    scene["cable_types"]["K"]["bending_stiffness"] = 1500.0
    return _model({**scene, "environment": {"floor": {"depth_table": rows, "friction": 0.4}}})


def measure(make: Callable[[], Any], skip: Skip, each: dict[str, int]) -> tuple[float, Any]:
    """CPU time of the run [s], and the model at its end."""
    model = make()
    start = model.snapshot()

    if skip.before is not None:
        assert skip.interval is not None
        spent = 0.0
        for k in range(round(skip.end / skip.interval)):
            skip.before(model)
            spent += best(partial(model.step_to, (k + 1) * skip.interval), 1)
        return spent, model

    def run() -> None:
        model.restore(start)
        if skip.interval is None:
            model.step_to(skip.end)
            return
        for k in range(round(skip.end / skip.interval)):
            if each:
                _with_words(model, **each)
            model.step_to((k + 1) * skip.interval)

    return best(run, skip.repeats), model


PAGE, STORE = Path("docs/benchmarks.md"), Path("docs/benchmarks/skips.csv")
HEAD = ("left out", "scene", "time, put back / left out", "tip, of L", "top tension")
WORTH = 2.0
"""Ratio of times from which on the page tells of a row."""


def summary(rows: Sequence[dict[str, str]]) -> str:
    """What gains most, without what it changes."""
    head = HEAD[:3]
    told = [row for row in rows if float(row[HEAD[2]]) >= WORTH]
    return table(head, [[row[name] for name in head] for row in told])


def measured(skip: Skip) -> tuple[str, ...]:
    """A row: what leaving out gains, and what it changes."""
    short, lean = measure(skip.without, skip, {})
    long, full = measure(skip.with_it, skip, skip.each)
    apart = lean.tip_position - full.tip_position
    away = float(np.linalg.norm(apart)) / lean.line_length
    pull = abs(lean.top_tension - full.top_tension) / abs(full.top_tension)
    return skip.name, skip.scene, f"{long / short:.2f}", f"{away:.1e}", f"{pull:.1e}"


def main() -> None:
    """Measure all; keep the rows, write a table."""
    write_rows(STORE, HEAD, [measured(skip) for skip in skips()])
    write_part(PAGE, "skips", summary(read_rows(STORE)))


if __name__ == "__main__":
    main()
