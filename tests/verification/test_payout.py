"""Pay-out and reel-in against closed forms, and what must be conserved."""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification import scenes

MASS, GRAVITY, LENGTH, STIFFNESS = 1000.0, 9.80665, 10.0, 1e9
ANGLE = 1e-3  # small: at 1e-2 the amplitude itself shifts the body by 1.3e-5 m in 10 s


def pendulum(rate, tolerance):
    """A heavy point body on a massless, hardly stretching cable in vacuum, released at ANGLE."""
    stretched = LENGTH * (1.0 + MASS * GRAVITY * np.cos(ANGLE) / STIFFNESS)
    end = [stretched * np.sin(ANGLE), 0.0, -stretched * np.cos(ANGLE)]
    return cm.load_scene(
        {
            "environment": {"water_density": 0},
            "cable_types": {"c": {"diameter": 0.01, "mass": 1e-4, "axial_stiffness": STIFFNESS}},
            "line": [
                {"cable": {"type": "c", "length": LENGTH, "model": "cable", "elements": 4}},
                {"body": {"mass": MASS, "submerged_weight": MASS * GRAVITY}},
            ],
            "initial": {"points": [[0, 0, 0], end]},
            "payout": {
                "rate": [{"t": 0, "rate": rate}],
                "drum": [{"cable": {"type": "c", "length": 20, "model": "cable"}}],
            },
            "solver": {"tolerance": tolerance},
        }
    )


@pytest.mark.parametrize("planar", [None, False])
@pytest.mark.parametrize(
    ("rate", "expected"),
    [(0.5, (-0.0640678512, -0.6247651622)), (-0.4, (0.6125181420, 0.2817748820))],
)
def test_pendulum_whose_length_changes(rate, expected, planar):
    """Closed form in Bessel functions; the body is right within tau L at both times."""
    tolerance = 1e-6
    model = cm.CableModel(pendulum(rate, tolerance), planar=planar)
    for time, share in zip((5.0, 10.0), expected, strict=True):
        model.step_to(time)
        length = LENGTH + rate * time
        x, _, z = model.tip_position
        assert length * np.arctan2(x, -z) == pytest.approx(
            length * ANGLE * share, abs=tolerance * LENGTH
        )
        assert model.line_length == pytest.approx(length, abs=1e-12 * 30)


@pytest.mark.parametrize(("other", "metres"), [(False, 30.0), (True, 20.0)])
def test_cable_on_the_drum_has_the_elements_that_it_is_given(other, metres):
    """About one a metre instead of 10 m, of the line's top element, too, from which it goes on."""
    kind = {"diameter": 0.02, "mass": 0.5, "axial_stiffness": 1e6}
    drum = {"type": "d" if other else "c", "length": 40.0, "elements": 40}
    model = cm.CableModel(
        cm.load_scene(
            {
                "cable_types": {"c": kind, "d": kind},
                "line": [{"cable": {"type": "c", "length": 40.0, "elements": 4}}],
                "payout": {"rate": [{"t": 0, "rate": 0.5}], "drum": [{"cable": drum}]},
            }
        )
    )
    model.step_to(40.0)
    assert 0.8 * metres <= model.statistics["elements"] - 4 <= metres + 1


def winch_scene(model="hybrid"):
    scene = cm.load_scene("scenes/payout_with_bodies.yaml").to_dict()
    for item in [*scene["line"], *scene["payout"]["drum"]]:
        if "cable" in item:
            item["cable"]["model"] = model
    return cm.load_scene(scene)


@pytest.mark.parametrize("model", ["hybrid", "cable", "elastica"])
def test_cable_is_conserved_and_bodies_come_and_go(model):
    """40 m out and 32 m on the drum: out to the end of the drum, and back to less than a metre."""
    simulated = cm.CableModel(winch_scene(model))
    seen = []
    for time in np.arange(2.0, 170.1, 2.0):
        simulated.step_to(time)
        assert simulated.line_length + simulated.drum_length == pytest.approx(72.0, abs=1e-10)
        seen.append((len(simulated.bodies), simulated.winch))
    assert max(bodies for bodies, _ in seen) == 3
    assert ("drum empty") in {winch for _, winch in seen}
    assert seen[-1] == (0, "shortest length")
    assert simulated.line_length == pytest.approx(0.4)
    assert simulated.payout_rate == 0.0


def test_rate_is_reported_at_the_present_time():
    simulated = cm.CableModel(winch_scene())
    simulated.step_to(20.5)
    assert simulated.payout_rate == pytest.approx(0.35, abs=1e-12)
    simulated.step(0.5, payout_rate=0.1)
    assert simulated.payout_rate == pytest.approx(0.1, abs=1e-12)


def test_results_converge_with_the_tolerance():
    """Bodies leaving the drum and taken back: positions within tau L of a run 30 times finer."""
    runs = []
    for tolerance in (1e-3, 3e-5):
        scene = winch_scene().to_dict()
        scene["solver"]["tolerance"] = tolerance
        simulated = cm.CableModel(cm.load_scene(scene))
        tips = []
        for time in (30.0, 50.0, 60.0, 90.0, 110.0, 130.0):
            simulated.step_to(time)
            tips.append(simulated.tip_position)
        runs.append(np.array(tips))
    assert np.abs(runs[0] - runs[1]).max() <= 1e-3 * 72.0


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_a_body_leaves_the_drum_when_the_cable_below_it_is_out(tolerance):
    """5 m and 17 m are out at 27.64 and 44.79 s; within .3 s the line bears its weight."""
    scene = cm.load_scene("scenes/payout_with_bodies.yaml", [f"solver.tolerance={tolerance}"])
    simulated = cm.CableModel(scene)
    weight = 20.0
    ramp = 0.35  # of cable, while the rate rises to 0.7 m/s from 20 to 21 s
    for bodies, out in enumerate((5.0, 17.0), start=1):
        leaves = 21.0 + (out - ramp) / 0.7
        simulated.step_to(leaves - 0.01)
        before = simulated.top_tension
        assert len(simulated.bodies) == bodies
        for part in (0.2, 0.25, 0.3):
            simulated.step_to(leaves + part)
        assert len(simulated.bodies) == bodies + 1
        assert simulated.top_tension - before == pytest.approx(weight, rel=0.5)


def test_a_winch_under_short_steps_makes_no_shocks():
    """In and out at 100 Hz under way: where elements are joined the tension goes on as it was.

    Elements that are brought to their length in the norm of a step of 10 ms answer with inertia
    (13,000 N of 90); of few elements one became most of the line, and its neighbours 0.1 m.
    """
    scene = cm.load_scene("scenes/towed_cable.yaml").to_dict()
    scene["vessel"] = {"velocity": [{"t": 0, "velocity": [0.8, 0, 0]}]}
    model = cm.CableModel(cm.load_scene(scene), planar=False)
    start = model.top_tension
    tension = []
    for k in range(16000):
        rate = -0.8 * np.sin(2.0 * np.pi * k / 8000)
        model.step(0.01, vessel_velocity=(0.8, 0.3 * np.sin(0.002 * k), 0), payout_rate=rate)
        tension.append(model.top_tension)
    tension = np.array(tension)
    assert tension.min() > 0.0
    assert tension.max() < 3.0 * start
    assert np.abs(np.diff(tension, 2)).max() < 0.05 * start
    assert np.diff(model.state().s).min() > 0.05


def drawn_in_through_a_bend(elements):
    """A stiff cable that leaves its clamp all but level and hangs from there, taken in by 4.6 m.

    Returns the tensions at the top, every 0.05 s, of a line of the given elements.
    """
    cable = {"diameter": 0.02, "mass": 0.6, "axial_stiffness": 1e6, "bending_stiffness": 12.0}
    model = cm.CableModel(
        cm.load_scene(
            {
                "cable_types": {"C": cable},
                "line": [
                    {"cable": {"type": "C", "length": 8, "elements": elements}},
                    {"body": {"mass": 6, "submerged_weight": 50, "drag_area": 0.05}},
                ],
                "vessel": {"connection": {"clamped": [1, 0, 0.3]}},
                "payout": {
                    "rate": [{"t": t, "rate": -0.2 * (t > 2)} for t in (0, 2, 3)],
                    "drum": [{"cable": {"type": "C", "length": 2}}],
                },
            }
        )
    )
    pulls = []
    while model.time < 25.0:
        model.step(0.05)
        pulls.append(model.top_tension)
    assert model.statistics["elements"] < 0.6 * elements  # they were joined
    return np.array(pulls)


def test_a_bend_that_cable_is_drawn_through_is_not_joined_away():
    """Joining must not move the line by more than is promised: where it did, energy came of it.

    16 elements were 12.6 N off 96, of 75, and took 88 N where there are 71.
    """
    pulls, fine = drawn_in_through_a_bend(16), drawn_in_through_a_bend(96)
    assert np.abs(pulls - fine).max() < 8.0
    assert np.abs(pulls).max() < 1.01 * np.abs(fine).max()


# A string that runs along itself ------------------------------------------------------------------

SPEED, STRING, HEIGHT = 10.0, 1.0, 1e-3  # of transverse waves; the string's first length; a bump


def bump(x):
    return HEIGHT * np.sin(np.pi * x / STRING) ** 4


def height_of_string(x, time, rate):
    """Of a string between a fixed eye at x = 0 and one that moves away at `rate`, by d'Alembert.

    y = f(c t + x) - f(c t - x); at the moving eye f(c t + l) = f(c t - l), l = STRING + rate t,
    which carries f on from its start: there the bump stands still as the moving eye sees it.
    """
    z = SPEED * time + np.concatenate([x, -x])
    while (far := z > STRING).any():
        z = np.where(far, (SPEED - rate) / (SPEED + rate) * (z - STRING) - STRING, z)
    f = 0.5 * (np.sign(z) - rate / SPEED) * bump(np.abs(z))
    return f[: len(x)] - f[len(x) :]


def running_string(rate, elements, tolerance):
    """The vessel pays string out, or takes it in, as it moves: the string's matter is at rest.

    Weightless in vacuum, T / (m (1 + strain)) = SPEED^2 in unstretched lengths.
    """
    mass, stiffness = 1.0, 1e4
    stretch = 1.0 / (1.0 - mass * SPEED**2 / stiffness)
    s = np.linspace(0.0, STRING, 401)
    string = {"type": "k", "length": STRING, "model": "cable"}
    points = np.column_stack([stretch * s, 0.0 * s, bump(STRING - s)])
    return cm.load_scene(
        {
            "environment": {"water_density": 0, "gravity": 0},
            "cable_types": {
                "k": {
                    "diameter": 0.01,
                    "mass": mass,
                    "submerged_weight": 0,
                    "axial_stiffness": stiffness,
                }
            },
            "line": [{"cable": {**string, "elements": elements}}],
            "end": {"anchor": [stretch * STRING, 0, 0]},
            "initial": {"points": points.tolist()},
            "vessel": {"velocity": [{"t": 0, "velocity": [-rate * stretch, 0, 0]}]},
            "payout": {"rate": [{"t": 0, "rate": rate}], "drum": [{"cable": string}]},
            "solver": {"tolerance": tolerance},
        }
    )


def error_of_string(rate, time, elements, tolerance):
    """Largest error on the way, of the bump's height."""
    model = cm.CableModel(running_string(rate, elements, tolerance))
    worst = 0.0
    for k in range(1, 21):
        model.step_to(time * k / 20)
        assert model.line_length == pytest.approx(STRING + rate * model.time, abs=1e-12)
        s = np.linspace(0.0, model.line_length, 101)
        exact = height_of_string(model.line_length - s, model.time, rate)
        worst = max(worst, np.abs(model.sample(s).position[:, 2] - exact).max() / HEIGHT)
    return worst


def test_a_string_that_runs_out_at_almost_half_of_its_wave_speed():
    """Waves go through the top element while it grows and is split, and meet the moving eye.

    There a wave comes back longer by (c + v) / (c - v) = 7/3. (Between two eyes that both run the
    lowest frequency would be pi (c^2 - v^2) / (c L) = 26.389 rad/s for c 10, v 4, L 1; here cable
    runs past one end of a line only.)
    """
    coarse = error_of_string(4.0, 0.2, 16, 1e-5)
    fine = error_of_string(4.0, 0.2, 32, 1e-6)
    assert coarse < 1e-2
    assert fine < 2e-3


def test_a_string_that_is_taken_in():
    """The same at a tenth of the wave speed, with elements that are joined.

    Waves come back shorter. (At 0.4 of it the tow point overtakes those that are as short as
    elements, which the mesh carries more slowly, and they pile up there.)
    """
    assert error_of_string(-1.0, 0.4, 32, 1e-6) < 1e-2
    assert error_of_string(-1.0, 0.4, 64, 1e-6) < 4e-3


@pytest.mark.parametrize(("tolerance", "promises"), [(1e-2, 1.0), (1e-3, 1.0), (1e-4, 2.0)])
def test_a_winch_that_stops_dead_sends_a_wave_along_the_line(tolerance, promises):
    """At the end of its drum, however long the steps before: the tension at the tow point jumps by
    V sqrt(EA m), and the free end goes on at V until the wave is there, then back as far. At 1e-4
    the end, which turns round at once, is 1.5 tau L off then: the front is one of 12 elements."""
    mass, stiffness, speed, length, drum = 1.0, 1e5, 1.0, 100.0, 15.0
    rope = {"type": "r", "model": "cable"}
    kind = {
        "diameter": 0.02,
        "mass": mass,
        "submerged_weight": mass * GRAVITY,
        "axial_stiffness": stiffness,
    }
    scene = {
        "environment": {"water_density": 0, "gravity": GRAVITY},
        "cable_types": {"r": kind},
        "line": [{"cable": {**rope, "length": length}}],
        "payout": {
            "rate": [{"t": 0, "rate": 0}, {"t": 20, "rate": speed}],
            "drum": [{"cable": {**rope, "length": drum}}],
        },
        "solver": {"tolerance": tolerance},
    }
    model = cm.CableModel(cm.load_scene(scene))
    stop = 25.0
    model.step_to(20.0)
    model.step_to(24.0)
    before = model.tip_position[2]
    weight = mass * GRAVITY * (length + drum)
    sinking = speed * (1.0 + weight / stiffness) * (stop - model.time)
    travel = (length + drum) / np.sqrt(stiffness / mass)  # of the wave, one way [s]
    model.step_to(stop + 0.5 * travel)
    wave = (model.top_tension - weight) / (speed * np.sqrt(stiffness * mass))
    assert wave == pytest.approx(1.0, abs=0.1)
    for part, exact in ((1.0, 1.0), (1.5, 0.5), (2.0, 0.0)):
        model.step_to(stop + part * travel)
        down = before - sinking - model.tip_position[2]
        assert abs(down - exact * speed * travel) < promises * tolerance * model.line_length


def test_an_empty_drum_starts_as_if_its_winch_stood_still():
    """What is asked to run out at once, and cannot, neither moves the start nor snaps after it."""
    scene = scenes.turned(tolerance=1e-3).to_dict()
    still = cm.CableModel(cm.load_scene(scene))
    asked = cm.CableModel(cm.load_scene(scene, ["payout.rate=1"]))

    assert asked.payout_rate == 0.0
    assert asked.top_tension == pytest.approx(still.top_tension, rel=1e-9)
    for model in (still, asked):
        model.step(0.5)
    assert asked.winch == "drum empty"
    assert asked.top_tension == pytest.approx(still.top_tension, rel=1e-3)
