"""``python -m benchmarks.random_scenes [--count 1000] [--set N] [--only SEED[,SEED...]]``.

Verdicts are kept in ``docs/stress/random_scenes.json``; a part of the seeds replaces those kept.
The tables of ``docs/stress.md`` are written from all that are kept, and ``outcomes.csv`` beside.
``--only`` prints the scene and all about its outcome, and keeps nothing. ``--set 2`` judges another
thousand scenes (seeds 1000 to 1999), to see whether what was made better for the first holds for
scenes that nobody has looked at; their verdicts are printed and counted, not kept. ``--held``
judges 200 scenes (from 5000 on) that no rule was made by, and keeps them: once. ``--waves`` judges
200 in waves (from 10000 on), ``--ordinary`` those of ordinary jobs (from 20000 on), ``--converge``
the thousand as runs that are asked to converge; each has a file of its own. What makes a search
fail: ``failures.py``.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from dataclasses import asdict
from pathlib import Path

from benchmarks.random_scenes import overview, report
from benchmarks.random_scenes.chance import COUNT
from benchmarks.random_scenes.failures import failures
from benchmarks.random_scenes.judge import Verdict
from benchmarks.random_scenes.ordinary import drawn
from benchmarks.random_scenes.report import ALL, AT_SEA, CONVERGED, HELD, JOBS
from benchmarks.random_scenes.watch import search, work

PAGE = Path("docs/stress.md")
STORED = Path("docs/stress")


def show(verdict: Verdict) -> None:
    """One line for each scene as it comes."""
    print(
        f"{verdict.seed:4d} {verdict.outcome:9s} {verdict.position:8.2g} {verdict.tension:8.2g} "
        f"{100 * verdict.compared:4.0f} % {verdict.cpu:6.2f} s {verdict.check_cpu:6.1f} s "
        f"{','.join(verdict.kinds)} {verdict.why[:150]} {verdict.note[:100]}".replace("\n", " "),
        flush=True,
    )


def main() -> None:
    """Judge scenes; keep the verdicts."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.random_scenes", description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="seed to begin with")
    parser.add_argument("--count", type=int, default=COUNT, help="how many seeds from there on")
    parser.add_argument("--held", action="store_true", help="scenes that no rule was made by")
    parser.add_argument("--waves", action="store_true", help="scenes in waves")
    parser.add_argument("--ordinary", action="store_true", help="scenes of ordinary jobs")
    parser.add_argument("--converge", action="store_true", help="runs that are asked to converge")
    parser.add_argument("--only", help="show these seeds, with commas; keep nothing")
    parser.add_argument("--seeds", help="judge and keep these seeds, with commas")
    parser.add_argument("--again", help="judge anew those kept with these outcomes, with commas")
    parser.add_argument("--report", action="store_true", help="only write the page anew")
    parser.add_argument("--set", type=int, default=1, help="which thousand; others than 1: no page")
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    searches = {"held": HELD, "waves": AT_SEA, "ordinary": JOBS, "converge": CONVERGED}
    asked = [kind for word, kind in searches.items() if getattr(chosen, word)]
    if len(asked) > 1:
        parser.error(f"--{', --'.join(searches)} are searches: choose one")
    if chosen.worker:
        work([int(seed) for seed in chosen.worker.split(",")], converged=chosen.converge)
        return
    if chosen.only:
        import cablemodel as cm

        for seed in (int(word) for word in chosen.only.split(",")):
            scene = drawn(seed)
            print(cm.load_scene(scene.scene).to_yaml())
            print(f"# caller's step {scene.step!r} s; {scene.traits}")
            for verdict in search([seed], show, converged=chosen.converge):
                print(json.dumps(asdict(verdict), indent=1))
        return
    if chosen.set != 1:
        start = COUNT * (chosen.set - 1)
        outcomes: Counter[str] = Counter()

        def count(verdict: Verdict) -> None:
            show(verdict)
            outcomes[verdict.outcome] += 1

        rows = range(chosen.first, min(chosen.first + chosen.count, COUNT))
        search([start + row for row in rows], count, converged=chosen.converge)
        print(", ".join(f"{outcome}: {number}" for outcome, number in outcomes.most_common()))
        return
    kept = {}
    kind = asked[0] if asked else ALL
    store = STORED / kind.file(".json")
    if store.exists():
        kept = {row["seed"]: row for row in json.loads(store.read_text())}
    before = {seed: row["outcome"] for seed, row in kept.items()}
    last = min(chosen.first + chosen.count, kind.count)
    seeds = [kind.first + row for row in range(chosen.first, last)]
    if chosen.seeds:
        seeds = [int(word) for word in chosen.seeds.split(",")]
    if chosen.again:
        seeds = [s for s, row in kept.items() if row["outcome"] in chosen.again.split(",")]

    def keep(verdict: Verdict) -> None:
        show(verdict)
        kept[verdict.seed] = asdict(verdict)
        store.parent.mkdir(parents=True, exist_ok=True)
        rows = [kept[seed] for seed in sorted(kept)]
        store.write_text(json.dumps(rows, indent=1) + "\n")

    if not chosen.report:
        search(seeds, keep, converged=chosen.converge)
    verdicts = [Verdict(**kept[seed]) for seed in sorted(kept)]
    report.write(PAGE, STORED)
    overview.write_pages()
    counts = Counter(verdict.outcome for verdict in verdicts)
    print(", ".join(f"{outcome}: {number}" for outcome, number in counts.most_common()))
    failed = failures(verdicts, before, claimed=kind.claimed)
    for seed, why in failed:
        print(f"{seed} {why}")
    if failed:
        raise SystemExit(f"{len(failed)} of {len(verdicts)} scenes fail; see {store}")


if __name__ == "__main__":
    main()
