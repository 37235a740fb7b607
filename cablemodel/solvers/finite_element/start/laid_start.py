"""A static start of cable that friction holds on the sea floor where it was laid.

A line with a free end comes to rest without friction where the floor is level, the water still and
the vessel at rest: nothing pushes what lies. On a slope, or in a current, the same line would slide
away, and fold. What has been laid there has many shapes at rest, by what tension it was laid with.
It starts as a lay without tension leaves it: straight behind the vessel, each piece held by just
the friction that makes the floor's force on it vertical, and that balances its own drag, so that no
tension is left where it lands. What the vessel drags over the floor feels the friction of that
motion instead.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.kernels.element.tables import (
    CONTACT_H,
    CONTACT_POINTS,
    CONTACT_WEIGHTS,
    STEEPEST,
    STIFFENING,
)
from cablemodel.solvers.finite_element.start import continuation, laid_loads, sea_floor
from cablemodel.solvers.finite_element.start.frame import earth, local
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.scene import Scene
from cablemodel.solvers.shared.numbers import LYING, NO_DIRECTION

FloatArray = NDArray[np.float64]

SOFT = 3.0
"""Way in which friction is mobilised while the start is sought, in units of the line's length: it
follows what slides along the floor, as no bristle does."""
LAYING = 0.1
"""The same of a lay, whose first shape is nearly at rest: little pulls it far with longer ones."""
STEADIER = 0.01
"""Of that: the length of bristles where the longest ones find no equilibrium. Thin cable that is
pressed but a little buckles aside, at 2 sqrt(EI k) on bristles that hold it by k [N/m2]."""
PASSES = 12
"""In which friction is set anew to what each piece needs, at most."""
LAID_START_CALM = 0.02
"""What the bristles may hold beyond that, in tau times the weight of the line."""
SMALLEST_STEP = 1.0 / 32.0
"""Of the way on which bristles get their own length, where at once finds no equilibrium."""
GROWN = 0.01
"""Change of what the floor bears at a node from one pass to the next, at most."""
COARSEST, LAID_START_FINER = 1e-2, 16.0
"""Tolerances at which what lies is looked for in turn: this one, a quarter of it, and so on."""
SOFTER = 4.0
"""Of the tolerance of a lay that finds no start: at which the next one is sought."""
LEAST = 1.5
"""Of the tolerance that is asked for: by what these are coarser at least."""
LAID_START_STEPS = 100
"""Of a relaxation over a depth table, at most. What lies on ridges slides over them a crest at a
time, or never gets there: the plainest start, in which valleys hold it, is next."""
STEP_OF_LAYER, SMALLEST_STEP_OF_LAYER = 10.0, 1.2
"""Of a lay whose cable bends less at first: by what its layer gets thinner at a time, and the least
of such steps where longer ones fail."""
SLIDES = 3.0
"""Of a bristle's length: well beyond where it slips."""
DRAWN_ROUNDS = 20
"""For bristles that bear, with the floor's own law, what they are asked to."""
DRAWN_FROM, DRAWN_TO = 0.2, 5.0
"""Ratio by which they are drawn anew in one of these."""
DRAWN_MOST = 100.0
"""In bristles: how far they are drawn at most."""


def applies(scene: Scene) -> bool:
    """Whether friction holds the line's free end at the start, and something pushes what lies."""
    floor = scene.environment.floor
    if floor is None or floor.friction == 0.0:
        return False
    if scene.initial.kind != "static" or scene.end.kind != "free":
        return False
    current = scene.environment.current
    begins = 0 if current is None else max(0, int(np.searchsorted(current.t, 0.0, "right")) - 1)
    flows = current is not None and bool(np.any(current.velocity[begins]))
    moves = laid_loads.is_dragged(scene)
    return flows or moves or floor.z is None or any(floor.slope)


def coarser(scene: Scene) -> Scene | None:
    """The scene at the tolerance whose start says where this one's cable lies; None: it finds that.

    Where cable lies that friction holds depends on how it came there. Found anew at each tolerance,
    a finer one lay metres from the coarser one; from coarser to finer all agree.
    """
    if is_lay(scene):
        return None  # its first shape says where it lies, at every tolerance
    tolerance = COARSEST
    if scene.solver.tolerance * LEAST > tolerance or laid_loads.is_dragged(scene):
        return None
    while scene.solver.tolerance * LEAST * LAID_START_FINER <= tolerance:
        tolerance /= LAID_START_FINER
    return _at_tolerance(scene, tolerance)


def _at_tolerance(scene: Scene, tolerance: float) -> Scene:
    settings = scene.solver.model_copy(update={"tolerance": tolerance})
    return scene.model_copy(update={"solver": settings})


def is_lay(scene: Scene) -> bool:
    """Whether a vessel under way pays out."""
    velocity = scene.motion().evaluate(0.0)[1]
    return scene.rate_at_start > 0.0 and bool(np.any(velocity[:2]))


def stiffer_layers(scene: Scene) -> tuple[float, float] | None:
    """Touchdown layers of a lay's cables [m]: of one that does not fold, and the thinnest; None
    where none is thinner than that, and over ridges, where cable lies as it came down."""
    if not _is_even(scene):
        return None
    most, own = sea_floor.unfolding_layer(scene), sea_floor.thinnest_layer(scene)
    return (most, own) if is_lay(scene) and own < most else None


def is_laid_back(scene: Scene) -> bool:
    """Whether what lies does so along a line that the vessel has laid over a plane."""
    return is_lay(scene) and _is_even(scene) and not laid_loads.is_dragged(scene)


def outruns_its_foot(scene: Scene) -> bool:
    """Whether a lay's cable takes more momentum along than its tension, (m + m_a) V^2 > T, up to
    where it is higher above the floor than a layer in which what lies does not fold."""
    if not is_lay(scene) or laid_loads.is_dragged(scene):
        return False
    environment, kind = scene.environment, scene.cable_types[scene.cables[-1].type]
    momentum = sea_floor.momentum_of(kind, environment.water_density, scene.rate_at_start)
    height = momentum / sea_floor.contact_weight(kind, environment.gravity)
    return height > sea_floor.unfolding_layer(scene)


def on_softer_floor(scene: Scene) -> Scene | None:
    """A lay at a coarser tolerance, whose floor is softer; None: no lay, or coarse as it is."""
    tolerance = SOFTER * scene.solver.tolerance
    if tolerance > COARSEST or not is_laid_back(scene):
        return None
    return _at_tolerance(scene, tolerance)


def stiffer(scene: Scene, layer: float) -> Scene:
    """The scene with cables that bend on to the floor over so long a layer [m] at least."""
    gravity = scene.environment.gravity
    types = {
        name: kind.model_copy(
            update={
                "bending_stiffness": max(
                    kind.bending_stiffness, sea_floor.contact_weight(kind, gravity) * layer**3
                )
            }
        )
        for name, kind in scene.cable_types.items()
    }
    return scene.model_copy(update={"cable_types": types})


def lie_still(
    block: Block,
    scene: Scene,
    solve: Callable[[], int],
    hold: Callable[[], int],
    coarser: Block | None = None,
    steadier: bool = False,
) -> int:
    """Bring a block to equilibrium with what lies held by its own friction; a status.

    First without the drag on what lies, and with bristles so long that what lies slides to where no
    tension is left; then with both as they are, each bristle drawn by what it has to hold.

    Args:
        solve: equilibrium of the block as it is, a status.
        hold: the same, to where bristles have got shorter.
        coarser: leaves the first of them out; what lies is where it is in this block.
        steadier: on short bristles only.
    """
    state = block.scalars
    shape, drawn = shape_and_roots(block)
    q, rest = _positions(block), drawn[:, : int(block.header.dimension)]
    bristle, soft = float(state.bristle), longest_bristle(block, scene)
    dragged = laid_loads.is_dragged(scene)
    if not _is_even(scene):
        few = continuation.in_few_steps
        solve, hold = (
            partial(few, block, solve, LAID_START_STEPS),
            partial(few, block, hold, LAID_START_STEPS),
        )
    if coarser is not None:
        laid = _places_in(coarser, block)
    else:
        laid = _laid_line(block, scene, q)
        status, soft = _lay_freely(block, scene, laid, solve, hold, steadier=steadier)
        if status != at.OK or not which_lie(block, scene).any():
            return status
    if dragged:
        laid = q.copy()  # no line was laid: bristles are drawn from where the cable is
    elif coarser is None:
        down = which_bear(block, scene)
        laid[~down] = q[~down]  # comes to lie where it is
        _put_on(block, laid, down)

    def hold_with(share: float) -> int:
        """Bristles of their own length at 1. As they get shorter they pull what slid aside back."""
        bears, drags = _loads(block, scene)
        state.bristle = soft * (bristle / soft) ** share
        drawn[:] = shape
        rest[:] = laid - state.bristle * _shares(block, scene, bears, drags, dragged)
        status = hold()
        state.bristle = bristle
        return status

    if coarser is not None:
        before = block.image.copy()
        status = hold_with(1.0)
        if status == at.OK or not is_laid_back(scene):
            return status
        # Cable that bends less is longer at the foot: where what lies stays, that presses it.
        block.image[:] = before
        status, soft = _lay_freely(block, scene, laid, solve, hold, steadier=steadier)
        if status != at.OK:
            return status
    return continuation.continued(block, hold_with, step=1.0, smallest=SMALLEST_STEP)


def _is_even(scene: Scene) -> bool:
    """Whether the floor is a plane."""
    return scene.environment.floor is not None and scene.environment.floor.z is not None


def shape_and_roots(block: Block) -> tuple[FloatArray, FloatArray]:
    """Places and slopes of the nodes, and those that their bristles are drawn from."""
    words = int(block.header.nodes), 2 * int(block.header.dimension)
    return block.array(Header.position, *words), block.array(Header.rest, *words)


def longest_bristle(block: Block, scene: Scene) -> float:
    """With which what lies finds where no tension is left [m]."""
    return (LAYING if is_lay(scene) else SOFT) * float(block.scalars.length)


def _lay_freely(
    block: Block,
    scene: Scene,
    laid: FloatArray,
    solve: Callable[[], int],
    at_once: Callable[[], int],
    *,
    steadier: bool,
) -> tuple[int, float]:
    """Let what lies slide on long bristles, and its line with it, to where they hold nothing; a
    status, and how long they are [m].

    Over ridges what long ones hold may slide from crest to crest without an end: there bristles of
    their own length are tried, which may leave some tension where the cable lands.

    Args:
        laid: where the nodes lie, or would, (nodes, dimension) [m]; moved along.
        solve: equilibrium of the block as it is, a status; at_once: the same on its own floor only.
    """
    soft = longest_bristle(block, scene)
    before, lay = block.image.copy(), laid.copy()
    if is_lay(scene) and not _is_even(scene) and not laid_loads.is_dragged(scene):
        for length in (soft, float(block.scalars.bristle)):
            block.image[:], laid[:] = before, lay
            status = _let_slide(block, scene, laid, at_once, length)
            if status == at.OK:
                break
        return status, length
    if not is_laid_back(scene):
        return _let_slide(block, scene, laid, solve, soft), soft
    with _level_across(block, scene, laid[-1]) as along:
        before = block.image.copy()
        status = at.STATICS_FAILED if steadier else _let_slide(block, along, laid, solve, soft)
        if status != at.OK:
            block.image[:], laid[:] = before, lay
            soft *= STEADIER
            status = _let_slide(block, along, laid, solve, soft)
    return status, soft


@contextmanager
def _level_across(block: Block, scene: Scene, place: FloatArray) -> Iterator[Scene]:
    """A lay whose floor, in block and scene, is level across the vessel's way.

    Friction holds what lies on such a slope, and makes the floor's force vertical; in a touchdown
    that has yet to be found it does so nearly, and a line without tension at its foot would run
    down the slope by that: as far as tau L, and elsewhere on every mesh.
    place: where both floors are as high, in the block, (dimension,).
    """
    floor = scene.environment.floor
    assert floor is not None
    state, velocity = block.scalars, scene.motion().evaluate(0.0)[1][:2]
    x, y, _z = earth(block, place[None])[0].tolist()
    slope = float(np.dot(floor.slope, velocity)) * velocity / float(velocity @ velocity)
    level = {"z": floor.height(x, y), "slope": tuple(slope.tolist()), "at": (x, y)}
    environment = scene.environment.model_copy(update={"floor": floor.model_copy(update=level)})
    plane = state.floor_plane.copy()
    state.floor_plane = (level["z"], *slope, x, y)
    try:
        yield scene.model_copy(update={"environment": environment})
    finally:
        state.floor_plane = plane


def _let_slide(
    block: Block, scene: Scene, laid: FloatArray, solve: Callable[[], int], soft: float
) -> int:
    """Let what lies slide over this floor on bristles so long [m], as `_lay_freely`; a status."""
    state = block.scalars
    shape, drawn = shape_and_roots(block)
    q, rest = _positions(block), drawn[:, : int(block.header.dimension)]
    bristle = float(state.bristle)
    dragged = laid_loads.is_dragged(scene)
    # What a lay has laid is at rest over the ground: only a current pulls at it.
    drifts = not dragged and not (is_lay(scene) and scene.environment.current is None)
    grown, _drags = _loads(block, scene)
    for _ in range(PASSES):
        bears = grown
        state.bristle = soft
        drawn[:] = shape
        rest[:] = laid - soft * _shares(block, scene, bears, None, dragged)
        kept = _without_drag(block, scene) if drifts else None
        status = solve()
        if kept is not None:
            kept()
        state.bristle = bristle
        lies = which_lie(block, scene)
        if status != at.OK or not lies.any():
            return status
        moved = _slide(laid, q, lies, bears, even=_is_even(scene))
        held = state.friction * float(bears[lies] @ moved[lies]) / soft
        # What the floor bears for long has grown meanwhile, and friction with it.
        grown, _drags = _loads(block, scene)
        calm = held <= LAID_START_CALM * scene.solver.tolerance * float(bears.sum())
        if calm and np.all(np.abs(grown - bears) <= GROWN * bears):
            break
    return int(at.OK)


def let_go(block: Block, scene: Scene, solve: Callable[[], int], *, steadier: bool = False) -> None:
    """Take what a lay's line pulls with off what hangs; without an equilibrium nothing changes.

    What bends on to the floor is shorter than the line it lies on by millimetres. Held where it was
    put, that stretches the line: by a hundredth of its tension, and another one on every mesh. On
    long bristles it pulls at nothing; short ones that are drawn by the same share hold the same.

    Args:
        solve: equilibrium of the block as it is, a status.
    """
    if not _is_even(scene):
        return
    nodes = int(block.header.nodes)
    tension = np.abs(block.array(Header.tension, nodes, 2)[:, 0])
    pulls = tension[_lying_elements(block, which_lie(block, scene))].max(initial=0.0)
    edges = block.array(Header.edges, nodes, at.EDGE_WORDS)
    weight = float(edges[1:, at.Edge.weight] @ edges[1:, at.Edge.length])
    if pulls <= LAID_START_CALM * scene.solver.tolerance * abs(weight):
        return
    before = block.image.copy()
    lay = _laid_line(block, scene, _positions(block))
    status, soft = _lay_freely(block, scene, lay, solve, solve, steadier=steadier)
    if status == at.OK:
        shape, drawn = shape_and_roots(block)
        bristle = float(block.scalars.bristle)
        drawn[:] = shape - bristle / soft * (shape - drawn)
        bears, drags = _loads(block, scene)  # without the drag on what lies, so far
        drag = _shares(block, scene, bears, drags, False) - _shares(
            block, scene, bears, None, False
        )
        drawn[:, : int(block.header.dimension)] -= bristle * drag
        status = solve()
    if status != at.OK:
        block.image[:] = before


def _places_in(other: Block, block: Block) -> FloatArray:
    """Where the nodes of a block are in another one, (nodes, dimension) [m]."""
    from cablemodel.solvers import library as entry

    nodes = int(block.header.nodes)
    edges = block.array(Header.edges, nodes, at.EDGE_WORDS)
    arcs = edges[:, at.Edge.start] + edges[:, at.Edge.length]
    arcs[0] = 0.0
    joints = block.integers(Header.joint, nodes)
    parents = block.integers(Header.parent, nodes)
    rows = np.empty(at.STATION_WORDS * nodes)
    entry.sample(other.ints, other.reals, arcs, rows)
    found = rows.reshape(nodes, -1)[:, at.Station.position.span]
    places = np.array([local(block, place, point=True) for place in found])
    own = _positions(block)
    for node in np.flatnonzero(joints):  # both ends of a body have the same arc length
        places[node] = places[parents[node]] + own[node] - own[parents[node]]
    return places


def _laid_line(block: Block, scene: Scene, q: FloatArray) -> FloatArray:
    """Where each node lies, or would if it landed: on the line of what lies now, unstretched.

    A lay's runs from its far end, which nothing pulls aside, the way that the vessel goes. Over a
    depth table what lies stays where it is; its line goes on towards the vessel.
    q: positions, (nodes, dimension) [m].
    """
    line = q.copy()
    lies = np.flatnonzero(which_lie(block, scene))
    if len(lies) < 2:
        return line
    foot, tail = int(lies[0]), int(lies[-1])
    even = _is_even(scene)
    ends = _on_floor(block, scene, q[[foot, tail]]) if even else q[[foot, tail]]
    way = ends[1] - ends[0]
    runs_back = is_laid_back(scene)
    way = (
        _way_back(block, scene)
        if runs_back
        else way / max(float(np.linalg.norm(way)), NO_DIRECTION)
    )
    edges = block.array(Header.edges, len(q), at.EDGE_WORDS)
    lengths = np.where(block.integers(Header.joint, len(q)) == 0, edges[:, at.Edge.length], 0.0)
    for body in block.array(Header.bodies, int(block.header.body_count), at.BODY_WORDS):
        if body[at.Body.node] >= 0:
            lengths[int(body[at.Body.node])] += body[at.Body.length]
    arcs = np.cumsum(lengths)
    straight = np.outer(arcs - arcs[foot], way)
    line[:foot] = ends[0] + straight[:foot]
    if even:
        line = ends[1] + straight - straight[tail] if runs_back else ends[0] + straight
        line += float(np.mean((q - line)[lies] @ way)) * way
    return line


def _way_back(block: Block, scene: Scene) -> FloatArray:
    """Along an even floor, behind a vessel under way: unit vector in the block, (dimension,)."""
    velocity = np.asarray(scene.motion().evaluate(0.0)[1])
    way = local(block, laid_loads.way_back(scene, velocity), point=False)
    return np.asarray(way / np.linalg.norm(way))


def _on_floor(block: Block, scene: Scene, places: FloatArray) -> FloatArray:
    """Places (n, dimension) in the block, brought to an even floor across it."""
    up = _up_at(block, scene, earth(block, places)[0])
    return np.asarray(places - np.outer(gaps_above(block, scene, places), up))


def _up_at(block: Block, scene: Scene, place: FloatArray) -> FloatArray:
    """Out of the floor at a place (3,) of the earth [m], in the block, (dimension,)."""
    up = local(block, laid_loads.out_of_floor(scene, float(place[0]), float(place[1])), point=False)
    return np.asarray(up / np.linalg.norm(up))


def _downhill(up: FloatArray) -> FloatArray:
    """Along the floor: what it does not bear of a unit weight, from `_up_at`, (dimension,)."""
    down: FloatArray = up * up[-1]
    down[-1] -= 1.0
    return down


def _put_on(block: Block, line: FloatArray, lies: NDArray[np.bool_]) -> None:
    """Put what lies back on its line, with slopes along it."""
    nodes, dimension = int(block.header.nodes), int(block.header.dimension)
    q = block.array(Header.position, nodes, 2 * dimension)
    places = np.flatnonzero(lies)
    if len(places) < 3:
        return
    turned = np.gradient(line[places], axis=0)
    turned /= np.maximum(np.linalg.norm(turned, axis=1), NO_DIRECTION)[:, None]
    for node, along in zip(places[2:], turned[2:], strict=True):
        q[node, :dimension] = line[node]
        q[node, dimension:] = along * np.linalg.norm(q[node, dimension:])


def _slide(
    line: FloatArray, q: FloatArray, lies: NDArray[np.bool_], bears: FloatArray, *, even: bool
) -> FloatArray:
    """Let the laid line follow what lies along itself: as a whole on an even floor, else each node.

    Returns how far each node was from it, (nodes,) [m].
    """
    places = np.flatnonzero(lies)
    way = line[places[-1]] - line[places[0]]
    size = float(np.linalg.norm(way))
    along = (q - line) @ (way / max(size, NO_DIRECTION))
    along[~lies] = 0.0
    along[: places[0]] = along[places[0]]
    if even:
        along[:] = bears[lies] @ along[lies] / float(bears[lies].sum())
    line += np.outer(along, way / max(size, NO_DIRECTION))
    return np.asarray(np.abs(along), dtype=np.float64)


def _without_drag(block: Block, scene: Scene) -> Callable[[], None]:
    """Take the drag off the elements and bodies that lie; returns what puts it back.

    It turns with the cable, and cable that bristles so long hold would drift with it.
    """
    nodes = int(block.header.nodes)
    lies = which_bear(block, scene)  # what comes down yet feels the vessel's motion
    edges = block.array(Header.edges, nodes, at.EDGE_WORDS)
    bodies = block.array(Header.bodies, int(block.header.body_count), at.BODY_WORDS)
    columns = [at.Edge.drag_normal.word, at.Edge.drag_tangential.word]
    of_body = [at.Body.drag.word, at.Body.drag_axial.word]
    kept, kept_bodies = edges[:, columns].copy(), bodies[:, of_body].copy()
    lying = _lying_elements(block, lies)
    for column in columns:
        edges[lying, column] = 0.0
    for body in bodies:
        node = int(body[at.Body.node])
        if node >= 0 and lies[node]:
            body[of_body] = 0.0

    def put_back() -> None:
        edges[:, columns] = kept
        bodies[:, of_body] = kept_bodies

    return put_back


def _lying_elements(block: Block, lies: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which elements, by the node at their far end, lie at both ends, (nodes,)."""
    nodes = int(block.header.nodes)
    parents = block.integers(Header.parent, nodes)
    return np.asarray(lies & lies[np.maximum(parents, 0)])


def _positions(block: Block) -> FloatArray:
    """Positions of the nodes, (nodes, dimension) [m]."""
    nodes, dimension = int(block.header.nodes), int(block.header.dimension)
    q: FloatArray = block.array(Header.position, nodes, 2 * dimension)[:, :dimension]
    return q


def gaps_above(block: Block, scene: Scene, places: FloatArray) -> FloatArray:
    """Heights above the floor, across it, of places (n, dimension) in the block, (n,) [m]."""
    floor = scene.environment.floor
    assert floor is not None
    gaps = np.empty(len(places))
    for n, (x, y, z) in enumerate(earth(block, places).tolist()):
        rise = laid_loads.slopes(scene, x, y)
        gaps[n] = (z - floor.height(x, y)) / math.sqrt(1.0 + rise[0] ** 2 + rise[1] ** 2)
    return gaps


def which_lie(block: Block, scene: Scene) -> NDArray[np.bool_]:
    """Which nodes touch the floor, (nodes,)."""
    gaps = gaps_above(block, scene, _positions(block))
    return np.asarray(gaps < float(block.scalars.floor_depth))


def which_bear(block: Block, scene: Scene) -> NDArray[np.bool_]:
    """Which nodes are down on the floor, not at the edge of its contact layer, (nodes,)."""
    gaps = gaps_above(block, scene, _positions(block))
    return np.asarray(gaps < LYING * float(block.scalars.floor_depth))


def _along(block: Block) -> FloatArray:
    """Unit vectors along the cable at the nodes, away from the vessel, (nodes, dimension)."""
    nodes, dimension = int(block.header.nodes), int(block.header.dimension)
    slopes = block.array(Header.position, nodes, 2 * dimension)[:, dimension:]
    return np.asarray(slopes / np.maximum(np.linalg.norm(slopes, axis=1), NO_DIRECTION)[:, None])


def _flow(block: Block, scene: Scene) -> tuple[FloatArray, FloatArray, FloatArray]:
    """At the nodes: drag across and along the cable over its coefficients [m2/s2], and the velocity
    of the cable over the ground [m/s]; (nodes, dimension) each."""
    along = _along(block)
    water = laid_loads.water_velocity(scene, earth(block, _positions(block))[:, 2])
    velocity = local(block, scene.motion().evaluate(0.0)[1], point=False)
    own = velocity + scene.rate_at_start * along
    if block.scalars.laid:
        own[which_lie(block, scene)] = 0.0
    flow = np.array([local(block, value, point=False) for value in water]) - own
    tangential = np.sum(flow * along, axis=1)[:, None] * along
    normal = flow - tangential
    normal *= np.linalg.norm(normal, axis=1)[:, None]
    tangential *= np.linalg.norm(tangential, axis=1)[:, None]
    return normal, tangential, own


def _loads(block: Block, scene: Scene) -> tuple[FloatArray, FloatArray]:
    """What the floor bears at the nodes at rest, and the drag on elements and bodies that lie.

    (nodes,) and (nodes, dimension) [N].
    """
    nodes, dimension = int(block.header.nodes), int(block.header.dimension)
    edges = block.array(Header.edges, nodes, at.EDGE_WORDS)
    parents = block.integers(Header.parent, nodes)
    joints = block.integers(Header.joint, nodes)
    normal, tangential, _own = _flow(block, scene)
    lies = which_bear(block, scene)
    lying = _lying_elements(block, lies)
    bears, drags = np.zeros(nodes), np.zeros((nodes, dimension))
    for node in range(1, nodes):
        if joints[node]:
            continue
        edge, half = edges[node], 0.5 * edges[node, at.Edge.length]
        for end in (int(parents[node]), node):
            bears[end] += half * edge[at.Edge.contact] * edge[at.Edge.support]
            if lying[node]:
                drags[end] += half * edge[at.Edge.drag_normal] * normal[end]
                drags[end] += half * edge[at.Edge.drag_tangential] * tangential[end]
    for body in block.array(Header.bodies, int(block.header.body_count), at.BODY_WORDS):
        node = int(body[at.Body.node])
        if node < 0:
            continue
        ends = [int(parents[node]), node] if body[at.Body.length] > 0.0 else [node]
        for end, support_load in zip(ends, body[at.Body.support.span], strict=False):
            bears[end] += abs(body[at.Body.weight]) * support_load / len(ends)
            if lies[node]:
                drags[end] += body[at.Body.drag] * normal[end] / len(ends)
                drags[end] += body[at.Body.drag_axial] * tangential[end] / len(ends)
    return bears, drags


def asked_of_friction(block: Block, scene: Scene) -> float:
    """What a lay's cable needs where it lies behind the vessel, against its slope and the current
    there, over the friction that there is: the most at any node [-]; 0 where nothing was laid."""
    if not is_laid_back(scene):
        return 0.0
    edges = block.array(Header.edges, int(block.header.nodes), at.EDGE_WORDS)
    places, way, most = earth(block, _positions(block)), _way_back(block, scene), 0.0
    water = laid_loads.water_velocity(scene, places[:, 2])
    for node in np.flatnonzero(_lying_elements(block, which_bear(block, scene))):
        contact, drag = edges[node, at.Edge.contact], edges[node, at.Edge.drag_normal]
        if contact == 0.0:
            continue  # a joint
        up, flow = _up_at(block, scene, places[node]), local(block, water[node], point=False)
        across = flow - (flow @ way) * way
        across -= (across @ up) * up
        pull = contact * _downhill(up) / up[-1] + drag * float(np.linalg.norm(across)) * across
        most = max(most, float(np.linalg.norm(pull)) / contact)
    return most / float(block.scalars.friction)


def _shares(
    block: Block, scene: Scene, bears: FloatArray, drags: FloatArray | None, dragged: bool
) -> FloatArray:
    """Bristles at the nodes, in units of their length, (nodes, dimension).

    They make the floor's whole force vertical, as the weight is that it bears, and hold the drag.
    dragged: they are drawn by the motion over the floor instead.
    """
    friction = float(block.scalars.friction)
    own = _flow(block, scene)[2]
    share = np.zeros_like(own)
    places = earth(block, _positions(block))
    steep = np.zeros(len(own))
    for node in np.flatnonzero(bears > 0.0):
        up = _up_at(block, scene, places[node])
        if dragged:
            along = own[node] - (own[node] @ up) * up
            share[node] = SLIDES * along / max(float(np.linalg.norm(along)), NO_DIRECTION)
            continue
        down = _downhill(up)
        steep[node] = np.linalg.norm(down) / up[-1]
        share[node] = down / max(float(np.linalg.norm(down)), NO_DIRECTION)
        if drags is not None:
            drags[node] -= (drags[node] @ up) * up
    if dragged:
        return share
    share *= _drawn(block, scene, steep / friction)[:, None]
    if drags is not None:
        share += drags / (friction * np.maximum(bears, NO_DIRECTION))[:, None]
    return share


def _drawn(block: Block, scene: Scene, wanted: FloatArray) -> FloatArray:
    """Bristles at the nodes by which friction is the wanted part of the largest there can be.

    wanted: (nodes,). A bristle slips where the floor presses less than it pulls: what is lost
    there, at the place where the cable lands, the rest of the element has to hold.
    """
    q = _positions(block)
    nodes, dimension = q.shape
    slopes = block.array(Header.position, nodes, 2 * dimension)[:, dimension:]
    edges = block.array(Header.edges, nodes, at.EDGE_WORDS)
    parents = block.integers(Header.parent, nodes)
    depth = float(block.scalars.floor_depth)
    gaps = gaps_above(block, scene, q)
    drawn = wanted * (gaps < depth)  # at a body, or anywhere on the level
    ends = [
        (int(parents[n]), n) for n in np.flatnonzero(block.integers(Header.joint, nodes) == 0)[1:]
    ]
    near = [
        (p, n) for p, n in ends if min(gaps[p], gaps[n]) < depth + 0.5 * edges[n, at.Edge.length]
    ]
    if not near:
        return drawn
    upper, lower = np.array(near).T
    h = edges[lower, at.Edge.length]
    data = np.stack([q[upper], slopes[upper] * h[:, None], q[lower], slopes[lower] * h[:, None]])
    points = np.einsum("pk,ked->epd", CONTACT_H, data)
    law = law_of_contact(gaps_above(block, scene, points.reshape(-1, dimension)) / depth)
    law = law.reshape(len(near), -1)
    force = (h * edges[lower, at.Edge.contact] * edges[lower, at.Edge.support])[
        :, None
    ] * CONTACT_WEIGHTS

    def at_nodes(values: FloatArray) -> FloatArray:
        """Forces at the points (elements, points), shared out to the nodes (nodes,)."""
        found = np.zeros(nodes)
        np.add.at(found, upper, (force * values) @ (1.0 - CONTACT_POINTS))
        np.add.at(found, lower, (force * values) @ CONTACT_POINTS)
        return found

    touches = at_nodes(law) > 0.0
    drawn = np.where(touches, wanted, drawn)
    needed = wanted * at_nodes(law)
    for _ in range(DRAWN_ROUNDS):
        bristle = np.outer(drawn[upper], 1.0 - CONTACT_POINTS) + np.outer(
            drawn[lower], CONTACT_POINTS
        )
        held = at_nodes(np.minimum(bristle, law))
        drawn = np.where(
            held > 0.0,
            drawn * np.clip(needed / np.maximum(held, 1e-300), DRAWN_FROM, DRAWN_TO),
            drawn,
        )
    return np.asarray(np.minimum(drawn, DRAWN_MOST), dtype=np.float64)


def law_of_contact(gaps: FloatArray) -> FloatArray:
    """What the floor bears over what it bears at rest; gaps (n,) in units of the contact layer.

    That of kernels/floor/contact.py, which has no machine code of its own.
    """
    steepness = -2.0 * gaps / STIFFENING
    below = 1.0 + STIFFENING * np.expm1(np.minimum(steepness, STEEPEST))
    below += STIFFENING * np.maximum(steepness - STEEPEST, 0.0) * np.exp(STEEPEST)
    return np.asarray(np.where(gaps >= 0.0, np.clip(1.0 - gaps, 0.0, None) ** 2, below))
