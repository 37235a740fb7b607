"""Point bodies at nodes: mass, submerged weight, drag and added mass about the node's tangent.

Drag is 1/2 rho |u| (CdA_n u_n + CdA_a u_a): with equal areas along and across, that of a sphere,
whatever way the cable points. (Of its parts squared each, a body of equal areas would feel up to
30 % less drag when it moves askew: 1.5 % of the top tension in the pay-out scene S3.)

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
        u2 = 0.0
        for i in range(dimension):
            ut += w[3 + i] * w[i]
            along += w[6 + i] * w[i]
            u2 += w[3 + i] ** 2
        speed = math.sqrt(u2)
        fn = M[row + B_DRAG] * speed
        inertia = M[row + B_MASS] + M[row + B_ADDED]
        ft = (M[row + B_DRAG_AXIAL] - M[row + B_DRAG]) * speed * ut
        ft += (M[row + B_ADDED] - M[row + B_ADDED_AXIAL]) * along
        for i in range(dimension):
            out[at + i] += inertia * w[6 + i] - fn * w[3 + i] - ft * w[i]
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
        u2 = 0.0
        for i in range(dimension):
            ut += w[3 + i] * w[i]
            along += w[6 + i] * w[i]
            u2 += w[3 + i] ** 2
        speed = math.sqrt(u2)
        inverse = 1.0 / max(speed, 1e-30)
        cn = M[row + B_DRAG]
        ct = M[row + B_DRAG_AXIAL]
        added = M[row + B_ADDED] - M[row + B_ADDED_AXIAL]
        inertia = ca * (M[row + B_MASS] + M[row + B_ADDED])
        turn = ig * (ct - cn) * speed
        for i in range(dimension):
            for j in range(dimension):
                tt = w[i] * w[j]
                p = -tt
                if i == j:
                    p += 1.0
                    D[size * i + j] += inertia
                un = w[3 + i] - ut * w[i]
                drag = speed * (cn * p + ct * tt)
                drag += (cn * un + ct * ut * w[i]) * w[3 + j] * inverse
                D[size * i + j] += cv * drag - ca * added * tt
                D[size * i + dimension + j] -= (
                    w[i] * (turn * (w[3 + j] - ut * w[j]) + ig * added * (w[6 + j] - along * w[j]))
                    + (turn * ut + ig * added * along) * p
                )
