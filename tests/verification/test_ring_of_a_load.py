"""A load rings on its wire when the winch's acceleration has jumped: an ODE of one unknown."""

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import cablemodel as cm

DENSITY, GRAVITY = 1025.0, 9.80665
LENGTH, STIFFNESS = 60.0, 2e6
MASS, ADDED, WEIGHT, AREA = 2000.0, 500.0, 15e3, 1.0
CABLE_MASS, CABLE_WEIGHT = 0.05, 0.1
WINCH = ((0.0, 0.0), (5.0, 0.0), (7.0, 0.5))
END = 60.0


def lowered(tolerance, drag_coefficient):
    """2 t on 60 m of light wire; the winch goes from rest to half a metre a second in 2 s."""
    wire = {
        "diameter": 0.02,
        "mass": CABLE_MASS,
        "submerged_weight": CABLE_WEIGHT,
        "axial_stiffness": STIFFNESS,
        "drag_normal": 0.0,
        "drag_tangential": 0.0,
    }
    load = {
        "mass": MASS,
        "submerged_weight": WEIGHT,
        "added_mass": ADDED,
        "added_mass_axial": ADDED,
        "drag_area": AREA,
        "drag_area_axial": AREA,
        "drag_coefficient": drag_coefficient,
        "drag_coefficient_axial": drag_coefficient,
    }
    return cm.load_scene(
        {
            "environment": {"water_density": DENSITY, "gravity": GRAVITY},
            "cable_types": {"W": wire},
            "line": [
                {"cable": {"type": "W", "length": LENGTH, "model": "cable"}},
                {"body": load},
            ],
            "payout": {
                "rate": [{"t": t, "rate": rate} for t, rate in WINCH],
                "drum": [{"cable": {"type": "W", "length": 40.0, "model": "cable"}}],
            },
            "solver": {"tolerance": tolerance},
        }
    )


def tensions_of_a_spring(times, drag_coefficient):
    """Top tension of a load on a spring that is paid out, (n,) [N].

    A third of the wire's mass goes with the load, and half of its weight is in the middle.
    """

    def length(t):
        _, start, end = (row[0] for row in WINCH)
        speed = WINCH[-1][1]
        ramp = 0.5 * speed * np.clip(t - start, 0.0, end - start) ** 2 / (end - start)
        return LENGTH + ramp + speed * max(t - end, 0.0)

    def middle(t, depth):
        return STIFFNESS * (depth / length(t) - 1.0)

    def rates(t, state):
        depth, speed = state
        drag = 0.5 * DENSITY * AREA * drag_coefficient * abs(speed) * speed
        hangs = WEIGHT + 0.5 * CABLE_WEIGHT * length(t)
        mass = MASS + ADDED + CABLE_MASS * length(t) / 3.0
        return [speed, (hangs - middle(t, depth) - drag) / mass]

    start = [LENGTH * (1.0 + (WEIGHT + 0.5 * CABLE_WEIGHT * LENGTH) / STIFFNESS), 0.0]
    # From one jump of the winch's acceleration to the next, which no step may pass over.
    found = []
    breaks = [row[0] for row in WINCH] + [END]
    for begin, end in itertools.pairwise(breaks):
        here = times[(times > begin) & (times <= end)]
        part = solve_ivp(rates, (begin, end), start, rtol=1e-10, atol=1e-12, dense_output=True)
        found += [middle(t, part.sol(t)[0]) + 0.5 * CABLE_WEIGHT * length(t) for t in here]
        start = part.y[:, -1]
    return np.array(found)


@pytest.mark.parametrize("drag_coefficient", [0.2, 0.4, 1.0])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
@pytest.mark.parametrize("interval", [0.05, 0.2, 1.0, 10.0])
def test_load_rings_as_a_spring_does(interval, tolerance, drag_coefficient):
    """However far apart the outputs are.

    The ring is of 630 N, 4 promises at 1e-3 and 40 at 1e-4. Steps of several of its radians damped
    it: 1.5 to 7 promises. Where it lives for many turns, the two-step scheme did so, too.
    """
    times = np.arange(1, round(END / interval) + 1) * interval
    expected = tensions_of_a_spring(times, drag_coefficient)
    model = cm.CableModel(lowered(tolerance, drag_coefficient))
    found = []
    for t in times:
        model.step_to(float(t))
        found.append(model.top_tension)
    off = np.abs(np.array(found) - expected)
    assert np.max(off) <= 10.0 * tolerance * np.max(expected)
