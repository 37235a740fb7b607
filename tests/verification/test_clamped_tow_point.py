"""A clamp at the tow point: starts in any direction, and cable that runs past it."""

import numpy as np
import pytest

import cablemodel as cm

BENDING, MASS, GRAVITY = 0.8, 0.0745, 9.80665


def hanging(angle, *, length=100.0, model="elastica", bending=BENDING, tolerance=1e-4, **more):
    """A line in vacuum whose clamp points `angle` away from straight down."""
    direction = [np.sin(angle), 0.0, -np.cos(angle)]
    return cm.load_scene(
        {
            "environment": {"water_density": 0},
            "cable_types": {
                "k": {
                    "diameter": 0.0046,
                    "mass": MASS,
                    "axial_stiffness": 1e6,
                    "bending_stiffness": bending,
                }
            },
            "line": [{"cable": {"type": "k", "length": length, "model": model}}],
            "vessel": {"connection": {"clamped": direction}},
            "solver": {"tolerance": tolerance},
            **more,
        }
    )


@pytest.mark.parametrize("model", ["elastica", "hybrid"])
@pytest.mark.parametrize("degrees", [30, 90, 120, 150, 180])
def test_a_long_line_starts_from_a_clamp_in_any_direction(degrees, model):
    """Offset of what hangs by the layer of an elastica under tension: 2 sqrt(EI/T) sin(angle/2)."""
    angle = np.radians(degrees)
    run = cm.CableModel(hanging(angle, model=model))
    x, _, z = run.tip_position
    layer = np.sqrt(BENDING / (MASS * GRAVITY * 100.0))
    assert abs(x) == pytest.approx(2.0 * layer * np.sin(0.5 * angle), rel=0.03)
    assert -100.02 < z < -99.5
    assert np.linalg.norm(run.top_force) == pytest.approx(MASS * GRAVITY * 100.0, rel=1e-4)


WINCH = {
    "rate": [{"t": 0, "rate": 0}, {"t": 1, "rate": 0.5}],
    "drum": [{"cable": {"type": "k", "length": 50}}],
}


@pytest.mark.parametrize("model", ["elastica", "hybrid"])
@pytest.mark.parametrize("degrees", [30, 90, 135])
def test_moment_of_a_clamp_past_which_cable_runs(degrees, model):
    """On elements many layers long: that of the layer, 2 sqrt(EI T) sin(angle/2), within 10 %."""
    angle = np.radians(degrees)
    run = cm.CableModel(hanging(angle, model=model, tolerance=1e-3, payout=WINCH))
    tension = MASS * GRAVITY * 100.0
    moment = 2.0 * np.sqrt(BENDING * tension) * np.sin(0.5 * angle)
    assert np.linalg.norm(run.top_moment) == pytest.approx(moment, rel=0.1)
    assert np.linalg.norm(run.top_force) == pytest.approx(tension, rel=1e-3)


@pytest.mark.parametrize("model", ["elastica", "hybrid"])
def test_a_clamp_lets_cable_run_out_and_in(model):
    """In water under way, at 100 Hz: the tension goes on as that of a pinned line does."""
    tensions = {}
    for connection in ("pinned", {"clamped": [-0.3, 0, -1]}):
        scene = cm.load_scene("scenes/towed_cable.yaml").to_dict()
        scene["line"][0]["cable"]["model"] = model
        scene["vessel"] = {
            "velocity": [{"t": 0, "velocity": [0.8, 0, 0]}],
            "connection": connection,
        }
        scene["payout"] = {"drum": [{"cable": {**scene["line"][0]["cable"], "length": 20}}]}
        run = cm.CableModel(cm.load_scene(scene))
        found = []
        for k in range(6000):
            run.step(0.01, payout_rate=0.6 * np.sin(2.0 * np.pi * k / 4000))
            found.append(run.top_tension)
        tensions[str(connection)] = np.array(found)
    pinned, clamped = tensions.values()
    assert clamped == pytest.approx(pinned, rel=0.05)
    assert np.abs(np.diff(clamped, 2)).max() < 0.05 * pinned[0]


def test_a_flexible_cable_is_not_clamped():
    """The limit of no bending stiffness: the same run as with a pinned end."""
    velocity = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 2, "velocity": [0.5, 0, 0]}]
    ends = []
    for connection in ("pinned", {"clamped": [1, 0, 0]}):
        scene = hanging(0.0, length=10.0, model="cable", bending=0.0).to_dict()
        scene["vessel"] = {"velocity": velocity, "connection": connection}
        run = cm.CableModel(cm.load_scene(scene))
        run.step_to(5.0)
        ends.append(run.tip_position)
        # Newton's method leaves that much, at whatever time one looks.
        left = 1e-9 * run.top_tension * run.line_length
        assert run.top_moment == pytest.approx(0.0, abs=left)
    assert np.array_equal(*ends)


def test_a_clamped_line_that_a_winch_draws_taut_stretches_evenly():
    """Slack between clamp and anchor at first, then stretched by a third: T = EA (D/l - 1).

    The mode of each element that nothing but its stabilisation holds is that stiff for the slack
    line's tension; left so, halves of elements were 40 % too long or too short, the mesh grew from
    13 to 142 elements, and a step failed.
    """
    stiffness, chord = 1e5, 2.0 * np.sqrt(2.0)
    cable = {"type": "k", "length": 4.0, "model": "hybrid"}
    run = cm.CableModel(
        cm.load_scene(
            {
                "environment": {"water_density": 1025.0},
                "cable_types": {
                    "k": {
                        "diameter": 0.036,
                        "mass": 1.13,
                        "submerged_weight": 0.86,
                        "axial_stiffness": stiffness,
                        "bending_stiffness": 13.9,
                        "drag_normal": 1.7,
                        "drag_tangential": 0.08,
                    }
                },
                "line": [{"cable": cable}],
                "end": {"anchor": [2.0, 0.0, -2.0]},
                "payout": {
                    "rate": [{"t": 0.0, "rate": 0.0}, {"t": 1.0, "rate": -0.25}],
                    "drum": [{"cable": {**cable, "length": 2.0}}],
                },
                "vessel": {"connection": {"clamped": [0.55, 0.2, -0.5]}},
                "solver": {"tolerance": 1e-3},
            }
        )
    )
    for time in (6.0, 7.0, 8.0):
        run.step_to(time)
        stretch = chord / run.line_length
        places = run.sample(np.linspace(0.0, run.line_length, 33)).position
        chords = np.linalg.norm(np.diff(places, axis=0), axis=1) * 32.0 / run.line_length
        # Next to the clamp the line bends: a layer of 3 to 5 % of its length.
        assert chords[2:] == pytest.approx(stretch, rel=2e-3)
        assert run.top_tension == pytest.approx(stiffness * (stretch - 1.0), rel=0.01)
    assert run.line_length == pytest.approx(2.125, abs=1e-9)


@pytest.mark.parametrize("axial", [1e6, 5e10])
@pytest.mark.parametrize("across", [0.0, 0.5])
@pytest.mark.parametrize("step", [0.02, 0.2])
def test_a_clamp_holds_its_direction_for_ever(step, across, axial):
    """To rounding, in a plane and in space, in the two-step scheme's steps and longer ones.

    What rounding turns the slope by, and its rate, is for nothing in the equations to pull back: a
    stiff line of 600 m was turned without end, and the turning clamp fed it with energy until a
    step failed after 9 s.
    """
    direction = np.array([-0.2, 0.89, -0.42]) / np.linalg.norm([-0.2, 0.89, -0.42])
    velocity = 1.8 * (direction * [1.0, 1.0, 0.0] + [across, 0.0, 0.0])
    scene = {
        "environment": {"water_density": 1025.0},
        "cable_types": {
            "k": {
                "diameter": 0.032,
                "mass": 3.3,
                "submerged_weight": 24.0,
                "axial_stiffness": axial,
                "bending_stiffness": 5.5e3,
                "drag_normal": 1.5,
                "drag_tangential": 0.07,
            }
        },
        "line": [{"cable": {"type": "k", "length": 600.0, "model": "hybrid"}}],
        "vessel": {
            "connection": {"clamped": direction.tolist()},
            "velocity": [
                {"t": 0.0, "velocity": [0.0, 0.0, 0.0]},
                {"t": 0.02, "velocity": velocity.tolist()},
            ],
        },
        "solver": {"tolerance": 7e-3},
    }
    run = cm.CableModel(cm.load_scene(scene))
    for count in range(1, round(16.0 / step) + 1):
        run.step_to(count * step)
        tangent = run.sample(np.zeros(1)).tangent[0]
        assert np.linalg.norm(np.cross(tangent, direction)) < 1e-12
