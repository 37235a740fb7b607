"""Parameters: one table, checked values, errors in plain words."""

from __future__ import annotations

import ast
import dataclasses
import math
from pathlib import Path

import pytest
import yaml
from cablemodel_ros import interface, settings
from cablemodel_ros.settings import PARAMETERS, Settings, SettingsError

ROOT = Path(__file__).parents[3]
PACKAGE = ROOT / "ros2_node/cablemodel_ros"
WITH_ROS = {"inputs", "outputs", "node", "messages", "markers", "neighbours"}


def test_every_parameter_is_a_setting_and_its_default_is_allowed() -> None:
    assert [p.attribute for p in PARAMETERS] == [f.name for f in dataclasses.fields(Settings)]
    made = Settings.of()
    for parameter in PARAMETERS:
        assert getattr(made, parameter.attribute) == parameter.default
        assert parameter.description


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("rate", 0.0), ("rate", math.nan), ("rate", "fast"), ("rate", True),
        ("stations", 1), ("stations", 2.5), ("vessel_input", "wind"), ("publish_clock", 1),
        ("tow_point", [0.0, 1.0]), ("tow_point", [0.0, math.inf, 1.0]), ("scene", 5),
        ("limits.speed", -1.0), ("log.max_files", 0),
    ],
)  # fmt: skip
def test_impossible_values_are_refused_by_name(name: str, value: object) -> None:
    with pytest.raises(SettingsError) as caught:
        Settings.of({name: value})
    assert f"parameter {name} is {value!r}" in str(caught.value)
    assert "allowed: " in str(caught.value)


def test_unknown_parameters_are_refused() -> None:
    with pytest.raises(SettingsError, match="speed_limit"):
        Settings.of({"speed_limit": 3})


def test_whole_numbers_are_numbers() -> None:
    assert Settings.of({"rate": 50}).rate == 50.0


def test_the_configuration_that_comes_with_the_node_is_allowed() -> None:
    content = yaml.safe_load((ROOT / "ros2_node/config/cable.yaml").read_text(encoding="utf-8"))
    values = {}
    for name, value in content["/**"]["ros__parameters"].items():
        if isinstance(value, dict):
            values |= {f"{name}.{key}": part for key, part in value.items()}
        else:
            values[name] = value
    assert Settings.of(values).odom_relative


def test_only_the_shell_imports_ros() -> None:
    for path in PACKAGE.glob("*.py"):
        names = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                names.add(node.module.split(".")[0])
        ros = {name for name in names if name == "rclpy" or name.endswith(("_msgs", "_interfaces"))}
        assert bool(ros) == (path.stem in WITH_ROS), (path.name, ros)


def test_tables_of_the_docs_are_current() -> None:
    text = (ROOT / "docs/ros2.md").read_text(encoding="utf-8")
    assert interface.document() in text, "run python docs/write_ros2_tables.py"
    assert interface.document_of_systems() in text, "run python docs/write_ros2_tables.py"
    assert settings.document() in text, "run python docs/write_ros2_tables.py"


def test_every_topic_of_the_table_is_published_and_documented_once() -> None:
    from cablemodel import variables

    names = [topic.name for topic in interface.OUTPUTS]
    assert sorted(names) == sorted({variable.topic for variable in variables.OUTPUTS})
