"""Point bodies at nodes: mass, submerged weight, drag and added mass about the node's tangent.

The half-length of the bodies of Sun & Leonard 1998, section 4.1, is zero here: a point mass passes
no moment; see rigid.py for the others. In the plane the second component is the vertical one.
"""

import math

from .compile import kernel
from .environment import current_at
from .layout import (
    B_ADDED,
    B_ADDED_AXIAL,
    B_DRAG,
    B_DRAG_AXIAL,
    B_LENGTH,
    B_MASS,
    B_NODE,
    B_WEIGHT,
    BODY_WORDS,
    I_BODIES,
    I_DIMENSION,
    O_BODY,
    O_DIAGONAL,
    O_MOTION,
)


@kernel
def body_kinematics(I, M, node, q, v, a, w):
    """t (w[0:3]), relative water velocity (w[3:6]), acceleration (w[6:9]); returns 1/|r'|."""
    dimension = I[I_DIMENSION]
    at = 2 * dimension * node
    current_at(I, M, q[at + dimension - 1], w[3:6])
    norm = 0.0
    for i in range(dimension):
        norm += q[at + dimension + i] ** 2
    inverse = 1.0 / math.sqrt(norm)
    for i in range(3):
        w[i] = 0.0
        w[6 + i] = 0.0
    for i in range(dimension):
        w[i] = q[at + dimension + i] * inverse
        w[3 + i] -= v[at + i]
        w[6 + i] = a[at + i]
    if dimension == 2:
        w[5] = 0.0
    return inverse


@kernel
def flow_force(M, row, dimension, inertia, w):
    """Inertia minus drag [N] into w[12:15], from axis, relative flow, acceleration in w[0:9].

    ``inertia`` is the mass that resists acceleration across the axis: its own and the added one.
    """
    ut = 0.0
    along = 0.0
    for i in range(dimension):
        ut += w[3 + i] * w[i]
        along += w[6 + i] * w[i]
    un2 = 0.0
    for i in range(dimension):
        w[9 + i] = w[3 + i] - ut * w[i]
        un2 += w[9 + i] ** 2
    fn = M[row + B_DRAG] * math.sqrt(un2)
    ft = M[row + B_DRAG_AXIAL] * abs(ut) * ut
    ft += (M[row + B_ADDED] - M[row + B_ADDED_AXIAL]) * along
    for i in range(dimension):
        w[12 + i] = inertia * w[6 + i] - fn * w[9 + i] - ft * w[i]


@kernel
def flow_derivatives(M, row, dimension, inertia, ig, ca, cv, w):
    """Derivatives of `flow_force`, (dimension, dimension) each, from w[0:9].

    w[12:21]: for the motion, ca and cv being those of acceleration and velocity for a change of
    position; w[21:30]: for a vector along the axis, whose inverse length is ig.
    """
    ut = 0.0
    along = 0.0
    for i in range(dimension):
        ut += w[3 + i] * w[i]
        along += w[6 + i] * w[i]
    un2 = 0.0
    for i in range(dimension):
        w[9 + i] = w[3 + i] - ut * w[i]
        un2 += w[9 + i] ** 2
    un = math.sqrt(un2)
    iun = 1.0 / max(un, 1e-30)
    cn = M[row + B_DRAG]
    ct = M[row + B_DRAG_AXIAL]
    added = M[row + B_ADDED] - M[row + B_ADDED_AXIAL]
    d_tt = 2.0 * cv * ct * abs(ut) - ca * added
    e_tn = -ig * (2.0 * ct * abs(ut) - cn * un)
    e_p = -ig * (ct * abs(ut) * ut - cn * un * ut + added * along)
    e_nn = ig * cn * ut * iun
    for i in range(dimension):
        for j in range(dimension):
            tt = w[i] * w[j]
            p = -tt
            own = 0.0
            if i == j:
                p += 1.0
                own = ca * inertia
            nn = w[9 + i] * w[9 + j]
            at = dimension * i + j
            w[12 + at] = own + cv * cn * (un * p + iun * nn) + d_tt * tt
            w[21 + at] = (
                e_tn * w[i] * w[9 + j]
                + e_p * p
                + e_nn * nn
                - added * ig * w[i] * (w[6 + j] - along * w[j])
            )


@kernel
def body_residual(I, M, q, v, a, out):
    """Add inertia, weight and minus drag of every body to the forces of its node."""
    dimension = I[I_DIMENSION]
    w = M[I[O_MOTION] + 16 : I[O_MOTION] + 46]
    for body in range(I[I_BODIES]):
        row = I[O_BODY] + body * BODY_WORDS
        node = int(M[row + B_NODE])
        if node < 0 or M[row + B_LENGTH] > 0.0:  # still on the drum, or in rigid.py
            continue
        body_kinematics(I, M, node, q, v, a, w)
        flow_force(M, row, dimension, M[row + B_MASS] + M[row + B_ADDED], w)
        at = 2 * dimension * node
        for i in range(dimension):
            out[at + i] += w[12 + i]
        out[at + dimension - 1] += M[row + B_WEIGHT]


@kernel
def body_jacobian(I, M, q, v, a, ca, cv):
    """Add the bodies' derivatives to the diagonal blocks of their nodes."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    w = M[I[O_MOTION] + 16 : I[O_MOTION] + 46]
    for body in range(I[I_BODIES]):
        row = I[O_BODY] + body * BODY_WORDS
        node = int(M[row + B_NODE])
        if node < 0 or M[row + B_LENGTH] > 0.0:
            continue
        ig = body_kinematics(I, M, node, q, v, a, w)
        flow_derivatives(M, row, dimension, M[row + B_MASS] + M[row + B_ADDED], ig, ca, cv, w)
        D = M[I[O_DIAGONAL] + size * size * node : I[O_DIAGONAL] + size * size * (node + 1)]
        for i in range(dimension):
            for j in range(dimension):
                D[size * i + j] += w[12 + dimension * i + j]
                D[size * i + dimension + j] += w[21 + dimension * i + j]
