"""Messages of /tf, as rosbags reads them."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from cablemodel_ros.frames import heading_rotation
from cablemodel_ros.line_rig import LineRig
from cablemodel_ros.rig import Frame
from cablemodel_ros.settings import Settings
from cablemodel_ros.timebase import RealTime
from cablemodel_ros.times import Stamp
from cablemodel_ros.transforms import Transforms

import cablemodel as cm
from cablemodel.results.log.messages import quaternion_of, typestore

KIND = "tf2_msgs/msg/TFMessage"
SCENE = Path(__file__).parents[3] / "scenes/towed_cable.yaml"


def read(data: bytes) -> Any:
    """Its transforms; the bytes are those that rosbags makes of them."""
    message = typestore().deserialize_cdr(data, KIND)
    assert bytes(typestore().serialize_cdr(message, KIND)) == data
    return message.transforms


def test_the_vessel_frame_is_where_the_tow_point_says() -> None:
    def transforms(**asked: bool) -> Any:
        """Of a vessel that heads north, with its tow point at (10, 20, 0.5)."""
        settings = Settings.of({"scene": str(SCENE), "tow_point": [-2.0, 0.0, 0.5], **asked})
        rig = LineRig(cm.load_scene(SCENE), settings, RealTime())
        rig.model = SimpleNamespace(vessel_position=np.array([10.0, 20.0, 0.5]))  # type: ignore[assignment]
        rig.helm.rotation = heading_rotation(math.pi / 2)
        return read(Transforms().message(Stamp(2_000_000_000), rig.frames()))

    (own,) = transforms(tf=True)  # the vessel's frame is not ours
    assert (own.header.frame_id, own.child_frame_id) == ("map", "tow_point")
    place = own.transform.translation
    assert (place.x, place.y, place.z) == (10.0, 20.0, 0.5)
    assert own.transform.rotation.w == 1.0
    (transform,) = transforms(tf_vessel=True)
    place, turn = transform.transform.translation, transform.transform.rotation
    assert (place.x, place.y, place.z) == pytest.approx((10.0, 22.0, 0.0))
    assert (turn.z, turn.w) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))
    assert (transform.header.frame_id, transform.child_frame_id) == ("map", "base_link")


def test_names_may_be_of_any_length_and_change() -> None:
    made = Transforms()
    for count in (1, 2, 9, 2, 0):
        frames = [
            Frame("främe"[:k] + "x" * k, np.array([k, -0.0, 1e-9]), heading_rotation(0.3 * k))
            for k in range(count)
        ]
        for ns in (0, 1_700_000_000_123_456_789):
            found = read(made.message(Stamp(ns), frames))
            assert [transform.child_frame_id for transform in found] == [f.name for f in frames]
            for frame, transform in zip(frames, found, strict=True):
                stamp, at = transform.header.stamp, transform.transform
                assert (stamp.sec, stamp.nanosec) == divmod(ns, 1_000_000_000)
                place, turn = at.translation, at.rotation
                assert [place.x, place.y, place.z] == frame.position.tolist()
                assert (turn.x, turn.y, turn.z, turn.w) == quaternion_of(frame.axes)
