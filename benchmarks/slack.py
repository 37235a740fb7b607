"""Slack that is laid in space for an hour and a half, behind a ship at 5 knots.

``python -m benchmarks.slack`` goes on with the job "speed up while laying" beyond its seamount.
What must hold: the elements that are awake, the top tension and the height of what lies stay what
they were in the first half hour. Takes some minutes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import cablemodel as cm

JOB = Path(__file__).parents[1] / "docs" / "jobs" / "lay_speeding_up.yaml"
SINCE, DURATION, STEP = 1000.0, 5400.0, 10.0
"""When the seamount lies behind, how long it goes on, and between looks [s]."""
HANGS, BEFORE = 1000.0, 1500.0
"""More than what hangs, and what was laid before [m]."""
DEPTH = 100.0


def main() -> None:
    """Lay, print what was measured; fails where something does not hold."""
    model = cm.CableModel(cm.load_scene(JOB, "payout.drum.0.cable.length=20000"))
    model.step_to(SINCE)
    looks = []
    while model.time < SINCE + DURATION - 0.5 * STEP:
        model.step(STEP)
        numbers = model.statistics
        looks.append((numbers["elements"] - numbers["asleep"], model.top_tension))
    parts = np.array_split(np.array(looks), 3)
    (awake, tension), (awake_late, tension_late) = parts[0].mean(axis=0), parts[-1].mean(axis=0)
    arcs = np.linspace(HANGS, model.line_length - BEFORE, 20_000)
    height = float(model.sample(arcs).position[:, 2].max()) + DEPTH
    print(
        f"elements {model.statistics['elements']}, awake in the first and last half hour "
        f"{awake:.0f}, {awake_late:.0f}; top tension {tension:.1f}, {tension_late:.1f} N; "
        f"what lies is at most {height:.3f} m high"
    )
    problems = {
        "more and more is awake": awake_late > 2.0 * awake,
        "the tension changes": abs(tension_late - tension) > 0.01 * tension,
        "a loop stands": height > 1.0,
    }
    failed = [problem for problem, found in problems.items() if found]
    if failed:
        raise SystemExit("; ".join(failed))


if __name__ == "__main__":
    main()
