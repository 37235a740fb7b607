"""A system's block from the first states of its parts: lines that start alone, and the rest.

Each part has come to rest, or runs steadily, on the floor and with the scales of the whole. What a
state and its elements are goes into the whole's block as it is: nothing is sought again.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import sea_floor
from cablemodel.solvers.finite_element.start.first_state import hold_supports
from cablemodel.solvers.finite_element.start.frame import earth
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel.solvers.shared.numbers import SAME_PLACE
from cablemodel.systems.built import Built
from cablemodel.systems.guess import Guess
from cablemodel.systems.lays import Lay
from cablemodel.systems.motion import axes_of
from cablemodel.systems.scene import SystemScene
from cablemodel.systems.tables import filled
from cablemodel.systems.tree import tree_of

FloatArray = NDArray[np.float64]
Indices = NDArray[np.intp]

OF_A_START = (
    at.Edge.bending, at.Edge.bending_full, at.Edge.flexible, at.Edge.damping, at.Edge.damping_01,
    at.Edge.damping_11, at.Edge.stabilisation, at.Edge.third_rest, at.Edge.bears, at.Edge.yields,
    at.Edge.model, at.Edge.nominal, at.Edge.support,
)  # fmt: skip
"""Words of an element that its start has chosen."""
OF_A_CABLE = at.Cable.nominal, at.Cable.shortest
"""The same of a cable: how it leaves a drum."""


def joined(scene: SystemScene, rest: Built | None, starts: list[tuple[Lay, Block]]) -> Built:
    """The system at its initial state.

    rest: what starts as a system; starts: of lines that start alone.
    """
    from cablemodel.solvers import library as entry

    nodes = {} if rest is None else {name: _nodes_in(rest, name) for name in rest.lines}
    nodes |= {lay.line: _nodes_alone(lay, block) for lay, block in starts}
    tree = tree_of(scene, nodes)
    axes = {name: axes_of(body.attitude) for name, body in scene.bodies.items()}
    built = filled(scene, tree, Guess({}, {}, {}, axes), settings=scene)
    block = built.block
    sea_floor.fill(block, scene)
    block.header.sleep = 0
    of_line = np.array([name for name, _arc in tree.arcs])
    for lay, own in starts:
        own_nodes = np.flatnonzero(of_line == lay.line)
        _put_line(built, lay, own, own_nodes if _outward(built, lay) else own_nodes[::-1])
    if rest is not None:
        if rest.friction_holds:  # on shorter bristles than those of lines that start alone
            entry.draw_alike(block.ints, block.reals, float(rest.block.scalars.bristle))
        apart = [lay.line for lay, _own in starts]
        _put_rest(built, rest, np.flatnonzero(~np.isin(of_line, apart)))
    hold_supports(block)
    entry.end_search(block.ints, block.reals)
    return built


def _nodes_in(rest: Built, name: str) -> list[FloatArray]:
    """Arc lengths of the nodes of a line's cables, each from 0 to its length [m]."""
    elements = rest.elements(name)
    arcs = np.append(elements.start, elements.start[-1] + elements.length[-1])
    found, offset = [], 0.0
    for cable in (item.cable for item in rest.scene.lines[name].items if item.cable is not None):
        here = SAME_PLACE * cable.length
        within = (arcs > offset - here) & (arcs < offset + cable.length + here)
        own = np.unique(np.clip(arcs[within] - offset, 0.0, cable.length))
        own = own[np.append(True, np.diff(own) > here)]
        own[0], own[-1] = 0.0, cable.length
        found.append(own)
        offset += cable.length
    return found


def _nodes_alone(lay: Lay, block: Block) -> list[FloatArray]:
    """The same of a line that starts alone, from its beginning in the system to its end."""
    count = int(block.header.nodes)
    edges = block.array(Header.edges, count, at.EDGE_WORDS)
    joints = block.integers(Header.joint, count)
    found: list[list[float]] = []
    segment = -1.0
    for node in range(1, count):
        if joints[node] != at.JOINT_NONE:
            continue
        if edges[node, at.Edge.segment] != segment:
            segment = edges[node, at.Edge.segment]
            found.append([0.0])
        found[-1].append(found[-1][-1] + float(edges[node, at.Edge.length]))
    cables = [np.array(own) for own in found]
    for own, cable in zip(cables, lay.scene.cables, strict=True):
        own[-1] = cable.length
    if lay.winch.at == "start":
        return cables
    return [own[-1] - own[::-1] for own in reversed(cables)]


def _outward(built: Built, lay: Lay) -> bool:
    """Whether the tree goes along a line from its winch outwards."""
    return built.tree.held_at(built.scene, lay.winch).outward


def _put_rest(built: Built, rest: Built, nodes: Indices) -> None:
    """The state of what starts as a system; nodes: where its nodes are in the whole."""
    block, own, count = built.block, rest.block, rest.nodes
    joints = own.integers(Header.joint, count)
    ties = (joints != at.JOINT_ROOT) & (joints != at.JOINT_ROOT_FREE)
    ties[0] = False
    parents = nodes[own.integers(Header.parent, count)]
    assert np.array_equal(block.integers(Header.parent, built.nodes)[nodes][ties], parents[ties])
    for header in (Header.position, Header.velocity, Header.acceleration, Header.rest):
        block.array(header, built.nodes, 6)[nodes] = own.array(header, count, 6)
    block.array(Header.tension, built.nodes, 2)[nodes] = own.array(Header.tension, count, 2)
    edges = block.array(Header.edges, built.nodes, at.EDGE_WORDS)
    _choose_as(edges, nodes, own.array(Header.edges, count, at.EDGE_WORDS))
    scene, scene_of_rest = built.scene, rest.scene
    segments = [k for k, part in enumerate(built.tree.segments) if part.line in rest.lines]
    _leave_as(block, segments, own)
    owners = {*scene_of_rest.lines, *scene_of_rest.winches}
    masses = np.array([mass.owner in owners for mass in built.tree.masses], dtype=bool)
    held = np.array([end.line in owners for end in built.tree.held], dtype=bool)
    bodies = np.ones(len(scene.bodies), dtype=bool)
    closures = np.ones(int(block.header.closure_count), dtype=bool)
    for header, words, mine, of_nodes in (
        (Header.free_bodies, at.FREE_WORDS, bodies, [at.FreeBody.node]),
        (Header.bodies, at.BODY_WORDS, masses, [at.Body.node]),
        (Header.constraints, at.CONSTRAINT_WORDS, held, [at.Constraint.node]),
        (Header.closures, at.CLOSURE_WORDS, closures, [at.Closure.node, at.Closure.other]),
    ):
        table = block.array(header, len(mine), words)
        table[mine] = own.array(header, int(mine.sum()), words)
        for word in of_nodes:
            known = mine & (table[:, word] >= 0.0)
            table[known, word] = nodes[table[known, word].astype(np.intp)]
    feet = int(block.header.foot_count), at.FOOT_WORDS
    block.array(Header.feet, *feet)[:] = own.array(Header.feet, *feet)
    for number, name in enumerate(scene.winches):
        if name in scene_of_rest.winches:
            row = rest.winch(list(scene_of_rest.winches).index(name))
            built.winch(number).rate = float(row.rate)
    block.scalars.third_mode = max(block.scalars.third_mode, own.scalars.third_mode)


def _choose_as(edges: FloatArray, rows: Indices, own: FloatArray) -> None:
    """Let rows of a table of elements have what other ones (n, EDGE_WORDS) have chosen."""
    for word in OF_A_START:
        edges[rows, word] = own[:, word]


def _leave_as(block: Block, segments: list[int], own: Block) -> None:
    """Let cables, rows of a block's table, leave their drums as those of a part do."""
    table = block.array(Header.cables, int(block.header.cable_count), at.CABLE_WORDS)
    rows = own.array(Header.cables, len(segments), at.CABLE_WORDS)
    for word in OF_A_CABLE:
        table[segments, word] = rows[:, word]
    edge = at.Cable.edge.word
    _choose_as(table[:, edge:], np.array(segments, dtype=np.intp), rows[:, edge:])


def _put_line(built: Built, lay: Lay, own: Block, nodes: Indices) -> None:
    """The state of a line that starts alone; nodes: where its nodes are in the whole."""
    block, count = built.block, len(nodes)
    if own.header.lays_slack:
        own.array(Header.edges, count, at.EDGE_WORDS)[:, at.Edge.flexible] *= at.LAID_SLACK
        of_cables = own.array(Header.cables, int(own.header.cable_count), at.CABLE_WORDS)
        of_cables[:, at.Cable.edge.word + at.Edge.flexible.word] *= at.LAID_SLACK
    outward = bool(nodes[0] <= nodes[-1])
    way = 1.0 if outward else -1.0
    for header in (Header.position, Header.velocity, Header.acceleration, Header.rest):
        state = own.array(header, count, 6).copy()
        if header in (Header.position, Header.rest):
            state[:, :3] = earth(own, state[:, :3])
        state[:, 3:] *= way
        block.array(header, built.nodes, 6)[nodes] = state
    # An element has the number of its node that is farther along the tree.
    elements = nodes[1:] if outward else nodes[:-1]
    tension = own.array(Header.tension, count, 2)[1:] * [1.0, way]
    block.array(Header.tension, built.nodes, 2)[elements] = tension
    edges = block.array(Header.edges, built.nodes, at.EDGE_WORDS)
    _choose_as(edges, elements, own.array(Header.edges, count, at.EDGE_WORDS)[1:])
    segments = [k for k, part in enumerate(built.tree.segments) if part.line == lay.line]
    _leave_as(block, segments[::-1] if outward else segments, own)
    # Of a line that lies its weight says nothing: what is promised goes by what hangs.
    cables = block.array(Header.cables, int(block.header.cable_count), at.CABLE_WORDS)
    cables[segments, at.Cable.tension] = np.abs(tension[:, 0]).max()
    bodies = block.array(Header.bodies, len(built.tree.masses), at.BODY_WORDS)
    own_bodies = own.array(Header.bodies, int(own.header.body_count), at.BODY_WORDS)
    out = [k for k, mass in enumerate(built.tree.masses) if mass.owner == lay.line]
    if not outward:
        out.reverse()
    for number, row in zip(out, own_bodies, strict=False):
        bodies[number, at.Body.support.span] = row[at.Body.support.span]
    number = list(built.scene.winches).index(lay.name)
    built.winch(number).rate = float(own.winch.rate)
    block.header.lays_slack = max(int(block.header.lays_slack), int(own.header.lays_slack))
    block.scalars.third_mode = max(block.scalars.third_mode, own.scalars.third_mode)
