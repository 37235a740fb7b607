"""A system's numbers in its block: settings, elements, vessels' motion, supports, bodies."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.scene.line import Cable
from cablemodel.scene.sea import Sea, sea
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import waves
from cablemodel.solvers.finite_element.start.line_tables import edge_row, fill_body, note_choices
from cablemodel.solvers.finite_element.start.refinement import FALLING_SPARE
from cablemodel.solvers.finite_element.start.scales import is_flexible
from cablemodel.solvers.finite_element.start.sea_floor import PRELOAD, table_words
from cablemodel.solvers.finite_element.start.tables import fill_current, fill_jumps, fill_settings
from cablemodel.solvers.finite_element.start.winch import (
    JOINT_SPARE_NODES,
    WINCH_SPARE_NODES,
    fill_length,
)
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Scalars
from cablemodel.solvers.shared.numbers import REFINEMENT_SPARE, SLOPE_WEIGHT
from cablemodel.systems.built import Built
from cablemodel.systems.free_bodies import FreeBody, Hull
from cablemodel.systems.guess import Guess, standing
from cablemodel.systems.lines import (
    bends_at,
    memory_of_bodies,
    mesh_may_change,
    tension_of_bodies,
)
from cablemodel.systems.motion import axes_of, turning
from cablemodel.systems.scene import SystemScene
from cablemodel.systems.tree import Tree
from cablemodel.systems.vessel_frames import RaoPoint

FloatArray = NDArray[np.float64]
SMALLEST_RADIUS = 1e-3
"""Of a free body without a hull, where its buoyancy gives none [m]."""


def allocated(scene: SystemScene, tree: Tree) -> Built:
    """A block with room for a system on a tree, and its tree in it."""
    current = scene.environment.current
    water = sea(scene)
    foils = [foil for body in scene.bodies.values() for foil in body.foils.values()]
    types = [scene.cable_types[part.cable.type] for part in tree.segments]
    nodes = len(tree.parent)
    spare = (
        REFINEMENT_SPARE[0] + math.ceil(REFINEMENT_SPARE[1] * nodes)
        if mesh_may_change(scene)
        else 0
    )
    spare += at.NODES_OF_A_CUT * len(scene.cuts) + nodes_for_winches(scene, tree)
    pieces = sum(
        len(vessel.motion().pieces) + len(turning(vessel)) for vessel in scene.vessels.values()
    )
    block = Block(
        capacity=nodes + spare,
        pieces=2,
        depths=1 if current is None else len(current.z),
        times=1 if current is None else len(current.t),
        strain_words=sum(len(kind.strain_coefficients) for kind in types),
        bodies=len(tree.masses),
        constraints=len(tree.held),
        rates=max(1, sum(len(winch.rate) for winch in scene.winches.values())),
        winches=len(scene.winches),
        cables=len(tree.segments),
        floor_words=table_words(scene.environment.floor),
        waves=0 if water is None else len(water.amplitude),
        cell_terms=waves.cell_terms(water),
        frames=len(scene.vessels),
        frame_pieces=pieces,
        free_bodies=len(scene.bodies),
        arms=len(tree.arms),
        foils=len(foils),
        foil_words=at.FOIL_ROW_WORDS * sum(len(foil.rows()) for foil in foils),
        cuts=len(scene.cuts),
        rao_words=rao_words(scene, water),
        feet=len(feet_of(scene)),
        closures=len(tree.closures) + len(tree.clamps),
        lines=len(scene.lines),
    )
    block.header.parts = 1
    block.header.nodes = nodes
    falls = FALLING_SPARE if spare and scene.cuts else 0  # memory grows if they are needed
    block.scalars.most_nodes = nodes + spare + falls
    block.header.dimension = 3
    block.integers(Header.parent, nodes)[:] = tree.parent
    block.integers(Header.joint, nodes)[:] = tree.joint
    return Built(scene, block, tree)


def filled(scene: SystemScene, tree: Tree, guess: Guess, *, settings: SystemScene) -> Built:
    """A block for a tree, with all that scene and guess say of it but places and floor.

    settings: the scene whose scales it has.
    """
    from cablemodel.solvers import library as entry

    built = allocated(scene, tree)
    block = built.block
    fill_settings_of(settings, built)
    fill_cables(scene, built)
    fill_frames(scene, block)
    fill_held(scene, built)
    fill_bodies(scene, built, guess)
    fill_closures(scene, built)
    fill_cuts(scene, built)
    fill_winches(scene, built)
    entry.arrange(block.ints, block.reals, lengths_of(scene, tree))
    fill_feet(scene, built)
    fill_waves(scene, block)
    return built


def facts_of_system(scene: SystemScene) -> FloatArray:
    """What `kernels/mesh/lengths.py` wants to know of the lines besides their lengths, the words of
    LineFacts."""
    mass = math.fsum(body.mass for body in scene.bodies.values())
    items = [item for line in scene.lines.values() for item in line.items]
    for item in items:
        if item.body is not None:
            mass += item.body.mass
    words = np.zeros(at.FACT_WORDS)
    facts = at.LineFacts(words, 0)
    facts.mass = mass
    facts.tension = tension_of_bodies(scene)
    facts.memory = memory_of_bodies(scene)
    facts.follows = mesh_may_change(scene)
    facts.above_floor = scene.environment.floor is not None
    facts.bends = not all(
        is_flexible(scene, item.cable) for item in items if item.cable is not None
    )
    return words


def lengths_of(scene: SystemScene, tree: Tree | None = None) -> FloatArray:
    """Rows of CableLength: the cables of each line from its beginning, then those on each drum as
    they leave it. tree: whose cable table has them; without one they are in no table."""
    found = []
    gravity = scene.environment.gravity
    for number, line in enumerate(scene.lines.values()):
        for cable in (item.cable for item in line.items if item.cable is not None):
            row = _length_row(scene, cable, number, -1)
            # Of what floats a thousandth of its weight in air.
            row[at.CableLength.tension] = scene.cable_types[cable.type].typical_weight(gravity)
            if tree is not None:
                parts = enumerate(tree.segments)
                row[at.CableLength.row] = next(n for n, part in parts if part.cable is cable)
            found.append(row)
    for number, (name, winch) in enumerate(scene.winches.items()):
        own = [] if tree is None else tree.wound[name]
        for n, cable in enumerate(winch.drum_cables):
            row = _length_row(scene, cable, list(scene.lines).index(winch.line), number)
            if tree is not None:
                parts = enumerate(tree.segments)
                row[at.CableLength.row] = next(k for k, part in parts if part is own[n])
            found.append(row)
    return np.concatenate(found)


def _length_row(scene: SystemScene, cable: Cable, line: int, winch: int) -> FloatArray:
    """The row of a cable of a line, or on the drum of a winch, in no table."""
    row = np.zeros(at.LENGTH_WORDS)
    fill_length(row, scene, cable)
    row[at.CableLength.row] = -1.0
    row[at.CableLength.line], row[at.CableLength.winch] = line, winch
    return row


def fill_settings_of(scene: SystemScene, built: Built) -> None:
    """Tolerances, water, current, and what follows from the lengths of lines."""
    from cablemodel.solvers import library as entry

    block = built.block
    ints, reals = block.ints, block.reals
    state = Scalars(reals)
    fill_settings(block, scene)
    state.plane = 1.0, 0.0
    rest = block.array(Header.pieces, 2, at.PIECE_WORDS)
    rest[:, at.Piece.end] = math.inf
    entry.measure(ints, reals, lengths_of(scene), facts_of_system(scene))
    fill_current(block, scene)


def fill_cables(scene: SystemScene, built: Built) -> None:
    """Rows of all elements, and point bodies in lines."""
    block, tree = built.block, built.tree
    rho = scene.environment.water_density
    strain = block.array(Header.strain, int(block.header.strain_words))
    table = block.array(Header.cables, len(tree.segments), at.CABLE_WORDS)
    used = 0
    for index, (segment, row) in enumerate(zip(tree.segments, table, strict=True)):
        cable = segment.cable
        kind = scene.cable_types[cable.type]
        strain[used : used + len(kind.strain_coefficients)] = kind.strain_coefficients
        offset = int(block.header.strain) + used
        used += len(kind.strain_coefficients)
        row[at.Cable.displaced] = rho * 0.25 * math.pi * kind.diameter**2
        row[at.Cable.row] = list(scene.lines).index(segment.line)
        row[at.Cable.backward] = segment.backward
        row[at.Cable.counted] = cable.elements is not None
        row[at.Cable.chain] = segment.chain
        row[at.Cable.leaves] = segment.end
        row[at.Cable.hinge] = segment.hinged
        row[at.Cable.body] = segment.mass
        edge = row[at.Cable.edge :]
        edge[:] = edge_row(scene, cable, index, offset)
        note_choices(block, edge)
    edges = block.array(Header.edges, len(tree.parent), at.EDGE_WORDS)
    for node, element in tree.elements.items():
        edges[node] = table[element.segment, at.Cable.edge :]
        edges[node, at.Edge.length] = edges[node, at.Edge.nominal] = element.length
        # Along the tree: where it goes back along a line, arc lengths count as negative.
        backward = tree.segments[element.segment].backward
        start = -element.start - element.length if backward else element.start
        edges[node, at.Edge.start] = start
    bodies = block.array(Header.bodies, len(tree.masses), at.BODY_WORDS)
    for row, mass in zip(bodies, tree.masses, strict=True):
        fill_body(row, mass.node, mass.body, rho)


def nodes_for_winches(scene: SystemScene, tree: Tree) -> int:
    """Nodes that what is on the drums needs."""
    count = 0
    for winch in scene.winches.values():
        mean = mean_element(scene, tree, winch.line)
        count += WINCH_SPARE_NODES
        for item in winch.drum:
            if item.cable is not None:
                elements = item.cable.length / size_on_drum(item.cable, mean)
                count += JOINT_SPARE_NODES + math.ceil(elements)
    return count


def mean_element(scene: SystemScene, tree: Tree, line: str) -> float:
    """Length of an element of a line at first, on average [m]."""
    count = sum(tree.segments[e.segment].line == line for e in tree.elements.values())
    return scene.lines[line].length / count


def size_on_drum(cable: Cable, usual: float) -> float:
    """Length of the elements in which a cable leaves a drum [m]."""
    return usual if cable.elements is None else cable.length / cable.elements


def fill_winches(scene: SystemScene, built: Built) -> None:
    """Where winches are, their rates, and in what elements cables pass them."""
    block, tree = built.block, built.tree
    rates = [row for winch in scene.winches.values() for row in winch.rate]
    table = block.array(Header.rates, max(1, len(rates)), at.RATE_WORDS)
    for place, point in zip(table, rates, strict=False):
        place[:] = point.t, point.rate
    block.header.payout = int(any(row.rate != 0.0 for row in rates))
    cables = block.array(Header.cables, len(tree.segments), at.CABLE_WORDS)
    first = 0
    for line_row in built.line_rows.values():
        line_row.winch = -1.0
    for number, winch in enumerate(scene.winches.values()):
        if winch.at == "start":
            built.line_rows[winch.line].winch = number
        held = tree.held_at(scene, winch)
        row = built.winch(number)
        row.node, row.way = held.node, 1.0 if held.outward else -1.0
        row.cable = segment = tree.elements[held.top].segment
        row.off_drum = -row.way
        fill_chain(scene, tree, cables, tree.segments[segment].chain)
        row.first_rate, row.rates = first, len(winch.rate)
        first += len(winch.rate)


def fill_chain(scene: SystemScene, tree: Tree, cables: FloatArray, chain: int) -> None:
    """Elements in which the cables of a chain pass a winch. cables: the table of all."""
    for number, part in enumerate(tree.segments):
        if part.chain != chain:
            continue
        own = [e.length for e in tree.elements.values() if e.segment == number]
        if own:
            size = math.fsum(own) / len(own)
        else:
            size = size_on_drum(part.cable, mean_element(scene, tree, part.line))
        cables[number, at.Cable.nominal] = size


def fill_frames(scene: SystemScene, block: Block) -> None:
    """Motion of all vessels."""
    rows = block.array(Header.frames, len(scene.vessels), at.FRAME_WORDS)
    table = block.array(Header.frame_pieces, int(block.header.frame_piece_count), at.PIECE_WORDS)
    used = 0
    for row, vessel in zip(rows, scene.vessels.values(), strict=True):
        for place, pieces in (
            (at.Frame.first.word, vessel.motion().pieces),
            (at.Frame.turn_first.word, turning(vessel)),
        ):
            row[place], row[place + 1] = used, len(pieces)
            own = table[used : used + len(pieces)]
            own[:] = pieces
            fill_jumps(own)
            used += len(pieces)


def headings_of(rows: tuple[RaoPoint, ...]) -> list[float]:
    """Headings that a vessel's responses are known for, in [0, 360) and in order [degrees]: those
    of its rows, and where these are of one side the other's, whose responses are alike."""
    given = {row.heading_deg % 360.0 for row in rows}
    if is_one_sided(rows):
        given |= {(360.0 - heading) % 360.0 for heading in given}
    return sorted(given)


def is_one_sided(rows: tuple[RaoPoint, ...]) -> bool:
    """Whether rows are of several headings from one side: 0 to 180 degrees."""
    given = {row.heading_deg for row in rows}
    return len(given) > 1 and all(0.0 <= heading <= 180.0 for heading in given)


def rao_words(scene: SystemScene, water: Sea | None) -> int:
    """Words of the responses of all vessels that have them."""
    components = 0 if water is None else len(water.amplitude)
    headings = sum(len(headings_of(vessel.raos)) for vessel in scene.vessels.values())
    return headings * (1 + components * at.RAO_WORDS)


def fill_waves(scene: SystemScene, block: Block) -> None:
    """The sea's components, and how vessels answer them."""
    water = sea(scene)
    waves.fill(block, water, scene.solver.tolerance)
    if water is None:
        return
    frequency = np.sort(water.frequency)  # as in the block: by their numbers
    words = block.array(Header.raos, rao_words(scene, water))
    frames = block.array(Header.frames, len(scene.vessels), at.FRAME_WORDS)
    used = 0
    for row, vessel in zip(frames, scene.vessels.values(), strict=True):
        if vessel.raos:
            headings = headings_of(vessel.raos)
            row[at.Frame.raos], row[at.Frame.headings] = 1 + used, len(headings)
            table = responses(vessel.raos, frequency)
            own = np.concatenate([np.radians(headings), table.ravel()])
            words[used : used + len(own)] = own
            used += len(own)


def responses(rows: tuple[RaoPoint, ...], frequency: FloatArray) -> FloatArray:
    """Cosine and sine parts (headings, n, RAO_WORDS) at frequencies (n,) [rad/s], by `headings_of`.

    Linear between the frequencies of the rows, and as at the last ones beyond.
    """
    headings = headings_of(rows)
    given = np.array(sorted({2.0 * math.pi / row.period for row in rows}))
    one_sided = is_one_sided(rows)
    found = np.zeros((len(headings), len(given), 6), dtype=complex)
    # Port and starboard are alike: sway, roll and yaw change their sign.
    mirrored = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    for row in rows:
        w = int(np.argmin(np.abs(given - 2.0 * math.pi / row.period)))
        heading = row.heading_deg % 360.0
        found[headings.index(heading), w] = response = row.response
        if one_sided and heading not in (0.0, 180.0):
            found[headings.index(360.0 - heading), w] = mirrored * response
    out = np.zeros((len(headings), len(frequency), at.RAO_WORDS))
    for h, by_frequency in enumerate(found):
        for k in range(6):
            # cos(w t + phase) where the wave is cos(theta), theta = k x - w t.
            out[h, :, 2 * k] = np.interp(frequency, given, by_frequency[:, k].real)
            out[h, :, 2 * k + 1] = np.interp(frequency, given, by_frequency[:, k].imag)
    return out


def fill_held(scene: SystemScene, built: Built) -> None:
    """Nodes at vessels' points and anchors."""
    block = built.block
    names = list(scene.vessels)
    table = block.array(Header.constraints, len(built.tree.held), at.CONSTRAINT_WORDS)
    for row, held in zip(table, built.tree.held, strict=True):
        row[at.Constraint.node] = held.node
        if held.end.anchor is not None:
            row[at.Constraint.kind] = at.HELD_BY_ANCHOR
            row[at.Constraint.position.span] = held.end.anchor
            continue
        owner = held.end.owner
        row[at.Constraint.kind] = at.HELD_BY_FRAME
        row[at.Constraint.frame] = names.index(owner)
        row[at.Constraint.position.span] = scene.vessels[owner].points[held.end.of_owner]
        line = scene.lines[held.line]
        at_end = held.end is line.end
        if bends_at(scene, line, held.end):
            row[at.Constraint.clamped] = at.EXACTLY
            sign = 1.0 if held.outward is not at_end else -1.0  # along the way of the tree
            row[at.Constraint.own_direction.span] = sign * np.array(held.end.clamped)


def cross_matrix(x: FloatArray) -> FloatArray:
    """[x] with [x] y = x x y, (3, 3)."""
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def _inertia(mass: tuple[float, ...], turning: tuple[float, ...], place: FloatArray) -> FloatArray:
    """Matrix of inertia (6, 6) about a point from which masses along the axes and moments of
    inertia about them are at a place."""
    m, c = np.diag(mass), cross_matrix(place)
    return np.block([[m, -m @ c], [c @ m, np.diag(turning) - c @ m @ c]])


def fill_bodies(scene: SystemScene, built: Built, guess: Guess) -> None:
    """Rows of the free bodies, their arms and foils."""
    block, tree = built.block, built.tree
    rho, gravity = scene.environment.water_density, scene.environment.gravity
    rows = block.array(Header.free_bodies, len(scene.bodies), at.FREE_WORDS)
    foils = block.array(Header.foils, int(block.header.foil_count), at.FOIL_WORDS)
    rows_of_foils = int(block.header.foil_words) // at.FOIL_ROW_WORDS
    table = block.array(Header.foil_table, rows_of_foils, at.FOIL_ROW_WORDS)
    used = tabled = 0
    names = list(scene.bodies)
    edges = block.array(Header.edges, len(tree.parent), at.EDGE_WORDS)
    for row, (name, body) in zip(rows, scene.bodies.items(), strict=True):
        node, point = tree.bodies[name]
        reference = np.array(body.place(point))

        def from_reference(place: Any, reference: FloatArray = reference) -> FloatArray:
            return np.array(place) - reference

        size = _size(body)
        row[at.FreeBody.node], row[at.FreeBody.size] = node, size
        edges[node, at.Edge.length] = size / SLOPE_WEIGHT  # increment_norm weighs turns by .3 of it
        row[at.FreeBody.weight] = body.mass * gravity
        row[at.FreeBody.buoyancy] = body.mass * gravity - body.weight_in(scene.environment)
        if body.hull is not None:
            _fill_hull(row, body.hull, reference)
        elif gravity > 0.0 and rho > 0.0:
            volume = max(0.0, row[at.FreeBody.buoyancy]) / (rho * gravity)
            row[at.FreeBody.radius] = max(SMALLEST_RADIUS, (0.75 * volume / math.pi) ** (1.0 / 3.0))
        centre, water = (
            from_reference(body.centre_of_gravity),
            from_reference(body.centre_of_buoyancy),
        )
        row[at.FreeBody.centre.span] = centre
        row[at.FreeBody.buoyancy_centre.span] = water
        row[at.FreeBody.drag_centre.span] = from_reference(body.centre_of_drag)
        row[at.FreeBody.drag.span] = 0.5 * rho * np.array(body.drag_area)
        row[at.FreeBody.turn_drag.span] = 0.5 * rho * np.array(body.drag_turning)
        row[at.FreeBody.origin.span] = -reference
        mass = (body.mass,) * 3
        row[at.FreeBody.solid.span] = _inertia(mass, body.inertia, centre).ravel()
        added = _inertia(body.added_mass, body.added_inertia, water)
        row[at.FreeBody.added.span] = added.ravel()
        row[at.FreeBody.rotation.span] = guess.axes[name].ravel()
        row[at.FreeBody.first_foil], row[at.FreeBody.foil_count] = used, len(body.foils)
        for foil in body.foils.values():
            wing = foils[used]
            span = np.array(foil.span) - np.dot(foil.span, foil.chord) * np.array(foil.chord)
            wing[at.Foil.place.span] = from_reference(foil.position)
            wing[at.Foil.chord.span] = foil.chord
            wing[at.Foil.span.span] = span / np.linalg.norm(span)
            wing[at.Foil.area] = 0.5 * rho * foil.area
            wing[at.Foil.reach] = 0.5 * math.sqrt(foil.area)
            coefficients = foil.rows()
            wing[at.Foil.table] = at.FOIL_ROW_WORDS * tabled
            wing[at.Foil.rows] = len(coefficients)
            table[tabled : tabled + len(coefficients)] = coefficients
            tabled += len(coefficients)
            turned = at.Foil(wing, 0).deflection
            turned.first = turned.last = foil.deflection
            used += 1
    arms = block.array(Header.arms, len(tree.arms), at.ARM_WORDS)
    for row, (node, name, point) in zip(arms, tree.arms, strict=True):
        body = scene.bodies[name]
        own = tree.bodies[name][1]
        origin: FloatArray = np.array(body.place(own))
        row[at.Arm.node], row[at.Arm.body] = node, names.index(name)
        row[at.Arm.place.span] = np.array(body.points[point]) - origin


def _fill_hull(row: FloatArray, hull: Hull, reference: FloatArray) -> None:
    row[at.FreeBody.hull] = at.HULL_SPHERE if hull.height is None else at.HULL_CYLINDER
    row[at.FreeBody.hull_radius] = row[at.FreeBody.radius] = 0.5 * hull.diameter
    row[at.FreeBody.hull_height] = hull.height or 0.0
    row[at.FreeBody.hull_centre.span] = np.array(hull.centre) - reference


def _size(body: FreeBody) -> float:
    """By how much a turn of 1 rad moves what is far out on a body [m]."""
    places = [*body.points.values(), *(foil.position for foil in body.foils.values())]
    reach = max((math.dist(a, b) for a in places for b in places), default=0.0)
    return max(reach, math.sqrt(max(body.inertia) / body.mass))


def feet_of(scene: SystemScene) -> list[tuple[str, FloatArray]]:
    """Bodies and places of all that may touch the floor."""
    if scene.environment.floor is None:
        return []
    return [
        (name, np.array(place))
        for name, body in scene.bodies.items()
        for place in (body.points.values() if body.feet is None else body.feet)
    ]


def fill_feet(scene: SystemScene, built: Built) -> None:
    """Where bodies touch the floor: each foot bears an equal part of the weight."""
    feet = feet_of(scene)
    rows = built.block.array(Header.feet, len(feet), at.FOOT_WORDS)
    names = list(scene.bodies)
    for row, (name, place) in zip(rows, feet, strict=True):
        body = scene.bodies[name]
        own = built.tree.bodies[name][1]
        reference = np.array(body.place(own))
        least = PRELOAD * body.mass * scene.environment.gravity  # of what floats, as of cable
        count = sum(other == name for other, _place in feet)
        row[at.Foot.body] = names.index(name)
        row[at.Foot.place.span] = place - reference
        row[at.Foot.pressed] = 1.0
        row[at.Foot.load] = max(body.weight_in(scene.environment), least) / count


def hold_feet(scene: SystemScene, built: Built) -> None:
    """While a start is sought without friction it holds bodies that stand where the scene puts
    them, by their places there; others slide to where their lines lead them."""
    stands = standing(scene)
    floor = scene.environment.floor
    feet = feet_of(scene)
    rows = built.block.array(Header.feet, len(feet), at.FOOT_WORDS)
    for row, (name, place) in zip(rows, feet, strict=True):
        if name in stands and floor is not None:
            row[at.Foot.friction] = floor.friction
            row[at.Foot.rest.span] = stands[name] + axes_of(scene.bodies[name].attitude) @ place


def fill_closures(scene: SystemScene, built: Built) -> None:
    """Where ends of lines come to what is in the tree before, and what clamps them at bodies."""
    tree, names = built.tree, list(scene.bodies)
    count = len(tree.closures)
    rows = built.block.array(Header.closures, count + len(tree.clamps), at.CLOSURE_WORDS)
    for row, (node, name, direction) in zip(rows[count:], tree.clamps, strict=True):
        row[at.Closure.node], row[at.Closure.other] = node, -1.0
        row[at.Closure.body], row[at.Closure.clamp] = names.index(name), 1.0
        row[at.Closure.place.span] = direction
        row[at.Closure.tension] = built.block.scalars.tension_scale  # until it is known
    for row, (node, owner, where) in zip(rows[:count], tree.closures, strict=True):
        row[at.Closure.node], row[at.Closure.body], row[at.Closure.other] = node, -1.0, -1.0
        if isinstance(where, str):
            own = tree.bodies[owner][1]
            body = scene.bodies[owner]
            row[at.Closure.body] = names.index(owner)
            row[at.Closure.place.span] = np.array(body.place(where)) - np.array(body.place(own))
        else:
            gaps = [abs(arc - where) if line == owner else math.inf for line, arc in tree.arcs]
            row[at.Closure.other] = int(np.argmin(gaps))


def fill_cuts(scene: SystemScene, built: Built) -> None:
    """Where and when lines are to be cut."""
    tree = built.tree
    rows = built.block.array(Header.cuts, len(scene.cuts), at.CUT_WORDS)
    for row, cut in zip(rows, scene.cuts.values(), strict=True):
        place = scene.lines[cut.line].arc_at(cut.at)
        element = min(
            (e for e in tree.elements.values() if tree.segments[e.segment].line == cut.line),
            key=lambda e: max(e.start - place, place - e.start - e.length),
        )
        backward = tree.segments[element.segment].backward
        row[at.Cut.segment] = element.segment
        row[at.Cut.arc] = -place if backward else place
        if cut.at in ("start", "end"):
            begins = (cut.at == "start") is not backward
            row[at.Cut.side] = at.CUT_START if begins else at.CUT_END
        row[at.Cut.time] = math.inf if cut.time is None else cut.time
        row[at.Cut.tension] = math.inf if cut.tension is None else cut.tension
        row[at.Cut.done] = math.inf
