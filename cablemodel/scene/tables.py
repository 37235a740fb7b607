"""Tables that a scene names by file: CSV of any kind, and a vessel's motion from an MCAP log."""

from __future__ import annotations

import csv
import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import shown
from cablemodel.scene.base import rising
from cablemodel.scene.problems import suggestion
from cablemodel.scene.units import rejection

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

FloatArray = NDArray[np.float64]

_FAR_END = "/end_odom"
"""How the topic of the far end's motion ends, in the logs of this project."""
_TOW_POINT = "/applied_odom"
"""And that of the tow point's."""
_OTHER_UNITS = ("deg", "degree", "degrees", "kn", "kt", "knot", "knots", "kmh", "km/h")
"""What a column's name may end with that is in another unit than the one that is read."""


def velocity_from_file(
    name: str, context: Any, topic: str | None, at: tuple[str, ...]
) -> tuple[FloatArray, FloatArray]:
    """Times (n,) [s] and velocities (n, 3) [m/s], ENU, of a vessel from a CSV or MCAP file.

    Args:
        name: the file, relative to the folder of the scene.
        context: validation context; ``context["folder"]`` is that folder.
        topic: of the MCAP file; None where it holds only one that fits, but for those of a run of
            this project: of these it is the tow point's, and the far end's if there is no other.
            What is chosen with a doubt is noted in the context's ``notes``.
        at: place of the file's name below the validated value, for messages.

    Raises:
        PydanticCustomError: no such file, or not a table of velocities.
    """
    return _motion_from_file(name, context, topic, at, VELOCITIES)


def attitudes_from_file(
    name: str, context: Any, topic: str | None, at: tuple[str, ...]
) -> tuple[FloatArray, FloatArray]:
    """Times (n,) [s] and roll, pitch and yaw (n, 3) [rad] of a vessel; the rest is that of
    `velocity_from_file`."""
    times, values = _motion_from_file(name, context, topic, at, ATTITUDES)
    return times, np.unwrap(values, axis=0)


def _motion_from_file(
    name: str, context: Any, topic: str | None, at: tuple[str, ...], kind: MotionInFile
) -> tuple[FloatArray, FloatArray]:
    path = _found(name, context, at)
    if path.suffix.lower() == ".mcap":
        return _motion_from_mcap(path, topic, at, (context or {}).get("notes", []), kind)
    if topic is not None:
        allowed = "no topic with a CSV file"
        raise rejection("only an MCAP file has topics", allowed, topic, (*at[:-1], "topic"))
    columns = _columns_from_csv(path, ("t", *kind.columns), (), at, is_log=True)
    times = columns["t"]
    early = np.flatnonzero(np.diff(times) <= 0.0)
    if len(early):
        row = int(early[0]) + 1
        word = "twice the same t" if times[row] == times[row - 1] else "out of order: t"
        problem = f"row {row + 1} of {path.name}: {word} ({times[row]:g} after {times[row - 1]:g})"
        raise rejection(problem, rising("t"), path.name, at)
    return times, np.stack([columns[name] for name in kind.columns], axis=1)


def table_from_file(
    name: str, context: Any, columns: Sequence[str], optional: Sequence[str] = ()
) -> dict[str, FloatArray]:
    """Columns (n,) of a CSV file with a header, SI, by name.

    Raises:
        PydanticCustomError: no such file, a missing or unknown column, or a cell that is not a
            number.
    """
    return _columns_from_csv(_found(name, context, ()), columns, optional, ())


def rows_from_file(
    name: str, context: Any, columns: Sequence[str], optional: Sequence[str] = ()
) -> list[dict[str, float]]:
    """The same by rows."""
    table = table_from_file(name, context, columns, optional)
    return [dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)]


def _found(name: str, context: Any, at: tuple[str, ...]) -> Path:
    folder = Path((context or {}).get("folder", "."))
    path = folder / name
    try:
        exists = path.is_file()
    except (OSError, ValueError):  # a name too long, or with a zero byte
        exists = False
    if not exists:
        allowed = f"a file, relative to {folder}"
        raise rejection(f"there is no file {shown(name)}", allowed, name, at)
    return path


def _columns_from_csv(
    path: Path,
    columns: Sequence[str],
    optional: Sequence[str],
    at: tuple[str, ...],
    *,
    is_log: bool = False,
) -> dict[str, FloatArray]:
    """By name. Of a log, which may hold more, only columns are refused that are like known ones."""
    allowed = f"a CSV file with commas, a first line {','.join(columns)}"
    allowed += f" (and {','.join(optional)})" if optional else ""
    allowed += " and below it numbers in SI"
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            reader = csv.reader(stream)
            header = [cell.strip() for cell in next(filter(_is_filled, reader), [])]
            for column in columns:
                if column not in header:
                    problem = f"{path.name} has no column {column}, its first line is"
                    problem += f" {shown(','.join(header))}"
                    raise rejection(problem, allowed, path.name, at)
            known = (*columns, *optional)
            _refuse_columns(path.name, header, known, _like_known if is_log else _unknown, at)
            names = [column for column in known if column in header]
            places = [header.index(column) for column in names]
            first = reader.line_num  # the lines before it are the header's
        table = _numbers(path, first, places)
        if table is None:
            table = _cells(path, first, dict(zip(names, places, strict=True)), allowed, at)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise rejection(f"{path.name} cannot be read ({error})", allowed, path.name, at) from None
    if len(table) == 0:
        raise rejection(f"{path.name} has no rows", allowed, path.name, at)
    return dict(zip(names, np.ascontiguousarray(table.T), strict=True))


def _refuse_columns(
    name: str,
    header: Sequence[str],
    known: tuple[str, ...],
    word_about: Callable[[str, tuple[str, ...]], str],
    at: tuple[str, ...],
) -> None:
    """Reject columns that would be read twice, or not at all; one without a name holds nothing."""
    told = [f"column {column} twice" for column in known if header.count(column) > 1]
    others = dict.fromkeys(column for column in header if column and column not in known)
    told += filter(None, (word_about(column, known) for column in others))
    if told:
        raise rejection(f"{name}: {'; '.join(told)}", f"the columns {', '.join(known)}", name, at)


def _unknown(column: str, known: tuple[str, ...]) -> str:
    """About a column that none of the known ones is."""
    near = suggestion(column, list(known))
    if not near:  # the same word, with or without its unit
        word = column.lower()
        longer = sorted((other for other in known if other.startswith(f"{word}_")), key=len)
        shorter = [other for other in known if word.startswith(f"{other}_")]
        like = longer[:1] or sorted(shorter, key=len)[-1:]
        near = f", did you mean {like[0]}?" if like else ""
    return f"unknown column {shown(column)}{near}"


def _like_known(column: str, known: tuple[str, ...]) -> str:
    """The same, where it may be meant for a known one; else nothing."""
    stem, _, unit = column.lower().replace("[", "_").rstrip("] )").replace("(", "_").rpartition("_")
    words = [other for other in known if len(other) > 1]  # T is a temperature beside t
    other_unit = unit.strip() in _OTHER_UNITS and stem.strip(" _") in words
    return _unknown(column, known) if other_unit or suggestion(column, words) else ""


def _is_filled(line: list[str]) -> bool:
    return bool("".join(line).strip())


def _numbers(path: Path, first: int, places: Sequence[int]) -> FloatArray | None:
    """The cells in some columns below a line, (rows, columns); None: they are not all numbers."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # no rows
            table = np.loadtxt(
                path, delimiter=",", skiprows=first, usecols=places, ndmin=2, comments=None,
                quotechar='"', encoding="utf-8-sig",
            )  # fmt: skip
    except ValueError:
        return None
    return table if np.isfinite(table).all() else None


def _cells(
    path: Path, first: int, places: Mapping[str, int], allowed: str, at: tuple[str, ...]
) -> FloatArray:
    """The same, cell by cell: slowly, and with a word about the one that is none."""
    rows = []
    with path.open(newline="", encoding="utf-8-sig") as stream:
        reader = csv.reader(stream)
        for line in reader:
            if reader.line_num <= first or not _is_filled(line):
                continue
            row = []
            for column, place in places.items():
                cell = line[place] if place < len(line) else ""
                try:
                    number = float(cell)
                except ValueError:
                    number = math.nan
                if not math.isfinite(number):
                    problem = f"line {reader.line_num} of {path.name}, column {column}: "
                    problem += f"{shown(cell)} is no finite number"
                    raise rejection(problem, allowed, ",".join(line), at)
                row.append(number)
            rows.append(row)
    return np.array(rows).reshape(-1, len(places))


def _motion_from_mcap(
    path: Path, topic: str | None, at: tuple[str, ...], notes: list[str], kind: MotionInFile
) -> tuple[FloatArray, FloatArray]:
    """Times and values of the messages on a topic; t = 0 is the first one's stamp."""
    from mcap.reader import make_reader
    from rosbags.typesys import Stores, get_typestore

    allowed = f"an MCAP file with a topic of {' or '.join(kind.types)} in CDR"
    try:
        with path.open("rb") as stream:
            reader = make_reader(stream)
            summary = reader.get_summary()
            offered = _topics_of(summary, kind)
            chosen = _chosen(offered, topic, path, allowed, at, notes, kind)
            types = get_typestore(Stores.ROS2_JAZZY)
            rows = [
                _row(types, offered[chosen], message.data, kind)
                for _, _, message in reader.iter_messages(topics=[chosen])
            ]
    except _RefusedError as refused:
        raise refused.rejection from None
    except Exception as error:  # a damaged file makes the libraries fail in any of many ways
        problem = f"{path.name} cannot be read ({type(error).__name__}: {error})"
        raise rejection(problem, allowed, path.name, at) from None
    if not rows:
        raise rejection(f"{path.name} has no message on {chosen}", allowed, path.name, at)
    start = rows[0][0]
    times: list[float] = []
    for stamp, value in rows:
        seconds = (stamp - start) * 1e-9
        if not all(map(math.isfinite, value)) or (times and seconds <= times[-1]):
            problem = f"{chosen} in {path.name}, {seconds:g} s after its start: "
            problem += f"the {kind.word} is not finite, or the time stamp does not rise"
            raise rejection(problem, allowed, path.name, at)
        times.append(seconds)
    return np.array(times), np.array([value for _, value in rows], dtype=np.float64)


class _RefusedError(Exception):
    """Carries a rejection past the net for damaged files."""

    def __init__(self, problem: str, allowed: str, value: Any, at: tuple[str, ...]) -> None:
        super().__init__(problem)
        self.rejection = rejection(problem, allowed, value, at)


def _topics_of(summary: Any, kind: MotionInFile) -> dict[str, str]:
    """Message type by topic, for the topics that can give it."""
    topics = {}
    for channel in summary.channels.values() if summary is not None else ():
        schema = summary.schemas.get(channel.schema_id)
        if channel.message_encoding == "cdr" and schema and schema.name in kind.types:
            topics[channel.topic] = schema.name
    return topics


def _chosen(
    offered: dict[str, str],
    topic: str | None,
    path: Path,
    allowed: str,
    at: tuple[str, ...],
    notes: list[str],
    kind: MotionInFile,
) -> str:
    names = ", ".join(sorted(offered)) or "none"
    if topic is None and offered:
        # The far end is at the other end of the line, whatever else there is.
        other = [name for name in offered if not name.endswith(_FAR_END)] or list(offered)
        kept = [name for name in other if name.endswith(_TOW_POINT)] or other
        if len(kept) == 1:
            chosen = kept[0]
            if chosen.endswith(_FAR_END):
                notes.append(
                    f"{kind.place}: the tow point moves as the far end of the line in "
                    f"{path.name} did, by the topic {chosen}: it is the only one with {kind.words} "
                    "there"
                )
            elif len(offered) > 1:
                notes.append(
                    f"{kind.place}: the topic {chosen} is taken from {path.name}, of {names}"
                )
            return chosen
    if topic is None:
        problem = f"{path.name} has {len(offered)} topics with {kind.words} ({names})"
        raise _RefusedError(problem, "topic: one of them" if offered else allowed, path.name, at)
    if topic not in offered:
        where = (*at[:-1], "topic")
        raise _RefusedError(f"{path.name} has no such topic with {kind.words}", names, topic, where)
    return topic


def _row(
    types: Typestore, type_name: str, data: bytes, kind: MotionInFile
) -> tuple[int, tuple[float, float, float]]:
    """Time stamp [ns] and value (3,) of one message."""
    message: Any = types.deserialize_cdr(data, type_name)
    stamp = message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec
    return stamp, kind.value(message, type_name)


def _velocity(message: Any, type_name: str) -> tuple[float, float, float]:
    """Velocity [m/s] in the fixed frame. Odometry gives its twist in the child frame, so it is
    turned by the pose; TwistStamped is taken to be in the map frame."""
    if type_name == "geometry_msgs/msg/TwistStamped":
        linear = message.twist.linear
        return linear.x, linear.y, linear.z
    linear = message.twist.twist.linear
    velocity = (linear.x, linear.y, linear.z)
    if message.child_frame_id in ("", message.header.frame_id):
        return velocity
    turn = message.pose.pose.orientation
    return _turned(velocity, (turn.x, turn.y, turn.z, turn.w))


def _attitude(message: Any, type_name: str) -> tuple[float, float, float]:
    """Roll, pitch and yaw [rad] of the orientation in the fixed frame."""
    from scipy.spatial.transform import Rotation

    holder = message if type_name == "sensor_msgs/msg/Imu" else message.pose
    turn = (holder.pose if type_name == "nav_msgs/msg/Odometry" else holder).orientation
    quaternion = (turn.x, turn.y, turn.z, turn.w)
    if not any(quaternion):  # it was never filled in
        return math.nan, math.nan, math.nan
    roll, pitch, yaw = Rotation.from_quat(quaternion).as_euler("xyz")
    return float(roll), float(pitch), float(yaw)


def _turned(
    vector: tuple[float, float, float], quaternion: tuple[float, float, float, float]
) -> tuple[float, float, float]:
    """A vector turned by a quaternion (x, y, z, w) of any length."""
    x, y, z, w = quaternion
    norm = x * x + y * y + z * z + w * w
    if norm == 0.0:  # a message whose orientation was never filled in
        return vector
    a, b, c = vector
    # t = 2 q x v; v' = v + (w t + q x t)/|q|^2
    t = (2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a))
    return (
        a + (w * t[0] + y * t[2] - z * t[1]) / norm,
        b + (w * t[1] + z * t[0] - x * t[2]) / norm,
        c + (w * t[2] + x * t[1] - y * t[0]) / norm,
    )


@dataclass(frozen=True)
class MotionInFile:
    """What a file gives of a vessel's motion over time."""

    place: str
    """Key of the scene."""
    word: str
    words: str
    columns: tuple[str, str, str]
    """Of a CSV file, SI."""
    types: tuple[str, ...]
    """Of messages."""
    value: Callable[[Any, str], tuple[float, float, float]]
    """Of a message, by its type."""


VELOCITIES = MotionInFile(
    "vessel.velocity", "velocity", "velocities", ("vx", "vy", "vz"),
    ("nav_msgs/msg/Odometry", "geometry_msgs/msg/TwistStamped"), _velocity,
)  # fmt: skip
ATTITUDES = MotionInFile(
    "attitude", "attitude", "orientations", ("roll", "pitch", "yaw"),
    ("nav_msgs/msg/Odometry", "geometry_msgs/msg/PoseStamped", "sensor_msgs/msg/Imu"), _attitude,
)  # fmt: skip
