"""Entry point: ``python -m benchmarks [--quick] [--only S1,S4] [--no-peers] ...``.

Results are kept in ``docs/benchmarks/results.json``, part by part, so that one part can be
measured again without the others; the report is written from all that is there.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from benchmarks import machine, report, work_precision
from benchmarks.measure import Measurement
from benchmarks.scaling import ScalingPoint, measure_scaling
from benchmarks.scenes import SCENES
from benchmarks.startup import StartUp, measure_start_up

PARTS = (*work_precision.PARTS, "search", "scaling", "startup")
QUICK_PARTS = ("ours", "moordyn", "startup")


def arguments(given: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few settings, about a minute")
    parser.add_argument("--only", default=",".join(SCENES), help="scenes, with commas")
    parser.add_argument("--parts", default="", help=f"some of {','.join(PARTS)}")
    parser.add_argument("--report", action="store_true", help="only write page and figures anew")
    return parser.parse_args(given)


def tell(measurement: Measurement) -> None:
    """Print one measurement as it comes."""
    print(
        f"{measurement.scene:4} {measurement.contestant:24} {measurement.setting:12} "
        f"{measurement.cost:.2e} s/s, tip {measurement.tip_error:.1e}, "
        f"T {report.number(measurement.tension_error)} {measurement.failure or ''}",
        flush=True,
    )


def merge(kept: Sequence[Measurement], fresh: Sequence[Measurement]) -> list[Measurement]:
    """Old measurements with the new ones in the place of those that they repeat."""

    def key(measurement: Measurement) -> tuple[str, str, str]:
        return measurement.scene, measurement.contestant, measurement.setting

    replaced = {key(m) for m in fresh}
    return [m for m in kept if key(m) not in replaced] + list(fresh)


def write_page(stored: dict[str, Any]) -> None:
    """Page, figures and tables of rows from the numbers that are kept."""
    report.write(
        stored["machine"],
        [Measurement(**m) for m in stored["measurements"]],
        [ScalingPoint(**p) for p in stored["scaling"]],
        StartUp(**stored["startup"]) if stored["startup"] else None,
    )


def main(given: Sequence[str] | None = None) -> None:
    """Measure the chosen parts, keep the numbers, write the report."""
    chosen = arguments(given)
    names = [name for name in SCENES if name in chosen.only.split(",")]
    parts = chosen.parts.split(",") if chosen.parts else (QUICK_PARTS if chosen.quick else PARTS)
    store = report.FOLDER / "results.json"
    stored: dict[str, Any] = json.loads(store.read_text()) if store.exists() else {}
    if chosen.report:
        write_page(stored)
        return
    described = machine.describe()
    # Parts may be measured at different times: each keeps the load that it ran under.
    loads: dict[str, str] = stored.get("loads", {})
    load = described["load"]
    some = len(names) < len(SCENES)
    for part in parts:
        if some and part in work_precision.PARTS:
            revision = f"(revision {described['revision']})"
            loads[f"{part} of {', '.join(names)}"] = f"{load} {revision}"
        else:
            loads = {ran: then for ran, then in loads.items() if not ran.startswith(f"{part} of ")}
            loads[part] = load
    if some:
        described |= stored.get("machine", {})  # but for packages that are new

    fresh: list[Measurement] = []
    for part in work_precision.PARTS:
        if part in parts:
            fresh += work_precision.run(names, part, chosen.quick, tell)
    results = merge([Measurement(**m) for m in stored.get("measurements", [])], fresh)
    searched = [Measurement(**m) for m in stored.get("search", [])]
    if "search" in parts:
        from benchmarks.peers.moordyn_search import search

        searched = search(report=tell)
    scaling = [ScalingPoint(**p) for p in stored.get("scaling", []) if "series" in p]
    if "scaling" in parts:
        scaling = measure_scaling(lambda point: print(point, flush=True), chosen.quick)
    start_up = StartUp(**stored["startup"]) if stored.get("startup") else None
    if "startup" in parts:
        start_up = measure_start_up(with_first_start=not chosen.quick)
        print(start_up)

    stored = {
        "machine": described,
        "loads": loads,
        "measurements": [asdict(m) for m in results],
        "search": [asdict(m) for m in searched],
        "scaling": [asdict(p) for p in scaling],
        "startup": asdict(start_up) if start_up else None,
    }
    store.parent.mkdir(parents=True, exist_ok=True)
    store.write_text(json.dumps(stored, indent=1) + "\n")
    write_page(stored)
    print(f"wrote {report.PAGE}")


if __name__ == "__main__":
    main()
