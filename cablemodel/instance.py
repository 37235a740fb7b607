"""From a scene to an instance block at its initial state."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel import laid_shape, sea_floor, waves
from cablemodel.block import Block
from cablemodel.errors import SceneError, SceneProblem, StaticsError
from cablemodel.kernels import layout as at
from cablemodel.mesh import Span, Start, line_nodes
from cablemodel.scene.sea import sea

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.line import Body, Cable

FloatArray = NDArray[np.float64]

_MODELS = {"elastica": 0.0, "cable": 1.0, "hybrid": 2.0}
_OUT_OF_PLANE = 1e-12
STABILISATION = 3.0
"""Stiffness of the stabilised tangential mode, in units of a typical tension."""
REFINEMENTS = 14
BENT = 10.0
"""Of tau L: what h^2 times the jump of curvature may be in a static shape."""
LARGEST_STATIC_MESH = 4000
SPARE_NODES = 16  # for joints at the vessel, and for a short line that is paid out again
SHORTEST_LINE = 0.01
"""Of the initial length: what reel-in leaves out."""
SHORTEST_PIECE = 0.1
"""Of an element: cable that must be out before the joint below it leaves the drum."""
TIME_TOLERANCE = 0.045
"""Local error allowed in a step, in units of tau L; calibrated, see docs/engine.md."""
RIGID = 1e7
"""Least axial stiffness of a body of finite length, in units of a typical tension."""
SOFTEST = 3e-5
"""Its largest axial compliance, in units of that of the line."""
UNDAMPED = 0.08
"""Factor on it in a vacuum, at tau = 1e-3."""


def refuse_unsupported(scene: Scene) -> None:
    """Raise a SceneError for parts of a scene that this engine does not simulate."""
    problems: list[SceneProblem] = []

    def refuse(path: str, value: object, what: str, allowed: str) -> None:
        problems.append(SceneProblem(path, value, f"{what} not supported yet", allowed))

    for index, item in enumerate(scene.payout.drum):
        if item.body is not None and item.body.half_length > 0.0:
            path = f"payout.drum.{index}.body.half_length"
            length = item.body.half_length
            refuse(path, length, "a body of finite length on the drum is", "0 (a point body)")
    for part, items in (("line", scene.line), ("payout.drum", scene.payout.drum)):
        for index, item in enumerate(items):
            if item.body is not None and item.body.rotary_inertia > 0.0 == item.body.half_length:
                path = f"{part}.{index}.body.rotary_inertia"
                what = "a point body with rotary inertia is"
                refuse(path, item.body.rotary_inertia, what, "0, or a half_length")
    if scene.payout.drum and scene.payout.drum[-1].body is not None:
        path = f"payout.drum.{len(scene.payout.drum) - 1}"
        what = "a body at the inner end of the drum never leaves it: this is"
        refuse(path, "body", what, "a cable last")
    if scene.solver.method != "finite_element":
        method = scene.solver.method
        problems.append(
            SceneProblem(
                "solver.method", method, f"{method} has no finite elements", "finite_element"
            )
        )
    if problems:
        raise SceneError(problems)


@dataclass
class _Line:
    """The line as nodes and edges, before it goes into a block."""

    parent: list[int]
    joint: list[int]
    length: list[float]
    start: list[float]
    cable: list[int]
    passed: list[float]
    """Length of the bodies between the vessel and each node [m]: not cable, but in the way."""
    bodies: list[tuple[int, Body, int]]
    """Node (-1: on the drum), body, its place in the scene's line and drum.

    The node of a body of finite length is its outer attachment, its parent the inner one."""
    nominal: list[float]
    """Length of an element of every cable of the line [m]."""

    @property
    def nodes(self) -> int:
        return len(self.parent)


def _start(scene: Scene) -> Start:
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
    )


def _spans(scene: Scene, scale: float) -> list[Span]:
    """The cables as the mesh sees them: bending layers at clamps, and at bodies of an elastica."""
    spans = []
    items = list(scene.line)
    clamped = scene.vessel.connection.kind == "clamped"
    for place, item in enumerate(items):
        if item.cable is None:
            clamped = item.body is not None
            continue
        cable = item.cable
        kind = scene.cable_types[cable.type]
        layer = math.inf if cable.model == "cable" else math.sqrt(kind.bending_stiffness / scale)
        last = place == len(items) - 1
        ends_clamped = scene.end.connection.kind == "clamped" if last else False
        body = None if last else items[place + 1].body
        # A point body at the end bends nothing.
        before_body = body is not None and (body.half_length > 0.0 or place + 2 < len(items))
        body_layer = cable.model == "elastica"
        at_start = clamped and (place == 0 or body_layer)
        at_end = ends_clamped or (before_body and body_layer)
        spans.append(
            Span(
                cable.length,
                cable.elements,
                layer if at_start else math.inf,
                layer if at_end else math.inf,
            )
        )
        clamped = False
    return spans


def _mesh(scene: Scene, spaced: list[FloatArray]) -> _Line:
    """Joints and bodies of the scene's line on the nodes of its cables, vessel first."""
    items = list(scene.line)
    line = _Line([-1], [0], [0.0], [0.0], [0], [0.0], [], [])
    arc = 0.0
    index = -1
    previous: Cable | None = None
    body: Body | None = None

    def add(joint: int, length: float, start: float, ahead: float = 0.0) -> None:
        line.parent.append(line.nodes - 1)
        line.joint.append(joint)
        line.length.append(length)
        line.start.append(start)
        line.cable.append(index)
        line.passed.append(line.passed[-1] + ahead)

    for place, item in enumerate(items):
        if item.body is not None:
            body = item.body
            if body.half_length > 0.0:
                add(at.JOINT_BODY, 0.0, arc, 2.0 * body.half_length)
            line.bodies.append((line.nodes - 1, body, place))
            continue
        cable = item.cable
        assert cable is not None
        index += 1
        rigid = body is not None and body.half_length > 0.0
        if previous is not None and not rigid and _hinged(previous, cable, body is not None):
            add(at.JOINT_HINGE, 0.0, arc)
        nodes = spaced[index]
        line.nominal.append(float(np.max(np.diff(nodes))))
        for left, right in itertools.pairwise(nodes):
            add(at.JOINT_NONE, float(right - left), arc + float(left))
        arc += cable.length
        previous = cable
        body = None
    return line


def _strain_range(coefficients: tuple[float, ...]) -> tuple[float, float]:
    """Tensions [N] between which the curve is used as it is; its tangents continue it outside.

    A polynomial is fitted to pulls: below zero its tangent there is taken, and above, the curve
    ends where its slope has fallen to a tenth of the slope at rest.
    """
    if len(coefficients) == 1:
        return -math.inf, math.inf
    slope = np.array([(n + 1) * c for n, c in enumerate(coefficients)])
    slope[0] *= 0.9
    roots = np.asarray(np.polynomial.polynomial.polyroots(slope), dtype=np.complex128)
    real = [float(root.real) for root in roots if abs(root.imag) < 1e-9 * abs(root)]
    real = [tension for tension in real if tension > 0.0]
    return 0.0, min(real, default=math.inf)


def _tension_scale(scene: Scene) -> float:
    """A tension [N] that is typical of the line: what the stabilisation is measured by."""
    scale = 0.0
    for cable, tension in zip(scene.cables, tension_per_length(scene), strict=True):
        scale += cable.length * tension
    for body in scene.bodies:
        scale += abs(body.submerged_weight)
    return scale


def tension_per_length(scene: Scene) -> list[float]:
    """What each cable of the line adds to a typical tension, per length [N/m].

    Weight of all that hangs, and the drag of the line broadside to the fastest relative flow.
    """
    rho = scene.environment.water_density
    gravity = scene.environment.gravity
    motion = scene.motion()
    pieces = motion.pieces
    speed = 0.0
    for t in [*pieces[:, 0], *np.minimum(pieces[:, 1], pieces[:, 0] + 1.0)]:
        speed = max(speed, float(np.linalg.norm(motion.evaluate(float(t))[1])))
    if scene.environment.current is not None:
        speed += float(np.max(np.linalg.norm(scene.environment.current.velocity, axis=-1)))
    water = sea(scene)
    if water is not None:
        speed += water.speed
    found = []
    for kind in (scene.cable_types[cable.type] for cable in scene.cables):
        weight = max(abs(kind.submerged_weight), 1e-3 * kind.mass * gravity)
        found.append(weight + 0.5 * rho * kind.drag_normal * kind.diameter * speed**2 * 0.1)
    return found


def _vertical_plane(scene: Scene, directions: list[FloatArray]) -> FloatArray | None:
    """Horizontal direction of the vertical plane that holds all of the scene, or None."""
    motion = scene.motion()
    if not motion.is_planar():
        return None
    moving = motion.horizontal_direction()
    candidates = [] if moving is None else [np.asarray(moving, dtype=float)]
    candidates += [np.asarray(d[:2], dtype=float) for d in directions]
    floor = scene.environment.floor
    if floor is not None and floor.z is not None:
        candidates.append(np.asarray(floor.slope, dtype=float))
    elif floor is not None:
        candidates.append(np.array([1.0, 0.0]))
        if np.ptp(floor.grid_z, axis=1).any():
            return None
    if scene.environment.current is not None:
        candidates += list(scene.environment.current.velocity.reshape(-1, 3)[:, :2])
    water = sea(scene)
    if water is not None:
        candidates.append(np.array([math.cos(water.direction), math.sin(water.direction)]))
    plane: FloatArray | None = None
    for vector in candidates:
        size = float(np.hypot(*vector))
        if size == 0.0:
            continue
        unit = vector / size
        if plane is None:
            plane = unit
        elif abs(plane[0] * unit[1] - plane[1] * unit[0]) > _OUT_OF_PLANE:
            return None
    return np.array([1.0, 0.0]) if plane is None else plane


def build(scene: Scene, *, planar: bool | None = None, drum_room: float = 1.0) -> Block:
    """A block at the scene's initial state, t = 0.

    ``planar``: False forces three dimensions; None and True choose a vertical plane where the
    scene lies in one. ``drum_room``: elements of the drum's cable for which there is room, in units
    of those that this scene needs. A static start refines the mesh until its shape is accurate.

    Raises SceneError (not supported, inconsistent), StaticsError (no equilibrium found).
    """
    refuse_unsupported(scene)
    scale = _tension_scale(scene)
    position = scene.motion().evaluate(0.0)[0]
    points = laid_shape.on_floor(scene, _initial_points(scene, position))
    sea_floor.check(scene, points)
    nodes = line_nodes(_spans(scene, scale), scene.solver.tolerance, _start(scene))
    nodes = laid_shape.refine_guess(scene, nodes, points)
    nodes = waves.refine(scene, nodes, points)
    block = _build_on(scene, nodes, points, scale, planar, drum_room)
    if scene.initial.kind != "static":
        return block
    fixed = [cable.elements is not None for cable in scene.cables]
    for _round in range(REFINEMENTS):
        finer = _refined(block, scene, nodes, fixed)
        if finer is None:
            break
        nodes = finer
        block = _build_on(scene, nodes, _shape(block), scale, planar, drum_room)
    _refine_touchdown(block, scene)
    return block


def _refine_touchdown(block: Block, scene: Scene) -> None:
    """Refine a static shape where it meets the floor, and solve again from its own shape."""
    from cablemodel import library as entry

    _position, velocity, _ = scene.motion().evaluate(0.0)
    frame = np.ascontiguousarray(local(block, velocity, point=False))
    for _round in range(REFINEMENTS):
        if not entry.refine_at_floor(block.ints, block.reals):
            break
        _solve_static(block, frame)
    _count_from_zero(block)


def _shape(block: Block) -> FloatArray:
    """The block's present shape as a fine polyline, (n, 3): the guess on a finer mesh."""
    from cablemodel import library as entry

    count = int(block.ints[at.I_NODES])
    edges = block.array(at.O_EDGE, count, at.EDGE_WORDS)[1:]
    ends = np.concatenate([[0.0], edges[:, at.E_START] + edges[:, at.E_LENGTH]])
    stations = np.unique(np.interp(np.arange(8 * count - 7) / 8.0, np.arange(count), ends))
    out = np.empty(at.STATION_WORDS * len(stations))
    entry.sample(block.ints, block.reals, stations, out)
    points = out.reshape(-1, at.STATION_WORDS)[:, :3]
    bodies = np.flatnonzero(block.integers(at.O_JOINT, count) == at.JOINT_BODY)
    places = _node_places(block) if len(bodies) else points
    for node in reversed(bodies):
        # Both ends of a body have the same arc length: one station, or the line's last one.
        here = int(np.searchsorted(stations, ends[node] - 1e-9 * ends[-1]))
        points = np.vstack([points[:here], places[node - 1 : node + 1], points[here + 1 :]])
    return points.copy()


def _node_places(block: Block) -> FloatArray:
    """Positions of the nodes in the earth frame, (n, 3) [m]."""
    count, dimension = int(block.ints[at.I_NODES]), int(block.ints[at.I_DIMENSION])
    places = block.array(at.O_POSITION, count, 2 * dimension)[:, :dimension]
    if dimension == 2:
        plane = block.reals[at.S_PLANE : at.S_PLANE + 2]
        places = places @ np.array([[plane[0], plane[1], 0.0], [0.0, 0.0, 1.0]])
    return places + block.reals[at.S_BASE : at.S_BASE + 3]


def _refined(
    block: Block, scene: Scene, nodes: list[FloatArray], fixed: list[bool]
) -> list[FloatArray] | None:
    """Cables' nodes with those elements halved that a static shape bends too much; None: done.

    The curvature of a cubic element changes by D over its length h and jumps by J at its nodes;
    what it cannot follow misplaces the cable by a fraction of h^2 J.
    """
    count = int(block.ints[at.I_NODES])
    dimension = int(block.ints[at.I_DIMENSION])
    q = block.array(at.O_POSITION, count, 2 * dimension)
    edges = block.array(at.O_EDGE, count, at.EDGE_WORDS)
    joints = block.integers(at.O_JOINT, count)
    start = np.zeros((count, dimension))
    end = np.zeros((count, dimension))
    h = edges[:, at.E_LENGTH]
    for node in range(1, count):
        if joints[node]:
            continue
        r0, d0 = q[node - 1, :dimension], q[node - 1, dimension:]
        r1, d1 = q[node, :dimension], q[node, dimension:]
        chord = (r1 - r0) / h[node]
        start[node] = (6.0 * chord - 4.0 * d0 - 2.0 * d1) / h[node]
        end[node] = (2.0 * d0 + 4.0 * d1 - 6.0 * chord) / h[node]
    jump = np.zeros(count)  # at the child end of each element
    for node in range(1, count - 1):
        if not joints[node] and not joints[node + 1]:
            jump[node] = float(np.linalg.norm(start[node + 1] - end[node]))
    # Flexible ends have no neighbour to compare with: half of the change inside stands for it.
    inside = np.linalg.norm(start - end, axis=1)
    indicator = h**2 * np.maximum(jump, np.concatenate([[0.0], jump[:-1]]))
    indicator[1] = max(indicator[1], 0.25 * h[1] ** 2 * inside[1])
    last = int(np.flatnonzero(joints == 0)[-1])  # beyond it there may be a body
    indicator[last] = max(indicator[last], 0.25 * h[last] ** 2 * inside[last])
    split = indicator > BENT * scene.solver.tolerance * scene.line_length
    if not split.any() or count > LARGEST_STATIC_MESH:
        return None
    finer = []
    node = 1
    changed = False
    for index, places in enumerate(nodes):
        while joints[node]:
            node += 1
        new = [float(places[0])]
        for left, right in itertools.pairwise(places):
            if split[node] and not fixed[index]:
                new.append(0.5 * (left + right))
                changed = True
            new.append(float(right))
            node += 1
        finer.append(np.array(new))
    return finer if changed else None


def _build_on(
    scene: Scene,
    nodes: list[FloatArray],
    points: FloatArray,
    scale: float,
    planar: bool | None,
    drum_room: float,
) -> Block:
    """A block on given nodes, from a polyline as the first guess of its shape."""
    line = _mesh(scene, nodes)
    winch = _winch(scene, line, drum_room)
    motion = scene.motion()
    position, velocity, _ = motion.evaluate(0.0)

    directions = [p - position for p in points]
    directions += [
        np.asarray(connection.direction, dtype=float)
        for connection in (scene.vessel.connection, scene.end.connection)
        if connection.kind == "clamped"
    ]
    plane = None if planar is False else _vertical_plane(scene, directions)

    current = scene.environment.current
    depths = 1 if current is None else len(current.z)
    times = 1 if current is None else len(current.t)
    constraints = 2 if scene.end.kind == "anchor" else 1
    water = sea(scene)
    block = Block(
        capacity=line.nodes + winch.extra_nodes + sea_floor.spare_nodes(scene),
        pieces=1 + len(motion.pieces),
        depths=depths,
        times=times,
        strain_words=sum(
            len(scene.cable_types[cable.type].strain_coefficients) for cable in winch.cables
        ),
        bodies=len(line.bodies),
        constraints=constraints,
        rates=len(scene.payout.rate),
        cables=len(winch.cables),
        floor_words=sea_floor.table_words(scene.environment.floor),
        waves=0 if water is None else len(water.amplitude),
    )
    ints, reals = block.ints, block.reals
    dimension = 3 if plane is None else 2
    ints[at.I_NODES] = line.nodes
    ints[at.I_DIMENSION] = dimension
    ints[at.I_PIECE] = 1
    ints[at.I_ORDER] = 4
    ints[at.I_MAXIMUM_STEPS] = 2_000_000
    rho = scene.environment.water_density
    ints[at.I_DRAG] = int(rho > 0.0)
    length = scene.line_length
    tolerance = scene.solver.tolerance
    reals[at.S_TOLERANCE] = tolerance
    allowed = TIME_TOLERANCE * tolerance * length
    if rho == 0.0:
        # Nothing forgets an error, and a stiff line takes an order from the scheme.
        allowed *= UNDAMPED * math.sqrt(tolerance / 1e-3)
    reals[at.S_TIME_TOLERANCE] = allowed
    reals[at.S_LENGTH] = length
    reals[at.S_BASE : at.S_BASE + 3] = position
    reals[at.S_PLANE : at.S_PLANE + 2] = (1.0, 0.0) if plane is None else plane
    reals[at.S_GRAVITY] = scene.environment.gravity
    reals[at.S_WATER_DENSITY] = rho

    _fill_motion(block, motion.pieces)
    if current is not None:
        ints[at.I_CURRENT] = 1 if depths == 1 else 2
        block.array(at.O_DEPTHS, depths)[:] = current.z
        block.array(at.O_TIMES, times)[:] = current.t
        block.array(at.O_CURRENT, times, depths, 3)[:] = current.velocity
    _fill_line(block, scene, line, winch, scale)
    _fill_constraints(block, scene, line)
    _fill_positions(block, line, points, length)
    sea_floor.fill(block, scene)
    waves.fill(block, water)
    sea_floor.place_of_rest(block, scene)
    _find_initial_state(block, scene, velocity)
    return block


def local(block: Block, vector: FloatArray, *, point: bool) -> FloatArray:
    """An earth-frame point or vector in the block's coordinates, (dimension,)."""
    value = np.asarray(vector, dtype=float)
    if point:
        value = value - block.reals[at.S_BASE : at.S_BASE + 3]
    if block.ints[at.I_DIMENSION] == 3:
        return value
    plane = block.reals[at.S_PLANE : at.S_PLANE + 2]
    return np.array([plane @ value[:2], value[2]])


def _fill_motion(block: Block, pieces: FloatArray) -> None:
    """The scene's pieces from row 1 on (row 0 is the caller's live motion), and their kinks."""
    from cablemodel.scene.motion import VesselMotion

    table = block.array(at.O_PIECES, len(pieces) + 1, at.PIECE_WORDS)
    table[1:] = pieces
    table[1:, at.P_ACCELERATION_JUMP] = 0.0
    table[1:, at.P_VELOCITY_JUMP] = 0.0
    for k in range(1, len(pieces)):
        t = float(pieces[k, 0])
        before = VesselMotion(pieces[k - 1 : k]).evaluate(t)
        after = VesselMotion(pieces[k : k + 1]).evaluate(t)
        jump = float(np.linalg.norm(after[1] - before[1]))
        scale = float(np.linalg.norm(after[1]) + np.linalg.norm(before[1]))
        table[1 + k, at.P_VELOCITY_JUMP] = jump if jump > 1e-9 * scale else 0.0
        table[1 + k, at.P_ACCELERATION_JUMP] = np.linalg.norm(after[2] - before[2])


@dataclass
class _Winch:
    """The cables of line and drum in the order in which they leave, and what lies between them."""

    cables: list[Cable]
    leaves: list[float]
    """Pay-out at which each one's vessel end passes the tow point [m]."""
    nominal: list[float]
    bodies: list[int]
    """Row of the body at each one's lower end, -1: none."""
    hinges: list[bool]
    extra_nodes: int
    most: float
    least: float


def _hinged(lower: Cable, upper: Cable, body: bool) -> bool:
    """Whether a joint of two cables lets the slope jump.

    A flexible cable passes no moment. A hybrid is flexible at a body, where its tension jumps.
    """
    models = (lower.model, upper.model)
    return "cable" in models or (body and "hybrid" in models)


def _winch(scene: Scene, line: _Line, drum_room: float) -> _Winch:
    """The cable table; bodies on the drum are added to the line's bodies."""
    total = scene.line_length
    elements = sum(1 for joint in line.joint[1:] if joint == 0)
    usual = total / elements
    winch = _Winch([], [], [], [], [], SPARE_NODES, 0.0, 0.0)
    rows = {place: row for row, (_, _, place) in enumerate(line.bodies)}
    below = total
    body = -1
    nominal = list(reversed(line.nominal))
    for place in range(len(scene.line) - 1, -1, -1):
        item = scene.line[place]
        if item.cable is None:
            body = rows[place] if winch.cables else -1
            continue
        below -= item.cable.length
        _add_cable(winch, item.cable, -below, nominal[len(winch.cables)], body)
        body = -1
    for index, item in enumerate(scene.payout.drum):
        if item.body is not None:
            line.bodies.append((-1, item.body, len(scene.line) + index))
            body = len(line.bodies) - 1
            continue
        assert item.cable is not None
        winch.most += item.cable.length
        top = winch.cables[-1]
        winch.extra_nodes += math.ceil(drum_room * item.cable.length / usual) + 6
        if body < 0 and (top.type, top.model) == (item.cable.type, item.cable.model):
            winch.leaves[-1] = winch.most
        else:
            _add_cable(winch, item.cable, winch.most, usual, body)
        body = -1
    winch.least = -(total - SHORTEST_LINE * total)
    above = 0.0
    index = -1
    for item in scene.line:
        if item.cable is not None:
            above += item.cable.length
            index += 1
        elif item.body is not None and item.body.half_length > 0.0:
            # Not taken onto the drum: reel-in ends before it.
            winch.least = max(winch.least, SHORTEST_PIECE * line.nominal[index] - above)
            break
    return winch


def _add_cable(winch: _Winch, cable: Cable, leaves: float, nominal: float, body: int) -> None:
    winch.hinges.append(bool(winch.cables) and _hinged(winch.cables[-1], cable, body >= 0))
    winch.cables.append(cable)
    winch.leaves.append(leaves)
    winch.nominal.append(nominal)
    winch.bodies.append(body)


def _edge_row(
    scene: Scene, cable: Cable, segment: int, strain_offset: int, scale: float
) -> FloatArray:
    """A row of the edge table for elements of a cable, without length and place."""
    rho = scene.environment.water_density
    kind = scene.cable_types[cable.type]
    row = np.zeros(at.EDGE_WORDS)
    added = rho * 0.25 * math.pi * kind.diameter**2 * kind.added_mass
    row[at.E_MASS] = kind.mass + added
    row[at.E_ADDED] = added
    row[at.E_WEIGHT] = kind.submerged_weight
    row[at.E_CONTACT] = sea_floor.contact_weight(kind, scene.environment.gravity)
    row[at.E_DRAG_NORMAL] = 0.5 * rho * kind.drag_normal * kind.diameter
    row[at.E_DRAG_TANGENTIAL] = 0.5 * rho * kind.drag_tangential * math.pi * kind.diameter
    row[at.E_COMPLIANCE] = kind.strain_coefficients[0]
    row[at.E_STRAIN_TERMS] = len(kind.strain_coefficients)
    row[at.E_STRAIN_OFFSET] = strain_offset
    row[at.E_TENSION_LOW : at.E_TENSION_HIGH + 1] = _strain_range(kind.strain_coefficients)
    row[at.E_STABILISATION] = min(STABILISATION * scale, 1.0 / kind.strain_coefficients[0])
    row[at.E_BENDING_FULL] = 0.0 if cable.model == "cable" else kind.bending_stiffness
    row[at.E_MODEL] = _MODELS[cable.model]
    if row[at.E_BENDING_FULL] == 0.0 and scene.environment.floor is not None:
        row[at.E_BENDING_FULL] = sea_floor.least_bending(scene, kind)
        row[at.E_MODEL] = at.MODEL_HYBRID
    row[at.E_BENDING] = row[at.E_BENDING_FULL]
    row[at.E_SEGMENT] = segment
    row[at.E_TYPE] = list(scene.cable_types).index(cable.type)
    return row


def _fill_line(block: Block, scene: Scene, line: _Line, winch: _Winch, scale: float) -> None:
    rho = scene.environment.water_density
    ints, reals = block.ints, block.reals
    strain = block.array(at.O_STRAIN, int(ints[at.I_STRAIN]))
    used = 0
    table = block.array(at.O_CABLES, len(winch.cables), at.CABLE_WORDS)
    for index, (cable, row) in enumerate(zip(winch.cables, table, strict=True)):
        coefficients = scene.cable_types[cable.type].strain_coefficients
        strain[used : used + len(coefficients)] = coefficients
        offset = int(ints[at.O_STRAIN]) + used
        used += len(coefficients)
        row[at.K_LEAVES] = winch.leaves[index]
        row[at.K_NOMINAL] = winch.nominal[index]
        row[at.K_SHORTEST] = SHORTEST_PIECE * winch.nominal[index]
        row[at.K_HINGE] = float(winch.hinges[index])
        row[at.K_BODY] = winch.bodies[index]
        kind = scene.cable_types[cable.type]
        row[at.K_DISPLACED] = rho * 0.25 * math.pi * kind.diameter**2
        row[at.K_EDGE :] = _edge_row(scene, cable, index, offset, scale)
        row[at.K_EDGE + at.E_NOMINAL] = winch.nominal[index]
        edge = row[at.K_EDGE :]
        if edge[at.E_MODEL] == at.MODEL_HYBRID and edge[at.E_BENDING_FULL] > 0.0:
            ints[at.I_HYBRID] = 1
    block.integers(at.O_PARENT, line.nodes)[:] = line.parent
    block.integers(at.O_JOINT, line.nodes)[:] = line.joint
    edges = block.array(at.O_EDGE, line.nodes, at.EDGE_WORDS)
    outermost = len(scene.cables) - 1
    for node in range(1, line.nodes):
        edges[node] = table[outermost - line.cable[node], at.K_EDGE :]
        edges[node, at.E_LENGTH] = line.length[node]
        edges[node, at.E_START] = line.start[node]
    ints[at.I_TOP_CABLE] = outermost
    ints[at.I_PAYOUT] = int(any(row.rate != 0.0 for row in scene.payout.rate))
    reals[at.S_TOP_LENGTH] = line.length[1]
    reals[at.S_PAID_MOST] = winch.most
    reals[at.S_PAID_LEAST] = winch.least
    for row, point in zip(
        block.array(at.O_RATES, len(scene.payout.rate), at.RATE_WORDS),
        scene.payout.rate,
        strict=True,
    ):
        row[:] = point.t, point.rate
    table = block.array(at.O_BODY, len(line.bodies), at.BODY_WORDS)
    for body_row, (node, body, place) in zip(table, line.bodies, strict=True):
        body_row[at.B_NODE] = node
        body_row[at.B_MASS] = body.mass
        body_row[at.B_WEIGHT] = body.submerged_weight
        body_row[at.B_ADDED] = body.added_mass
        body_row[at.B_ADDED_AXIAL] = body.added_mass_axial
        body_row[at.B_DRAG] = 0.5 * rho * body.drag_coefficient * body.drag_area
        body_row[at.B_DRAG_AXIAL] = 0.5 * rho * body.drag_coefficient_axial * body.drag_area_axial
        body_row[at.B_ITEM] = place
        if body.half_length > 0.0:
            _fill_rigid(body_row, body, scene, scale)
            ints[at.I_RIGID] += 1
            if place == len(scene.line) - 1:
                body_row[at.B_TIE] = scale * body_row[at.B_LENGTH]
    # A start that the user would not notice: it grows fourfold a step.
    block.reals[at.S_TENSION_SCALE] = scale
    period = math.sqrt(scene.line_length / max(scene.environment.gravity, 1e-3))
    block.reals[at.S_PERIOD] = period
    softness = masses = 0.0
    for cable in scene.cables:
        kind = scene.cable_types[cable.type]
        softness += kind.strain_coefficients[0] * cable.length
        masses += kind.mass * cable.length
    masses += math.fsum(body.mass for node, body, _place in line.bodies if node >= 0)
    block.reals[at.S_AXIAL] = 1.0 / (softness * masses)
    block.reals[at.S_UNDAMPED] = float(_start(scene).lightly_damped)
    block.reals[at.S_FIRST_STEP] = 0.02 * period
    block.reals[at.S_STEP] = 1e-2 * math.sqrt(max(scene.solver.tolerance, 1e-12)) * period
    block.reals[at.S_SMALLEST_STEP] = 1e-10 * period


def _fill_rigid(row: FloatArray, body: Body, scene: Scene, scale: float) -> None:
    """What a body of finite length has more than a point body."""
    row[at.B_LENGTH] = 2.0 * body.half_length
    row[at.B_OFFSET] = body.centre_offset
    row[at.B_INERTIA] = body.rotary_inertia
    row[at.B_DRY_WEIGHT] = body.mass * scene.environment.gravity
    row[at.B_PULL : at.B_PULL + 2] = scale  # until the tensions are known
    stretch = math.fsum(
        scene.cable_types[cable.type].strain_coefficients[0] * cable.length
        for cable in scene.cables
    )
    row[at.B_COMPLIANCE] = min(row[at.B_LENGTH] / (RIGID * scale), SOFTEST * stretch)


def _fill_constraints(block: Block, scene: Scene, line: _Line) -> None:
    table = block.array(at.O_CONSTRAINT, int(block.ints[at.I_CONSTRAINTS]), at.CONSTRAINT_WORDS)
    ends = [(0, at.C_VESSEL, scene.vessel.connection)]
    if scene.end.kind == "anchor":
        ends.append((line.nodes - 1, at.C_ANCHOR, scene.end.connection))
    dimension = int(block.ints[at.I_DIMENSION])
    for row, (node, kind, connection) in zip(table, ends, strict=True):
        row[at.C_NODE] = node
        row[at.C_KIND] = kind
        if kind == at.C_ANCHOR:
            place = local(block, np.asarray(scene.end.position), point=True)
            row[at.C_POSITION : at.C_POSITION + dimension] = place
        if connection.kind == "clamped":
            row[at.C_CLAMPED] = 1.0
            direction = np.asarray(connection.direction, dtype=float)
            unit = direction / np.linalg.norm(direction)
            row[at.C_DIRECTION : at.C_DIRECTION + dimension] = local(block, unit, point=False)


def _bodies_length(scene: Scene) -> float:
    """Length of the bodies that are out at t = 0 [m]."""
    return math.fsum(2.0 * body.half_length for body in scene.bodies)


def _initial_points(scene: Scene, start: FloatArray) -> FloatArray:
    """A polyline from the tow point outwards that the first shape follows, (n, 3)."""
    length = scene.line_length + _bodies_length(scene)
    if scene.initial.kind == "straight":
        direction = np.asarray(scene.initial.direction, dtype=float)
        return np.array([start, start + length * direction / np.linalg.norm(direction)])
    if scene.initial.kind == "points":
        return np.asarray(scene.initial.points, dtype=float)
    if scene.end.kind == "anchor":
        return _sagging(start, np.asarray(scene.end.position, dtype=float), length, _sinks(scene))
    if scene.vessel.connection.kind == "clamped":
        direction = np.asarray(scene.vessel.connection.direction, dtype=float)
        return np.array([start, start + length * direction / np.linalg.norm(direction)])
    return np.array([start, start + np.array([0.0, 0.0, -length if _sinks(scene) else length])])


def _sinks(scene: Scene) -> bool:
    weight = math.fsum(
        cable.length * scene.cable_types[cable.type].submerged_weight for cable in scene.cables
    )
    return weight + math.fsum(body.submerged_weight for body in scene.bodies) >= 0.0


def _sagging(start: FloatArray, end: FloatArray, length: float, sinks: bool) -> FloatArray:
    """A parabola of the given length between two points: the first guess of a hanging cable."""
    chord = float(np.linalg.norm(end - start))
    if chord >= length * (1.0 - 1e-6):
        return np.array([start, end])
    x = np.linspace(0.0, 1.0, 201)
    bow = np.zeros(3)
    bow[2] = -1.0 if sinks else 1.0
    if abs(float((end - start) @ bow)) > 0.999 * max(chord, 1e-12):
        bow = np.array([1.0, 0.0, 0.0])  # one end above the other: the slack goes aside

    def curve(sag: float) -> FloatArray:
        return start + np.outer(x, end - start) + np.outer(4.0 * x * (1.0 - x) * sag, bow)

    low, high = 0.0, length
    for _ in range(60):
        sag = 0.5 * (low + high)
        if np.linalg.norm(np.diff(curve(sag), axis=0), axis=1).sum() < length:
            low = sag
        else:
            high = sag
    return curve(0.5 * (low + high))


def _fill_positions(block: Block, line: _Line, points: FloatArray, length: float) -> None:
    """Nodes along the polyline, at their share of its length, with slopes along it.

    Bodies of finite length keep theirs: the cable takes what is left.
    """
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    arc = np.concatenate([[0.0], np.cumsum(chords)])
    if arc[-1] <= line.passed[-1]:
        problem = f"the shape is {arc[-1]:g} m long, no longer than its bodies"
        raise SceneError.at("initial.points", None, problem, f"more than {line.passed[-1]:g} m")
    stretch = (arc[-1] - line.passed[-1]) / length
    where = np.zeros(line.nodes)
    for node in range(1, line.nodes):
        where[node] = line.start[node] + line.length[node]
    where *= stretch
    where += line.passed
    where = np.minimum(where, arc[-1])
    if len(points) == 2:  # the usual start; spares the import of scipy, 0.3 s
        direction = (points[1] - points[0]) / arc[-1]
        places = points[0] + np.outer(where, direction)
        slopes = np.tile(direction, (line.nodes, 1))
    else:
        from scipy.interpolate import CubicHermiteSpline

        # Linear in the points, so that a turned polyline gives the turned shape (PCHIP does not).
        smooth = CubicHermiteSpline(arc, points, np.gradient(points, arc, axis=0))
        places = smooth(where)
        slopes = smooth.derivative()(where)
    slopes *= stretch / np.linalg.norm(slopes, axis=1)[:, None]
    for node, body, _place in line.bodies:
        if body.half_length > 0.0 and node >= 0:
            # Its ends lie on the shape; the chord between them is shorter than a curved shape.
            middle = 0.5 * (places[node - 1] + places[node])
            axis = places[node] - places[node - 1]
            axis /= np.linalg.norm(axis)
            places[node - 1] = middle - body.half_length * axis
            places[node] = middle + body.half_length * axis
            if node == line.nodes - 1:
                slopes[node] = axis
    dimension = int(block.ints[at.I_DIMENSION])
    q = block.array(at.O_POSITION, line.nodes, 2 * dimension)
    for node in range(line.nodes):
        q[node, :dimension] = local(block, places[node], point=True)
        q[node, dimension:] = local(block, slopes[node], point=False)
    table = block.array(at.O_CONSTRAINT, int(block.ints[at.I_CONSTRAINTS]), at.CONSTRAINT_WORDS)
    for row in table:
        if row[at.C_CLAMPED] != 0.0:
            node = int(row[at.C_NODE])
            q[node, dimension:] = stretch * row[at.C_DIRECTION : at.C_DIRECTION + dimension]


def _stabilise(block: Block) -> bool:
    """Stabilise the tangential modes by the tension found at the start, if that is larger.

    The scale guessed from weights is too small where a line is taut without being heavy, or
    weightless and held by its bending stiffness. Returns whether anything changed.
    """
    changed = False
    nodes = int(block.ints[at.I_NODES])
    tension = float(np.max(np.abs(block.array(at.O_TENSION, nodes, 2)[:, 0])))
    for rows in (
        block.array(at.O_EDGE, nodes, at.EDGE_WORDS)[1:],
        block.array(at.O_CABLES, int(block.ints[at.I_CABLES]), at.CABLE_WORDS)[:, at.K_EDGE :],
    ):
        for row in rows:
            if row[at.E_COMPLIANCE] > 0.0:
                bending = 10.0 * row[at.E_BENDING_FULL] / block.reals[at.S_LENGTH] ** 2
                wanted = max(row[at.E_STABILISATION], STABILISATION * tension, bending)
                wanted = min(wanted, 1.0 / row[at.E_COMPLIANCE])
                changed = changed or wanted != row[at.E_STABILISATION]
                row[at.E_STABILISATION] = wanted
    for row in block.array(at.O_BODY, int(block.ints[at.I_BODIES]), at.BODY_WORDS):
        if row[at.B_LENGTH] > 0.0 and tension > 0.0:
            row[at.B_COMPLIANCE] = min(row[at.B_COMPLIANCE], row[at.B_LENGTH] / (RIGID * tension))
    return changed


def _rate_at_start(scene: Scene) -> float:
    """Pay-out rate just after t = 0 [m/s]; a table holds its first value before it begins."""
    rates = scene.payout.rate
    if not rates:
        return 0.0
    return float(np.interp(0.0, [row.t for row in rates], [row.rate for row in rates]))


def _start_flowing(block: Block, scene: Scene) -> None:
    """Material velocity of a cable that is paid out from t = 0 on: with the vessel, along itself.

    A cable at rest would answer with an axial shock of EA rate / c. Where it is laid at the rate
    of the vessel's speed, what lies on the floor is at rest.
    """
    rate = _rate_at_start(scene)
    if rate == 0.0:
        return
    nodes, dimension = int(block.ints[at.I_NODES]), int(block.ints[at.I_DIMENSION])
    q = block.array(at.O_POSITION, nodes, 2 * dimension)
    v = block.array(at.O_VELOCITY, nodes, 2 * dimension)
    v[1:, :dimension] = v[0, :dimension] + rate * q[1:, dimension:]


def _find_initial_state(block: Block, scene: Scene, velocity: FloatArray) -> None:
    from cablemodel import library as entry

    ints, reals = block.ints, block.reals
    entry.place_supports(ints, reals)
    frame = np.ascontiguousarray(local(block, velocity, point=False))
    if ints[at.I_PAYOUT]:
        reals[at.S_PAYOUT_RATE] = _rate_at_start(scene)
    if scene.initial.kind != "static":
        _start_flowing(block, scene)
        entry.tension_from_stretch(ints, reals)
    else:
        if scene.end.kind == "anchor" and np.any(frame != 0.0):
            raise SceneError.at(
                "initial",
                "static",
                "an anchored cable has no steady state while the vessel moves",
                "a vessel at rest at t = 0, or initial: {points: [...]}",
            )
        _solve_static(block, frame)
    if _stabilise(block) and scene.initial.kind == "static":
        # The new stiffness changes the forces by a little: the state must meet them.
        _solve_static(block, frame)
    _count_from_zero(block)
    if ints[at.I_HYBRID] or ints[at.I_RIGID]:
        entry.choose_bending(ints, reals)


def _solve_static(block: Block, frame: FloatArray) -> None:
    from cablemodel import library as entry

    ints, reals = block.ints, block.reals
    held = ints[at.I_CONSTRAINTS] > 1
    friction = reals[at.S_FRICTION]
    if not held:
        # A free end comes to rest without friction; it holds the line from there.
        reals[at.S_FRICTION] = 0.0
    status = entry.equilibrium(ints, reals, frame)
    reals[at.S_FRICTION] = friction
    if not held:
        sea_floor.rest_where_it_is(block)
    if status != at.OK:
        node = int(ints[at.I_FAILED_NODE])
        arc = block.array(at.O_EDGE, int(ints[at.I_NODES]), at.EDGE_WORDS)[node, at.E_START]
        raise StaticsError(
            f"no static equilibrium was found; what moved last is {arc:g} m along the cable. Check "
            "weights, ends and current, or start from initial: {straight: ...} or {points: ...}"
        )
    entry.place_supports(ints, reals)


def _count_from_zero(block: Block) -> None:
    for counter in (at.I_STEPS, at.I_REJECTED, at.I_FACTORISATIONS, at.I_ITERATIONS):
        block.ints[counter] = 0
    block.ints[at.I_FACTORED] = 0
    block.ints[at.I_HISTORY] = 0
