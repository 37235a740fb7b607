"""The systems that both codes are measured on are the same, and rows of one are kept by it."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.sections import read_rows
from benchmarks.systems import CASES, Settings, SystemCase, SystemRunner, keep, moordyn_input

ALL = pytest.mark.parametrize("case", CASES.values(), ids=CASES)


@ALL
def test_what_is_driven_moves_alike(case: SystemCase) -> None:
    """A table of velocities for the one, places for the other."""
    runner = SystemRunner(case, 1e-2)
    vessel = runner._model.vessels[case.driven]
    for time in case.times:
        runner.advance(time)
        moved = runner._model.vessels[case.driven].position - vessel.position
        assert np.abs(moved - case.motion(time)).max() < 1e-7 * case.cable.length


@ALL
def test_lines_hang_from_the_same_places(case: SystemCase) -> None:
    model = SystemRunner(case, 1e-4)._model
    for line, ends in zip(model.lines.values(), case.lines, strict=True):
        found = line.sample([0.0, line.length]).position
        for place, end in zip(found, ends, strict=True):
            point = case.points[end]
            if point.kind != "Free":
                assert np.abs(place - point.place).max() < 1e-9
    for body in model.scene.bodies.values():
        (point,) = (point for point in case.points if point.kind == "Free")
        density = model.scene.environment.water_density
        lift = density * point.volume
        assert body.mass == point.mass
        assert body.weight_in(model.scene.environment) == pytest.approx(
            (point.mass - lift) * model.scene.environment.gravity
        )
        assert body.added_mass == (point.added_mass * lift,) * 3
        assert body.drag_area == (point.drag_area,) * 3


@ALL
def test_the_peer_is_given_every_point_and_line(case: SystemCase) -> None:
    text = moordyn_input(case, Settings(10, "RK2", 2.0, 0.6, 0.1), 1e-3)
    rows = text.splitlines()
    points = rows[rows.index(next(r for r in rows if "POINTS" in r)) + 3 :]
    assert [row.split()[1] for row in points[: len(case.points)]] == [
        point.kind for point in case.points
    ]
    lines = rows[rows.index(next(r for r in rows if " LINES " in r)) + 3 :]
    assert [tuple(int(k) - 1 for k in row.split()[2:4]) for row in lines[: len(case.lines)]] == (
        list(case.lines)
    )


def test_rows_of_the_other_case_stay(tmp_path: Path) -> None:
    file, head = tmp_path / "rows.csv", ("scene", "value")
    keep(file, head, "L", [["L", "1"], ["L", "2"]])
    keep(file, head, "B", [["B", "3"]])
    keep(file, head, "L", [["L", "4"]])
    assert [tuple(row.values()) for row in read_rows(file)] == [("L", "4"), ("B", "3")]
