"""A load that rings on its wire after a jump, in a system: against a mass on a spring."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from cablemodel.systems import SystemModel

G, TAU = 9.81, 1e-3
MASS, LENGTH, STIFFNESS = 5000.0, 100.0, 2e6
WIRE = {"diameter": 0.01, "mass": 0.05, "axial_stiffness": STIFFNESS}
TIMES, RATES = [0.0, 2.0, 7.0, 12.0], [0.0, 0.0, 1.0, 1.0]
UNTIL, INTERVAL = 25.0, 1.0


def hung(way: str, moves: str, **more: Any) -> dict[str, Any]:
    """A load below a ship in a vacuum; the winch pays out, or the ship goes down as fast."""
    items: list[Any] = [
        {"cable": {"type": "wire", "length": LENGTH}},
        {"body": {"mass": MASS, "submerged_weight": MASS * G, "drag_area": 0.0}},
    ]
    line = {"from": "ship.sheave", "to": "free", "items": items}
    if way == "up":
        line = {"from": "free", "to": "ship.sheave", "items": items[::-1]}
    ship: dict[str, Any] = {"points": {"sheave": [0, 0, 0]}}
    scene: dict[str, Any] = {
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": {"wire": WIRE}, "vessels": {"ship": ship}, "lines": {"hoist": line},
        "solver": {"tolerance": TAU}, **more,
    }  # fmt: skip
    if moves == "winch":
        end = "start" if way == "down" else "end"
        rows = [{"t": t, "rate": r} for t, r in zip(TIMES, RATES, strict=True)]
        scene["winches"] = {"w": {"line": "hoist", "at": end, "drum": 50.0, "rate": rows}}
    else:
        ship["velocity"] = [
            {"t": t, "velocity": [0, 0, -r]} for t, r in zip(TIMES, RATES, strict=True)
        ]
    return scene


def tensions(moves: str) -> np.ndarray:
    """Of a mass on a spring without weight, at the outputs [N]."""
    kinks = [2.0, 7.0, UNTIL]
    grid = np.cumsum(np.interp(np.arange(0.0, UNTIL, 1e-3) + 5e-4, TIMES, RATES)) * 1e-3

    def gone(t: float) -> float:
        """What has been paid out, or the ship's way down [m]."""
        return float(np.interp(t, np.arange(1, len(grid) + 1) * 1e-3, grid, left=0.0))

    def tension(t: float, x: float) -> float:
        way = gone(t)
        length = LENGTH + (way if moves == "winch" else 0.0)
        return STIFFNESS * (x - LENGTH - way) / length

    def motion(t: float, state: np.ndarray) -> list[float]:
        return [state[1], G - tension(t, state[0]) / MASS]

    state = np.array([LENGTH * (1.0 + MASS * G / STIFFNESS), 0.0])
    outputs = np.arange(1, round(UNTIL / INTERVAL) + 1) * INTERVAL
    found, begin = [], 0.0
    for end in kinks:
        times = outputs[(outputs > begin) & (outputs <= end)]
        run = solve_ivp(motion, (begin, end), state, t_eval=[*times[times < end], end],
                        rtol=1e-9, atol=1e-9)  # fmt: skip
        found += [tension(t, x) for t, x in zip(run.t, run.y[0], strict=True) if t in times]
        state, begin = run.y[:, -1], end
    return np.array(found)


@pytest.mark.parametrize(("way", "moves"), [("down", "winch"), ("up", "winch"), ("down", "ship")])
def test_a_load_rings_as_a_mass_on_a_spring(way: str, moves: str) -> None:
    """With outputs three times a turn; 1 kN of 50, which long steps would damp."""
    model = SystemModel(hung(way, moves))
    found = []
    for k in range(round(UNTIL / INTERVAL)):
        model.step_to((k + 1) * INTERVAL)
        line = model.lines["hoist"]
        found.append(line.start_tension if way == "down" else line.end_tension)
    expected = tensions(moves)
    assert np.ptp(expected[-10:]) > 10.0 * TAU * MASS * G
    assert np.array(found) == pytest.approx(expected, abs=0.5 * 10.0 * TAU * MASS * G)


def test_a_cut_ends_what_is_followed() -> None:
    cut = {"snap": {"line": "hoist", "at": 60.0, "time": 9.0}}
    model = SystemModel(hung("down", "ship", cuts=cut))
    model.step_to(8.0)
    assert model.built.block.header.rings == 1
    model.step_to(9.5)
    assert model.built.block.header.rings == 0
