"""The tension-strain curve: Sun & Leonard 1998, eq. 21, without its constant term."""

from cablemodel.solvers.finite_element.kernels.element.tables import P1, WEIGHT, WEIGHT_P1
from cablemodel.solvers.shared.access import edge_of, header, scalars
from cablemodel.solvers.shared.compile import inlined, kernel
from cablemodel.solvers.shared.layout import (
    LARGEST_STRAIN,
)
from cablemodel.solvers.shared.strain import strain_and_slope

PRESSED_EA = 0.01  # of its axial stiffness, what resists where cable bends aside within an element
FOLDS_WITHIN = 1e-4  # tau down to which it does: finer meshes resolve its folds
PIECES = 8  # in which the tensions at three points of an element may lie, each on either branch
EXACT = 1e-12  # of a change of strain


@kernel
def promised_tension(M):
    """What tensions may be wrong by [N], by the largest tension so far.

    A typical one stands for it at first.
    """
    state = scalars(M)
    return 10.0 * state.tolerance * max(state.largest_tension, state.tension_scale)


@kernel
def pressed_stiffness(M):
    """Part of its axial stiffness that flexible cable keeps where it is pressed, off the floor.

    All of it where drag does not damp what snaps back, and where the mesh resolves its folds.
    """
    state = scalars(M)
    if state.undamped != 0.0 or state.tolerance < FOLDS_WITHIN:
        return 1.0
    return PRESSED_EA


@inlined
def strain_aside(M, edge, tension, promised):
    """Strain [-] of flexible cable by what bends aside within an element at a tension [N], and
    d strain/d tension [1/N].

    What is pressed by more than `promised` [N], what tensions may be wrong by, folds in waves
    shorter than any element (P/m grows them, and nothing of their own holds them): its chord gets
    shorter under hardly more pressure. What the mesh resolves of it takes over as it bends.
    """
    beyond = tension + promised
    if beyond >= 0.0:
        return 0.0, 0.0
    softness = edge.compliance * (1.0 / scalars(M).pressed - 1.0)
    return softness * beyond, softness


@kernel
def moments_aside(M, edge, t0, t1):
    """Means over an element of that strain, alone and times P1, under the tension t0 + t1 P1 [N],
    and their derivatives by t0, t1 and both [1/N]."""
    promised = promised_tension(M)
    r0 = 0.0
    r1 = 0.0
    c00 = 0.0
    c01 = 0.0
    c11 = 0.0
    for g in range(3):
        strain, slope = strain_aside(M, edge, t0 + t1 * P1[g], promised)
        r0 += WEIGHT[g] * strain
        r1 += WEIGHT_P1[g] * strain
        c00 += WEIGHT[g] * slope
        c01 += WEIGHT_P1[g] * slope
        c11 += WEIGHT_P1[g] * P1[g] * slope
    return r0, r1, c00, c01, c11


@kernel
def energy_aside(M, edge, tension):
    """What `strain_aside` keeps per unit length [J/m]."""
    strain, softness = strain_aside(M, edge, tension, promised_tension(M))
    return tension * strain - 0.5 * strain * strain / softness if softness > 0.0 else 0.0


@kernel
def tensions_after(M, edge, t0, t1, change0, change1):
    """What the tension t0 + t1 P1 of an element changes by [N] as means of its strain do [-], alone
    and times P1; and whether other points of it bend aside than did.

    By Newton's method: strain is piecewise linear in a tension below zero.
    """
    promised = promised_tension(M)
    wanted0 = change0
    wanted1 = change1
    old0 = t0
    old1 = t1
    before = 0
    now = 0
    for iteration in range(PIECES + 1):
        r0 = 0.0
        r1 = 0.0
        c00 = 0.0
        c01 = 0.0
        c11 = 0.0
        now = 0
        for g in range(3):
            tension = t0 + t1 * P1[g]
            strain, slope = strain_and_slope(
                M,
                tension,
                edge.tension_low,
                edge.tension_high,
                int(edge.strain_offset),
                int(edge.strain_terms),
            )
            aside, softness = strain_aside(M, edge, tension, promised)
            if softness > 0.0:
                now += 1 << g
            strain += aside
            slope += softness
            r0 += WEIGHT[g] * strain
            r1 += WEIGHT_P1[g] * strain
            c00 += WEIGHT[g] * slope
            c01 += WEIGHT_P1[g] * slope
            c11 += WEIGHT_P1[g] * P1[g] * slope
        if iteration == 0:
            before = now
            wanted0 += r0
            wanted1 += r1
        d0 = wanted0 - r0
        d1 = wanted1 - r1
        if iteration > 0 and abs(d0) + abs(d1) <= EXACT * (abs(change0) + abs(change1)):
            break
        determinant = c00 * c11 - c01 * c01
        t0 += (c11 * d0 - c01 * d1) / determinant
        t1 += (c00 * d1 - c01 * d0) / determinant
    return t0 - old0, t1 - old1, now != before


@kernel
def overstretched(I, M):
    """The first node whose element is longer than any cable can be stretched to; 0: none."""
    head = header(I)
    for node in range(1, head.nodes):
        edge = edge_of(I, M, node)
        if I[head.joint + node] == 0:
            strain, _slope = strain_and_slope(
                M,
                M[head.tension + 2 * node],
                edge.tension_low,
                edge.tension_high,
                int(edge.strain_offset),
                int(edge.strain_terms),
            )
            if strain > LARGEST_STRAIN:
                return node
    return 0
