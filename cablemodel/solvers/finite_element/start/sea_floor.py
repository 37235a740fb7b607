"""A scene's sea floor for the kernels: heights, stiffness, friction at the start, checks."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import SceneError
from cablemodel.scene.depth_table import monotone_slopes
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.kernels.element.tables import BRISTLE, DEPTH
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.curves import bends
from cablemodel.solvers.shared.layout import Header, Scalars
from cablemodel.solvers.shared.numbers import TAKES_OFF

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.common import CableScene
    from cablemodel.scene.environment import Floor
    from cablemodel.scene.line import Cable, CableType
    from cablemodel.scene.vessel import Payout

FloatArray = NDArray[np.float64]

SHARPEST = 1.2, 0.003
"""Length over which bending spreads a touchdown of cable that has no bending stiffness, in units of
tau times the height from which it hangs, and of that height: the longer one. Without the second
part starts at fine tolerances take a minute, and each tolerance would lay another cable."""
COLUMN_HEIGHT = 7.837 ** (-1.0 / 3.0)
"""The same in units of p / w, of cable that leaves a winch with the momentum p = (m + m_a) V^2:
that high above where it lands, the tension is less than p, which pushes it like a column that
stands on the floor, and less stiff it would buckle (Greenhill 1881)."""
FLOOR_LOWEST = 0.2
"""Of the line's length: least height that it is taken to hang from. Longer ones hang at less than
12 degrees, or lie: with less their starts took up to 20 s."""
UNFOLDING = 1.2, 0.003
"""Layer from which on a lay does not fold on the way to its start, in units of tau L, and of L."""
FLOOR_SPARE = 40, 30
"""Nodes kept for refinement: a constant, and one for each halving down to the finest element."""
PRELOAD = 1e-3
"""Of the weight in air: what the floor's preload carries of cable, or a body, that floats."""
LEAST_PRELOAD = 1e-9
"""That of cable without mass [N/m]."""
ABOVE_TABLE = 0.05
"""Of a table's range of heights: what its cubics may be above the highest of them."""
BELOW_FLOOR = 1e-6
"""Of the line's length: what a place that is given may be below the floor by rounding."""
TRACK_TIMES = 201
"""Times of a run at which its track is compared with the floor."""
TRACK_BELOW = 1e-3
"""Of the line's length: what the tow point may come below the floor in the run."""


def contact_weight(kind: CableType, gravity: float) -> float:
    """Weight per length that the floor's preload carries [N/m]; small for a cable that floats."""
    return max(kind.submerged_weight, PRELOAD * kind.mass * gravity, LEAST_PRELOAD)


def momentum_of(kind: CableType, density: float, rate: float) -> float:
    """That a cable which runs out takes along, per time: (m + m_a) V^2 [N]."""
    added = kind.added_mass * density * 0.25 * math.pi * kind.diameter**2
    return (kind.mass + added) * rate**2


def hanging_height(scene: CableScene) -> float:
    """Height over the floor from which a line hangs at the start that a winch pays out to a free
    end [m]; of others, which lay no slack, their length."""
    x, y, z = scene.place
    length = scene.line_length
    floor = scene.environment.floor
    if floor is None or _laying(scene) is None:
        return length
    height = z - floor.height(x, y)
    return min(max(height, FLOOR_LOWEST * length), length)


def least_bending(scene: CableScene, kind: CableType) -> float:
    """Bending stiffness that a perfectly flexible cable gets where it is slack [N m2].

    Its motion is not well posed where it folds without tension: it takes the shape that bending
    gives it, however small. What hangs straight down lies .83 l off that of no stiffness, by the
    layer l of `SHARPEST`; with a horizontal tension H it is l (w l / H)^2.
    """
    weight = contact_weight(kind, scene.environment.gravity)
    layer = hanging_height(scene) * max(SHARPEST[0] * scene.solver.tolerance, SHARPEST[1])
    momentum = momentum_of(kind, scene.environment.water_density, _fastest_lay(scene))
    # None bends more sharply than it is thick.
    return weight * max(layer, kind.diameter, COLUMN_HEIGHT * momentum / weight) ** 3


def _fastest_lay(scene: CableScene) -> float:
    """Largest rate at which a winch pays out to a free end over a floor [m/s]; 0: none does."""
    payout = _laying(scene)
    return 0.0 if payout is None else max([0.0, *(row.rate for row in payout.rate)])


def _laying(scene: CableScene) -> Payout | None:
    """Of a winch that pays out from its drum over a floor, to a free end, or to an anchor from
    which the vessel lays at the start; None: there is none."""
    from cablemodel.scene import Scene

    if scene.environment.floor is None or not isinstance(scene, Scene) or not scene.payout.drum:
        return None
    if scene.end.kind != "free":
        moves = bool(np.any(scene.motion().evaluate(0.0)[1]))
        if scene.initial.kind != "static" or not moves or scene.rate_at_start <= 0.0:
            return None
    return scene.payout


def unfolding_layer(scene: CableScene) -> float:
    """Touchdown layer of cable that does not fold on the way to the start of a lay [m]."""
    return scene.line_length * (UNFOLDING[0] * scene.solver.tolerance + UNFOLDING[1])


def touchdown_layer(scene: CableScene, cable: Cable) -> float:
    """Length over which bending spreads a touchdown, (EI/w)^(1/3) [m]."""
    kind = scene.cable_types[cable.type]
    bending = 0.0 if cable.model == "cable" else kind.bending_stiffness
    bending = bending or least_bending(scene, kind)
    return math.cbrt(bending / contact_weight(kind, scene.environment.gravity))


def spare_nodes(scene: Scene) -> int:
    """Nodes that refinement at the touchdown may need."""
    if scene.environment.floor is None:
        return 0
    longest = scene.line_length + sum(cable.length for cable in scene.drum_cables)
    halvings = math.ceil(math.log2(max(2.0, longest / finest_element(scene))))
    return FLOOR_SPARE[0] + FLOOR_SPARE[1] * halvings + _nodes_over_ridges(scene, longest)


def _nodes_over_ridges(scene: Scene, longest: float) -> int:
    """Nodes of a line of this length that lies on a depth table all along.

    There h^2 times the jump of curvature stays below tau L (kernels/mesh/touchdown_mesh.py); from
    one cubic of the table to the next the curvature may jump by twice the sharpest.
    """
    floor = scene.environment.floor
    if floor is None or floor.z is not None:
        return 0
    x, y, z = floor.grid_x, floor.grid_y, floor.grid_z
    bend = _sharpest(x, z, monotone_slopes(x, z)) + _sharpest(y, z.T, monotone_slopes(y, z.T))
    if bend == 0.0:
        return 0
    element = math.sqrt(scene.solver.tolerance * scene.line_length / (2.0 * bend))
    return math.ceil(longest / max(element, finest_element(scene)))


def finest_element(scene: Scene) -> float:
    """Length of the smallest element that the touchdown may ask for [m]."""
    return at.LAYER * thinnest_layer(scene)


def thinnest_layer(scene: CableScene) -> float:
    """Length over which bending spreads the sharpest touchdown of a scene's cables [m]."""
    return min(touchdown_layer(scene, cable) for cable in (*scene.cables, *scene.drum_cables))


def contact_depth(scene: CableScene) -> float:
    """Gap below which the floor pushes [m]."""
    return DEPTH * scene.solver.tolerance * scene.line_length


def bristle_length(scene: CableScene) -> float:
    """Way along the floor after which friction is mobilised [m]."""
    return BRISTLE * (scene.solver.tolerance * scene.line_length)


def table_words(floor: Floor | None) -> int:
    """Words of the floor's table in a block."""
    if floor is None or floor.z is not None:
        return 0
    nx, ny = len(floor.grid_x), len(floor.grid_y)
    return nx + ny + 4 * nx * ny


def fill(block: Block, scene: CableScene) -> None:
    """Write floor, contact and friction into a block."""
    floor = scene.environment.floor
    if floor is None:
        return
    ints, reals = block.ints, block.reals
    head = Header(ints)
    state = Scalars(reals)
    state.floor_depth = contact_depth(scene)
    state.end_support = 1.0
    state.bristle = bristle_length(scene)
    state.friction = floor.friction
    head.sleep = int(floor.friction > 0.0)
    head.floor_state = at.FLOOR_TOUCHED  # until it is known where the line is
    state.floor_damping, state.landing_damping = _damping(scene)
    state.bristles_damped = 1.0
    if floor.z is not None:
        head.floor_kind = at.FLOOR_PLANE
        state.floor_plane = (floor.z, *floor.slope, *floor.at)
        state.floor_top = 1e300 if any(floor.slope) else floor.z
        return
    head.floor_kind = at.FLOOR_TABLE
    x, y, z = floor.grid_x, floor.grid_y, floor.grid_z
    head.floor_columns, head.floor_rows = len(x), len(y)
    along_x = monotone_slopes(x, z)
    along_y = monotone_slopes(y, z.T).T
    both = monotone_slopes(y, along_x.T).T
    words = block.array(Header.floor, table_words(floor))
    words[:] = np.concatenate([x, y, np.stack([z, along_x, along_y, both], axis=-1).ravel()])
    state.floor_top = float(z.max() + ABOVE_TABLE * np.ptp(z))
    bend = _sharpest(x, z, along_x) + _sharpest(y, z.T, along_y.T)
    state.floor_bend = bend / 8.0


def _sharpest(x: FloatArray, z: FloatArray, slope: FloatArray) -> float:
    """Largest second derivative along x of the cubics with these values and slopes."""
    if len(x) < 2:
        return 0.0
    first, last = bends(z, slope, np.diff(x))
    return float(max(np.abs(first).max(), np.abs(last).max()))


def _damping(scene: CableScene) -> tuple[float, float]:
    """By how much the floor's force on cable, and on bodies, grows per speed of approach [s/m].

    By default one over the speed at which the cable sinks: it rings little when it lands. Soil
    throws no load up again: a body that falls from tau L above comes to rest within the layer in
    which the floor begins to push, which takes a third of its depth times damping and gravity off
    the speed. It lands without a bounce, then, the finer the tolerance the faster it is.
    """
    floor = scene.environment.floor
    if floor is not None and floor.damping is not None:
        return floor.damping, floor.damping
    rho = scene.environment.water_density
    speeds = []
    for cable in scene.cables:
        kind = scene.cable_types[cable.type]
        weight = contact_weight(kind, scene.environment.gravity)
        drag = rho * kind.drag_normal * kind.diameter
        speeds.append(math.sqrt(2.0 * weight / drag) if drag > 0.0 else 1.0)
    sinks = 1.0 / max(speeds)
    fall = scene.solver.tolerance * scene.line_length
    speed = math.sqrt(2.0 * scene.environment.gravity * fall)
    return sinks, max(sinks, TAKES_OFF * speed / (scene.environment.gravity * contact_depth(scene)))


def place_of_rest(block: Block, scene: Scene) -> None:
    """Where friction holds the cable at the start: where it was laid, without tension.

    An anchored cable was laid from its anchor towards the vessel, and then pulled: friction holds
    back what has stretched. Elsewhere the first shape is the place of rest.
    """
    nodes, dimension = int(block.header.nodes), int(block.header.dimension)
    q = block.array(Header.position, nodes, 2 * dimension)
    rest = block.array(Header.rest, nodes, 2 * dimension)
    rest_where_it_is(block)
    if scene.end.kind != "anchor" or scene.initial.kind != "static":
        return
    edges = block.array(Header.edges, nodes, at.EDGE_WORDS)
    arcs = edges[:, at.Edge.start] + edges[:, at.Edge.length]
    way = q[0, :dimension] - q[-1, :dimension]
    way[dimension - 1] = 0.0
    size = float(np.linalg.norm(way))
    if size > 0.0:
        rest[:, :dimension] = q[-1, :dimension] + np.outer(arcs[-1] - arcs, way / size)
        rest[:, dimension:] = -way / size


def rest_where_it_is(block: Block) -> None:
    """Make the present places and slopes those of rest: kernels/time/begin.py."""
    from cablemodel.solvers import library as entry

    entry.rest_here(block.ints, block.reals)


def check(scene: Scene, points: FloatArray) -> None:
    """Refuse what is below the floor at the start, or beyond the edge of its table.

    Raises SceneError naming the place, its height and that of the floor.
    """
    floor = scene.environment.floor
    if floor is None:
        return
    margin = BELOW_FLOOR * scene.line_length
    if floor.z is None:
        _check_cover(scene, floor, points)
    _check_above(floor, "vessel.position", points[0], margin)
    _check_afloat(scene, floor)
    if scene.end.kind == "anchor":
        _check_above(floor, "end.anchor", np.asarray(scene.end.position, dtype=float), margin)
    if scene.initial.kind != "static":
        for point in points:
            _check_above(floor, "initial", np.asarray(point), margin)


def _check_above(floor: Floor, path: str, point: FloatArray, margin: float) -> None:
    height = floor.height(float(point[0]), float(point[1]))
    if point[2] < height - margin:
        raise SceneError.at(
            path,
            [round(float(value), 6) for value in point],
            "it lies below the sea floor",
            f"z of at least {height:g} m there",
        )


def _check_afloat(scene: Scene, floor: Floor) -> None:
    """The vessel's own schedule must not take the tow point below the floor during the run."""
    times = np.linspace(0.0, scene.run.duration, TRACK_TIMES)
    most = TRACK_BELOW * scene.line_length
    for time, place in zip(times, scene.motion().track(times)[0].tolist(), strict=True):
        depth = floor.height(place[0], place[1]) - place[2]
        if depth > most:
            raise SceneError.at(
                "vessel",
                [round(float(value), 6) for value in place],
                f"the tow point is {depth:g} m below the sea floor at t = {time:g} s",
                "a motion above the floor, or a shorter run.duration",
            )


def _check_cover(scene: Scene, floor: Floor, points: FloatArray) -> None:
    """The table must hold the vessel's track over the run, the first shape and the anchor."""
    track = scene.motion().track(np.linspace(0.0, scene.run.duration, TRACK_TIMES))[0]
    places = np.array([*track, *points])
    for axis, name, grid in ((0, "x", floor.grid_x), (1, "y", floor.grid_y)):
        if len(grid) < 2:
            continue
        low, high = float(places[:, axis].min()), float(places[:, axis].max())
        if low < grid[0] or high > grid[-1]:
            raise SceneError.at(
                "environment.floor.depth_table",
                f"{name} from {grid[0]:g} to {grid[-1]:g} m",
                "it does not cover the run",
                f"{name} from {low:g} to {high:g} m at least: the vessel and the cable go there",
            )
