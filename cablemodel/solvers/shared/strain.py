"""The tension-strain curve: Sun & Leonard 1998, eq. 21, without its constant term."""

from cablemodel.solvers.shared.compile import inlined


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
