"""Stress scenes of the finite elements: snaps, slack, reel-in, impacts, long lays, directions.

Each scene says what must hold and measures it; a row of the table is its outcome. A scene that
raises has failed, whatever the error. ``python -m benchmarks.stress_scenes`` writes
``docs/stress/scenes.csv``, and its summary into ``docs/stress.md``; ``tests/stress`` runs the
quick ones.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.sections import read_rows, write_part, write_rows

CABLE_K: dict[str, float] = {
    "diameter": 0.01666, "mass": 0.4613, "submerged_weight": 2.33333, "axial_stiffness": 1e6,
    "bending_stiffness": 0.1, "drag_normal": 1.0, "drag_tangential": 0.1586, "added_mass": 1.0,
}  # fmt: skip
ARMOURED: dict[str, float] = {
    "diameter": 0.03, "mass": 2.26, "submerged_weight": 15.0, "axial_stiffness": 3e7,
    "bending_stiffness": 300.0, "drag_normal": 1.2, "drag_tangential": 0.01, "added_mass": 1.0,
}  # fmt: skip


@dataclass(frozen=True)
class Outcome:
    """What came out of a scene: measured numbers in words, and whether what must hold does."""

    scene: str
    holds: bool
    measured: str
    simulated: float
    cpu: float


@dataclass(frozen=True)
class StressScene:
    """A scene: its name, what must hold, a function that runs it, whether it is quick."""

    name: str
    must_hold: str
    run: Callable[[], tuple[bool, str, float]]
    quick: bool = True


def scene(line: list[dict[str, Any]], kind: dict[str, float] | None = None, **parts: Any) -> Any:
    """A scene of cable K (or another one) with the given parts."""
    import cablemodel as cm

    parts.setdefault("solver", {"tolerance": 1e-3})
    return cm.load_scene({"cable_types": {"K": kind or CABLE_K}, "line": line, **parts})


def cable(length: float, model: str = "elastica") -> dict[str, Any]:
    """An item of a line."""
    return {"cable": {"type": "K", "length": length, "model": model}}


def sudden_stop() -> tuple[bool, str, float]:
    """Towing at 3 m/s, the vessel slows down by 1 m/s within a millisecond, and stops a moment
    later: a front that leaves the line taut, slack, recovery."""
    import cablemodel as cm

    line = cable(30.0)
    line["cable"]["elements"] = 64  # a front of a millisecond is 1.5 m long
    model = cm.CableModel(scene([line], vessel={"velocity": velocity_rows((3.0, 0, 0))}))
    before, tangent = model.top_tension, model.sample([0.0]).tangent[0]
    model.step(1e-3, vessel_velocity=(2.0, 0.0, 0.0))
    front = -1.0 * abs(tangent[0]) * math.sqrt(1e6 * 0.4613)
    # The velocity falls over the step: what the top feels then is the whole front.
    drop = model.top_tension - before
    for _ in range(240):
        model.step(0.5, vessel_velocity=(0.0, 0.0, 0.0))
    hanging = abs(model.tip_position[2] - model.vessel_position[2] + 30.0)
    holds = abs(drop / front - 1.0) < 0.05 and hanging < 0.5
    measured = f"front {drop:.0f} N of {front:.0f} N, tip {hanging:.3f} m above rest after 120 s"
    return holds, measured, model.time


def velocity_rows(velocity: tuple[float, float, float]) -> list[dict[str, Any]]:
    """A velocity table that holds one value."""
    return [{"t": 0, "velocity": list(velocity)}]


def heave_snap() -> tuple[bool, str, float]:
    """1135 kg on 300 m of rope, heaved 2 m in 6 s: slack and snap every cycle, none grows."""
    import cablemodel as cm

    rope = {**CABLE_K, "diameter": 0.02, "mass": 0.3, "submerged_weight": 1.0,
            "axial_stiffness": 2e6, "bending_stiffness": 1.0}  # fmt: skip
    body = {"mass": 1135, "submerged_weight": 2500, "added_mass": 500, "added_mass_axial": 500,
            "drag_area": 1.0, "drag_coefficient": 1.2, "drag_area_axial": 1.0,
            "drag_coefficient_axial": 1.2}  # fmt: skip
    omega, times = 2.0 * math.pi / 6.0, np.arange(0.0, 120.01, 0.1)
    heave = 2.0 * omega * np.sin(omega * times) * np.minimum(times / 12.0, 1.0)
    rows = [
        {"t": float(t), "velocity": [0, 0, float(v)]} for t, v in zip(times, heave, strict=True)
    ]
    model = cm.CableModel(
        scene(
            [cable(300.0), {"body": body}],
            rope,
            vessel={"velocity": rows, "interpolation": "cubic"},
        )
    )
    peaks, lowest = [], math.inf
    for cycle in range(20):
        tensions = []
        for k in range(60):
            model.step_to(6.0 * cycle + 0.1 * (k + 1))
            tensions.append(model.top_tension)
        peaks.append(max(tensions))
        lowest = min(lowest, *tensions)
    late = peaks[10:]
    holds = max(late) < 1.5 * float(np.median(late))
    measured = f"peaks {min(late):.0f} to {max(late):.0f} N over ten cycles, lowest {lowest:.0f} N"
    return holds, measured, model.time


def reel_in() -> tuple[bool, str, float]:
    """100 m reeled in to the shortest length, 1 m: lengths exact, the tension of what hangs."""
    import cablemodel as cm

    model = cm.CableModel(
        scene([cable(100.0)], payout={"rate": [{"t": 0, "rate": 0}, {"t": 5, "rate": -0.5}]})
    )
    total = model.line_length + model.drum_length
    worst = 0.0
    while model.line_length > 2.0 + 1e-9:
        model.step(min(1.0, (model.line_length - 2.0) / 0.5 + 1e-9))
        worst = max(worst, abs(model.line_length + model.drum_length - total))
        if model.time > 300.0:
            break
    model.step(30.0, payout_rate=0.0)
    model.step(60.0, payout_rate=0.0)
    weight = model.line_length * CABLE_K["submerged_weight"]
    holds = worst < 1e-9 and abs(model.top_tension / weight - 1.0) < 0.01
    measured = (
        f"{model.line_length:.3f} m left, lengths to {worst:.0e} m, tension {model.top_tension:.3f}"
        f" N of {weight:.3f} N"
    )
    return holds, measured, model.time


def strike() -> tuple[bool, str, float]:
    """A body of 50 N is lowered onto the floor at 0.7 m/s, strikes it and lies there."""
    import cablemodel as cm

    body = {"mass": 20, "submerged_weight": 50, "added_mass": 5, "added_mass_axial": 5,
            "drag_area": 0.05, "drag_coefficient": 1.0, "drag_area_axial": 0.05,
            "drag_coefficient_axial": 1.0}  # fmt: skip
    model = cm.CableModel(
        scene(
            [cable(20.0), {"body": body}],
            environment={"floor": {"z": -25, "friction": 0.5}},
            payout={
                "rate": [
                    {"t": 0, "rate": 0},
                    {"t": 1, "rate": 0.7},
                    {"t": 7.5, "rate": 0.7},
                    {"t": 8, "rate": 0},
                ],
                "drum": [cable(20.0)],
            },
        )
    )
    deepest, highest = 0.0, 0.0
    # A body that stops dead sends a front up the cable, which doubles at the tow point.
    front = 0.7 * math.sqrt(1e6 * 0.4613)
    for _ in range(600):
        model.step(0.05)
        deepest = min(deepest, model.bodies[0].position[2] + 25.0)
        highest = max(highest, model.tension_max)
    hanging = model.line_length - model.floor_length
    carried = model.floor_force[2] + model.top_force[2] * -1.0
    weight = 50.0 + model.line_length * CABLE_K["submerged_weight"]
    holds = deepest > -0.25 * 1e-3 * 20.0 and abs(carried / weight - 1.0) < 0.01
    holds = holds and highest < 2.0 * front + weight
    measured = (
        f"deepest {-deepest * 1e3:.1f} mm, floor and vessel carry {carried:.2f} N of {weight:.2f} "
        f"N, {hanging:.2f} m hang, highest tension {highest:.0f} N (a front: {front:.0f} N)"
    )
    return holds, measured, model.time


LAY_SPEED = 1.0
"""Of vessel and winch in the long lay [m/s]."""


def long_lay_scene(laid: float, element: float | None = None) -> Any:
    """A steady lay in 3,000 m of water, with that much on the drum [m].

    element: length of the elements that it is paid out in [m]. The line begins on a mesh of its
    own: it comes down with hardly any tension, and 25 m do not resolve how it bends there.
    """
    drum = cable(laid, "hybrid")
    if element is not None:
        drum["cable"]["elements"] = round(laid / element)

    return scene(
        [cable(5000.0, "hybrid")],
        ARMOURED,
        environment={"floor": {"z": -3000, "friction": 0.4}},
        vessel={"velocity": velocity_rows((LAY_SPEED, 0, 0))},
        payout={"rate": [{"t": 0, "rate": LAY_SPEED}], "drum": [drum]},
    )


def long_lay(laid: float) -> tuple[bool, str, float]:
    """A lay in 3,000 m of water until `laid` metres lie: the lay law's tension, work linear."""
    import cablemodel as cm

    speed = LAY_SPEED
    model = cm.CableModel(long_lay_scene(laid))
    law = lay_law(speed, speed, 3000.0)
    tensions = []
    while model.time < laid / speed - 1000.0:
        model.step(20.0)
        tensions.append(model.top_tension)
    late = np.array(tensions[len(tensions) // 2 :])
    worst = float(np.max(np.abs(late / law - 1.0)))
    steps = model.statistics["steps"]
    return (
        worst < 0.01,
        f"top tension within {100 * worst:.2f} % of the lay law's {law:.0f} N, "
        f"{model.floor_length:.0f} m lie, {model.statistics['elements']} elements, {steps} steps",
        model.time,
    )


Ridges = tuple[tuple[float, float], ...]
"""Waves of a sea floor that add up: steepest slope and distance of the crests [m] of each."""


def rough_lay_scene(ridges: Ridges, laid: float, bending: float = 300.0) -> Any:
    """The lay of :func:`long_lay_scene` over ridges, by a cable of that stiffness [N m2]."""
    import cablemodel as cm

    apart = min(wavelength for _, wavelength in ridges) / 16.0
    places = np.arange(-5000.0, 2000.0 + laid, apart)
    heights = np.full(len(places), -3000.0)
    for number, (slope, wavelength) in enumerate(ridges):
        wave = 2.0 * math.pi / wavelength
        heights += slope / wave * np.sin(wave * places + 1.0 + 2.0 * number)
    table = [{"x": float(x), "z": float(z)} for x, z in zip(places, heights, strict=True)]
    parts = long_lay_scene(laid).to_dict()
    parts["environment"]["floor"] = {"depth_table": table, "friction": 0.4}
    parts["cable_types"]["K"]["bending_stiffness"] = bending
    return cm.load_scene(parts)


def depth_below(model: Any, scene: Any) -> float:
    """How far the deepest cable lies below the scene's depth table, by SciPy's PCHIP [m]."""
    from scipy.interpolate import PchipInterpolator

    floor = scene.environment.floor
    height = PchipInterpolator(floor.grid_x, floor.grid_z[:, 0])
    places = model.sample(np.linspace(0.0, model.line_length, 20001)).position
    return float(np.max(height(places[:, 0]) - places[:, 2]))


def rough_lays(
    floors: tuple[Ridges, ...], laid: float, bending: float = 300.0
) -> Callable[[], tuple[bool, str, float]]:
    """Lays over these floors until the drum is empty, asleep and awake."""

    def run() -> tuple[bool, str, float]:
        import cablemodel as cm

        apart, deepest, awake, simulated = 0.0, 0.0, 0, 0.0
        for ridges in floors:
            scene = rough_lay_scene(ridges, laid, bending)
            tensions = []
            for sleep in (True, False):
                model = cm.CableModel(scene, sleep=sleep)
                tensions.append([])
                while model.time < laid / LAY_SPEED:
                    model.step(20.0)
                    tensions[-1].append(model.top_tension)
                deepest = max(deepest, depth_below(model, scene))
                simulated += model.time
                awake = max(awake, int(model.statistics["elements"]))
            asleep, whole = np.array(tensions)
            apart = max(apart, float(np.max(np.abs(asleep / whole - 1.0))))
        accuracy = 1e-3 * 5000.0
        names = [" and ".join(f"{100 * s:g} % {w:g} m" for s, w in ridges) for ridges in floors]
        measured = (
            f"slopes and crests {', '.join(names)}: top tension asleep within "
            f"{100 * apart:.2f} % of awake, {deepest / accuracy:.3f} tau L deep, up to {awake} "
            "elements"
        )
        return apart < 0.01 and deepest < 0.25 * accuracy, measured, simulated

    return run


def lay_law(speed: float, payout: float, depth: float) -> float:
    """Top tension of a steady lay without bottom tension (Zajac 1957) [N]."""
    kind = ARMOURED
    normal = 0.5 * 1025.0 * kind["drag_normal"] * kind["diameter"] * speed**2
    ratio = normal / kind["submerged_weight"]
    cosine = 2.0 * ratio / (1.0 + math.sqrt(1.0 + 4.0 * ratio**2))
    slip = payout - speed * cosine
    drag = 0.5 * 1025.0 * kind["drag_tangential"] * math.pi * kind["diameter"] * slip * abs(slip)
    return depth * (kind["submerged_weight"] - drag / math.sqrt(1.0 - cosine**2))


def mirror() -> tuple[bool, str, float]:
    """Reversal and a turn of 3 m radius to port and to starboard: mirror images to 1e-10."""
    import cablemodel as cm

    runs = []
    for sign in (1, -1):
        path = [
            {"straight": {"duration": 5, "speed": 1.0}},
            {"turn": {"angle": f"{180 * sign} deg", "radius": 3, "speed": 1.0}},
            {"straight": {"duration": 60, "speed": 1.0}},
        ]
        model = cm.CableModel(scene([cable(30.0)], vessel={"path": path}))
        places = []
        for k in range(60):
            model.step_to(1.0 * (k + 1))
            places.append(model.sample(np.linspace(0.0, 30.0, 7)).position)
        runs.append(np.array(places) * np.array([1.0, sign, 1.0]))
    apart = float(np.abs(runs[0] - runs[1]).max()) / 30.0
    return apart < 1e-10, f"{apart:.1e} L apart", 60.0


def directions() -> tuple[bool, str, float]:
    """A slack cable released along every axis and askew: no direction is special."""
    import cablemodel as cm

    ends = []
    for angle in np.linspace(0.0, 2.0 * math.pi, 9)[:-1]:
        c, s = math.cos(angle), math.sin(angle)
        model = cm.CableModel(scene([cable(10.0)], initial={"straight": [c, s, 0.0]}), planar=False)
        model.step_to(10.0)
        x, y, z = model.tip_position
        ends.append((c * x + s * y, -s * x + c * y, z))
    spread = float(np.ptp(np.array(ends), axis=0).max()) / 10.0
    for way in ((0.0, 0.0, -1.0), (0.0, 0.0, 1.0), (1.0, 0.0, 1.0)):
        model = cm.CableModel(scene([cable(10.0)], initial={"straight": list(way)}), planar=False)
        model.step_to(20.0)
    return (
        spread < 1e-9,
        f"eight directions {spread:.1e} L apart; up, down and askew complete",
        30.0,
    )


def pay_out_scene(friction: float = 0.0, tolerance: float = 1e-3, ramp: float = 1.0) -> Any:
    """Scene S3: 60 m with a body in 70 m of water, towed and paid out until it lies."""
    body = {"mass": 6, "submerged_weight": 20, "added_mass": 2, "added_mass_axial": 2,
            "drag_area": 0.03, "drag_coefficient": 0.6, "drag_area_axial": 0.03,
            "drag_coefficient_axial": 0.6}  # fmt: skip
    return scene(
        [cable(10.0), {"body": body}, cable(50.0)],
        environment={"floor": {"z": -70, "friction": friction}},
        vessel={"velocity": [*velocity_rows((0, 0, 0)), {"t": 20, "velocity": [0.65, 0, 0]}]},
        payout={
            "rate": [{"t": 0, "rate": 0}, {"t": 20, "rate": 0}, {"t": 20 + ramp, "rate": 0.7}],
            "drum": [cable(80.0)],
        },
        solver={"tolerance": tolerance},
    )


def pay_out_to_floor(
    friction: float = 0.0, tolerance: float = 1e-3, ramp: float = 1.0, depth: float = 1.0
) -> tuple[float, float]:
    """Scene S3: mean top tension over 94 to 98 s [N] and CPU seconds per simulated second."""
    import cablemodel as cm

    model = cm.CableModel(pay_out_scene(friction, tolerance, ramp))
    model._scalars.floor_depth *= depth
    start = time.process_time()
    tensions = []
    for k in range(196):
        model.step_to(0.5 * (k + 1))
        if model.time >= 94.0:
            tensions.append(model.top_tension)
    return float(np.mean(tensions)), (time.process_time() - start) / model.time


def floor_variants() -> tuple[bool, str, float]:
    """S3 with friction 0 to 1, floor stiffness and tolerance over two decades, a stepped rate."""
    base, _ = pay_out_to_floor()
    found = {
        "friction 0.3": pay_out_to_floor(friction=0.3)[0],
        "friction 1": pay_out_to_floor(friction=1.0)[0],
        "ten times softer": pay_out_to_floor(depth=10.0)[0],
        "ten times stiffer": pay_out_to_floor(depth=0.1)[0],
        "tau 1e-2": pay_out_to_floor(tolerance=1e-2)[0],
        "tau 1e-4": pay_out_to_floor(tolerance=1e-4)[0],
        "rate in a step": pay_out_to_floor(ramp=1e-3)[0],
    }
    worst = max(abs(value - 134.98) / 134.98 for value in found.values())
    text = ", ".join(f"{name} {value:.2f}" for name, value in found.items())
    return worst < 0.02, f"mean tension at 96 s (134.98 N): {base:.2f}; {text}", 8 * 98.0


SCENES = (
    StressScene("sudden stop", "front -V cos a sqrt(EA m) within 5 %, recovers", sudden_stop),
    StressScene("heave snap", "peaks do not grow", heave_snap),
    StressScene("reel-in", "lengths to 1e-9 m, hangs at rest afterwards", reel_in),
    StressScene(
        "body strikes the floor",
        "at most tau L/4 deep, forces balance, tension of a front and its echo",
        strike,
    ),
    StressScene("mirror", "1e-10 L", mirror),
    StressScene("directions", "1e-9 L, all complete", directions),
    StressScene("floor variants of S3", "within 2 % of the rigid floor", floor_variants, False),
    StressScene(
        "lay over ridges",
        "to the drum's end; 1 % of top tension; at most tau L/4 deep",
        rough_lays((((0.05, 200.0),),), 1e3),
    ),
    StressScene(
        "lays of 4 km over ridges",
        "the same",
        rough_lays(
            (
                ((0.02, 50.0),),
                ((0.02, 1000.0),),
                ((0.05, 200.0),),
                ((0.1, 50.0),),
                ((0.1, 1000.0),),
            ),
            4e3,
        ),
        False,
    ),
    StressScene(
        "lay of 5 km of stiff cable over ridges of three lengths",
        "the same",
        rough_lays((((0.06, 200.0), (0.05, 450.0), (0.045, 1100.0)),), 5e3, 1500.0),
        False,
    ),
    StressScene("lay of 10 km", "lay law within 1 %", lambda: long_lay(10e3), False),
    StressScene("lay of 50 km", "lay law within 1 %", lambda: long_lay(50e3), False),
)


def run(stress: StressScene) -> Outcome:
    """One scene; never raises for a failing one."""
    import cablemodel as cm

    start = time.process_time()
    try:
        holds, measured, simulated = stress.run()
    except (cm.CableModelError, ArithmeticError) as error:
        holds, measured, simulated = False, f"{type(error).__name__}: {error}"[:200], math.nan
    return Outcome(stress.name, holds, measured, simulated, time.process_time() - start)


PAGE = Path("docs/stress.md")
STORE = Path("docs/stress/scenes.csv")
HEAD = ("scene", "must hold", "outcome", "measured", "simulated [s]", "CPU [s]")


def summary(rows: Sequence[dict[str, str]]) -> str:
    """How many hold, and which do not; what was measured is in the data file."""
    failed = [row["scene"] for row in rows if row["outcome"] != "holds"]
    kept = f"{len(rows) - len(failed)} of {len(rows)} hold"
    return f"{kept}. Not: {', '.join(failed)}." if failed else f"{kept}."


def main() -> None:
    """Run all and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", help="a part of a scene's name")
    arguments = parser.parse_args()
    rows = []
    for stress in SCENES:
        if arguments.only and arguments.only not in stress.name:
            continue
        outcome = run(stress)
        rows.append(
            (
                stress.name,
                stress.must_hold,
                "holds" if outcome.holds else "fails",
                outcome.measured,
                f"{outcome.simulated:.0f}",
                f"{outcome.cpu:.2f}",
            )
        )
        print(" | ".join(rows[-1]), flush=True)
    if not arguments.only:
        write_rows(STORE, HEAD, rows)
        write_part(PAGE, "hard scenes", summary(read_rows(STORE)))


if __name__ == "__main__":
    main()
