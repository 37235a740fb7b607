"""The three models of one cable: elastica, perfectly flexible, hybrid."""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification import scenes

MODELS = ["elastica", "cable", "hybrid"]


def run(make, model, times, **settings):
    cable = cm.CableModel(make(model=model, **settings))
    tips, tensions = [], []
    for time in times:
        cable.step_to(time)
        tips.append(cable.tip_position - cable.vessel_position)
        tensions.append(cable.top_tension)
    return np.array(tips), np.array(tensions)


def test_bending_shifts_the_towed_end_by_less_than_a_millimetre():
    """EI = 0 shifts S1's end by at most 6e-4 m; it is not nothing either."""
    times = [10.0, 30.0, 45.0, 60.0, 100.0]
    stiff, _ = run(scenes.towed, "elastica", times, tolerance=1e-7, elements=60)
    flexible, _ = run(scenes.towed, "cable", times, tolerance=1e-7, elements=60)
    shift = np.linalg.norm(stiff - flexible, axis=1)
    assert 1e-4 < shift.max() < 6.5e-4


@pytest.mark.parametrize("make", [scenes.towed, scenes.turned])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_models_agree_where_bending_does_not_matter(make, tolerance):
    """Within the tolerances of both and the 6e-4 m that bending shifts the end."""
    times = [10.0, 30.0, 60.0]
    tips, tensions = zip(*(run(make, m, times, tolerance=tolerance) for m in MODELS), strict=True)
    reach = 2.0 * 30.0 * tolerance + 6.5e-4
    for tip, tension in zip(tips[1:], tensions[1:], strict=True):
        assert tip == pytest.approx(tips[0], abs=reach)
        assert tension == pytest.approx(tensions[0], abs=20.0 * tolerance * max(tensions[0]))


def test_hybrid_is_the_elastica_where_tension_is_low():
    """S2w starts without tension: bending decides how the cable unfolds at its held end."""
    times = [0.5, 1.0, 2.0]
    stiff, force = run(scenes.released_in_water, "elastica", times, tolerance=1e-5)
    mixed, mixed_force = run(scenes.released_in_water, "hybrid", times, tolerance=1e-5)
    assert mixed == pytest.approx(stiff, abs=2e-3)
    assert mixed_force == pytest.approx(force, abs=2e-2 * force.max())


@pytest.mark.parametrize("model", MODELS)
def test_released_cable_in_every_model(model):
    """From zero tension the flexible model too: it falls as the others but for its last decimals.

    The bending layer at the held end shifts the far end by some lambda = sqrt(EI/T) = 0.1 m times
    the curvature there: centimetres at the start of the fall, less later.
    """
    tips, _ = run(scenes.released_in_water, model, [1.0, 4.0, 10.0], tolerance=1e-5)
    expected = [[9.87545, 0, -0.467173], [9.11788, 0, -2.035458], [7.11999, 0, -5.171839]]
    assert tips == pytest.approx(np.array(expected), abs=1.5e-2)


@pytest.mark.parametrize("model", MODELS)
def test_elastica_without_stiffness_is_the_flexible_cable(model):
    """EI = 0 in each of the models is one and the same computation."""
    data = scenes.towed(model=model, elements=12).to_dict()
    data["cable_types"]["C"]["bending_stiffness"] = 0.0
    cable = cm.CableModel(cm.load_scene(data))
    flexible = scenes.towed(model="cable", elements=12).to_dict()
    flexible["cable_types"]["C"]["bending_stiffness"] = 0.0
    reference = cm.CableModel(cm.load_scene(flexible))
    for time in (20.0, 40.0):
        cable.step_to(time)
        reference.step_to(time)
        assert cable.tip_position == pytest.approx(reference.tip_position, abs=1e-12)
