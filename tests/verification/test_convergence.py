"""Observed orders in the element's length h and in the time step.

Theory. Cubic Hermite elements: positions converge like h^4 where the solution is smooth on the
scale of h, and so do end forces. Behind a jump of curvature, which a jump of the vessel's
acceleration leaves in a flexible cable, they converge like h^2. A layer of thickness
lambda = sqrt(EI/T) is not smooth until h < lambda; before that its strength, of the order of the
layer's offset, stays as the error, and the observed order is anything. Time: the scheme has order
4, its stages order 2; the tension is algebraic, so that orders between 3 and 4 may be seen.
"""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification import scenes


def towed_tips(model, counts, tolerance, time, bending=None):
    """Free ends at `time` for each element count."""
    tips = []
    for count in counts:
        scene = scenes.towed(tolerance=tolerance, elements=count, model=model)
        if bending is not None:
            data = scene.to_dict()
            data["cable_types"]["C"]["bending_stiffness"] = bending
            scene = cm.load_scene(data)
        run = cm.CableModel(scene)
        run.step_to(time)
        tips.append(run.tip_position)
    return np.array(tips)


def orders(values):
    """log2 of the ratios of successive differences, for counts that double."""
    steps = np.linalg.norm(np.diff(values, axis=0), axis=1)
    return np.log2(steps[:-1] / steps[1:])


def test_fourth_order_in_h_where_bending_is_resolved(record_property):
    """EI = 100: lambda is 1.1 m at the top, 4 m and more over the lowest metres."""
    found = orders(towed_tips("elastica", (8, 16, 32, 64), 1e-9, 20.0, bending=100.0))
    record_property("orders in h, EI 100", found.tolist())
    assert found[-1] == pytest.approx(4.0, abs=0.5)


def smoothly_towed(count):
    """EI = 0, the vessel's speed rises as a smooth polynomial of time from 0 to 0.8 m/s in 30 s."""
    times = np.linspace(0.0, 30.0, 121)
    x = times / 30.0
    speed = 0.8 * x**5 * (126.0 - 420.0 * x + 540.0 * x**2 - 315.0 * x**3 + 70.0 * x**4)
    rows = [
        {"t": float(t), "velocity": [float(v), 0.0, 0.0]} for t, v in zip(times, speed, strict=True)
    ]
    return scenes.scene(
        30.0,
        {**scenes.CABLE_K, "bending_stiffness": 0.0},
        model="cable",
        elements=count,
        tolerance=1e-9,
        vessel={"velocity": rows, "interpolation": "cubic"},
    )


def test_fourth_order_in_h_without_bending(record_property):
    """EI = 0: at the free end tension vanishes, yet a smooth motion stays smooth there."""
    tips = []
    for count in (4, 8, 16, 32):
        model = cm.CableModel(smoothly_towed(count))
        model.step_to(15.0)
        tips.append(model.tip_position)
    found = orders(np.array(tips))
    record_property("orders in h, EI 0", found.tolist())
    assert (found > 3.5).all()


def test_second_order_in_h_behind_a_jump_of_acceleration(record_property):
    """EI = 0 is hyperbolic: S1's jump of acceleration at t = 0 runs along as a jump of curvature.

    A jump of r'' inside an element is an error of order h^2 in r, there and in what follows it.
    """
    found = orders(towed_tips("cable", (8, 16, 32, 64, 128), 1e-9, 20.0))
    record_property("orders in h, EI 0, jump", found.tolist())
    assert found[-2:] == pytest.approx(2.0, abs=0.5)


def test_error_in_h_before_the_layer_is_resolved(record_property):
    """EI = 0.1: lambda is 0.04 m at the top, smaller than any h here; no order is promised.

    The layer shifts the end by lambda^2 kappa = EI kappa/T, kappa < 0.05/m: 1e-4 m at the most.
    """
    tips = towed_tips("elastica", (8, 16, 32, 64), 1e-9, 20.0)
    record_property("orders in h, EI 0.1", orders(tips).tolist())
    assert np.linalg.norm(tips[-1] - tips[-2]) < 1e-5
    assert np.linalg.norm(tips[-1] - tips[0]) < 1e-3


def test_order_in_the_time_step(record_property):
    """S1 until 20 s, smooth; steps follow the tolerance, and the error falls with steps^-4.

    Above 1e-5 the start decides, below 3e-7 rounding in the axial direction.
    """
    exact = cm.CableModel(scenes.towed(tolerance=1e-10, elements=30))
    exact.step_to(20.0)
    errors, steps = [], []
    for tolerance in (1e-5, 3e-6, 1e-6, 3e-7):
        model = cm.CableModel(scenes.towed(tolerance=tolerance, elements=30))
        model.step_to(20.0)
        errors.append(np.linalg.norm(model.tip_position - exact.tip_position))
        steps.append(model.statistics["steps"])
    order = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    record_property("order in time", float(order))
    assert 3.0 < order < 5.0


@pytest.mark.parametrize("name", ["towed", "turned"])
def test_caller_steps_of_any_length_agree(name):
    """1 ms, 0.1 s or 10 s: within the tolerance of the converged run."""
    make = {"towed": scenes.towed, "turned": scenes.turned}[name]
    exact = cm.CableModel(make(tolerance=1e-7))
    exact.step_to(10.0)
    for interval in (10.0, 2.5, 0.1, 0.01):
        model = cm.CableModel(make(tolerance=1e-4))
        for k in range(round(10.0 / interval)):
            model.step_to((k + 1) * interval)
        assert model.tip_position == pytest.approx(exact.tip_position, abs=1e-4 * 30.0)
        assert model.top_tension == pytest.approx(exact.top_tension, rel=1e-3)
