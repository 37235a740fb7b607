"""Messages that are made of objects: markers, the vessel's transform, diagnostics."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable

import numpy as np
import pytest
from cablemodel_ros import messages
from cablemodel_ros.diagnostics import WARN, Status
from cablemodel_ros.markers import Picture, markers
from cablemodel_ros.rig import Strand
from cablemodel_ros.times import Stamp
from std_msgs.msg import Float64
from visualization_msgs.msg import Marker, MarkerArray

from .conftest import NodeProcess, Talker, wait_until


def test_markers_draw_cable_bodies_and_tension() -> None:
    position = np.array([[0.0, 0, 0], [10, 0, -10], [20, 0, -20]])
    tension = np.array([100.0, 50.0, -1.0])
    strands = [Strand("", position, tension, 100.0), Strand("tow: ", position, tension, 7.0)]
    picture = Picture(strands, [position[1]], 0.02)
    found = markers(picture, messages.message_time(Stamp(1_500_000_000))).markers
    line, figures, _, others, body = found
    assert [marker.id for marker in found] == [0, 1, 2, 3, 4]
    assert line.type == Marker.LINE_STRIP
    assert [(p.x, p.z) for p in line.points] == [(0, 0), (10, -10), (20, -20)]
    assert (line.colors[0].r, line.colors[0].b) == (1.0, 0.0)
    assert (line.colors[2].r, line.colors[2].b) == (1.0, 1.0)  # pushed
    assert figures.text == "100 N"
    assert others.text == "tow: 7 N"
    assert body.pose.position.x == 10
    assert line.header.frame_id == "map"
    assert (line.header.stamp.sec, line.header.stamp.nanosec) == (1, 500_000_000)


def test_diagnostics_carry_level_message_and_values() -> None:
    status = Status("commands", WARN, ["a", "b"], {"count": "3"})
    (made,) = messages.diagnostics([status], "cable", messages.message_time(Stamp(0))).status
    assert made.level == b"\x01"
    assert (made.name, made.message) == ("cable: commands", "a; b")
    assert (made.values[0].key, made.values[0].value) == ("count", "3")


def test_the_node_draws_the_cable_and_leaves_tf_out_where_there_is_none(
    start_node: Callable[..., NodeProcess], talker: Talker
) -> None:
    node = start_node(vessel_input="scene", payout_input="scene", autostart=True, tf=True,
                      markers_rate=10, stations=11)  # fmt: skip
    pictures = talker.listen("/cable/markers", MarkerArray)
    tensions = talker.listen("/cable/tension_top", Float64)
    wait_until(lambda: len(pictures) > 1, 300)
    line = pictures[-1].markers[0]
    assert len(line.points) == len(line.colors) == 11
    assert line.points[-1].z == pytest.approx(-50, abs=0.1)
    assert pictures[-1].markers[1].text == f"{tensions[-1].data:.0f} N"
    if importlib.util.find_spec("tf2_msgs") is None:
        assert "/tf is left out: no tf2_msgs/msg/TFMessage here" in node.text
