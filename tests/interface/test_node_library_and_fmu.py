"""Node, library and FMU fed the same commands give the same states, to round-off.

The node's part is its session, which makes and logs what the commands come to; what the wire adds
is tested in tests/interface/ros.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from cablemodel_ros.session import Session
from cablemodel_ros.settings import Settings
from cablemodel_ros.times import Simulated
from fmu_tools import Slave, python_outputs, unpacked

import cablemodel as cm

ROOT = Path(__file__).parents[2]
STATIONS = 7
DT = 0.02


@pytest.mark.slow
def test_node_library_and_fmu_give_the_same_states(tmp_path: Path) -> None:
    scene = cm.load_scene(ROOT / "ros2_node/scenes/waypoint_tow.yaml")
    settings = Settings.of(
        {"scene": scene.to_yaml(), "vessel_input": "cmd_vel", "rate": 1 / DT,
         "log.folder": str(tmp_path)}
    )  # fmt: skip
    session = Session(settings)
    session.start()
    for k in range(1, 501):
        t = k * DT
        velocity = (0.8 * math.cos(0.3 * t), 0.8 * math.sin(0.3 * t), 0.0)
        session.rig.commands.take_twist(None, "map", velocity, (0, 0, 0))
        session.rig.commands.take_payout_rate(0.4 * math.sin(t))
        session.cycle(Simulated(t))
    session.close()
    (path,) = tmp_path.glob("cable_*.mcap")
    inputs = cm.open_run(path).applied_inputs
    library = cm.CableModel(scene)
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave = Slave(place, description)
        for k in range(len(inputs["time"])):
            velocity = np.array([inputs[f"vessel_velocity.{axis}"][k] for axis in "xyz"])
            rate = float(inputs["payout_rate"][k])
            library.step(inputs["step"][k], vessel_velocity=velocity, payout_rate=rate)
            slave.set("vessel.velocity", velocity)
            slave.set("payout.rate", rate)
            slave.step(float(inputs["step"][k]))
        expected = python_outputs(session.model, STATIONS)
        for name, value in python_outputs(library, STATIONS).items():
            scale = max(float(np.nan_to_num(np.abs(expected[name])).max()), 1e-3)
            for found in (value, slave.get(name)):
                np.testing.assert_allclose(
                    found, expected[name], rtol=0.0, atol=1e-7 * scale, err_msg=name
                )  # what is nowhere, as of a line that was never slack, is so in all three
        slave.close()
    assert session.model.time == pytest.approx(10.0)
    assert not session.model.planar
