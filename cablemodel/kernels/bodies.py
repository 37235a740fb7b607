"""Point bodies at nodes: mass, submerged weight, drag and added mass about the node's tangent.

The half-length of the bodies of Sun & Leonard 1998, section 4.1, is zero here: a point mass passes
no moment. In the plane the second component is the vertical one.
"""

import math

from .compile import kernel
from .environment import current_at
from .layout import (
    B_ADDED,
    B_ADDED_AXIAL,
    B_DRAG,
    B_DRAG_AXIAL,
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
def body_residual(I, M, q, v, a, out):
    """Add inertia, weight and minus drag of every body to the forces of its node."""
    dimension = I[I_DIMENSION]
    w = M[I[O_MOTION] + 16 : I[O_MOTION] + 28]
    for body in range(I[I_BODIES]):
        row = I[O_BODY] + body * BODY_WORDS
        node = int(M[row + B_NODE])
        if node < 0:  # still on the drum
            continue
        body_kinematics(I, M, node, q, v, a, w)
        at = 2 * dimension * node
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
        inertia = M[row + B_MASS] + M[row + B_ADDED]
        ft = M[row + B_DRAG_AXIAL] * abs(ut) * ut
        ft += (M[row + B_ADDED] - M[row + B_ADDED_AXIAL]) * along
        for i in range(dimension):
            out[at + i] += inertia * w[6 + i] - fn * w[9 + i] - ft * w[i]
        out[at + dimension - 1] += M[row + B_WEIGHT]


@kernel
def body_jacobian(I, M, q, v, a, ca, cv):
    """Add the bodies' derivatives to the diagonal blocks of their nodes."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    w = M[I[O_MOTION] + 16 : I[O_MOTION] + 28]
    for body in range(I[I_BODIES]):
        row = I[O_BODY] + body * BODY_WORDS
        node = int(M[row + B_NODE])
        if node < 0:  # still on the drum
            continue
        ig = body_kinematics(I, M, node, q, v, a, w)
        D = M[I[O_DIAGONAL] + size * size * node : I[O_DIAGONAL] + size * size * (node + 1)]
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
        inertia = ca * (M[row + B_MASS] + M[row + B_ADDED])
        d_tt = 2.0 * cv * ct * abs(ut) - ca * added
        e_tn = -ig * (2.0 * ct * abs(ut) - cn * un)
        e_p = -ig * (ct * abs(ut) * ut - cn * un * ut + added * along)
        e_nn = ig * cn * ut * iun
        for i in range(dimension):
            for j in range(dimension):
                tt = w[i] * w[j]
                p = -tt
                if i == j:
                    p += 1.0
                    D[size * i + j] += inertia
                nn = w[9 + i] * w[9 + j]
                D[size * i + j] += cv * cn * (un * p + iun * nn) + d_tt * tt
                D[size * i + dimension + j] += (
                    e_tn * w[i] * w[9 + j]
                    + e_p * p
                    + e_nn * nn
                    - added * ig * w[i] * (w[6 + j] - along * w[j])
                )
