"""Rings along a line: what a jump of an acceleration starts, and steps that do not damp it.

A load rings on its wire when the acceleration of winch or vessel jumps. A long step damps that, and
the embedded solution with it, so that their difference tells nothing. But what a step makes of a
ring is known: R(i angle) instead of exp(i angle), R its scheme's stability function. That much of
the amplitude it misses, and such errors add up for as long as a ring lasts. The amplitude is what
the jump makes, then what a window of two turns finds in the tension beside a cubic of time: the
motion that waves or a vessel force on the line is that, and is none of the ring. One of less than
is allowed may be damped away at once: no more than all of it can be missed.

A body that comes out of waves, or goes in, is knocked, too. There steps listen for rings: what one
misses of a ring its embedded solution tells (`hearing.py`).

Every end that a vessel holds has a ring of its own, watched in the element next to it: that of a
bow (`bows.py`), or of what hangs there as on one end. What rings shakes all that hangs there: the
line that may least be wrong says what the ring may be.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.stabilisation import follow_third_mode
from cablemodel.solvers.finite_element.kernels.element.tables import (
    STAGE_A,
    STAGE_C,
    STAGES,
    WINDOW,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_state import rubs
from cablemodel.solvers.finite_element.kernels.time.bows import bow_mode
from cablemodel.solvers.finite_element.kernels.time.consistency import (
    jerk_jump,
    jump_along,
    motion_breaks,
)
from cablemodel.solvers.finite_element.kernels.time.solved_tension import (
    SHORT,
    SOLVED_A,
    STRAINED,
    may_be_solved_for,
    solve_for_tension,
)
from cablemodel.solvers.finite_element.kernels.time.tension import LOSS_FACTOR, dies_away, gives_way
from cablemodel.solvers.finite_element.kernels.time.watched_tension import (
    allowed_at,
    least_tolerance,
    watched_element,
)
from cablemodel.solvers.finite_element.kernels.time.waves import (
    MOST_LASTING,
    begin_wave,
    end_wave,
    error_of_turn,
    follow_wave,
    longest_wave_step,
    may_miss_waves,
    tree_of,
)
from cablemodel.solvers.shared.access import (
    body_of,
    closure_of,
    constraint_of,
    edge_of,
    free_body_of,
    header,
    scalars,
    spare_row,
    tension_of,
    trial_tension_of,
    winch_of,
)
from cablemodel.solvers.shared.compile import copy_words, inlined, kernel, outlined, view
from cablemodel.solvers.shared.layout import HELD_BY_ANCHOR, HELD_BY_FRAME, WHOLLY, AlongRows

ROW_DISPLACEMENTS, ROW_MASSES = AlongRows.displacements.word, AlongRows.masses.word
ROW_BEYOND, ROW_CLOSED = AlongRows.beyond.word, AlongRows.closed.word

SHARE_OF_RINGS = 0.4  # of the error of tension that a step may have: other errors add to it
SHARE_OF_WAVES = 0.6  # the same of waves: with a ring's all that a step may miss
LEFT_SLACK = 0.1  # of the pressure to which limp cable gives way: tension left by Newton's method
LEFT_TO_FRICTION = 0.1  # of the error of tension that a step may have: left by Newton's method
ROUNDED = 1e-13  # strain that rounding may change
WINDOW_TURN = 4.0 * math.pi  # of a window: two turns [rad]


@inlined
def allowed_of(I, M, row):
    """What may be missed of the tension that rings at a constraint [N]."""
    return row.ring_share * allowed_at(I, M, watched_element(I, row))


@kernel
def ring_allowed(I, M, row):
    """What may be missed of a ring that is followed, for as long as it lasts, and then the rest
    [N]. What begins with no more than all that a step may miss is not."""
    return SHARE_OF_RINGS * allowed_of(I, M, row)


@inlined
def waves_allowed(I, M, row):
    """What may be missed of waves at a constraint, of all together [N]."""
    return SHARE_OF_WAVES * allowed_of(I, M, row)


@kernel
def own_masses(I, M, own):
    """What bodies have at their nodes, with the water that they take along [kg], into the words at
    `own`, one a node."""
    head = header(I)
    for node in range(head.nodes):
        M[own + node] = 0.0
    for n in range(head.body_count):
        row = body_of(I, M, n)
        if row.node > 0.0:
            M[own + int(row.node)] += row.mass + row.added_mass_axial
    for n in range(head.free_count):
        row = free_body_of(I, M, n)
        water = (row.added[0] + row.added[7] + row.added[14]) / 3.0
        M[own + int(row.node)] += row.solid[0] + water


@kernel
def least_allowed(I, M, root, end):
    """The least that elements of a tree's nodes from `root` to `end` allow, over the sum of m s
    that swings beyond them: with displacements s and masses as `axial_mode` left them.

    Where lines close a cycle, others bear a part of that, as they do of its weight.
    """
    head = header(I)
    s = spare_row(I, ROW_DISPLACEMENTS)
    own = spare_row(I, ROW_MASSES)
    beyond = spare_row(I, ROW_BEYOND)
    closed = spare_row(I, ROW_CLOSED)
    for node in range(root, end):
        M[beyond + node] = M[own + node] * M[s + node]
        M[closed + node] = 0.0
    for n in range(head.closure_count):
        closure = closure_of(I, M, n)
        node = int(closure.node)
        if root <= node < end and closure.clamp == 0.0:
            M[closed + node] = 1.0
    least = 1e300
    for node in range(end - 1, root, -1):
        above = I[head.parent + node]
        swings = M[beyond + node]
        if I[head.joint + node] == 0:
            edge = edge_of(I, M, node)
            swings += edge.mass * edge.length * 0.5 * (M[s + above] + M[s + node])
            if swings > 0.0 and M[closed + node] == 0.0:
                least = min(least, allowed_at(I, M, node) / swings)
        M[beyond + above] += swings
        M[closed + above] += M[closed + node]
    return least


@kernel
def axial_mode(I, M, held):
    """Of the first motion along itself of all that hangs on a node that is held: frequency [rad/s],
    and the mass that moves with it when that node accelerates [kg].

    By Rayleigh's quotient, of displacements s as under the parts' own weights: the sum of m s over
    that of m s^2; of the mass the square of the sum of m s over that. Other ends that are held
    count as free: cables between them sag.

    And of what is allowed of its tension the part that the line has which it harms most.
    """
    head = header(I)
    nodes = head.nodes
    root, end = tree_of(I, held)
    s = spare_row(I, ROW_DISPLACEMENTS)
    own = spare_row(I, ROW_MASSES)
    beyond = spare_row(I, ROW_BEYOND)
    own_masses(I, M, own)
    copy_words(I, beyond, own, nodes)
    for node in range(end - 1, root, -1):
        hangs = M[beyond + node]
        if I[head.joint + node] == 0:
            edge = edge_of(I, M, node)
            hangs += edge.mass * edge.length
        M[beyond + I[head.parent + node]] += hangs
    for node in range(nodes):
        M[s + node] = 0.0
    for n in range(head.body_count):
        row = body_of(I, M, n)
        if row.node > 0.0:
            M[s + int(row.node)] = row.compliance
    moved = 0.0
    squares = 0.0
    for node in range(root + 1, end):
        above = M[s + I[head.parent + node]]
        carried = M[beyond + node]
        below = above + M[s + node] * carried
        if I[head.joint + node] == 0:
            edge = edge_of(I, M, node)
            mass = edge.mass * edge.length
            below += edge.compliance * edge.length * (carried + 0.5 * mass)
            moved += mass * 0.5 * (above + below)
            squares += mass * (above * above + above * below + below * below) / 3.0
        M[s + node] = below
        moved += M[own + node] * below
        squares += M[own + node] * below * below
    if not squares > 0.0:
        return 0.0, 0.0, 1.0
    share = 1.0
    if head.parts != 0:
        top = held + 1 if held == root else held
        share = min(share, least_allowed(I, M, root, end) * moved / allowed_at(I, M, top))
    return math.sqrt(moved / squares), moved * moved / squares, share


@kernel
def find_mode(I, M, row, jumps):
    """Write the mode of a bow into the row of an end, or else `axial_mode` of what hangs there,
    where the mesh is another one.

    With a winch it always is; in a system the share of what is allowed goes with the tensions; a
    bow's goes with the shape, wherever the end's motion jumps.
    """
    head = header(I)
    anew = scalars(M).modes_known == 0.0 or head.payout != 0 or head.parts != 0
    if anew or jumps:
        frequency, mass, share = bow_mode(I, M, int(row.node), watched_element(I, row))
        anew = anew or row.bow != 0.0
        row.bow = 1.0 if frequency > 0.0 else 0.0
        if row.bow == 0.0 and anew:
            frequency, mass, share = axial_mode(I, M, int(row.node))
        if row.bow != 0.0 or anew:
            row.mode_frequency, row.mode_mass, row.ring_share = frequency, mass, share


@kernel
def begin_window(I, M, row, t, tension):
    """Begin to measure a ring, at time t and that tension."""
    find_mode(I, M, row, True)
    row.ring_since = t
    row.ring_about = tension
    row.ring_cosine = 0.0
    row.ring_sine = 0.0
    row.ring_frequency = row.mode_frequency


@kernel
def jumps_at(I, M, row):
    """Jumps of velocity [m/s], acceleration [m/s2] and jerk [m/s3] along the line at an end that is
    held, as a step begins."""
    faster = 0.0
    jump = 0.0
    jerk = 0.0
    breaks = motion_breaks(I, M, row)
    if breaks or header(I).live != 0 or row.kind == HELD_BY_FRAME:
        faster, jump = jump_along(I, M, row)
    if breaks:
        jerk = jerk_jump(I, M, row)
    for n in range(header(I).winch_count):
        winch = winch_of(I, M, n)
        if winch.node == row.node:
            jump += abs(winch.acceleration_jump)
    return faster, jump, jerk


@outlined
def largest_jump(I, M):
    """The largest jump of an acceleration along a line at its ends [m/s2], as a step begins."""
    largest = 0.0
    for n in range(header(I).constraint_count):
        row = constraint_of(I, M, n)
        if row.kind != HELD_BY_ANCHOR:
            _faster, jump, _jerk = jumps_at(I, M, row)
            largest = max(largest, jump)
    return largest


@kernel
def begin_rings(I, M, dt):
    """As a step of dt begins: the tension with which a line would not ring jumps with an
    acceleration, and it rings about that; so its velocity about one that jumps, and the tension's
    rate about that of a jerk."""
    head = header(I)
    state = scalars(M)
    if dies_away(M):
        return
    state.heard = 0.0
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.kind == HELD_BY_ANCHOR or row.clamped == WHOLLY:
            continue
        faster, jump, jerk = jumps_at(I, M, row)
        top = watched_element(I, row)
        find_mode(I, M, row, faster + jump + jerk > 0.0)
        frequency = row.mode_frequency
        moved = row.mode_mass
        allowed = allowed_of(I, M, row)
        if moved == 0.0:
            continue
        taut = tension_of(I, M, top).mean  # by more it does not ring: it goes slack
        if state.heard == 0.0 or allowed / moved < state.heard:
            state.heard = allowed / moved
            state.heard_most = taut / moved
            state.heard_frequency = frequency
        begin_wave(I, M, row, jump, waves_allowed(I, M, row))
        of_jerk = moved * jerk / frequency
        if of_jerk > taut:
            of_jerk = 0.0
        most = max(taut, row.ring)
        made = min(moved * (jump + frequency * faster), most)
        if made + of_jerk <= allowed:
            continue
        made = min(made + row.ring, most)
        count = 2 * head.dimension * head.nodes
        if faster == 0.0 and may_be_solved_for(I, M):
            copy_words(I, spare_row(I, SOLVED_A), head.acceleration, count)
            copy_words(I, spare_row(I, STRAINED), head.tension_rate, 2 * head.nodes)
            tension = view(M, head.tension, 2 * head.nodes)
            q = view(M, head.position, count)
            v = view(M, head.velocity, count)
            now = state.time + state.smallest_step  # of the pieces of motion that begin there
            change, _moving = solve_for_tension(I, M, now, SHORT * dt, q, v, tension)
            if change >= 0.0:
                made = min(made, math.hypot(row.ring, change * allowed))
        if row.ring == 0.0:
            if made + of_jerk <= allowed:
                continue
            head.rings += 1
        row.ring_lasts = 0.0
        row.ring = made + of_jerk
        begin_window(I, M, row, state.time, tension_of(I, M, top).mean)
    if head.rings + head.axial_waves != 0:
        follow_third_mode(I, M, 0.0)
    state.modes_known = 1.0


@kernel
def add_to_window(row, y, weight, tension):
    """A tension at that place in the window, for a stretch of it of that weight [rad]."""
    seen = 0.5 * (1.0 + math.cos(0.5 * y)) if abs(y) < 2.0 * math.pi else 0.0
    of_it = weight * seen * (tension - row.ring_about)
    even = WINDOW[0, 0] * math.cos(y) + WINDOW[0, 1] + WINDOW[0, 2] * y * y
    odd = WINDOW[1, 0] * math.sin(y) + WINDOW[1, 1] * y + WINDOW[1, 2] * y * y * y
    row.ring_cosine += of_it * even
    row.ring_sine += of_it * odd


@kernel
def measure_ring(row, found):
    """At a window's end: amplitude and how long the ring lasts, by what it has lost of that which
    the window before has found. What a jump makes is no more than a bound."""
    lasts = MOST_LASTING
    if row.ring_lasts > 0.0 and found < row.ring:
        lasts = min(lasts, WINDOW_TURN / math.log(row.ring / found))
    row.ring_lasts = lasts
    row.ring = min(row.ring, found)


@kernel
def begin_heard(I, M, dt, scheme):
    """Follow from the trial on the rings that a step of dt has heard, if it should not have missed
    what it has: what ends of lines do is not all that shakes them."""
    head = header(I)
    head.heard = 0
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        missed = row.ring_missed
        row.ring_missed = 0.0
        if missed == 0.0 or row.ring > 0.0:
            continue
        find_mode(I, M, row, True)
        angle = row.mode_frequency * dt
        if angle == 0.0:
            continue
        top = watched_element(I, row)
        after = trial_tension_of(I, M, top).mean
        made = min(missed / error_of_turn(scheme, angle), after)
        if made <= allowed_of(I, M, row):
            continue  # no more than all of it can be missed
        if missed_of_ring(made / ring_allowed(I, M, row), 0.0, scheme, angle) > 1.0:
            head.rings += 1
            row.ring = made
            row.ring_lasts = 0.0
            begin_window(I, M, row, scalars(M).time + dt, after)


@kernel
def follow_rings(I, M, dt, scheme):
    """Measure rings in a step from the state to the trial, by a scheme of STAGES; -1: two-step.

    At a window's end there is no more of one than that finds.
    """
    head = header(I)
    state = scalars(M)
    if head.rings + head.axial_waves + head.heard == 0:
        return
    end_here = False
    if head.axial_waves != 0:
        end_here = gives_way(I, M, view(M, head.trial_tension, 2 * head.nodes))
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if end_here:
            end_wave(I, M, row)
        if row.wave > 0.0:
            follow_wave(I, M, row, dt, waves_allowed(I, M, row))
        if row.ring == 0.0:
            continue
        top = watched_element(I, row)
        angle = row.ring_frequency * dt
        y = row.ring_frequency * (state.time - row.ring_since) - 2.0 * math.pi
        before = tension_of(I, M, top).mean
        after = trial_tension_of(I, M, top).mean
        if scheme < 0:
            add_to_window(row, y, 0.5 * angle, before)
            add_to_window(row, y + angle, 0.5 * angle, after)
        else:
            last = STAGES[scheme] - 1
            add_to_window(row, y, STAGE_A[scheme, last, 0] * angle, before)
            for i in range(1, last + 1):
                at = y + STAGE_C[scheme, i] * angle
                share = STAGE_A[scheme, last, i] * angle
                add_to_window(row, at, share, M[head.stage_tensions + 6 * top + i - 1])
        if y + angle >= 2.0 * math.pi:
            measure_ring(row, math.hypot(row.ring_cosine, row.ring_sine))
            if row.ring <= ring_allowed(I, M, row):
                row.ring = 0.0
                head.rings -= 1
            begin_window(I, M, row, state.time + dt, after)
    if head.heard != 0:
        begin_heard(I, M, dt, scheme)


@kernel
def missed_of_ring(amplitude, lasts, scheme, angle):
    """What a step in which a ring of that amplitude [tolerances] turns by that angle misses of it,
    over what it may add [-].

    That is a share of the tolerance, as the ring lasts [rad]; 0: not known yet, then as a cable's
    material has it.
    """
    missed = error_of_turn(scheme, angle)
    if lasts == 0.0:
        lasts = 2.0 / LOSS_FACTOR
    return amplitude * missed * max(lasts / angle, 1.0)


@kernel
def left_in_tensions(I, M, dt):
    """What Newton's method may leave in tensions in a step of dt [N]: elsewhere the next step
    forgets it, but rings keep it, and friction, from whose bristles it works cable loose."""
    head = header(I)
    least = math.inf
    if scalars(M).yields > 0.0:
        least = LEFT_SLACK * scalars(M).yields
    if rubs(I, M):
        least = min(least, LEFT_TO_FRICTION * least_tolerance(I, M))
    if head.rings + head.axial_waves == 0:
        return least
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.ring > 0.0:
            top = watched_element(I, row)
            lasts = row.ring_lasts if row.ring_lasts > 0.0 else 2.0 / LOSS_FACTOR
            share = ring_allowed(I, M, row) * row.ring_frequency * dt / lasts
            least = min(least, max(share, ROUNDED / edge_of(I, M, top).compliance))
        if row.wave > 0.0:
            top = watched_element(I, row)
            share = waves_allowed(I, M, row) * row.wave_frequency * dt / MOST_LASTING
            least = min(least, max(share, ROUNDED / edge_of(I, M, top).compliance))
    return least


@kernel
def may_miss_rings(I, M, dt, scheme):
    """Whether a step of dt may miss what it does of what rings."""
    head = header(I)
    if head.rings + head.axial_waves == 0:
        return True
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if not may_miss_waves(I, M, row, dt, scheme, waves_allowed(I, M, row)):
            return False
        if row.ring > 0.0:
            amplitude = row.ring / ring_allowed(I, M, row)
            angle = row.ring_frequency * dt
            if missed_of_ring(amplitude, row.ring_lasts, scheme, angle) > 1.0:
                return False
    return True


@kernel
def longest_ring_step(I, M, dt, scheme):
    """A step of at most dt that follows what rings: a whole part of a turn, so that it changes
    seldom. What it misses goes with the angle to the power of the scheme's order."""
    head = header(I)
    if head.rings + head.axial_waves == 0:
        return dt
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.wave > 0.0:
            dt = longest_wave_step(I, M, row, dt, scheme, waves_allowed(I, M, row))
        if row.ring == 0.0:
            continue
        amplitude = row.ring / ring_allowed(I, M, row)
        lasts = row.ring_lasts
        if not missed_of_ring(amplitude, lasts, scheme, row.ring_frequency * dt) > 1.0:
            continue
        parts = 2.0
        missed = missed_of_ring(amplitude, lasts, scheme, math.pi)
        while missed > 1.0:
            parts = math.floor(parts * missed ** (1.0 / (3 + scheme))) + 1.0
            missed = missed_of_ring(amplitude, lasts, scheme, 2.0 * math.pi / parts)
        longest = 2.0 * math.pi / (parts * row.ring_frequency)
        if 0.0 < longest and longest < dt:
            dt = longest
    return dt
