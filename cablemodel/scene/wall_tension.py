"""Wall tension: what the material of the cable carries, from the effective tension.

The tension T of the equations is the effective one where there is water: its weight is that in
water, and the pressure of the water around it is part of it. With p that pressure, A the area of
the unstretched cross-section and nothing but material inside (Sparks 1984; the names are those of
OrcaFlex),

    wall tension = effective tension - p A.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.scene.sea import Sea, sea

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.line import Cable

FloatArray = NDArray[np.float64]

_SAME = 1e-10
"""Of the line: arc lengths that differ by less are the same."""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The water around a line, and the cross-sections that it presses on."""

    weight: float
    """rho g [N/m3]."""
    sea: Sea | None
    ends: FloatArray
    """Arc length from the line's end at t = 0 to the vessel end of every cable, outermost first
    (n,) [m]."""
    areas: FloatArray
    """Of these cables (n,) [m2]."""
    length: float
    """Of the line at t = 0 [m]."""

    @classmethod
    def of(cls, scene: Scene) -> Surroundings:
        """Those of a scene's line and of what is on its drum."""
        return cls._around(
            scene, [*reversed(scene.cables), *scene.drum_cables], scene.line_length, sea(scene)
        )

    @classmethod
    def of_line(cls, scene: Any, name: str) -> Surroundings:
        """Those of a line of a system."""
        line = scene.lines[name]
        drums = {w.at: w.drum_cables for w in scene.winches.values() if w.line == name}
        beyond = drums.get("end", [])
        cables = [item.cable for item in reversed(line.items) if item.cable is not None]
        cables = [*reversed(beyond), *cables, *drums.get("start", [])]
        inboard = math.fsum(cable.length for cable in beyond)
        return cls._around(scene, cables, line.length, sea(scene), inboard)

    @classmethod
    def _around(
        cls,
        scene: Any,
        cables: list[Cable],
        length: float,
        waves: Sea | None,
        inboard: float = 0.0,
    ) -> Surroundings:
        """cables: outermost first; of them so much [m] is on a drum at the line's end."""
        diameters = np.array([scene.cable_types[cable.type].diameter for cable in cables])
        environment = scene.environment
        return cls(
            weight=environment.water_density * environment.gravity,
            sea=waves,
            ends=np.cumsum([cable.length for cable in cables]) - inboard,
            areas=0.25 * math.pi * diameters**2,
            length=length,
        )

    def pressure(self, time: float, position: FloatArray) -> FloatArray:
        """Of the water at points (n, 3) over that of the air (n,) [Pa]: hydrostatic below z = 0,
        or below the waves, with that of their motion (Airy)."""
        head = -position[:, 2]
        if self.sea is not None:
            head = head + self.sea.head(time, position)
        return self.weight * np.maximum(0.0, head)

    def pressure_force(
        self, time: float, s: FloatArray, position: FloatArray, length: float
    ) -> FloatArray:
        """p A at arc lengths s (n,) of a line of this length [m], at points (n, 3): (n,) [N]."""
        # A joint belongs to the cable beyond it.
        from_end = length - s - _SAME * length
        cable = np.minimum(np.searchsorted(self.ends, from_end), len(self.ends) - 1)
        return self.pressure(time, position) * self.areas[cable]
