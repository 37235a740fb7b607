"""The session: a model steered by commands, with services, log and failures."""

from __future__ import annotations

import math
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from cablemodel_ros.control import ControlLoop, ForeignClock
from cablemodel_ros.diagnostics import ERROR, OK, WARN, Diagnostics
from cablemodel_ros.recording import Recorder
from cablemodel_ros.session import Session, SessionError
from cablemodel_ros.settings import Settings
from cablemodel_ros.timebase import Followed
from cablemodel_ros.times import Simulated, Stamp
from clocks_by_hand import Clocks
from mcap.reader import make_reader

import cablemodel as cm
from cablemodel.model import Snapshot
from cablemodel.results.log.writer import SNAPSHOT_ATTACHMENT
from cablemodel.results.replay import replay

CABLE = {
    "diameter": 0.01666, "mass": 0.4613, "submerged_weight": 2.33333, "axial_stiffness": 1.0e6,
    "bending_stiffness": 0.1, "drag_normal": 1.0, "drag_tangential": 0.1586, "added_mass": 1.0,
}  # fmt: skip
PATTERN = "cable_*.mcap"
SCENE: dict[str, Any] = {
    "title": "Session",
    "cable_types": {"K": CABLE},
    "line": [{"cable": {"type": "K", "length": 30}}],
    "payout": {"drum": [{"cable": {"type": "K", "length": 5}}]},
    "run": {"duration": 60, "output_interval": 0.1},
}


def settings(*overrides: str, **values: object) -> Settings:
    scene = cm.load_scene(SCENE, overrides).to_yaml()
    names = {name.replace("__", "."): value for name, value in values.items()}
    return Settings.of({"scene": scene, "vessel_input": "cmd_vel", **names})


@pytest.fixture
def session() -> Any:
    made = Session(settings(), Clocks().timebase)
    made.start()
    yield made
    made.close()


def opened(made: Settings, clocks: Clocks | None = None) -> Session:
    """A session whose clocks pass only where a test lets them."""
    return Session(made, (clocks or Clocks()).timebase)


def drive(
    session: Session, steps: int, velocity=(0.8, 0.0, 0.0), rate: float | None = None
) -> None:
    dt = 1.0 / session.settings.rate
    begin = round(session.model.time / dt)
    for k in range(begin + 1, begin + steps + 1):
        session.rig.commands.take_twist(None, "map", velocity, (0, 0, 0))
        if rate is not None:
            session.rig.commands.take_payout_rate(rate)
        session.cycle(Simulated(k * dt))


def test_a_session_is_the_library_fed_the_same_commands(session: Session) -> None:
    model = cm.CableModel(session.scene)
    drive(session, 300)
    velocity = np.zeros(3)
    for k in range(1, 301):
        # Default limit: 2 m/s2, so 0.02 m/s a step.
        velocity = np.array([min(0.8, velocity[0] + 0.02), 0.0, 0.0])
        model.step_to(k * 0.01, vessel_velocity=velocity, payout_rate=0.0)
    assert np.abs(session.model.state().position - model.state().position).max() < 1e-9
    assert session.model.top_tension == pytest.approx(model.top_tension, rel=1e-7)
    assert session.rig.helm.limited == 39


def test_a_scene_with_direct_integration_is_steered_saved_and_restored(tmp_path: Path) -> None:
    """As with the finite elements: the library's numbers, and a saved state that goes on."""
    solver = {"method": "direct_integration", "time_step": 0.1}
    scene = cm.load_scene({**SCENE, "solver": solver}).to_yaml()
    session = opened(settings(scene=scene))
    session.start()
    assert session.scene.solver.method == "direct_integration"
    model = cm.CableModel(session.scene)
    drive(session, 200, rate=0.0)
    velocity = np.zeros(3)
    for k in range(1, 201):
        velocity = np.array([min(0.8, velocity[0] + 0.02), 0.0, 0.0])
        model.step_to(k * 0.01, vessel_velocity=velocity, payout_rate=0.0)
    assert np.abs(session.model.state().position - model.state().position).max() < 1e-9
    path = session.save().write(tmp_path)
    other = opened(settings(scene=scene, initial_state=str(path)))
    drive(session, 50, rate=0.3)
    other.start()
    drive(other, 50, rate=0.3)
    assert other.model.line_length > 30.0
    assert other.model.top_tension == session.model.top_tension
    session.close()
    other.close()


def test_pay_out_stops_before_the_drum_is_empty(session: Session) -> None:
    drive(session, 1500, rate=1.0)
    assert session.model.drum_length == pytest.approx(0.0, abs=0.05)
    assert session.model.line_length == pytest.approx(35.0, abs=0.05)
    assert abs(session.model.payout_rate) < 0.1
    drive(session, 200, rate=-1.0)
    assert session.model.payout_rate == pytest.approx(-1.0)
    assert session.model.line_length < 34.5


def test_pay_out_that_the_model_refuses_is_given_up_and_told(session: Session) -> None:
    whole = session.model.step_to

    def refusing(target: float, **inputs: Any) -> None:
        if inputs["payout_rate"]:
            raise cm.StepError("the winch is stuck", time=session.model.time)
        whole(target, **inputs)

    session.model.step_to = refusing  # type: ignore[method-assign]
    drive(session, 20, rate=0.5)
    assert session.model.time == pytest.approx(0.2)
    assert session.model.line_length == 30.0
    assert session.rig.tallies["payout_rate_cmd"].refused > 0
    loop = ControlLoop(session, threading.Lock(), lambda c: None, lambda reason: None)
    commands = Diagnostics(session, loop).statuses()[1]
    assert commands.level == WARN
    assert "the winch is stuck" in commands.message


def test_a_step_that_cannot_be_made_fails_the_session_and_is_logged(tmp_path: Path) -> None:
    session = opened(settings(log__folder=str(tmp_path)))
    session.start()
    drive(session, 5)

    def failing(target: float, **inputs: Any) -> None:
        raise cm.StepError("no convergence", time=session.model.time, arc_length=3.0)

    session.model.step_to = failing  # type: ignore[method-assign]
    with pytest.raises(SessionError, match="no convergence"):
        drive(session, 1)
    assert "3 m along the cable" in session.failure
    session.close()
    (path,) = tmp_path.glob(PATTERN)
    run = cm.open_run(path)
    assert not run.complete
    assert "no convergence" in run.reason


def test_reset_brings_the_initial_state_back_and_forgets_commands() -> None:
    clocks = Clocks()
    session = opened(settings(), clocks)
    session.start()
    initial = session.model.snapshot()
    drive(session, 100)
    assert session.model.snapshot() != initial
    clocks.wait(5.0)
    session.reset()
    assert session.model.snapshot() == initial
    assert session.rig.commands.latest().twist is None
    assert session.stamp() == clocks.ros
    session.close()


@pytest.mark.parametrize("step", [-20.0, 30.0])
def test_stamps_follow_a_system_clock_that_is_set_in_a_file_of_its_own(
    tmp_path: Path, step: float
) -> None:
    clocks = Clocks()
    session = opened(settings(log__folder=str(tmp_path)), clocks)
    session.start()
    loop, _ = loop_of(session)
    diagnostics = Diagnostics(session, loop)
    for moved in (0.0, step):
        clocks.set(moved)
        for _ in range(50):
            clocks.wait(0.01)
            drive(session, 1)
            assert abs(session.stamp() - clocks.ros) < 0.1 + abs(moved)
        assert session.stamp() - clocks.ros == pytest.approx(0.0, abs=1e-6)
    status = diagnostics.statuses()[0]
    assert status.level == WARN
    assert f"the system's clock was set by {step:+g} s" in status.message
    session.close()
    first, second = sorted(tmp_path.glob(PATTERN))
    assert cm.open_run(first).applied_inputs["time"][-1] == pytest.approx(0.5, abs=0.11)
    assert cm.open_run(second).applied_inputs["time"][-1] == pytest.approx(1.0)


def test_time_that_slips_moves_stamps_and_not_the_log(tmp_path: Path) -> None:
    """The node was held up: its stamps are the ROS clock's again, the log's times the model's."""
    clocks = Clocks()
    session = opened(settings(log__folder=str(tmp_path)), clocks)
    session.start()
    for _ in range(2):
        for _ in range(50):
            clocks.wait(0.01)
            drive(session, 1)
        clocks.wait(3.0)
        session.timebase.slip(3.0)
        assert session.stamp() == clocks.ros
    drive(session, 1)
    session.close()
    (path,) = tmp_path.glob(PATTERN)
    run = cm.open_run(path)
    assert run.time == pytest.approx(np.arange(0.0, 1.05, 0.1))
    assert run.applied_inputs["time"][-1] == pytest.approx(1.01)
    assert replay(run).exact


def test_a_saved_state_goes_on_as_the_model_did(session: Session, tmp_path: Path) -> None:
    drive(session, 100)
    path = session.save().write(tmp_path)
    other = opened(settings(initial_state=str(path)))
    assert other.model.time == session.model.time
    drive(session, 50, rate=0.0)
    other.start()
    drive(other, 50, rate=0.0)
    assert other.model.top_tension == session.model.top_tension
    assert cm.load_scene(path.with_suffix(".yaml")) == session.scene
    with np.load(path) as saved:
        assert saved["position"].shape == (len(saved["s"]), 3)


def test_a_saved_state_has_the_vessels_attitude(session: Session, tmp_path: Path) -> None:
    """Commands along its bow go on as they did; an initial heading that is given counts more."""
    for _ in range(100):
        session.rig.commands.take_twist(None, "base_link", (0.5, 0, 0), (0, 0, 0.5))
        drive_on(session)
    attitude = session.rig.attitude
    assert math.atan2(attitude[1, 0], attitude[0, 0]) == pytest.approx(0.5, abs=0.05)
    path = session.save().write(tmp_path)
    other = opened(settings(initial_state=str(path)))
    np.testing.assert_array_equal(other.rig.attitude, attitude)
    other.reset()
    np.testing.assert_array_equal(other.rig.attitude, attitude)
    given = opened(settings(initial_state=str(path), initial_heading=2.5))
    assert given.rig.attitude[0, 0] == pytest.approx(math.cos(2.5))


def drive_on(session: Session) -> None:
    """One cycle."""
    dt = 1.0 / session.settings.rate
    session.cycle(Simulated((round(session.model.time / dt) + 1) * dt))


def test_pay_out_that_the_scene_schedules_and_nobody_commands_is_told() -> None:
    schedule = "payout.rate=[{t: 0, rate: 0.5}]"
    made = opened(settings(schedule))
    assert any("no payout_rate_cmd yet" in said for said in made.rig.command_findings())
    made.rig.commands.take_payout_rate(0.1)
    assert list(made.rig.command_findings()) == []
    for other in (settings(schedule, payout_input="scene"), settings()):
        assert list(opened(other).rig.command_findings()) == []


def test_relative_odometry_counts_from_where_a_saved_state_is(
    session: Session, tmp_path: Path
) -> None:
    drive(session, 300)
    path = session.save().write(tmp_path)
    made = settings(initial_state=str(path), vessel_input="odom", odom_relative=True)
    other: Any = opened(made)
    place = other.model.vessel_position
    assert place[0] > 1.0
    other.rig.commands.take_odometry(
        None, "map", "map", (700.0, 0, 0), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)
    )
    assert other.rig.commands.latest().odometry.course.position == pytest.approx(place)


def test_a_saved_state_of_another_scene_is_refused(session: Session, tmp_path: Path) -> None:
    path = session.save().write(tmp_path)
    other = cm.load_scene(
        {**SCENE, "line": [{"cable": {"type": "K", "length": 30, "elements": 3}}]}
    )
    with pytest.raises(cm.SceneError, match=r"initial_state: .* belongs to another scene; "):
        Session(settings(scene=other.to_yaml(), initial_state=str(path)))


def test_what_is_no_saved_state_is_refused_by_name(session: Session, tmp_path: Path) -> None:
    """The scene that was saved beside it, half of it, an array, and nothing."""
    path = session.save().write(tmp_path)
    half, array = tmp_path / "half.npz", tmp_path / "array.npy"
    half.write_bytes(path.read_bytes()[:-500])
    np.save(array, np.zeros(3))
    for file in (path.with_suffix(".yaml"), half, array):
        with pytest.raises(cm.SceneError) as told:
            Session(settings(initial_state=str(file)))
        assert str(told.value) == (
            f"initial_state: {file} is no saved state; allowed: a .npz file that ~/save wrote"
        )
    with pytest.raises(cm.SceneError, match=r"none.npz cannot be read \(No such file"):
        Session(settings(initial_state=str(tmp_path / "none.npz")))


def test_wrong_scenes_are_told_in_the_scene_s_own_words() -> None:
    with pytest.raises(cm.SceneError, match="the parameter is empty"):
        Session(Settings.of({}))
    with pytest.raises(cm.SceneError, match="lenght: unknown key, did you mean length"):
        Session(Settings.of({"scene": cm.load_scene(SCENE).to_yaml().replace("length", "lenght")}))


def test_the_log_of_a_session_replays_exactly(tmp_path: Path) -> None:
    session = opened(settings(log__folder=str(tmp_path)))
    session.start()
    drive(session, 150, (0.7, 0.3, 0.0), rate=0.4)
    session.close()
    (path,) = tmp_path.glob(PATTERN)
    run = cm.open_run(path)
    assert run.complete
    inputs = run.applied_inputs
    model = cm.CableModel(run.scene)
    states = {0.0: model.state()}
    for k, end in enumerate(inputs["time"]):
        velocity = [inputs[f"vessel_velocity.{axis}"][k] for axis in "xyz"]
        assert inputs["vessel_velocity_given"][k] == 1
        model.step_to(end, vessel_velocity=velocity, payout_rate=inputs["payout_rate"][k])
        states[float(end)] = model.state()
    assert len(inputs["time"]) == 150
    assert len(run.states) == 16
    for state in run.states:
        assert np.array_equal(state.position, states[state.time].position)
        assert np.array_equal(state.tension, states[state.time].tension)


def test_logs_are_bounded_and_each_file_begins_at_a_snapshot(tmp_path: Path) -> None:
    session = opened(settings(log__folder=str(tmp_path), log__max_size=0.1, log__max_files=3))
    session.start()
    until = time.monotonic() + 60
    while session.recorder is not None and session.recorder.files < 6:
        drive(session, 100)
        while session.recorder._queue:  # no output is left out for want of room
            time.sleep(0.01)
        assert time.monotonic() < until
    session.close()
    files = sorted(tmp_path.glob(PATTERN), key=lambda path: path.stat().st_mtime)
    assert len(files) == 3
    assert max(path.stat().st_size for path in files) < 3e6
    last_time = 0.0
    for path in files:
        with path.open("rb") as file:
            attachments = {a.name: a.data for a in make_reader(file).iter_attachments()}
        run = cm.open_run(path)
        model = cm.CableModel(run.scene)
        model.restore(Snapshot(attachments[SNAPSHOT_ATTACHMENT]))
        assert model.time == run.states[0].time >= last_time
        assert np.array_equal(model.state().position, run.states[0].position)
        assert np.all(np.diff(run.applied_inputs["time"]) > 0)
        assert run.applied_inputs["time"][0] == pytest.approx(model.time + 0.01)
        last_time = run.applied_inputs["time"][-1]
        again = replay(run)
        assert again.exact
        assert again.steps == len(run.applied_inputs["time"])
    run.metadata["engine"] = "old"
    with pytest.raises(cm.LogError, match="a state of engine old"):
        replay(run)


def test_a_log_after_a_failure_has_all_steps_from_its_state_on(tmp_path: Path) -> None:
    """Also those that are made before the writing thread opens the new file."""
    folder = tmp_path / "log"
    folder.write_text("in the way")
    session = opened(settings(log__folder=str(folder)))
    recorder = session.recorder
    assert recorder is not None
    session.start()
    wait_until(lambda: bool(recorder.error))
    drive(session, 20)
    folder.unlink()
    wait_until(lambda: recorder.wants_file, 60.0)
    drive(session, 50, (0.7, 0.3, 0.0), rate=0.4)
    session.close()
    (path,) = folder.glob(PATTERN)
    with path.open("rb") as file:
        (state,) = (
            a.data for a in make_reader(file).iter_attachments() if a.name == SNAPSHOT_ATTACHMENT
        )
    run = cm.open_run(path)
    model = cm.CableModel(run.scene)
    model.restore(Snapshot(state))
    assert run.applied_inputs["time"][0] == pytest.approx(model.time + 0.01)
    assert len(run.applied_inputs["time"]) >= 49
    assert replay(run).exact


def test_a_slow_disk_costs_outputs_first_and_then_begins_a_new_file(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path, cm.load_scene(SCENE), max_bytes=1e9, max_files=9, capacity=10)
    recorder._stop.set()  # the writer is gone: nothing is taken from the queue
    recorder._thread.join()
    for stamp in range(20):
        recorder.step(Stamp(stamp), [])
        recorder.outputs(Stamp(stamp), [])
    assert recorder.dropped > recorder.gaps > 0
    assert recorder.wants_file


# -- the control loop -----------------------------------------------------------------------------


def loop_of(session: Session, clock: ForeignClock | None = None) -> tuple[ControlLoop, Any]:
    seen = SimpleNamespace(cycles=[], failures=[])
    loop = ControlLoop(
        session, threading.Lock(), seen.cycles.append, seen.failures.append, clock=clock
    )
    return loop, seen


def wait_until(condition: Any, seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)


def test_real_time_is_real_time() -> None:
    session = Session(settings(rate=50.0))
    loop, seen = loop_of(session)
    begin = time.monotonic()
    loop.start()
    wait_until(lambda: session.model.time > 1.0)
    loop.stop()
    elapsed = time.monotonic() - begin
    assert session.model.time + loop.pacer.slipped == pytest.approx(elapsed, abs=0.3)
    stamps = [cycle.stamp for cycle in seen.cycles]
    assert stamps == sorted(stamps)
    assert abs(stamps[-1] - Stamp.now()) < 1.0
    session.close()


def test_a_foreign_clock_leads_and_its_jump_back_resets() -> None:
    clock = ForeignClock()
    session = Session(settings(), Followed(clock.now))
    loop, seen = loop_of(session, clock)
    loop.start()
    time.sleep(0.2)
    assert session.model.time == 0.0
    for k in range(11):
        clock.set(Stamp(7_000_000_000 + k * 50_000_000))
        time.sleep(0.01)
    wait_until(lambda: session.model.time >= 0.5 - 1e-9)
    time.sleep(0.2)
    assert session.model.time == pytest.approx(0.5)
    assert all((cycle.stamp.ns - 7_000_000_000) % 10_000_000 == 0 for cycle in seen.cycles)
    assert seen.cycles[-1].stamp.ns == 7_500_000_000
    clock.set(Stamp(1_000_000_000))
    wait_until(lambda: loop.resets == 1)
    assert session.model.time == 0.0
    clock.set(Stamp(1_100_000_000))
    wait_until(lambda: session.model.time >= 0.1 - 1e-9)
    assert seen.cycles[-1].stamp.ns == 1_100_000_000
    loop.stop()
    session.close()


def test_free_running_is_faster_than_real_time_and_pauses() -> None:
    session = Session(settings(real_time_factor=0.0))
    loop, seen = loop_of(session)
    begin = time.monotonic()
    loop.start()
    wait_until(lambda: session.model.time > 5.0)
    elapsed = time.monotonic() - begin
    loop.stop()
    assert session.model.time > 1.5 * elapsed
    assert seen.cycles[0].stamp.ns == 10_000_000
    count, stamp = len(seen.cycles), seen.cycles[-1].stamp
    time.sleep(0.1)
    assert len(seen.cycles) == count
    loop.reset()
    assert session.model.time == 0.0
    loop.start()
    wait_until(lambda: len(seen.cycles) > count)
    loop.stop()
    assert seen.cycles[count].stamp.ns == stamp.ns + 10_000_000  # the clock never goes back
    session.close()


def test_a_model_that_is_too_slow_sheds_publication_before_physics(session: Session) -> None:
    whole = session.model.step_to

    def slow(target: float, **inputs: Any) -> None:
        time.sleep(0.03)  # three periods
        whole(target, **inputs)

    session.model.step_to = slow  # type: ignore[method-assign]
    loop, seen = loop_of(session)
    diagnostics = Diagnostics(session, loop)
    loop.start()
    time.sleep(1.5)
    loop.stop()
    published = [cycle for cycle in seen.cycles if cycle.outputs]
    assert all(cycle.shed != bool(cycle.outputs) for cycle in seen.cycles)
    assert 0 < len(published) < len(seen.cycles)
    assert loop.pacer.missed > 20
    assert session.model.time > 1.0  # longer steps keep up with real time
    status = diagnostics.statuses()[0]
    assert status.level == WARN
    assert "deadlines missed" in status.message
    assert "publications left out" in status.message


def test_what_a_cable_may_be_wrong_by_is_published_logged_and_told(tmp_path: Path) -> None:
    session = opened(settings("solver.error_estimate=true", log__folder=str(tmp_path)))
    model: Any = session.model
    session.start()
    drive(session, 100)
    error = model.position_error
    assert error > 0.0
    topics = [topic for topic, _ in session.rig.outputs(session.stamp())]
    assert {"~/position_error", "~/tension_error"} < set(topics)
    diagnostics = Diagnostics(session, loop_of(session)[0])
    status = diagnostics.statuses()[0]
    assert status.level == OK
    assert float(status.values["estimated error of positions [m]"]) == pytest.approx(
        error, rel=1e-5
    )
    saved = model.snapshot()
    for wrong, text in ((1.0, "positions may be off by 1 m, more than a tolerance of 0.001"),
                        (math.nan, "errors are not known")):  # fmt: skip
        model._errors = (wrong, 0.5)
        status = diagnostics.statuses()[0]
        assert status.level == WARN
        assert text in status.message
        assert status.values["estimated error of the top tension [N]"] == "0.5"
    session.close()
    (log,) = tmp_path.glob(PATTERN)
    run = cm.open_run(log)
    assert run["position_error"][-1] == error
    # A state that was saved brings the finer run along.
    model.reset()
    model.restore(saved)
    assert model.position_error == error


def test_a_failure_ends_the_loop_and_is_told_once(session: Session) -> None:
    def failing(target: float, **inputs: Any) -> None:
        raise cm.StepError("no convergence", time=session.model.time)

    session.model.step_to = failing  # type: ignore[method-assign]
    loop, seen = loop_of(session)
    loop.start()
    wait_until(lambda: seen.failures)
    wait_until(lambda: not loop.running)
    assert len(seen.failures) == 1
    assert "no convergence" in seen.failures[0]
    assert Diagnostics(session, loop).statuses()[0].level == ERROR
    loop.stop()


def test_limits_may_change_while_it_runs(session: Session) -> None:
    loop, _ = loop_of(session)
    drive(session, 100)
    assert session.model.vessel_velocity[0] == pytest.approx(0.8)
    loop.update(settings(limits__speed=0.3, lag_limit=0.1))
    drive(session, 50)
    assert session.model.vessel_velocity[0] == pytest.approx(0.3)
    assert loop.pacer.lag_limit == 0.1


def test_diagnostics_say_what_is_stale_and_what_is_missing() -> None:
    clocks = Clocks()
    session = opened(settings(), clocks)
    session.start()
    loop, _ = loop_of(session)
    diagnostics = Diagnostics(session, loop)
    assert "no cmd_vel yet" in diagnostics.statuses()[1].message
    drive(session, 10)
    status = diagnostics.statuses()[1]
    assert status.level == OK
    clocks.wait(1.0)
    session.cycle(Simulated(0.11))
    status = diagnostics.statuses()[1]
    assert status.level == WARN
    assert "cmd_vel is stale" in status.message
    session.rig.commands.take_twist(None, "map", (float("nan"), 0, 0), (0, 0, 0))
    assert "1 of cmd_vel refused" in diagnostics.statuses()[1].message
    assert "refused" not in diagnostics.statuses()[1].message  # told once
    session.close()
