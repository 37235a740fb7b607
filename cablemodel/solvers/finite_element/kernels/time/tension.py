"""The tension of a step: how wrong it is.

Tension follows the line's stretch. Where steps resolve the motion along the line, an error of that
motion is one of the tension, and adds up from step to step. Where the line is too stiff for its
steps, the tension holds it at its length: a step finds it from differences of positions, of order 2
only, but what is wrong there is forgotten by the next step (`embedded_tension.py` tells one from
the other). Where that is too large, tensions are solved for (`solved_tension.py`).
"""

import math

from cablemodel.solvers.finite_element.kernels.element.strain import folds
from cablemodel.solvers.finite_element.kernels.element.tables import GAMMA, UNDERRATED
from cablemodel.solvers.finite_element.kernels.floor.floor_state import rubs
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import lowest_gap
from cablemodel.solvers.finite_element.kernels.line.system import remembers
from cablemodel.solvers.finite_element.kernels.mesh.touchdown_mesh import begins_anew
from cablemodel.solvers.finite_element.kernels.time.embedded_tension import (
    ROW_LEFT,
    embedded_error,
    filter_motion,
    find_embedded_errors,
    stage_scatter,
)
from cablemodel.solvers.finite_element.kernels.time.hearing import STIFF, hear, hears
from cablemodel.solvers.finite_element.kernels.time.solved_tension import (
    SOLVED_FROM,
    begins_smoothly,
    bend_of_tension,
    rings,
    solve_at_end,
    solves,
)
from cablemodel.solvers.finite_element.kernels.time.watched_tension import (
    allowed_at,
    is_watched,
    watched,
)
from cablemodel.solvers.shared.access import (
    edge_of,
    header,
    scalars,
    spare_row,
    tension_of,
    tension_rate_of,
    trial_tension_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel, outlined, view

TENSION_SHARE = 0.045  # of the error allowed: what a step may add to one that lasts
SHARE_OF_LIMITED = 0.03  # the same where the caller makes steps short
LOSS_FACTOR = 0.01  # of a cable's material: 2 / (it w) is the time in which a ring of w dies away
TENSION_FINEST = 0.1  # step times the frequency of the axial motion: one that follows for sure
TENSION_UNSEEN = 0.05  # of the error allowed: scatter of stages below which none is looked at
TENSION_NEARLY = 0.5  # of the longest step not looked at: its tensions say how long the next is
TENSION_STAYS = 0.5  # error of a step after which the next one is as long
# What a step does along the line; in a system, where it is refused: that no other one than its
# tensions' error is too large.
PASSES_OVER, FOLLOWS, SOLVED, MISSES = 0, 1, 2, 3
SHARE_RESOLVED = 1e-6  # of an embedded error: what lasts of it at least


@kernel
def share_of_ring(M, dt, scheme, share):
    """Of what is allowed, what a step's embedded error may be of a tension that rings, in a system
    without winches: elements that pass one make rings of their own, which steps had better damp.

    share: what of that error lasts, 1 / (1 + (w gamma dt)^2), which tells the angle w dt. Errors
    of a ring add up for 2 / LOSS_FACTOR radians, and are larger than the embedded one by
    `UNDERRATED` times the angle. What its material ends before a line has moved is left to steps.
    """
    angle = math.sqrt(max(0.0, 1.0 / max(share, SHARE_RESOLVED) - 1.0)) / GAMMA[scheme]
    if 0.5 * LOSS_FACTOR * angle * scalars(M).period > dt:
        return TENSION_SHARE
    angle = max(angle, TENSION_FINEST)
    return 0.5 * LOSS_FACTOR * angle / max(1.0, UNDERRATED[scheme] * angle)


@kernel
def is_slack(I, M, first):
    """Whether the line of a system that begins above a node is slack in a step: pressed somewhere
    by more than its tensions may be wrong by, or nowhere carries more than that.

    Cable bends aside where it is pressed, and waves along it end there: nothing rings on for as
    long as a material lets it.
    """
    head = header(I)
    least = 0.0
    largest = 0.0
    allowed = 0.0
    for node in range(first, head.nodes):
        if node > first and begins_anew(I, node):
            break
        if I[head.joint + node] != 0:
            continue
        allowed = allowed_at(I, M, node)
        for n in range(2):
            tension = M[(head.tension if n == 0 else head.trial_tension) + 2 * node]
            least = min(least, tension)
            largest = max(largest, tension)
    return least < -allowed or largest < allowed


@inlined
def longest_unwatched(M):
    """Below this step what one does not follow dies away by the material before a line has moved
    [s]: what turns by `TENSION_FINEST` in the step and more."""
    return TENSION_FINEST * 0.5 * LOSS_FACTOR * scalars(M).period


@inlined
def dies_within(M, dt):
    """Whether a step is so short."""
    return dt < longest_unwatched(M)


@inlined
def is_over_at_once(I, M, dt):
    """Whether a step of dt need not look at tensions: of one line as it follows all, of a system as
    what it does not follow dies away."""
    if header(I).parts != 0:
        return dies_within(M, dt)
    return dt * math.sqrt(scalars(M).axial) < TENSION_FINEST


@inlined
def phase_missed(change, off):
    """What two-step steps miss of a tension that rings, until its material ends the ring [N].

    change: of the tension in the step; off: what the prediction missed of it. Of a ring a at the
    angle x = w dt they are a x and a x^3 / 2, a quarter of a turn from its peaks both, and a step
    is late by a x^3 / 3: after 2 / LOSS_FACTOR radians by a x^2 / 3 for each, and never by more
    than 2 a. Where x is not small the line is too stiff for the step to follow.
    """
    if off == 0.0 or 2.0 * off > change:
        return 0.0
    turn = math.sqrt(2.0 * off / change)
    late = 2.0 / LOSS_FACTOR / 3.0 * change * turn
    return min(late, 2.0 * change / turn)


@kernel
def two_step_error(I, M, dt):
    """Error of the watched tensions of a two-step step [tolerances], and what it does along the
    line.

    Where the line is too stiff for it to follow, dt^2 T'' at most, by which the prediction from
    the last step's rate is off; else half of what the predicted positions stretch it by more or
    less, which lasts. In a system what lasts may ring (`phase_missed`).
    """
    head = header(I)
    if is_over_at_once(I, M, dt):
        return 0.0, FOLLOWS
    worst = 0.0
    along = PASSES_OVER
    for node in range(1, watched(I)):
        if not is_watched(I, node):
            continue
        final = trial_tension_of(I, M, node).mean
        predicted = tension_of(I, M, node).mean + dt * tension_rate_of(I, M, node).mean
        first = M[head.stage_tensions + 6 * node]
        lasting = 0.5 * abs(final - first) / SHARE_OF_LIMITED
        passed_over = abs(final - predicted)
        if not passed_over < lasting:
            along = FOLLOWS
        missed = min(passed_over, lasting)
        if head.parts != 0:
            change = abs(final - tension_of(I, M, node).mean)
            missed = max(missed, phase_missed(change, abs(final - first)))
        worst = max(worst, missed / allowed_at(I, M, node))
    if hears(I, M):
        hear(I, M, -1)
    return worst, along


@kernel
def gives_way(I, M, tension):
    """Whether flexible cable bends aside within an element under these tensions: waves along it
    end there, and nothing rings on."""
    head = header(I)
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            if folds(M, edge_of(I, M, node), tension[2 * node], tension[2 * node + 1]):
                return True
    return False


@kernel
def dies_away(M):
    """Whether what rings along the line is over before the line has moved, by its material."""
    state = scalars(M)
    return state.axial * state.period * state.period > (2.0 / LOSS_FACTOR) ** 2


@outlined
def error_kept(I, M, error, gamma_dt):
    """Error of a step's tensions [tolerances], where cable rubs: along what lies friction keeps it,
    and it may be no more than what lasts elsewhere.

    error: of the positions, (nodes, 2, dimension) [m]; it is overwritten.
    """
    head = header(I)
    filter_motion(I, M, error, gamma_dt)
    left_in = spare_row(I, ROW_LEFT)
    q = view(M, head.trial_position, 2 * head.dimension * head.nodes)
    depth = scalars(M).floor_depth
    worst = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        missed = abs(M[left_in + 2 * node]) / allowed_at(I, M, node)
        if TENSION_SHARE * worst < missed and lowest_gap(I, M, q, node) < depth:
            missed /= TENSION_SHARE
        worst = max(worst, missed)
    return worst


@kernel
def tension_error(I, M, dt, scheme, gamma_dt, error, of_positions):
    """Error of the watched tensions of a step from the state to the trial [tolerances], and what
    the step does along the line: PASSES_OVER, FOLLOWS, or SOLVED, for which see `take_solved`.
    Nothing is solved for in a system.

    error: of the positions, (nodes, 2, dimension) [m]. of_positions: that over what is allowed;
    what is no more than that is not told exactly.
    """
    head = header(I)
    state = scalars(M)
    at_once = is_over_at_once(I, M, dt)
    if at_once and (head.parts == 0 or dt < TENSION_NEARLY * longest_unwatched(M)):
        return 0.0, FOLLOWS
    if rubs(I, M):
        return error_kept(I, M, error, gamma_dt), PASSES_OVER
    scatter = 0.0
    for node in range(1, watched(I)):
        if is_watched(I, node):
            scatter = max(scatter, stage_scatter(I, M, node, scheme))
    if scatter <= TENSION_UNSEEN:
        return scatter, PASSES_OVER
    if head.parts == 0:
        if gives_way(I, M, view(M, head.trial_tension, 2 * head.nodes)):
            return 0.0, FOLLOWS
    if head.parts == 0 and dies_away(M):
        return 0.0, SOLVED if solves(I, M, dt, scatter) else PASSES_OVER
    follows = head.rings + head.axial_waves != 0
    follows = follows or bend_of_tension(I, M, dt) / (state.axial * dt * dt) > SOLVED_FROM
    bound = -1.0
    if head.parts == 0 and scatter <= of_positions and not remembers(I):
        if follows or (head.settled == 0 and scatter <= SOLVED_FROM):
            bound = TENSION_SHARE * of_positions
    if find_embedded_errors(I, M, error, gamma_dt, bound):
        return of_positions, FOLLOWS if follows else PASSES_OVER
    share = 0.0
    lasting = 0.0
    forgotten = 0.0
    rings_on = False
    for node in range(1, watched(I)):
        if head.parts != 0 and head.payout == 0 and (node == 1 or begins_anew(I, node)):
            rings_on = not is_slack(I, M, node)
        if is_watched(I, node):
            scatter = stage_scatter(I, M, node, scheme) if head.parts != 0 else scatter
            left, share = embedded_error(I, M, node, scatter)
            part = share_of_ring(M, dt, scheme, share) if rings_on else TENSION_SHARE
            lasting = max(lasting, left * share * share / part)
            forgotten = max(forgotten, (1.0 - share * share) * scatter)
    if hears(I, M):
        hear(I, M, scheme)
    if head.parts != 0:
        missed = max(lasting, forgotten)
        if at_once:
            return min(TENSION_STAYS, missed), FOLLOWS
        return missed, MISSES if missed > 1.0 else PASSES_OVER
    if share > STIFF or follows:
        return max(lasting, forgotten), FOLLOWS
    settled = head.settled != 0 and begins_smoothly(I, M)
    if (settled or forgotten > SOLVED_FROM) and lasting <= 1.0 and solves(I, M, dt, scatter):
        if settled:
            return lasting, SOLVED
        if not rings(I, M, dt):
            solve_at_end(I, M, dt)
            return lasting, SOLVED
    return max(lasting, forgotten), PASSES_OVER
