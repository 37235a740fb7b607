"""Natural frequencies about an equilibrium against closed forms.

A frequency of a conforming cubic element converges from above like h^4; the lowest ones must come
first, in order and without others between them.
"""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification.references import catenary, modes
from tests.verification.scenes import IDEAL, scene

GRAVITY = 9.80665


def frequencies(model, count):
    return model.natural_frequencies(count)


def observed_order(errors):
    return np.log2(np.abs(errors[0]) / np.abs(errors[1]))


def hanging_chain(elements):
    cable = {**IDEAL, "submerged_weight": GRAVITY, "axial_stiffness": 1e8}
    return cm.CableModel(scene(10.0, cable, model="cable", elements=elements, density=0.0))


def test_hanging_chain():
    """Stretch w L/EA = 1e-6 shifts them by less; a free end without tension is regular."""
    expected = np.array(modes.hanging_chain(10.0, 3))
    assert frequencies(hanging_chain(32), 3) == pytest.approx(expected, rel=1e-6)
    errors = [frequencies(hanging_chain(n), 3)[2] - expected[2] for n in (4, 8)]
    assert observed_order(errors) > 3.8


def hanging_elastica(elements):
    cable = {
        **IDEAL,
        "submerged_weight": GRAVITY,
        "axial_stiffness": 1e8,
        "bending_stiffness": 1e-3 * GRAVITY,
    }
    vessel = {"connection": {"clamped": [0.0, 0.0, -1.0]}}
    return cm.CableModel(scene(1.0, cable, elements=elements, density=0.0, vessel=vessel))


def test_hanging_elastica():
    """Clamped at the top; EI/(w L^3) = 1e-3, so that the layer of 0.03 L needs elements. With 64 of
    them rounding in the start and in the derivatives, 5e-7, is as large as what is left."""
    expected = np.array(modes.hanging_elastica(1e-3, 3)) * np.sqrt(GRAVITY)
    errors = [frequencies(hanging_elastica(n), 3) - expected for n in (16, 32, 64)]
    assert observed_order(errors[:2]) == pytest.approx(4.0, abs=0.5)
    assert errors[2] / expected == pytest.approx(0.0, abs=2e-6)


def beam(elements, tension, *, clamped_start, anchor, clamped_end=False):
    cable = {**IDEAL, "axial_stiffness": 1e9, "bending_stiffness": 1.0}
    along = {"clamped": [1.0, 0.0, 0.0]}
    vessel = {"connection": along} if clamped_start else {"position": [0.0, 0.0, 0.0]}
    end = "free"
    if anchor:
        end = {"anchor": [1.0 + tension / 1e9, 0.0, 0.0]}
        if clamped_end:
            end["connection"] = along
    initial = {"points": [[0, 0, 0], [1.0 + tension / 1e9, 0, 0]]}
    return cm.CableModel(
        scene(1.0, cable, elements=elements, density=0.0, vessel=vessel, end=end, initial=initial)
    )


def test_cantilever():
    expected = np.array(modes.cantilever(2)) ** 2
    errors = [
        frequencies(beam(n, 0.0, clamped_start=True, anchor=False), 2) - expected for n in (8, 16)
    ]
    # The first one is right to rounding already: EA = 1e9 beside frequencies of 1.
    assert observed_order(errors)[1] == pytest.approx(4.0, abs=0.3)
    assert errors[1] / expected == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize("clamped", [False, True])
def test_tensioned_beam(clamped):
    reference = modes.tensioned_beam_clamped if clamped else modes.tensioned_beam_pinned
    expected = np.array(reference(100.0, 2))
    errors = [
        frequencies(beam(n, 100.0, clamped_start=clamped, anchor=True, clamped_end=clamped), 2)
        - expected
        for n in (8, 16)
    ]
    assert observed_order(errors)[1] == pytest.approx(4.0, abs=0.3)
    assert errors[1] / expected == pytest.approx(0.0, abs=5e-5)


@pytest.mark.parametrize("parameter", [1.0, 4.0 * np.pi**2, 100.0])
def test_sagging_cable(parameter):
    """In the plane: the symmetric mode of Irvine's theory, and the antisymmetric one at 2 pi.

    The theory is for a flat cable: its error is of the order (w L/H)^2 = 1e-6.
    """
    horizontal, sag = 1.0, 1e-3
    axial_stiffness = horizontal * parameter / sag**2
    cable = {
        **IDEAL,
        "submerged_weight": sag * horizontal,
        "axial_stiffness": axial_stiffness,
    }
    span = catenary.pinned_catenary_span(horizontal, 1.0, sag * horizontal, axial_stiffness)
    model = cm.CableModel(
        scene(
            1.0,
            cable,
            model="cable",
            elements=48,
            density=0.0,
            end={"anchor": [span, 0.0, 0.0]},
        )
    )
    expected = sorted([modes.irvine_symmetric(parameter), 2.0 * np.pi])
    found = frequencies(model, 2) / np.sqrt(horizontal)
    assert found == pytest.approx(expected, rel=2e-6)


@pytest.mark.parametrize("gravity", [0.0, GRAVITY])
def test_axial_mode_with_an_end_mass(gravity):
    """An end mass like the cable's; weight stretches the cable but does not shift the mode.

    Without weight nothing holds the cable sideways: all else is at zero. With it, the mode is the
    one in which the mass moves along the cable, among those that move it across. Cubics have
    frequencies of a bar from above, like h^6.
    """
    (expected,) = modes.axial_with_end_mass(1000.0, 1e7, 1.0, 1000.0, 1)
    cable = {**IDEAL, "axial_stiffness": 1e7, "submerged_weight": gravity}
    errors = []
    for elements in (2, 4):
        model = cm.CableModel(
            scene(
                1000.0,
                cable,
                model="cable",
                elements=elements,
                density=0.0,
                body={"mass": 1000.0, "submerged_weight": 1000.0 * gravity},
                initial="static" if gravity else {"straight": [0.0, 0.0, -1.0]},
            )
        )
        found = frequencies(model, 4 * elements)
        errors.append(found[np.argmin(np.abs(found - expected))] / expected - 1.0)
    assert observed_order(errors) == pytest.approx(6.0, abs=0.7)
    assert abs(errors[1]) < 1e-8


@pytest.mark.parametrize("axial_stiffness", [1e5, 1e6, 3e7])
@pytest.mark.parametrize("bending", [0.0, 1.0])
def test_a_taut_line_has_the_modes_of_a_string_and_of_a_bar_and_no_others(axial_stiffness, bending):
    """Elements that stretched and shortened within themselves had frequencies among them, which
    a stabilisation set: 174 and 347 rad/s of EA = 1e6."""
    elements, length, tension = 8, 100.0, 10e3
    stretched = length * (1.0 + tension / axial_stiffness)
    cable = {**IDEAL, "mass": 0.15, "axial_stiffness": axial_stiffness}
    model = cm.CableModel(
        scene(
            length,
            {**cable, "submerged_weight": 1e-9, "bending_stiffness": bending},
            elements=elements,
            density=0.0,
            end={"anchor": [stretched, 0.0, 0.0]},
        )
    )
    n = np.arange(1, 2 * elements)
    # Across, all is stretched; along, the stretch is what moves.
    string = n * np.pi / length * np.sqrt(tension / (0.15 * (1.0 + tension / axial_stiffness)))
    bar = n * np.pi / length * np.sqrt(axial_stiffness / 0.15)
    found = frequencies(model, 4 * elements)
    known = np.sort(np.concatenate([string[: elements + 2], bar[: elements + 2]]))
    known = known[known < 0.99 * min(string[elements + 2], bar[elements + 2])]
    # Cubics are from above, at half of what the mesh has within 3 %.
    assert np.all(found[: len(known)] > (1.0 - 1e-4) * known)
    assert found[: len(known)] == pytest.approx(known, rel=0.035)


def test_a_slack_line_has_no_modes_of_its_elements():
    """The same ones on meshes of 12 and 24: whatever belongs to a mesh moves by a factor."""

    def model(elements):
        cable = {**IDEAL, "submerged_weight": 1.0, "axial_stiffness": 1e6}
        end = {"anchor": [60.0, 0.0, 0.0]}
        return cm.CableModel(scene(100.0, cable, elements=elements, density=0.0, end=end))

    coarse, fine = frequencies(model(12), 12), frequencies(model(24), 12)
    assert coarse == pytest.approx(fine, rel=0.02)


def test_modes_are_the_same_in_three_dimensions():
    """Out of the plane a sagging chain has frequencies of its own; hanging, all come in pairs."""
    cable = {**IDEAL, "submerged_weight": GRAVITY, "axial_stiffness": 1e8}
    model = cm.CableModel(scene(10.0, cable, model="cable", elements=16, density=0.0), planar=False)
    found = frequencies(model, 6)
    expected = np.repeat(modes.hanging_chain(10.0, 3), 2)
    assert found == pytest.approx(expected, rel=3e-6)
