"""What skipping gains: ``python -m benchmarks.skips``, a table in Markdown.

Each row runs a scene twice, with and without something that the engine leaves out by itself where
a scene does not need it; what is left out is put back by hand. Time is the processor's, the best
of several; the change is that of the last tip position over the length, and of the top tension.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.kernels import CABLE, best, towed

END = 100.0


@dataclass(frozen=True)
class Skip:
    """A part that can be left out, on one scene: `without` leaves it out, `with_it` does not."""

    name: str
    scene: str
    without: Callable[[], Any]
    with_it: Callable[[], Any]
    interval: float | None = None


def _model(scene: dict[str, Any], planar: bool | None = None) -> Any:
    import cablemodel as cm

    return cm.CableModel(cm.load_scene(scene), planar=planar)


def _with_words(model: Any, **words: float) -> Any:
    """The model with words of its block set: header words as integers, S_ words as reals."""
    from cablemodel.kernels import layout as at

    for name, value in words.items():
        if name.startswith("S_"):
            model._reals[getattr(at, name)] = value
        else:
            model._ints[getattr(at, name)] = int(value)
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
            "the same where it matters",
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
            lambda: _with_words(_model(fine), I_PAYOUT=1),
        ),
        Skip(
            "stages (two-step scheme against one-step)",
            "tow, 100 Hz",
            lambda: _model(fine),
            lambda: _with_words(_model(fine), I_TWO_STEP_WAIT=1 << 40),
            interval=0.01,
        ),
    ]


def measure(make: Callable[[], Any], interval: float | None) -> tuple[float, Any]:
    """CPU time of the run [s], and the model at its end."""
    model = make()
    start = model.snapshot()

    def run() -> None:
        model.restore(start)
        if interval is None:
            model.step_to(END)
            return
        for k in range(round(END / interval)):
            model.step_to((k + 1) * interval)

    return best(run, 5), model


def table() -> str:
    """The rows as Markdown."""
    lines = [
        "| left out | scene | time, put back / left out | tip, of L | top tension |",
        "|---|---|---|---|---|",
    ]
    for skip in skips():
        short, lean = measure(skip.without, skip.interval)
        long, full = measure(skip.with_it, skip.interval)
        away = float(np.linalg.norm(lean.tip_position - full.tip_position)) / 30.0
        pull = abs(lean.top_tension - full.top_tension) / abs(full.top_tension)
        lines.append(
            f"| {skip.name} | {skip.scene} | {long / short:.2f} | {away:.1e} | {pull:.1e} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Print the page."""
    print("# What skipping gains\n")
    print(
        "Written by `python -m benchmarks.skips > docs/benchmarks/skips.md`: a towed cable (S1) of"
    )
    print(
        "16 elements to 100 s; times through the Python interface, which adds 3.5 us to each step"
    )
    print("at 100 Hz (from C the last row is 2.6).\n")
    print(table())


if __name__ == "__main__":
    main()
