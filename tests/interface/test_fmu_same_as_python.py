"""The FMU gives the bits of the Python model for the same inputs and steps (on this machine)."""

from pathlib import Path

import numpy as np
import pytest
from fmu_tools import Slave, assert_same_bits, step_alike, still_scene, unpacked

import cablemodel as cm
from cablemodel.solvers import library

SCENES = Path(__file__).parents[2] / "scenes"
STATIONS = 7


@pytest.fixture(scope="module")
def still(tmp_path_factory):
    scene = still_scene()
    with unpacked(scene, tmp_path_factory.mktemp("fmu"), stations=STATIONS) as found:
        yield scene, *found


def test_python_uses_the_library_that_the_fmu_holds(still):
    path = library.library_path()
    assert path is not None
    assert path.read_bytes() == (still[1] / "binaries" / "linux64" / path.name).read_bytes()


def test_every_output_is_compared(still):
    """None of the names in the description is missing from the comparison."""
    scene, place, description = still
    slave = Slave(place, description)
    from fmu_tools import python_outputs

    names = {
        n for name in python_outputs(cm.CableModel(scene), STATIONS) for n in slave.names(name)
    }
    assert names == {v.name for v in description.modelVariables if v.causality == "output"}
    slave.close()


def test_inputs_and_variable_steps(still):
    """Velocity in all directions (the plane is left), pay-out, current; steps from 1 ms to 3 s."""
    scene, place, description = still
    slave, model = Slave(place, description), cm.CableModel(scene)
    assert_same_bits(slave, model, STATIONS)
    rng = np.random.default_rng(1)
    for dt in (0.001, 0.02, 0.3, 3.0, 0.01, 0.5, 1.0, 0.07):
        step_alike(slave, model, rng, dt)
        assert_same_bits(slave, model, STATIONS)
    assert not model.planar
    assert model.drum_length != 15.0
    slave.close()


@pytest.mark.parametrize("both", [False, True])
def test_position_input(still, both):
    scene, place, description = still
    slave = Slave(place, description, vessel_input=3 if both else 2)
    model = cm.CableModel(scene)
    for n in range(1, 60):
        t = 0.1 * n
        position = np.array([5 + 0.1 * t**2, 3 + 0.2 * np.sin(t), 0.1 * np.sin(2 * t)])
        velocity = np.array([0.2 * t, 0.2 * np.cos(t), 0.2 * np.cos(2 * t)])
        slave.set("vessel.position", position)
        slave.set("vessel.velocity", velocity)
        slave.step(0.1)
        model.step(
            0.1,
            vessel_position=position,
            vessel_velocity=velocity if both else None,
            payout_rate=0.0,
            current=(0, 0, 0),
        )
        np.testing.assert_allclose(model.vessel_position, position, rtol=0, atol=1e-12)
    assert_same_bits(slave, model, STATIONS)
    slave.close()


@pytest.mark.parametrize("name", ["towed_cable", "turn", "whip", "release_in_water"])
def test_the_scenes_own_schedule(name, tmp_path):
    """With nothing connected the FMU runs the scene."""
    scene = cm.load_scene(SCENES / f"{name}.yaml")
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        scheduled = name in ("towed_cable", "turn")
        start = {v.name: v.start for v in description.modelVariables}["use_scene_inputs"]
        assert start == ("true" if scheduled else "false")
        slave, model = Slave(place, description, use_scene_inputs=True), cm.CableModel(scene)
        for _ in range(20):
            slave.set("vessel.velocity", (9.0, 9.0, 9.0))  # ignored
            slave.step(0.05)
            model.step(0.05)
        assert_same_bits(slave, model, STATIONS)
        slave.close()


@pytest.mark.filterwarnings("ignore::cablemodel.TautLayWarning")  # of the scene recovery
@pytest.mark.parametrize(
    ("name", "steps", "dt"),
    [
        ("recovery", 60, 0.5),
        ("deployment", 60, 0.5),
        ("touchdown", 80, 1.0),
        ("cable_lay", 60, 2.0),
        ("jumper_in_waves", 80, 0.25),
    ],
)
def test_scenes_with_floor_bodies_winch_and_waves(name, steps, dt, tmp_path):
    """They run in the FMU as in Python, the floor's outputs too; a state taken on the way goes on
    as the run did, bit by bit."""
    scene = cm.load_scene(SCENES / f"{name}.yaml")
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, model = Slave(place, description, use_scene_inputs=True), cm.CableModel(scene)
        for n in range(steps):
            if n == steps // 2:
                state, time = slave.fmu.getFMUstate(), slave.time
            slave.step(dt)
            model.step(dt)
            assert_same_bits(slave, model, STATIONS)
        on_floor = slave.get("floor.length") if scene.environment.floor is not None else 0.0
        assert (on_floor > 1.0) == (name not in ("deployment", "jumper_in_waves"))
        end = slave.fmu.serializeFMUstate(slave.fmu.getFMUstate())
        slave.fmu.setFMUstate(state)
        slave.time = time
        for _ in range(steps - steps // 2):
            slave.step(dt)
        assert slave.fmu.serializeFMUstate(slave.fmu.getFMUstate()) == end
        slave.close()


def test_a_body_that_comes_off_the_drum(tmp_path):
    """It is at the tow point until then; bodies are numbered from the vessel outwards."""
    scene = still_scene()
    data = scene.to_dict()
    body = data["line"][1]
    cable = {"cable": {"type": "K", "length": 8}}
    data["payout"] = {"drum": [{"cable": {"type": "K", "length": 2}}, body, cable]}
    scene = cm.load_scene(data)
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, model = Slave(place, description), cm.CableModel(scene)
        assert slave.get("body[1].position").tolist() == [5, 3, 0]
        assert slave.get("body[2].position")[2] < -15
        for _ in range(20):
            slave.set("payout.rate", 0.5)
            slave.step(0.5)
            model.step(0.5, (0, 0, 0), payout_rate=0.5, current=(0, 0, 0))
            assert_same_bits(slave, model, STATIONS)
        assert len(model.bodies) == 2
        assert slave.get("body[1].position")[2] < -1
        slave.close()


def test_bodies_of_finite_length(tmp_path):
    """In line and at the end: centre of gravity and axis, and in space after a push aside."""
    data = still_scene().to_dict()
    body = {**data["line"][1]["body"], "half_length": 0.5, "centre_offset": 0.2}
    body["rotary_inertia"] = 0.6
    data["line"] = [data["line"][0], {"body": body}, data["line"][2], {"body": body}]
    data["environment"]["current"] = None
    scene = cm.load_scene(data)
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, model = Slave(place, description), cm.CableModel(scene)
        assert slave.get("body[2].position")[2] == pytest.approx(-31.6, abs=1e-2)
        for k in range(20):
            velocity = (0.5, 0.2 if k > 10 else 0.0, 0.0)
            slave.set("vessel.velocity", velocity)
            slave.step(0.25)
            model.step(0.25, velocity, payout_rate=0.0, current=(0, 0, 0))
            assert_same_bits(slave, model, STATIONS)
            assert model.planar == (k <= 10)
        slave.close()


def test_start_time_shifts_the_scene(still):
    scene, place, description = still
    slave, model = Slave(place, description, start=64.0), cm.CableModel(scene)
    for _ in range(8):
        slave.set("vessel.velocity", (0.25, 0, 0))
        slave.step(0.25)
        model.step(0.25, vessel_velocity=(0.25, 0, 0), payout_rate=0.0, current=(0, 0, 0))
    assert slave.get("tension.top") == model.top_tension
    slave.close()


def test_input_derivatives_give_the_value_at_the_end_of_the_step(still):
    scene, place, description = still
    slave, model = Slave(place, description), cm.CableModel(scene)
    velocity = slave.references["vessel.velocity[1]"].valueReference
    for n in range(10):
        slave.set("vessel.velocity", (0.03125 * n, 0, 0))
        slave.fmu.setRealInputDerivatives([velocity], [1], [0.125])
        slave.step(0.25)
        end = (0.03125 * (n + 1), 0, 0)
        model.step(0.25, vessel_velocity=end, payout_rate=0.0, current=(0, 0, 0))
    assert_same_bits(slave, model, STATIONS)
    # They are for one step: the next value is again the one at the step's end.
    slave.set("vessel.velocity", (0.5, 0, 0))
    slave.step(0.25)
    model.step(0.25, vessel_velocity=(0.5, 0, 0), payout_rate=0.0, current=(0, 0, 0))
    assert_same_bits(slave, model, STATIONS)
    slave.close()


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_velocity_leads_as_far_as_its_derivatives_say(still, order):
    """v = t^n, by the value at each step's start, beside a place in the library."""
    scene, place, description = still
    slave, model = Slave(place, description), cm.CableModel(scene)
    velocity = slave.references["vessel.velocity[1]"].valueReference
    begin, dt = model.vessel_position, 0.25
    for n in range(8):
        t = n * dt
        slopes = [float(np.polyval(np.polyder([1.0] + order * [0.0], k), t)) for k in (1, 2, 3)]
        slave.set("vessel.velocity", (t**order, 0, 0))
        slave.fmu.setRealInputDerivatives([velocity] * 3, [1, 2, 3], slopes)
        slave.step(dt)
        way, speed = (t + dt) ** (order + 1) / (order + 1), (t + dt) ** order
        there = {"vessel_position": begin + np.array([way, 0, 0]), "vessel_velocity": (speed, 0, 0)}
        model.step(dt, **there, payout_rate=0.0, current=(0, 0, 0))
    assert slave.get("tension.top") == pytest.approx(model.top_tension, rel=1e-9)
    assert slave.get("tip.position[1]") == pytest.approx(model.tip_position[0], rel=1e-9)
    slave.close()


def test_coefficients_set_before_the_start_are_those_of_the_scene(still):
    """A coefficient changed in the FMU gives the equilibrium of a scene that has it."""
    _scene, place, description = still
    weight = 3.5
    slave = Slave(
        place,
        description,
        **{
            "cable_types.K.submerged_weight": weight,
            "cable_types.K.drag_normal": 1.3,
            "cable_types.K.added_mass": 0.5,
            "body[1].drag_coefficient": 0.9,
        },
    )
    changed = still_scene()
    data = changed.to_dict()
    data["cable_types"]["K"].update(submerged_weight=weight, drag_normal=1.3, added_mass=0.5)
    data["line"][1]["body"]["drag_coefficient"] = 0.9
    model = cm.CableModel(cm.load_scene(data))
    np.testing.assert_allclose(slave.get("tension.top"), model.top_tension, rtol=1e-6)
    np.testing.assert_allclose(slave.get("end.position"), model.tip_position, atol=1e-6)
    for _ in range(20):
        slave.set("vessel.velocity", (0.5, 0, 0))
        slave.step(0.5)
        model.step(0.5, vessel_velocity=(0.5, 0, 0), payout_rate=0.0, current=(0, 0, 0))
    # The mesh and the first step are those of the exported scene: equal within the tolerance.
    np.testing.assert_allclose(slave.get("end.position"), model.tip_position, atol=0.03)
    np.testing.assert_allclose(slave.get("tension.top"), model.top_tension, rtol=0.01)
    slave.close()


def test_a_coefficient_tuned_in_the_run_takes_effect_at_the_next_step(still):
    _, place, description = still
    slave, other = Slave(place, description), Slave(place, description)
    for cable in (slave, other):
        for _ in range(10):
            cable.set("vessel.velocity", (0.5, 0, 0))
            cable.step(1.0)
    assert slave.get("end.position").tobytes() == other.get("end.position").tobytes()
    slave.set("cable_types.K.drag_normal", 2.0)
    for cable in (slave, other):
        for _ in range(60):
            cable.step(1.0)
    assert slave.get("cable_types.K.drag_normal") == 2.0
    # More drag: the far end rises, by a lot.
    assert slave.get("end.position")[2] > other.get("end.position")[2] + 1.0
    slave.close()
    other.close()


def test_how_long_a_line_has_been_slack(tmp_path):
    """A load that snaps in heave: times of the last spell are those of the master."""
    scene = cm.load_scene(Path(__file__).parents[2] / "docs" / "jobs" / "snap_in_heave.yaml")
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, later = Slave(place, description), Slave(place, description, start=100.0)
        model = cm.CableModel(scene)
        assert_same_bits(slave, model, STATIONS)
        assert np.isnan(later.get("slack.since"))
        for _ in range(50):
            for each in (slave, later, model):
                each.step(0.5)
            assert_same_bits(slave, model, STATIONS)
        assert model.slack_time > 1.0
        assert later.get("slack.since") == 100.0 + model.slack_since
        assert later.get("slack.time") == model.slack_time
        slave.close()
        later.close()
