"""Results that the engine does not reach yet: measured, written down, expected to fail.

A test listed here runs like any other one. It is reported as an expected failure while it fails;
when it passes, the run fails until its line is removed (``strict``).
"""

import pytest

_TIGHT = (
    "asked to a fixed absolute digit at a tolerance of 1e-6 or tighter, where axial rounding and "
    "time steps leave a little more; the deviation is in the message of the failure"
)
LIMITS = {
    "test_converges_to_the_table": _TIGHT,
}
FAILING = frozenset(
    {
        "test_axial_mode_with_an_end_mass[0.0]",
        "test_converges_to_the_table[released in water-100-1e-08]",
    }
)


def pytest_collection_modifyitems(items):
    """Mark what fails today; the parameters that pass are not marked."""
    for item in items:
        name = item.originalname if item.name not in LIMITS else item.name
        if name in LIMITS and item.name in FAILING:
            item.add_marker(pytest.mark.xfail(reason=LIMITS[name], strict=True))
