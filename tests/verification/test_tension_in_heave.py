"""Top tension at outputs of lines whose steps are far too long for it: heave."""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification.scenes import IDEAL, scene

PERIOD = 4.0


def smoothly(share):
    """How far the heave has come up after that share of a period."""
    return 1.0 - np.exp(-(share**4))


def heaving(speed, instants, come_up):
    """A vessel that heaves for four periods, up to that speed [m/s]."""
    rows = []
    for t in np.linspace(0.0, 4.0 * PERIOD, instants):
        up = speed * np.sin(2.0 * np.pi * t / PERIOD) * come_up(t / PERIOD)
        rows.append({"t": float(t), "velocity": [0.0, 0.0, float(up)]})
    return {"velocity": rows, "interpolation": "cubic"}


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
@pytest.mark.parametrize("interval", [0.3, 0.1])
def test_tension_of_a_stiff_line_in_heave(interval, tolerance):
    """All of it moves with the vessel: submerged weight, inertia and drag along the line.

    The caller's steps are far too long for the line's axial waves (0.02 s), and the tension that
    they difference from positions is wrong by 4 promises at 1e-4 (90 % of the instants within 8).
    """
    cable = {
        **IDEAL,
        "mass": 1.3,
        "submerged_weight": 8.0,
        "axial_stiffness": 2e9,
        "drag_normal": 1.2,
        "drag_tangential": 0.02,
        "added_mass": 1.0,
    }
    body = {
        "mass": 300.0,
        "submerged_weight": 1500.0,
        "added_mass": 100.0,
        "added_mass_axial": 50.0,
        "drag_area": 0.5,
        "drag_area_axial": 0.5,
    }
    towed = scene(
        100.0,
        cable,
        model="cable",
        body=body,
        tolerance=tolerance,
        vessel=heaving(0.5, 81, lambda share: np.minimum(share, 1.0)),
    )
    model = cm.CableModel(towed)
    errors, largest = [], 0.0
    for k in range(round(3.0 * PERIOD / interval)):
        model.step_to((k + 1) * interval)
        _, velocity, acceleration = towed.motion().evaluate(model.time)
        drag = 0.5 * 1025.0 * (0.5 + 0.02 * np.pi * 0.01 * 100.0)
        expected = 8.0 * 100.0 + 1500.0 + (130.0 + 350.0) * acceleration[2]
        expected += drag * abs(velocity[2]) * velocity[2]
        largest = max(largest, expected)
        errors.append(abs(model.top_tension - expected))
    assert largest > 2500.0
    assert max(errors) <= 10.0 * tolerance * largest


@pytest.mark.parametrize(("tolerance", "interval"), [(3e-4, 0.5), (3e-4, 0.3), (1e-4, 0.5)])
def test_tension_of_a_line_that_gives_way_in_heave(tolerance, interval):
    """A body on a line of which it swings in a sixth of the heave's period: an ODE of one unknown.

    What the stretch's own second derivative adds to the tension is 1 to 4 promises, and steps of
    two to five times the axial time leave an oscillation of the body: 2.4, 5.0 and 3.3 promises.
    """
    from scipy.integrate import solve_ivp

    length, stiffness = 100.0, 3.5e6
    spring, weight, cable_mass, cable_weight = stiffness / length, 1500.0, 0.013, 0.08
    body = {
        "mass": 300.0,
        "submerged_weight": weight,
        "added_mass": 100.0,
        "added_mass_axial": 50.0,
        "drag_area": 1e-3,
        "drag_area_axial": 1e-3,
    }
    cable = {
        **IDEAL,
        "mass": cable_mass,
        "submerged_weight": cable_weight,
        "axial_stiffness": stiffness,
    }
    towed = scene(
        length,
        cable,
        model="cable",
        body=body,
        tolerance=tolerance,
        # It comes up so smoothly that the body does not swing by itself.
        vessel=heaving(1.0, 641, smoothly),
    )
    motion_of_vessel = towed.motion()

    def middle(t, place):
        """Tension in the middle of the line, its mean."""
        return spring * (motion_of_vessel.evaluate(t)[0][2] - place - length)

    def rates(t, state):
        # The lower half of the cable goes with the body.
        drag = 0.5 * 1025.0 * 1e-3 * abs(state[1]) * state[1]
        force = middle(t, state[0]) - weight - 0.5 * cable_weight * length - drag
        return [state[1], force / (350.0 + 0.5 * cable_mass * length)]

    times = np.arange(1, round(3.0 * PERIOD / interval) + 1) * interval
    start = [-length - (weight + 0.5 * cable_weight * length) / spring, 0.0]
    exact = solve_ivp(
        rates, (0.0, 12.1), start, t_eval=times, rtol=1e-10, atol=1e-12, max_step=0.05
    )
    model = cm.CableModel(towed)
    errors, largest = [], 0.0
    for t, place in zip(times, exact.y[0], strict=True):
        model.step_to(t)
        lifted = cable_weight + cable_mass * motion_of_vessel.evaluate(t)[2][2]
        expected = middle(t, place) + 0.5 * lifted * length
        largest = max(largest, expected)
        errors.append(abs(model.top_tension - expected))
    assert max(errors) <= 10.0 * tolerance * largest


def moored(tolerance, axial_stiffness, floor):
    """16.5 m of light cable to an anchor 16.1 m away; the top heaves by 0.5 m in 4 s."""
    cable = {
        "diameter": 0.0094,
        "mass": 0.157,
        "submerged_weight": 0.85,
        "axial_stiffness": axial_stiffness,
        "drag_normal": 1.4,
        "drag_tangential": 0.06,
        "added_mass": 0.8,
    }
    return cm.CableModel(
        scene(
            16.5,
            cable,
            model="cable",
            tolerance=tolerance,
            vessel=heaving(0.5 * np.pi / PERIOD, 97, smoothly),
            end={"anchor": [14.5, 0.0, -7.0]},
            floor=floor,
        )
    )


@pytest.mark.parametrize("floor", [None, {"z": -11.4}])
@pytest.mark.parametrize(
    ("axial_stiffness", "tolerance", "interval"),
    [(2e3, 1e-3, 0.4), (4e3, 1e-3, 0.15), (4e3, 1e-3, 0.4), (1.6e4, 1e-3, 0.15)],
)
def test_tension_of_a_moored_line_in_heave(axial_stiffness, tolerance, interval, floor):
    """It gives way by its stretch, and was read as if it could not: 5 to 17 promises off.

    Against steps of 5 ms, which resolve what it does along itself (0.1 s), at a quarter of the
    tolerance. A floor that it does not touch changes nothing.
    """
    model = moored(tolerance, axial_stiffness, floor)
    fine = moored(tolerance / 4.0, axial_stiffness, floor)
    errors, largest = [], 0.0
    for k in range(round(12.0 / interval)):
        model.step_to((k + 1) * interval)
        for t in np.linspace(k * interval, model.time, round(interval / 0.005) + 1)[1:]:
            fine.step_to(t)
        largest = max(largest, fine.top_tension)
        errors.append(abs(model.top_tension - fine.top_tension))
    assert largest > 25.0
    assert max(errors) <= 10.0 * tolerance * largest
