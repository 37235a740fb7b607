"""Water that accelerates: its force along a line too, and what currents that change in time do."""

import math

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson, quad, solve_ivp

import cablemodel as cm
from cablemodel.scene.sea import sea
from tests.verification.direct_scenes import POINT_BODY
from tests.verification.scenes import CABLE_K

RHO, GRAVITY = 1025.0, 9.80665
DIAMETER, ADDED = 0.05, 0.9
AREA = math.pi / 4 * DIAMETER**2
ROPE = {
    "diameter": DIAMETER, "mass": RHO * AREA, "submerged_weight": 0.0, "axial_stiffness": 1e8,
    "bending_stiffness": 0.0, "drag_normal": 0.0, "drag_tangential": 0.0, "added_mass": ADDED,
}  # fmt: skip
"""Neutral: straight when taut, so that no sag makes tension of what pushes across."""
THREAD = {
    "diameter": 2e-4, "mass": 3.2e-5, "submerged_weight": 0.0, "axial_stiffness": 0.1,
    "bending_stiffness": 0.0, "drag_normal": 0.0, "drag_tangential": 0.0, "added_mass": 0.0,
}  # fmt: skip
RAMP = {
    "table": [{"z": 0, "t": 0, "velocity": [0, 0, 0]}, {"z": 0, "t": 20, "velocity": [4, 2, 0]}]
}
RATE = np.array([0.2, 0.1, 0.0])
"""Of that current [m/s2]."""


def taut(end, environment):
    """A line of ROPE from 2 m below the surface to `end`, stretched by a hundredth: 1 MN."""
    top = np.array([0.0, 0.0, -2.0])
    length = float(np.linalg.norm(end - top)) / 1.01
    return cm.load_scene(
        {
            "environment": environment, "cable_types": {"C": ROPE}, "end": {"anchor": [*end]},
            "line": [{"cable": {"type": "C", "length": length, "model": "cable", "elements": 24}}],
            "vessel": {"position": [*top]}, "initial": {"points": [[*top], [*end]]},
            "solver": {"tolerance": 1e-4},
        }
    )  # fmt: skip


def test_a_wave_pushes_a_fixed_line_along_itself():
    """The vertical reaction at the top of a vertical line, by quadrature: rho A times the water's
    vertical acceleration, each part shared by the two ends as a held rod does."""
    top, bottom = -2.0, -26.0
    waves = {"regular": {"height": 0.5, "period": 6}}
    given = taut(np.array([0.0, 0.0, bottom]), {"waves": waves})
    field, model = sea(given), cm.CableModel(given)
    (k,), (w,), (a,) = field.number, field.frequency, field.amplitude
    at_rest = model.top_force[2]
    found, expected = [], []
    for n in range(48, 96):
        model.step_to(0.25 * n)
        found.append(model.top_force[2] - at_rest)
        rate = -a * w * w * math.cos(-w * model.time)
        expected.append(
            quad(
                lambda z, rate=rate: (
                    RHO * AREA * rate * math.exp(k * z) * (z - bottom) / (top - bottom) / 1.01
                ),
                bottom,
                top,
            )[0]
        )
    scale = np.abs(expected).max()
    assert scale > 1.0  # [N]
    np.testing.assert_allclose(found, expected, atol=0.01 * scale)


@pytest.mark.parametrize("waves", [None, {"regular": {"height": 1e-6, "period": 8}}])
@pytest.mark.parametrize("end", [[20.0, 0.0, -22.0], [20.0, 10.0, -22.0], [0.0, 0.0, -25.0]])
def test_a_current_that_rises_pushes_a_fixed_line(end, waves):
    """rho A (1 + Ca) du/dt across, rho A du/dt along; a uniform load is halved by the two ends.

    Without waves and with, where it is another part of the code that does it.
    """
    end = np.array(end)
    model = cm.CableModel(taut(end, {"current": RAMP, "waves": waves}))
    at_rest = model.top_force
    model.step_to(6.0)
    tangent = (end - [0, 0, -2]) / np.linalg.norm(end - [0, 0, -2])
    along = tangent * (tangent @ RATE)
    total = RHO * AREA * (RATE + ADDED * (RATE - along)) * model.line_length
    found = model.top_force - at_rest
    np.testing.assert_allclose(found, 0.5 * total, atol=1e-3 * np.linalg.norm(total))


def test_only_what_changes_pushes():
    """After the table's last row the current is steady, and without drag nothing is left."""
    table = [{"z": 0, "t": t, "velocity": [u, 0, 0]} for t, u in ((0, 0), (5, 1), (6, 1), (7, 3))]
    model = cm.CableModel(taut(np.array([0.0, 0.0, -25.0]), {"current": {"table": table}}))
    at_rest = model.top_force[0]
    half = 0.5 * RHO * AREA * (1 + ADDED) * model.line_length
    for time, rate in ((5.0, 0.2), (5.9, 0.0), (7.0, 2.0), (7.9, 0.0)):
        model.step_to(time)
        assert model.top_force[0] - at_rest == pytest.approx(rate * half, abs=0.02 * half)


@pytest.mark.parametrize("planar", [None, False])
@pytest.mark.parametrize("half_length", [0.0, 0.2])
@pytest.mark.parametrize("waves", [None, {"regular": {"height": 1e-6, "period": 8}}])
def test_a_body_goes_along_with_the_water(waves, half_length, planar):
    """By (displaced + added mass) / (mass + added mass), without drag, as a sphere in a bubbly
    pipe does; by the scene's current, and by the caller's, blown up within a microsecond."""
    mass, displaced, added = 100.0, 90.0, 60.0
    body = {
        "mass": mass, "submerged_weight": (mass - displaced) * GRAVITY, "added_mass": added,
        "added_mass_axial": added,
    }  # fmt: skip
    if half_length:
        body |= {"half_length": half_length, "rotary_inertia": 5.0}
    share = (displaced + added) / (mass + added)
    scene = {
        "cable_types": {"C": THREAD}, "solver": {"tolerance": 1e-4},
        "line": [{"cable": {"type": "C", "length": 5, "model": "cable"}}, {"body": body}],
        "initial": {"points": [[0, 0, -20], [0, 0, -26]]}, "vessel": {"position": [0, 0, -20]},
    }  # fmt: skip
    table = [{"z": 0, "t": 0, "velocity": [0, 0, 0]}, {"z": 0, "t": 10, "velocity": [3, 0, 0]}]
    risen = cm.CableModel(
        cm.load_scene({**scene, "environment": {"waves": waves, "current": {"table": table}}}),
        planar=planar,
    )
    risen.step_to(2.0)
    assert risen.bodies[0].velocity[0] == pytest.approx(share * 0.6, rel=2e-3)
    assert risen.bodies[0].position[0] == pytest.approx(share * 0.6, rel=2e-3)
    assert risen.planar == (planar is None)
    blown = cm.CableModel(cm.load_scene({**scene, "environment": {"waves": waves}}), planar=planar)
    blown.step(1.0)
    blown.step(1e-6, current=[0.5, 0, 0])
    assert blown.bodies[0].velocity[0] == pytest.approx(share * 0.5, rel=2e-3)
    for _ in range(4):
        blown.step(0.25, current=[0.5, 0, 0])
    assert blown.bodies[0].velocity[0] == pytest.approx(share * 0.5, rel=5e-3)


def test_a_neutral_line_is_moved_along_itself():
    """A rubber line, held at both ends, by the water of a low wave: the equation of a rod that
    moves along itself, m z_tt = EA z_ss + rho A a_w, by SciPy on 60 points."""
    top, bottom, stiffness = -2.0, -26.0, 1000.0
    mass = RHO * AREA
    given = cm.load_scene(
        {
            "environment": {"waves": {"regular": {"height": 0.1, "period": 8}}},
            "cable_types": {"C": ROPE | {"axial_stiffness": stiffness}},
            "line": [{"cable": {"type": "C", "length": 20, "model": "cable", "elements": 24}}],
            "vessel": {"position": [0, 0, top]}, "end": {"anchor": [0, 0, bottom]},
            "solver": {"tolerance": 1e-6},
        }
    )  # fmt: skip
    field, model = sea(given), cm.CableModel(given)
    rest = np.linspace(top, bottom, 61)
    inner = rest[1:-1]
    here = np.column_stack([0 * inner, 0 * inner, inner])
    spacing = 20 / 60

    def law(t, y):
        z = np.concatenate([[0.0], y[:59], [0.0]])
        ahead, behind = field.velocity(t + 1e-4, here), field.velocity(max(0, t - 1e-4), here)
        push = RHO * AREA * (ahead - behind)[:, 2] / (1e-4 + min(t, 1e-4))
        return np.concatenate([y[59:], (stiffness * np.diff(z, 2) / spacing**2 + push) / mass])

    times = np.arange(0.5, 20.5, 0.5)
    exact = solve_ivp(law, (0, 20), np.zeros(118), t_eval=times, rtol=1e-8, atol=1e-10).y[29]
    found = []
    for time in times:
        model.step_to(time)
        found.append(model.sample(10.0).position[0, 2] - rest[30])
    assert np.ptp(exact) > 2e-3
    np.testing.assert_allclose(found, exact, atol=0.02 * np.ptp(exact))


def hung(method, current, body=POINT_BODY, model="elastica", **solver):
    """25 m of cable K with a body, as the solvers of both methods take it."""
    return cm.load_scene(
        {
            "environment": {"current": current}, "cable_types": {"K": CABLE_K},
            "line": [{"cable": {"type": "K", "length": 25, "model": model}}, {"body": body}],
            "solver": {"method": method, **solver},
        }
    )  # fmt: skip


GUST = {
    "table": [
        {"z": z, "t": t, "velocity": [share * u, share * v, 0]}
        for t, u, v in ((0, 0, 0), (2, 0, 0), (4, 0.5, 0.2), (8, -0.1, 0.2))
        for z, share in ((0, 1.0), (-30, 0.6))
    ]
}
RIGID = POINT_BODY | {
    "half_length": 0.3, "rotary_inertia": 0.4, "centre_offset": 0.2, "added_mass_axial": 0.5
}  # fmt: skip


@pytest.mark.parametrize("body", [POINT_BODY, RIGID])
@pytest.mark.parametrize("model", ["elastica", "cable"])
@pytest.mark.parametrize("live", [False, True])
def test_both_solvers_agree_in_a_gust(model, body, live):
    """A current of the scene over depth and time, or the caller's.

    What its kinks make ring along the line, +- 0.3 N of 78, the long steps of the direct solver
    damp: tensions are compared by their means over a second, within 0.3 N.
    """
    results = []
    for method, solver in (
        ("finite_element", {"tolerance": 1e-5}),
        ("direct_integration", {"time_step": 0.02, "node_spacing": 0.5}),
    ):
        run = cm.CableModel(hung(method, None if live else GUST, body, model, **solver))
        rows = []
        for n in range(1, 61):
            t = 0.2 * n
            flow = None
            if live:
                flow = [
                    float(np.interp(t, (0, 2, 4, 8), u))
                    for u in ((0, 0, 0.5, -0.1), (0, 0, 0.2, 0.2))
                ]
                flow.append(0.0)
            run.step_to(t, current=flow)
            rows.append([*run.tip_position, run.top_tension])
        results.append(np.array(rows))
    assert np.ptp(results[0][:, 0]) > 0.5
    np.testing.assert_allclose(results[1][:, :3], results[0][:, :3], atol=0.01)
    there, here = (np.convolve(rows[:, 3], np.full(5, 0.2), "valid") for rows in results)
    np.testing.assert_allclose(here, there, rtol=4e-3)


@pytest.mark.parametrize("body", [POINT_BODY, RIGID])
def test_energy_comes_from_the_water(body):
    """What the current gives as it accelerates is in drag_power, on cable and bodies."""
    model = cm.CableModel(hung("finite_element", GUST, body, tolerance=1e-5))
    times = np.arange(0.0, 12.0, 0.02)
    stored, power, exchanged = [], [], []
    for time in times:
        if time > 0:
            model.step_to(time)
        energy = model.energy()
        stored.append(sum(energy[n] for n in ("kinetic", "axial", "bending", "potential")))
        taken = energy["drag_power"] + energy["added_mass_power"]
        power.append(energy["vessel_power"] - taken)
        exchanged.append(abs(energy["drag_power"]))
    # Power jumps where the current has a kink: by pieces.
    balance = np.zeros(len(times))
    for first, last in ((0, 100), (100, 200), (200, 400), (400, 599)):
        piece = np.array(power[first : last + 1])
        if first:
            piece[0] = 2 * piece[1] - piece[2]
        balance[first : last + 1] = balance[first] + cumulative_simpson(
            piece, x=times[first : last + 1], initial=0.0
        )
    error = np.abs(np.array(stored) - stored[0] - balance).max()
    assert error < 2e-3 * cumulative_simpson(exchanged, x=times, initial=0.0)[-1]
