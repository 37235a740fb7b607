"""The reference solutions give the numbers that were computed elsewhere (8 digits)."""

from dataclasses import replace

import numpy as np
import pytest

from tests.verification.references import (
    catenary,
    elastica,
    lumped_cable,
    modes,
    motion,
    static_cable,
)

GRAVITY = 9.80665


def cable_k(length=30.0, axial_stiffness=1e6):
    return static_cable.CableProperties(
        length=length,
        weight=2.33333,
        strain=static_cable.linear_strain(axial_stiffness),
        diameter=0.01666,
        drag_normal=1.0,
        drag_tangential=0.1586,
    )


@pytest.mark.parametrize(
    ("rise", "axial_stiffness", "horizontal", "top"),
    [
        (300.0, 1e7, 3817.791111, 7903.338370),
        (300.0, 1e5, 3246.888257, 7452.757414),
        (600.0, 1e8, 51455.53062, 67488.30262),
    ],
)
def test_elastic_catenary(rise, axial_stiffness, horizontal, top):
    found = catenary.elastic_catenary(800.0, rise, 1000.0, 10.0, axial_stiffness)
    assert found.horizontal == pytest.approx(horizontal, rel=2e-10)
    assert found.tension(1000.0) == pytest.approx(top, rel=2e-10)
    assert found.position(1000.0) == pytest.approx((800.0, rise), rel=1e-14)


def test_elastic_catenary_middle():
    found = catenary.elastic_catenary(800.0, 300.0, 1000.0, 10.0, 1e7)
    assert found.position(500.0) == pytest.approx((466.6270330, -63.2123681), abs=1e-7)


def test_towed_free_end():
    cable = cable_k(axial_stiffness=1e15)
    angle = static_cable.critical_angle(cable, 0.8)
    assert np.degrees(angle) == pytest.approx(35.998, abs=1e-3)
    shape = static_cable.steady_shape(cable, None, lambda z: np.array([-0.8, 0.0, 0.0]))
    assert shape.top_angle == pytest.approx(angle, abs=1e-10)
    expected = static_cable.critical_angle_tension(cable, 0.8)
    assert shape.top_tension == pytest.approx(expected, rel=1e-10)
    assert shape.end_position == pytest.approx(
        [-30 * np.cos(angle), 0.0, -30 * np.sin(angle)], abs=1e-8
    )


def test_towed_free_end_that_stretches():
    """Without the factor sqrt(e) on the drag the angle and tension are those without stretch."""
    cable = replace(cable_k(), drag_exponent=0.0)
    shape = static_cable.steady_shape(cable, None, lambda z: np.array([-0.8, 0.0, 0.0]))
    assert np.degrees(shape.top_angle) == pytest.approx(35.998, abs=1e-3)
    assert shape.end_position == pytest.approx([-24.2723, 0.0, -17.6335], abs=6e-5)
    assert shape.top_tension == pytest.approx(94.6068, abs=6e-5)


def test_drag_on_the_stretched_cable_moves_the_towed_end():
    """The factor sqrt(e) moves the steady tow by about 1.6e-4 m and 1.5e-3 N."""
    with_factor, without = (
        static_cable.steady_shape(
            replace(cable_k(), drag_exponent=p), None, lambda z: np.array([-0.8, 0.0, 0.0])
        )
        for p in (0.5, 0.0)
    )
    moved = np.linalg.norm(with_factor.end_position - without.end_position)
    assert 1.0e-4 < moved < 1.7e-4
    assert 1.2e-3 < with_factor.top_tension - without.top_tension < 1.6e-3


def test_depressor_tow_is_independent_of_the_integrator():
    """No number was given: halving the tolerance, and the force balance of the whole, decide."""
    cable = static_cable.CableProperties(
        1000.0, 8.0, static_cable.linear_strain(5e6), 0.025, 1.2, 0.02
    )
    body = static_cable.EndBody(5000.0, 0.4, 0.1)
    fine, coarse = (
        static_cable.steady_shape(cable, body, lambda z: np.array([-2.0, 0, 0]), rtol=rtol)
        for rtol in (1e-12, 1e-9)
    )
    assert fine.end_position == pytest.approx(coarse.end_position, abs=1e-6)
    assert fine.top_tension == pytest.approx(coarse.top_tension, rel=1e-8)
    # Weight is per unstretched length, and normal drag has a vertical part that lifts.
    s = np.linspace(0.0, 1000.0, 20001)
    x, _, z = fine.position(s).T
    tension = fine.tension(s)
    tangent = np.gradient(fine.position(s), s, axis=0, edge_order=2)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    flow = np.array([-2.0, 0.0, 0.0])
    along = tangent @ flow
    across = flow - along[:, None] * tangent
    drag = cable.normal_drag * np.linalg.norm(across, axis=1)[:, None] * across
    drag += cable.tangential_drag * (np.abs(along) * along)[:, None] * tangent
    drag *= np.sqrt(1.0 + tension / 5e6)[:, None]
    total = np.trapezoid(drag, s, axis=0) - np.array([0, 0, 8000.0]) - body.cable_force(flow)
    assert fine.top_force == pytest.approx(-total, abs=1e-3)
    assert x[-1] < -300.0
    assert z[-1] < -400.0


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        (1.0, (0.9435667637, 0.3017207738, 0.4613519497)),
        (10.0, (0.4450044022, 0.8106090249, 1.4302855388)),
    ],
)
def test_cantilever_tip_load(load, expected):
    assert elastica.cantilever_tip_load(load) == pytest.approx(expected, abs=1e-10)
    rod = elastica.extensible_rod(1.0, 1.0, 1e13, 0.0, end_force=(0.0, -load))
    assert (rod.x[-1], -rod.z[-1], -rod.theta[-1]) == pytest.approx(expected, abs=2e-9)


@pytest.mark.parametrize(
    ("weight", "tip"), [(1.0, (None, 0.123471402)), (100.0, (0.159223383, 0.937523935))]
)
def test_cantilever_under_its_own_weight(weight, tip):
    rod = elastica.extensible_rod(1.0, 1.0, 1e13, 0.0, weight=weight)
    if tip[0] is not None:
        assert rod.x[-1] == pytest.approx(tip[0], abs=2e-9)
    assert -rod.z[-1] == pytest.approx(tip[1], abs=2e-9)


def test_clamped_end_layer():
    angle = np.radians(30.0)
    assert elastica.clamped_end_curvature(1.0, 100.0, angle) == pytest.approx(5.17638090, abs=1e-8)
    rod = elastica.extensible_rod(1.0, 1.0, 1e13, angle, end_force=(100.0, 0.0), steps=40)
    assert -rod.moment[0] == pytest.approx(5.17638090, abs=5e-8)
    assert rod.z[-1] == pytest.approx(elastica.clamped_end_offset(1.0, 100.0, angle), abs=1e-8)


def test_hanging_chain_frequencies():
    expected = [1.19073171, 2.73322614, 4.28482982]
    assert modes.hanging_chain(10.0, 3) == pytest.approx(expected, abs=6e-9)


def test_hanging_elastica_frequencies():
    """Computed elsewhere: 1.2236592 for the first; a Ritz solution with 40 Legendre polynomials
    gives 1.22365931, 2.91815254, 5.08184275 and decides for the power series."""
    expected = [1.22365931, 2.91815255, 5.08184275]
    assert modes.hanging_elastica(1e-3, 3) == pytest.approx(expected, abs=6e-9)


def test_cantilever_frequencies():
    assert modes.cantilever(2) == pytest.approx([1.8751040687, 4.6940911330], abs=6e-11)


def test_tensioned_beam_frequencies():
    pinned = modes.tensioned_beam_pinned(100.0, 2)
    assert pinned == pytest.approx([32.9297666, 74.2050350], abs=6e-8)
    assert modes.tensioned_beam_clamped(100.0, 1) == pytest.approx([40.9931610], abs=6e-8)


@pytest.mark.parametrize(
    ("parameter", "expected"), [(1.0, 3.26788621), (4 * np.pi**2, 6.28318531), (100.0, 8.15929589)]
)
def test_sagging_cable_frequencies(parameter, expected):
    assert modes.irvine_symmetric(parameter) == pytest.approx(expected, abs=6e-9)


def test_axial_end_mass_frequency():
    found = modes.axial_with_end_mass(1000.0, 1e7, 1.0, 1000.0, 1)
    assert found == pytest.approx([2.72061369], abs=6e-9)


def test_pendulum_period():
    assert motion.pendulum_period(1.0, np.radians(60.0)) == pytest.approx(2.1532423518, abs=6e-11)


def test_spring_pendulum_tends_to_the_pendulum():
    period = motion.pendulum_period(1.0, np.radians(60.0))
    start = (np.sin(np.radians(60.0)), -np.cos(np.radians(60.0)))
    end = motion.spring_pendulum(1.0, 1e8, 1.0, GRAVITY, start, [period])[-1]
    assert end == pytest.approx(start, abs=1e-6)


def test_sinking_obeys_its_equation():
    velocity, distance = motion.sinking([0.0, 0.5, 0.5 + 1e-6], 2.0, 0.5, 0.2, 8.0)
    assert velocity[0] == 0.0
    acceleration = (velocity[2] - velocity[1]) / 1e-6
    assert 0.7 * acceleration == pytest.approx(2.0 - 8.0 * velocity[1] ** 2, rel=1e-5)
    assert (distance[2] - distance[1]) / 1e-6 == pytest.approx(velocity[1], rel=1e-5)


def test_drifting_in_a_steady_current_is_the_sinking_cable_seen_from_the_water():
    """In water at speed c the cable nears c like 1/t: c - v = c/(1 + drag c t/(m + ma))."""
    drift = motion.drifting(lambda t: 0.7, [0.0, 2.0], 0.5, 0.2, 8.0)
    velocity, _ = drift([0.3, 2.0])
    expected = 0.7 - 0.7 / (1 + 8.0 * 0.7 * np.array([0.3, 2.0]) / 0.7)
    assert velocity == pytest.approx(expected, abs=1e-11)


def test_rigid_rod_swings_at_its_own_period():
    """A uniform rod swings as a pendulum of two thirds of its length."""
    period = motion.pendulum_period(2.0 / 3.0, 0.5)
    angle = motion.rigid_rod(
        1.0, 2.0, 2.0 * GRAVITY, 0.0, 0.0, lambda t: 0.0, [0.0, 10.0], [period], start_angle=0.5
    )
    assert angle[0] == pytest.approx(0.5, abs=1e-9)


def test_rigid_rod_rests_in_a_steady_current():
    """Where it rests, w L^2/2 sin = cn c^2 cos^2 L^2/2; it turns slowly enough to be there."""
    angle = motion.rigid_rod(
        1.0, 0.2, 20.0, 10.0, 0.1, lambda t: min(t, 1.0), [0.0, 1.0, 400.0], [400.0]
    )[0]
    assert 20.0 * np.sin(angle) == pytest.approx(10.0 * np.cos(angle) ** 2, rel=1e-4)


def test_falling_folded_chain():
    expected = 0.8472130848 * np.sqrt(2 * 3.0 / GRAVITY)
    assert motion.folded_chain_fall_time(3.0) == pytest.approx(expected, rel=2e-10)
    assert motion.folded_chain_fall(3.0, [expected * (1 - 1e-9)])[0] == pytest.approx(3.0, rel=1e-4)


def test_stretched_hanging_length():
    """For a linear cable: W L/EA + w L^2/(2 EA)."""
    length = static_cable.hanging_length(100.0, 5.0, 200.0, [1e-6])
    assert length - 100.0 == pytest.approx(1e-6 * (200.0 * 100.0 + 5.0 * 100.0**2 / 2), rel=1e-12)


def test_lumped_chain_hangs_like_a_cable():
    """At rest: tension w L at the top, the end w L^2 / (2 EA) below its unstretched place."""
    cable = cable_k()
    segments = 10
    s = np.linspace(0.0, 30.0, segments + 1)
    start = np.column_stack((0 * s, 0 * s, -s - 2.33333 * (30.0 * s - s**2 / 2) / 1e6))
    still = (np.zeros(3), np.zeros(3))
    tip, top = lumped_cable.towed_cable(
        cable, 1e6, 0.4613, 0.2234, lambda t: still, start, [0.0, 5.0], [5.0]
    )
    assert tip[0] == pytest.approx([0.0, 0.0, -30.0 - 2.33333 * 450.0 / 1e6], abs=1e-6)
    assert top[0] == pytest.approx(70.0, abs=0.01)


@pytest.mark.slow
def test_stretch_in_the_drag_moves_the_released_cable_as_the_tables_have_it():
    """The corrections of `tables`, on their cheapest scene; 1 % of them with 20 segments."""
    s = np.linspace(0.0, 10.0, 21)
    start = np.column_stack((s, 0 * s, 0 * s))
    still = (np.zeros(3), np.zeros(3))
    added = 1025.0 * np.pi / 4 * 0.01666**2
    with_factor, without = (
        lumped_cable.towed_cable(
            replace(cable_k(10.0), drag_exponent=p),
            1e6,
            0.4613,
            added,
            lambda t: still,
            start,
            [0.0, 10.0],
            [10.0],
        )[0]
        for p in (0.5, 0.0)
    )
    assert with_factor[0] - without[0] == pytest.approx([1.93e-6, 0.0, 0.67e-6], abs=2e-8)
