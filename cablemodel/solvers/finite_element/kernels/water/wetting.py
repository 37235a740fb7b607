"""Which share of a cable or of a body is wet where it stands through the surface.

At a depth d below the surface a point is wet by a share, a cubic from 0 to 1 over a band of +- half
around it: half a cable's diameter. An element sees the surface by shares of its three Gauss points;
with l_g the quadratic that is 1 at one of them and 0 at the others, x along the element,

    s_g = integral of l_g(x) share(d(x)) dx / integral of l_g(x) dx.

The Gauss rule with these shares integrates loads that are quadratic along the element over its wet
part alone, so that they change smoothly while the surface climbs along it and on to the next,
however long elements are. A share may be a little below 0 or above 1: see `drag_shares`. d(x) is
the quadratic through the depths of the Gauss points.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.tables import (
    P1,
    WEIGHT,
    WET_POINTS,
    WET_WEIGHTS,
)
from cablemodel.solvers.shared.compile import inlined, kernel, outlined

OUTER = float(P1[2])  # Gauss points lie at -OUTER, 0, OUTER of x in [-1, 1]
NOWHERE = 2.0


@kernel
def share_at(depth, half):
    """Share that is wet at a depth [m], and its derivative [1/m]; half of the band [m]."""
    x = depth / half
    if x <= -1.0:
        return 0.0, 0.0
    if x >= 1.0:
        return 1.0, 0.0
    return 0.5 + x * (0.75 - 0.25 * x * x), 0.75 * (1.0 - x * x) / half


@inlined
def where_zero(a, b, c):
    """Places where a + b x + c x^2 = 0, NOWHERE for what does not exist."""
    square = b * b - 4.0 * a * c
    if square < 0.0:
        return NOWHERE, NOWHERE
    q = -0.5 * (b + math.copysign(math.sqrt(square), b))
    return (q / c if c != 0.0 else NOWHERE), (a / q if q != 0.0 else NOWHERE)


@inlined
def first_beyond(x, places):
    """The first of four places beyond x, or the element's end."""
    found = 1.0
    for place in places:
        if x < place and place < found:
            found = place
    return found


@outlined
def wet_shares(points, half):
    """Shares of an element's Gauss points, and their derivatives by its height [1/m], at its
    ElementPoints.

    points.wet, on entry: depths of the Gauss points [m]; half of the band [m].
    """
    wet = points.wet
    slope = points.wet_slope
    d0 = wet[0]
    d1 = wet[1]
    d2 = wet[2]
    b = (d2 - d0) / (2.0 * OUTER)
    c = (0.5 * (d0 + d2) - d1) / (OUTER * OUTER)
    span = abs(b) + abs(c)
    if d1 - span >= half or d1 + span <= -half:
        for g in range(3):
            wet[g] = 1.0 if d1 > 0.0 else 0.0
            slope[g] = 0.0
        return
    u0, u1 = where_zero(d1 - half, b, c)
    u2, u3 = where_zero(d1 + half, b, c)
    places = (u0, u1, u2, u3)
    for g in range(3):
        wet[g] = 0.0
        slope[g] = 0.0
    x = -1.0
    while x < 1.0:
        end = first_beyond(x, places)
        middle = 0.5 * (x + end)
        depth = d1 + middle * (b + middle * c)
        if depth >= half and end - x == 2.0:
            for g in range(3):
                wet[g] = WEIGHT[g]
        elif depth > -half:
            for p in range(5):
                u = x + (end - x) * WET_POINTS[p]
                share, rate = share_at(d1 + u * (b + u * c), half)
                part = 0.5 * (end - x) * WET_WEIGHTS[p]
                outer = 0.5 * u / OUTER
                inner = u * outer / OUTER
                wet[0] += part * share * (inner - outer)
                wet[1] += part * share * (1.0 - 2.0 * inner)
                wet[2] += part * share * (inner + outer)
                slope[0] -= part * rate * (inner - outer)
                slope[1] -= part * rate * (1.0 - 2.0 * inner)
                slope[2] -= part * rate * (inner + outer)
        x = end
    for g in range(3):
        wet[g] /= WEIGHT[g]
        slope[g] /= WEIGHT[g]


@kernel
def drag_shares(points):
    """The shares of an element's Gauss points by which drag counts, from those of its wet part.

    Where little of an element is wet, or all but its middle, a share is below 0. Drag grows with
    the square of the speed: with such a share it does work on a cable that moves fast there, the
    more the faster it is, and the speed becomes infinite within a finite time. So drag has shares
    that are never below 0: with the same length of the wet part and the same mean, or the nearest
    that there is, and what is then nearest to its second moment. Where no share is below 0 they
    are the same.
    """
    wet = points.wet
    drag = points.drag
    above = WEIGHT[0] * wet[0]
    below = WEIGHT[2] * wet[2]
    length = max(0.0, above + WEIGHT[1] * wet[1] + below)
    # Moments of the wet part about the element's middle, in units of the outer points' distance.
    first = max(-length, min(length, below - above))
    second = max(abs(first), min(length, below + above))
    drag[0] = 0.5 * (second - first) / WEIGHT[0]
    drag[1] = (length - second) / WEIGHT[1]
    drag[2] = 0.5 * (second + first) / WEIGHT[2]
