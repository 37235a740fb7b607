"""Newton-Raphson on field and boundary equations at one time level (section 5)."""

from cablemodel.kernels.access import header
from cablemodel.kernels.layout import (
    NOT_CONVERGED,
    OK,
)

from .assembly import fill_system, set_strains, unknowns
from .compile import kernel
from .elimination import eliminate
from .geometry import gap, gap_change, set_flow, set_places
from .layout import (
    D_END,
    D_METHOD,
    D_RIGHT_SIDES,
    D_SECTIONS,
    ELIMINATION,
    END_CONTACT,
    END_TOUCHDOWN,
    F3,
    K1,
    K2,
    N_COUNT,
    N_FIRST,
    N_KIND,
    O_DELTA,
    O_RHS,
    O_SECTION,
    O_SHAPE,
    O_SWEEP,
    O_Y,
    PHI,
    RHS_WORDS,
    SECTION_WORDS,
    SHAPE_WORDS,
    THETA,
    V3,
    WIDTH,
    X_FLOW_END,
    X_REACTION,
    X_SCALE,
    X_TOLERANCE,
)
from .superposition import superpose

MOST_ITERATIONS = 10
LARGEST_TURN = 0.7
"""An iteration that would turn the cable by more is shortened [rad]."""
ROUND_OFF = 1e-6
"""Relative changes below this may be round-off."""


@kernel
def solve_linear(I, M, slots):
    """Changes of all unknowns (over their scales) by the chosen method."""
    head = header(I)
    head.factorisations += 1
    if I[D_METHOD] == ELIMINATION:
        return eliminate(I, M, slots, I[O_SWEEP])
    return superpose(I, M, slots, I[O_SWEEP])


@kernel
def spread(I, M):
    """Changes from the packed unknowns of each node to all ten, in their own units."""
    for index in range(I[D_SECTIONS]):
        section = I[O_SECTION] + SECTION_WORDS * index
        active = unknowns(I, I[section + N_KIND])
        first = I[section + N_FIRST]
        for node in range(first, first + I[section + N_COUNT]):
            for side in range(I[D_RIGHT_SIDES]):
                at = I[O_DELTA] + 2 * WIDTH * node + WIDTH * side
                packed = 0
                for j in range(WIDTH):
                    packed += (active >> j) & 1
                for j in range(WIDTH - 1, -1, -1):
                    if (active >> j) & 1:
                        packed -= 1
                        M[at + j] = M[at + packed] * M[X_SCALE + j]
                    else:
                        M[at + j] = 0.0


@kernel
def parameter_side(I, M, slots):
    """Second right-hand side where the line ends on the floor: minus the derivative of the residual
    by the flow past the touchdown point, or by the reaction of the floor."""
    word = X_FLOW_END if I[D_END] == END_TOUCHDOWN else X_REACTION
    kept = M[word]
    step = 1e-6 * max(abs(kept), M[X_SCALE] if word == X_FLOW_END else M[X_SCALE + F3])
    M[word] = kept + step
    set_flow(I, M)
    fill_system(I, M, 1)
    M[word] = kept
    set_flow(I, M)
    for slot in range(slots):
        at = I[O_RHS] + RHS_WORDS * slot
        for i in range(I[I[O_SHAPE] + SHAPE_WORDS * slot]):
            M[at + WIDTH + i] = (M[at + WIDTH + i] - M[at + i]) / step
    return word


@kernel
def solve_level(I, M):
    """Iterate until the largest change is within the relative tolerance. Returns the status.

    Velocities are measured by the largest of them, forces likewise, angles by a radian; each by at
    least its own scale.
    """
    head = header(I)
    floor = I[D_END] == END_CONTACT or I[D_END] == END_TOUCHDOWN
    I[D_RIGHT_SIDES] = 2 if floor else 1
    sides = I[D_RIGHT_SIDES]
    set_flow(I, M)
    previous = 1e300
    for _iteration in range(MOST_ITERATIONS):
        head.iterations += 1
        set_strains(I, M)
        set_places(I, M)
        slots = fill_system(I, M, 0)
        word = 0
        if floor:
            word = parameter_side(I, M, slots)
        status = solve_linear(I, M, slots)
        if status != OK:
            return status
        spread(I, M)
        change = 0.0
        if floor:
            by_side = gap_change(I, M, 1, 1 if word == X_FLOW_END else 0)
            change = -(gap(I, M) + gap_change(I, M, 0, 0)) / by_side
        largest_v = M[X_SCALE]
        largest_f = M[X_SCALE + F3]
        largest_k = M[X_SCALE + K2]
        dv = 0.0
        df = 0.0
        dk = 0.0
        turn = 0.0
        place = 0
        total = slots - 1
        for node in range(total):
            at = I[O_DELTA] + 2 * WIDTH * node
            y = I[O_Y] + WIDTH * node
            for j in range(WIDTH):
                if sides == 2:
                    M[at + j] += change * M[at + WIDTH + j]
                size = abs(M[y + j])
                delta = abs(M[at + j])
                if not delta < 1e200:
                    I[head.failed] = node
                    return NOT_CONVERGED
                if j <= V3:
                    largest_v = max(largest_v, size)
                    dv = max(dv, delta)
                elif j == PHI or j == THETA:
                    if delta > turn:
                        turn = delta
                        place = node
                elif j < K1:
                    largest_f = max(largest_f, size)
                    df = max(df, delta)
                else:
                    largest_k = max(largest_k, size)
                    dk = max(dk, delta)
        I[head.failed] = place
        factor = 1.0
        if turn > LARGEST_TURN:
            factor = LARGEST_TURN / turn
        for node in range(total):
            at = I[O_DELTA] + 2 * WIDTH * node
            y = I[O_Y] + WIDTH * node
            for j in range(WIDTH):
                M[y + j] += factor * M[at + j]
        error = max(max(dv / largest_v, df / largest_f), max(turn, dk / largest_k))
        if floor:
            M[word] += factor * change
            if word == X_REACTION:
                error = max(error, abs(change) / largest_f)
            else:
                error = max(error, abs(change) / largest_v)
        set_flow(I, M)
        # Where round-off keeps a change from shrinking further, it has converged too.
        stalled = error <= ROUND_OFF and error > 0.25 * previous
        previous = error
        if factor == 1.0 and (error <= M[X_TOLERANCE] or stalled):
            set_strains(I, M)
            set_places(I, M)
            return OK
    return NOT_CONVERGED
