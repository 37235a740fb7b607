"""Newton-Raphson on field and boundary equations at one time level (section 5)."""

from cablemodel.solvers.shared.access import header
from cablemodel.solvers.shared.compile import view
from cablemodel.solvers.shared.layout import (
    NOT_CONVERGED,
    OK,
)

from .access import own_header, own_scalars, section_of, shape_of, sides_of
from .assembly import fill_system, set_strains, unknowns
from .compile import kernel
from .elimination import eliminate
from .geometry import gap, gap_change, set_flow, set_places
from .layout import (
    ELIMINATION,
    END_CONTACT,
    END_TOUCHDOWN,
    F3,
    K1,
    K2,
    PHI,
    THETA,
    V3,
    WIDTH,
)
from .superposition import superpose

DIRECT_MOST_ITERATIONS = 10
DIRECT_LARGEST_TURN = 0.7
"""An iteration that would turn the cable by more is shortened [rad]."""
DIRECT_ROUND_OFF = 1e-6
"""Relative changes below this may be round-off."""


@kernel
def solve_linear(I, M, slots):
    """Changes of all unknowns (over their scales) by the chosen method."""
    own = own_header(I)
    head = header(I)
    head.factorisations += 1
    if own.method == ELIMINATION:
        return eliminate(I, M, slots)
    return superpose(I, M, slots)


@kernel
def spread(I, M):
    """Changes from the packed unknowns of each node to all ten, in their own units."""
    own = own_header(I)
    run = own_scalars(M)
    for index in range(own.section_count):
        section = section_of(I, M, index)
        active = unknowns(I, section.kind)
        first = section.first
        for node in range(first, first + section.count):
            for side in range(own.right_sides):
                change = view(M, own.delta + WIDTH * (2 * node + side), WIDTH)
                packed = 0
                for j in range(WIDTH):
                    packed += (active >> j) & 1
                for j in range(WIDTH - 1, -1, -1):
                    if (active >> j) & 1:
                        packed -= 1
                        change[j] = change[packed] * run.scale[j]
                    else:
                        change[j] = 0.0


@kernel
def set_parameter(M, flows, value):
    """The flow past the touchdown point, or the reaction of the floor."""
    run = own_scalars(M)
    if flows:
        run.flow_end = value
    else:
        run.reaction = value


@kernel
def parameter_side(I, M, slots):
    """Second right-hand side where the line ends on the floor: minus the derivative of the residual
    by the flow past the touchdown point, or by the reaction of the floor. Returns whether it is by
    the flow."""
    own = own_header(I)
    run = own_scalars(M)
    flows = own.end == END_TOUCHDOWN
    kept = run.flow_end if flows else run.reaction
    step = 1e-6 * max(abs(kept), run.scale[0] if flows else run.scale[F3])
    set_parameter(M, flows, kept + step)
    set_flow(I, M)
    fill_system(I, M, 1)
    set_parameter(M, flows, kept)
    set_flow(I, M)
    for slot in range(slots):
        sides = sides_of(I, M, slot).sides
        for i in range(shape_of(I, M, slot).rows):
            sides[WIDTH + i] = (sides[WIDTH + i] - sides[i]) / step
    return flows


@kernel
def solve_level(I, M):
    """Iterate until the largest change is within the relative tolerance. Returns the status.

    Velocities are measured by the largest of them, forces likewise, angles by a radian; each by at
    least its own scale.
    """
    own = own_header(I)
    run = own_scalars(M)
    head = header(I)
    floor = own.end == END_CONTACT or own.end == END_TOUCHDOWN
    own.right_sides = 2 if floor else 1
    sides = own.right_sides
    set_flow(I, M)
    previous = 1e300
    for _iteration in range(DIRECT_MOST_ITERATIONS):
        head.iterations += 1
        set_strains(I, M)
        set_places(I, M)
        slots = fill_system(I, M, 0)
        flows = False
        if floor:
            flows = parameter_side(I, M, slots)
        status = solve_linear(I, M, slots)
        if status != OK:
            return status
        spread(I, M)
        change = 0.0
        if floor:
            by_side = gap_change(I, M, 1, 1 if flows else 0)
            change = -(gap(I, M) + gap_change(I, M, 0, 0)) / by_side
        largest_v = run.scale[0]
        largest_f = run.scale[F3]
        largest_k = run.scale[K2]
        dv = 0.0
        df = 0.0
        dk = 0.0
        turn = 0.0
        place = 0
        total = slots - 1
        for node in range(total):
            deltas = view(M, own.delta + 2 * WIDTH * node, 2 * WIDTH)
            y = view(M, own.unknowns + WIDTH * node, WIDTH)
            for j in range(WIDTH):
                if sides == 2:
                    deltas[j] += change * deltas[WIDTH + j]
                size = abs(y[j])
                delta = abs(deltas[j])
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
        if turn > DIRECT_LARGEST_TURN:
            factor = DIRECT_LARGEST_TURN / turn
        for node in range(total):
            deltas = view(M, own.delta + 2 * WIDTH * node, 2 * WIDTH)
            y = view(M, own.unknowns + WIDTH * node, WIDTH)
            for j in range(WIDTH):
                y[j] += factor * deltas[j]
        error = max(max(dv / largest_v, df / largest_f), max(turn, dk / largest_k))
        if floor:
            if flows:
                run.flow_end += factor * change
                error = max(error, abs(change) / largest_v)
            else:
                run.reaction += factor * change
                error = max(error, abs(change) / largest_f)
        set_flow(I, M)
        # Where round-off keeps a change from shrinking further, it has converged too.
        stalled = error <= DIRECT_ROUND_OFF and error > 0.25 * previous
        previous = error
        if factor == 1.0 and (error <= run.tolerance or stalled):
            set_strains(I, M)
            set_places(I, M)
            return OK
    return NOT_CONVERGED
