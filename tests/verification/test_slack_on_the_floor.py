"""Slack that comes down on a floor, for long: where it is, what it pulls with, and what it costs.

Answers that need no mesh: cable is neither lost nor stretched; the water under a ship at rest holds
as much of it as it is deep; what hangs weighs what it weighs less what drags along it; a lay with
slack leaves as much of it all along the floor.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cablemodel as cm

DEPTH, RATE, RAMP = 50.0, 0.5, 5.0
DIAMETER, MASS, ALONG = 0.016, 0.46, 0.05
ROPE = {
    "diameter": DIAMETER,
    "mass": MASS,
    "axial_stiffness": 1e6,
    "bending_stiffness": 0.1,
    "drag_normal": 1.0,
    "drag_tangential": ALONG,
}
WEIGHT = 9.80665 * (MASS - 1025.0 * math.pi * DIAMETER**2 / 4.0)  # in water [N/m]
COIL = 0.6  # higher above the floor hangs only what has not come down yet [m]
AWAKE_AT_MOST = 1.5  # of the nodes that were awake in the first minutes
SPACING = 0.02  # of the places that are looked at [m]


def scene(
    line: float,
    drum: float,
    rate: list[Any],
    velocity: list[Any],
    floor: dict[str, Any] | None = None,
) -> cm.Scene:
    return cm.load_scene(
        {
            "cable_types": {"rope": ROPE},
            "line": [{"cable": {"type": "rope", "length": line}}],
            "environment": {"floor": {**(floor or {"z": -DEPTH}), "friction": 0.5}},
            "vessel": {"velocity": velocity},
            "payout": {"rate": rate, "drum": [{"cable": {"type": "rope", "length": drum}}]},
        }
    )


def at_rest(drum: float) -> cm.CableModel:
    """A ship at rest, whose cable does not reach the floor, and which begins to pay out."""
    rate = [{"t": 0.0, "rate": 0.0}, {"t": RAMP, "rate": RATE}]
    return cm.CableModel(scene(45.0, drum, rate, [{"t": 0.0, "velocity": [0.0, 0.0, 0.0]}]))


def lay(speed: float, slack: float, floor: dict[str, Any] | None = None) -> cm.CableModel:
    """A ship that lays along x, with a share of slack."""
    rate = [{"t": 0.0, "rate": speed * (1.0 + slack)}]
    velocity = [{"t": 0.0, "velocity": [speed, 0.0, 0.0]}]
    return cm.CableModel(scene(80.0, 1000.0, rate, velocity, floor))


def awake(model: cm.CableModel) -> int:
    return int(model.statistics["elements"] - model.statistics["asleep"])


def shape(model: cm.CableModel) -> tuple[np.ndarray, np.ndarray]:
    """Arc lengths of places along the cable (n,) [m], and where they are (n, 3) [m]."""
    arcs = np.linspace(0.0, model.line_length, math.ceil(model.line_length / SPACING))
    return arcs, model.sample(arcs).position


def assert_none_is_lost(arcs: np.ndarray, places: np.ndarray) -> None:
    """Neither where elements are joined nor where they sleep; a metre of it carries nothing."""
    pieces = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert pieces.sum() == pytest.approx(arcs[-1], rel=2e-3)
    whole = np.add.reduceat(pieces, np.arange(0, len(pieces) - 50, 50))[:-1]
    assert np.abs(whole / (50 * arcs[1]) - 1.0).max() < 0.01


def test_a_ship_at_rest_pays_its_drum_out_on_a_pile() -> None:
    drum = 200.0
    model = at_rest(drum)
    dragged = 0.5 * 1025.0 * ALONG * math.pi * DIAMETER * RATE**2
    first = 0
    pulls, awakes = [], []
    while model.time < 420.0 - 1e-9:
        model.step(1.0)
        awakes.append(awake(model))
        if model.time < 60.0:
            continue
        out = 45.0 + min(drum, RATE * (model.time - 0.5 * RAMP))
        assert model.line_length == pytest.approx(out, abs=1e-6)
        if model.time < 400.0:
            pulls.append(model.top_tension)
        if model.time <= 120.0:
            first = max(first, awake(model))
        if model.time % 60.0 == 0.0:
            assert np.mean(awakes[-60:]) < AWAKE_AT_MOST * first, "what wakes falls asleep again"
            arcs, places = shape(model)
            assert_none_is_lost(arcs, places)
            high = places[:, 2] > COIL - DEPTH
            assert arcs[high].max() == pytest.approx(DEPTH - COIL, rel=0.01), "it hangs"
            assert not high[arcs > DEPTH].any(), "the rest lies"
            assert np.abs(places[:, :2]).max() < 0.1 * DEPTH, "where it has come down"
    assert np.mean(pulls) == pytest.approx((WEIGHT - dragged) * DEPTH, rel=0.02)
    assert model.top_tension == pytest.approx(WEIGHT * DEPTH, rel=0.02)


def test_a_ship_at_rest_pays_out_for_an_hour() -> None:
    """Elements that are awake, and the work of a minute, are those of the first minutes."""
    model = at_rest(2000.0)
    awakes, work = [], []
    while model.time < 3600.0 - 1e-9:
        before = model.statistics["iterations"]
        seconds = []
        for _second in range(60):
            model.step(1.0)
            seconds.append(awake(model))
        awakes.append(np.mean(seconds))
        work.append(model.statistics["iterations"] - before)
    assert max(awakes[5:]) < AWAKE_AT_MOST * max(awakes[:5])
    assert max(work[5:]) < AWAKE_AT_MOST * max(work[1:5])
    arcs, places = shape(model)
    assert arcs[-1] == pytest.approx(45.0 + RATE * (3600.0 - 0.5 * RAMP), abs=1e-6)
    assert_none_is_lost(arcs, places)


def test_a_lay_with_a_tenth_of_slack_leaves_it_all_along() -> None:
    speed, slack = 0.5, 0.1
    model = lay(speed, slack)
    first = 0
    while model.time < 1200.0 - 1e-9:
        model.step(1.0)
        if model.time <= 300.0:
            first = max(first, awake(model))
        assert awake(model) < AWAKE_AT_MOST * first
    arcs, places = shape(model)
    assert_none_is_lost(arcs, places)
    hangs = 1.5 * DEPTH
    laid = (arcs > hangs) & (arcs < model.line_length - 80.0)
    assert np.ptp(arcs[laid]) > 400.0
    way = places[laid][0, 0] - places[laid][-1, 0]
    assert np.ptp(arcs[laid]) / way == pytest.approx(1.0 + slack, rel=0.005)
    # Loops that are all alike hold a little more: here and there one is left out.
    for start in np.arange(hangs, model.line_length - 180.0, 100.0):
        part = places[(arcs >= start) & (arcs <= start + 100.0)]
        assert 100.0 / (part[0, 0] - part[-1, 0]) == pytest.approx(1.0 + slack, rel=0.02)


def test_slack_in_space_falls_over_and_lies(tmp_path: Path) -> None:
    """Along the bottom of a valley a line comes down in space, exactly in one plane.

    Loops do not stand up in it, as in a planar model: they fall over, and lie as meanders.
    """
    table = tmp_path / "floor.csv"
    places = [f"{x},{y},{1e-5 * abs(y) - DEPTH}" for x in (-500, 1500) for y in (-500, 0, 500)]
    table.write_text("\n".join(["x,y,z", *places]))
    speed, slack = 0.5, 0.02
    model = lay(speed, slack, {"depth_table": str(table)})
    assert not model.planar
    model.step_to(600.0)
    arcs, places = shape(model)
    assert_none_is_lost(arcs, places)
    laid = (arcs > 2.0 * DEPTH) & (arcs < model.line_length - 80.0)
    assert places[laid, 2].max() < 0.1 - DEPTH
    assert np.ptp(places[laid, 1]) > 0.2
    way = places[laid][0, 0] - places[laid][-1, 0]
    assert np.ptp(arcs[laid]) / way == pytest.approx(1.0 + slack, rel=0.005)
    assert awake(model) < 0.5 * model.statistics["elements"]


@pytest.mark.parametrize("slack", [0.005, 0.06])
def test_flexible_slack_neither_pushes_nor_pulls_where_it_sleeps(slack: float) -> None:
    """Cable without bending stiffness lies as it fell: joined, asleep and awake again it bears no
    pressure, and no tension but what friction can hold: friction times its weight, over its length.
    """
    depth, speed = 3000.0, 4.0 * 0.514444
    cable = {
        "diameter": 0.0175,
        "mass": 0.58,
        "axial_stiffness": 7e6,
        "drag_normal": 1.7,
        "drag_tangential": 0.006,
    }
    model = cm.CableModel(
        cm.load_scene(
            {
                "environment": {"floor": {"z": -depth, "friction": 0.5}},
                "cable_types": {"lw": cable},
                "line": [{"cable": {"type": "lw", "length": 14359.8}}],
                "vessel": {"velocity": [speed, 0.0, 0.0]},
                "payout": {
                    "rate": speed * (1.0 + slack),
                    "drum": [{"cable": {"type": "lw", "length": 2000.0}}],
                },
            }
        )
    )
    promised = 0.01 * model.top_tension
    hangs = 13500.0  # (Zajac 1957: at 12.84 degrees)
    most = 0
    while model.time < 600.0 - 1e-9:
        model.step(10.0)
        state = model.state()
        behind = state.s > hangs + 100.0
        assert np.abs(state.tension[behind]).max() < promised
        most = max(most, int(model.statistics["asleep"]))
    assert most > 0
