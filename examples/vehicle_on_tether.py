"""A vehicle that MuJoCo simulates, at the end of a tether below a ship.

MuJoCo has the vehicle's inertia, thrusters and hull drag; the cable model has umbilical, cage and
tether, of which the vehicle is a driven end. After every step of 0.05 s the vehicle's motion goes
to the tether, and the tether's force to the vehicle. The vehicle steps first, so that the tether
gets the motion that it reaches; a soft tether forgives that its force is a step old.

    python examples/vehicle_on_tether.py [PLOT.png]

needs the package mujoco, and matplotlib for a plot.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

import cablemodel as cm

Floats = NDArray[np.float64]

STEP, DURATION = 0.05, 120.0  # [s]
START = np.array([8.0, 0.0, -60.0])
WAY = np.array([[25.0, 0.0, -60.0], [25.0, 20.0, -64.0], [5.0, 20.0, -58.0]])
LEG = 40.0  # time for each place [s]
THRUST = 600.0  # at most, along each axis [N]
STIFFNESS, DAMPING = 120.0, 250.0  # of the vehicle's controller [N/m], [N s/m]
LAG = 0.5  # of its thrusters [s]
DRAG = 0.5 * 1025.0 * np.array([0.6, 1.2, 1.5])  # of its hull [kg/m]

SCENE: dict[str, Any] = {
    "title": "A vehicle on its tether",
    "environment": {"water_density": 1025.0},
    "cable_types": {
        "umbilical": {"diameter": 0.03, "mass": 3.1, "axial_stiffness": 2.5e7},
        "tether": {
            "diameter": 0.016, "mass": 0.23, "submerged_weight": 0.3, "axial_stiffness": 1e6,
            "bending_stiffness": 3.0,
        },
    },
    "vessels": {
        "ship": {"points": {"sheave": [0.0, 0.0, 2.0]}},
        "vehicle": {"position": START.tolist(), "points": {"tail": [0.0, 0.0, 0.0]}},
    },
    "bodies": {
        "cage": {
            "mass": 900.0, "submerged_weight": 6e3, "inertia": 400.0, "added_mass": 700.0,
            "drag_area": 1.5, "drag_turning": 3.0,
            "points": {"top": [0.0, 0.0, 0.8], "spool": [0.4, 0.0, -0.5]},
        }
    },
    "lines": {
        "umbilical": {
            "from": "ship.sheave", "to": "cage.top",
            "items": [{"cable": {"type": "umbilical", "length": 60.0}}],
        },
        "tether": {
            "from": "cage.spool", "to": "vehicle.tail",
            "items": [{"cable": {"type": "tether", "length": 45.0}}],
        },
    },
}  # fmt: skip

VEHICLE = f"""
<mujoco>
  <option timestep="{STEP}" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body name="vehicle" pos="{START[0]} {START[1]} {START[2]}">
      <freejoint/>
      <inertial pos="0 0 0" mass="450" diaginertia="60 90 90"/>
    </body>
  </worldbody>
</mujoco>
"""
"""Neutral in water; its mass holds the water's that it takes along."""


def wanted_at(time: float) -> Floats:
    """Where the vehicle should be at a time [s], (3,) [m]."""
    return WAY[min(int(time / LEG), len(WAY) - 1)]


class Vehicle:
    """Hull, thrusters and controller; pose and velocities are MuJoCo's (quaternions begin with w,
    angular velocities are in the hull's axes)."""

    def __init__(self) -> None:
        import mujoco

        self._step = mujoco.mj_step
        self._hull = mujoco.MjModel.from_xml_string(VEHICLE)
        self._state = mujoco.MjData(self._hull)
        self._body = self._hull.body("vehicle").id
        self._thrust = np.zeros(3)
        self._steps = 0

    @property
    def time(self) -> float:
        """[s]"""
        return self._steps * STEP

    @property
    def pose(self) -> Floats:
        """Place [m] and attitude, (7,)."""
        return np.array(self._state.qpos)

    @property
    def velocity(self) -> Floats:
        """[m/s] and [rad/s], (6,)."""
        return np.array(self._state.qvel)

    def step(self, wrench: Floats) -> None:
        """Go on by STEP under what the tether does: force and moment, earth frame (6,)."""
        speed = self.velocity[:3]
        off = wanted_at(self.time) - self.pose[:3]
        demand = np.clip(STIFFNESS * off - DAMPING * speed, -THRUST, THRUST)
        self._thrust += (demand - self._thrust) * STEP / LAG
        drag = -DRAG * np.linalg.norm(speed) * speed
        self._state.xfrc_applied[self._body, :3] = self._thrust + drag + wrench[:3]
        self._state.xfrc_applied[self._body, 3:] = wrench[3:] - 200.0 * self.velocity[3:]
        self._step(self._hull, self._state)
        self._steps += 1


def couple() -> dict[str, Floats]:
    """The way of the vehicle, where it should be, and the tether's tension at it, over time."""
    vehicle, model = Vehicle(), cm.SystemModel(SCENE)
    rows = []
    while vehicle.time < DURATION - 0.5 * STEP:
        wanted = wanted_at(vehicle.time)
        vehicle.step(model.wrenches["vehicle"])
        place, velocity = vehicle.pose[:3], vehicle.velocity[:3]
        model.step(STEP, vessels={"vehicle": cm.VesselInput(position=place, velocity=velocity)})
        rows.append([model.time, *place, *wanted, model.lines["tether"].end_tension])
    table = np.array(rows)
    return {
        "time": table[:, 0], "place": table[:, 1:4], "wanted": table[:, 4:7],
        "tension": table[:, 7],
    }  # fmt: skip


def draw(run: dict[str, Floats], path: str) -> None:
    """The vehicle's way from above, its depth, the tension at its end of the tether."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 3.2), layout="constrained")
    way, depth, pull = figure.subplots(1, 3)
    way.plot(*run["place"][:, :2].T)
    way.plot(*WAY[:, :2].T, "o", color="0.4")
    way.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    depth.plot(run["time"], run["place"][:, 2])
    depth.plot(run["time"], run["wanted"][:, 2], color="0.6", linewidth=1)
    depth.set(xlabel="time [s]", ylabel="z [m]")
    pull.plot(run["time"], run["tension"])
    pull.set(xlabel="time [s]", ylabel="tension at the vehicle [N]")
    figure.savefig(path, dpi=150)


def main() -> None:
    run = couple()
    off = np.linalg.norm(run["place"] - run["wanted"], axis=1)
    ends = [int(k * LEG / STEP) - 1 for k in range(1, len(WAY) + 1)]
    for k in ends:
        print(f"t = {run['time'][k]:5.1f} s: {off[k]:.2f} m from where it should be")
    print(f"largest tension at the vehicle: {run['tension'].max():.0f} N")
    if len(sys.argv) > 1:
        draw(run, sys.argv[1])


if __name__ == "__main__":
    main()
