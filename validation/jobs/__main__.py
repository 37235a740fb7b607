"""`python -m validation.jobs [JOB ...]` computes jobs, all by default, and writes their answers."""

from __future__ import annotations

import sys
import time

import matplotlib

from validation.jobs import book


def main(names: list[str]) -> int:
    """Returns 1 for an unknown job or one whose answers do not agree."""
    matplotlib.use("Agg")
    known = book.jobs()
    wrong = [name for name in names if name not in known]
    if wrong:
        print(f"no job {', '.join(wrong)}; there are {', '.join(known)}", file=sys.stderr)
        return 1
    failed = 0
    for name in names or list(known):
        began = time.perf_counter()
        answers, figure = known[name]()
        figure.savefig(book.FOLDER / f"{name}.png", dpi=80)
        book.write({name: answers})
        if (book.FOLDER / f"{name}.md").exists():
            book.render(name)
        print(f"{name}: {time.perf_counter() - began:.1f} s")
        for a in answers:
            failed += not a.agrees
            values = f"{a.found:.6g} | {a.independent:.6g} {a.unit}, within {a.within:.3g}"
            print(f"  {a.quantity}: {values}{'' if a.agrees else '   DISAGREE'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
