"""Systems above a sea floor, against catenaries that lie on it."""

from __future__ import annotations

import math
import warnings
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import fsolve

import cablemodel as cm
from cablemodel.cli.plausibility import held_by_springs, system_start_warnings
from cablemodel.solvers.finite_element.start import firm_friction
from cablemodel.solvers.shared import layout as at
from tests.verification.references.moored import moored_catenary

LENGTH, WEIGHT, STIFFNESS, DEPTH = 280.0, 850.0, 300e6, 100.0
ANGLES = np.radians([0.0, 120.0, 240.0])


def buoy_on_three_legs(friction: float = 0.0) -> dict[str, Any]:
    """Chain legs from anchors on the floor to a submerged buoy."""
    points, lines = {}, {}
    for name, angle in zip("abc", ANGLES, strict=True):
        way = np.array([np.cos(angle), np.sin(angle), 0.0])
        points[name] = (3.0 * way).tolist()
        anchor = (250.0 * way - [0.0, 0.0, DEPTH]).tolist()
        items = [{"cable": {"type": "chain", "length": LENGTH}}]
        lines[name] = {"from": {"anchor": anchor}, "to": f"buoy.{name}", "items": items}
    return {
        "environment": {"water_density": 1025.0, "floor": {"z": -DEPTH, "friction": friction}},
        "cable_types": {
            "chain": {
                "diameter": 0.1, "mass": 100.0, "submerged_weight": WEIGHT,
                "axial_stiffness": STIFFNESS, "drag_normal": 1.2,
            }
        },
        "bodies": {
            "buoy": {
                "mass": 3e4, "submerged_weight": -2.5e5, "inertia": 6e4, "added_mass": 2e4,
                "drag_area": 20.0, "drag_turning": 5000.0, "position": [0, 0, -12],
                "points": points,
            }
        },
        "lines": lines,
    }  # fmt: skip


def leg_forces(away: float, rise: float) -> tuple[float, float]:
    """Horizontal and vertical pull (H, V) [N] of an elastic catenary whose rest lies on the floor,
    without friction, on its upper end so far from its anchor and above it [m]."""

    def off(logs: Any) -> Any:
        h, v = np.exp(logs)
        lies = LENGTH - v / WEIGHT
        x = h / WEIGHT * np.arcsinh(v / h) + h * LENGTH / STIFFNESS + lies
        z = h / WEIGHT * (np.hypot(1.0, v / h) - 1.0) + v**2 / (2.0 * STIFFNESS * WEIGHT)
        return [x - away, z - rise]

    h, v = np.exp(fsolve(off, np.log([3e4, 8e4]), xtol=1e-13))
    return float(h), float(v)


@pytest.fixture(scope="module")
def at_rest() -> cm.SystemModel:
    return cm.SystemModel(buoy_on_three_legs())


def pulls(model: cm.SystemModel) -> dict[str, tuple[float, float]]:
    """Those of all legs as they stand."""
    found = {}
    for name, line in model.lines.items():
        ends = line.sample([0.0, line.length]).position
        found[name] = leg_forces(float(np.hypot(*(ends[1] - ends[0])[:2])), ends[1, 2] - ends[0, 2])
    return found


def test_a_buoy_floats_where_its_legs_weigh_what_it_lifts(at_rest: cm.SystemModel) -> None:
    for name, (h, v) in pulls(at_rest).items():
        assert at_rest.lines[name].end_tension == pytest.approx(np.hypot(h, v), rel=2e-3)
        assert 3.0 * v == pytest.approx(2.5e5, rel=2e-3)
    assert np.abs(at_rest.bodies["buoy"].position[:2]).max() < 0.01


def test_a_buoy_pushed_aside_finds_the_restoring_force_of_three_catenaries(
    at_rest: cm.SystemModel,
) -> None:
    model = cm.SystemModel(at_rest.scene)
    push = np.array([2e4, 0.0, 0.0, 0.0, 0.0, 0.0])
    for _ in range(60):
        model.step(10.0, forces={"buoy": push})
    total = np.zeros(3)
    for name, (h, v) in pulls(model).items():
        ends = model.lines[name].sample([0.0, LENGTH]).position
        way = (ends[0] - ends[1])[:2] / np.hypot(*(ends[0] - ends[1])[:2])
        total += [*(h * way), -v]
    assert total[0] == pytest.approx(-2e4, rel=0.01)
    assert abs(total[1]) < 20.0
    assert total[2] == pytest.approx(-2.5e5, rel=2e-3)
    assert model.bodies["buoy"].position[0] > 1.0


def test_the_mesh_follows_a_touchdown(at_rest: cm.SystemModel) -> None:
    """Elements come and go on all legs; those of the others stay theirs."""
    model = cm.SystemModel(at_rest.scene)
    for k in range(40):
        force = 1e5 * np.sin(2.0 * np.pi * k / 10.0)
        model.step(1.0, forces={"buoy": [force, 0.5 * force, 0.0, 0.0, 0.0, 0.0]})
        for name, line in model.lines.items():
            state = line.sample()
            assert np.all(np.diff(state.s) > 0.0)
            assert state.s[-1] == LENGTH
            chords = np.linalg.norm(np.diff(state.position, axis=0), axis=1)
            assert chords.sum() == pytest.approx(LENGTH, rel=0.02), name
            assert state.position[:, 2].min() > -DEPTH - 0.1
    again = cm.SystemModel(at_rest.scene)
    again.restore(model.snapshot())
    model.step(3.0)
    again.step(3.0)
    assert model.snapshot() == again.snapshot()


def test_an_anchor_below_the_floor_is_named() -> None:
    data = buoy_on_three_legs()
    data["lines"]["b"]["from"]["anchor"][2] = -120.0
    with pytest.raises(cm.SceneError, match=r"lines\.b\.from\.anchor.*below the sea floor"):
        cm.load_system(data)


def lander(friction: float = 0.5, pull: float = 0.0) -> dict[str, Any]:
    """A frame on four feet that a wire lowers."""
    corners = [[x, y, -0.5] for x in (-1.0, 1.0) for y in (-0.8, 0.8)]
    return {
        "environment": {"water_density": 1025.0, "floor": {"z": -30.0, "friction": friction}},
        "cable_types": {
            "wire": {"diameter": 0.012, "mass": 0.5, "axial_stiffness": 5e6, "drag_normal": 1.2}
        },
        "vessels": {"ship": {"points": {"hook": [pull, 0, 0]}}},
        "bodies": {
            "lander": {
                "mass": 600.0, "submerged_weight": 4e3, "inertia": [300, 400, 500],
                "added_mass": 300.0, "drag_area": 2.0, "drag_turning": 10.0,
                "points": {"eye": [0, 0, 0.6]}, "feet": corners,
            }
        },
        "lines": {
            "wire": {
                "from": "ship.hook", "to": "lander.eye",
                "items": [{"cable": {"type": "wire", "length": 26.0}}],
            }
        },
    }  # fmt: skip


def test_a_body_stands_on_its_feet() -> None:
    """Lowered on to the floor it stands: the wire bears its own weight alone."""
    model = cm.SystemModel(lander())
    assert model.lines["wire"].end_tension == pytest.approx(4e3, rel=1e-3)
    for _ in range(100):
        model.step(0.5, vessels={"ship": cm.VesselInput(velocity=[0, 0, -0.1])})
    for _ in range(60):
        model.step(0.5, vessels={"ship": cm.VesselInput(velocity=[0, 0, 0])})
    body = model.bodies["lander"]
    depth = 0.06 * 1e-3 * 26.0  # of the contact layer
    assert body.position[2] == pytest.approx(-29.5, abs=depth)
    assert np.abs(body.attitude[:2]).max() < depth
    assert abs(model.lines["wire"].end_tension) < 20.0


def test_friction_holds_a_body_up_to_its_limit() -> None:
    """Pushed along the floor by less than mu W it stays; by more it slides."""
    scene = lander()
    scene["lines"]["wire"]["items"][0]["cable"]["length"] = 29.2
    scene["environment"]["floor"]["z"] = -29.5
    model = cm.SystemModel(scene)
    for _ in range(40):
        model.step(0.5)
    start = model.bodies["lander"].position.copy()
    weight = 4e3 - model.lines["wire"].end_tension
    for _ in range(20):
        model.step(0.5, forces={"lander": [0.35 * weight, 0, 0, 0, 0, 0]})
    assert np.linalg.norm(model.bodies["lander"].position - start) < 0.01
    for _ in range(4):
        model.step(0.5, forces={"lander": [0.8 * weight, 0, 0, 0, 0, 0]})
    assert model.bodies["lander"].position[0] - start[0] > 0.2


SLACK, GRAVITY, WATER = 100.0, 9.80665, 1025.0
HANGING = {
    "rope": {"diameter": 0.016, "mass": 0.16, "axial_stiffness": 4e5, "bending_stiffness": 0.3},
    "umbilical": {"diameter": 0.03, "mass": 1.1, "axial_stiffness": 4e6, "bending_stiffness": 27.0},
    "chain": {"diameter": 0.03, "mass": 18.0, "axial_stiffness": 6e7},
}


def weight_of(kind: str) -> float:
    """Of a metre in water [N]."""
    own = HANGING[kind]
    return (own["mass"] - WATER * math.pi / 4.0 * own["diameter"] ** 2) * GRAVITY


@pytest.mark.parametrize("kind", list(HANGING))
@pytest.mark.parametrize("height", [99.5, 95.0, 90.0, 40.0])
def test_slack_below_its_upper_end_hangs_doubled(kind: str, height: float) -> None:
    """Each end bears the weight of what hangs below it, (L + h) / 2 and (L - h) / 2 of a line that
    sinks; upright between its ends the line would be a strut, at -EA (L - h) / L."""
    weight = weight_of(kind)
    scene = {
        "cable_types": {"line": HANGING[kind]},
        "vessels": {"ship": {"points": {"eye": [0, 0, 0]}}},
        "lines": {
            "line": {
                "from": {"anchor": [0, 0, -height]},
                "to": "ship.eye",
                "items": [{"cable": {"type": "line", "length": SLACK}}],
            }
        },
    }
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model = cm.SystemModel(scene)
    line = model.lines["line"]
    # A rope floats. What bends takes the room of its bend, some (EI / w)^(1/3), from the parts.
    most, least = 0.5 * (SLACK + height) * weight, 0.5 * (SLACK - height) * weight
    ends = (most, least) if weight > 0.0 else (-least, -most)
    stiffness = HANGING[kind].get("bending_stiffness", 0.0)
    bend = 2.0 * abs(weight) * (stiffness / abs(weight)) ** (1.0 / 3.0)
    allowed = 0.002 * max(map(abs, ends)) + bend
    assert (line.end_tension, line.start_tension) == pytest.approx(ends, abs=allowed)
    largest = max(map(abs, ends))
    assert line.sample().tension.min() > -bend - 0.002 * largest
    # Within the element that turns, as far as tensions are promised.
    assert line.tension_range[0] > -bend - 10.0 * model.scene.solver.tolerance * largest


@pytest.mark.parametrize("depth", [90.0, 70.0])
def test_a_buoy_above_its_anchor_floats_on_slack_chain(depth: float) -> None:
    """By Archimedes: what it displaces, less the chain that hangs below it."""
    weight, radius, mass = weight_of("chain"), 1.5, 20e3
    buoy = {
        "mass": mass, "hull": {"diameter": 2.0 * radius, "height": 6.0}, "inertia": 60e3,
        "centre_of_gravity": [0, 0, -1.5], "points": {"keel": [0, 0, -3.0]},
    }  # fmt: skip
    scene = {
        "cable_types": {"line": HANGING["chain"]},
        "bodies": {"buoy": buoy},
        "lines": {
            "leg": {
                "from": {"anchor": [0, 0, -depth]},
                "to": "buoy.keel",
                "items": [{"cable": {"type": "line", "length": SLACK}}],
            }
        },
    }
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model = cm.SystemModel(scene)
    keel = model.bodies["buoy"].position[2] - 3.0
    hangs = 0.5 * (SLACK + depth + keel)
    floats = -WATER * math.pi * radius**2 * keel * GRAVITY
    assert floats == pytest.approx(mass * GRAVITY + weight * hangs, rel=2e-4)
    assert model.lines["leg"].end_tension == pytest.approx(weight * hangs, rel=2e-3)


FRICTION, CHAIN = 0.6, 222.0


def moored_ship(items: list[dict[str, Any]], tolerance: float = 1e-3) -> dict[str, Any]:
    """130 m of cable from an anchor to a ship 45 m above the floor, which hauls at it from 2 s on
    for 2.5 m."""
    hauls = [(0.0, 0.0), (2.0, 0.0), (4.0, 0.25), (12.0, 0.25), (14.0, 0.0)]
    kinds = {
        "chain": {"diameter": 0.036, "mass": 26.0, "axial_stiffness": 1e8},
        "heavy": {"diameter": 0.06, "mass": 70.0, "axial_stiffness": 4e8},
    }
    for kind, weight in ("chain", CHAIN), ("heavy", 600.0):
        kinds[kind]["submerged_weight"] = weight
    used = {item["cable"]["type"] for item in items if "cable" in item}
    return {
        "environment": {"floor": {"z": -45.0, "friction": FRICTION}},
        "cable_types": {name: kind for name, kind in kinds.items() if name in used},
        "vessels": {
            "ship": {
                "position": [108.0, 0, 0],
                "points": {"eye": [0, 0, 0]},
                "velocity": [{"t": t, "velocity": [v, 0, 0]} for t, v in hauls],
            }
        },
        "lines": {"leg": {"from": {"anchor": [0, 0, -45.0]}, "to": "ship.eye", "items": items}},
        "solver": {"tolerance": tolerance},
    }


def piece(length: float, kind: str = "chain") -> dict[str, Any]:
    return {"cable": {"type": kind, "length": length}}


def warned_of_its_start(model: cm.SystemModel) -> list[str]:
    """Not of what friction lets through as lines move."""
    return [words for words in system_start_warnings(model) if " as it moves" not in words]


def off_coulomb(model: cm.SystemModel, name: str, weight: float, stiffness: float) -> float:
    """By how much tensions of a line that begins at its anchor miss those of one that was laid and
    then pulled to where its end is, in what is promised: the most along it."""
    line, friction = model.lines[name], model.scene.environment.floor.friction
    s = np.linspace(0.0, line.length, 1001)
    found = line.sample(s)
    way = found.position[-1] - found.position[0]
    across = float(np.hypot(*way[:2]))
    exact = moored_catenary(across, float(way[2]), line.length, weight, stiffness, friction)
    wanted = exact.tension(s)
    off = np.abs(found.tension - wanted).max()
    return float(off / (10.0 * model.scene.solver.tolerance * wanted.max()))


def test_friction_holds_the_legs_of_a_buoy_from_the_start_on() -> None:
    """Also at rest for 30 s. Legs are as stiff as chain, and lie far to their anchors."""
    scene = buoy_on_three_legs(0.6)
    for name, angle in zip("abc", ANGLES, strict=True):
        way = np.array([np.cos(angle), np.sin(angle), 0.0])
        scene["lines"][name]["from"] = {"anchor": (400.0 * way - [0.0, 0.0, DEPTH]).tolist()}
        scene["lines"][name]["items"][0]["cable"]["length"] = LENGTH + 150.0
    model = cm.SystemModel(scene)
    assert warned_of_its_start(model) == []
    for time in (0.0, 30.0):
        if time:
            model.step_to(time)
        for name, line in model.lines.items():
            assert off_coulomb(model, name, WEIGHT, STIFFNESS) < 3.0
            assert abs(line.start_tension) < 3e-2 * line.end_tension


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
@pytest.mark.parametrize("turned", [False, True])
def test_friction_holds_a_line_of_a_ship_from_the_start_on(tolerance: float, turned: bool) -> None:
    """No tension comes to its anchor, which it would pull at by 6,400 N. Then it is hauled at:
    friction's springs let through less than a tenth of the largest tension."""
    scene = moored_ship([piece(130.0)], tolerance)
    leg = scene["lines"]["leg"]
    if turned:
        leg["from"], leg["to"] = leg["to"], leg["from"]
    model = cm.SystemModel(scene)
    line = model.lines["leg"]
    assert warned_of_its_start(model) == []
    promised = 10.0 * tolerance * line.tension_range[1]
    assert abs(line.end_tension if turned else line.start_tension) < promised
    if not turned:
        assert off_coulomb(model, "leg", CHAIN, 1e8) < (3.0 if tolerance == 1e-3 else 6.0)
        model.step_to(40.0)
        assert off_coulomb(model, "leg", CHAIN, 1e8) < 0.1 / (10.0 * tolerance)


@pytest.mark.parametrize(
    ("items", "lost"),
    [
        ([piece(40.0, "heavy"), piece(90.0)], {40.0: 0.0, 35.0: 5.0 * 600.0, 20.0: 20.0 * 600.0}),
        (
            [piece(50.0), {"body": {"name": "clump", "mass": 500.0, "submerged_weight": 3000.0}},
             piece(80.0)],
            {51.0: 0.0, 49.0: 3000.0 + 2.0 * CHAIN, 40.0: 3000.0 + 11.0 * CHAIN, 0.0: 1e5},
        ),
    ],
    ids=["two cables", "a clump"],
)  # fmt: skip
def test_friction_takes_from_the_tension_what_lies_weighs(
    items: list[dict[str, Any]], lost: dict[float, float]
) -> None:
    """From a place that lies on to the anchor: mu times that, and no more than there is."""
    scene = moored_ship(items)
    scene["vessels"]["ship"].pop("velocity")
    model = cm.SystemModel(scene)
    line, (first, *_) = model.lines["leg"], lost
    for time in (0.0, 30.0):
        if time:
            model.step_to(time)
        found = dict(zip(lost, line.sample(list(lost)).tension, strict=True))
        horizontal = line.end_tension - 45.0 * CHAIN
        lies = line.on_floor.floor_length
        assert found[first] == pytest.approx(
            horizontal - FRICTION * CHAIN * (lies - first), abs=3e-2 * line.end_tension
        )
        for arc, weight in lost.items():
            wanted = max(0.0, found[first] - FRICTION * weight)
            assert found[arc] == pytest.approx(wanted, abs=3e-2 * line.end_tension)


def test_check_tells_of_friction_that_lets_more_through_as_a_line_moves() -> None:
    """Its start is right; the springs of the steps are longer."""
    model = cm.SystemModel(moored_ship([piece(130.0)]))
    (warning,) = system_start_warnings(model)
    most = held_by_springs(model, "leg")[1]
    assert f"up to {most:.4g} N too much or too little as it moves" in warning
    line = model.lines["leg"]
    model.step_to(14.0)
    behind = line.sample([30.0])
    let_through = line.start_tension - max(0.0, behind.tension[0] - 30.0 * FRICTION * CHAIN)
    assert 0.0 < let_through < most


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_check_tells_by_how_much_soft_friction_misses_the_tension_of_an_anchor(
    tolerance: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no start is found that friction holds, it begins without. Coulomb's friction takes mu w
    a metre from a tension that rises at the touchdown, and lets none of it come to an anchor far
    behind: springs do, by no more than `check` says."""
    lies = 30.0
    finds_none = SimpleNamespace(
        equilibrium=lambda *_: at.STATICS_FAILED, OutOfTimeError=TimeoutError
    )
    monkeypatch.setattr(firm_friction, "search", finds_none)
    model = cm.SystemModel(moored_ship([piece(130.0)], tolerance))
    line = model.lines["leg"]
    first, largest = line.start_tension, line.end_tension
    assert first == pytest.approx(largest - 45.0 * CHAIN, rel=2e-2)
    (warning,) = system_start_warnings(model)
    reach, most = held_by_springs(model, "leg")
    assert f"up to {most:.4g} N" in warning
    assert reach * FRICTION * CHAIN == pytest.approx(most)
    model.step_to(14.0)
    behind = line.sample([lies])
    assert behind.on_floor[0]
    assert behind.tension[0] - first < 0.5 * FRICTION * CHAIN * lies  # which holds all of that
    assert 10.0 * tolerance * largest < line.start_tension - first < most


def test_check_says_nothing_of_friction_that_takes_hold_soon_enough() -> None:
    """As on rope, which stretches, or where nothing lies."""
    for friction in (0.0, 0.3):
        scene = buoy_on_three_legs(friction)
        scene["cable_types"]["chain"]["axial_stiffness"] = 3e5
        assert "friction" not in "".join(system_start_warnings(cm.SystemModel(scene)))


MU, SLEDGE, HEIGHT = 0.5, 5e3, 0.4
CDA, TOWED = 0.01, 0.4


def sledge(away: float) -> dict[str, Any]:
    """A sledge on the floor, on 90 m of wire from a ship that gets under way at 3 s."""
    feet = [[x, y, -HEIGHT] for x in (-1.0, 1.0) for y in (-0.6, 0.6)]
    speeds = [(0.0, 0.0), (3.0, 0.0), (10.0, TOWED)]
    return {
        "environment": {"floor": {"z": -40.0, "friction": MU}},
        "cable_types": {
            "wire": {
                "diameter": 0.024, "mass": 2.25, "axial_stiffness": 26e6, "bending_stiffness": 60.0,
                "drag_normal": 1.2, "added_mass": 1.0,
            }
        },
        "vessels": {
            "ship": {
                "points": {"stern": [0, 0, 0]},
                "velocity": [{"t": t, "velocity": [v, 0, 0]} for t, v in speeds],
            }
        },
        "bodies": {
            "sledge": {
                "mass": 700.0, "submerged_weight": SLEDGE, "inertia": [150, 300, 350],
                "drag_area": CDA, "drag_turning": 1.0, "feet": feet,
                "points": {"eye": [1.2, 0, 0]}, "position": [-away, 0, HEIGHT - 40.0],
            }
        },
        "lines": {
            "wire": {
                "from": "ship.stern", "to": "sledge.eye",
                "items": [{"cable": {"type": "wire", "length": 90.0}}],
            }
        },
    }  # fmt: skip


def along_and_held(model: cm.SystemModel) -> tuple[float, float]:
    """Of the wire on the sledge: along the floor, and friction's largest then [N]."""
    line = model.lines["wire"]
    end = line.sample([line.length])
    pull = -float(end.tension[0]) * end.tangent[0]
    return float(pull[0]), MU * (SLEDGE - float(pull[2]))


def test_a_sledge_stands_where_it_is_put_and_is_towed_against_its_friction() -> None:
    model = cm.SystemModel(sledge(75.0))
    moved = model.bodies["sledge"].position - [-75.0, 0.0, HEIGHT - 40.0]
    assert np.abs(moved).max() < 0.02 * 1e-3 * 90.0
    along, most = along_and_held(model)
    assert 0.1 * most < along < 0.5 * most
    model.step_to(2.5)
    assert model.bodies["sledge"].position[0] == pytest.approx(-75.0 + moved[0], abs=1e-4)
    model.step_to(90.0)
    assert model.bodies["sledge"].velocity[0] == pytest.approx(TOWED, rel=1e-4)
    along, most = along_and_held(model)
    assert along == pytest.approx(most + 0.5 * WATER * CDA * TOWED**2, rel=1e-3)


def test_a_sledge_that_is_put_out_of_reach_comes_to_where_friction_holds_it() -> None:
    model = cm.SystemModel(sledge(86.0))
    start = model.bodies["sledge"].position
    assert -84.0 < start[0] < -79.0
    along, most = along_and_held(model)
    assert along == pytest.approx(most, rel=1e-3)
    model.step_to(2.5)
    assert model.bodies["sledge"].position == pytest.approx(start, abs=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.6, 0.2])
def test_a_body_that_lands_on_a_slope_is_slowed_by_the_friction_of_the_blow(
    friction: float,
) -> None:
    """It falls 0.332 m without water, on four feet at once. The blow's friction takes mu v_n from
    its speed along the slope, if there is as much: then g (sin a - mu cos a) speeds it up."""
    slope = math.radians(20.0)
    s, c = math.sin(slope), math.cos(slope)
    given = {
        "environment": {
            "water_density": 0.0,
            "floor": {"z": -20.0, "slope": [s / c, 0], "friction": friction, "damping": 5.0},
        },
        "cable_types": {"wire": {"diameter": 0.01, "mass": 0.05, "axial_stiffness": 1e5}},
        "bodies": {
            "load": {
                "mass": 500.0, "submerged_weight": 500.0 * GRAVITY, "inertia": 100.0,
                "points": {"top": [0.5 * s, 0, 0.5 * c]}, "attitude": [0, -slope, 0],
                "feet": [[x, y, -0.4] for x in (0.6, -0.6) for y in (0.6, -0.6)],
                "position": [0, 0, -19.3],
            }
        },
        "lines": {
            "wire": {
                "from": {"anchor": [0, 0, -10]}, "to": "load.top",
                "items": [{"cable": {"type": "wire", "length": 8.33}}],
            }
        },
        "cuts": {"slip": {"line": "wire", "at": "end", "time": 1.0}},
        "solver": {"tolerance": 3e-4},
    }  # fmt: skip
    model = cm.SystemModel(given)
    normal, down = np.array([-s, 0, c]), np.array([-c, 0, -s])
    origin = np.array([0.0, 0.0, 20.0])
    place = model.bodies["load"].position + origin
    way = (place @ normal - 0.4) / c
    landed = 1.0 + math.sqrt(2.0 * way / GRAVITY)
    model.step_to(landed + 1.0)
    load = model.bodies["load"]
    if friction * c > s:
        where = (load.position + origin - place) @ down
        assert where == pytest.approx(way * s, abs=0.01)
        assert np.abs(load.velocity).max() < 1e-3
        return
    speed = math.sqrt(2.0 * GRAVITY * way)
    after = speed * (s - friction * c) + GRAVITY * (s - friction * c)
    assert load.velocity @ down == pytest.approx(after, abs=0.05)
