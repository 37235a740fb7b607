"""The log of an FMU's run in fmpy replays like any other."""

from pathlib import Path
from types import SimpleNamespace

import fmpy
import numpy as np
import pytest
from fmpy import simulate_fmu
from fmu_tools import Slave

import cablemodel as cm
from cablemodel.results.replay import replay
from cablemodel_fmu.export import export_fmu
from cablemodel_fmu.recording import FmuLog

SCENE = Path(__file__).parents[2] / "scenes" / "turn.yaml"
RUN = {"stop_time": 20, "output_interval": 0.5}


def series(names, stop, step):
    """Values for fmpy, which holds them over a step."""
    time = np.arange(0.0, stop + step / 2, step)
    found = np.zeros(len(time), dtype=[("time", float), *((name, float) for name in names)])
    found["time"] = time
    return found


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    path = tmp_path_factory.mktemp("fmu") / "turn.fmu"
    return export_fmu(cm.load_scene(SCENE), path, platforms=["linux64"])


@pytest.mark.parametrize("driven", [False, True])
def test_it_replays_to_the_last_bit(fmu, tmp_path, driven):
    """Where the scene drives, and where the master does; at times that only the FMU knows."""
    given = {}
    if driven:
        given["input"] = series(["vessel.velocity[1]", "vessel.velocity[2]"], 20, 0.5)
        given["input"]["vessel.velocity[1]"] = 0.3 * np.sin(0.3 * given["input"]["time"])
        given["input"]["vessel.velocity[2]"] = 0.02 * given["input"]["time"]
    with FmuLog(fmu, tmp_path / "run.mcap") as log:
        result = simulate_fmu(str(fmu), step_finished=log, **RUN, **given)
    run = cm.open_run(tmp_path / "run.mcap")
    assert run.complete
    assert run.time[-1] == 20.0
    np.testing.assert_array_equal(run.top_tension, result["tension.top"])
    inputs = run.applied_inputs
    assert set(inputs["vessel_velocity_given"]) == {float(driven)}
    found = replay(run)
    assert found.expected_exact
    assert found.exact, found.differences


@pytest.mark.parametrize("taken_back", [False, True])
def test_steps_that_are_left_out_or_taken_back_are_refused(fmu, tmp_path, taken_back):
    """What was logged would be no run."""
    place = tmp_path / "fmu"
    description = fmpy.read_model_description(str(fmu))
    slave = Slave(fmpy.extract(str(fmu), str(place)), description)
    master = SimpleNamespace(fmu=slave.fmu)

    def run_it() -> None:
        with FmuLog(fmu, tmp_path / "run.mcap") as log:
            for _ in range(2):
                slave.step(0.5)
                log(slave.time, master)
            if taken_back:
                state = slave.fmu.getFMUstate()
                slave.step(0.5)
                log(slave.time, master)
                slave.fmu.setFMUstate(state)
                slave.time -= 0.5
            else:
                slave.step(0.5)
            slave.step(0.75)
            log(slave.time, master)

    with pytest.raises(cm.CableModelError, match="a log holds every step once, in order"):
        run_it()
    slave.close()
    assert cm.open_run(tmp_path / "run.mcap").time[-1] == (1.5 if taken_back else 1.0)


def test_a_run_with_other_parameters_is_refused(fmu, tmp_path):
    start = {"line.cable[1].length": cm.load_scene(SCENE).cables[0].length * 1.1}

    def run_it():
        with FmuLog(fmu, tmp_path / "run.mcap") as log:
            simulate_fmu(str(fmu), step_finished=log, start_values=start, **RUN)

    with pytest.raises(cm.CableModelError, match="export it with this value"):
        run_it()
    run = cm.open_run(tmp_path / "run.mcap")
    assert not run.complete
    assert "export it with this value" in run.reason
