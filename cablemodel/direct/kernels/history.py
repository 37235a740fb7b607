"""Eq. 38: rates at the end of a step from values at both ends, y_t = beta y - past."""

from .assembly import fill_system
from .compile import kernel
from .geometry import last_node
from .layout import (
    B_PAST,
    B_STATE,
    B_STATE_RATE,
    BODY_STATES,
    BODY_WORDS,
    D_BODIES,
    O_BODY,
    O_PAST,
    O_RATE,
    O_STRAINS,
    O_Y,
    RATES,
    WIDTH,
    X_BETA,
    X_MEMORY,
)


@kernel
def value(I, M, node, which):
    """The value of a node that eq. 38 differentiates: V1, V2, V3, phi, theta, strain."""
    if which < 5:
        return M[I[O_Y] + WIDTH * node + which]
    return M[I[O_STRAINS] + 2 * node]


@kernel
def keep_past(I, M):
    """past = beta y_p + gamma y_t_p at the start of a step, of nodes and bodies."""
    beta = M[X_BETA]
    memory = M[X_MEMORY]
    for node in range(last_node(I) + 1):
        for k in range(RATES):
            at = RATES * node + k
            M[I[O_PAST] + at] = beta * value(I, M, node, k) + memory * M[I[O_RATE] + at]
    for body in range(I[D_BODIES]):
        row = I[O_BODY] + BODY_WORDS * body
        for k in range(BODY_STATES):
            M[row + B_PAST + k] = beta * M[row + B_STATE + k] + memory * M[row + B_STATE_RATE + k]


@kernel
def set_rates(I, M):
    """Rates at the end of a step that has converged."""
    beta = M[X_BETA]
    for node in range(last_node(I) + 1):
        for k in range(RATES):
            at = RATES * node + k
            M[I[O_RATE] + at] = beta * value(I, M, node, k) - M[I[O_PAST] + at]
    if I[D_BODIES] > 0:
        fill_system(I, M, 1)  # leaves the bodies' states at the converged values
        for body in range(I[D_BODIES]):
            row = I[O_BODY] + BODY_WORDS * body
            for k in range(BODY_STATES):
                M[row + B_STATE_RATE + k] = beta * M[row + B_STATE + k] - M[row + B_PAST + k]


@kernel
def forget(I, M):
    """All rates zero: a steady state."""
    for k in range(RATES * (last_node(I) + 1)):
        M[I[O_PAST] + k] = 0.0
        M[I[O_RATE] + k] = 0.0
    for body in range(I[D_BODIES]):
        row = I[O_BODY] + BODY_WORDS * body
        for k in range(BODY_STATES):
            M[row + B_PAST + k] = 0.0
            M[row + B_STATE_RATE + k] = 0.0
