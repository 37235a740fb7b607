"""Kernels run without Python: nothing in them calls out but to the C mathematics library."""

import json
import math

import numba
import pytest
from numba import float64, int64

from cablemodel.solvers.shared.compile import INTEGERS, OPTIONS, REALS
from cablemodel_fmu import intermediate
from cablemodel_fmu.symbols import ALLOWED_SYMBOLS, external_symbols


@pytest.fixture(scope="module", params=intermediate.PARTS)
def module(request):
    """Part, IR and arguments of a solver's entry points."""
    assembly, arguments = intermediate.kernel_module(request.param)
    return request.param, assembly.read_text(), json.loads(arguments.read_text())


@pytest.mark.slow
def test_every_entry_point_is_compiled(module):
    part, assembly, arguments = module
    names = intermediate.entry_points(part)
    assert set(arguments) == set(names)
    for name in names:
        assert f"define i64 @{intermediate.PREFIX}{name}(" in assembly


@pytest.mark.slow
def test_kernels_call_nothing_but_the_mathematics_library(module):
    symbols = external_symbols(module[1])
    assert symbols <= ALLOWED_SYMBOLS
    assert "sin" in symbols  # an arc of the vessel's path: the whole call tree is in the module


def _symbols(function):
    dispatcher = numba.jit(**OPTIONS)(function)
    dispatcher.entry_signature = int64(INTEGERS, REALS, float64)
    assembly, arguments = intermediate.native_module({"probe": dispatcher})
    assert arguments == {"probe": ["block", "float64"]}
    return external_symbols(assembly)


def test_a_kernel_that_leaves_the_allowed_functions_is_noticed():
    def kernel(block, reals, x):
        reals[0] = math.gamma(x)
        return 0

    assert _symbols(kernel) - ALLOWED_SYMBOLS


def test_a_kernel_that_prints_is_noticed():
    def kernel(block, reals, x):
        print(x)  # noqa: T201
        return 0

    assert _symbols(kernel) - ALLOWED_SYMBOLS


def test_a_kernel_that_uses_trigonometry_is_allowed():
    def kernel(block, reals, x):
        reals[0] = math.hypot(math.sin(x), math.sqrt(abs(x)) ** x)
        return block[0]

    symbols = _symbols(kernel)
    assert {"sin", "hypot"} <= symbols
    assert symbols <= ALLOWED_SYMBOLS
