"""A way-point tow in two processes: the node `cable`, and a controller with a winch.

    python waypoint_tow.py --plot waypoint_tow.png

Starts both, waits until the course is done, and reads the log that the node wrote. Then the same
vessel motion is simulated again without the winch, to show what it is good for. Ends with status
1 if the tension exceeded its limit.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from waypoint_controller import COURSE, WaypointController

import cablemodel as cm

HERE = Path(__file__).parent
SCENE = HERE.parent / "scenes/waypoint_tow.yaml"


def simulate(folder: Path, factor: float, patience: float) -> Path:
    """Run node and controller; gives the path of the log.

    Raises:
        TimeoutError: the course was not done in `patience` seconds.
    """
    parameters = {
        "scene": SCENE, "autostart": "true", "vessel_input": "cmd_vel", "rate": 20.0,
        "real_time_factor": factor, "publish_clock": "true", "command_timeout": 5.0,
        "limits.acceleration": 0.2, "limits.payout_acceleration": 0.5, "log.folder": folder,
    }  # fmt: skip
    node_command = [sys.executable, "-m", "cablemodel_ros.node", "--ros-args"]
    for name, value in parameters.items():
        node_command += ["-p", f"{name}:={value}"]
    controller_command = [sys.executable, str(HERE / "waypoint_controller.py"), "--ros-args",
                          "-p", "use_sim_time:=true"]  # fmt: skip
    environment = {
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",  # both are on this machine
        **os.environ,
        "ROS_LOG_DIR": str(folder / "ros_log"),
    }
    with (folder / "node.txt").open("w") as output:
        node = subprocess.Popen(node_command, stderr=output, stdout=output, env=environment)
        controller = subprocess.Popen(controller_command, env=environment)
        try:
            controller.wait(patience)
        except subprocess.TimeoutExpired:
            controller.kill()
            raise TimeoutError(
                f"the course was not done in {patience:g} s; the node said: "
                + (folder / "node.txt").read_text()
            ) from None
        finally:
            node.send_signal(signal.SIGINT)  # the node finishes its log
            try:
                node.wait(20.0)
            except subprocess.TimeoutExpired:
                node.kill()
    (path,) = folder.glob("cable_*.mcap")
    return path


def without_winch(run: cm.Run) -> np.ndarray:
    """Tension at the tow point [N] at the run's output times, had the winch stood still."""
    model = cm.CableModel(run.scene)
    inputs = run.applied_inputs
    tensions = [model.top_tension]
    for k, end in enumerate(inputs["time"]):
        velocity = [inputs[f"vessel_velocity.{axis}"][k] for axis in "xyz"]
        model.step_to(end, vessel_velocity=velocity, payout_rate=0.0)
        if len(tensions) < len(run.time) and end >= run.time[len(tensions)] - 1e-9:
            tensions.append(model.top_tension)
    return np.array(tensions)


def draw(run: cm.Run, bare: np.ndarray, limit: float, path: Path) -> None:
    """Tension, winch and course."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    inputs = run.applied_inputs
    figure, (top, middle, below) = plt.subplots(3, 1, figsize=(8, 9), layout="constrained")
    count = min(len(run.time), len(bare))
    top.plot(run.time[:count], bare[:count], color="0.6", label="winch locked")
    top.plot(run.time, run.top_tension, label="winch controlled")
    top.axhline(limit, color="tab:red", linestyle="--", label="limit")
    top.set(ylabel="tension at the tow point [N]", xlabel="time [s]")
    top.legend()
    middle.plot(run.time, run["line_length"], label="cable out [m]")
    rate = middle.twinx()
    rate.plot(inputs["time"], inputs["payout_rate"], color="tab:orange", linewidth=0.8)
    rate.set_ylabel("pay-out rate [m/s]", color="tab:orange")
    middle.set(ylabel="cable out [m]", xlabel="time [s]")
    below.plot(inputs["vessel_position.x"], inputs["vessel_position.y"], label="tow point")
    tip = run.tip_position
    below.plot(tip[:, 0], tip[:, 1], label="far end")
    below.plot([leg.x for leg in COURSE], [leg.y for leg in COURSE], "k+", label="way-points")
    below.set(xlabel="x, east [m]", ylabel="y, north [m]", aspect="equal")
    below.legend()
    figure.savefig(path, dpi=110)


def main() -> int:
    """Run, compare, draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--factor", type=float, default=10.0, help="times real time")
    parser.add_argument("--plot", type=Path, help="picture to write (needs matplotlib)")
    parser.add_argument("--folder", type=Path, help="where the log stays; else it is removed")
    parser.add_argument("--patience", type=float, default=600.0, help="[s]")
    arguments = parser.parse_args()
    limit = WaypointController().limit
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        run = cm.open_run(simulate(folder, arguments.factor, arguments.patience))
        bare = without_winch(run)
        if arguments.plot:
            draw(run, bare, limit, arguments.plot)
        result = {
            "simulated time [s]": round(float(run.time[-1]), 1),
            "limit [N]": limit,
            "highest tension [N]": round(float(run.top_tension.max()), 1),
            "highest tension with the winch locked [N]": round(float(bare.max()), 1),
            "longest line [m]": round(float(run["line_length"].max()), 1),
            "line at the end [m]": round(float(run["line_length"][-1]), 1),
        }
    print(json.dumps(result, indent=2))
    return int(result["highest tension [N]"] >= limit)


if __name__ == "__main__":
    sys.exit(main())
