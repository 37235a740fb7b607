"""The tow point moves as closed forms say."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scene_examples import minimal

import cablemodel as cm
from cablemodel.cli.plausibility import scene_warnings
from cablemodel.scene import VesselMotion
from cablemodel.scene.motion import ARC, COLUMNS, KIND, POLYNOMIAL, SHAPE, T_END, T_START


def motion_of(**vessel: Any) -> VesselMotion:
    return cm.load_scene(minimal() | {"vessel": vessel}).motion()


def assert_motion(motion: VesselMotion, t: float, *expected: Any) -> None:
    for actual, wanted in zip(motion.evaluate(t), expected, strict=True):
        np.testing.assert_allclose(actual, wanted, rtol=1e-13, atol=1e-13)


def test_without_motion_the_tow_point_rests() -> None:
    motion = motion_of(position=[1, 2, 3])
    assert motion.pieces.shape == (1, COLUMNS)
    assert motion.pieces[0, T_END] == math.inf
    assert_motion(motion, 1e6, [1, 2, 3], [0, 0, 0], [0, 0, 0])
    assert motion.is_planar()
    assert motion.horizontal_direction() is None


def test_linear_velocity_gives_quadratic_position_and_holds_its_last_value() -> None:
    motion = motion_of(
        position=[0, 0, -1],
        velocity=[{"t": 0, "velocity": [0, 0, 0]}, {"t": 30, "velocity": [0.8, 0, 0]}],
    )
    a = 0.8 / 30
    assert_motion(motion, 0, [0, 0, -1], [0, 0, 0], [a, 0, 0])
    assert_motion(motion, 15, [a * 15**2 / 2, 0, -1], [a * 15, 0, 0], [a, 0, 0])
    assert_motion(motion, 30, [12, 0, -1], [0.8, 0, 0], [0, 0, 0])  # right limit
    assert_motion(motion, 200, [12 + 0.8 * 170, 0, -1], [0.8, 0, 0], [0, 0, 0])
    assert motion.breakpoints.tolist() == [30]
    assert motion.horizontal_direction() == pytest.approx([1, 0])


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_a_table_holds_its_first_value_from_zero(interpolation: str) -> None:
    rows = [{"t": 5, "velocity": [1, 0, 0]}, {"t": 7, "velocity": [3, 0, 0]}]
    motion = motion_of(velocity=rows, interpolation=interpolation)
    assert motion.pieces[:, T_START].tolist() == [0, 5, 7]
    assert_motion(motion, 4, [4, 0, 0], [1, 0, 0], [0, 0, 0])
    assert_motion(motion, 10, [5 + 4 + 9, 0, 0], [3, 0, 0], [0, 0, 0])


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_a_table_from_before_zero_starts_within(interpolation: str) -> None:
    rows = [{"t": t, "velocity": [math.sin(t), 0, t]} for t in (-4, -1.5, 1, 3, 4)]
    whole = VesselMotion.from_table(
        [row["t"] + 4 for row in rows],
        [row["velocity"] for row in rows],
        (0, 0, 0),
        interpolation,
    )
    cut = motion_of(velocity=rows, interpolation=interpolation)
    shift = whole.evaluate(4)[0]
    assert cut.pieces[0, T_START] == 0
    for t in (0, 0.3, 1, 2.9, 10):
        position, velocity, acceleration = whole.evaluate(t + 4)
        assert_motion(cut, t, position - shift, velocity, acceleration)


def test_a_table_that_ended_before_zero_holds() -> None:
    rows = [{"t": -2, "velocity": [0, 0, 0]}, {"t": -1, "velocity": [0, 2, 0]}]
    assert_motion(motion_of(velocity=rows), 3, [0, 6, 0], [0, 2, 0], [0, 0, 0])


def test_cubic_through_two_rows_is_the_smooth_step() -> None:
    rows = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 2, "velocity": [4, 0, 0]}]
    motion = motion_of(velocity=rows, interpolation="cubic")
    for t in (0.0, 0.5, 1.0, 1.9):
        x = t / 2
        velocity = 4 * (3 * x**2 - 2 * x**3)
        position = 8 * (x**3 - x**4 / 2)
        acceleration = 12 * x * (1 - x)
        assert_motion(motion, t, [position, 0, 0], [velocity, 0, 0], [acceleration, 0, 0])
    assert_motion(motion, 2, [4, 0, 0], [4, 0, 0], [0, 0, 0])


def test_cubic_reproduces_a_parabola_away_from_its_ends() -> None:
    times = np.array([0, 1, 1.5, 4, 5, 7, 8, 10.0])
    curve = lambda t: np.stack([t**2 - 3 * t, 2 - t, 0.5 * t**2], axis=-1)  # noqa: E731
    motion = VesselMotion.from_table(times, curve(times), (0, 0, 0), "cubic")
    for t in np.linspace(1, 8, 50):
        np.testing.assert_allclose(motion.evaluate(t)[1], curve(t), atol=1e-12)


def test_cubic_converges_with_order_three_or_better() -> None:
    def error(n: int) -> float:
        times = np.linspace(0, 2 * math.pi, n + 1)
        values = np.stack([1 - np.cos(times), 0 * times, np.sin(times) ** 2], axis=-1)
        motion = VesselMotion.from_table(times, values, (0, 0, 0), "cubic")
        exact = lambda t: (t - math.sin(t), 0, t / 2 - math.sin(2 * t) / 4)  # noqa: E731
        return max(
            np.linalg.norm(motion.evaluate(t)[0] - exact(t)) for t in np.linspace(0, 6.28, 100)
        )

    # Velocity at the rows is exact, their slopes are of second order: position of third.
    assert math.log2(error(40) / error(80)) > 2.9


rows_of_numbers = st.lists(
    st.tuples(st.floats(0.1, 5), *[st.floats(-3, 3)] * 3), min_size=1, max_size=8
)


@given(rows_of_numbers, st.sampled_from(["linear", "cubic"]), st.floats(-2, 2))
def test_motion_is_continuous_and_each_is_the_derivative_of_the_one_before(
    rows: list[tuple[float, ...]], interpolation: str, first: float
) -> None:
    times = first + np.cumsum([row[0] for row in rows])
    values = [row[1:] for row in rows]
    motion = VesselMotion.from_table(times, values, (1, 2, 3), interpolation)
    pieces = motion.pieces
    assert pieces[0, T_START] == 0
    assert pieces[-1, T_END] == math.inf
    np.testing.assert_array_equal(pieces[1:, T_START], pieces[:-1, T_END])
    np.testing.assert_array_equal(motion.evaluate(0)[0], [1, 2, 3])
    for kink in motion.breakpoints:
        before, after = motion.evaluate(np.nextafter(kink, 0)), motion.evaluate(kink)
        orders = 3 if interpolation == "cubic" else 2
        for left, right in zip(before[:orders], after[:orders], strict=True):
            np.testing.assert_allclose(left, right, atol=1e-9)
    for t, value in zip(times, values, strict=True):
        if t >= 0:
            np.testing.assert_allclose(motion.evaluate(t)[1], value, atol=1e-9)


@given(rows_of_numbers, st.floats(0, 2 * math.pi))
def test_a_rotated_table_gives_the_rotated_motion(
    rows: list[tuple[float, ...]], angle: float
) -> None:
    times = np.cumsum([row[0] for row in rows])
    values = np.array([row[1:] for row in rows])
    turn = np.array(
        [
            [math.cos(angle), -math.sin(angle), 0],
            [math.sin(angle), math.cos(angle), 0],
            [0, 0, 1],
        ]
    )
    straight = VesselMotion.from_table(times, values, (0, 0, 0), "cubic")
    turned = VesselMotion.from_table(times, values @ turn.T, (0, 0, 0), "cubic")
    for t in (0.0, 0.7, 3.3, 20.0):
        for a, b in zip(straight.evaluate(t), turned.evaluate(t), strict=True):
            np.testing.assert_allclose(turn @ a, b, atol=1e-11)


def test_turn_to_port_is_a_half_circle() -> None:
    motion = motion_of(
        position=[5, 6, 7], path=[{"turn": {"angle": "180 deg", "radius": 10, "speed": 0.8}}]
    )
    assert motion.pieces[0, KIND] == ARC
    assert motion.pieces[1, KIND] == POLYNOMIAL
    end = math.pi * 10 / 0.8
    assert motion.breakpoints == pytest.approx([end])
    for t in (0.0, 10.0, 39.0):
        a = 0.08 * t
        assert_motion(
            motion,
            t,
            [5 + 10 * math.sin(a), 6 + 10 - 10 * math.cos(a), 7],
            [0.8 * math.cos(a), 0.8 * math.sin(a), 0],
            [-0.064 * math.sin(a), 0.064 * math.cos(a), 0],
        )
    assert_motion(motion, end + 10, [5 - 8, 6 + 20, 7], [-0.8, 0, 0], [0, 0, 0])
    assert not motion.is_planar()
    assert motion.horizontal_direction() is None


def test_turn_to_starboard_mirrors_the_turn_to_port() -> None:
    mirror = np.array([1, -1, 1])
    port, starboard = (
        motion_of(path=[{"turn": {"angle": angle, "radius": 4, "speed": 1}}]) for angle in (2, -2)
    )
    for t in (0.0, 3.0, 7.99, 12.0):
        for a, b in zip(port.evaluate(t), starboard.evaluate(t), strict=True):
            np.testing.assert_allclose(a, b * mirror, atol=1e-13)


def test_speed_changes_uniformly_over_a_leg() -> None:
    motion = motion_of(
        path=[
            {"straight": {"duration": 10, "speed": 1, "heading": "90 deg"}},
            {"straight": {"length": 30, "speed": 3}},
            {"turn": {"angle": "-90 deg", "radius": 20, "speed": 1}},
            {"straight": {"duration": 4, "speed": 0}},
            {"straight": {"duration": 2}},
            {"straight": {"length": 1, "speed": 1, "heading": "180 deg"}},
        ]
    )
    # 30 m at 2 m/s on average; a quarter circle of 10 pi at 2; 4 s from 1 to 0; 2 s; 1 m at 1/2
    marks = np.cumsum([10, 15, 10 * math.pi / 2, 4, 2, 2])
    np.testing.assert_allclose(motion.breakpoints, marks, rtol=1e-14)
    assert_motion(motion, 10, [0, 10, 0], [0, 1, 0], [0, 2 / 15, 0])
    assert_motion(motion, 25, [0, 40, 0], [0, 3, 0], [3**2 / 20, -2 / (5 * math.pi), 0])
    at_end_of_turn = motion.evaluate(marks[2])
    np.testing.assert_allclose(at_end_of_turn[0], [20, 60, 0], atol=1e-12)
    np.testing.assert_allclose(at_end_of_turn[1], [1, 0, 0], atol=1e-12)
    assert_motion(motion, marks[3], [22, 60, 0], [0, 0, 0], [0, 0, 0])
    assert_motion(motion, marks[5] + 1, [20, 60, 0], [-1, 0, 0], [0, 0, 0])


def test_a_full_turn_allows_the_heading_to_be_given_again() -> None:
    motion = motion_of(
        path=[
            {"turn": {"angle": "360 deg", "radius": 4, "speed": 1}},
            {"straight": {"duration": 1, "heading": 0}},
        ]
    )
    np.testing.assert_allclose(motion.evaluate(100)[1], [1, 0, 0], atol=1e-12)


@pytest.mark.parametrize("heading", [0.0, 0.3, math.pi / 2, 2.5])
def test_motion_along_one_heading_is_planar(heading: float) -> None:
    motion = motion_of(path=[{"straight": {"duration": 3, "speed": 2, "heading": heading}}])
    direction = motion.horizontal_direction()
    assert motion.is_planar()
    assert direction == pytest.approx([math.cos(heading), math.sin(heading)])


def test_heave_alone_leaves_the_plane_free() -> None:
    rows = [{"t": t, "velocity": [0, 0, math.cos(t)]} for t in range(5)]
    motion = motion_of(velocity=rows, interpolation="cubic")
    assert motion.is_planar()
    assert motion.horizontal_direction() is None


def test_sway_takes_the_motion_out_of_its_plane() -> None:
    rows = [{"t": t, "velocity": [1, 1e-4 * math.cos(t), 0]} for t in range(5)]
    assert not motion_of(velocity=rows).is_planar()
    rows = [{"t": t, "velocity": [t, 2 * t, math.cos(t)]} for t in range(5)]
    direction = motion_of(velocity=rows).horizontal_direction()
    assert direction is not None
    assert direction == pytest.approx(np.array([1, 2]) / math.sqrt(5))


def test_pieces_are_laid_out_as_the_kernels_read_them() -> None:
    rows = [{"t": 0, "velocity": [1, 2, 3]}, {"t": 2, "velocity": [3, 2, 1]}]
    piece = motion_of(position=[7, 8, 9], velocity=rows).pieces[0]
    assert piece.shape == (24,)
    assert piece[:3].tolist() == [0, 2, 0]
    assert piece[SHAPE : SHAPE + 9].tolist() == [7, 8, 9, 1, 2, 3, 0.5, 0, -0.5]
    assert not piece[SHAPE + 9 :].any()


@pytest.mark.parametrize("t", [-1e-9, math.nan, math.inf])
def test_times_outside_the_motion_are_refused(t: float) -> None:
    with pytest.raises(ValueError, match="finite t >= 0"):
        motion_of().evaluate(t)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_a_track_is_the_motion_at_each_of_its_times(interpolation: str) -> None:
    rows = [{"t": t, "velocity": [math.sin(t), 0.3 * t, math.cos(3 * t)]} for t in (-1, 0.5, 2, 7)]
    legs = [
        {"straight": {"speed": 2, "length": 10, "heading": 0.3}},
        {"turn": {"angle": -1.2, "radius": 8, "speed": 3}},
        {"straight": {"duration": 4, "speed": 1}},
    ]
    times = np.concatenate([np.linspace(0.0, 30.0, 61), [5.0, 0.5]])
    for motion in (
        motion_of(velocity=rows, interpolation=interpolation),
        motion_of(path=legs, position=[1, 2, -3]),
    ):
        places, velocities = motion.track(times)
        single = [motion.evaluate(float(t)) for t in times]
        np.testing.assert_array_equal(places, [row[0] for row in single])
        np.testing.assert_array_equal(velocities, [row[1] for row in single])


def test_a_track_outside_the_motion_is_refused() -> None:
    for times, bad in (([2.0, -1.0], "-1.0"), ([1.0, math.nan], "nan"), (math.inf, "inf")):
        with pytest.raises(ValueError, match=f"finite t >= 0, not {bad}"):
            motion_of().track(times)


def test_what_a_motion_hands_out_cannot_be_changed() -> None:
    direction = motion_of(velocity=[1, 2, 0]).horizontal_direction()
    assert direction is not None
    with pytest.raises(ValueError, match="read-only"):
        direction[0] = 5.0


def test_typical_velocities_are_those_at_each_begin_and_soon_after() -> None:
    rows = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 4, "velocity": [2, 0, 0]}]
    motion = motion_of(velocity=rows)
    assert motion.typical_velocities()[:, 0].tolist() == [0, 2, 0.5, 2]
    assert motion.typical_speed == 2.0


def test_a_start_looks_through_a_long_table_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """1.5 million rows cost half a second each time."""
    asked = []
    velocities = VesselMotion.typical_velocities

    def counted(self: VesselMotion) -> Any:
        asked.append(self)
        return velocities(self)

    monkeypatch.setattr(VesselMotion, "typical_velocities", counted)
    scene = cm.load_scene(
        {
            "cable_types": {"c": {"diameter": 0.02, "mass": 1.0, "axial_stiffness": 5e6}},
            "line": [{"cable": {"type": "c", "length": 20.0}}],
            "vessel": {"velocity": [1, 0, 0]},
        }
    )
    cm.CableModel(scene)
    assert not scene_warnings(scene)
    assert len(asked) == 1


def test_a_scene_makes_its_motion_once_and_another_vessel_has_its_own() -> None:
    scene = cm.load_scene(minimal() | {"vessel": {"velocity": [1, 0, 0]}})
    assert scene.motion() is scene.motion()
    other = cm.load_scene(minimal() | {"vessel": {"velocity": [0, 2, 0]}})
    moved = scene.model_copy(update={"vessel": other.vessel})
    assert moved.motion().evaluate(1.0)[1].tolist() == [0, 2, 0]
    assert scene.motion().evaluate(1.0)[1].tolist() == [1, 0, 0]
    assert copy.deepcopy(scene).motion().evaluate(3.0)[0].tolist() == [3, 0, 0]
