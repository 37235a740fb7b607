"""The compiled kernels do what their source says: the same run as plain Python."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
SCENES = TESTS.parent / "scenes"

RUN = """
import json, sys
if sys.argv[2] == "plain":
    import plain_kernels
import cablemodel as cm
model = cm.CableModel(cm.load_scene(sys.argv[1], "solver.start_time_limit=600"))
for _ in range(20):
    model.step(0.1)
print(json.dumps([*model.tip_position, *model.tip_velocity, model.top_tension]))
"""


@pytest.mark.parametrize("scene", ["towed_cable", "turn", "recovery"])
def test_compiled_and_plain_kernels_agree(scene):
    """Two seconds: in a plane and in space, with bodies, a winch and a floor."""
    path = SCENES / f"{scene}.yaml"
    folders = [str(TESTS), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(folders)}
    found = [
        json.loads(
            subprocess.run(
                [sys.executable, "-c", RUN, str(path), kind],
                capture_output=True, text=True, check=True, env=environment, cwd=TESTS.parent,
            ).stdout
        )
        for kind in ("compiled", "plain")
    ]  # fmt: skip
    assert found[0] == pytest.approx(found[1], rel=1e-7, abs=1e-9)
