"""Tables from files: CSV, and velocity from MCAP logs."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer
from rosbags.typesys import Stores, get_typestore
from scene_examples import minimal

import cablemodel as cm
from cablemodel import variables
from cablemodel.cli.plausibility import scene_warnings

ODOMETRY = "nav_msgs/msg/Odometry"
TWIST = "geometry_msgs/msg/TwistStamped"


def scene_with(folder: Path, **velocity: str) -> cm.Scene:
    data = minimal() | {"vessel": {"velocity": velocity}}
    return cm.load_scene(data, folder=folder)


def refusal(folder: Path, **velocity: str) -> cm.SceneError:
    with pytest.raises(cm.SceneError) as caught:
        scene_with(folder, **velocity)
    return caught.value


def rows(scene: cm.Scene) -> list[tuple[float, tuple[float, ...]]]:
    assert scene.vessel.velocity is not None
    return [(row.t, row.velocity) for row in scene.vessel.velocity]


def test_velocity_from_csv_by_column_names(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("\ufefft, vy,vx,note,vz\n0,2,1,a,3\n\n1.5,5,4,b,6\n")
    scene = scene_with(tmp_path, file="log.csv")
    assert rows(scene) == [(0, (1, 2, 3)), (1.5, (4, 5, 6))]
    # Written, the scene no longer needs the file.
    assert cm.load_scene(scene.to_yaml()) == scene


def test_files_are_found_next_to_the_scene(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("t,vx,vy,vz\n0,1,2,3\n")
    path = tmp_path / "scene.yaml"
    path.write_text(
        "cable_types: {K: {diameter: 1, mass: 1, axial_stiffness: 1}}\n"
        "line: [{cable: {type: K, length: 1}}]\n"
        "vessel: {velocity: {file: log.csv}}\n"
    )
    assert rows(cm.load_scene(path)) == [(0, (1, 2, 3))]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no column t"),
        ("t,vx,vy\n0,1,2\n", "no column vz"),
        ("t;vx;vy;vz\n0;1;2;3\n", "its first line is 't;vx;vy;vz'"),
        ("t,vx,vy,vz\n", "no rows"),
        ("t,vx,vy,vz\n0,1,2\n", "line 2 of log.csv, column vz: '' is no finite number"),
        ("t,vx,vy,vz\n0,1,2,3\n\n1,x,2,3\n", "line 4 of log.csv, column vx: 'x' is no"),
        ("t,vx,vy,vz\n0,1,2,nan\n", "line 2 of log.csv, column vz: 'nan' is no"),
        ("t,vx,vy,vz\n0,1,2,3\n0,1,2,3\n", "twice the same t"),
        ("t,vx,vy,vz\n1,1,2,3\n0,1,2,3\n", "out of order"),
    ],
)
def test_bad_csv_is_refused(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "log.csv").write_text(text)
    error = refusal(tmp_path, file="log.csv")
    assert error.path.startswith("vessel.velocity")
    assert words in str(error)


def test_quotes_spaces_and_empty_rows_of_a_table_are_understood(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text('\n"t", vx,vy,vz\n0, 1 ,"2",3\n,,,\n1,1e0,2,3\n')
    assert rows(scene_with(tmp_path, file="log.csv")) == [(0, (1, 2, 3)), (1, (1, 2, 3))]


def test_a_long_table_is_read_and_started_from_quickly(tmp_path: Path) -> None:
    """A million rows as objects took minutes: 10^5 of them 4 s to load and as many to start."""
    times = 0.05 * np.arange(100_000)
    table = np.stack([times, np.sin(times), 0.0 * times, np.cos(times) - 1.0], axis=1)
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header="t,vx,vy,vz", comments="")
    cm.CableModel(cm.load_scene(minimal()))  # what is imported is not timed
    began = time.process_time()
    scene = scene_with(tmp_path, file="log.csv")
    loaded = time.process_time()
    motion = cm.CableModel(scene)
    started = time.process_time()
    assert scene.vessel.velocity is not None
    assert scene.vessel.velocity[-1].velocity == pytest.approx(table[-1, 1:], abs=1e-15)
    assert motion.vessel_position == pytest.approx((0, 0, 0))
    # Three times what it takes.
    assert loaded - began < 1.0
    assert started - loaded < 1.0


def test_a_depth_table_of_many_rows_is_read_quickly(tmp_path: Path) -> None:
    x, y = np.meshgrid(10.0 * np.arange(300), 10.0 * np.arange(300), indexing="ij")
    table = np.stack([x.ravel(), y.ravel(), -100.0 - 3.0 * np.sin(x / 50.0).ravel()], axis=1)
    shuffled = np.random.default_rng(1).permutation(table)
    np.savetxt(tmp_path / "floor.csv", shuffled, delimiter=",", header="x,y,z", comments="")
    data = minimal() | {"environment": {"floor": {"depth_table": "floor.csv"}}}
    began = time.process_time()
    floor = cm.load_scene(data, folder=tmp_path).environment.floor
    assert time.process_time() - began < 1.5
    assert floor is not None
    assert np.array_equal(floor.grid_z, table[:, 2].reshape(300, 300))


def test_missing_and_odd_files_are_refused(tmp_path: Path) -> None:
    assert "no file 'none.csv'" in str(refusal(tmp_path, file="none.csv"))
    assert "no file" in str(refusal(tmp_path, file="x" * 5000))
    assert "no file" in str(refusal(tmp_path, file="\0"))
    assert "no file" in str(refusal(tmp_path, file="."))
    (tmp_path / "binary.csv").write_bytes(bytes(range(256)))
    assert "cannot be read" in str(refusal(tmp_path, file="binary.csv"))
    (tmp_path / "log.csv").write_text("t,vx,vy,vz\n0,1,2,3\n")
    assert refusal(tmp_path, file="log.csv", topic="/odom").path == "vessel.velocity.topic"


def write_log(path: Path, topics: dict[str, tuple[str, list[Any]]]) -> None:
    """Write messages, given as (stamp [ns], message), to an MCAP file."""
    types = get_typestore(Stores.ROS2_JAZZY)
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2")
        for topic, (name, messages) in topics.items():
            text, _ = types.generate_msgdef(name, ros_version=2)
            schema = writer.register_schema(name, "ros2msg", text.encode())
            channel = writer.register_channel(topic, "cdr", schema)
            for stamp, message in messages:
                data = bytes(types.serialize_cdr(message, name))
                writer.add_message(channel, stamp, data, stamp)
        writer.finish()


def header(stamp: int, frame: str = "map") -> Any:
    types = get_typestore(Stores.ROS2_JAZZY).types
    time = types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
    return types["std_msgs/msg/Header"](stamp=time, frame_id=frame)


def twist(velocity: tuple[float, float, float]) -> Any:
    types = get_typestore(Stores.ROS2_JAZZY).types
    vector = types["geometry_msgs/msg/Vector3"]
    return types["geometry_msgs/msg/Twist"](linear=vector(*velocity), angular=vector(0, 0, 0))


def twist_message(stamp: int, velocity: tuple[float, float, float]) -> tuple[int, Any]:
    types = get_typestore(Stores.ROS2_JAZZY).types
    return stamp, types[TWIST](header=header(stamp), twist=twist(velocity))


def odometry_message(
    stamp: int, velocity: tuple[float, float, float], yaw: float, child: str = "vessel"
) -> tuple[int, Any]:
    types = get_typestore(Stores.ROS2_JAZZY).types
    covariance = np.zeros(36)
    pose = types["geometry_msgs/msg/Pose"](
        position=types["geometry_msgs/msg/Point"](0, 0, 0),
        orientation=types["geometry_msgs/msg/Quaternion"](
            0, 0, math.sin(yaw / 2), math.cos(yaw / 2)
        ),
    )
    return stamp, types[ODOMETRY](
        header=header(stamp),
        child_frame_id=child,
        pose=types["geometry_msgs/msg/PoseWithCovariance"](pose=pose, covariance=covariance),
        twist=types["geometry_msgs/msg/TwistWithCovariance"](
            twist=twist(velocity), covariance=covariance
        ),
    )


START = 1_700_000_000_000_000_000
SECOND = 1_000_000_000


def test_velocity_from_twist_stamped(tmp_path: Path) -> None:
    messages = [
        twist_message(START, (1, 2, 3)),
        twist_message(START + SECOND // 2, (4, 5, 6)),
    ]
    write_log(tmp_path / "run.mcap", {"/cmd_vel": (TWIST, messages)})
    expected = [(0, (1, 2, 3)), (0.5, (4, 5, 6))]
    assert rows(scene_with(tmp_path, file="run.mcap")) == expected
    assert rows(scene_with(tmp_path, file="run.mcap", topic="/cmd_vel")) == expected


def test_odometry_is_turned_from_the_vessel_frame_into_the_map(tmp_path: Path) -> None:
    messages = [
        odometry_message(START, (1, 0, 0.5), 0.0),
        odometry_message(START + SECOND, (1, 0, 0.5), math.pi / 2),
        odometry_message(START + 2 * SECOND, (1, 0, 0.5), math.pi / 2, child="map"),
    ]
    write_log(tmp_path / "run.mcap", {"/odom": (ODOMETRY, messages)})
    (_, ahead), (_, turned), (_, same) = rows(scene_with(tmp_path, file="run.mcap"))
    assert ahead == pytest.approx((1, 0, 0.5))
    assert turned == pytest.approx((0, 1, 0.5))
    assert same == (1, 0, 0.5)


def test_the_topic_must_be_clear(tmp_path: Path) -> None:
    two = {
        "/a": (TWIST, [twist_message(START, (1, 0, 0))]),
        "/b": (TWIST, [twist_message(START, (2, 0, 0))]),
    }
    write_log(tmp_path / "run.mcap", two)
    assert "(/a, /b)" in str(refusal(tmp_path, file="run.mcap"))
    assert refusal(tmp_path, file="run.mcap", topic="/c").allowed == "/a, /b"
    assert rows(scene_with(tmp_path, file="run.mcap", topic="/b")) == [(0, (2, 0, 0))]
    write_log(tmp_path / "empty.mcap", {})
    assert "0 topics" in str(refusal(tmp_path, file="empty.mcap"))


def test_stamps_must_rise(tmp_path: Path) -> None:
    messages = [twist_message(START, (1, 0, 0)), twist_message(START, (2, 0, 0))]
    write_log(tmp_path / "run.mcap", {"/a": (TWIST, messages)})
    assert "does not rise" in str(refusal(tmp_path, file="run.mcap"))


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: b"",
        lambda data: b"not a log",
        lambda data: data[: len(data) // 2],
        lambda data: data[:60] + b"\xff" * 40 + data[100:],
    ],
    ids=["empty", "other", "cut", "corrupt"],
)
def test_damaged_logs_are_refused(tmp_path: Path, damage: Callable[[bytes], bytes]) -> None:
    path = tmp_path / "run.mcap"
    write_log(path, {"/a": (TWIST, [twist_message(START, (1, 0, 0))])})
    path.write_bytes(damage(path.read_bytes()))
    assert refusal(tmp_path, file="run.mcap").path == "vessel.velocity.file"


def test_floor_from_csv(tmp_path: Path) -> None:
    (tmp_path / "grid.csv").write_text("x,y,z\n0,0,-10\n0,10,-20\n10,0,-30\n10,10,-40\n")
    (tmp_path / "line.csv").write_text("x,z\n0,-10\n10,-30\n")
    (tmp_path / "holes.csv").write_text("x,y,z\n0,0,-10\n0,10,-20\n10,0,-30\n")
    data = minimal() | {"environment": {"floor": {"depth_table": "grid.csv"}}}
    scene = cm.load_scene(data, folder=tmp_path)
    floor = scene.environment.floor
    assert floor is not None
    assert floor.grid_z.tolist() == [[-10, -20], [-30, -40]]
    assert floor.height(5, 5) == pytest.approx(-25, abs=1e-12)
    assert floor.height(-100, 100) == -20
    assert cm.load_scene(scene.to_yaml()) == scene
    data["environment"]["floor"]["depth_table"] = "line.csv"
    floor = cm.load_scene(data, folder=tmp_path).environment.floor
    assert floor is not None
    assert floor.height(5, 1234) == -20
    for name, words in (("holes.csv", "no z at x = 10 m, y = 10 m"), ("none.csv", "no file")):
        data["environment"]["floor"]["depth_table"] = name
        with pytest.raises(cm.SceneError, match=words):
            cm.load_scene(data, folder=tmp_path)


def test_the_vessels_own_motion_is_preferred_to_the_far_ends(tmp_path: Path) -> None:
    far = variables.resolved("~/end_odom")
    end = {far: (ODOMETRY, [odometry_message(START, (9, 0, 0), 0.0)])}
    own = {"/odom": (ODOMETRY, [odometry_message(START, (1, 0, 0), 0.0)])}
    applied = {
        "/cable/applied_odom": (ODOMETRY, [odometry_message(START, (2, 0, 0), 0.0)]),
        "/cable/applied_cmd_vel": (TWIST, [twist_message(START, (2, 0, 0))]),
    }
    for topics, speed, note in (
        (end, 9, f"vessel.velocity: the tow point moves as the far end .* by the topic {far}"),
        (own, 1, None),
        (end | own, 1, rf"the topic /odom is taken from run\.mcap, of {far}, /odom"),
        (end | own | applied, 2, r"the topic /cable/applied_odom is taken from run\.mcap"),
    ):
        write_log(tmp_path / "run.mcap", topics)
        scene = scene_with(tmp_path, file="run.mcap")
        assert rows(scene)[0][1][0] == speed
        assert bool(scene.notes) == (note is not None)
        if note is not None:
            assert re.search(note, scene.notes[0])
            assert scene_warnings(scene)[0] == scene.notes[0]
        for topic in topics:
            assert scene_with(tmp_path, file="run.mcap", topic=topic).notes == ()
    write_log(tmp_path / "run.mcap", end | own | {"/nav": own["/odom"]})
    assert "has 3 topics with velocities" in str(refusal(tmp_path, file="run.mcap"))


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("amplitude,period,phase_deg", "unknown column 'phase_deg', did you mean phase?"),
        ("amplitude,period,Phase", "unknown column 'Phase', did you mean phase?"),
        ("amplitude,period,note", "unknown column 'note'; allowed: the columns amplitude, period"),
        ("amplitude,period,amplitude", "column amplitude twice"),
    ],
)
def test_a_column_of_a_sea_that_would_be_dropped_is_refused(
    tmp_path: Path, header: str, words: str
) -> None:
    (tmp_path / "sea.csv").write_text(f"{header}\n1,8,90\n")
    data = minimal() | {"environment": {"waves": {"components": {"rows": "sea.csv"}}}}
    with pytest.raises(cm.SceneError) as caught:
        cm.load_scene(data, folder=tmp_path)
    assert caught.value.path == "environment.waves.components.rows"
    assert f"sea.csv: {words}" in str(caught.value)


def test_a_column_of_a_floor_that_would_be_dropped_is_refused(tmp_path: Path) -> None:
    """With Y for y, a grid was a profile, the same everywhere along y."""
    (tmp_path / "floor.csv").write_text("x,Y,z\n0,0,-10\n10,0,-20\n")
    data = minimal() | {"environment": {"floor": {"depth_table": "floor.csv"}}}
    with pytest.raises(cm.SceneError, match="unknown column 'Y', did you mean y"):
        cm.load_scene(data, folder=tmp_path)


@pytest.mark.parametrize(
    ("column", "words"),
    [
        ("v_x", "unknown column 'v_x', did you mean vx?"),
        ("vx_kn", "unknown column 'vx_kn', did you mean vx?"),
        ("vx", "column vx twice"),
        ("vx_raw", ""),
        ("wx", ""),
        ("T", ""),
        ("", ""),
    ],
)
def test_a_log_may_have_more_columns_but_none_like_a_known_one(
    tmp_path: Path, column: str, words: str
) -> None:
    (tmp_path / "log.csv").write_text(f"t,vx,vy,vz,{column}\n0,1,2,3,9\n")
    if words:
        assert words in str(refusal(tmp_path, file="log.csv"))
    else:
        assert rows(scene_with(tmp_path, file="log.csv")) == [(0, (1, 2, 3))]
