"""A small part of the robustness matrix: the corners, with every caller step."""

from __future__ import annotations

import pytest

from benchmarks.robustness import HARD_SCENES, HardScene, compare, energy_is_right, run_one

CORNERS = [(0.0, 1e4), (0.0, 1e9), (0.1, 1e6), (10.0, 1e4), (10.0, 1e9)]


@pytest.mark.parametrize(("bending_stiffness", "axial_stiffness"), CORNERS)
@pytest.mark.parametrize("scene", HARD_SCENES, ids=lambda scene: scene.name)
def test_completes_and_agrees_whatever_step_the_caller_takes(
    scene: HardScene,
    bending_stiffness: float,
    axial_stiffness: float,
) -> None:
    outcomes = [
        run_one(scene, bending_stiffness, axial_stiffness, step) for step in (0.001, 0.1, 2.0)
    ]

    for outcome in outcomes:
        assert outcome.completed, f"caller step {outcome.caller_step} s: {outcome.message}"
    disagreement = compare(scene, outcomes)
    assert disagreement.within, (
        f"runs are {disagreement.distance:.3g} tau L apart at {disagreement.instant} s"
    )
    assert energy_is_right(scene, outcomes[-1]), (
        f"energy at most {outcomes[-1].most_energy:.3g} of the start's, "
        f"{outcomes[-1].energy_left:.3g} of it left at {scene.settled} s"
    )


def test_a_nearly_inextensible_whip_with_bending_comes_to_rest() -> None:
    whip = next(scene for scene in HARD_SCENES if scene.name == "whip")

    outcome = run_one(whip, bending_stiffness=1.0, axial_stiffness=1e9, caller_step=2.0)

    assert outcome.completed, outcome.message
    assert energy_is_right(whip, outcome)
