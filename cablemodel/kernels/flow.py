"""Cable that runs along its own shape at rest: what a steady pay-out adds to a static start.

In the vessel's frame the shape stands still and each piece of cable moves along it with V r'
(Sun & Leonard 1998, eq. 16, with d/dt = 0 at fixed s), V the pay-out rate. Against cable that
stands still that changes

- the drag along the cable, whose flow is u_t - V |r'|; that across the cable stays;
- inertia: (m + ma) V^2 r''. By parts it takes (m + ma) V^2 from the tension that straightens the
  cable, and leaves the momentum that passes each end of an element;
- the drag of bodies, which run with their cable.

All of it is computed from r' at the Gauss points, and so are its derivatives, exactly: with
velocities interpolated between nodes the flow had a part across the cable wherever an iterate
bends, and Newton's method did not converge at shallow lay angles.
"""

import math

from .bodies import (
    add_waves,
    body_kinematics,
    body_residual,
    flow_derivatives,
    wet_derivatives,
)
from .compile import kernel, view
from .environment import current_at
from .floor import block_of
from .layout import (
    B_ADDED,
    B_LENGTH,
    B_MASS,
    B_NODE,
    BODY_WORDS,
    E_DRAG_TANGENTIAL,
    E_LENGTH,
    E_MASS,
    EDGE_WORDS,
    GAUSS_WORDS,
    I_BODIES,
    I_DIMENSION,
    I_DRAG,
    I_NODES,
    I_RIGID,
    I_WAVES,
    O_BODY,
    O_DIAGONAL,
    O_EDGE,
    O_GAUSS,
    O_JOINT,
    O_MOTION,
    O_PARENT,
)
from .rigid import rigid_residual
from .tables import D0, D1, D2, D3, H0, H1, H2, H3, WD, WH
from .waves import DRAG, element_water

SCRATCH = 700  # first word of ours in the elements' workspace, beyond theirs


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
def at_point(I, M, flow, q, v, parent, node, h, g, w):
    """Tangent into w[0:3], water past the resting shape into w[3:6]; the stretch.

    And the water's speed along the cable, without and with the flow [m/s].
    """
    dimension = I[I_DIMENSION]
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
        w[i] = slope
        square += slope * slope
        height = place
    stretch = math.sqrt(square)
    current_at(I, M, height, view(w, 3, 3))
    along = 0.0
    for i in range(dimension):
        w[i] /= stretch
        speed = 0.0
        for k in range(4):
            at = size * (parent if k < 2 else node) + dimension * (k % 2) + i
            speed += value_function(k, g, h) * v[at]
        w[3 + i] -= speed
        along += w[3 + i] * w[i]
    return stretch, along, along - flow * stretch


@kernel
def flow_residual(I, M, flow, q, v, a, tension, out, out_constraint):
    """Add what the flow changes to forces that were found without it."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    W = view(M, I[O_GAUSS], GAUSS_WORDS)
    w = view(W, SCRATCH, 24)
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] != 0:
            continue
        parent = I[I[O_PARENT] + node]
        e = I[O_EDGE] + node * EDGE_WORDS
        h = M[e + E_LENGTH]
        momentum = M[e + E_MASS] * flow * flow
        if I[I_WAVES] != 0:
            element_water(I, M, W, e, view(q, size * parent, size), view(q, size * node, size))
        for g in range(3):
            stretch, still, runs = at_point(I, M, flow, q, v, parent, node, h, g, w)
            drag = 0.0
            if I[I_DRAG] != 0:
                drag = math.sqrt(stretch) * M[e + E_DRAG_TANGENTIAL]
                drag *= abs(runs) * runs - abs(still) * still
                if I[I_WAVES] != 0:
                    drag *= W[DRAG + g]
            for k in range(4):
                at = size * (parent if k < 2 else node) + dimension * (k % 2)
                scale = h if k % 2 == 1 else 1.0
                value = scale * (h * WH[g, k] * drag + WD[g, k] * momentum * stretch)
                for i in range(dimension):
                    out[at + i] -= value * w[i]
        for i in range(dimension):
            out[size * parent + i] -= momentum * q[size * parent + dimension + i]
            out[size * node + i] += momentum * q[size * node + dimension + i]
    if I[I_BODIES] == 0:
        return
    # Forces of the bodies with the flow in place of those without it.
    count = size * I[I_NODES]
    for n in range(count):
        out[n] = -out[n]
    body_residual(I, M, q, v, a, out)
    if I[I_RIGID] > 0:
        rigid_residual(I, M, q, v, a, tension, out, out_constraint)
    for n in range(count):
        out[n] = -out[n]
    run_with_cable(I, M, flow, q, v)
    body_residual(I, M, q, v, a, out)
    if I[I_RIGID] > 0:
        rigid_residual(I, M, q, v, a, tension, out, out_constraint)
    run_with_cable(I, M, -flow, q, v)


@kernel
def run_with_cable(I, M, flow, q, v):
    """Add the flow to the velocities of the nodes of bodies."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    for body in range(I[I_BODIES]):
        row = I[O_BODY] + body * BODY_WORDS
        node = int(M[row + B_NODE])
        if node < 0:
            continue
        for _side in range(2 if M[row + B_LENGTH] > 0.0 else 1):
            for i in range(dimension):
                v[size * node + i] += flow * q[size * node + dimension + i]
            node = I[I[O_PARENT] + node]


@kernel
def flow_jacobian(I, M, flow, q, v, a, ca, cv):
    """Add the derivatives of `flow_residual` to the blocks of the effective Jacobian.

    Of a body of finite length they are left out: its drag is little beside what holds it.
    """
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    W = view(M, I[O_GAUSS], GAUSS_WORDS)
    w = view(W, SCRATCH, 24)
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] != 0:
            continue
        parent = I[I[O_PARENT] + node]
        e = I[O_EDGE] + node * EDGE_WORDS
        h = M[e + E_LENGTH]
        momentum = M[e + E_MASS] * flow * flow
        if I[I_WAVES] != 0:
            element_water(I, M, W, e, view(q, size * parent, size), view(q, size * node, size))
        for g in range(3):
            stretch, still, runs = at_point(I, M, flow, q, v, parent, node, h, g, w)
            coefficient = 0.0
            if I[I_DRAG] != 0:
                coefficient = math.sqrt(stretch) * M[e + E_DRAG_TANGENTIAL]
                if I[I_WAVES] != 0:
                    coefficient *= W[DRAG + g]
            drag = coefficient * (abs(runs) * runs - abs(still) * still)
            turned = 2.0 * coefficient * (abs(runs) - abs(still))
            slides = -2.0 * coefficient * abs(runs) * flow + 0.5 * drag / stretch
            for k in range(4):
                scale = h if k % 2 == 1 else 1.0
                load = scale * h * WH[g, k]
                bend = scale * WD[g, k] * momentum
                for l in range(4):
                    slope = slope_function(l, g, h)
                    value = value_function(l, g, h)
                    at = block_of(I, node, k, l, dimension)
                    at += 2 * dimension * dimension * (k % 2) + dimension * (l % 2)
                    for i in range(dimension):
                        for j in range(dimension):
                            across = w[3 + j] - still * w[j]
                            rate = turned * across / stretch + (slides - drag / stretch) * w[j]
                            entry = -load * (rate * w[i] * slope - cv * turned * w[i] * w[j] * value)
                            if i == j:
                                entry -= (load * drag / stretch + bend) * slope
                            M[at + size * i + j] += entry
        area = size * size
        for i in range(dimension):
            at = size * i + dimension + i
            M[I[O_DIAGONAL] + area * parent + at] -= momentum
            M[I[O_DIAGONAL] + area * node + at] += momentum
    for side in range(2 if I[I_BODIES] > 0 else 0):
        sign = 2.0 * side - 1.0
        for body in range(I[I_BODIES]):
            row = I[O_BODY] + body * BODY_WORDS
            node = int(M[row + B_NODE])
            if node >= 0 and M[row + B_LENGTH] == 0.0:
                add_body(I, M, flow, q, v, a, ca, cv, row, node, sign)
        run_with_cable(I, M, flow if side == 0 else -flow, q, v)


@kernel
def add_body(I, M, flow, q, v, a, ca, cv, row, node, sign):
    """Add a point body's derivatives with the flow (sign 1), or take those without it (-1)."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    w = M[I[O_MOTION] + 16 : I[O_MOTION] + 46]
    at = size * node
    D = I[O_DIAGONAL] + size * at
    for part in range(2):
        # The second time what the velocity adds that turns with the slope.
        if part == 1 and sign < 0.0:
            break
        rate = cv if part == 0 else flow
        second = ca if part == 0 else 0.0
        ig = body_kinematics(I, M, node, q, v, a, w)
        if I[I_WAVES] != 0:
            add_waves(I, M, row, q[at], q[at + 1], q[at + dimension - 1], 0.0, w)
            wet_derivatives(I, M, row, ig, second, rate, w)
        else:
            mass = M[row + B_MASS] + M[row + B_ADDED]
            flow_derivatives(M, row, dimension, mass, ig, second, rate, w)
        for i in range(dimension):
            for j in range(dimension):
                motion = sign * w[12 + dimension * i + j]
                if part == 0:
                    M[D + size * i + j] += motion
                    M[D + size * i + dimension + j] += sign * w[21 + dimension * i + j]
                else:
                    M[D + size * i + dimension + j] += motion
