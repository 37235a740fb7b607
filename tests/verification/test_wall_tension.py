"""Wall tension: what a strain gauge on the cable would say, by the balance of its material."""

import math

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.errors import CableModelError
from cablemodel.results.states import States, matrix_of
from cablemodel.scene.sea import sea
from tests.verification.scenes import CABLE_K

RHO, GRAVITY = 1025.0, 9.80665
THIN = CABLE_K | {"diameter": 0.01}
AREA = math.pi / 4 * CABLE_K["diameter"] ** 2
LINE = [{"cable": {"type": "K", "length": 20}}, {"cable": {"type": "T", "length": 30}}]


def hung(**changes):
    return cm.load_scene(
        {"cable_types": {"K": CABLE_K, "T": THIN}, "line": LINE, "vessel": {"position": [0, 0, 4]},
         "environment": {"waves": {"regular": {"height": 2, "period": 6}}}, **changes}
    )  # fmt: skip


@pytest.mark.parametrize("method", ["finite_element", "direct_integration"])
def test_the_material_carries_its_weight_in_air(method):
    """Of a line that hangs straight down: the water pushes at its lower end alone, and there it is
    compressed. The effective tension there is zero."""
    kind = CABLE_K | {"submerged_weight": CABLE_K["mass"] * GRAVITY - RHO * GRAVITY * AREA}
    model = cm.CableModel(
        cm.load_scene(
            {"cable_types": {"K": kind}, "line": [{"cable": {"type": "K", "length": 40}}],
             "vessel": {"position": [0, 0, -5]}, "solver": {"method": method}}
        )
    )  # fmt: skip
    state = model.sample([0.0, 7.0, 25.0, 40.0])
    end = -RHO * GRAVITY * (5 + 40) * AREA
    expected = end + kind["mass"] * GRAVITY * (40 - state.s)
    # The cable stretches by up to 1e-4, and so does its depth.
    np.testing.assert_allclose(state.wall_tension, expected, atol=2e-3 * abs(end))
    assert state.tension[-1] == pytest.approx(0.0, abs=0.05)


def test_pressure_is_that_of_the_waves_and_each_cable_has_its_own_area():
    """Airy's: a layer of water is accelerated by the difference of the pressures on it."""
    model = cm.CableModel(hung())
    field = sea(model.scene)
    model.step_to(11.3)
    state = model.sample([1.0, 15.0, 20.0, 45.0])
    off = state.tension - state.wall_tension
    assert off[0] == 0.0  # in the air
    step = 1e-4
    for row, diameter in ((1, 0.01666), (2, 0.01), (3, 0.01)):
        place = state.position[row]
        rate = field.velocity(model.time + step, place[None]) - field.velocity(
            model.time - step, place[None]
        )
        above, below = model_pressure(model, place, step), model_pressure(model, place, -step)
        gradient = (above - below) / (2 * step)
        assert gradient == pytest.approx(
            -RHO * (GRAVITY + rate[0, 2] / (2 * step)), rel=1e-5, abs=0.1
        )
        pressure = model_pressure(model, place, 0.0)
        assert off[row] == pytest.approx(pressure * math.pi / 4 * diameter**2)
        assert pressure == pytest.approx(-RHO * GRAVITY * place[2], rel=0.5)


def model_pressure(model, place, up):
    """Of the surroundings of a model at a height above a place [Pa]."""
    around, _length = model.state().water
    return float(around.pressure(model.time, place[None] + np.array([0.0, 0.0, up]))[0])


def test_what_is_paid_out_has_the_area_of_its_own_cable():
    """Thin cable comes off the drum; what was out keeps its areas, by its way to the far end."""
    drum = [{"cable": {"type": "T", "length": 15}}]
    payout = {"rate": [{"t": 0, "rate": 0}, {"t": 1, "rate": 1}], "drum": drum}
    line = [{"cable": {"type": "K", "length": 30}}]
    model = cm.CableModel(hung(line=line, payout=payout, vessel={"position": [0, 0, -4]}))
    model.step_to(10.5)
    state = model.sample([9.5, 10.5])
    around, length = state.water
    assert length == pytest.approx(40.0)
    areas = (state.tension - state.wall_tension) / around.pressure(model.time, state.position)
    np.testing.assert_allclose(areas, [math.pi / 4 * 0.01**2, AREA], rtol=1e-9)


def test_a_run_has_it_too_in_memory_and_from_its_log(tmp_path):
    given = hung()
    run = cm.simulate(given, log=tmp_path / "run.mcap", until=2.0)
    model = cm.CableModel(given)
    model.step_to(float(run.states.time[-1]))
    again = cm.open_run(tmp_path / "run.mcap")
    last = again.states[-1]
    np.testing.assert_allclose(last.wall_tension, last.tension - pressed(last))
    np.testing.assert_allclose(again.states.wall_tension[-1], last.wall_tension)
    assert again.to_xarray()["wall_tension"].attrs["units"] == "N"
    bare = States(np.array([0.0]), [matrix_of(model.state())])[0]
    with pytest.raises(CableModelError, match="does not know the water"):
        _ = bare.wall_tension


def pressed(state):
    around, _length = state.water
    area = np.where(state.s < 20 - 1e-6, AREA, math.pi / 4 * 0.01**2)
    return around.pressure(state.time, state.position) * area
