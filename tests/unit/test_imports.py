"""Dependencies point inward, and importing the package costs little."""

from __future__ import annotations

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
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
    *(PARTS_OF_SCIPY := ("scipy.interpolate", "scipy.linalg", "scipy.optimize", "scipy.sparse")),
    "pandas",
    "plotly",
    "cablemodel.solvers.library",
]

# Layers from the inside out: a module may import from its own layer and from those before it.
LAYERS = (
    ("cablemodel.cache", "cablemodel.errors", "cablemodel.extras", "cablemodel.variables"),
    ("cablemodel.scene",),
    ("cablemodel.moordyn_deck",),
    ("cablemodel.solvers.shared",),
    ("cablemodel.solvers.finite_element.kernels", "cablemodel.solvers.direct.kernels"),
    ("cablemodel.solvers.library", "cablemodel.solvers.protocol"),
    ("cablemodel.solvers.finite_element", "cablemodel.solvers.direct"),
    ("cablemodel.solvers",),
    ("cablemodel.model", "cablemodel.linear"),
    ("cablemodel.systems",),
    ("cablemodel.results",),
    ("cablemodel.accuracy",),
    ("cablemodel.analysis",),
    ("cablemodel.views",),
    ("cablemodel.cli", "cablemodel.__main__"),
)
SIDE_BY_SIDE = ("cablemodel.solvers.finite_element", "cablemodel.solvers.direct")
"""Neither solver imports the other: what they share stands in solvers/shared."""
FLAT = 8
"""Modules beside the packages, at most."""


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


def imported(path: Path, *, to_run: bool = False) -> list[str]:
    """Modules of this package that a file imports at any level of nesting; to_run: without those
    for its annotations alone."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if to_run and isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            node.body = []
    names = []
    for node in ast.walk(tree):
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
    if module == "cablemodel":
        return  # the front door names everything, lazily
    level = layer_of(module)
    assert level is not None, f"{module} stands in no layer of this test"
    for name in imported(path):
        other = layer_of(name)
        if other is not None:
            assert other <= level, f"{module} imports {name}"
        for one, another in (SIDE_BY_SIDE, SIDE_BY_SIDE[::-1]):
            assert not (module.startswith(one) and name.startswith(another)), module


def test_no_module_imports_itself_through_others() -> None:
    """Not even where an import waits for a function to be called."""
    paths = dict(modules())
    graph = {module: set[str]() for module in paths}
    for module, path in paths.items():
        if module == "cablemodel":
            continue
        for name in imported(path, to_run=True):
            while name not in paths:
                name = name.rpartition(".")[0]
            if name not in (module, "cablemodel"):
                graph[module].add(name)
    order = tuple(TopologicalSorter(graph).static_order())  # a CycleError names the circle
    assert set(order) == set(graph)


def test_few_modules_stand_beside_the_packages() -> None:
    flat = {path.name for path in PACKAGE.glob("*.py")} - {"__init__.py", "__main__.py"}
    assert len(flat) <= FLAT, flat


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
    return set(result.stdout.splitlines()[-1].split())


def test_importing_the_package_loads_nothing_heavy() -> None:
    assert loaded_after("import cablemodel; cablemodel.__version__; cablemodel.SceneError") == set()


def test_loading_a_scene_without_units_or_files_loads_nothing_heavy() -> None:
    scene = (
        "cable_types: {K: {diameter: 1, mass: 1, axial_stiffness: 1e6}}\\n"
        "line: [{cable: {type: K, length: 1}}]"
    )
    assert loaded_after(f"import cablemodel; cablemodel.load_scene('{scene}').motion()") == set()


@pytest.mark.parametrize(
    "module", ["cablemodel.results.run", "cablemodel.results.compare", "cablemodel.views.plot"]
)
def test_reading_runs_loads_no_solver(module: str) -> None:
    """Where no library is built for this machine its kernels bring numba along."""
    assert "cablemodel.solvers.library" not in loaded_after(f"import {module}")


def test_the_command_line_loads_no_solver_before_it_needs_one() -> None:
    assert not {"numba", "cablemodel.solvers.library"} & loaded_after("import cablemodel.cli")


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_tow_is_checked_and_run_without_a_compiler_and_parts_of_scipy(
    command: str, tmp_path: Path
) -> None:
    """They take longer to load than all else that a first run does. Pint loads its top alone."""
    scene = str(tmp_path / "tow.yaml")
    loaded = loaded_after(
        "from cablemodel.cli.app import app\n"
        f"app(['new', {scene!r}, '--tow'], standalone_mode=False)\n"
        f"app([{command!r}, {scene!r}], standalone_mode=False)"
    )
    assert "cablemodel.solvers.library" in loaded
    assert not {"numba", *PARTS_OF_SCIPY} & loaded


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
