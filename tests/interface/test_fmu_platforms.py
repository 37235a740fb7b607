"""The FMU's libraries for all platforms, driven by a C program that knows the FMI headers only.

Windows' runs under Wine, that of Linux on ARM under QEMU; that of macOS is built and looked at.
`make test` installs Wine, QEMU and the ARM C library where it may (Debian: wine64, qemu-user,
libc6-arm64-cross).
"""

import json
import os
import platform
import re
import shutil
import struct
import subprocess
from pathlib import Path

import numpy as np
import pefile
import pytest
from fmpy import extract, read_model_description

import cablemodel as cm
from cablemodel.solvers.library import BINARIES, kernel_hash
from cablemodel_fmu.build import SOURCES, build, compile_c
from cablemodel_fmu.export import export_fmu

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        platform.system() != "Linux" or platform.machine() != "x86_64",
        reason="runs on Linux on x86-64",
    ),
]
SCENES = Path(__file__).parents[2] / "scenes"
DRIVER = Path(__file__).with_name("drive_fmu.c")
STEPS, DT = 60, 0.5
REFERENCES = {"tension.top": 1006, "end.position[1]": 1009, "end.position[3]": 1011}

WINE = next((p for p in map(shutil.which, ("wine64", "wine64-stable", "wine")) if p), None) or next(
    (p for p in ("/usr/lib/wine/wine64",) if os.path.exists(p)), None
)
QEMU = shutil.which("qemu-aarch64") or shutil.which("qemu-aarch64-static")
ARM = Path("/usr/aarch64-linux-gnu")

# C library functions that the libraries may use. Kernels: tests/unit/test_kernel_symbols.py.
ALLOWED = {
    *("sin", "cos", "sincos", "pow", "hypot", "sqrt", "floor", "fabs", "atan2", "exp", "log"),
    *("acos", "atan", "ceil", "remainder"),
    *("malloc", "calloc", "realloc", "free", "memcpy", "memmove", "memset", "memcmp", "bcmp"),
    *("strlen", "strcmp", "strncmp", "strcpy", "snprintf", "vsnprintf", "qsort"),
    *("fopen", "fclose", "fread", "fseek", "ftell"),
}
# What the linker adds for the start and end of every library.
LOADER = {"__cxa_finalize", "__gmon_start__", "_ITM_deregisterTMCloneTable"}
LOADER |= {"_ITM_registerTMCloneTable", "dyld_stub_binder", "__stack_chk_fail"}
# What the start-up code of Windows' libraries takes from the system (mingw-w64's crtdll.c, its
# relocations and thread-local storage, and assert's message).
WINDOWS_NAMES = {
    *("_initterm", "_initterm_e", "_initialize_onexit_table", "_register_onexit_function"),
    *("_execute_onexit_table", "_exit", "abort", "__acrt_iob_func", "fwrite"),
    *("__stdio_common_vfprintf", "__stdio_common_vsprintf"),  # snprintf, of the universal C runtime
    *("_wfopen", "MultiByteToWideChar", "GetLastError"),
    *("InitializeCriticalSection", "DeleteCriticalSection"),
    *("EnterCriticalSection", "LeaveCriticalSection", "TlsGetValue", "Sleep"),
    *("VirtualProtect", "VirtualQuery"),
}
DARWIN_NAMES = {"__sincos_stret", "bzero", "__bzero", "memset_pattern16"}
EXPORTS = {"fmi2Instantiate", "fmi2DoStep", "fmi2SetFMUstate", "cablemodel_kernel"}


def assert_exported(names: set[str]) -> None:
    """The functions of FMI, and one that gives the kernels to Python: no kernel, which another
    library in the process could take the place of."""
    assert names >= EXPORTS
    assert all(name.startswith("fmi2") for name in names - {"cablemodel_kernel"})


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    """Two FMUs of the towed cable, for desktops and for Linux on ARM, unpacked."""
    folder = tmp_path_factory.mktemp("fmus")
    scene = cm.load_scene(SCENES / "towed_cable.yaml")
    found = {}
    for name, platforms in (
        ("desktop", ("linux64", "win64", "darwin64")),
        ("arm", ("aarch64-linux",)),
    ):
        path = export_fmu(scene, folder / f"{name}.fmu", platforms=platforms, inputs="scene")
        found[name] = Path(extract(str(path), unzipdir=str(folder / name)))
    found["guid"] = read_model_description(str(folder / "desktop.fmu")).guid
    found["size"] = (folder / "desktop.fmu").stat().st_size
    found["scene"] = scene
    return found


def drive(fmus, place: Path, library: str, command: list, zig: str, tmp_path: Path) -> np.ndarray:
    program = tmp_path / ("drive.exe" if "windows" in zig else "drive")
    extra = [] if "windows" in zig else ["-ldl"]
    compile_c(zig, [DRIVER], program, f"-I{SOURCES / 'fmi2'}", *extra)
    resources = (place / "resources").as_uri()
    if "windows" in zig:
        resources = resources.replace("file:///", "file:///Z:/")
    # It is exported to run its own schedule: the program sets inputs, and they are ignored.
    arguments = [str(place / "binaries" / library), resources, fmus["guid"]]
    arguments += [str(STEPS), str(DT), "1", *map(str, REFERENCES.values())]
    environment = {**os.environ, "WINEDEBUG": "-all", "WINEPREFIX": str(tmp_path / "wine")}
    done = subprocess.run(
        [*command, str(program), *arguments],
        capture_output=True,
        text=True,
        timeout=150,
        env=environment,
    )
    assert done.returncode == 0, done.stderr
    return np.array([[float(word) for word in line.split()] for line in done.stdout.splitlines()])


@pytest.fixture(scope="module")
def expected(fmus):
    model = cm.CableModel(fmus["scene"])
    rows = []
    for n in range(STEPS):
        model.step_to(n * DT + DT)
        rows.append([model.time, model.top_tension, *model.tip_position[[0, 2]]])
    return np.array(rows)


def test_a_c_program_on_linux_has_the_bits_of_python(fmus, expected, tmp_path):
    rows = drive(
        fmus, fmus["desktop"], "linux64/cablemodel.so", [], "x86_64-linux-gnu.2.17", tmp_path
    )
    np.testing.assert_array_equal(rows, expected)


@pytest.mark.skipif(WINE is None, reason="Wine is not installed")
def test_windows(fmus, expected, tmp_path):
    rows = drive(
        fmus, fmus["desktop"], "win64/cablemodel.dll", [WINE], "x86_64-windows-gnu", tmp_path
    )
    np.testing.assert_allclose(rows, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.skipif(QEMU is None or not ARM.exists(), reason="QEMU or ARM's libc is not installed")
def test_linux_on_arm(fmus, expected, tmp_path):
    command = [QEMU, "-L", str(ARM)]
    rows = drive(
        fmus, fmus["arm"], "linux64/cablemodel.so", command, "aarch64-linux-gnu.2.17", tmp_path
    )
    np.testing.assert_allclose(rows, expected, rtol=1e-9, atol=1e-9)


def _nm(path: Path, *options: str) -> set[str]:
    done = subprocess.run(["nm", *options, str(path)], capture_output=True, text=True, check=True)
    names = [line.split()[-1] for line in done.stdout.splitlines() if line.split()]
    return {re.sub(r"@.*", "", name) for name in names}


@pytest.mark.parametrize("name", ["linux64", "aarch64-linux"])
def test_symbols_on_linux(name):
    path = BINARIES / name / "cablemodel.so"
    assert _nm(path, "-D", "--undefined-only") <= ALLOWED | LOADER
    assert_exported(_nm(path, "-D", "--defined-only"))


def _mach_o_symbols(data: bytes) -> tuple[set[str], set[str]]:
    """Undefined and exported symbols of a thin 64-bit Mach-O file, without their underscores."""
    (count,) = struct.unpack_from("<I", data, 16)
    at, undefined, exported = 32, set(), set()
    for _ in range(count):
        command, size = struct.unpack_from("<II", data, at)
        if command == 2:  # LC_SYMTAB
            symbols, number, strings, _ = struct.unpack_from("<IIII", data, at + 8)
            for n in range(number):
                name, kind, _, _, _ = struct.unpack_from("<IBBHQ", data, symbols + 16 * n)
                if not kind & 1:
                    continue
                end = data.index(b"\0", strings + name)
                text = data[strings + name : end].decode().removeprefix("_")
                (undefined if kind & 0x0E == 0 else exported).add(text)
        at += size
    return undefined, exported


def test_symbols_on_macos(fmus):
    data = (fmus["desktop"] / "binaries" / "darwin64" / "cablemodel.dylib").read_bytes()
    magic, count = struct.unpack_from(">II", data)
    assert (magic, count) == (0xCAFEBABE, 2)
    seen = set()
    for n in range(count):
        cpu, _, offset, size, alignment = struct.unpack_from(">IIIII", data, 8 + 20 * n)
        assert offset % (1 << alignment) == 0
        undefined, exported = _mach_o_symbols(data[offset : offset + size])
        assert undefined <= ALLOWED | LOADER | DARWIN_NAMES
        assert_exported(exported - {"_mh_dylib_header", "__dso_handle"})  # the linker's
        seen.add(cpu)
    assert seen == {0x01000007, 0x0100000C}


def test_symbols_on_windows(fmus):
    """It imports from the universal C runtime and the kernel alone: parts of Windows since 10."""
    library = pefile.PE(str(fmus["desktop"] / "binaries" / "win64" / "cablemodel.dll"))
    imports = {entry.dll.decode(): entry.imports for entry in library.DIRECTORY_ENTRY_IMPORT}
    assert all(re.fullmatch(r"api-ms-win-crt-\w+-l1-1-0\.dll|KERNEL32\.dll", d) for d in imports)
    names = {item.name.decode() for items in imports.values() for item in items}
    assert names <= ALLOWED | WINDOWS_NAMES
    assert_exported({item.name.decode() for item in library.DIRECTORY_ENTRY_EXPORT.symbols})


def test_the_fmu_for_all_desktops_is_small(fmus):
    # Four machine codes, each with all that systems have: bodies, winches, cuts, waves, RAOs, feet,
    # starts, coefficients and lengths, damping, what grows out of a start.
    assert fmus["size"] <= 1_495_000


def test_a_build_gives_the_same_file_again(tmp_path):
    """Compared with the library that is in use, which was built from another folder."""
    (path,) = build(["linux64"], folder=tmp_path)
    assert path.read_bytes() == (BINARIES / "linux64" / path.name).read_bytes()


def test_libraries_belong_to_the_kernels():
    for name in ("linux64", "win64", "darwin64", "aarch64-linux"):
        about = json.loads((BINARIES / name / "library.json").read_text())
        assert about["kernels"] == kernel_hash()
