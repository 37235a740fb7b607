"""A system that cannot be meant, and a step that cannot, are refused in the words of the file."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import pytest
from system_to_steer import SCENE

import cablemodel as cm
from cablemodel.cli.plausibility import system_start_warnings
from cablemodel.scene import apply_overrides
from cablemodel.systems import SystemModel

FIN = "bodies.cage.foils.fin"


@pytest.mark.parametrize(
    ("override", "path", "words"),
    [
        (
            "lines.tether={start: cage.spool, to: vehicle.tail, items: []}",
            "lines.tether.start",
            "did you mean from?; allowed: from, to, items",
        ),
        (
            "lines.tether={from: cage.spool, to: vehicle.tail, cable: {}}",
            "lines.tether.cable",
            "it belongs in lines.tether.items.N; allowed: from, to, items",
        ),
        (
            "bodies.cage.drag_coefficient=0.8",
            "bodies.cage.drag_coefficient",
            "did you mean drag_area (area times coefficient)?",
        ),
        ("bodies.cage.CdA=0.8", "bodies.cage.CdA", "did you mean drag_area?"),
        ("winches.hoist.drum_length=9", "winches.hoist.drum_length", "did you mean drum?"),
        ("floor={z: -50}", "floor", "it belongs in environment; allowed: title"),
        ("vessel={}", "vessel", "did you mean vessels?"),
        ("lines=[{from: cage.spool}]", "lines", "allowed: a mapping {NAME: {from, to, items}}"),
        (
            "bodies.cage.points=[0, 0, 1]",
            "bodies.cage.points",
            "not a mapping; allowed: a mapping {NAME: a list of numbers [x, y, z] in m}",
        ),
        (
            "vessels.ship.connection={clamped: [0, 0, -1]}",
            "vessels.ship.connection",
            "lines have clamps, not the vessel; allowed: pinned; from: {point: VESSEL.POINT",
        ),
        (
            "solver={method: direct_integration}",
            "solver.method",
            "direct_integration computes one line below one point; allowed: finite_element",
        ),
        (
            "lines.tether.to={anchor: [0, 0, -9], clamped: [1, 0, 0]}",
            "lines.tether.to",
            "only a point holds a clamp; allowed: a point with clamped; for an anchor that of a",
        ),
        (
            "bodies.cage.submerged_weight=null",
            "bodies.cage",
            "neither submerged_weight nor hull is given",
        ),
        (
            f"{FIN}.table=[[-180, 0, 0], [0, .nan, 0.1], [180, 0, 0]]",
            f"{FIN}.table.1.1",
            "nan is not a finite number",
        ),
        (
            f"{FIN}.table=[[-180, 0, 0], [0, 0, .inf], [180, 0, 0]]",
            f"{FIN}.table.1.2",
            "inf is not a finite number; allowed: a number at least 0",
        ),
        (
            f"{FIN}.table=[[-180, 0, 0], [0, 1, -5], [180, 0, 0]]",
            f"{FIN}.table.1.2",
            "-5 is out of range; allowed: a number at least 0",
        ),
        (f"{FIN}.table=[]", f"{FIN}.table", "it has no rows; allowed: rows of angles that rise"),
        (f"{FIN}.table=[[-180, 0, 0]]", f"{FIN}.table", "angles out of order; allowed: angles"),
        (
            f"{FIN}.table=[[-180, 0.5, 0], [0, 1, 0.1], [180, -0.7, 3]]",
            f"{FIN}.table",
            "at -180 degrees, 0.5 and 0, are others than at 180, -0.7 and 3; allowed: the same",
        ),
        (
            "cuts.weak_link.at=middle",
            "cuts.weak_link.at",
            "'middle' is not a number with a unit; allowed: start, end, or a number above 0 in m",
        ),
        ("cuts.weak_link.at=strat", "cuts.weak_link.at", "did you mean start?; allowed: start"),
        ("cuts.weak_link.at=0", "cuts.weak_link.at", "0 is out of range; allowed: start, end, or"),
        ("cuts.weak_link.at=[1]", "cuts.weak_link.at", "[1] is not a number; allowed: start, end"),
        (
            "lines.tether.from={line: umbilical, at: 40}",
            "lines.tether.from.at",
            "umbilical, which is 40 m long; allowed: between 0 and 40 m, not at its ends",
        ),
        (
            f"{FIN}.deflection=6",
            f"{FIN}.deflection",
            "at least -3.14159 and at most 3.14159 in rad",
        ),
        (f"{FIN}.stall=200 deg", f"{FIN}.stall", "above 0 and at most 1.5708 in rad"),
    ],
)
def test_refused(override: str, path: str, words: str) -> None:
    with pytest.raises(cm.SceneError) as caught:
        cm.load_system(apply_overrides(SCENE, [override]))
    found = {problem.path: str(problem) for problem in caught.value.problems}
    assert words in found[path]
    assert len(found) == 1 or not path.startswith("cuts")


@pytest.mark.parametrize("end", ["cage", "cage.bottom"])
def test_a_point_that_is_none_is_told_once(end: str) -> None:
    data = apply_overrides(SCENE, [f"lines.umbilical.to={end}", "lines.tether.from=free"])
    with pytest.raises(cm.SceneError) as caught:
        cm.load_system(data)
    (problem,) = caught.value.problems
    assert str(problem).startswith(f"lines.umbilical.to: '{end}' is no point of a vessel or body")


def test_an_end_that_is_missing_is_told_in_the_words_of_the_file() -> None:
    data = copy.deepcopy(SCENE)
    del data["lines"]["tether"]["from"]
    with pytest.raises(cm.SceneError, match=r"tether\.from: is missing; allowed: where it begins"):
        cm.load_system(data)


def test_the_word_pinned_is_still_read() -> None:
    """As logs of systems have it."""
    scene = cm.load_system(apply_overrides(SCENE, ["vessels.ship.connection=pinned"]))
    assert scene == cm.load_system(SCENE)


def test_a_scene_of_one_line_is_no_system() -> None:
    types = {"wire": {"diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e7}}
    data = {"cable_types": types, "line": [{"cable": {"type": "wire", "length": 10}}]}
    with pytest.raises(cm.SceneError, match="line: a scene of one line, from a vessel outwards"):
        cm.SystemModel(data)


@pytest.mark.parametrize(
    ("vessels", "words"),
    [
        ({"ship": [1.0, 0.0, 0.0]}, "a VesselInput, as VesselInput(velocity=[2, 0, 0])"),
        ({"boat": cm.VesselInput(velocity=[1, 0, 0])}, "give one of ship, vehicle"),
        ({"ship": cm.VesselInput(velocity=[1, 0])}, "give 3 finite numbers"),
        ([cm.VesselInput()], "give a mapping by the names of ship, vehicle"),
    ],
)
def test_a_wrong_motion_of_a_vessel_is_told(vessels: Any, words: str) -> None:
    model = cm.SystemModel(SCENE)
    assert repr(model) == "<SystemModel of 'Ship, cage and vehicle' at t = 0 s>"
    with pytest.raises(cm.StepError) as caught:
        model.step(0.1, vessels=vessels)
    assert words in str(caught.value)
    assert model.time == 0.0


def test_a_fairlead_below_the_floor_is_told() -> None:
    changes = ["environment.floor={z: -30}", "vessels.ship.position=[0, 0, -40]"]
    with pytest.raises(cm.SceneError, match=r"vessels\.ship\.points\.\w+: .*below the sea floor"):
        cm.load_system(apply_overrides(SCENE, changes))


@pytest.mark.filterwarnings("ignore:Matrix is exactly singular")
def test_lines_that_nothing_holds_are_named() -> None:
    """Two branches, each of the other: the file is consistent, and they sink for ever."""
    scene = apply_overrides(SCENE, ["title=Two of each other"])
    cable = [{"cable": {"type": "wire", "length": 10}}]
    for name, other in (("one", "two"), ("two", "one")):
        scene["lines"][name] = {"from": {"line": other, "at": 5}, "to": "free", "items": cable}
    with pytest.raises(cm.StaticsError, match="nothing holds one and two") as caught:
        SystemModel(scene)
    assert "; branches go in a circle, one on two on one: let one begin" in str(caught.value)


def test_check_tells_of_a_link_that_is_too_weak_for_its_start() -> None:
    for tension, told in ((1e3, True), (1e6, False)):
        cut = f"cuts.weak_link={{line: umbilical, at: end, tension: {tension}}}"
        words = "".join(system_start_warnings(SystemModel(apply_overrides(SCENE, [cut]))))
        assert ("cuts.weak_link: umbilical has 2" in words) == told


def test_one_cut_may_stand_alone_also_where_it_is_recorded() -> None:
    model = cm.SystemModel(SCENE)
    with cm.SystemRecorder(model) as recorder:
        recorder.step(0.1, cuts="weak_link")
    assert model.cuts == {"weak_link": 0.0}
    assert recorder.run().applied_inputs["weak_link.cut"].tolist() == [1.0]
    model.reset()
    model.step(0.1, cuts="weak_link")
    assert model.cuts == {"weak_link": 0.0}


def test_a_place_beyond_a_line_is_told() -> None:
    model = cm.SystemModel(SCENE)
    with pytest.raises(ValueError, match="s = 50 m is not on umbilical; allowed: 0 to 40 m"):
        model.lines["umbilical"].sample([0.0, 50.0])


def test_recorders_name_each_other() -> None:
    with pytest.raises(TypeError, match=r"<SystemModel of .* is recorded by a SystemRecorder"):
        cm.Recorder(cm.SystemModel(SCENE))  # type: ignore[arg-type]
    types = {"wire": {"diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e7}}
    line = cm.CableModel({"cable_types": types, "line": [{"cable": {"type": "wire", "length": 9}}]})
    with pytest.raises(TypeError, match=r"<CableModel of 'untitled' .* is recorded by a Recorder"):
        cm.SystemRecorder(line)


@pytest.mark.parametrize(
    ("key", "text", "words"),
    [
        ("raos", "heading_deg,period,heave_phase", "'heave_phase', did you mean heave_phase_deg?"),
        ("raos", "heading_deg,period,pitch", "unknown column 'pitch', did you mean pitch_deg?"),
        ("raos", "heading_deg,period,haeve", "unknown column 'haeve', did you mean heave?"),
        ("raos", "heading_deg,period,gain", "unknown column 'gain'; allowed: the columns heading"),
        ("attitude", "t,roll,pitch,yaw,yaw_deg", "unknown column 'yaw_deg', did you mean yaw?"),
    ],
)
def test_a_column_that_would_be_dropped_is_refused(
    tmp_path: Path, key: str, text: str, words: str
) -> None:
    (tmp_path / "ship.csv").write_text(f"{text}\n0,5,1,0,0\n")
    scene = apply_overrides(SCENE, ["environment.waves={regular: {height: 1, period: 8}}"])
    name = str(tmp_path / "ship.csv")
    scene["vessels"]["ship"][key] = name if key == "raos" else {"file": name}
    with pytest.raises(cm.SceneError) as caught:
        cm.load_system(scene)
    assert caught.value.path.startswith(f"vessels.ship.{key}")
    assert "ship.csv: unknown column" in str(caught.value)
    assert words in str(caught.value)


@pytest.mark.parametrize("headings", [(0, 360), (-90, 270), (180, -180)])
def test_headings_that_a_turn_lies_between_have_one_answer(headings: tuple[int, int]) -> None:
    """The one that stood last in the file was taken."""
    scene = apply_overrides(SCENE, ["environment.waves={regular: {height: 1, period: 8}}"])
    rows = [{"heading_deg": heading, "period": 5, "heave": 0.5} for heading in headings]
    scene["vessels"]["ship"]["raos"] = rows
    rows[1]["heave_phase_deg"] = 360
    cm.load_system(scene)
    rows[1]["heave_phase_deg"] = 90
    with pytest.raises(cm.SceneError) as caught:
        cm.load_system(scene)
    assert caught.value.path == "vessels.ship.raos.1"
    words = f"rows 0 and 1 differ, of period 5 s and headings {headings[0]} and {headings[1]} deg"
    assert words in str(caught.value)


def test_a_row_that_stands_twice_is_not_one_that_is_missing() -> None:
    scene = apply_overrides(SCENE, ["environment.waves={regular: {height: 1, period: 8}}"])
    rows = [{"heading_deg": heading, "period": 5 + heading} for heading in (0, 0, 1, 1)]
    scene["vessels"]["ship"]["raos"] = rows
    with pytest.raises(cm.SceneError, match="one row for every period at every heading"):
        cm.load_system(scene)


def test_half_turns_and_right_angles_of_foils_are_allowed() -> None:
    changes = [f"{FIN}.deflection=-180 deg", f"{FIN}.stall=90 deg"]
    changes.append(f"{FIN}.table=[[-180, 0, 0.1], [0, 1, 0], [180, -1e-9, 0.1]]")
    fin = cm.load_system(apply_overrides(SCENE, changes)).bodies["cage"].foils["fin"]
    assert fin.deflection == pytest.approx(-math.pi)
    assert fin.stall == pytest.approx(math.pi / 2)


@pytest.mark.parametrize("name", ["a b", "", "a.b", "a/b", "1"])
@pytest.mark.parametrize(
    "place", ["vessels.ship.points", "bodies.cage.points", "bodies.cage.foils"]
)
def test_points_and_foils_have_names_as_all_have(place: str, name: str) -> None:
    scene = copy.deepcopy(SCENE)
    kind, owner, parts = place.split(".")
    scene[kind][owner][parts][name] = {"area": 1} if parts == "foils" else [0, 0, 1]
    with pytest.raises(cm.SceneError) as caught:
        cm.load_system(scene)
    (problem,) = caught.value.problems
    allowed = "letters, digits and _, a letter first"
    assert str(problem) == f"{place}.{name}: '{name}' is no name; allowed: {allowed}"


@pytest.mark.parametrize(
    ("apart", "height", "told"),
    [(0.2, None, "2.8"), (3.2, None, ""), (2.5, 1.0, "0.5"), (2.5, 6.0, "0.5"), (3.2, 1.0, "")],
)
def test_check_tells_of_hulls_within_each_other(
    apart: float, height: float | None, told: str
) -> None:
    hull = {"diameter": 3.0} if height is None else {"diameter": 3.0, "height": height}
    float_ = {"mass": 3000.0, "hull": hull, "inertia": 3000.0, "centre_of_gravity": [0, 0, -0.3]}
    float_["points"] = {"eye": [0, 0, -0.5 * (height or 3.0)]}
    wire = {"diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e7}
    scene: dict[str, Any] = {
        "environment": {"waves": {"regular": {"height": 0.5, "period": 6}}},
        "cable_types": {"wire": wire},
        "bodies": {"one": float_, "two": float_},
        "lines": {
            f"to_{name}": {
                "from": {"anchor": [0, y, -50]},
                "to": f"{name}.eye",
                "items": [{"cable": {"type": "wire", "length": 44}}],
            }
            for name, y in (("one", 0), ("two", apart))
        },
    }
    words = [text for text in system_start_warnings(SystemModel(scene)) if "hull" in text]
    assert len(words) == bool(told)
    assert not told or words[0].startswith(f"bodies.one.hull is {told} m within that of two")
