"""Systems of lines, bodies and vessels against closed forms that no code of ours produced."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.optimize import brentq, fsolve
from typer.testing import CliRunner

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.errors import SceneError, StepError
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel.systems import SystemModel, load_system
from cablemodel.systems.equilibrium import without_shape
from cablemodel.systems.inputs import VesselInput
from tests.verification.references.bodies import free_spin

G = 9.81
STRING = {"diameter": 0.002, "mass": 0.002, "axial_stiffness": 2e6, "submerged_weight": 0.002 * G}


def string(length: float, **more: Any) -> list[dict[str, Any]]:
    """A perfectly flexible, light line."""
    return [{"cable": {"type": "string", "length": length, "model": "cable", **more}}]


def in_vacuum(**parts: Any) -> dict[str, Any]:
    """A scene without water."""
    return {
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": {"string": STRING},
        **parts,
    }


def hung_bar(tolerance: float = 1e-4) -> dict[str, Any]:
    """A bar on two equal strings."""
    bar = {
        "mass": 20.0,
        "submerged_weight": 20.0 * G,
        "inertia": [0.5, 3.0, 3.0],
        "points": {"a": [0.6, 0, 0], "b": [-0.6, 0, 0]},
    }
    return in_vacuum(
        bodies={"bar": bar},
        lines={
            "one": {"from": {"anchor": [0.6, 0, 0]}, "to": "bar.a", "items": string(5.0)},
            "two": {"from": {"anchor": [-0.6, 0, 0]}, "to": "bar.b", "items": string(5.0)},
        },
        solver={"tolerance": tolerance},
    )


def crossings(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Times at which values change sign."""
    k = np.flatnonzero(np.diff(np.sign(values)) != 0)
    return times[k] - values[k] * (times[k + 1] - times[k]) / (values[k + 1] - values[k])


def test_bifilar_pendulum() -> None:
    """A bar on two strings turns with the period 2 pi sqrt(I h / (m g a b)), small angles."""
    model = SystemModel(hung_bar())
    assert model.bodies["bar"].position == pytest.approx([0.0, 0.0, -5.0], abs=1e-3)
    model.step(0.5, forces={"bar": [0, 0, 0, 0, 0, 0.5]})
    model.step(0.5)
    times, yaws = [], []
    for _ in range(500):
        model.step(0.02)
        times.append(model.time)
        yaws.append(model.bodies["bar"].attitude[2])
    assert max(np.abs(yaws)) < 0.05
    half = np.diff(crossings(np.array(times), np.array(yaws)))
    expected = 2.0 * math.pi * math.sqrt(3.0 * 5.0 / (20.0 * G * 0.6 * 0.6))
    assert 2.0 * half.mean() == pytest.approx(expected, rel=2e-3)


def test_plate_on_three_strings() -> None:
    """An off-centre weight on three vertical strings: tensions by balance of forces and moments."""
    places = {"a": [1.0, 0.0, 0.0], "b": [-0.5, 0.8, 0.0], "c": [-0.5, -0.8, 0.0]}
    centre = np.array([0.1, 0.15, 0.0])
    plate = {
        "mass": 50.0,
        "submerged_weight": 50.0 * G,
        "inertia": [5.0, 5.0, 9.0],
        "centre_of_gravity": centre.tolist(),
        "points": places,
    }
    lines = {
        name: {"from": {"anchor": [*place[:2], 0]}, "to": f"plate.{name}", "items": string(4.0)}
        for name, place in places.items()
    }
    model = SystemModel(in_vacuum(bodies={"plate": plate}, lines=lines))
    arms = np.array(list(places.values()))
    balance = np.vstack([np.ones(3), arms[:, 0], arms[:, 1]])
    expected = np.linalg.solve(balance, 50.0 * G * np.array([1.0, *centre[:2]]))
    found = [model.lines[name].end_tension for name in places]
    assert found == pytest.approx(expected, rel=1e-4)


def test_torque_free_body() -> None:
    """A body that hangs by its centre of gravity turns as Euler's equations say, and keeps its
    angular momentum and energy (Poinsot)."""
    inertia = np.array([1.0, 2.0, 2.5])
    body = {
        "mass": 10.0,
        "submerged_weight": 98.1,
        "inertia": inertia.tolist(),
        "points": {"c": [0, 0, 0]},
    }
    model = SystemModel(
        in_vacuum(
            bodies={"body": body},
            lines={"line": {"from": {"anchor": [0, 0, 0]}, "to": "body.c", "items": string(3.0)}},
            solver={"tolerance": 1e-5},
        )
    )
    model.step(1.0, forces={"body": [0, 0, 0, 0.3, 3.0, 0.6]})
    model.step(1.0)

    def spin() -> np.ndarray:
        state = model.bodies["body"]
        return state.axes.T @ state.angular_velocity

    def momentum() -> np.ndarray:
        return np.asarray(model.bodies["body"].axes @ (inertia * spin()))

    first, energy = momentum(), 0.5 * inertia @ spin() ** 2
    start, begun = spin(), model.time
    worst = 0.0
    solution = free_spin(inertia, start, 30.0)
    for _ in range(60):
        model.step(0.5)
        worst = max(worst, float(np.abs(spin() - solution(model.time - begun)).max()))
    assert np.linalg.norm(start) > 0.5
    assert worst < 2e-3 * float(np.linalg.norm(start))
    assert momentum() == pytest.approx(first, abs=1e-3 * float(np.linalg.norm(first)))
    assert 0.5 * inertia @ spin() ** 2 == pytest.approx(energy, rel=1e-3)


def towed(**parts: Any) -> dict[str, Any]:
    """A scene in water behind a tug at 2 m/s, lines that hardly weigh or drag."""
    wire = {
        "diameter": 0.004,
        "mass": 0.0129,
        "axial_stiffness": 1e6,
        "submerged_weight": 0.001,
        "drag_normal": 0.0,
        "drag_tangential": 0.0,
    }
    return {
        "environment": {"water_density": 1025.0},
        "cable_types": {"wire": wire},
        **parts,
    }


def wire(length: float) -> list[dict[str, Any]]:
    return [{"cable": {"type": "wire", "length": length, "model": "cable"}}]


def test_bridle() -> None:
    """Legs of a Y bridle carry T / (2 cos(half angle)) each."""
    tug = {
        "points": {"port": [0.0, 6.0, 0.0], "starboard": [0.0, -6.0, 0.0]},
        "velocity": [2.0, 0.0, 0.0],
        "position": [0.0, 0.0, -50.0],
    }
    model = SystemModel(
        towed(
            vessels={"tug": tug},
            bodies={
                "fish": {
                    "mass": 100.0,
                    "submerged_weight": 0.5,
                    "inertia": 10.0,
                    "drag_area": 0.8,
                    "points": {"nose": [0.5, 0.0, 0.0]},
                }
            },
            lines={
                "port": {"from": "tug.port", "to": "fish.nose", "items": wire(20.0)},
                "starboard": {"from": "tug.starboard", "to": "fish.nose", "items": wire(20.0)},
            },
        )
    )
    drag = 0.5 * 1025.0 * 0.8 * 2.0**2
    half = math.asin(6.0 / 20.0)
    for name in ("port", "starboard"):
        assert model.lines[name].start_tension == pytest.approx(
            drag / (2.0 * math.cos(half)), rel=1e-3
        )
    force = model.wrenches["tug"]
    assert force[:3] == pytest.approx([-drag, 0.0, -0.54], abs=2.0)
    before = model.bodies["fish"].position[0]
    model.step(10.0)
    assert model.bodies["fish"].position[0] - before == pytest.approx(20.0, abs=1e-3)


MEASURED = [
    (-180, 0.0, 0.05), (-12, -0.9, 0.1), (-4.1, -0.1, 0.02), (-3.9, -0.35, 0.02), (3, 0.3, 0.02),
    (12, 0.9, 0.08), (180, 0.0, 0.05),
]  # fmt: skip
"""Of a foil: angle of attack [degrees], lift and drag coefficients; two rows are close."""


@pytest.mark.parametrize("table", [None, MEASURED])
@pytest.mark.parametrize("deflection", [0.0, -0.08])
def test_depressor(deflection: float, table: list[tuple[float, float, float]] | None) -> None:
    """A foil on a line that neither weighs nor drags: its depth by lift, drag and weight."""
    wing = {
        "area": 0.5, "aspect_ratio": 4.0, "drag": 0.02, "deflection": deflection, "table": table,
    }  # fmt: skip
    bird = {
        "mass": 60.0,
        "submerged_weight": 200.0,
        "inertia": [5.0, 8.0, 8.0],
        "drag_area": [0.05, 0.05, 0.05],
        "drag_turning": 5.0,
        "points": {"nose": [0.0, 0.0, 0.0]},
        "foils": {"wing": wing, "tail": {"area": 0.2, "position": [-1.5, 0.0, 0.0], "drag": 0.02}},
    }
    model = SystemModel(
        towed(
            vessels={"tug": {"points": {"stern": [0, 0, 0]}, "velocity": [3.0, 0.0, 0.0]}},
            bodies={"bird": bird},
            lines={"tow": {"from": "tug.stern", "to": "bird.nose", "items": wire(30.0)}},
        )
    )
    state = model.bodies["bird"]
    pitch = -math.asin(state.axes[2, 0])  # nose down
    own = model.scene.bodies["bird"].foils
    q = 0.5 * 1025.0 * 9.0

    def forces(nose_down: float) -> tuple[float, float, float]:
        lift = drag = moment = 0.0
        for name, foil in own.items():
            angle = np.array([-nose_down + (deflection if name == "wing" else 0.0)])
            cl, cd = foil.coefficients(angle)[0]
            lift += q * foil.area * cl
            drag += q * foil.area * cd
            arm = foil.position[0]
            moment += arm * q * foil.area * (cl * math.cos(nose_down) - cd * math.sin(nose_down))
        return lift, drag + q * 0.05, moment

    balanced = brentq(lambda angle: forces(angle)[2], -0.2, 0.2)
    assert pitch == pytest.approx(balanced, abs=2e-3)
    lift, drag, _moment = forces(balanced)
    down = 200.0 - lift
    assert model.lines["tow"].end_tension == pytest.approx(math.hypot(down, drag), rel=2e-3)
    depth = 30.0 * down / math.hypot(down, drag)
    assert -state.position[2] == pytest.approx(depth, abs=0.05)


def catenary(span: np.ndarray, length: float, weight: float, stiffness: float) -> np.ndarray:
    """Force (horizontal, vertical) of an elastic line on its upper end, (span, rise) from its lower
    one [N]: Irvine, Cable Structures, section 2.3, the whole line off the floor."""

    def missed(force: np.ndarray) -> list[float]:
        h, v = force
        low = v - weight * length
        root = math.hypot(h, v) - math.hypot(h, low)
        x = h * length / stiffness + h / weight * (math.asinh(v / h) - math.asinh(low / h))
        z = (v**2 - low**2) / (2.0 * stiffness * weight) + root / weight
        return [x - span[0], z - span[1]]

    taut = 0.5 * weight * length / max(1.0 - math.hypot(*span) / length, 1e-3) ** 0.5
    guess = [taut * span[0] / length, taut * span[1] / length + weight * length]
    return np.asarray(fsolve(missed, guess, xtol=1e-12), dtype=np.float64)


def test_buoy_on_three_legs() -> None:
    """A buoy under water that is pushed aside: the force over its offset is that of three elastic
    catenaries."""
    chain = {
        "diameter": 0.02,
        "mass": 9.0,
        "submerged_weight": 78.0,
        "axial_stiffness": 3e7,
        "drag_normal": 1.2,
    }
    anchors = [
        [60.0 * math.cos(angle), 60.0 * math.sin(angle), -70.0]
        for angle in np.radians([0.0, 120.0, 240.0])
    ]
    buoy = {
        "mass": 500.0,
        "submerged_weight": -15e3,
        "inertia": 200.0,
        "added_mass": 300.0,
        "drag_area": 20.0,
        "drag_turning": 20.0,
        "points": {"eye": [0.0, 0.0, 0.0]},
    }
    legs = {
        f"leg{k}": {
            "from": {"anchor": place},
            "to": "buoy.eye",
            "items": [{"cable": {"type": "chain", "length": 90.0, "model": "cable"}}],
        }
        for k, place in enumerate(anchors)
    }
    model = SystemModel({"cable_types": {"chain": chain}, "bodies": {"buoy": buoy}, "lines": legs})

    def pull(place: np.ndarray) -> np.ndarray:
        """Force of all legs on the buoy at a place (3,) [N]."""
        total = np.zeros(3)
        for anchor in anchors:
            away = place - np.array(anchor)
            flat = math.hypot(away[0], away[1])
            h, v = catenary(np.array([flat, away[2]]), 90.0, 78.0, 3e7)
            total -= np.array([h * away[0] / flat, h * away[1] / flat, v])
        return total

    for push in (0.0, 3000.0):
        model.step(200.0, forces={"buoy": [push, 0.0, 0.0, 0.0, 0.0, 0.0]})
        model.step(100.0, forces={"buoy": [push, 0.0, 0.0, 0.0, 0.0, 0.0]})
        outside = np.array([push, 0.0, 15e3])
        begin = model.bodies["buoy"].position.round(9)  # differences are of that size
        rest = fsolve(lambda p, f=outside: pull(p) + f, begin)
        assert np.abs(pull(rest) + outside).max() < 0.01
        assert model.bodies["buoy"].position == pytest.approx(rest, abs=1e-3 * 90.0)
    assert rest[0] > 1.0


def test_fairlead_on_a_vessel_that_yaws() -> None:
    """A fairlead on an arm of a vessel that yaws is the circle prescribed to a bare point."""
    rate, arm = 0.02, 8.0
    line = {"items": [{"cable": {"type": "wire", "length": 60.0, "model": "cable"}}], "to": "free"}
    scene = towed(
        vessels={"tug": {"points": {"stern": [-arm, 0.0, 0.0]}}},
        lines={"tow": {"from": "tug.stern", **line}},
    )
    scene["cable_types"]["wire"].update(drag_normal=1.2, drag_tangential=0.01, submerged_weight=2.0)
    turns = SystemModel(scene)
    bare = dict(scene, vessels={"tug": {"points": {"stern": [0, 0, 0]}, "position": [-arm, 0, 0]}})
    moves = SystemModel(bare)
    for k in range(40):
        t = 0.5 * (k + 1)
        angle = rate * t
        turns.step(
            0.5, vessels={"tug": VesselInput(attitude=[0, 0, angle], attitude_rate=[0, 0, rate])}
        )
        place = [-arm * math.cos(angle), -arm * math.sin(angle), 0.0]
        speed = [arm * rate * math.sin(angle), -arm * rate * math.cos(angle), 0.0]
        moves.step(0.5, vessels={"tug": VesselInput(position=place, velocity=speed)})
    found, expected = (model.lines["tow"].sample() for model in (turns, moves))
    assert found.position == pytest.approx(expected.position, abs=1e-3 * 60.0)
    assert found.tension == pytest.approx(expected.tension, abs=1e-2 * expected.tension.max())


def test_clamp_turns_with_its_vessel() -> None:
    """A stiff rod that is clamped to a vessel turns with it, and sags as a cantilever does."""
    rod = {
        "diameter": 0.05,
        "mass": 5.0,
        "submerged_weight": 5.0,
        "axial_stiffness": 1e8,
        "bending_stiffness": 2000.0,
        "drag_normal": 1.0,
    }
    end = {"point": "ship.stern", "clamped": [1.0, 0.0, 0.0]}
    model = SystemModel(
        {
            "cable_types": {"rod": rod},
            "vessels": {"ship": {"points": {"stern": [1.0, 0.0, 0.0]}}},
            "lines": {
                "rod": {
                    "from": end,
                    "to": "free",
                    "items": [{"cable": {"type": "rod", "length": 2.0, "model": "elastica"}}],
                }
            },
            "solver": {"tolerance": 1e-4},
        }
    )
    sag = 5.0 * 2.0**4 / (8.0 * 2000.0)
    tip = model.lines["rod"].sample([2.0]).position[0]
    assert tip == pytest.approx([3.0, 0.0, -sag], abs=2e-4)
    # Its weight acts at its middle, 2 m from the ship's origin: half of the moment is the clamp's.
    assert model.wrenches["ship"] == pytest.approx([0, 0, -10.0, 0, 20.0, 0], abs=1e-2)
    for k in range(60):
        angle = 0.5 * (1.0 - math.cos(math.pi * (k + 1) / 60.0))
        model.step(0.5, vessels={"ship": VesselInput(attitude=[0.0, 0.0, angle])})
    still = VesselInput(attitude=[0.0, 0.0, 1.0], attitude_rate=[0.0, 0.0, 0.0])
    model.step(5.0, vessels={"ship": still})
    model.step(5.0)
    tip = model.lines["rod"].sample([2.0]).position[0]
    turned = model.vessels["ship"].attitude[2]
    assert turned == pytest.approx(1.0, abs=1e-9)
    assert tip == pytest.approx([3.0 * math.cos(1.0), 3.0 * math.sin(1.0), -sag], abs=1e-3)


def test_reading_changes_nothing() -> None:
    """A run whose outputs are read at every step is the same, bit for bit, as one without."""
    scene = hung_bar()
    scene["bodies"]["bar"]["points"]["c"] = [0.0, 0.2, 0.1]
    scene["lines"] = {"one": scene["lines"]["one"]}
    scene["lines"]["tail"] = {"from": "bar.c", "to": "free", "items": string(2.0)}
    read, left = SystemModel(scene), SystemModel(scene)
    for k in range(6):
        push = {"bar": [5.0 * math.cos(k), 3.0, 0.0, 0.5, 0.0, 0.2]}
        read.outputs()
        for model in (read, left):
            model.step(0.1, forces=push)
    one, other = read.outputs(), left.outputs()
    assert all(np.array_equal(one[name], other[name], equal_nan=True) for name in one)


def test_lines_side_by_side() -> None:
    """Two lines without a tie are each as by itself."""
    scene = towed(
        vessels={
            "tug": {
                "points": {"port": [0, 5, 0], "starboard": [0, -5, 0]},
                "velocity": [{"t": 0, "velocity": [1, 0, 0]}, {"t": 20, "velocity": [2, 0.5, 0]}],
            }
        },
        lines={
            "long": {"from": "tug.port", "to": "free", "items": wire(80.0)},
            "short": {"from": "tug.starboard", "to": "free", "items": wire(30.0)},
        },
    )
    scene["cable_types"]["wire"].update(drag_normal=1.2, drag_tangential=0.01, submerged_weight=2.0)
    both = SystemModel(scene)
    both.step(30.0)
    for name in ("long", "short"):
        alone = SystemModel(dict(scene, lines={name: scene["lines"][name]}))
        alone.step(30.0)
        length = both.lines[name].length
        stations = np.linspace(0.0, length, 7)
        found, expected = (m.lines[name].sample(stations) for m in (both, alone))
        assert found.position == pytest.approx(expected.position, abs=1e-3 * length)


def test_junction_passes_on_a_line() -> None:
    """A line of two halves that a junction joins is the same line in one piece."""
    scene = towed(
        vessels={"tug": {"points": {"stern": [0, 0, 0]}, "velocity": [1.5, 0, 0]}},
        lines={
            "whole": {"from": "tug.stern", "to": "free", "items": wire(60.0)},
        },
    )
    scene["cable_types"]["wire"].update(drag_normal=1.2, drag_tangential=0.01, submerged_weight=2.0)
    whole = SystemModel(scene)
    tiny = {"mass": 1e-3, "submerged_weight": 0.0, "inertia": 1e-6, "points": {"eye": [0, 0, 0]}}
    halves = SystemModel(
        dict(
            scene,
            bodies={"ring": tiny},
            lines={
                "upper": {"from": "tug.stern", "to": "ring.eye", "items": wire(30.0)},
                "lower": {"from": "ring.eye", "to": "free", "items": wire(30.0)},
            },
        )
    )
    for model in (whole, halves):
        model.step(5.0)
    stations = np.linspace(0.0, 30.0, 5)
    expected = whole.lines["whole"].sample(30.0 + stations).position
    assert halves.lines["lower"].sample(stations).position == pytest.approx(expected, abs=0.03)
    assert halves.lines["upper"].start_tension == pytest.approx(
        whole.lines["whole"].start_tension, rel=2e-3
    )


@pytest.mark.parametrize("listed", [("low", "high"), ("high", "low")])
def test_bodies_are_at_the_ends_of_their_lines_in_whatever_order_they_are_listed(
    listed: tuple[str, str],
) -> None:
    """Two bodies one below the other in a current that bends their lines, whose mesh is refined as
    the start is found: the lower line bears weight and drag of what hangs on it."""
    speed, weight, area = 1.2, 900.0, 0.5
    point = {"inertia": 5.0, "drag_area": area, "points": {"eye": [0, 0, 0]}}
    bodies = {name: {"mass": 120.0, "submerged_weight": weight, **point} for name in listed}
    wire = {"diameter": 0.012, "mass": 0.5, "axial_stiffness": 7e6, "drag_normal": 1.2}
    items = [{"cable": {"type": "wire", "length": 150.0, "model": "cable"}}]
    model = SystemModel({
        "environment": {"current": [speed, 0.3, 0.0]},
        "cable_types": {"wire": wire},
        "vessels": {"ship": {"points": {"stern": [0, 0, 0]}}},
        "bodies": bodies,
        "lines": {
            "upper": {"from": "ship.stern", "to": "high.eye", "items": items},
            "lower": {"from": "high.eye", "to": "low.eye", "items": items},
        },
        "solver": {"tolerance": 1e-4},
    })  # fmt: skip
    upper, lower = (model.lines[name].sample([0.0, 150.0]) for name in ("upper", "lower"))
    for body, place in (("high", upper.position[1]), ("low", lower.position[1])):
        assert model.bodies[body].position == pytest.approx(place, abs=1e-9)
    assert lower.position[0] == pytest.approx(upper.position[1], abs=1e-9)
    drag = 0.5 * 1025.0 * area * (speed**2 + 0.3**2)
    assert lower.tension[1] == pytest.approx(math.hypot(weight, drag), rel=1e-6)
    assert model.built.where(int(model.built.body_nodes()[0])) == (listed[0], 0.0)


def test_one_line_is_that_of_a_scene_of_one_line() -> None:
    """A system of one line is the scene of one line."""
    import cablemodel as cm

    kinds = {
        "wire": {
            "diameter": 0.01,
            "mass": 0.3,
            "axial_stiffness": 1e6,
            "drag_normal": 1.2,
            "bending_stiffness": 0.0,
        }
    }
    fish = {"body": {"mass": 50.0, "submerged_weight": 300.0, "drag_area": 0.1}}
    items = [{"cable": {"type": "wire", "length": 100.0}}, fish]
    one = cm.CableModel({"cable_types": kinds, "line": items, "vessel": {"velocity": [1.5, 0, 0]}})
    system = SystemModel(
        {
            "cable_types": kinds,
            "vessels": {"ship": {"points": {"stern": [0, 0, 0]}, "velocity": [1.5, 0, 0]}},
            "lines": {"tow": {"from": "ship.stern", "to": "free", "items": items}},
        }
    )
    for k in range(20):
        speed = 1.5 + 0.05 * (k + 1)
        one.step(1.0, vessel_velocity=[speed, 0.02 * (k + 1), 0.0])
        system.step(1.0, vessels={"ship": VesselInput(velocity=[speed, 0.02 * (k + 1), 0.0])})
    stations = np.linspace(0.0, 100.0, 9)
    found = system.lines["tow"].sample(stations)
    expected = one.sample(stations)
    assert found.position == pytest.approx(expected.position, abs=0.1)
    assert found.tension == pytest.approx(expected.tension, abs=0.01 * expected.tension.max())


def test_snapshot_and_failure() -> None:
    """A restored system goes on bit by bit; a wrong input leaves it as it was."""
    model = SystemModel(hung_bar(1e-3))
    model.step(1.0, forces={"bar": [2.0, 1.0, 0, 0, 0, 1.0]})
    kept = model.snapshot()
    model.step(2.0)
    after = model.snapshot()
    model.restore(kept)
    model.step(2.0)
    assert model.snapshot() == after
    with pytest.raises(StepError, match=r"forces is 'beam'.*one of bar"):
        model.step(1.0, forces={"beam": [0.0] * 6})
    assert model.snapshot() == after


def test_check_tells_what_is_tied_to_what(tmp_path: Path) -> None:
    """`cablemodel check` draws a system in words; a scene of one line says what it is."""
    import cablemodel as cm

    path = tmp_path / "bar.yaml"
    path.write_text(yaml.safe_dump(hung_bar(1e-3)))
    result = CliRunner().invoke(app, ["check", str(path)])
    assert result.exit_code == 0, result.output
    assert "body bar, 20 kg: held by one, two" in result.output
    assert "line two: from an anchor at (-0.6, 0, 0) m to bar.b: 5 m of string" in result.output
    with pytest.raises(SceneError, match="a system, not a scene of one line"):
        cm.load_scene(path)


def test_what_is_wrong_is_named() -> None:
    """Wrong references name the place, the value and what is allowed."""
    scene = hung_bar()
    scene["bodies"]["bar"]["foils"] = {"wing": {"area": 1.0, "chord": [0, 2, 0]}}
    with pytest.raises(SceneError, match=r"wing\.span.*along the chord.*across the chord"):
        SystemModel(scene)
    scene = hung_bar()
    scene["lines"]["one"]["to"] = "bar.c"
    with pytest.raises(SceneError, match=r"lines\.one\.to.*bar\.a, bar\.b"):
        SystemModel(scene)
    scene = hung_bar()
    scene["bodies"]["lost"] = scene["bodies"]["bar"]
    with pytest.raises(SceneError, match=r"bodies\.lost.*no line is attached"):
        SystemModel(scene)


def test_nodes_are_sampled_where_a_half_begins_at_zero_to_rounding() -> None:
    """Arc lengths of a line that goes back in the tree count from its end: -(start) - length."""
    wire = {"diameter": 0.02, "mass": 1.0, "axial_stiffness": 1e7}
    model = SystemModel({
        "cable_types": {"wire": wire}, "vessels": {"ship": {"points": {"stern": [0, 0, 0]}}},
        "lines": {"tow": {"from": "free", "to": "ship.stern",
                          "items": [{"cable": {"type": "wire", "length": 30.0}}]}},
    })  # fmt: skip
    elements = model.built.elements("tow")
    assert elements.backward.all()
    first = int(elements.node[np.argmin(elements.start)])
    edges = model.built.block.array(Header.edges, model.built.nodes, at.EDGE_WORDS)
    edges[first, at.Edge.start] = np.nextafter(-edges[first, at.Edge.length], 0.0)
    assert model.built.elements("tow").start.min() < 0.0
    assert model.lines["tow"].sample().s.min() == 0.0


def test_a_line_that_nothing_gives_a_shape_is_named_where_no_start_is_found() -> None:
    """A neutral tether without bending, slack in still water: by its name, and what would help."""
    scene = hung_bar()
    assert without_shape(load_system(scene)) == ""
    limp = {"submerged_weight": 0.0, "bending_stiffness": 0.0}
    scene["cable_types"] = {"string": {**STRING, **limp}}
    assert "cable of one and two has neither weight" in without_shape(load_system(scene))


@pytest.mark.parametrize("speed", [0.0, 1e-14, 1e-3])
def test_a_velocity_that_is_rounding_is_rest(speed: float) -> None:
    """As the first row of a table that was differentiated has it; in a scene of one line, too."""
    wire = {"diameter": 0.05, "mass": 10.5, "axial_stiffness": 8e7}
    rows = [{"t": 0, "velocity": [speed, 0, 0]}, {"t": 5, "velocity": [1, 0, 0]}]
    item = {"cable": {"type": "wire", "length": 260}}
    system = {
        "cable_types": {"wire": wire},
        "vessels": {"ship": {"points": {"bow": [0, 0, 0]}, "velocity": rows}},
        "lines": {"leg": {"from": "ship.bow", "to": {"anchor": [240, 0, 0]}, "items": [item]}},
    }
    single = {
        "cable_types": {"wire": wire}, "vessel": {"velocity": rows}, "line": [item],
        "end": {"anchor": [240, 0, 0]},
    }  # fmt: skip
    if speed == 1e-3:
        with pytest.raises(SceneError, match="no steady state while a vessel moves"):
            SystemModel(system)
        with pytest.raises(SceneError, match="no steady state while the vessel moves"):
            cm.CableModel(single)
        return
    model = SystemModel(system)
    model.step(2.0)
    assert model.vessels["ship"].position[0] == pytest.approx(0.4, abs=1e-9)
    assert cm.CableModel(single).top_tension == pytest.approx(
        SystemModel(system).lines["leg"].start_tension, rel=1e-2
    )
