"""Cable that runs along its own shape at rest: what a steady pay-out adds to a static start.

In the vessel's frame the shape stands still and each piece of cable moves along it with V r'
(Sun & Leonard 1998, eq. 16, with d/dt = 0 at fixed s), V the pay-out rate. Against cable that
stands still that changes

- the drag along the cable, whose flow is u_t - V |r'|; that across the cable stays;
- inertia: (m + ma) (2 V dv/ds + V^2 r''), the first while a shape comes to rest: without it a line
  whose tension is less than (m + ma) V^2 would swing up on the way. By parts the second takes
  (m + ma) V^2 from the tension that straightens the cable, and leaves the momentum that passes
  each end of an element;
- the drag of bodies, which run with their cable;
- what has been laid (`laid`): it is at rest over the ground, and
  only a current pulls at it. On a slope its drag with the vessel's velocity would be more than its
  weight. From running to rest all of that changes gradually with the gap: switched at one of them,
  it lifted what was let go and pressed down what ran, to and fro without an end.

All of it is computed from r' at the Gauss points, and so are its derivatives, exactly: with
velocities interpolated between nodes the flow had a part across the cable wherever an iterate
bends, and Newton's method did not converge at shallow lay angles.
"""

import math

from cablemodel.solvers.finite_element.kernels.bodies.point_bodies import (
    add_waves,
    body_in_water,
    body_kinematics,
    body_residual,
    flow_derivatives,
    wet_derivatives,
)
from cablemodel.solvers.finite_element.kernels.bodies.rigid import rigid_residual
from cablemodel.solvers.finite_element.kernels.element.tables import (
    D0,
    D1,
    D2,
    D3,
    H0,
    H1,
    H2,
    H3,
    WD,
    WH,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_forces import block_of
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at
from cablemodel.solvers.finite_element.kernels.water.waves import element_water
from cablemodel.solvers.shared.access import (
    body_of,
    edge_of,
    element_points,
    header,
    scalars,
    vector,
)
from cablemodel.solvers.shared.compile import kernel, own_numbers, own_record, view
from cablemodel.solvers.shared.environment import current_at
from cablemodel.solvers.shared.numbers import NO_SIZE
from cablemodel.solvers.shared.record import Record, reals


class CableInFlow(Record):
    """A Gauss point of the resting shape, in the block's coordinates (dimension of three)."""

    tangent = reals(3, "unit vector")
    flow = reals(3, "velocity of the water past it", "m/s")
    force = reals(3, "drag, or what inertia adds", "N/m")
    by_slope = reals(9, "derivative of the drag by r', (dimension, dimension) by rows", "N/m")
    by_flow = reals(9, "the same by the flow", "N s/m2")


cable_in_flow = own_record(CableInFlow)
element_vector = own_numbers(12)
"""element_vector(): zeros, `dimension` for each shape function of an element."""


@kernel
def slope_function(k, g, h):
    """Derivative of shape function k (of r0, d0, r1, d1) at Gauss point g, along the cable."""
    if k == 0:
        return D0[g] / h
    if k == 1:
        return D1[g]
    if k == 2:
        return D2[g] / h
    return D3[g]


@kernel
def value_function(k, g, h):
    """Shape function k at Gauss point g."""
    if k == 0:
        return H0[g]
    if k == 1:
        return h * H1[g]
    if k == 2:
        return H2[g]
    return h * H3[g]


@kernel
def at_point(I, M, flow, q, v, parent, node, h, g, point):
    """Tangent, and flow past the resting shape, at Gauss point g. Returns the stretch, and the
    water's speed along the cable, without and with the flow [m/s].
    """
    head = header(I)
    tangent = point.tangent
    dimension = head.dimension
    size = 2 * dimension
    height = 0.0
    square = 0.0
    for i in range(dimension):
        slope = 0.0
        place = 0.0
        for k in range(4):
            at = size * (parent if k < 2 else node) + dimension * (k % 2) + i
            slope += slope_function(k, g, h) * q[at]
            place += value_function(k, g, h) * q[at]
        tangent[i] = slope
        square += slope * slope
        height = place
    stretch = math.sqrt(square)
    current_at(I, M, height, point.flow)
    along = 0.0
    for i in range(dimension):
        tangent[i] /= stretch
        speed = 0.0
        for k in range(4):
            at = size * (parent if k < 2 else node) + dimension * (k % 2) + i
            speed += value_function(k, g, h) * v[at]
        point.flow[i] -= speed
        along += point.flow[i] * tangent[i]
    return stretch, along, along - flow * stretch


@kernel
def laid_share(I, M, q, node, normal):
    """Share of the cable at a node that has been laid, at rest over the ground; its change [1/m].

    With the gap, along the floor's normal, which is written (dimension words): all of it rests
    where there is none, and none at the gap that `laid` says.
    """
    head = header(I)
    state = scalars(M)
    if state.laid == 0.0 or head.floor_kind == 0:
        return 0.0, 0.0
    dimension = head.dimension
    gap = gap_at(I, M, view(q, 2 * dimension * node, 2 * dimension), normal)
    width = state.laid * state.floor_depth
    x = gap / width
    if x <= 0.0:
        return 1.0, 0.0
    if x >= 1.0:
        return 0.0, 0.0
    return (1.0 - x) * (1.0 - x) * (1.0 + 2.0 * x), -6.0 * x * (1.0 - x) / width


@kernel
def drag_at(edge, stretch, dimension, point):
    """Drag per length on cable with this tangent in this flow, and its derivatives."""
    tangent = point.tangent
    flow = point.flow
    cn = math.sqrt(stretch) * edge.drag_normal
    ct = math.sqrt(stretch) * edge.drag_tangential
    along = 0.0
    for i in range(dimension):
        along += flow[i] * tangent[i]
    speed = 0.0
    for i in range(dimension):
        speed += (flow[i] - along * tangent[i]) ** 2
    speed = math.sqrt(speed)
    inverse = 1.0 / max(speed, NO_SIZE)
    for i in range(dimension):
        across = flow[i] - along * tangent[i]
        point.force[i] = cn * speed * across + ct * abs(along) * along * tangent[i]
    for i in range(dimension):
        ni = flow[i] - along * tangent[i]
        for j in range(dimension):
            nj = flow[j] - along * tangent[j]
            p = -tangent[i] * tangent[j]
            if i == j:
                p += 1.0
            turned = cn * (-along * inverse * nj * ni - speed * (tangent[i] * nj + along * p))
            turned += ct * (2.0 * abs(along) * nj * tangent[i] + abs(along) * along * p)
            at = dimension * i + j
            point.by_slope[at] = (turned + 0.5 * point.force[i] * tangent[j]) / stretch
            point.by_flow[at] = cn * (speed * p + inverse * ni * nj)
            point.by_flow[at] += 2.0 * ct * abs(along) * tangent[i] * tangent[j]


@kernel
def element_forces(I, M, flow, frame, q, v, node, lies, f):
    """What the flow adds to the forces of an element, running or laid, into f (4 dimension words).

    By shape functions, in their order.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    points = element_points(I, M, 0)
    point = cable_in_flow()
    parent = I[head.parent + node]
    e = edge_of(I, M, node)
    h = e.length
    f[: 2 * size] = 0.0
    if lies and head.drag == 0:
        return
    momentum = e.mass * flow * flow
    for g in range(3):
        stretch, still, runs = at_point(I, M, flow, q, v, parent, node, h, g, point)
        if lies:
            for side in range(2):  # without the frame's velocity, less with it
                for i in range(dimension):
                    point.flow[i] += frame[i] if side == 0 else -frame[i]
                drag_at(e, stretch, dimension, point)
                for k in range(4):
                    value = (2.0 * side - 1.0) * h * WH[g, k] * (h if k % 2 == 1 else 1.0)
                    for i in range(dimension):
                        f[dimension * k + i] += value * point.force[i]
            continue
        drag = 0.0
        if head.drag != 0:
            drag = math.sqrt(stretch) * e.drag_tangential
            drag *= abs(runs) * runs - abs(still) * still
            if head.wave_count != 0:
                drag *= points.drag[g]
        for i in range(dimension):
            point.force[i] = 0.0
            for l in range(4):
                at = size * (parent if l < 2 else node) + dimension * (l % 2) + i
                point.force[i] += 2.0 * e.mass * flow * slope_function(l, g, h) * v[at]
        for k in range(4):
            scale = h if k % 2 == 1 else 1.0
            value = scale * (h * WH[g, k] * drag + WD[g, k] * momentum * stretch)
            load = scale * h * WH[g, k]
            for i in range(dimension):
                f[dimension * k + i] += load * point.force[i] - value * point.tangent[i]
    if lies:
        return
    for i in range(dimension):
        f[i] -= momentum * q[size * parent + dimension + i]
        f[size + i] += momentum * q[size * node + dimension + i]


@kernel
def flow_residual(I, M, flow, frame, q, v, a, tension, out, out_constraint):
    """Add what the flow changes to forces that were found without it.

    Of what has been laid only the drag changes.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    points = element_points(I, M, 0)
    normal = vector()
    f = element_vector()
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        parent = I[head.parent + node]
        share, _change = laid_share(I, M, q, parent, normal)
        share *= laid_share(I, M, q, node, normal)[0]
        if head.wave_count != 0:
            e = edge_of(I, M, node)
            element_water(I, M, points, e, view(q, size * parent, size), view(q, size * node, size))
        for lies in range(2):
            part = share if lies == 1 else 1.0 - share
            if part == 0.0:
                continue
            element_forces(I, M, flow, frame, q, v, node, lies == 1, f)
            for k in range(4):
                at = size * (parent if k < 2 else node) + dimension * (k % 2)
                for i in range(dimension):
                    out[at + i] += part * f[dimension * k + i]
    if head.body_count == 0:
        return
    # Forces of the bodies with the flow in place of those without it.
    count = size * head.nodes
    for n in range(count):
        out[n] = -out[n]
    body_residual(I, M, q, v, a, out)
    if head.rigid > 0:
        rigid_residual(I, M, q, v, a, tension, out, out_constraint)
    for n in range(count):
        out[n] = -out[n]
    run_with_cable(I, M, flow, frame, 1.0, q, v)
    body_residual(I, M, q, v, a, out)
    if head.rigid > 0:
        rigid_residual(I, M, q, v, a, tension, out, out_constraint)
    run_with_cable(I, M, flow, frame, -1.0, q, v)


@kernel
def run_with_cable(I, M, flow, frame, sign, q, v):
    """Add the flow to the velocities of the nodes of bodies (or take it off, sign -1).

    Of bodies that have been laid, minus the frame's velocity.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    normal = vector()
    for body in range(head.body_count):
        row = body_of(I, M, body)
        node = int(row.node)
        if node < 0:
            continue
        for _side in range(2 if row.length > 0.0 else 1):
            share, _change = laid_share(I, M, q, node, normal)
            for i in range(dimension):
                own = (1.0 - share) * flow * q[size * node + dimension + i] - share * frame[i]
                v[size * node + i] += sign * own
            node = I[head.parent + node]


@kernel
def flow_jacobian(I, M, flow, frame, q, v, a, ca, cv):
    """Add the derivatives of `flow_residual` to the blocks of the effective Jacobian.

    Of a body of finite length they are left out: its drag is little beside what holds it. So is how
    the share of a body that rests changes.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    points = element_points(I, M, 0)
    above = vector()
    below = vector()
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        parent = I[head.parent + node]
        upper, upper_change = laid_share(I, M, q, parent, above)
        lower, lower_change = laid_share(I, M, q, node, below)
        share = upper * lower
        if head.wave_count != 0:
            e = edge_of(I, M, node)
            element_water(I, M, points, e, view(q, size * parent, size), view(q, size * node, size))
        if share < 1.0:
            add_running(I, M, flow, q, v, node, 1.0 - share, cv)
        if share > 0.0 and head.drag != 0:
            add_laid(I, M, flow, frame, q, v, node, share, cv)
        changes = (upper_change * lower, lower_change * upper)
        if changes[0] != 0.0 or changes[1] != 0.0:
            add_landing(I, M, flow, frame, q, v, node, changes, above, below)
    for side in range(2 if head.body_count > 0 else 0):
        sign = 2.0 * side - 1.0
        for body in range(head.body_count):
            row = body_of(I, M, body)
            node = int(row.node)
            if node >= 0 and row.length == 0.0:
                share, _change = laid_share(I, M, q, node, below)
                add_body(I, M, (1.0 - share) * flow, q, v, a, ca, cv, row, node, sign)
        run_with_cable(I, M, flow, frame, 1.0 if side == 0 else -1.0, q, v)


@kernel
def add_running(I, M, flow, q, v, node, part, cv):
    """Add `part` of the derivatives of `element_forces` of cable that runs."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    points = element_points(I, M, 0)
    point = cable_in_flow()
    tangent = point.tangent
    parent = I[head.parent + node]
    e = edge_of(I, M, node)
    h = e.length
    momentum = part * e.mass * flow * flow
    for g in range(3):
        stretch, still, runs = at_point(I, M, flow, q, v, parent, node, h, g, point)
        coefficient = 0.0
        if head.drag != 0:
            coefficient = part * math.sqrt(stretch) * e.drag_tangential
            if head.wave_count != 0:
                coefficient *= points.drag[g]
        drag = coefficient * (abs(runs) * runs - abs(still) * still)
        turned = 2.0 * coefficient * (abs(runs) - abs(still))
        slides = -2.0 * coefficient * abs(runs) * flow + 0.5 * drag / stretch
        for k in range(4):
            scale = h if k % 2 == 1 else 1.0
            load = scale * h * WH[g, k]
            bend = scale * WD[g, k] * momentum
            turning = load * 2.0 * part * e.mass * flow * cv
            for l in range(4):
                slope = slope_function(l, g, h)
                value = value_function(l, g, h)
                at = block_of(I, node, k, l, dimension)
                at += 2 * dimension * dimension * (k % 2) + dimension * (l % 2)
                for i in range(dimension):
                    for j in range(dimension):
                        across = point.flow[j] - still * tangent[j]
                        rate = turned * across / stretch + (slides - drag / stretch) * tangent[j]
                        entry = -load * (
                            rate * tangent[i] * slope
                            - cv * turned * tangent[i] * tangent[j] * value
                        )
                        if i == j:
                            entry += (turning - load * drag / stretch - bend) * slope
                        M[at + size * i + j] += entry
    area = size * size
    for i in range(dimension):
        at = size * i + dimension + i
        M[head.diagonal + area * parent + at] -= momentum
        M[head.diagonal + area * node + at] += momentum


@kernel
def add_laid(I, M, flow, frame, q, v, node, part, cv):
    """Add `part` of the derivatives of `element_forces` of cable that has been laid."""
    head = header(I)
    dimension = head.dimension
    point = cable_in_flow()
    parent = I[head.parent + node]
    e = edge_of(I, M, node)
    h = e.length
    for g in range(3):
        stretch, _still, _runs = at_point(I, M, flow, q, v, parent, node, h, g, point)
        for side in range(2):
            for i in range(dimension):
                point.flow[i] += frame[i] if side == 0 else -frame[i]
            drag_at(e, stretch, dimension, point)
            add_drag(I, M, node, h, g, (2.0 * side - 1.0) * part * h, cv, point)


@kernel
def add_landing(I, M, flow, frame, q, v, node, changes, above, below):
    """Add what an element's forces change by as it comes to rest.

    changes: of its share that rests, with the gaps of both ends [1/m]; above, below: the floor's
    normals there.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    f = element_vector()
    for lies in range(2):
        sign = 2.0 * lies - 1.0
        element_forces(I, M, flow, frame, q, v, node, lies == 1, f)
        for k in range(4):
            for end in range(2):
                change = sign * (changes[0] if end == 0 else changes[1])
                normal = above if end == 0 else below
                at = block_of(I, node, k, 2 * end, dimension)
                at += 2 * dimension * dimension * (k % 2)
                for i in range(dimension):
                    for j in range(dimension):
                        M[at + size * i + j] += change * f[dimension * k + i] * normal[j]


@kernel
def add_drag(I, M, node, h, g, sign, cv, point):
    """Add `sign` times the derivatives of `drag_at` at a Gauss point to an element's blocks."""
    head = header(I)
    dimension = head.dimension
    for k in range(4):
        load = sign * WH[g, k] * (h if k % 2 == 1 else 1.0)
        for l in range(4):
            slope = load * slope_function(l, g, h)
            value = load * cv * value_function(l, g, h)
            at = block_of(I, node, k, l, dimension)
            at += 2 * dimension * dimension * (k % 2) + dimension * (l % 2)
            for i in range(dimension):
                for j in range(dimension):
                    n = dimension * i + j
                    entry = slope * point.by_slope[n] - value * point.by_flow[n]
                    M[at + 2 * dimension * i + j] += entry


@kernel
def add_body(I, M, flow, q, v, a, ca, cv, row, node, sign):
    """Add a point body's derivatives with the flow (sign 1), or take those without it (-1)."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    body = body_in_water()
    at = size * node
    D = head.diagonal + size * at
    for part in range(2):
        # The second time what the velocity adds that turns with the slope.
        if part == 1 and sign < 0.0:
            break
        rate = cv if part == 0 else flow
        second = ca if part == 0 else 0.0
        ig = body_kinematics(I, M, node, q, v, a, body)
        if head.wave_count != 0:
            add_waves(I, M, row, q[at], q[at + 1], q[at + dimension - 1], 0.0, body)
            wet_derivatives(I, M, row, ig, second, rate, body)
        else:
            mass = row.mass + row.added_mass
            flow_derivatives(row, dimension, mass, ig, second, rate, body)
        for i in range(dimension):
            for j in range(dimension):
                motion = sign * body.by_motion[dimension * i + j]
                if part == 0:
                    M[D + size * i + j] += motion
                    M[D + size * i + dimension + j] += sign * body.by_axis[dimension * i + j]
                else:
                    M[D + size * i + dimension + j] += motion
