"""What is typical of a scene: its tension, damping and lengths, from its data alone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from cablemodel.scene.sea import sea
from cablemodel.solvers.finite_element.mesh import Start

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.common import CableScene
    from cablemodel.scene.line import Cable

LARGE_STRAIN = 0.02
"""At the start: `cablemodel check` and FMUs warn of larger ones."""
TYPICAL_DRAG = 0.1
"""Of a cable's drag across: what it has on the average along a line that is inclined."""


def tension_scale(scene: Scene) -> float:
    """A tension [N] that is typical of the line: what the stabilisation is measured by."""
    scale = 0.0
    for cable, tension in zip(scene.cables, tension_per_length(scene), strict=True):
        scale += cable.length * tension
    for body in scene.bodies:
        scale += abs(body.submerged_weight)
    if scale == 0.0:  # nothing pulls: what a bend as long as the line takes
        stiffness = max(scene.cable_types[c.type].bending_stiffness for c in scene.cables)
        scale = stiffness / scene.line_length**2
    return scale


def tension_per_length(scene: Scene) -> list[float]:
    """What each cable of the line adds to a typical tension, per length [N/m].

    Weight of all that hangs, and the drag of the line broadside to the fastest relative flow. A
    line that runs out onto the floor comes down along itself: its ship carries what it weighs over
    the depth.
    """
    rho = scene.environment.water_density
    gravity = scene.environment.gravity
    if _runs_out_onto_floor(scene):
        depth = height_over_floor(scene)
        share = max(depth, 0.0) / scene.line_length
        return [
            share * scene.cable_types[cable.type].typical_weight(gravity) for cable in scene.cables
        ]
    speed = scene.motion().typical_speed
    if scene.environment.current is not None:
        speed += float(np.max(np.linalg.norm(scene.environment.current.velocity, axis=-1)))
    water = sea(scene)
    if water is not None:
        speed += water.speed
    found = []
    for kind in (scene.cable_types[cable.type] for cable in scene.cables):
        weight = kind.typical_weight(gravity)
        found.append(
            weight + 0.5 * rho * kind.drag_normal * kind.diameter * speed**2 * TYPICAL_DRAG
        )
    return found


def start_conditions(scene: Scene) -> Start:
    """What the mesh rules ask about the line as a whole."""
    rho = scene.environment.water_density
    drag = mass = 0.0
    for cable in scene.cables:
        kind = scene.cable_types[cable.type]
        drag += rho * kind.drag_normal * kind.diameter * cable.length
        mass += kind.mass * cable.length
    return Start(
        slack=scene.initial.kind != "static",
        damping=drag * scene.line_length / mass,
        free_end=scene.end.kind == "free",
        bare=_is_bare(scene),
    )


def _is_bare(scene: Scene) -> bool:
    """See mesh.Start."""
    environment = scene.environment
    return (
        scene.vessel.connection.kind == "pinned"
        and len(scene.line) == 1
        and not scene.payout.drum
        and not pays_out(scene)
        and environment.current is None
        and environment.waves is None
        and not floor_is_in_reach(scene)
        and scene.motion().is_planar()
    )


def _runs_out_onto_floor(scene: Scene) -> bool:
    """Whether a line with a free end runs out at t = 0 and may lie on the floor."""
    return scene.rate_at_start > 0.0 and scene.end.kind == "free" and floor_is_in_reach(scene)


def height_over_floor(scene: Scene) -> float:
    """Least distance of the tow point from the floor at t = 0, if there is one [m]."""
    floor = scene.environment.floor
    if floor is None:
        return math.inf
    x, y, z = scene.motion().evaluate(0.0)[0]
    top = floor.height(x, y) if floor.z is not None else float(floor.grid_z.max())
    slope = math.hypot(*floor.slope) if floor.z is not None else 0.0
    return float((z - top) / math.hypot(1.0, slope))


def floor_is_in_reach(scene: Scene) -> bool:
    """Whether the line is so long that it may touch the floor below the tow point at t = 0."""
    return height_over_floor(scene) < scene.line_length + bodies_length(scene)


def sinks(scene: Scene) -> bool:
    """Whether the line as a whole sinks."""
    weight = math.fsum(
        cable.length * scene.cable_types[cable.type].submerged_weight for cable in scene.cables
    )
    return weight + math.fsum(body.submerged_weight for body in scene.bodies) >= 0.0


def bodies_length(scene: Scene) -> float:
    """Length of the bodies that are out at t = 0 [m]."""
    return math.fsum(2.0 * body.half_length for body in scene.bodies)


def pays_out(scene: Scene) -> bool:
    """Whether cable runs past the tow point, or may where that is clamped: a drum holds some."""
    if scene.payout.drum and scene.vessel.connection.kind == "clamped":
        return True
    return any(row.rate != 0.0 for row in scene.payout.rate)


def is_flexible(scene: CableScene, cable: Cable) -> bool:
    """Whether a cable passes no moment."""
    return cable.model == "cable" or scene.cable_types[cable.type].bending_stiffness == 0.0
