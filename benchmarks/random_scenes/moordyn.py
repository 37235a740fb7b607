"""The random scenes that MoorDyn can express, run in it.

They are those of one cable, pinned, without bodies, winch and floor, in still water or air, that
start at rest: hanging (MoorDyn's own relaxation, or exactly straight where the end is free) or
straight and unstretched. MoorDyn has no tolerance to be held to: twenty segments, RK4 at its stable
step, and a run is *wrong* where the end (the middle, of an anchored line) is more than 5 % of the
length from cablemodel's at tau/4, as long as the motion can be predicted; twenty segments are
within 0.5 % on the benchmark scenes. A run that diverges raises nothing: it is *wrong*, too.
"""

from __future__ import annotations

import json
import math
import resource
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.random_scenes.chance import COUNT
from benchmarks.random_scenes.draw import Drawn, draw
from benchmarks.random_scenes.judge import FAINT, FINER, MOVED, RUN_LIMIT
from benchmarks.random_scenes.report import OUTCOMES
from benchmarks.random_scenes.trace import perturbed, run
from benchmarks.scenes import BenchmarkScene, Cable
from benchmarks.sections import table, write_part

SEGMENTS = 20
FAR = 0.05
"""Distance from our run at tau/4, over the length, from which on MoorDyn's is wrong [-]."""
PAGE = Path("docs/stress.md")
STORE = Path("docs/stress/moordyn.json")


@dataclass
class Row:
    """MoorDyn's outcome of one scene, and its largest distance over the length."""

    seed: int
    outcome: str
    distance: float = math.nan
    cpu: float = 0.0
    why: str = ""


def expressible(drawn: Drawn) -> bool:
    """Whether MoorDyn can state the scene."""
    t = drawn.traits
    at_rest = t["manoeuvre"] in ("rest", "tow", "heave", "whip", "released under way")
    plain = t["body"] == "none" and t["pay-out"] == "none" and t["floor"] == "none"
    return at_rest and plain and t["top"] == "pinned" and t["current"] == "none"


@dataclass(frozen=True)
class Placed(BenchmarkScene):
    """A scene whose nodes begin on the straight line from the top with these steps."""

    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)

    def starting_points(self, segments: int) -> NDArray[np.float64]:
        """Straight; stretched by its own weight where it hangs."""
        step = self.cable.length / segments
        stretch = np.ones(segments)
        if self.start == "hanging":
            below = segments - 0.5 - np.arange(segments)
            pull = abs(self.cable.submerged_weight) * step * below
            stretch += pull / self.cable.axial_stiffness
        along = np.concatenate([[0.0], np.cumsum(step * stretch)])
        return np.outer(along, self.direction)


def stated(drawn: Drawn) -> Placed:
    """The scene in the words of the benchmark's peers."""
    import cablemodel as cm

    scene, kind = drawn.scene, drawn.scene["cable_types"]["K"]
    motion = cm.load_scene(scene).motion()
    bends = drawn.traits["model"] != "cable"
    cable = Cable(
        length=scene["line"][0]["cable"]["length"],
        **{**kind, "bending_stiffness": kind["bending_stiffness"] if bends else 0.0},
    )
    anchor = scene.get("end", {}).get("anchor")
    start, way = "hanging", (0.0, 0.0, -math.copysign(1.0, cable.submerged_weight))
    if anchor is not None:
        start = "static"
    elif "initial" in scene:
        start, way = "straight", tuple(scene["initial"]["straight"])
    times = tuple(drawn.duration * (k + 1) / 20.0 for k in range(20))
    return Placed(
        name=str(drawn.seed),
        title=scene["title"],
        cable=cable,
        water_density=scene["environment"]["water_density"],
        scene=scene,
        times=times,
        motion=lambda t: tuple(motion.evaluate(t)[0].tolist()),
        start_velocity=(0.0, 0.0, 0.0),
        start=start,
        probe=0.5 * cable.length if anchor is not None else None,
        anchor=tuple(anchor) if anchor is not None else None,
        direction=way,
    )


def judged(seed: int) -> Row:
    """Run MoorDyn, and compare with our run at tau/4."""
    from benchmarks.peers.moordyn import MoorDynRunner, Settings

    drawn = draw(seed)
    scene = stated(drawn)
    row = Row(seed, "completed")
    settings = Settings(SEGMENTS, coupling_step=0.02)
    began, places = time.process_time(), []
    try:
        runner = MoorDynRunner(scene, scene.times, settings)
        for instant in scene.times:
            runner.advance(instant)
            places.append(runner.tip())
        runner.close()
    except Exception as error:  # whatever a peer raises is an outcome
        return replace(row, outcome="refused", why=f"{type(error).__name__}: {error}"[:120])
    row.cpu = time.process_time() - began
    if row.cpu > RUN_LIMIT:
        return replace(row, outcome="too slow")
    tau = drawn.tolerance
    fine, _ = run(drawn, drawn.scene, FINER * tau, RUN_LIMIT)
    shaken, _ = run(drawn, perturbed(drawn, FAINT * tau), FINER * tau, RUN_LIMIT)
    station = len(fine.shapes[0]) // 2 if scene.anchor is not None else -1
    length = scene.cable.length
    for k in range(1, min(len(fine.times), len(shaken.times))):
        moved = np.linalg.norm(fine.shapes[k] - shaken.shapes[k], axis=1).max()
        if not moved <= MOVED * tau * length:
            break
        ours = fine.shapes[k][station] - fine.shapes[k][0]
        row.distance = float(np.fmax(row.distance, np.linalg.norm(places[k - 1] - ours) / length))
        if not np.isfinite(places[k - 1]).all() or row.distance > FAR:
            row.outcome, row.why = "wrong", f"at t = {fine.times[k]:.3g} s {row.distance:.2g} L"
            break
    if not np.isfinite(places).all():
        row.outcome, row.why = "wrong", "not finite"
    return row


def in_its_own_process(seed: int) -> Row:
    """The same where a crash or a run without end is an outcome."""
    command = [sys.executable, "-m", "benchmarks.random_scenes.moordyn", "--worker", str(seed)]
    limit = 3 * int(RUN_LIMIT)
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5)),
    )
    if done.returncode == 0:
        return Row(**json.loads(done.stdout.splitlines()[-1]))
    if -done.returncode in (signal.SIGXCPU, signal.SIGKILL):
        return Row(seed, "too slow", cpu=limit)
    return Row(seed, "crashed", why=f"code {done.returncode}: {done.stderr[-100:]}")


def summary(rows: list[Row], ours: dict[int, str]) -> str:
    """Outcomes of both, side by side."""
    both = [row for row in rows if row.seed in ours]
    sides = (("MoorDyn", [r.outcome for r in both]), ("cablemodel", [ours[r.seed] for r in both]))
    lines = []
    for name, found in sides:
        counts = Counter(found)
        lines.append((name, str(len(found)), *(str(counts[o] or "") for o in OUTCOMES)))
    return table(("by", "scenes", *OUTCOMES), lines)


def main() -> None:
    """Run all of these; keep the rows, write their summary."""
    if len(sys.argv) > 2 and sys.argv[1] == "--worker":
        print(json.dumps(asdict(judged(int(sys.argv[2])))))
        return
    kept: list[dict[str, Any]] = json.loads(Path("docs/stress/random_scenes.json").read_text())
    ours = {row["seed"]: row["outcome"] for row in kept}
    rows = []
    for seed in range(COUNT):
        if seed in ours and expressible(draw(seed)):
            rows.append(in_its_own_process(seed))
            print(rows[-1], flush=True)
            STORE.write_text(json.dumps([asdict(row) for row in rows], indent=1) + "\n")
    write_part(PAGE, "moordyn", summary(rows, ours))


if __name__ == "__main__":
    main()
