"""Airy waves and JONSWAP seas: closed forms, spectra, and the kernels against NumPy."""

import itertools
import json
import math

import numba
import numpy as np
import pytest
from scipy.integrate import quad

import cablemodel as cm
from cablemodel.errors import SceneError
from cablemodel.scene.sea import sea, wave_number
from cablemodel.solvers.finite_element.kernels.bodies.point_bodies import (
    body_jacobian,
    body_residual,
)
from cablemodel.solvers.finite_element.kernels.line.system import set_time
from cablemodel.solvers.finite_element.kernels.water.airy import STILL
from cablemodel.solvers.finite_element.kernels.water.waves import Water, water_at, wave_at, wet_at
from cablemodel.solvers.shared.compile import OPTIONS
from cablemodel.solvers.shared.layout import Header

GRAVITY = 9.80665
CABLE = {"diameter": 0.02, "mass": 0.5, "axial_stiffness": 1e6, "bending_stiffness": 0.1}
REGULAR = {"regular": {"height": 2.0, "period": 7.0, "direction": 0.5, "phase": 0.3}}
JONSWAP = {"jonswap": {"hs": 2.5, "tp": 9.0, "seed": 7, "direction": 0.5}}


def scene(waves, depth=None, **changes):
    environment = {"waves": waves}
    if depth is not None:
        environment["floor"] = {"z": -depth}
    data = {
        "environment": environment,
        "cable_types": {"C": CABLE},
        "line": [{"cable": {"type": "C", "length": 10}}],
    }
    for path, value in changes.items():
        data["environment"][path] = value
    return cm.load_scene(data)


@pytest.mark.parametrize("depth", [0.3, 2.0, 10.0, 50.0, 1e4])
def test_dispersion(depth):
    frequency = np.geomspace(0.05, 6.0, 50)
    k = wave_number(frequency, depth, GRAVITY)
    np.testing.assert_allclose(GRAVITY * k * np.tanh(k * depth), frequency**2, rtol=1e-13)
    shallow = wave_number(np.array([1e-3]), depth, GRAVITY)
    deep = wave_number(frequency, math.inf, GRAVITY)
    assert shallow[0] == pytest.approx(1e-3 / math.sqrt(GRAVITY * depth), rel=1e-2)
    np.testing.assert_allclose(deep, frequency**2 / GRAVITY)


@pytest.mark.parametrize("waves", [REGULAR, JONSWAP])
@pytest.mark.parametrize("depth", [12.0, None])
def test_the_water_moves_as_linear_theory_demands(waves, depth):
    """No sources, no vorticity, none through the bottom, surface and water rise together."""
    field = sea(scene(waves, depth))
    rng = np.random.default_rng(2)
    points = np.column_stack([rng.uniform(-50, 50, (40, 2)), rng.uniform(-11.5, -0.5, 40)])
    t, step = 33.0, 1e-4
    gradient = np.stack(
        [
            (field.velocity(t, points + step * e) - field.velocity(t, points - step * e))
            / (2 * step)
            for e in np.eye(3)
        ],
        axis=1,
    )  # d/dx_j of u_i at [:, j, i]
    scale = np.abs(gradient).max()
    assert np.abs(np.trace(gradient, axis1=1, axis2=2)).max() < 1e-6 * scale
    assert np.abs(gradient - gradient.transpose(0, 2, 1)).max() < 1e-6 * scale
    if depth is not None:
        points[:, 2] = -depth
        assert np.abs(field.velocity(t, points)[:, 2]).max() < 1e-14
    points[:, 2] = 0.0
    places = points[:, 0], points[:, 1]
    rate = (field.elevation(t + step, *places) - field.elevation(t - step, *places)) / (2 * step)
    np.testing.assert_allclose(field.velocity(t, points)[:, 2], rate, atol=1e-6)


def test_a_regular_wave_is_the_closed_form():
    field = sea(scene(REGULAR, depth=15.0))
    (k,) = field.number
    w = 2 * math.pi / 7.0
    x, y, z, t = 3.0, -4.0, -2.0, 20.0
    theta = k * (x * math.cos(0.5) + y * math.sin(0.5)) - w * t + 0.3
    along = w * math.cosh(k * (z + 15)) / math.sinh(k * 15) * math.cos(theta)
    upward = w * math.sinh(k * (z + 15)) / math.sinh(k * 15) * math.sin(theta)
    expected = [along * math.cos(0.5), along * math.sin(0.5), upward]
    np.testing.assert_allclose(field.velocity(t, [[x, y, z]])[0], expected, rtol=1e-12)
    assert field.elevation(t, x, y) == pytest.approx(math.cos(theta), rel=1e-12)


@numba.jit(**OPTIONS)
def look(ints, reals, t, x, y, z, half, out):
    set_time(ints, reals, t)
    water = water_at()
    depth = wave_at(ints, reals, x, y, z, 1e3, -1, water)
    wet_at(depth, half, water)
    for i in range(3):
        out[i] = water.velocity[i]
        out[3 + i] = water.acceleration[i]
    out[6] = water.wet
    out[7] = water.slope
    return depth


def water(model, t, x, y, z, half):
    """The water at a place of the block's coordinates, and how deep below the surface it is."""
    out = np.zeros(8)
    depth = look(model._ints, model._reals, t, x, y, z, half, out)
    return Water(out, 0), depth


@pytest.mark.parametrize("planar", [None, False])
@pytest.mark.parametrize("waves", [REGULAR, JONSWAP])
def test_kernel_sums_the_same_components(waves, planar):
    """Velocity, acceleration (its derivative in time, during the ramp too) and surface."""
    given = scene(waves, depth=30.0)
    field = sea(given)
    model = cm.CableModel(given, planar=planar)
    assert model.planar == (planar is None)
    local = np.eye(3)
    if planar is None:
        local = np.array([[math.cos(0.5), math.sin(0.5), 0.0], [0.0, 0.0, 1.0]])
    rng = np.random.default_rng(5)
    for t in (-1.0, 2.0, 6.9, 50.0, 800.0):
        place = rng.uniform([-40, -40, -25], [40, 40, 1.5])
        if planar is None:
            place[:2] = place[0] * np.array([math.cos(0.5), math.sin(0.5)])
        inner = local @ place
        x, z, y = inner[0], inner[-1], inner[1]
        half = 3.0
        here, depth = water(model, t, x, y, z, half)
        surface = place[2] + depth
        size = len(inner)
        velocity, acceleration = here.velocity[:size], here.acceleration[:size]
        assert surface == pytest.approx(float(field.elevation(t, *place[:2])), abs=1e-12)
        np.testing.assert_allclose(velocity, local @ field.velocity(t, [place])[0], atol=1e-12)
        step = 1e-4
        change = field.velocity(t + step, [place]) - field.velocity(t - step, [place])
        np.testing.assert_allclose(acceleration, local @ change[0] / (2 * step), atol=1e-6)
        share, slope = here.wet, here.slope
        assert share == {True: 1.0, False: share}[place[2] < surface - half]
        assert 0.0 <= share <= 1.0
        above, below = (water(model, t, x, y, z + way, half)[0].wet for way in (step, -step))
        assert slope == pytest.approx((above - below) / (2 * step), abs=1e-6)


@pytest.mark.parametrize("depth", [30.0, 4000.0])
def test_sums_are_right_at_any_time_and_place(depth):
    """Phases of 1e5 rad, and exponents down to where components have died out."""
    given = scene(JONSWAP, depth=depth)
    field = sea(given)
    model = cm.CableModel(given, planar=False)
    speed = float((field.amplitude * field.frequency).sum())
    rng = np.random.default_rng(6)
    for _ in range(200):
        t = 10.0 ** rng.uniform(0.0, 5.0)
        place = rng.uniform([-4000, -4000, -1], [4000, 4000, 0]) * [1, 1, min(depth, 400.0)]
        point = water(model, t, *place, 1.0)[0].velocity
        gone = speed * math.exp(-STILL)
        # The phase itself, of this size, is known to some bits of 2^-52.
        known = 1e-12 + 4.0 * 2.0**-52 * (field.frequency[-1] * t + 6000.0 * field.number[-1])
        error = np.abs(point - field.velocity(t, [place])[0]).max()
        assert error < gone + known * speed


def jonswap_density(w, hs, tp, gamma):
    """DNV-RP-C205, 3.5.5: (1 - 0.287 ln gamma) times gamma^... times Pierson-Moskowitz."""
    peak = 2 * math.pi / tp
    sigma = 0.07 if w <= peak else 0.09
    pierson = 5 / 16 * hs**2 * peak**4 * w**-5 * math.exp(-1.25 * (w / peak) ** -4)
    bump = gamma ** math.exp(-0.5 * ((w - peak) / (sigma * peak)) ** 2)
    return (1 - 0.287 * math.log(gamma)) * pierson * bump


@pytest.mark.parametrize("gamma", [1.0, 3.3, 5.0])
def test_jonswap_spectrum(gamma):
    """Energy in every band, significant height, and the ratios of periods."""
    hs, tp = 2.5, 9.0
    field = sea(scene({"jonswap": {"hs": hs, "tp": tp, "gamma": gamma, "components": 400}}))
    energy = 0.5 * field.amplitude**2
    assert 4 * math.sqrt(energy.sum()) == pytest.approx(hs, rel=1e-12)
    edges = 2 * math.pi / tp * np.array([0.3, 0.8, 0.95, 1.05, 1.2, 1.6, 3.0])
    for low, high in itertools.pairwise(edges):
        found = energy[(field.frequency > low) & (field.frequency <= high)].sum()
        expected = quad(jonswap_density, low, high, (hs, tp, gamma))[0]
        assert found == pytest.approx(expected, abs=0.008 * hs**2 / 16)
    first = energy @ field.frequency / energy.sum()
    second = math.sqrt(energy @ field.frequency**2 / energy.sum())
    t1 = 0.7303 + 0.04936 * gamma - 0.006556 * gamma**2 + 0.0003610 * gamma**3
    tz = 0.6673 + 0.05037 * gamma - 0.006230 * gamma**2 + 0.0003341 * gamma**3
    assert 2 * math.pi / first / tp == pytest.approx(t1, rel=0.01)
    assert 2 * math.pi / second / tp == pytest.approx(tz, rel=0.02)


def test_significant_height_of_the_surface():
    """Of three hours at one place, within the sampling error; its crests are Rayleigh's."""
    field = sea(scene(JONSWAP))
    time = np.arange(60.0, 10860.0, 0.5)
    surface = np.array([field.elevation(t, 10.0, 20.0) for t in time])
    assert 4 * surface.std() == pytest.approx(2.5, rel=0.03)
    assert abs(surface.mean()) < 0.02
    # Kurtosis 3 of a normal sea.
    assert (surface**4).mean() / (surface**2).mean() ** 2 == pytest.approx(3.0, abs=0.3)
    assert 0.75 * 2.5 < surface.max() < 1.4 * 2.5


def test_a_seed_is_a_sea():
    same, again = sea(scene(JONSWAP)), sea(scene(JONSWAP))
    other = sea(scene({"jonswap": {**JONSWAP["jonswap"], "seed": 8}}))
    assert same.phase.tobytes() == again.phase.tobytes()
    assert np.abs(same.phase - other.phase).max() > 1.0
    # The generator is MT19937 of Matsumoto and Nishimura, whose numbers never change.
    generator = np.random.MT19937()
    generator._legacy_seeding(7)
    high, low = (int(value) for value in generator.random_raw(2))
    first = ((high >> 5) * 2**26 + (low >> 6)) / 2.0**53
    assert same.phase[0] == 2 * math.pi * first


@numba.jit(**OPTIONS)
def forces(ints, reals, q, v, a, out):
    set_time(ints, reals, 0.0)
    out[:] = 0.0
    body_residual(ints, reals, q, v, a, out)


@numba.jit(**OPTIONS)
def matrix(ints, reals, q, v, a, ca, cv):
    set_time(ints, reals, 0.0)
    body_jacobian(ints, reals, q, v, a, ca, cv)


@pytest.mark.parametrize("planar", [None, False])
@pytest.mark.parametrize("height", [-5.0, -0.2, 0.1, 4.0])
def test_derivative_of_a_body_at_the_surface(planar, height):
    """In calm water: its hydrostatic stiffness, and the added mass of its wet share."""
    data = scene(REGULAR).to_dict()
    body = {"mass": 60, "submerged_weight": -500, "added_mass": 40, "added_mass_axial": 20}
    data["line"].append({"body": body})
    model = cm.CableModel(cm.load_scene(data), planar=planar)
    ints, reals = model._ints, model._reals
    head = Header(ints)
    nodes, size = int(head.nodes), 2 * int(head.dimension)
    q = model._solver.memory.array(Header.position, nodes * size).copy()
    q[-size:] = np.random.default_rng(1).standard_normal(size)
    q[-size // 2 - 1] = height
    rest = np.zeros_like(q)
    ca, cv, step = 0.4, 0.9, 1e-6
    blocks = model._solver.memory.array(Header.diagonal, nodes, size, size)
    blocks[:] = 0.0
    matrix(ints, reals, q, rest, rest, ca, cv)
    found = np.zeros((size, size))
    for n in range(size):
        change = np.zeros_like(q)
        change[len(q) - size + n] = step
        up, down = np.zeros_like(q), np.zeros_like(q)
        forces(ints, reals, q + change, cv * change, ca * change, up)
        forces(ints, reals, q - change, -cv * change, -ca * change, down)
        found[:, n] = (up - down)[-size:] / (2 * step)
    np.testing.assert_allclose(blocks[-1], found, atol=1e-5 * np.abs(found).max())


@pytest.mark.parametrize(
    ("waves", "changes", "path", "words"),
    [
        ({"regular": {"height": 9, "period": 5}}, {}, "waves.regular.height", "break"),
        ({"regular": {"height": 4, "period": 9}}, {"floor": {"z": -4}}, "height", "break"),
        (REGULAR, {"gravity": 0}, "waves", "gravity"),
        (REGULAR, {"water_density": 0}, "waves", "water_density"),
        (REGULAR, {"floor": {"z": 0}}, "waves", "deep"),
        ({"jonswap": {"hs": 9, "tp": 5}}, {}, "waves.jonswap.hs", "break"),
        ({"components": {"rows": [{"amplitude": 4.5, "period": 5}]}}, {}, "components.rows", "bre"),
        ({"components": {"rows": [{"amplitude": 0, "period": 5}]}}, {}, "components.rows", "are 0"),
        ({"components": {"rows": []}}, {}, "components.rows", "is empty"),
    ],
)
def test_waves_that_cannot_be(waves, changes, path, words):
    with pytest.raises(SceneError) as caught:
        scene(waves, **changes)
    text = str(caught.value)
    assert path in text
    assert words in text


def test_a_sea_by_its_components_is_the_same_sea(tmp_path):
    """A regular wave, and a JONSWAP sea from a file, given by what they are made of."""
    one = {"rows": [{"amplitude": 1.0, "period": 7.0, "phase": 0.3}], "direction": 0.5}
    runs = [cm.CableModel(scene(waves, 30.0)) for waves in (REGULAR, {"components": one})]
    for run in runs:
        run.step(3.0)
    assert runs[0].top_tension == runs[1].top_tension
    field = sea(scene(JONSWAP, 30.0))
    columns = (field.amplitude, 2.0 * np.pi / field.frequency, field.phase)
    rows = [
        "amplitude,period,phase",
        *(",".join(map(repr, row)) for row in np.array(columns).T.tolist()),
    ]
    (tmp_path / "sea.csv").write_text("\n".join(rows))
    data = scene({"components": one, "ramp": field.ramp}, 30.0).to_dict()
    data["environment"]["waves"]["components"] = {"rows": "sea.csv", "direction": 0.5}
    (tmp_path / "scene.yaml").write_text(json.dumps(data))
    again = sea(cm.load_scene(tmp_path / "scene.yaml"))
    place = np.array([[3.0, -4.0, -5.0]])
    for t in (2.0, 50.0):
        np.testing.assert_allclose(again.velocity(t, place), field.velocity(t, place), rtol=1e-9)
    assert field.significant_height == pytest.approx(2.5, rel=1e-9)


def test_the_waters_power_is_the_same_where_a_winch_hardly_turns():
    """While cable may pass the tow point the matter's motion at its node is another array."""
    still, turning = (cm.CableModel(scene(JONSWAP, depth=30.0)) for _ in range(2))
    for _ in range(20):
        still.step(0.2)
        turning.step(0.2, payout_rate=-1e-9)
    assert turning.payout_rate != 0.0
    expected = still.energy()["drag_power"]
    assert abs(expected) > 1e-3
    assert turning.energy()["drag_power"] == pytest.approx(expected, rel=1e-4)
