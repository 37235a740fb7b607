"""A step that cannot be made: what the node says and does, by its policy."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import TwistStamped
from system_to_steer import SCENE as SYSTEM

import cablemodel as cm

from .conftest import NodeProcess, Talker, wait_until
from .helmsman import Watch

Start = Callable[..., NodeProcess]
FREE_RUN = {"vessel_input": "scene", "payout_input": "scene", "autostart": True}

FAILING = """
import sys
import cablemodel as cm
from cablemodel_ros import node

whole = cm.CableModel.step_to
failures = [0]

def step_to(self, time, *arguments, **inputs):
    if time > {after} and failures[0] < {times}:
        failures[0] += 1
        raise cm.StepError("no convergence", time=self.time, arc_length=3.0)
    whole(self, time, *arguments, **inputs)

cm.CableModel.step_to = step_to
sys.exit(node.main())
"""


FAILING_SYSTEM = FAILING.replace("CableModel", "SystemModel").replace(", arc_length=3.0", "")


def once_there(path: Path) -> str:
    """After which time steps fail, in a program: never, before there is such a file."""
    return f"(0.0 if __import__('pathlib').Path({str(path)!r}).exists() else 1e9)"


def told(diagnostics: list[DiagnosticArray], words: str) -> bool:
    return any(
        words in s.message and s.level == DiagnosticStatus.ERROR
        for a in diagnostics
        for s in a.status
    )


def test_by_default_the_node_stays_unconfigured_and_goes_on_saying_why(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    diagnostics = talker.listen("/diagnostics", DiagnosticArray)
    program = FAILING.format(after=0.505, times=10**6)
    node = start_node(**FREE_RUN, program=program, log__folder=tmp_path / "log")
    wait_until(lambda: told(diagnostics, "the simulation stopped"), 120)
    wait_until(lambda: talker.state == "unconfigured")
    diagnostics.clear()
    wait_until(lambda: told(diagnostics, "unconfigured until configured (on_failure: stay)"))
    assert "3 m along the cable: no convergence" in node.text
    (path,) = (tmp_path / "log").glob("cable_*.mcap")
    run = cm.open_run(path)
    assert "no convergence" in run.reason
    assert run.applied_inputs["time"][-1] == pytest.approx(0.5)
    assert talker.transition("configure")  # and it can be used again
    assert talker.transition("cleanup")


def test_on_request_the_process_ends_with_a_status_for_who_started_it(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    diagnostics = talker.listen("/diagnostics", DiagnosticArray)
    now = tmp_path / "now"
    program = FAILING.format(after=once_there(now), times=10**6)
    node = start_node(**FREE_RUN, program=program, log__folder=tmp_path / "log", on_failure="exit")
    wait_until(lambda: diagnostics, 120)  # the two have found each other
    now.touch()
    assert node.process.wait(120) == 3
    assert told(diagnostics, "the node ends (on_failure: exit)")
    assert "Traceback" not in node.text
    (path,) = (tmp_path / "log").glob("cable_*.mcap")
    assert "no convergence" in cm.open_run(path).reason


def test_a_start_that_fails_ends_the_process_too_where_that_is_wanted(
    start_node: Start, tmp_path: Path
) -> None:
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text("line: []")
    node = start_node(scene=wrong, autostart=True, on_failure="exit")
    assert node.process.wait(60) == 3
    assert "cannot configure" in node.text


def test_on_request_it_goes_back_to_the_last_good_state_and_on(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    watch = Watch(talker)
    program = FAILING.format(after=3.205, times=2)
    node = start_node(**FREE_RUN, program=program, log__folder=tmp_path / "log",
                      on_failure="retry", diagnostics_rate=10)  # fmt: skip
    applied = talker.listen("/cable/applied_cmd_vel", TwistStamped)
    wait_until(lambda: told(watch.diagnostics, "gone back by"), 120)
    wait_until(lambda: "simulation: a step could not be made: " in node.text)
    wait_until(lambda: float(watch.value("simulation", "simulated time [s]")) > 4.0)
    assert watch.value("simulation", "gone back after a failure") == "2"
    assert talker.state == "active"
    stamps = [m.header.stamp.sec + 1e-9 * m.header.stamp.nanosec for m in applied]
    assert stamps == sorted(stamps)
    assert node.stop() == 0
    first, *_, last = sorted((tmp_path / "log").glob("cable_*.mcap"))
    assert "no convergence" in cm.open_run(first).reason
    again = cm.open_run(last)
    assert again.complete
    assert again.applied_inputs["time"][0] < 3.0


def test_of_a_system_it_goes_back_and_on_and_in_the_end_says_why(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    """A failure that passes is got over; one that does not ends the process with its status."""
    path = tmp_path / "system.yaml"
    path.write_text(cm.load_system(SYSTEM).to_yaml())
    watch = Watch(talker)
    free_run = {**FREE_RUN, "scene": path, "rate": 50, "diagnostics_rate": 10}
    node = start_node(**free_run, program=FAILING_SYSTEM.format(after=2.01, times=2),
                      on_failure="retry", log__folder=tmp_path / "log")  # fmt: skip
    wait_until(lambda: told(watch.diagnostics, "gone back by"), 120)
    wait_until(lambda: float(watch.value("simulation", "simulated time [s]")) > 3.0)
    assert watch.value("simulation", "gone back after a failure") == "2"
    assert node.stop() == 0
    first, *_, last = sorted((tmp_path / "log").glob("cable_*.mcap"))
    assert "no convergence" in cm.open_run(first).reason
    assert cm.open_run(last).complete
    watch.diagnostics.clear()
    now = tmp_path / "now"
    program = FAILING_SYSTEM.format(after=once_there(now), times=10**6)
    node = start_node(**free_run, program=program, on_failure="exit")
    wait_until(lambda: watch.diagnostics, 120)  # the two have found each other
    now.touch()
    assert node.process.wait(120) == 3
    assert told(watch.diagnostics, "the node ends (on_failure: exit)")


def test_what_fails_again_and_again_is_given_up(start_node: Start, talker: Talker) -> None:
    diagnostics = talker.listen("/diagnostics", DiagnosticArray)
    program = FAILING.format(after=2.505, times=10**6)
    start_node(**FREE_RUN, program=program, on_failure="retry", real_time_factor=2.0)
    wait_until(lambda: told(diagnostics, "(on_failure: retry)"), 120)
    wait_until(lambda: talker.state == "unconfigured")
