"""Run scenes in a process of their own, so that whatever happens to it is an outcome too.

The worker writes a line of JSON as each run of a scene begins and as its verdict stands. It may use
a bounded amount of processor time per run: past that the kernel ends it, even inside a compiled
step. The parent notes what became of the scene, and starts another worker for those left.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any

from benchmarks.random_scenes.judge import (
    CHECK_LIMIT,
    CONVERGE_LIMIT,
    ENERGY_LIMIT,
    JUDGE_LIMIT,
    RUN_LIMIT,
    Verdict,
    judge,
    judge_converged,
)
from benchmarks.random_scenes.ordinary import drawn

GRACE = 3.0
"""CPU seconds beyond a run's limit until its process is ended: steps may be long [s]."""
LIMITS = {
    "run": RUN_LIMIT,
    "converge": CONVERGE_LIMIT,
    "rest": RUN_LIMIT,
    "energy": ENERGY_LIMIT,
    "check": CHECK_LIMIT,
    "perturbed": CHECK_LIMIT,
    "finest": CHECK_LIMIT,
    "judge": JUDGE_LIMIT,
}


def work(seeds: Sequence[int], *, converged: bool = False) -> None:
    """The worker: judge scene after scene, tell on standard output.

    converged: judge runs that are asked to converge.
    """

    def tell(**words: Any) -> None:
        print(json.dumps(words), flush=True)

    for seed in seeds:

        def started(phase: str, verdict: Verdict | None, seed: int = seed) -> None:
            used = time.process_time()
            _, hard = resource.getrlimit(resource.RLIMIT_CPU)
            resource.setrlimit(resource.RLIMIT_CPU, (int(used + LIMITS[phase] + GRACE), hard))
            tell(seed=seed, phase=phase, so_far=None if verdict is None else asdict(verdict))

        verdict = (judge_converged if converged else judge)(drawn(seed), started)
        tell(seed=seed, verdict=asdict(verdict))


def search(
    seeds: Sequence[int], report: Callable[[Verdict], None], *, converged: bool = False
) -> list[Verdict]:
    """Judge all of these scenes, in worker processes one after the other."""
    verdicts: list[Verdict] = []
    left = list(seeds)
    while left:
        command = [sys.executable, "-m", "benchmarks.random_scenes", "--worker"]
        command.append(",".join(str(seed) for seed in left))
        command += ["--converge"] if converged else []
        phase, so_far = "", None
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=os.environ) as worker:
            assert worker.stdout is not None
            for line in worker.stdout:
                told = json.loads(line)
                if "phase" in told:
                    phase, so_far = told["phase"], told["so_far"]
                    continue
                verdicts.append(Verdict(**told["verdict"]))
                left.remove(told["seed"])
                report(verdicts[-1])
        if worker.returncode != 0 and left:
            verdicts.append(_ended(left.pop(0), phase, so_far, worker.returncode))
            report(verdicts[-1])
        elif left and worker.returncode == 0:
            raise RuntimeError(f"the worker ended before it came to scene {left[0]}")
    return verdicts


def _ended(seed: int, phase: str, so_far: dict[str, Any] | None, code: int) -> Verdict:
    """What it means that a worker ended while it ran a scene.

    so_far: the verdict if only the phase did not end; None: that the scene is too slow.
    """
    if code != -signal.SIGXCPU:
        name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        return Verdict(seed, "crashed", f"{phase}: {name}")
    if so_far is None:
        return Verdict(seed, "too slow", f"{phase}: beyond the limit", cpu=LIMITS[phase])
    verdict = Verdict(**so_far)
    verdict.note = f"{verdict.note} {phase}: a step beyond the limit".strip()
    return verdict
