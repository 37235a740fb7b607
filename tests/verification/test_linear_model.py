"""Linear models against closed forms, static differences and small steps of the model itself."""

import copy

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.linear.equations import SIZE
from cablemodel.linear.line import LineEquations
from cablemodel.solvers.shared.layout import Header
from tests.verification.scenes import CABLE_K, IDEAL, scene

GRAVITY = 9.80665
TOW = "scenes/depressor_tow.yaml"


def outputs_of(model, names):
    """The outputs as the model itself says them."""

    def value(name):
        name, _, axis = name.rpartition(".") if name[-2:-1] == "." else (name, "", "")
        if name.startswith("bodies["):
            number, _, attribute = name[len("bodies[") :].partition("].")
            found = getattr(model.bodies[int(number)], attribute)
        else:
            found = getattr(model, name)
        return found["xyz".index(axis)] if axis else found

    return np.array([value(name) for name in names])


def turning():
    model = cm.CableModel(cm.load_scene("scenes/turn.yaml", ["solver.tolerance=1e-4"]))
    model.step(10.0)
    return model


def paying_out():
    model = cm.CableModel(cm.load_scene(TOW, ["solver.tolerance=1e-4"]))
    model.step(5.0, vessel_velocity=(2.0, 0.3, 0.0), payout_rate=0.3)
    return model


def with_bodies_between():
    model = cm.CableModel("scenes/payout_with_bodies.yaml")
    model.step(7.0, vessel_velocity=(0.4, 0.2, 0.0), payout_rate=0.1)
    return model


def clamped(rate=None):
    """Towed from a clamp, out of its plane."""
    cable = {**CABLE_K, "bending_stiffness": 20.0}
    model = cm.CableModel(
        scene(30.0, cable, elements=6, vessel={"connection": {"clamped": [-0.6, 0.0, -0.8]}})
    )
    model.step(8.0, vessel_velocity=(0.5, 0.2, 0.0), payout_rate=rate)
    return model


def clamped_and_reeled_in():
    """The clamp is a spring then."""
    return clamped(-0.1)


SHEARED = (
    "environment.current={table: [{z: -250, velocity: [0.2, 0.3, 0]}, "
    "{z: 0, velocity: [-0.8, 0, 0]}]}"
)
"""A current that fades and turns with depth."""


def in_sheared_current():
    model = cm.CableModel(cm.load_scene(TOW, [SHEARED, "solver.tolerance=1e-3"]))
    model.step(3.0, vessel_velocity=(2.2, 0.4, 0.1))
    return model


@pytest.mark.parametrize(
    "make",
    [turning, paying_out, with_bodies_between, clamped, clamped_and_reeled_in, in_sheared_current],
)
def test_matrices_are_the_derivatives_of_the_residual(make):
    """A body of finite length and a running winch too."""
    equations = LineEquations(make())
    count = SIZE * equations.nodes
    free = np.column_stack([equations.basis, equations._top()])
    for word, matrix, step in (
        (Header.position, equations.stiffness, 1e-6),
        (Header.velocity, equations.damping, 1e-5),
        (Header.acceleration, equations.mass, 1e-3),
    ):

        def change(block, by, way, word=word):
            block.array(word, count)[:] += by * way

        found = np.column_stack(
            [equations.by(lambda b, by, w=w: change(b, by, w), step) for w in free.T]
        )
        wanted = free.T @ matrix @ free
        error = np.abs(free.T @ found - wanted)
        # A slope's stiffness beside a body that hardly stretches: 1e10 N and the rounding of it.
        assert np.all(error <= 1e-6 * np.abs(wanted) + 1e-7 * np.abs(wanted).max(axis=1)[:, None])


def pendulum(length=10.0, elements=4):
    cable = {**IDEAL, "mass": 1e-4, "axial_stiffness": 1e9}
    body = {"mass": 1000.0, "submerged_weight": 1000.0 * GRAVITY}
    return cm.CableModel(
        scene(length, cable, model="cable", elements=elements, density=0.0, body=body)
    )


def test_a_heavy_body_on_a_wire_is_a_pendulum():
    model = pendulum()
    length = -model.tip_position[2]
    omega = np.sqrt(GRAVITY / length)
    linear = model.linearise()
    slow = linear.reduced(4)
    poles = np.linalg.eigvals(slow.A[:4, :4])
    assert np.sort(poles.imag) == pytest.approx([-omega, -omega, omega, omega], rel=1e-6)
    assert np.abs(poles.real).max() < 1e-8
    # To a tow point that swings at s: x of the body is a / s^2 times omega^2 / (s^2 + omega^2).
    s = 0.7j * omega
    for m in (linear, slow):
        only = m.only(["vessel_acceleration.x"], ["tip_position.x", "top_force.x"])
        found = only.C @ np.linalg.solve(s * np.eye(len(only.A)) - only.A, only.B) + only.D
        place = omega**2 / (s**2 + omega**2) / s**2
        assert found[0, 0] == pytest.approx(place, rel=1e-5)
        assert found[1, 0] == pytest.approx(-1000.0 * s**2 * place, rel=1e-5)
    # In heave it bounces on the wire's stiffness EA/L.
    bounce = 1e9 / 10.0 / 1000.0
    s = 0.4j * np.sqrt(bounce)
    heave = linear.only(["vessel_acceleration.z"], ["top_tension"])
    found = heave.C @ np.linalg.solve(s * np.eye(len(heave.A)) - heave.A, heave.B) + heave.D
    assert found[0, 0] == pytest.approx(1000.0 * bounce / (bounce + s**2), rel=1e-5)
    assert linear.offset[linear.outputs.index("top_tension")] == pytest.approx(
        1000.0 * GRAVITY, rel=1e-6
    )


def test_a_taut_line_has_the_modes_of_a_string():
    length, tension, elements = 100.0, 10e3, 12
    cable = {**IDEAL, "mass": 0.15, "submerged_weight": 1e-9, "axial_stiffness": 1e8}
    end = {"anchor": [length * (1.0 + tension / 1e8), 0.0, 0.0]}
    model = cm.CableModel(
        scene(length, cable, model="cable", elements=elements, density=0.0, end=end)
    )
    omega = np.pi / length * np.sqrt(tension / (0.15 * (1.0 + tension / 1e8)))
    linear = model.linearise().reduced(12)
    found = np.sort(np.linalg.eigvals(linear.A[:12, :12]).imag)[6:]
    assert found == pytest.approx(omega * np.repeat([1.0, 2.0, 3.0], 2), rel=1e-4)


def test_poles_are_the_natural_frequencies():
    """Of a sagging chain, in space: both planes."""
    cable = {**IDEAL, "submerged_weight": GRAVITY, "axial_stiffness": 1e8}
    end = {"anchor": [60.0, 0.0, -20.0]}
    model = cm.CableModel(
        scene(80.0, cable, model="cable", elements=12, density=0.0, end=end), planar=False
    )
    poles = np.linalg.eigvals(model.linearise().reduced(12).A[:12, :12])
    assert np.sort(poles.imag)[6:] == pytest.approx(model.natural_frequencies(6), rel=1e-5)


def static(overrides):
    return cm.CableModel(cm.load_scene(TOW, ["solver.tolerance=1e-4", *overrides]))


def test_gains_are_differences_of_static_solutions():
    """Of a towed body: speed, current, length of line; depth from the static solver."""
    linear = static([]).linearise()
    gains = linear.gains()
    knots, step = 1852.0 / 3600.0, 0.01
    four = 4.0 * knots
    cases = {
        "vessel_velocity.x": ([f"vessel.velocity=[{four + s * step}, 0, 0]"] for s in (1, -1)),
        "line_length": ([f"line.0.cable.length={300.0 + s * step}"] for s in (1, -1)),
        "current.x": ([f"environment.current=[{s * step}, 0, 0]"] for s in (1, -1)),
        "current.y": ([f"environment.current=[0, {s * step}, 0]"] for s in (1, -1)),
    }
    names = ["tip_position.x", "tip_position.y", "tip_position.z", "top_tension", "top_force.y"]
    rows = [linear.outputs.index(name) for name in names]
    for level, (more, less) in cases.items():
        wanted = (outputs_of(static(more), names) - outputs_of(static(less), names)) / (2.0 * step)
        found = gains[rows, linear.levels.index(level)]
        assert found == pytest.approx(wanted, rel=2e-3, abs=2e-4 * np.abs(wanted).max())
    reduced = linear.reduced(8)
    assert reduced.gains() == pytest.approx(gains, rel=1e-6, abs=1e-6 * np.abs(gains).max())


def test_gains_in_a_current_that_changes_with_depth_are_differences_of_static_solutions():
    """Deeper, a cable feels another current: without that, gains are a tenth off here."""
    linear = static([SHEARED]).linearise()
    speed, step = 4.0 * 1852.0 / 3600.0, 0.01
    names = ["tip_position.x", "tip_position.y", "tip_position.z", "top_tension"]
    ends = [static([SHEARED, f"vessel.velocity=[{speed + s * step}, 0, 0]"]) for s in (1, -1)]
    wanted = (outputs_of(ends[0], names) - outputs_of(ends[1], names)) / (2.0 * step)
    rows = [linear.outputs.index(name) for name in names]
    found = linear.gains()[rows, linear.levels.index("vessel_velocity.x")]
    assert found == pytest.approx(wanted, rel=2e-3, abs=2e-4 * np.abs(wanted).max())


def steps(model, dt, count, inputs):
    other = copy.deepcopy(model)
    for _ in range(count):
        other.step(dt, **inputs)
    return other


@pytest.mark.parametrize("crosses", [False, True])
def test_step_responses_are_those_of_small_steps(crosses):
    """Whole and reduced models, from a steady tow, also across the current: eight steps of 1 s."""
    flow = ["environment.current=[0.2, 0.5, 0]"] if crosses else []
    model = static(flow)
    assert model.planar is not crosses
    linear = model.linearise()
    whole, reduced = linear.discrete(1.0), linear.reduced(24).discrete(1.0)
    still, _pulse = whole.responses(8)  # but for the tow point, that goes on at 4 kn
    depth = linear.outputs.index("tip_position.z")
    assert still[:, depth] == pytest.approx(model.tip_position[2], abs=1e-3)
    now = {
        "vessel_velocity": model.vessel_velocity,
        "payout_rate": 0.0,
        "current": np.zeros(3),
    }
    names = ["tip_position.x", "tip_position.y", "tip_position.z", "bodies[0].position.z"]
    rows = [linear.outputs.index(name) for name in (*names, "top_tension")]
    count, size = 8, 2e-3
    for column, name in enumerate(whole.inputs):
        found = []
        for sign in (1.0, -1.0):
            inputs = dict(now)
            owner, _, axis = name.partition(".")
            by = sign * size * (np.eye(3)["xyz".index(axis)] if axis else 1.0)
            inputs[owner] = inputs[owner] + by
            found.append(outputs_of(steps(model, 1.0, count, inputs), (*names, "top_tension")))
        wanted = (found[0] - found[1]) / (2.0 * size)
        for discrete in (whole, reduced):
            _free, pulse = discrete.responses(count)
            got = pulse[:, rows, column].sum(axis=0)
            assert got[:4] == pytest.approx(
                wanted[:4], abs=2e-3 * max(0.1, np.abs(wanted[:4]).max())
            )
            assert got[4] == pytest.approx(wanted[4], abs=0.02 * max(abs(wanted[4]), 10.0))


@pytest.mark.parametrize("make", [turning, paying_out])
def test_a_motion_goes_on_as_its_linear_model_says(make):
    """About a state that is not steady: errors grow with the square of the time."""
    model = make()
    linear = model.linearise()
    rows = [linear.outputs.index(f"tip_position.{axis}") for axis in "xyz"]
    now = {"vessel_velocity": model.vessel_velocity, "payout_rate": model.payout_rate}
    errors = []
    for dt in (0.4, 0.8):
        free, _pulse = linear.discrete(dt).responses(1)
        after = steps(model, dt, 1, now).tip_position
        errors.append(np.linalg.norm(free[0, rows] - after))
        assert errors[-1] < 0.02 * np.linalg.norm(after - model.tip_position)
    assert errors[0] < 0.5 * errors[1]


def test_names_say_what_is_what():
    linear = pendulum().linearise()
    assert linear.states[:3] == ("nodes[0].slope.x", "nodes[0].slope.y", "nodes[0].slope.z")
    assert linear.levels[:2] == ("vessel_position.x", "vessel_position.y")
    assert "bodies[0].position.z" in linear.outputs
    assert linear.A.shape == (len(linear.states),) * 2
    assert linear.D.shape == (len(linear.outputs), len(linear.inputs))
    few = linear.only(["current_rate.x"], ["top_tension", "tip_position.z"])
    assert (few.B.shape[1], few.outputs) == (1, ("top_tension", "tip_position.z"))
    with pytest.raises(cm.CableModelError, match=r"no output 'depth'; there are top_force\.x"):
        linear.only(outputs=["depth"])
    with pytest.raises(cm.CableModelError, match="allowed: 1 to"):
        linear.reduced(0)
    with pytest.raises(cm.CableModelError, match="give a positive one"):
        linear.discrete(0.0)
    # A drum that is empty lets the winch turn one way only.
    assert "payout_acceleration" not in linear.inputs
    assert "payout_acceleration" in static([]).linearise().inputs


def on_the_floor():
    return cm.CableModel("scenes/cable_lay.yaml")


def in_waves():
    return cm.CableModel("scenes/floating_line_in_waves.yaml")


def slack():
    """A chain that lies straight between its ends, too long for them."""
    cable = {**IDEAL, "axial_stiffness": 1e6}
    return cm.CableModel(
        scene(
            10.0,
            cable,
            model="cable",
            elements=4,
            density=0.0,
            initial={"points": [[0, 0, 0], [9.99, 0, 0]]},
            end={"anchor": [9.99, 0.0, 0.0]},
        )
    )


@pytest.mark.parametrize(
    ("make", "reason"),
    [(on_the_floor, "sea floor"), (in_waves, "waves"), (slack, "slack, 0 m from the vessel")],
)
def test_what_is_not_linear_is_refused_by_name(make, reason):
    with pytest.raises(cm.CableModelError, match=f"linearise: .*{reason}"):
        make().linearise()


def changed(model, path, by):
    """The same state with another value of a parameter: a table's word, by hand."""
    from cablemodel.solvers.shared import layout as at

    other = copy.deepcopy(model)
    block = other._solver.memory
    nodes = int(block.header.nodes)
    edges = block.array(Header.edges, nodes, at.EDGE_WORDS)
    bodies = block.array(Header.bodies, int(block.header.body_count), at.BODY_WORDS)
    kind = next(iter(model.scene.cable_types.values()))
    if path.endswith("drag_normal"):
        edges[1:, at.Edge.drag_normal] += 0.5 * 1025.0 * kind.diameter * by
    elif path.endswith("cable_types.K.submerged_weight"):
        edges[1:, at.Edge.weight] += by
    elif path.endswith("body.submerged_weight"):
        bodies[0, at.Body.weight] += by
    else:
        bodies[0, at.Body.drag] += 0.5 * 1025.0 * model.scene.line[1].body.drag_coefficient * by
    block.header.factored = block.header.has_history = 0
    # A step begins with the accelerations of the state: make them those of the new value.
    other.step(1e-4, vessel_velocity=other.vessel_velocity, payout_rate=other.payout_rate)
    return other


@pytest.mark.parametrize(
    ("make", "inputs", "parameters"),
    [
        (
            turning,
            {"vessel_velocity": np.array([0.5, 0.4, 0.05]), "current": np.array([0.05, 0.1, 0.0])},
            {"cable_types.K.drag_normal": 0.05, "cable_types.K.submerged_weight": 0.1},
        ),
        (
            paying_out,
            {"vessel_velocity": np.array([2.05, 0.35, 0.05]), "payout_rate": 0.25},
            {"line.1.body.submerged_weight": 100.0, "line.1.body.drag_area": 0.01},
        ),
    ],
    ids=["turn", "pay-out"],
)
def test_sensitivities_of_a_step_are_those_of_differences(make, inputs, parameters):
    model, dt = make(), 1.0
    found = model.sensitivities(dt, **inputs, parameters=list(parameters))
    names = [f"tip_position.{axis}" for axis in "xyz"]
    rows = [found.outputs.index(name) for name in names]

    def after(start, given):
        return outputs_of(steps(start, dt, 1, given), names)

    for column, name in enumerate(found.inputs):
        owner, _, axis = name.partition(".")
        if owner not in inputs:
            continue
        by = 0.02 * (np.eye(3)["xyz".index(axis)] if axis else 1.0)
        ends = [after(model, inputs | {owner: inputs[owner] + s * by}) for s in (1, -1)]
        wanted = (ends[0] - ends[1]) / 0.04
        got = found.output_by_input[rows, column]
        assert got == pytest.approx(wanted, abs=5e-3 * np.abs(wanted).max()), name
    for column, (path, step) in enumerate(parameters.items()):
        ends = [after(changed(model, path, s * step), inputs) for s in (1, -1)]
        wanted = (ends[0] - ends[1]) / (2.0 * step)
        got = found.output_by_parameter[rows, column]
        assert got == pytest.approx(wanted, abs=5e-3 * np.abs(wanted).max()), path
        assert found.of(names[2], path) == got[2]


def test_sensitivities_name_what_they_do_not_know():
    model = pendulum()
    with pytest.raises(cm.CableModelError, match=r"cable_types\.D\.mass is None, not a number"):
        model.sensitivities(0.1, parameters=["cable_types.D.mass"])
    with pytest.raises(cm.CableModelError, match=r"line\.0\.cable\.length changes none of mass"):
        model.sensitivities(0.1, parameters=["line.0.cable.length"])
    found = model.sensitivities(0.1, vessel_velocity=(0.1, 0.0, 0.0))
    assert found.of("vessel_position.x", "vessel_velocity.x") == pytest.approx(0.05)
    with pytest.raises(cm.CableModelError, match="no sensitivity of 'depth'"):
        found.of("depth", "payout_rate")


def test_sensitivity_of_a_pendulum_is_that_of_its_equation():
    """x'' = omega^2 (p - x) while the tow point's speed grows evenly from 0 to v in a time t: then
    x = v / t (t^2 / 2 - (1 - cos omega t) / omega^2). At rest nothing depends on its mass."""
    model, dt = pendulum(), 2.0
    omega = np.sqrt(GRAVITY / -model.tip_position[2])
    found = model.sensitivities(dt, parameters=["line.1.body.mass"])
    place = (0.5 * dt**2 - (1.0 - np.cos(omega * dt)) / omega**2) / dt
    assert found.of("tip_position.x", "vessel_velocity.x") == pytest.approx(place, rel=1e-5)
    pull = 1000.0 * omega**2 * (0.5 * dt - place)
    assert found.of("top_force.x", "vessel_velocity.x") == pytest.approx(-pull, rel=1e-4)
    assert abs(found.of("tip_position.z", "line.1.body.mass")) < 1e-12
    # Lifted, it hardly stretches.
    lifted = found.of("tip_position.z", "vessel_velocity.z")
    assert lifted == pytest.approx(0.5 * dt, abs=1e-4)


def test_sensitivities_of_a_short_step_with_a_jump():
    """The waves of a heavy fish ask for another mesh as it begins: none that changes within it."""
    wire = {
        "diameter": 0.012, "mass": 0.5, "axial_stiffness": 6e6, "bending_stiffness": 2.0,
        "drag_normal": 1.4, "drag_tangential": 0.015,
    }  # fmt: skip
    fish = {"mass": 200.0, "submerged_weight": 1200.0, "added_mass": 80.0, "drag_area": 0.18}
    tow = {
        "cable_types": {"wire": wire},
        "line": [{"cable": {"type": "wire", "length": 200.0}}, {"body": fish}],
        "vessel": {"velocity": [2.0, 0.0, 0.0]},
        "solver": {"tolerance": 1e-4},
    }
    found = cm.CableModel(cm.load_scene(tow)).sensitivities(0.1, vessel_velocity=[2.2, 0.0, 0.0])
    # The line begins to move with its tow point: half of the step times the speed reached.
    assert found.of("top_tension", "vessel_velocity.x") > 0.0
    assert np.isfinite(found.state_by_input).all()
