"""From the scene of a system to a block at its initial state."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from cablemodel.block import Block
from cablemodel.errors import SceneError, StaticsError
from cablemodel.instance.first_state import count_from_zero
from cablemodel.instance.line_tables import STABILISATION, edge_row, fill_body
from cablemodel.instance.refinement import BENT, LARGEST_STATIC_MESH, ROUNDS
from cablemodel.instance.scales import is_flexible
from cablemodel.instance.tables import fill_current, fill_settings
from cablemodel.kernels import layout as at
from cablemodel.kernels.layout import Header, Scalars
from cablemodel.mesh import Span, Start, line_nodes
from cablemodel.scene import Scene
from cablemodel.scene.motion import jumps
from cablemodel.systems.guess import Guess, axes_of, first_guess
from cablemodel.systems.motion import first_angles, turning
from cablemodel.systems.scene import FreeBody, SystemLine, SystemScene
from cablemodel.systems.tree import Tree, tree_of

FloatArray = NDArray[np.float64]


@dataclass
class Built:
    """A block with what tells its nodes."""

    block: Block
    tree: Tree
    cables: list[tuple[str, int]]
    """Line and item of each row of the cable table."""


def build(scene: SystemScene) -> Built:
    """A block at the system's initial state, t = 0: at rest in the frame of its vessels.

    Raises:
        SceneError: vessels that move apart at t = 0, a cycle of free bodies.
        StaticsError: no equilibrium was found.
    """
    velocity = steady_velocity(scene)
    nodes = {name: _nodes(scene, name) for name in scene.lines}
    guess = first_guess(scene, velocity)
    built = _solved(scene, nodes, guess, None, velocity)
    for _round in range(ROUNDS):
        finer = _refined(scene, nodes, built)
        if finer is None:
            break
        nodes = finer
        built = _solved(scene, nodes, guess, built, velocity)
    return built


def steady_velocity(scene: SystemScene) -> FloatArray:
    """Velocity of the frame in which the system is at rest at t = 0, (3,) [m/s].

    Raises:
        SceneError: there is none.
    """
    found: FloatArray | None = None
    first = ""
    for name, vessel in scene.vessels.items():
        used = any(
            end.point is not None and end.point.partition(".")[0] == name
            for line in scene.lines.values()
            for end in line.ends
        )
        if not used:
            continue
        own = vessel.motion().evaluate(0.0)[1]
        if found is not None and np.linalg.norm(own - found) > 1e-9 * (1.0 + np.linalg.norm(own)):
            raise SceneError.at(
                f"vessels.{name}",
                own.tolist(),
                f"its velocity at t = 0 is not that of {first!r}: there is no steady state",
                "vessels that begin with one velocity",
            )
        found, first = own, name
    anchored = any(end.anchor is not None for line in scene.lines.values() for end in line.ends)
    if found is None:
        return np.zeros(3)
    if anchored and np.any(found != 0.0):
        raise SceneError.at(
            f"vessels.{first}",
            found.tolist(),
            "a system that is anchored has no steady state while a vessel moves",
            "vessels at rest at t = 0",
        )
    return np.asarray(found, dtype=np.float64)


def _flexible(scene: SystemScene, line: SystemLine, index: int) -> bool:
    cable = line.items[index].cable
    assert cable is not None
    return is_flexible(cast(Scene, scene), cable)  # its cable types alone


def _nodes(scene: SystemScene, name: str) -> list[FloatArray]:
    """Arc lengths of the nodes of a line's cables, with nodes at all branches."""
    line = scene.lines[name]
    spans = []
    places = [index for index, item in enumerate(line.items) if item.cable is not None]
    for index in places:
        cable = line.items[index].cable
        assert cable is not None
        layers = []
        for end, here in ((line.start, index == places[0]), (line.end, index == places[-1])):
            clamped = end.clamped is not None and here and not _flexible(scene, line, index)
            stiffness = scene.cable_types[cable.type].bending_stiffness
            layers.append(math.sqrt(stiffness / _scale(scene)) if clamped else math.inf)
        spans.append(Span(cable.length, cable.elements, layers[0], layers[1]))
    nodes = line_nodes(spans, scene.solver.tolerance, _start_of(scene, name))
    offset = 0.0
    for k, own in enumerate(nodes):
        ends = [
            end.at - offset
            for other in scene.lines.values()
            for end in other.ends
            if end.line == name and end.at is not None
        ]
        within = [place for place in ends if 0.0 < place < own[-1]]
        nodes[k] = np.unique(np.concatenate([own, within]))
        offset += float(own[-1])
    return nodes


def _start_of(scene: SystemScene, name: str) -> Start:
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


def _scale(scene: SystemScene) -> float:
    """A typical tension of the system [N]."""
    gravity = scene.environment.gravity
    total = 0.0
    for line in scene.lines.values():
        for item in line.items:
            if item.cable is not None:
                kind = scene.cable_types[item.cable.type]
                weight = max(abs(kind.submerged_weight), 1e-3 * kind.mass * gravity)
                total += weight * item.cable.length
            elif item.body is not None:
                total += abs(item.body.submerged_weight)
    total += sum(abs(body.submerged_weight) for body in scene.bodies.values())
    speed = float(np.linalg.norm(steady_velocity(scene)))
    rho = scene.environment.water_density
    for body in scene.bodies.values():
        total += 0.5 * rho * speed**2 * float(np.mean(body.drag_area))
    return max(total, 1e-6)


def _solved(
    scene: SystemScene,
    nodes: dict[str, list[FloatArray]],
    guess: Guess,
    before: Built | None,
    velocity: FloatArray,
) -> Built:
    """A block on given nodes, at rest; from another one on coarser nodes where there is one."""
    from cablemodel import library as entry

    tree = tree_of(scene, nodes)
    built = _allocated(scene, tree)
    block = built.block
    ints, reals = block.ints, block.reals
    head = Header(ints)
    state = Scalars(reals)
    _fill_settings(scene, built)
    _fill_cables(scene, built)
    _fill_frames(scene, block)
    _fill_held(scene, built)
    _fill_bodies(scene, built, guess, before)
    _place(scene, built, guess, before)
    entry.place_supports(ints, reals)
    scale = state.tension_scale
    for _attempt in range(2):
        status = int(entry.equilibrium(ints, reals, velocity.copy()))
        if status != at.OK:
            line, arc = tree.arcs[min(block.failed_node, len(tree.arcs) - 1)]
            raise StaticsError(
                f"no static equilibrium of the system was found; what moved last is {line!r} at "
                f"{arc:g} m. Check weights, lengths and attachments"
            )
        tension = block.array(Header.tension, len(tree.parent), 2)[:, 0]
        largest = float(np.abs(tension).max())
        if largest <= scale:
            break
        edges = block.array(Header.edges, len(tree.parent), at.EDGE_WORDS)
        for node in tree.elements:
            row = edges[node]
            row[at.E_STABILISATION] = min(
                max(row[at.E_STABILISATION], STABILISATION * largest), 1.0 / row[at.E_COMPLIANCE]
            )
        scale = math.inf
    acceleration = block.array(Header.acceleration, len(tree.parent), 6).copy()
    entry.place_supports(ints, reals)
    block.array(Header.acceleration, len(tree.parent), 6)[:] = acceleration
    count_from_zero(block)
    if head.hybrid:
        entry.choose_bending(ints, reals)
    return built


def _allocated(scene: SystemScene, tree: Tree) -> Built:
    current = scene.environment.current
    cables = [
        (name, index)
        for name, line in scene.lines.items()
        for index, item in enumerate(line.items)
        if item.cable is not None
    ]
    foils = [foil for body in scene.bodies.values() for foil in body.foils.values()]
    types = [scene.cable_types[_cable(scene, *place).type] for place in cables]
    pieces = sum(
        len(vessel.motion().pieces) + len(turning(vessel)) for vessel in scene.vessels.values()
    )
    block = Block(
        capacity=len(tree.parent),
        pieces=2,
        depths=1 if current is None else len(current.z),
        times=1 if current is None else len(current.t),
        strain_words=sum(len(kind.strain_coefficients) for kind in types),
        bodies=len(tree.masses),
        constraints=len(tree.held),
        rates=1,
        cables=len(cables),
        floor_words=0,
        waves=0,
        cell_terms=0,
        frames=len(scene.vessels),
        frame_pieces=pieces,
        free_bodies=len(scene.bodies),
        arms=len(tree.arms),
        foils=len(foils),
        foil_words=2 * at.FOIL_ANGLES * len(foils),
    )
    block.header.parts = 1
    block.header.nodes = len(tree.parent)
    block.header.dimension = 3
    block.integers(Header.parent, len(tree.parent))[:] = tree.parent
    block.integers(Header.joint, len(tree.parent))[:] = tree.joint
    return Built(block, tree, cables)


def _cable(scene: SystemScene, name: str, index: int) -> Any:
    cable = scene.lines[name].items[index].cable
    assert cable is not None
    return cable


def _fill_settings(scene: SystemScene, built: Built) -> None:
    """Tolerances, water, current, and what `kernels/scales.py` wants to know."""
    from cablemodel import library as entry

    block = built.block
    ints, reals = block.ints, block.reals
    state = Scalars(reals)
    fill_settings(block, cast(Scene, scene))  # its solver and water alone
    state.plane = 1.0, 0.0
    rest = block.array(Header.pieces, 2, at.PIECE_WORDS)
    rest[:, at.P_END] = math.inf
    lengths = {name: line.length for name, line in scene.lines.items()}
    longest, shortest = max(lengths.values()), min(lengths.values())
    softest, mass = 0.0, math.fsum(body.mass for body in scene.bodies.values())
    for line in scene.lines.values():
        softness = 0.0
        for item in line.items:
            if item.cable is not None:
                kind = scene.cable_types[item.cable.type]
                softness += kind.strain_coefficients[0] * item.cable.length
                mass += kind.mass * item.cable.length
            elif item.body is not None:
                mass += item.body.mass
        softest = max(softest, softness)
    facts = np.zeros(at.FACT_WORDS)
    facts[at.FACT_LENGTH] = longest
    facts[at.FACT_DAMPING] = min(_start_of(scene, name).damping for name in scene.lines)
    facts[at.FACT_SOFTNESS] = softest
    facts[at.FACT_MASS] = mass
    facts[at.FACT_TENSION] = _scale(scene)
    entry.measure(ints, reals, facts)
    # Of every line tau times its own length is promised: the shortest one decides.
    state.time_tolerance *= shortest / longest
    fill_current(block, cast(Scene, scene))  # its water alone


def _fill_cables(scene: SystemScene, built: Built) -> None:
    """Rows of all elements, and point bodies in lines."""
    block, tree = built.block, built.tree
    scale = float(block.scalars.tension_scale)
    rho = scene.environment.water_density
    strain = block.array(Header.strain, int(block.header.strain_words))
    table = block.array(Header.cables, len(built.cables), at.CABLE_WORDS)
    used = 0
    for index, ((name, item), row) in enumerate(zip(built.cables, table, strict=True)):
        cable = _cable(scene, name, item)
        kind = scene.cable_types[cable.type]
        strain[used : used + len(kind.strain_coefficients)] = kind.strain_coefficients
        offset = int(block.header.strain) + used
        used += len(kind.strain_coefficients)
        row[at.K_DISPLACED] = rho * 0.25 * math.pi * kind.diameter**2
        row[at.K_EDGE :] = edge_row(cast(Scene, scene), cable, index, offset, scale)
        if cable.model == "hybrid" and kind.bending_stiffness > 0.0:
            block.header.hybrid = 1
    rows = {place: index for index, place in enumerate(built.cables)}
    edges = block.array(Header.edges, len(tree.parent), at.EDGE_WORDS)
    for node, element in tree.elements.items():
        edges[node] = table[rows[element.line, element.cable], at.K_EDGE :]
        edges[node, at.E_LENGTH] = edges[node, at.E_NOMINAL] = element.length
        edges[node, at.E_START] = element.start
    bodies = block.array(Header.bodies, len(tree.masses), at.BODY_WORDS)
    for row, (node, body, _line, _item) in zip(bodies, tree.masses, strict=True):
        fill_body(row, node, body, rho)


def _fill_frames(scene: SystemScene, block: Block) -> None:
    """Motion of all vessels."""
    rows = block.array(Header.frames, len(scene.vessels), at.FRAME_WORDS)
    table = block.array(Header.frame_pieces, int(block.header.frame_piece_count), at.PIECE_WORDS)
    used = 0
    for row, vessel in zip(rows, scene.vessels.values(), strict=True):
        for place, pieces in (
            (at.F_FIRST, vessel.motion().pieces),
            (at.F_TURN_FIRST, turning(vessel)),
        ):
            row[place], row[place + 1] = used, len(pieces)
            own = table[used : used + len(pieces)]
            own[:] = pieces
            own[0, [at.P_VELOCITY_JUMP, at.P_ACCELERATION_JUMP]] = 0.0
            own[1:, at.P_VELOCITY_JUMP], own[1:, at.P_ACCELERATION_JUMP] = jumps(pieces)
            used += len(pieces)


def _fill_held(scene: SystemScene, built: Built) -> None:
    """Nodes at vessels' points and anchors."""
    block = built.block
    names = list(scene.vessels)
    table = block.array(Header.constraints, len(built.tree.held), at.CONSTRAINT_WORDS)
    for row, held in zip(table, built.tree.held, strict=True):
        row[at.C_NODE] = held.node
        if held.end.anchor is not None:
            row[at.C_KIND] = at.C_ANCHOR
            row[at.C_POSITION : at.C_POSITION + 3] = held.end.anchor
            continue
        assert held.end.point is not None
        owner, _dot, point = held.end.point.partition(".")
        row[at.C_KIND] = at.C_POINT
        row[at.C_FRAME] = names.index(owner)
        row[at.C_POSITION : at.C_POSITION + 3] = scene.vessels[owner].points[point]
        line = scene.lines[held.line]
        at_end = held.end is line.end
        cable = max(k for k, i in enumerate(line.items) if i.cable) if at_end else 0
        if held.end.clamped is not None and not _flexible(scene, line, cable):
            row[at.C_CLAMPED] = at.EXACTLY
            sign = 1.0 if held.outward is not at_end else -1.0  # along the way of the tree
            row[at.C_OWN_DIRECTION : at.C_OWN_DIRECTION + 3] = sign * np.array(held.end.clamped)


def cross_matrix(x: FloatArray) -> FloatArray:
    """[x] with [x] y = x x y, (3, 3)."""
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def _inertia(mass: tuple[float, ...], turning: tuple[float, ...], place: FloatArray) -> FloatArray:
    """Matrix of inertia (6, 6) about a point from which masses along the axes and moments of
    inertia about them are at a place."""
    m, c = np.diag(mass), cross_matrix(place)
    return np.block([[m, -m @ c], [c @ m, np.diag(turning) - c @ m @ c]])


def _fill_bodies(scene: SystemScene, built: Built, guess: Guess, before: Built | None) -> None:
    """Rows of the free bodies, their arms and foils."""
    block, tree = built.block, built.tree
    rho, gravity = scene.environment.water_density, scene.environment.gravity
    rows = block.array(Header.free_bodies, len(scene.bodies), at.FREE_WORDS)
    foils = block.array(Header.foils, int(block.header.foil_count), at.FOIL_WORDS)
    tables = block.array(Header.foil_table, len(foils), at.FOIL_ANGLES, 2)
    used = 0
    names = list(scene.bodies)
    edges = block.array(Header.edges, len(tree.parent), at.EDGE_WORDS)
    for index, (row, (name, body)) in enumerate(zip(rows, scene.bodies.items(), strict=True)):
        node, point = tree.bodies[name]
        reference = np.array(body.points[point] if point else (0.0, 0.0, 0.0))

        def from_reference(place: Any, reference: FloatArray = reference) -> FloatArray:
            return np.array(place) - reference

        size = _size(body)
        row[at.Y_NODE], row[at.Y_SIZE] = node, size
        edges[node, at.E_LENGTH] = size / 0.3  # increment_norm weighs turns by .3 of it
        row[at.Y_WEIGHT] = body.mass * gravity
        row[at.Y_BUOYANCY] = body.mass * gravity - body.submerged_weight
        centre, water = (
            from_reference(body.centre_of_gravity),
            from_reference(body.centre_of_buoyancy),
        )
        row[at.Y_CENTRE : at.Y_CENTRE + 3] = centre
        row[at.Y_BUOYANCY_CENTRE : at.Y_BUOYANCY_CENTRE + 3] = water
        row[at.Y_DRAG_CENTRE : at.Y_DRAG_CENTRE + 3] = from_reference(body.centre_of_drag)
        row[at.Y_DRAG : at.Y_DRAG + 3] = 0.5 * rho * np.array(body.drag_area)
        row[at.Y_TURN_DRAG : at.Y_TURN_DRAG + 3] = 0.5 * rho * np.array(body.drag_turning)
        row[at.Y_ORIGIN : at.Y_ORIGIN + 3] = -reference
        mass = (body.mass,) * 3
        row[at.Y_SOLID : at.Y_SOLID + 36] = _inertia(mass, body.inertia, centre).ravel()
        added = _inertia(body.added_mass, body.added_inertia, water)
        row[at.Y_ADDED : at.Y_ADDED + 36] = added.ravel()
        row[at.Y_ROTATION : at.Y_ROTATION + 9] = axes_of(body.attitude).ravel()
        if before is not None:
            old = before.block.array(Header.free_bodies, len(scene.bodies), at.FREE_WORDS)[index]
            row[at.Y_ROTATION : at.Y_ROTATION + 9] = old[at.Y_MOTION : at.Y_MOTION + 9]
        row[at.Y_FIRST_FOIL], row[at.Y_FOILS] = used, len(body.foils)
        for foil in body.foils.values():
            wing = foils[used]
            span = np.array(foil.span) - np.dot(foil.span, foil.chord) * np.array(foil.chord)
            wing[at.L_PLACE : at.L_PLACE + 3] = from_reference(foil.position)
            wing[at.L_CHORD : at.L_CHORD + 3] = foil.chord
            wing[at.L_SPAN : at.L_SPAN + 3] = span / np.linalg.norm(span)
            wing[at.L_AREA] = 0.5 * rho * foil.area
            wing[at.L_TABLE] = 2 * at.FOIL_ANGLES * used
            wing[at.L_DEFLECTION + 2] = wing[at.L_DEFLECTION + 3] = foil.deflection
            angles = np.linspace(-math.pi, math.pi, at.FOIL_ANGLES)
            tables[used] = foil.coefficients(angles)
            used += 1
    arms = block.array(Header.arms, len(tree.arms), at.ARM_WORDS)
    for row, (node, name, point) in zip(arms, tree.arms, strict=True):
        body = scene.bodies[name]
        own = tree.bodies[name][1]
        origin: FloatArray = np.array(body.points[own] if own else (0.0, 0.0, 0.0))
        row[at.A_NODE], row[at.A_BODY] = node, names.index(name)
        row[at.A_PLACE : at.A_PLACE + 3] = np.array(body.points[point]) - origin


def _size(body: FreeBody) -> float:
    """By how much a turn of 1 rad moves what is far out on a body [m]."""
    places = [*body.points.values(), *(foil.position for foil in body.foils.values())]
    reach = max((math.dist(a, b) for a in places for b in places), default=0.0)
    return max(reach, math.sqrt(max(body.inertia) / body.mass))


def _place(scene: SystemScene, built: Built, guess: Guess, before: Built | None) -> None:
    """Nodes along the first guess, or along the shape on coarser nodes."""
    tree = built.tree
    count = len(tree.parent)
    q = built.block.array(Header.position, count, 6)
    tension = built.block.array(Header.tension, count, 2)
    bodies = {node: name for name, (node, _point) in tree.bodies.items()}
    for node, (name, arc) in enumerate(tree.arcs):
        if node in bodies:
            body = scene.bodies[name]
            point = tree.bodies[name][1]
            arm = axes_of(body.attitude) @ np.array(body.points[point] if point else (0.0,) * 3)
            q[node, :3] = guess.bodies[name] + arm
            continue
        length = scene.lines[name].length
        near = np.clip(np.array([arc - 1e-3 * length, arc, arc + 1e-3 * length]), 0.0, length)
        places = guess.at(name, near / length)
        slope = places[2] - places[0]
        q[node, :3] = places[1]
        q[node, 3:] = slope / max(float(np.linalg.norm(slope)), 1e-30)
    for node, element in tree.elements.items():
        if element.backward:
            q[node, 3:] *= -1.0
            parent = tree.parent[node]
            if tree.joint[parent] != 0 or parent == 0:
                q[parent, 3:] *= -1.0
    rows = built.block.array(Header.constraints, len(tree.held), at.CONSTRAINT_WORDS)
    for row, held in zip(rows, tree.held, strict=True):
        if row[at.C_CLAMPED]:
            assert held.end.point is not None
            vessel = scene.vessels[held.end.point.partition(".")[0]]
            own = row[at.C_OWN_DIRECTION : at.C_OWN_DIRECTION + 3]
            q[held.node, 3:] = axes_of(first_angles(vessel)) @ own
    if before is None:
        return
    shape = Shape(before)
    for node, (name, arc) in enumerate(tree.arcs):
        if node in bodies:
            q[node, :3] = shape.bodies[name]
            continue
        q[node] = shape.at(name, arc, forward=_forward(tree, node))
    for node, element in tree.elements.items():
        tension[node, 0] = shape.tension(element.line, element.start + 0.5 * element.length)


def _forward(tree: Tree, node: int) -> bool:
    """Whether the slope at a node goes along its line from beginning to end."""
    element = tree.elements.get(node)
    if element is None:
        after = [k for k in tree.elements if tree.parent[k] == node]
        element = tree.elements[after[0]]
    return not element.backward


class Shape:
    """Cubics of a block's elements, to start from on other nodes."""

    def __init__(self, built: Built) -> None:
        tree, block = built.tree, built.block
        self.q = block.array(Header.position, len(tree.parent), 6)
        self.t = block.array(Header.tension, len(tree.parent), 2)
        self.tree = tree
        self.bodies = {name: self.q[node, :3] for name, (node, _p) in tree.bodies.items()}
        self.lines: dict[str, list[int]] = {}
        for node, element in tree.elements.items():
            self.lines.setdefault(element.line, []).append(node)

    def element(self, name: str, arc: float) -> tuple[int, float]:
        """Node of the element at an arc length, and the fraction of it along the tree's way."""
        for node in self.lines[name]:
            element = self.tree.elements[node]
            if element.start - 1e-9 <= arc <= element.start + element.length * (1.0 + 1e-12):
                x = min(1.0, max(0.0, (arc - element.start) / element.length))
                return node, 1.0 - x if element.backward else x
        raise AssertionError(f"{name} has no {arc} m")

    def at(self, name: str, arc: float, *, forward: bool) -> FloatArray:
        """Place and slope (6,) at an arc length of a line."""
        node, x = self.element(name, arc)
        element, h = self.tree.elements[node], self.tree.elements[node].length
        p, q = self.q[self.tree.parent[node]], self.q[node]
        y = 1.0 - x
        place = y * y * (1 + 2 * x) * p[:3] + h * x * y * y * p[3:]
        place = place + x * x * (3 - 2 * x) * q[:3] - h * x * x * y * q[3:]
        slope = 6 * x * y * (q[:3] - p[:3]) / h + y * (1 - 3 * x) * p[3:] + x * (3 * x - 2) * q[3:]
        if element.backward is forward:
            slope = -slope
        return np.concatenate([place, slope])

    def tension(self, name: str, arc: float) -> float:
        """Mean tension of the element there [N]."""
        return float(self.t[self.element(name, arc)[0], 0])


def _refined(
    scene: SystemScene, nodes: dict[str, list[FloatArray]], built: Built
) -> dict[str, list[FloatArray]] | None:
    """Nodes with those elements halved that bend too much (instance/refinement.py); None: none."""
    tree, block = built.tree, built.block
    q = block.array(Header.position, len(tree.parent), 6)
    bends: dict[int, tuple[FloatArray, FloatArray]] = {}
    for node, element in tree.elements.items():
        p, own, h = q[tree.parent[node]], q[node], element.length
        chord = (own[:3] - p[:3]) / h
        start = (6.0 * chord - 4.0 * p[3:] - 2.0 * own[3:]) / h
        end = (2.0 * p[3:] + 4.0 * own[3:] - 6.0 * chord) / h
        bends[node] = start, end
    indicator = {}
    for node, element in tree.elements.items():
        h, (start, end) = element.length, bends[node]
        inside = 0.25 * float(np.linalg.norm(start - end))
        parent = tree.parent[node]
        above = bends.get(parent)
        jump = inside if above is None else float(np.linalg.norm(start - above[1]))
        below = (
            bends.get(node + 1)
            if tree.parent[min(node + 1, len(tree.parent) - 1)] == node
            else None
        )
        jump = max(jump, inside if below is None else float(np.linalg.norm(below[0] - end)))
        indicator[node] = h * h * jump
    split: dict[str, set[float]] = {}
    for node, size in indicator.items():
        element = tree.elements[node]
        line = scene.lines[element.line]
        free = _cable(scene, element.line, element.cable).elements is None
        if free and size > BENT * scene.solver.tolerance * line.length:
            split.setdefault(element.line, set()).add(element.start + 0.5 * element.length)
    if not split or len(tree.parent) > LARGEST_STATIC_MESH:
        return None
    finer = {}
    for name, cables in nodes.items():
        offset, new = 0.0, []
        for places in cables:
            last = float(places[-1])
            more = [m - offset for m in split.get(name, ()) if 0.0 < m - offset < last]
            new.append(np.unique(np.concatenate([places, more])))
            offset += last
        finer[name] = new
    return finer
