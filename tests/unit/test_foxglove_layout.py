"""The Foxglove layout shows topics that logs have."""

import json
import re
from pathlib import Path
from typing import Any

from cablemodel.variables import OUTPUTS

ROOT = Path(__file__).parents[2]
LAYOUT: dict[str, Any] = json.loads((ROOT / "docs/foxglove/cablemodel.json").read_text())
PANELS = LAYOUT["configById"]
TOPICS = {row.resolved_topic: row.message for row in OUTPUTS}
DRAWN_IN_3D = {
    "sensor_msgs/msg/PointCloud2", "nav_msgs/msg/Odometry", "geometry_msgs/msg/PoseArray",
    "geometry_msgs/msg/PointStamped",
}  # fmt: skip


def test_the_shape_panel_shows_topics_of_the_table() -> None:
    topics = PANELS["3D!shape"]["topics"]
    assert topics["/cable/nodes"]["colorField"] == "tension"
    for topic in topics:
        assert TOPICS[topic] in DRAWN_IN_3D, topic


def test_plots_show_members_of_the_table() -> None:
    paths = [
        path["value"]
        for name, panel in PANELS.items()
        if name.startswith("Plot!")
        for path in panel["paths"]
    ]
    assert len(paths) > 5
    for path in paths:
        topic, member = re.fullmatch(r"(/cable/\w+)\.(.+)", path).groups()  # type: ignore[union-attr]
        members = {row.member or "data" for row in OUTPUTS if row.resolved_topic == topic}
        assert member in members or member.rpartition(".")[0] in members, path


def test_every_panel_has_a_place() -> None:
    def panels(place: Any) -> set[str]:
        if isinstance(place, str):
            tabs = PANELS[place].get("tabs", [])
            return {place}.union(*(panels(tab["layout"]) for tab in tabs))
        return panels(place["first"]) | panels(place["second"])

    assert panels(LAYOUT["layout"]) == set(PANELS)
