"""The scenes that come with the project: their numbers, as their comments tell them."""

import numpy as np
import pytest
from scipy.optimize import brentq

import cablemodel as cm
from cablemodel.scene.sea import sea
from tests.verification.touchdown_layer import touchdown_layer


def load(name, model=None, **solver):
    data = cm.load_scene(f"scenes/{name}.yaml").to_dict()
    data["solver"].update(solver)
    if model is not None:
        for item in [*data["line"], *data["payout"]["drum"]]:
            if item.get("cable"):
                item["cable"]["model"] = model
    return cm.load_scene(data)


def steps(scene):
    """A model of the scene after every output interval; cable on the drum and out is constant."""
    model = cm.CableModel(scene)
    total = model.line_length + model.drum_length
    count = round(scene.run.duration / scene.run.output_interval)
    for step in range(1, count + 1):
        model.step_to(step * scene.run.output_interval)
        assert model.line_length + model.drum_length == pytest.approx(total, rel=1e-9)
        yield model


@pytest.fixture(scope="module")
def fine_deployment():
    *_, model = steps(load("deployment", "elastica", tolerance=1e-5))
    return model


@pytest.mark.parametrize("kind", ["elastica", "cable", "hybrid"])
def test_deployment_is_completed_by_all_models(kind, fine_deployment):
    """Example 1 of the paper: they agree with a fine elastica to the tolerance."""
    scene = load("deployment", kind)
    tensions, bodies = {}, []
    for model in steps(scene):
        tensions[round(model.time)] = model.top_tension
        bodies.append(len(model.bodies))
    assert model.time == pytest.approx(200.0)
    # Ten bodies of half a metre have passed the tow point with the cable.
    assert model.line_length == pytest.approx(30.0 + 0.75 * (200.0 - 70.5) - 5.0, rel=1e-9)
    assert bodies[0] == 3
    assert bodies[-1] == 3 + 10
    # What hangs at the start: 30 m of cable and three bodies.
    assert tensions[1] == pytest.approx(100.0, rel=1e-3)
    assert tensions[71] < 0.5 * tensions[70]
    assert model.top_tension == pytest.approx(271.65, rel=1e-2)
    assert len({body.position[2] for body in model.bodies}) == 13
    assert model.bodies[-1].position == pytest.approx(model.tip_position, abs=0.5)
    tolerance = 1e-3 * model.line_length
    assert np.abs(model.tip_position - fine_deployment.tip_position).max() < tolerance
    assert model.tip_position == pytest.approx([25.48, 19.09, -104.23], abs=tolerance)


def test_a_jumper_moves_with_the_waves():
    """Calm water's tension is the weight that hangs; its swing and the cable's as they are told."""
    scene = load("jumper_in_waves")
    start = cm.CableModel(scene)
    assert start.top_tension == pytest.approx(399.0, abs=1.0)
    tension, near, belly = [], [], []
    for model in steps(scene):
        tension.append(model.top_tension)
        places = model.sample([10.0, 45.0]).position
        near.append(places[0, 0])
        belly.append(places[1, 0])
    # 3.730 N, 384.7 and 416.4 N at a tolerance of 2e-5.
    assert np.std(tension) == pytest.approx(3.73, abs=0.1)
    assert min(tension) == pytest.approx(384.7, abs=2.0)
    assert max(tension) == pytest.approx(416.4, abs=2.0)
    assert np.std(near) == pytest.approx(0.27, abs=0.01)
    assert np.std(belly) == pytest.approx(0.12, abs=0.01)
    # Weight in air above still water, submerged below: the tow point holds what hangs from it.
    state = start.sample(np.linspace(0.0, 66.0, 4001))
    lowest = int(np.argmin(state.position[:, 2]))
    kind = scene.cable_types["J"]
    air = state.position[: lowest + 1, 2] > 0.0
    weight = np.where(air, kind.mass * 9.80665, kind.submerged_weight)
    hanging = np.trapezoid(weight, state.s[: lowest + 1])
    assert -start.top_force[2] == pytest.approx(hanging, rel=5e-3)


def test_a_rope_floats_through_a_turn():
    """Wet by what carries its weight in air, and in the surface wherever the waves take it."""
    scene = load("floating_line_in_waves")
    start = cm.CableModel(scene)
    kind, afloat = scene.cable_types["rope"], start.sample(np.linspace(20.0, 110.0, 31))
    air = kind.mass * 9.80665
    wet = air / (air - kind.submerged_weight)
    drag = 0.5 * 1025.0 * np.pi * kind.diameter * kind.drag_tangential * 1.5**2
    np.testing.assert_allclose(-np.gradient(afloat.tension, 3.0), wet * drag, rtol=0.01)
    assert start.top_tension == pytest.approx(303.0, abs=1.0)
    field, tension, off = sea(scene), [], 0.0
    for model in steps(scene):
        tension.append(model.top_tension)
        x, y, z = model.sample(np.linspace(20.0, 120.0, 21)).position.T
        off = max(off, np.abs(field.elevation(model.time, x, y) - z).max())
    assert off < 0.02
    tension = np.array(tension)
    assert tension[60:120].min() == pytest.approx(265.6, abs=2.0)
    assert tension[60:120].max() == pytest.approx(351.0, abs=2.0)
    assert tension.min() == pytest.approx(107.4, abs=2.0)


def test_touchdown_has_the_papers_zero_tension():
    """Example 3 of the paper at 96 s: no tension 1.6 m above the touchdown, in its picture.

    Here 2.1 m at tau 1e-3 to 1e-5; by the place where the gap is that of lying cable, 1.7 to 2.0 m,
    the more the smaller tau.
    """
    landed = None
    for model in steps(load("touchdown")):
        if landed is None and model.floor_force[2] > 0.0:
            landed = model.time
        if model.time == 96.0:
            assert model.top_tension == pytest.approx(355.4, rel=5e-3)
            assert model.floor_force[2] == pytest.approx(188.3, rel=1e-2)
            above = height_of_zero_tension(model)
    assert landed == pytest.approx(29.5, abs=0.5)
    assert above == pytest.approx(2.1, abs=0.1)
    assert model.bodies[0].position[2] == pytest.approx(-69.4, abs=0.1)
    assert model.line_length == pytest.approx(65.0 + 0.7 * (125.0 - 20.5), rel=1e-9)


def test_touchdown_has_the_reaction_of_its_layer():
    """Near the paper's 8 N, which is a steady lay's at the vessel's speed: here the touchdown moves
    at half of it, as the body comes down, and the cable runs through it more slowly."""
    scene = load("touchdown")
    rows = []
    for model in steps(scene):
        if 90.0 <= model.time <= 100.0:
            lies = model.line_length - model.floor_length
            near = model.sample(np.linspace(lies - 4.0, lies + 1.0, 501))
            rows.append(
                (
                    model.time,
                    model.touchdown_position[0],
                    model.line_length - lies,
                    near.tension[-1],
                    model.touchdown_reaction,
                    near.curvature.max(),
                )
            )
    times, places, laid, tension, reaction, curvature = np.array(rows).T
    frame, through = np.polyfit(times, places, 1)[0], np.polyfit(times, laid, 1)[0]
    assert frame == pytest.approx(0.33, abs=0.05)
    expected = touchdown_layer(scene.cable_types["K"], tension.mean(), frame, through)
    assert (reaction.mean(), curvature.mean()) == pytest.approx(expected, rel=2e-2)
    # The same layer in a lay that is steady in the vessel's frame: the paper's reaction.
    assert touchdown_layer(scene.cable_types["K"], -1.1, 0.65, 0.7)[0] == pytest.approx(
        8.0, abs=0.1
    )


def height_of_zero_tension(model):
    """Arc length between the touchdown and the first place without tension above it [m]."""
    cable = model.sample(np.linspace(0.0, model.line_length, 20001))
    touchdown = cable.s[np.argmax(cable.position[:, 0] <= model.touchdown_position[0])]
    return touchdown - cable.s[np.argmax(cable.tension < 0.0)]


def test_cable_lay_follows_the_lay_law():
    """Top tension by Zajac's law at T0 = 0; later the tension at the touchdown adds to it."""
    scene = load("cable_lay")
    law = lay_tension(scene.cable_types["armoured"], speed=1.0, payout=1.0, depth=3000.0)
    assert law == pytest.approx(44790.0, abs=1.0)
    tensions, laid, off = {}, {}, []
    for model in steps(scene):
        tensions[model.time] = model.top_tension
        laid[model.time] = model.touchdown_position[0] - model.vessel_position[0]
        if model.time % 100.0 == 0.0:
            cable = model.sample(np.linspace(0.0, model.line_length, 8001))
            # 10 m above the floor, out of the reach of bending.
            above = np.argmax(cable.position[:, 2] < -2990.0)
            bottom = cable.tension[above] - law * 10.0 / 3000.0
            off.append((model.top_tension - bottom) / law - 1.0)
    # Weight against drag gives the same however the cable hangs; elements that land make it waver.
    assert len(off) == 50
    assert abs(np.mean(off)) < 1.5e-3
    assert np.max(np.abs(off)) < 5e-3  # half of what the tolerance promises
    steady = [value for time, value in tensions.items() if time <= 1200.0]
    assert steady == pytest.approx([law] * len(steady), rel=2.5e-3)
    assert max(tensions.values()) == pytest.approx(46.7e3, rel=5e-3)
    assert max(tensions, key=tensions.get) == pytest.approx(2410.0, abs=60.0)
    assert tensions[5000.0] == pytest.approx(44.93e3, rel=2.5e-3)
    assert laid[1000.0] == pytest.approx(-2732.0, abs=10.0)
    assert laid[2400.0] == pytest.approx(-2828.0, abs=15.0)
    # What lies on the floor is what went out, less what hangs.
    assert model.floor_length == pytest.approx(10051.8 - 4060.0, abs=10.0)
    assert np.abs(model.tip_position[0] + 3732.8) < 0.1  # friction holds the end


def lay_tension(kind, speed, payout, depth, density=1025.0):
    drag = 0.5 * density * kind.diameter

    def balance(angle):
        across = drag * kind.drag_normal * (speed * np.sin(angle)) ** 2
        return kind.submerged_weight * np.cos(angle) - across

    angle = brentq(balance, 0.01, 1.57)
    along = drag * np.pi * kind.drag_tangential * (payout - speed * np.cos(angle)) ** 2
    return (kind.submerged_weight - along / np.sin(angle)) * depth


@pytest.mark.filterwarnings("ignore::cablemodel.TautLayWarning")  # of the scene recovery
def test_recovery_brings_the_lander_on_board():
    """Tension: what hangs, at rest; the lander is lifted, and passes the tow point."""
    scene = load("recovery")
    heights, tensions, floor, lengths = {}, {}, {}, {}
    for model in steps(scene):
        heights[model.time] = model.bodies[0].position[2] if model.bodies else np.nan
        lengths[model.time] = model.line_length
        tensions[model.time] = model.top_tension
        floor[model.time] = model.floor_length
    assert heights[100.0] == pytest.approx(-100.0, abs=0.1)
    lifted = min(time for time, height in heights.items() if height > -99.5)
    assert lifted == pytest.approx(126.0, abs=6.0)
    free = min(time for time, length in floor.items() if time > lifted and length == 0.0)
    assert free == pytest.approx(203.0, abs=6.0)
    # Hanging straight: 3.9 N a metre and the lander's 250 N; drag at 0.5 m/s adds 3 %.
    slope = (tensions[240.0] - tensions[300.0]) / 30.0
    assert slope == pytest.approx(3.9, rel=0.05)
    # The lander leaves the line from 373 to 375.5 s; the tail is left.
    assert tensions[370.0] == pytest.approx(3.9 * lengths[370.0] + 250.0, rel=1e-2)
    assert tensions[374.0] == pytest.approx(3.9 * 30.0 + 250.0 * 0.6, rel=1e-2)
    assert lengths[374.0] == lengths[375.0] == pytest.approx(30.0, abs=1e-9)
    assert model.bodies == []
    assert model.line_length == pytest.approx(30.0 - 0.2 * 14.5, abs=1e-6)
    assert model.top_tension == pytest.approx(3.9 * model.line_length, rel=5e-3)
    # Once all hangs, elements that the winch takes in leave no mark on it.
    hanging = [tension for time, tension in tensions.items() if 220.0 < time < 318.0]
    assert np.abs(np.diff(hanging, 2)).max() < 0.03 * max(hanging)
