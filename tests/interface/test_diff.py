"""Two runs compared: the largest differences, when and where."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.results.compare import Comparison, compare
from cablemodel.scene import Scene, load_scene


def invoke(*arguments: Any) -> Any:
    return CliRunner().invoke(app, ["diff", *map(str, arguments)])


def named(result: Comparison, name: str) -> Any:
    (found,) = [item for item in result.differences if item.name == name]
    return found


@pytest.fixture
def tighter(swinging_cable: Any) -> Any:
    """The swinging cable, by 0.25 N tighter at one node after 3 s, and by 2 mm longer."""

    class Tighter(swinging_cable):  # type: ignore[misc]
        def state(self) -> Any:
            state = super().state()
            if self.time > 3.0:
                state.tension[4] += 0.25 if self.time < 4.0 else 0.125
            return state

        @property
        def tip_position(self) -> np.ndarray:
            return super().tip_position + np.array([0.0, 2e-3 * (self.time > 8.0), 0.0])

    return Tighter


def test_a_run_is_the_same_as_itself(full_scene: Scene, swinging_cable: Any) -> None:
    one = cm.simulate(full_scene, model=swinging_cable(full_scene))
    other = cm.simulate(full_scene, model=swinging_cable(full_scene))
    result = compare(one, other)
    assert result.identical
    assert result.passed
    assert (result.samples, result.states) == (35, 35)
    assert {item.name for item in result.differences} > set(one.names)


def test_differences_say_when_and_where(
    full_scene: Scene, swinging_cable: Any, tighter: Any
) -> None:
    one = cm.simulate(full_scene, model=swinging_cable(full_scene))
    other = cm.simulate(full_scene, model=tighter(full_scene))
    result = compare(one, other)
    assert not result.identical
    assert not result.passed
    tension = named(result, "state.tension")
    assert tension.largest == 0.25
    assert 3.0 < tension.time < 4.0
    assert tension.arc_length == pytest.approx(15.0, abs=0.5)
    tip = named(result, "tip_position")
    assert tip.largest == pytest.approx(2e-3)
    assert tip.time > 8.0
    assert named(result, "state.position").largest == 0.0
    # 2 mm of 30 m, and 0.25 N of 10 times 180 N.
    assert tip.share == pytest.approx(2e-3 / 30)
    assert compare(one, other, tolerance=1e-3).passed
    assert not compare(one, other, tolerance=2e-5).passed


def test_other_nodes_are_compared_at_the_same_places(
    simple_scene: Scene, swinging_cable: Any
) -> None:
    """A straight cable has the same shape with any mesh."""
    one = cm.simulate(simple_scene, model=swinging_cable(simple_scene))
    other = cm.simulate(simple_scene, model=swinging_cable(simple_scene, nodes=17))
    result = compare(one, other, tolerance=1e-12)
    assert named(result, "state.position").largest < 1e-12
    assert named(result, "state.tension").largest < 1e-12


def test_other_output_times_are_compared_where_they_meet(swinging_cable: Any) -> None:
    from copy import deepcopy

    runs = []
    for interval in (0.4, 0.2, 0.3, 0.37):
        spec = deepcopy(SPEC)
        spec["run"]["output_interval"] = interval
        scene = load_scene(spec)
        runs.append(cm.simulate(scene, model=swinging_cable(scene)))
    at_04, at_02, at_03, at_037 = runs
    result = compare(at_04, at_02)
    assert result.identical
    assert result.samples == result.states == 26
    assert compare(at_04, at_03).samples == 10  # every 1.2 s, and the end
    result = compare(at_037, at_02)
    assert not result.interpolated
    assert result.samples == 3  # 0, 7.4 and 10 s


def test_times_that_never_meet_are_interpolated(simple_scene: Scene, swinging_cable: Any) -> None:
    late = swinging_cable(simple_scene)
    late.step(0.01)
    one = cm.simulate(simple_scene, model=swinging_cable(simple_scene), until=5.0)
    other = cm.simulate(simple_scene, model=late, until=4.99)
    for time in (other.time, other.states.time):  # a log with times of its own
        time[1:-1] += 0.1
    result = compare(one, other, tolerance=1.0)
    assert result.interpolated
    assert result.states == 0
    assert result.samples == 16
    assert 0.0 < named(result, "tip_position").largest < 3.0
    assert not result.passed
    assert result.unmatched == ["the first run is from 0 to 5 s, the second from 0.01 to 4.99 s"]


def test_what_only_one_run_has_is_said(
    simple_scene: Scene, full_scene: Scene, swinging_cable: Any
) -> None:
    one = cm.simulate(simple_scene, model=swinging_cable(simple_scene))
    other = cm.simulate(full_scene, model=swinging_cable(full_scene), until=5.0)
    result = compare(one, other, tolerance=1e6)
    assert not result.passed
    only, span = result.unmatched
    assert only.startswith("only the second run has")
    assert "floor_force" in only
    assert span == "the first run is from 0 to 10 s, the second from 0 to 5 s"
    assert "floor_force" not in {item.name for item in result.differences}


def test_runs_without_a_common_time_are_refused(simple_scene: Scene, swinging_cable: Any) -> None:
    late = swinging_cable(simple_scene)
    late.step(8.0)
    one = cm.simulate(simple_scene, model=swinging_cable(simple_scene), until=5.0)
    other = cm.simulate(simple_scene, model=late)
    with pytest.raises(cm.LogError, match="from 0 to 5 s and from 8 to 10 s"):
        compare(one, other)


@pytest.mark.parametrize("tolerance", [-1.0, math.nan, math.inf])
def test_a_tolerance_is_a_number(
    simple_scene: Scene, swinging_cable: Any, tolerance: float
) -> None:
    run = cm.simulate(simple_scene, model=swinging_cable(simple_scene), until=1.0)
    with pytest.raises(ValueError, match="tolerance"):
        compare(run, run, tolerance=tolerance)


def test_the_command(
    simple_scene: Scene, swinging_cable: Any, tighter: Any, tmp_path: Path
) -> None:
    one, other = tmp_path / "one.mcap", tmp_path / "other.mcap"
    cm.simulate(simple_scene, log=one, model=swinging_cable(simple_scene))
    cm.simulate(simple_scene, log=other, model=tighter(simple_scene))
    same = invoke(one, one)
    assert same.exit_code == 0
    assert "The runs are the same, to the last bit" in same.stdout
    result = invoke(one, other)
    assert result.exit_code == 1
    assert "too much" in result.stdout
    assert "The runs are different" in result.stdout
    assert invoke(one, other, "--tolerance", "1e-3").exit_code == 0
    report = json.loads(invoke(one, other, "--json").stdout)
    assert report["passed"] is False
    (tip,) = [item for item in report["differences"] if item["name"] == "tip_position"]
    assert tip["largest"] == pytest.approx(2e-3)
    assert tip["time"] > 8.0
    assert invoke(one, other, "--tolerance", "-1").exit_code == 2
    assert invoke(one, tmp_path / "missing.mcap").exit_code == 2


SPEC: dict[str, Any] = {
    "cable_types": {"K": {"diameter": 0.01666, "mass": 0.4613, "axial_stiffness": 1e6}},
    "line": [{"cable": {"type": "K", "length": 30}}],
    "run": {"duration": 10, "output_interval": 0.3},
}
