"""Bodies of finite length that pass the tow point: what they weigh, how they move, what is kept."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import cablemodel as cm

GRAVITY = 9.80665
K = {"diameter": 0.01666, "mass": 0.4613, "submerged_weight": 2.33333, "axial_stiffness": 1e6,
     "bending_stiffness": 0.1, "drag_normal": 1.0, "drag_tangential": 0.1586,
     "added_mass": 1.0}  # fmt: skip


def cable(length, model="hybrid", **more):
    return {"cable": {"type": "K", "length": length, "model": model, **more}}


def body(half_length, mass=6.0, weight=20.0):
    """As in the paper's example 3, with the rotary inertia of an even mass."""
    inertia = mass * (2.0 * half_length) ** 2 / 12.0
    return {"body": {"mass": mass, "submerged_weight": weight, "half_length": half_length,
                     "rotary_inertia": inertia, "added_mass": 2, "added_mass_axial": 2,
                     "drag_area": 0.03, "drag_coefficient": 0.6, "drag_area_axial": 0.03,
                     "drag_coefficient_axial": 0.6}}  # fmt: skip


def towed(half_length, rate, model="hybrid", tolerance=1e-3):
    """40 m out with one body, towed at 0.8 m/s; two more bodies and 32 m of cable on the drum."""
    line = [cable(20, model), body(half_length), cable(20, model)]
    drum = [cable(5, model), body(half_length), cable(12, model), body(half_length),
            cable(15, model)]  # fmt: skip
    return cm.load_scene(
        {
            "cable_types": {"K": K},
            "line": line,
            "vessel": {"velocity": [{"t": 0, "velocity": [0.8, 0, 0]}]},
            "payout": {"rate": rate, "drum": drum},
            "solver": {"tolerance": tolerance},
        }
    )


# Lengths ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", ["hybrid", "cable", "elastica"])
def test_the_winch_turns_by_cable_and_bodies(model):
    """0.5 m/s out and in: cable passes, then a metre of body, cable again; exact at all times."""
    rate = [{"t": 0, "rate": 0.5}, {"t": 80, "rate": 0.5}, {"t": 80.001, "rate": -0.5}]
    run = cm.CableModel(towed(0.5, rate, model))
    travel = np.array([-41.0, -21.0, -20.0, 0.0, 5.0, 6.0, 18.0, 19.0, 34.0])
    paid = np.array([-40.0, -20.0, -20.0, 0.0, 5.0, 5.0, 17.0, 17.0, 32.0])
    numbers = []
    for time in np.arange(1.0, 230.1, 1.0):
        run.step_to(time)
        # The drum is empty after 68 s; in the end 1 % of 40 m is left, without the body above it.
        way = max(0.5 * min(time, 68.0) - 0.5 * max(0.0, time - 80.001), -39.6 - 1.0)
        expected = 40.0 + np.interp(way, travel, paid)
        assert run.line_length == pytest.approx(expected, abs=2e-4)
        assert run.line_length + run.drum_length == pytest.approx(72.0, abs=1e-10)
        assert run.state().s[-1] == pytest.approx(run.line_length, abs=1e-10)
        numbers.append(len(run.bodies))
    assert max(numbers) == 3
    assert numbers[-1] == 0
    assert run.winch == "shortest length"


@pytest.mark.parametrize(("interval", "count"), [(0.01, 20_000), (1.0, 1000)])
@pytest.mark.parametrize("half_length", [0.5, 0.05])
def test_commands_at_random_pass_a_body_to_and_fro(interval, count, half_length):
    """Ramps of 0.2 m/s2 around a body on the drum: lengths kept, no spikes in the tension.

    What a ramp's kink does to the line's mass is 12 N in a step of 10 ms, and what it makes ring
    along the line up to 5; a point body that leaves
    adds 20 to 34 N at once. A metre of body adds nothing to the kinks.
    """
    run = cm.CableModel(towed(half_length, [{"t": 0, "rate": 0}]))
    generator = np.random.default_rng(1)
    rate, target = 0.0, 0.0
    tensions, states = [], []
    for k in range(count):
        if k % max(1, round(2.0 / interval)) == 0:
            way = run.line_length - 45.0
            target = generator.uniform(-0.8, 0.8) - 0.15 * way
        rate += np.clip(target - rate, -0.2 * interval, 0.2 * interval)
        run.step(interval, payout_rate=rate)
        tensions.append(run.top_tension)
        states.append(len(run.bodies))
        assert run.line_length + run.drum_length == pytest.approx(72.0, abs=1e-9)
    assert np.count_nonzero(np.diff(states)) >= 8
    assert min(tensions) > 30.0
    assert max(tensions) < 600.0
    if interval == 0.01:
        assert np.abs(np.diff(tensions, 2)).max() < (20.0 if half_length == 0.5 else 80.0)


# Motion -------------------------------------------------------------------------------------------

LENGTH, ROD, BOB, STRING = 1.5, 60.0, 40.0, 3.0
RATES = [(0.0, 0.4), (3.0, 0.4), (4.5, -0.4), (5.5, -0.4), (7.0, 0.4), (12.0, 0.4)]
FIRST = 0.05 * LENGTH


def winch(time):
    """Way, rate and its slope of the winch."""
    times, rates = np.array(RATES).T
    k = min(int(np.searchsorted(times, time, side="right")) - 1, len(times) - 2)
    slope = (rates[k + 1] - rates[k]) / (times[k + 1] - times[k])
    ways = np.concatenate([[0.0], np.cumsum(0.5 * (rates[1:] + rates[:-1]) * np.diff(times))])
    since = time - times[k]
    return ways[k] + since * (rates[k] + 0.5 * slope * since), rates[k] + slope * since, slope


def along(angle):
    return np.array([np.sin(angle), -np.cos(angle)])


def single(time, state):
    """Angle and its rate of a bob on a string that is paid out."""
    way, rate, _slope = winch(time)
    angle, turn = state
    return turn, -(GRAVITY * np.sin(angle) + 2.0 * rate * turn) / (STRING + way)


def double(time, state):
    """A rod of even mass whose length out is x, and a bob on a string at its end.

    The matter that passes the pivot brings no angular momentum: (m x^3 / 3 a_t)_t is the torque,
    m the mass per length. With the bob's two equations that gives both angles and the tension.
    """
    x, rate, slope = winch(time)
    a, b, at, bt = state
    density = ROD / LENGTH
    across = np.array([np.cos(a), np.sin(a)])
    round_b = np.array([np.cos(b), np.sin(b)])
    # Unknown: a_tt, b_tt, T.   bob: x e(a) + s e(b)
    known = slope * along(a) + 2.0 * rate * at * across - x * at**2 * along(a)
    known -= STRING * bt**2 * along(b)
    matrix = np.zeros((3, 3))
    matrix[0] = [density * x**3 / 3.0, 0.0, -x * np.sin(b - a)]
    matrix[1:, 0] = BOB * x * across
    matrix[1:, 1] = BOB * STRING * round_b
    matrix[1:, 2] = along(b)
    right = np.empty(3)
    right[0] = -density * x**2 * rate * at - 0.5 * density * GRAVITY * x**2 * np.sin(a)
    right[1:] = -BOB * known + np.array([0.0, -BOB * GRAVITY])
    att, btt, _tension = np.linalg.solve(matrix, right)
    return at, bt, att, btt


def test_a_rod_and_a_bob_swing_while_the_rod_passes():
    """Against the equations of motion by SciPy, out, back and out again in vacuum."""
    angle, tolerance = 0.3, 1e-5
    start = (FIRST - winch(0.0)[0]) / RATES[0][1]
    first = solve_ivp(single, (0.0, start), [angle, 0.0], rtol=1e-11, atol=1e-12)
    swing = first.y[:, -1]
    end = 7.5
    path = solve_ivp(
        double, (start, end), [swing[0], swing[0], swing[1], swing[1]], rtol=1e-10, atol=1e-11,
        dense_output=True,
    )  # fmt: skip
    rod = {"mass": ROD, "submerged_weight": ROD * GRAVITY, "half_length": 0.5 * LENGTH,
           "rotary_inertia": ROD * LENGTH**2 / 12.0}  # fmt: skip
    string = {"type": "c", "length": STRING, "model": "cable", "elements": 4}
    reach = STRING * (1.0 + BOB * GRAVITY * np.cos(angle) / 1e9)
    scene = {
        "environment": {"water_density": 0},
        "cable_types": {"c": {"diameter": 0.01, "mass": 1e-4, "axial_stiffness": 1e9}},
        "line": [{"cable": string}, {"body": {"mass": BOB, "submerged_weight": BOB * GRAVITY}}],
        "initial": {"points": [[0, 0, 0], [reach * np.sin(angle), 0, -reach * np.cos(angle)]]},
        "payout": {
            "rate": [{"t": t, "rate": rate} for t, rate in RATES],
            "drum": [{"body": rod}, {"cable": {**string, "length": 5}}],
        },
        "solver": {"tolerance": tolerance},
    }
    run = cm.CableModel(cm.load_scene(scene))
    for time in np.arange(0.5, end + 0.01, 0.5):
        run.step_to(time)
        x = winch(time)[0]
        a, b, *_ = path.sol(time)
        assert FIRST < x < LENGTH
        found = run.bodies[0].direction
        assert found[[0, 2]] == pytest.approx(along(a), abs=1e-4)
        expected = x * along(a) + STRING * along(b)
        assert run.tip_position[[0, 2]] == pytest.approx(expected, abs=tolerance * STRING)


def test_energy_of_a_body_that_passes():
    """What the vessel does and what the matter brings at the tow point is what is stored.

    A body of even mass in vacuum under a vessel that moves; 1 ms between readings.
    """
    half, mass, rate = 0.5, 6.0, 0.5
    scene = {
        "environment": {"water_density": 0},
        "cable_types": {"K": {**K, "submerged_weight": K["mass"] * GRAVITY}},
        "line": [cable(10), {"body": {"mass": 10, "submerged_weight": 10 * GRAVITY}}],
        "initial": {"straight": [0.3, 0, -1]},
        "vessel": {"velocity": [{"t": 0, "velocity": [0, 0, 0]}, {"t": 2, "velocity": [1, 0, 0.2]},
                                {"t": 6, "velocity": [-0.5, 0, 0.3]}]},
        "payout": {"rate": [{"t": 0, "rate": rate}],
                   "drum": [cable(1), body(half, mass), cable(6)]},
        "solver": {"tolerance": 1e-4},
    }  # fmt: skip
    scene["payout"]["drum"][1]["body"] |= {
        "submerged_weight": mass * GRAVITY, "added_mass": 0, "added_mass_axial": 0,
    }  # fmt: skip
    run = cm.CableModel(cm.load_scene(scene), planar=False)
    run.step_to(2.2)  # the body comes at 2 s
    stored, power = [], []
    for _ in range(1700):
        run.step(1e-3)
        energy = run.energy()
        stored.append(sum(energy[k] for k in ("kinetic", "axial", "bending", "potential")))
        velocity = run.vessel_velocity + rate * run.bodies[0].direction
        brought = 0.5 * velocity @ velocity + GRAVITY * run.vessel_position[2]
        power.append(-run.top_force @ velocity + mass / (2 * half) * rate * brought)
    gained = np.array(stored) - stored[0]
    work = np.concatenate([[0.0], np.cumsum(0.5e-3 * (np.array(power)[1:] + power[:-1]))])
    exchanged = 1e-3 * np.sum(np.abs(power))
    assert np.abs(gained - work).max() < 2e-4 * exchanged


# Limits -------------------------------------------------------------------------------------------


def test_a_short_body_is_a_point():
    """Paths of the line's end go over into that of point bodies with the length of the body.

    On a fine mesh: a point leaves when a tenth of an element of the cable above it is out. Without
    drag on the bodies: a point's goes with its whole speed, a body's with both parts of it.
    """
    rate = [{"t": 0, "rate": 0}, {"t": 5, "rate": 0.7}, {"t": 40, "rate": 0.7}]

    def path(half_length):
        scene = towed(half_length, rate, tolerance=1e-4).to_dict()
        for item in [*scene["line"], *scene["payout"]["drum"]]:
            if "body" in item:
                item["body"] |= {"drag_area": 0, "drag_area_axial": 0}
        for item in scene["line"]:
            if "cable" in item:
                item["cable"]["elements"] = 60
        run = cm.CableModel(cm.load_scene(scene))
        run.step_to(20.0)
        return np.append(run.tip_position, run.line_length)

    point = path(0.0)
    away = [np.abs(path(half) - point).max() for half in (0.4, 0.2, 0.1)]
    assert away[0] < 3.0 * 0.8
    assert away[1] == pytest.approx(away[0] / 2.0, rel=0.1)
    assert away[2] == pytest.approx(away[0] / 4.0, rel=0.2)


@pytest.mark.parametrize("model", ["hybrid", "elastica"])
def test_a_line_that_was_paid_out_hangs_like_one_that_was_built(model):
    """Two bodies off the drum, then towed until all is at rest: within tau L of the same line.

    The bending layers of an elastica at its bodies are resolved in a line that is built, not off
    the drum.
    """
    tolerance = 1e-3
    rate = [{"t": 0, "rate": 0.5}, {"t": 60, "rate": 0.5}, {"t": 62, "rate": 0}]
    paid = cm.CableModel(towed(0.5, rate, model, tolerance))
    paid.step_to(600.0)
    top = paid.line_length - 40.0 - 17.0
    items = [cable(top, model), body(0.5), cable(12, model), body(0.5), cable(25, model),
             body(0.5), cable(20, model)]  # fmt: skip
    scene = paid.scene.to_dict() | {"line": items, "payout": {}}
    built = cm.CableModel(cm.load_scene(scene))
    reach = tolerance * built.line_length
    assert paid.line_length == pytest.approx(built.line_length, abs=1e-9)
    for ours, theirs in zip(paid.bodies, built.bodies, strict=True):
        at = paid.vessel_position
        assert ours.position - at == pytest.approx(theirs.position, abs=reach)
        turned = 5e-3 if model == "hybrid" else 2e-2
        assert ours.direction == pytest.approx(theirs.direction, abs=turned)
    assert paid.tip_position - paid.vessel_position == pytest.approx(built.tip_position, abs=reach)
    assert paid.top_tension == pytest.approx(built.top_tension, rel=1e-3)


def test_snapshot_in_the_middle_of_a_body():
    run = cm.CableModel(towed(0.5, [{"t": 0, "rate": 0.5}]))
    run.step_to(11.0)
    assert run.line_length == pytest.approx(45.0, abs=1e-10)  # half of the body is out
    kept = run.snapshot()
    run.step_to(14.0)
    first = run.tip_position, run.top_tension
    run.restore(kept)
    run.step_to(14.0)
    assert np.array_equal(first[0], run.tip_position)
    assert first[1] == run.top_tension


def test_a_body_on_the_drum_longer_than_the_cable_that_is_out_is_refused():
    scene = towed(0.5, [{"t": 0, "rate": 0.5}]).to_dict()
    scene["payout"]["drum"] = [body(11.0), cable(30)]
    with pytest.raises(cm.SceneError, match=r"payout\.drum\.0\.body\.half_length") as caught:
        cm.load_scene(scene)
    assert "22 m long, the cable next to it 20 m" in str(caught.value)
