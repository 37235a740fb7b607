"""Cable and bodies that move onto, along and over the sea floor."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import cablemodel as cm
from tests.verification.scenes import CABLE_K
from tests.verification.touchdown_layer import touchdown_layer

WEIGHT = CABLE_K["submerged_weight"]
BODY = {
    "mass": 6.0,
    "submerged_weight": 20.0,
    "added_mass": 2.0,
    "drag_area": 0.03,
    "drag_coefficient": 0.6,
}


def simulated(line, floor, tolerance=1e-4, planar=None, density=1025.0, bending=0.1, **settings):
    return cm.CableModel(
        cm.load_scene(
            {
                "environment": {"floor": floor, "water_density": density},
                "cable_types": {"K": {**CABLE_K, "bending_stiffness": bending}},
                "line": line,
                "solver": {"tolerance": tolerance},
                **settings,
            }
        ),
        planar=planar,
    )


def cable(length):
    return {"cable": {"type": "K", "length": length, "model": "elastica"}}


# S3: pay-out until the cable lands, and folds on a slippery floor ---------------------------------

TENSION = {60.0: 117.21, 96.0: 134.98, 120.0: 138.83}
ON_THE_FLOOR = {60.0: 28.0, 96.0: 71.2, 120.0: 103.7}


def paid_out_to_the_floor(tolerance):
    body = {**BODY, "added_mass_axial": 2.0, "drag_area_axial": 0.03, "drag_coefficient_axial": 0.6}
    start = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 20, "velocity": [0.65, 0, 0]}]
    rate = [{"t": 0, "rate": 0}, {"t": 20, "rate": 0}, {"t": 21, "rate": 0.7}]
    return simulated(
        [cable(10.0), {"body": body}, cable(50.0)],
        {"z": -70},
        tolerance,
        vessel={"velocity": start},
        payout={"rate": rate, "drum": [cable(80.0)]},
    )


@pytest.fixture(scope="module", params=[1e-3, 1e-4])
def folding(request):
    """Time, top tension and floor force of S3, every tenth of a second (n, 3)."""
    model = paid_out_to_the_floor(request.param)
    rows = []
    for k in range(1, 1221):
        model.step_to(0.1 * k)
        rows.append((0.1 * k, model.top_tension, model.floor_force[2]))
    return np.array(rows)


def at_and_around(rows, time, column):
    """Value at a time, and the mean over 2 s on both sides: the folding cable jerks."""
    near = np.abs(rows[:, 0] - time) < 2.01
    return rows[np.argmin(np.abs(rows[:, 0] - time)), column], rows[near, column].mean()


@pytest.mark.parametrize("time", TENSION)
def test_tension_while_it_folds(folding, time):
    """Within 0.5 % in the mean over 4 s: measured 0.27 % at the most."""
    _, mean = at_and_around(folding, time, 1)
    assert mean == pytest.approx(TENSION[time], rel=5e-3)


@pytest.mark.parametrize("time", TENSION)
def test_tension_at_an_instant_while_it_folds(folding, time, request):
    """Within 0.5 %, but while folds close: then within what is promised, 10 tau."""
    tolerance = request.node.callspec.params["folding"]
    closing = tolerance == 1e-3 and time == 120.0
    instant, _ = at_and_around(folding, time, 1)
    assert instant == pytest.approx(TENSION[time], rel=10.0 * tolerance if closing else 5e-3)


@pytest.mark.parametrize("time", TENSION)
def test_floor_force_while_it_folds(folding, time):
    """Mean within 0.5 % at 60 and 120 s, 1.1 % at 96 s (0.7 to 1.0 % at eleven tolerances from 1e-3
    to 5e-5: folds fall by chance); from there it strays by 0.5 % of the top tension."""
    instant, mean = at_and_around(folding, time, 2)
    assert mean == pytest.approx(ON_THE_FLOOR[time], rel=11e-3 if time == 96.0 else 5e-3)
    assert instant == pytest.approx(mean, abs=5e-3 * TENSION[time])


@pytest.mark.xfail(
    strict=True, reason="measured 0.66 to 0.83 % at every tolerance and floor stiffness"
)
def test_floor_force_at_96_s_is_that_of_the_table(folding):
    _, mean = at_and_around(folding, 96.0, 2)
    assert mean == pytest.approx(ON_THE_FLOOR[96.0], rel=5e-3)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_time_of_touchdown(tolerance):
    """38.778 s; 38.80 to 38.81 s at every tolerance: the tip is 15 mm higher than the table's."""
    model = paid_out_to_the_floor(tolerance)
    model.step_to(38.6)
    assert not model.floor_force.any()
    assert np.isnan(model.touchdown_position).all()
    while not model.floor_force.any():
        model.step(0.01)
    assert model.time == pytest.approx(38.778, abs=0.05)
    assert model.touchdown_position[2] == pytest.approx(-70.0, abs=tolerance * 73.0)


# A steady lay ------------------------------------------------------------------------------------


def lay(tolerance):
    return simulated(
        [cable(110.0)],
        {"z": -70},
        tolerance,
        bending=1.0,
        vessel={"velocity": [0.65, 0, 0]},
        payout={"rate": [{"t": 0, "rate": 0.7}], "drum": [cable(100.0)]},
    )


@pytest.fixture(scope="module")
def laying():
    """Top tension, concentrated reaction and largest curvature (n, 3) of a lay at 0.65 m/s and
    0.70 m/s of pay-out, EI = 1, from its steady state; over 10 s, while the laid tail is short."""
    model = lay(1e-4)
    rows = []
    for k in range(41):
        if k:
            model.step_to(0.25 * k)
        touchdown = model.line_length - model.floor_length
        near = model.sample(np.linspace(touchdown - 3.0, touchdown + 3.0, 601))
        rows.append((model.top_tension, model.touchdown_reaction, near.curvature.max()))
    return np.array(rows)


def test_tension_of_a_lay(laying):
    """Static BVP of the touchdown layer: 140.895 N. Within 1 % throughout; measured 0.1 %."""
    assert laying[:, 0] == pytest.approx(140.895, rel=1e-2)
    assert laying[:, 0].mean() == pytest.approx(140.895, rel=2e-3)


def test_largest_curvature_of_a_lay(laying):
    """0.67798 1/m; within 2 % at the start, 4 % high in the mean of the run."""
    assert laying[0, 2] == pytest.approx(0.67798, rel=2e-2)
    assert laying[:, 2].mean() == pytest.approx(0.67798, rel=5e-2)


def layer_of(model, bottom_tension, inertia):
    """Reaction [N] and largest curvature [1/m] of that lay on a rigid floor."""
    return touchdown_layer(model.scene.cable_types["K"], bottom_tension, 0.65, 0.7, inertia)


def test_reference_of_the_touchdown_layer():
    """Two boundary value problems solved elsewhere: 1.81364 N, 0.67798 1/m."""
    assert layer_of(lay(1e-3), 0.0, 1.0) == pytest.approx((1.81364, 0.67798), rel=5e-3)


@pytest.mark.parametrize(
    ("tolerance", "rel"), [(1e-2, 3e-2), (1e-3, 1e-2), (1e-4, 1e-2), (1e-5, 1e-2)]
)
def test_concentrated_reaction_of_a_steady_start(tolerance, rel):
    """Whatever the contact layer, with the inertia of cable that runs round the bend."""
    model = lay(tolerance)
    lying = model.line_length - model.floor_length + 1.5
    reaction, _ = layer_of(model, model.sample([lying]).tension[0], 1.0)
    assert model.touchdown_reaction == pytest.approx(reaction, rel=rel)


def test_concentrated_reaction_of_a_lay(laying):
    """1.814 N; in the run it scatters by 7 %, the mean of ten seconds by 2 %."""
    assert laying[1:, 1].mean() == pytest.approx(1.81364, rel=4e-2)


@pytest.mark.xfail(strict=True, reason="4 % high in the run")
def test_largest_curvature_of_a_lay_within_a_per_cent(laying):
    assert laying[:, 2].mean() == pytest.approx(0.67798, rel=1e-2)


# Stick and slip ----------------------------------------------------------------------------------


def on_a_slope(friction, direction, slope=0.2, **settings):
    return simulated(
        [cable(20.0)],
        {"z": 0, "slope": [slope, 0], "friction": friction},
        initial={"points": [[0, 0, 0], (20.0 * np.asarray(direction)).tolist()]},
        **settings,
    )


UP = np.array([1.0, 0.0, 0.2]) / np.hypot(1.0, 0.2)


@pytest.mark.parametrize("direction", [UP, -UP, [0.0, 1.0, 0.0]])
def test_cable_that_sticks_does_not_creep(direction):
    """Friction 0.5 on a slope of 0.2, for an hour. In the first ten minutes it takes up the load
    within the bristle, 0.02 tau L, or its own transverse elasticity; then nothing moves."""
    model = on_a_slope(0.5, direction)
    s = np.linspace(0.0, 20.0, 41)
    accuracy = 1e-4 * 20.0
    start = model.sample(s).position
    model.step_to(600.0)
    settled = model.sample(s).position
    assert np.abs(settled - start).max() < accuracy
    model.step_to(4200.0)
    assert np.abs(model.sample(s).position - settled).max() < 1e-3 * accuracy


def test_cable_on_too_steep_a_slope_slides():
    """Friction 0.1: it swings down the slope about the vessel; it stays on the floor."""
    model = on_a_slope(0.1, [0.0, 1.0, 0.0])
    model.step_to(60.0)
    assert model.tip_position[0] < -5.0
    assert model.tip_position[2] == pytest.approx(0.2 * model.tip_position[0], abs=1e-4 * 20.0)
    push = model.floor_force @ (np.array([-0.2, 0.0, 1.0]) / np.hypot(1.0, 0.2))
    assert push == pytest.approx(20.0 * WEIGHT / np.hypot(1.0, 0.2), rel=1e-2)


COARSE = pytest.mark.xfail(
    strict=True,
    reason="2.1e-3 after 60 s: the straight cable is joined into one element, whose floor force "
    "is 1.2e-3 too large where it rests 0.02 of the contact layer above the held tow point",
)


@pytest.mark.parametrize("planar", [None, False])
@pytest.mark.parametrize(
    ("density", "slope"),
    [(0.0, 0.0), (1025.0, 0.0), (0.0, 0.2), (0.0, -0.2)],
)
def test_dragging_a_cable_over_the_floor(density, slope, planar, request):
    """Coulomb, drag and the weight along the slope, closed form; linear along the cable."""
    if slope < 0.0:
        request.applymarker(COARSE)
    speed, friction = 0.5, 0.5
    way = np.array([1.0, 0.0, slope]) / np.hypot(1.0, slope)
    ramp = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 10, "velocity": (speed * way).tolist()}]
    model = simulated(
        [cable(20.0)],
        {"z": 0, "slope": [slope, 0], "friction": friction},
        planar=planar,
        density=density,
        initial={"points": [[0, 0, 0], (-20.0 * way).tolist()]},
        vessel={"velocity": ramp},
    )
    model.step_to(60.0)
    drag = 0.5 * density * 0.1586 * np.pi * 0.01666 * speed**2
    pull = drag + WEIGHT * (friction + slope) / np.hypot(1.0, slope)
    state = model.sample(np.linspace(0.0, 20.0, 21))
    assert state.on_floor.all()
    assert state.tension == pytest.approx(pull * (20.0 - state.s), abs=10 * 1e-4 * 20.0 * pull)
    assert -model.top_force @ way == pytest.approx(20.0 * pull, rel=10 * 1e-4)


# Energy ------------------------------------------------------------------------------------------


def stored(energy):
    return sum(energy[name] for name in ("kinetic", "axial", "bending", "potential", "floor"))


def history(model, interval, count):
    """Stored energy [J], power of the vessel, power lost to water and floor [W]: (count + 1, 4)."""
    rows = []
    for k in range(count + 1):
        if k:
            model.step_to(k * interval)
        energy = model.energy()
        lost = abs(energy["drag_power"]), energy["floor_power"]
        rows.append((stored(energy), energy["vessel_power"], *lost))
    return np.array(rows)


def integral(interval, powers):
    """Running trapezoidal integral [J]."""
    steps = 0.5 * interval * (powers[1:] + powers[:-1])
    return np.concatenate([[0.0], np.cumsum(steps)])


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_energy_of_a_cable_that_drops_flat(tolerance, friction):
    """From 0.5 m: what is lost to water and floor is what it had, within 10 tau of it. Read ten
    or more times while cable goes through the contact layer."""
    interval = tolerance
    model = simulated(
        [cable(20.0)],
        {"z": -0.5, "friction": friction},
        tolerance,
        initial={"straight": [1, 0, 0]},
    )
    rows = history(model, interval, round(1.6 / interval))
    energy, _, drag, floor = rows.T
    lost = integral(interval, drag) + integral(interval, floor)
    assert lost[-1] > 20.0
    assert energy[-1] - energy[0] + lost[-1] == pytest.approx(0.0, abs=10 * tolerance * lost[-1])
    assert np.diff(energy).max() < 10 * tolerance * lost[-1]
    assert (energy <= energy[0]).all()


@pytest.mark.parametrize("half_length", [0.0, 0.5])
@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_energy_of_a_body_that_strikes(tolerance, friction, half_length):
    """Stored energy plus drag less work of the vessel never exceeds the start: the floor only
    takes. (How much it takes within 1e-4 s is not resolved; the waves that run up the line are.)"""
    interval = 5e-4
    body = {**BODY, "half_length": half_length}
    if half_length:
        body["rotary_inertia"] = 1.0
    motion = [
        {"t": 0, "velocity": [0.3, 0, 0]},
        {"t": 1, "velocity": [0.3, 0, -0.5]},
        {"t": 7, "velocity": [0.3, 0, -0.5]},
        {"t": 8, "velocity": [0, 0, 0]},
    ]
    model = simulated(
        [cable(10.0), {"body": body}],
        {"z": -12, "friction": friction},
        tolerance,
        vessel={"velocity": motion},
    )
    energy, vessel, drag, _ = history(model, interval, 16000).T
    work = integral(interval, vessel)
    left = energy + integral(interval, drag) - work
    scale = np.abs(work).max()
    assert (left <= left[0] + 10 * tolerance * scale).all()
    assert left[-1] < left[0]
    assert model.bodies[0].position[2] == pytest.approx(-12.0, abs=tolerance * 10.0 + 0.01)
    assert model.floor_force[2] > 20.0


@pytest.mark.parametrize("damping", [4.0, 20.0])
def test_a_load_leaves_the_floor_as_its_damping_lets_it(damping: float) -> None:
    """Of a force f(z) (1 - c v) alone, m v dv = f (1 - c v) dz: c u - ln(1 + c u) is the same for
    the speed u that it comes down with and, with the sign changed, that it leaves with."""
    load = {"mass": 500.0, "submerged_weight": 1000.0, "drag_area": 0.2, "drag_coefficient": 1.0}
    wire = {
        "diameter": 0.01, "mass": 0.2, "submerged_weight": 1.2, "axial_stiffness": 1e6,
        "bending_stiffness": 0.1,
    }  # fmt: skip
    model = cm.CableModel(
        cm.load_scene(
            {
                "environment": {"floor": {"z": -20.0, "damping": damping}},
                "cable_types": {"wire": wire},
                "line": [{"cable": {"type": "wire", "length": 19.0}}, {"body": load}],
                "payout": {
                    "rate": [{"t": 0.0, "rate": 0.0}, {"t": 2.0, "rate": 0.5}],
                    "drum": [{"cable": {"type": "wire", "length": 30.0}}],
                },
                "solver": {"tolerance": 1e-4},
            }
        )
    )
    speeds = []
    while model.time < 6.0:
        model.step(1e-3)
        speeds.append(model.bodies[0].velocity[2])
    down, up = -damping * min(speeds), damping * max(speeds)
    left = brentq(lambda b: -b - math.log(1.0 - b) - (down - math.log(1.0 + down)), 1e-9, 1 - 1e-9)
    assert up == pytest.approx(left, rel=0.03)


@pytest.mark.parametrize("half_length", [0.0, 1.0])
@pytest.mark.parametrize("tolerance", [1e-3, 2.5e-4, 1e-4])
def test_a_load_that_lands_takes_tension_off_its_wire_by_steps(
    tolerance: float, half_length: float
) -> None:
    """Soil throws nothing up again. The wire, paid out at V to a load that lies, sends V sqrt(EA m)
    up and down: its top tension falls by twice that whenever a front arrives. (A load that
    bounced made it 1.4 of them.) Longer steps of the caller damp what rings after a landing."""
    speed, mass, stiffness = 0.167, 0.625, 6.3e6
    wire = {
        "diameter": 0.0134, "mass": mass, "submerged_weight": 4.7, "axial_stiffness": stiffness,
        "bending_stiffness": 8.4,
    }  # fmt: skip
    load = {
        "mass": 2170.0, "submerged_weight": 16840.0, "drag_area": 0.7, "drag_coefficient": 1.0,
        "half_length": half_length,
    } | ({"rotary_inertia": 1400.0} if half_length else {})  # fmt: skip
    rate = [{"t": 0.0, "rate": 0.0}, {"t": 10.0, "rate": 0.0}, {"t": 20.0, "rate": speed}]
    model = cm.CableModel(
        cm.load_scene(
            {
                "environment": {"floor": {"z": -445.0 - 2.0 * half_length}},
                "cable_types": {"wire": wire},
                "line": [{"cable": {"type": "wire", "length": 440.0}}, {"body": load}],
                "payout": {"rate": rate, "drum": [{"cable": {"type": "wire", "length": 30.0}}]},
                "solver": {"tolerance": tolerance},
            }
        )
    )
    model.step_to(35.0)
    hangs = model.top_tension
    drop = speed * math.sqrt(stiffness * mass)
    carries = model.tension_min
    while model.tension_min > carries - 0.5 * drop:
        model.step(0.01)
        assert model.time < 40.0
    landed, trip = model.time, 2.0 * model.line_length * math.sqrt(mass / stiffness)
    for fronts in range(1, 11):
        for part in range(27, -1, -1):
            model.step_to(landed + trip * (fronts - part / 28))
        expected = hangs - 2.0 * drop * fronts
        assert model.top_tension == pytest.approx(expected, abs=0.25 * 2.0 * drop)
        assert model.bodies[0].velocity[2] < 0.1 * speed


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
@pytest.mark.parametrize("line", [[cable(10.0)], [cable(10.0), {"body": BODY}]])
def test_line_let_down_vertically_does_not_stand(line, tolerance):
    """What is exactly straight and vertical tips over where it touches: the floor bears its weight,
    not what a column would."""
    motion = [
        {"t": 0, "velocity": [0, 0, 0]},
        {"t": 0.5, "velocity": [0, 0, -1]},
        {"t": 4.5, "velocity": [0, 0, -1]},
        {"t": 5, "velocity": [0, 0, 0]},
    ]
    floor = {"z": -14, "friction": 0.3}
    model = simulated(line, floor, tolerance, vessel={"velocity": motion})
    s = np.linspace(0.0, 10.0, 401)
    for time in np.arange(0.1, 30.01, 0.1):
        model.step_to(time)
        # A rigid floor sends V sqrt(EA m) = 679 N up the line, and back.
        assert model.tension_min > -2.0 * 679.0
        assert model.sample(s).position[:, 2].min() > -14.0 - tolerance * 10.0
    weight = 10.0 * WEIGHT + (20.0 if len(line) == 2 else 0.0)
    assert model.floor_force[2] - model.top_force[2] == pytest.approx(weight, abs=0.01)
    assert model.top_tension == pytest.approx(9.5 * WEIGHT, rel=0.05)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
@pytest.mark.parametrize("bending", [0.0, 10.0, 60.0, 300.0])
@pytest.mark.parametrize(("away", "length"), [(240.0, 300.0), (420.0, 450.0)])
def test_the_touchdown_of_a_line_at_rest_is_a_catenarys_and_its_bends(
    away: float, length: float, bending: float, tolerance: float
) -> None:
    """Of a catenary in 100 m of water, up to sqrt(EI/T) beyond it as the bend there is resolved;
    the laid length counts from there."""
    depth, weight = 100.0, 9.6

    def hanging(height: float) -> float:
        return math.sqrt(depth**2 + 2.0 * height * depth)

    def reach(height: float) -> float:
        return height * math.acosh(1.0 + depth / height)

    height = brentq(lambda a: reach(a) + length - hanging(a) - away, 1e-3, 1e5)
    beyond = math.sqrt(bending / (weight * height))
    model = cm.CableModel(
        cm.load_scene(
            {
                "environment": {"floor": {"z": -depth, "friction": 0.0}},
                "cable_types": {
                    "c": {
                        "diameter": 0.028, "mass": 1.6, "submerged_weight": weight,
                        "axial_stiffness": 2.5e9, "bending_stiffness": bending,
                    }
                },
                "line": [{"cable": {"type": "c", "length": length}}],
                "end": {"anchor": [away, 0, -depth]},
                "solver": {"tolerance": tolerance},
            }
        )
    )  # fmt: skip
    within = tolerance * length
    found = float(model.touchdown_position[0]) - reach(height)
    laid = length - hanging(height) - model.floor_length
    assert -within < found < beyond + within
    assert laid == pytest.approx(found, abs=0.01 * within)
    if bending == 300.0 and away == 240.0 and tolerance == 1e-4:  # its bend is resolved
        assert found == pytest.approx(beyond, rel=0.06)
