"""The session with a system: every part is commanded by its name, within limits."""

from __future__ import annotations

import copy
import json
import math
import re
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cablemodel_ros import interface
from cablemodel_ros.control import ControlLoop
from cablemodel_ros.diagnostics import WARN, Diagnostics
from cablemodel_ros.frames import angle_rates, angles_of, axes_of
from cablemodel_ros.session import Session, SessionError
from cablemodel_ros.settings import Settings, SettingsError
from cablemodel_ros.times import Simulated
from clocks_by_hand import Clocks
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader
from scipy.spatial.transform import Rotation
from system_to_steer import SCENE

import cablemodel as cm
from cablemodel import variables
from cablemodel.results.log.messages import quaternion_of
from cablemodel.results.log.writer import SNAPSHOT_ATTACHMENT
from cablemodel.results.replay import replay

ROOT = Path(__file__).parents[3]
DT = 0.02
LEVEL = (0.0, 0.0, 0.0, 1.0)
ANGLES = st.tuples(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))


def text(**changes: Any) -> str:
    data = copy.deepcopy(SCENE)
    for path, value in changes.items():
        here = data
        *above, last = path.split("__")
        for key in above:
            here = here[key]
        here[last] = value
    return cm.load_system(data).to_yaml()


def settings(scene: str | None = None, **values: Any) -> Settings:
    names = {name.replace("__", "."): value for name, value in values.items()}
    return Settings.of({"scene": scene or text(), "rate": 1 / DT, **names})


class Bench:
    """A session whose clocks pass with its steps, and takes for its ports by topic."""

    def __init__(self, made: Settings) -> None:
        self.clocks = Clocks()
        self.session = Session(made, self.clocks.timebase)
        self.model: cm.SystemModel = self.session.model
        self.ports = {port.topic.name: port.take for port in self.session.rig.ports}
        self.session.start()

    def steps(self, count: int, before: Any = lambda: None) -> None:
        for _ in range(count):
            before()
            self.clocks.wait(DT)
            # Whole steps, as the pacer's: sums of periods would have round-off.
            self.session.cycle(Simulated((round(self.model.time / DT) + 1) * DT))

    def odometry(self, name: str, position: Any, turn: Any = LEVEL, velocity: Any = (0, 0, 0),
                 spin: Any = (0, 0, 0), frame: str = "map", child: str = "map") -> str:  # fmt: skip
        take = self.ports[f"~/{name}/odom_in"]
        return str(take(self.clocks.ros, frame, child, position, turn, velocity, spin))

    def diagnostics(self) -> Diagnostics:
        nothing: Any = lambda _: None  # noqa: E731
        loop = ControlLoop(self.session, threading.Lock(), nothing, nothing)
        return Diagnostics(self.session, loop)


@given(ANGLES)
def test_angles_and_axes_are_each_others_inverse(angles: tuple[float, float, float]) -> None:
    turn = axes_of(np.array(angles))
    assert turn == pytest.approx(Rotation.from_euler("xyz", angles).as_matrix(), abs=1e-12)
    assert axes_of(angles_of(turn)) == pytest.approx(turn, abs=1e-9)


@given(ANGLES, ANGLES)
def test_rates_of_angles_are_their_slope_under_a_spin(
    angles: tuple[float, float, float], spin: tuple[float, float, float]
) -> None:
    step, start = 1e-6, np.array(angles)
    begin, end = (
        Rotation.from_rotvec(sign * step * np.array(spin)).as_matrix() @ axes_of(start)
        for sign in (-0.5, 0.5)
    )
    change = np.remainder(angles_of(end) - angles_of(begin) + math.pi, 2 * math.pi) - math.pi
    assert angle_rates(start, np.array(spin)) == pytest.approx(change / step, rel=1e-3, abs=1e-4)


def test_ports_outputs_and_services_have_the_users_names() -> None:
    bench = Bench(settings(vessel_inputs="vehicle=cmd_vel"))
    assert set(bench.ports) == {
        "~/ship/odom_in", "~/vehicle/cmd_vel", "~/cage/wrench_in", "~/cage/fin/deflection",
        "~/hoist/payout_rate_cmd",
    }  # fmt: skip
    assert set(bench.session.rig.orders) == {"~/weak_link/cut"}
    stamp = bench.session.stamp()
    topics = [topic for topic, _ in bench.session.rig.outputs(stamp)]
    promised = {topic.name for topic in interface.topics_of(bench.session.scene)}
    assert {*topics, variables.APPLIED_INPUTS_TOPIC} == promised
    assert len(topics) == len(set(topics))
    assert {"~/ship/odom", "~/ship/wrench", "~/cage/odom", "~/tether/nodes", "~/outputs",
            "~/umbilical/tension_start", "~/weak_link/time"} <= promised  # fmt: skip
    for some in ({"~/tether/nodes"}, {"~/outputs"}, {"~/ship/wrench", "~/cage/odom"}, set()):
        assert {topic for topic, _ in bench.session.rig.outputs(stamp, some)} == some
    assert json.loads(json.dumps(bench.session.summary()))["lines"] == {
        "umbilical": 40.0, "tether": 25.0,
    }  # fmt: skip


def test_a_vessel_follows_odometry_in_place_and_attitude() -> None:
    """A ship that heaves by 0.5 m and pitches by 5 degrees in 8 s, turning slowly: after two
    periods it is where its odometry says, and its fairlead too, which the arm of 10 m moves."""
    bench = Bench(settings(vessel_inputs="vehicle=scene"))
    w = 2.0 * math.pi / 8.0

    def motion(t: float) -> tuple[np.ndarray, ...]:
        angles = np.array([0.02 * math.sin(w * t), math.radians(5.0) * math.sin(w * t), 0.01 * t])
        rates = np.array(
            [0.02 * w * math.cos(w * t), math.radians(5.0) * w * math.cos(w * t), 0.01]
        )
        place = np.array([0.5 * t, 0.0, 0.5 * math.sin(w * t)])
        return place, np.array([0.5, 0.0, 0.5 * w * math.cos(w * t)]), angles, rates

    def spin(angles: np.ndarray, rates: np.ndarray) -> np.ndarray:
        _, pitch, yaw = angles
        c, s = math.cos(yaw), math.sin(yaw)
        across = np.array([-s, c, 0.0])
        ahead = np.array([c * math.cos(pitch), s * math.cos(pitch), -math.sin(pitch)])
        return rates[0] * ahead + rates[1] * across + np.array([0.0, 0.0, rates[2]])

    def send() -> None:
        place, velocity, angles, rates = motion(bench.model.time)
        turn = quaternion_of(axes_of(angles))
        assert bench.odometry("ship", place, turn, velocity, spin(angles, rates)) == ""

    bench.steps(800, send)
    errors = []
    for _ in range(400):
        bench.steps(1, send)
        place, _, angles, _ = motion(bench.model.time)
        ship = bench.model.vessels["ship"]
        errors.append([*(ship.position - place), *(ship.attitude - angles)])
    assert np.abs(errors)[:, :3].max() < 0.01
    assert np.abs(errors)[:, 3:].max() < math.radians(0.1)
    sheave = bench.model.vessels["ship"].position + bench.model.vessels["ship"].axes @ [-10, 0, 3]
    assert bench.model.lines["umbilical"].sample([0.0]).position[0] == pytest.approx(
        sheave, abs=1e-9
    )
    assert bench.session.rig.limited < 40
    bench.session.close()


# The cage's spool is on its far side from the vehicle: it would turn round.
@pytest.mark.filterwarnings("ignore::cablemodel.UnstableStartWarning")
def test_a_heading_is_reached_by_the_shorter_way() -> None:
    """From 170 degrees to -170, and back: over the south, never more than 10 degrees from it."""
    made = settings(
        text(vessels__ship__attitude=[0.0, 0.0, math.radians(170.0)]), vessel_inputs="vehicle=scene"
    )
    bench = Bench(made)
    for heading in (-170.0, 170.0):
        turn = quaternion_of(axes_of(np.array([0.0, 0.0, math.radians(heading)])))
        off = []
        for _ in range(200):
            bench.steps(1, lambda turn=turn: bench.odometry("ship", (0, 0, 0), turn))
            yaw = math.degrees(bench.model.vessels["ship"].attitude[2])
            off.append(abs(math.remainder(yaw - 180.0, 360.0)))
        assert max(off) < 10.5
        assert math.remainder(yaw - heading, 360.0) == pytest.approx(0.0, abs=0.01)
    bench.session.close()


def test_a_twist_in_its_own_axes_moves_a_driven_end_that_turns() -> None:
    bench = Bench(settings(vessel_input="scene", vessel_inputs="vehicle=cmd_vel"))
    take = bench.ports["~/vehicle/cmd_vel"]
    bench.steps(400, lambda: take(bench.clocks.ros, "vehicle", (0.4, 0, 0), (0, 0, 0.1)))
    vehicle = bench.model.vessels["vehicle"]
    heading = vehicle.attitude[2]
    assert heading == pytest.approx(0.1 * 8.0, abs=0.01)
    expected = 0.4 * np.array([math.cos(heading), math.sin(heading), 0.0])
    assert vehicle.velocity == pytest.approx(expected, abs=1e-9)
    # Circle of 4 m: up to the run-up of .2 s.
    place = vehicle.position - [10.0, 0.0, -37.0]
    assert place == pytest.approx([4 * math.sin(0.8), 4 * (1 - math.cos(0.8)), 0], abs=0.05)
    bench.session.close()


def test_a_twist_without_a_stamp_is_in_the_vessel_s_axes() -> None:
    made = settings(vessel_input="scene", vessel_inputs="ship=cmd_vel", cmd_vel_stamped=False)
    bench = Bench(made)
    (port,) = (p for p in bench.session.rig.ports if p.topic.name == "~/ship/cmd_vel")
    assert port.topic.message == "geometry_msgs/msg/Twist"
    bench.steps(100, lambda: port.take((0.2, 0, 0), (0, 0, 0.4)))
    ship = bench.model.vessels["ship"]
    assert ship.attitude[2] > 0.6
    assert ship.velocity @ ship.axes == pytest.approx([0.2, 0.0, 0.0], abs=1e-9)
    bench.session.close()


def test_a_stale_command_brings_a_vessel_to_rest_and_a_wrench_to_nothing() -> None:
    bench = Bench(settings(vessel_inputs="vehicle=scene ship=cmd_vel"))
    twist, wrench = bench.ports["~/ship/cmd_vel"], bench.ports["~/cage/wrench_in"]
    diagnostics = bench.diagnostics()
    assert "no ship/cmd_vel yet" in diagnostics.statuses()[1].message

    def send() -> None:
        twist(bench.clocks.ros, "map", (0.8, 0.2, 0), (0, 0, 0.05))
        wrench(bench.clocks.ros, "map", (0, 300.0, 0), (0, 0, 0))

    bench.steps(100, send)
    assert bench.model.vessels["ship"].velocity == pytest.approx([0.8, 0.2, 0.0])
    assert bench.model.bodies["cage"].velocity[1] > 0.1
    bench.steps(100)
    ship = bench.model.vessels["ship"]
    assert ship.velocity.tolist() == [0.0, 0.0, 0.0]
    assert ship.angular_velocity == pytest.approx(np.zeros(3), abs=1e-12)
    status = diagnostics.statuses()[1]
    assert status.level == WARN
    assert "ship/cmd_vel is stale: ramping to zero" in status.message
    assert "cage/wrench_in is stale: it acts no more" in status.message
    assert (
        bench.session.rig.advance(Simulated(bench.model.time + DT), bench.clocks.timebase.now())[
            "forces"
        ]
        == {}
    )
    bench.session.close()


def test_a_wrench_in_the_body_s_axes_turns_with_it() -> None:
    bench = Bench(settings(vessel_input="scene"))
    bench.steps(1, lambda: bench.ports["~/cage/wrench_in"](None, "cage", (100.0, 0, 0), (0, 0, 5)))
    axes = bench.model.bodies["cage"].axes
    given = bench.session.rig.advance(Simulated(bench.model.time + DT), bench.clocks.timebase.now())
    assert given["forces"]["cage"] == pytest.approx([*(axes @ [100, 0, 0]), *(axes @ [0, 0, 5])])
    bench.session.close()


def test_a_foil_goes_where_it_is_told_at_its_rate_and_stays_there() -> None:
    bench = Bench(settings(vessel_input="scene", limits__deflection_rate=0.5))
    assert bench.ports["~/cage/fin/deflection"](0.2) == ""
    bench.steps(10)
    assert bench.model.deflections["cage.fin"] == pytest.approx(0.1)
    bench.steps(100)
    assert bench.model.deflections["cage.fin"] == 0.2
    assert not bench.session.rig.stale
    bench.session.close()


def test_a_winch_follows_commands_and_stops_when_they_end() -> None:
    bench = Bench(settings(vessel_input="scene", limits__payout_acceleration=0.5))
    bench.steps(20)
    assert bench.model.winches["hoist"].payout_rate == 0.0
    command = bench.ports["~/hoist/payout_rate_cmd"]
    bench.steps(100, lambda: command(0.3))
    winch = bench.model.winches["hoist"]
    assert winch.payout_rate == pytest.approx(0.3)
    assert winch.drum_length == pytest.approx(30.0 - (winch.line_length - 40.0), abs=1e-9)
    assert 40.0 < winch.line_length < 40.0 + 0.3 * 100 * DT
    assert "hoist/payout_rate_cmd" not in bench.session.rig.stale
    bench.steps(200)
    assert "hoist/payout_rate_cmd" in bench.session.rig.stale
    assert bench.model.winches["hoist"].payout_rate == 0.0
    bench.steps(4000, lambda: command(9.0))  # to the end of the drum, and gently
    assert bench.model.winches["hoist"].drum_length == pytest.approx(0.0, abs=0.05)
    bench.session.close()


def test_pay_out_without_cable_on_the_drum_is_told() -> None:
    """Of a winch that has no drum, and of one whose drum is empty; not while it takes in."""
    for drum, why in ((0.0, "winches.hoist has no drum"), (0.5, "the drum is empty")):
        bench = Bench(settings(text(winches__hoist__drum=drum), vessel_input="scene"))
        diagnostics, command = bench.diagnostics(), bench.ports["~/hoist/payout_rate_cmd"]
        told = f"hoist/payout_rate_cmd asks for cable, and {why}"
        bench.steps(150, lambda command=command: command(0.5))
        assert bench.model.winches["hoist"].drum_length == 0.0
        commands = diagnostics.statuses()[1]
        assert commands.level == WARN
        assert told in commands.message
        bench.steps(20, lambda command=command: command(-0.5))
        assert told not in diagnostics.statuses()[1].message
        bench.session.close()


def test_rates_that_the_model_refuses_are_given_up_and_told() -> None:
    """The system goes on without; the winch stands, also where the scene's own would turn it."""
    rate = [{"t": 0.0, "rate": 0.0}, {"t": 0.1, "rate": 0.2}]
    bench = Bench(settings(text(winches__hoist__rate=rate), vessel_input="scene"))
    whole = bench.model.step_to

    def refusing(target: float, **inputs: Any) -> None:
        if inputs["rates"].get("hoist"):
            raise cm.StepError("the winch is stuck", time=bench.model.time)
        whole(target, **inputs)

    bench.model.step_to = refusing  # type: ignore[method-assign]
    bench.ports["~/hoist/payout_rate_cmd"](0.5)
    bench.steps(20)
    assert bench.model.time == pytest.approx(20 * DT)
    assert bench.model.winches["hoist"].payout_rate == 0.0
    assert bench.session.rig.tallies["hoist/payout_rate_cmd"].refused == 1
    commands = bench.diagnostics().statuses()[1]
    assert commands.level == WARN
    assert "the winch is stuck" in commands.message
    bench.model.step_to = whole  # type: ignore[method-assign]
    bench.steps(20, lambda: bench.ports["~/hoist/payout_rate_cmd"](0.3))
    assert bench.model.winches["hoist"].payout_rate == pytest.approx(0.3)
    bench.session.close()


def test_a_step_that_fails_for_another_reason_than_a_winch_fails_the_session() -> None:
    bench = Bench(settings(vessel_input="scene"))

    def refusing(target: float, **inputs: Any) -> None:
        raise cm.StepError("no convergence", time=bench.model.time)

    bench.model.step_to = refusing  # type: ignore[method-assign]
    with pytest.raises(SessionError, match="no convergence"):
        bench.steps(1)
    bench.ports["~/hoist/payout_rate_cmd"](0.5)
    with pytest.raises(SessionError, match="no convergence"):  # not the winch's fault
        bench.steps(1)
    bench.session.close()


def test_limits_of_winches_and_foils_are_counted() -> None:
    bench = Bench(settings(vessel_input="scene", limits__payout_acceleration=0.5))
    bench.steps(10)
    assert bench.session.rig.limited == 0
    bench.ports["~/cage/fin/deflection"](0.2)  # takes 0.2 s at 1 rad/s
    bench.steps(20)
    assert bench.session.rig.limited == pytest.approx(0.2 / DT, abs=1)
    before = bench.session.rig.limited
    command = bench.ports["~/hoist/payout_rate_cmd"]
    bench.steps(60, lambda: command(0.3))  # takes 0.6 s
    assert bench.session.rig.limited - before == pytest.approx(0.6 / DT, abs=1)
    bench.session.close()


def test_what_cannot_be_used_is_refused_by_name_and_counted() -> None:
    bench = Bench(settings(vessel_inputs="vehicle=cmd_vel"))
    refusals = [
        bench.odometry("ship", (math.nan, 0, 0)),
        bench.odometry("ship", (0, 0, 0), turn=(0, 0, 0, 0)),
        bench.odometry("ship", (0, 0, 0), frame="odom"),
        bench.odometry("ship", (0, 0, 0), child="vehicle"),
        bench.ports["~/vehicle/cmd_vel"](bench.clocks.ros, "ship", (1, 0, 0), (0, 0, 0)),
        bench.ports["~/cage/wrench_in"](None, "ship", (1, 0, 0), (0, 0, 0)),
        bench.ports["~/cage/wrench_in"](bench.clocks.ros + -9.0, "", (1, 0, 0), (0, 0, 0)),
        bench.ports["~/cage/fin/deflection"](math.inf),
        bench.ports["~/hoist/payout_rate_cmd"](math.nan),
    ]
    for refusal, words in zip(
        refusals,
        ("ship/odom_in refused: not finite", "ship/odom_in refused: orientation",
         "ship/odom_in refused: frame 'odom'; allowed: map",
         "ship/odom_in refused: child frame 'vehicle'; allowed: ship, map",
         "vehicle/cmd_vel refused: frame 'ship'; allowed: map, vehicle",
         "cage/wrench_in refused: frame 'ship'; allowed: map, cage",
         "cage/wrench_in refused: its stamp is 9 s old",
         "cage/fin/deflection refused: not finite",
         "hoist/payout_rate_cmd refused: not finite"),
        strict=True,
    ):  # fmt: skip
        assert refusal.startswith(words), refusal
    message = bench.diagnostics().statuses()[1].message
    assert "4 of ship/odom_in refused" in message
    assert "1 of cage/fin/deflection refused" in message
    bench.session.close()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("boat=odom", "'boat=odom'; allowed: NAME=SOURCE with NAME ship | vehicle"),
        ("ship=radio", "SOURCE odom | cmd_vel | scene"),
        ("ship", "'ship'; allowed"),
    ],
)
def test_sources_that_are_none_are_refused(given: str, words: str) -> None:
    with pytest.raises(SettingsError) as caught:
        Session(settings(vessel_inputs=given))
    assert words in str(caught.value)


def test_a_vessel_that_waves_move_is_not_moved_twice() -> None:
    rows = [{"heading_deg": 0, "period": 8, "heave": 0.5}]
    scene = text(
        environment__waves={"regular": {"height": 1, "period": 8}}, vessels__ship__raos=rows
    )
    with pytest.raises(SettingsError, match=r"vessels.ship.raos .* allowed: ship=scene"):
        Session(settings(scene))
    Session(settings(scene, vessel_inputs="ship=scene")).close()


@pytest.mark.parametrize(
    "path", sorted((ROOT / "scenes/systems").glob("*.yaml")), ids=lambda p: p.stem
)
def test_the_scenes_of_systems_run_and_are_published_whole(path: Path) -> None:
    bench = Bench(settings(str(path), vessel_input="scene"))
    bench.steps(3)
    assert bench.model.time == pytest.approx(3 * DT)
    topics = {topic for topic, _ in bench.session.rig.outputs(bench.session.stamp())}
    assert {*topics, variables.APPLIED_INPUTS_TOPIC} == {
        topic.name for topic in interface.topics_of(bench.session.scene)
    }
    bench.session.close()


def test_settings_that_are_odd_with_a_system_are_told() -> None:
    made = Session(settings(tow_point=[1.0, 0.0, 0.0], vessel_inputs="ship=scene", tf_vessel=True))
    assert made.rig.notes == (
        "parameter tow_point is set, and means nothing for this scene",
        "tf_vessel broadcasts map -> vehicle: what gives ~/vehicle/odom_in must not",
    )
    made.close()


def test_a_cut_is_made_once_and_again_after_going_back(tmp_path: Path) -> None:
    bench = Bench(settings(vessel_input="scene", on_failure="retry"))
    order = bench.session.rig.orders["~/weak_link/cut"]
    bench.steps(60)
    done, words = order()
    assert done
    assert words == "weak_link: made in the next step, after t = 1.2 s"
    bench.steps(1)
    assert bench.model.cuts["weak_link"] == pytest.approx(1.2)
    done, words = order()
    assert not done
    assert words.startswith("weak_link: made already, at t = 1.2")
    slack = {
        f"{name}: slack so far [s]": f"{line.slack.time:.3f}"
        for name, line in bench.model.lines.items()
    }
    assert bench.session.rig.values() == {"weak_link made [s]": "1.200", **slack}
    whole = bench.model.step_to

    def failing(target: float, **inputs: Any) -> None:
        raise cm.StepError("no convergence", time=bench.model.time)

    bench.model.step_to = failing  # type: ignore[method-assign]
    with pytest.raises(SessionError):
        bench.steps(1)
    bench.model.step_to = whole  # type: ignore[method-assign]
    assert bench.session.retry()
    assert bench.model.cuts["weak_link"] is None
    bench.steps(1)
    assert bench.model.cuts["weak_link"] is not None
    bench.session.reset()
    bench.steps(1)
    assert bench.model.cuts["weak_link"] is None
    bench.session.close()


def drive(bench: Bench, steps: int) -> None:
    """Everything at once."""

    def send() -> None:
        t = bench.model.time
        angles = np.array([0.05 * math.sin(t), 0.1 * math.sin(0.7 * t), 0.02 * t])
        bench.odometry("ship", (0.5 * t, 0.2 * math.sin(t), 0.3 * math.sin(0.8 * t)),
                       quaternion_of(axes_of(angles)), (0.5, 0, 0), (0, 0, 0.02),
                       child="ship")  # fmt: skip
        bench.ports["~/vehicle/cmd_vel"](None, "map", (0.3, 0.1, 0.05), (0, 0, 0.1))
        bench.ports["~/cage/wrench_in"](None, "cage", (80.0 * math.sin(t), 20.0, 0), (0, 0, 4.0))
        bench.ports["~/cage/fin/deflection"](0.3 * math.sin(2.0 * t))
        bench.ports["~/hoist/payout_rate_cmd"](0.4 * math.sin(t))

    bench.steps(steps, send)


def test_the_log_of_a_system_replays_to_the_bit_and_the_library_agrees(tmp_path: Path) -> None:
    bench = Bench(settings(vessel_inputs="vehicle=cmd_vel", log__folder=str(tmp_path)))
    drive(bench, 100)
    bench.session.rig.orders["~/weak_link/cut"]()
    drive(bench, 100)
    bench.session.close()
    (path,) = tmp_path.glob("cable_*.mcap")
    run = cm.open_run(path)
    assert run.complete
    result = replay(run)
    assert result.exact, result
    assert (result.steps, result.samples) == (200, 41)
    model = cm.SystemModel(run.scene)
    rows = np.stack(list(run.applied_inputs.values()), axis=1)
    for row in rows:
        given = model.given_by(row)
        assert set(given["vessels"]) == {"ship", "vehicle"}
        model.step_to(row[0], **given)
    for name, value in model.outputs().items():
        assert np.array_equal(value, bench.model.outputs()[name], equal_nan=True), name


def test_files_of_a_system_begin_at_a_snapshot_and_a_saved_state_goes_on(tmp_path: Path) -> None:
    logs = tmp_path / "log"
    bench = Bench(settings(vessel_inputs="vehicle=cmd_vel", log__folder=str(logs)))
    drive(bench, 50)
    bench.session.stop()
    bench.session.start()
    path = bench.session.save().write(tmp_path)
    with np.load(path) as saved:
        assert saved["tether.position"].shape == (len(saved["tether.s"]), 3)
    assert cm.load_system(path.with_suffix(".yaml")) == bench.session.scene
    other = Bench(settings(vessel_inputs="vehicle=scene ship=scene", initial_state=str(path)))
    assert other.model.time == bench.model.time
    relative = settings(initial_state=str(path), odom_relative=True)
    moved: Any = Bench(relative)
    place = moved.model.vessels["ship"].position
    assert np.linalg.norm(place) > 0.1
    moved.odometry("ship", (900.0, 0, 0))
    sample = moved.session.rig._commands["ship"].latest().odometry
    assert sample.course.position == pytest.approx(place)
    bench.steps(30)
    bench.session.close()
    first, second = sorted(logs.glob("*.mcap"))
    with second.open("rb") as file:
        (snapshot,) = (a.data for a in make_reader(file).iter_attachments()
                       if a.name == SNAPSHOT_ATTACHMENT)  # fmt: skip
    model = cm.SystemModel(bench.session.scene)
    model.restore(snapshot)
    assert model.time == other.model.time
    for name, value in model.outputs().items():
        assert np.array_equal(value, other.model.outputs()[name], equal_nan=True), name
    for file in (first, second):
        result = replay(cm.open_run(file))
        assert result.exact
        assert result.steps
    changed = text(bodies__cage__mass=401.0)
    with pytest.raises(cm.SceneError, match="another scene"):
        Session(settings(changed, initial_state=str(path)))
    other.session.close()


def test_frames_of_bodies_and_vessels_are_those_of_the_model() -> None:
    bench = Bench(settings(vessel_input="scene", tf=True, tf_vessel=True))
    bench.steps(1)
    cycle = bench.session.cycle(Simulated(0.1))
    assert [frame.name for frame in cycle.frames] == ["cage", "ship", "vehicle"]
    assert np.array_equal(cycle.frames[0].position, bench.model.bodies["cage"].position)
    assert bench.session.cycle(Simulated(0.2), topics=()).frames == []
    bench.session.close()


def test_what_a_system_may_be_wrong_by_is_published_and_told() -> None:
    bench = Bench(settings(text(solver={"error_estimate": True})))
    bench.steps(20)
    errors = bench.model.errors
    topics = {topic for topic, _ in bench.session.rig.outputs(bench.session.stamp())}
    assert {f"~/{name}/position_error" for name in errors} < topics
    rig: Any = bench.session.rig
    assert list(rig.findings()) == []
    for name, its in errors.items():
        shown = rig.values()[f"{name}: estimated error of positions [m]"]
        assert float(shown) == pytest.approx(its.position, rel=1e-5)
    name = next(iter(bench.model.lines))
    for wrong, words in (
        (1e3, f"positions of {name} may be off by 1e\\+03 m, more than a tolerance of 0.001"),
        (math.nan, "errors are not known"),
    ):
        bench.model._errors = {**errors, name: replace(errors[name], position=wrong)}
        (finding,) = rig.findings()
        assert re.match(words, finding)
