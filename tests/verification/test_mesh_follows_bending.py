"""Elements are halved where the line bends too much for them, and joined again."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from tests.verification.scenes import CABLE_K

LENGTH = 30.0
TAU = 1e-3


def cable_of(
    elements: int | None, length: float = LENGTH, model: str = "elastica"
) -> dict[str, Any]:
    """Some cable K, with the mesh that the tolerance asks for, or so many elements."""
    cable: dict[str, Any] = {"type": "K", "length": length, "model": model}
    if elements is not None:
        cable["elements"] = elements
    return cable


def water(depth: float | None) -> dict[str, Any]:
    """Water without a floor, or with one at that depth [m], which the cable does not reach."""
    floor = {} if depth is None else {"floor": {"z": -depth, "friction": 0.5}}
    return {"water_density": 1025.0, **floor}


def reversing(
    tolerance: float, elements: int | None = None, depth: float | None = None
) -> cm.CableModel:
    """A cable towed at 1 m/s, whose vessel stops, goes astern within 6 s, then rests."""
    cable = cable_of(elements)
    scene = {
        "environment": water(depth),
        "cable_types": {"K": CABLE_K},
        "line": [{"cable": cable}],
        "vessel": {
            "position": [0.0, 0.0, 0.0],
            "velocity": [
                {"t": 0.0, "velocity": [1.0, 0.0, 0.0]},
                {"t": 2.0, "velocity": [1.0, 0.0, 0.0]},
                {"t": 8.0, "velocity": [-3.0, 0.0, 0.0]},
                {"t": 12.0, "velocity": [-3.0, 0.0, 0.0]},
                {"t": 14.0, "velocity": [0.0, 0.0, 0.0]},
            ],
        },
        "solver": {"tolerance": tolerance},
        "run": {"duration": 400.0, "output_interval": 1.0},
    }
    return cm.CableModel(cm.load_scene(scene))


def shapes(model: cm.CableModel, times: list[float]) -> tuple[np.ndarray, int]:
    """Positions of 31 places (times, 31, 3) [m], and the most elements at any of the times."""
    found, most = [], 0
    for time in times:
        model.step_to(time)
        found.append(model.sample(np.linspace(0.0, model.line_length, 31)).position)
        most = max(most, model.statistics["elements"])
    return np.array(found), most


TIMES = [float(t) for t in np.arange(2.5, 20.1, 0.5)]


@pytest.fixture(scope="module")
def reference() -> np.ndarray:
    """The same with 96 equal elements, at a fiftieth of the tolerance."""
    return shapes(reversing(TAU / 50.0, elements=96), TIMES)[0]


def distance(found: np.ndarray, reference: np.ndarray, promise: float = TAU * LENGTH) -> float:
    """Largest distance at any time and place, in units of tau L."""
    return float(np.linalg.norm(found - reference, axis=2).max() / promise)


@pytest.mark.parametrize("depth", [None, 31.0, 60.0])
def test_mesh_that_follows_keeps_the_promise(reference: np.ndarray, depth: float | None) -> None:
    """Above a floor, too, where one follower looks after bends and touchdown."""
    model = reversing(TAU, depth=depth)
    first = model.statistics["elements"]
    found, most = shapes(model, TIMES)
    assert distance(found, reference) < 1.0
    assert first < most <= 6 * first


def test_mesh_that_stays_does_not(reference: np.ndarray) -> None:
    first = reversing(TAU).statistics["elements"]
    found, most = shapes(reversing(TAU, elements=first), TIMES)
    assert most == first
    assert distance(found, reference) > 5.0


@pytest.mark.parametrize("depth", [None, 60.0])
def test_halves_are_joined_once_the_line_hangs_again(depth: float | None) -> None:
    model = reversing(TAU, depth=depth)
    first = model.statistics["elements"]
    _shapes, most = shapes(model, TIMES)
    model.step_to(400.0)
    assert first <= model.statistics["elements"] < most
    tip = model.sample(np.array([LENGTH])).position[0]
    assert np.linalg.norm(tip - model.vessel_position - [0.0, 0.0, -LENGTH]) < TAU * LENGTH


def let_go(
    tolerance: float, rate: float, elements: int | None = None, depth: float | None = None
) -> cm.CableModel:
    """A level cable without tension, let go while the winch runs."""
    cable = cable_of(elements)
    scene = {
        "environment": water(depth),
        "cable_types": {"K": CABLE_K},
        "line": [{"cable": cable}],
        "initial": {"straight": [1.0, 0.0, 0.0]},
        "payout": {"rate": [{"t": 0.0, "rate": rate}], "drum": [{"cable": cable}]},
        "vessel": {"position": [0.0, 0.0, 0.0]},
        "solver": {"tolerance": tolerance},
        "run": {"duration": 6.0, "output_interval": 1.0},
    }
    return cm.CableModel(cm.load_scene(scene))


@pytest.mark.parametrize(
    ("rate", "most", "depth"),
    [(-0.1, 1.0, None), (0.1, 1.0, None), (0.4, 1.25, None), (-0.1, 1.0, 60.0), (0.1, 1.0, 60.0)],
)
def test_a_winch_keeps_elements_short_where_the_line_bends(
    rate: float, most: float, depth: float | None
) -> None:
    """A line that falls bends where it is held: the winch neither joins nor outgrows its mesh.

    At 0.4 m/s it was 21 tau L off after 6 s; what is left is of the first second.
    """

    times = np.arange(0.25, 6.1, 0.25).tolist()
    exact, _most = shapes(let_go(TAU / 30.0, rate, elements=96), times)
    found, _most = shapes(let_go(TAU, rate, depth=depth), times)
    assert distance(found, exact) < most


def turning_back(tolerance: float, rate: float) -> cm.CableModel:
    """100 m of line towed at 2 m/s, whose vessel turns back within 10 s while a winch runs."""
    cable = {"type": "K", "length": 100.0, "model": "elastica"}
    scene = {
        "environment": {"water_density": 1025.0},
        "cable_types": {"K": {**CABLE_K, "bending_stiffness": 1.0}},
        "line": [{"cable": cable}],
        "payout": {
            "rate": [{"t": 0.0, "rate": rate}],
            "drum": [{"cable": {**cable, "length": 20.0}}],
        },
        "vessel": {
            "position": [0.0, 0.0, 0.0],
            "velocity": [
                {"t": 0.0, "velocity": [2.0, 0.0, 0.0]},
                {"t": 2.0, "velocity": [2.0, 0.0, 0.0]},
                {"t": 12.0, "velocity": [-2.0, 0.6, 0.0]},
            ],
        },
        "solver": {"tolerance": tolerance},
        "run": {"duration": 40.0, "output_interval": 1.0},
    }
    return cm.CableModel(cm.load_scene(scene))


@pytest.mark.parametrize("rate", [-0.02, 0.02])
def test_a_slow_winch_lets_the_top_element_be_halved(rate: float) -> None:
    """The line bends right below the vessel that turns back: 3.5 tau L off with a long element."""
    tolerance = 3e-4

    times = np.arange(1.0, 40.1, 1.0).tolist()
    exact, _most = shapes(turning_back(tolerance / 20.0, rate), times)
    found, _most = shapes(turning_back(tolerance, rate), times)
    assert np.linalg.norm(found - exact, axis=2).max() < tolerance * 100.0


SPAN = 200.0
INSTANTS = [float(t) for t in np.arange(0.5, 6.1, 0.5)]


def let_go_slack(tolerance: float, body: bool, elements: int | None = None) -> cm.CableModel:
    """A line of 200 m, straight and slack at first; in its middle a body that sinks, or none."""
    pieces = 2 if body else 1
    cable = cable_of(None if elements is None else elements // pieces, SPAN / pieces, "hybrid")
    weight = {"mass": 60.0, "submerged_weight": 400.0, "added_mass": 20.0, "drag_area": 0.05}
    scene = {
        "environment": water(None),
        "cable_types": {"K": CABLE_K},
        "line": [{"cable": cable}, *([{"body": weight}, {"cable": cable}] if body else [])],
        "initial": {"straight": [1.0, 0.0, 0.2]},
        "solver": {"tolerance": tolerance},
        "run": {"duration": INSTANTS[-1]},
    }
    return cm.CableModel(cm.load_scene(scene))


@pytest.mark.parametrize("body", [False, True])
def test_the_mesh_of_a_slack_line_follows_its_kinks(body: bool) -> None:
    """Some metres of 200 bend: at the tow point, and where a body sinks from the line.

    28 elements that stayed, long ones in the middle, were 6 and 2.3 tau L off.
    """
    tolerance = 3e-4
    reference = shapes(let_go_slack(3e-5, body, elements=400), INSTANTS)[0]

    def off(elements: int | None) -> float:
        found = shapes(let_go_slack(tolerance, body, elements), INSTANTS)[0]
        return distance(found, reference, tolerance * SPAN)

    assert off(None) < 1.0
    if not body:
        assert off(elements=36) > 2.0  # as many as the mesh that follows ends with


@pytest.mark.parametrize("bending", [0.0, 1e-4])
def test_what_folds_leaves_the_winch_its_nodes(bending: float) -> None:
    """A slack column of hardly any stiffness takes all the nodes that a bend may have."""
    cable = {"type": "K", "length": 50.0, "model": "elastica"}
    scene = {
        "environment": water(None),
        "cable_types": {"K": {**CABLE_K, "bending_stiffness": bending}},
        "line": [{"cable": cable}],
        "initial": {"straight": [0.1, 0.0, 1.0]},
        "payout": {
            "rate": [{"t": 0.0, "rate": 0.0}, {"t": 1.0, "rate": 2.0}],
            "drum": [{"cable": {**cable, "length": 100.0}}],
        },
        "solver": {"tolerance": TAU},
        "run": {"duration": 60.0},
    }
    model = cm.CableModel(cm.load_scene(scene))
    first, most = model.statistics["elements"], 0
    while model.winch == "free":
        model.step(1.0)
        most = max(most, model.statistics["elements"])
    assert model.line_length == pytest.approx(150.0, rel=1e-12)
    assert most > 5 * first


def test_halves_are_not_joined_to_be_halved_again():
    """Cable is paid out while its ship gets faster: what is halved in the bend stays so."""
    kind = {
        "diameter": 0.017, "mass": 0.55, "axial_stiffness": 4e7, "bending_stiffness": 0,
        "drag_normal": 1.5, "drag_tangential": 0.005,
    }  # fmt: skip
    faster = [{"t": time, "velocity": [speed, 0, 0]} for time, speed in ((20, 2.0), (120, 3.0))]
    model = cm.CableModel(
        cm.load_scene(
            {
                "cable_types": {"c": kind},
                "line": [{"cable": {"type": "c", "length": 3000}}],
                "vessel": {"velocity": [{"t": 0, "velocity": [2, 0, 0]}, *faster]},
                "payout": {
                    "rate": [
                        {"t": time, "rate": rate} for time, rate in ((0, 0), (20, 0), (60, 4))
                    ],
                    "drum": [{"cable": {"type": "c", "length": 3000}}],
                },
            }
        )
    )
    counts = []
    for time in np.arange(0.5, 400.0, 0.5):
        model.step_to(time)
        counts.append(model.statistics["elements"])
    assert max(counts) > counts[0]
    assert np.count_nonzero(np.diff(counts)) < 40
