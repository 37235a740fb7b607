"""Lines that are cut, let go or break."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import trapezoid

import cablemodel as cm
from cablemodel.systems import SystemModel
from tests.verification.test_system_moorings import buoy_on_three_legs

MASS, STIFFNESS = 0.5, 1e6
G = 9.81


def wire(**more: Any) -> dict[str, Any]:
    kind = {"diameter": 0.01, "mass": MASS, "axial_stiffness": STIFFNESS, **more}
    return {"environment": {"water_density": 0.0, "gravity": G}, "cable_types": {"wire": kind}}


def cable(length: float, **more: Any) -> dict[str, Any]:
    return {"cable": {"type": "wire", "length": length, **more}}


def hanging(**cut: Any) -> dict[str, Any]:
    """A body of 200 kg on 20 m of wire below a vessel."""
    return {
        **wire(),
        "vessels": {"ship": {"points": {"hook": [0, 0, 0]}}},
        "bodies": {
            "load": {
                "mass": 200.0, "submerged_weight": 200.0 * G, "inertia": 50.0,
                "points": {"eye": [0, 0, 0.5]},
            }
        },
        "lines": {"wire": {"from": "ship.hook", "to": "load.eye", "items": [cable(20.0)]}},
        "cuts": {"knife": {"line": "wire", **cut}},
    }  # fmt: skip


@pytest.mark.parametrize("at", ["start", 7.0, "end"])
def test_what_is_cut_off_falls(at: Any) -> None:
    """Weight is all that acts below the cut: the momentum is that of free fall."""
    model = SystemModel(hanging(at=at, time=1.0))
    model.step(1.0)
    assert model.cuts == {"knife": 1.0} or model.cuts == {"knife": None}
    model.step(1e-9)
    assert model.cuts["knife"] == 1.0
    model.step(1.0 - 1e-9)
    falls = {"start": 20.0, 7.0: 13.0, "end": 0.0}[at]
    fallen = 200.0 * model.bodies["load"].velocity[2]
    if falls:
        s = np.linspace(20.0 - falls + 1e-9, 20.0, 2001)
        fallen += MASS * trapezoid(model.lines["wire"].sample(s).velocity[:, 2], s)
    assert fallen == pytest.approx(-G * (200.0 + MASS * falls), rel=2e-3)
    hangs = 0.0 if at == "start" else model.wrenches["ship"][2]
    assert abs(hangs) < 200.0 * G
    if at == "start":
        assert np.abs(model.wrenches["ship"]).max() < 1e-6


def test_a_cut_sends_the_wave_of_its_tension(tmp_path: Path) -> None:
    """A taut string without weight, cut at one end: behind the front it moves at T / sqrt(EA m)."""
    scene = {
        **wire(),
        "lines": {
            "string": {
                "from": {"anchor": [0, 0, 0]},
                "to": {"anchor": [101.0, 0, 0]},
                "items": [cable(100.0, elements=100)],
            }
        },
        "cuts": {"knife": {"line": "string", "at": "end"}},
    }
    scene["environment"]["gravity"] = 1e-6
    model = SystemModel(scene)
    tension = model.lines["string"].start_tension
    assert tension == pytest.approx(0.01 * STIFFNESS, rel=1e-3)
    front = 40.0 / math.sqrt(STIFFNESS / MASS)  # it has come 40 m
    model.step(front, cuts=["knife"])
    speed = tension / math.sqrt(STIFFNESS * MASS)
    state = model.lines["string"].sample(np.linspace(70.0, 99.0, 59))
    assert state.velocity[:, 0].mean() == pytest.approx(-speed, rel=0.02)
    ahead = model.lines["string"].sample(np.linspace(0.0, 50.0, 51))
    assert np.abs(ahead.velocity[:, 0]).max() < 0.05 * speed
    assert ahead.tension.mean() == pytest.approx(tension, rel=0.01)


def test_steps_do_not_try_to_follow_what_a_material_ends() -> None:
    """A buoy loses one of three legs: what is cut off is slack, and the others ring."""
    scene = buoy_on_three_legs(0.3)
    scene["cuts"] = {"breaks": {"line": "a", "at": "end", "time": 0.5}}
    model = SystemModel(scene)
    model.step_to(0.5)
    before = model.statistics
    model.step_to(2.5)
    taken, refused = (model.statistics[word] - before[word] for word in ("steps", "rejected"))
    assert model.lines["a"].tension_range[0] < -1e3
    longest = 0.1 * 0.005 * math.sqrt(280.0 / G)  # tensions of longer steps are looked at
    assert taken + refused < 1.1 * 2.0 / longest


def test_a_line_breaks_above_its_strength() -> None:
    """The load is pulled down ever harder: it breaks when weight and pull come to the strength."""
    weight = G * (200.0 + 20.0 * MASS)
    model = SystemModel(hanging(at="start", tension=weight + 500.0))
    reached = None
    for k in range(1, 21):  # 50 N more each second, from one second's end to the next
        model.step(1.0, forces={"load": [0, 0, -50.0 * k, 0, 0, 0]})
        reached = model.cuts["knife"]
        if reached is not None:
            break
    assert reached == pytest.approx(10.0, abs=0.2)  # the load's own ring is 8 N at most


def test_a_branch_and_a_body_come_off() -> None:
    """Every kind of end can be let go: of a branch, at a body's point, at an anchor."""
    scene = hanging(at="end")
    scene["bodies"]["load"]["points"]["ring"] = [0, 0, -0.5]
    scene["lines"]["tail"] = {"from": "load.ring", "to": "free", "items": [cable(5.0)]}
    scene["lines"]["branch"] = {
        "from": {"line": "wire", "at": 8.0}, "to": {"anchor": [3.0, 0, -8.0]},
        "items": [cable(4.0)],
    }  # fmt: skip
    scene["cuts"] |= {
        "tail_off": {"line": "tail", "at": "start"},
        "branch_off": {"line": "branch", "at": "start"},
        "anchor_off": {"line": "branch", "at": "end"},
    }
    model = SystemModel(scene)
    model.step(0.2)
    masses = {"tail": 5.0 * MASS, "branch": 4.0 * MASS}
    for name, line in (("tail_off", "tail"), ("branch_off", "branch"), ("anchor_off", "branch")):
        model.step(0.05, cuts=[name])
        assert model.cuts[name] == pytest.approx(model.time - 0.05)
        assert len(model.lines[line].sample().s) > 1
    before = {name: model.lines[name].sample().velocity[:, 2].mean() for name in masses}
    model.step(0.5)
    for name in masses:
        fallen = model.lines[name].sample().velocity[:, 2].mean() - before[name]
        assert fallen == pytest.approx(-0.5 * G, rel=0.03), name
    top = model.lines["wire"].start_tension
    assert top == pytest.approx(G * (200.0 + 20.0 * MASS), rel=0.1)
    model.step(0.3, cuts=["knife"])
    assert model.bodies["load"].velocity[2] == pytest.approx(-0.3 * G, rel=0.05)


def test_a_cut_is_logged_replayed_and_remembered(tmp_path: Path) -> None:
    scene = cm.load_system({**hanging(at=7.0), "run": {"duration": 2.0, "output_interval": 0.1}})
    log = tmp_path / "cut.mcap"
    model = SystemModel(scene)
    with cm.SystemRecorder(model, log) as recorder:
        for k in range(20):
            recorder.step(0.1, cuts=["knife"] if k == 8 else [])
            if k == 10:
                snapshot, state = model.snapshot(), model.bodies["load"].position.copy()
    run = cm.open_run(log)
    assert run["knife.time"][-1] == pytest.approx(0.8)
    assert np.isnan(run["knife.time"][8])
    from cablemodel.results.replay import replay

    assert replay(run).exact
    other = SystemModel(scene)
    other.restore(snapshot)
    assert np.array_equal(other.bodies["load"].position, state)
    for _ in range(9):
        other.step(0.1)
    for name, value in model.outputs().items():
        assert np.array_equal(other.outputs()[name], value, equal_nan=True), name


@pytest.mark.parametrize(
    ("cut", "message"),
    [
        ({"line": "wrie", "at": 1.0}, r"cuts\.knife\.line.*'wrie' is not one of the lines.*wire"),
        ({"line": "wire", "at": 25.0}, r"cuts\.knife\.at.*20 m long.*below 20 m"),
        ({"line": "wire", "at": "middle"}, r"cuts\.knife\.at"),
    ],
)
def test_wrong_cuts_are_named(cut: dict[str, Any], message: str) -> None:
    scene = hanging(at=1.0)
    scene["cuts"]["knife"] = cut
    with pytest.raises(cm.SceneError, match=message):
        cm.load_system(scene)


def test_an_unknown_cut_is_refused_and_nothing_changes() -> None:
    model = SystemModel(hanging(at=1.0))
    before = model.snapshot()
    with pytest.raises(cm.StepError, match=r"cuts is 'saw'.*knife"):
        model.step(0.1, cuts=["saw"])
    assert model.snapshot() == before


def test_a_short_strop_recoils_beside_a_long_mooring() -> None:
    """An anchor is let go at the end of a strop of 6 m, which recoils from 13 kN and folds: that
    takes steps as short as it is itself, not as the mooring of 205 m. Meanwhile the anchor falls by
    (m + m') dv/dt = W - rho CdA v^2 / 2, v = V tanh(W t / ((m + m') V))."""
    mass, added, weight, area = 1500.0, 600.0, 12.8e3, 1.067
    kinds = {
        "rope": {"diameter": 0.02, "mass": 0.25, "submerged_weight": -0.1, "axial_stiffness": 1e6},
        "chain": {"diameter": 0.036, "mass": 7.9, "submerged_weight": 67, "axial_stiffness": 32e6},
    }
    model = SystemModel({
        "environment": {"floor": {"z": -250, "friction": 0.5}},
        "cable_types": {name: {**kind, "drag_normal": 1.2} for name, kind in kinds.items()},
        "vessels": {"ship": {"points": {"stern": [0, 0, -1]}, "velocity": [0.8, 0, 0]}},
        "bodies": {
            "float": {
                "mass": 400.0, "hull": {"diameter": 1.2}, "inertia": 50.0, "added_mass": 300.0,
                "drag_area": 0.6, "drag_turning": 0.1, "points": {"eye": [0, 0, -0.6]},
            },
            "anchor": {
                "mass": mass, "submerged_weight": weight, "inertia": 213.0, "added_mass": added,
                "drag_area": area, "drag_turning": 0.6,
                "points": {"eye": [0, 0, 0.4], "hook": [0, 0, 0.5]},
            },
        },
        "lines": {
            "mooring": {
                "from": "anchor.eye", "to": "float.eye",
                "items": [
                    {"cable": {"type": "chain", "length": 5}},
                    {"cable": {"type": "rope", "length": 200}},
                ],
            },
            "strop": {
                "from": "ship.stern", "to": "anchor.hook",
                "items": [{"cable": {"type": "rope", "length": 6}}],
            },
        },
        "cuts": {"go": {"line": "strop", "at": "end", "time": 2.0}},
        "solver": {"tolerance": 1e-4},
    })  # fmt: skip
    model.step_to(2.0)
    model.step_to(4.0)
    final = math.sqrt(2.0 * weight / (1025.0 * area))
    expected = final * math.tanh(weight * 2.0 / ((mass + added) * final))
    assert -model.bodies["anchor"].velocity[2] == pytest.approx(expected, rel=0.01)


def test_the_mesh_follows_a_tow_that_parts_and_folds_above_its_body() -> None:
    """WHOI Cable's example breaking.cbl: the upper end is 362.0 m deep 100 s later, on shorter
    elements, as on masses between springs; on 60 elements it is 40 to 100 m higher."""
    kind = {
        "diameter": 0.0131, "mass": 0.3, "submerged_weight": 2.0, "axial_stiffness": 1.5e6,
        "bending_stiffness": 10.0, "drag_normal": 1.0, "drag_tangential": 0.005,
    }  # fmt: skip
    body = {
        "mass": 500.0, "submerged_weight": 500.0, "added_mass": 261.8, "added_mass_axial": 261.8,
        "drag_area": 0.7854, "drag_coefficient": 2.0,
    }  # fmt: skip
    items = [{"cable": {"type": "tow", "length": 1000.0}}, {"body": body}]
    model = SystemModel(
        {
            "environment": {"gravity": 10.0, "water_density": 1000.0},
            "cable_types": {"tow": kind},
            "vessels": {"ship": {"points": {"stern": [0, 0, 0]}, "velocity": [0.5, 0, 0]}},
            "lines": {"tow": {"from": "ship.stern", "to": "free", "items": items}},
            "cuts": {"part": {"line": "tow", "at": "start", "time": 100.0}},
        }
    )
    model.step_to(200.0)
    assert model.lines["tow"].sample([0.0]).position[0, 2] == pytest.approx(-362.0, abs=1.0)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_an_output_at_the_time_of_a_cut_is_of_the_state_before_it(tolerance: float) -> None:
    """The wave needs 24 ms to the nearer end: the tensions read were up to 17 % off there."""
    rope = {"diameter": 0.02, "mass": 2.0, "axial_stiffness": 3e6, "axial_damping": 3e4}
    ends = {"from": {"anchor": [0, 0, 50]}, "to": {"anchor": [100, 0, 62]}}
    scene = {
        "environment": {"water_density": 0.0},
        "cable_types": {"rope": rope},
        "lines": {"rope": {**ends, "items": [{"cable": {"type": "rope", "length": 105.0}}]}},
        "cuts": {"knife": {"line": "rope", "at": 30.0, "time": 2.0}},
        "solver": {"tolerance": tolerance},
    }
    model = cm.SystemModel(scene)

    def tensions() -> list[float]:
        line = model.lines["rope"]
        return [line.start_tension, line.end_tension, *line.tension_range]

    model.step_to(1.9)
    before = tensions()
    model.step_to(2.0)
    assert tensions() == pytest.approx(before, rel=0.1 * tolerance)
    assert model.cuts == {"knife": None}
    model.step_to(2.5)
    assert model.cuts == {"knife": 2.0}
    assert tensions()[-1] < 0.9 * before[-1]
