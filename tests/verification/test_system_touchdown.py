"""What lines of a system do on the sea floor: as one line, and as catenaries that lie in part."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.systems import SystemModel
from tests.verification.references.moored import moored_catenary

WEIGHT, STIFFNESS = 698.094, 384.243e6
ACROSS, RISE, LENGTH = 848.67, 250.0, 902.2
CHAIN = {
    "diameter": 0.1, "mass": WEIGHT / 9.80665, "submerged_weight": WEIGHT,
    "axial_stiffness": STIFFNESS, "drag_normal": 1.2, "added_mass": 1.0,
}  # fmt: skip


def chain(length: float = LENGTH) -> dict[str, Any]:
    return {"cable": {"type": "chain", "length": length, "model": "cable"}}


def system(tolerance: float = 1e-4, friction: float = 0.0, **parts: Any) -> dict[str, Any]:
    return {
        "environment": {"floor": {"z": 0.0, "friction": friction}},
        "cable_types": {"chain": CHAIN},
        "solver": {"tolerance": tolerance},
        **parts,
    }


def mooring(from_anchor: bool, tolerance: float = 1e-4, friction: float = 0.0, **more: Any) -> Any:
    """A chain between a ship and an anchor that is x = ACROSS away on the floor."""
    ends = [{"anchor": [ACROSS, 0, 0]}, "ship.eye"]
    one, other = ends if from_anchor else ends[::-1]
    ship = {"position": [0, 0, RISE], "points": {"eye": [0, 0, 0]}, **more}
    return system(
        tolerance,
        friction,
        vessels={"ship": ship},
        lines={"leg": {"from": one, "to": other, "items": [chain()]}},
    )


def single(tolerance: float, friction: float, **vessel: Any) -> cm.CableModel:
    scene = system(tolerance, friction, line=[chain()], end={"anchor": [ACROSS, 0, 0]})
    return cm.CableModel(cm.load_scene({**scene, "vessel": {"position": [0, 0, RISE], **vessel}}))


@pytest.mark.parametrize("from_anchor", [False, True])
def test_a_leg_lies_as_one_line_does(from_anchor: bool) -> None:
    """At rest, and while the ship moves: in both directions of the line."""
    motion = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 5, "velocity": [1, 0.5, 0]}]
    one = single(1e-4, 0.0, velocity=motion)
    model = SystemModel(mooring(from_anchor, velocity=motion))
    for time in (0.0, 4.0, 8.0):
        if time:
            one.step_to(time)
            model.step_to(time)
        found, pull = model.lines["leg"].on_floor, one.tension_max
        way = 0.05 * math.sqrt(2.0 * 1e-4 * LENGTH * pull / WEIGHT)  # of a touchdown layer
        assert found.floor_length == pytest.approx(one.floor_length, abs=way)
        assert found.touchdown_position == pytest.approx(one.touchdown_position, abs=way)
        # Both are promised to 10 tau of the largest tension.
        assert found.floor_force == pytest.approx(one.floor_force, abs=2e-3 * pull)
        assert found.touchdown_reaction == pytest.approx(one.touchdown_reaction, abs=2e-3 * pull)


def test_forces_on_a_leg_balance_at_rest() -> None:
    """Moved over a rough floor and at rest again: the floor's force, and those at both ends,
    which friction makes unequal, bear the weight."""
    motion = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 4, "velocity": [-0.5, 0.5, 0]},
              {"t": 8, "velocity": [0, 0, 0]}]  # fmt: skip
    model = SystemModel(mooring(True, friction=0.5, velocity=motion))
    model.step_to(300.0)
    leg, found = model.lines["leg"], model.lines["leg"].on_floor
    ends = leg.sample([0.0, LENGTH])
    pulls = ends.tension[:, None] * ends.tangent
    left = found.floor_force + pulls[1] - pulls[0] - [0.0, 0.0, WEIGHT * LENGTH]
    assert left == pytest.approx(np.zeros(3), abs=1e-3 * leg.end_tension)
    assert np.hypot(*found.floor_force[:2]) > 0.01 * leg.end_tension


@pytest.mark.parametrize("at", ["start", "end"])
def test_what_a_winch_pays_out_comes_to_lie(at: str) -> None:
    """At rest again, after 4 m of pay-out: forces balance, and as much more lies as the catenary
    of the pull at the ship says, whose touchdown is where it begins to hang."""
    ends = [{"anchor": [60.0, 0, -20.0]}, "ship.eye"]
    one, other = ends[::-1] if at == "start" else ends
    rate = [
        {"t": 0, "rate": 0},
        {"t": 2, "rate": 0.2},
        {"t": 20, "rate": 0.2},
        {"t": 22, "rate": 0},
    ]
    scene = system(
        1e-3,
        0.3,
        vessels={"ship": {"points": {"eye": [0, 0, 0]}}},
        lines={"leg": {"from": one, "to": other, "items": [chain(70.0)]}},
        winches={"winch": {"line": "leg", "at": at, "drum": 50.0, "rate": rate}},
    )
    scene["environment"]["floor"]["z"] = -20.0
    model = SystemModel(scene)
    leg = model.lines["leg"]
    lay = leg.on_floor.floor_length
    model.step_to(90.0)
    found, ends = leg.on_floor, leg.sample([0.0, leg.length])
    pulls = ends.tension[:, None] * ends.tangent
    top = leg.start_tension if at == "start" else leg.end_tension
    left = found.floor_force + pulls[1] - pulls[0] - [0.0, 0.0, WEIGHT * leg.length]
    assert left == pytest.approx(np.zeros(3), abs=1e-3 * top)
    # Of T = H + w h and s^2 = h (h + 2 H / w).
    hangs = math.sqrt(20.0 * (2.0 * top / WEIGHT - 20.0))
    layer = math.sqrt(2.0 * 1e-3 * leg.length * (top / WEIGHT - 20.0))
    assert leg.length == pytest.approx(74.0)
    assert found.floor_length == pytest.approx(74.0 - hangs, abs=0.05 * layer)
    assert found.floor_length > lay + 4.0


@pytest.mark.parametrize("from_anchor", [False, True])
def test_what_is_stiff_rests_on_its_touchdown(from_anchor: bool) -> None:
    """EI k'' - H k = -w with k = 0 at the touchdown: its shear there is w sqrt(EI / H)."""
    stiffness = 7.4e7
    scene = mooring(from_anchor)
    scene["cable_types"]["chain"]["bending_stiffness"] = stiffness
    scene["lines"]["leg"]["items"][0]["cable"]["model"] = "elastica"
    leg = SystemModel(scene).lines["leg"]
    found, pull = leg.on_floor, min(leg.start_tension, leg.end_tension)
    expected = WEIGHT * math.sqrt(stiffness / pull)
    assert found.touchdown_reaction == pytest.approx(expected, rel=0.02)
    bears = WEIGHT * found.floor_length + found.touchdown_reaction
    assert found.floor_force[2] == pytest.approx(bears, rel=1e-3)


@pytest.mark.parametrize("from_anchor", [False, True])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_a_leg_is_a_catenary_whose_rest_lies(from_anchor: bool, tolerance: float) -> None:
    """Its touchdown, what lies, and what the floor bears, by the closed form."""
    exact = moored_catenary(ACROSS, RISE, LENGTH, WEIGHT, STIFFNESS, 0.0)
    leg = SystemModel(mooring(from_anchor, tolerance)).lines["leg"]
    found = leg.on_floor
    worth = math.sqrt(2.0 * tolerance * LENGTH * exact.horizontal / WEIGHT)
    assert found.floor_length == pytest.approx(exact.laid, abs=worth)
    end = ACROSS - exact.position(np.array([exact.laid]))[0, 0]
    assert found.touchdown_position == pytest.approx([end, 0.0, 0.0], abs=worth)
    top = leg.end_tension if from_anchor else leg.start_tension
    # T = H + w h, and what the floor bears is what the hanging part does not weigh.
    assert top == pytest.approx(exact.horizontal + WEIGHT * RISE, rel=2e-3)
    bears = WEIGHT * exact.laid + found.touchdown_reaction
    assert found.floor_force == pytest.approx([0.0, 0.0, bears], abs=10.0 * tolerance * top)


def hung(half: float, height: float) -> dict[str, Any]:
    """A chain between two ships, whose middle lies."""
    ship = {"points": {"eye": [0, 0, 0]}}
    return system(
        1e-4,
        vessels={
            "east": {"position": [half, 0, height], **ship},
            "west": {"position": [-half, 0, height], **ship},
        },
        lines={"leg": {"from": "east.eye", "to": "west.eye", "items": [chain(600.0)]}},
    )


def test_what_lies_between_two_ships_has_a_touchdown_at_both_ends() -> None:
    """Two moorings that meet in the middle: the point is that nearest to its beginning."""
    half, height = 270.0, 100.0

    exact = moored_catenary(half, height, 300.0, WEIGHT, STIFFNESS, 0.0)
    found = SystemModel(hung(half, height)).lines["leg"].on_floor
    layer = math.sqrt(2.0 * 1e-4 * 600.0 * exact.horizontal / WEIGHT)
    assert found.floor_length == pytest.approx(2.0 * exact.laid, abs=0.05 * layer)
    foot = exact.position(np.array([exact.laid]))[0, 0]  # from the middle
    assert found.touchdown_position == pytest.approx([foot, 0, 0], abs=0.05 * layer)
    assert found.floor_force[2] == pytest.approx(WEIGHT * 2.0 * exact.laid, rel=1e-3)


@pytest.mark.parametrize("turned", [False, True])
def test_a_line_that_rises_between_two_anchors(turned: bool) -> None:
    """A buoy lifts its middle: what lies does so on both sides, by vertical balance with a reaction
    at each end of it, and the first touchdown is that on the side of its beginning."""
    anchors = [{"anchor": [-150.0, 0, 0]}, {"anchor": [150.0, 0, 0]}]
    one, other = anchors[::-1] if turned else anchors
    lift = 60e3
    buoy = {"name": "buoy", "mass": 3000.0, "submerged_weight": -lift}
    items = [chain(170.0), {"body": buoy}, chain(170.0)]
    model = SystemModel(system(lines={"arch": {"from": one, "to": other, "items": items}}))
    found = model.lines["arch"].on_floor
    bears = 340.0 * WEIGHT - lift
    assert found.floor_force == pytest.approx([0.0, 0.0, bears], rel=1e-4, abs=1.0)
    lies = (bears - 2.0 * found.touchdown_reaction) / WEIGHT
    assert found.floor_length == pytest.approx(lies, rel=1e-4)
    side = 1.0 if turned else -1.0
    place = [side * (150.0 - 0.5 * lies), 0.0, 0.0]
    assert found.touchdown_position == pytest.approx(place, abs=0.01)


@pytest.mark.parametrize("stiffness", [0.0, 2e4])
def test_a_line_that_is_lifted_by_a_branch(stiffness: float) -> None:
    """Its ends are free: it is looked at from the middle, where the tree of nodes begins."""
    rope = {"diameter": 0.03, "mass": 0.7, "submerged_weight": 0.5, "axial_stiffness": 1e7}
    scene = system(
        1e-3,
        0.5,
        vessels={"ship": {"points": {"eye": [0, 0, 20.0]}}},
        lines={
            "low": {"from": "free", "to": "free", "items": [chain(60.0)]},
            "rope": {
                "from": "ship.eye",
                "to": {"line": "low", "at": 30.0},
                "items": [{"cable": {"type": "rope", "length": 15.0}}],
            },
        },
    )
    scene["cable_types"] = {"rope": rope, "chain": {**CHAIN, "bending_stiffness": stiffness}}
    lines = SystemModel(scene).lines
    found = lines["low"].on_floor
    bears = 60.0 * WEIGHT - lines["rope"].end_tension
    assert found.floor_force == pytest.approx([0.0, 0.0, bears], rel=1e-3, abs=1.0)
    lies = (bears - 2.0 * found.touchdown_reaction) / WEIGHT
    assert found.floor_length == pytest.approx(lies, rel=1e-3)
    assert 20.0 < lies < 55.0
    assert lines["rope"].on_floor.floor_length == 0.0


def test_a_line_that_touches_nowhere() -> None:
    scene = hung(270.0, 100.0)
    for ship in scene["vessels"].values():
        ship["position"][2] = 400.0
    found = SystemModel(scene).lines["leg"].on_floor
    assert np.isnan(found.touchdown_position).all()
    assert not found.floor_force.any()
    assert (found.floor_length, found.touchdown_reaction) == (0.0, 0.0)


def test_lines_are_told_apart() -> None:
    """A leg beside others, on a branch and in other company, does what it does alone."""
    alone = SystemModel(mooring(True)).lines["leg"].on_floor
    scene = mooring(True)
    scene["vessels"]["other"] = {"position": [0, 500, 300], "points": {"eye": [0, 0, 0]}}
    scene["lines"] = {
        "hangs": {"from": "other.eye", "to": "free", "items": [chain(200.0)]},
        **scene["lines"],
        "lies": {
            "from": {"anchor": [ACROSS, 500, 0]},
            "to": {"anchor": [ACROSS - 100.0, 500, 0]},
            "items": [chain(100.0)],
        },
    }
    lines = SystemModel(scene).lines
    found = lines["leg"].on_floor
    assert found.floor_length == pytest.approx(alone.floor_length, abs=1e-6)
    assert found.floor_force == pytest.approx(alone.floor_force, abs=1e-3)
    assert lines["hangs"].on_floor.floor_length == 0.0
    lies = lines["lies"].on_floor
    assert lies.floor_length == pytest.approx(100.0, rel=1e-3)
    assert lies.floor_force[2] == pytest.approx(100.0 * WEIGHT, rel=1e-3)
    assert lies.touchdown_position == pytest.approx([ACROSS, 500.0, 0.0], abs=0.1)


@pytest.mark.parametrize("from_anchor", [False, True])
def test_what_is_cut_off_comes_down(from_anchor: bool) -> None:
    """Cut 700 m from its anchor, all of that lies in the end, and the rest hangs clear; it touches
    first where it was cut."""
    scene = mooring(from_anchor, 1e-3, friction=0.5)
    at = 700.0 if from_anchor else LENGTH - 700.0
    scene["cuts"] = {"knife": {"line": "leg", "at": at, "time": 1.0}}
    model = SystemModel(scene)
    leg = model.lines["leg"]
    assert leg.on_floor.floor_length < 200.0
    for time in np.arange(1.0, 91.0):
        model.step_to(float(time))
        # Folds or not, the floor bears what it touches: the contact layer is 0.06 tau L.
        assert leg.on_floor.touchdown_position[2] < 0.06 * 1e-3 * LENGTH
    found = leg.on_floor
    assert found.floor_length == pytest.approx(700.0, rel=0.01)
    assert found.floor_force[2] == pytest.approx(700.0 * WEIGHT, rel=0.01)
    state = leg.sample()
    ends = np.flatnonzero(state.s == at)
    there = state.position[ends[0] if from_anchor else ends[-1]]
    assert found.touchdown_position == pytest.approx(there, abs=2.0)
