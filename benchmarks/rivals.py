"""The peers that take part, scene by scene, with the settings that are tried for each.

A peer's curve is the cheapest of its settings at each error (``compare.front``). Settings are those
that its documentation recommends and a grid around them, up to about a minute a run.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Any

from benchmarks.measure import Contestant, Runner
from benchmarks.scenes import BenchmarkScene

# Cost grows with the square of the segments: stop where one run takes about a minute.
MOORDYN_SEGMENTS = {
    "S1": (10, 20, 40, 80, 120),
    "S2w": (10, 20, 40, 80, 160),
    "S2a": (10, 20, 40, 80, 160, 320),
    "S2v": (10, 20, 40, 80, 160),
    "S4": (10, 20, 40, 80, 120),
    "J": (10, 20, 40, 80),
    "JW": (10, 20, 40, 80),
}
MOORDYN_CURVES = (
    # The setting that the project's targets are stated against, and the cheapest stable one
    # that a search over schemes, steps and damping found (see docs/benchmarks.md).
    ("MoorDyn RK4, BA=0", "RK4", 2.7, 0.0),
    ("MoorDyn RK2, zeta=0.6", "RK2", 2.0, 0.6),
)


def moordyn_contestants(scene: str, quick: bool = False) -> list[Contestant]:
    """MoorDyn: one curve per scheme, one point per number of segments."""
    from benchmarks.peers.moordyn import MoorDynRunner, Settings

    return [
        _contestant(name, f"N={segments}", MoorDynRunner, Settings(segments, scheme, *rest))
        for name, scheme, *rest in MOORDYN_CURVES
        for segments in MOORDYN_SEGMENTS.get(scene, ())
        if segments == 20 or not quick
    ]


def cabledyn_contestants(scene: str, quick: bool = False) -> list[Contestant]:
    """CableDyn: elements, time step, damping, and Newton's tolerance with the tangent reused.

    S1's free end needs short steps (its point is stepped apart from the line); on the jumper its
    own default of damping and others were tried.
    """
    from benchmarks.peers.cabledyn import CableDynRunner, Settings

    grids: dict[str, tuple[Sequence[int], Sequence[float]]] = {
        "S1": ((10, 20, 40, 80), (0.02, 0.01, 0.005, 0.0025)),
        # Steps are whole parts of the 3 s between instants.
        "J": ((6, 10, 20, 40), (0.5, 0.25, 0.2, 0.1, 0.05)),
    }
    if scene not in grids:
        return []
    counts, steps = grids[scene]
    if quick:
        counts, steps = counts[1:2], steps[1:2]
    radii = (0.4, 0.8) if scene == "J" else (0.4,)
    return [
        _contestant(
            "CableDyn",
            f"N={n} dt={dt:g} rho={rho:g}",
            CableDynRunner,
            Settings(n, dt, rho, True, 1e-6),
        )
        for n, dt, rho in itertools.product(counts, steps, radii)
    ]


def exudyn_contestants(scene: str, quick: bool = False) -> list[Contestant]:
    """Exudyn: elements, time step, damping or the trapezoidal rule, order of integration."""
    from benchmarks.peers.exudyn import ExudynRunner, Settings

    if scene != "S2v":
        return []
    counts = (8,) if quick else (6, 8, 12, 16, 24, 32)
    return [
        _contestant(
            "Exudyn ANCF",
            f"N={n} dt={dt:g} rho={rho} {'reduced' if reduced else 'full'}",
            ExudynRunner,
            Settings(n, dt, rho, reduced),
        )
        for n in counts
        for dt, rho, reduced in (
            (0.0125, 0.6, True),
            (0.005, 0.6, True),
            (0.0025, 0.6, True),
            (0.005, 0.9, True),
            (0.005, None, True),
            (0.005, 0.6, False),
        )
    ]


def mujoco_contestants(scene: str, quick: bool = False) -> list[Contestant]:
    """MuJoCo: rods, time step and integrator."""
    from benchmarks.peers.mujoco import MuJoCoRunner, Settings

    if scene != "S2v":
        return []
    counts = (20,) if quick else (10, 20, 40, 80)
    return [
        _contestant(
            "MuJoCo chain", f"N={n} dt={dt:g} {scheme}", MuJoCoRunner, Settings(n, dt, scheme)
        )
        for n in counts
        for dt, scheme in (
            (0.01, "RK4"),
            (0.005, "RK4"),
            (0.0025, "RK4"),
            (0.0005, "implicitfast"),
        )
    ]


def newton_contestants(scene: str, quick: bool = False) -> list[Contestant]:
    """Newton: capsules, time step and sweeps.

    Shorter steps and more sweeps err by more, by single precision; without fast arithmetic, with
    the older penalty scheme, or without what is kept of the step before, errors were the same.
    """
    from benchmarks.peers.newton import NewtonRunner, Settings

    if scene != "S2v":
        return []
    counts = (20,) if quick else (6, 10, 20, 40)
    return [
        _contestant("Newton VBD", f"N={n} dt={dt:g} sweeps={k}", NewtonRunner, Settings(n, dt, k))
        for n in counts
        for dt, k in (
            (0.005, 10),
            (0.0025, 5),
            (0.0025, 10),
            (0.0025, 40),
            (0.00125, 5),
            (0.00125, 10),
            (0.00125, 40),
            (0.00025, 40),
        )
    ]


def _contestant(
    name: str,
    setting: str,
    runner: Callable[[BenchmarkScene, Sequence[float], Any], Runner],
    settings: Any,
) -> Contestant:
    def make(scene: BenchmarkScene, times: Sequence[float]) -> Runner:
        return runner(scene, times, settings)

    return Contestant(name, setting, make, "prototype")


PEERS: dict[str, Callable[[str, bool], list[Contestant]]] = {
    "moordyn": moordyn_contestants,
    "cabledyn": cabledyn_contestants,
    "exudyn": exudyn_contestants,
    "mujoco": mujoco_contestants,
    "newton": newton_contestants,
}
"""Contestants of each peer by scene; the second argument asks for few."""
