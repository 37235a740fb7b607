"""What a module of LLVM IR takes from outside, and what kernels may take."""

from __future__ import annotations

import re

ALLOWED_SYMBOLS = {
    *("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "log", "sqrt", "hypot", "pow"),
    *("floor", "ceil"),
    *("memcpy", "memmove", "memset"),
}
"""What kernels may ask of the C library."""

_NO_SYMBOL = {
    *("fabs", "copysign", "smax", "smin", "umax", "umin", "abs", "ctpop", "ctlz", "cttz", "fshl"),
    *("minnum", "maxnum", "sqrt", "lifetime", "assume", "experimental.noalias.scope.decl"),
    *("uadd", "usub", "umul", "sadd", "ssub", "smul", "vector", "masked"),
}
"""LLVM intrinsics that compile to instructions, or to nothing."""


def external_symbols(assembly: str) -> set[str]:
    """Names that a module takes from outside; an intrinsic counts as the function it may become."""
    import llvmlite.binding as llvm

    module = llvm.parse_assembly(assembly)
    names = {g.name for g in module.global_variables if g.is_declaration}
    for function in module.functions:
        if not function.is_declaration:
            continue
        intrinsic = re.fullmatch(r"llvm\.(([a-z0-9]+)(\..*)?)", function.name)
        if intrinsic is None:
            names.add(function.name)
        elif intrinsic[1] not in _NO_SYMBOL and intrinsic[2] not in _NO_SYMBOL:
            names.add(intrinsic[2])
    return names
