"""Static starts that the plainest first shape does not lead to, and which way those lie that
nothing turns. The scenes are of the random search, with a vessel at rest and no winch."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import cablemodel as cm
from benchmarks.random_scenes.draw import draw
from tests.verification.scenes import CABLE_K

PLACES = np.linspace(0.0, 1.0, 33)


def at_rest(seed: int, finer: float) -> cm.Scene:
    """The line of a random scene under a vessel at rest.

    finer: what the scene's tolerance is divided by.
    """
    drawn = draw(seed)
    scene: dict[str, Any] = {**drawn.scene, "payout": {}}
    kept = ("position", "connection")
    scene["vessel"] = {key: value for key, value in scene["vessel"].items() if key in kept}
    current = scene["environment"].get("current")
    if isinstance(current, dict):  # it stays as it is at the start
        rows = [row for row in current["table"] if row["t"] == 0.0]
        scene["environment"] = {**scene["environment"], "current": {"table": rows}}
    scene["solver"] = {**scene["solver"], "tolerance": drawn.tolerance / finer}
    return cm.load_scene(scene)


@pytest.mark.parametrize(
    ("seed", "finer"),
    [
        pytest.param(49, 1.0, id="heavy body, clamp that turns the line back"),
        pytest.param(88, 2.0, id="the same with a body of finite length, hybrid"),
        pytest.param(470, 1.0, id="body on coarse elements"),
        pytest.param(743, 1.0, id="swept by a current between its ends"),
        pytest.param(828, 2.0, id="clamped line in a current"),
    ],
)
def test_a_start_is_found_and_is_one_of_rest(seed: int, finer: float) -> None:
    """The same at a quarter of the tolerance; and a run, whose equations are those of motion and
    not of the search, leaves it where it is."""
    coarse, fine = (cm.CableModel(at_rest(seed, finer * factor)) for factor in (1.0, 4.0))
    length = coarse.line_length
    allowed = 1.25 * coarse.scene.solver.tolerance * length
    first = coarse.sample(PLACES * length).position
    assert np.linalg.norm(fine.sample(PLACES * length).position - first, axis=1).max() < allowed
    coarse.step(5.0)
    later = coarse.sample(PLACES * length).position
    assert np.linalg.norm(later - first, axis=1).max() < 0.5 * allowed


@pytest.mark.parametrize(
    ("seed", "finer"),
    [
        pytest.param(202, 1.0, id="what lies is drawn down a slope, against the current"),
        pytest.param(767, 1.0, id="at the finer tolerance it sank too deep into the softest floor"),
    ],
)
def test_a_start_is_found_at_both_tolerances(seed: int, finer: float) -> None:
    """The tension at the top is that of the same shape."""
    coarse, fine = (cm.CableModel(at_rest(seed, finer * factor)) for factor in (1.0, 4.0))
    length = coarse.line_length
    away = fine.sample(PLACES * length).position - coarse.sample(PLACES * length).position
    assert np.linalg.norm(away, axis=1).max() < 1.25 * coarse.scene.solver.tolerance * length
    assert fine.top_tension == pytest.approx(coarse.top_tension, rel=2e-3)


@pytest.mark.slow
def test_a_mesh_does_not_chase_what_lies() -> None:
    """Laid anew on each finer mesh, this line slid on over its slope, until 620 elements."""
    drawn = draw(402)
    model = cm.CableModel(cm.load_scene(drawn.scene))
    assert model.statistics["elements"] < 200


def test_a_clamp_that_was_turned_has_the_moment_of_its_layer() -> None:
    """A long line under a clamp that turns it back by more than a right angle, over layers that its
    elements resolve: 2 sqrt(EI T) sin(angle/2), T being the tension beyond the layer."""
    scene = at_rest(88, 2.0)
    model = cm.CableModel(scene)
    below = model.sample([1.0])  # 70 layers down
    clamp = np.asarray(scene.vessel.connection.direction)
    cosine = float(clamp @ below.tangent[0]) / float(np.linalg.norm(clamp))
    assert cosine < -0.5
    stiffness = scene.cable_types["K"].bending_stiffness
    moment = 2.0 * math.sqrt(stiffness * below.tension[0]) * math.sqrt(0.5 * (1.0 - cosine))
    assert np.linalg.norm(model.top_moment) == pytest.approx(moment, rel=0.02)


@pytest.mark.parametrize("finer", [1.0, 2.0, 4.0])
def test_a_line_lies_the_way_it_was_laid(finer: float) -> None:
    """Behind the vessel, where neither friction nor water turns it: a start that is found on softer
    floors lay towards x."""
    drawn = draw(813)
    solver = {**drawn.scene["solver"], "tolerance": drawn.tolerance / finer}
    model = cm.CableModel(cm.load_scene({**drawn.scene, "solver": solver}))
    velocity = model.scene.motion().evaluate(0.0)[1][:2]
    behind, end = -velocity / np.linalg.norm(velocity), model.tip_position[:2]
    assert end @ behind > 0.0
    aside = end - (end @ behind) * behind
    assert np.linalg.norm(aside) < drawn.tolerance * model.line_length


@pytest.mark.parametrize("length", [72.0, 77.3, 79.0])
@pytest.mark.parametrize("tolerance", [1e-3, 2e-4])
def test_a_thick_cable_that_hangs_straight_down_to_its_anchored_rest_starts(length, tolerance):
    """A catenary would turn on to the floor within its layer (EI/w)^(1/3) of 2.4 m, or much less.
    From one as wide as that, which is 6 m shorter than the cable, no start was found."""
    scene = {
        "environment": {"floor": {"z": -29.34, "friction": 0.5}},
        "cable_types": {
            "K": {
                "diameter": 0.0657,
                "mass": 16.84,
                "submerged_weight": 131.0,
                "axial_stiffness": 2.18e8,
                "bending_stiffness": 1855.0,
            }
        },
        "line": [{"cable": {"type": "K", "length": length}}],
        "end": {"anchor": [50.5, 0.0, -29.34]},
    }
    coarse, fine = (
        cm.CableModel(cm.load_scene({**scene, "solver": {"tolerance": tolerance / finer}}))
        for finer in (1.0, 4.0)
    )
    away = fine.sample(PLACES * length).position - coarse.sample(PLACES * length).position
    assert np.linalg.norm(away, axis=1).max() < 1.25 * tolerance * length
    # What hangs is carried by the top alone, but for what the bend puts on the floor.
    assert fine.top_tension == pytest.approx(coarse.top_tension, abs=12.5 * tolerance * 4000.0)
    assert 131.0 * 29.34 - 157.0 < fine.top_tension < 131.0 * (length - 37.0)


@pytest.mark.parametrize(
    ("height", "stiffness", "clamped", "speed"),
    [
        (0.0, 10.0, False, 0.5),
        (-4e-5, 10.0, False, 0.0),
        (1.0, 200.0, True, 0.0),
        (0.2, 200.0, True, 0.0),
        (0.2, 50.0, True, 0.5),
    ],
)
def test_a_tow_point_at_the_floor_starts(height, stiffness, clamped, speed):
    vessel = {"position": [0, 0, height - 100.0], "velocity": [speed, 0, 0]}
    if clamped:
        vessel["connection"] = {"clamped": [-1, 0, 0]}
    model = cm.CableModel(
        cm.load_scene(
            {
                "environment": {"floor": {"z": -100, "friction": 0.5}},
                "cable_types": {
                    "K": {
                        "diameter": 0.03,
                        "mass": 2.0,
                        "submerged_weight": 10.0,
                        "axial_stiffness": 1e6,
                        "bending_stiffness": stiffness,
                    }
                },
                "line": [{"cable": {"type": "K", "length": 50}}],
                "vessel": vessel,
            }
        )
    )
    heights = model.sample(np.linspace(0.0, 50.0, 101)).position[:, 2] + 100.0
    within = 0.05  # tau L
    assert heights.min() > -within
    assert abs(heights[50:]).max() < within
    assert heights.max() < height + 2.0  # a stiff one may arch, none stands
    model.step(1.0)
    assert np.isfinite(model.top_tension)


def bight(
    model: str, bending: float, across: float, deeper: float = 0.0, **cable: float
) -> cm.Scene:
    """50 m of cable between two ends near each other, the anchor `deeper` than the tow point."""
    way = np.array([0.6, 0.8])
    return cm.load_scene(
        {
            "cable_types": {"K": {**CABLE_K, "bending_stiffness": bending, **cable}},
            "line": [{"cable": {"type": "K", "length": 50.0, "model": model}}],
            "end": {"anchor": [*(across * way).tolist(), -deeper]},
            "vessel": {"position": [0.0, 0.0, 0.0]},
            "solver": {"tolerance": 1e-3},
        }
    )


@pytest.mark.parametrize("model", ["cable", "hybrid"])
@pytest.mark.parametrize("weight", [2.33333, -2.33333])
@pytest.mark.parametrize("across", [0.1, 0.3, 1.0, 1.5])
@pytest.mark.parametrize("deeper", [0.0, 5.0])
def test_a_bight_is_a_catenary(model: str, weight: float, across: float, deeper: float) -> None:
    found = cm.CableModel(bight(model, 0.0, across, deeper, submerged_weight=weight))
    # The radius at the bend: sinh(x) / x = sqrt(L^2 - v^2) / h, x = h / 2a.
    ratio = math.sqrt(50.0**2 - deeper**2) / across
    half = brentq(lambda x: math.sinh(x) / x - ratio, 1e-3, 20.0)
    radius = 0.5 * across / half
    rise = math.copysign(deeper, weight)
    first = radius * math.sinh(math.atanh(rise / 50.0) + half)
    depth = radius * (math.hypot(1.0, first / radius) - 1.0)
    heights = found.sample(np.linspace(0.0, 50.0, 2001)).position[:, 2]
    lowest = heights.min() if weight > 0.0 else -heights.max()
    assert lowest == pytest.approx(-depth, abs=1e-3 * 50.0)
    assert found.top_tension == pytest.approx(abs(weight) * (radius + depth), rel=1e-2)
    before = found.sample(PLACES * 50.0).position
    found.step(5.0)
    later = found.sample(PLACES * 50.0).position
    assert np.linalg.norm(later - before, axis=1).max() < 0.5e-3 * 50.0


@pytest.mark.parametrize("bending", [0.1, 10.0])
@pytest.mark.parametrize("across", [0.1, 1.0])
def test_a_stiff_bight_turns_within_its_layer(bending: float, across: float) -> None:
    """Below the legs, which hang straight, its shape is that of (EI/w)^(1/3) alone: of eight times
    the stiffness it is twice as large. And it rests."""
    layer = (bending / 2.33333) ** (1.0 / 3.0)
    curvatures = []
    for stiff, wide in ((bending, across), (8.0 * bending, 2.0 * across)):
        scene = bight("elastica", stiff, wide)
        found = cm.CableModel(scene)
        curvatures.append(found.state().curvature.max())
        before = found.sample(PLACES * 50.0).position
        found.step(5.0)
        later = found.sample(PLACES * 50.0).position
        assert np.linalg.norm(later - before, axis=1).max() < 0.5e-3 * 50.0
    assert curvatures[0] == pytest.approx(2.0 * curvatures[1], rel=0.1)
    assert 0.3 < curvatures[0] * layer < 3.0


@pytest.mark.parametrize("weight", [2.33333, -2.33333])
@pytest.mark.parametrize(("length", "across"), [(5.0, 0.4), (15.0, 0.0), (50.0, 0.0)])
def test_a_stiff_loop_between_ends_as_good_as_at_one_place(
    length: float, across: float, weight: float
) -> None:
    """The same at a quarter of the tolerance, and at rest in a run; its ends carry it by halves."""
    shapes = []
    for tolerance in (1e-3, 2.5e-4):
        data = bight("hybrid", 10.0, across, submerged_weight=weight).to_dict()
        data["line"][0]["cable"]["length"] = length
        data["solver"] = {"tolerance": tolerance}
        found = cm.CableModel(cm.load_scene(data))
        before = found.sample(PLACES * length).position
        shapes.append(before)
        assert -found.top_force[2] == pytest.approx(0.5 * weight * length, rel=1e-2)
        found.step(5.0)
        later = found.sample(PLACES * length).position
        assert np.linalg.norm(later - before, axis=1).max() < 0.5 * tolerance * length
    # Loops of ends at one place may lie in any plane, of a scene that lies in one in x and z.
    assert np.linalg.norm(shapes[0] - shapes[1], axis=1).max() < 1.25e-3 * length
