"""A cubic Hermite element at its Gauss points: two components side by side.

Of three components the last goes without a companion, in the formulas of the element itself. And
r'' at the ends of one.
"""

from typing import Any

from cablemodel.solvers.finite_element.kernels.element.tables import (
    D1,
    D2,
    D3,
    E1,
    E2,
    E3,
    H0,
    H1,
    H2,
    H3,
)
from cablemodel.solvers.finite_element.kernels.line.products import values_of_two
from cablemodel.solvers.shared.compile import inlined, own_numbers

six_numbers, eight_numbers = own_numbers(6), own_numbers(8)
"""eight_numbers(): two components, four words each, at three Gauss points and one that is none."""


@inlined
def bend_at_begin(six_chords, d0, d1):
    """h r'' of a cubic of length h where it begins: by six times (r1 - r0) / h, and its slopes."""
    return six_chords - 4.0 * d0 - 2.0 * d1


@inlined
def bend_at_end(six_chords, d0, d1):
    """The same where it ends."""
    return 2.0 * d0 + 4.0 * d1 - six_chords


def cubic_kernels(dimension: int) -> tuple[Any, Any, Any]:
    """Kernels that write the first two components of r', of r'' and of a velocity.

    x0, x1: vectors of the element's nodes (2, dimension), h: its length.
    """
    slopes_of_two = values_of_two((D2, D1, D3))
    second_of_two = values_of_two((E2, E1, E3))
    places_of_two = values_of_two((H0, H1, H2, H3))

    @inlined
    def slopes(x0, x1, h, out):
        """dr/ds."""
        ih = 1.0 / h
        unknowns = six_numbers()
        for i in range(2):
            unknowns[i] = (x1[i] - x0[i]) * ih
            unknowns[2 + i] = x0[dimension + i]
            unknowns[4 + i] = x1[dimension + i]
        slopes_of_two(unknowns, out)

    @inlined
    def second_derivatives(x0, x1, h, out):
        """d2r/ds2 [1/m]."""
        ih2 = 1.0 / (h * h)
        ih = 1.0 / h
        unknowns = six_numbers()
        for i in range(2):
            unknowns[i] = (x1[i] - x0[i]) * ih2
            unknowns[2 + i] = x0[dimension + i] * ih
            unknowns[4 + i] = x1[dimension + i] * ih
        second_of_two(unknowns, out)

    @inlined
    def values(x0, x1, h, out):
        """What the nodes have, velocities or accelerations, between them."""
        unknowns = eight_numbers()
        for i in range(2):
            unknowns[i] = x0[i]
            unknowns[2 + i] = h * x0[dimension + i]
            unknowns[4 + i] = x1[i]
            unknowns[6 + i] = h * x1[dimension + i]
        places_of_two(unknowns, out)

    return slopes, second_derivatives, values
