"""A system of two vessels and the cables between them in other people's masters: fmpy, libcosim,
Ecos, CoFMPy and the FMU Manipulation Toolbox. All give what the same arithmetic gives in Python."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd
from numpy.typing import NDArray
from test_fmu_importers import BOLLARD
from test_fmu_system_coupling import moored as taut
from test_fmu_system_coupling import wire
from vessel_fmu import Vessel, export_vessel

import cablemodel as cm
from cablemodel.systems import SystemModel
from cablemodel_fmu.export import export_fmu, ports_file
from cablemodel_fmu.system import connections, crafts

DT, STEPS = 0.1, 40
VESSELS = ("ship", "barge")
MASTERS = Path(__file__).parents[2] / ".venv-masters" / "bin" / "python"

Rows = NDArray[np.float64]


def moored() -> cm.SystemScene:
    """With lines that hang: what taut ones do to both vessels grows from the last bit on."""
    head = {"from": "ship.bow", "to": {"anchor": [104.9, 0, -1]}, "items": [wire(110)]}
    side = {"from": "ship.stern", "to": "barge.eye", "items": [wire(48)]}
    return taut(lines={"head": head, "side": side})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("masters")
    export_fmu(moored(), folder / "cable.fmu", platforms=["linux64"], stations=2,
               ssp=folder / "tow.ssp")  # fmt: skip
    export_vessel(folder / "vessel.fmu")
    (folder / "coupled.json").write_text(json.dumps({
        "vessels": [f"vessel_{name}" for name in VESSELS],
        "pairs": connections(crafts(moored())),
        "read": [[f"vessel_{name}", f"velocity[{i}]"] for name in VESSELS for i in (1, 2)]
        + [["cable", "head.tension.start"], ["cable", "side.tension.end"]],
        "references": {
            fmu: {v.name: v.valueReference for v in
                  read_model_description(str(folder / f"{fmu}.fmu")).modelVariables}
            for fmu in ("cable", "vessel")
        },
    }))  # fmt: skip
    return folder


def expected(ends: Iterable[float], *, force_at_first: bool) -> Rows:
    """Vessels and cables side by side in Python, values exchanged after each step: both vessels'
    speeds (x, y), and tensions at the ship's bow and at the barge (steps, 6)."""
    model = SystemModel(moored())
    vessels = {name: Vessel() for name in VESSELS}
    forces = {
        name: model.wrenches[name][:3].copy() if force_at_first else np.zeros(3) for name in VESSELS
    }
    rows = []
    for end in ends:
        dt = end - model.time
        given = {
            name: cm.VesselInput(velocity=vessel.velocity.copy(), attitude_rate=np.zeros(3))
            for name, vessel in vessels.items()
        }
        model.step_to(end, vessels=given)
        for name, vessel in vessels.items():
            vessel.step(dt, forces[name])
            forces[name] = model.wrenches[name][:3]
        speeds = [vessel.velocity[i] for vessel in vessels.values() for i in (0, 1)]
        rows.append([*speeds, model.lines["head"].start_tension, model.lines["side"].end_tension])
    assert np.abs(rows[-1][:4]).min() > 1e-3  # both are under way
    return np.array(rows)


def sums(steps: int) -> list[float]:
    """Ends of steps, of masters that add them up."""
    return list(itertools.accumulate([DT] * steps))


def run(code: str, *arguments: Any, python: Path | str = sys.executable) -> Rows:
    """In a process of its own: these tools keep threads and libraries to its end."""
    command = [str(python), "-c", code, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("result ")]
    return np.array(json.loads(line.removeprefix("result ")))


def test_fmpy_runs_the_system_of_its_vessels(folder: Path) -> None:
    system = read_ssd(str(folder / "tow.ssp"), validate=True).system
    names = [component.name for component in system.elements]
    assert names == ["vessel_ship", "vessel_barge", "cable"]
    assert len(system.connections) == 12
    result = simulate_ssp(str(folder / "tow.ssp"), stop_time=(STEPS - 0.5) * DT, step_size=DT)
    found = [result[f"cable.{name}.velocity_input[{i}]"] for name in VESSELS for i in (1, 2)]
    rows = expected(sums(STEPS), force_at_first=False)
    np.testing.assert_allclose(np.array(found).T, rows[:, :4], rtol=1e-7, atol=1e-12)


LIBCOSIM = """
import json, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimSlave import CosimLocalSlave
from libcosimpy.CosimObserver import CosimObserver
folder, dt, steps = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
about = json.load(open(folder + "/coupled.json"))
execution = CosimExecution.from_step_size(step_size=int(dt * 1e9))
fmus = {"cable": "cable", **dict.fromkeys(about["vessels"], "vessel")}
slaves = {name: execution.add_local_slave(CosimLocalSlave(f"{folder}/{fmu}.fmu", name))
          for name, fmu in fmus.items()}
place = lambda name, variable: (slaves[name], about["references"][fmus[name]][variable])
for start, end in about["pairs"]:
    execution.connect_real_variables(*place(*start), *place(*end))
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
rows = []
for _ in range(steps):
    assert execution.step()
    rows.append([observer.last_real_values(slave, [vr])[0]
                 for slave, vr in (place(*which) for which in about["read"])])
print("\\nresult", json.dumps(rows), flush=True)
"""


def test_libcosim_couples_them(folder: Path) -> None:
    rows = run(LIBCOSIM, folder, DT, STEPS)
    ends = [(n + 1) / 10 for n in range(STEPS)]
    np.testing.assert_allclose(rows, expected(ends, force_at_first=True), rtol=1e-9, atol=1e-12)


ECOS = """
import ctypes, json, sys
from importlib.metadata import files
(tbb,) = [f for f in files("tbb") if f.name == "libtbb.so.12"]
ctypes.CDLL(str(tbb.locate()), ctypes.RTLD_GLOBAL)  # ecospy needs it, but does not bring it
from ecospy import EcosSimulation, EcosSimulationStructure
folder, dt, steps = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
about = json.load(open(folder + "/coupled.json"))
name = "::".join
with EcosSimulationStructure() as structure:
    structure.add_model("cable", folder + "/cable.fmu")
    for vessel in about["vessels"]:
        structure.add_model(vessel, folder + "/vessel.fmu")
    for start, end in about["pairs"]:
        structure.make_real_connection(name(start), name(end))
    with EcosSimulation(structure=structure, step_size=dt) as simulation:
        simulation.init()
        rows = []
        for _ in range(steps):
            simulation.step(1)
            rows.append([simulation.get_real(name(which)) for which in about["read"]])
        simulation.terminate()
print("\\nresult", json.dumps(rows), flush=True)
"""


def test_ecos_couples_them(folder: Path) -> None:
    rows = run(ECOS, folder, DT, STEPS)
    wanted = expected(sums(STEPS), force_at_first=True)
    np.testing.assert_allclose(rows, wanted, rtol=1e-9, atol=1e-12)


PORTS = """
import json, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
folder, steps = sys.argv[1], int(sys.argv[2])
about = json.load(open(folder + "/coupled.json"))
execution = CosimExecution.from_osp_config_file(folder + "/OspSystemStructure.xml")
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
rows = []
for _ in range(steps):
    assert execution.step()
    rows.append([
        observer.last_real_values(execution.slave_index_from_instance_name(name), [
            about["references"]["cable" if name == "cable" else "vessel"][variable]])[0]
        for name, variable in about["read"]])
print("\\nresult", json.dumps(rows), flush=True)
"""

STRUCTURE = """<?xml version="1.0" encoding="UTF-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
  <BaseStepSize>{step}</BaseStepSize>
  <Algorithm>fixedStep</Algorithm>
  <Simulators>{simulators}</Simulators>
  <Connections>{connections}</Connections>
</OspSystemStructure>
"""


def test_libcosim_couples_them_by_their_ports(folder: Path) -> None:
    """The export gives each vessel of the system a port of its own."""
    assert ports_file(moored(), folder / "cable.fmu").exists()
    (folder / "vessel_OspModelDescription.xml").write_text(BOLLARD)
    simulators = '<Simulator name="cable" source="cable.fmu"/>' + "".join(
        f'<Simulator name="vessel_{name}" source="vessel.fmu"/>' for name in VESSELS
    )
    connected = "".join(
        f'<VariableGroupConnection><VariableGroup simulator="cable" name="{name}"/>'
        f'<VariableGroup simulator="vessel_{name}" name="bollard"/></VariableGroupConnection>'
        for name in VESSELS
    )
    structure = STRUCTURE.format(step=DT, simulators=simulators, connections=connected)
    (folder / "OspSystemStructure.xml").write_text(structure)
    rows = run(PORTS, folder, STEPS)
    ends = [(n + 1) / 10 for n in range(STEPS)]
    np.testing.assert_allclose(rows, expected(ends, force_at_first=True), rtol=1e-9, atol=1e-12)


COFMUPY = """
import json, sys
from cofmupy import Coordinator
coordinator = Coordinator()
coordinator.start(sys.argv[1] + "/system.json")
about = json.load(open(sys.argv[1] + "/coupled.json"))
rows = []
for _ in range(int(sys.argv[3])):
    coordinator.do_step(float(sys.argv[2]))
    rows.append([coordinator.get_variable(tuple(which))[0] for which in about["read"]])
print("\\nresult", json.dumps(rows), flush=True)
"""


@pytest.mark.skipif(not MASTERS.exists(), reason="CoFMPy is not installed: make .venv-masters")
def test_cofmupy_couples_them(folder: Path) -> None:
    connected = [
        {
            side: {"id": place, "variable": name, "unit": "", "type": "fmu"}
            for side, (place, name) in zip(("source", "target"), pair, strict=True)
        }
        for pair in connections(crafts(moored()))
    ]
    sources = {**{f"vessel_{name}": "vessel" for name in VESSELS}, "cable": "cable"}
    fmus = [
        {"id": name, "name": name, "path": str(folder / f"{fmu}.fmu")}
        for name, fmu in sources.items()
    ]
    configuration = {"cosim_method": "jacobi", "iterative": False, "fmus": fmus}
    (folder / "system.json").write_text(json.dumps({**configuration, "connections": connected}))
    rows = run(COFMUPY, folder, DT, STEPS, python=MASTERS)
    wanted = expected(sums(STEPS), force_at_first=False)
    np.testing.assert_allclose(rows, wanted, rtol=1e-9, atol=1e-12)


def test_the_toolbox_finds_nothing_to_complain_about(folder: Path) -> None:
    tool = Path(sys.executable).with_name("fmutool")
    command = [tool, "-input", folder / "cable.fmu", "-check"]
    done = subprocess.run(command, capture_output=True, text=True)
    text = done.stdout + done.stderr
    assert done.returncode == 0, text
    assert "seems to be compliant with FMI-2.0" in text
    assert "No semantic error" in text


def test_a_container_of_vessels_and_cables(folder: Path, tmp_path: Path) -> None:
    """The toolbox makes one FMU of the system; fmpy runs that."""
    (tmp_path / "tow.ssp").write_bytes((folder / "tow.ssp").read_bytes())
    tool = Path(sys.executable).with_name("fmucontainer")
    command = [tool, "-fmu-directory", tmp_path, "-container", "tow.ssp", "-no-auto-input"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    names = [f"{vessel}.velocity[{i}]" for vessel in ("vessel", "vessel-1") for i in (1, 2)]
    result = simulate_fmu(
        str(tmp_path / "tow.fmu"), stop_time=STEPS * DT, output_interval=DT, output=names
    )
    found = np.array([result[name][1:] for name in names]).T
    rows = expected(sums(STEPS), force_at_first=True)
    np.testing.assert_allclose(found, rows[:, :4], rtol=1e-9, atol=1e-12)
