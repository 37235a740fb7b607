"""Lines that are clamped to free bodies, against closed forms, invariances and laws of motion."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

import cablemodel as cm
from cablemodel.cli.plausibility import system_warnings
from cablemodel.solvers import library
from cablemodel.solvers.shared import layout as at

G = 9.81
EI, LENGTH, MASS, INERTIA = 1e4, 2.0, 2.0, 4.0
BEAM = {"diameter": 0.02, "mass": 1e-3, "axial_stiffness": 1e7, "bending_stiffness": EI}
HULL = {"ship": {"points": {"stern": [0, 0, 0]}}}


def clamped(point: str, *way: float) -> dict[str, Any]:
    return {"point": point, "clamped": list(way)}


def of(kind: str, length: float, **more: Any) -> list[dict[str, Any]]:
    return [{"cable": {"type": kind, "length": length, **more}}]


def body(mass: float, inertia: Any, *, place: list[float], **points: list[float]) -> dict[str, Any]:
    weight = mass * G
    return {"mass": mass, "submerged_weight": weight, "inertia": inertia, "points": points,
            "position": place}  # fmt: skip


def cantilever(model: str, backward: bool) -> dict[str, Any]:
    """A light beam that a ship holds, with a load at its end."""
    ends = clamped("ship.stern", -1, 0, 0), clamped("load.eye", -1, 0, 0)
    if backward:
        ends = clamped("load.eye", 1, 0, 0), clamped("ship.stern", 1, 0, 0)
    return {
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": {"beam": BEAM},
        "vessels": HULL,
        "bodies": {"load": body(MASS, INERTIA, place=[-LENGTH, 0, 0], eye=[0, 0, 0])},
        "lines": {
            "beam": {"from": ends[0], "to": ends[1], "items": of("beam", LENGTH, model=model)}
        },
        "solver": {"tolerance": 1e-5},
    }  # fmt: skip


@pytest.mark.parametrize("model", ["elastica", "hybrid"])
@pytest.mark.parametrize("backward", [False, True])
def test_a_cantilever_bends_and_swings_as_a_beam(model: str, backward: bool) -> None:
    """Euler and Bernoulli: w = P L^3 / 3 EI + N L^2 / 2 EI, turn = P L^2 / 2 EI + N L / EI; of a
    light beam with a mass and a rotary inertia at its end K = EI [12/L^3, -6/L^2; -6/L^2, 4/L]."""
    system = cm.SystemModel(cantilever(model, backward))
    weight, torque = MASS * G, 30.0
    # A hybrid's clamp is a spring of 1e3 EI over its element: 0.02 % of the whole.
    near = 2e-3 if model == "hybrid" else 5e-4
    load = system.bodies["load"]
    assert -load.position[2] == pytest.approx(weight * LENGTH**3 / 3 / EI, rel=near)
    assert -load.attitude[1] == pytest.approx(weight * LENGTH**2 / 2 / EI, rel=near)
    stiff = EI * np.array([[12 / LENGTH**3, -6 / LENGTH**2], [-6 / LENGTH**2, 4 / LENGTH]])
    squares, modes = eigh(stiff, np.diag([MASS, INERTIA]))
    expected = np.sqrt(squares)
    found = system.natural_frequencies(5)  # the first one turns it about the beam, in both planes
    assert found[0] < 1e-3
    assert found[1:] == pytest.approx(np.repeat(expected, 2), rel=near)
    # A torque that grows evenly.
    span = 0.3
    system.step(span, forces={"load": [0.0, 0.0, 0.0, 0.0, torque, 0.0]})
    grown = modes.T @ [0.0, torque] / squares * (1 - np.sin(expected * span) / (expected * span))
    sag, turn = modes @ grown - np.linalg.solve(stiff, [weight, 0.0])
    load = system.bodies["load"]
    assert load.attitude[1] == pytest.approx(turn, rel=2 * near)
    assert load.position[2] == pytest.approx(sag, abs=1e-5 * LENGTH)  # what tau promises


@pytest.mark.parametrize("away", [0.1, 0.4])
@pytest.mark.parametrize("model", ["elastica", "hybrid"])
def test_an_umbilical_turns_a_load_with_the_moment_of_its_layer(model: str, away: float) -> None:
    """Of a long elastica under a tension T, at an angle a: 2 sqrt(EI T) sin(a / 2)."""
    stiffness, weight = 500.0, 2000.0
    data = cantilever(model, backward=False)
    data["cable_types"]["beam"] = {**BEAM, "bending_stiffness": stiffness}
    load = body(weight / G, 50.0, place=[0, 0, -20], eye=[0, 0, 0])
    data["bodies"] = {"load": {**load, "centre_of_gravity": [away, 0, 0]}}
    data["lines"]["beam"] = {
        "from": "ship.stern", "to": clamped("load.eye", 0, 0, -1),
        "items": of("beam", 20.0, model=model),
    }  # fmt: skip
    data["solver"] = {"tolerance": 1e-3}
    layer = 2.0 * math.sqrt(stiffness * weight)
    turn = brentq(lambda a: weight * away * math.cos(a) - layer * math.sin(a / 2), 0, 2)
    system = cm.SystemModel(data)
    assert system.bodies["load"].attitude[1] == pytest.approx(turn, rel=2e-3)


def two_parallel_beams(count: int) -> dict[str, Any]:
    """A beam that hangs with a body, and below that the same beam, or `count` of its parts beside
    each other, with a second body: of two, one closes a cycle."""
    data = cantilever("elastica", backward=False)
    data["cable_types"]["part"] = {**BEAM, "bending_stiffness": EI / count}
    first = {"from": clamped("ship.stern", 0, 0, -1), "to": clamped("load.eye", 0, 0, -1)}
    data["lines"]["beam"] = {**first, "items": of("beam", LENGTH)}
    for name, depth in (("load", LENGTH), ("second", 2 * LENGTH)):
        data["bodies"][name] = body(MASS, INERTIA, place=[0, 0, -depth], eye=[0, 0, 0])
    for k in range(count):
        ends = clamped("load.eye", 0, 0, -1), clamped("second.eye", 0, 0, -1)
        if k:
            ends = clamped("second.eye", 0, 0, 1), clamped("load.eye", 0, 0, 1)
        part = {"from": ends[0], "to": ends[1], "items": of("part", LENGTH)}
        data["lines"][f"part{k}"] = part
    return data


def test_two_beams_that_close_a_cycle_are_one_of_twice_the_stiffness() -> None:
    one, two = (cm.SystemModel(two_parallel_beams(count)) for count in (1, 2))
    assert two.bodies["second"].position == pytest.approx(one.bodies["second"].position, rel=1e-4)
    for system in (one, two):
        system.step(0.3, forces={"second": [0.0, 5.0, 0.0, 0.0, 10.0, 0.0]})
        system.step(0.7)
    assert abs(one.bodies["second"].position[1]) > 1e-4
    for name in ("load", "second"):
        for key in ("position", "attitude"):
            found, expected = (getattr(each.bodies[name], key) for each in (two, one))
            assert found == pytest.approx(expected, abs=2e-5)


def test_beams_in_a_row_stand_out_from_what_clamps_them() -> None:
    """Far from the strings that a start is sought from: w = sum of P a^2 (3 x - a) / 6 EI."""
    data = cantilever("elastica", backward=False)
    data["bodies"]["second"] = body(MASS, INERTIA, place=[0, 0, 0], eye=[0, 0, 0])
    ends = {"from": clamped("load.eye", -1, 0, 0), "to": clamped("second.eye", -1, 0, 0)}
    data["lines"]["more"] = {**ends, "items": of("beam", LENGTH)}
    load = MASS * G * LENGTH**3 / (6 * EI)
    sag = -cm.SystemModel(data).bodies["second"].position[2]
    assert sag == pytest.approx(load * (1 * (6 - 1) + 4 * (6 - 2)), rel=1e-3)


def in_two(model: str, divided: bool) -> dict[str, Any]:
    """A line in a current, or the same in two pieces that a hardly visible body joins."""
    line = {"diameter": 0.05, "mass": 3.0, "axial_stiffness": 1e7, "bending_stiffness": 2e3}
    ends = clamped("ship.stern", -1, 0, -0.3), {"anchor": [-7, 1, -5]}
    data: dict[str, Any] = {
        "environment": {"current": {"table": [{"z": 0, "velocity": [0.3, 0.5, 0]}]}},
        "cable_types": {"line": line},
        "vessels": HULL,
        "lines": {"a": {"from": ends[0], "to": ends[1], "items": of("line", 10, model=model)}},
        "solver": {"tolerance": 1e-3},
    }
    if divided:
        way = (1.0, 0.2, 0.0)
        dot = {"mass": 1e-3, "submerged_weight": 1e-3, "inertia": 1e-5,
               "points": {"a": [0, 0, 0]}, "attitude": [0.2, 0.6, 0.1]}  # fmt: skip
        data["bodies"] = {"dot": dot}
        data["lines"] = {
            "a": {"from": ends[0], "to": clamped("dot.a", *way), "items": of("line", 4)},
            "b": {"from": clamped("dot.a", *way), "to": ends[1], "items": of("line", 6)},
        }
        for part in data["lines"].values():
            part["items"][0]["cable"]["model"] = model
    return data


@pytest.mark.parametrize("model", ["elastica", "hybrid"])
def test_a_body_of_no_mass_between_two_clamps_is_not_seen(model: str) -> None:
    one, two = (cm.SystemModel(in_two(model, divided)) for divided in (False, True))
    for n in range(20):
        t = 0.1 * (n + 1)
        moves = {"velocity": [0.5 * math.sin(2 * t), 0.4 * math.sin(t), 0.3 * math.sin(3 * t)]}
        drive = cm.VesselInput(**moves, attitude_rate=[0.0, 0.2 * math.sin(2 * t), 0.1])
        for system in (one, two):
            system.step(0.1, vessels={"ship": drive})
    whole = one.lines["a"].sample([1.0, 4.0, 7.0])
    first, second = two.lines["a"].sample([1.0, 4.0]), two.lines["b"].sample([0.0, 3.0])
    assert np.vstack([first.position, second.position[1:]]) == pytest.approx(
        whole.position, abs=2e-3
    )
    bends = np.concatenate([first.curvature[:1], second.curvature])
    assert bends == pytest.approx(whole.curvature, rel=0.01)
    assert whole.curvature.min() > 0.05
    pulls = np.concatenate([first.tension, second.tension[1:]])
    assert pulls == pytest.approx(whole.tension, rel=0.01)


def weightless() -> dict[str, Any]:
    """Two bodies that a beam joins, on a string that is cut; what little weight there is lets it
    hang at first."""
    kinds = {
        "beam": {"diameter": 0.03, "mass": 1.0, "submerged_weight": 1e-3, "axial_stiffness": 1e7,
                 "bending_stiffness": 2e3},
        "string": {"diameter": 2e-3, "mass": 2e-3, "submerged_weight": 1e-6,
                   "axial_stiffness": 1e5},
    }  # fmt: skip
    one = body(20.0, [2.0, 3.0, 4.0], place=[0, 0, -1.2], top=[0, 0, 0.2], eye=[0, 0, -0.3])
    two = body(12.0, [1.0, 1.5, 2.0], place=[0, 0, -4.7], eye=[0, 0, 0.2])
    for each in (one, two):
        each["submerged_weight"] = 1e-3 * each["mass"]
    beam = {"from": clamped("one.eye", 0, 0, -1), "to": clamped("two.eye", 0, 0, -1)}
    return {
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": kinds,
        "vessels": HULL,
        "bodies": {"one": one, "two": two},
        "lines": {
            "string": {
                "from": "ship.stern", "to": "one.top", "items": of("string", 1.0, model="cable")
            },
            "beam": {**beam, "items": of("beam", 3.0, model="elastica")},
        },
        "cuts": {"release": {"line": "string", "at": "end"}},
        "solver": {"tolerance": 1e-4},
    }  # fmt: skip


def invariants(system: cm.SystemModel) -> tuple[np.ndarray, np.ndarray, float]:
    """Momentum, angular momentum about the centre of mass, and energy beside that of the fall."""
    scene, block = system.scene, system.built.block
    masses, places, speeds, spins = [], [], [], np.zeros(3)
    energy = 0.0
    for name, part in scene.bodies.items():
        state = system.bodies[name]
        own = state.axes @ (np.array(part.inertia) * (state.axes.T @ state.angular_velocity))
        spins += own
        energy += 0.5 * (part.mass * state.velocity @ state.velocity + state.angular_velocity @ own)
        masses.append(part.mass)
        places.append(state.position)
        speeds.append(state.velocity)
    points, weights = np.polynomial.legendre.leggauss(4)
    elements = system.built.elements("beam")
    for start, length in zip(elements.start, elements.length, strict=True):
        state = system.lines["beam"].sample(start + 0.5 * length * (1.0 + points))
        masses += (0.5 * length * weights * 1.0).tolist()
        places += list(state.position)
        speeds += list(state.velocity)
    mass, place, speed = np.array(masses)[:, None], np.array(places), np.array(speeds)
    momentum = (mass * speed).sum(axis=0)
    centre = (mass * place).sum(axis=0) / mass.sum()
    angular = spins + (mass * np.cross(place - centre, speed)).sum(axis=0)
    words = np.zeros(at.ENERGY_WORDS)
    library.energy(block.ints, block.reals, words)
    of_cable = at.Energies(words, 0)
    energy += of_cable.kinetic + of_cable.axial + of_cable.bending
    return momentum, angular, energy - momentum @ momentum / (2.0 * mass.sum())


def test_two_bodies_on_a_beam_keep_momentum_angular_momentum_and_energy() -> None:
    """They tumble and vibrate: the beam's moments turn the bodies as its forces do."""
    system = cm.SystemModel(weightless())
    system.step(0.01, cuts=["release"])
    for _ in range(5):
        system.step(
            0.1, forces={"one": [5, 20, 0, 10, 10, 3], "two": [20, -10, 0, 2, 20, -2]}
        )  # fmt: skip
    system.step(0.05)
    momentum, angular, energy = invariants(system)
    begun, turned = system.time, []
    for _ in range(4):
        system.step(0.5)
        turned.append(system.bodies["one"].attitude - system.bodies["two"].attitude)
        now = invariants(system)
        weight = np.array([0.0, 0.0, 1e-3 * 35.0 * (system.time - begun)])
        assert now[0] + weight == pytest.approx(momentum, abs=1e-6 * np.linalg.norm(momentum))
        assert now[1] == pytest.approx(angular, abs=1e-6 * np.linalg.norm(angular))
        assert now[2] == pytest.approx(energy, rel=1e-4)
    assert np.ptp(turned, axis=0).max() > 0.05


def cage(turn: float = 0.0, mirror: float = 1.0, kind: str = "hybrid") -> dict[str, Any]:
    """A cage on a wire and two umbilicals, and a vehicle on a tether and a wire: a cycle."""
    c, s = math.cos(turn), math.sin(turn)
    frame = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.diag([1.0, mirror, 1.0])

    def at_(*place: float) -> list[float]:
        return list(frame @ place)

    def tied(point: str, *way: float) -> dict[str, Any]:
        return clamped(point, *(frame @ way))

    of_water = {"added_mass": 100.0, "drag_turning": 1.0, "drag_area": 1.0}
    tether, wire = (of(name, length) for name, length in (("tether", 10.0), ("wire", 14.0)))
    return {
        "environment": {"current": {"table": [{"z": 0, "velocity": at_(0.3, 0.6, 0)}]}},
        "cable_types": {
            "tether": {"diameter": 0.03, "mass": 1.2, "axial_stiffness": 1e6,
                       "bending_stiffness": 300.0},
            "wire": {"diameter": 0.01, "mass": 0.4, "axial_stiffness": 1e6},
        },
        "vessels": {"ship": {"points": {"a": at_(0, 0, 0), "b": at_(3, 1, 0), "c": at_(-2, 2, 0)}}},
        "bodies": {
            "cage": {"mass": 500, "submerged_weight": 3000, "inertia": 100.0, **of_water,
                     "points": {"top": at_(0.2, 0.1, 0.5), "one": at_(0.6, 0, 0.3),
                                "two": at_(-0.6, 0, 0.3), "out": at_(0, 0.5, -0.5)},
                     "position": at_(0, 0, -20)},
            "rov": {"mass": 100, "submerged_weight": 100, "inertia": 20.0, **of_water,
                    "points": {"nose": at_(0, -0.4, 0)}, "position": at_(0.5, 8, -22)},
        },
        "lines": {
            "wire": {"from": "ship.a", "to": "cage.top", "items": of("wire", 19.5)},
            "one": {"from": "ship.b", "to": tied("cage.one", 0, 0, -1), "items": of("tether", 21)},
            "two": {"from": tied("cage.two", -0.3, 0.1, 1), "to": "ship.c",
                    "items": of("tether", 22)},
            "out": {"from": tied("cage.out", 0, 1, -0.2), "to": tied("rov.nose", 0, 1, 0),
                    "items": tether},
            "beside": {"from": "cage.top", "to": "rov.nose", "items": wire},
        },
        "cuts": {"let_go": {"line": "out", "at": "start"}, "knife": {"line": "out", "at": 1e-9}},
        "solver": {"tolerance": 1e-3},
    }  # fmt: skip


def test_a_scene_that_is_turned_or_mirrored_has_the_same_tensions() -> None:
    found = []
    for turn, mirror in ((0.0, 1.0), (0.7, 1.0), (0.0, -1.0)):
        system = cm.SystemModel(cage(turn, mirror))
        c, s = math.cos(turn), math.sin(turn)
        frame = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.diag([1.0, mirror, 1.0])
        push = [*(frame @ [50.0, 0.0, 10.0]), *(mirror * frame @ [1.0, 2.0, 0.0])]
        for _ in range(20):
            system.step(0.1, forces={"rov": push})
        found.append([pull for line in system.lines.values()
                      for pull in (line.start_tension, line.end_tension)])  # fmt: skip
    assert found[1] == pytest.approx(found[0], rel=1e-6)
    assert found[2] == pytest.approx(found[0], rel=1e-6)


def test_what_is_restored_goes_on_bit_by_bit() -> None:
    """Also in a model whose own matrix is another one; and an end that a body clamps is let go."""
    system, other = cm.SystemModel(cage()), cm.SystemModel(cage())
    for n in range(10):
        system.step(0.1, forces={"rov": [50.0, 0.0, 10.0 * n, 1.0, 2.0, 0.0]})
    kept = system.snapshot()
    other.restore(kept)
    for _ in range(5):
        system.step(0.1)
        other.step(0.1)
        assert system.snapshot() == other.snapshot()
    ways = []
    for cut in ("let_go", "knife"):
        system.restore(kept)
        before = abs(system.lines["out"].start_tension)
        system.step(0.1, cuts=[cut])
        pulls = []
        for _ in range(10):
            system.step(0.1)
            pulls.append(abs(system.lines["out"].start_tension))
        # A free end has what Newton's method leaves over, which rounding decides: 1e-13 to 1e-5 N
        # at any one instant, seldom more as the end whips. What still held it would pull always.
        assert before > 100.0
        assert np.quantile(pulls, 0.25) < 1e-6
        assert np.median(pulls) < 1e-5
        way = system.bodies["cage"].axes @ np.array([0.0, 1.0, -0.2]) / math.hypot(1.0, 0.2)
        assert system.lines["out"].sample([0.0]).tangent[0] @ way < 0.99
        ways.append(system.bodies["rov"].position)
    assert ways[0] == pytest.approx(ways[1], abs=1e-9)


def test_a_flexible_cable_is_hinged() -> None:
    data, hinged = cage(), cage()
    for scene in (data, hinged):
        scene["cable_types"]["tether"]["bending_stiffness"] = 0.0
    for line in hinged["lines"].values():
        for end in ("from", "to"):
            if isinstance(line[end], dict):
                line[end] = line[end]["point"]
    found = [cm.SystemModel(scene).bodies["cage"].attitude.tolist() for scene in (data, hinged)]
    assert found[0] == found[1]
    told = [word for word in system_warnings(cm.load_system(data)) if "no bending" in word]
    assert [word.partition(" ")[0] for word in told] == [
        "lines.one.to", "lines.two.from", "lines.out.from", "lines.out.to"
    ]  # fmt: skip
    assert not any("no bending" in word for word in system_warnings(cm.load_system(cage())))


def test_a_vessel_does_not_let_go_of_a_clamped_end() -> None:
    data = cage()
    data["lines"]["one"]["from"] = clamped("ship.b", 0, 0, -1)
    data["cuts"]["other"] = {"line": "one", "at": "start"}
    with pytest.raises(cm.SceneError, match=r"cuts\.other\.at.*does not let go"):
        cm.SystemModel(data)
