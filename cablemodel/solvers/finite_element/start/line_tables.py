"""The line in the block's tables: cables, elements, bodies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import sea_floor
from cablemodel.solvers.finite_element.start.line import Line
from cablemodel.solvers.finite_element.start.winch import Winch
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel.solvers.shared.scene_numbers import strain_range

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.common import CableScene
    from cablemodel.scene.line import Body, Cable

FloatArray = NDArray[np.float64]

_MODELS = {"elastica": 0.0, "cable": 1.0, "hybrid": 2.0}


def fill_cables(block: Block, scene: Scene, winch: Winch) -> None:
    """A row for every cable of line and drum, outermost first, with the edge that it is made of."""
    strain = block.array(Header.strain, int(block.header.strain_words))
    used = 0
    table = block.array(Header.cables, len(winch.cables), at.CABLE_WORDS)
    for index, (cable, row) in enumerate(zip(winch.cables, table, strict=True)):
        coefficients = scene.cable_types[cable.type].strain_coefficients
        strain[used : used + len(coefficients)] = coefficients
        offset = int(block.header.strain) + used
        used += len(coefficients)
        row[at.Cable.nominal] = winch.nominal[index]
        row[at.Cable.hinge] = float(winch.hinges[index])
        row[at.Cable.body] = winch.bodies[index]
        diameter = scene.cable_types[cable.type].diameter
        row[at.Cable.displaced] = scene.environment.water_density * 0.25 * math.pi * diameter**2
        row[at.Cable.edge :] = edge_row(scene, cable, index, offset)
        row[at.Cable.edge.word + at.Edge.nominal.word] = winch.nominal[index]
        note_choices(block, row[at.Cable.edge :])
    block.winch.cable = len(scene.cables) - 1
    block.winch.off_drum = 1.0


def note_choices(block: Block, edge: FloatArray) -> None:
    """What elements of this kind, a row of the edge table, choose by their tension as they go."""
    if edge[at.Edge.model] == at.MODEL_HYBRID and edge[at.Edge.bending_full] > 0.0:
        block.header.hybrid = 1


def edge_row(scene: CableScene, cable: Cable, segment: int, strain_offset: int) -> FloatArray:
    """A row of the edge table for elements of a cable, without length, place and stabilisation."""
    rho = scene.environment.water_density
    kind = scene.cable_types[cable.type]
    row = np.zeros(at.EDGE_WORDS)
    added = rho * 0.25 * math.pi * kind.diameter**2 * kind.added_mass
    row[at.Edge.mass] = kind.mass + added
    row[at.Edge.added_mass] = added
    row[at.Edge.weight] = kind.submerged_weight
    row[at.Edge.contact] = sea_floor.contact_weight(kind, scene.environment.gravity)
    row[at.Edge.support] = 1.0
    row[at.Edge.drag_normal] = 0.5 * rho * kind.drag_normal * kind.diameter
    row[at.Edge.drag_tangential] = 0.5 * rho * kind.drag_tangential * math.pi * kind.diameter
    row[at.Edge.compliance] = kind.strain_coefficients[0]
    row[at.Edge.damping] = row[at.Edge.damping_full] = kind.axial_damping
    row[at.Edge.damping_11] = 3.0 * kind.axial_damping  # the mean of P1^2 is a third
    row[at.Edge.strain_terms] = len(kind.strain_coefficients)
    row[at.Edge.strain_offset] = strain_offset
    row[at.Edge.tension_low : at.Edge.tension_high.word + 1] = strain_range(
        kind.strain_coefficients
    )
    row[at.Edge.bending_full] = 0.0 if cable.model == "cable" else kind.bending_stiffness
    row[at.Edge.model] = _MODELS[cable.model]
    row[at.Edge.flexible] = float(row[at.Edge.bending_full] == 0.0)
    if row[at.Edge.bending_full] == 0.0 and scene.environment.floor is not None:
        row[at.Edge.bending_full] = sea_floor.least_bending(scene, kind)
        row[at.Edge.model] = at.MODEL_HYBRID
    row[at.Edge.bending] = row[at.Edge.bending_full]
    row[at.Edge.segment] = segment
    row[at.Edge.type] = list(scene.cable_types).index(cable.type)
    return row


def fill_edges(block: Block, scene: Scene, line: Line) -> None:
    """The tree of nodes, and for each the edge to its parent: its cable's, with its own length."""
    cables = block.array(Header.cables, int(block.header.cable_count), at.CABLE_WORDS)
    block.integers(Header.parent, line.nodes)[:] = line.parent
    block.integers(Header.joint, line.nodes)[:] = line.joint
    edges = block.array(Header.edges, line.nodes, at.EDGE_WORDS)
    outermost = int(block.winch.cable)
    for node in range(1, line.nodes):
        edges[node] = cables[outermost - line.cable[node], at.Cable.edge :]
        edges[node, at.Edge.length] = line.length[node]
        edges[node, at.Edge.start] = line.start[node]
        if scene.environment.floor is None:
            edges[node, at.Edge.nominal] = line.length[node]


def fill_bodies(block: Block, scene: Scene, line: Line) -> None:
    """A row for every body of line and drum."""
    rho = scene.environment.water_density
    table = block.array(Header.bodies, len(line.bodies), at.BODY_WORDS)
    for row, (node, body, place) in zip(table, line.bodies, strict=True):
        fill_body(row, node, body, rho)
        row[at.Body.item] = place
        if body.half_length > 0.0:
            _fill_rigid(row, body, scene)
            block.header.rigid += 1
            row[at.Body.tie] = place == len(scene.line) - 1  # how stiff it is follows


def fill_body(row: FloatArray, node: int, body: Body, rho: float) -> None:
    """What every body has, into its row: at a node, in water of a density [kg/m3]."""
    row[at.Body.node] = node
    row[at.Body.mass] = body.mass
    row[at.Body.weight] = body.submerged_weight
    row[at.Body.added_mass] = body.added_mass
    row[at.Body.added_mass_axial] = body.added_mass_axial
    row[at.Body.drag] = 0.5 * rho * body.drag_coefficient * body.drag_area
    row[at.Body.drag_axial] = 0.5 * rho * body.drag_coefficient_axial * body.drag_area_axial
    row[at.Body.support.span] = 1.0


def _fill_rigid(row: FloatArray, body: Body, scene: Scene) -> None:
    """What a body of finite length has more than a point body."""
    row[at.Body.length] = 2.0 * body.half_length
    row[at.Body.offset] = body.centre_offset
    row[at.Body.inertia] = body.rotary_inertia
    row[at.Body.dry_weight] = body.mass * scene.environment.gravity
