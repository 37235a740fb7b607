"""`python -m validation [FAMILY ...]` runs families, all by default, and writes what they leave."""

from __future__ import annotations

import sys
import time

import matplotlib

from validation import rows


def main(names: list[str]) -> int:
    """Returns 1 for an unknown family; a row that is not met is told, and stands in the page."""
    matplotlib.use("Agg")
    known = rows.families()
    wrong = [name for name in names if name not in known]
    if wrong:
        print(f"no family {', '.join(wrong)}; there are {', '.join(known)}", file=sys.stderr)
        return 1
    found: list[rows.Row] = []
    for name in names or list(known):
        began = time.perf_counter()
        some, figure = known[name].run()
        rows.STORE.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(rows.STORE.parent / f"{name}.png", dpi=80)
        print(f"{name}: {len(some)} rows, {time.perf_counter() - began:.1f} s")
        for row in some:
            mark = "" if row.met else "   NOT MET"
            print(f"  {row.case}: {row.metric} {row.result:.3g} {row.unit} ({row.limit:.3g}){mark}")
        found += some
    rows.write(found)
    rows.render()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
