"""What is legal in a scene, but seldom meant."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cablemodel.model import CableModel, CableState
    from cablemodel.scene import Scene

_AIR = 100.0
"""Densities [kg/m3] below this are air; nothing is surprising about it above z = 0."""
_LIGHTEST, _HEAVIEST = 100.0, 12_000.0
"""Densities [kg/m3] of cables: foam and lead."""
_LARGE_STRAIN = 0.02
_ABOVE_WATER = 0.01
"""Height [m] by which a cable may stand above z = 0 without a word."""


def scene_warnings(scene: Scene) -> list[str]:
    """What is seen without a start."""
    from cablemodel.instance.scales import is_flexible

    found = []
    settings = scene.run
    if settings.output_interval > settings.duration:
        found.append(
            f"run.output_interval ({settings.output_interval:g} s) is longer than run.duration "
            f"({settings.duration:g} s): only the start and the end are output"
        )
    if scene.vessel.connection.kind == "clamped" and is_flexible(scene, scene.cables[0]):
        found.append("vessel.connection is clamped, but the first cable has no bending: no effect")
    used = {item.cable.type for item in (*scene.line, *scene.payout.drum) if item.cable is not None}
    for name in sorted(scene.cable_types):
        kind = scene.cable_types[name]
        if name not in used:
            found.append(f"cable_types.{name} is not used in the line")
            continue
        density = kind.mass / (0.25 * math.pi * kind.diameter**2)
        if not _LIGHTEST < density < _HEAVIEST:
            found.append(
                f"cable type {name} has a density of {density:.3g} kg/m3 (water: "
                f"{scene.environment.water_density:g}): are its diameter ({kind.diameter:g} m) and "
                f"its mass ({kind.mass:g} kg/m) right?"
            )
        weight = kind.submerged_weight or 0.0
        if weight < 0.0 and scene.environment.waves is None:  # a surface to float on
            found.append(f"cable type {name} floats: its submerged weight is {weight:g} N/m")
    return found


def start_warnings(scene: Scene, model: CableModel, state: CableState) -> list[str]:
    """What is seen at the start."""
    found = []
    for name in sorted({cable.type for cable in scene.cables}):
        kind = scene.cable_types[name]
        strain = sum(
            c * model.tension_max ** (k + 1) for k, c in enumerate(kind.strain_coefficients)
        )
        if strain > _LARGE_STRAIN:
            found.append(
                f"cable type {name} would stretch by {100 * strain:.1f} % under the highest "
                f"tension at the start; is its axial stiffness right?"
            )
    above = float(state.position[:, 2].max())
    wet = scene.environment.water_density > _AIR and scene.environment.waves is None
    if wet and above > _ABOVE_WATER:
        found.append(
            f"the cable reaches {above:.3g} m above z = 0; without waves there is water "
            "everywhere, also there"
        )
    slack = 10.0 * scene.solver.tolerance * max(abs(model.tension_max), abs(model.tension_min))
    if model.tension_min < -slack:
        found.append(f"the cable is compressed at the start: {model.tension_min:.3g} N")
    return found
