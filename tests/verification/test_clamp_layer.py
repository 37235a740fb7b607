"""Cable that runs past a clamp lies where its bending layer puts it, along all of the line.

Under the tension T a cable of stiffness EI leaves its clamp in a layer of some sqrt(EI/T), which
elements that a winch moves do not resolve. Held against the closed form of the layer, and against
the same line without a winch, whose mesh resolves it and whose slope is prescribed.
"""

import math

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.solvers.estimating import PLACES
from tests.verification.scenes import IDEAL

LENGTH, PULL = 50.0, 400.0
STILL = [{"t": 0.0, "rate": 0.0}]


def weightless(degrees, *, stiffness=100.0, tolerance=1e-3, model="hybrid", across=0.0, rate=()):
    """A line without weight and drag below a clamp `degrees` from straight down, and 400 N.

    across: of the clamp's direction that is out of the plane of x and z. rate: of the winch.
    """
    direction = [math.sin(math.radians(degrees)), across, -math.cos(math.radians(degrees))]
    kind = {**IDEAL, "mass": 0.01, "submerged_weight": 0.0, "axial_stiffness": 1e8}
    cable = {"type": "C", "model": model}
    return cm.load_scene(
        {
            "environment": {"water_density": 0.0},
            "cable_types": {"C": {**kind, "bending_stiffness": stiffness}},
            "line": [
                {"cable": {**cable, "length": LENGTH}},
                {"body": {"mass": PULL / 9.80665, "submerged_weight": PULL}},
            ],
            "vessel": {"connection": {"clamped": direction}},
            "payout": {"rate": list(rate) or STILL, "drum": [{"cable": {**cable, "length": 20.0}}]},
            "solver": {"tolerance": tolerance},
        }
    )


def closed_form(degrees, stiffness, s):
    """x, z [m] and angle from straight down of the elastica that a clamp holds, (len(s),) each.

    tan(psi/4) = tan(angle/4) exp(-s/l), l = sqrt(EI/T), is integrated by the trapezoidal rule.
    """
    layer = math.sqrt(stiffness / PULL)
    fine = np.concatenate([[0.0], np.geomspace(1e-6 * layer, LENGTH, 200_000)])
    psi = 4.0 * np.arctan(math.tan(math.radians(degrees) / 4.0) * np.exp(-fine / layer))
    steps = np.diff(fine)
    x, z = (
        np.concatenate([[0.0], np.cumsum(0.5 * steps * (f[1:] + f[:-1]))])
        for f in (np.sin(psi), -np.cos(psi))
    )
    return [np.interp(s, fine, values) for values in (x, z, psi)]


@pytest.mark.parametrize("degrees", [5.0, 60.0, 120.0, 170.0])
@pytest.mark.parametrize("stiffness", [1.0, 100.0, 2000.0])
@pytest.mark.parametrize("model", ["hybrid", "elastica"])
def test_a_line_lies_where_its_layer_puts_it(degrees, stiffness, model):
    """With a spring at the tow point instead lines were 4 to 20 tau L off, at any tolerance."""
    line = cm.CableModel(weightless(degrees, stiffness=stiffness, model=model))
    s = LENGTH * PLACES
    x, z, psi = closed_form(degrees, stiffness, s)
    found = line.sample(s)
    expected = np.column_stack([x, np.zeros(len(s)), z])
    assert np.linalg.norm(found.position - expected, axis=1).max() < 1e-4 * LENGTH
    assert np.arccos(np.clip(-found.tangent[:, 2], -1.0, 1.0)) == pytest.approx(psi, abs=2e-3)
    moment = 2.0 * math.sqrt(stiffness * PULL) * math.sin(psi[0] / 2.0)
    assert np.linalg.norm(line.top_moment) == pytest.approx(moment, rel=2e-3)
    inner = 2.0 * math.sqrt(stiffness * PULL) * np.sin(psi / 2.0)
    assert found.bending_moment == pytest.approx(inner, abs=5e-3 * moment)
    assert line.top_tension == pytest.approx(PULL, rel=1e-4)
    assert found.position[0] == pytest.approx(np.zeros(3), abs=1e-12)


def test_in_space_as_in_its_plane():
    scene = weightless(60.0)
    one, other = (cm.CableModel(scene, planar=planar) for planar in (True, False))
    assert other.sample(LENGTH * PLACES).position == pytest.approx(
        one.sample(LENGTH * PLACES).position, abs=1e-8
    )
    leaving, moments = cm.CableModel(scene), []
    for model in (leaving, other):
        model.step(1.0, vessel_velocity=(0.0, 0.1, 0.0))  # out of the plane
        moments.append(model.top_moment)
    assert leaving.tip_position == pytest.approx(other.tip_position, abs=1e-3 * LENGTH)
    assert moments[0] == pytest.approx(moments[1], rel=0.02, abs=0.02 * np.abs(moments).max())


def test_cable_runs_along_the_shape_that_the_layer_has():
    """Paid out slowly past a clamp at 60 degrees: only the end moves, down."""
    rate = [{"t": 0.0, "rate": 0.0}, {"t": 2.0, "rate": 0.0}, {"t": 3.0, "rate": 0.5}]
    model = cm.CableModel(weightless(60.0, rate=rate, tolerance=1e-3))
    x, z, _psi = closed_form(60.0, 100.0, np.array([LENGTH]))
    while model.time < 20.0:
        model.step(0.5)
        paid = model.line_length - LENGTH
        expected = [x[0], 0.0, z[0] - paid]
        assert model.tip_position == pytest.approx(expected, abs=1e-3 * LENGTH)
        assert model.vessel_position == pytest.approx(np.zeros(3), abs=1e-12)
    assert paid > 8.0


def towed(winch, tolerance):
    """60 m with a body of 400 N, whose clamp points down and forward; towed faster and turned."""
    cable = {"type": "C", "length": 60.0, "model": "hybrid"}
    kind = {"diameter": 0.03, "mass": 1.5, "axial_stiffness": 2e6, "bending_stiffness": 50.0}
    ways = [(0, (0, 0, 0)), (8, (2, 0, 0)), (20, (2, 0, 0)), (26, (0, 2, 0)), (60, (0, 2, 0))]
    return cm.load_scene(
        {
            "cable_types": {"C": kind},
            "line": [
                {"cable": cable},
                {"body": {"mass": 60, "submerged_weight": 400, "drag_area": 0.2}},
            ],
            "vessel": {
                "connection": {"clamped": [0.8, 0.0, -1.0]},
                "velocity": [{"t": t, "velocity": velocity} for t, velocity in ways],
            },
            "payout": {"drum": [{"cable": {**cable, "length": 10.0}}]} if winch else {},
            "solver": {"tolerance": tolerance},
        }
    )


def test_with_a_winch_as_without_one_in_motion():
    """A winch that stands still changes nothing of a tow and a turn.

    It was 4.7 tau L off with a spring. (Turned right back, by a clamp that points forward, it is
    1.1 tau L off, for drag on the loop.)
    """
    tolerance = 1e-3
    other, reference = (
        cm.CableModel(towed(winch, tau)) for winch, tau in ((True, tolerance), (False, 2e-5))
    )
    assert reference.statistics["elements"] > 5 * other.statistics["elements"]
    for _ in range(40):
        apart = []
        for model in (other, reference):
            model.step(1.0)
            apart.append(model.sample(60.0 * PLACES).position)
        assert np.linalg.norm(apart[0] - apart[1], axis=1).max() < tolerance * 60.0
        tensions = [abs(model.top_tension) for model in (other, reference)]
        assert tensions[0] == pytest.approx(tensions[1], rel=0.025)


def test_a_snapshot_holds_where_the_layer_is():
    model = cm.CableModel(towed(True, 1e-3))
    model.step(5.0)
    kept = model.snapshot()
    model.step(3.0)
    later = model.sample(60.0 * PLACES).position
    model.restore(kept)
    model.step(3.0)
    assert np.array_equal(model.sample(60.0 * PLACES).position, later)
