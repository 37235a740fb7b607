"""The foot of a lay: the layer in which it bends on to the floor, and what has been laid.

Independent: the boundary value problem of that layer on a rigid floor, by scipy's `solve_bvp`, in
the frame of the touchdown, with the added mass in the centrifugal term.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_bvp

import cablemodel as cm
from tests.verification.scenes import CABLE_K

SPEED, RATE, DEPTH = 0.65, 0.7, 70.0
LAYERS = 14.0


def boundary_layer(bending: float) -> tuple[float, float]:
    """Concentrated reaction [N] and largest curvature [1/m] of cable K laid without tension.

    Angle a, curvature k, tension T and shear Q over s, from the touchdown up: a = k = T = 0 there,
    straight at the far end. EI k' = -Q; T' = Q k + w sin a - drag; Q' = ((m + ma) V^2 - T) k + w
    cos a - D sin^2 a.
    """
    weight, diameter = CABLE_K["submerged_weight"], CABLE_K["diameter"]
    centrifugal = (CABLE_K["mass"] + 1025.0 * math.pi / 4.0 * diameter**2) * RATE**2
    normal = 0.5 * 1025.0 * CABLE_K["drag_normal"] * diameter * SPEED**2
    along = 0.5 * 1025.0 * CABLE_K["drag_tangential"] * math.pi * diameter
    ratio = normal / weight
    steep = math.acos(2.0 * ratio / (1.0 + math.sqrt(1.0 + 4.0 * ratio**2)))
    layer = (bending / weight) ** (1.0 / 3.0)

    def rates(_s, state):
        a, k, tension, shear = state
        slip = RATE - SPEED * np.cos(a)
        return np.array(
            [
                k,
                -shear / bending,
                shear * k + weight * np.sin(a) - along * slip * np.abs(slip),
                (centrifugal - tension) * k
                + weight * np.cos(a)
                - normal * np.sin(a) * np.abs(np.sin(a)),
            ]
        )

    def ends(floor, up):
        return np.array([floor[0], floor[1], floor[2], up[1]])

    s = np.linspace(0.0, LAYERS * layer, 400)
    x = 0.7 * s / layer
    guess = np.array(
        [
            steep * (1.0 - np.exp(-x) * (1.0 + x)),
            0.7 * steep / layer * x * np.exp(-x),
            weight * math.sin(steep) * np.maximum(s - layer, 0.0),
            -weight * layer * np.exp(-s / layer),
        ]
    )
    found = solve_bvp(rates, ends, s, guess, tol=1e-8, max_nodes=20_000)
    assert found.success
    bent = found.sol(np.linspace(0.0, 4.0 * layer, 4001))[1]
    return -float(found.sol(0.0)[3]), float(bent.max())


def cable(length: float, model: str = "elastica") -> dict:
    return {"cable": {"type": "K", "length": length, "model": model}}


def lay(bending: float, **solver) -> cm.CableModel:
    """Its frictionless lay, which is steady."""
    data = {
        "environment": {"floor": {"z": -DEPTH}},
        "cable_types": {"K": {**CABLE_K, "bending_stiffness": bending}},
        "line": [cable(110.0)],
        "vessel": {"velocity": [SPEED, 0, 0]},
        "payout": {"rate": RATE, "drum": [cable(100.0)]},
        "solver": solver,
    }
    return cm.CableModel(cm.load_scene(data))


def near(model: cm.CableModel, bending: float, count: int = 3001):
    """Stations from five layers before the touchdown to three behind it."""
    layer = (bending / CABLE_K["submerged_weight"]) ** (1.0 / 3.0)
    touchdown = model.line_length - model.floor_length
    last = min(touchdown + 3.0 * layer, model.line_length)
    return model.sample(np.linspace(touchdown - 5.0 * layer, last, count))


def test_the_boundary_value_problem_is_that_of_two_others():
    """1.81364 N and 0.67798 1/m of EI 1; 3.801 and 6.436 N of 10 and 50 by direct integration."""
    assert boundary_layer(1.0) == pytest.approx((1.81364, 0.67798), rel=1e-4)
    assert boundary_layer(10.0)[0] == pytest.approx(3.801, rel=1e-4)
    assert boundary_layer(50.0)[0] == pytest.approx(6.436, rel=1e-4)


@pytest.mark.parametrize(
    ("bending", "tolerance", "rel"),
    [
        *((bending, 1e-3, 1e-2) for bending in (1.0, 3.0, 10.0, 25.0, 50.0)),
        *((bending, 1e-4, 3e-3) for bending in (1.0, 10.0, 25.0, 50.0)),
        (3.0, 1e-4, 3e-3),
    ],
)
def test_reaction_and_curvature_of_a_frictionless_lay(bending, tolerance, rel):
    reaction, curvature = boundary_layer(bending)
    model = lay(bending, tolerance=tolerance)
    assert model.touchdown_reaction == pytest.approx(reaction, rel=rel)
    assert near(model, bending).curvature.max() == pytest.approx(curvature, rel=rel)


@pytest.mark.parametrize("bending", [1.0, 10.0, 50.0])
def test_the_touchdown_converges(bending):
    """It is where a rigid floor's would be: within 0.02 layers at any tolerance. Where cable comes
    as near the floor as it lies depended on its softness: 0.14 m apart at 1e-3 and 1e-5."""
    layer = (bending / CABLE_K["submerged_weight"]) ** (1.0 / 3.0)
    places, lengths = [], []
    for tolerance in (1e-3, 3e-4, 1e-4, 1e-5):
        model = lay(bending, tolerance=tolerance)
        places.append(float(model.touchdown_position[0]))
        lengths.append(model.floor_length)
    assert np.ptp(places) < 0.02 * layer
    assert np.ptp(lengths) < 0.05 * layer


@pytest.mark.parametrize("time", [0.0, 15.0])
@pytest.mark.parametrize("bending", [1.0, 50.0])
def test_no_saw_teeth_along_a_touchdown(bending, time):
    """Tension and curvature of adjacent stations differ as a smooth line's do: teeth were 0.5 N,
    and 5 % of the largest curvature, from one element to the next."""
    model = lay(bending, tolerance=1e-3)
    if time > 0.0:
        model.step_to(time)
    found = near(model, bending, count=801)
    _, curvature = boundary_layer(bending)
    assert np.abs(np.diff(found.curvature)).max() < 0.04 * curvature
    falls = np.diff(found.tension)
    # Tension falls towards the floor; below its last metre it may rise again by its compression.
    layer = (bending / CABLE_K["submerged_weight"]) ** (1.0 / 3.0)
    assert np.maximum(falls, 0.0)[: 801 // 4].sum() == 0.0
    assert np.abs(falls).max() < 3.0 * 8.0 * layer / 800.0 * CABLE_K["submerged_weight"]


DENSITY = 1025.0
ARMOURED = {
    "diameter": 0.04, "mass": 4.3, "axial_stiffness": 50e6, "drag_normal": 1.2,
    "drag_tangential": 0.01, "bending_stiffness": 2000.0,
}  # fmt: skip


@pytest.mark.parametrize(("knots", "depth"), [(2.0, 1000.0), (5.0, 3000.0)])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_laid_cable_is_not_pressed(knots, depth, tolerance):
    """A lay without slack leaves no tension. What slid as it came through the soft floor pressed
    it by 1 to 1.5 kN, more the further it lay behind."""
    speed = knots * 1852.0 / 3600.0
    weight = (
        ARMOURED["mass"] * 9.80665 - DENSITY * 9.80665 * math.pi / 4 * ARMOURED["diameter"] ** 2
    )
    drag = 0.5 * DENSITY * ARMOURED["drag_normal"] * ARMOURED["diameter"] * speed**2
    cosine = (-weight + math.sqrt(weight**2 + 4.0 * drag**2)) / (2.0 * drag)
    length = 1.05 * depth / math.sqrt(1.0 - cosine**2) + 20.0
    data = {
        "environment": {"floor": {"z": -depth, "friction": 0.5}},
        "cable_types": {"c": ARMOURED},
        "line": [{"cable": {"type": "c", "length": length}}],
        "vessel": {"velocity": [speed, 0, 0]},
        "payout": {"rate": speed, "drum": [{"cable": {"type": "c", "length": 1500}}]},
        "solver": {"tolerance": tolerance},
    }
    model = cm.CableModel(cm.load_scene(data))
    top = weight * depth
    for time in (50.0, 200.0, 400.0):
        model.step_to(time)
        begin = model.line_length - 0.98 * model.floor_length
        laid = model.sample(np.linspace(begin, model.line_length, 500)).tension
        # What the tolerance promises; measured up to 0.8 of it.
        assert np.abs(laid).max() < 10.0 * tolerance * top
