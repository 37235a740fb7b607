"""Every scene that cannot be meant is refused with path, value and what is allowed."""

from __future__ import annotations

import pickle
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from scene_examples import full, minimal

import cablemodel as cm
from cablemodel.scene import apply_overrides


def refusal(data: Any, *overrides: str) -> cm.SceneError:
    with pytest.raises(cm.SceneError) as caught:
        cm.load_scene(apply_overrides(data, overrides) if overrides else data)
    return caught.value


@pytest.mark.parametrize(
    ("override", "path", "words"),
    [
        # unknown keys
        ("line.0.cable.lenght=3", "line.0.cable.lenght", "did you mean length?"),
        ("enviroment={}", "enviroment", "did you mean environment?"),
        ("zzz=1", "zzz", "unknown key"),
        ("end={anchr: [0, 0, 0]}", "end.anchr", "did you mean anchor?"),
        # words of other programs and of the trade
        ("cable_types.K.EA=1 MN", "cable_types.K.EA", "did you mean axial_stiffness?"),
        ("cable_types.K.Diam=1", "cable_types.K.Diam", "did you mean diameter?"),
        ("cable_types.K.CdAx=1", "cable_types.K.CdAx", "did you mean drag_tangential?"),
        ("environment.depth=50", "environment.depth", "did you mean floor: {z: -DEPTH}?"),
        ("run.dt=0.1", "run.dt", "did you mean output_interval (steps are chosen by the"),
        ("winch={}", "winch", "did you mean payout?"),
        ("vessel.speed=5 kn", "vessel.speed", "did you mean path: legs with speed and"),
        # keys at a wrong place
        ("line.0.length=5", "line.0.length", "it belongs in line.0.cable; allowed: cable, body"),
        ("floor={z: -5}", "floor", "unknown key, it belongs in environment; allowed: title"),
        ("vessel.payout={}", "vessel.payout", "unknown key, a key of the scene itself; allowed"),
        ("vessel.tolerance=1", "vessel.tolerance", "a key of solver; allowed: position"),
        (
            "environment.waves={hs: 2, tp: 8}",
            "environment.waves.hs",
            "it belongs in environment.waves.jonswap; allowed: regular",
        ),
        (
            "environment.waves={direction: 1}",
            "environment.waves.direction",
            "jonswap or environment.waves.components; allowed: regular",
        ),
        # what is missing
        (
            "line.0.cable={type: K}",
            "line.0.cable.length",
            "is missing: unstretched length; allowed",
        ),
        # wrong kinds of value
        ("line={cable: 3}", "line", "a list of mappings with the keys cable, body"),
        ("line.0.cable.length=true", "line.0.cable.length", "True is not a number"),
        ("line.0.cable.length=yes", "line.0.cable.length", "not a number"),
        ("line.0.cable.length=null", "line.0.cable.length", "None is not a number"),
        ("line.0.cable.length=[3]", "line.0.cable.length", "not a number"),
        ("line.0.cable.length=1:30", "line.0.cable.length", "not a number"),
        ("line.0.cable.length=2020-01-01", "line.0.cable.length", "not a number"),
        ("line.0.cable.elements=2.5", "line.0.cable.elements", "not a whole number"),
        ("line.0.cable.elements=0", "line.0.cable.elements", "out of range"),
        ("line.0.cable.model=elastic", "line.0.cable.model", "did you mean elastica?"),
        ("title=5", "title", "not a text"),
        ("environment=5", "environment", "not a mapping"),
        ("environment=null", "environment", "not a mapping"),
        ("line={}", "line", "not a list"),
        ("cable_types={}", "cable_types", "empty"),
        ("cable_types={5: {}}", "cable_types.5", "not a name"),
        # units
        ("line.0.cable.length=5 kg", "line.0.cable.length", "cannot be converted to m"),
        ("run.duration=5 m", "run.duration", "to s: m is the metre, min the minute; allowed"),
        (
            "cable_types.K.axial_stiffness=5 kn",
            "cable_types.K.axial_stiffness",
            "kN the kilonewton",
        ),
        ("line.0.cable.length=5 parsecs/s", "line.0.cable.length", "cannot be converted"),
        ("line.0.cable.length=5 foo", "line.0.cable.length", "unknown unit 'foo'"),
        ("line.0.cable.length=5 m m", "line.0.cable.length", "cannot be converted"),
        ("line.0.cable.length=9**9**9 m", "line.0.cable.length", "not a number with a unit"),
        ("line.0.cable.length=5 degC", "line.0.cable.length", "cannot be converted"),
        ("cable_types.K.drag_normal=1 m", "cable_types.K.drag_normal", "to a plain number"),
        # impossible numbers
        ("line.0.cable.length=0", "line.0.cable.length", "above 0 in m"),
        ("line.0.cable.length=-5 km", "line.0.cable.length", "above 0 in m"),
        ("line.0.cable.length=.inf", "line.0.cable.length", "not a finite number"),
        ("line.0.cable.length=.nan", "line.0.cable.length", "not a finite number"),
        ("line.0.cable.length=1e999", "line.0.cable.length", "not a finite number"),
        ("line.0.cable.length=1e300", "line.0.cable.length", "beyond all reason"),
        ("line.0.cable.length=1e-300", "line.0.cable.length", "beyond all reason"),
        ("cable_types.K.mass=0", "cable_types.K.mass", "above 0 in kg/m"),
        ("cable_types.K.diameter=-1", "cable_types.K.diameter", "above 0 in m"),
        ("cable_types.K.bending_stiffness=-1", "cable_types.K.bending_stiffness", "at least 0"),
        ("cable_types.K.drag_normal=-1", "cable_types.K.drag_normal", "at least 0"),
        ("environment.water_density=-1", "environment.water_density", "at least 0"),
        ("environment.gravity=-9.81", "environment.gravity", "at least 0"),
        ("solver.tolerance=0", "solver.tolerance", "above 0 and below 1"),
        ("run.duration=0", "run.duration", "above 0 in s"),
        # strain law
        ("cable_types.K.tension_strain=[1e-6]", "cable_types.K", "both axial_stiffness and"),
        ("cable_types.K.axial_stiffness=null", "cable_types.K", "neither axial_stiffness nor"),
        # the line
        ("line=[]", "line", "no cable in the line"),
        ("line=[{}]", "line.0", "either cable or body"),
        ("line.0.cable.type=Q", "line.0.cable.type", "allowed: K"),
        ("payout.drum=[{cable: {type: Q, length: 1}}]", "payout.drum.0.cable.type", "allowed: K"),
        ("payout.drum=[{rope: 1}]", "payout.drum.0.rope", "unknown key"),
        # ends and start
        ("end=fixed", "end", "free, or a mapping with anchor"),
        ("end={}", "end", "free, or a mapping with anchor"),
        ("end={connection: pinned}", "end", "not held"),
        ("end={anchor: [1, 2]}", "end.anchor", "not a list of 3 numbers"),
        ("end={anchor: [1, 2, z]}", "end.anchor.2", "'z' is not a number"),
        ("vessel.connection={clamped: [0, 0, 0]}", "vessel.connection.clamped", "cannot be zero"),
        ("initial={straight: [0, 0, 0]}", "initial.straight", "cannot be zero"),
        ("initial={straight: [1, 0, 0], points: []}", "initial", "exclude each other"),
        ("initial={points: [[0, 0, 0]]}", "initial.points", "at least two"),
        ("initial={points: [[0, 0, 0], [0, 0, 0]]}", "initial.points.1", "the same point"),
        ("initial={points: [[0, 0, 9], [0, 0, 0]]}", "initial.points.0", "vessel.position"),
        # tables
        ("vessel.velocity=[]", "vessel.velocity", "empty"),
        ("vessel.velocity=[{t: 0}]", "vessel.velocity.0.velocity", "is missing"),
        ("vessel.velocity=[1, 2]", "vessel.velocity", "not a list of 3 numbers"),
        ("vessel.velocity=[1, 2, x]", "vessel.velocity.2", "not a number"),
        ("vessel.velocity=log.csv", "vessel.velocity", "a file is named by {file: log.csv}"),
        (
            "vessel.velocity=3 m/s",
            "vessel.velocity",
            "'3 m/s' is no vector; allowed: a vector [x, y, z] in m/s, as [5 kn, 0, 0], a list",
        ),
        (
            "environment.current=100",
            "environment.current",
            "100 is no current; allowed: none, a list of numbers [x, y, z] in m/s, or a mapping",
        ),
        ("environment.current=1 m/s", "environment.current", "or a mapping with the key table"),
        ("vessel.velocity=0.5", "vessel.velocity", "0.5 is no vector; allowed: a vector [x, y, z]"),
        ("vessel.velocity={file: none.csv}", "vessel.velocity.file", "there is no file"),
        ("vessel.velocity={fil: none.csv}", "vessel.velocity", "{file: NAME}"),
        ("payout.rate=[{t: 1, rate: 0}, {t: 1, rate: 1}]", "payout.rate.1.t", "twice the same t"),
        ("payout.rate=[{t: 1, rate: 0}, {t: 0, rate: 1}]", "payout.rate.1.t", "out of order"),
        ("environment.current={table: []}", "environment.current.table", "empty"),
        ("environment.current=[0, 1, x]", "environment.current.2", "not a number"),
        (
            "environment.current={table: [{z: 0, velocity: [0,0,0]}, {z: 0, velocity: [0,0,0]}]}",
            "environment.current.table.1",
            "given twice",
        ),
        (
            "environment.current={table: [{z: 0, t: 0, velocity: [0,0,0]}, "
            "{z: 1, t: 1, velocity: [0,0,0]}]}",
            "environment.current.table",
            "z = 1 m is missing at t = 0 s",
        ),
        # environment
        ("environment.waves={}", "environment.waves", "regular, jonswap or components"),
        ("environment.waves={jonswap: {hs: -1, tp: 8}}", "environment.waves.jonswap.hs", "above"),
        ("environment.floor={}", "environment.floor", "either z or depth_table"),
        ("environment.floor={z: 5}", "vessel.position", "5 m below the sea floor"),
        ("environment.floor={z: 5}", "vessel.position", "above the water: z is up"),
        (
            "environment.floor={depth_table: [{x: 0, z: -9}, {x: 5, z: -9}, {x: 5, z: -8}]}",
            "environment.floor.depth_table",
            "x = 5 m, y = 0 m is given twice",
        ),
        (
            "environment.floor={depth_table: [{x: 0, z: -9}, {x: 5, y: 1, z: -9}]}",
            "environment.floor.depth_table",
            "no z at x = 0 m, y = 1 m",
        ),
        ("environment.floor={z: -5, friction: -1}", "environment.floor.friction", "at least 0"),
        # path
        ("vessel.path=[]", "vessel.path", "empty"),
        ("vessel.path=[{}]", "vessel.path.0", "either straight or turn"),
        (
            "vessel.path=[{straight: {duration: 1}}]",
            "vessel.path.0.straight.speed",
            "first leg",
        ),
        (
            "vessel.path=[{straight: {speed: 1}}]",
            "vessel.path.0.straight",
            "either duration or length",
        ),
        (
            "vessel.path=[{straight: {length: 1, speed: 0}}]",
            "vessel.path.0.straight",
            "never ends",
        ),
        (
            "vessel.path=[{turn: {angle: 0, radius: 1, speed: 1}}]",
            "vessel.path.0.turn.angle",
            "by nothing",
        ),
        (
            "vessel.path=[{turn: {angle: 90 deg, radius: 1, speed: 1}}, "
            "{straight: {length: 1, heading: 0}}]",
            "vessel.path.1.straight.heading",
            "the leg before ends at 1.5708",
        ),
        # solver
        ("solver={method: fem}", "solver.method", "finite_element or direct_integration"),
        ("solver={time_step: 1}", "solver.time_step", "finite_element has no such setting"),
        (
            "solver={method: direct_integration, tolerance: 0.1}",
            "solver.tolerance",
            "direct_integration has no such setting",
        ),
    ],
)
def test_refused(override: str, path: str, words: str) -> None:
    error = refusal(minimal(), override)
    assert error.path == path
    assert words in str(error)
    assert error.allowed or "empty" in words


def test_strain_must_grow_with_tension() -> None:
    data = minimal()
    for curve in ([0, 1e-9], [-1e-6], [], "x", [1e-6] * 9, [True]):
        data["cable_types"]["K"] = {"diameter": 0.01, "mass": 0.1, "tension_strain": curve}
        assert refusal(data).path.startswith("cable_types.K.tension_strain")


def test_velocity_and_path_exclude_each_other() -> None:
    data = minimal()
    data["vessel"] = {
        "velocity": [1, 0, 0],
        "path": [{"straight": {"duration": 1, "speed": 1}}],
    }
    assert refusal(data).path == "vessel"


def test_bodies_need_cable_before_them() -> None:
    body = {"body": {"mass": 1, "submerged_weight": 5}}
    cable = minimal()["line"][0]
    assert refusal(minimal() | {"line": [body, cable]}).path == "line.0"
    assert refusal(minimal() | {"line": [cable, body, body]}).path == "line.2"
    anchored = minimal() | {"line": [cable, body], "end": {"anchor": [0, 0, -9]}}
    assert refusal(anchored).path == "end"
    assert cm.load_scene(minimal() | {"line": [cable, body]}).bodies[0].mass == 1


def test_a_straight_line_must_meet_its_anchor() -> None:
    data = minimal() | {"end": {"anchor": [0, 0, -30]}}
    assert cm.load_scene(data | {"initial": {"straight": [0, 0, -1]}}).initial.kind == "straight"
    assert refusal(data | {"initial": {"straight": [1, 0, 0]}}).path == "initial.straight"


def test_all_problems_are_listed_at_once() -> None:
    error = refusal(
        full(),
        "line.0.cable.length=-1",
        "vessel.positon=[0, 0, 0]",
        "environment.floor.friction=-1",
        "cable_types.K.mass=5 m",
    )
    assert {problem.path for problem in error.problems} == {
        "line.0.cable.length",
        "vessel.positon",
        "environment.floor.friction",
        "cable_types.K.mass",
    }
    assert str(error).startswith("4 problems in the scene\n  ")
    assert (error.path, error.value) == ("environment.floor.friction", -1)


def test_endless_lists_of_problems_are_cut() -> None:
    data = minimal()
    data["vessel"] = {"velocity": [{"t": "x", "velocity": [0, 0, 0]}] * 500}
    error = refusal(data)
    assert len(error.problems) == 21
    assert "480 more" in str(error)


def test_the_value_is_the_one_in_the_file() -> None:
    assert refusal(minimal(), "line.0.cable.length=-5 km").value == "-5 km"
    assert refusal(minimal(), "end={anchor: [1, 2, deep]}").value == "deep"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("line: [1\nx: 2", "line 2"),
        ("line: [1,\n  {a: 1\n", "the { of line 2, column 3, is not closed before this"),
        ("line:\n  - a: 1\n    cable: 2\n   b: 3\n", "line 4, column 4: this does not go on with"),
        ("a: b: c\n", "line 1, column 5: a ':' that cannot stand here"),
        ("a: 1\nb\nc: 2\n", "no ':' after the key of line 2, column 1"),
        ("a: %x\n", "'%' cannot begin a value; allowed: such text in quotes"),
        ('a: "x\n', "the quote of line 1, column 4, is not closed"),
        ("line:\n\t- x: 2\n", "line 2, column 1: a tab; allowed: spaces"),
        ("a: 1\na: 2\n", "'a' is there twice"),
        ("line:\n  - cable: {type: K, type: L}\n", "'type' is there twice"),
        ("- 1\n- 2\n", "not a mapping"),
        ("just text\n", "not a mapping"),
        ("\n", "is empty"),
        ("a: &a [*a]\n", "contains itself"),
        ("a: !!python/object/apply:os.system [true]\n", "could not determine a constructor"),
        ("a: \x00\n", "special characters"),
        ("--- 1\n--- 2\n", "another document"),
        ("{[1]: 2}\n", "unhashable"),
        ("a: " + "[" * 5000 + "\n", "nested too deeply"),
        ("a: !!int x\n", "invalid literal"),
        ("? \n", "the key is not text"),
        (
            "a: &a [x,x,x,x,x,x,x,x,x,x]\n"
            + "".join(
                f"{name}: &{name} [{','.join([f'*{before}'] * 10)}]\n"
                for before, name in pairwise("abcdefgh")
            ),
            "more than",
        ),
    ],
)
def test_bad_yaml_is_refused(text: str, words: str) -> None:
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(1000)  # Python's own; Hypothesis leaves a higher one behind
    try:
        error = refusal(text)
    finally:
        sys.setrecursionlimit(limit)
    assert words in str(error)


def test_errors_of_a_file_name_it(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text("line: []\n")
    assert str(refusal(path)).startswith(f"{path}: ")
    path.write_bytes(b"\xff\xfe\x00")
    assert "cannot be read" in str(refusal(path))
    assert "cannot be read" in str(refusal(tmp_path / "none.yaml"))
    assert "cannot be read" in str(refusal(tmp_path))
    assert "cannot be read" in str(refusal("a\0b"))
    assert "is no scene" in str(refusal(5))


def test_errors_survive_pickling() -> None:
    error = refusal(minimal(), "zzz=1")
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error)
    assert again.problems == error.problems
    step = cm.StepError("it did not converge", time=1.5, arc_length=3.0, advice="try less")
    again = pickle.loads(pickle.dumps(step))
    assert str(again) == str(step)
    assert "t = 1.5 s, 3 m along the cable" in str(again)
    assert (again.time, again.arc_length, again.advice) == (1.5, 3.0, "try less")


def test_a_scene_error_is_a_value_error() -> None:
    assert isinstance(refusal({}), ValueError)
    assert isinstance(refusal({}), cm.CableModelError)


def test_what_follows_from_a_missing_value_is_no_problem_of_its_own() -> None:
    types = {"wire": {"diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e7}}
    line = [{"cable": {"type": "wire", "length": 10}}, {"body": {"mass": 10}}]
    with pytest.raises(cm.SceneError) as caught:
        cm.load_scene({"cable_types": types, "line": line})
    assert [problem.path for problem in caught.value.problems] == ["line.1.body.submerged_weight"]
