"""The FMU in other people's tools: fmpy, the Open Simulation Platform (libcosim), Ecos."""

import itertools
import json
import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu
from fmu_tools import still_scene
from vessel_fmu import coupled_in_python, export_vessel

import cablemodel as cm
from cablemodel_fmu.export import export_fmu

DT, STEPS = 0.1, 100


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmus")
    export_fmu(scene(), folder / "cable.fmu", platforms=["linux64"])
    export_vessel(folder / "vessel.fmu")
    return folder


def scene():
    return still_scene(vessel={"position": [0, 0, 0]})


def run(code: str, *arguments) -> list:
    """In a process of its own: these tools keep threads and libraries to its end."""
    command = [sys.executable, "-c", code, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("result ")]
    return json.loads(line.removeprefix("result "))


def test_fmpy_finds_nothing_to_complain_about(folder):
    assert validate_fmu(str(folder / "cable.fmu")) == []


def test_a_description_says_which_of_an_array_a_variable_is(tmp_path):
    """Importers show names that nobody knows, and descriptions: no two of an array are the same."""
    line = [{"cable": {"type": "K", "length": 5}}, {"body": {"mass": 9, "submerged_weight": 50}}]
    line += [line[0], {"body": {"name": "bird", "mass": 9, "submerged_weight": 50}}]
    export_fmu(still_scene(line=line), tmp_path / "cable.fmu", platforms=["linux64"], stations=3)
    variables = read_model_description(str(tmp_path / "cable.fmu")).modelVariables
    driven = [v for v in variables if v.causality in ("input", "output")]
    assert len({v.description for v in driven}) == len(driven) > 50
    words = {v.name: v.description for v in driven}
    assert words["end.velocity[2]"] == "velocity of the far end, y (north)"
    assert words["body[2].position[3]"] == (
        "position of a body, 2 of 2 from the vessel (bird), z (up)"
    )


def test_fmpy_simulates_with_an_input_series(folder):
    """fmpy interpolates the series and sets input derivatives: a ramp arrives as it was meant."""
    driven = [f"{name}[{i}]" for name in ("vessel.velocity", "vessel.position", "current.velocity")
              for i in (1, 2, 3)]  # fmt: skip
    series = np.zeros(2, dtype=[("time", float), *((name, float) for name in driven)])
    series["time"] = -5, 20  # fmpy gives no derivative at the first sample
    series["vessel.velocity[1]"] = -0.25, 1.0
    result = simulate_fmu(
        str(folder / "cable.fmu"), input=series, stop_time=10, output_interval=0.5,
        use_event_mode=False, set_input_derivatives=True,
    )  # fmt: skip
    model = cm.CableModel(scene())
    for n in range(1, 21):
        model.step(0.5, (0.025 * n, 0, 0), payout_rate=0.0, current=(0, 0, 0))
    assert result["time"][-1] == 10.0
    # fmpy's values differ in the last bit, which may cost or save an iteration of Newton's method.
    np.testing.assert_allclose(result["tension.top"][-1], model.top_tension, rtol=1e-4)
    np.testing.assert_allclose(result["line.position[1,1]"][-1], 0.5 * 0.05 * 10**2)
    np.testing.assert_allclose(result["end.position[1]"][-1], model.tip_position[0], atol=1e-4)


LIBCOSIM = """
import json, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimSlave import CosimLocalSlave
from libcosimpy.CosimObserver import CosimObserver
folder, dt, steps = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
execution = CosimExecution.from_step_size(step_size=int(dt * 1e9))
cable = execution.add_local_slave(CosimLocalSlave(folder + "/cable.fmu", "cable"))
vessel = execution.add_local_slave(CosimLocalSlave(folder + "/vessel.fmu", "vessel"))
for i in range(3):
    execution.connect_real_variables(vessel, 3 + i, cable, i)
    execution.connect_real_variables(cable, 1000 + i, vessel, i)
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
rows = []
for _ in range(steps):
    assert execution.step()
    rows.append(observer.last_real_values(vessel, [3]) + observer.last_real_values(cable, [1006]))
print("\\nresult", json.dumps(rows), flush=True)
"""


def test_libcosim_couples_it_to_a_vessel(folder):
    rows = np.array(run(LIBCOSIM, folder, DT, STEPS))
    expected = coupled_in_python(scene(), [(n + 1) / 10 for n in range(STEPS)])
    assert expected[-1, 0] > 0.2  # it is under way
    np.testing.assert_allclose(rows, expected, rtol=1e-12)


ECOS = """
import ctypes, json, sys
from importlib.metadata import files
(tbb,) = [f for f in files("tbb") if f.name == "libtbb.so.12"]
ctypes.CDLL(str(tbb.locate()), ctypes.RTLD_GLOBAL)  # ecospy needs it, but does not bring it
from ecospy import EcosSimulation, EcosSimulationStructure
folder, dt, steps = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
with EcosSimulationStructure() as structure:
    structure.add_model("cable", folder + "/cable.fmu")
    structure.add_model("vessel", folder + "/vessel.fmu")
    for i in "123":
        structure.make_real_connection(f"vessel::velocity[{i}]", f"cable::vessel.velocity[{i}]")
        structure.make_real_connection(f"cable::force.top[{i}]", f"vessel::force[{i}]")
    with EcosSimulation(structure=structure, step_size=dt) as simulation:
        simulation.init()
        rows = []
        for _ in range(steps):
            simulation.step(1)
            rows.append([simulation.get_real("vessel::velocity[1]"),
                         simulation.get_real("cable::tension.top")])
        simulation.terminate()
print("\\nresult", json.dumps(rows), flush=True)
"""


def test_ecos_couples_it_to_a_vessel(folder):
    rows = np.array(run(ECOS, folder, DT, STEPS))
    expected = coupled_in_python(scene(), list(itertools.accumulate([DT] * STEPS)))
    np.testing.assert_allclose(rows, expected, rtol=1e-9)


PORTS = """
import json, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
execution = CosimExecution.from_osp_config_file(sys.argv[1])
index = execution.slave_index_from_instance_name
cable, vessel = index("cable"), index("vessel")
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
rows = []
for _ in range(int(sys.argv[2])):
    assert execution.step()
    rows.append(observer.last_real_values(vessel, [3]) + observer.last_real_values(cable, [1006]))
print("\\nresult", json.dumps(rows), flush=True)
"""

SYSTEM = """<?xml version="1.0" encoding="UTF-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
  <BaseStepSize>{step}</BaseStepSize>
  <Algorithm>fixedStep</Algorithm>
  <Simulators>
    <Simulator name="cable" source="cable.fmu"/>
    <Simulator name="vessel" source="vessel.fmu"/>
  </Simulators>
  <Connections><VariableGroupConnection>
    <VariableGroup simulator="cable" name="tow point"/>
    <VariableGroup simulator="vessel" name="bollard"/>
  </VariableGroupConnection></Connections>
</OspSystemStructure>
"""

# The vessel's side of the same port.
BOLLARD = """<?xml version="1.0" encoding="UTF-8"?>
<OspModelDescription xmlns="https://open-simulation-platform.com/OspModelDescription/1.0.0"
 version="1.0"><VariableGroups><LinearMechanicalPort name="bollard">
 <Force name="force"><Variable ref="force[1]"/><Variable ref="force[2]"/><Variable ref="force[3]"/>
 </Force><LinearVelocity name="velocity"><Variable ref="velocity[1]"/><Variable ref="velocity[2]"/>
 <Variable ref="velocity[3]"/></LinearVelocity></LinearMechanicalPort></VariableGroups>
</OspModelDescription>
"""


def test_libcosim_couples_them_by_their_ports(folder):
    """libcosim reads the ports with a system structure, and connects forces and velocities."""
    (folder / "OspSystemStructure.xml").write_text(SYSTEM.format(step=DT))
    (folder / "vessel_OspModelDescription.xml").write_text(BOLLARD)
    rows = np.array(run(PORTS, folder / "OspSystemStructure.xml", STEPS))
    expected = coupled_in_python(scene(), [(n + 1) / 10 for n in range(STEPS)])
    np.testing.assert_allclose(rows, expected, rtol=1e-12)


# From the schema of OSP-IS, OspModelDescription-1.0.0.xsd: the sequence of the groups that may
# stand in VariableGroups, as far as the cable has them; what a mechanical port holds.
OSP = "{https://open-simulation-platform.com/OspModelDescription/1.0.0}"
OSP_SEQUENCE = ("Force", "LinearVelocity", "LinearDisplacement", "LinearMechanicalPort")
OSP_PORT = {"LinearMechanicalPort": ["Force", "LinearVelocity"]}


def test_ports_for_the_open_simulation_platform(folder):
    """Next to the FMU, under the name by which libcosim looks for it, by the rules of OSP-IS."""
    description = read_model_description(str(folder / "cable.fmu"))
    root = ElementTree.parse(folder / f"{description.modelName}_OspModelDescription.xml").getroot()
    assert (root.tag, root.attrib) == (f"{OSP}OspModelDescription", {"version": "1.0"})
    (groups,) = root
    assert groups.tag == f"{OSP}VariableGroups"
    order = [OSP_SEQUENCE.index(group.tag.removeprefix(OSP)) for group in groups]
    assert order == sorted(order)
    names = [element.get("name") for element in groups.iter() if element.get("name")]
    assert len(set(names)) == len(names) == 5
    causality = {v.name: v.causality for v in description.modelVariables}
    for group in groups:
        kinds = OSP_PORT.get(group.tag.removeprefix(OSP))
        simple = [group] if kinds is None else list(group)
        assert kinds is None or [part.tag.removeprefix(OSP) for part in simple] == kinds
        sides = []
        for part in simple:
            assert [child.tag for child in part] == [f"{OSP}Variable"] * 3
            (side,) = {causality[child.get("ref")] for child in part}
            sides.append(side)
        assert kinds is None or sorted(sides) == ["input", "output"]
