"""Eq. 38: rates at the end of a step from values at both ends, y_t = beta y - past."""

from .access import own_header, own_scalars, rigid_body_of, strain_of
from .assembly import fill_system
from .compile import kernel
from .geometry import last_node
from .layout import (
    BODY_STATES,
    RATES,
    WIDTH,
    NodeRates,
)

STRAIN = NodeRates.strain.word
"""Number of the strain among what is differentiated; those before it are unknowns."""


@kernel
def value(I, M, node, which):
    """The value of a node that eq. 38 differentiates: V1, V2, V3, phi, theta, strain."""
    own = own_header(I)
    if which < STRAIN:
        return M[own.unknowns + WIDTH * node + which]
    return strain_of(I, M, node).strain


@kernel
def keep_past(I, M):
    """past = beta y_p + gamma y_t_p at the start of a step, of nodes and bodies."""
    own = own_header(I)
    run = own_scalars(M)
    beta = run.beta
    memory = run.memory
    for node in range(last_node(I) + 1):
        for k in range(RATES):
            at = RATES * node + k
            M[own.past + at] = beta * value(I, M, node, k) + memory * M[own.rate + at]
    for body in range(own.body_count):
        row = rigid_body_of(I, M, body)
        for k in range(BODY_STATES):
            row.past[k] = beta * row.state[k] + memory * row.state_rate[k]


@kernel
def set_rates(I, M):
    """Rates at the end of a step that has converged."""
    own = own_header(I)
    run = own_scalars(M)
    beta = run.beta
    for node in range(last_node(I) + 1):
        for k in range(RATES):
            at = RATES * node + k
            M[own.rate + at] = beta * value(I, M, node, k) - M[own.past + at]
    if own.body_count > 0:
        fill_system(I, M, 1)  # leaves the bodies' states at the converged values
        for body in range(own.body_count):
            row = rigid_body_of(I, M, body)
            for k in range(BODY_STATES):
                row.state_rate[k] = beta * row.state[k] - row.past[k]


@kernel
def forget(I, M):
    """All rates zero: a steady state."""
    own = own_header(I)
    for k in range(RATES * (last_node(I) + 1)):
        M[own.past + k] = 0.0
        M[own.rate + k] = 0.0
    for body in range(own.body_count):
        row = rigid_body_of(I, M, body)
        for k in range(BODY_STATES):
            row.past[k] = 0.0
            row.state_rate[k] = 0.0
