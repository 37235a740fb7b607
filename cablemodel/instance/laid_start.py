"""A static start of cable that friction holds on the sea floor where it was laid.

A line with a free end comes to rest without friction where the floor is level, the water still and
the vessel at rest: nothing pushes what lies. On a slope, or in a current, the same line would slide
away, and fold. What has been laid there has many shapes at rest, by what tension it was laid with.
It starts as a lay without tension leaves it: straight behind the vessel, each piece held by just the
friction that balances its own weight along the slope and its own drag, so that no tension is left
where it lands. What the vessel drags over the floor feels the friction of that motion instead.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel import laid_loads
from cablemodel.block import Block
from cablemodel.instance.frame import local
from cablemodel.instance.scales import rate_at_start
from cablemodel.kernels import layout as at

if TYPE_CHECKING:
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]
import os
DBG = os.environ.get('DBG')

SOFT = 3.0
"""Way in which friction is mobilised while the start is sought, in units of the line's length: it
follows what slides along the floor, as no bristle does."""
PASSES = 12
"""In which friction is set anew to what each piece needs, at most."""
CALM = 0.02
"""What the bristles may hold beyond that, in tau times the weight of the line."""
SLIDES = 3.0
"""Of a bristle's length: well beyond where it slips."""


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
    moves = laid_loads.is_dragged(scene.motion().evaluate(0.0)[1], rate_at_start(scene))
    return flows or moves or floor.z is None or any(floor.slope)


def lie_still(block: Block, scene: Scene, solve: Callable[[], int]) -> int:
    """Bring a block to equilibrium with what lies held by its own friction; a status.

    First without the drag on what lies, and with bristles so long that what lies slides to where no
    tension is left; then with both as they are, each bristle drawn by what it has to hold.

    Args:
        solve: equilibrium of the block as it is, a status.
    """
    reals = block.reals
    nodes, dimension = int(block.ints[at.I_NODES]), int(block.ints[at.I_DIMENSION])
    q = block.array(at.O_POSITION, nodes, 2 * dimension)[:, :dimension]
    rest = block.array(at.O_REST, nodes, 3)[:, :dimension]
    bristle, soft = float(reals[at.S_BRISTLE]), SOFT * float(reals[at.S_LENGTH])
    dragged = laid_loads.is_dragged(scene.motion().evaluate(0.0)[1], rate_at_start(scene))
    status: int = at.OK
    even = scene.environment.floor is not None and scene.environment.floor.z is not None
    laid = _laid_line(block, scene, q)
    for _ in range(PASSES):
        bears, _drags = _loads(block, scene)
        reals[at.S_BRISTLE] = soft
        rest[:] = laid - soft * _shares(block, scene, bears, None, dragged)
        kept = None if dragged else _without_drag(block, scene)
        status = solve()
        if kept is not None:
            kept()
        reals[at.S_BRISTLE] = bristle
        if status != at.OK:
            return status
        lies = _lies(block, scene)
        if not lies.any():
            return status
        moved = _slide(laid, q, lies, bears, even=even)
        held = reals[at.S_FRICTION] * float(bears[lies] @ moved[lies]) / soft
        if DBG: print(_, held / (scene.solver.tolerance * float(bears.sum())), moved.max()/reals[at.S_LENGTH])
        if held <= CALM * scene.solver.tolerance * float(bears.sum()):
            break
    _put_on(block, laid, _lies(block, scene))
    bears, drags = _loads(block, scene)
    rest[:] = laid - bristle * _shares(block, scene, bears, drags, dragged)
    status = solve()
    if DBG: print("final", status, np.abs(block.array(at.O_TENSION, nodes, 2)[1:,0]).min())
    return status


def _laid_line(block: Block, scene: Scene, q: FloatArray) -> FloatArray:
    """Where each node lies, or would if it landed: on the line of what lies now, unstretched.

    Over a depth table what lies stays where it is; its line goes on towards the vessel.
    q: positions, (nodes, dimension) [m].
    """
    line = q.copy()
    lies = np.flatnonzero(_lies(block, scene))
    if len(lies) < 2:
        return line
    foot, tail = int(lies[0]), int(lies[-1])
    way = q[tail] - q[foot]
    way /= max(float(np.linalg.norm(way)), 1e-12)
    edges = block.array(at.O_EDGE, len(q), at.EDGE_WORDS)
    lengths = np.where(block.integers(at.O_JOINT, len(q)) == 0, edges[:, at.E_LENGTH], 0.0)
    for body in block.array(at.O_BODY, int(block.ints[at.I_BODIES]), at.BODY_WORDS):
        if body[at.B_NODE] >= 0:
            lengths[int(body[at.B_NODE])] += body[at.B_LENGTH]
    arcs = np.cumsum(lengths)
    straight = np.outer(arcs - arcs[foot], way)
    line[:foot] = q[foot] + straight[:foot]
    if scene.environment.floor is not None and scene.environment.floor.z is not None:
        line = q[foot] + straight
        line += float(np.mean((q - line)[lies] @ way)) * way
    return line


def _put_on(block: Block, line: FloatArray, lies: NDArray[np.bool_]) -> None:
    """Put what lies back on its line, with slopes along it."""
    nodes, dimension = int(block.ints[at.I_NODES]), int(block.ints[at.I_DIMENSION])
    q = block.array(at.O_POSITION, nodes, 2 * dimension)
    places = np.flatnonzero(lies)
    if len(places) < 3:
        return
    turned = np.gradient(line[places], axis=0)
    turned /= np.linalg.norm(turned, axis=1)[:, None]
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
    along = (q - line) @ (way / max(size, 1e-12))
    along[~lies] = 0.0
    along[: places[0]] = along[places[0]]
    if even:
        along[:] = bears[lies] @ along[lies] / float(bears[lies].sum())
    line += np.outer(along, way / max(size, 1e-12))
    return np.abs(along)


def _without_drag(block: Block, scene: Scene) -> Callable[[], None]:
    """Take the drag off the elements and bodies that lie; returns what puts it back.

    It turns with the cable, and cable that bristles so long hold would drift with it.
    """
    nodes = int(block.ints[at.I_NODES])
    lies = _lies(block, scene)
    edges = block.array(at.O_EDGE, nodes, at.EDGE_WORDS)
    bodies = block.array(at.O_BODY, int(block.ints[at.I_BODIES]), at.BODY_WORDS)
    columns = [at.E_DRAG_NORMAL, at.E_DRAG_TANGENTIAL]
    of_body = [at.B_DRAG, at.B_DRAG_AXIAL]
    kept, kept_bodies = edges[:, columns].copy(), bodies[:, of_body].copy()
    edges[np.ix_(_lying_elements(block, lies), columns)] = 0.0
    for body in bodies:
        node = int(body[at.B_NODE])
        if node >= 0 and lies[node]:
            body[of_body] = 0.0

    def put_back() -> None:
        edges[:, columns] = kept
        bodies[:, of_body] = kept_bodies

    return put_back


def _lying_elements(block: Block, lies: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which elements, by the node at their far end, lie at both ends, (nodes,)."""
    nodes = int(block.ints[at.I_NODES])
    parents = block.integers(at.O_PARENT, nodes)
    return np.asarray(lies & lies[np.maximum(parents, 0)])


def _earth(block: Block) -> FloatArray:
    """Places of the nodes in the earth's frame, (nodes, 3) [m]."""
    nodes, dimension = int(block.ints[at.I_NODES]), int(block.ints[at.I_DIMENSION])
    places = block.array(at.O_POSITION, nodes, 2 * dimension)[:, :dimension]
    if dimension == 2:
        plane = block.reals[at.S_PLANE : at.S_PLANE + 2]
        places = places @ np.array([[plane[0], plane[1], 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(places + block.reals[at.S_BASE : at.S_BASE + 3], dtype=np.float64)


def _lies(block: Block, scene: Scene) -> NDArray[np.bool_]:
    """Which nodes touch the floor, (nodes,)."""
    floor = scene.environment.floor
    assert floor is not None
    depth = float(block.reals[at.S_FLOOR_DEPTH])
    return np.array([z - floor.height(float(x), float(y)) < depth for x, y, z in _earth(block)])


def _along(block: Block) -> FloatArray:
    """Unit vectors along the cable at the nodes, away from the vessel, (nodes, dimension)."""
    nodes, dimension = int(block.ints[at.I_NODES]), int(block.ints[at.I_DIMENSION])
    slopes = block.array(at.O_POSITION, nodes, 2 * dimension)[:, dimension:]
    return np.asarray(slopes / np.maximum(np.linalg.norm(slopes, axis=1), 1e-12)[:, None])


def _flow(block: Block, scene: Scene) -> tuple[FloatArray, FloatArray, FloatArray]:
    """At the nodes: drag across and along the cable over its coefficients [m2/s2], and the velocity
    of the cable over the ground [m/s]; (nodes, dimension) each."""
    along = _along(block)
    water = laid_loads.water_velocity(scene, _earth(block)[:, 2])
    velocity = local(block, scene.motion().evaluate(0.0)[1], point=False)
    own = velocity + rate_at_start(scene) * along
    flow = np.array([local(block, value, point=False) for value in water]) - own
    tangential = np.sum(flow * along, axis=1)[:, None] * along
    normal = flow - tangential
    normal *= np.linalg.norm(normal, axis=1)[:, None]
    tangential *= np.linalg.norm(tangential, axis=1)[:, None]
    return normal, tangential, own


def _loads(block: Block, scene: Scene) -> tuple[FloatArray, FloatArray]:
    """At the nodes: the weight that the floor bears per unit of the law of contact, (nodes,), and
    the drag on elements and bodies that lie, (nodes, dimension) [N]."""
    nodes, dimension = int(block.ints[at.I_NODES]), int(block.ints[at.I_DIMENSION])
    edges = block.array(at.O_EDGE, nodes, at.EDGE_WORDS)
    parents = block.integers(at.O_PARENT, nodes)
    joints = block.integers(at.O_JOINT, nodes)
    normal, tangential, _own = _flow(block, scene)
    lies = _lies(block, scene)
    lying = _lying_elements(block, lies)
    bears, drags = np.zeros(nodes), np.zeros((nodes, dimension))
    for node in range(1, nodes):
        if joints[node]:
            continue
        edge, half = edges[node], 0.5 * edges[node, at.E_LENGTH]
        for end in (int(parents[node]), node):
            bears[end] += half * edge[at.E_CONTACT] * edge[at.E_BORNE]
            if lying[node]:
                drags[end] += half * edge[at.E_DRAG_NORMAL] * normal[end]
                drags[end] += half * edge[at.E_DRAG_TANGENTIAL] * tangential[end]
    for body in block.array(at.O_BODY, int(block.ints[at.I_BODIES]), at.BODY_WORDS):
        node = int(body[at.B_NODE])
        if node < 0:
            continue
        ends = [int(parents[node]), node] if body[at.B_LENGTH] > 0.0 else [node]
        for end, borne in zip(ends, body[at.B_BORNE : at.B_BORNE + 2], strict=False):
            bears[end] += abs(body[at.B_WEIGHT]) * borne / len(ends)
            if lies[node]:
                drags[end] += body[at.B_DRAG] * normal[end] / len(ends)
                drags[end] += body[at.B_DRAG_AXIAL] * tangential[end] / len(ends)
    return bears, drags


def _shares(
    block: Block, scene: Scene, bears: FloatArray, drags: FloatArray | None, dragged: bool
) -> FloatArray:
    """Bristles at the nodes, in units of their length, (nodes, dimension).

    They make the floor's whole force vertical, as the weight is that it bears, and hold the drag.
    dragged: they are drawn by the motion over the floor instead.
    """
    floor = scene.environment.floor
    assert floor is not None
    friction, depth = block.reals[at.S_FRICTION], float(block.reals[at.S_FLOOR_DEPTH])
    places, own = _earth(block), _flow(block, scene)[2]
    share = np.zeros_like(own)
    for node, (x, y, z) in enumerate(places.tolist()):
        gap = z - floor.height(x, y)
        if bears[node] <= 0.0 or gap >= depth:
            continue
        rise = laid_loads.slopes(scene, x, y)
        up = local(block, np.array([-rise[0], -rise[1], 1.0]), point=False)
        size = float(np.linalg.norm(up))
        up /= size
        if dragged:
            along = own[node] - (own[node] @ up) * up
            share[node] = SLIDES * along / max(float(np.linalg.norm(along)), 1e-12)
            continue
        down = up * up[-1]
        down[-1] -= 1.0
        share[node] = down / friction
        if drags is not None:
            share[node] += (drags[node] - (drags[node] @ up) * up) / (friction * bears[node])
    return share

