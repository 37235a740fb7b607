"""One of the ordinary random scenes of each job, and what makes them ordinary."""

from __future__ import annotations

import itertools
import math

import pytest

import cablemodel as cm
from benchmarks.random_scenes.draw import draw
from benchmarks.random_scenes.judge import judge
from benchmarks.random_scenes.ordinary import (
    JOBS,
    KNOT,
    ORDINARY,
    WORKING_STRAIN,
    draw_ordinary,
    drawn,
)
from benchmarks.random_scenes.report import JOBS as SEARCH

# A cheap one of each that keeps its promise; what does not is in docs/stress/ordinary_scenes.json.
SEEDS = {"tow": 20000, "turn": 20001, "lay": 20009, "lower": 20017, "recover": 20018,
         "moor": 20005, "heave": 20006}  # fmt: skip
EVERY = range(SEARCH.first, SEARCH.first + SEARCH.count)


@pytest.mark.parametrize("job", JOBS)
def test_ordinary_scene_starts_and_ends_within_its_promise(job: str) -> None:
    scene = drawn(SEEDS[job])
    verdict = judge(scene)

    assert scene.traits["manoeuvre"] == job
    assert verdict.outcome == "completed", verdict.why
    assert verdict.compared == 1.0
    assert 0.0 < verdict.position <= 1.25
    assert 0.0 < verdict.tension <= 1.25


def test_a_light_line_has_the_time_that_it_takes_to_sink() -> None:
    """1,339 m that sink at 0.18 m/s: after an hour they carry nine tenths of their weight."""
    assert judge(drawn(20498)).outcome == "completed"


def test_a_number_means_the_same_ordinary_scene_everywhere() -> None:
    scene = drawn(ORDINARY + 8)

    assert scene.traits["manoeuvre"] == JOBS[1]
    assert scene.scene["cable_types"]["K"]["diameter"] == pytest.approx(0.09032828482911122)
    assert drawn(3).scene == draw(3).scene
    with pytest.raises(ValueError, match=f"seed 3: allowed are {ORDINARY} and more"):
        draw_ordinary(3)


def test_every_ordinary_scene_loads_and_is_ordinary() -> None:
    """Nothing is thicker, faster, steeper or more heavily loaded than it is said to be."""
    for seed in EVERY:
        scene = drawn(seed)
        loaded = cm.load_scene(scene.scene)
        cable = scene.scene["cable_types"]["K"]
        assert 0.005 <= cable["diameter"] <= 0.1
        assert cable["submerged_weight"] > 0.0
        assert float(scene.traits["strain"]) <= 1.001 * WORKING_STRAIN
        assert 1e-4 <= loaded.solver.tolerance <= 1e-3
        speeds = scene.scene["vessel"].get("velocity", [])
        assert all(math.hypot(*row["velocity"]) <= 8.001 * KNOT for row in speeds)
        rates = scene.scene.get("payout", {}).get("rate", [])
        for before, after in itertools.pairwise(rates):
            change = abs(after["rate"] - before["rate"])
            assert change == 0.0 or after["t"] - before["t"] >= 2.0
