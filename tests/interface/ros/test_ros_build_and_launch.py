"""As on a robot: colcon builds the package, its overlay is sourced, its launch file starts it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from std_msgs.msg import Float64

from .conftest import ROOT, Talker, wait_until

PACKAGE = ROOT / "ros2_node"
RUN = Path(__file__).parent / "launching/run.py"


@pytest.fixture(scope="module")
def overlay(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace in which colcon has built the package."""
    workspace = tmp_path_factory.mktemp("ws")
    shutil.copytree(
        PACKAGE,
        workspace / "src/cablemodel_ros",
        ignore=shutil.ignore_patterns("__pycache__", "*.egg-info", "build"),
    )
    built = subprocess.run(
        [sys.executable, "-m", "colcon", "build", "--packages-select", "cablemodel_ros"],
        cwd=workspace,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert built.returncode == 0, built.stdout + built.stderr
    assert "1 package finished" in built.stdout
    return workspace


def in_overlay(overlay: Path, command: str, folder: Path) -> subprocess.Popen[str]:
    """A shell that sources the overlay; this environment's Python comes first."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    with (folder / "out").open("w") as out:
        return subprocess.Popen(
            ["bash", "-c", f"source {overlay}/install/setup.bash && exec {command}"],
            stdout=out,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=folder,
            env={**os.environ, "PATH": path, "ROS_LOG_DIR": str(folder / "ros_log")},
        )


@pytest.fixture
def launched(overlay: Path, tmp_path: Path) -> Iterator[tuple[subprocess.Popen[str], Path]]:
    command = f"python {RUN} cablemodel_ros cable.launch.py namespace:=tug rviz:=true"
    process = in_overlay(overlay, command, tmp_path)
    yield process, tmp_path / "out"
    process.terminate()
    try:
        process.wait(20)
    finally:
        process.kill()


def test_the_overlay_is_what_runs(overlay: Path, tmp_path: Path) -> None:
    code = (
        "import cablemodel_ros.node as n; "
        "from ament_index_python.packages import get_package_share_directory as share; "
        "print(n.__file__); print(share('cablemodel_ros'))"
    )
    process = in_overlay(overlay, f'python -c "{code}"', tmp_path)
    said = (tmp_path / "out").read_text if process.wait(60) == 0 else None
    assert said is not None, (tmp_path / "out").read_text()
    module, share = said().split()
    assert Path(module).resolve().is_relative_to(overlay.resolve())
    assert Path(share).resolve().is_relative_to(overlay.resolve())
    for name in ("launch/cable.launch.py", "config/cable.yaml", "rviz/cable.rviz",
                 "scenes/waypoint_tow.yaml", "package.xml"):  # fmt: skip
        assert (Path(share) / name).exists()


def test_the_launch_file_starts_node_and_viewer_in_one_namespace(
    launched: tuple[subprocess.Popen[str], Path], talker: Talker
) -> None:
    process, out = launched
    tensions = talker.listen("/tug/cable/tension_top", Float64)
    wait_until(lambda: len(tensions) > 5 or process.poll() is not None, 300)
    assert process.poll() is None, out.read_text()
    assert tensions[0].data == pytest.approx(50 * 2.33333, rel=1e-3)
    commands = json.loads(out.read_text().splitlines()[0])
    (viewer,) = [command for command in commands if command[0] == "rviz2"]
    assert "__ns:=/tug" in viewer
    config = yaml.safe_load(Path(viewer[viewer.index("-d") + 1]).read_text())
    shown = {
        display["Topic"]["Value"]
        for display in config["Visualization Manager"]["Displays"]
        if "Topic" in display
    }
    assert len(shown) == 4
    published = {name for name, _ in talker.node.get_topic_names_and_types()}
    assert {f"/tug/{topic}" for topic in shown} <= published
    # The file of parameters was read: its limits are not the node's defaults.
    from rcl_interfaces.srv import GetParameters

    request = GetParameters.Request(names=["limits.speed", "on_failure"])
    speed, policy = talker.call("/tug/cable/get_parameters", GetParameters, request).values
    assert (speed.double_value, policy.string_value) == (5.0, "stay")
