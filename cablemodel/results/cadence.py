"""When a run gives outputs, and which of them come with shapes and exact states.

Outputs over time (tensions, forces, positions of the far end and of bodies) are kept at every
output. What is kept along the cable is far larger: 64 nodes at 20 Hz would make 300 MB an hour, for
doubles hardly compress. In a long run it is therefore kept at every second, fifth, tenth ... output
only, such that it stays within a budget; short runs keep all. A replay needs none of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from cablemodel.errors import SceneError
from cablemodel.variables import STATE_LABELS

MOST_OUTPUTS = 10_000_000
"""Of one run: more fill the memory, and are a slip in an interval or a duration."""

SHAPE_BYTES = 64e6
"""Budget of a run for shapes in 32-bit floats, before compression."""
STATE_BYTES = 32e6
"""Budget of a run for states in 64-bit floats, before compression."""

_SHAPE_NODE = 6 * 4
_STATE_NODE = 8 * len(STATE_LABELS)


@dataclass(frozen=True)
class Cadence:
    """Every how many outputs there is a shape for viewers, and an exact state; the first and the
    last output of a run always have both."""

    shapes: int = 1
    states: int = 1

    @classmethod
    def of(
        cls, outputs: int, nodes: int, output_interval: float, state_interval: float | None = None
    ) -> Cadence:
        """What fits the budgets.

        Args:
            outputs: of the whole run.
            nodes: along the cable.
            output_interval: time between outputs [s].
            state_interval: time between exact states [s] instead of what fits; it is rounded to
                whole output intervals, and shapes are at least as frequent.

        Raises:
            ValueError: ``state_interval`` is not a positive number.
        """
        shapes = _round(outputs * nodes * _SHAPE_NODE / SHAPE_BYTES)
        if state_interval is None:
            return cls(shapes, _round(outputs * nodes * _STATE_NODE / STATE_BYTES))
        if not (math.isfinite(state_interval) and state_interval > 0.0):
            raise ValueError(
                f"state_interval is {state_interval}, it must be a positive time in seconds"
            )
        states = max(1, round(state_interval / output_interval))
        return cls(min(shapes, states), states)


def _round(excess: float) -> int:
    """The least of 1, 2, 5, 10, 20, 50, ... that is not below a ratio."""
    if excess <= 1.0:
        return 1
    decade = int(10 ** math.floor(math.log10(excess)))
    return next(step * decade for step in (1, 2, 5, 10) if step * decade >= excess)


def output_times(start: float, end: float, interval: float) -> list[float]:
    """Multiples of the interval after ``start``, and the end: never a sum of steps, whose
    round-off would grow. A last step shorter than a millionth of the interval is merged.

    Raises:
        SceneError: there are too many, see `check_outputs`.
    """
    check_outputs(start, end, interval)
    first = math.floor(start / interval * (1.0 + 1e-12)) + 1
    times = []
    k = first
    while k * interval < end - 1e-6 * interval:
        times.append(k * interval)
        k += 1
    return [*times, end] if end > start else times


def check_outputs(start: float, end: float, interval: float) -> None:
    """Refuse a run of more outputs than anyone reads, before any of them is made.

    Raises:
        SceneError: there are more than `MOST_OUTPUTS`.
    """
    outputs = (end - start) / interval
    if outputs <= MOST_OUTPUTS:
        return
    count = f"{outputs:,.0f}" if outputs < 1e15 else f"{outputs:.3g}"
    raise SceneError.at(
        "run.output_interval",
        interval,
        f"an output every {interval:g} s until {end:g} s makes {count} outputs",
        f"at most {MOST_OUTPUTS:,}: an output_interval of at least "
        f"{_up((end - start) / MOST_OUTPUTS):g} s, or an end (run.duration, until) of at most "
        f"{start + MOST_OUTPUTS * interval:g} s",
    )


def _up(value: float) -> float:
    """The least number of three digits that is not below a positive one."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return math.ceil(value / unit - 1e-9) * unit
