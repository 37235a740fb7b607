"""Dependencies point inward, and importing the package costs little."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import cablemodel

PACKAGE = Path(cablemodel.__file__).parent
HEAVY = [
    "numba",
    "pint",
    "matplotlib",
    "mcap",
    "rosbags",
    "typer",
    "rich",
    "scipy",
    "pandas",
    "plotly",
    "cablemodel.library",
]

# Layers from the inside out: a module may import from its own layer and from those before it.
LAYERS = (
    ("cablemodel.cache", "cablemodel.errors", "cablemodel.extras", "cablemodel.curves"),
    ("cablemodel.kernels",),
    ("cablemodel.library",),
    ("cablemodel.scene",),
    ("cablemodel.moordyn_deck",),
    ("cablemodel.block",),
    ("cablemodel.mesh",),
    (
        "cablemodel.sea_floor",
        "cablemodel.laid_loads",
        "cablemodel.free_hanging",
        "cablemodel.laid_shape",
        "cablemodel.waves",
        "cablemodel.wall_tension",
        "cablemodel.linearisation",
        "cablemodel.stability",
        "cablemodel.instance",
    ),
    (
        "cablemodel.direct",
        "cablemodel.finite_element",
        "cablemodel.error_estimate",
        "cablemodel.solver",
    ),
    ("cablemodel.variables",),
    (
        "cablemodel.model",
        "cablemodel.linear_equations",
        "cablemodel.linear_line",
        "cablemodel.linear_model",
        "cablemodel.linear_parts",
        "cablemodel.step_sensitivity",
    ),
    ("cablemodel.systems",),
    ("cablemodel.states", "cablemodel.cadence"),
    ("cablemodel.log",),
    (
        "cablemodel.promise",
        "cablemodel.recorder",
        "cablemodel.run",
        "cablemodel.converged_run",
        "cablemodel.columns",
        "cablemodel.dataset",
    ),
    ("cablemodel.compare",),
    ("cablemodel.replay",),
    (
        "cablemodel.drawing",
        "cablemodel.plot",
        "cablemodel.analysis",
        "cablemodel.export",
        "cablemodel.parameter_sweep",
    ),
    (
        "cablemodel.animate",
        "cablemodel.report",
        "cablemodel.sweep_plot",
        "cablemodel.accuracy",
    ),
    ("cablemodel.cli", "cablemodel.__main__"),
)


def layer_of(module: str) -> int | None:
    for level, names in enumerate(LAYERS):
        if any(module == name or module.startswith(name + ".") for name in names):
            return level
    return None


def modules() -> list[tuple[str, Path]]:
    found = []
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
        found.append((".".join(parts).removesuffix(".__init__"), path))
    return found


def imported(path: Path) -> list[str]:
    """Modules of this package that a file imports at any level of nesting."""
    names = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            within = path.relative_to(PACKAGE.parent).parts
            above = within[: len(within) - node.level] if node.level else ()
            home = ".".join([*above, *([node.module] if node.module else [])])
            names += [f"{home}.{alias.name}" for alias in node.names]
    return [name for name in names if name.split(".")[0] == "cablemodel"]


@pytest.mark.parametrize(("module", "path"), modules(), ids=[name for name, _ in modules()])
def test_dependencies_point_inward(module: str, path: Path) -> None:
    level = layer_of(module)
    if module == "cablemodel":
        return  # the front door names everything, lazily
    assert level is not None, f"{module} stands in no layer of this test"
    for name in imported(path):
        other = layer_of(name)
        if other is not None:
            assert other <= level, f"{module} imports {name}"


def loaded_after(statement: str) -> set[str]:
    """Heavy packages that a fresh interpreter has loaded after a statement."""
    code = f"import sys\n{statement}\nprint(*(n for n in {HEAVY!r} if n in sys.modules))"
    result = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        cwd=PACKAGE.parent,
    )
    return set(result.stdout.split())


def test_importing_the_package_loads_nothing_heavy() -> None:
    assert loaded_after("import cablemodel; cablemodel.__version__; cablemodel.SceneError") == set()


def test_loading_a_scene_without_units_or_files_loads_nothing_heavy() -> None:
    scene = (
        "cable_types: {K: {diameter: 1, mass: 1, axial_stiffness: 1e6}}\\n"
        "line: [{cable: {type: K, length: 1}}]"
    )
    assert loaded_after(f"import cablemodel; cablemodel.load_scene('{scene}').motion()") == set()


@pytest.mark.parametrize("module", ["cablemodel.run", "cablemodel.compare", "cablemodel.plot"])
def test_reading_runs_loads_no_solver(module: str) -> None:
    """Where no library is built for this machine its kernels bring numba along."""
    assert "cablemodel.library" not in loaded_after(f"import {module}")


def test_the_command_line_loads_no_solver_before_it_needs_one() -> None:
    assert not {"numba", "cablemodel.library"} & loaded_after("import cablemodel.cli")


def test_pint_loads_with_the_first_unit() -> None:
    scene = (
        "cable_types: {K: {diameter: 1 cm, mass: 1, axial_stiffness: 1e6}}\\n"
        "line: [{cable: {type: K, length: 1}}]"
    )
    assert "pint" in loaded_after(f"import cablemodel; cablemodel.load_scene('{scene}')")


def test_unknown_names_are_attribute_errors() -> None:
    with pytest.raises(AttributeError, match="no attribute 'CabelModel'"):
        cablemodel.CabelModel  # noqa: B018


def test_public_names_are_listed() -> None:
    assert set(cablemodel.__all__) <= set(dir(cablemodel))
    assert cablemodel.__version__
