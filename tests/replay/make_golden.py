"""Make the golden logs anew: `make golden`, or with names for some of them.

Only what differs from its log is replaced: a log that still replays exactly stays as it is.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from cases import CASES, FOLDER, LARGEST, Case

from cablemodel.errors import LogError
from cablemodel.results.compare import compare
from cablemodel.results.replay import replay
from cablemodel.results.run import open_run


def main(names: list[str]) -> int:
    unknown = set(names) - {case.name for case in CASES}
    if unknown:
        print(f"there are no golden logs {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    FOLDER.mkdir(exist_ok=True)
    for stray in set(FOLDER.glob("*.mcap")) - {case.path for case in CASES}:
        print(f"{stray.name}: no case, removed")
        stray.unlink()
    return max(renew(case) for case in CASES if not names or case.name in names)


def renew(case: Case) -> int:
    """Make a log, if the old one does not replay exactly, and say what has changed."""
    if case.path.exists() and current(case):
        print(f"{case.name}: as it was")
        return 0
    with tempfile.TemporaryDirectory() as folder:
        made = case.make(Path(folder) / "new.mcap")
        what = "new"
        if case.path.exists():
            what = changed(case.path, made)
        case.path.write_bytes(made.read_bytes())
    size = case.path.stat().st_size
    print(f"{case.name}: {what}, {size / 1e3:.0f} kB")
    return int(size > LARGEST)


def current(case: Case) -> bool:
    """Whether the log is one of this engine, of this case, and replays."""
    try:
        run = open_run(case.path)
        result = replay(run)
    except LogError:
        return False
    with tempfile.TemporaryDirectory() as folder:
        again = open_run(case.make(Path(folder) / "again.mcap"))
    return result.expected_exact and result.exact and again.scene == run.scene and (
        again.time.tolist() == run.time.tolist()
    )  # fmt: skip


def changed(old: Path, new: Path) -> str:
    try:
        found = compare(open_run(old), open_run(new))
    except LogError as error:
        return f"replaces one that cannot be read ({error})"
    worst = max(found.differences, key=lambda item: item.share, default=None)
    if worst is None or worst.largest == 0.0:
        return "the same values"
    return (
        f"{worst.name} changed by up to {worst.largest:.2e} {worst.unit} at t = {worst.time:g} s, "
        f"{worst.share:.1e} of its scale"
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
