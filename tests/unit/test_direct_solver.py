"""The direct solver's parts: derivatives, linear systems, state, what it refuses, how it fails."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.solvers.direct import library
from cablemodel.solvers.direct.build import build
from cablemodel.solvers.direct.kernels import layout as own
from cablemodel.solvers.direct.kernels.entry import ENTRY_POINTS
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.compile import OPTIONS
from tests.verification import direct_scenes as scenes

RIGID = {
    "mass": 20.0,
    "submerged_weight": 12.0,
    "half_length": 0.4,
    "centre_offset": 0.3,
    "rotary_inertia": 0.5,
    "added_mass": 5.0,
    "drag_area": 0.1,
}
LINES: dict[str, list[dict[str, Any]]] = {
    "elastica": [scenes.cable(6.0)],
    "cable": [scenes.cable(6.0, "cable")],
    "hybrid with a point body": [
        scenes.cable(4.0, "cable"),
        {"body": scenes.POINT_BODY},
        scenes.cable(8.0, "hybrid"),
    ],
    "rigid bodies": [
        scenes.cable(3.0, "cable"),
        {"body": RIGID},
        scenes.cable(3.0),
        {"body": RIGID},
        scenes.cable(2.0),
        {"body": scenes.POINT_BODY},
        scenes.cable(2.0),
        {"body": RIGID},
    ],
}
CURRENT = {
    "current": {"table": [{"z": -20, "velocity": [0, 0, 0]}, {"z": 0, "velocity": [0.3, 0, 0]}]}
}


def disturbed(line, planar, **settings):
    """A block in an arbitrary state in the middle of an arbitrary step."""
    curved = {**scenes.CABLE_K, "tension_strain": [1e-6, 2e-9]}
    del curved["axial_stiffness"]
    scene = scenes.direct(
        line,
        vessel={"velocity": [{"t": 0, "velocity": [0.5, 0, 0]}]},
        environment=CURRENT,
        types={"K": curved},
        **settings,
    )
    block = build(scene, planar=planar)
    random = np.random.default_rng(7)
    nodes = int(
        block.integers(
            own.OwnHeader.sections, block.ints[own.OwnHeader.section_count], own.SECTION_WORDS
        )[:, own.Section.count].sum()
    )
    used = [own.V1, own.V3, own.PHI, own.F1, own.F3, own.K2] if planar else range(own.WIDTH)
    y = block.array(own.OwnHeader.unknowns, nodes, own.WIDTH)
    for unknown in used:
        size = (
            block.reals[own.OwnScalars.scale.place + unknown]
            if unknown in (own.F1, own.F2)
            else 1.0
        )
        y[:, unknown] += 0.1 * size * random.normal(size=nodes)
    past = block.array(own.OwnHeader.past, nodes, own.RATES)
    past[:] = 0.1 * random.normal(size=past.shape)
    block.array(own.OwnHeader.flow, nodes)[:] = 0.3 * random.normal(size=nodes)
    block.reals[own.OwnScalars.beta] = 2.0
    return block, y, list(used)


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("name", LINES)
def test_newton_matrix_is_the_derivative_of_the_residual(name, planar):
    """Central differences of the right-hand sides, for every unknown of every node."""
    block, y, used = disturbed(LINES[name], planar)
    slots = library.assemble(block.ints, block.reals)
    shape = block.integers(own.OwnHeader.shape, slots, own.SHAPE_WORDS).copy()
    left = block.array(own.OwnHeader.left, slots, own.WIDTH, own.WIDTH).copy()
    right = block.array(own.OwnHeader.right, slots, own.WIDTH, own.WIDTH).copy()
    rows = block.array(own.OwnHeader.rhs, slots, own.RHS_WORDS)
    divisors = rows[:, own.SlotSides.scales.span]
    scales = np.where(divisors > 0.0, divisors, 1.0)
    kinds = {own.CABLE: {own.V1, own.V2, own.V3, own.PHI, own.THETA, own.F3}}
    for section in block.integers(
        own.OwnHeader.sections, block.ints[own.OwnHeader.section_count], own.SECTION_WORDS
    ):
        active = [k for k in used if k in kinds.get(int(section[own.Section.kind]), set(used))]
        for node in range(
            section[own.Section.first], section[own.Section.first] + section[own.Section.count]
        ):
            for column, unknown in enumerate(active):
                scale = block.reals[own.OwnScalars.scale.place + unknown]
                kept = y[node, unknown]
                step = 1e-5 * scale
                values = []
                for sign in (1.0, -1.0):
                    y[node, unknown] = kept + sign * step
                    library.assemble(block.ints, block.reals)
                    values.append(rows[:, : own.WIDTH] * divisors)
                y[node, unknown] = kept
                slope = -(values[0] - values[1]) / (2.0 * step) * scale / scales
                for slot, matrix in ((node, right), (node + 1, left)):
                    count = shape[slot, own.SlotShape.rows]
                    found = matrix[slot, :count, column]
                    assert found == pytest.approx(slope[slot, :count], abs=2e-5), (slot, unknown)


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("name", LINES)
def test_superposition_and_elimination_solve_the_same_system(name, planar):
    """Round-off apart, with both meeting points: at the hybrid's joint and at the far end."""
    block, _y, _used = disturbed(LINES[name], planar)
    slots = library.assemble(block.ints, block.reals)
    rows = block.array(own.OwnHeader.rhs, slots, own.RHS_WORDS)
    rows[:, : own.WIDTH] = np.random.default_rng(3).normal(size=(slots, 10))
    found = []
    for method, meeting in (
        (own.ELIMINATION, 0),
        (own.SUPERPOSITION, 0),
        (own.SUPERPOSITION, None),
    ):
        if meeting is not None:
            block.ints[own.OwnHeader.meeting] = meeting
        else:
            block.ints[own.OwnHeader.meeting] = block.integers(
                own.OwnHeader.sections, block.ints[own.OwnHeader.section_count], own.SECTION_WORDS
            )[-1, own.Section.first]
        block.ints[own.OwnHeader.method] = method
        assert library.solve(block.ints, block.reals, slots) == at.OK
        shape = block.integers(own.OwnHeader.shape, slots, own.SHAPE_WORDS)
        change = block.array(own.OwnHeader.delta, slots, 2, own.WIDTH)
        unknowns = shape[:, own.SlotShape.right]
        found.append(np.concatenate([change[n, 0, : unknowns[n]] for n in range(slots - 1)]))
    for other in found[1:]:
        assert other == pytest.approx(found[0], rel=1e-6, abs=1e-8 * np.abs(found[0]).max())


def test_a_snapshot_goes_on_bit_by_bit():
    scene = scenes.deployed("elastica")
    model = cm.CableModel(scene)
    model.step_to(75.0)
    kept = pickle.loads(pickle.dumps(model.snapshot()))
    model.step_to(90.0)
    first = model.state()
    other = cm.CableModel(scene)
    other.restore(kept)
    other.step_to(90.0)
    second = other.state()
    for field in ("position", "velocity", "tension", "curvature"):
        assert np.array_equal(getattr(first, field), getattr(second, field))
    model.reset()
    assert model.time == 0.0
    assert np.array_equal(model.state().position, cm.CableModel(scene).state().position)


@pytest.mark.parametrize("half_length", [0.0, 0.25])
def test_a_step_that_is_rejected_leaves_no_trace(half_length):
    """Halved steps go on from the start of the step that failed: from nothing of its iterate, be
    it places, strains or the velocities that bodies remember."""
    run = cm.CableModel(scenes.deployed("elastica", half_length))
    run.step_to(100.0)
    compared = 0
    while run.time < 160.0:
        before, rejected = run.snapshot(), run.statistics["rejected"]
        run.step(1.0)
        if run.statistics["rejected"] != rejected + 1:
            continue
        halved, tension = run.state(), run.top_tension
        run.restore(before)
        run.step(0.5)
        run.step(0.5)
        assert run.statistics["rejected"] == rejected
        assert run.state().position == pytest.approx(halved.position, abs=1e-9)
        assert run.state().velocity == pytest.approx(halved.velocity, abs=1e-8)
        assert run.top_tension == pytest.approx(tension, rel=1e-9)
        compared += 1
    assert compared >= 1


def test_a_snapshot_of_the_other_solver_is_refused():
    model = cm.CableModel(scenes.towed("cable"))
    other = cm.CableModel(scenes.deployed("cable"))
    with pytest.raises(cm.SceneError, match="another scene"):
        model.restore(other.snapshot())


def test_steps_land_exactly_and_are_split_evenly():
    model = cm.CableModel(scenes.towed("cable", time_step=1.0))
    model.step(2.5)
    assert model.time == 2.5
    assert model.statistics["steps"] == 3
    model.step(1e-3)
    assert model.time == 2.501


def test_given_inputs_are_reached_linearly_as_with_the_finite_elements():
    """A position with a velocity: the cubic that meets both; the plane is left when asked to."""
    model = cm.CableModel(scenes.towed("cable"))
    assert model.planar
    model.step(1.0, vessel_velocity=(0.1, 0.05, 0.0))
    assert not model.planar
    assert model.vessel_position == pytest.approx([0.05, 0.025, 0.0], abs=1e-12)
    model.step(1.0, vessel_velocity=(0.2, 0.0, 0.0), vessel_position=(0.3, 0.1, 0.0))
    assert model.vessel_position == pytest.approx([0.3, 0.1, 0.0], abs=1e-12)
    assert model.vessel_velocity == pytest.approx([0.2, 0.0, 0.0], abs=1e-12)


def test_planar_and_spatial_equations_are_the_same_in_a_plane():
    flat, full = (
        cm.CableModel(scenes.towed("hybrid", relative_tolerance=1e-8), planar=planar)
        for planar in (None, False)
    )
    assert (flat.planar, full.planar) == (True, False)
    for model in (flat, full):
        model.step_to(40.0)
    assert full.state().position == pytest.approx(flat.state().position, abs=1e-9)


def test_sampling_and_range():
    model = cm.CableModel(scenes.towed("elastica"))
    model.step_to(20.0)
    state = model.sample([0.0, 29.9999999, 30.0])
    assert state.position[0] == pytest.approx(model.vessel_position)
    assert state.position[2] == pytest.approx(model.tip_position)
    with pytest.raises(ValueError, match="not on the line"):
        model.sample([30.1])


def test_run_writes_and_reads_a_log(tmp_path):
    run = cm.simulate(scenes.towed("hybrid"), log=tmp_path / "run.mcap", until=5.0)
    assert run["top_tension"][-1] == pytest.approx(70.0, abs=0.1)
    assert run.scene.solver.method == "direct_integration"


ANCHOR = {"end": {"anchor": [20, 0, -10]}}
FLOOR = {"environment": {"floor": {"z": -70.0}}}
DEPTHS = [{"x": 0, "z": -70.0}, {"x": 100, "z": -60.0}]
REFUSED = [
    ({"environment": {"waves": {"regular": {"height": 1, "period": 6}}}}, "environment.waves"),
    ({"line": [{"cable": {"type": "K", "length": 30, "elements": 4}}]}, "line.0.cable.elements"),
    (ANCHOR, "end"),
    (
        {"initial": {"straight": [1, 0, 0]}, "line": [scenes.cable(30, "cable")]},
        "line.0.cable.model",
    ),
    ({**FLOOR, "line": [scenes.cable(30, "cable")]}, "line.0.cable.model"),
    ({**FLOOR, **ANCHOR, "initial": {"points": [[0, 0, 0], [20, 0, -10]]}}, "end"),
    ({"environment": {"floor": {"depth_table": DEPTHS}}}, "environment.floor.depth_table"),
    ({"environment": {"floor": {"z": -70.0, "damping": 1.0}}}, "environment.floor.damping"),
    ({**FLOOR, "line": [scenes.cable(30), {"body": scenes.POINT_BODY}]}, "line.1"),
    (
        {"payout": {"rate": [{"t": 0, "rate": 0.5}], "drum": [scenes.cable(9)]}},
        "payout.rate.0.rate",
    ),
    ({"payout": {"drum": [scenes.cable(9), {"body": scenes.POINT_BODY}]}}, "payout.drum.1"),
]


@pytest.mark.parametrize(("change", "path"), REFUSED, ids=[path for _, path in REFUSED])
def test_what_the_method_cannot_do_is_refused_by_name(change, path):
    data = {
        "cable_types": {"K": scenes.CABLE_K},
        "line": [scenes.cable(30.0)],
        "solver": {"method": "direct_integration"},
        **change,
    }
    with pytest.raises(cm.SceneError) as error:
        cm.CableModel(cm.load_scene(data))
    assert error.value.path == path
    assert error.value.allowed
    assert error.value.allowed.endswith("or solver.method: finite_element")
    assert f"(given: {error.value.value})" in str(error.value)


def test_settings_of_the_method():
    scene = scenes.towed(joint="paper", bending_length="3 m", linear_solver="elimination")
    assert cm.load_scene(scene.to_dict()) == scene
    with pytest.raises(cm.SceneError, match="no such setting"):
        scenes.towed(tolerance=1e-3)


def fails(model, until, match):
    """A step error with advice, after which the model is as it was."""
    before = model.snapshot().image
    with pytest.raises(cm.StepError, match=match) as error:
        model.step_to(until)
    assert error.value.advice
    assert model.snapshot().image == before


def test_a_flexible_cable_that_goes_slack_says_so():
    drop = {"velocity": [{"t": 0, "velocity": [0, 0, 0]}, {"t": 0.5, "velocity": [0, 0, -3.0]}]}
    scene = scenes.direct([scenes.cable(30.0, "cable")], vessel=drop, time_step=0.1)
    fails(cm.CableModel(scene), 3.0, "lost its tension|does not converge")


def test_a_held_end_that_drifts_says_so():
    x = np.linspace(0.0, 1.0, 41)
    points = np.stack([20.0 * x, 0.0 * x, -24.0 * x * (1.0 - x)], axis=1)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    scene = scenes.direct(
        [scenes.cable(float(length))],
        initial={"points": points.tolist()},
        end={"anchor": [20, 0, 0]},
        vessel={"velocity": [{"t": 0, "velocity": [0, 0, 0]}, {"t": 5, "velocity": [-0.5, 0, 0]}]},
    )
    fails(cm.CableModel(scene), 30.0, "drifted|does not converge")


def test_a_line_that_lies_along_every_horizontal_direction_says_so():
    """A neutral cable laid in a half circle: some part of it lies along the axis of the angles."""
    angle = np.linspace(0.0, 1.5 * np.pi, 91)
    points = np.stack([3.0 * np.sin(angle), 3.0 - 3.0 * np.cos(angle), 0.0 * angle], axis=1)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    scene = scenes.direct(
        [scenes.cable(float(length))], initial={"points": points.tolist()}, node_spacing=0.1
    )
    fails(cm.CableModel(scene), 1.0, "sin theta = 0")


@pytest.mark.parametrize("what", ["energy", "linearise", "small_motions", "natural_frequencies"])
def test_analyses_are_for_the_finite_elements(what):
    model = cm.CableModel(scenes.towed("cable"))
    with pytest.raises(cm.CableModelError, match="direct_integration, use finite_element"):
        getattr(model, what)()


def test_a_line_that_would_lie_on_the_floor_at_the_start_says_so():
    """No static state with cable on the floor: 80 m hang in 70 m of water."""
    with pytest.raises(cm.StaticsError, match=r"goes through the floor.*finite_element"):
        cm.CableModel(scenes.direct([scenes.cable(80.0)], environment={"floor": {"z": -70.0}}))


def test_kernels_are_compiled_by_the_rules_of_all_kernels():
    """No runtime, no fastmath, so that they can leave Python like the others."""
    for entry in ENTRY_POINTS.values():
        options = {key: entry.targetoptions[key] for key in OPTIONS if key in entry.targetoptions}
        assert options.items() <= OPTIONS.items()
        assert options["_nrt"] is False
