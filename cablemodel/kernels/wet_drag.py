"""Drag on an element through the surface: none that pushes the cable on.

The shares of an element's Gauss points (wetting.py) make loads that are quadratic along it exact on
its wet part, and are below 0 for that where little of it is wet, or all but its middle. Drag grows
with the square of the speed: with a share below 0 it does work on a cable that moves fast there,
the more the faster it is, and the speed becomes infinite within a finite time.

So drag has shares of its own that are never below 0: with the same length of the wet part and the
same mean, or the nearest that there is, and what is then nearest to its second moment. Where no
share is below 0 they are the same.
"""

import math

from .compile import kernel, outlined
from .layout import E_DRAG_NORMAL, E_DRAG_TANGENTIAL, E_LENGTH, ELEMENT_WORDS, I_DIMENSION
from .tables import D0, D1, D2, D3, H0, H1, H2, H3, WEIGHT
from .waves import FORCE, VELOCITY, WET

SHARE = ELEMENT_WORDS - 4  # a slot in the Gauss workspace, where the Newton matrix has its sums


@kernel
def set_drag_shares(W):
    """The shares of the Gauss points by which drag counts, from those of the wet part."""
    above = WEIGHT[0] * W[WET]
    below = WEIGHT[2] * W[WET + 2]
    length = max(0.0, above + WEIGHT[1] * W[WET + 1] + below)
    # Moments of the wet part about the element's middle, in units of the outer points' distance.
    first = max(-length, min(length, below - above))
    second = max(abs(first), min(length, below + above))
    W[SHARE] = 0.5 * (second - first) / WEIGHT[0]
    W[SHARE + 1] = (length - second) / WEIGHT[1]
    W[SHARE + 2] = 0.5 * (second + first) / WEIGHT[2]


@kernel
def is_overdrawn(W):
    """Whether the share of a Gauss point is below 0."""
    return min(W[WET], W[WET + 1], W[WET + 2]) < 0.0


@kernel
def count_by_drag(W):
    """Let the Newton matrix count all loads by the shares of drag.

    It grows with the speed, and added mass is little beside all mass.
    """
    if is_overdrawn(W):
        set_drag_shares(W)
        for g in range(3):
            W[WET + g] = W[SHARE + g]


@outlined
def correct_drag(I, M, W, edge, x0, x1, v0, v1):
    """Add to minus the loads what drag by its own shares differs by from drag by the wet ones.

    Water and shares are what `element_water` has written.
    """
    if not is_overdrawn(W):
        return
    dimension = I[I_DIMENSION]
    h = M[edge + E_LENGTH]
    set_drag_shares(W)
    for g in range(3):
        u2 = 0.0
        ud = 0.0
        d2 = 0.0
        for i in range(dimension):
            d = dimension + i
            slope = (x0[i] * D0[g] + x1[i] * D2[g]) / h + x0[d] * D1[g] + x1[d] * D3[g]
            u = W[VELOCITY + 4 * i + g]
            u -= v0[i] * H0[g] + v1[i] * H2[g] + h * (v0[d] * H1[g] + v1[d] * H3[g])
            u2 += u * u
            ud += u * slope
            d2 += slope * slope
        stretch = math.sqrt(d2)
        ut = ud / stretch
        un = math.sqrt(max(0.0, u2 - ut * ut))
        more = (W[SHARE + g] - W[WET + g]) * math.sqrt(stretch)
        fn = more * M[edge + E_DRAG_NORMAL] * un
        ft = more * M[edge + E_DRAG_TANGENTIAL] * abs(ut) * ut
        for i in range(dimension):
            d = dimension + i
            slope = (x0[i] * D0[g] + x1[i] * D2[g]) / h + x0[d] * D1[g] + x1[d] * D3[g]
            t = slope / stretch
            u = W[VELOCITY + 4 * i + g]
            u -= v0[i] * H0[g] + v1[i] * H2[g] + h * (v0[d] * H1[g] + v1[d] * H3[g])
            W[FORCE + 4 * i + g] -= fn * (u - ut * t) + ft * t
