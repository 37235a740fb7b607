"""Waves along a line: what a jump of an acceleration sends along it, and what follows them.

An end that is held begins to accelerate by a, and tension runs along the line as a wave of sound,
to and fro. Of waves w = k pi / t, t the time in which sound runs along the line, its tension has
the amplitude 2 a Z / (t w^2), Z = sqrt(EA m), whatever hangs there: that of a bar whose upper end
is moved, a first wave and its overtones 1 / k^2. The load itself rings more slowly (`rings.py`).
Long steps and long elements end such waves as they end a ring, unseen by the embedded solution.

So what they miss is summed over the overtones: each by the scheme's stability function and by the
frequency that elements give it, for as long as it lasts, and by no more than all of it. What is
allowed of that sum is what one step may miss, or as much as is missed of overtones beyond the
last: else steps and elements are shorter. The first wave's amplitude is what jumps make, then what
a window of one turn finds at most in the speeds by which the line is stretched, beside the linear
ones of a load that rings.

Between winch and load alone is that their spectrum: what hangs between throws waves back. Where
cable is pressed it bends aside, and waves along it end; so they do where something comes to a
floor. Those that nothing has ended after MOST_LASTING are left to the steps.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.stabilisation import soften
from cablemodel.solvers.finite_element.kernels.element.tables import GAMMA, NUMERATOR, STAGES
from cablemodel.solvers.finite_element.kernels.time.tension import LOSS_FACTOR
from cablemodel.solvers.finite_element.kernels.time.watched_tension import is_root, watched_element
from cablemodel.solvers.shared.access import (
    body_of,
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
from cablemodel.solvers.shared.compile import inlined, kernel
from cablemodel.solvers.shared.layout import FLOOR_TOUCHED, AlongRows

ROW_TIMES, ROW_SPEEDS = AlongRows.times.word, AlongRows.speeds.word

MOST_LASTING = 2000.0  # rad: longest that a ring, or a first wave, is taken to last
OVERTONES = 32  # most that are followed
ALL_WAVES = math.pi * math.pi / 6.0  # of the first wave's amplitude: that of all together
ELEMENT_DISPERSION = 1e-5  # of a wave's frequency: what elements are off by, over (w t)^6 of each
TURN_FINER = 1.1  # least by which a turn is divided further


@kernel
def tree_of(I, node):
    """The root of the tree that a node belongs to, and the node beyond its last."""
    head = header(I)
    root = node
    while not is_root(I, root):
        root = I[head.parent + root]
    end = root + 1
    while end < head.nodes and not is_root(I, end):
        end += 1
    return root, end


@kernel
def error_of_turn(scheme, angle):
    """By how much a step in which something turns by that angle [rad] misses it, of its amplitude:
    by how much the scheme's stability function R(i angle) differs from exp(i angle). Of the
    two-step scheme, -1, a third of the angle's cube."""
    if scheme < 0:
        return angle * angle * angle / 3.0
    real, imaginary = 0.0, 0.0
    for n in range(STAGES[scheme]):
        # Horner's rule in i angle, from the highest power.
        real, imaginary = NUMERATOR[scheme, n] - angle * imaginary, angle * real
    turn = GAMMA[scheme] * angle
    poles = STAGES[scheme] - 1
    size = (1.0 + turn * turn) ** (-0.5 * poles)
    behind = angle - poles * math.atan(turn)
    return math.hypot(size * real - math.cos(behind), size * imaginary - math.sin(behind))


@inlined
def time_of_sound(edge):
    """In which sound runs along an element [s]."""
    return edge.length * math.sqrt(edge.mass * edge.compliance)


@kernel
def times_of_sound(I, M, held):
    """The time in which sound runs from a node that is held to each of those that hang on it [s],
    into their row: the first and the one beyond the last of those nodes, and the one that it comes
    to last."""
    head = header(I)
    root, end = tree_of(I, held)
    times = spare_row(I, ROW_TIMES)
    M[times + root] = 0.0
    farthest = root
    for node in range(root + 1, end):
        until = M[times + I[head.parent + node]]
        if I[head.joint + node] == 0:
            edge = edge_of(I, M, node)
            until += time_of_sound(edge)
        M[times + node] = until
        if until > M[times + farthest]:
            farthest = node
    return root, end, farthest


@inlined
def hardness(I, M, row):
    """Z = sqrt(EA m) of the element below a constraint: tension over speed of a wave [N s/m]."""
    edge = edge_of(I, M, watched_element(I, row))
    return math.sqrt(edge.mass / edge.compliance) if edge.compliance > 0.0 else 0.0


@inlined
def relaxation(I, M, row):
    """Time by whose half a wave's rate of decay is w^2 [s]: of the material."""
    edge = edge_of(I, M, watched_element(I, row))
    return edge.damping_full * edge.compliance


@kernel
def end_wave(I, M, row):
    """Follow waves at a constraint no longer."""
    if row.wave > 0.0:
        row.wave = 0.0
        header(I).axial_waves -= 1
        if header(I).axial_waves == 0:
            soften(I, M)


@kernel
def end_waves(I, M):
    """Follow no waves any longer: what comes to a floor ends them, and sends others."""
    for n in range(header(I).constraint_count):
        end_wave(I, M, constraint_of(I, M, n))


@kernel
def runs_through(I, M, root, end):
    """Whether what is tied together runs from one winch to another. Waves gain at one what they
    lose at the other, and elements that pass make more of them: steps had better damp them."""
    winches = 0
    for n in range(header(I).winch_count):
        if root <= winch_of(I, M, n).node < end:
            winches += 1
    return winches > 1


@kernel
def something_between(I, M, root, end, lasts):
    """Whether a body hangs on what is tied together nearer than its far end, to which sound runs
    for that time [s]: it throws waves back, and their spectrum is another one."""
    head = header(I)
    times = spare_row(I, ROW_TIMES)
    for n in range(head.body_count):
        node = int(body_of(I, M, n).node)
        if root < node < end and M[times + node] < lasts:
            return True
    for n in range(head.free_count):
        node = int(free_body_of(I, M, n).node)
        if root < node < end and M[times + node] < lasts:
            return True
    return False


@kernel
def least_tension(I, M, root, end):
    """Of what is tied together [N]."""
    head = header(I)
    least = math.inf
    for node in range(root + 1, end):
        if I[head.joint + node] == 0:
            tension = tension_of(I, M, node)
            least = min(least, tension.mean - abs(tension.slope))
    return least


@kernel
def begin_wave(I, M, row, jump, allowed):
    """What a jump of the acceleration [m/s2] at an end that is held sends along its line, if that
    is more than is allowed, and less than all that is there: by more it goes slack somewhere."""
    head = header(I)
    if jump == 0.0 or head.floor_state == FLOOR_TOUCHED:
        return
    root, end, farthest = times_of_sound(I, M, int(row.node))
    lasts = M[spare_row(I, ROW_TIMES) + farthest]
    if runs_through(I, M, root, end) or something_between(I, M, root, end, lasts):
        return
    new = 2.0 / (math.pi * math.pi) * jump * hardness(I, M, row) * lasts
    made = new + row.wave
    if ALL_WAVES * made <= allowed:
        return
    if ALL_WAVES * made >= least_tension(I, M, root, end):
        end_wave(I, M, row)
        return
    if row.wave == 0.0 or ALL_WAVES * new > allowed:
        row.wave_began = scalars(M).time
    if row.wave == 0.0:
        head.axial_waves += 1
        row.wave_since = scalars(M).time
        row.wave_seen = 0.0
    row.wave = made
    row.wave_lasts = 0.0
    row.wave_frequency = math.pi / lasts
    row.wave_element = longest_wave_element(I, M, row, allowed)


@kernel
def speed_of_stretch(I, M, row, dt):
    """The largest speed by which a line below an end is stretched in a step of dt to the trial,
    beside that which grows linearly with the time of sound from that end to the farthest [m/s]."""
    head = header(I)
    root, end, farthest = times_of_sound(I, M, int(row.node))
    times = spare_row(I, ROW_TIMES)
    speeds = spare_row(I, ROW_SPEEDS)
    M[speeds + root] = 0.0
    for node in range(root + 1, end):
        M[speeds + node] = M[speeds + I[head.parent + node]]
        if I[head.joint + node] == 0:
            edge = edge_of(I, M, node)
            more = trial_tension_of(I, M, node).mean - tension_of(I, M, node).mean
            M[speeds + node] += more * (edge.compliance * edge.length / dt)
    if M[times + farthest] == 0.0:
        return 0.0
    whole = M[speeds + farthest] / M[times + farthest]
    largest = 0.0
    for node in range(root + 1, end):
        largest = max(largest, abs(M[speeds + node] - whole * M[times + node]))
    return largest


@kernel
def follow_wave(I, M, row, dt, allowed):
    """Measure waves at a constraint in a step of dt from the state to the trial."""
    state = scalars(M)
    row.wave_seen = max(row.wave_seen, hardness(I, M, row) * speed_of_stretch(I, M, row, dt))
    if row.wave_frequency * (state.time + dt - row.wave_since) < 2.0 * math.pi:
        return
    found = min(row.wave, row.wave_seen)
    if row.wave_lasts == 0.0:
        row.wave_lasts = 2.0 / LOSS_FACTOR  # what a jump makes is no more than a bound
    elif found < row.wave:
        row.wave_lasts = min(MOST_LASTING, 2.0 * math.pi / math.log(row.wave / found))
    else:
        row.wave_lasts = MOST_LASTING
    row.wave = found
    row.wave_since = state.time + dt
    row.wave_seen = 0.0
    over = row.wave_frequency * (row.wave_since - row.wave_began) > MOST_LASTING
    if over or ALL_WAVES * row.wave <= allowed:
        end_wave(I, M, row)
    else:
        row.wave_element = longest_wave_element(I, M, row, allowed)


@kernel
def how_long(row, number, relaxed):
    """How long that wave of a row lasts [rad]: by its material, at most as the first does, and if
    that is not known yet as in any cable. What lasts longer is missed by the sixth root of that."""
    lasts = number * (row.wave_lasts if row.wave_lasts > 0.0 else 2.0 / LOSS_FACTOR)
    loss = number * row.wave_frequency * relaxed
    return min(lasts, 2.0 / loss) if loss > 0.0 else lasts


@inlined
def beyond(amplitude, number):
    """All that is there of the waves beyond that number, whose first has that amplitude."""
    return amplitude / (number + 0.5)


@kernel
def missed_by_steps(row, amplitude, relaxed, scheme, dt):
    """What steps of dt miss of waves until they are over, whose first has that amplitude, in its
    unit; relaxed: `relaxation`."""
    missed = 0.0
    for number in range(1, OVERTONES + 1):
        own = amplitude / (number * number)
        angle = number * row.wave_frequency * dt
        lost = error_of_turn(scheme, angle) * max(how_long(row, number, relaxed) / angle, 1.0)
        missed += own * min(lost, 1.0)
        if lost >= 1.0:
            # So are those beyond.
            return missed + beyond(amplitude, number) - beyond(amplitude, OVERTONES)
    return missed


@kernel
def missed_by_elements(row, amplitude, relaxed, turn):
    """The same of elements along which the first wave turns by that angle [rad]."""
    missed = 0.0
    for number in range(1, OVERTONES + 1):
        own = amplitude / (number * number)
        lost = ELEMENT_DISPERSION * (number * turn) ** 6 * how_long(row, number, relaxed)
        missed += own * min(lost, 1.0)
        if lost >= 1.0:
            return missed + beyond(amplitude, number) - beyond(amplitude, OVERTONES)
    return missed


@inlined
def may_be_missed(amplitude):
    """What may be missed of waves whose first has that amplitude: what is allowed, their unit, or
    as much as of those that are not followed."""
    return max(1.0, beyond(amplitude, OVERTONES))


@kernel
def may_miss_waves(I, M, row, dt, scheme, allowed):
    """Whether steps of dt may miss what they do of waves at a constraint."""
    if row.wave == 0.0:
        return True
    amplitude = row.wave / allowed
    missed = missed_by_steps(row, amplitude, relaxation(I, M, row), scheme, dt)
    return missed <= may_be_missed(amplitude)


@kernel
def longest_wave_step(I, M, row, dt, scheme, allowed):
    """A step of at most dt that follows waves at a constraint: a whole part of the first's turn."""
    amplitude = row.wave / allowed
    relaxed = relaxation(I, M, row)
    missed = missed_by_steps(row, amplitude, relaxed, scheme, dt)
    most = may_be_missed(amplitude)
    if missed <= most:
        return dt
    longest = dt
    parts = 1.0
    while missed > most:
        finer = max((missed / most) ** (1.0 / (3 + scheme)), TURN_FINER)
        parts = math.floor(parts * finer) + 1.0
        longest = 2.0 * math.pi / (parts * row.wave_frequency)
        missed = missed_by_steps(row, amplitude, relaxed, scheme, longest)
    return min(longest, dt)


@kernel
def longest_wave_element(I, M, row, allowed):
    """The longest that an element may be where waves run, as the time of sound [s]."""
    amplitude = row.wave / allowed
    relaxed = relaxation(I, M, row)
    most = may_be_missed(amplitude)
    parts = 1.0
    while missed_by_elements(row, amplitude, relaxed, math.pi / parts) > most:
        parts = math.floor(TURN_FINER * parts) + 1.0
    return math.pi / (parts * row.wave_frequency)
