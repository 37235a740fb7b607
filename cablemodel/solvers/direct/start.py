"""The direct solver's initial state: shape, angles, tensions, and the steady state from them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.direct.block import DirectBlock
from cablemodel.solvers.direct.kernels import layout as own
from cablemodel.solvers.direct.sections import Section
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.curves import hermite, way_along
from cablemodel.solvers.shared.layout import Header
from cablemodel.solvers.shared.scene_numbers import shared_direction

if TYPE_CHECKING:
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]
STRAIN_ROUNDS = 50
"""Of Newton's method, for the tension of a strain."""


@dataclass(frozen=True)
class Plane:
    """The vertical plane of a scene."""

    direction: FloatArray
    """Horizontal unit vector (2,): the paper's e2."""
    flat: bool
    """Whether all of the scene lies in it."""


def vertical_plane(scene: Scene) -> Plane:
    """The plane of the motion and of all else; e2 along the first of them where they differ."""
    motion = scene.motion()
    moving = motion.horizontal_direction()
    _, velocity, _ = motion.evaluate(0.0)
    candidates = [velocity[:2]]
    candidates += [] if moving is None else [np.asarray(moving, dtype=float)]
    candidates += [direction[:2] for direction in _directions(scene)]
    if scene.environment.current is not None:
        candidates += list(scene.environment.current.velocity.reshape(-1, 3)[:, :2])
    if scene.environment.floor is not None:
        candidates.append(np.asarray(scene.environment.floor.slope, dtype=float))
    e2, shared = shared_direction(candidates)
    return Plane(e2, shared and bool(motion.is_planar()))


def _directions(scene: Scene) -> list[FloatArray]:
    """Directions that the scene gives for its cable."""
    found = [
        np.asarray(connection.direction, dtype=float)
        for connection in (scene.vessel.connection, scene.end.connection)
        if connection.kind == "clamped"
    ]
    if scene.initial.kind == "straight":
        found.append(np.asarray(scene.initial.direction, dtype=float))
    elif scene.initial.kind == "points":
        points = np.asarray(scene.initial.points, dtype=float)
        found += list(np.diff(points, axis=0))
    return found


def find_initial_state(block: DirectBlock, scene: Scene, sections: list[Section]) -> int:
    """Fill the nodes with the scene's start; returns the status of the steady state."""
    from cablemodel.solvers.direct import library as entry

    ints, reals = block.ints, block.reals
    _, velocity, _ = scene.motion().evaluate(0.0)
    nodes = sum(len(section.lengths) + 1 for section in sections)
    y = block.array(own.OwnHeader.unknowns, nodes, own.WIDTH)
    y[:, [own.PHI, own.THETA]] = _angles(block, scene, sections)
    _clamp(block, scene, y)
    if scene.end.kind == "anchor":
        assert scene.end.position is not None
        reals[own.OwnScalars.anchor.span] = scene.end.position
    if scene.initial.kind == "static":
        y[:, own.F3] = _hanging_tension(scene, sections)
        _set_velocity(block, y, velocity)
        entry.place(ints, reals, 0.0)
        status = entry.equilibrium(ints, reals)
    else:
        if scene.initial.kind == "points":
            points = np.asarray(scene.initial.points, dtype=float)
            length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
            y[:, own.F3] = _tension_of(scene, sections, length / scene.line_length - 1.0)
            _curvatures(y, sections)
        rates = scene.payout.rate
        if rates and rates[0].t <= 0.0:
            # Cable that is paid out from the start on moves along itself: at rest it would answer
            # with an axial shock of EA rate / c.
            y[:, own.V3] = rates[0].rate
        entry.place(ints, reals, 0.0)
        entry.assemble(ints, reals)  # gives the bodies their velocities
        status = at.OK
    for counter in (
        Header.steps.word,
        Header.rejected.word,
        Header.factorisations.word,
        Header.iterations.word,
    ):
        ints[counter] = 0
    return int(status)


def _paper_axes(block: DirectBlock, vectors: FloatArray) -> FloatArray:
    """Earth-frame vectors (n, 3) along e1 (down), e2, e3."""
    px, py = block.scalars.plane
    x, y, z = vectors.T
    return np.stack([-z, px * x + py * y, py * x - px * y], axis=1)


def _euler(block: DirectBlock, tangents: FloatArray) -> FloatArray:
    """phi and theta (n, 2) of unit tangents (n, 3); phi without jumps along the line."""
    t = _paper_axes(block, tangents)
    phi = np.unwrap(np.arctan2(t[:, 0], -t[:, 1]))
    return np.stack([phi, np.arccos(np.clip(t[:, 2], -1.0, 1.0))], axis=1)


def _angles(block: DirectBlock, scene: Scene, sections: list[Section]) -> FloatArray:
    """Angles of all nodes of the scene's start."""
    arcs = _node_arcs(sections)
    if scene.initial.kind == "points":
        points = np.asarray(scene.initial.points, dtype=float)
        places = way_along(points)
        if len(points) == 2:
            tangents = np.tile(points[1] - points[0], (len(arcs), 1))
        else:
            where = np.minimum(arcs * places[-1] / scene.line_length, places[-1])
            slopes = np.gradient(points, places, axis=0)
            tangents = hermite(where, places, points.T, slopes.T)[1].T
        tangents = tangents / np.linalg.norm(tangents, axis=1)[:, None]
        return _euler(block, tangents)
    if scene.initial.kind == "straight":
        direction = np.asarray(scene.initial.direction, dtype=float)
    elif scene.vessel.connection.kind == "clamped":
        direction = np.asarray(scene.vessel.connection.direction, dtype=float)
    else:
        weight = _hanging_tension(scene, sections, signed=True)[0]
        direction = np.array([0.0, 0.0, -1.0 if weight >= 0.0 else 1.0])
    direction = direction / np.linalg.norm(direction)
    return _euler(block, np.tile(direction, (len(arcs), 1)))


def _node_arcs(sections: list[Section]) -> FloatArray:
    """Unstretched arc length of every node from the vessel [m]."""
    arcs = []
    arc = 0.0
    for section in sections:
        arcs.append(arc + np.concatenate([[0.0], np.cumsum(section.lengths)]))
        arc += section.length
    return np.concatenate(arcs)


def _hanging_tension(scene: Scene, sections: list[Section], *, signed: bool = False) -> FloatArray:
    """Tension of every node of the line hanging straight down (or up) at rest [N]."""
    tensions: list[FloatArray] = []
    points = list(scene.bodies)
    total = 0.0
    if scene.line[-1].body is not None and scene.line[-1].body.half_length == 0.0:
        total = points[-1].submerged_weight
    for section in reversed(sections):
        if section.cable is None:
            below = total
            total += points[section.body].submerged_weight
            tensions.append(np.array([total, below]))
        else:
            weight = scene.cable_types[section.cable.type].submerged_weight
            to_go = section.length - np.concatenate([[0.0], np.cumsum(section.lengths)])
            tensions.append(total + weight * to_go)
            total += weight * section.length
        if section.point >= 0:
            total += points[section.point].submerged_weight
    found = np.concatenate(tensions[::-1])
    return found if signed else np.abs(found)


def _set_velocity(block: DirectBlock, y: FloatArray, velocity: FloatArray) -> None:
    """Every node moves with the vessel."""
    g = _paper_axes(block, velocity[None, :])[0]
    phi, theta = y[:, own.PHI], y[:, own.THETA]
    sp, cp, st, ct = np.sin(phi), np.cos(phi), np.sin(theta), np.cos(theta)
    y[:, own.V1] = cp * g[0] + sp * g[1]
    y[:, own.V2] = -sp * ct * g[0] + cp * ct * g[1] + st * g[2]
    y[:, own.V3] = sp * st * g[0] - cp * st * g[1] + ct * g[2]


def _clamp(block: DirectBlock, scene: Scene, y: FloatArray) -> None:
    """Angles of clamped ends, on the branch of the angles next to them."""
    ends = (
        (0, scene.vessel.connection, 0),
        (1, scene.end.connection, len(y) - 1),
    )
    for end, connection, node in ends:
        if connection.kind != "clamped":
            continue
        direction = np.asarray(connection.direction, dtype=float)
        phi, theta = _euler(block, (direction / np.linalg.norm(direction))[None, :])[0]
        phi += 2.0 * math.pi * round((y[node, own.PHI] - phi) / (2.0 * math.pi))
        block.ints[own.OwnHeader.clamped] |= 1 << end
        at_end = own.OwnScalars.clamp.place + 2 * end
        block.reals[at_end : at_end + 2] = phi, theta


def _tension_of(scene: Scene, sections: list[Section], strain: float) -> FloatArray:
    """Tension of every node at an even strain [N]."""
    tensions = []
    for section in sections:
        tension = 0.0
        if section.cable is not None:
            coefficients = scene.cable_types[section.cable.type].strain_coefficients
            tension = strain / coefficients[0]
            for _ in range(STRAIN_ROUNDS):
                value = sum(c * tension ** (n + 1) for n, c in enumerate(coefficients))
                slope = sum((n + 1) * c * tension**n for n, c in enumerate(coefficients))
                tension -= (value - strain) / slope
        tensions.append(np.full(len(section.lengths) + 1, tension))
    return np.concatenate(tensions)


def _curvatures(y: FloatArray, sections: list[Section]) -> None:
    """Curvatures of the parts that bend, from the differences of their angles."""
    first = 0
    for section in sections:
        count = len(section.lengths) + 1
        if section.kind == own.ELASTICA:
            arcs = np.concatenate([[0.0], np.cumsum(section.lengths)])
            rows = y[first : first + count]
            rows[:, own.K1] = np.gradient(rows[:, own.THETA], arcs)
            rows[:, own.K2] = np.gradient(rows[:, own.PHI], arcs) * np.sin(rows[:, own.THETA])
        first += count
