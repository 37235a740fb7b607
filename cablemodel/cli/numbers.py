"""Numbers as people read them: no exponents where engineers have none."""

from __future__ import annotations

import math

_SMALLEST, _LARGEST = 1e-3, 1e7
"""Between these sizes a number is written out."""


def readable(value: float, digits: int = 4) -> str:
    """A number with at least so many digits, all of those before the point among them.

    12,004.3 is ``12,004``, 0.0123456 is ``0.01235``; empty where it is not finite.
    """
    if not math.isfinite(value):
        return ""
    rounded = float(f"{value:.{digits}g}")
    size = abs(rounded)
    if size != 0.0 and not _SMALLEST <= size < _LARGEST:
        return f"{value:.{digits - 1}g}"
    decimals = max(0, digits - 1 - math.floor(math.log10(size))) if size else 0
    text = f"{value + 0.0:,.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text
