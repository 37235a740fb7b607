"""Steps that the caller limits: as accurate, as safe and as reproducible as the engine's own."""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification import scenes

INTERVAL = 0.01


def stepped(scene, until, interval=INTERVAL):
    model = cm.CableModel(scene)
    for k in range(round(until / interval)):
        model.step_to((k + 1) * interval)
    return model


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize(
    ("make", "until", "length"),
    [
        (scenes.towed, 45.0, 30.0),
        (scenes.turned, 30.0, 30.0),
        (scenes.released_in_water, 6.0, 10.0),
        (scenes.released_in_air, 1.2, 10.0),
    ],
)
def test_hundred_hertz_keeps_the_promise(make, until, length, tolerance):
    """Positions within tau L of a run at a tenth of the tolerance that takes its own steps.

    Twice that for the whip, on which the tolerance is not calibrated (its mesh decides).
    """
    model = stepped(make(tolerance=tolerance), until)
    fine = cm.CableModel(make(tolerance=tolerance / 10.0))
    fine.step_to(until)
    allowed = tolerance * length * (2.0 if make is scenes.released_in_air else 1.0)
    assert np.linalg.norm(model.tip_position - fine.tip_position) < allowed
    if make is not scenes.released_in_air:
        assert model.top_tension == pytest.approx(
            fine.top_tension, abs=10.0 * tolerance * max(fine.top_tension, model.tension_max)
        )


def test_a_step_of_a_towed_cable_takes_one_iteration():
    model = stepped(scenes.towed(tolerance=1e-3), 40.0)
    counts = model.statistics
    assert counts["iterations"] < 1.15 * counts["steps"]
    assert counts["factorisations"] < 0.01 * counts["steps"]


def test_a_restored_model_goes_on_with_the_same_bits():
    """The history of the two-step scheme is part of the state, before and after a step by it."""
    model = stepped(scenes.towed(tolerance=1e-3), 5.0)
    kept = model.snapshot()
    ends = []
    for _ in range(2):
        model.restore(kept)
        for k in range(100):
            model.step_to(5.0 + (k + 1) * INTERVAL)
        ends.append(bytes(model._solver.memory.image))
    assert ends[0] == ends[1]


@pytest.mark.parametrize("interval", [INTERVAL, 3.0])
def test_a_step_that_fails_leaves_every_bit_as_it_was(interval):
    """Also the matrix, which is kept only once it is about to be replaced."""
    model = stepped(scenes.turned(tolerance=1e-3), 2.0)
    limit = int(model._header.maximum_steps)
    model._header.maximum_steps = 0
    before = bytes(model._solver.memory.image)
    with pytest.raises(cm.StepError):
        model.step(interval)
    assert bytes(model._solver.memory.image) == before
    model._header.maximum_steps = limit
    model.step(interval)


def test_a_change_of_the_callers_step_is_taken_in_its_stride():
    """Steps from 0.1 ms to 2 s in any order: the promise holds at every second."""
    random = np.random.default_rng(4)
    tolerance = 1e-3
    model = cm.CableModel(scenes.turned(tolerance=tolerance))
    fine = cm.CableModel(scenes.turned(tolerance=tolerance / 10.0))
    while model.time < 40.0:
        model.step(float(random.choice([1e-4, 0.003, 0.01, 0.01, 0.01, 0.02, 0.1, 2.0])))
        if random.random() < 0.05:
            fine.step_to(model.time)
            away = np.linalg.norm(model.tip_position - fine.tip_position)
            assert away < tolerance * 30.0


def test_energy_of_a_whip_at_a_hundred_hertz_does_not_grow():
    """In air, some seconds beyond the crack: energy falls but for 1 % at the crack itself."""

    def energy(model):
        parts = model.energy()
        return sum(parts[name] for name in ("kinetic", "axial", "bending", "potential"))

    model = cm.CableModel(scenes.released_in_air(tolerance=1e-3))
    weight = scenes.CABLE_K["mass"] * 9.80665
    start = energy(model) + 0.5 * weight * 100.0
    highest = 0.0
    for k in range(800):
        model.step_to((k + 1) * INTERVAL)
        highest = max(highest, energy(model) + 0.5 * weight * 100.0)
    assert highest < 1.01 * start


@pytest.mark.parametrize("short", [1e-9, 1e-6, 1e-4, 1e-2])
@pytest.mark.parametrize("change", [0.001, 0.1])
def test_a_change_of_speed_within_a_short_step_makes_its_wave_and_no_more(short, change):
    """A change V of the vessel's speed sends a wave of V sqrt(EA m) along the cable, which passes
    the tow point again and again. 0.1 m/s in a tenth of a millisecond gave 9 times that, 0.001 m/s
    in a nanosecond 20,000 times: the next step began with that one's acceleration.

    By its characteristics, a straight undamped line with that body has at most 1.83 waves at
    instants a tenth of a second apart, where ends reflect them."""
    model = cm.CableModel(
        cm.load_scene(
            {
                "cable_types": {
                    "armoured": {
                        "diameter": 0.011, "mass": 0.45, "axial_stiffness": 6e6,
                        "bending_stiffness": 2.0, "drag_normal": 1.5, "drag_tangential": 0.01,
                    }
                },
                "line": [
                    {"cable": {"type": "armoured", "length": 300.0}},
                    {"body": {"mass": 50.0, "submerged_weight": 300.0, "drag_area": 0.3}},
                ],
                "vessel": {"velocity": [3.0, 0.0, 0.0]},
            }
        )
    )  # fmt: skip
    model.step(0.1)
    before = model.top_tension
    velocity = (3.0 + change, 0.0, 0.0)
    model.step(short, vessel_velocity=velocity)
    tensions = []
    for _ in range(20):
        model.step(0.1, vessel_velocity=velocity)
        tensions.append(model.top_tension)

    wave = change * np.sqrt(6e6 * 0.45)
    assert np.ptp(tensions) < 2.0 * 1.83 * wave
    assert max(tensions) - before > 0.5 * wave
    assert np.abs(np.array(tensions) - before).max() < 1.83 * wave


@pytest.mark.parametrize("far", [1e3, 1e4, 1e6])
def test_a_jump_that_no_cable_bears_is_refused(far):
    model = cm.CableModel(scenes.towed())
    model.step(1.0)
    before = model.snapshot()
    with pytest.raises(cm.StepError, match=r"small enough|stretched") as error:
        model.step(0.1, vessel_position=(far, 0.0, 0.0))
    assert 0.0 <= error.value.arc_length <= model.line_length
    assert "inputs" in error.value.advice
    assert model.snapshot() == before


def after_a_ramp(kind: str, ramp: float, system: bool) -> np.ndarray:
    """Tips of a wire with a load (times, 3) [m] after something has changed within `ramp` [s]."""
    speeds = {"stop": (3.0, 0.0), "start": (0.0, 0.3), "winch": (0.0, 0.0)}[kind]
    times = (0.0, 10.0, 10.0 + ramp)
    velocity = [
        {"t": t, "velocity": [speed, 0, 0]}
        for t, speed in zip(times, (speeds[0], *speeds), strict=True)
    ]
    rate = [{"t": t, "rate": r} for t, r in zip(times, (0.0, 0.0, 1.0), strict=True)]
    wire = {"cable": {"type": "wire", "length": 200.0}}
    items = [wire, {"body": {"mass": 400.0, "submerged_weight": 3000.0, "drag_area": 0.5}}]
    scene = {
        "cable_types": {"wire": {"diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e7}},
        "solver": {"tolerance": 1e-3},
    }
    if system:
        scene["vessels"] = {"ship": {"velocity": velocity, "points": {"stern": [0, 0, 0]}}}
        scene["lines"] = {"tow": {"from": "ship.stern", "to": "free", "items": items}}
        if kind == "winch":
            scene["winches"] = {"hoist": {"line": "tow", "drum": 100.0, "rate": rate}}
        model = cm.SystemModel(cm.load_system(scene))
    else:
        scene |= {"line": items, "vessel": {"velocity": velocity}}
        if kind == "winch":
            scene["payout"] = {"drum": [wire], "rate": rate}
        model = cm.CableModel(cm.load_scene(scene))
    tips = []
    for time in np.arange(10.5, 16.0, 0.5):
        model.step_to(time)
        line = model.lines["tow"] if system else model
        tips.append(line.sample([line.length if system else line.line_length]).position[0])
    return np.array(tips)


@pytest.mark.parametrize("system", [False, True])
@pytest.mark.parametrize("kind", ["stop", "start", "winch"])
def test_a_change_of_speed_is_a_jump_however_short_its_ramp_in_a_table(kind, system):
    """Who may not write one time twice writes it a microsecond later. The step after the ramp must
    not begin with its acceleration: a stop from 3 m/s within 1e-6 s moved the tip by metres."""
    expected = after_a_ramp(kind, 1e-3, system)
    for ramp in (1e-4, 1e-6, 1e-9):
        assert np.abs(after_a_ramp(kind, ramp, system) - expected).max() < 0.25 * 1e-3 * 200.0
