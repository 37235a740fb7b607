"""The FMU and the system of a vessel with it in more masters: fmpy's SSP, the FMU Manipulation
Toolbox and CoFMPy. (libcosim and Ecos: test_fmu_importers.py.)"""

import itertools
import json
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd
from fmu_tools import Slave, still_scene
from vessel_fmu import coupled_in_python, export_vessel

from cablemodel_fmu.export import ExportError, export_fmu
from cablemodel_fmu.system import MOVING

DT, STEPS = 0.1, 60
ROOT = Path(__file__).parents[2]
MASTERS = ROOT / ".venv-masters" / "bin" / "python"


def scene():
    return still_scene(vessel={"position": [0, 0, 0]}, run={"duration": 6, "output_interval": DT})


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("masters")
    export_fmu(scene(), folder / "cable.fmu", platforms=["linux64"], ssp=folder / "tow.ssp")
    export_vessel(folder / "vessel.fmu")
    return folder


def expected(dt=DT, steps=STEPS):
    """Rows of the vessel's speed and the tension; the vessel's first step is without the cable's
    force, for these masters give inputs no values before it."""
    ends = list(itertools.accumulate([dt] * steps))
    return coupled_in_python(scene(), ends, first_force=np.zeros(3))


def test_the_system_is_one_of_ssp(folder):
    """By the schemas and its contents: two FMUs, what connects them, where the vessel starts."""
    system = read_ssd(str(folder / "tow.ssp"), validate=True).system
    assert [component.name for component in system.elements] == ["vessel", "cable"]
    assert len(system.connections) == 6
    with zipfile.ZipFile(folder / "tow.ssp") as archive:
        assert archive.read("resources/cable.fmu") == (folder / "cable.fmu").read_bytes()
        text = archive.read("SystemStructure.ssd").decode()
    assert 'name="start_velocity[1]"' in text


def test_fmpy_runs_the_system(folder):
    result = simulate_ssp(str(folder / "tow.ssp"), stop_time=(STEPS - 0.5) * DT, step_size=DT)
    rows = expected()
    assert rows[-1, 0] > 0.2
    np.testing.assert_allclose(result["cable.vessel.velocity[1]"], rows[:, 0], rtol=1e-9)


@pytest.mark.parametrize("moved_by", ["position", "position and velocity"])
def test_the_system_connects_what_the_fmu_is_exported_to_be_moved_by(tmp_path, moved_by):
    """The vessel's last position is the tow point's next: nothing is ignored."""
    ssp = tmp_path / "tow.ssp"
    fmu = export_fmu(
        scene(), tmp_path / "cable.fmu", platforms=["linux64"], vessel_input=moved_by, ssp=ssp
    )
    outputs = MOVING[moved_by]
    connected = read_ssd(str(ssp), validate=True).system.connections
    assert len(connected) == 3 + 3 * len(outputs)
    result = simulate_ssp(str(ssp), stop_time=(STEPS - 0.5) * DT, step_size=DT)
    assert result["vessel.position[1]"][-1] > 0.5
    # The cable by itself, given the same, pulls as it did.
    place = extract(str(fmu), str(tmp_path / "fmu"))
    slave = Slave(Path(place), read_model_description(str(fmu)))
    for k in range(len(result)):  # a row is what a step gave, and what the next one gets
        for output in outputs:
            names = [f"cable.vessel.{output}[{i}]" for i in (1, 2, 3)]
            slave.set(f"vessel.{output}", [result[name][k - 1] if k else 0.0 for name in names])
        slave.step(DT)
    assert slave.messages == []
    there = result["cable.vessel.position[1]"][-2]
    assert slave.get("line.position[1,1]") == pytest.approx(there, rel=1e-12)
    force = [result[f"cable.force.top[{i}]"][-1] for i in (1, 2, 3)]
    np.testing.assert_array_equal(slave.get("force.top"), force)
    slave.close()


def test_a_cable_that_ignores_its_vessel_is_in_no_system(tmp_path):
    with pytest.raises(ExportError, match="ignores the vessels"):
        export_fmu(scene(), tmp_path / "cable.fmu", inputs="scene", ssp=tmp_path / "tow.ssp")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["cable.fmu", "vessel.fmu"])
def test_the_toolbox_finds_nothing_to_complain_about(folder, name):
    tool = Path(sys.executable).with_name("fmutool")
    done = subprocess.run([tool, "-input", folder / name, "-check"], capture_output=True, text=True)
    text = done.stdout + done.stderr
    assert done.returncode == 0, text
    assert "seems to be compliant with FMI-2.0" in text
    assert "No semantic error" in text


def test_a_container_of_vessel_and_cable(folder, tmp_path):
    """The toolbox makes one FMU of the system; fmpy runs that."""
    (tmp_path / "tow.ssp").write_bytes((folder / "tow.ssp").read_bytes())
    tool = Path(sys.executable).with_name("fmucontainer")
    command = [tool, "-fmu-directory", tmp_path, "-container", "tow.ssp", "-no-auto-input"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    result = simulate_fmu(str(tmp_path / "tow.fmu"), stop_time=STEPS * DT, output_interval=DT)
    rows = coupled_in_python(scene(), list(itertools.accumulate([DT] * STEPS)))
    np.testing.assert_allclose(result["vessel.velocity[1]"][1:], rows[:, 0], rtol=1e-9)


COFMUPY = """
import json, sys
from cofmupy import Coordinator
coordinator = Coordinator()
coordinator.start(sys.argv[1])
rows = []
for _ in range(int(sys.argv[3])):
    coordinator.do_step(float(sys.argv[2]))
    rows.append([coordinator.get_variable(("vessel", "velocity[1]"))[0],
                 coordinator.get_variable(("cable", "tension.top"))[0]])
print("\\nresult", json.dumps(rows), flush=True)
"""


@pytest.mark.skipif(not MASTERS.exists(), reason="CoFMPy is not installed: make .venv-masters")
def test_cofmupy_couples_them(folder):
    """It is in an environment of its own, for it wants other versions of what tests use."""
    from cablemodel_fmu.system import connections, crafts

    connected = [
        {
            side: {"id": place, "variable": name, "unit": "", "type": "fmu"}
            for side, (place, name) in zip(("source", "target"), pair, strict=True)
        }
        for pair in connections(crafts(scene()))
    ]
    fmus = [{"id": name, "name": name, "path": str(folder / f"{name}.fmu")}
            for name in ("vessel", "cable")]  # fmt: skip
    configuration = {"cosim_method": "jacobi", "iterative": False, "fmus": fmus}
    (folder / "system.json").write_text(json.dumps({**configuration, "connections": connected}))
    command = [MASTERS, "-c", COFMUPY, folder / "system.json", str(DT), str(STEPS)]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("result ")]
    rows = np.array(json.loads(line.removeprefix("result ")))
    np.testing.assert_allclose(rows, expected(), rtol=1e-9)
