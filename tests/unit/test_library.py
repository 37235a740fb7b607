"""The compiled library: used when it fits the kernels, left aside otherwise, with the same bits."""

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.solvers import library
from cablemodel.solvers.finite_element.start.search import Search

ROOT = Path(__file__).parents[2]

# A run of direct integration, and Newton matrices of finite elements: in space, with waves, at a
# floor. Their bits, and what compiled them. All of the finite elements' kernels take numba minutes.
RUN = """
import sys, hashlib
from pathlib import Path
import numpy as np
import cablemodel as cm
from cablemodel.solvers import library
digest = hashlib.sha256()
model = cm.CableModel(cm.load_scene("{root}/scenes/example_2_tow.yaml"))
for n in range(15):
    model.step(0.07 + 0.1 * (n % 3), payout_rate=-0.1 * (n > 5), current=(0, 0.1, 0))
    state = model.state()
    for array in (state.position, state.velocity, state.tension, model.top_force):
        digest.update(array.tobytes())
for path in sorted(Path(sys.argv[1]).glob("*.npy")):
    block = np.load(path)
    library.assemble(block, block.view(np.float64), 30.0, 900.0)
    digest.update(block.tobytes())
print(library.library_path() is not None, "numba" in sys.modules, digest.hexdigest())
"""


def run(code: str, *arguments: Path, **environment) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


def built() -> bool:
    return library.library_path() is not None


needs_library = pytest.mark.skipif(
    not built(), reason="the library is not built: python -m cablemodel_fmu.build native"
)


@needs_library
@pytest.mark.slow
def test_library_and_numba_give_the_same_bits(tmp_path):
    for name in ("turn", "whip", "jumper_in_waves", "cable_lay"):
        model = cm.CableModel(cm.load_scene(ROOT / f"scenes/{name}.yaml"))
        model.step(0.5)
        np.save(tmp_path / f"{name}.npy", model._solver.memory.ints)
    code = RUN.format(root=ROOT)
    used, numba_loaded, bits = run(code, tmp_path).split()
    assert (used, numba_loaded) == ("True", "False")
    used, numba_loaded, numba_bits = run(code, tmp_path, CABLEMODEL_KERNELS="numba").split()
    assert (used, numba_loaded) == ("False", "True")
    assert bits == numba_bits


START = """
import sys
import cablemodel as cm
model = cm.CableModel(cm.load_scene("{root}/scenes/{scene}.yaml"))
model.step(0.1)
heavy = ("numba", "llvmlite", *("scipy." + part for part in (
    "interpolate", "linalg", "optimize", "sparse", "spatial", "special")))
print(*(name for name in heavy if name in sys.modules))
"""


@needs_library
@pytest.mark.parametrize(
    "scene", ["towed_cable", "jumper_in_waves", "depressor_tow", "recovery", "cable_lay"]
)
def test_a_first_step_compiles_nothing_and_imports_little(scene):
    """Neither numba nor, of SciPy, more than its name, which pint looks up; benchmarks.startup
    measures the time that it takes."""
    assert run(START.format(root=ROOT, scene=scene)) == ""


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """A copy of the libraries that may be spoilt."""
    if library.BINARIES.exists():
        shutil.copytree(library.BINARIES, tmp_path / "binaries")
    monkeypatch.setattr(library, "BINARIES", tmp_path / "binaries")
    library.library_path.cache_clear()
    yield tmp_path / "binaries" / str(library.platform_name())
    library.library_path.cache_clear()


@needs_library
def test_a_library_of_other_kernels_is_left_aside(copy):
    assert library.library_path() is not None
    about = json.loads((copy / "library.json").read_text())
    about["kernels"] = "0" * 64
    (copy / "library.json").write_text(json.dumps(about))
    library.library_path.cache_clear()
    assert library.library_path() is None


@needs_library
def test_a_library_that_is_gone_is_not_missed(copy):
    (copy / json.loads((copy / "library.json").read_text())["file"]).unlink()
    assert library.library_path() is None


def test_numba_can_be_asked_for(copy, monkeypatch):
    monkeypatch.setenv("CABLEMODEL_KERNELS", "numba")
    assert library.library_path() is None


class Kernel:
    """What numba makes of a kernel, as far as `telling` knows it."""

    def __init__(self, seconds):
        self.seconds = seconds

    def compile(self, signature):
        time.sleep(self.seconds)
        return f"compiled for {signature}"


def test_compiling_for_long_is_told_once(caplog, monkeypatch):
    monkeypatch.setattr(library, "LONG", 0.05)
    told = []
    kernels = library.telling({"quick": Kernel(0.0), "step": Kernel(0.2), "sample": Kernel(0.2)})
    with library.compiling_told(told.append):
        assert kernels["quick"].compile("reals") == "compiled for reals"
        assert told == []
        assert kernels["step"].compile("reals") == "compiled for reals"
        kernels["sample"].compile("reals")
    assert told == [library.COMPILING]
    assert not caplog.records
    library.telling({"step": Kernel(0.2)})["step"].compile("reals")
    assert [record.message for record in caplog.records] == [library.COMPILING]


def test_a_search_for_a_start_is_not_charged_with_compiling():
    search = Search(limit=0.1)
    library.telling({"equilibrium": Kernel(0.2)})["equilibrium"].compile("reals")
    assert search.left > 0.0
    time.sleep(0.12)
    assert search.left < 0.0


@pytest.mark.parametrize(
    "edited",
    ["shared/inputs.py", "finite_element/kernels/time/stepping.py", "direct/kernels/stepping.py"],
)
def test_the_hash_is_that_of_the_sources(edited, tmp_path, monkeypatch):
    """Of both solvers, for one library holds both."""
    before = library.kernel_hash()
    for folder in library.KERNELS:
        shutil.copytree(ROOT / "cablemodel" / "solvers" / folder, tmp_path / folder)
    with (tmp_path / edited).open("a") as file:
        file.write("# changed\n")
    monkeypatch.setattr(library, "__file__", str(tmp_path / "library.py"))
    library.kernel_hash.cache_clear()
    try:
        assert library.kernel_hash() != before
    finally:
        library.kernel_hash.cache_clear()


def test_there_is_no_entry_point_of_another_name():
    with pytest.raises(AttributeError, match="no entry point 'leap'"):
        _ = library.leap
