"""The tension-strain curve: Sun & Leonard 1998, eq. 21, without its constant term."""

from .access import edge_of, header
from .compile import inlined, kernel
from .layout import (
    LARGEST_STRAIN,
)


@inlined
def strain_and_slope(M, tension, low, high, offset, terms):
    """Strain [-] and d strain/d tension [1/N] at a tension [N].

    A polynomial c_1 T + c_2 T^2 + ... between `low` and `high`, where it is known to rise; its
    tangents outside, so that it can be inverted everywhere.
    """
    t = min(max(tension, low), high)
    strain = 0.0
    slope = 0.0
    for n in range(terms - 1, -1, -1):
        c = M[offset + n]
        slope = slope * t + (n + 1) * c
        strain = (strain + c) * t
    return strain + slope * (tension - t), slope


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
