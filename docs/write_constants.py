"""Write docs/engine/constants.csv anew: a row for each number that steers the engine.

Name, value and effect are read from the code, the date is that of the line in the history. Unit,
source and command are written by hand, in the file itself, and kept; so is an effect that the code
does not say. A test fails where a constant has no row, a row no constant, or one of these is empty.
"""

from __future__ import annotations

import ast
import csv
import importlib
import io
import re
import subprocess
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

ROOT = Path(__file__).parents[1]
STORE = ROOT / "docs" / "engine" / "constants.csv"
HEAD = ("name", "module", "value", "unit", "effect", "source", "date", "command")
PLACES = ("solvers", "systems", "accuracy/converge.py")
"""Folders and modules of cablemodel whose numbers steer the engine."""
C_PLACE = "fmu/cablemodel_fmu/c"
"""Folder of the FMU's own code."""
C_NUMBER = re.compile(
    r"(?:#define|enum \{) (?P<name>[A-Z_]+)(?: =)? \(?(?P<value>-?[\d.]+(?:e[+-]?\d+)?)"
    r"(?: / (?P<over>[\d.]+)\))?(?: \};)?(?: +/\* (?P<effect>.*) \*/)?"
)
"""One of its numbers: a macro, a quotient of two numbers, or an enumerator that stands alone."""
NO_STEERING = {
    "compile.py": "options of the compiler",
    "library.py": "when to say that the solver is compiled",
}
"""Modules that are left out whatever they hold."""
WHOLE_ARE_WORDS = "layout.py"
"""Of modules of that name: whole numbers are places in memory, sizes and cases; others steer."""
ROWS = "ROW_"
"""What names of places in memory begin with."""
WORDS = {
    "solvers/finite_element/kernels/water/airy.py": (
        "PER_TURN TURN TURN_REST ROUND HALVED MIDDLE S1 S2 S3 S4 S5 C1 C2 C3 C4 C5 C6 E0 E1 E2 "
        "E3 E4 E5 E6 E7 E8 E9"
    ),
    "solvers/finite_element/kernels/element/element_planar.py": "X Z TT TN NT NN XX XZ ZX ZZ",
    "solvers/finite_element/kernels/element/element_spatial.py": "X Y Z XX XY XZ YX YY YZ ZX ZY ZZ",
    "solvers/finite_element/kernels/outputs/part_outputs.py": "WRENCH",
    "solvers/finite_element/kernels/mesh/payout.py": "VELOCITY ACCELERATION",
    "solvers/finite_element/kernels/mesh/lengths.py": "SPRING_FIRST SPRING_LAST",
    "solvers/finite_element/kernels/mesh/mesh_motion.py": "FOLLOW_WORDS",
    "solvers/finite_element/kernels/bodies/raos.py": "UP YAW",
    "solvers/finite_element/kernels/water/sea_cells.py": "OVER",
    "solvers/finite_element/kernels/time/esdirk.py": "AT_FLOOR_FORCES",
    "solvers/finite_element/kernels/time/time_stepping.py": (
        "MADE TOO_LONG REACHES_FLOOR STIRS BREAKS"
    ),
    "solvers/finite_element/kernels/element/tables.py": "PAIRS_D PAIRS_H PAIRS_HD _G3",
    "solvers/finite_element/kernels/time/tension.py": "PASSES_OVER FOLLOWS SOLVED MISSES",
    "solvers/finite_element/kernels/time/solved_tension.py": (
        "SOLVED_Q SOLVED_V SOLVED_A SOLVED_T SOLVED_RATE CURVED STRAINED SOFTNESS"
    ),
    "solvers/finite_element/linearisation.py": "SHARES_PLACE TIED",
    "solvers/finite_element/kernels/mesh/top_element.py": (
        "JOINT_OUT JOINT_IN SPLIT_TOP JOIN_TOP BODY_OUT CABLE_AFTER_BODY CABLE_IN BODY_IN"
    ),
    "solvers/finite_element/kernels/line/block_solver.py": "WORK_LOWER WORK_UPPER",
    "solvers/finite_element/kernels/water/wetting.py": "OUTER NOWHERE",
    "solvers/direct/block.py": "_GAUSS_WORDS",
    "solvers/direct/kernels/assembly.py": (
        "_FULL _FLEXIBLE _PLANAR _VELOCITIES _FORCES _ANGLES _CURVATURES"
    ),
    "solvers/direct/kernels/history.py": "STRAIN",
    "solvers/direct/kernels/superposition.py": "SIDES",
    "solvers/estimating.py": "_TENSION _LENGTH",
    "systems/linear.py": "_ROOTS",
    "systems/motion.py": "_TRACK_WORDS",
    "fmu/cablemodel_fmu/c/cable.h": "STATE_MAGIC PI WRENCH_WORDS",
}
"""Places in memory, masks, cases, and coefficients of series: they steer nothing."""


@dataclass(frozen=True)
class Constant:
    """A number, or a few, at the top of a module."""

    module: str
    """Its path below cablemodel/; of the FMU's C from the root."""
    name: str
    value: str
    effect: str
    """What the code says of it: the comment behind it, or the text below it."""
    line: int


def constants() -> list[Constant]:
    """All of them, in the order of the code."""
    found = []
    for place in PLACES:
        at = ROOT / "cablemodel" / place
        for path in sorted(at.rglob("*.py")) if at.is_dir() else [at]:
            if path.name not in NO_STEERING:
                found += list(_of(path))
    for path in sorted((ROOT / C_PLACE).glob("*.[ch]")):
        found += list(_of_c(path))
    return found


def _of_c(path: Path) -> Iterator[Constant]:
    """Macros and lone enumerators that are numbers; what the comment behind them says."""
    module = path.relative_to(ROOT).as_posix()
    for k, line in enumerate(path.read_text(encoding="utf-8").splitlines()):
        found = C_NUMBER.fullmatch(line)
        if found is not None and found["name"] not in WORDS.get(module, "").split():
            value = ast.literal_eval(found["value"])
            if found["over"]:
                value /= ast.literal_eval(found["over"])
            yield Constant(module, found["name"], _words(value), found["effect"] or "", k + 1)


def _of(path: Path) -> Iterator[Constant]:
    module = str(path.relative_to(ROOT / "cablemodel"))
    text = path.read_text(encoding="utf-8")
    body = ast.parse(text).body
    comments = _comments(text)
    words = WORDS.get(module, "").split()
    loaded = importlib.import_module(f"cablemodel.{module[:-3].replace('/', '.')}")
    for k, node in enumerate(body):
        if not isinstance(node, ast.Assign) or len(node.targets) != 1:
            continue
        target, after = node.targets[0], body[k + 1] if k + 1 < len(body) else None
        names = target.elts if isinstance(target, ast.Tuple) else [target]
        for item in names:
            if not isinstance(item, ast.Name) or item.id != item.id.upper():
                continue
            if item.id.startswith(ROWS) or item.id in words:
                continue
            value = getattr(loaded, item.id)
            whole = path.name == WHOLE_ARE_WORDS and isinstance(value, int)
            if not _is_number(value) or whole:
                continue
            effect = _behind(node, comments) or _below(after) or _above(node, comments)
            yield Constant(module, item.id, _words(value), effect, node.lineno)


def _is_number(value: object) -> bool:
    if isinstance(value, tuple):
        return bool(value) and all(_is_number(part) for part in value)
    return isinstance(value, int | float) and not isinstance(value, bool)


def _words(value: object) -> str:
    if isinstance(value, tuple):
        return ", ".join(f"({_words(v)})" if isinstance(v, tuple) else _words(v) for v in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _comments(text: str) -> dict[int, tuple[str, bool]]:
    """Comments by line, and whether code stands before them."""
    found = {}
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            alone = not token.line[: token.start[1]].strip()
            found[token.start[0]] = (token.string.lstrip("# "), not alone)
    return found


def _behind(node: ast.stmt, comments: dict[int, tuple[str, bool]]) -> str:
    """Comments in the assignment's own lines."""
    lines = range(node.lineno, (node.end_lineno or node.lineno) + 1)
    return " ".join(comments[line][0] for line in lines if line in comments)


def _above(node: ast.stmt, comments: dict[int, tuple[str, bool]]) -> str:
    line, words = node.lineno - 1, []
    while line in comments and not comments[line][1]:
        words.insert(0, comments[line][0])
        line -= 1
    return " ".join(words)


def _below(after: ast.stmt | None) -> str:
    if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
        return " ".join(str(after.value.value).split())
    return ""


def kept() -> dict[tuple[str, str], dict[str, str]]:
    """The rows that are stored, by module and name."""
    if not STORE.exists():
        return {}
    with STORE.open(encoding="utf-8", newline="") as file:
        return {(row["module"], row["name"]): row for row in csv.DictReader(file)}


def dated(constant: Constant) -> str:
    """The day on which the line got the form that it has; empty outside of a repository."""
    where = f"{constant.line},{constant.line}"
    folder = "" if constant.module.startswith(C_PLACE) else "cablemodel/"
    command = ["git", "blame", "--porcelain", "-L", where, f"{folder}{constant.module}"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    seconds = [line.split()[1] for line in done.stdout.splitlines() if line[:12] == "author-time "]
    if not seconds:
        return ""
    return f"{datetime.fromtimestamp(int(seconds[0]), UTC):%Y-%m-%d}"


def main() -> None:
    """Write the file: rows of constants that are there, with what was written by hand."""
    before = kept()
    with STORE.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, HEAD, lineterminator="\n")
        writer.writeheader()
        for constant in constants():
            row = dict.fromkeys(HEAD, "") | before.get((constant.module, constant.name), {})
            if row["value"] != constant.value or not row["date"]:
                row["date"] = dated(constant)
            row |= {
                "name": constant.name,
                "module": constant.module,
                "value": constant.value,
                "effect": constant.effect or row["effect"],
            }
            writer.writerow(row)


if __name__ == "__main__":
    main()
