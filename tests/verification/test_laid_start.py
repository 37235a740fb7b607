"""Static starts of cable that friction holds where it was laid: on slopes, and across a current."""

import itertools
import warnings

import numpy as np
import pytest

import cablemodel as cm
from benchmarks import random_lays
from benchmarks.random_lays import landing
from benchmarks.random_scenes.draw import draw
from cablemodel.solvers.estimating import PLACES

TOLERANCE = 1e-3
LENGTH, DEPTH, WEIGHT = 500.0, 200.0, 17.41  # [m], [m], [N/m]


def lay(slope: float = 0.0, current: object = "none", friction: float = 0.4) -> cm.Scene:
    """A steady lay at 0.6 m/s towards x in 200 m of water, 500 m of cable out."""
    return cm.load_scene(
        {
            "environment": {
                "floor": {"z": -DEPTH, "slope": [slope, 0], "friction": friction},
                "current": current,
            },
            "cable_types": {
                "c": {
                    "diameter": 0.03, "mass": 2.5, "submerged_weight": WEIGHT,
                    "axial_stiffness": 20e6, "bending_stiffness": 200,
                }
            },
            "line": [{"cable": {"type": "c", "length": LENGTH}}],
            "vessel": {"velocity": [0.6, 0, 0]},
            "payout": {"rate": 0.6, "drum": [{"cable": {"type": "c", "length": 1000}}]},
            "solver": {"tolerance": TOLERANCE},
        }
    )  # fmt: skip


@pytest.mark.filterwarnings("ignore::cablemodel.TautLayWarning")
@pytest.mark.parametrize("slope", [-0.04, 0.04])
def test_cable_on_a_slope_stays_where_it_was_laid(slope: float) -> None:
    """Friction of 0.4 holds cable on a slope of 0.04; it slid to a heap of folds without."""
    model = cm.CableModel(lay(slope))
    touchdown, end = model.touchdown_position, model.tip_position
    # What lies is straight: as long as the way from the touchdown to the end.
    lying = float(np.linalg.norm(end - touchdown))
    assert lying == pytest.approx(model.floor_length, abs=2e-3 * LENGTH)
    behind = model.sample(np.linspace(LENGTH - 0.9 * lying, LENGTH, 300))
    assert np.all(behind.on_floor)
    assert np.max(behind.curvature) < 1e-3
    # Zajac's lay law: without tension where it lands, the vessel bears the weight down to there.
    assert model.top_tension == pytest.approx(-WEIGHT * touchdown[2], rel=0.01)
    model.step(60.0)
    assert np.linalg.norm(model.tip_position - end) < TOLERANCE * LENGTH


def test_a_lay_starts_in_a_cross_current() -> None:
    """What hangs is blown to the side; the lay lies straight, along the vessel's way, where it
    lands."""
    model = cm.CableModel(lay(current=[0.0, 0.3, 0.0]))
    end = model.tip_position
    assert model.touchdown_position[1] > 10.0
    assert abs(end[1] - model.touchdown_position[1]) < TOLERANCE * LENGTH
    for duration in (0.0, 900.0):
        if duration:
            model.step(duration)
        # Along any flexible cable the tension grows by its weight down to the touchdown, less the
        # drag along it, some 10 N here.
        whole = model.sample(np.linspace(0.0, model.line_length, 2000))
        touchdown = int(np.argmax(whole.on_floor))
        grown = model.top_tension - whole.tension[touchdown]
        assert grown == pytest.approx(WEIGHT * DEPTH, rel=10 * TOLERANCE)
        assert np.linalg.norm(model.tip_position - end) < TOLERANCE * LENGTH


def lay_across(slope: list[float], stiffness: float) -> cm.Scene:
    """A lay at 2.5 m/s with a little slack in 1,000 m, a current across that fades downwards."""
    return cm.load_scene(
        {
            "environment": {
                "floor": {"z": -1000.0, "slope": slope, "friction": 0.7},
                "current": {
                    "table": [
                        {"z": 0.0, "velocity": [-0.2, 0.4, 0.0]},
                        {"z": -1000.0, "velocity": [0.0, 0.05, 0.0]},
                    ]
                },
            },
            "cable_types": {
                "c": {
                    "diameter": 0.02, "mass": 0.8, "submerged_weight": 4.0,
                    "axial_stiffness": 2e6, "bending_stiffness": stiffness,
                }
            },
            "line": [{"cable": {"type": "c", "length": 6000.0}}],
            "vessel": {"velocity": [2.5, 0.0, 0.0]},
            "payout": {"rate": 2.53, "drum": [{"cable": {"type": "c", "length": 1000.0}}]},
        }
    )  # fmt: skip


@pytest.mark.parametrize("stiffness", [0.0, 1.0, 20.0, 200.0])
@pytest.mark.parametrize("slope", [[0.0, 0.0], [0.01, -0.03]])
def test_a_laid_line_pulls_at_nothing(slope: list[float], stiffness: float) -> None:
    """A lay with a little slack starts with no tension in what lies, along the vessel's way behind
    the place where it lands, at every tolerance."""
    scene = lay_across(slope, stiffness)
    lands, pull, _length = landing(scene)
    tensions = []
    for tolerance in (1e-3, 2e-4, 5e-5)[: 3 if stiffness > 1.0 else 2]:
        settings = scene.solver.model_copy(update={"tolerance": tolerance})
        model = cm.CableModel(scene.model_copy(update={"solver": settings}))
        tensions.append(model.top_tension)
        lies = model.line_length - model.floor_length + np.linspace(20.0, 1000.0, 50)
        assert np.abs(model.sample(lies).tension).max() < 10.0 * tolerance * model.top_tension
        assert model.top_tension == pytest.approx(pull, rel=0.5 * TOLERANCE)
        assert model.touchdown_position[1] == pytest.approx(lands[1], abs=TOLERANCE * 6000.0)
        assert model.tip_position[1] == pytest.approx(lands[1], abs=TOLERANCE * 6000.0)
    assert max(tensions) - min(tensions) < 0.2 * TOLERANCE * min(tensions)


def test_thin_cable_lies_without_tension_too() -> None:
    """It bends on to the floor within 20 cm, of 6 km."""
    slope = [0.01, -0.03]
    scene = lay_across(slope, 0.02)
    pull = landing(scene).tension
    for tolerance in (1e-3, 2e-4):
        settings = scene.solver.model_copy(update={"tolerance": tolerance})
        model = cm.CableModel(scene.model_copy(update={"solver": settings}))
        assert model.top_tension == pytest.approx(pull, rel=TOLERANCE)


@pytest.mark.parametrize("seed", range(100, 110))
def test_random_lays_land_where_flexible_cable_does(seed: int) -> None:
    found = random_lays.measure(random_lays.draw(seed))
    assert not found.warned
    assert found.over == pytest.approx(1.0, rel=5e-3)  # half the promise
    assert found.aside < 1.0


@pytest.mark.parametrize("speed", [0.5, 1.0])
def test_a_current_that_sweeps_a_lay_away_is_told(speed: float) -> None:
    """The drag of the current across what lies, over mu w: 1/2 rho Cdn d u^2 / (mu w)."""
    scene = lay(current=[0.0, speed, 0.0])
    needed = 0.5 * 1025.0 * scene.cable_types["c"].drag_normal * 0.03 * speed**2 / (0.4 * WEIGHT)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        cm.CableModel(scene)
    told = [each.message for each in said if isinstance(each.message, cm.SweptStartWarning)]
    assert [each.needed for each in told] == pytest.approx([needed] if needed > 1.0 else [])


def test_a_level_floor_in_still_water_starts_without_friction() -> None:
    one, other = cm.CableModel(lay()), cm.CableModel(lay(friction=0.0))
    assert np.array_equal(one.state().position, other.state().position)


def chain(
    slope: list[float],
    tolerance: float,
    speed: float = 0.0,
    water: float = 1025.0,
    friction: float = 0.4,
) -> cm.CableModel:
    """Cable without bending stiffness, 6 m of it, a free end on a floor 3 m below the vessel."""
    scene = {
        "environment": {
            "water_density": water,
            "floor": {"z": -3.0, "slope": slope, "friction": friction},
        },
        "cable_types": {
            "c": {
                "diameter": 0.02, "mass": 3.0, "submerged_weight": 25.0, "axial_stiffness": 1e6,
                "bending_stiffness": 0,
            }
        },
        "line": [{"cable": {"type": "c", "length": 6.0}}],
        "vessel": {"velocity": [speed, 0, 0]},
        "solver": {"tolerance": tolerance},
    }  # fmt: skip
    return cm.CableModel(cm.load_scene(scene))


@pytest.mark.parametrize("slope", [[0.06, 0.0], [-0.06, 0.0], [0.05, -0.15], [0.0, 0.2]])
def test_a_laid_start_does_not_depend_on_the_tolerance(slope: list[float]) -> None:
    """One shape of the many at rest: laid without tension, so that all of it hangs vertically."""
    tolerance = 1e-3
    coarse, fine = chain(slope, tolerance), chain(slope, tolerance / 4)
    s = np.linspace(0.0, 6.0, 61)
    apart = np.linalg.norm(coarse.sample(s).position - fine.sample(s).position, axis=1)
    assert apart.max() < 1.25 * tolerance * 6.0
    for model in (coarse, fine):
        # No tension where it lands: the vessel pulls straight up, the floor pushes straight up.
        assert np.hypot(*model.top_force[:2]) < 10 * tolerance * model.top_tension
        assert np.hypot(*model.floor_force[:2]) < 10 * tolerance * model.top_tension
        end = model.tip_position
        model.step(60.0)
        assert np.linalg.norm(model.tip_position - end) < tolerance * 6.0


@pytest.mark.parametrize("seed", [71, 230, 503, 688])
def test_what_friction_holds_lies_alike_at_all_tolerances(seed: int) -> None:
    """Friction would hold it elsewhere, too: by 21, 134, 89 and 9 tau L from one to the next."""
    drawn = draw(seed)
    shapes = []
    for finer in (1, 4, 16):
        settings = {**drawn.scene["solver"], "tolerance": drawn.tolerance / finer}
        model = cm.CableModel(cm.load_scene({**drawn.scene, "solver": settings}))
        shapes.append(model.sample(model.line_length * PLACES).position)
    promised = drawn.tolerance * model.line_length
    first, second = (
        np.linalg.norm(one - other, axis=1).max() / promised
        for one, other in itertools.pairwise(shapes)
    )
    assert first < 0.5
    assert second < 0.5 * first


def test_a_vessel_under_way_drags_what_lies() -> None:
    """Without water: the vessel pulls by the friction of all that lies, from the start on."""
    model = chain([0.0, 0.0], 1e-3, speed=0.5, water=0.0)
    horizontal, down = -model.floor_force[0], model.floor_force[2]
    assert down > 0.3 * 6.0 * 25.0
    assert horizontal == pytest.approx(0.4 * down, rel=0.01)
    assert -model.top_force[0] == pytest.approx(horizontal, rel=0.01)
    tension = model.top_tension
    model.step(20.0)
    assert model.top_tension == pytest.approx(tension, rel=0.02)


@pytest.mark.parametrize("model", ["elastica", "hybrid", "cable"])
def test_a_line_without_bending_stiffness_kinks_at_a_body(model: str) -> None:
    """Towed at 2 m/s: the vessel pulls by the drag, of body and cable, and the weight; the models
    differ by bending only, of which there is none."""
    scene = {
        "cable_types": {"c": {
            "diameter": 0.02, "mass": 1.2, "submerged_weight": 8.0, "axial_stiffness": 1e6,
            "bending_stiffness": 0,
        }},
        "line": [
            {"cable": {"type": "c", "length": 6.0, "model": model}},
            {"body": {"mass": 60, "submerged_weight": 400, "added_mass": 10, "drag_area": 0.08}},
            {"cable": {"type": "c", "length": 3.0, "model": model}},
        ],
        "vessel": {"velocity": [2.0, 0, 0]},
    }  # fmt: skip
    tensions = []
    for tolerance in (1e-3, 1e-5):
        line = cm.CableModel(cm.load_scene({**scene, "solver": {"tolerance": tolerance}}))
        tensions.append(line.top_tension)
    assert tensions[0] == pytest.approx(tensions[1], rel=1e-3)


@pytest.mark.parametrize("stiffness", [400.0, 40.0])
def test_a_heavy_laid_line_starts_at_its_place_at_every_tolerance(stiffness: float) -> None:
    """Almost straight down, what pulls at the foot moves it by ten times the pull over the weight
    per length: 2 N of 19 kN, which the tension may be wrong by, moved it by 2 tau L."""
    places = []
    tolerance, length = 1.2e-4, 187.0
    for finer in (1, 16):
        scene = {
            "environment": {
                "floor": {"z": -124.0, "friction": 0.45},
                "current": {
                    "table": [
                        {"z": 0.0, "velocity": [-0.048, 0.059, 0.0]},
                        {"z": -124.0, "velocity": [-0.007, 0.003, 0.0]},
                    ]
                },
            },
            "cable_types": {"c": {
                "diameter": 0.09, "mass": 22.0, "submerged_weight": 152.0, "axial_stiffness": 2e8,
                "bending_stiffness": stiffness, "drag_normal": 1.56,
            }},
            "line": [{"cable": {"type": "c", "length": length}}],
            "vessel": {"velocity": [-0.33, -0.40, 0.0]},
            "payout": {"rate": 0.5186, "drum": [{"cable": {"type": "c", "length": 30.0}}]},
            "solver": {"tolerance": tolerance / finer},
        }  # fmt: skip
        model = cm.CableModel(cm.load_scene(scene))
        places.append(model.sample(length * PLACES).position)
    apart = np.linalg.norm(places[0] - places[1], axis=1).max()
    assert apart < 0.5 * tolerance * length
