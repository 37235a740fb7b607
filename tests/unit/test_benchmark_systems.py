"""The systems that both codes are measured on are the same, and rows of one are kept by it."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.scenes import GRAVITY
from benchmarks.sections import read_rows
from benchmarks.systems import (
    CASES,
    DENSITY,
    Settings,
    SystemCase,
    SystemRunner,
    keep,
    moordyn_input,
)

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


def string_below(case: SystemCase, parts: int, times: list[float]) -> np.ndarray:
    """Case B while its angle is small: a string of masses below what is towed, its end's way (n,)
    behind that [m]. Unknowns are places across the plane of the legs, along which tension is that
    at rest."""
    cable, body = case.cable, case.points[-1]
    wide = case.points[0].place[1]
    cosine = np.sqrt(1.0 - (wide / cable.length) ** 2)
    h = cable.length / parts
    floats = DENSITY * np.pi / 4.0 * cable.diameter**2
    mass = (cable.mass + floats) * h
    own = body.mass + DENSITY * body.volume
    weight = (body.mass - DENSITY * body.volume) * GRAVITY
    middles = (np.arange(parts) + 0.5) * h
    pull = weight / (2.0 * cosine) + cable.submerged_weight * cosine * middles
    drag = 0.5 * DENSITY * cable.drag_normal * cable.diameter * h
    of_body = 0.5 * DENSITY * body.drag_area

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        place, speed = np.split(state, 2)
        along = pull * np.diff(np.append(place, case.motion(t)[0])) / h
        loss = drag * np.abs(speed) * speed
        first = 2.0 * along[0] - (of_body + drag) * abs(speed[0]) * speed[0]
        change = (np.diff(along) - loss[1:]) / mass
        return np.concatenate([speed, [first / (own + mass)], change])

    found = solve_ivp(
        rates, (0.0, times[-1]), np.zeros(2 * parts), "DOP853", times, rtol=1e-9, atol=1e-11
    )
    return found.y[0] - [case.motion(t)[0] for t in times]


def test_the_towed_body_follows_as_a_string_of_masses_says() -> None:
    """To 3e-4 of its way, of small angles; MoorDyn's limit lags by 5e-3 more at first."""
    case, times = CASES["B"], [2.0, 3.0, 4.0, 5.0]
    coarse, fine = (string_below(case, parts, times) for parts in (20, 40))
    exact = fine + (fine - coarse) / 3.0
    runner = SystemRunner(case, 1e-5)
    for time, place in zip(times, exact, strict=True):
        runner.advance(time)
        assert runner.tip()[0] == pytest.approx(place, rel=3e-4)
