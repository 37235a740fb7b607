"""Linear models of systems against closed forms, static differences, small steps, and one line."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.linear.equations import SIZE, Equations
from cablemodel.linear.model import LinearModel
from cablemodel.solvers.shared import layout as at
from cablemodel.systems import SystemModel
from cablemodel.systems.inputs import VesselInput
from cablemodel.systems.linear import SystemEquations
from cablemodel.systems.model import load_system
from tests.verification.scenes import IDEAL, scene
from tests.verification.test_system_small_motions import body_on_a_string, squares
from tests.verification.test_systems import G, hung_bar, in_vacuum, string

DEPRESSOR = "scenes/systems/depressor.yaml"
BRIDLE = "scenes/systems/bridle_tow.yaml"
WIRE = {
    "diameter": 0.012, "mass": 0.55, "axial_stiffness": 8e6, "drag_normal": 1.2, "added_mass": 1.0,
}  # fmt: skip
FISH = {
    "mass": 150.0, "submerged_weight": 1200.0, "inertia": [5.0, 6.0, 7.0], "added_mass": 30.0,
    "drag_area": [0.2, 0.3, 0.3], "drag_turning": 0.01,
    "points": {"a": [0.5, 0, 0.3], "b": [-0.5, 0.2, 0.3], "c": [0, -0.3, 0.3]},
}  # fmt: skip
LEAD = {"mass": 200.0, "submerged_weight": 1200.0, "drag_area": 0.3, "drag_coefficient": 1.0}
SHIP = {"points": {"p": [-5, 2, 1], "q": [-5, -2, 1]}, "velocity": [1.5, 0, 0]}


def in_water(**parts: Any) -> dict[str, Any]:
    """A scene of wires in water."""
    return {
        "environment": {"water_density": 1025.0},
        "cable_types": {"wire": WIRE, "rod": {**WIRE, "bending_stiffness": 30.0}},
        **parts,
    }


def wire(length: float, kind: str = "wire", **more: Any) -> dict[str, Any]:
    return {"cable": {"type": kind, "length": length, **more}}


def winch_at(side: str) -> dict[str, Any]:
    """A fish on a winch, which is at the beginning or at the end of the line."""
    ends = [("from", "ship.p"), ("to", "fish.a")]
    if side == "end":
        ends = [("from", "fish.a"), ("to", "ship.p")]
    rows = [{"t": 0, "rate": 0}, {"t": 2, "rate": 0.4}]
    return in_water(
        vessels={"ship": SHIP},
        bodies={"fish": FISH},
        lines={"w": {**dict(ends), "items": [wire(80.0)]}},
        winches={"winch": {"line": "w", "at": side, "drum": 50, "rate": rows}},
    )


def clamped() -> dict[str, Any]:
    """A rod that a ship holds in a clamp, lead at its end."""
    start = {"point": "ship.p", "clamped": [-0.7, 0, -0.7]}
    line = {"from": start, "to": "free", "items": [wire(20.0, "rod"), {"body": LEAD}]}
    return in_water(vessels={"ship": SHIP}, lines={"w": line})


def cycle() -> dict[str, Any]:
    """Two bodies with two lines between them."""
    return in_water(
        vessels={"ship": SHIP},
        bodies={"fish": FISH, "cage": FISH},
        lines={
            "w": {"from": "ship.p", "to": "fish.a", "items": [wire(80.0)]},
            "u": {"from": "fish.b", "to": "cage.a", "items": [wire(20.0)]},
            "v": {"from": "cage.b", "to": "fish.c", "items": [wire(20.0)]},
        },
    )


def branched() -> dict[str, Any]:
    """A line with a weight in it and a branch to an anchor, a fish at its end."""
    items = [wire(40.0), {"body": LEAD}, wire(20.0)]
    return in_water(
        environment={"water_density": 1025.0, "current": [0.3, 0.1, 0.0]},
        vessels={"ship": {**SHIP, "velocity": [0, 0, 0]}},
        bodies={"fish": FISH},
        lines={
            "w": {"from": "ship.p", "to": "fish.a", "items": items},
            "u": {
                "from": {"line": "w", "at": 30},
                "to": {"anchor": [40, 10, -30]},
                "items": [wire(56.0)],
            },
        },
    )


def values_of(model: SystemModel, names: tuple[str, ...] | list[str]) -> np.ndarray:
    """Outputs as the model itself says them."""
    found = model.outputs()

    def value(name: str) -> float:
        owner, _, axis = name.rpartition(".")
        return float(found[owner]["xyz".index(axis)] if axis in "xyz" else found[name])

    return np.array([value(name) for name in names])


def arguments(names: tuple[str, ...], values: np.ndarray) -> dict[str, Any]:
    """What a step is given for these inputs of a discrete model; it takes no current."""
    vessels: dict[str, dict[str, np.ndarray]] = {}
    found: dict[str, Any] = {"forces": {}, "deflections": {}, "rates": {}}
    for name, value in zip(names, values, strict=True):
        owner, _, kind = name.rpartition(".")
        if kind == "deflection":
            found["deflections"][owner] = value
        elif kind == "payout_rate":
            found["rates"][owner] = value
        elif owner != "current":
            part, quantity = owner.split(".")
            if quantity in ("force", "torque"):
                place = "xyz".index(kind) + (3 if quantity == "torque" else 0)
                found["forces"].setdefault(part, np.zeros(6))[place] = value
            else:
                moves = vessels.setdefault(part, {})
                moves.setdefault(quantity, np.zeros(3))["xyz".index(kind)] = value
    found["vessels"] = {name: VesselInput(**moves) for name, moves in vessels.items()}
    return found


def stepped(model: SystemModel, dt: float, count: int, given: dict[str, Any]) -> SystemModel:
    other = copy.deepcopy(model)
    for _ in range(count):
        other.step(dt, **given)
    return other


def turning() -> SystemModel:
    """A tug that turns, heels and trims; a plate that turns and a pontoon behind it."""
    model = SystemModel(BRIDLE)
    model.step_to(55.0)
    model.step(
        1.0,
        vessels={"tug": VesselInput(velocity=[2, 0.3, 0.2], attitude_rate=[0.1, 0.05, 0.1])},
        forces={"plate": [0, 50, 20, 5, 10, 30]},
    )
    return model


def after(parts: dict[str, Any]) -> SystemModel:
    model = SystemModel(parts)
    model.step(3.0)
    return model


@pytest.mark.parametrize(
    "make",
    [
        turning,
        lambda: after(winch_at("start")),
        lambda: after(winch_at("end")),
        lambda: after(clamped()),
        lambda: after(branched()),
    ],
    ids=["turning", "winch at the start", "winch at the end", "clamped", "branched"],
)
def test_matrices_are_the_derivatives_of_the_residual(make: Any) -> None:
    """Over the free motions, and by all that moves vessels: the kernels' own residual, in which
    bodies take their lines with them."""
    equations = SystemEquations(make())
    z = equations.basis
    drives = equations._all_drives()
    by_place, by_rate, by_level, by_input = equations._by_all(drives, equations.turning())

    def by(change: Any, step: float) -> np.ndarray:
        kept, found = equations.block.image.copy(), []
        for sign in (1.0, -1.0):
            change(sign * step)
            found.append(Equations.residual(equations))
            equations.block.image[:] = kept
        return np.asarray(z.T @ (found[0] - found[1]) / (2.0 * step))

    for words, matrix, step in (
        (equations.q, by_place, 1e-6),
        (equations.v, by_rate, 1e-5),
        (equations.a, equations.mass @ z, 1e-3),
    ):

        def move(size: float, way: np.ndarray, words: np.ndarray = words) -> None:
            words[:] += size * way

        found = np.column_stack([by(lambda s, w=w: move(s, w), step) for w in z.T])
        wanted = z.T @ matrix
        largest = np.abs(wanted).max(axis=1)[:, None]
        # Drag by turning is not smooth where a body is at rest.
        assert np.all(np.abs(found - wanted) <= 1e-6 * np.abs(wanted) + 1e-6 * largest + 1e-3)
    held = {int(row.node) for row in equations.held}
    for n, name in enumerate(equations.scene.vessels):
        frame = equations.frames[n]
        goes_on = [node for node in equations.shifts[n] if int(node) not in held]
        for piece, kinds in (
            (frame.piece, ("position", "velocity", "acceleration")),
            (frame.turn_piece, ("attitude", "attitude_rate", "attitude_acceleration")),
        ):
            law = at.Polynomial(piece.data, 0)
            for kind, field, words, step in zip(
                kinds,
                ("position", "velocity", "second"),
                (equations.q, equations.v, equations.a),
                (1e-6, 1e-5, 1e-5),
                strict=True,
            ):
                for axis in range(3):

                    def place(size: float) -> None:
                        share = 0.5 if field == "second" else 1.0  # noqa: B023
                        getattr(law, field)[axis] += share * size  # noqa: B023
                        equations._motion_when_placed()
                        if "attitude" not in kind:  # noqa: B023
                            for node in goes_on:  # noqa: B023
                                words[SIZE * node + axis] += size  # noqa: B023

                    label = f"{name}.{kind}.{'xyz'[axis]}"
                    if label in drives.levels:
                        column = by_level[:, drives.levels.index(label)]
                    else:
                        column = by_input[:, drives.inputs.index(label)]
                    found, wanted = by(place, step), z.T @ column
                    assert np.abs(found - wanted).max() <= 1e-6 * np.abs(wanted).max() + 0.05


@pytest.mark.parametrize("parts", [hung_bar(), cycle(), branched()], ids=["bar", "cycle", "tee"])
def test_poles_are_the_natural_frequencies(parts: dict[str, Any]) -> None:
    """Without water; cycles and branches too."""
    parts = {**parts, "environment": {"water_density": 0.0, "gravity": G}}
    for vessel in parts.get("vessels", {}).values():
        parts["vessels"] = {"ship": {**vessel, "velocity": [0, 0, 0]}}
    model = SystemModel(parts)
    linear = model.linearise()
    own = len(linear.states) - len(linear.operating)
    poles = np.linalg.eigvals(linear.A[:own, :own])
    for frequency in model.natural_frequencies(8):
        if frequency > 1e-2:
            assert np.abs(np.abs(poles.imag) - frequency).min() < 1e-4 * frequency


def test_bar_and_pendulums_have_the_poles_of_their_equations() -> None:
    """The bifilar pendulum, 2 pi sqrt(I h / (m g a b)), and a body that hangs on one string."""

    def frequencies(parts: dict[str, Any]) -> np.ndarray:
        linear = SystemModel(parts).linearise()
        own = len(linear.states) - len(linear.operating)
        return np.abs(np.linalg.eigvals(linear.A[:own, :own]).imag)

    bifilar = math.sqrt(20.0 * G * 0.6 * 0.6 / (3.0 * 5.0))
    assert np.abs(frequencies(hung_bar()) - bifilar).min() < 1e-3 * bifilar
    found = frequencies(body_on_a_string(-0.4))
    for square in squares(-0.4):
        assert np.abs(found - math.sqrt(-square)).min() < 2e-3 * math.sqrt(-square)


def response(linear: LinearModel, s: complex) -> np.ndarray:
    """Transfer functions, (outputs, inputs)."""
    return np.asarray(
        linear.C @ np.linalg.solve(s * np.eye(len(linear.A)) - linear.A, linear.B) + linear.D
    )


def test_a_vessel_that_rolls_swings_what_hangs_below_it() -> None:
    """A weight on a string at a point h above a vessel's origin: pitch moves the point by h, and
    the force there acts about the origin by h."""
    height, length = 2.0, 5.0
    ball = {
        "mass": 20.0,
        "submerged_weight": 20.0 * G,
        "inertia": 1e-3,
        "points": {"eye": [0, 0, 0]},
    }
    linear = SystemModel(
        in_vacuum(
            vessels={"ship": {"points": {"top": [0, 0, height]}}},
            bodies={"ball": ball},
            lines={"one": {"from": "ship.top", "to": "ball.eye", "items": string(length)}},
            solver={"tolerance": 1e-6},
        )
    ).linearise()
    square = G / length
    s = 0.6j * math.sqrt(square)
    place = height * square / (s**2 + square) / s**2
    wanted = {
        "ball.position.x": place,
        "ship.force.x": -20.0 * s**2 * place,
        # The weight acts beside the origin as the point moves there.
        "ship.moment.y": -20.0 * s**2 * place * height + 20.0 * G * height / s**2,
        "ship.attitude.y": 1.0 / s**2,
    }
    few = linear.only(["ship.attitude_acceleration.y"], list(wanted))
    found = response(few, s)[:, 0]
    assert found == pytest.approx(list(wanted.values()), rel=2e-3)


STEPS = {
    "velocity": 2e-3, "attitude_rate": 1e-4, "force": 2.0, "torque": 0.1, "deflection": 2e-4,
    "payout_rate": 2e-3,
}  # fmt: skip


@pytest.mark.parametrize(
    ("parts", "tolerance", "inputs"),
    [
        (
            DEPRESSOR,
            1e-5,
            (
                "ship.velocity.x", "ship.velocity.y", "ship.attitude_rate.y", "depressor.force.x",
                "depressor.torque.y", "depressor.tail.deflection",
            ),
        ),
        (winch_at("end"), 1e-7, ("winch.payout_rate", "fish.force.y")),
        (cycle(), 1e-5, ("ship.velocity.z", "cage.force.x")),
    ],
    ids=["depressor", "winch", "cycle"],
)  # fmt: skip
def test_step_responses_are_those_of_small_steps(
    parts: Any, tolerance: float, inputs: tuple[str, ...]
) -> None:
    """Six steps of half a second, of runs that follow axial waves where they turn bodies."""
    model = SystemModel(load_system(parts, [f"solver.tolerance={tolerance}"]))
    linear = model.linearise()
    dt, count = 0.5, 6
    discrete = linear.discrete(dt)
    free, pulse = discrete.responses(count)
    assert linear.offset == pytest.approx(values_of(model, linear.outputs), rel=1e-6, abs=1e-4)
    kinds = {"position": 5e-3, "attitude": 5e-3, "start_tension": 0.02, "end_tension": 0.02}
    for name in inputs:
        column = discrete.inputs.index(name)
        size = next(STEPS[part] for part in reversed(name.split(".")) if part in STEPS)
        ends = []
        for sign in (1.0, -1.0):
            given = discrete.operating.copy()
            given[column] += sign * size
            other = stepped(model, dt, count, arguments(discrete.inputs, given))
            ends.append(values_of(other, linear.outputs))
        wanted = (ends[0] - ends[1]) / (2.0 * size)
        got = pulse[:, :, column].sum(axis=0)
        for kind, share in kinds.items():
            rows = [k for k, output in enumerate(linear.outputs) if f".{kind}" in output]
            largest = np.abs(wanted[rows]).max()
            # What the run itself tells apart.
            largest = max(largest, (1e-3 if "tension" in kind else 1e-8) / size)
            assert got[rows] == pytest.approx(wanted[rows], abs=share * largest), (name, kind)
    still = stepped(model, dt, count, arguments(discrete.inputs, discrete.operating))
    assert free[-1] == pytest.approx(values_of(still, linear.outputs), rel=1e-4, abs=1e-2)


def spinning_cycle() -> SystemModel:
    """Bodies in a cycle of lines that turn."""
    model = SystemModel(load_system(cycle(), ["solver.tolerance=1e-6"]))
    for _ in range(4):
        model.step(0.25, forces={"cage": [0, 0, 0, 40, 20, 60], "fish": [0, 0, 0, 30, 0, -60]})
    return model


def test_a_motion_goes_on_as_its_linear_model_says() -> None:
    """About a tow that turns: errors grow with the square of the time."""
    model = turning()
    linear = model.linearise()
    rows = [k for k, name in enumerate(linear.outputs) if name.startswith("plate.position")]
    errors = []
    for dt in (0.05, 0.1):
        discrete = linear.discrete(dt)
        given = arguments(discrete.inputs, discrete.operating)
        wanted = values_of(stepped(model, dt, 1, given), linear.outputs)[rows]
        errors.append(np.linalg.norm(discrete.responses(1)[0][0, rows] - wanted))
    moved = np.linalg.norm(wanted - values_of(model, linear.outputs)[rows])
    assert errors[1] < 5e-3 * moved
    assert errors[0] < 0.5 * errors[1]


def test_ends_that_close_a_cycle_go_with_bodies_that_turn() -> None:
    """Places, velocities and accelerations of both sides are the same for every free motion."""
    equations = SystemEquations(spinning_cycle())
    turning = equations.turning()
    assert turning is not None
    (closure,) = equations.closures
    body = equations.bodies[int(closure.body)]
    words = slice(SIZE * int(closure.node), SIZE * int(closure.node) + 3)

    def apart() -> np.ndarray:
        Equations.residual(equations)
        motion, place = body.motion, np.array(closure.place)
        turn, spin = np.array(motion.turn).reshape(3, 3), np.array(motion.spin)
        moved = np.cross(spin, place)
        pushed = np.cross(motion.spin_rate, place) + np.cross(spin, moved)
        reference = motion.reference
        return np.array(
            [
                equations.q[words] - reference.position - turn @ place,
                equations.v[words] - reference.velocity - turn @ moved,
                equations.a[words] - reference.acceleration - turn @ pushed,
            ]
        )

    z, step = equations.basis, 1e-4
    for k in np.flatnonzero(np.any(z[SIZE * int(body.node) + 3 :][:3] != 0.0, axis=0)):
        for of_place, of_speed, of_push in (
            (z[:, k], turning.velocity[:, k], turning.acceleration[:, k]),
            (np.zeros(len(z)), z[:, k], turning.by_rate[:, k]),
        ):
            kept, found = equations.block.image.copy(), []
            for sign in (step, -step):
                equations.q[:] += sign * of_place
                equations.v[:] += sign * of_speed
                equations.a[:] += sign * of_push
                found.append(apart())
                equations.block.image[:] = kept
            assert np.abs(found[0] - found[1]).max() / (2.0 * step) < 1e-6


def buoy(overrides: list[str]) -> SystemModel:
    """The buoy on its legs in an even current, with neither waves nor floor."""
    parts = load_system("scenes/systems/buoy_on_three_legs.yaml").to_dict()
    del parts["environment"]["waves"], parts["environment"]["floor"]
    parts["environment"]["current"] = [0.3, 0.0, 0.0]
    return SystemModel(load_system(parts, ["solver.tolerance=1e-5", *overrides]))


def differences(make: Any, key: str, value: Any, step: float, names: list[str]) -> np.ndarray:
    """Of static starts, by a number of the scene."""
    found = [values_of(make([f"{key}={value(sign * step)}"]), names) for sign in (1.0, -1.0)]
    return np.asarray((found[0] - found[1]) / (2.0 * step))


def test_gains_of_a_moored_buoy_are_differences_of_static_starts() -> None:
    """By its weight, by where that acts, by the current."""
    names = ["buoy.position.x", "buoy.position.z", "buoy.attitude.y", "a.end_tension"]
    linear = buoy([]).linearise()
    rows = [linear.outputs.index(name) for name in names]
    gains = linear.gains()[rows]
    gravity = 9.80665
    cases = (
        ("buoy.force.z", "bodies.buoy.mass", lambda by: 14000.0 - by / gravity, 2e3),
        (
            "buoy.torque.y",
            "bodies.buoy.centre_of_gravity",
            lambda by: [by / (14000.0 * gravity), 0.0, -0.4],
            100.0,
        ),
        ("current.x", "environment.current", lambda by: [0.3 + by, 0.0, 0.0], 0.01),
    )
    for level, key, value, step in cases:
        wanted = differences(buoy, key, value, step, names)
        found = gains[:, linear.levels.index(level)]
        if (
            level == "buoy.force.z"
        ):  # the weight acts at the centre of gravity, of a buoy that heels
            x, y, _z = buoy([]).bodies["buoy"].axes @ [0.0, 0.0, -0.4]
            found = found + y * gains[:, linear.levels.index("buoy.torque.x")]
            found = found - x * gains[:, linear.levels.index("buoy.torque.y")]
        # Of places and of the tension, each kind by its largest.
        for part in (slice(0, 2), slice(2, 3), slice(3, 4)):
            assert found[part] == pytest.approx(wanted[part], abs=5e-3 * np.abs(wanted[part]).max())


def test_gains_of_a_towed_depressor_are_differences_of_steady_tows() -> None:
    """By its speed and by its tail; the slow model has the same."""

    def tow(overrides: list[str]) -> SystemModel:
        return SystemModel(load_system(DEPRESSOR, ["solver.tolerance=1e-5", *overrides]))

    names = ["depressor.position.x", "depressor.position.z", "depressor.attitude.y"]
    names += ["wire.start_tension", "ship.force.x"]
    linear = tow([]).linearise()
    rows = [linear.outputs.index(name) for name in names]
    gains = linear.gains()[rows]
    for level, key, value, step in (
        ("ship.velocity.x", "vessels.ship.velocity", lambda by: [3.0 + by, 0.0, 0.0], 0.01),
        ("depressor.tail.deflection", "bodies.depressor.foils.tail.deflection", float, 1e-3),
    ):
        wanted = differences(tow, key, value, step, names)
        found = gains[:, linear.levels.index(level)]
        for part in (slice(0, 2), slice(2, 3), slice(3, 5)):
            assert found[part] == pytest.approx(wanted[part], abs=5e-3 * np.abs(wanted[part]).max())
    reduced = linear.reduced(12)
    assert reduced.gains()[rows] == pytest.approx(gains, rel=1e-6, abs=1e-9)
    s = 0.05j
    slow, whole = response(reduced, s)[rows], response(linear, s)[rows]
    assert slow == pytest.approx(whole, rel=1e-2, abs=1e-3 * np.abs(whole).max())


def test_gains_in_a_current_that_changes_with_depth_are_differences_of_steady_tows() -> None:
    """Of the depressor and its wing, too."""
    sheared = "environment.current={table: [{z: -150, velocity: [0, 0, 0]}, " + (
        "{z: 0, velocity: [-0.8, 0, 0]}]}"
    )

    def tow(overrides: list[str]) -> SystemModel:
        return SystemModel(load_system(DEPRESSOR, ["solver.tolerance=1e-5", sheared, *overrides]))

    names = ["depressor.position.x", "depressor.position.z", "wire.start_tension"]
    linear = tow([]).linearise()
    rows = [linear.outputs.index(name) for name in names]
    found = linear.gains()[rows, linear.levels.index("ship.velocity.x")]
    wanted = differences(tow, "vessels.ship.velocity", lambda by: [3.0 + by, 0.0, 0.0], 0.01, names)
    for part in (slice(0, 2), slice(2, 3)):
        assert found[part] == pytest.approx(wanted[part], abs=5e-3 * np.abs(wanted[part]).max())


def test_a_line_written_as_a_system_has_the_same_transfer_functions() -> None:
    cable = {**IDEAL, "diameter": 0.02, "mass": 1.2, "axial_stiffness": 5e6, "drag_normal": 1.2}
    cable |= {"added_mass": 1.0}
    body = {"mass": 300.0, "submerged_weight": 2000.0, "drag_area": 0.3, "drag_coefficient": 1.0}
    line = {"model": "cable", "elements": 8}
    short = scene(60.0, cable, density=1025.0, body=body, vessel={"velocity": [1.0, 0, 0]}, **line)
    parts = short.to_dict() if hasattr(short, "to_dict") else dict(short)
    one = cm.CableModel(short, planar=False)
    system = SystemModel(
        {
            "environment": parts["environment"],
            "cable_types": parts["cable_types"],
            "vessels": {"ship": {"points": {"p": [0, 0, 0]}, "velocity": [1.0, 0, 0]}},
            "lines": {"w": {"from": "ship.p", "to": "free", "items": parts["line"]}},
        }
    )
    axes = "xyz"
    inputs = {f"vessel_acceleration.{a}": f"ship.acceleration.{a}" for a in axes}
    inputs |= {f"current_rate.{a}": f"current_rate.{a}" for a in axes}
    outputs = {f"top_force.{a}": f"ship.force.{a}" for a in axes}
    outputs |= {"top_tension": "w.start_tension"}
    of_line = one.linearise().only(list(inputs), list(outputs))
    of_system = system.linearise().only(list(inputs.values()), list(outputs.values()))
    assert of_system.offset == pytest.approx(of_line.offset, rel=1e-6, abs=1e-6)
    for frequency in (0.02, 0.3, 2.0, 15.0):
        wanted = response(of_line, 1j * frequency)
        found = response(of_system, 1j * frequency)
        assert np.abs(found - wanted).max() < 1e-5 * np.abs(wanted).max()


def test_steps_of_differences_are_the_kernels() -> None:
    from cablemodel.solvers.finite_element.kernels.bodies import free_bodies
    from cablemodel.systems import linear

    assert linear.STEP == free_bodies.BODY_STEP


def test_names_say_what_is_what() -> None:
    linear = SystemModel(winch_at("start")).linearise()
    assert linear.states[:3] == tuple(f"w.nodes[0].slope.{axis}" for axis in "xyz")
    assert "fish.rotation.x" in linear.states
    assert "fish.rotation_rate.z" in linear.states
    assert linear.levels[:2] == ("ship.position.x", "ship.position.y")
    for name in ("ship.acceleration.z", "fish.torque_rate.x", "winch.payout_acceleration"):
        assert name in linear.inputs
    few = linear.only(["winch.payout_acceleration"], ["winch.line_length", "ship.moment.x"])
    assert few.discrete(0.1).inputs == ("winch.payout_rate",)
    with pytest.raises(cm.CableModelError, match=r"no output 'depth'; there are w\.start_tension"):
        linear.only(outputs=["depth"])


def on_the_floor() -> SystemModel:
    parts = load_system("scenes/systems/buoy_on_three_legs.yaml").to_dict()
    del parts["environment"]["waves"]
    return SystemModel(parts)


def cut() -> SystemModel:
    model = SystemModel(hung_bar() | {"cuts": {"knife": {"line": "one", "at": 2.0}}})
    model.step(0.01, cuts=["knife"])
    return model


def slack() -> SystemModel:
    line = {"from": {"anchor": [0, 0, 0]}, "to": {"anchor": [3, 0, 0]}, "items": string(8.0)}
    model = SystemModel(in_vacuum(lines={"one": line}))
    model.built.block.array(at.Header.tension, model.built.nodes, 2)[3:, 0] = -1.0
    return model


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda: SystemModel("scenes/systems/buoy_on_three_legs.yaml"), "waves drive the system"),
        (on_the_floor, "sea floor"),
        (cut, "the cut knife has been made"),
        (slack, "one is slack, .* m from its beginning"),
    ],
    ids=["waves", "floor", "cut", "slack"],
)
def test_what_is_not_linear_is_refused_by_name(make: Any, reason: str) -> None:
    with pytest.raises(cm.CableModelError, match=f"linearise: .*{reason}"):
        make().linearise()


def test_what_nothing_holds_is_named() -> None:
    """The bar on two strings rolls freely about its own axis."""
    linear = SystemModel(hung_bar()).linearise()
    assert linear.free == ("bar.rotation.x",)
    for ask in (linear.gains, lambda: linear.reduced(4)):
        with pytest.raises(cm.CableModelError, match=r"nothing holds bar\.rotation\.x"):
            ask()
