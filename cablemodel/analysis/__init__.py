"""Statistics of runs (`series`), and sweeps over parameters (`sweep`)."""

from cablemodel.analysis.series import (
    YEAR,
    Cycles,
    Extremes,
    FatigueCurve,
    Floats,
    Spectrum,
    Statistic,
    cycles,
    damage,
    equivalent_range,
    extreme_value,
    extremes,
    spectrum,
    statistics,
)

__all__ = [
    "YEAR",
    "Cycles",
    "Extremes",
    "FatigueCurve",
    "Floats",
    "Spectrum",
    "Statistic",
    "cycles",
    "damage",
    "equivalent_range",
    "extreme_value",
    "extremes",
    "spectrum",
    "statistics",
]
