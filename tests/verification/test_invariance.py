"""The same scene seen from elsewhere gives the same run: turned about z, mirrored, moved, boosted.

Rounding is all that may differ: 1e-10 of the length. Turning a plane scene may change the plane
that the cable is computed in, not whether it is computed in one.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cablemodel as cm
from tests.verification.scenes import CABLE_K, scene

LENGTH = 10.0
angles = st.floats(-np.pi, np.pi, allow_nan=False)
places = st.tuples(*[st.floats(-1e3, 1e3, allow_nan=False)] * 3)
CURRENT = [(0.0, (0.2, 0.1, 0.0)), (-5.0, (-0.3, 0.4, 0.0))]
VESSEL = [(0.0, (0.0, 0.0, 0.0)), (2.0, (0.5, 0.4, 0.1)), (4.0, (-0.3, 0.2, 0.0))]
START = (0.3, 0.2, -0.9)


def rotation(angle, mirror=False):
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return matrix @ np.diag([1.0, -1.0, 1.0]) if mirror else matrix


def spatial_run(matrix, shift=(0.0, 0.0, 0.0), boost=None):
    """Ends, middles and forces of a run in three dimensions, seen in the turned frame."""
    shift = np.asarray(shift, float)
    added = np.zeros(3) if boost is None else np.asarray(boost, float)

    def turned(vector):
        return [float(x) for x in matrix @ np.asarray(vector)]

    model = cm.CableModel(
        scene(
            LENGTH,
            CABLE_K,
            elements=6,
            tolerance=1e-3,
            current={
                "table": [
                    {"z": z + shift[2], "velocity": turned(np.add(v, added))} for z, v in CURRENT
                ]
            },
            vessel={
                "position": [float(x) for x in shift],
                "velocity": [{"t": t, "velocity": turned(np.add(v, added))} for t, v in VESSEL],
            },
            initial={"straight": turned(START)} if boost is None else "static",
        )
    )
    rows = []
    for _ in range(8):
        model.step(0.5)
        state = model.sample([LENGTH / 2, LENGTH])
        rows.append(
            [
                *((state.position - model.vessel_position) @ matrix).ravel(),
                *(model.top_force @ matrix),
                *state.tension,
            ]
        )
    return np.array(rows)


@pytest.fixture(scope="module")
def unturned():
    return spatial_run(np.eye(3))


@settings(max_examples=12, deadline=None, derandomize=True)
@given(angle=angles, mirror=st.booleans())
def test_run_does_not_depend_on_the_direction_of_x(unturned, angle, mirror):
    turned = spatial_run(rotation(angle, mirror))
    positions, forces = slice(0, 6), slice(6, 11)
    assert turned[:, positions] == pytest.approx(unturned[:, positions], abs=1e-10 * LENGTH)
    largest = np.abs(unturned[:, forces]).max()
    assert turned[:, forces] == pytest.approx(unturned[:, forces], abs=1e-8 * largest)


@settings(max_examples=12, deadline=None, derandomize=True)
@given(angle=angles, mirror=st.booleans())
def test_start_from_points_does_not_depend_on_the_direction_of_x(angle, mirror):
    """The curve through a few points turns with them."""
    points = np.array([(0.0, 0.0, 0.0), (1.5, 0.0, -4.0), (3.0, 1.0, -8.9)])
    s = np.linspace(0.0, LENGTH, 9)

    def shape(matrix):
        turned = (points @ matrix.T).tolist()
        start = scene(LENGTH, CABLE_K, elements=6, initial={"points": turned})
        return cm.CableModel(start).sample(s).position @ matrix

    assert shape(rotation(angle, mirror)) == pytest.approx(shape(np.eye(3)), abs=1e-10 * LENGTH)


@settings(max_examples=8, deadline=None, derandomize=True)
@given(shift=places)
def test_run_does_not_depend_on_the_origin(unturned, shift):
    """A shift of 1 km leaves 1e-13 m in the coordinates; times EA/h = 6e5 N/m that is 7e-8 N."""
    moved = spatial_run(np.eye(3), shift)
    assert moved[:, :6] == pytest.approx(unturned[:, :6], abs=1e-10 * LENGTH)
    largest = np.abs(unturned[:, 6:]).max()
    assert moved[:, 6:] == pytest.approx(unturned[:, 6:], abs=1e-7 * largest)


@settings(max_examples=6, deadline=None, derandomize=True)
@given(speed=st.floats(-2.0, 2.0, allow_nan=False), angle=angles)
def test_run_does_not_depend_on_the_speed_of_the_frame(speed, angle):
    """Vessel and water with a common velocity more: Galileo. The run starts from statics.

    The stabilisation is scaled by a guess from absolute speeds, so that time steps differ: both
    are what is promised, tau L of positions and 10 tau of the tension.
    """
    plain = spatial_run(np.eye(3), boost=(0.0, 0.0, 0.0))
    boost = (speed * np.cos(angle), speed * np.sin(angle), 0.0)
    moving = spatial_run(np.eye(3), boost=boost)
    assert moving[:, :6] == pytest.approx(plain[:, :6], abs=1e-3 * LENGTH)
    largest = np.abs(plain[:, 6:]).max()
    assert moving[:, 6:] == pytest.approx(plain[:, 6:], abs=1e-2 * largest)


def planar_run(angle, *, planar=None):
    c, s = float(np.cos(angle)), float(np.sin(angle))
    rows = [(0.0, 0.0), (2.0, 0.6), (4.0, -0.2)]
    model = cm.CableModel(
        scene(
            LENGTH,
            CABLE_K,
            elements=6,
            tolerance=1e-3,
            vessel={"velocity": [{"t": t, "velocity": [v * c, v * s, 0.1 * t]} for t, v in rows]},
        ),
        planar=planar,
    )
    out = []
    for _ in range(8):
        model.step(0.5)
        tip = model.tip_position - model.vessel_position
        out.append([c * tip[0] + s * tip[1], c * tip[1] - s * tip[0], tip[2], model.top_tension])
    return model.planar, np.array(out)


@settings(max_examples=8, deadline=None, derandomize=True)
@given(angle=angles)
def test_plane_scene_is_computed_in_its_plane_whichever_that_is(angle):
    _, along_x = planar_run(0.0)
    planar, turned = planar_run(angle)
    assert planar
    assert turned[:, :3] == pytest.approx(along_x[:, :3], abs=1e-10 * LENGTH)
    assert turned[:, 3] == pytest.approx(along_x[:, 3], rel=1e-8)


def test_plane_and_space_give_the_same_run():
    """Same elements, same steps: the planar kernels are the spatial ones with y left out."""
    _, plane = planar_run(0.0)
    planar, space = planar_run(0.0, planar=False)
    assert not planar
    assert space[:, :3] == pytest.approx(plane[:, :3], abs=1e-9 * LENGTH)
    assert space[:, 3] == pytest.approx(plane[:, 3], rel=1e-7)
