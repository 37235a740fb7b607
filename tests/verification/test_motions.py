"""Transients with closed forms, or ODEs of a few unknowns, as solutions."""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification.references import motion
from tests.verification.scenes import CABLE_K, IDEAL, hoist_that_stops, scene

GRAVITY = 9.80665
START = np.radians(60.0)
PERIOD = motion.pendulum_period(1.0, START)
ADDED = 1025.0 * np.pi / 4.0 * CABLE_K["diameter"] ** 2
DRAG = 0.5 * 1025.0 * CABLE_K["drag_normal"] * CABLE_K["diameter"]


# Pendulums --------------------------------------------------------------------------------------


def pendulum(tolerance, *, axial_stiffness=1e5, ratio=1e-5, elements=2):
    """1 kg on a cable of a hundred-thousandth of that, released at 60 deg under its tension."""
    stretch = 1.0 + GRAVITY * np.cos(START) / axial_stiffness
    place = [stretch * np.sin(START), 0.0, -stretch * np.cos(START)]
    cable = {
        **IDEAL,
        "mass": ratio,
        "submerged_weight": ratio * GRAVITY,
        "axial_stiffness": axial_stiffness,
    }
    model = cm.CableModel(
        scene(
            1.0,
            cable,
            model="cable",
            elements=elements,
            density=0.0,
            tolerance=tolerance,
            body={"mass": 1.0, "submerged_weight": GRAVITY},
            initial={"points": [[0.0, 0.0, 0.0], place]},
        )
    )
    return model, place


def swing(place, times, ratio=1e-5):
    """What `pendulum` must do, (n, 2)."""
    mass, weight = 1.0 + ratio / 3.0, GRAVITY * (1.0 + ratio / 2.0)
    return motion.spring_pendulum(1.0, 1e5, mass, weight, (place[0], place[2]), times)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_pendulum(tolerance):
    """One period on an elastic line, exactly: a straight cable adds a third of its mass and half
    of its weight to the bob's."""
    times = np.linspace(0.0, PERIOD, 9)[1:]
    model, place = pendulum(tolerance)
    exact = swing(place, times)
    for time, position in zip(times, exact, strict=True):
        model.step_to(time)
        assert model.tip_position[[0, 2]] == pytest.approx(position, abs=tolerance)


def test_pendulum_period():
    """2.1532423518 s for a massless inextensible line; strain 2e-7 and mass ratio 1e-7 here.

    Where the mass swings back through the vertical, at three quarters of a period, time is seen
    best: 1e-6 m there are 3e-7 s.
    """
    model, _ = pendulum(1e-7, axial_stiffness=1e8, ratio=1e-7)
    assert pytest.approx(2.1532423518, abs=1e-10) == PERIOD
    model.step_to(0.75 * PERIOD)
    late = model.tip_position[0] / model.tip_velocity[0]
    assert 0.75 * PERIOD - late == pytest.approx(0.75 * PERIOD, abs=2e-6)


@pytest.mark.parametrize("interval", [0.05, 0.01, 0.002])
def test_pendulum_stepped_by_its_caller(interval):
    """However short the caller's steps: the error is that of the tolerance."""
    tolerance = 1e-4
    model, place = pendulum(tolerance)
    exact = swing(place, [2.0])[0]
    for k in range(round(2.0 / interval)):
        model.step_to((k + 1) * interval)
    assert model.tip_position[[0, 2]] == pytest.approx(exact, abs=tolerance)


# A rigid rod in a current that varies in time ---------------------------------------------------

GUSTS = [(0.0, 0.0), (0.5, 1.0), (1.0, -0.6), (2.0, 0.4), (3.0, 0.4)]


def gust(t):
    return float(np.interp(t, *zip(*GUSTS, strict=True)))


def current_table(rows=GUSTS):
    return {"table": [{"t": t, "z": 0.0, "velocity": [c, 0.0, 0.0]} for t, c in rows]}


@pytest.mark.parametrize("added_mass", [0.0, 1.0])
def test_rigid_rod_in_gusts(added_mass):
    """A stiff cable hinged at the vessel swings in a current that is a table over time.

    EI = 1e6 bends it by 1e-7 of its length. The added mass goes with the acceleration of the cable
    relative to that of the water, whose pressure accelerates what it displaces, too.
    """
    cable = {
        **CABLE_K,
        "added_mass": added_mass,
        "drag_tangential": 0.0,
        "axial_stiffness": 1e8,
        "bending_stiffness": 1e6,
    }
    times = np.linspace(0.0, 3.0, 13)[1:]
    exact = motion.rigid_rod(
        1.0,
        0.4613,
        2.33333,
        DRAG,
        ADDED * added_mass,
        gust,
        [t for t, _ in GUSTS],
        times,
        current_inertia=ADDED * (1.0 + added_mass),
    )
    model = cm.CableModel(scene(1.0, cable, elements=16, tolerance=1e-5, current=current_table()))
    for time, angle in zip(times, exact, strict=True):
        model.step_to(time)
        tip = model.tip_position
        assert np.arctan2(tip[0], -tip[2]) == pytest.approx(angle, abs=1e-5)


@pytest.mark.parametrize("added_mass", [0.0, 1.0])
def test_cable_adrift_in_gusts(added_mass):
    """Straight across the current, carried along by it: the vessel moves as the water drags.

    Nothing bends it or pulls at it if drag and inertia are right at every time.
    """
    cable = {**CABLE_K, "submerged_weight": 0.0, "added_mass": added_mass, "bending_stiffness": 1.0}
    drift = motion.drifting(
        gust,
        [t for t, _ in GUSTS],
        0.4613,
        ADDED * added_mass,
        DRAG,
        current_inertia=ADDED * (1.0 + added_mass),
    )
    times = np.linspace(0.0, 3.0, 1201)
    velocity, _ = drift(times)
    rows = [
        {"t": float(t), "velocity": [float(v), 0.0, 0.0]}
        for t, v in zip(times, velocity, strict=True)
    ]
    model = cm.CableModel(
        scene(
            5.0,
            cable,
            elements=8,
            tolerance=1e-5,
            current=current_table(),
            vessel={"velocity": rows},
            initial={"straight": [0.0, 1.0, 0.0]},
        )
    )
    for time in (0.5, 1.0, 2.0, 3.0):
        model.step_to(time)
        _, moved = drift(time)
        assert model.tip_position == pytest.approx([moved[0], 5.0, 0.0], abs=5e-5)
        assert model.top_tension < 1e-4 * DRAG * 5.0  # of what holds it in a current of 1 m/s


def test_current_beside_a_step_input():
    """A live current is added to the scene's and varies linearly over the step."""
    rows = [(0.0, 0.0), (1.0, 0.8)]
    towed = scene(5.0, CABLE_K, elements=8, tolerance=1e-5, current=current_table(rows))
    table = cm.CableModel(towed)
    live = cm.CableModel(scene(5.0, CABLE_K, elements=8, tolerance=1e-5))
    table.step_to(1.0)
    live.step(1.0, current=(0.8, 0.0, 0.0))
    assert live.tip_position == pytest.approx(table.tip_position, abs=2e-5)


# Sinking ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_horizontal_cable_sinks_as_tanh(tolerance):
    """The vessel lets go by moving as the cable sinks, which then stays straight and slack."""
    times = np.linspace(0.0, 1.5, 301)
    velocity, _ = motion.sinking(times, 2.33333, 0.4613, ADDED, DRAG)
    rows = [
        {"t": float(t), "velocity": [0.0, 0.0, -float(v)]}
        for t, v in zip(times, velocity, strict=True)
    ]
    model = cm.CableModel(
        scene(
            10.0,
            CABLE_K,
            tolerance=tolerance,
            vessel={"velocity": rows, "interpolation": "cubic"},
            initial={"straight": [1.0, 0.0, 0.0]},
        )
    )
    for time in (0.1, 0.3, 0.6, 1.5):
        model.step_to(time)
        speed, depth = motion.sinking(time, 2.33333, 0.4613, ADDED, DRAG)
        reach = 10.0 * tolerance
        assert model.tip_position == pytest.approx([10.0, 0.0, -depth], abs=reach)
        assert model.tip_velocity[2] == pytest.approx(-speed, abs=5.0 * reach)


def test_middle_of_a_released_cable_sinks_as_tanh():
    """S2w, 8 m from the held end after 0.3 s: bending waves have not come that far."""
    model = cm.CableModel(
        scene(10.0, CABLE_K, tolerance=1e-6, initial={"straight": [1.0, 0.0, 0.0]})
    )
    model.step_to(0.3)
    _, depth = motion.sinking(0.3, 2.33333, 0.4613, ADDED, DRAG)
    assert model.sample([8.0]).position[0, 2] == pytest.approx(-depth, abs=1e-5)


# Axial waves ------------------------------------------------------------------------------------

IMPEDANCE = np.sqrt(1e7)
"""sqrt(EA m) of the cable below [N s/m]; its wave speed is the same number [m/s]."""


def pulled(elements, tolerance, ramp):
    """1 km of cable, straight and without loads; the vessel pulls with 1 m/s after `ramp` [s]."""
    cable = {**IDEAL, "axial_stiffness": 1e7}
    rows = [{"t": 0.0, "velocity": [0, 0, 0]}, {"t": ramp, "velocity": [-1.0, 0, 0]}]
    return cm.CableModel(
        scene(
            1000.0,
            cable,
            model="cable",
            elements=elements,
            density=0.0,
            tolerance=tolerance,
            initial={"straight": [1.0, 0.0, 0.0]},
            vessel={"velocity": rows},
        )
    )


def test_axial_front_has_the_tension_of_the_impedance():
    """T = V(t) sqrt(EA m) at the vessel until the echo is back, at 2 L/c = 0.632 s."""
    model = pulled(128, 1e-8, ramp=0.1)
    for time in np.arange(0.05, 0.62, 0.05):
        model.step_to(time)
        expected = IMPEDANCE * min(time / 0.1, 1.0)
        assert model.top_tension == pytest.approx(expected, rel=5e-3)


def test_axial_wave_doubles_at_the_free_end():
    """It arrives after L/c = 0.316 s, undistorted, and the end moves with 2 V(t - L/c)."""
    model = pulled(128, 1e-8, ramp=0.1)
    for time in (0.25, 0.366, 0.4, 0.5, 0.6):
        model.step_to(time)
        since = time - 1000.0 / IMPEDANCE
        moved = 2.0 * (np.clip(since, 0.0, 0.1) ** 2 / 0.2 + max(since - 0.1, 0.0))
        assert model.tip_position[0] == pytest.approx(1000.0 - moved, abs=1e-3)


def test_sudden_stop_sends_a_front_of_minus_v_sqrt_ea_m():
    """A load is hoisted at 1 m/s and stopped within 50 ms: T falls by V sqrt(EA m), here by 40 %.

    In vacuum; 1 km of cable hangs with 8 kN at its end, and its echo returns after 0.63 s.
    """
    model = hoist_that_stops()
    assert model.top_tension == pytest.approx(8000.0, rel=1e-9)
    for time in (0.1, 0.125, 0.15, 0.3, 0.5, 0.65):
        model.step_to(time)
        lost = IMPEDANCE * np.clip((time - 0.1) / 0.05, 0.0, 1.0)
        assert model.top_tension == pytest.approx(8000.0 - lost, abs=0.01 * IMPEDANCE)


def test_axial_oscillation_of_an_end_mass():
    """A mass like the cable's, let go with the cable unstretched: the series of its modes."""
    from scipy.optimize import brentq

    ratio, length, stiffness = 1.0, 1000.0, 1e7
    roots = [
        brentq(lambda b: b * np.sin(b) - ratio * np.cos(b), n * np.pi + 1e-9, (n + 0.5) * np.pi)
        for n in range(200)
    ]
    load = GRAVITY * 1.0

    def displacement(t):
        """Of the mass, from the static place: modes sin(b s/L), static shape as a start."""
        total = 0.0
        for b in roots:
            # <phi, u_static> with mass m ds and M at the end, over <phi, phi>.
            s = np.linspace(0.0, 1.0, 4001)
            phi = np.sin(b * s)
            static = load * length**2 / stiffness * (s - s**2 / 2.0 + s / ratio)
            top = np.trapezoid(phi * static, s) + phi[-1] * static[-1] / ratio
            bottom = np.trapezoid(phi**2, s) + phi[-1] ** 2 / ratio
            omega = b * np.sqrt(stiffness) / length
            total += top / bottom * phi[-1] * (1.0 - np.cos(omega * t))
        return total

    cable = {**IDEAL, "axial_stiffness": stiffness, "submerged_weight": load}
    model = cm.CableModel(
        scene(
            length,
            cable,
            model="cable",
            elements=32,
            density=0.0,
            tolerance=1e-7,
            body={"mass": 1000.0, "submerged_weight": 1000.0 * load},
            initial={"straight": [0.0, 0.0, -1.0]},
        )
    )
    for time in (0.3, 0.7, 1.2, 2.31):
        model.step_to(time)
        expected = -1000.0 - displacement(time)
        assert model.tip_position[2] == pytest.approx(expected, abs=1e-3)


# The folded chain -------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("separation", "bending"), [(0.04, 1e-6), (0.02, 1.25e-7)])
def test_folded_chain_falls_faster_than_free(separation, bending):
    """Pinned at one end, let go beside it; 0.84721 sqrt(2L/g) in the limit of no separation b.

    Energy alone gives the fall x of the end. The fold is b wide, so that what is neglected is of
    the order b: a tenth of it is allowed. A trace of bending stiffness, smaller with b^3, keeps
    the fold from crumpling.
    """
    length = 1.0
    duration = motion.folded_chain_fall_time(length)
    times = np.array([0.3, 0.6, 0.8, 0.9]) * duration
    arm = (length - np.pi * separation / 2.0) / 2.0
    half = separation / 2.0
    points = [[0.0, 0.0, 0.0]]
    points += [
        [half * (1 - np.cos(a)), 0.0, -arm - half * np.sin(a)] for a in np.linspace(0, np.pi, 41)
    ]
    points.append([separation, 0.0, 0.0])
    cable = {
        **IDEAL,
        "submerged_weight": GRAVITY,
        "axial_stiffness": 1e5,
        "bending_stiffness": bending,
    }
    model = cm.CableModel(
        scene(
            length,
            cable,
            elements=400,
            density=0.0,
            tolerance=1e-4,
            initial={"points": points},
        )
    )
    exact = motion.folded_chain_fall(length, times)
    for time, fall in zip(times, exact, strict=True):
        model.step_to(time)
        assert -model.tip_position[2] == pytest.approx(fall, abs=separation / 10.0)
    assert -model.tip_position[2] > GRAVITY * model.time**2 / 2.0 + separation
