"""The quick ones of the stress scenes; `make stress` runs all of them."""

from __future__ import annotations

import pytest

from benchmarks.stress_scenes import SCENES, StressScene, run


@pytest.mark.parametrize(
    "stress", [scene for scene in SCENES if scene.quick], ids=lambda scene: scene.name
)
def test_what_must_hold_holds(stress: StressScene) -> None:
    outcome = run(stress)

    assert outcome.holds, outcome.measured
