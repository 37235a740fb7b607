"""From a scene to the direct solver's block at its initial state."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import StaticsError
from cablemodel.solvers.direct.block import DirectBlock
from cablemodel.solvers.direct.checks import refuse_unsupported
from cablemodel.solvers.direct.kernels import layout as own
from cablemodel.solvers.direct.sections import Section, drum_kind, even, sections_of
from cablemodel.solvers.direct.start import find_initial_state, vertical_plane
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Scalars
from cablemodel.solvers.shared.scene_numbers import strain_range

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.line import Body
from cablemodel.solvers.shared.numbers import SHORTEST_LINE

FloatArray = NDArray[np.float64]

DIRECT_SPARE_NODES = 24
DRIFT_ALLOWED = 1e-3
"""Of the line's length: how far a held end may drift before the run is stopped."""
SLACK_ALLOWED = 1e-4
"""Of a typical tension: what a flexible section may be below zero."""
STILL_SPEED = 0.1
"""Of a line whose vessel does not move: a typical one [m/s]."""
DRAG_OF_SCALE = 0.05
"""Of a cable's drag across, in the typical tension."""
NO_JUMP = 1e-12
"""Jump of the vessel's acceleration that is rounding [m/s2]."""


def build(scene: Scene, *, planar: bool | None = None) -> DirectBlock:
    """A block at the scene's initial state, t = 0.

    ``planar``: False forces three dimensions; else a scene in one vertical plane is planar.

    Raises SceneError (not supported), StaticsError (no steady state found).
    """
    refuse_unsupported(scene)
    sections = sections_of(scene)
    motion = scene.motion()
    current = scene.environment.current
    floor = scene.environment.floor
    spacing = scene.solver.node_spacing
    of_drum = scene.drum_cables
    joints = sum(1 for section in sections[1:] if section.kind != own.RIGID) + len(of_drum)
    nodes = sum(len(section.lengths) + 1 for section in sections) + DIRECT_SPARE_NODES
    for cable in of_drum:
        nodes += 2 * len(even(cable.length, spacing)) + 6
    if floor is not None:
        nodes += 2 * math.ceil(scene.line_length / spacing)
    items = scene.line_and_drum
    bodies = [(place, item.body) for place, item in enumerate(items) if item.body is not None]
    types = list(scene.cable_types)
    block = DirectBlock(
        nodes=nodes,
        sections=len(sections) + 2 * len(of_drum) + 2,
        materials=len(types),
        bodies=len(bodies),
        drum=joints,
        pieces=1 + len(motion.pieces),
        depths=1 if current is None else len(current.z),
        times=1 if current is None else len(current.t),
        strain_words=sum(len(kind.strain_coefficients) for kind in scene.cable_types.values()),
        rates=len(scene.payout.rate),
    )
    ints, reals = block.ints, block.reals
    head = Header(ints)
    state = Scalars(reals)
    plane = vertical_plane(scene)
    ints[own.OwnHeader.planar] = int(plane.flat and planar is not False)
    ints[own.OwnHeader.joint] = own.PAPER if scene.solver.joint == "paper" else own.MOMENT_FREE
    ints[own.OwnHeader.method] = (
        own.ELIMINATION if scene.solver.linear_solver == "elimination" else own.SUPERPOSITION
    )
    ints[own.OwnHeader.end] = own.END_ANCHOR if scene.end.kind == "anchor" else own.END_FREE
    ints[own.OwnHeader.restart] = 1
    head.piece = 1
    state.plane = plane.direction
    state.water_density = scene.environment.water_density
    state.gravity = scene.environment.gravity
    reals[own.OwnScalars.time_step] = scene.solver.time_step
    reals[own.OwnScalars.spacing] = spacing
    reals[own.OwnScalars.alpha] = scene.solver.alpha
    reals[own.OwnScalars.tolerance] = scene.solver.relative_tolerance
    reals[own.OwnScalars.share] = 1.0
    reals[own.OwnScalars.drift] = DRIFT_ALLOWED * scene.line_length
    _fill_motion(block, motion.pieces)
    if current is not None:
        head.current_kind = 1 if len(current.z) == 1 else 2
        block.array(Header.depths, len(current.z))[:] = current.z
        block.array(Header.times, len(current.t))[:] = current.t
        block.array(Header.current, len(current.t), len(current.z), 3)[:] = current.velocity
    _fill_materials(block, scene)
    _fill_bodies(block, scene, bodies)
    _fill_sections(block, scene, sections)
    _fill_drum(block, scene, sections)
    if floor is not None:
        _fill_floor(block, scene)
    scale = _tension_scale(scene)
    reals[own.OwnScalars.scale : own.OwnScalars.scale.place + own.WIDTH] = 1.0
    speed = float(
        np.max(np.linalg.norm(scene.motion().typical_velocities(), axis=1), initial=STILL_SPEED)
    )
    reals[own.OwnScalars.scale : own.OwnScalars.scale.place + 3] = speed
    reals[own.OwnScalars.scale.place + own.F1 : own.OwnScalars.scale.place + own.F3 + 1] = scale
    reals[own.OwnScalars.lowest] = SLACK_ALLOWED * scale
    status = find_initial_state(block, scene, sections)
    if status != at.OK:
        from cablemodel.solvers.direct.failures import explain

        problem, advice = explain(status)
        raise StaticsError(f"no steady state was found: {problem}; {advice}")
    return block


def _tension_scale(scene: Scene) -> float:
    """A tension [N] that is typical of the line: what hangs on it, and some of its drag."""
    rho, gravity = scene.environment.water_density, scene.environment.gravity
    speed = scene.motion().typical_speed
    scale = sum(abs(body.submerged_weight) for body in scene.bodies)
    for cable in scene.cables:
        kind = scene.cable_types[cable.type]
        weight = kind.typical_weight(gravity)
        drag = DRAG_OF_SCALE * rho * kind.drag_normal * kind.diameter * speed**2
        scale += cable.length * (weight + drag)
    return scale


def _fill_motion(block: DirectBlock, pieces: FloatArray) -> None:
    """The scene's pieces from row 1 on (row 0 is the caller's live motion), and their jumps."""
    from cablemodel.scene.motion import jumps

    table = block.array(Header.pieces, len(pieces) + 1, at.PIECE_WORDS)
    table[1:] = pieces
    table[1, at.Piece.acceleration_jump] = 0.0
    jump = sum(jumps(pieces)[:2])
    table[2:, at.Piece.acceleration_jump] = np.where(jump > NO_JUMP, jump, 0.0)


def _fill_materials(block: DirectBlock, scene: Scene) -> None:
    rho = scene.environment.water_density
    rows = block.array(own.OwnHeader.materials, len(scene.cable_types), own.MATERIAL_WORDS)
    used = int(block.header.strain)
    for row, kind in zip(rows, scene.cable_types.values(), strict=True):
        coefficients = kind.strain_coefficients
        block.reals[used : used + len(coefficients)] = coefficients
        row[own.Material.mass] = kind.mass
        row[own.Material.displaced] = rho * 0.25 * math.pi * kind.diameter**2
        row[own.Material.added_mass] = rho * 0.25 * math.pi * kind.diameter**2 * kind.added_mass
        row[own.Material.weight] = kind.submerged_weight
        row[own.Material.normal] = 0.5 * rho * kind.drag_normal * kind.diameter
        row[own.Material.tangential] = 0.5 * rho * kind.drag_tangential * math.pi * kind.diameter
        row[own.Material.bending] = kind.bending_stiffness
        row[own.Material.terms] = len(coefficients)
        row[own.Material.offset] = used
        row[own.Material.low : own.Material.high.word + 1] = strain_range(coefficients)
        used += len(coefficients)


def _fill_bodies(block: DirectBlock, scene: Scene, bodies: list[tuple[int, Body]]) -> None:
    rho, gravity = scene.environment.water_density, scene.environment.gravity
    rows = block.array(own.OwnHeader.bodies, len(bodies), own.BODY_WORDS)
    for row, (place, body) in zip(rows, bodies, strict=True):
        row[own.RigidBody.mass] = body.mass
        row[own.RigidBody.weight] = body.submerged_weight
        row[own.RigidBody.added_mass] = body.added_mass
        row[own.RigidBody.added_mass_axial] = body.added_mass_axial
        row[own.RigidBody.drag] = 0.5 * rho * body.drag_coefficient * body.drag_area
        row[own.RigidBody.drag_axial] = (
            0.5 * rho * body.drag_coefficient_axial * body.drag_area_axial
        )
        row[own.RigidBody.half] = body.half_length
        row[own.RigidBody.offset] = body.centre_offset
        row[own.RigidBody.inertia] = body.rotary_inertia
        row[own.RigidBody.buoyancy] = body.mass * gravity - body.submerged_weight
        row[own.RigidBody.item] = place


def _fill_sections(block: DirectBlock, scene: Scene, sections: list[Section]) -> None:
    table = block.integers(own.OwnHeader.sections, len(sections) + 1, own.SECTION_WORDS)
    types = list(scene.cable_types)
    table[:, own.Section.body] = -1
    table[:, own.Section.point] = -1
    length, share = int(block.ints[own.OwnHeader.length]), int(block.ints[own.OwnHeader.share])
    node = 0
    material = 0
    cables = [section.cable for section in sections]
    for index, (row, section) in enumerate(zip(table, sections, strict=False)):
        if section.cable is not None:
            material = types.index(section.cable.type)
        row[own.Section.first] = node
        row[own.Section.count] = len(section.lengths) + 1
        row[own.Section.kind] = section.kind
        row[own.Section.material] = material
        row[own.Section.body] = section.body
        row[own.Section.point] = section.point
        row[own.Section.hinge] = int(section.hinge)
        row[own.Section.item] = index
        block.reals[length + node + 1 : length + node + len(section.lengths) + 1] = section.lengths
        if section.follows:
            shares = block.reals[share + node : share + node + len(section.lengths) + 1]
            if index > 0 and cables[index - 1] is section.cable:
                # The part before it takes up the change of length in its last interval.
                shares[:] = 1.0
                block.reals[share + node - 1] = 1.0
            else:
                shares[1:] = np.cumsum(section.lengths) / section.length
        node += len(section.lengths) + 1
    block.ints[own.OwnHeader.section_count] = len(sections)
    if scene.line[-1].body is not None and scene.line[-1].body.half_length == 0.0:
        table[len(sections), own.Section.point] = len(scene.bodies) - 1
    for index in range(1, len(sections)):
        if (sections[index].kind == own.CABLE) != (sections[index - 1].kind == own.CABLE):
            block.ints[own.OwnHeader.meeting] = table[index, own.Section.first]


def _fill_drum(block: DirectBlock, scene: Scene, sections: list[Section]) -> None:
    """Rows of the joints in the order in which they pass the tow point; those of the line first."""
    ints = block.ints
    types = list(scene.cable_types)
    rows: list[tuple[int, int, int, int, float, int, int]] = []
    below = scene.line_length
    for index in range(len(sections) - 1, 0, -1):
        section = sections[index]
        below -= section.length
        if section.kind == own.RIGID:
            continue
        above = sections[index - 1]
        rigid = above.body
        joint = above if rigid >= 0 else section
        if rigid >= 0:
            above = sections[index - 2]
        assert above.cable is not None
        material = types.index(above.cable.type)
        rows.append((material, above.kind, joint.point, index, -below, int(joint.hinge), rigid))
    ints[own.OwnHeader.drum_used] = len(rows)
    out = 0.0
    body = len(scene.bodies) - 1
    pending = -1
    half = 0.0
    for index, item in enumerate(scene.payout.drum):
        if item.body is not None:
            body += 1
            pending, half = body, item.body.half_length
            continue
        cable = item.cable
        assert cable is not None
        kind, material = drum_kind(scene, cable), types.index(cable.type)
        top = sections[0]
        assert top.cable is not None
        previous = (
            (rows[-1][0], rows[-1][1])
            if len(rows) > ints[own.OwnHeader.drum_used]
            else (types.index(top.cable.type), top.kind)
        )
        if pending >= 0 or previous != (material, kind):
            point, rigid = (-1, pending) if half > 0.0 else (pending, -1)
            hinge = int(cable.model != "elastica")
            rows.append((material, kind, point, 100 + index, out, hinge, rigid))
        pending, half = -1, 0.0
        out += cable.length
    ints[own.OwnHeader.drum_count] = len(rows)
    table = block.integers(own.OwnHeader.drum, len(rows), own.DRUM_WORDS)
    for row, values in zip(table, rows, strict=True):
        (
            row[own.DrumRow.material],
            row[own.DrumRow.kind],
            row[own.DrumRow.point],
            row[own.DrumRow.item],
        ) = values[:4]
        row[own.DrumRow.hinge], row[own.DrumRow.rigid] = values[5:]
        row.view(np.float64)[own.DrumRow.leaves] = values[4]
    winch = block.winch
    winch.way, winch.rates = 1.0, len(scene.payout.rate)
    winch.paid_most = out
    total = scene.line_length
    winch.paid_least = -(total - SHORTEST_LINE * total)
    for rate_row, point_of_rate in zip(
        block.array(Header.rates, len(scene.payout.rate), at.RATE_WORDS),
        scene.payout.rate,
        strict=True,
    ):
        rate_row[:] = point_of_rate.t, point_of_rate.rate


def _fill_floor(block: DirectBlock, scene: Scene) -> None:
    """The plane n.x = d of the floor, n pointing up, along the paper's axes."""
    floor = scene.environment.floor
    assert floor is not None
    assert floor.z is not None
    reals = block.reals
    state = Scalars(reals)
    normal = np.array([-floor.slope[0], -floor.slope[1], 1.0])
    normal /= np.linalg.norm(normal)
    px, py = state.plane
    reals[own.OwnScalars.floor : own.OwnScalars.floor.place + 3] = (
        -normal[2],
        px * normal[0] + py * normal[1],
        py * normal[0] - px * normal[1],
    )
    reals[own.OwnScalars.floor.place + 3] = normal @ np.array([floor.at[0], floor.at[1], floor.z])
    reals[own.OwnScalars.friction] = floor.friction
    block.ints[own.OwnHeader.floor] = 1
