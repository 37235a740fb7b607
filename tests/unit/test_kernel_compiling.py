"""While kernels are compiled numba remembers what calls mean; then it is as it was."""

import ast
from pathlib import Path

import numba
import numpy as np
import pytest
from numba import float64, int64
from numba.core.types.functions import BaseFunction

import cablemodel
from cablemodel.solvers.library import KERNELS
from cablemodel.solvers.shared.compile import (
    INTEGERS,
    OPTIONS,
    REALS,
    calls_resolved_once,
    entry_point,
    indices_from_zero,
)


def _mixed(ints, reals, factor):
    """The same operators for integers, floats and both, not to be mistaken for one another."""
    whole = ints[0] + ints[1] * ints[2]
    real = reals[0] + reals[1] * reals[2]
    both = ints[0] + reals[1] * ints[2]
    return (
        int(1000.0 * (real + both * factor) + ints[3] // ints[1])
        + whole // 7
        - max(ints[0], ints[1]) * int(max(reals[0], reals[1]) + min(3.0, factor))
    )


def _arguments():
    rng = np.random.default_rng(3)
    return rng.integers(2, 90, 4), rng.uniform(1.0, 9.0, 4), 1.7


@pytest.fixture
def resolutions(monkeypatch):
    """How many calls of built-in functions numba resolves itself."""
    resolve, calls = BaseFunction.get_call_type, []

    def count(self, context, args, kws):
        calls.append((self, args))
        return resolve(self, context, args, kws)

    monkeypatch.setattr(BaseFunction, "get_call_type", count)
    return calls


def test_what_is_compiled_is_the_same_with_fewer_resolutions(resolutions):
    signature = int64(INTEGERS, REALS, float64)
    plain = numba.jit(**OPTIONS)(_mixed)
    plain.compile(signature)
    without = len(resolutions)
    resolutions.clear()
    remembering = numba.jit(**OPTIONS)(_mixed)
    with calls_resolved_once():
        remembering.compile(signature)
    assert len(resolutions) < 0.7 * without
    assert plain(*_arguments()) == remembering(*_arguments()) == _mixed(*_arguments())


def _second_word_less(ints, words):
    return ints[1:][-words]


def test_an_index_counts_from_the_begin_in_kernels_alone():
    signature = int64(INTEGERS, int64)
    ints = np.array([5, 6, 7, 8])
    kernel, plain = numba.jit(**OPTIONS)(_second_word_less), numba.jit(**OPTIONS)(_second_word_less)
    with indices_from_zero():
        kernel.compile(signature)
    plain.compile(signature)
    assert kernel(ints, 1) == 5
    assert plain(ints, 1) == 8


def test_no_kernel_counts_from_the_end():
    solvers = Path(cablemodel.__file__).parent / "solvers"
    for folder in KERNELS:
        for path in (solvers / folder).rglob("*.py"):
            for function in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if not isinstance(function, ast.FunctionDef):
                    continue
                for found in ast.walk(function):
                    if isinstance(found, ast.Subscript):
                        index = found.slice
                        assert not isinstance(index, ast.UnaryOp), f"{path}:{found.lineno}"


def test_numba_is_as_it_was_afterwards():
    before = BaseFunction.get_call_type
    with calls_resolved_once():
        assert BaseFunction.get_call_type is not before
    assert BaseFunction.get_call_type is before
    with pytest.raises(ZeroDivisionError), calls_resolved_once():
        raise ZeroDivisionError
    assert BaseFunction.get_call_type is before


def test_an_entry_point_is_compiled_so(resolutions, tmp_path):
    kernel = entry_point(int64(INTEGERS, REALS, float64), lambda: tmp_path)(_mixed)
    assert kernel(*_arguments()) == _mixed(*_arguments())
    of_entry_point = len(resolutions)
    resolutions.clear()
    numba.jit(**OPTIONS)(_mixed).compile(int64(INTEGERS, REALS, float64))
    assert of_entry_point < 0.7 * len(resolutions)
    assert any(tmp_path.rglob("*.nbi"))


def test_other_flags_resolve_anew_and_mean_what_they_say(resolutions):
    def divided(ints, reals, factor):
        return int(factor / reals[0]) + ints[0]

    signature = int64(INTEGERS, REALS, float64)
    with calls_resolved_once():
        kernel = numba.jit(**OPTIONS)(divided)
        kernel.compile(signature)
        resolutions.clear()
        again = numba.jit(**OPTIONS)(divided)
        again.compile(signature)
        same_flags = len(resolutions)
        resolutions.clear()
        checked = numba.jit(**{**OPTIONS, "error_model": "python", "_nrt": True})(divided)
        checked.compile(signature)
        other_flags = len(resolutions)
    assert same_flags == 0
    assert other_flags > 0
    ints, reals, _ = _arguments()
    reals[0] = 0.0
    assert isinstance(kernel(ints, reals, 1.0), int)
    with pytest.raises(ZeroDivisionError):
        checked(ints, reals, 1.0)


def test_one_within_another_leaves_numba_as_it_was():
    before = BaseFunction.get_call_type
    with calls_resolved_once():
        outer = BaseFunction.get_call_type
        with calls_resolved_once():
            pass
        assert BaseFunction.get_call_type is outer
    assert BaseFunction.get_call_type is before
