"""What is read off a state: stations along the cable, forces at the ends, energies, extremes."""

import math

from cablemodel.solvers.finite_element.kernels.bodies.rotation import cross
from cablemodel.solvers.finite_element.kernels.bodies.vessel_clamp import add_clamp_moment
from cablemodel.solvers.finite_element.kernels.element.tension_along import tension_range
from cablemodel.solvers.finite_element.kernels.floor.floor_outputs import (
    floor_force,
    touchdown_along,
    touchdown_of_line,
)
from cablemodel.solvers.finite_element.kernels.line.system import residual, set_time
from cablemodel.solvers.finite_element.kernels.mesh.body_passage import overhang
from cablemodel.solvers.shared.access import (
    constraint_of,
    edge_of,
    header,
    new_motion,
    scalars,
    spare_row,
    summary_at,
    vector,
    winch_of,
)
from cablemodel.solvers.shared.compile import kernel, own_numbers, view
from cablemodel.solvers.shared.environment import add_layer_motion
from cablemodel.solvers.shared.layout import (
    BY_SPRING,
    SummaryRows,
)
from cablemodel.solvers.shared.slack import read_slack
from cablemodel.solvers.shared.summary import clear_floor

ROW_ELEMENTS = SummaryRows.elements.word

node_forces = own_numbers(6)
"""node_forces(): zeros, the force at a node and what is conjugate to its slope."""


@kernel
def to_earth(I, M, local, out):
    """A vector in the block's coordinates into the earth frame."""
    state = scalars(M)
    if header(I).dimension == 3:
        out[0] = local[0]
        out[1] = local[1]
        out[2] = local[2]
    else:
        out[0] = state.plane[0] * local[0]
        out[1] = state.plane[1] * local[0]
        out[2] = local[1]


@kernel
def place_on_earth(I, M, local, out):
    """A place in the block's coordinates into the earth frame."""
    to_earth(I, M, local, out)
    for i in range(3):
        out[i] += scalars(M).origin[i]


@kernel
def way_from_tow_point(I, M, way, rate):
    """Where the elements begin, from the tow point, and its rate, earth frame.

    0 but for a clamp past which cable runs (`clamp_layer.py`).
    """
    for i in range(3):
        way[i] = 0.0
        rate[i] = 0.0
    if constraint_of(I, M, 0).clamped == BY_SPRING:
        layer = new_motion()
        add_layer_motion(I, M, scalars(M).time, layer)
        to_earth(I, M, layer.position, way)
        to_earth(I, M, layer.velocity, rate)


@kernel
def end_forces(I, M):
    """Residual of the present state into the workspace: the supports' forces at their nodes."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    set_time(I, M, state.time)
    residual(
        I,
        M,
        M[head.position : head.position + count],
        M[head.velocity : head.velocity + count],
        M[head.acceleration : head.acceleration + count],
        M[head.tension : head.tension + 2 * head.nodes],
        M[head.residual : head.residual + count],
        M[head.constraint_residual : head.constraint_residual + 2 * head.nodes],
    )


@kernel
def support_force(I, M, node, force, moment):
    """Force and moment, earth frame, that the support exerts on the cable at a node.

    `end_forces` has been called. The moment is r' x (force conjugate to r').
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    at = head.residual + size * node
    to_earth(I, M, view(M, at, dimension), force)
    slope = vector()
    to_earth(I, M, view(M, head.position + size * node + dimension, dimension), slope)
    turning = vector()  # conjugate to the slope
    if node == 0 and head.payout != 0:
        # A spring's moment is no reaction: it is among the forces that the residual balances.
        forces = node_forces()
        add_clamp_moment(I, M, view(M, head.position, size), forces)
        for i in range(dimension):
            forces[dimension + i] = M[at + dimension + i] - forces[dimension + i]
        to_earth(I, M, view(forces, dimension, dimension), turning)
    else:
        to_earth(I, M, view(M, at + dimension, dimension), turning)
    cross(slope, turning, moment)
    if node == 0:
        # The force acts where the elements begin, beside the tow point.
        way = vector()
        way_from_tow_point(I, M, way, vector())
        of_force = vector()
        cross(way, force, of_force)
        for i in range(3):
            moment[i] += of_force[i]


@kernel
def reaction_along(I, M, node, sign):
    """Component along the tangent of the support's force at an end node: the tension there [N]."""
    head = header(I)
    dimension = head.dimension
    at = 2 * dimension * node
    q = head.position + at + dimension
    f = head.residual + at
    norm = 0.0
    along = 0.0
    for i in range(dimension):
        norm += M[q + i] * M[q + i]
        along += M[q + i] * M[f + i]
    return sign * along / math.sqrt(norm)


@kernel
def line_length(I, M):
    """Unstretched length of the cable that is out [m]."""
    head = header(I)
    last = head.nodes - 1
    edge = edge_of(I, M, last)
    if last == 1:
        return edge.length - overhang(I, M)
    return edge.start + edge.length + winch_of(I, M, 0).paid


@kernel
def read_floor(I, M, elements, found):
    """What a Summary says of the floor, of the line with these elements from its beginning on,
    whose order changes."""
    force = vector()
    touchdown = vector()
    floor_force(I, M, elements, force)
    if header(I).parts == 0:
        lying, reaction = touchdown_along(I, M, elements, False, touchdown)
    else:
        lying, reaction = touchdown_of_line(I, M, elements, touchdown)
    found.floor_length, found.touchdown_reaction = lying, reaction
    to_earth(I, M, force, found.floor_force)
    place_on_earth(I, M, touchdown, found.touchdown_position)


@kernel
def summarise(I, M, out):
    """Numbers of the present state that logs and co-simulation ask for at every step: a Summary."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    nodes = head.nodes
    found = summary_at(out, 0)
    wrench = found.wrench
    end_forces(I, M)
    support_force(I, M, 0, view(wrench, 0, 3), view(wrench, 3, 3))
    for i in range(6):
        wrench[i] = -wrench[i]
    top = reaction_along(I, M, 0, -1.0)
    found.top_tension = math.copysign(
        math.sqrt(wrench[0] ** 2 + wrench[1] ** 2 + wrench[2] ** 2), top
    )
    lowest = 1e300  # of tension alone: the force at the top has the shear, too, with that sign
    highest = found.top_tension
    for node in range(1, nodes):
        if I[head.joint + node] == 0:
            low, high = tension_range(I, M, node)
            lowest = min(lowest, low)
            highest = max(highest, high)
    found.tension_min = lowest
    found.tension_max = highest
    last = size * (nodes - 1)
    place_on_earth(I, M, view(M, head.position + last, size), found.tip_position)
    to_earth(I, M, view(M, head.velocity + last, size), found.tip_velocity)
    place_on_earth(I, M, view(M, head.position, size), found.vessel_position)
    to_earth(I, M, view(M, head.velocity, size), found.vessel_velocity)
    way = vector()
    rate = vector()
    way_from_tow_point(I, M, way, rate)
    for i in range(3):
        found.vessel_position[i] -= way[i]
        found.vessel_velocity[i] -= rate[i]
    found.line_length = line_length(I, M)
    winch = winch_of(I, M, 0)
    found.payout_rate = winch.stage_rate if head.payout != 0 else 0.0
    found.drum_length = winch.paid_most - winch.paid
    clear_floor(found, 0.0)
    if head.floor_kind != 0:
        elements = view(M, spare_row(I, ROW_ELEMENTS), nodes)
        count = 0
        for node in range(1, nodes):
            if I[head.joint + node] == 0:
                elements[count] = node
                count += 1
        read_floor(I, M, view(elements, 0, count), found)
    read_slack(I, M, found)
