"""Energy: what the vessel puts in is stored or lost to drag; nothing comes from nowhere."""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification import scenes
from tests.verification.references import motion
from tests.verification.scenes import IDEAL, scene

GRAVITY = 9.80665


def stored(model):
    energy = model.energy()
    return energy["kinetic"] + energy["axial"] + energy["bending"] + energy["potential"]


def test_energy_report_is_that_of_the_state():
    """Gauss quadrature of the sampled cable: kinetic with added mass, strain, bending, weight."""
    model = cm.CableModel(scenes.towed(tolerance=1e-5, elements=16))
    model.step_to(25.0)
    points, weights = np.polynomial.legendre.leggauss(12)
    edges = np.linspace(0.0, 30.0, 17)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    s = (middle[:, None] + half[:, None] * points).ravel()
    w = (half[:, None] * weights).ravel()
    state = model.sample(s)
    cable = scenes.CABLE_K
    added = 1025.0 * np.pi / 4.0 * cable["diameter"] ** 2
    along = np.einsum("ij,ij->i", state.velocity, state.tangent)
    square = np.einsum("ij,ij->i", state.velocity, state.velocity)
    kinetic = np.sum(w * (cable["mass"] * square + added * (square - along**2))) / 2
    potential = np.sum(w * cable["submerged_weight"] * state.position[:, 2])
    bending = np.sum(w * 0.1 * state.curvature**2) / 2
    axial = np.sum(w * state.tension**2) / 2e6
    energy = model.energy()
    assert energy["kinetic"] == pytest.approx(kinetic, rel=1e-4)
    assert energy["potential"] == pytest.approx(potential, rel=1e-6)
    assert energy["bending"] == pytest.approx(bending, rel=1e-3)
    assert energy["axial"] == pytest.approx(axial, rel=1e-3)
    assert energy["vessel_power"] == pytest.approx(
        -model.top_force @ model.vessel_velocity, rel=1e-9
    )


def drag_power(model, elements, length):
    """Power that drag takes from the sampled cable [W], negative."""
    points, weights = np.polynomial.legendre.leggauss(6)
    edges = np.linspace(0.0, length, elements + 1)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    state = model.sample((middle[:, None] + half[:, None] * points).ravel())
    w = (half[:, None] * weights).ravel()
    cable = scenes.CABLE_K
    normal = 0.5 * 1025.0 * cable["drag_normal"] * cable["diameter"]
    tangential = 0.5 * 1025.0 * cable["drag_tangential"] * np.pi * cable["diameter"]
    along = np.einsum("ij,ij->i", state.velocity, state.tangent)
    across = np.linalg.norm(state.velocity - along[:, None] * state.tangent, axis=1)
    factor = np.sqrt(1.0 + state.tension / 1e6)
    return -np.sum(w * factor * (normal * across**3 + tangential * np.abs(along) ** 3))


def test_reported_drag_power_is_that_of_the_state():
    model = cm.CableModel(scenes.towed(tolerance=1e-5, elements=32))
    for time in (10.0, 30.0, 60.0):
        model.step_to(time)
        assert -abs(model.energy()["drag_power"]) == pytest.approx(
            drag_power(model, 32, 30.0), rel=1e-4
        )


def added_mass_exchange(model, elements, length):
    """Power of the added-mass force that its kinetic energy does not account for [W].

    Morison's -ma (I - t t^T) a does work at the rate -d/dt(ma |v_n|^2 / 2) - ma (v.t)(v.t_dot):
    the second part is energy that the water takes or gives as the cable turns while it slides.
    t_dot is that of the material, P dv/ds / |r'|.
    """
    points, weights = np.polynomial.legendre.leggauss(6)
    edges = np.linspace(0.0, length, elements + 1)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    s = (middle[:, None] + half[:, None] * points).ravel()
    w = (half[:, None] * weights).ravel()
    state, step = model.sample(s), 1e-3
    change = (model.sample(s + step).velocity - model.sample(s - step).velocity) / (2.0 * step)
    tangent = state.tangent
    turning = change - np.einsum("ij,ij->i", change, tangent)[:, None] * tangent
    turning /= (1.0 + state.tension / 1e6)[:, None]
    along = np.einsum("ij,ij->i", state.velocity, tangent)
    across = np.einsum("ij,ij->i", state.velocity, turning)
    added = 1025.0 * np.pi / 4.0 * scenes.CABLE_K["diameter"] ** 2
    return -added * np.sum(w * along * across)


def simpson(interval, values):
    values = np.asarray(values)
    weights = np.ones(len(values))
    weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
    return interval / 3.0 * weights @ values


def balance(model, interval, count, elements, length):
    """(gain of stored energy, work of the vessel, loss to drag, exchange) over the run [J]."""
    start = stored(model)
    work, lost, exchanged = [], [], []
    for k in range(count + 1):
        if k:
            model.step_to(k * interval)
        energy = model.energy()
        work.append(energy["vessel_power"])
        lost.append(abs(energy["drag_power"]))
        exchanged.append(added_mass_exchange(model, elements, length))
    gain = stored(model) - start
    return gain, *(simpson(interval, powers) for powers in (work, lost, exchanged))


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_energy_balance_of_a_tow_closes_with_the_tolerance(tolerance):
    """Over 60 s, to 10 tau of the work, at every tau; the exchange is 4e-4 of it.

    Powers are integrated by Simpson's rule over output intervals of 0.2 s, which adds 1e-5.
    """
    model = cm.CableModel(scenes.towed(tolerance=tolerance, elements=20))
    gain, work, lost, exchange = balance(model, 0.2, 300, 20, 30.0)
    assert work > 1000.0
    assert abs(exchange) > 0.5
    assert gain == pytest.approx(work - lost + exchange, abs=(10 * tolerance + 1e-5) * work)


def test_drag_only_takes_energy_from_a_released_cable():
    """No work is done on it: stored energy falls from output to output, by the drag's share."""
    model = cm.CableModel(scenes.released_in_water(tolerance=1e-5, elements=40))
    gain, work, lost, exchange = balance(model, 0.02, 200, 40, 10.0)
    assert work == 0.0
    assert gain < 0.0
    assert gain == pytest.approx(-lost + exchange, rel=1e-4)


def test_reported_exchange_with_added_mass_is_that_of_the_state():
    """A cable that is let go in a cross current, while it turns and slides."""
    model = cm.CableModel(
        scenes.released_in_water(tolerance=1e-5, elements=40, current=[0.3, 0.4, 0.0])
    )
    for time in (0.5, 1.0, 3.0):
        model.step_to(time)
        taken = model.energy()["added_mass_power"]
        assert abs(taken) > 1e-3
        assert taken == pytest.approx(-added_mass_exchange(model, 40, 10.0), rel=1e-3)


def test_energy_balance_of_a_body_with_unequal_added_masses_closes():
    """A depressor on a line is towed off: its axis turns while it moves along and across it."""
    body = {
        "mass": 20.0,
        "submerged_weight": 100.0,
        "added_mass": 40.0,
        "added_mass_axial": 2.0,
        "drag_area": 0.02,
        "drag_area_axial": 0.02,
    }
    ramp = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 1.0, "velocity": [2.0, 0, 0]}]
    model = cm.CableModel(
        scene(
            5.0,
            {**IDEAL, "axial_stiffness": 1e7, "mass": 0.1},
            model="cable",
            body=body,
            tolerance=1e-6,
            vessel={"velocity": ramp},
        )
    )
    start, given, lost, taken = stored(model), [0.0], [0.0], [0.0]
    for k in range(800):
        model.step_to(0.005 * (k + 1))
        energy = model.energy()
        given.append(energy["vessel_power"])
        lost.append(energy["drag_power"])
        taken.append(energy["added_mass_power"])
    gain = stored(model) - start
    given, lost, taken = (simpson(0.005, power) for power in (given, lost, taken))
    assert abs(taken) > 0.01 * given
    assert gain == pytest.approx(given - lost - taken, abs=1e-3 * given)


def rope(tolerance, **settings):
    """1 m of rope in vacuum, let go at 60 degrees; a little bending stiffness, no end mass."""
    place = [np.sin(np.radians(60.0)), 0.0, -np.cos(np.radians(60.0))]
    cable = {
        **IDEAL,
        "mass": 0.4613,
        "submerged_weight": 0.4613 * GRAVITY,
        "axial_stiffness": 1e6,
        "bending_stiffness": 10.0,
    }
    return cm.CableModel(
        scene(
            1.0,
            cable,
            density=0.0,
            tolerance=tolerance,
            initial={"straight": place},
            **settings,
        )
    )


SWING = 0.4613 * GRAVITY * 0.25
"""Energy of that swing above its rest [J]."""


def bob(tolerance, **settings):
    """1 kg on a metre of cable of a thousandth of its mass, let go at 60 degrees in vacuum."""
    stretch = 1.0 + GRAVITY * 0.5 / 1e6
    place = [stretch * np.sin(np.radians(60.0)), 0.0, -stretch * 0.5]
    cable = {
        **IDEAL,
        "mass": 1e-3,
        "submerged_weight": 1e-3 * GRAVITY,
        "axial_stiffness": 1e6,
    }
    return cm.CableModel(
        scene(
            1.0,
            cable,
            model="cable",
            density=0.0,
            tolerance=tolerance,
            body={"mass": 1.0, "submerged_weight": GRAVITY},
            initial={"points": [[0.0, 0.0, 0.0], place]},
            **settings,
        )
    )


PERIOD = motion.pendulum_period(1.0, np.radians(60.0))


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_undamped_swing_keeps_its_energy(tolerance):
    """Ten periods without drag: numerical damping at most 10 tau a period, and never a gain.

    A height error of tau L is an energy error of 2 tau of this swing.
    """
    model = bob(tolerance, elements=4)
    start = stored(model)
    for k in range(10):
        model.step_to((k + 1) * PERIOD)
        change = (stored(model) - start) / (0.5 * GRAVITY)
        assert -10.0 * tolerance * (k + 1) < change < 2.0 * tolerance * (k + 1)


@pytest.mark.parametrize("interval", [0.02, 0.01, 0.002])
def test_undamped_swing_stepped_by_its_caller_keeps_its_energy(interval):
    """A caller at 50 to 500 Hz, far below what the tolerance needs: no worse than without."""
    tolerance = 1e-4
    model = bob(tolerance, elements=4)
    start = stored(model)
    for k in range(round(5.0 * PERIOD / interval)):
        model.step_to((k + 1) * interval)
    change = (stored(model) - start) / (0.5 * GRAVITY)
    assert -10.0 * tolerance * 5 < change < 2.0 * tolerance * 5


def test_numerical_damping_of_an_undamped_swing_falls_with_the_order_of_the_scheme(
    record_property,
):
    """Ten periods of the pendulum: the loss of energy over that of the swing.

    A scheme of order 4 whose local error is held at tau takes steps ~ tau^(1/4), and its damping
    per unit of time is of order dt^4 or dt^5: in a decade of tau the loss must fall tenfold. Where
    the tension is stiff the stages are of order 2 only: 10^(3/4) at the least.
    """
    losses = []
    for tolerance in (1e-6, 1e-7, 1e-8):
        model = bob(tolerance, elements=2)
        start = stored(model)
        model.step_to(10.0 * PERIOD)
        losses.append((start - stored(model)) / (0.5 * GRAVITY))
        record_property(f"damping at {tolerance:g}", losses[-1])
    # Rounding in the 350,000 steps at 1e-8 leaves a few 1e-13 of either sign.
    assert (np.array(losses) > -1e-12).all(), losses
    assert losses[0] / max(losses[2], 1e-12) > 10.0**1.5


@pytest.mark.parametrize("tolerance", [1e-4, 1e-5])
def test_swing_of_a_stiff_rope_keeps_its_energy(tolerance):
    model = rope(tolerance)
    start = stored(model)
    for k in range(5):
        model.step_to((k + 1) * 1.75)
        change = (stored(model) - start) / SWING
        assert -10.0 * tolerance * (k + 1) < change < 2.0 * tolerance * (k + 1)
