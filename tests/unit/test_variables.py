"""The one table of variables."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import cablemodel as cm
from cablemodel import variables

DOCUMENT = Path(__file__).parents[2] / "docs" / "variables.md"
INTERFACES = {
    # The contract with users: Python name to FMU name and topic.
    "top_tension": ("tension.top", "~/tension_top"),
    "tension_min": ("tension.min", "~/tension_min"),
    "tension_max": ("tension.max", "~/tension_max"),
    "slack_time": ("slack.time", "~/slack"),
    "slack_longest": ("slack.longest", "~/slack"),
    "slack_since": ("slack.since", "~/slack"),
    "slack_start": ("slack.start", "~/slack"),
    "slack_end": ("slack.end", "~/slack"),
    "top_force": ("force.top[i]", "~/top_wrench"),
    "top_moment": ("moment.top[i]", "~/top_wrench"),
    "tip_position": ("end.position[i]", "~/end_odom"),
    "tip_velocity": ("end.velocity[i]", "~/end_odom"),
    "bodies.position": ("body[j].position[i]", "~/bodies"),
    "bodies.direction": ("body[j].direction[i]", "~/bodies"),
    "line_length": ("line.length", "~/line_length"),
    "drum_length": ("drum.length", "~/drum_length"),
    "payout_rate": ("payout.applied", "~/payout_rate"),
    "state.position": ("line.position[k,i]", "~/nodes"),
    "state.tension": ("line.tension[k]", "~/nodes"),
    "state.curvature": ("line.curvature[k]", "~/nodes"),
    "touchdown_position": ("touchdown.position[i]", "~/touchdown"),
    "touchdown_reaction": ("touchdown.reaction", "~/touchdown_reaction"),
    "floor_force": ("floor.force[i]", "~/floor_force"),
    "floor_length": ("floor.length", "~/floor_length"),
    "position_error": ("error.position", "~/position_error"),
    "tension_error": ("error.tension", "~/tension_error"),
}


def test_the_page_of_the_docs_is_up_to_date() -> None:
    assert DOCUMENT.read_text(encoding="utf-8") == variables.document()


def test_names_are_those_that_users_were_promised() -> None:
    found = {row.python: (row.fmu, row.topic) for row in variables.OUTPUTS if row.fmu}
    assert found == INTERFACES


def test_a_topic_has_one_message_type_and_one_condition() -> None:
    for topic in {row.topic for row in variables.OUTPUTS}:
        rows = [row for row in variables.OUTPUTS if row.topic == topic]
        assert len({(row.message, row.present) for row in rows}) == 1, topic


def test_names_are_unique() -> None:
    for names in (
        [row.python for row in variables.OUTPUTS],
        [row.fmu for row in variables.OUTPUTS if row.fmu],
        [item.python for item in variables.INPUTS],
        list(variables.STATE_LABELS),
        list(variables.APPLIED_INPUT_LABELS),
    ):
        assert len(set(names)) == len(names)


def test_fmu_names_are_structured_and_count_from_one() -> None:
    rows = {row.python: row for row in variables.OUTPUTS}
    assert list(rows["top_tension"].fmu_names()) == ["tension.top"]
    assert list(rows["top_force"].fmu_names()) == ["force.top[1]", "force.top[2]", "force.top[3]"]
    assert list(rows["state.position"].fmu_names(stations=2)) == [
        "line.position[1,1]", "line.position[1,2]", "line.position[1,3]",
        "line.position[2,1]", "line.position[2,2]", "line.position[2,3]",
    ]  # fmt: skip
    assert list(rows["bodies.direction"].fmu_names(bodies=2))[3] == "body[2].direction[1]"
    assert list(rows["state.s"].fmu_names(stations=2)) == []


def test_every_fmu_name_fits_the_grammar_of_structured_names() -> None:
    structured = re.compile(r"[a-z]+(\[\d+\])?(\.[a-z]+)*(\[\d+(,\d+)*\])?")
    for row in variables.OUTPUTS:
        for name in row.fmu_names(bodies=2, stations=3):
            assert structured.fullmatch(name), name


def test_labels_name_every_component() -> None:
    assert variables.STATE_LABELS[:5] == (
        "s", "position.x", "position.y", "position.z", "tangent.x",
    )  # fmt: skip
    assert len(variables.STATE_LABELS) == sum(count for _, count in variables.STATE_FIELDS)
    place = variables.span(variables.STATE_FIELDS, "velocity")
    assert variables.STATE_LABELS[place] == ("velocity.x", "velocity.y", "velocity.z")
    with pytest.raises(KeyError):
        variables.span(variables.STATE_FIELDS, "colour")


@pytest.mark.parametrize(
    ("line", "drum", "floor", "expected"),
    [
        ([], [], None, {"always"}),
        ([], [], None, {"always", "error_estimate"}),
        (["body"], [], None, {"always", "bodies"}),
        ([], ["cable"], None, {"always", "drum"}),
        ([], ["body"], object(), {"always", "drum", "bodies", "floor"}),
    ],
)
def test_a_scene_has_only_the_variables_of_its_parts(
    line: list[str], drum: list[str], floor: object, expected: set[str]
) -> None:
    def items(kinds: list[str]) -> list[SimpleNamespace]:
        return [SimpleNamespace(body=object() if kind == "body" else None) for kind in kinds]

    scene = SimpleNamespace(
        line=items(line),
        payout=SimpleNamespace(drum=items(drum)),
        environment=SimpleNamespace(floor=floor),
        solver=SimpleNamespace(error_estimate="error_estimate" in expected),
    )
    assert variables.features(scene) == expected
    topics = variables.topics_of(scene)
    assert ("/cable/touchdown" in topics) == (floor is not None)
    assert ("/cable/bodies" in topics) == ("bodies" in expected)
    assert ("/cable/drum_length" in topics) == ("drum" in expected)
    assert ("/cable/position_error" in topics) == ("error_estimate" in expected)
    assert topics["/cable/nodes"] == "sensor_msgs/msg/PointCloud2"


@pytest.mark.parametrize("method", ["finite_element", "direct_integration"])
def test_nothing_touches_down_without_a_floor(method: str) -> None:
    """Python's attributes are there in all scenes: what is nowhere is no point."""
    scene = cm.load_scene(
        {
            "cable_types": {"K": {"diameter": 0.02, "mass": 0.5, "axial_stiffness": 1e6}},
            "line": [{"cable": {"type": "K", "length": 20}}],
            "vessel": {"velocity": [1, 0, 0]},
            "solver": {"method": method},
        }
    )
    model = cm.CableModel(scene)
    model.step(0.5)
    assert np.isnan(model.touchdown_position).all()
    assert not model.floor_force.any()
    assert (model.floor_length, model.touchdown_reaction) == (0.0, 0.0)
