"""Steady lays start from their own shape, in a short time, and stay steady.

Independent: the ordinary differential equations of a cable that runs along its own shape in the
frame of its touchdown (Zajac 1957, with stretch and the momentum (m + ma) V^2), by scipy, from the
tension that the start has where it lies.
"""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

import cablemodel as cm
from benchmarks.random_scenes.ordinary import draw_ordinary
from tests.verification.references.lays import (
    ARMOURED,
    DENSITY,
    KNOT,
    LIGHT,
    bottom_tension,
    independent,
    lay,
    lay_angle,
)

SCENES = Path(__file__).parents[2] / "scenes"
SOON = 6.0
"""Seconds for a start: within 2 on a machine of its own, more where tests run side by side."""


def started(scene: cm.Scene) -> cm.CableModel:
    """The model, within a short time."""
    began = time.process_time()
    model = cm.CableModel(scene)
    assert time.process_time() - began < SOON
    return model


@pytest.mark.parametrize(
    ("kind", "knots", "depth", "bending", "slope", "slack"),
    [
        (LIGHT, 5.0, 4000.0, 20.0, 0.0, 0.0),
        (LIGHT, 5.0, 8000.0, 20.0, 0.0, 0.02),
        (LIGHT, 8.0, 500.0, 1.0, 0.0, 0.0),
        (LIGHT, 8.0, 500.0, 20.0, 0.0, 0.0),
        (LIGHT, 0.5, 500.0, 0.0, 0.0, 0.02),
        (LIGHT, 3.0, 100.0, 0.0, 0.0, 0.0),
        (ARMOURED, 8.0, 2000.0, 5000.0, 0.0, 0.0),
        (ARMOURED, 3.0, 8000.0, 1000.0, 0.0, 0.02),
        # The next three alternated between two shapes where cable is let go to the floor.
        (ARMOURED, 6.1, 607.0, 1.0, 0.0, 0.0),
        (LIGHT, 6.5, 30.0, 1.0, 0.0, 0.0),
        (ARMOURED, 4.1, 63.0, 1.0, 0.0, 0.02),
        # Level, and deep beside the layer in which the cable bends on to the floor.
        (LIGHT, 8.0, 6000.0, 5.0, 0.0, 0.0),
        (ARMOURED, 8.0, 6000.0, 2.0, 0.0, 0.02),
        (LIGHT, 1.0, 500.0, 1.0, 15.0, 0.0),
        (LIGHT, 2.0, 500.0, 20.0, 5.0, 0.0),
        (LIGHT, 5.0, 2000.0, 20.0, 5.0, 0.0),
        (ARMOURED, 2.0, 2000.0, 1000.0, -15.0, 0.0),
        (LIGHT, 2.0, 500.0, 20.0, -5.0, 0.0),
    ],
)
def test_a_steady_lay_starts_with_the_tension_of_its_lay(
    kind: dict[str, float],
    knots: float,
    depth: float,
    bending: float,
    slope: float,
    slack: float,
) -> None:
    """Within 0.5 %, and at rest: the tension that is left at the touchdown is the tolerance's."""
    scene, rate = lay(kind, knots, depth, bending=bending, slope=slope, slack=slack)
    model = started(scene)
    bottom = bottom_tension(model)
    weight, _ = lay_angle(kind, knots * KNOT)
    assert abs(bottom) < 10.0 * scene.solver.tolerance * weight * scene.line_length
    rise = -float(model.touchdown_position[2])
    top, _length = independent(kind, knots, rate, bottom, rise, straight=True)
    assert model.top_tension == pytest.approx(top, rel=5e-3)
    before, tops = model.top_tension, []
    for tenth in range(1, 101):
        model.step_to(0.1 * tenth)
        tops.append(model.top_tension)
    # Their mean: each element that lands lets tensions jump by less than is promised.
    assert np.mean(tops) == pytest.approx(before, rel=2e-2)


def test_a_power_cable_that_does_not_bend_starts_in_shallow_water() -> None:
    """Up to a meter above the floor its tension is less than the momentum that it takes along,
    (m + m_a) V^2: from rest there is no way to a shape that bends the other way there."""
    power = {
        "diameter": 0.1, "mass": 23.0, "axial_stiffness": 14e6, "drag_normal": 1.3,
        "drag_tangential": 0.006,
    }  # fmt: skip
    scene, rate = lay(power, 4.0, 15.0, bending=0.0)
    model = cm.CableModel(scene)
    rise = -float(model.touchdown_position[2])
    top, _length = independent(power, 4.0, rate, bottom_tension(model), rise, straight=True)
    assert model.top_tension == pytest.approx(top, rel=5e-3)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 211.0])
def test_a_lay_that_turns_later_starts_on_any_heading(degrees: float) -> None:
    """In space it is sought in the plane in which it hangs: off the axes rounding folded it."""
    scene, _rate = lay(LIGHT, 5.0, 1500.0, bending=1.0)
    plain = started(scene)
    heading = math.radians(degrees)
    way = np.array([math.cos(heading), math.sin(heading), 0.0])
    turned = np.array([-way[1], way[0], 0.0])
    speed = 5.0 * KNOT
    rows = [
        {"t": t, "velocity": (speed * w).tolist()}
        for t, w in ((0.0, way), (60.0, way), (120.0, turned))
    ]
    data = scene.model_dump(mode="json", exclude_unset=True)
    model = started(cm.load_scene({**data, "vessel": {"velocity": rows}}))
    assert plain.planar
    assert not model.planar
    assert model.top_tension == pytest.approx(plain.top_tension, rel=1e-9)
    assert model.touchdown_position[:2] == pytest.approx(
        plain.touchdown_position[0] * way[:2], abs=1e-6
    )


@pytest.mark.parametrize(
    ("kind", "knots", "depth", "bending"),
    [(LIGHT, 3.0, 500.0, 1.0), (ARMOURED, 8.0, 100.0, 1000.0), (ARMOURED, 2.0, 2000.0, 5000.0)],
)
def test_a_taut_lay_starts_with_what_it_drags(
    kind: dict[str, float], knots: float, depth: float, bending: float
) -> None:
    """0.2 % short: all that lies slides, and its friction is the tension at the touchdown; from
    there up the differential equations with (m + ma) V^2 hold."""
    scene, rate = lay(kind, knots, depth, bending=bending, slack=-0.002)
    with pytest.warns(cm.TautLayWarning, match="it is taut"):
        model = started(scene)
    weight, _ = lay_angle(kind, knots * KNOT)
    lying = model.floor_length
    touchdown = float(model.sample([model.line_length - lying]).tension[0])
    assert touchdown == pytest.approx(0.5 * weight * lying, rel=0.1)
    top, _length = independent(kind, knots, rate, touchdown, depth, straight=False)
    assert model.top_tension == pytest.approx(top, rel=1e-2)


SHEATHED = {
    "diameter": 0.026,
    "mass": 1.55,
    "axial_stiffness": 25e6,
    "drag_normal": 1.4,
    "drag_tangential": 0.01,
}


@pytest.mark.filterwarnings("error::cablemodel.DrawnStartWarning")
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
@pytest.mark.parametrize(
    ("kind", "knots", "depth", "bending", "slope", "slack"),
    [
        # Down and up, where the cable bends on to the floor over 2e-4 of the line and less.
        (SHEATHED, 6.0, 5000.0, 60.0, -3.0, 0.0),
        (SHEATHED, 6.0, 5000.0, 5.0, -3.0, 0.03),
        (SHEATHED, 6.0, 5000.0, 60.0, -8.0, 0.03),
        (SHEATHED, 6.0, 5000.0, 20.0, -8.0, 0.0),
        (SHEATHED, 6.0, 5000.0, 60.0, 8.0, 0.0),
        (SHEATHED, 3.0, 2500.0, 60.0, 12.0, 0.0),
        # The contact layer is thin against that bend.
        (SHEATHED, 1.5, 60.0, 20.0, -3.0, 0.0),
        (SHEATHED, 1.5, 60.0, 60.0, -3.0, 0.03),
    ],
)
def test_thin_cable_starts_on_slopes_as_it_is_laid(
    kind: dict[str, float],
    knots: float,
    depth: float,
    bending: float,
    slope: float,
    slack: float,
    tolerance: float,
) -> None:
    """Straight at the lay angle, in closed form: T = (w sin a - ft) s from no tension at the floor,
    and s (1 + T/2EA) reaches up to the vessel."""
    scene, rate = lay(
        kind, knots, depth, bending=bending, slope=slope, slack=slack, tolerance=tolerance
    )
    model = started(scene)
    speed, up = knots * KNOT, math.radians(slope)
    weight, down = lay_angle(kind, speed)
    along = rate - speed * math.cos(down)
    drag = 0.5 * DENSITY * kind["drag_tangential"] * math.pi * kind["diameter"]
    load = weight * math.sin(down) - drag * abs(along) * along
    chord = depth * math.cos(up) / math.sin(down - up)
    ease = load / (2.0 * kind["axial_stiffness"])
    top = load * (math.sqrt(1.0 + 4.0 * ease * chord) - 1.0) / (2.0 * ease)
    assert model.top_tension == pytest.approx(top, rel=2e-3)


@pytest.mark.parametrize(("slope", "slack"), [(12.0, -0.02), (12.0, -0.3), (6.0, -0.1)])
def test_a_taut_lay_up_a_slope_starts_with_what_it_drags(slope: float, slack: float) -> None:
    """w times the height that hangs, by any shape, and (mu cos b + sin b) w of each metre that lies
    (without drag along the cable); and so it goes on, without a jump."""
    kind = {**LIGHT, "drag_tangential": 0.0}
    scene, _rate = lay(kind, 2.0, 170.0, bending=700.0, slope=slope, slack=slack)
    with pytest.warns(cm.TautLayWarning, match="it is taut"):
        model = started(scene)
    weight, _ = lay_angle(kind, 2.0 * KNOT)
    up = math.radians(slope)
    lies = model.floor_length * (0.5 * math.cos(up) + math.sin(up))
    expected = weight * (lies - float(model.touchdown_position[2]))
    assert model.top_tension == pytest.approx(expected, rel=1e-2)
    first, tops = model.top_tension, []
    for second in (5.0, 10.0):
        model.step_to(second)
        tops.append(model.top_tension)
    assert tops[1] - first == pytest.approx(2.0 * (tops[0] - first), abs=5e-3 * first)


@pytest.mark.parametrize("slack", [0.0, 0.1])
def test_a_lay_that_the_floor_bears_in_part_touches_it(slack: float) -> None:
    """Two degrees steeper than its floor the flow carries half of it, and it lay as near the floor
    nowhere as cable lies: no touchdown and no length on it, under a force of 800 N."""
    scene, _rate = lay(LIGHT, 7.3, 222.0, bending=20.0, slope=5.0, slack=slack)
    model = started(scene)
    weight, _ = lay_angle(LIGHT, 7.3 * KNOT)
    assert model.floor_force[2] > 0.3 * weight * 282.0
    assert model.floor_length == pytest.approx(282.0, rel=0.02)
    hanging = model.line_length - model.floor_length
    assert model.touchdown_position == pytest.approx(model.sample([hanging]).position[0], abs=1e-6)


def test_a_lay_up_a_slope_is_not_a_drag() -> None:
    """Less is paid out up a slope than the vessel goes, and nothing is dragged by that."""
    scene, rate = lay(LIGHT, 1.0, 200.0, bending=1.0, slope=15.0)
    assert rate < 0.9 * KNOT
    model = started(scene)
    assert abs(bottom_tension(model)) < 0.02 * model.top_tension


def test_the_ready_lay_at_5_knots() -> None:
    """10.8 degrees, 12.4 kN less the drag: w h, and 660 N more once the winch falls short."""
    scene = cm.load_scene(SCENES / "cable_lay_5_knots.yaml")
    model = started(scene)
    kind = {**LIGHT, "drag_tangential": 0.005}
    top, length = independent(kind, 5.0, 5.0 * KNOT, 0.0, 4000.0, straight=True)
    assert model.top_tension == pytest.approx(top, rel=3e-3)
    assert model.line_length - model.floor_length == pytest.approx(length, rel=3e-3)
    model.step_to(60.0)
    assert model.top_tension == pytest.approx(top, rel=5e-3)


def test_cable_lay_at_two_metres_a_second() -> None:
    """The ready lay, faster and with more cable out: 30 degrees."""
    data: dict[str, Any] = cm.load_scene(SCENES / "cable_lay.yaml").to_dict()
    data["line"][0]["cable"]["length"] = 7000.0
    data["vessel"]["velocity"] = [2, 0, 0]
    data["payout"]["rate"] = [{"t": 0, "rate": 2.0}]
    model = started(cm.load_scene(data))
    kind = data["cable_types"]["armoured"]
    drag = 0.5 * DENSITY * kind["drag_normal"] * kind["diameter"] * 4.0
    cosine = (-15.0 + math.sqrt(15.0**2 + 4.0 * drag**2)) / (2.0 * drag)
    slip = 2.0 - 2.0 * cosine
    along = 0.5 * DENSITY * kind["drag_tangential"] * math.pi * kind["diameter"] * slip**2
    expected = (15.0 - along / math.sqrt(1.0 - cosine**2)) * 3000.0
    assert model.top_tension == pytest.approx(expected, rel=5e-3)


def from_points(**initial: Any) -> dict[str, Any]:
    """A lay at 2 m/s in 500 m of water from three points."""
    return {
        "environment": {"floor": {"z": -500, "friction": 0.5}},
        "cable_types": {"c": {**LIGHT, "bending_stiffness": 20}},
        "line": [{"cable": {"type": "c", "length": 2350}}],
        "vessel": {"velocity": [2, 0, 0]},
        "payout": {
            "rate": [{"t": 0, "rate": 2}],
            "drum": [{"cable": {"type": "c", "length": 1000}}],
        },
        "initial": {"points": [[0, 0, 0], [-2000, 0, -500], [-2285, 0, -500]], **initial},
    }


def test_points_take_the_velocity_of_the_steady_lay() -> None:
    model = started(cm.load_scene(from_points()))
    weight, _ = lay_angle(LIGHT, 2.0)
    assert model.top_tension == pytest.approx(500.0 * weight, rel=2e-2)
    model.step_to(60.0)
    assert model.top_tension == pytest.approx(500.0 * weight, rel=3e-2)


def test_points_take_velocities() -> None:
    """Of each point, and smoothly between them along the line."""
    given = [[2, 0, 0], [1, 0, 0.5], [0, 0, 0]]
    model = cm.CableModel(cm.load_scene(from_points(velocities=given)))
    chords = np.array([0.0, math.hypot(2000.0, 500.0), 285.0]).cumsum()
    ways = [(0, 1), (0, 2), (1, 2)]  # from a point's neighbour to the other one
    slopes = [np.subtract(given[b], given[a]) / (chords[b] - chords[a]) for a, b in ways]
    between = CubicHermiteSpline(chords, given, slopes)
    places = [0.25 * chords[-1], chords[1], model.line_length]
    near, middle, far = model.sample(places).velocity
    assert near == pytest.approx(between(places[0]), abs=0.02)
    assert middle == pytest.approx(given[1], abs=0.02)
    assert np.abs(far).max() < 1e-9


@pytest.mark.parametrize("rest", ["rest", [[0, 0, 0]] * 3])
def test_rest_under_a_ship_that_moves_is_refused(rest: Any) -> None:
    """By its name, or as velocities that are all zero."""
    with pytest.raises(cm.SceneError, match=r"initial.velocities.*moves at 2 m/s.*jerk"):
        cm.load_scene(from_points(velocities=rest))
    still = from_points(velocities=rest) | {"vessel": {"velocity": [0, 0, 0]}}
    assert not cm.load_scene(still).notes


def test_no_line_to_an_anchor_moves_steadily() -> None:
    data = from_points(velocities="steady") | {"end": {"anchor": [-2285, 0, -500]}}
    with pytest.raises(cm.SceneError, match=r"initial.velocities.*away from an anchor"):
        cm.load_scene(data)


@pytest.mark.parametrize("change", ["winch stands", "drum is empty", "anchored", "direct"])
def test_rest_under_a_ship_that_moves_is_told(change: str) -> None:
    """Where nothing asks for the steady lay: it was not told of under a full drum that stands."""
    data = from_points()
    assert not cm.load_scene(data).notes
    if change == "winch stands":
        data["payout"]["rate"] = 0.0
    elif change == "drum is empty":
        del data["payout"]["drum"]
    elif change == "anchored":
        data["end"] = {"anchor": [-2285, 0, -500]}
    else:
        data["solver"] = {"method": "direct_integration"}
    (note,) = cm.load_scene(data).notes
    assert "start at rest under a tow point that moves at 2 m/s" in note
    assert ("steady" in note) == (change in ("winch stands", "drum is empty"))


def test_a_straight_line_at_rest_under_a_ship_that_moves_is_told() -> None:
    """Unless a winch pays it out: it moves along with the ship then."""
    data = from_points() | {"initial": {"straight": [-0.9, 0.0, -0.1]}}
    assert not cm.load_scene(data).notes
    del data["payout"]
    (note,) = cm.load_scene(data).notes
    assert "starts at rest under a tow point that moves at 2 m/s: the line is jerked" in note
    assert "initial: static" in note


def test_direct_integration_refuses_velocities_of_points() -> None:
    data = from_points(velocities="steady") | {"solver": {"method": "direct_integration"}}
    with pytest.raises(cm.SceneError, match=r"initial.velocities.*starts points at rest"):
        cm.CableModel(cm.load_scene(data))


def test_a_start_that_takes_too_long_says_what_was_tried() -> None:
    """And what makes it hard; a limit of no time at all is the shortest there is."""
    scene, _ = lay(LIGHT, 5.0, 4000.0, bending=20.0)
    data = {**scene.to_dict(), "solver": {"start_time_limit": 1e-6}}
    with pytest.raises(cm.StaticsError, match=r"start_time_limit.*Tried: .*over 1.9 m of a line"):
        cm.CableModel(cm.load_scene(data))


REPEATER = {"name": "rep", "mass": 83, "submerged_weight": 500, "half_length": 0.8}


@pytest.mark.parametrize(
    ("path", "value", "reason"),
    [
        ("environment.floor.slope", [0.22, 0.0], "rises by 12.4 degrees .* comes down at 7.75: "),
        ("line.1", {"body": REPEATER}, "body rep weighs 500 N, more than the 150.5 N"),
        ("environment.current", [0.0, 1.2, 0.0], "drags at what lies there with 18.8 N/m, and fri"),
        ("environment.floor.friction", 0.01, "friction of 0.01 holds nothing on a slope of 0.02"),
    ],
)
def test_what_was_hard_about_a_start_is_named(path: str, value: Any, reason: str) -> None:
    scene, _ = lay(LIGHT, 7.0, 40.0, bending=5.0, slope=math.degrees(math.atan(0.02)))
    data = scene.to_dict()
    data["solver"] = {"start_time_limit": 1e-6}
    if path == "line.1":
        data["line"] += [value, data["line"][0]]
        overrides = []
    else:
        overrides = [f"{path}={value}"]
    with pytest.raises(cm.StaticsError, match=f"What makes it hard: .*{reason}"):
        cm.CableModel(cm.load_scene(data, overrides))


def hills(
    kind: dict[str, float], knots: float, depth: float, height: float, length: float, ahead: float
) -> cm.Scene:
    """An exact lay over hills that are so high and long; ahead: of their phase at the ship."""
    level, _rate = lay(kind, knots, depth, bending=kind["bending_stiffness"])
    data = level.to_dict()
    reach = 1.6 * data["line"][0]["cable"]["length"] + 500.0
    x = np.arange(-reach, 0.1 * reach + 300.0, length / 16.0)
    z = height * np.sin(2.0 * np.pi * x / length + ahead) - depth
    table = [{"x": float(a), "z": float(b)} for a, b in zip(x, z, strict=True)]
    data["environment"]["floor"] = {"depth_table": table, "friction": 0.5}
    return cm.load_scene(data)


THIN = {
    "diameter": 0.0234, "mass": 0.82, "axial_stiffness": 10e6, "bending_stiffness": 8.0,
    "drag_normal": 1.4, "drag_tangential": 0.006,
}  # fmt: skip


@pytest.mark.parametrize("ahead", [0.0, 3.5])
@pytest.mark.filterwarnings("error::cablemodel.DrawnStartWarning")
def test_a_lay_over_hills_starts_without_tension_where_it_lands(ahead: float) -> None:
    """It started as a drag, or was refused: on long bristles what lies slid from crest to crest."""
    model = started(hills(THIN, 6.0, 4000.0, 33.3, 2400.0, ahead))
    deep = -float(model.touchdown_position[2])
    top, _length = independent(THIN, 6.0, 6.0 * KNOT, 0.0, deep, straight=True)
    assert model.top_tension == pytest.approx(top, rel=1e-2)


@pytest.mark.parametrize(
    ("kind", "knots", "depth", "slack"),
    [(LIGHT, 6.0, 300.0, 0.03), (ARMOURED, 4.0, 400.0, 0.05), (LIGHT, 3.0, 100.0, 0.1)],
)
def test_slack_without_bending_stiffness_takes_hardly_anything_off_the_top_tension(
    kind: dict[str, float], knots: float, depth: float, slack: float
) -> None:
    """It leaves the floor without tension, and is limp there: what folds does not push back. How it
    folds is chance: of three runs whose weights differ by 1e-8 the middle one is taken."""
    means, largest = [], []
    for more in (0.0, 1e-8, 2e-8):
        heavier = {**kind, "mass": kind["mass"] * (1.0 + more)}
        scene, rate = lay(heavier, knots, depth, bending=0.0, slack=slack)
        model = started(scene)
        tops = []
        for second in range(1, 101):
            model.step_to(float(second))
            tops.append(model.top_tension)
        top, _length = independent(heavier, knots, rate, 0.0, depth, straight=True)
        means.append(np.mean(tops[50:]) / top - 1.0)
        largest.append(np.abs(np.array(tops) / top - 1.0).max())
    assert abs(np.median(means)) < 5e-3
    assert np.median(largest) < 1.5e-2


def test_a_lay_down_a_slope_that_gets_too_little_cable_is_told() -> None:
    """It keeps up with the ship and not with the touchdown: 1.0 and 1.008 times the speed here."""
    exact, rate = lay(LIGHT, 2.0, 200.0, bending=1.0, slope=-5.0)
    data = exact.model_dump(mode="json", exclude_unset=True)
    data["payout"]["rate"] = 2.0 * KNOT
    with pytest.warns(cm.TautLayWarning) as told:
        model = cm.CableModel(cm.load_scene(data))
    warning = told[0].message
    assert isinstance(warning, cm.TautLayWarning)
    assert warning.needed == pytest.approx(rate, rel=1e-12)
    before = model.top_tension
    model.step_to(30.0)
    assert model.top_tension > 1.02 * before


def test_a_lay_that_is_taut_from_the_start_is_told() -> None:
    """With the tension where it lands: the friction of all that is dragged."""
    exact, rate = lay(LIGHT, 2.0, 200.0, bending=1.0)
    data = exact.model_dump(mode="json", exclude_unset=True)
    data["payout"]["rate"] = 0.97 * rate
    with pytest.warns(cm.TautLayWarning, match="it is taut") as told:
        model = cm.CableModel(cm.load_scene(data))
    (warning,) = (each.message for each in told)
    assert isinstance(warning, cm.TautLayWarning)
    assert (warning.rate, warning.needed) == pytest.approx((0.97 * rate, rate), rel=1e-12)
    weight, _ = lay_angle(LIGHT, 2.0 * KNOT)
    assert warning.tension == pytest.approx(0.5 * weight * model.floor_length, rel=0.03)


def test_a_lay_over_ridges_that_gets_too_little_cable_is_told() -> None:
    exact, rate = lay(LIGHT, 2.0, 200.0, bending=1.0)
    data = exact.model_dump(mode="json", exclude_unset=True)
    table = [{"x": x, "z": -200.0 + math.sin(x / 30.0)} for x in np.arange(-900.0, 301.0, 15.0)]
    data["environment"]["floor"] = {"depth_table": table, "friction": 0.5}
    data["payout"]["rate"] = 0.97 * rate
    with pytest.warns(cm.TautLayWarning, match="a lay over these ridges takes 1.0289 m/s"):
        cm.CableModel(cm.load_scene(data))


@pytest.mark.parametrize("seed", [22508, 24349, 25763, 29753])
@pytest.mark.filterwarnings("error")
def test_thin_cable_across_a_current_starts_without_tension_where_it_lands(seed: int) -> None:
    """Ordinary jobs that were refused, or started drawn. Without drag along itself a line that
    lands without tension carries at its top the weight of as much cable as the water is deep."""
    drawn = draw_ordinary(seed)
    model = cm.CableModel(cm.load_scene(drawn.scene))
    length, top = model.line_length, model.top_tension
    state = model.sample(np.linspace(0.0, length, 2001))
    lands = int(np.flatnonzero(state.on_floor)[0])
    assert abs(state.tension[lands]) < 10.0 * drawn.tolerance * top
    weight = drawn.scene["cable_types"]["K"]["submerged_weight"]
    assert top == pytest.approx(-weight * state.position[lands, 2], rel=1e-2)


@pytest.mark.parametrize("laid", [300.0, 1000.0, 2000.0])
def test_a_lay_goes_on_however_much_has_been_laid(laid: float) -> None:
    """At one knot in 20 m nothing changes, whatever lies behind. (1.2 % of the tension at worst,
    as what lies is pushed by a tenth of a millimetre.)"""
    kind = {"diameter": 0.14, "mass": 38.0, "axial_stiffness": 4e8, "bending_stiffness": 5e3,
            "drag_normal": 1.2, "drag_tangential": 0.01}  # fmt: skip
    scene = {
        "environment": {"floor": {"z": -20.0, "friction": 0.5}},
        "cable_types": {"power": kind},
        "line": [{"cable": {"type": "power", "length": 20.0 + laid}}],
        "vessel": {"velocity": [KNOT, 0.0, 0.0]},
        "payout": {"rate": KNOT, "drum": [{"cable": {"type": "power", "length": 500.0}}]},
    }
    model = cm.CableModel(cm.load_scene(scene))
    weight = 9.80665 * (kind["mass"] - 1025.0 * math.pi / 4.0 * kind["diameter"] ** 2)
    # T = w h + (m + m_a) V^2 less the drag along it, a few newtons.
    for second in range(1, 301):
        model.step_to(float(second))
        assert model.top_tension == pytest.approx(20.0 * weight, rel=1.5e-2), second


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_slack_that_was_laid_has_one_tension(tolerance: float) -> None:
    """It lies in waves of a few tenths of a metre, and presses itself by 16 N of 12,400; from
    element to element it was +-76 N at 1e-4, by a stiffness made for all its weight and drag."""
    scene = Path(__file__).parents[2] / "docs/jobs/lay_with_slack.yaml"
    model = cm.CableModel(cm.load_scene(scene, f"solver.tolerance={tolerance:g}"))
    model.step_to(240.0)
    laid = model.line_length - model.floor_length + np.linspace(20.0, 320.0, 1000)
    tension = model.sample(laid).tension
    assert np.abs(tension - np.median(tension)).max() < min(10.0 * tolerance * 12.4e3, 15.0)
