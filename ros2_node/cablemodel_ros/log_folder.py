"""The folder of a node's logs: which files are its own, which go, and what makes them one bag.

A list beside the logs names the files that this node wrote, and how each begins. Only these go when
there are too many: a file that was renamed or copied, or that somebody else put there, stays.
``metadata.yaml`` makes a bag of the finished files, as `ros2 bag play FOLDER` needs it; one that
another wrote is left alone.
"""

from __future__ import annotations

import json
import os
import time
import zlib
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import yaml

BAG = "metadata.yaml"
_HEAD_BYTES = 4096
_OWNER = "cablemodel_node"
_BAG_VERSION = 9  # of rosbag2 in ROS 2 Jazzy


class LogFolder:
    """Names, counts and removes a node's own logs.

    Args:
        folder: where they are; it is made when the first file is.
        node: full name of the node: ``/tug/cable``.
        max_files: most files of this node's that stay.

    Attributes: ``problem`` (why there is no bag of them; empty if there is).
    """

    def __init__(self, folder: Path, node: str, max_files: int) -> None:
        self._folder, self._node, self._max_files = folder, node, max_files
        self._name = node.strip("/").replace("/", "_")
        self._list = folder / f".{self._name}_logs.json"
        self._number = 0
        self.problem = ""

    def new(self) -> Path:
        """Path of the next file: ``cable_<date>_<number>.mcap``, or ``tug_cable_...``."""
        self._folder.mkdir(parents=True, exist_ok=True)
        day = time.strftime("%Y%m%dT%H%M%S", time.gmtime())
        while True:
            path = self._folder / f"{self._name}_{day}_{self._number:04d}.mcap"
            self._number += 1
            if not path.exists():
                return path

    def opened(self, path: Path) -> None:
        """The file is there, and it is ours."""
        length = min(path.stat().st_size, _HEAD_BYTES)
        entry = {"file": path.name, "length": length, "head": _head(path, length)}
        self._write([*self._entries(), entry])

    def forget(self, path: Path) -> None:
        """Remove a file in which there is nothing."""
        with suppress(OSError):
            path.unlink()
        self._write([entry for entry in self._entries() if entry["file"] != path.name])

    def make_room(self) -> None:
        """Remove our oldest files beyond those that may stay."""
        entries = self._entries()
        for entry in entries[: max(0, len(entries) - self._max_files)]:
            with suppress(FileNotFoundError):
                (self._folder / entry["file"]).unlink()
        self._write(entries[-self._max_files :])
        self._write_bag()

    def finished(self, path: Path) -> None:
        """The file is complete: it becomes part of the bag."""
        entries = self._entries()
        for entry in entries:
            if entry["file"] == path.name:
                entry["bag"] = _contents(path)
        self._write(entries)
        self._write_bag()

    def _entries(self) -> list[dict[str, Any]]:
        """Our files that still are what we wrote, the oldest first."""
        try:
            listed = json.loads(self._list.read_text(encoding="utf-8"))["files"]
        except (OSError, ValueError, KeyError, TypeError):
            return []
        found = []
        for entry in listed:
            with suppress(OSError):
                if _head(self._folder / entry["file"], entry["length"]) == entry["head"]:
                    found.append(entry)
        return found

    def _write(self, entries: list[dict[str, Any]]) -> None:
        _replace(self._list, json.dumps({"node": self._node, "files": entries}, indent=1))

    def _write_bag(self) -> None:
        """Write ``metadata.yaml`` of all finished files that are there."""
        path = self._folder / BAG
        owner = _owner_of(path) or self._node
        self.problem = "" if owner == self._node else f"{path} is of {owner}: left as it is"
        files = [entry for entry in self._entries() if entry.get("bag")]
        if self.problem or not files:
            return
        # JSON is YAML too, and takes a hundredth of the time and memory to write.
        _replace(path, json.dumps(_bag(self._node, files), indent=1))


def _owner_of(bag: Path) -> str:
    """The node that wrote a bag's ``metadata.yaml``; empty where there is none."""
    try:
        information = json.loads(bag.read_text(encoding="utf-8"))["rosbag2_bagfile_information"]
        return str(information["custom_data"][_OWNER])
    except FileNotFoundError:
        return ""
    except (ValueError, KeyError, TypeError):  # ours would be JSON
        return "somebody else"


@cache
def _profiles(text: str) -> Any:
    """QoS profiles of a channel, of which a log has one or two."""
    return yaml.safe_load(text or "[]")


def _head(path: Path, length: int) -> int:
    """Checksum of the beginning of a log: scene and time, which no two logs have in common."""
    with path.open("rb") as file:
        return zlib.crc32(file.read(length))


def _replace(path: Path, text: str) -> None:
    """Write a file such that it is the old or the new one at every moment."""
    part = path.with_name(f"{path.name}.part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)


def _contents(path: Path) -> dict[str, Any]:
    """What ``metadata.yaml`` tells of a finished file."""
    from mcap.reader import SeekingReader

    with path.open("rb") as file:
        summary = SeekingReader(file).get_summary()
    assert summary is not None
    statistics = summary.statistics
    assert statistics is not None
    return {
        "begin": statistics.message_start_time,
        "end": statistics.message_end_time,
        "topics": [
            {
                "name": channel.topic,
                "type": summary.schemas[channel.schema_id].name,
                "qos": channel.metadata.get("offered_qos_profiles", ""),
                "hash": channel.metadata.get("topic_type_hash", ""),
                "count": statistics.channel_message_counts.get(channel.id, 0),
            }
            for channel in summary.channels.values()
        ],
    }


def _bag(node: str, files: list[dict[str, Any]]) -> dict[str, Any]:
    """``metadata.yaml`` as rosbag2 writes it."""
    topics: dict[str, dict[str, Any]] = {}
    entries = []
    for item in files:
        bag = item["bag"]
        for topic in bag["topics"]:
            known = topics.setdefault(topic["name"], {**topic, "count": 0})
            known["count"] += topic["count"]
        entries.append(
            {
                "path": item["file"],
                "starting_time": {"nanoseconds_since_epoch": bag["begin"]},
                "duration": {"nanoseconds": bag["end"] - bag["begin"]},
                "message_count": sum(topic["count"] for topic in bag["topics"]),
            }
        )
    begin = min(item["bag"]["begin"] for item in files)
    end = max(item["bag"]["end"] for item in files)
    information = {
        "version": _BAG_VERSION,
        "storage_identifier": "mcap",
        "duration": {"nanoseconds": end - begin},
        "starting_time": {"nanoseconds_since_epoch": begin},
        "message_count": sum(entry["message_count"] for entry in entries),
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": topic["name"],
                    "type": topic["type"],
                    "serialization_format": "cdr",
                    "offered_qos_profiles": _profiles(topic["qos"]),
                    "type_description_hash": topic["hash"],
                },
                "message_count": topic["count"],
            }
            for topic in topics.values()
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [entry["path"] for entry in entries],
        "files": entries,
        "custom_data": {_OWNER: node},
        "ros_distro": "jazzy",
    }
    return {"rosbag2_bagfile_information": information}
