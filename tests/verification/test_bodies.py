"""Bodies of finite length against rigid-body mechanics, closed forms and very stiff cable."""

from dataclasses import asdict
from functools import cache

import numpy as np
import pytest

import cablemodel as cm
from tests.verification.references import bodies as reference
from tests.verification.references.bodies import GRAVITY, Body
from tests.verification.scenes import CABLE_K, IDEAL

ENERGIES = ("kinetic", "axial", "bending", "potential")


def load(line, cable, *, density=1025.0, tolerance=1e-4, others=None, **settings):
    """A scene with the cable types C and `others`."""
    return cm.load_scene(
        {
            "environment": {"gravity": GRAVITY, "water_density": density},
            "cable_types": {"C": cable, **(others or {})},
            "line": line,
            "solver": {"tolerance": tolerance},
            **settings,
        }
    )


def stored(model):
    energy = model.energy()
    return sum(energy[name] for name in ENERGIES)


# Swings in vacuum -------------------------------------------------------------------------------

STIFFNESS = 1e6
SWUNG = [
    Body(5.0, 0.7 * 5.0 * GRAVITY, 0.4, centre_offset=0.3, rotary_inertia=0.4),
    Body(2.0, 2.0 * GRAVITY, 0.3, centre_offset=-0.2, rotary_inertia=0.1),
]


def swing(bodies, tolerance, degrees=40.0, **settings):
    """Bodies on metres of weightless cable, let go under the tension that they have there.

    Returns the model and where `reference.chain` starts, (n, 3).
    """
    angle = np.radians(degrees)
    direction = np.array([np.sin(angle), -np.cos(angle)])
    cable = {**IDEAL, "mass": 1e-6, "submerged_weight": 0.0, "axial_stiffness": STIFFNESS}
    line, points, start, at = [], [[0.0, 0.0, 0.0]], [], np.zeros(2)
    for k, body in enumerate(bodies):
        line += [
            {"cable": {"type": "C", "length": 1.0, "model": "cable", "elements": 2}},
            {"body": asdict(body)},
        ]
        weight = sum(below.submerged_weight for below in bodies[k:])
        at = at + (1.0 + weight * np.cos(angle) / STIFFNESS) * direction
        start.append([*at, angle])
        at = at + 2.0 * body.half_length * direction
    points.append([at[0], 0.0, at[1]])
    scene = load(
        line, cable, density=0.0, tolerance=tolerance, initial={"points": points}, **settings
    )
    return scene, start


@cache
def chain_of(count):
    """Times, and where these bodies are then; the same at every tolerance."""
    bodies = SWUNG[:count]
    _, start = swing(bodies, 1e-4)
    times = np.linspace(0.0, 3.0, 7)[1:]
    return times, reference.chain(bodies, np.ones(count), STIFFNESS, start, times)


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5])
def test_swing_of_rigid_bodies(count, tolerance):
    """A body on a stiff line is a double pendulum, two of them one of four links: 3 s of each."""
    bodies = SWUNG[:count]
    scene, _ = swing(bodies, tolerance)
    times, exact = chain_of(count)
    model = cm.CableModel(scene)
    length = scene.line_length + sum(2.0 * body.half_length for body in bodies)
    for time, states in zip(times, exact, strict=True):
        model.step_to(time)
        for body, found, state in zip(bodies, model.bodies, states, strict=True):
            centre, end = reference.centre_and_end(body, state)
            assert found.position[[0, 2]] == pytest.approx(centre, abs=tolerance * length)
            assert found.position[1] == 0.0
        assert model.tip_position[[0, 2]] == pytest.approx(end, abs=tolerance * length)


@pytest.mark.parametrize("interval", [0.001, 0.02, 0.3])
def test_swing_stepped_by_its_caller(interval):
    tolerance = 1e-4
    scene, start = swing(SWUNG[:1], tolerance)
    times = np.array([0.6, 1.2])
    exact = reference.chain(SWUNG[:1], np.ones(1), STIFFNESS, start, times)
    model = cm.CableModel(scene)
    for k in range(round(times[-1] / interval)):
        model.step_to((k + 1) * interval)
    centre, _ = reference.centre_and_end(SWUNG[0], exact[-1, 0])
    assert model.bodies[0].position[[0, 2]] == pytest.approx(centre, abs=1.8 * tolerance)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_swing_keeps_its_energy(tolerance):
    """Two bodies, 5 s: lost or gained at most 10 tau of the energy of the swing."""
    scene, _ = swing(SWUNG, tolerance)
    model = cm.CableModel(scene)
    start = stored(model)
    scale = sum(body.submerged_weight for body in SWUNG) * 2.0 * (1.0 - np.cos(np.radians(40.0)))
    for time in np.arange(0.5, 5.1, 0.5):
        model.step_to(time)
        assert abs(stored(model) - start) < 10.0 * tolerance * scale


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_clamped_swing_keeps_its_energy(tolerance):
    """The same with a cable that bends between bodies and passes moments, and has mass."""
    cable = {
        **IDEAL,
        "mass": 0.4,
        "submerged_weight": 0.4 * GRAVITY,
        "axial_stiffness": 1e6,
        "bending_stiffness": 5.0,
    }
    piece = {"cable": {"type": "C", "length": 1.0, "model": "elastica"}}
    line = [piece, {"body": asdict(SWUNG[0])}, piece, {"body": asdict(SWUNG[1])}, piece]
    scene = load(
        line, cable, density=0.0, tolerance=tolerance, initial={"straight": [0.6, 0, -0.8]}
    )
    model = cm.CableModel(scene)
    start = stored(model)
    scale = sum(body.submerged_weight for body in SWUNG) * 2.0 * 0.2
    for time in np.arange(0.5, 5.1, 0.5):
        model.step_to(time)
        change = (stored(model) - start) / scale
        assert -10.0 * tolerance * (1.0 + time) < change < 10.0 * tolerance


def test_axial_mode_with_an_end_mass():
    """2.72061369 rad/s in closed form, for a point mass: its length must not add a spring."""
    cable = {**IDEAL, "mass": 1.0, "submerged_weight": 1.0, "axial_stiffness": 1e7}
    body = {"mass": 1000.0, "submerged_weight": 1000.0, "half_length": 2.0, "rotary_inertia": 900.0}
    line = [{"cable": {"type": "C", "length": 1000.0, "model": "cable", "elements": 16}}]
    model = cm.CableModel(load([*line, {"body": body}], cable, density=0.0))
    frequencies = model.natural_frequencies(60)
    assert np.abs(frequencies / 2.72061369 - 1.0).min() < 3e-5


# Water ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("broadside", [False, True])
def test_falling_body(broadside):
    """V tanh(t/tau) along and across its axis: a line that falls like it does not pull at it."""
    body = Body(
        30.0, 120.0, 0.5, rotary_inertia=3.0, added_mass=20.0, added_mass_axial=4.0,
        drag_area=0.2, drag_area_axial=0.05,
    )  # fmt: skip
    area = body.drag_area if broadside else body.drag_area_axial
    added = body.added_mass if broadside else body.added_mass_axial
    speed = np.sqrt(2.0 * body.submerged_weight / (1025.0 * area))
    rise = (body.mass + added) * speed / body.submerged_weight
    times = np.linspace(0.0, 5.0 * rise, 2001)
    table = [{"t": t, "velocity": [0, 0, -speed * np.tanh(t / rise)]} for t in times.tolist()]
    cable = {**IDEAL, "mass": 1e-3, "axial_stiffness": 1e5, "bending_stiffness": 10.0}
    line = [{"cable": {"type": "C", "length": 2.0, "model": "elastica"}}, {"body": asdict(body)}]
    direction = [1.0, 0.0, 0.0] if broadside else [0.0, 0.0, -1.0]
    model = cm.CableModel(
        load(line, cable, initial={"straight": direction}, vessel={"velocity": table})
    )
    start = model.bodies[0].position
    for time in np.array([0.5, 1.0, 2.0, 5.0]) * rise:
        model.step_to(time)
        fallen = speed * rise * np.log(np.cosh(time / rise))
        found = model.bodies[0]
        assert found.position - start == pytest.approx([0.0, 0.0, -fallen], abs=1e-4 * 2.0)
        assert found.direction == pytest.approx(direction, abs=2e-4 * 2.0)
        assert abs(model.top_tension) < 10e-4 * body.submerged_weight


DEPRESSOR = Body(
    60.0, 400.0, 0.6, centre_offset=0.2, rotary_inertia=8.0, added_mass=25.0,
    added_mass_axial=3.0, drag_area=0.15, drag_area_axial=0.012,
)  # fmt: skip


def towing(length, speed, model, tolerance, bending, **settings):
    line = [{"cable": {"type": "C", "length": length, "model": model}}, {"body": asdict(DEPRESSOR)}]
    cable = {**CABLE_K, "bending_stiffness": bending}
    vessel = {"velocity": [{"t": 0, "velocity": [speed, 0, 0]}]}
    return load(line, cable, tolerance=tolerance, vessel=vessel, **settings)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
@pytest.mark.parametrize("speed", [1.0, 3.0])
@pytest.mark.parametrize("planar", [None, False])
def test_depressor_tow(speed, tolerance, planar):
    """A kilometre of flexible cable, the body hinged to it."""
    centre, axis, top = reference.towed_below(DEPRESSOR, CABLE_K, 1000.0, speed)
    model = cm.CableModel(towing(1000.0, speed, "cable", tolerance, 0.0), planar=planar)
    assert model.bodies[0].position == pytest.approx(centre, abs=tolerance * 1000.0)
    assert model.bodies[0].direction == pytest.approx(axis, abs=1e-9)
    assert model.top_tension == pytest.approx(top, abs=10.0 * tolerance * top)
    model.step(100.0)
    moved = model.bodies[0].position - model.vessel_position
    assert moved == pytest.approx(centre, abs=tolerance * 1000.0)


@cache
def expected_tow(bending):
    return reference.towed_below(DEPRESSOR, CABLE_K, 100.0, 2.0, bending)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("bending", [0.1, 10.0])
@pytest.mark.parametrize("model", ["elastica", "hybrid"])
def test_clamped_depressor_tow(model, bending, tolerance):
    """A cable that bends holds the body by its layer of sqrt(EI/T), 16 and 160 mm, on any mesh."""
    centre, axis, top = expected_tow(bending)
    free = expected_tow(0.0)[1]
    assert np.abs(axis - free).max() > 1e-3
    simulated = cm.CableModel(towing(100.0, 2.0, model, tolerance, bending))
    found = simulated.bodies[0]
    assert found.position == pytest.approx(centre, abs=tolerance * 100.0)
    assert simulated.top_tension == pytest.approx(top, abs=10.0 * tolerance * top)
    if tolerance < 1e-3:
        assert found.direction == pytest.approx(axis, abs=0.05 * np.abs(axis - free).max())


def stiff_piece(drag, vessel, rigid):
    """A metre of bar between two cables that bend, towed: a body, or the same in cable elements.

    Mass, weight, length, inertia (with the added mass's) and, at rest, drag are the same.
    """
    length, diameter, mass, weight = 1.0, 0.12, 14.0, 40.0
    added = 1025.0 * np.pi / 4.0 * diameter**2
    bar = {
        **CABLE_K,
        "diameter": diameter,
        "mass": mass,
        "submerged_weight": weight,
        "axial_stiffness": 1e8,
        "bending_stiffness": 1e4,
        "drag_normal": drag,
        "drag_tangential": 0.01 * drag,
    }
    body = Body(
        mass * length, weight * length, 0.5 * length,
        rotary_inertia=(mass + added) * length**3 / 12.0, added_mass=added * length,
        drag_area=drag * diameter * length,
        drag_area_axial=0.01 * drag * np.pi * diameter * length,
    )  # fmt: skip
    middle = {"cable": {"type": "bar", "length": length, "model": "elastica", "elements": 4}}
    line = [
        {"cable": {"type": "C", "length": 12.0, "model": "elastica"}},
        {"body": asdict(body)} if rigid else middle,
        {"cable": {"type": "C", "length": 8.0, "model": "elastica"}},
    ]
    cable = {**CABLE_K, "bending_stiffness": 1.0}
    return cm.CableModel(
        load(line, cable, others={"bar": bar}, vessel={"velocity": vessel}, tolerance=1e-6)
    )


def centre_end_direction(model):
    """Places of the piece's middle and of the far end (2, 3), and the piece's direction (3,)."""
    if model.bodies:
        piece = model.bodies[0]
        return np.array([piece.position, model.tip_position]), piece.direction
    state = model.sample(12.5)
    return np.array([state.position[0], model.tip_position]), state.tangent[0]


def assert_like_stiff_piece(models):
    (places, direction), (other, along) = map(centre_end_direction, models)
    assert places == pytest.approx(other, abs=5e-5 * 21.0)
    assert direction == pytest.approx(along, abs=1e-3)
    assert models[0].top_tension == pytest.approx(models[1].top_tension, rel=5e-4)


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0])
def test_towed_body_is_a_very_stiff_piece_of_cable(speed):
    tow = [{"t": 0, "velocity": [speed, 0, 0]}]
    assert_like_stiff_piece([stiff_piece(1.0, tow, rigid) for rigid in (True, False)])


def test_body_turns_like_a_very_stiff_piece_of_cable():
    """Towed from rest. Without drag of its own: a bar, unlike a body, has some against turning."""
    ramp = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 10, "velocity": [1.0, 0, 0]}]
    models = [stiff_piece(0.0, ramp, rigid) for rigid in (True, False)]
    for time in (0.001, 2.0, 5.0, 10.0, 15.0, 20.0):
        for model in models:
            model.step_to(time)
        assert_like_stiff_piece(models)


def deployed(model="hybrid", tolerance=1e-4, turn=0.0, mirror=1.0, **settings):
    """Two bodies in line and one at the end, towed round a bend with a current across it."""
    turned = np.array(
        [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    )
    flip = np.diag([1.0, mirror, 1.0])

    def along(x, y):
        return (turned @ flip @ [x, y, 0.0]).tolist()

    sonde = {**asdict(SWUNG[0]), "added_mass": 4.0, "drag_area": 0.05, "drag_area_axial": 0.01}
    line = [
        {"cable": {"type": "C", "length": 10.0, "model": model}},
        {"body": {**sonde, "name": "upper"}},
        {"cable": {"type": "C", "length": 6.0, "model": model}},
        {"body": {**sonde, "name": "middle", "half_length": 0.0, "rotary_inertia": 0.0}},
        {"cable": {"type": "C", "length": 6.0, "model": model}},
        {"body": {**sonde, "name": "lowest"}},
    ]
    legs = [
        {"t": 0, "velocity": along(0.8, 0)},
        {"t": 4, "velocity": along(0.8, 0)},
        {"t": 10, "velocity": along(0.1, 0.8)},
    ]
    scene = load(
        line, CABLE_K, tolerance=tolerance, vessel={"velocity": legs}, **settings
    ).to_dict()
    scene["environment"]["current"] = along(0.1, 0.05)
    return cm.load_scene(scene), turned @ flip


@pytest.mark.parametrize("model", ["hybrid", "cable", "elastica"])
def test_rotation_and_mirror_image_change_nothing(model):
    runs = []
    for turn, mirror in ((0.0, 1.0), (2.1, 1.0), (0.0, -1.0)):
        scene, frame = deployed(model, turn=turn, mirror=mirror)
        simulated = cm.CableModel(scene)
        simulated.step_to(15.0)
        assert [body.name for body in simulated.bodies] == ["upper", "middle", "lowest"]
        runs.append([[body.position @ frame, body.direction @ frame] for body in simulated.bodies])
        assert not simulated.planar
    assert runs[1] == pytest.approx(np.array(runs[0]), abs=1e-9)
    assert runs[2] == pytest.approx(np.array(runs[0]), abs=1e-9)


@pytest.mark.parametrize("model", ["hybrid", "cable", "elastica"])
def test_plane_and_space_agree_and_a_plane_can_be_left(model):
    """The planar model, the same in space, and one that leaves the plane on the way."""
    scene = deployed(model)[0].to_dict()
    scene["environment"]["current"] = None
    scene["vessel"]["velocity"] = [{"t": 0, "velocity": [0.8, 0, 0]}]
    scene = cm.load_scene(scene)
    models = [cm.CableModel(scene), cm.CableModel(scene, planar=False)]
    assert [simulated.planar for simulated in models] == [True, False]
    for simulated in models:
        simulated.step_to(2.0, vessel_velocity=[0.5, 0.0, 0.0])
    assert models[0].planar
    for simulated in models:
        simulated.step_to(6.0, vessel_velocity=[0.5, 0.4, 0.0])
    assert not models[0].planar
    for one, other in zip(models[0].bodies, models[1].bodies, strict=True):
        assert one.position == pytest.approx(other.position, abs=1e-4 * 23.6)
        assert one.direction == pytest.approx(other.direction, abs=1e-3)


@pytest.mark.parametrize("model", ["hybrid", "cable", "elastica"])
def test_results_converge_with_the_tolerance(model):
    """Bodies and far end within tau L of a run a hundred times finer, at every tau."""

    def run(tolerance):
        simulated = cm.CableModel(deployed(model, tolerance)[0])
        out = []
        for time in (4.0, 8.0, 12.0, 30.0):
            simulated.step_to(time)
            out.append([body.position for body in simulated.bodies] + [simulated.tip_position])
        return np.array(out)

    exact = run(1e-6)
    for tolerance in (1e-2, 1e-3, 1e-4):
        assert np.abs(run(tolerance) - exact).max() < tolerance * 22.0


HARSH = {
    "slack": {"initial": {"straight": [1, 0, 0]}},
    "inverted": {"initial": {"straight": [1e-3, 0, 1]}},
    "sudden stop": {
        "vessel": {
            "velocity": [
                {"t": 0, "velocity": [3, 0, 0]},
                {"t": 1, "velocity": [3, 0, 0]},
                {"t": 1.001, "velocity": [0, 0, 0]},
            ]
        }
    },
    "heave": {
        "vessel": {"velocity": [{"t": k, "velocity": [0, 0, 2.0 * (-1.0) ** k]} for k in range(20)]}
    },
    "anchored": {"end": {"anchor": [15, 4, -10], "connection": {"clamped": [1, 0, 0]}}},
}


def harsh(settings, model, length=8.0):
    """Two bodies on pieces of cable of that length [m]."""
    body = {**asdict(SWUNG[0]), "added_mass": 4.0, "drag_area": 0.05, "drag_area_axial": 0.01}
    piece = {"cable": {"type": "C", "length": length, "model": model}}
    line = [piece, {"body": body}, piece, {"body": body}, *([piece] if "end" in settings else [])]
    return cm.CableModel(load(line, CABLE_K, tolerance=1e-3, **settings))


@pytest.mark.parametrize("model", ["hybrid", "cable", "elastica"])
def test_steps_of_a_line_that_is_slack_each_other_second(model):
    """Four for each radian, as above: the median of lengths that a rounding is between. How slack
    folds is chaos: from one to the next, steps differ by a tenth."""
    steps = []
    for length in 8.0 + 1e-8 * np.arange(-1, 2):
        simulated = harsh(HARSH["heave"], model, float(length))
        simulated.step_to(20.0)
        steps.append(simulated.statistics["steps"])
    assert np.median(steps) < 4 * 76 * 20


@pytest.mark.parametrize("model", ["hybrid", "cable", "elastica"])
@pytest.mark.parametrize("case", HARSH)
def test_no_energy_comes_from_nowhere(case, model):
    """Tension that vanishes, buckling, snaps: completed, the body as long as it is, no runaway.

    Every second the vessel's acceleration jumps, and while it is taut the line rings at 76 rad/s:
    four steps for each radian, if it were taut for all of the time.
    """
    settings = HARSH[case]
    simulated = harsh(settings, model)
    energy = [stored(simulated)]
    for time in np.arange(1.0, 20.1, 1.0):
        simulated.step_to(time)
        energy.append(stored(simulated))
    if case in ("slack", "inverted", "anchored"):  # the vessel does no work
        assert np.diff(energy).max() < 0.01 * np.ptp(energy) + 1e-3
    if case != "heave":
        assert simulated.statistics["steps"] < 4 * 76 * 20
    if "end" not in settings:
        end = simulated.sample(simulated.line_length).position[0]
        assert np.linalg.norm(simulated.tip_position - end) == pytest.approx(0.8, rel=1e-5)


@pytest.mark.parametrize("interval", [0.001, 0.1, 100.0])
def test_any_step_of_the_caller(interval):
    tolerance = 1e-3
    end = max(interval, 0.2) if interval < 1.0 else interval
    models = [cm.CableModel(deployed("hybrid", tolerance)[0]) for _ in range(2)]
    for k in range(round(end / interval)):
        models[0].step_to((k + 1) * interval)
    models[1].step_to(end)
    for one, other in zip(models[0].bodies, models[1].bodies, strict=True):
        assert one.position == pytest.approx(other.position, abs=tolerance * 22.0)


@pytest.mark.parametrize("model", ["hybrid", "cable", "elastica"])
def test_energy_balance_of_a_tow_closes(model):
    """Work of the vessel and loss to drag, bodies' shares in both, by Simpson's rule over 10 s.

    Without added mass, whose exchange with the water `test_energy` accounts for.
    """
    tolerance, interval = 1e-5, 0.05
    scene = deployed(model, tolerance)[0].to_dict()
    scene["environment"]["current"] = None
    scene["cable_types"]["C"]["added_mass"] = 0.0
    for item in scene["line"]:
        if "body" in item:
            item["body"]["added_mass"] = 0.0
    simulated = cm.CableModel(cm.load_scene(scene))
    start = stored(simulated)
    power = []
    for k in range(201):
        if k:
            simulated.step_to(k * interval)
        energy = simulated.energy()
        power.append([energy["vessel_power"], abs(energy["drag_power"])])
    weights = np.full(201, 2.0)
    weights[1::2], weights[0], weights[-1] = 4.0, 1.0, 1.0
    work, lost = interval / 3.0 * weights @ np.array(power)
    assert stored(simulated) - start == pytest.approx(work - lost, abs=2e-4 * work)


def test_snapshot_goes_on_bit_by_bit():
    model = cm.CableModel(deployed()[0])
    model.step_to(5.0)
    kept = model.snapshot()
    model.step_to(8.0)
    first = [body.position for body in model.bodies]
    model.restore(kept)
    model.step_to(8.0)
    assert np.array_equal(first, [body.position for body in model.bodies])


def test_reel_in_takes_bodies_of_finite_length_on_board():
    """Cable and bodies of the line pass the tow point in turn, and come out again."""
    scene = deployed()[0].to_dict()
    scene["payout"] = {
        "rate": [{"t": 0, "rate": 0}, {"t": 1, "rate": -1.0}],
        "drum": [{"cable": {"type": "C", "length": 5.0}}],
    }
    model = cm.CableModel(cm.load_scene(scene))
    model.step_to(40.0)
    assert model.winch == "shortest length"
    assert model.line_length == pytest.approx(0.01 * 22.0)
    assert len(model.bodies) == 1
    model.step(1.0, payout_rate=0.5)
    model.step(20.0, payout_rate=0.5)
    assert model.winch == "free"
    assert len(model.bodies) == 2
    assert model.line_length + model.drum_length == pytest.approx(27.0, abs=1e-10)


# What is refused --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "path", "words"),
    [
        ({"half_length": 4.0}, "line.1.body.half_length", "8 m long, the cable next to it 6 m"),
        ({"half_length": 1e-7}, "line.1.body.half_length", "too short against the line"),
        ({"half_length": -1.0}, "line.1.body.half_length", ""),
        ({"centre_offset": 1.5}, "line.1.body.centre_offset", ""),
    ],
)
def test_impossible_bodies_are_refused(change, path, words):
    scene = deployed()[0].to_dict()
    scene["line"][1]["body"].update(change)
    with pytest.raises(cm.SceneError) as caught:
        cm.load_scene(scene)
    assert path in str(caught.value)
    assert words in str(caught.value)


def test_what_this_engine_does_not_do_with_bodies_is_refused():
    scene = deployed()[0].to_dict()
    scene["line"][3]["body"]["rotary_inertia"] = 1.0
    with pytest.raises(cm.SceneError, match=r"line\.3\.body\.rotary_inertia"):
        cm.CableModel(cm.load_scene(scene))
