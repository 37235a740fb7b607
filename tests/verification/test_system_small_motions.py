"""Small motions of systems about a state, and starts that do not last."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh
from typer.testing import CliRunner

import cablemodel as cm
from benchmarks.random_systems import scene_of
from cablemodel.cli import app
from cablemodel.errors import OverturnedStartWarning, UnstableStartWarning
from cablemodel.solvers import library
from cablemodel.solvers.finite_element.linearisation import (
    free_motions,
    matrices,
    small_motions,
)
from cablemodel.solvers.finite_element.stability import slowest_growth
from cablemodel.systems import SystemModel
from cablemodel.systems.equilibrium import Equilibria
from tests.verification.test_system_clamps import cage, two_parallel_beams
from tests.verification.test_system_cycles import two_bars
from tests.verification.test_systems import G, hung_bar, in_vacuum, string

SCENES = Path(__file__).parents[2] / "scenes" / "systems"


def test_frequencies_of_a_bar_on_two_strings() -> None:
    """Swinging along and across as a pendulum, and turning; on strings without weight."""
    found = SystemModel(hung_bar()).natural_frequencies(4)
    turning = math.sqrt(20.0 * G * 0.6 * 0.6 / (3.0 * 5.0))
    swinging = math.sqrt(G / 5.0)
    # It rolls freely about its own axis, on which both strings are.
    assert found == pytest.approx([0.0, swinging, swinging, turning], rel=2e-3, abs=1e-3)


def body_on_a_string(height: float) -> dict:
    """A body that a string holds at a point, its centre of gravity so far above that [m]."""
    bar = {
        "mass": 20.0, "submerged_weight": 20.0 * G, "inertia": 3.0,
        "points": {"eye": [0, 0, -height]},
    }  # fmt: skip
    return in_vacuum(
        bodies={"bar": bar},
        lines={"one": {"from": {"anchor": [0, 0, 0]}, "to": "bar.eye", "items": string(5.0)}},
    )


def squares(height: float) -> np.ndarray:
    """Squares of the growths [1/s2] of string and body in a plane, by Lagrange's equations."""
    mass, length, inertia = 20.0, 5.0, 3.0
    inertias = [
        [mass * length**2, mass * length * height],
        [mass * length * height, mass * height**2 + inertia],
    ]
    return -eigh(np.diag([mass * G * length, -mass * G * height]), inertias, eigvals_only=True)


def test_a_body_that_stands_on_its_string_starts_hanging_and_is_warned_of() -> None:
    with pytest.warns(OverturnedStartWarning, match="bar starts turned by 180 degrees"):
        model = SystemModel(body_on_a_string(0.4))
    hanging = SystemModel(body_on_a_string(-0.4))
    found, expected = model.natural_frequencies(6), hanging.natural_frequencies(6)
    assert found == pytest.approx(expected, rel=1e-3, abs=1e-3)
    up = model.bodies["bar"].axes[:, 2]
    assert up == pytest.approx([0, 0, -1], abs=1e-6)
    assert model.bodies["bar"].position == pytest.approx([0, 0, -5.4], abs=1e-2)


def test_a_spar_that_is_top_heavy_starts_heeled_and_is_warned_of() -> None:
    """It falls to every side alike: two motions that grow at the same rate, and do not swing."""
    spar = {
        "mass": 6000.0, "inertia": [3e4, 3e4, 4e3], "centre_of_gravity": [0, 0, -1.0],
        "hull": {"diameter": 2.0, "height": 6.0}, "points": {"keel": [0, 0, -3.0]},
    }  # fmt: skip
    tether = {"diameter": 0.05, "mass": 2.0, "axial_stiffness": 4e5}
    with pytest.warns(OverturnedStartWarning, match="spar starts turned by 4. degrees") as told:
        model = SystemModel(
            {
                "cable_types": {"tether": tether},
                "bodies": {"spar": spar},
                "lines": {
                    "tether": {
                        "from": {"anchor": [0, 0, -60.0]}, "to": "spar.keel",
                        "items": [{"cable": {"type": "tether", "length": 55.0}}],
                    }
                },
            }
        )  # fmt: skip
    heel = np.arccos(model.bodies["spar"].axes[2, 2])
    assert [warning.message.angles for warning in told] == [{"spar": pytest.approx(heel)}]


@pytest.fixture
def falls_nowhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """Starts stay where they do not last."""
    monkeypatch.setattr(Equilibria, "_fallen", lambda *_arguments: None)


@pytest.mark.usefixtures("falls_nowhere")
def test_the_growth_of_a_body_that_stands_on_its_string() -> None:
    with pytest.warns(UnstableStartWarning, match="unstable equilibrium") as caught:
        SystemModel(body_on_a_string(0.4))
    (warning,) = (w.message for w in caught if isinstance(w.message, UnstableStartWarning))
    assert warning.rate == pytest.approx(math.sqrt(squares(0.4).max()), rel=1e-3)
    assert warning.frequency == 0.0
    assert warning.part in ("bar", "one")


def test_what_hangs_swings_as_two_pendulums() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", UnstableStartWarning)
        model = SystemModel(body_on_a_string(-0.4))
    found = model.natural_frequencies(6)
    for square in squares(-0.4):
        assert np.abs(found - math.sqrt(-square)).min() < 2e-3 * math.sqrt(-square)


def towed_wing(tail: float) -> dict:
    """A depressor below a ship; its wing is that far behind the centre of gravity [m]."""
    wing = {"area": 0.5, "position": [-tail, 0, 0], "deflection": -0.15}
    body = {
        "mass": 150.0, "submerged_weight": 1250.0, "inertia": [3.0, 3.0, 3.0],
        "added_mass": 25.0, "drag_area": [0.1, 0.2, 0.2], "drag_turning": 0.01,
        "points": {"eye": [0.15, 0, 0.2]}, "foils": {"wing": wing},
    }  # fmt: skip
    return {
        "environment": {"water_density": 1025.0},
        "cable_types": {"wire": {"diameter": 0.01, "mass": 0.4, "axial_stiffness": 4e6}},
        "vessels": {"ship": {"points": {"stern": [0, 0, 0]},
                             "velocity": [{"t": 0, "velocity": [2.0, 0, 0]}]}},
        "bodies": {"wing_body": body},
        "lines": {"tow": {"from": "ship.stern", "to": "wing_body.eye",
                          "items": [{"cable": {"type": "wire", "length": 60.0}}]}},
    }  # fmt: skip


def growth_in_the_run(scene: dict) -> float:
    """How fast the pitch of the wing's body leaves its start after a push [1/s]."""
    runs = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnstableStartWarning)
        for push in (0.0, 1e-3):
            model = SystemModel(scene | {"solver": {"tolerance": 1e-6}})
            seen = []
            for k in range(84):
                force = [0, 0, 0, 0, push, 0] if k < 4 else [0.0] * 6
                model.step(0.05, forces={"wing_body": force})
                seen.append(model.bodies["wing_body"].attitude[1])
            runs.append(seen)
    apart = np.abs(np.subtract(*runs))
    early, late = apart[16:50].max(), apart[50:].max()  # a period of the one that grows
    return float(np.log(late / early) / (34 * 0.05))


@pytest.mark.parametrize("tail", [-0.05, 0.1])
def test_a_wing_without_a_tail_swings_up(tail: float) -> None:
    """What the start says of growth is what a fine run does."""
    scene = towed_wing(tail)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", UnstableStartWarning)
        SystemModel(scene)
    grows = growth_in_the_run(scene)
    if tail > 0.0:
        assert not caught
        assert grows < 0.0
    else:
        (warning,) = (w.message for w in caught)
        assert isinstance(warning, UnstableStartWarning)
        assert grows == pytest.approx(warning.rate, rel=0.1)


def sped_up(speed: float) -> dict:
    """A depressor with its wing ahead of its weight, from 1 m/s to a speed within 6 s."""
    scene = towed_wing(0.0)
    scene["bodies"]["wing_body"] |= {
        "mass": 196.0, "submerged_weight": 1636.0, "inertia": 6.7, "added_mass": 29.0,
        "added_inertia": 1.35, "drag_area": [0.17, 0.34, 0.34], "drag_turning": 0.02,
        "centre_of_buoyancy": [0, 0, 0.1],
        "foils": {"wing": {"area": 0.7, "position": [0.05, 0, 0], "deflection": -0.18}},
    }  # fmt: skip
    scene["cable_types"]["wire"] |= {"diameter": 0.016, "mass": 0.28, "axial_stiffness": 1e6}
    rows = [(0.0, 1.0), (6.0, speed)]
    scene["vessels"]["ship"]["velocity"] = [{"t": t, "velocity": [v, 0, 0]} for t, v in rows]
    return scene


@pytest.mark.parametrize("speed", [2.5, 3.5])
def test_what_becomes_unstable_at_speed_is_warned_of(speed: float) -> None:
    """What the state of a run says of growth is what a push does to a fine run, or does not."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", UnstableStartWarning)
        model = SystemModel(sped_up(speed) | {"solver": {"error_estimate": True}})
        model.step_to(5.0)
        assert not caught
        kept = model.snapshot()
        for end in (6.0, 8.0):
            model.step_to(end)
    after = model.snapshot()
    model.restore(kept)
    for end in (6.0, 8.0):
        model.step_to(end)
    assert model.snapshot() == after  # looking changes nothing
    runs = []
    for push in (0.0, 1e-2):
        fine = SystemModel(sped_up(speed) | {"solver": {"tolerance": 1e-6}})
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnstableStartWarning)
            fine.step_to(6.0)
        seen = []
        for k in range(60):
            force = [0, 0, 0, 0, push if k < 4 else 0.0, 0]
            fine.step(0.05, forces={"wing_body": force})
            seen.append(fine.bodies["wing_body"].attitude[1])
        runs.append(seen)
    apart = np.abs(np.subtract(*runs))
    grows = math.log(apart[40:].max() / apart[:20].max()) / (40 * 0.05)
    if speed < 3.0:
        assert not caught
        assert grows < 0.0
        return
    (warning,) = (w.message for w in caught)
    assert isinstance(warning, UnstableStartWarning)
    assert "at t = 6 s is unstable" in str(warning)
    assert grows == pytest.approx(warning.rate, rel=0.4)


def side_by_side(count: int) -> SystemModel:
    """Lines below a ship without a tie to each other."""
    points = {f"p{k}": [0.0, float(k), 0.0] for k in range(count)}
    lines = {
        f"l{k}": {"from": f"ship.p{k}", "to": "free", "items": string(20.0)} for k in range(count)
    }
    return SystemModel(in_vacuum(vessels={"ship": {"points": points}}, lines=lines))


def test_what_looks_at_a_start_grows_as_the_system() -> None:
    """Not with its square: entries of the matrices are as many times more as there are lines."""
    counts = []
    for lines in (3, 12):
        block = side_by_side(lines).built.block
        counts.append([*(part.nnz for part in matrices(block)), free_motions(block)[0].nnz])
    assert counts[1] == [4 * entries for entries in counts[0]]


@pytest.mark.parametrize("speed", [1.25, 1.5, 1.75])
def test_a_depressor_starts_upright(speed: float) -> None:
    """At 1.5 m/s its relaxation tumbles and ends upside down, from where it falls; upright the wing
    pulls down."""
    scene = cm.load_system(SCENES / "depressor.yaml").to_dict()
    scene["vessels"]["ship"]["velocity"] = [speed, 0, 0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model = SystemModel(scene)
    scene["vessels"]["ship"]["velocity"] = [
        {"t": 0, "velocity": [2.0, 0, 0]},
        {"t": 30, "velocity": [speed, 0, 0]},
    ]
    slowed = SystemModel(scene)
    slowed.step(1200.0)
    tension = slowed.lines["wire"].start_tension
    assert model.lines["wire"].start_tension == pytest.approx(tension, rel=1e-3)
    assert model.bodies["depressor"].axes[2, 2] > 0.9


@pytest.mark.usefixtures("falls_nowhere")
def test_check_lists_it(tmp_path) -> None:
    import yaml

    path = tmp_path / "standing.yaml"
    path.write_text(yaml.safe_dump(body_on_a_string(0.4)))
    result = CliRunner().invoke(app, ["check", str(path)])
    assert result.exit_code == 0, result.output
    assert "unstable equilibrium" in result.output


def growing_by_kernel(model: SystemModel) -> tuple[int, int]:
    """What `count_growing` and `count_leaving` say of a system's state."""
    block = model.built.block
    kept, least = block.image.copy(), slowest_growth(block)
    held = library.count_growing(block.ints, block.reals, least)
    block.image[:] = kept
    work = np.zeros(library.count_leaving(block.ints, block.reals, least, np.zeros(1)))
    growing = library.count_leaving(block.ints, block.reals, least, work)
    block.image[:] = kept
    return held, growing


def growing_by_dense_matrices(model: SystemModel) -> tuple[int, int]:
    """Negative eigenvalues of the symmetric part of A at the slowest growth that matters, and how
    many of all motions' growths are above that."""
    block = model.built.block
    kept, least = block.image.copy(), slowest_growth(block)
    library.count_growing(block.ints, block.reals, least)  # which lifts what is pressed
    mass, damping, stiffness = small_motions(block)
    block.image[:] = kept
    a = stiffness + least * damping + least * least * mass
    rows = np.hstack([np.linalg.solve(mass, stiffness), np.linalg.solve(mass, damping)])
    count = len(mass)
    rates = np.linalg.eigvals(np.vstack([np.eye(2 * count)[count:], -rows]))
    return int(np.sum(np.linalg.eigvalsh(a + a.T) < 0.0)), int(np.sum(rates.real > least))


def longer(scene: dict, factor: float) -> dict:
    """The scene, whose lines are made so many times as long."""
    for line in scene["lines"].values():
        for item in line["items"]:
            if item.get("cable"):
                item["cable"]["length"] *= factor
    return scene


def all_lines(name: str, factor: float) -> dict:
    """A ready scene whose lines are so many times as long."""
    return longer(cm.load_system(SCENES / f"{name}.yaml").to_dict(), factor)


@pytest.mark.parametrize(
    ("source", "growing"),
    [
        (body_on_a_string(0.4), 2),
        (body_on_a_string(-0.4), 0),
        (towed_wing(-0.05), 2),
        (towed_wing(0.1), 0),
        *((all_lines("otter_boards", factor), grows) for factor, grows in ((1.1, 0), (1.2, 4))),
        *((all_lines("streamer", factor), 0) for factor in (0.8, 1.0, 1.1, 1.3)),
        (all_lines("depressor", 1.0), 0),
        (all_lines("array_from_its_drum", 1.0), 0),
        (all_lines("anchor_last", 1.0), 0),
    ],
)
@pytest.mark.usefixtures("falls_nowhere")
@pytest.mark.filterwarnings("ignore::cablemodel.errors.UnstableStartWarning")
def test_the_kernels_count_what_grows_as_dense_matrices_do(source, growing) -> None:
    model = SystemModel(source)
    found = growing_by_kernel(model)
    assert found == growing_by_dense_matrices(model)
    assert found[1] == growing


def test_a_system_with_a_cycle_and_clamps_is_counted_through_its_closures() -> None:
    """As if its ends had never been free: motions that leave the gaps closed."""
    for source in (two_bars(), two_parallel_beams(4), cage()):
        model = SystemModel(source)
        assert model.built.block.header.closure_count > 0
        assert growing_by_kernel(model) == growing_by_dense_matrices(model)


def test_a_wing_that_swings_up_fast_on_a_long_line_is_warned_of() -> None:
    """With a branch: motions of the undamped system alone did not lead to it."""
    scene = longer(scene_of(18)[0], 1.4)
    scene.pop("cuts")
    with pytest.warns(UnstableStartWarning) as caught:
        model = SystemModel(scene)
    (warning,) = (w.message for w in caught if isinstance(w.message, UnstableStartWarning))
    assert growing_by_kernel(model)[1] == growing_by_dense_matrices(model)[1] == 2
    assert warning.rate == pytest.approx(1.73, rel=0.01)
    assert warning.frequency == pytest.approx(4.57, rel=0.01)
