"""Damping by a cable's material, against springs with dashpots and the closed form of a bar."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import cablemodel as cm
from tests.verification.test_energy import simpson, stored

GRAVITY = 9.80665
LENGTH, STIFFNESS, MASS, LIGHT = 50.0, 1e6, 1000.0, 0.01
HEAVE, PERIOD = 0.05, 1.7


def wire(damping: float, **other: float) -> dict[str, float]:
    mass = other.get("mass", LIGHT)
    own = {"diameter": 0.01, "mass": mass, "submerged_weight": mass * GRAVITY}
    return {**own, "axial_stiffness": STIFFNESS, "axial_damping": damping, **other}


def heave(amplitude: float, period: float, until: float) -> list[dict[str, object]]:
    omega = 2.0 * math.pi / period
    times = np.linspace(0.0, until, round(100 * until) + 1)
    speeds = amplitude * omega * np.sin(omega * times)
    rows = zip(times.tolist(), speeds.tolist(), strict=True)
    return [{"t": t, "velocity": [0, 0, speed]} for t, speed in rows]


def load_on_a_wire(kind: dict[str, float], mass: float, tolerance: float, **parts: object) -> dict:
    body = {"mass": mass, "submerged_weight": mass * GRAVITY}
    return {
        "environment": {"water_density": 0.0},
        "cable_types": {"wire": kind},
        "line": [{"cable": {"type": "wire", "length": LENGTH}}, {"body": body}],
        "solver": {"tolerance": tolerance},
        **parts,
    }


def heaved(damping: float, tolerance: float, until: float, **other: float) -> dict:
    vessel = {"interpolation": "cubic", "velocity": heave(HEAVE, PERIOD, until)}
    run = {"duration": until, "output_interval": 0.02}
    return load_on_a_wire(wire(damping, **other), MASS, tolerance, vessel=vessel, run=run)


def spring_and_dashpot(damping: float, times: np.ndarray) -> np.ndarray:
    """Tension at the top of a load on a light wire that is heaved [N]."""
    omega = 2.0 * math.pi / PERIOD
    load = MASS * GRAVITY

    def pull(t, y):
        stretch = HEAVE * (1.0 - np.cos(omega * t)) - y[0]
        rate = HEAVE * omega * np.sin(omega * t) - y[1]
        return load + (STIFFNESS * stretch + damping * rate) / LENGTH

    def rates(t, y):
        return [y[1], pull(t, y) / MASS - GRAVITY]

    found = solve_ivp(rates, (0.0, times[-1]), [0.0, 0.0], t_eval=times, rtol=1e-9, atol=1e-12)
    return pull(times, found.y) + LIGHT * LENGTH * GRAVITY


@pytest.mark.parametrize("bending", [0.0, 10.0])
@pytest.mark.parametrize(("damping", "tolerance"), [(2e4, 1e-3), (2e4, 1e-4), (2e5, 1e-4)])
def test_a_load_on_a_light_wire_is_a_spring_with_a_dashpot(damping, tolerance, bending):
    run = cm.simulate(heaved(damping, tolerance, 6.0, bending_stiffness=bending))
    expected = spring_and_dashpot(damping, run.time)
    apart = np.abs(run["top_tension"] - expected).max()
    assert apart < 4.0 * tolerance * expected.max()
    assert np.ptp(spring_and_dashpot(0.0, run.time)) > 1.2 * np.ptp(expected)


def winch_rows() -> list[dict[str, float]]:
    turns = ((0.0, 0.0), (1.0, 0.0), (1.5, 2.0), (4.0, 2.0), (4.2, 0.0))
    return [{"t": t, "rate": rate} for t, rate in turns]


def of_a_line() -> dict:
    drum = [{"cable": {"type": "wire", "length": 50.0}}]
    payout = {"rate": winch_rows(), "drum": drum}
    run = {"duration": 10.0, "output_interval": 0.02}
    return load_on_a_wire(wire(2e4), MASS, 1e-3, payout=payout, run=run)


def of_a_system() -> dict:
    below = -LENGTH * (1.0 + MASS * GRAVITY / STIFFNESS)
    body = {"mass": MASS, "submerged_weight": MASS * GRAVITY, "inertia": [10, 10, 10],
            "points": {"eye": [0, 0, 0]}, "position": [0, 0, below]}  # fmt: skip
    items = [{"cable": {"type": "wire", "length": LENGTH}}]
    return {
        "environment": {"water_density": 0.0},
        "cable_types": {"wire": wire(2e4)},
        "vessels": {"ship": {"points": {"sheave": [0, 0, 0]}}},
        "bodies": {"load": body},
        "lines": {"fall": {"from": "ship.sheave", "to": "load.eye", "items": items}},
        "winches": {"drum": {"line": "fall", "at": "start", "drum": 50.0, "rate": winch_rows()}},
        "solver": {"tolerance": 1e-3},
        "run": {"duration": 10.0, "output_interval": 0.02},
    }


@pytest.mark.parametrize(
    ("scene", "name"), [(of_a_line, "top_tension"), (of_a_system, "fall.start_tension")]
)
def test_damping_goes_with_the_matter_that_a_winch_pays_out(scene, name):
    """The strain's rate of what is out is (z' - V (1 + e)) / l, not that of a mesh that grows."""
    run = cm.simulate(scene())
    turns = winch_rows()
    times, rates = [row["t"] for row in turns], [row["rate"] for row in turns]

    def strain(t, y):
        paid = np.interp(t, times, rates)
        e = y[0] / y[2] - 1.0
        return e, (y[1] - paid * (1.0 + e)) / y[2], paid

    def pull(t, y):
        e, rate, _paid = strain(t, y)
        return STIFFNESS * e + 2e4 * rate

    def motion(t, y):
        return [y[1], GRAVITY - pull(t, y) / MASS, strain(t, y)[2]]

    at_rest = [LENGTH * (1.0 + MASS * GRAVITY / STIFFNESS), 0.0, LENGTH]
    found = solve_ivp(motion, (0.0, 10.0), at_rest, t_eval=run.time, rtol=1e-9, max_step=0.05)
    expected = pull(run.time, found.y) + LIGHT * found.y[2] * GRAVITY
    assert np.abs(run[name] - expected).max() < 1e-3 * expected.max()


def test_the_modes_of_a_bar_are_damped_by_their_frequencies():
    """x'' = -w^2 (x + B x' / EA), w of a bar with a mass at its end: m w l / c = tan...; linear."""
    damping, mass = 5e3, 2.0
    line = load_on_a_wire(wire(damping, mass=mass), 50.0, 1e-5)
    model = cm.CableModel(line)
    free = cm.CableModel(load_on_a_wire(wire(0.0, mass=mass), 50.0, 1e-5))
    speed = math.sqrt(STIFFNESS / mass)
    # cot x = x m_body / (mu l), x = w l / c
    ratio = 50.0 / (mass * LENGTH)
    places = np.linspace(0.01, 3.0 * math.pi, 200001)
    left = np.cos(places) - ratio * places * np.sin(places)
    roots = places[:-1][np.sign(left[:-1]) != np.sign(left[1:])][:3] * speed / LENGTH
    for omega in roots:
        decay = 0.5 * omega**2 * damping / STIFFNESS
        pole = complex(-decay, math.sqrt(omega**2 - decay**2))
        assert np.abs(np.linalg.eigvals(model.linearise().A) - pole).min() < 3e-3 * omega
        assert np.abs(np.linalg.eigvals(free.linearise().A) - 1j * omega).min() < 3e-3 * omega


def test_what_the_material_takes_closes_the_balance_of_energy():
    model = cm.CableModel(heaved(2e4, 1e-4, 4.0))
    start, given, taken = stored(model), [model.energy()["vessel_power"]], [0.0]
    for n in range(400):
        model.step_to(0.01 * (n + 1))
        energy = model.energy()
        given.append(energy["vessel_power"])
        taken.append(energy["damping_power"])
    assert min(taken) >= 0.0
    lost = simpson(0.01, taken)
    assert lost > 30.0
    gain = stored(model) - start
    exchanged = simpson(0.01, np.abs(given))
    assert gain == pytest.approx(simpson(0.01, given) - lost, abs=1e-3 * exchanged)


def test_a_rope_that_is_caught_pulls_as_spring_and_dashpot_and_never_pushes_by_its_damping():
    """Thrown up and caught: tension only, T + D at least 0. A light rope in water without drag on
    the load; what it adds is its share of the mass, and the folds that it straightens."""
    stiffness, length, mass, damping, amplitude, period = 2e5, 20.0, 500.0, 5e3, 1.2, 1.9
    kind = wire(damping, mass=0.05, axial_stiffness=stiffness, added_mass=0.0, drag_tangential=0.0)
    body = {"mass": mass, "submerged_weight": mass * GRAVITY}
    vessel = {"interpolation": "cubic", "velocity": heave(amplitude, period, 4.0)}
    scene = {
        "cable_types": {"rope": kind},
        "line": [{"cable": {"type": "rope", "length": length}}, {"body": body}],
        "vessel": vessel,
        "solver": {"tolerance": 1e-4},
        "run": {"duration": 4.0, "output_interval": 0.01},
    }
    omega = 2.0 * math.pi / period

    def pull(t, y):
        strain = (amplitude * (1.0 - np.cos(omega * t)) - y[0]) / length
        rate = (amplitude * omega * np.sin(omega * t) - y[1]) / length
        return np.where(strain > 0.0, np.maximum(stiffness * strain + damping * rate, 0.0), 0.0)

    def rates(t, y):
        return [y[1], pull(t, y) / mass - GRAVITY]

    begin = [-mass * GRAVITY * length / stiffness, 0.0]
    times = np.linspace(0.0, 4.0, 401)
    found = solve_ivp(rates, (0.0, 4.0), begin, t_eval=times, rtol=1e-8, max_step=1e-3)
    expected = pull(times, found.y)
    run = cm.simulate(scene)
    assert run["top_tension"].max() == pytest.approx(expected.max(), rel=0.02)
    assert np.sqrt(np.mean((run["top_tension"] - expected) ** 2)) < 0.03 * expected.max()
    assert run["tension_min"].min() > -0.06 * expected.max()


def test_a_line_breaks_at_what_it_carries_with_its_damping():
    """A load is jerked up: T + B e' comes to the limit before T does."""
    limit = 11_500.0
    scene = of_a_system()
    scene["vessels"]["ship"]["velocity"] = heave(HEAVE, PERIOD, 4.0)
    scene["vessels"]["ship"]["interpolation"] = "cubic"
    del scene["winches"]
    scene["cuts"] = {"link": {"line": "fall", "at": "end", "tension": limit}}
    scene["run"]["duration"] = 4.0
    times = np.linspace(0.0, 4.0, 40001)
    tension = spring_and_dashpot(2e4, times) - LIGHT * LENGTH * GRAVITY
    first = times[np.argmax(tension >= limit)]
    assert 0.0 < first < 4.0
    run = cm.simulate(scene)
    assert run["link.time"][-1] == pytest.approx(first, abs=2e-3)


def test_direct_integration_refuses_damping_on_the_drum_too():
    scene = load_on_a_wire(wire(0.0, bending_stiffness=1.0), MASS, 1e-3)
    scene["cable_types"]["damped"] = wire(1e3, bending_stiffness=1.0)
    scene["payout"] = {"drum": [{"cable": {"type": "damped", "length": 10.0}}]}
    scene["solver"] = {"method": "direct_integration"}
    with pytest.raises(cm.SceneError, match=r"damped.axial_damping: .*no damping of the material"):
        cm.CableModel(scene)


def test_bad_damping_is_told():
    with pytest.raises(cm.SceneError, match=r"cable_types.wire.axial_damping: .*at least 0"):
        cm.load_scene(load_on_a_wire(wire(-1.0), MASS, 1e-3))
    scene = load_on_a_wire(wire(1e3, bending_stiffness=1.0), MASS, 1e-3)
    scene["solver"] = {"method": "direct_integration"}
    with pytest.raises(cm.SceneError, match=r"no damping of the material .given: 1000"):
        cm.CableModel(scene)


def test_units_of_damping():
    scene = cm.load_scene(load_on_a_wire({**wire(0.0), "axial_damping": "20 kN*s"}, MASS, 1e-3))
    assert scene.cable_types["wire"].axial_damping == 2e4
