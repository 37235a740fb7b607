"""Equilibria on the sea floor: against a closed form, and by the balance of all forces."""

import numpy as np
import pytest
from scipy.optimize import brentq

import cablemodel as cm
from tests.verification.references.lays import ARMOURED, LIGHT, lay_angle
from tests.verification.references.lumped_lay import anchored_masses
from tests.verification.references.moored import moored_catenary
from tests.verification.scenes import CABLE_K

WEIGHT = CABLE_K["submerged_weight"]
BODY = {
    "mass": 6.0,
    "submerged_weight": 20.0,
    "added_mass": 2.0,
    "drag_area": 0.03,
    "drag_coefficient": 0.6,
}


def on_floor(line, floor, tolerance=1e-4, planar=None, cable=None, **settings):
    return cm.CableModel(
        cm.load_scene(
            {
                "environment": {"floor": floor},
                "cable_types": {"C": cable or CABLE_K},
                "line": line,
                "solver": {"tolerance": tolerance},
                **settings,
            }
        ),
        planar=planar,
    )


def cable(length, model="elastica"):
    return {"cable": {"type": "C", "length": length, "model": model}}


def weight(model):
    return WEIGHT * model.line_length + 20.0 * len(model.bodies)


# A mooring line -----------------------------------------------------------------------------------

MOORING = {
    "diameter": 0.1,
    "mass": 698.094 / 9.80665,
    "submerged_weight": 698.094,
    "axial_stiffness": 384.243e6,
}
POWER = {
    "diameter": 0.1, "mass": 23.0, "axial_stiffness": 150e6, "drag_normal": 1.2,
    "drag_tangential": 0.01,
}  # fmt: skip
ACROSS, RISE, LENGTH = 848.67, 250.0, 902.2


def moored(friction, tolerance, planar=None, angle=0.0):
    way = np.array([np.cos(angle), np.sin(angle), 0.0])
    return on_floor(
        [cable(LENGTH, "cable")],
        {"z": 0, "friction": friction},
        tolerance,
        planar,
        MOORING,
        end={"anchor": (ACROSS * way).tolist()},
        vessel={"position": [0, 0, RISE]},
    )


def exact(friction):
    return moored_catenary(ACROSS, RISE, LENGTH, 698.094, 384.243e6, friction)


def test_closed_form_is_that_of_the_tables():
    """Numbers computed with mpmath, independently of this project."""
    slippery, rough = exact(0.0), exact(1.0)
    assert slippery.horizontal == pytest.approx(736938.3235, abs=1e-3)
    assert slippery.tension(np.array([LENGTH])) == pytest.approx(911088.3569, abs=1e-3)
    assert slippery.laid == pytest.approx(134.785511, abs=1e-5)
    assert rough.horizontal == pytest.approx(737375.9183, abs=1e-3)
    assert rough.tension(np.array([0.0])) == pytest.approx(643424.8565, abs=1e-3)


@pytest.mark.parametrize(("planar", "angle"), [(None, 0.0), (False, 0.0), (None, 30.0)])
@pytest.mark.parametrize("friction", [0.0, 1.0])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_mooring_line(friction, tolerance, planar, angle):
    """Positions within tau L, tensions within 10 tau of the largest, all along the line."""
    model = moored(friction, tolerance, planar, np.deg2rad(angle))
    line, s = exact(friction), np.linspace(0.0, LENGTH, 201)
    state = model.sample(s)
    way = np.array([np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))])
    shape = np.stack([ACROSS - state.position[:, :2] @ way, state.position[:, 2]], axis=-1)
    tension = line.tension(LENGTH - s)
    assert shape == pytest.approx(line.position(LENGTH - s), abs=tolerance * LENGTH)
    assert state.tension == pytest.approx(tension, abs=10 * tolerance * tension[0])
    assert model.top_force[:2] @ way == pytest.approx(
        line.horizontal, abs=10 * tolerance * tension[0]
    )
    on_the_floor = 698.094 * LENGTH - np.sqrt(tension[0] ** 2 - line.horizontal**2)
    assert model.floor_force[2] == pytest.approx(on_the_floor, abs=10 * tolerance * tension[0])
    rubbed = line.horizontal - tension[-1]
    assert model.floor_force[:2] @ way == pytest.approx(rubbed, abs=10 * tolerance * tension[0])


@pytest.mark.parametrize("friction", [0.0, 1.0])
def test_length_on_the_floor_converges(friction):
    """A taut line leaves the floor as s^2 w / 2H: tau L of height is worth sqrt(2 tau L H / w)."""
    laid = exact(friction).laid
    for tolerance in (1e-3, 1e-4, 1e-5, 1e-6):
        model = moored(friction, tolerance)
        worth = np.sqrt(2.0 * tolerance * LENGTH * 737e3 / 698.094)
        assert model.floor_length == pytest.approx(laid, abs=worth)
        end = ACROSS - exact(friction).position(np.array([laid]))[0, 0]
        assert model.touchdown_position[0] == pytest.approx(end, abs=worth)


def test_three_dimensions_agree_with_two():
    for friction in (0.0, 1.0):
        flat = moored(friction, 1e-4, True)
        for full in (moored(friction, 1e-4, False), moored(friction, 1e-4, None, np.pi / 6)):
            assert full.top_tension == pytest.approx(flat.top_tension, rel=1e-9)
            assert full.floor_length == pytest.approx(flat.floor_length, rel=1e-9)


FRICTION_ENDS = {
    "light": (LIGHT, 500.0, 750.0, 800.0),
    "armoured": (ARMOURED, 100.0, 130.0, 300.0),
    "power": (POWER, 40.0, 60.0, 150.0),
}
"""Cable, depth [m], length that may hang and that lies [m]."""


def lying_to_its_anchor(kind, friction, off=0.0, angle=0.0, speeds=()):
    """Such a cable that lies to its anchor, from a vessel with these speeds away from it; and the
    closed form where the vessel is `off` from its place."""
    cable_type, depth, hangs, lies = FRICTION_ENDS[kind]
    weight, _ = lay_angle(cable_type, 1.0)
    length, across = hangs + lies, 0.9 * np.sqrt(hangs**2 - depth**2) + lies
    way = np.array([np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle)), 0.0])
    vessel = {"position": [0, 0, depth]}
    if speeds:
        vessel["velocity"] = [{"t": t, "velocity": (-v * way).tolist()} for t, v in speeds]
    model = on_floor(
        [cable(length, "cable")],
        {"z": 0, "friction": friction},
        1e-3,
        None,
        {**cable_type, "submerged_weight": weight},
        end={"anchor": (across * way).tolist()},
        vessel=vessel,
    )
    stiffness = cable_type["axial_stiffness"]
    return model, moored_catenary(across + off, depth, length, weight, stiffness, friction)


@pytest.mark.parametrize("angle", [0.0, 30.0])
@pytest.mark.parametrize("friction", [0.3, 0.5])
@pytest.mark.parametrize("kind", FRICTION_ENDS)
def test_an_anchor_does_not_feel_what_friction_has_taken_up(kind, friction, angle):
    """Cable that hardly stretches: its friction takes hold at once, as Coulomb's does, not over
    0.02 tau L. At the start, and as long as nothing moves."""
    model, line = lying_to_its_anchor(kind, friction, angle=angle)
    s = np.linspace(0.0, model.line_length, 201)
    tension = line.tension(model.line_length - s)
    assert tension[-1] < 0.1 * tension[0]
    promised = 10.0 * 1e-3 * tension[0]
    found = model.sample(s).tension
    assert found[-1] == pytest.approx(tension[-1], abs=promised)
    # An element that is held in part has a tension of its own.
    assert found == pytest.approx(tension, abs=1.5 * promised)
    model.step_to(30.0)
    assert model.sample(s).tension == pytest.approx(found, abs=0.15 * promised)


SPEEDS = [(0.0, 0.0), (40.0, 1.0 / 40.0), (80.0, 0.0), (200.0, 0.0)]
"""Of a vessel that moves off by 1 m: time [s], speed [m/s]."""


@pytest.mark.parametrize("friction", [0.3, 1.0])
@pytest.mark.parametrize("kind", ["armoured", "power"])
def test_an_anchor_hardly_feels_a_vessel_that_moves_off(kind, friction):
    """What slips ends where Coulomb's friction has taken up the change of tension. Friction that
    steps worked loose, or that crept on, pulled the anchor with 20 promises."""
    model, line = moved_off(kind, friction)
    s = np.linspace(0.0, model.line_length, 201)
    tension = line.tension(model.line_length - s)
    found = model.sample(s).tension
    promised = 10.0 * 1e-3 * tension[0]
    assert found[0] == pytest.approx(tension[0], abs=0.2 * promised)
    assert found == pytest.approx(tension, abs=9.0 * promised)
    assert found[-1] == pytest.approx(tension[-1], abs=8.5 * promised)


def moves_off(kind):
    """By how much a vessel moves off: .04 of how far its cable reaches that hangs [m]."""
    _, depth, hangs, _ = FRICTION_ENDS[kind]
    return 0.04 * 0.9 * np.sqrt(hangs**2 - depth**2)


def moved_off(kind, friction, more=0.0):
    """Such a cable after its vessel has moved off, by a share more, and the closed form there."""
    off = (1.0 + more) * moves_off(kind)
    speeds = [(t, off * speed) for t, speed in SPEEDS]
    model, line = lying_to_its_anchor(kind, friction, off, speeds=speeds)
    model.step_to(200.0)
    return model, line


@pytest.mark.parametrize("friction", [0.3, 1.0])
def test_rounding_works_no_friction_loose(friction):
    """What Newton's method left in tensions moved cable by a bristle: what was left of friction
    hung on the last digits, by 10 promises."""
    model, _ = moved_off("light", friction)
    s = np.linspace(0.0, model.line_length, 201)
    expected = model.sample(s).tension
    for more in (1e-12, -1e-12, 1e-10, -1e-8, 1e-6, 1e-5, -1e-4):
        found = moved_off("light", friction, more)[0].sample(s).tension
        assert found == pytest.approx(expected, abs=0.3 * 10.0 * 1e-3 * expected.max())


@pytest.mark.parametrize("friction", [0.3, 1.0])
def test_what_lies_remembers_higher_tensions_on_the_way(friction):
    """Eight hundred metres that lie, beside masses with Coulomb's friction: the closed form of the
    last place is 8 promises from them."""
    cable_type, depth, hangs, lies = FRICTION_ENDS["light"]
    off = moves_off("light")
    model, _ = moved_off("light", friction)
    _, line = lying_to_its_anchor("light", friction)

    def motion(t):
        away = off * np.interp(t, *np.transpose(SPEEDS))
        return np.stack([away, np.zeros_like(away)], axis=-1)

    kind = {
        **cable_type,
        "submerged_weight": lay_angle(cable_type, 1.0)[0],
        "axial_damping": 2e-4 * cable_type["axial_stiffness"],
    }
    masses, length = 200, hangs + lies
    expected = anchored_masses(
        line, length, masses, motion, kind=kind, depth=depth, duration=200.0, interval=200.0
    )[-1]
    found = model.sample(length * (1.0 - (np.arange(masses) + 0.5) / masses)).tension
    promised = 10.0 * 1e-3 * expected.max()
    assert found == pytest.approx(expected, abs=4.0 * promised)


CHAIN = {
    "diameter": 0.036, "mass": 7.9, "submerged_weight": 67.0, "axial_stiffness": 32e6,
    "axial_damping": 6400.0, "drag_normal": 1.2, "drag_tangential": 0.01,
}  # fmt: skip
WIRE_ROPE = {
    "diameter": 0.05, "mass": 10.0, "submerged_weight": 78.0, "axial_stiffness": 90e6,
    "axial_damping": 18000.0, "drag_normal": 1.2, "drag_tangential": 0.01,
}  # fmt: skip
IN_HEAVE = {
    "chain": (CHAIN, 50.0, 80.0, 85.0, 0.6),
    "long chain": (CHAIN, 80.0, 150.0, 200.0, 0.9),
    "wire rope": (WIRE_ROPE, 100.0, 160.0, 240.0, 0.4),
}
"""Cable, depth [m], length that may hang and that lies [m], friction."""


@pytest.mark.parametrize("kind", IN_HEAVE)
def test_an_anchor_feels_what_friction_leaves_of_heave(kind):
    """A vessel that drifts off and heaves, beside masses with Coulomb's friction: tension works its
    way to the anchor bit by bit, and stays there."""
    cable_type, depth, hangs, lies, friction = IN_HEAVE[kind]
    length, across = hangs + lies, 0.92 * np.sqrt(hangs**2 - depth**2) + lies
    off = 0.02 * np.sqrt(hangs**2 - depth**2)

    def motion(t):
        drifts = np.where(t < 30.0, off / 15.0 * np.sin(np.pi * t / 30.0) ** 2, 0.0)
        heaves = -0.6 * np.pi / 4.0 * np.sin(np.pi * t / 4.0) * np.minimum(1.0, t / 20.0)
        return np.stack([drifts, heaves], axis=-1)

    line = moored_catenary(
        across,
        depth,
        length,
        cable_type["submerged_weight"],
        cable_type["axial_stiffness"],
        friction,
    )
    expected = anchored_masses(
        line, length, 200, motion, kind=cable_type, depth=depth, duration=60.0, interval=0.2
    )[:, [0, -1]]
    t = np.linspace(0.0, 60.0, 601)
    speeds = [
        {"t": float(at), "velocity": [-drift, 0.0, heave]}
        for at, (drift, heave) in zip(t, motion(t).tolist(), strict=True)
    ]
    model = on_floor(
        [cable(length, "cable")],
        {"z": 0, "friction": friction},
        1e-3,
        None,
        cable_type,
        end={"anchor": [across, 0.0, 0.0]},
        vessel={"position": [0, 0, depth], "velocity": speeds, "interpolation": "cubic"},
    )
    found = []
    for at in 0.2 * np.arange(1, 301):
        model.step_to(at)
        found.append(model.sample([length, 0.0]).tension)
    promised = 10.0 * 1e-3 * expected.max()
    wrong = np.abs(np.array(found) - expected) / promised
    assert np.all(np.sqrt((wrong**2).mean(axis=0)) < [0.9, 0.6])
    assert wrong[:, 0].max() < 2.5


# A cable let down to the floor --------------------------------------------------------------------

LINES = {
    "cable": [cable(30.0)],
    "point body at the end": [cable(30.0), {"body": BODY}],
    "point body on the floor": [cable(25.0), {"body": BODY}, cable(5.0)],
    "body of finite length on the floor": [
        cable(30.0),
        {"body": {**BODY, "half_length": 0.5, "rotary_inertia": 1.0}},
        cable(5.0),
    ],
    "body that hangs, and cable that lies": [cable(15.0), {"body": BODY}, cable(10.0)],
    "body that lies at the touchdown": [cable(20.5), {"body": BODY}, cable(5.0)],
    "point body far behind the touchdown": [cable(30.0), {"body": BODY}, cable(5.0)],
    "body of finite length at the end": [
        cable(30.0),
        {"body": {**BODY, "half_length": 0.5, "rotary_inertia": 1.0}},
    ],
}


def balanced(model, tolerance=1e-6):
    """What the vessel and the floor bear is the weight, along every axis [N]."""
    left = model.floor_force - model.top_force - [0.0, 0.0, weight(model)]
    assert left == pytest.approx(np.zeros(3), abs=tolerance)


@pytest.mark.parametrize("planar", [None, False])
@pytest.mark.parametrize("line", LINES)
def test_line_hanging_to_the_floor(line, planar):
    model = on_floor(LINES[line], {"z": -20}, planar=planar)
    accuracy = 1e-4 * model.line_length
    balanced(model)
    hangs = 15.0 if "hangs" in line else 20.0
    if "at the touchdown" not in line:
        # Frictionless floor, no horizontal force: the vessel bears the cable down to the floor.
        borne = WEIGHT * 20.0 + (20.0 if hangs == 15.0 else 0.0)
        assert model.top_tension == pytest.approx(borne, abs=10 * 1e-4 * borne)
    heights = model.sample(np.linspace(0.0, model.line_length, 801)).position[:, 2]
    assert heights.min() >= -20.0 - accuracy


RIGID_BODY = {"body": {**BODY, "half_length": 0.5, "rotary_inertia": 1.0}}


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize(
    ("bending", "end"),
    [(0.0, []), (0.01, []), (0.1, []), (1.0, []), (10.0, []), (10.0, [RIGID_BODY])],
)
def test_slack_that_lies_has_a_start(bending, end, tolerance):
    """Whatever bending stiffness: tension of what hangs, no element folded in line."""
    kind = {**CABLE_K, "bending_stiffness": bending}
    model = on_floor([cable(35.0), *end], {"z": -20, "friction": 0.3}, tolerance, None, kind)
    balanced(model)
    assert model.top_tension == pytest.approx(20.0 * WEIGHT, rel=10 * tolerance)
    state = model.sample(np.linspace(0.0, 35.0, 3501))
    steps = np.linalg.norm(np.diff(state.position, axis=0), axis=1)
    assert steps == pytest.approx(0.01, rel=0.05)


# Floors that are not level ------------------------------------------------------------------------


def anchored(floor, tolerance=1e-4, planar=None, length=60.0, across=40.0):
    foot = cm.load_scene(
        {
            "environment": {"floor": floor},
            "cable_types": {"C": CABLE_K},
            "line": [cable(1.0)],
            "vessel": {"position": [0, 0, 100]},
        }
    ).environment.floor.height(0.0, 0.0)
    return on_floor(
        [cable(length)],
        floor,
        tolerance,
        planar,
        end={"anchor": [0, 0, foot]},
        vessel={"position": [across, 0, 0]},
    )


@pytest.mark.parametrize("across", [0.0, 0.05])
def test_plane_as_a_table_is_the_plane(across):
    """Bicubic interpolation reproduces a plane on an uneven grid."""
    xs, ys = (-20, 0, 10, 30, 70), (-30, -10, 15, 40)
    plane = anchored({"z": -30, "slope": [0.15, across]})
    rows = [{"x": x, "y": y, "z": -30 + 0.15 * x + across * y} for x in xs for y in ys]
    table = anchored({"depth_table": rows})
    assert table.top_force == pytest.approx(plane.top_force, abs=1e-6)
    assert table.floor_force == pytest.approx(plane.floor_force, abs=1e-6)
    s = np.linspace(0.0, 60.0, 121)
    assert table.sample(s).position == pytest.approx(plane.sample(s).position, abs=1e-7)


@pytest.mark.parametrize("slope", [[0.1, 0.0], [0.1, 0.05], [0.0, -0.3]])
def test_slippery_slope_pushes_along_its_normal(slope):
    """A free end on a frictionless slope: the vessel holds what the normal does not, exactly."""
    model = on_floor([cable(30.0)], {"z": -20, "slope": slope})
    normal = np.array([-slope[0], -slope[1], 1.0]) / np.hypot(1.0, np.hypot(*slope))
    push = model.floor_force @ normal
    assert push > 10.0
    assert model.floor_force == pytest.approx(push * normal, abs=1e-6)
    balanced(model)
    # All that lies slides down the line of steepest slope: tension grows by w sin(angle) up it.
    laid = model.sample(np.linspace(25.0, 30.0, 9))
    steep = WEIGHT * np.hypot(*slope) / np.hypot(1.0, np.hypot(*slope))
    assert laid.on_floor.all()
    assert laid.tension == pytest.approx(steep * (30.0 - laid.s), abs=10 * 1e-4 * 50.0)


def bumpy(tops, radius=6.0, height=3.0):
    xs = np.arange(-20.0, 121.0, 1.0)
    heights = -30.0 + sum(height * np.exp(-(((xs - top) / radius) ** 2)) for top in tops)
    rows = [{"x": float(x), "z": float(z)} for x, z in zip(xs, heights, strict=True)]
    return {"depth_table": rows}


def gaps(model, floor, count=2001):
    """Vertical gaps between sampled cable and a floor that is smooth through the table [m]."""
    from scipy.interpolate import PchipInterpolator

    rows = floor["depth_table"]
    surface = PchipInterpolator([row["x"] for row in rows], [row["z"] for row in rows])
    place = model.sample(np.linspace(0.0, model.line_length, count)).position
    return place[:, 2] - surface(place[:, 0])


def deepest(kind, tolerance):
    """Deepest penetration in units of tau L."""
    if kind == "bump":
        floor, length = bumpy([12.0]), 55.0
        model = anchored(floor, tolerance, length=length)
    elif kind == "humps":
        floor, length = bumpy([20.0, 45.0], radius=5.0, height=4.0), 91.0
        model = anchored(floor, tolerance, length=length, across=80.0)
    else:
        model, length = on_floor([cable(30.0)], {"z": -20}, tolerance), 30.0
        floor = {"depth_table": [{"x": -100.0, "z": -20.0}, {"x": 100.0, "z": -20.0}]}
    return -gaps(model, floor).min() / (tolerance * length)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("kind", ["bump", "humps", "bend"])
def test_no_penetration_at_rest(kind, tolerance):
    """A twentieth of tau L, though the humps bear up to 63 times the weight of the cable."""
    assert deepest(kind, tolerance) <= 0.05


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_forces_on_a_bump_are_in_balance(tolerance):
    model = anchored(bumpy([12.0]), tolerance, length=55.0)
    left = model.floor_force[2] - model.top_force[2] - WEIGHT * 55.0
    # The anchor bears the rest: the vertical component of the tension there.
    end = model.sample([55.0])
    assert left == pytest.approx(end.tension[0] * -end.tangent[0, 2], abs=10 * tolerance * 96.0)


def test_cable_over_two_humps():
    """Touches both tops, and hangs free in between: reactions apart, balance of all forces."""
    floor = bumpy([20.0, 45.0], radius=5.0, height=4.0)
    model = anchored(floor, 1e-4, length=91.0, across=80.0)
    state = model.sample(np.linspace(0.0, 91.0, 1821))
    for top in (20.0, 45.0):
        assert state.on_floor[np.abs(state.position[:, 0] - top) < 3.0].any()
    between = (state.position[:, 0] > 28.0) & (state.position[:, 0] < 37.0)
    assert not state.on_floor[between].any()
    end = state.tension[-1] * -state.tangent[-1]
    # With no friction nothing but the tops' slopes pushes along x.
    left = model.floor_force - model.top_force - [0.0, 0.0, WEIGHT * 91.0]
    assert left[[0, 2]] == pytest.approx(end[[0, 2]], abs=10 * 1e-4 * state.tension.max())
    assert model.touchdown_position[0] == pytest.approx(45.0, abs=3.0)


def test_a_rod_that_leans_on_its_end_stands_where_it_is():
    """A light stiff rod with a heavy body near its end, which bears thousands of the rod's weight.

    Friction was as soft as for that weight: the end slipped by 12 tau L before it held.
    """
    tolerance, length, floor = 5e-4, 8.7, -5.5
    rod = {
        "diameter": 0.009,
        "mass": 0.064,
        "submerged_weight": 2e-4,
        "axial_stiffness": 1.8e8,
        "bending_stiffness": 280.0,
        "drag_normal": 1.4,
    }

    def start(tolerance):
        body = {"mass": 4.0, "submerged_weight": 20.0}
        line = [cable(8.0), {"body": body}, cable(length - 8.0)]
        return on_floor(line, {"z": floor, "friction": 0.74}, tolerance, cable=rod)

    model = start(tolerance)
    assert model.floor_force[2] > 1000.0 * rod["submerged_weight"] * length
    assert -0.1 * tolerance * length < model.tip_position[2] - floor < 0.0
    finer = start(tolerance / 4.0)
    assert np.linalg.norm(model.tip_position - finer.tip_position) < tolerance * length


# Slack on the floor, and lines that a winch draws over it -----------------------------------------


@pytest.mark.parametrize("bending", [0.0, 0.1])
@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("initial", ["static", {"straight": [-1, 0, 0]}])
def test_a_line_that_lies_at_rest_without_tension_takes_easy_steps(bending, friction, initial):
    """All its tensions are rounding, which nothing may ask to settle; then it is picked up."""
    kind = {**CABLE_K, "bending_stiffness": bending}
    floor = {"z": -70, "friction": friction}
    at = {"vessel": {"position": [0, 0, -70]}, "initial": initial}
    model = on_floor([cable(50.0, "hybrid")], floor, 1e-3, None, kind, **at)
    first = model.sample(np.linspace(0.0, 50.0, 51)).position
    for step in (1e-3, 1.0, 10.0):
        model.step(step)
    statistics = model.statistics
    assert statistics["rejected"] == 0
    assert statistics["steps"] < 10
    assert abs(model.top_tension) < 1e-6
    later = model.sample(np.linspace(0.0, 50.0, 51)).position
    assert np.linalg.norm(later - first, axis=1).max() < 1e-3
    model.step(5.0, vessel_velocity=(0.0, 0.0, 0.4))
    model.step(60.0, vessel_velocity=(0.0, 0.0, 0.0))
    model.step(600.0)
    hangs = model.vessel_position[2] + 70.0
    lies = hangs * WEIGHT + (friction * WEIGHT * model.floor_length if friction else 0.0)
    assert hangs * WEIGHT * 0.99 < model.top_tension < 1.01 * lies


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("slope", [[0, 0], [0.1, 0.05]])
@pytest.mark.parametrize("current", [None, [0.2, 0.1, 0]])
def test_a_vessel_at_rest_reels_in_what_lies(slope, current):
    """What comes along itself feels the friction of that: a catenary with that pull at its foot."""
    friction, length, depth = 0.4, 120.0, 50.0
    kind = {**CABLE_K, "drag_tangential": 0.0, "bending_stiffness": 0.0}
    floor = {"z": -depth, "slope": slope, "friction": friction}
    winch = {"payout": {"rate": -0.3, "drum": [cable(100.0)]}}
    model = cm.CableModel(
        cm.load_scene(
            {
                "environment": {"floor": floor, "current": current},
                "cable_types": {"C": kind},
                "line": [cable(length)],
                "solver": {"tolerance": 1e-4},
                **winch,
            }
        )
    )
    assert 0.0 < model.floor_length < length
    before = model.top_tension
    if current is None and not any(slope):
        hangs = brentq(lambda s: s**2 - depth**2 - 2.0 * depth * friction * (length - s), 0.0, 1e3)
        pull = friction * WEIGHT * (length - hangs)
        assert before == pytest.approx(pull + WEIGHT * depth, rel=1e-3)
    # It goes on as it started: what was found is the steady motion.
    model.step(0.5)
    assert model.top_tension == pytest.approx(before, rel=0.01)


def to_anchor(across, above, model):
    """50 m of line from the floor to an anchor above it."""
    at = {"vessel": {"position": [0, 0, -70]}, "end": {"anchor": [across, 0, -70 + above]}}
    return on_floor([cable(50.0, model)], {"z": -70, "friction": 0.3}, 1e-3, **at)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("above", [0.0, 1e-3, 10.0])
def test_a_taut_line_from_the_floor_to_an_anchor_as_high_or_higher(above):
    model = to_anchor(50.1, above, "hybrid")
    stretched = (np.hypot(50.1, above) / 50.0 - 1.0) * CABLE_K["axial_stiffness"]
    assert model.top_tension == pytest.approx(stretched, rel=1e-2)
    model.step(1.0)
    # Friction lets go of what leaves the floor, and the line rings by .7 promises.
    assert model.statistics["steps"] + model.statistics["rejected"] <= 12
    assert model.top_tension == pytest.approx(stretched, rel=1e-2)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("across", [0.0, 45.0])
def test_a_slack_line_to_an_anchor_as_high_as_the_tow_point_is_refused_in_words(across):
    with pytest.raises(cm.StaticsError, match="longer than straight down and along the floor"):
        to_anchor(across, 0.0, "hybrid")


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("across", [20.0, 30.0])
def test_a_line_that_hangs_from_its_anchor_down_to_the_floor(across):
    model = to_anchor(across, 30.0, "hybrid")
    assert model.tension_max == pytest.approx(30.0 * WEIGHT, rel=0.5)
    before = model.tip_position
    model.step(5.0)
    assert model.tip_position == pytest.approx(before, abs=1e-9)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("slack", [0.001, 0.01, 0.1, 0.3])
def test_a_line_with_a_little_slack_hangs_and_lies(slack):
    """The corner at its touchdown is sharp: what is slack is less than chords would cut off it."""
    kind = {**CABLE_K, "bending_stiffness": 0.0}
    floor, depth, across = {"z": -5, "friction": 0.3}, 5.0, 200.0
    at = {"end": {"anchor": [across, 0, -depth]}}
    model = on_floor([cable(depth + across + slack)], floor, 1e-3, None, kind, **at)
    assert model.top_tension == pytest.approx(depth * WEIGHT, rel=0.15)
    assert model.tension_min > -0.3 * WEIGHT * across
