"""A heavy load that swings on a wire: water takes long to end that, and errors add up meanwhile."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

from cablemodel.systems import SystemModel

G, RHO, TAU = 9.81, 1025.0, 1e-3
MASS, ADDED, WEIGHT, AREA, LENGTH = 20_000.0, 3000.0, 0.85 * 20_000.0 * G, 3.0, 20.0
SPEED, BEGIN, RISE, UNTIL = 0.3, 2.0, 2.0, 100


def crane(t: float) -> tuple[float, float, float]:
    """Way, speed and acceleration of the crane's tip."""
    since = min(max(t - BEGIN, 0.0), RISE)
    way = 0.5 * SPEED / RISE * since**2 + SPEED * max(t - BEGIN - RISE, 0.0)
    return way, SPEED / RISE * since, SPEED / RISE if 0.0 < since < RISE else 0.0


def swings(outputs: np.ndarray) -> np.ndarray:
    """Angles of a pendulum whose drag goes with the square of the speed [rad]."""
    length = LENGTH * (1.0 + WEIGHT / 2e7)

    def motion(t: float, state: np.ndarray) -> list[float]:
        angle, rate = state
        along = np.array([np.cos(angle), np.sin(angle)])
        velocity = np.array([crane(t)[1], 0.0]) + length * rate * along
        drag = -0.5 * RHO * AREA * np.hypot(*velocity) * velocity
        force = drag - [(MASS + ADDED) * crane(t)[2], WEIGHT]
        return [rate, float(force @ along) / ((MASS + ADDED) * length)]

    state, found = np.zeros(2), []
    for begin, end in pairwise(outputs):
        run = solve_ivp(motion, (begin, end), state, rtol=1e-10, atol=1e-12)
        state = run.y[:, -1]
        found.append(state[0])
    return np.array(found)


def test_a_load_swings_as_long_as_its_drag_lets_it() -> None:
    rows = [(0.0, 0.0), (BEGIN, 0.0), (BEGIN + RISE, SPEED), (2.0 * UNTIL, SPEED)]
    load = {"mass": MASS, "submerged_weight": WEIGHT, "inertia": 2000.0, "added_mass": ADDED,
            "drag_area": AREA, "points": {"eye": [0, 0, 0]}}  # fmt: skip
    wire = {"diameter": 0.002, "mass": 0.003, "axial_stiffness": 2e7, "drag_normal": 1.2}
    items = [{"cable": {"type": "wire", "length": LENGTH}}]
    model = SystemModel({
        "environment": {"water_density": RHO, "gravity": G}, "cable_types": {"wire": wire},
        "vessels": {"crane": {"points": {"tip": [0, 0, 0]},
                              "velocity": [{"t": t, "velocity": [v, 0, 0]} for t, v in rows]}},
        "bodies": {"load": load},
        "lines": {"hoist": {"from": "crane.tip", "to": "load.eye", "items": items}},
        "solver": {"tolerance": TAU},
    })  # fmt: skip
    outputs = np.arange(0.0, UNTIL + 1.0)
    length = LENGTH * (1.0 + WEIGHT / 2e7)
    for end, angle in zip(outputs[1:], swings(outputs), strict=True):
        model.step_to(float(end))
        expected = length * np.array([np.sin(angle), 0.0, -np.cos(angle)]) + [crane(end)[0], 0, 0]
        assert np.linalg.norm(model.bodies["load"].position - expected) < 0.5 * TAU * LENGTH
