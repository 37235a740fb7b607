"""A load on a wire that has mass, of few elements, against an elastic rod by polynomials.

The rod hangs from a winch that pays out, or from a vessel whose heave begins without a jump of its
acceleration. Its load rings for minutes: nothing damps it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import legendre
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

import cablemodel as cm

LENGTH, STIFFNESS, MASS, WEIGHT = 140.0, 3e8, 23.5, 172.0  # of the wire, per length
LOAD, LOAD_WEIGHT = 20e3, 150e3
TAU, UNTIL, INTERVAL = 2e-4, 42.0, 0.7
PROMISE = 10.0 * TAU * (LOAD_WEIGHT + LENGTH * WEIGHT)
KINKS, RATE = (10.0, 12.0), 0.2
PERIOD, HEAVE, RAMP = 8.0, 0.4, 30.0
TERMS = 8


def paid(t: float) -> tuple[float, float, float]:
    """Length [m] and two derivatives of a rod that is paid out."""
    begin, end = KINKS
    slope = RATE / (end - begin)
    if t <= begin:
        return LENGTH, 0.0, 0.0
    if t <= end:
        return LENGTH + 0.5 * slope * (t - begin) ** 2, slope * (t - begin), slope
    return LENGTH + 0.5 * RATE * (end - begin) + RATE * (t - end), RATE, 0.0


def heaved(t: float) -> float:
    """The vessel's acceleration upwards [m/s2]: its velocity comes up as t sin."""
    w, share = 2.0 * np.pi / PERIOD, min(t / RAMP, 1.0)
    rise = 1.0 / RAMP if t < RAMP else 0.0
    return float(HEAVE * (share * w * np.cos(w * t) + rise * np.sin(w * t)))


def rod(length: Callable[[float], tuple[float, float, float]],
        held: Callable[[float], float], kinks: tuple[float, ...]) -> np.ndarray:  # fmt: skip
    """Tension at its upper end at the outputs [N].

    Where a point is: y = X - L(t) + v(X / L, t) below what is held, X from the load, v of Legendre
    polynomials that vanish at the upper end.
    """
    points, weights = legendre.leggauss(20)
    at, weights = 0.5 * (points + 1.0), 0.5 * weights
    unit = np.eye(TERMS + 1)[1:]
    shape = np.array([legendre.legval(points, c) - 1.0 for c in unit])
    slope = np.array([2.0 * legendre.legval(points, legendre.legder(c)) for c in unit])
    bend = np.array([4.0 * legendre.legval(points, legendre.legder(c, 2)) for c in unit])
    lower = np.array([legendre.legval(-1.0, c) - 1.0 for c in unit])
    upper = np.array([2.0 * legendre.legval(1.0, legendre.legder(c)) for c in unit])
    inertia = MASS * shape * weights
    moved, carried, bent = inertia.sum(1), inertia @ (at * slope).T, inertia @ (at**2 * bend).T
    spring = STIFFNESS * (slope * weights) @ slope.T
    weight = WEIGHT * shape @ weights
    # By these the mass of a line of any length, with its load, is inverted.
    loads, modes = eigh(LOAD * np.outer(lower, lower), inertia @ shape.T)
    back = modes.T.copy()

    def motion(t: float, state: np.ndarray) -> np.ndarray:
        a, b = state[:TERMS], state[TERMS:]
        size, rate, kink = length(t)
        g, ahead = rate / size, held(t) - kink
        force = -(size * moved + LOAD * lower) * ahead - size * weight - LOAD_WEIGHT * lower
        force -= spring @ a / size
        if rate:
            force += size * g * (carried @ (2.0 * b - (2.0 * g - kink / rate) * a) - g * (bent @ a))
        return np.concatenate([b, modes @ (back @ force / (size + loads))])

    still = -np.linalg.solve(spring / LENGTH, LENGTH * weight + LOAD_WEIGHT * lower)
    state, begin, found = np.concatenate([still, np.zeros(TERMS)]), 0.0, []
    outputs = np.arange(1, round(UNTIL / INTERVAL) + 1) * INTERVAL
    for end in (*kinks, outputs[-1]):
        times = outputs[(outputs > begin) & (outputs <= end)]
        run = solve_ivp(motion, (begin, end), state, method="DOP853", rtol=1e-10, atol=1e-12,
                        t_eval=np.unique([*times, end]))  # fmt: skip
        found += [
            STIFFNESS * (y[:TERMS] @ upper) / length(t)[0]
            for t, y in zip(run.t, run.y.T, strict=True) if t in times
        ]  # fmt: skip
        state, begin = run.y[:, -1], end
    return np.array(found)


def hung(**more: Any) -> dict[str, Any]:
    """The rod as a scene."""
    wire = {"diameter": 0.05, "mass": MASS, "submerged_weight": WEIGHT,
            "axial_stiffness": STIFFNESS, "drag_normal": 1.2, "added_mass": 1.0}  # fmt: skip
    return {
        "cable_types": {"wire": wire},
        "line": [
            {"cable": {"type": "wire", "length": LENGTH}},
            {"body": {"mass": LOAD, "submerged_weight": LOAD_WEIGHT}},
        ],
        "end": "free", "initial": "static", "solver": {"tolerance": TAU}, **more,
    }  # fmt: skip


def tensions(scene: dict[str, Any]) -> np.ndarray:
    """At the upper end, at the outputs [N]."""
    model = cm.CableModel(scene)
    found = []
    for k in range(1, round(UNTIL / INTERVAL) + 1):
        model.step_to(k * INTERVAL)
        found.append(model.top_tension)
    return np.array(found)


def test_a_load_rings_as_on_a_rod_that_is_paid_out() -> None:
    begin, end = KINKS
    rates = [{"t": 0.0, "rate": 0.0}, {"t": begin, "rate": 0.0}, {"t": end, "rate": RATE}]
    drum = [{"cable": {"type": "wire", "length": 50.0}}]
    expected = rod(paid, lambda _t: 0.0, KINKS)
    found = tensions(hung(payout={"rate": rates, "drum": drum}))
    late = expected[-20:] - np.poly1d(np.polyfit(range(20), expected[-20:], 1))(range(20))
    assert np.ptp(late) > 5.0 * PROMISE  # it still rings
    assert found == pytest.approx(expected, abs=0.5 * PROMISE)


def test_a_load_rings_where_a_heave_begins_smoothly() -> None:
    """The jerk jumps alone: the vessel's acceleration begins with zero."""
    times = np.arange(0.0, UNTIL + 1.0, 0.02)
    w = 2.0 * np.pi / PERIOD
    speeds = HEAVE * np.minimum(times / RAMP, 1.0) * np.sin(w * times)
    rows = [
        {"t": float(t), "velocity": [0, 0, float(v)]} for t, v in zip(times, speeds, strict=True)
    ]
    expected = rod(lambda _t: (LENGTH, 0.0, 0.0), heaved, (RAMP,))
    found = tensions(
        hung(vessel={"position": [0, 0, 0], "velocity": rows, "interpolation": "cubic"})
    )
    assert found == pytest.approx(expected, abs=PROMISE)
