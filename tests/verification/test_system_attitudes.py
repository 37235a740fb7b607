"""Vessels whose roll, pitch and yaw come from a table or a file, and foils from a table."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore
from scipy.interpolate import CubicSpline, PchipInterpolator
from scipy.spatial.transform import Rotation

import cablemodel as cm
from cablemodel.systems import SystemModel
from tests.unit.test_scene_files import write_log

DEGREE = np.pi / 180.0
TIMES = np.array([0.0, 2.0, 3.5, 7.0, 11.0, 12.0])
ANGLES = DEGREE * np.array(
    [[0, 1, 0], [8, -2, 3], [-6, 0, 5], [4, 3, 40], [0, -1, 170], [2, 0, 190]]
)
POINT = np.array([6.0, -2.0, 4.0])
COLUMNS = "t,roll,pitch,yaw"


def ship(attitude: Any, **more: Any) -> dict[str, Any]:
    """A load on a wire from a fairlead of a ship."""
    return {
        "environment": {"water_density": 1025},
        "cable_types": {"wire": {"diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e7}},
        "vessels": {"ship": {"points": {"lead": POINT.tolist()}, "attitude": attitude, **more}},
        "bodies": {
            "load": {
                "mass": 500, "submerged_weight": 3000, "inertia": 50, "drag_area": 0.4,
                "points": {"top": [0, 0, 0.5]},
            }
        },
        "lines": {
            "wire": {
                "from": "ship.lead", "to": "load.top",
                "items": [{"cable": {"type": "wire", "length": 40}}],
            }
        },
    }  # fmt: skip


def loaded(folder: Path, attitude: Any) -> cm.SystemScene:
    path = folder / "scene.yaml"
    path.write_text(json.dumps(ship(attitude)))
    return cm.load_system(path)


def table(angles: np.ndarray = ANGLES) -> list[dict[str, Any]]:
    rows = zip(TIMES.tolist(), angles.tolist(), strict=True)
    return [{"t": t, "attitude": row} for t, row in rows]


def expected(t: float) -> tuple[np.ndarray, np.ndarray]:
    """Angles and their rates by a spline through the rows, at rest at both ends."""
    spline = CubicSpline(TIMES, ANGLES, bc_type="clamped")
    at = min(t, TIMES[-1])
    return spline(at), spline(at, 1) if t < TIMES[-1] else np.zeros(3)


def test_a_ship_turns_as_its_table_says_and_takes_its_fairlead_with_it() -> None:
    model = SystemModel(ship(table()))
    for t in (0.0, 0.7, 2.0, 5.3, 10.9, 12.0, 15.0):
        if t > 0.0:
            model.step_to(t)
        angles, rates = expected(t)
        found = model.vessels["ship"]
        turn = Rotation.from_euler("xyz", angles)
        assert found.axes == pytest.approx(turn.as_matrix(), abs=1e-12)
        place = model.lines["wire"].sample([0.0]).position[0]
        assert place == pytest.approx(turn.apply(POINT), abs=1e-9)
        after = Rotation.from_euler("xyz", angles + 1e-6 * rates)
        spin = (after * turn.inv()).as_rotvec() / 1e-6
        assert found.angular_velocity == pytest.approx(spin, abs=1e-6)


def test_a_table_is_added_to_the_heading_of_a_path() -> None:
    path = [
        {"straight": {"duration": 4, "speed": 2, "heading": 0.3}},
        {"turn": {"angle": 1.0, "radius": 20}},
        {"straight": {"duration": 20}},
    ]
    both = SystemModel(ship(table(), path=path))
    alone = SystemModel(ship([0, 0, 0], path=path))
    for t in (0.0, 1.7, 4.0, 5.1, 9.0, 14.0, 20.0):
        if t > 0.0:
            both.step_to(t)
            alone.step_to(t)
        heading = alone.vessels["ship"].attitude
        wanted = Rotation.from_euler("xyz", expected(t)[0] + heading).as_matrix()
        assert both.vessels["ship"].axes == pytest.approx(wanted, abs=1e-9)
        assert both.vessels["ship"].position == pytest.approx(alone.vessels["ship"].position)


def test_a_table_may_begin_before_or_after_the_start() -> None:
    for late in (-3.0, 2.5):
        rows = [{**row, "t": row["t"] + late} for row in table()]
        model = SystemModel(ship(rows))
        for t in (0.0, 1.0, 3.0, 6.0):
            if t > 0.0:
                model.step_to(t)
            wanted = Rotation.from_euler("xyz", expected(max(t - late, 0.0))[0]).as_matrix()
            assert model.vessels["ship"].axes == pytest.approx(wanted, abs=1e-9)


def test_a_table_from_a_file_is_the_same(tmp_path: Path) -> None:
    text = "\n".join(",".join(map(repr, row)) for row in np.column_stack([TIMES, ANGLES]).tolist())
    (tmp_path / "roll.csv").write_text(f"{COLUMNS}\n{text}\n")
    scene = loaded(tmp_path, {"file": "roll.csv"})
    assert scene == cm.load_system(ship(table()))
    assert cm.load_system(scene.to_yaml()) == scene


@pytest.mark.parametrize("kind", ["nav_msgs/msg/Odometry", "sensor_msgs/msg/Imu"])
def test_orientations_of_a_log_are_read_and_turn_on_past_180_degrees(
    tmp_path: Path, kind: str
) -> None:
    types = get_typestore(Stores.ROS2_JAZZY).types
    stamp, header = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
    vector, cube = types["geometry_msgs/msg/Vector3"], np.zeros(36)
    messages = []
    for t, angles in zip(TIMES, ANGLES, strict=True):
        x, y, z, w = Rotation.from_euler("xyz", angles).as_quat()
        turn = types["geometry_msgs/msg/Quaternion"](x=x, y=y, z=z, w=w)
        head = header(stamp=stamp(sec=100 + int(t), nanosec=int(1e9 * (t % 1))), frame_id="map")
        zero = vector(x=0.0, y=0.0, z=0.0)
        if kind == "sensor_msgs/msg/Imu":
            none = np.zeros(9)
            message = types[kind](
                header=head, orientation=turn, orientation_covariance=none, angular_velocity=zero,
                angular_velocity_covariance=none, linear_acceleration=zero,
                linear_acceleration_covariance=none,
            )  # fmt: skip
        else:
            pose = types["geometry_msgs/msg/Pose"](
                position=types["geometry_msgs/msg/Point"](x=0.0, y=0.0, z=0.0), orientation=turn
            )
            twist = types["geometry_msgs/msg/Twist"](linear=zero, angular=zero)
            message = types[kind](
                header=head, child_frame_id="ship",
                pose=types["geometry_msgs/msg/PoseWithCovariance"](pose=pose, covariance=cube),
                twist=types["geometry_msgs/msg/TwistWithCovariance"](twist=twist, covariance=cube),
            )  # fmt: skip
        messages.append((int(1e9 * t), message))
    write_log(tmp_path / "log.mcap", {"/ship": (kind, messages)})
    found = loaded(tmp_path, {"file": "log.mcap"}).vessels["ship"].attitude
    assert found is not None
    assert found.column("t") == pytest.approx(TIMES, abs=1e-9)
    assert found.column("attitude") == pytest.approx(ANGLES, abs=1e-9)


@pytest.mark.parametrize(
    ("attitude", "words"),
    [
        ([{"t": 1, "attitude": [0, 0, 0]}, {"t": 1, "attitude": [0, 0, 0]}], "twice the same t"),
        ([{"t": 1, "attitude": [0, 0]}], "3 numbers"),
        ("roll.csv", "a file is named by {file: roll.csv}"),
        (5, "[roll, pitch, yaw] in rad"),
        ({"file": "none.csv"}, "there is no file"),
    ],
)
def test_a_wrong_attitude_is_told_in_the_words_of_the_file(attitude: Any, words: str) -> None:
    with pytest.raises(cm.SceneError, match=r"vessels\.ship\.attitude") as caught:
        cm.load_system(ship(attitude))
    assert words in str(caught.value)


def test_a_foil_has_the_coefficients_of_its_table_between_its_rows_too() -> None:
    """Rows .2 degrees apart: a table of whole degrees between gave .15 for 0, and 1.06 for 1."""
    rows = [(-180, 0, 0.1), (4.4, 0, 0.02), (4.6, 1, 0.03), (20, 1, 0.3), (180, 0, 0.1)]
    scene = ship([0, 0, 0])
    wing = {"area": 1.0, "table": rows}
    scene["bodies"]["load"]["foils"] = {"wing": wing, "other": {"area": 2.0}}
    model = SystemModel(scene)
    foil = model.scene.bodies["load"].foils["wing"]
    angles = DEGREE * np.array([-180.0, 0.0, 4.2, 4.4, 4.5, 4.62, 4.8, 5.5, 20.0, 60.0, 179.9])
    given = np.array(rows)
    wanted = PchipInterpolator(DEGREE * given[:, 0], given[:, 1:])(angles)
    assert foil.coefficients(angles) == pytest.approx(wanted, abs=1e-12)
    assert foil.coefficients(angles)[[1, 2, 3, 6, 7, 8], 0] == pytest.approx([0, 0, 0, 1, 1, 1])
