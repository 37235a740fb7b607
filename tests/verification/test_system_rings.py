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


def test_a_push_rings_on_for_as_long_as_a_wire_lets_it() -> None:
    """No jump of a vessel tells of this ring. Long steps turn with it for six periods before they
    are off by the promise; a wire's material takes sixteen to end it."""
    push, begin, rise = 1500.0, 2.0, 0.1
    load = {
        "mass": MASS,
        "submerged_weight": MASS * G,
        "inertia": 500.0,
        "points": {"eye": [0] * 3},
    }
    hoist = {
        "from": {"anchor": [0, 0, 0]}, "to": "load.eye",
        "items": [{"cable": {"type": "wire", "length": LENGTH}}],
    }  # fmt: skip
    model = SystemModel({
        "environment": {"water_density": 0.0, "gravity": G}, "cable_types": {"wire": WIRE},
        "bodies": {"load": load}, "lines": {"hoist": hoist}, "solver": {"tolerance": TAU},
    })  # fmt: skip
    model.step_to(begin)
    force = {"load": [0.0, 0.0, -push, 0.0, 0.0, 0.0]}
    model.step_to(begin + rise, forces=force)
    w = np.sqrt(STIFFNESS / LENGTH / (MASS + WIRE["mass"] * LENGTH / 3.0))
    for end in range(3, 51):
        model.step_to(float(end), forces=force)
        t = end - begin
        swing = (np.sin(w * t) - np.sin(w * (t - rise))) / (w * rise)
        expected = MASS * G + push * (1.0 - swing)
        found = model.lines["hoist"].end_tension
        assert found == pytest.approx(expected, abs=10.0 * TAU * MASS * G)


TOW, HANGS = 400.0, 200.0
"""Mass of what is tied below the load [kg], and its weight in water [N]."""


def test_a_ring_that_a_hoist_may_miss_shakes_a_line_below_its_load() -> None:
    """The ring is less than a per cent of the hoist's tension, and a tenth of that of the line
    below, which carries what is all but buoyant: against two masses on springs."""
    times, rates = [0.0, 2.0, 7.0, 30.0], [0.0, 0.0, 0.1, 0.1]
    load = {"mass": MASS, "submerged_weight": MASS * G, "inertia": 500.0,
            "points": {"eye": [0, 0, 0], "below": [0, 0, 0]}}  # fmt: skip
    lower = [
        {"cable": {"type": "wire", "length": 20.0}},
        {"body": {"mass": TOW, "submerged_weight": HANGS, "drag_area": 0.0}},
    ]
    wire = {"diameter": 0.01, "mass": 0.005, "axial_stiffness": STIFFNESS}
    model = SystemModel({
        "environment": {"water_density": 0.0, "gravity": G}, "cable_types": {"wire": wire},
        "vessels": {"ship": {
            "points": {"sheave": [0, 0, 0]},
            "velocity": [{"t": t, "velocity": [0, 0, -r]}
                         for t, r in zip(times, rates, strict=True)],
        }},
        "bodies": {"load": load},
        "lines": {
            "hoist": {"from": "ship.sheave", "to": "load.eye",
                      "items": [{"cable": {"type": "wire", "length": LENGTH}}]},
            "lower": {"from": "load.below", "to": "free", "items": lower},
        },
        "solver": {"tolerance": TAU},
    })  # fmt: skip
    springs = STIFFNESS / LENGTH, STIFFNESS / 20.0

    def pulls(t: float, x: np.ndarray) -> tuple[float, float]:
        """Of both lines [N], by how far both masses and the ship are below their start [m]."""
        ship = 0.01 * min(max(t - 2.0, 0.0), 5.0) ** 2 + 0.1 * max(t - 7.0, 0.0)
        top = MASS * G + HANGS + springs[0] * (x[0] - ship)
        return top, HANGS + springs[1] * (x[1] - x[0])

    def motion(t: float, state: np.ndarray) -> list[float]:
        top, low = pulls(t, state)
        return [*state[2:], G + (low - top) / MASS, (HANGS - low) / TOW]

    outputs = np.arange(1.0, 25.0)
    run = solve_ivp(motion, (0.0, 25.0), np.zeros(4), t_eval=outputs, max_step=0.02,
                    rtol=1e-9, atol=1e-9)  # fmt: skip
    expected = np.array([pulls(t, x) for t, x in zip(run.t, run.y.T, strict=True)])
    found = []
    for end in outputs:
        model.step_to(end)
        found.append([model.lines["hoist"].start_tension, model.lines["lower"].start_tension])
    hoisted, lower_pull = np.ptp(expected[-10:], axis=0)
    assert hoisted < 10.0 * TAU * MASS * G
    assert lower_pull > 100.0 * TAU * HANGS
    allowed = 10.0 * TAU * expected.max(axis=0)
    assert np.all(np.abs(np.array(found) - expected) < allowed)


@pytest.mark.parametrize("interval", [0.5, 0.05, 0.02])
def test_a_buoy_that_is_pushed_bobs_as_long_at_any_interval_of_the_caller(interval: float) -> None:
    """Steps that are short against a natural one are none of a longer period."""
    wire = {"diameter": 0.03, "mass": 0.6, "axial_stiffness": 2e6, "drag_normal": 0.0,
            "drag_tangential": 0.0}  # fmt: skip
    buoy = {"mass": 6000.0, "submerged_weight": -7000.0, "inertia": 4e4, "added_mass": 400.0,
            "points": {"eye": [0, 0, 0]}}  # fmt: skip
    leg = {"from": {"anchor": [0, 0, -60]}, "to": "buoy.eye",
           "items": [{"cable": {"type": "wire", "length": 54.0}}]}  # fmt: skip
    model = SystemModel(
        {"cable_types": {"wire": wire}, "bodies": {"buoy": buoy}, "lines": {"leg": leg}}
    )
    mass, spring = 6400.0 + 0.6 * 54.0 / 3.0, 2e6 / 54.0

    def push(t: float) -> float:
        return float(np.interp(t, [0.0, 0.5, 10.0, 10.5], [0.0, -3000.0, -3000.0, 0.0]))

    def motion(t: float, state: np.ndarray) -> list[float]:
        return [state[1], (push(t) - spring * state[0]) / mass]

    times = np.arange(0.5, 60.25, 0.5)
    exact = solve_ivp(motion, (0.0, 60.0), [0.0, 0.0], t_eval=times, max_step=0.02, rtol=1e-9)
    first, found = model.lines["leg"].end_tension, []
    for step in range(1, round(60.0 / interval) + 1):
        time = step * interval
        model.step_to(time, forces={"buoy": [0.0, 0.0, push(time), 0.0, 0.0, 0.0]})
        if len(found) < len(times) and abs(time - times[len(found)]) < 1e-6:
            found.append(model.lines["leg"].end_tension)
    expected = first + spring * exact.y[0]
    assert np.abs(found - expected).max() < 10.0 * TAU * expected.max()


def smooth(t: np.ndarray) -> np.ndarray:
    """From 0 to 1 in eight seconds, without a jump of acceleration."""
    x = np.clip(t / 8.0, 0.0, 1.0)
    return np.asarray(x**3 * (10.0 - 15.0 * x + 6.0 * x * x))


def between_ships(tolerance: float) -> dict[str, Any]:
    """A wire between two ships that follow rows of velocity, at 20 Hz."""
    times = np.round(np.arange(0.0, 26.0, 0.05), 9)

    def first(t: np.ndarray) -> np.ndarray:
        return smooth(t) * np.array([0.8 * np.sin(0.8 * t), 0.0 * t, 1.5 * np.sin(0.8 * t)])

    def second(t: np.ndarray) -> np.ndarray:
        sideways = 0.6 * np.sin(0.5 * t)
        return smooth(t) * np.array([0.5 * np.sin(1.1 * t + 1.0), sideways, -1.2 * np.sin(0.8 * t)])

    ships = {}
    for name, way, x in (("A", first, 0.0), ("B", second, 240.0)):
        rates = ((way(times + 1e-4) - way(times - 1e-4)) / 2e-4).T
        pairs = zip(times.tolist(), rates.tolist(), strict=True)
        ships[name] = {
            "position": [x, 0, 0], "points": {"p": [0, 0, 0]}, "interpolation": "cubic",
            "velocity": [{"t": t, "velocity": rate} for t, rate in pairs],
        }  # fmt: skip
    wire = {"diameter": 0.05, "mass": 10.5, "axial_stiffness": 80e6, "drag_normal": 1.2}
    line = {"from": "A.p", "to": "B.p", "items": [{"cable": {"type": "wire", "length": 260.0}}]}
    return {
        "cable_types": {"wire": wire}, "vessels": ships, "lines": {"w": line},
        "solver": {"tolerance": tolerance},
    }  # fmt: skip


def test_short_steps_after_long_ones_feed_no_ring() -> None:
    """The wire's second ring along itself turns by three in the natural step, which ends just
    before each row of the ships' velocities: the rest is a short one."""
    tension = {}
    for tolerance, interval in ((1e-5, 0.25), (1e-4, 0.25), (1e-4, 0.5)):
        model = SystemModel(between_ships(tolerance))
        found = tension[tolerance, interval] = {}
        for k in range(round(25.0 / interval)):
            model.step_to((k + 1) * interval)
            found[model.time] = model.lines["w"].start_tension
    fine = tension.pop((1e-5, 0.25))
    for found in tension.values():
        off = max(abs(value - fine[t]) for t, value in found.items())
        assert off < 0.5 * 10.0 * 1e-4 * max(fine.values())
