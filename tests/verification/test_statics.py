"""Equilibria against closed forms and static ODEs.

Positions of a cubic element converge like h^4, so a fixed number of elements has an error that is
known in advance; runs at a tolerance tau must be within tau L.
"""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification.references import catenary, elastica, static_cable
from tests.verification.scenes import IDEAL, cantilever, scene


def plane(vector):
    """x and z."""
    return np.asarray(vector)[[0, 2]]


def observed_orders(errors):
    """log2 of the ratios of successive errors."""
    errors = np.asarray(errors)
    return np.log2(errors[:-1] / errors[1:])


# Elastic catenary -------------------------------------------------------------------------------

CATENARIES = [(300.0, 1e7), (300.0, 1e5), (600.0, 1e8)]


def hanging_between(rise, axial_stiffness, **settings):
    cable = {**IDEAL, "submerged_weight": 10.0, "axial_stiffness": axial_stiffness}
    return cm.CableModel(
        scene(
            1000.0,
            cable,
            model="cable",
            end={"anchor": [0.0, 0.0, 0.0]},
            vessel={"position": [800.0, 0.0, rise]},
            **settings,
        )
    )


@pytest.mark.parametrize(("rise", "axial_stiffness"), CATENARIES)
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5, 1e-6])
def test_elastic_catenary(rise, axial_stiffness, tolerance):
    exact = catenary.elastic_catenary(800.0, rise, 1000.0, 10.0, axial_stiffness)
    model = hanging_between(rise, axial_stiffness, tolerance=tolerance)
    top = exact.tension(1000.0)
    s = np.linspace(0.0, 1000.0, 41)
    state = model.sample(s)
    shape = np.array([exact.position(1000.0 - value) for value in s])
    tension = np.array([exact.tension(1000.0 - value) for value in s])
    assert state.position[:, [0, 2]] == pytest.approx(shape, abs=tolerance * 1000.0)
    assert abs(model.top_force[0]) == pytest.approx(exact.horizontal, abs=10 * tolerance * top)
    assert model.top_tension == pytest.approx(top, abs=10 * tolerance * top)
    assert state.tension == pytest.approx(tension, abs=10 * tolerance * top)


@pytest.mark.parametrize(("rise", "axial_stiffness"), CATENARIES)
def test_elastic_catenary_to_eight_digits(rise, axial_stiffness):
    exact = catenary.elastic_catenary(800.0, rise, 1000.0, 10.0, axial_stiffness)
    model = hanging_between(rise, axial_stiffness, elements=128)
    assert abs(model.top_force[0]) == pytest.approx(exact.horizontal, rel=1e-8)
    assert model.top_tension == pytest.approx(exact.tension(1000.0), rel=1e-8)
    assert plane(model.sample([500.0]).position[0]) == pytest.approx(
        exact.position(500.0), abs=1e-5
    )


# Cantilevers and the clamped end ----------------------------------------------------------------


@pytest.mark.parametrize("load", [1.0, 10.0])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_cantilever_with_a_tip_load(load, tolerance):
    """Elliptic integrals; the stretch P/EA = 1e-8 does not show."""
    x, y, angle = elastica.cantilever_tip_load(load)
    model = cantilever(load=load, axial_stiffness=load * 1e8, tolerance=tolerance)
    assert plane(model.tip_position) == pytest.approx((x, -y), abs=tolerance)
    tangent = plane(model.sample([1.0]).tangent[0])
    assert np.arctan2(-tangent[1], tangent[0]) == pytest.approx(angle, abs=10 * tolerance)
    assert abs(model.top_moment[1]) == pytest.approx(load * x, abs=10 * tolerance * load)


@pytest.mark.parametrize("load", [1.0, 10.0])
def test_cantilever_converges_with_the_fourth_power_of_the_element(load):
    exact = elastica.extensible_rod(1.0, 1.0, 1e6, 0.0, end_force=(0.0, -load))
    errors = [
        np.linalg.norm(plane(cantilever(load=load, elements=n).tip_position) - exact.tip)
        for n in (8, 16, 32)
    ]
    assert observed_orders(errors) == pytest.approx(4.0, abs=0.4)
    assert errors[-1] < 5e-9 * load


@pytest.mark.parametrize("weight", [1.0, 100.0])
def test_cantilever_under_its_own_weight(weight):
    """For w L^3/EI = 100 a second, looped equilibrium exists: this one must be found."""
    exact = elastica.extensible_rod(1.0, 1.0, 1e6, 0.0, weight=weight)
    errors = [
        np.linalg.norm(plane(cantilever(weight=weight, elements=n).tip_position) - exact.tip)
        for n in (32, 64, 128)
    ]
    assert observed_orders(errors) == pytest.approx(4.0, abs=0.4)
    assert errors[-1] < 1e-8
    drop = {1.0: 0.123471402, 100.0: 0.937523935}[weight]
    stiff = cantilever(weight=weight, elements=64, axial_stiffness=1e8 * weight)
    assert -stiff.tip_position[2] == pytest.approx(drop, abs=2e-7)


@pytest.mark.parametrize("weight", [1.0, 100.0])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_cantilever_under_its_own_weight_at_a_tolerance(weight, tolerance):
    exact = elastica.extensible_rod(1.0, 1.0, 1e8, 0.0, weight=weight)
    model = cantilever(weight=weight, axial_stiffness=1e8, tolerance=tolerance)
    assert plane(model.tip_position) == pytest.approx(exact.tip, abs=tolerance)


def test_clamped_end_under_tension():
    """Curvature (2/lambda) sin(a/2), offset 2 lambda sin(a/2), lambda = sqrt(EI/T) = 0.1 m."""
    angle = np.radians(30.0)
    errors = []
    for elements in (40, 80, 160):
        model = cantilever(
            2.0,
            axial_stiffness=1e9,
            load=100.0,
            elements=elements,
            vessel={"connection": {"clamped": [np.sin(angle), 0.0, -np.cos(angle)]}},
        )
        offset = elastica.clamped_end_offset(1.0, 100.0, angle)
        errors.append(abs(model.tip_position[0] - offset))
    assert observed_orders(errors) == pytest.approx(4.0, abs=0.4)
    assert errors[-1] < 1e-7
    curvature = elastica.clamped_end_curvature(1.0, 100.0, angle)
    assert np.linalg.norm(model.top_moment) == pytest.approx(curvature, rel=1e-6)
    # Second derivatives of cubics: h^2, here (h/lambda)^2 / 12 and less.
    assert model.sample([0.0]).curvature[0] == pytest.approx(curvature, rel=2e-3)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_clamped_end_at_a_tolerance(tolerance):
    """The mesh resolves the layer by itself. A moment has half the order of a position."""
    angle = np.radians(30.0)
    model = cantilever(
        20.0,
        axial_stiffness=1e9,
        load=100.0,
        tolerance=tolerance,
        vessel={"connection": {"clamped": [np.sin(angle), 0.0, -np.cos(angle)]}},
    )
    curvature = elastica.clamped_end_curvature(1.0, 100.0, angle)
    assert np.linalg.norm(model.top_moment) == pytest.approx(curvature, rel=0.5 * tolerance**0.5)
    offset = elastica.clamped_end_offset(1.0, 100.0, angle)
    assert model.tip_position[0] == pytest.approx(offset, abs=20.0 * tolerance)


def test_clamped_anchor_turns_the_far_end_as_the_near_one():
    """A weightless cable pulled straight between two clamps at opposite angles is symmetric."""
    slope = np.radians(20.0)
    stretched = 2.0 * (1.0 + 50.0 / 1e6)
    model = cantilever(
        2.0,
        elements=64,
        end={
            "anchor": [stretched, 0.0, 0.0],
            "connection": {"clamped": [np.cos(slope), 0.0, -np.sin(slope)]},
        },
        vessel={"connection": {"clamped": [np.cos(slope), 0.0, np.sin(slope)]}},
    )
    state = model.sample([0.0, 0.5, 1.5, 2.0])
    assert state.tangent[0] == pytest.approx([np.cos(slope), 0.0, np.sin(slope)], abs=1e-12)
    assert state.tangent[3] == pytest.approx([np.cos(slope), 0.0, -np.sin(slope)], abs=1e-12)
    assert state.position[1, 2] == pytest.approx(state.position[2, 2], abs=1e-9)
    assert state.position[1, 2] > 0.0


# Towing and currents ----------------------------------------------------------------------------

TOW_CABLE = {
    "diameter": 0.025,
    "mass": 1.3,
    "submerged_weight": 8.0,
    "axial_stiffness": 5e6,
    "bending_stiffness": 0.0,
    "drag_normal": 1.2,
    "drag_tangential": 0.02,
    "added_mass": 1.0,
}
DEPRESSOR = {
    "mass": 700.0,
    "submerged_weight": 5000.0,
    "drag_area": 0.5,
    "drag_coefficient": 0.8,
    "drag_area_axial": 0.5,
    "drag_coefficient_axial": 0.1,
}


def reference_cable(length, strain=None):
    return static_cable.CableProperties(
        length,
        TOW_CABLE["submerged_weight"],
        strain or static_cable.linear_strain(TOW_CABLE["axial_stiffness"]),
        TOW_CABLE["diameter"],
        TOW_CABLE["drag_normal"],
        TOW_CABLE["drag_tangential"],
    )


@pytest.mark.parametrize("speed", [1.0, 2.0, 3.0])
def test_depressor_tow(speed):
    """Layback, depth, top tension and angle to 1e-6 of length, tension and a radian."""
    exact = static_cable.steady_shape(
        reference_cable(1000.0),
        static_cable.EndBody(5000.0, 0.4, 0.05),
        lambda z: np.array([-speed, 0.0, 0.0]),
    )
    model = cm.CableModel(
        scene(
            1000.0,
            TOW_CABLE,
            model="cable",
            elements=400,
            body=DEPRESSOR,
            vessel={"velocity": [{"t": 0, "velocity": [speed, 0.0, 0.0]}]},
        )
    )
    assert model.tip_position == pytest.approx(exact.end_position, abs=1e-6 * 1000.0)
    assert model.top_tension == pytest.approx(exact.top_tension, rel=1e-6)
    force = model.top_force
    assert np.arctan2(-force[2], np.hypot(*force[:2])) == pytest.approx(exact.top_angle, abs=1e-6)
    s = np.linspace(0.0, 1000.0, 51)
    assert model.sample(s).position == pytest.approx(exact.position(s), abs=1e-3)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_depressor_tow_at_a_tolerance(speed, tolerance):
    exact = static_cable.steady_shape(
        reference_cable(1000.0),
        static_cable.EndBody(5000.0, 0.4, 0.05),
        lambda z: np.array([-speed, 0.0, 0.0]),
    )
    model = cm.CableModel(
        scene(
            1000.0,
            TOW_CABLE,
            tolerance=tolerance,
            body=DEPRESSOR,
            vessel={"velocity": [{"t": 0, "velocity": [speed, 0.0, 0.0]}]},
        )
    )
    assert model.tip_position == pytest.approx(exact.end_position, abs=tolerance * 1000.0)
    assert model.top_tension == pytest.approx(exact.top_tension, rel=10 * tolerance)


SHEARED = [
    {"z": 0.0, "velocity": [1.5, 0.3, 0.0]},
    {"z": -120.0, "velocity": [0.9, -0.4, 0.0]},
    {"z": -300.0, "velocity": [-0.3, 0.2, 0.0]},
]


def sheared(z):
    depths = [-300.0, -120.0, 0.0]
    return np.array(
        [np.interp(z, depths, [-0.3, 0.9, 1.5]), np.interp(z, depths, [0.2, -0.4, 0.3]), 0.0]
    )


def test_current_that_turns_with_depth():
    """A three-dimensional shape; the profile has kinks, which elements do not see: h^2 there."""
    exact = static_cable.steady_shape(
        reference_cable(400.0), static_cable.EndBody(5000.0, 0.4, 0.05), sheared
    )
    model = cm.CableModel(
        scene(
            400.0,
            TOW_CABLE,
            model="cable",
            elements=128,
            body=DEPRESSOR,
            current={"table": SHEARED},
        )
    )
    assert model.tip_position == pytest.approx(exact.end_position, abs=4e-4)
    assert model.top_tension == pytest.approx(exact.top_tension, rel=1e-6)
    s = np.linspace(0.0, 400.0, 21)
    assert model.sample(s).position == pytest.approx(exact.position(s), abs=4e-4)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_current_that_turns_with_depth_at_a_tolerance(tolerance):
    exact = static_cable.steady_shape(
        reference_cable(400.0), static_cable.EndBody(5000.0, 0.4, 0.05), sheared
    )
    model = cm.CableModel(
        scene(400.0, TOW_CABLE, tolerance=tolerance, body=DEPRESSOR, current={"table": SHEARED})
    )
    assert model.tip_position == pytest.approx(exact.end_position, abs=tolerance * 400.0)
    assert model.top_tension == pytest.approx(exact.top_tension, rel=10 * tolerance)


# Tension-strain curve ---------------------------------------------------------------------------

CURVE = [4.0e-6, -2.0e-10, 6.0e-15]
"""Softer than linear at first, stiffer later; strain 0.045 at 20 kN, always rising."""


def test_hanging_cable_with_a_polynomial_tension_strain_curve():
    """Vertical: the tension is known, so that the length is an integral."""
    cable = {**IDEAL, "submerged_weight": 30.0, "tension_strain": CURVE}
    del cable["axial_stiffness"]
    body = {"mass": 500.0, "submerged_weight": 4000.0}
    model = cm.CableModel(scene(400.0, cable, model="cable", elements=16, body=body))
    length = static_cable.hanging_length(400.0, 30.0, 4000.0, CURVE)
    assert length > 401.0
    assert model.tip_position == pytest.approx([0.0, 0.0, -length], abs=1e-8 * length)
    assert model.top_tension == pytest.approx(16000.0, rel=1e-9)
    half = static_cable.hanging_length(200.0, 30.0, 10000.0, CURVE)
    assert -model.sample([200.0]).position[0, 2] == pytest.approx(half, rel=1e-7)


def test_towed_cable_with_a_polynomial_tension_strain_curve():
    """The stretch changes the shape and, by the factor sqrt(e), the drag."""
    exact = static_cable.steady_shape(
        reference_cable(1000.0, static_cable.polynomial_strain(CURVE)),
        static_cable.EndBody(5000.0, 0.4, 0.05),
        lambda z: np.array([-2.0, 0.0, 0.0]),
    )
    cable = {**TOW_CABLE, "tension_strain": CURVE}
    del cable["axial_stiffness"]
    model = cm.CableModel(
        scene(
            1000.0,
            cable,
            model="cable",
            elements=128,
            body=DEPRESSOR,
            vessel={"velocity": [{"t": 0, "velocity": [2.0, 0.0, 0.0]}]},
        )
    )
    assert model.tip_position == pytest.approx(exact.end_position, abs=1e-3)
    assert model.top_tension == pytest.approx(exact.top_tension, rel=1e-6)


@pytest.mark.parametrize("elements", [None, 4, 16])
def test_static_tension_holds_nothing_of_a_motion_that_begins(elements):
    """The vessel speeds up from t = 0: no wave has told the cable, which hangs by its weight.

    With the vessel's acceleration at once the force held the inertia of half an element.
    """
    ramp = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 0.2, "velocity": [1.0, 0, 1.0]}]
    model = cm.CableModel(
        scene(100.0, TOW_CABLE, model="cable", elements=elements, vessel={"velocity": ramp})
    )
    assert model.top_tension == pytest.approx(800.0, rel=1e-9)
    assert model.top_force == pytest.approx([0.0, 0.0, -800.0], abs=1e-6)


def test_what_a_start_bears_it_goes_on_bearing() -> None:
    """A float holds a cable in a sharp bend that presses it by 4 N, more than elements bear before
    they bend aside. The first step took that for a blow: 7 mm/s after 10 ms."""
    cable = {
        "diameter": 0.0043, "mass": 0.076, "submerged_weight": 0.6, "axial_stiffness": 6.2e4,
        "bending_stiffness": 0.0036,
    }  # fmt: skip
    buoy = {
        "mass": 1.15, "submerged_weight": -22.5, "half_length": 0.075, "centre_offset": -0.071,
        "rotary_inertia": 0.013, "drag_area": 0.022, "drag_coefficient": 1.0,
    }  # fmt: skip
    model = cm.CableModel(
        cm.load_scene(
            {
                "cable_types": {"K": cable},
                "line": [
                    {"cable": {"type": "K", "length": 60.7, "model": "elastica"}},
                    {"body": buoy},
                    {"cable": {"type": "K", "length": 70.0, "model": "elastica"}},
                ],
                "end": {"anchor": [-48.8, 75.3, -26.4]},
                "vessel": {"connection": {"clamped": [-0.37, 0.58, -0.72]}},
                "solver": {"tolerance": 3e-3},
            }
        )
    )
    assert model.tension_min < -3.0
    for time in (0.001, 0.01, 0.1):
        model.step_to(time)
        moves = model.sample(np.linspace(0.0, model.line_length, 50)).velocity
        assert np.abs(moves).max() < 1e-4
