"""What colcon and the launch file need is there, and speaks of things that exist."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable
from pathlib import Path

import pytest
import yaml
from cablemodel_ros import interface, settings

import cablemodel as cm

PACKAGE = Path(__file__).parents[3] / "ros2_node"


def setup_arguments() -> dict[str, ast.expr]:
    tree = ast.parse((PACKAGE / "setup.py").read_text(encoding="utf-8"))
    calls = [n for n in ast.walk(tree) if isinstance(n, ast.Call)]
    (call,) = [c for c in calls if getattr(c.func, "id", "") == "setup"]
    return {k.arg: k.value for k in call.keywords if k.arg}


def test_package_xml_and_setup_agree() -> None:
    root = ElementTree.parse(PACKAGE / "package.xml").getroot()
    assert root.findtext("name") == "cablemodel_ros"
    version = setup_arguments()["version"]
    assert isinstance(version, ast.Constant)
    assert root.findtext("version") == version.value
    assert root.findtext("export/build_type") == "ament_python"


def imported(paths: Iterable[Path]) -> set[str]:
    """Packages that sources import, wherever in them, but for Python's own."""
    found = set()
    for path in paths:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {name.name.partition(".")[0] for name in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                found.add(node.module.partition(".")[0])
    return found - sys.stdlib_module_names


UBUNTU = {"numpy": "python3-numpy", "yaml": "python3-yaml"}
"""Packages of Ubuntu by what is imported of them."""


def test_package_xml_names_what_is_used_and_nothing_else() -> None:
    launch = PACKAGE / "launch/cable.launch.py"
    used = imported([*PACKAGE.glob("cablemodel_ros/*.py"), launch])
    # By name: messages of topics, what the launch file starts and is started by, RViz's plugins.
    topics = (*interface.OUTPUTS, *interface.APPLIED, *interface.OTHERS, *interface.INPUTS)
    used |= {topic.message.split("/")[0] for topic in topics}
    used |= set(re.findall(r'package="(\w+)"', launch.read_text(encoding="utf-8")))
    used |= {"ros2launch"}
    rviz = (PACKAGE / "rviz/cable.rviz").read_text(encoding="utf-8")
    used |= set(re.findall(r"Class: (\w+)/", rviz))
    used -= {"cablemodel", "cablemodel_ros"}
    # What the library brings and Ubuntu has no package of.
    project = tomllib.loads((PACKAGE.parent / "pyproject.toml").read_text(encoding="utf-8"))
    brought = {re.split(r"\W", need)[0] for need in project["project"]["dependencies"]}
    used = {UBUNTU.get(name, name) for name in used - (brought - set(UBUNTU))}
    root = ElementTree.parse(PACKAGE / "package.xml").getroot()
    named = [element.text for element in root.findall("exec_depend")]
    assert named == sorted(used)
    assert not root.findall("test_depend")  # nor tests in the package


def test_every_file_that_is_installed_exists() -> None:
    assert ast.unparse(setup_arguments()["package_data"]) == "{NAME: ['fastdds.xml']}"
    text = ast.unparse(setup_arguments()["data_files"]).replace("{NAME}", "cablemodel_ros")
    names = re.findall(r"'((?:resource|launch|config|rviz|scenes)/[\w.]+)'", text)
    assert len(names) == 5
    for name in ["package.xml", "cablemodel_ros/fastdds.xml", *names]:
        assert (PACKAGE / name).exists(), name


def test_the_launch_file_sets_parameters_that_exist() -> None:
    tree = ast.parse((PACKAGE / "launch/cable.launch.py").read_text(encoding="utf-8"))
    keys = {
        key.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Dict)
        for key in node.keys
        if isinstance(key, ast.Constant)
    }
    assert keys
    assert keys <= {*settings.BY_NAME, "use_sim_time"}


def test_rviz_shows_topics_that_exist() -> None:
    content = yaml.safe_load((PACKAGE / "rviz/cable.rviz").read_text(encoding="utf-8"))
    shown = {
        display["Topic"]["Value"]
        for display in content["Visualization Manager"]["Displays"]
        if "Topic" in display
    }
    known = (*interface.OUTPUTS, *interface.APPLIED, *interface.OTHERS)
    assert shown
    # Relative, so that they follow the namespace that the launch file starts RViz in.
    assert shown <= {topic.name.replace("~", "cable") for topic in known}


def test_the_scene_that_comes_with_the_node_hangs_at_its_weight() -> None:
    model = cm.CableModel(cm.load_scene(PACKAGE / "scenes/waypoint_tow.yaml"))
    assert model.top_tension == pytest.approx(50 * 2.33333, rel=1e-3)
    assert model.drum_length == 150
