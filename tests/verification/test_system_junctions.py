"""Where a line begins or ends on another one: it does so there, in balance, and stays."""

from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from tests.verification.references.junction import Leg, meeting

G = 9.81
LENGTH, WEIGHT, STIFFNESS = 430.0, 300.0, 5e6
WEST, EAST, DEEP = [0.0, 0.0, 0.0], [380.0, 20.0, -25.0], [190.0, 140.0, -130.0]
ITEMS = [{"cable": {"type": "K", "length": LENGTH}}]
BOB = {"mass": 500.0, "submerged_weight": 500.0 * G}


def system(**parts: Any) -> cm.SystemModel:
    """Lines of one cable in a vacuum."""
    kind = {"diameter": 0.02, "mass": WEIGHT / G, "submerged_weight": WEIGHT,
            "axial_stiffness": STIFFNESS}  # fmt: skip
    return cm.SystemModel({
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": {"K": kind},
        "solver": {"tolerance": 1e-4},
        **parts,
    })  # fmt: skip


def main(at: float, start: Any, end: Any, length: float = 150.0, **items: Any) -> dict[str, Any]:
    """A line between two anchors, and a branch; where an end says so it is at ``at``."""
    there = {"line": "main", "at": at}
    ends = [there if end == "main" else end for end in (start, end)]
    branch = [{"cable": {"type": "K", "length": length}}, *([items] if items else [])]
    return {
        "main": {"from": {"anchor": WEST}, "to": {"anchor": EAST}, "items": ITEMS},
        "branch": {"from": ends[0], "to": ends[1], "items": branch},
    }


@pytest.mark.parametrize("at", [17.0, 143.3, 200.0, 215.0, 401.7])
@pytest.mark.parametrize("side", ["beginning", "end"])
def test_a_branch_meets_the_line_as_three_catenaries(at: float, side: str) -> None:
    """Also where no mass of the first guess is near."""
    ends = ("main", {"anchor": DEEP}) if side == "beginning" else ({"anchor": DEEP}, "main")
    model = system(lines=main(at, *ends, length=260.0))
    legs = [Leg(tuple(end), length, WEIGHT, STIFFNESS)  # type: ignore[arg-type]
            for end, length in ((WEST, at), (EAST, LENGTH - at), (DEEP, 260.0))]  # fmt: skip
    line, branch = model.lines["main"], model.lines["branch"]
    here = branch.sample([0.0 if side == "beginning" else 260.0]).position[0]
    place, forces = meeting(legs, here)
    assert np.linalg.norm(here - place) < 1e-4 * LENGTH
    assert line.start_tension == pytest.approx(legs[0].end_tension(forces[0]), rel=1e-3)
    assert line.end_tension == pytest.approx(legs[1].end_tension(forces[1]), rel=1e-3)
    held = branch.end_tension if side == "beginning" else branch.start_tension
    assert held == pytest.approx(legs[2].end_tension(forces[2]), rel=1e-3)


@pytest.mark.parametrize("at", [38.0, 215.0, 333.3])
def test_it_stays_there(at: float) -> None:
    """A weight that swings from a line, on a branch that is free below."""
    model = system(
        vessels={"beam": {"points": {"tip": WEST}, "velocity": [
            {"t": 0, "velocity": [0, 0, 0]}, {"t": 1, "velocity": [0, 2, 0]},
            {"t": 2, "velocity": [0, 0, 0]},
        ]}},
        lines={**main(at, "main", "free", 20.0, body=BOB),
               "main": {"from": "beam.tip", "to": {"anchor": EAST}, "items": ITEMS}},
    )  # fmt: skip
    for _ in range(11):
        line, branch = model.lines["main"], model.lines["branch"]
        apart = branch.sample([0.0]).position[0] - line.sample([at]).position[0]
        assert np.linalg.norm(apart) < 1e-9 * LENGTH
        model.step(0.5)


def test_a_line_between_two_others_begins_and_ends_on_them() -> None:
    """One end is in the tree, the other one closes a cycle."""
    other = [[end[0], end[1] + 60.0, end[2]] for end in (WEST, EAST)]
    model = system(lines={
        "one": {"from": {"anchor": WEST}, "to": {"anchor": EAST}, "items": ITEMS},
        "other": {"from": {"anchor": other[0]}, "to": {"anchor": other[1]}, "items": ITEMS},
        "between": {"from": {"line": "one", "at": 151.0}, "to": {"line": "other", "at": 217.0},
                    "items": [{"cable": {"type": "K", "length": 90.0}}]},
    })  # fmt: skip
    for _ in range(3):
        ends = model.lines["between"].sample([0.0, 90.0]).position
        places = [model.lines["one"].sample([151.0]), model.lines["other"].sample([217.0])]
        apart = ends - [place.position[0] for place in places]
        assert np.abs(apart).max() < 1e-6
        model.step(1.0)


@pytest.mark.parametrize(
    ("cables", "at"),
    [
        ([18.7, 11.6, 17.1], 30.3),  # less than the sum by an ulp
        ([66.1 - 27.2, 27.2], 66.1 - 27.2),
        ([27.2, 38.9], 27.2),
        ([70.0, 50.0], 95.0),  # in the middle of the second one
        ([0.1, 0.2, 30.0], 0.3),
    ],
)
def test_a_branch_at_a_joint_of_cables_is_as_one_beside_it(cables: list[float], at: float) -> None:
    """Lengths add up to the place to rounding only."""
    length = sum(cables)

    def tensions(at: float) -> np.ndarray:
        rope = {"diameter": 0.02, "mass": 1.138, "submerged_weight": 8.0, "axial_stiffness": 2e6}
        scene = {
            "cable_types": {"rope": rope},
            "vessels": {"ship": {"points": {"eye": [0, 0, 0]}, "position": [0.4 * length, 14, -5]}},
            "lines": {
                "main": {
                    "from": {"anchor": [0, 0, -10]}, "to": {"anchor": [0.85 * length, 0, -20]},
                    "items": [{"cable": {"type": "rope", "length": one}} for one in cables],
                },
                "side": {
                    "from": "ship.eye", "to": {"line": "main", "at": at},
                    "items": [{"cable": {"type": "rope", "length": 0.7 * length}}],
                },
            },
        }  # fmt: skip
        lines = cm.SystemModel(scene).lines
        return np.array([lines["main"].start_tension, lines["main"].end_tension,
                         lines["side"].start_tension])  # fmt: skip

    assert tensions(at) == pytest.approx(tensions(at + 0.01), rel=0.02)
