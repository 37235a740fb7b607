"""The paper's axes and Euler angles (eq. 24): e1 down, e2 and e3 horizontal, a3 along the cable.

a1 = (cos phi, sin phi, 0), a2 = (-sin phi cos theta, cos phi cos theta, sin theta),
a3 = (sin phi sin theta, -cos phi sin theta, cos theta). They fail where sin theta = 0: where the
cable lies along e3. In a vertical plane theta is pi/2 and phi alone turns.
"""

import math

from cablemodel.solvers.shared.access import scalars

from .compile import inlined


@inlined
def to_fixed(phi, theta, x1, x2, x3):
    """Components along e1, e2, e3 of x1 a1 + x2 a2 + x3 a3."""
    sp = math.sin(phi)
    cp = math.cos(phi)
    st = math.sin(theta)
    ct = math.cos(theta)
    return (
        cp * x1 - sp * ct * x2 + sp * st * x3,
        sp * x1 + cp * ct * x2 - cp * st * x3,
        st * x2 + ct * x3,
    )


@inlined
def to_local(phi, theta, g1, g2, g3):
    """Components along a1, a2, a3 of a vector given along e1, e2, e3."""
    sp = math.sin(phi)
    cp = math.cos(phi)
    st = math.sin(theta)
    ct = math.cos(theta)
    return (
        cp * g1 + sp * g2,
        -sp * ct * g1 + cp * ct * g2 + st * g3,
        sp * st * g1 - cp * st * g2 + ct * g3,
    )


@inlined
def to_earth(M, g1, g2, g3):
    """East, north, up of a vector along e1 (down), e2 = (px, py, 0), e3 = (py, -px, 0)."""
    state = scalars(M)
    px = state.plane[0]
    py = state.plane[1]
    return px * g2 + py * g3, py * g2 - px * g3, -g1


@inlined
def from_earth(M, x, y, z):
    """Components along e1, e2, e3 of an earth-frame vector."""
    state = scalars(M)
    px = state.plane[0]
    py = state.plane[1]
    return -z, px * x + py * y, py * x - px * y
