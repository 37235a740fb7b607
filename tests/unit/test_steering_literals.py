"""Numbers that steer the engine have names, and so rows in docs/engine/constants.csv.

A number in a function steers where a formula would hardly have it:

- it is no multiple of an eighth: the coefficients of cubics, means and round things are;
- it is a power of ten from 10 on;
- it decides: it stands in a comparison of sizes, or in what is a minimum, a maximum or a count of
  places or rounds, or it is alone what is returned, assigned or chosen.

Not so 0, 1, 2, 0.5 and half a turn, exponents and indices, and what stands for no limit at all or
keeps a quotient from having none (beyond 1e100, within 1e-100).
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ENGINE = ROOT / "cablemodel"
C_PLACE = ROOT / "fmu" / "cablemodel_fmu" / "c"
FOLDERS = "solvers", "systems"
LATER = ("solvers/direct/kernels", "solvers/finite_element/kernels/element")
"""Folders whose numbers have yet to be named."""
FORMULAS = {
    ("solvers/finite_element/kernels/bodies/raos.py", 10.0): "smooth step of degree five",
    ("solvers/finite_element/kernels/water/waves.py", 10.0): "smooth step of degree five",
    ("systems/lays.py", 10.0): "smooth step of degree five",
    ("solvers/finite_element/start/laid_shape.py", 4): "points that a bend has at least",
}
"""Numbers of formulas that look like the others, and which formulas they are of."""

PLAIN = {0.0, 0.5, 1.0, 2.0, 180.0}
FEW = 3
"""Whole numbers up to that are cases, dimensions and ends."""
EXTREMES = {"min", "max", "minimum", "maximum", "clip", "quantile"}
ROUNDS = "iteration", "attempt"
"""What counts rounds, beside names that begin with an underscore: others count components."""
ORDERED = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)
ALONE = (
    ast.Assign,
    ast.AnnAssign,
    ast.AugAssign,
    ast.Return,
    ast.IfExp,
    ast.keyword,
    ast.arguments,
)


def steering(text: str) -> Iterator[tuple[int, float]]:
    """Lines and values of the numbers in functions that steer."""
    tree = ast.parse(text)
    parents = {child: node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            above = list(_above(node, parents))
            inside = any(isinstance(parent, ast.FunctionDef | ast.Lambda) for parent, _ in above)
            if inside and _steers(abs(node.value), above):  # type: ignore[arg-type]
                yield node.lineno, node.value  # type: ignore[misc]


def _above(node: ast.AST, parents: dict[ast.AST, ast.AST]) -> Iterator[tuple[ast.AST, ast.AST]]:
    """What a node stands in, from the inside out, with the part in which it does."""
    while node in parents:
        yield parents[node], node
        node = parents[node]


def _is_chosen(value: float) -> bool:
    """Whether a formula would hardly have a number, wherever it stands."""
    return value * 8.0 != int(value * 8.0) or value in (10.0, 100.0) or value % 1000.0 == 0.0


def _steers(value: float, above: list[tuple[ast.AST, ast.AST]]) -> bool:
    if value in PLAIN or value >= 1e100 or value <= 1e-100:
        return False
    decides = counts = False
    for parent, part in above:
        if isinstance(parent, ast.Subscript) and parent.slice is part:
            return False
        if isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.Pow):
            if parent.right is part:
                return False
            break
        if isinstance(parent, ast.Call):
            name = _name(parent.func)
            if name in ("pow", "power") and part is parent.args[-1]:
                return False
            counts = name == "linspace" or (name == "range" and _is_round(above))
            decides = decides or name in EXTREMES
            if name not in EXTREMES:
                break
        elif isinstance(parent, ast.Compare):
            decides = any(isinstance(op, ORDERED) for op in parent.ops)
            break
        elif not isinstance(parent, ast.BinOp | ast.UnaryOp | ast.Tuple | ast.List | ast.IfExp):
            break
    if isinstance(value, int):
        return value > FEW and (decides or counts)
    if _is_chosen(value):
        return True
    around = next(parent for parent, _part in above if not isinstance(parent, ast.UnaryOp))
    return decides or counts or isinstance(around, ALONE)


def _is_round(above: list[tuple[ast.AST, ast.AST]]) -> bool:
    loop = next((parent for parent, _part in above if isinstance(parent, ast.For)), None)
    target = loop.target if loop is not None else None
    return isinstance(target, ast.Name) and target.id.startswith(("_", *ROUNDS))


def _name(function: ast.expr) -> str:
    if isinstance(function, ast.Attribute):
        return function.attr
    return function.id if isinstance(function, ast.Name) else ""


def found() -> dict[tuple[str, float], list[int]]:
    """Lines of the engine's numbers without a name, by module and value."""
    lines: dict[tuple[str, float], list[int]] = {}
    for path in sorted(path for folder in FOLDERS for path in (ENGINE / folder).rglob("*.py")):
        module = path.relative_to(ENGINE).as_posix()
        if not module.startswith(LATER):
            for line, value in steering(path.read_text(encoding="utf-8")):
                lines.setdefault((module, value), []).append(line)
    return lines


def test_numbers_that_steer_have_names() -> None:
    """Name one at the top of its module, and give it a row: `python docs/write_constants.py`."""
    unnamed = {key: lines for key, lines in found().items() if key not in FORMULAS}
    assert unnamed == {}


def test_numbers_of_the_fmu_have_names() -> None:
    """Such numbers of its C stand in macros with a comment; an example of a vessel aside."""
    number = re.compile(r"(?<![\w.])(?:\d+\.\d*(?:e[-+]?\d+)?|\d+e[-+]?\d+)(?![\w.])")
    unnamed = []
    for path in sorted(C_PLACE.glob("*.[ch]")):
        text = re.sub(r"/\*.*?\*/", _blank, path.read_text(encoding="utf-8"), flags=re.DOTALL)
        for line, code in enumerate(re.sub(r'"(?:\\.|[^"\\\n])*"', '""', text).splitlines(), 1):
            found = [] if code.startswith("#define") else map(float, number.findall(code))
            unnamed += [
                (path.name, line, value)
                for value in found
                if 1e-100 < value < 1e100 and _is_chosen(value)
            ]
    assert unnamed == [("fmi2.c", line, 100.0) for _name, line, _value in unnamed]  # per cent


def _blank(comment: re.Match[str]) -> str:
    return "\n" * comment[0].count("\n")


def test_exceptions_are_still_there() -> None:
    assert set(FORMULAS) - set(found()) == set()


@pytest.mark.parametrize(
    ("line", "steers"),
    [
        ("x = 0.9 * y", True),
        ("x = 10.0 * tolerance", True),
        ("x *= 0.25", True),
        ("x = 3.0 if y else z", True),
        ("return x > 4.0 * y", True),
        ("x = min(y, 4.0 * z)", True),
        ("for _round in range(20): pass", True),
        ("x = np.linspace(0.0, y, 65)", True),
        ("return x <= 5", True),
        ("def g(angle=0.1): pass", True),
        ("x = 6.0 * y - 0.125 * z", False),
        ("x = y ** 0.25 + math.pow(y, 0.3)", False),
        ("x = 0.5 * y[4] + 2.0", False),
        ("return x < 1e300", False),
        ("return kind == 5", False),
        ("for n in range(6): pass", False),
        ("x = max(y, (0.75 * z) ** 2)", False),
    ],
)
def test_what_steers(line: str, *, steers: bool) -> None:
    assert bool(list(steering(f"def f():\n    {line}\n"))) == steers
