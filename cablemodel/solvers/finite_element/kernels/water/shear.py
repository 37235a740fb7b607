"""How the drag of a cable changes with its height, where the current changes with depth."""

import math

from cablemodel.solvers.finite_element.kernels.element.tables import H0, H1, H2, H3
from cablemodel.solvers.shared.access import header, vector
from cablemodel.solvers.shared.compile import outlined
from cablemodel.solvers.shared.environment import shear_at
from cablemodel.solvers.shared.layout import POINT_WORDS
from cablemodel.solvers.shared.numbers import NO_SIZE


@outlined
def add_shear(I, M, points, edge, rows, words, x0, x1, v0, v1):
    """What the water of another height drags at the Gauss points, d(-F)/dz = -(dF/du) du/dz, into
    rows A00 of so many words each; F: Sun & Leonard 1998, eq. 23."""
    dimension = header(I).dimension
    up = dimension - 1
    slope = dimension + up
    h = edge.length
    shear = vector()
    across = vector()
    for g in range(3):
        height = x0[up] * H0[g] + x1[up] * H2[g] + h * (x0[slope] * H1[g] + x1[slope] * H3[g])
        shear_at(I, M, height, shear)
        along = 0.0
        change = 0.0
        for i in range(dimension):
            d = dimension + i
            moves = v0[i] * H0[g] + v1[i] * H2[g] + h * (v0[d] * H1[g] + v1[d] * H3[g])
            across[i] = points.water[POINT_WORDS * i + g] - moves
            along += across[i] * points.tangent[POINT_WORDS * i + g]
            change += shear[i] * points.tangent[POINT_WORDS * i + g]
        square = 0.0
        change_across = 0.0
        for i in range(dimension):
            across[i] -= along * points.tangent[POINT_WORDS * i + g]
            square += across[i] ** 2
            change_across += shear[i] * across[i]
        root = h * math.sqrt(points.stretch[g])
        normal = root * edge.drag_normal * math.sqrt(square)
        by_tangent = (2.0 * root * edge.drag_tangential * abs(along) - normal) * change
        by_normal = root * edge.drag_normal * change_across / max(math.sqrt(square), NO_SIZE)
        for i in range(dimension):
            dragged = normal * shear[i] + by_normal * across[i]
            dragged += by_tangent * points.tangent[POINT_WORDS * i + g]
            rows[words * g + dimension * i + up] -= dragged
