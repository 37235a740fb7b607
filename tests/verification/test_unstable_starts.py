"""Static starts do not stay in equilibria that do not last.

Greenhill's column and Euler's strut have closed forms for when they do and, the strut, for what
holds it when it does not; the eigenvalues of the dense matrices tell for everything else.
"""

import math

import numpy as np
import pytest

import cablemodel as cm
from benchmarks.random_scenes.draw import draw
from cablemodel.solvers.finite_element.linearisation import small_motions
from cablemodel.solvers.finite_element.stability import growing_motion, slowest_growth
from cablemodel.solvers.finite_element.start import unstable_start
from cablemodel.solvers.finite_element.start.from_scene import build
from tests.verification.scenes import IDEAL, scene

GREENHILL = 7.8373
"""q L^3 / EI above which a column that is clamped at its foot bends over: (9/4) j^2, j = 1.8663
being the first zero of the Bessel function of order -1/3."""
UP = {"connection": {"clamped": [0.0, 0.0, 1.0]}}
GRAVITY = 9.80665


def column(share, **settings):
    """2 m high, clamped at the tow point; share: of the heaviest that stands."""
    stiffness = 3.0
    load = share * GREENHILL * stiffness / 2.0**3
    kind = {**IDEAL, "mass": load / GRAVITY, "submerged_weight": load, "axial_stiffness": 1e6}
    kind["bending_stiffness"] = stiffness
    return scene(2.0, kind, density=0.0, vessel=UP, tolerance=1e-3, **settings)


def real_growth(block):
    """Largest growth rate of a motion that does not swing [1/s], by dense matrices; 0: none."""
    mass, damping, stiffness = small_motions(block)
    count = len(mass)
    blocks = [[np.zeros_like(mass), np.eye(count)]]
    blocks += [[-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]]
    rates = np.linalg.eigvals(np.block(blocks))
    real = rates.real[np.abs(rates.imag) <= 1e-6 * np.abs(rates.real)]
    return max((float(rate) for rate in real if rate > slowest_growth(block)), default=0.0)


@pytest.fixture
def as_found(monkeypatch):
    """Starts as the relaxation finds them, stable or not."""
    monkeypatch.setattr(unstable_start, "left", lambda block, *_: block)


@pytest.mark.parametrize("planar", [None, False])
def test_a_column_stands_up_to_greenhills_weight(planar):
    model = cm.CableModel(column(0.999), planar=planar)
    assert np.hypot(*model.tip_position[:2]) < 1e-9
    assert model.tip_position[2] == pytest.approx(2.0, abs=1e-3)


@pytest.mark.parametrize("planar", [None, False])
@pytest.mark.parametrize("share", [1.003, 1.3, 5.0])
def test_a_heavier_column_bends_over_and_stays_there(share, planar):
    """In space along x, where any way would do: behind a vessel that does not move."""
    model = cm.CableModel(column(share), planar=planar)
    tip = model.tip_position.copy()
    assert tip[0] < -0.1
    assert abs(tip[1]) < -1e-5 * tip[0]
    assert real_growth(model._solver.memory) == 0.0
    model.step(5.0)
    assert model.tip_position == pytest.approx(tip, abs=1e-3)


def test_a_column_that_is_given_upright_is_left_alone():
    model = cm.CableModel(column(5.0, initial={"straight": [0.0, 0.0, 1.0]}))
    assert model.tip_position.tolist() == [0.0, 0.0, 2.0]


def strut(share):
    """A strip of 1 m between hinges, pressed by a share of Euler's load while it is straight."""
    press = 500.0
    kind = {**IDEAL, "axial_stiffness": 1e9}
    kind["bending_stiffness"] = press / (share * math.pi**2)
    end = {"anchor": [1.0 - press / kind["axial_stiffness"], 0.0, 0.0]}
    return press / share, scene(1.0, kind, density=0.0, gravity=9.81, end=end, elements=16)


def test_a_strut_bows_till_it_bears_eulers_load():
    """EA (1 - chord/L) is pressed into it; bowed by A it has shed all above pi^2 EI / L^2, for
    (pi A / 2 L)^2 is what it is shorter then."""
    euler, straight = strut(0.98)
    assert cm.CableModel(straight).top_tension == pytest.approx(-0.98 * euler, rel=1e-6)
    euler, bowed = strut(2.0)
    model = cm.CableModel(bowed)
    assert model.tension_min == pytest.approx(-euler, rel=1e-3)
    shed = euler / 1e9
    bow = float(np.linalg.norm(model.sample([0.5]).position[0, 1:]))
    assert bow == pytest.approx(2.0 / math.pi * math.sqrt(shed), rel=1e-3)


SEEDS = [
    pytest.param(145, id="buoy on a line that hangs below it"),
    pytest.param(178, id="buoy at the end of a heavy line"),
    pytest.param(732, id="sinker at the end of a line that floats"),
    pytest.param(10088, id="clamp that turns a beam back to its anchor"),
]

HELD = [
    pytest.param(159, id="slack pressed together where friction holds it"),
    pytest.param(436, id="sinker on a line that floats"),
]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.usefixtures("as_found")
def test_what_grows_is_what_the_dense_matrices_say(seed):
    block = build(cm.load_scene(draw(seed).scene))
    image = block.image.copy()
    growing = growing_motion(block)
    assert growing is not None
    assert growing.rate == pytest.approx(real_growth(block), rel=1e-3)
    assert np.array_equal(block.image, image)


@pytest.mark.parametrize("seed", [*SEEDS, *HELD])
def test_random_scenes_start_from_what_lasts(seed):
    loaded = cm.load_scene(draw(seed).scene)
    block = build(loaded)
    assert growing_motion(block) is None
    if seed != 436:  # without damping rounding makes frequencies complex there
        assert real_growth(block) == 0.0
    assert np.array_equal(build(loaded).image, block.image)


def floating_with_a_sinker():
    """Perfectly flexible: it turns back in a point, which no shape of finite curvature does."""
    kind = {**IDEAL, "submerged_weight": -4.0, "axial_stiffness": 1e6}
    sinker = {"mass": 12.0, "submerged_weight": 80.0}
    return scene(200.0, kind, model="cable", body=sinker, tolerance=1e-2)


def test_a_start_that_stays_unstable_says_so():
    with pytest.warns(cm.UnstableStartWarning, match="grows by e in") as caught:
        model = cm.CableModel(floating_with_a_sinker())
    assert len(caught) == 1
    warning = caught[0].message
    assert warning.rate == pytest.approx(real_growth(model._solver.memory), rel=1e-3)
    assert warning.arc_length == pytest.approx(200.0)
    assert model.tip_position[2] > 199.0


@pytest.mark.parametrize("seed", [0, 7, 26])
def test_a_start_that_lasts_is_the_one_that_is_found(seed, monkeypatch):
    loaded = cm.load_scene(draw(seed).scene)
    image = build(loaded).image.copy()
    monkeypatch.setattr(unstable_start, "left", lambda block, *_: block)
    assert np.array_equal(build(loaded).image, image)
