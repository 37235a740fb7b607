"""The 1998 method measured: iterations, costs of its models and linear solvers, round-off, orders.

    python -m benchmarks.direct

Processor time of stepping alone, the least of several runs.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import cablemodel as cm
from benchmarks import direct_steps
from benchmarks.direct_steps import Table
from benchmarks.sections import read_rows, table, write_part, write_rows
from cablemodel.solvers.direct import library
from cablemodel.solvers.direct.build import build
from cablemodel.solvers.direct.kernels import layout as own
from tests.verification import direct_scenes, scenes
from tests.verification.references import tables

PAGE, FOLDER = Path("docs/benchmarks.md"), Path("docs/benchmarks")
MODELS = ("cable", "hybrid", "elastica")
REPEATS = 7
LONG_LINE = 2000
"""Intervals of the line on which linear solvers are timed."""

Floats = NDArray[np.float64]


def stepping_cost(model: cm.CableModel, until: float) -> tuple[float, cm.CableModel]:
    """Least processor time of a run [s], and the model at its end."""
    costs = []
    for _ in range(REPEATS):
        model.reset()
        start = time.process_time()
        model.step_to(until)
        costs.append(time.process_time() - start)
    return min(costs), model


def models_compared() -> Table:
    """Example 2 with the three models, 200 s at 1 s and 1 m: cost over that of `cable`."""
    rows = []
    for planar, solver in itertools.product((None, False), ("superposition", "elimination")):
        costs, iterations = {}, {}
        for model in MODELS:
            scene = direct_scenes.towed(model, linear_solver=solver)
            model_of_scene = cm.CableModel(scene, planar=planar)
            costs[model], run = stepping_cost(model_of_scene, 200.0)
            counts = run.statistics
            iterations[model] = counts["iterations"] / counts["steps"]
        rows.append(
            [
                "plane" if planar is None else "space",
                solver,
                f"{1e3 * costs['cable']:.1f} ms",
                f"{100 * (costs['hybrid'] / costs['cable'] - 1):+.0f} %",
                f"{100 * (costs['elastica'] / costs['cable'] - 1):+.0f} %",
                f"{iterations['elastica']:.2f}",
            ]
        )
    heads = ["equations", "linear solver", "cable", "hybrid", "elastica", "iterations a step"]
    return heads, rows


def iterations() -> Table:
    """Iterations a step of the paper's examples, at its tolerances and at a tight one."""
    cases: list[tuple[str, str, float, Callable[..., cm.Scene]]] = [
        ("1 (assumed data)", "0.05: 3 to 5", 200.0, lambda **k: direct_scenes.deployed("elastica")),
        ("2", "3 to 5", 200.0, lambda **k: direct_scenes.towed("elastica", **k)),
        ("3, to 110 s", "0.01: 2 to 6", 110.0, lambda **k: direct_scenes.laid(**k)),
    ]
    rows = []
    for name, paper, until, make in cases:
        row = [name, paper]
        for settings in ({}, {"relative_tolerance": 1e-8}):
            if name.startswith("1") and settings:
                row.append("-")
                continue
            model = cm.CableModel(make(**settings))
            model.step_to(until)
            counts = model.statistics
            row.append(
                f"{counts['iterations'] / (counts['steps'] + counts['rejected']):.2f} "
                f"({counts['rejected']} of {counts['steps']} steps halved)"
            )
        rows.append(row)
    return ["example", "the paper", "at its tolerance", "at 1e-8"], rows


def system(model: str, planar: bool, intervals: int) -> tuple[Any, int]:
    """A block in the middle of S1 whose Newton system is assembled, and its slots."""
    spacing = 30.0 / intervals
    scene = direct_scenes.towed(model, node_spacing=spacing)
    block = build(scene, planar=planar)
    inputs = np.zeros(14)
    library.step(block.ints, block.reals, 20.0, inputs)
    return block, library.assemble(block.ints, block.reals)


def dense_rows(block: Any, slots: int) -> tuple[Floats, Floats, list[int]]:
    """The same system as a banded matrix (LAPACK's layout), its right-hand side and bandwidths."""
    shape = block.integers(own.OwnHeader.shape, slots, own.SHAPE_WORDS)
    left = block.array(own.OwnHeader.left, slots, own.WIDTH, own.WIDTH)
    right = block.array(own.OwnHeader.right, slots, own.WIDTH, own.WIDTH)
    rhs = block.array(own.OwnHeader.rhs, slots, own.RHS_WORDS)
    first = np.concatenate([[0], np.cumsum(shape[: slots - 1, own.SlotShape.right])])
    rows = np.concatenate([[0], np.cumsum(shape[:, own.SlotShape.rows])])
    size = int(rows[-1])
    entries: list[tuple[int, int, float]] = []
    b = np.zeros(size)
    for slot in range(slots):
        for i in range(shape[slot, own.SlotShape.rows]):
            row = int(rows[slot]) + i
            b[row] = rhs[slot, i]
            entries += [
                (row, int(first[slot - 1]) + j, left[slot, i, j])
                for j in range(shape[slot, own.SlotShape.left])
            ]
            entries += [
                (row, int(first[slot]) + j, right[slot, i, j])
                for j in range(shape[slot, own.SlotShape.right])
            ]
    below = max(r - c for r, c, _ in entries)
    above = max(c - r for r, c, _ in entries)
    band = np.zeros((below + above + 1, size))
    for r, c, value in entries:
        band[above + r - c, c] = value
    return band, b, [below, above]


def times_band(band: Floats, widths: list[int], x: Any) -> Any:
    """Matrix times vector, in the vector's precision."""
    below, above = widths
    size = band.shape[1]
    out = np.zeros(size, dtype=x.dtype)
    for d in range(-below, above + 1):
        rows = slice(max(0, -d), min(size, size - d))
        columns = slice(max(0, d), min(size, size + d))
        out[rows] += band[above - d, columns] * x[columns]
    return out


def unsuppressed(block: Any, slots: int) -> Floats:
    """Superposition without suppression, by shooting from the vessel with raw solutions."""
    shape = block.integers(own.OwnHeader.shape, slots, own.SHAPE_WORDS)
    left = block.array(own.OwnHeader.left, slots, own.WIDTH, own.WIDTH)
    right = block.array(own.OwnHeader.right, slots, own.WIDTH, own.WIDTH)
    rhs = block.array(own.OwnHeader.rhs, slots, own.RHS_WORDS)
    n = int(shape[0, own.SlotShape.right])
    conditions = right[0, : shape[0, own.SlotShape.rows], :n]
    start = np.linalg.lstsq(conditions, rhs[0, : shape[0, own.SlotShape.rows]], rcond=None)[0]
    basis = np.linalg.svd(conditions)[2][shape[0, own.SlotShape.rows] :].T
    values = [np.column_stack([start, basis])]
    for slot in range(1, slots - 1):
        source = -left[slot, :n, :n] @ values[-1]
        source[:, 0] += rhs[slot, :n]
        values.append(np.linalg.solve(right[slot, :n, :n], source))
    end = left[slots - 1, : shape[slots - 1, own.SlotShape.rows], :n]
    goal = rhs[slots - 1, : shape[slots - 1, own.SlotShape.rows]] - end @ values[-1][:, 0]
    z = np.linalg.lstsq(end @ values[-1][:, 1:], goal, rcond=None)[0]
    return np.concatenate([value[:, 0] + value[:, 1:] @ z for value in values])


def linear_solvers() -> Table:
    """Cost and forward error of the solvers on the system of a step of S1."""
    from scipy.linalg import solve_banded

    rows = []
    for model, planar in itertools.product(("cable", "elastica"), (True, False)):
        block, slots = system(model, planar, 30)
        random = np.random.default_rng(1)
        shape = block.integers(own.OwnHeader.shape, slots, own.SHAPE_WORDS).copy()
        rhs = block.array(own.OwnHeader.rhs, slots, own.RHS_WORDS)
        rhs[:, : own.WIDTH] = random.normal(size=(slots, own.WIDTH))
        band, b, widths = dense_rows(block, slots)
        exact = solve_banded(widths, band, b).astype(np.longdouble)
        for _ in range(5):
            left_over = b.astype(np.longdouble) - times_band(band, widths, exact)
            exact += solve_banded(widths, band, left_over.astype(float))
        largest = float(np.abs(exact).max())
        errors = {"banded": float(np.abs(solve_banded(widths, band, b) - exact).max()) / largest}
        with np.errstate(all="ignore"):
            raw = unsuppressed(block, slots)
            errors["unsuppressed"] = float(np.abs(raw - exact).max()) / largest
        costs = {}
        for name, method in (
            ("superposition", own.SUPERPOSITION),
            ("elimination", own.ELIMINATION),
        ):
            block.ints[own.OwnHeader.method] = method
            library.solve(block.ints, block.reals, slots)
            change = block.array(own.OwnHeader.delta, slots, 2, own.WIDTH)
            found = np.concatenate(
                [change[k, 0, : shape[k, own.SlotShape.right]] for k in range(slots - 1)]
            )
            errors[name] = float(np.abs(found - exact).max()) / largest
            costs[name] = long_line_cost(model, planar, method)
        costs["banded"] = banded_cost(model, planar)
        rows.append(
            [
                f"{model}, {'plane' if planar else 'space'} ({shape[0, own.SlotShape.right]})",
                *(f"{1e6 * costs[k]:.2f}" for k in ("superposition", "elimination", "banded")),
                f"{costs['superposition'] / costs['elimination']:.2f}",
                *(
                    f"{errors[k]:.0e}"
                    for k in ("unsuppressed", "superposition", "elimination", "banded")
                ),
            ]
        )
    heads = [
        "model (unknowns)",
        "superposition [us]",
        "elimination [us]",
        "LAPACK banded [us]",
        "ratio of the first two",
        "error: superposition without suppression",
        "with",
        "elimination",
        "LAPACK",
    ]
    return heads, rows


def least_time(task: Callable[[], Any]) -> float:
    """Least processor time of several runs [s]."""
    costs = []
    for _ in range(REPEATS):
        start = time.process_time()
        task()
        costs.append(time.process_time() - start)
    return min(costs)


def long_line_cost(model: str, planar: bool, method: int) -> float:
    """Time of a linear solve an interval [s]."""
    block, slots = system(model, planar, LONG_LINE)
    block.ints[own.OwnHeader.method] = method
    library.solve(block.ints, block.reals, slots)
    return least_time(lambda: library.solve(block.ints, block.reals, slots)) / LONG_LINE


def banded_cost(model: str, planar: bool) -> float:
    """The same by scipy's solve_banded, on a matrix that stands ready."""
    from scipy.linalg import solve_banded

    block, slots = system(model, planar, LONG_LINE)
    band, b, widths = dense_rows(block, slots)
    return least_time(lambda: solve_banded(widths, band, b)) / LONG_LINE


def errors_of(scene: cm.Scene, reference: tables.Table) -> tuple[float, float, float]:
    """Largest error of the tip over L, of the top tension over its largest; processor time [s]."""
    model = cm.CableModel(scene)
    far = pull = 0.0
    start = time.process_time()
    for t, tip, tension in zip(reference.time, reference.tip, reference.tension, strict=True):
        model.step_to(t)
        far = max(far, float(np.linalg.norm(model.tip_position - model.vessel_position - tip)))
        pull = max(pull, abs(model.top_tension - tension))
    spent = time.process_time() - start
    return far / reference.length, pull / reference.largest_tension, spent


def refinement() -> Table:
    """Errors against the converged tables as dt and ds are refined; the elements beside."""
    cases: list[tuple[str, Callable[..., cm.Scene], tables.Table, tuple[float, ...], float]] = [
        ("S1", lambda **k: direct_scenes.towed("elastica", **k), tables.TOWED, (1, 0.5, 0.25), 1.0),
        (
            "S4",
            lambda **k: direct_scenes.turned("elastica", **k),
            tables.TURNED,
            (0.5, 0.25, 0.125),
            1.0,
        ),
        (
            "S2w",
            lambda **k: direct_scenes.released(**k),
            tables.RELEASED_IN_WATER,
            (0.04, 0.02, 0.01),
            5.0,
        ),
    ]
    rows = []
    for name, make, reference, steps, ratio in cases:
        for alpha in (1.0, 0.55, 0.5):
            before: tuple[float, float] | None = None
            for dt in steps:
                settings = {"alpha": alpha, "time_step": dt, "node_spacing": ratio * dt}
                far, pull, spent = errors_of(make(relative_tolerance=1e-5, **settings), reference)
                order = "" if before is None else f"{math.log2(before[0] / far):.1f}"
                before = (far, pull)
                rows.append(
                    [
                        name,
                        f"alpha {alpha:g}, dt {dt:g} s, ds {ratio * dt:g} m",
                        f"{far:.1e}",
                        order,
                        f"{pull:.1e}",
                        f"{1e3 * spent:.0f}",
                    ]
                )
        element_scenes = {
            "S1": scenes.towed,
            "S4": scenes.turned,
            "S2w": scenes.released_in_water,
        }
        for tolerance in (1e-3, 1e-4):
            errors_of(element_scenes[name](tolerance=tolerance), reference)
            far, pull, spent = errors_of(element_scenes[name](tolerance=tolerance), reference)
            rows.append(
                [
                    name,
                    f"finite elements, tolerance {tolerance:g}",
                    f"{far:.1e}",
                    "",
                    f"{pull:.1e}",
                    f"{1e3 * spent:.1f}",
                ]
            )
    heads = ["scene", "settings", "tip / L", "order", "tension / largest", "CPU [ms]"]
    return heads, rows


STORES = {
    "models": models_compared,
    "iterations": iterations,
    "linear_solvers": linear_solvers,
    "refinement": refinement,
    "survey": direct_steps.survey,
    "touchdown": direct_steps.touchdown,
}
"""Data files in the folder, and what measures them."""


def file_of(name: str) -> Path:
    """The data file of that table."""
    return FOLDER / f"direct_{name}.csv"


def summary() -> str:
    """What the models cost, and how far from the finite elements runs are, from the data files."""
    models = read_rows(file_of("models"))
    costs = table(tuple(models[0]), [list(row.values()) for row in models])
    survey = read_rows(file_of("survey"))
    completed = sum(int(row["completed"]) for row in survey)
    whole = len(survey) * len(direct_steps.TOLERANCES)
    wrong = sum(int(row["wrong"]) for row in survey)
    names = dict.fromkeys(row["example"] for row in survey)
    lines = []
    for name in names:
        mine = [row for row in survey if row["example"] == name]
        lines.append(
            (
                name,
                f"{sum(int(row['completed']) for row in mine)} of "
                f"{len(mine) * len(direct_steps.TOLERANCES)}",
                f"{min(float(row['tension [%]']) for row in mine):.2f} to "
                f"{max(float(row['tension [%]']) for row in mine):.2f}",
                f"{min(float(row['place [%]']) for row in mine):.2f} to "
                f"{max(float(row['place [%]']) for row in mine):.2f}",
            )
        )
    head = ("example, spacing", "runs completed", "tension off by [%]", "places off by [%]")
    return (
        f"{costs}\n{completed} of {whole} runs of the survey came to their end, the others were "
        f"refused; {wrong} took over a wrong state.\n\n{table(head, lines)}"
    )


def main() -> None:
    """Measure everything; keep the rows, write a summary."""
    build(direct_scenes.towed("cable"))
    for name, measure in STORES.items():
        head, rows = measure()
        write_rows(file_of(name), head, rows)
        print(table(head, rows))
    write_part(PAGE, "method of 1998", summary())


if __name__ == "__main__":
    main()
