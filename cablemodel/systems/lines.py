"""What a system's lines are like: their nodes at first, typical forces, the frame at rest."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import SceneError
from cablemodel.scene.line import Cable
from cablemodel.scene.motion import AT_REST
from cablemodel.solvers.finite_element.mesh import Span, Start, line_nodes
from cablemodel.solvers.finite_element.start.scales import is_flexible
from cablemodel.solvers.shared.numbers import ONE_PLACE
from cablemodel.systems.guess import standing
from cablemodel.systems.scene import LineEnd, SystemLine, SystemScene

FloatArray = NDArray[np.float64]


def flexible_at(scene: SystemScene, line: SystemLine, index: int) -> bool:
    """Whether a cable of a line, by the number of its item, passes no moment."""
    cable = line.items[index].cable
    assert cable is not None
    return is_flexible(scene, cable)


def bends_at(scene: SystemScene, line: SystemLine, end: LineEnd) -> bool:
    """Whether an end of a line is clamped, and its cable there passes a moment."""
    cables = [index for index, item in enumerate(line.items) if item.cable is not None]
    last = cables[0 if end is line.start else -1]
    return end.clamped is not None and not flexible_at(scene, line, last)


def nodes_of(scene: SystemScene, name: str) -> list[FloatArray]:
    """Arc lengths of the nodes of a line's cables, with nodes at all branches."""
    line = scene.lines[name]
    spans = []
    places = [index for index, item in enumerate(line.items) if item.cable is not None]
    for index in places:
        cable = line.items[index].cable
        assert cable is not None
        layers = []
        for end, here in ((line.start, index == places[0]), (line.end, index == places[-1])):
            clamped = here and bends_at(scene, line, end)
            stiffness = scene.cable_types[cable.type].bending_stiffness
            layers.append(math.sqrt(stiffness / tension_scale(scene)) if clamped else math.inf)
        spans.append(Span(cable.length, cable.elements, layers[0], layers[1]))
    nodes = line_nodes(spans, scene.solver.tolerance, start_of(scene, name))
    offset = 0.0
    for k, own in enumerate(nodes):
        ends = [
            end.at - offset
            for other in scene.lines.values()
            for end in other.ends
            if end.line == name and end.at is not None
        ]
        # Lengths add up to a place to rounding: no element is as short as that.
        within = [p for p in ends if 0.0 < p < own[-1] and np.abs(own - p).min() > ONE_PLACE]
        nodes[k] = np.unique(np.concatenate([own, within]))
        offset += float(own[-1])
    return nodes


def start_of(scene: SystemScene, name: str) -> Start:
    """What a line is like as it starts."""
    line = scene.lines[name]
    rho = scene.environment.water_density
    drag = mass = 0.0
    for item in line.items:
        if item.cable is not None:
            kind = scene.cable_types[item.cable.type]
            drag += rho * kind.drag_normal * kind.diameter * item.cable.length
            mass += kind.mass * item.cable.length
    free = any(end.is_free for end in line.ends)
    return Start(slack=False, damping=drag * line.length / mass, free_end=free)


LEAST_TENSION = 1e-6
"""A typical tension where nothing weighs [N]."""
FOR_EVER = 1e30
"""How many times as long a motion goes on that nothing slows down."""


def memory_of_bodies(scene: SystemScene) -> float:
    """How many times as long as of a cable the motion of a body goes on, at least 1: by the drag
    area over the mass, of the body that drag slows down least."""
    cables = [scene.cable_types[cable.type] for cable in scene.cables]
    bodies = [
        float(np.mean(body.drag_area)) / (body.mass + float(np.mean(body.added_mass)))
        for body in scene.bodies.values()
    ]
    points = [item.body for line in scene.lines.values() for item in line.items if item.body]
    bodies += [
        body.drag_coefficient * body.drag_area / (body.mass + body.added_mass) for body in points
    ]
    cable = min(kind.drag_normal * kind.diameter / kind.mass for kind in cables)
    slowest = min(bodies, default=cable)
    if cable <= slowest:
        return 1.0
    return cable / slowest if slowest > 0.0 else FOR_EVER


def tension_scale(scene: SystemScene) -> float:
    """A typical tension of the system [N]."""
    gravity, total = scene.environment.gravity, 0.0
    for line in scene.lines.values():
        for cable in (item.cable for item in line.items if item.cable is not None):
            total += scene.cable_types[cable.type].typical_weight(gravity) * cable.length
    return total + tension_of_bodies(scene)


def tension_of_bodies(scene: SystemScene) -> float:
    """What bodies add to that, with a least [N]."""
    items = [item for line in scene.lines.values() for item in line.items]
    total = sum(abs(item.body.submerged_weight) for item in items if item.body is not None)
    total += sum(abs(body.weight_in(scene.environment)) for body in scene.bodies.values())
    speed = float(np.linalg.norm(steady_velocity(scene)))
    rho = scene.environment.water_density
    for body in scene.bodies.values():
        total += 0.5 * rho * speed**2 * float(np.mean(body.drag_area))
    return max(total, LEAST_TENSION)


def is_adrift(scene: SystemScene) -> bool:
    """Whether nothing holds it: no vessel, anchor, or body that stands on the floor."""
    ends = [end for line in scene.lines.values() for end in line.ends]
    owners = {end.owner for end in ends}
    anchored = any(end.anchor is not None for end in ends)
    return not (anchored or owners & scene.vessels.keys() or standing(scene))


def flows_at_start(scene: SystemScene) -> FloatArray:
    """Velocities of the water at t = 0 at the depths of the current's table (n, 3) [m/s]."""
    current = scene.environment.current
    if current is None:
        return np.zeros((1, 3))
    by_depth = current.velocity.transpose(1, 2, 0)
    return np.array([[np.interp(0.0, current.t, own) for own in rows] for rows in by_depth])


def steady_velocity(scene: SystemScene) -> FloatArray:
    """Velocity of the frame in which the system is at rest at t = 0, (3,) [m/s]: that of its
    vessels, or of the water where nothing holds it. Lines that start alone have their own.

    Raises:
        SceneError: there is none.
    """
    found: FloatArray | None = None
    first = ""
    alone = {winch.line for name, winch in scene.winches.items() if scene.runs_alone(name)}
    ends = [end for name, line in scene.lines.items() if name not in alone for end in line.ends]
    for name, vessel in scene.vessels.items():
        if not any(end.owner == name for end in ends):
            continue
        own = vessel.motion().evaluate(0.0)[1]
        if found is not None and np.linalg.norm(own - found) > AT_REST * (
            1.0 + np.linalg.norm(own)
        ):
            raise SceneError.at(
                f"vessels.{name}",
                own.tolist(),
                f"its velocity at t = 0 is not that of {first!r}: there is no steady state",
                "vessels that begin with one velocity",
            )
        found, first = own, name
    if found is None and not ends:
        return np.zeros(3)
    anchored = any(end.anchor is not None for end in ends)
    if found is None:
        rows = flows_at_start(scene) if is_adrift(scene) else np.zeros((1, 3))
        if np.ptp(rows, axis=0).max() > 0.0:
            raise SceneError.at(
                "environment.current",
                rows.tolist(),
                "it differs over depth, and nothing holds the system: how fast it drifts at t = 0 "
                "is not computed",
                "a vessel to which a line of it is tied (cut it there to let the system drift)",
            )
        return np.asarray(rows[0])
    if anchored and np.linalg.norm(found) > AT_REST:
        raise SceneError.at(
            f"vessels.{first}",
            found.tolist(),
            "a system that is anchored has no steady state while a vessel moves",
            "vessels at rest at t = 0",
        )
    return np.asarray(found, dtype=np.float64)


def cable_of(scene: SystemScene, line: str, item: int) -> Cable:
    """A cable of a line, by the number of its item."""
    cable = scene.lines[line].items[item].cable
    assert cable is not None
    return cable


def mesh_may_change(scene: SystemScene) -> bool:
    """Whether no line asks for a number of elements."""
    return all(cable.elements is None for cable in (*scene.cables, *scene.drum_cables))
