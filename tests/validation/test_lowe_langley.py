"""Lowe and Langley's jumper in waves, against what they published: top tension over three periods.

G. M. Lowe and R. S. Langley 2006, case 4: 170 m between a point 5 m and one 55 m below the
surface, in a wave of 10 m and 10 s over 100 m of water. `data/lowe_langley_case4.csv` is their
effective tension at the top [kN], read off at 298 times [s]; the wave had come up by t = 0.
"""

from pathlib import Path

import numpy as np

import cablemodel as cm

PUBLISHED = np.loadtxt(Path(__file__).parent / "data" / "lowe_langley_case4.csv", delimiter=",")
RAMP = 20.0  # two periods: the phase is that at t = 0
SCENE = {
    "environment": {
        "water_density": 1000,
        "gravity": 9.807,
        "floor": {"z": -100},
        "waves": {"regular": {"height": 10, "period": 10, "phase": "230 deg"}, "ramp": RAMP},
    },
    "cable_types": {
        "jumper": {
            "diameter": 0.396,
            "mass": 165,
            "axial_stiffness": 500e6,
            "bending_stiffness": 120.8e3,
            "drag_normal": 1,
            "drag_tangential": 0,
            "added_mass": 1,
        }
    },
    "line": [{"cable": {"type": "jumper", "length": 170}}],
    "vessel": {"position": [0, 0, -5]},
    "end": {"anchor": [-100, 0, -55]},
    "solver": {"tolerance": 1e-3},
}


def test_top_tension_of_a_jumper_in_waves():
    """It swings by a third less without the Froude-Krylov force along the line: 3.5 kN rms."""
    model, found = cm.CableModel(cm.load_scene(SCENE)), []
    for time in PUBLISHED[:, 0]:
        model.step_to(RAMP + max(0.0, time))
        found.append(model.sample(0.0).tension[0] / 1e3)
    apart = np.array(found) - PUBLISHED[:, 1]
    assert np.sqrt(np.mean(apart**2)) < 0.35
    assert np.ptp(PUBLISHED[:, 1]) > 11  # [kN]: what it swings by
