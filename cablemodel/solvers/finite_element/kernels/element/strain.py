"""The tension-strain curve: Sun & Leonard 1998, eq. 21, without its constant term."""

from cablemodel.solvers.finite_element.kernels.element.tables import P1, WEIGHT, WEIGHT_P1
from cablemodel.solvers.shared.access import (
    edge_of,
    header,
    scalars,
    tension_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel, view
from cablemodel.solvers.shared.layout import (
    LARGEST_STRAIN,
)
from cablemodel.solvers.shared.strain import strain_and_slope

PIECES = 8  # in which the tensions at three points of an element may lie, each on either branch
EXACT = 1e-12  # of a change of strain


@kernel
def promised_tension(M):
    """What tensions may be wrong by [N], by the largest tension so far, or next to nothing of a
    typical one, which stands for it before the first step: what lies or hangs slack has none."""
    state = scalars(M)
    typical = state.tension_scale
    if state.largest_tension > 0.0:
        typical *= state.tolerance
    return 10.0 * state.tolerance * max(state.largest_tension, typical)


@inlined
def largest_mean(tension, nodes):
    """The largest mean tension of an element, either way [N]; tension: (nodes, 2)."""
    largest = 0.0
    for node in range(1, nodes):
        largest = max(largest, abs(tension[2 * node]))
    return largest


@inlined
def strain_in(M, edge, tension):
    """Strain [-] of an element's material at a tension [N], and d strain/d tension [1/N]."""
    return strain_and_slope(
        M,
        tension,
        edge.tension_low,
        edge.tension_high,
        int(edge.strain_offset),
        int(edge.strain_terms),
    )


@inlined
def may_be_slack(edge, t0, t1):
    """Whether some of an element under the tension t0 + t1 P1 may be pressed aside."""
    return t0 + edge.bears < abs(t1) and edge.yields != 0.0


@inlined
def strain_aside(edge, tension):
    """Strain [-] of cable by what bends aside within an element at a tension [N], and
    d strain/d tension [1/N]; see `limp.py`."""
    beyond = tension + edge.bears
    if beyond >= 0.0 or edge.yields == 0.0:
        return 0.0, 0.0
    softness = 1.0 / edge.yields
    return softness * beyond, softness


@inlined
def is_limp(edge):
    """Whether any pressure shortens an element."""
    return edge.yields > 0.0 and edge.bears == 0.0


@inlined
def folds(M, edge, t0, t1):
    """Whether an element under the tension t0 + t1 P1 bends aside: slack that lies, by more than
    what positions may be wrong by."""
    if is_limp(edge):
        return t0 < -scalars(M).tolerance * edge.yields
    return edge.yields > 0.0 and t0 - abs(t1) < -edge.bears


@kernel
def moments_aside(edge, t0, t1):
    """Means over an element of that strain, alone and times P1, under the tension t0 + t1 P1 [N],
    and their derivatives by t0, t1 and both [1/N]."""
    r0 = 0.0
    r1 = 0.0
    c00 = 0.0
    c01 = 0.0
    c11 = 0.0
    for g in range(3):
        strain, slope = strain_aside(edge, t0 + t1 * P1[g])
        r0 += WEIGHT[g] * strain
        r1 += WEIGHT_P1[g] * strain
        c00 += WEIGHT[g] * slope
        c01 += WEIGHT_P1[g] * slope
        c11 += WEIGHT_P1[g] * P1[g] * slope
    return r0, r1, c00, c01, c11


@kernel
def energy_aside(edge, tension):
    """What `strain_aside` keeps per unit length [J/m]."""
    strain, softness = strain_aside(edge, tension)
    return tension * strain - 0.5 * strain * strain / softness if softness > 0.0 else 0.0


@kernel
def moments(M, edge, t0, t1):
    """Means over an element of its strain [-], alone and times P1, under the tension t0 + t1 P1
    [N], with what bends aside; their derivatives by t0, t1 and both [1/N]; and which of its points
    bend aside, a bit for each."""
    r0 = 0.0
    r1 = 0.0
    c00 = 0.0
    c01 = 0.0
    c11 = 0.0
    bent = 0
    for g in range(3):
        tension = t0 + t1 * P1[g]
        strain, slope = strain_in(M, edge, tension)
        aside, softness = strain_aside(edge, tension)
        if softness > 0.0:
            bent += 1 << g
        strain += aside
        slope += softness
        r0 += WEIGHT[g] * strain
        r1 += WEIGHT_P1[g] * strain
        c00 += WEIGHT[g] * slope
        c01 += WEIGHT_P1[g] * slope
        c11 += WEIGHT_P1[g] * P1[g] * slope
    return r0, r1, c00, c01, c11, bent


@kernel
def tensions_after(M, edge, t0, t1, change0, change1):
    """What the tension t0 + t1 P1 of an element changes by [N] as means of its strain do [-], alone
    and times P1; and whether other points of it bend aside than did.

    By Newton's method: strain is piecewise linear in a tension below zero.
    """
    wanted0 = change0
    wanted1 = change1
    old0 = t0
    old1 = t1
    before = 0
    now = 0
    for iteration in range(PIECES + 1):
        r0, r1, c00, c01, c11, now = moments(M, edge, t0, t1)
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
def tensions_of_both(I, M, upper, lower):
    """Tension (mean, times P1) [N] of one element in the place of two of a cable, with their
    strain: a mean of tensions has another where some bends aside."""
    above = edge_of(I, M, upper)
    below = edge_of(I, M, lower)
    tension = view(M, header(I).tension, 2 * header(I).nodes)
    t0, t1 = tension[2 * upper], tension[2 * upper + 1]
    t2, t3 = tension[2 * lower], tension[2 * lower + 1]
    h = above.length + below.length
    x = above.length / h
    y = below.length / h
    a0, a1, _c, _c01, _c11, _bent = moments(M, above, t0, t1)
    b0, b1, _c, _c01, _c11, _bent = moments(M, below, t2, t3)
    mean = x * t0 + y * t2
    slope = 0.5 * (t2 + t3 - t0 + t1)
    r0, r1, _c, _c01, _c11, _bent = moments(M, below, mean, slope)
    r0 = x * a0 + y * b0 - r0
    r1 = x * (x * a1 - y * a0) + y * (y * b1 + x * b0) - r1
    d0, d1, _others = tensions_after(M, below, mean, slope, r0, r1)
    return mean + d0, slope + d1


@kernel
def overstretched(I, M):
    """The first node whose element is longer than any cable can be stretched to; 0: none."""
    head = header(I)
    for node in range(1, head.nodes):
        edge = edge_of(I, M, node)
        if I[head.joint + node] == 0:
            strain, _slope = strain_in(M, edge, tension_of(I, M, node).mean)
            if strain > LARGEST_STRAIN:
                return node
    return 0
