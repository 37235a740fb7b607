"""What a step of the FMU costs: from C, through fmpy, and in Python (python -m benchmarks.fmu).

Processor time, fastest of several runs of the towed cable (scenes/towed_cable.yaml, tolerance
1e-3). Long steps show the kernel alone, which is the same code in all of them; steps of 10 ms show
what each way adds to a call.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import cablemodel as cm
from benchmarks.measure import best
from cablemodel_fmu.build import SOURCES, compile_c
from cablemodel_fmu.export import export_fmu

ROOT = Path(__file__).parents[1]
DRIVER = ROOT / "tests" / "interface" / "drive_fmu.c"
LONG, SHORT = 20.0, 0.01
REPEAT = 20


@dataclass(frozen=True)
class FmuCost:
    """Seconds of processor time a step, and what else the FMU costs."""

    step: float
    """Length of the step [s]."""
    steps: int
    c: float
    fmpy: float
    python: float

    @property
    def times_real_time(self) -> float:
        """Of the C program."""
        return self.step / self.c


def measure(folder: Path, guid: str, program: Path, dt: float, steps: int) -> FmuCost:
    """Cost of one step in the three ways, on the scene's own schedule."""
    from fmpy.fmi2 import FMU2Slave

    library = folder / "binaries" / "linux64" / "cablemodel.so"
    arguments = [str(library), (folder / "resources").as_uri(), guid]
    arguments += [str(steps), repr(dt), str(REPEAT), "1006"]
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=True)

    slave = FMU2Slave(
        guid=guid, unzipDirectory=str(folder), modelIdentifier="cablemodel", instanceName="bench"
    )
    slave.instantiate()

    def begin() -> None:
        slave.reset()
        slave.setupExperiment()
        slave.enterInitializationMode()
        slave.exitInitializationMode()

    def through_fmpy() -> None:
        for n in range(steps):
            slave.doStep(currentCommunicationPoint=n * dt, communicationStepSize=dt)

    model = cm.CableModel(cm.load_scene(ROOT / "scenes" / "towed_cable.yaml"))

    def in_python() -> None:
        for n in range(steps):
            model.step_to(n * dt + dt)

    fmpy = best(through_fmpy, REPEAT, begin) / steps
    python = best(in_python, REPEAT, model.reset) / steps
    slave.freeInstance()
    return FmuCost(dt, steps, float(done.stdout), fmpy, python)


def main() -> None:
    """Measure and print; one JSON object at the end."""
    from fmpy import extract, read_model_description

    with tempfile.TemporaryDirectory() as work:
        path = Path(work) / "tow.fmu"
        start = time.perf_counter()
        export_fmu(cm.load_scene(ROOT / "scenes" / "towed_cable.yaml"), path)
        exported = time.perf_counter() - start
        folder = Path(extract(str(path)))
        program = Path(work) / "drive"
        compile_c("x86_64-linux-gnu.2.17", [DRIVER], program, f"-I{SOURCES / 'fmi2'}", "-ldl")
        guid = read_model_description(str(path)).guid
        costs = [
            measure(folder, guid, program, dt, steps) for dt, steps in ((LONG, 10), (SHORT, 5000))
        ]
        size = path.stat().st_size
        shutil.rmtree(folder)
    print(f"FMU of three platforms: {size / 1e3:.0f} kB, exported in {exported:.2f} s")
    for cost in costs:
        print(
            f"steps of {cost.step:g} s: C {cost.c * 1e6:.2f} us, fmpy {cost.fmpy * 1e6:.2f} us, "
            f"CableModel.step_to {cost.python * 1e6:.2f} us; "
            f"{cost.times_real_time:.0f} times real time from C"
        )
    print(json.dumps({"size": size, "export": exported, "steps": [asdict(c) for c in costs]}))


if __name__ == "__main__":
    main()
