"""The line in the block's tables: cables, elements, bodies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel import sea_floor
from cablemodel.block import Block
from cablemodel.instance.line import Line
from cablemodel.instance.winch import Winch
from cablemodel.kernels import layout as at

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.common import CableScene
    from cablemodel.scene.line import Body, Cable

FloatArray = NDArray[np.float64]

STABILISATION = 3.0
"""Stiffness of the stabilised tangential mode, in units of a typical tension."""
RIGID = 1e7
"""Least axial stiffness of a body of finite length, in units of a typical tension."""
SOFTEST = 3e-5
"""Its largest axial compliance, in units of that of the line."""
_MODELS = {"elastica": 0.0, "cable": 1.0, "hybrid": 2.0}


def fill_cables(block: Block, scene: Scene, winch: Winch, scale: float) -> None:
    """A row for every cable of line and drum, outermost first, with the edge that it is made of."""
    strain = block.array(at.O_STRAIN, int(block.ints[at.I_STRAIN]))
    used = 0
    table = block.array(at.O_CABLES, len(winch.cables), at.CABLE_WORDS)
    for index, (cable, row) in enumerate(zip(winch.cables, table, strict=True)):
        coefficients = scene.cable_types[cable.type].strain_coefficients
        strain[used : used + len(coefficients)] = coefficients
        offset = int(block.ints[at.O_STRAIN]) + used
        used += len(coefficients)
        row[at.K_LEAVES] = winch.leaves[index]
        row[at.K_NOMINAL] = winch.nominal[index]
        row[at.K_SHORTEST] = winch.shortest[index]
        row[at.K_HINGE] = float(winch.hinges[index])
        row[at.K_BODY] = winch.bodies[index]
        diameter = scene.cable_types[cable.type].diameter
        row[at.K_DISPLACED] = scene.environment.water_density * 0.25 * math.pi * diameter**2
        row[at.K_EDGE :] = edge_row(scene, cable, index, offset, scale)
        row[at.K_EDGE + at.E_NOMINAL] = winch.nominal[index]
        edge = row[at.K_EDGE :]
        if edge[at.E_MODEL] == at.MODEL_HYBRID and edge[at.E_BENDING_FULL] > 0.0:
            block.ints[at.I_HYBRID] = 1
    block.ints[at.I_TOP_CABLE] = len(scene.cables) - 1


def edge_row(
    scene: CableScene, cable: Cable, segment: int, strain_offset: int, scale: float
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
    row[at.E_BORNE] = 1.0
    row[at.E_DRAG_NORMAL] = 0.5 * rho * kind.drag_normal * kind.diameter
    row[at.E_DRAG_TANGENTIAL] = 0.5 * rho * kind.drag_tangential * math.pi * kind.diameter
    row[at.E_COMPLIANCE] = kind.strain_coefficients[0]
    row[at.E_STRAIN_TERMS] = len(kind.strain_coefficients)
    row[at.E_STRAIN_OFFSET] = strain_offset
    row[at.E_TENSION_LOW : at.E_TENSION_HIGH + 1] = strain_range(kind.strain_coefficients)
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


def strain_range(coefficients: tuple[float, ...]) -> tuple[float, float]:
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


def fill_edges(block: Block, scene: Scene, line: Line) -> None:
    """The tree of nodes, and for each the edge to its parent: its cable's, with its own length."""
    cables = block.array(at.O_CABLES, int(block.ints[at.I_CABLES]), at.CABLE_WORDS)
    block.integers(at.O_PARENT, line.nodes)[:] = line.parent
    block.integers(at.O_JOINT, line.nodes)[:] = line.joint
    edges = block.array(at.O_EDGE, line.nodes, at.EDGE_WORDS)
    outermost = int(block.ints[at.I_TOP_CABLE])
    for node in range(1, line.nodes):
        edges[node] = cables[outermost - line.cable[node], at.K_EDGE :]
        edges[node, at.E_LENGTH] = line.length[node]
        edges[node, at.E_START] = line.start[node]
        if scene.environment.floor is None:
            edges[node, at.E_NOMINAL] = line.length[node]
    block.reals[at.S_TOP_LENGTH] = line.length[1]


def fill_bodies(block: Block, scene: Scene, line: Line, scale: float) -> None:
    """A row for every body of line and drum. scale: a typical tension [N]."""
    rho = scene.environment.water_density
    table = block.array(at.O_BODY, len(line.bodies), at.BODY_WORDS)
    for row, (node, body, place) in zip(table, line.bodies, strict=True):
        fill_body(row, node, body, rho)
        row[at.B_ITEM] = place
        if body.half_length > 0.0:
            _fill_rigid(row, body, scene, scale)
            block.ints[at.I_RIGID] += 1
            if place == len(scene.line) - 1:
                row[at.B_TIE] = scale * row[at.B_LENGTH]


def fill_body(row: FloatArray, node: int, body: Body, rho: float) -> None:
    """What every body has, into its row: at a node, in water of a density [kg/m3]."""
    row[at.B_NODE] = node
    row[at.B_MASS] = body.mass
    row[at.B_WEIGHT] = body.submerged_weight
    row[at.B_ADDED] = body.added_mass
    row[at.B_ADDED_AXIAL] = body.added_mass_axial
    row[at.B_DRAG] = 0.5 * rho * body.drag_coefficient * body.drag_area
    row[at.B_DRAG_AXIAL] = 0.5 * rho * body.drag_coefficient_axial * body.drag_area_axial
    row[at.B_BORNE : at.B_BORNE + 2] = 1.0


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
