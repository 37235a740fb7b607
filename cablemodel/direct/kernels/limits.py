"""Where the formulation ends: slack in a flexible section, the singular angle, a drifting end."""

import math

from cablemodel.kernels.layout import I_FAILED_NODE, OK

from .compile import kernel
from .geometry import last_node
from .layout import (
    CABLE,
    D_END,
    D_SECTIONS,
    DRIFT,
    END_ANCHOR,
    F3,
    N_COUNT,
    N_FIRST,
    N_KIND,
    O_PLACE,
    O_SECTION,
    O_Y,
    SECTION_WORDS,
    SINGULAR_ANGLE,
    SLACK,
    THETA,
    WIDTH,
    X_ANCHOR,
    X_DRIFT,
    X_LOWEST,
)

AT_POLE = 0.02
"""sin(theta) below which the equations are taken as singular."""


@kernel
def check_state(I, M):
    """OK, or why the state that has been found is none: the status, with the node at fault."""
    for index in range(I[D_SECTIONS]):
        section = I[O_SECTION] + SECTION_WORDS * index
        first = I[section + N_FIRST]
        for node in range(first, first + I[section + N_COUNT]):
            y = I[O_Y] + WIDTH * node
            if abs(math.sin(M[y + THETA])) < AT_POLE:
                I[I_FAILED_NODE] = node
                return SINGULAR_ANGLE
            if I[section + N_KIND] == CABLE and M[y + F3] < -M[X_LOWEST]:
                I[I_FAILED_NODE] = node
                return SLACK
    if I[D_END] == END_ANCHOR:
        node = last_node(I)
        total = 0.0
        for i in range(3):
            total += (M[I[O_PLACE] + 3 * node + i] - M[X_ANCHOR + i]) ** 2
        if total > M[X_DRIFT] ** 2:
            I[I_FAILED_NODE] = node
            return DRIFT
    return OK
