"""Cable and bodies in waves: forces by quadrature, motions by ODEs, energy, the free surface."""

import math

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson, quad, solve_ivp
from scipy.optimize import brentq

import cablemodel as cm
from cablemodel.scene.sea import sea
from tests.verification.scenes import CABLE_K

RHO, GRAVITY = 1025.0, 9.80665
PILE = {
    "diameter": 0.05, "mass": 4.0, "axial_stiffness": 1e9, "bending_stiffness": 0.0,
    "drag_normal": 1.1, "drag_tangential": 0.0, "added_mass": 0.9,
}  # fmt: skip


def scene(waves, cable, line, *, tolerance=1e-3, current=None, **changes):
    return cm.load_scene(
        {
            "environment": {"waves": waves, "current": current},
            "cable_types": {"C": cable},
            "line": line,
            "solver": {"tolerance": tolerance},
            **changes,
        }
    )


def taut_pile(top: float, bottom: float, waves, elements=24, **changes):
    """A vertical line that 1e6 N keep straight: a beam on two supports, far from resonance."""
    length = (top - bottom) / 1.001
    return scene(
        waves, PILE,
        [{"cable": {"type": "C", "length": length, "model": "cable", "elements": elements}}],
        end={"anchor": [0, 0, bottom]}, vessel={"position": [0, 0, top]}, tolerance=1e-4,
        initial={"points": [[0, 0, top], [0, 0, bottom]]}, **changes,
    )  # fmt: skip


def morison(field, t, z, flow=0.0):
    """Force per length across a fixed vertical cylinder of PILE [N/m], by hand."""
    (k,), (w,), (a,) = field.number, field.frequency, field.amplitude
    theta = -w * t + field.phase[0]
    level = min(z, 0.0)
    u = flow + a * w * math.exp(k * level) * math.cos(theta)
    rate = a * w * w * math.exp(k * level) * math.sin(theta)
    d = PILE["diameter"]
    inertia = RHO * math.pi / 4 * d * d * (1 + PILE["added_mass"]) * rate
    return 0.5 * RHO * PILE["drag_normal"] * d * abs(u) * u + inertia


@pytest.mark.parametrize("height", [0.05, 1.5])
@pytest.mark.parametrize("flow", [0.0, 0.4])
def test_morison_force_on_a_fixed_line(height, flow):
    """Inertia where the wave is low, drag where it is high: the reaction at the upper support."""
    top, bottom = -2.0, -26.0
    given = taut_pile(
        top, bottom, {"regular": {"height": height, "period": 6}}, current=[flow, 0, 0]
    )
    field, model = sea(given), cm.CableModel(given)
    found, expected = [], []
    for n in range(48, 96):
        model.step_to(0.25 * n)
        found.append(model.top_force[0])

        def lever(z, t=model.time):
            return morison(field, t, z, flow) * (z - bottom) / (top - bottom)

        # Per unstretched length: root of the stretch in the drag, and ds = dz / 1.001.
        expected.append(quad(lever, bottom, top)[0])
    scale = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, atol=0.002 * scale)
    assert scale > 0.4  # [N]


@pytest.mark.parametrize(("elements", "within"), [(8, 0.002), (12, 0.005), (24, 0.002)])
def test_a_line_through_the_surface_feels_the_water_below_it(elements, within):
    """Up to the moving surface, with the motion at z = 0 above it.

    Twelve elements of 2 m have no node at z = 0, where the water's motion has its kink.
    """
    top, bottom = 3.0, -21.0
    given = taut_pile(top, bottom, {"regular": {"height": 2.0, "period": 6}}, elements)
    field, model = sea(given), cm.CableModel(given)
    found, expected = [], []
    for n in range(48, 96):
        model.step_to(0.25 * n)
        found.append(model.top_force[0])
        surface = float(field.elevation(model.time))

        def lever(z, t=model.time):
            return morison(field, t, z) * (z - bottom) / (top - bottom)

        expected.append(quad(lever, bottom, surface, points=[0.0] if surface > 0 else None)[0])
    scale = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, atol=within * scale)


def test_a_neutral_body_follows_the_orbits():
    """On a rubber thread that hardly pulls: Morison's equation for a point, solved by SciPy."""
    thread = {
        "diameter": 2e-4, "mass": 3.2e-5, "submerged_weight": 0.0, "axial_stiffness": 0.1,
        "bending_stiffness": 0.0, "drag_normal": 0.0, "drag_tangential": 0.0, "added_mass": 0.0,
    }  # fmt: skip
    mass, added, area, cd = 100.0, 60.0, 0.2, 0.8
    body = {
        "mass": mass, "submerged_weight": 0.0, "added_mass": added, "added_mass_axial": added,
        "drag_area": area, "drag_area_axial": area, "drag_coefficient": cd,
        "drag_coefficient_axial": cd,
    }  # fmt: skip
    given = scene(
        {"regular": {"height": 1.0, "period": 8, "direction": 0.7}}, thread,
        [{"cable": {"type": "C", "length": 5, "model": "cable"}}, {"body": body}],
        initial={"points": [[0, 0, 0], [0, 0, -6]]}, tolerance=1e-4,
    )  # fmt: skip
    field, model = sea(given), cm.CableModel(given)

    def law(t, y):
        step = 1e-5
        here = y[None, :3]
        water = field.velocity(t, here)[0]
        rate = (field.velocity(t + step, here) - field.velocity(t - step, here))[0] / (2 * step)
        flow = water - y[3:]
        force = 0.5 * RHO * cd * area * np.linalg.norm(flow) * flow + (mass + added) * rate
        distance = np.linalg.norm(y[:3])
        force -= thread["axial_stiffness"] * (distance / 5.0 - 1.0) * y[:3] / distance
        return np.concatenate([y[3:], force / (mass + added)])

    times = np.arange(0.5, 30.5, 0.5)
    exact = solve_ivp(law, (0, 30), [0, 0, -6, 0, 0, 0], t_eval=times, rtol=1e-9, atol=1e-9).y
    found = []
    for time in times:
        model.step_to(time)
        found.append(model.tip_position)
    orbit = np.ptp(exact[2])
    assert orbit > 0.5  # e^(-6 k) of 1 m is 0.69
    np.testing.assert_allclose(found, exact[:3].T, atol=0.003 * orbit)


def buoy(length: float, waves):
    """A buoy of 50 kg that displaces 100 kg on a neutral line from a tow point 20 m deep."""
    neutral = {**CABLE_K, "submerged_weight": 0.0, "mass": RHO * math.pi / 4 * 0.01666**2}
    body = {"mass": 50, "submerged_weight": -50 * GRAVITY, "added_mass": 50,
            "added_mass_axial": 50, "drag_area": 0.2, "drag_area_axial": 0.2}  # fmt: skip
    initial = "static"
    if length > 20:  # slack: an arc of this length to a point of the surface
        chord = np.array([8.0, 20.0])
        half = brentq(lambda a: math.sin(a) / a - np.linalg.norm(chord) / length, 0.1, 3.0)
        way = np.linspace(-half, half, 61)
        along = 0.5 * (1.0 + np.sin(way) / math.sin(half))
        aside = 0.5 * (np.cos(way) - math.cos(half)) / math.sin(half)
        x = along * chord[0] + aside * chord[1]
        z = -20.0 + along * chord[1] - aside * chord[0]
        initial = {"points": np.column_stack([x, 0 * x, z]).tolist()}
    return scene(
        waves, neutral, [{"cable": {"type": "C", "length": length}}, {"body": body}],
        vessel={"position": [0, 0, -20]}, tolerance=1e-4, initial=initial,
    )  # fmt: skip


def test_a_buoy_is_pulled_under_and_floats():
    """Held down by its line it lifts with all its buoyancy; on a long one it floats, half wet,
    and goes up and down with a long wave."""
    still = {"regular": {"height": 1e-6, "period": 12}}
    held = cm.CableModel(buoy(15.0, still))
    assert held.top_tension == pytest.approx(50 * GRAVITY, rel=1e-3)
    given = buoy(26.0, {"regular": {"height": 1.0, "period": 12}, "ramp": 40})
    field, model = sea(given), cm.CableModel(given)
    heave, surface = [], []
    for n in range(320):
        model.step_to(0.25 * (n + 1))
        heave.append(model.tip_position[2])
        surface.append(float(field.elevation(model.time, *model.tip_position[:2])))
    late = slice(200, None)
    assert np.ptp(surface[late]) > 0.9
    np.testing.assert_allclose(heave[late], surface[late], atol=0.01)


@pytest.mark.parametrize("kind", ["regular", "jonswap"])
def test_energy_is_exchanged_with_vessel_and_water_alone(kind):
    waves = {
        "regular": {"regular": {"height": 1.5, "period": 6}},
        "jonswap": {"jonswap": {"hs": 1.5, "tp": 6, "seed": 3, "components": 30}},
    }[kind]
    given = scene(
        waves, CABLE_K, [{"cable": {"type": "C", "length": 40}}], tolerance=1e-4,
        vessel={"position": [0, 0, -3], "velocity": [{"t": 0, "velocity": [0, 0, 0]},
                {"t": 10, "velocity": [0.5, 0, 0]}]},
    )  # fmt: skip
    model = cm.CableModel(given)
    times = np.arange(0.0, 20.0, 0.02)
    stored, power, exchanged = [], [], []
    for time in times:
        if time > 0:
            model.step_to(time)
        energy = model.energy()
        parts = [energy[n] for n in ("kinetic", "axial", "bending", "potential")]
        stored.append(sum(parts))
        power.append(energy["vessel_power"] - energy["drag_power"])
        exchanged.append(abs(energy["vessel_power"]) + abs(energy["drag_power"]))
    balance = cumulative_simpson(power, x=times, initial=0.0)
    error = np.abs(np.array(stored) - stored[0] - balance).max()
    assert error < 3e-4 * cumulative_simpson(exchanged, x=times, initial=0.0)[-1]


def test_plane_and_space_agree_and_turn_together():
    """A catenary with a buoy in the plane of the waves, in space, and both turned by 30 degrees."""
    line = [
        {"cable": {"type": "C", "length": 30}},
        {"body": {"mass": 2, "submerged_weight": -30, "drag_area": 0.02, "added_mass": 3}},
        {"cable": {"type": "C", "length": 30}},
    ]
    results = []
    for angle, planar in ((0.0, None), (0.0, False), (math.pi / 6, None)):
        c, s = math.cos(angle), math.sin(angle)
        given = scene(
            {"regular": {"height": 2, "period": 7, "direction": angle}}, CABLE_K, line,
            end={"anchor": [45 * c, 45 * s, -30]},
        )  # fmt: skip
        model = cm.CableModel(given, planar=planar)
        assert model.planar == (planar is None)
        rows = []
        for n in range(60):
            model.step_to(0.5 * (n + 1))
            position = model.sample(np.linspace(0, 60, 7)).position
            along = position[:, 0] * c + position[:, 1] * s
            rows.append([model.top_tension, *along, *position[:, 2]])
        results.append(np.array(rows))
    # Newton leaves different parts of its tolerance.
    np.testing.assert_allclose(results[1], results[0], rtol=2e-3, atol=1e-3)
    np.testing.assert_allclose(results[2], results[0], rtol=2e-3, atol=1e-3)


def test_plane_and_space_agree_with_a_rigid_body_and_a_winch():
    """A body of finite length at the end, hung through the surface and paid out at 0.5 m/s."""
    body = {"mass": 40, "submerged_weight": 150, "half_length": 0.6, "rotary_inertia": 8,
            "added_mass": 25, "added_mass_axial": 5, "drag_area": 0.3,
            "drag_area_axial": 0.1}  # fmt: skip
    results = []
    for planar in (None, False):
        given = scene(
            {"regular": {"height": 1.5, "period": 6}}, CABLE_K,
            [{"cable": {"type": "C", "length": 8}}, {"body": body}],
            vessel={"position": [0, 0, 2]},
            payout={"rate": [{"t": 0, "rate": 0}, {"t": 5, "rate": 0.5}],
                    "drum": [{"cable": {"type": "C", "length": 12}}]},
        )  # fmt: skip
        model = cm.CableModel(given, planar=planar)
        assert model.planar == (planar is None)
        # 2 m of cable hang in air.
        weight = 150 + 8 * CABLE_K["submerged_weight"]
        weight += 2 * (CABLE_K["mass"] * GRAVITY - CABLE_K["submerged_weight"])
        assert model.top_tension == pytest.approx(weight, rel=2e-3)
        rows = []
        for n in range(80):
            model.step_to(0.25 * (n + 1))
            rows.append([model.top_tension, *model.tip_position, *model.bodies[0].direction])
        results.append(np.array(rows))
    assert np.ptp(results[0][:, 1]) > 0.2
    assert model.line_length == pytest.approx(8 + 0.25 * 5 + 0.5 * 15, rel=1e-9)
    np.testing.assert_allclose(results[1], results[0], rtol=2e-3, atol=2e-3)


def jumper(tolerance: float, elements: int | None = None):
    """A run of 30 s: positions (60, 13, 3) [m] and tensions at the top (60,) [N]."""
    given = scene(
        {"regular": {"height": 2, "period": 7}}, CABLE_K,
        [{"cable": {"type": "C", "length": 60, "elements": elements}}],
        end={"anchor": [45, 0, -30]}, tolerance=tolerance,
    )  # fmt: skip
    model = cm.CableModel(given)
    rows, tension = [], []
    for n in range(60):
        model.step_to(0.5 * (n + 1))
        rows.append(model.sample(np.linspace(0, 60, 13)).position)
        tension.append(model.top_tension)
    return np.array(rows), np.array(tension)


@pytest.fixture(scope="module")
def fine_jumper():
    return jumper(1e-6, 96)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 2e-5])
def test_a_jumper_keeps_its_promise(tolerance, fine_jumper):
    """At the surface, too: tension does not stop converging where elements are wet in part."""
    rows, tension = jumper(tolerance)
    apart = np.linalg.norm(rows - fine_jumper[0], axis=2)
    assert apart.max() < tolerance * 60
    assert np.abs(tension - fine_jumper[1]).max() < 10 * tolerance * fine_jumper[1].max()


def test_a_line_that_is_towed_floats():
    """From its static start on: wet by what carries its weight, pulled by that share of its drag.

    Straight up, where lines that are buoyant begin in water without a surface, it would stand in
    the air.
    """
    weight, mass, speed, length = -2.0, 0.6, 1.0, 60.0
    cable = CABLE_K | {"diameter": 0.03, "mass": mass, "submerged_weight": weight}
    given = scene(
        {"regular": {"height": 1.0, "period": 6}}, cable | {"bending_stiffness": 1.0},
        [{"cable": {"type": "C", "length": length}}],
        vessel={"position": [0, 0, 0.5], "velocity": [speed, 0, 0]}, tolerance=1e-4,
    )  # fmt: skip
    model, field = cm.CableModel(given), sea(given)
    wet = mass * GRAVITY / (mass * GRAVITY - weight)
    s = np.linspace(20, length, 9)  # beyond what hangs above the water
    start = model.sample(s)
    depth = brentq(lambda x: 0.5 + x * (0.75 - 0.25 * x * x) - wet, -1, 1) * 0.015
    np.testing.assert_allclose(start.position[:, 2], -depth, atol=2e-4)
    drag = 0.5 * RHO * math.pi * 0.03 * cable["drag_tangential"] * speed**2
    np.testing.assert_allclose(start.tension, wet * drag * (length - s), atol=0.5)
    for t in np.arange(20.0, 30.0, 0.5):
        model.step_to(t)
        place = model.sample(np.linspace(10, length, 6)).position
        surface = field.elevation(t, place[:, 0], place[:, 1])
        np.testing.assert_allclose(place[:, 2], surface, atol=0.05)
