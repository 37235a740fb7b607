"""Cable that is pressed bends aside, within elements where nothing else holds it.

Cable without bending stiffness folds under any pressure P in waves however short (sqrt(P/m) times
their number grows them), far shorter than elements; with some, in waves of a twentieth of the line
beyond Euler's load of that. An element gets shorter then instead.

A lay that begins with slack is limp: an element gets shorter by T / `yields`, to nothing under a
small part of what its tension may be wrong by. So slack lies where it fell, and what hangs above it
is not pushed: what cable comes to that is ever more flexible (Pipkin 1986, "The relaxed energy
density for isotropic elastic membranes"). What folds dissipates: D = B d|r'|/dt, with a B by which
D is as large as that pressure. Nothing else stops the strain of an element then.

In a line that hangs free pressure runs slower than tension by a factor s: the stiffness that is
left is s^2 EA, and a blow that makes a tension T makes a pressure s T. It shortens the line by
T / (s EA), which is no more than a half. What falls faster than its load gathers above it over the
length s c t that pressure has run, not in one place: s^2 is a part of tau, so that less is gathered
wrong as less may be. The slower, the less a line is a strut: but Newton's method needs shorter
steps where elements are short, and near a floor, where the mesh follows what folds. There, and in a
bare end, which nothing pulls taut, a line stays straight under all that its tension may be wrong
by, and s is a tenth.

What is slack closes without stretching the material, which damps where it is taut only: at points
of an element, as a snap runs through it.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.damping import damp_evenly, strain_rate
from cablemodel.solvers.finite_element.kernels.element.scales import line_length
from cablemodel.solvers.finite_element.kernels.element.strain import (
    folds,
    is_limp,
    promised_tension,
)
from cablemodel.solvers.finite_element.kernels.element.tables import P1, WEIGHT, WEIGHT_P1
from cablemodel.solvers.finite_element.kernels.floor.contact import touchdown_layer
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import near_floor
from cablemodel.solvers.finite_element.kernels.mesh.payout import material_top
from cablemodel.solvers.shared.access import (
    body_of,
    cable_of,
    closure_of,
    constraint_of,
    edge_of,
    free_body_of,
    header,
    scalars,
    spare_row,
    tension_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel, view
from cablemodel.solvers.shared.layout import (
    FLOOR_FAR,
    FLOOR_TOUCHED,
    JOINT_ROOT,
    LAID_SLACK,
    LimpRows,
)

BORNE = 0.1  # of what tensions may be wrong by: pressure that shortens a limp element to nothing
FOLDED = 5.0  # of w (EI/w)^(1/3): what a heavy elastica that is fed onto a floor pushes back with
SLOWEST_FOLD = 1e-3  # in sqrt(L/g): rate of folding down to which it dissipates as much
LEFT_HANGING = 0.1  # in tau: of its stiffness, what is left to cable that hangs and is pressed
SHEDS = 1e-3  # of its stiffness: less is left to cable of which no mesh follows how it folds
BORNE_HANGING = 0.01  # of what tensions may be wrong by: pressure under which that stays straight
SLOWER_FOLDED = 0.1  # than tension: pressure where the mesh follows what folds
HALVED_BELOW = 0.75  # of the length with which an element was made: a shorter one has been halved
FOLDS_WITHIN = 1e-4  # tau down to which cable of undamped material does: below, blows do not end
SNAPS = 0.05  # of its line: element of cable that is slack, at tau = 1e-3
ROW_HUNG, ROW_BELOW = LimpRows.hung.word, LimpRows.below.word
ROW_ABOVE, ROW_HELD = LimpRows.above.word, LimpRows.held.word
SHORTER = 0.5  # by which a blow of the largest tension makes cable that hangs


@inlined
def push_of(M, edge):
    """What folds of an element's bending push back with [N]."""
    return FOLDED * edge.contact * touchdown_layer(M, edge)


@inlined
def is_laid_slack(I, edge):
    """Whether an element is flexible cable of a lay that begins with slack, once one does: in a
    system not all lines do."""
    return edge.flexible != 0.0 and (header(I).parts == 0 or edge.flexible == LAID_SLACK)


@inlined
def may_be_wrong(I, M, edge):
    """By what the tension of an element may be wrong [N], by the largest in its line so far."""
    state = scalars(M)
    if header(I).parts != 0:
        return 10.0 * state.tolerance * cable_of(I, M, int(edge.segment)).tension
    return promised_tension(M)


@kernel
def has_slack(I, M):
    """Whether flexible cable of a lay is slack: where it lies its material is pressed, or would
    be if it were not limp, by more than tensions may be wrong by, and than half of what folds of
    its least bending push back with. What hangs may be pressed by a blow; cable that bends and lies
    straight may bear more than its folds do."""
    head = header(I)
    q = view(M, head.position, 2 * head.dimension * head.nodes)
    if not (scalars(M).yields > 0.0 or head.floor_state == FLOOR_TOUCHED):
        return False
    for node in range(1, head.nodes):
        pressure = -tension_of(I, M, node).mean
        if pressure <= 0.0 or I[head.joint + node] != 0:
            continue
        edge = edge_of(I, M, node)
        if not is_laid_slack(I, edge):
            continue
        if is_limp(edge):
            pressure /= edge.yields * edge.compliance
        elif not (near_floor(I, M, node, q) and near_floor(I, M, I[head.parent + node], q)):
            continue
        if pressure > max(may_be_wrong(I, M, edge), 0.5 * push_of(M, edge)):
            return True
    return False


@kernel
def mark_ends(I, M, ends):
    """Mark the nodes at which something is held, or hangs, (nodes,)."""
    head = header(I)
    for node in range(head.nodes):
        ends[node] = 0.0
    for n in range(head.body_count):
        if body_of(I, M, n).node > 0.0:
            ends[int(body_of(I, M, n).node)] = 1.0
    for n in range(head.free_count):
        ends[int(free_body_of(I, M, n).node)] = 1.0
    for n in range(head.constraint_count):
        ends[int(constraint_of(I, M, n).node)] = 1.0
    for n in range(head.closure_count):
        if closure_of(I, M, n).node >= 0.0:
            ends[int(closure_of(I, M, n).node)] = 1.0


@kernel
def find_hung(I, M):
    """Write 1 into ROW_HUNG for each element that something pulls taut: of a tree that is held,
    with something at both of its ends or beyond them; else 0."""
    head = header(I)
    nodes = head.nodes
    ends = view(M, spare_row(I, ROW_HUNG), nodes)
    below = view(M, spare_row(I, ROW_BELOW), nodes)
    above = view(M, spare_row(I, ROW_ABOVE), nodes)
    held = view(M, spare_row(I, ROW_HELD), nodes)
    mark_ends(I, M, ends)
    for node in range(nodes):
        below[node] = ends[node]
        above[node] = 0.0
        held[node] = 0.0
    for node in range(nodes - 1, 0, -1):
        if I[head.joint + node] < JOINT_ROOT and below[node] != 0.0:
            below[I[head.parent + node]] = 1.0
    for n in range(head.constraint_count):
        root = int(constraint_of(I, M, n).node)
        while root > 0 and I[head.joint + root] < JOINT_ROOT:
            root = I[head.parent + root]
        held[root] = 1.0
    for node in range(1, nodes):
        if I[head.joint + node] < JOINT_ROOT:
            parent = I[head.parent + node]
            above[node] = max(ends[parent], above[parent])
            held[node] = held[parent]
    for node in range(nodes):
        ends[node] = below[node] * above[node] * held[node]


@inlined
def holds_straight(I, M, edge):
    """Pressure under which cable with bending stiffness buckles between the nodes of an element,
    whose slopes hold it: Euler's 4 pi^2 EI / h^2 [N]. Longer waves are the mesh's own. A mesh
    however fine would hold a rope as straight as it was never made: h is that of slack cable."""
    if edge.flexible != 0.0:
        return 0.0
    h = max(edge.length, SNAPS * line_length(I, M, edge))
    return 4.0 * math.pi * math.pi * edge.bending_full / (h * h)


@kernel
def hang_limp(I, M, edge, promised):
    """Let an element that hangs free bend aside; promised: what tensions may be wrong by [N]."""
    state = scalars(M)
    edge.bears = BORNE_HANGING * promised
    slower = math.sqrt(LEFT_HANGING * max(state.tolerance, FOLDS_WITHIN))
    far = header(I).floor_state == FLOOR_FAR
    if edge.pulled == 0.0 or not far or edge.length < HALVED_BELOW * edge.nominal:
        edge.bears = promised
        slower = SLOWER_FOLDED
    edge.bears = max(edge.bears, holds_straight(I, M, edge))
    strain = promised / (10.0 * state.tolerance) * edge.compliance
    slower = max(slower, strain / SHORTER)
    edge.yields = slower * slower / edge.compliance


@inlined
def sheds(M, edge, t0, t1):
    """Whether an element that hangs bends aside, and hardly pushes: no mesh need follow how. What
    stretches much pushes with more."""
    soft = edge.yields * edge.compliance < SHEDS
    return edge.bears > 0.0 and soft and folds(M, edge, t0, t1)


@inlined
def may_fold(I, M):
    """Whether what hangs bends aside at all."""
    state = scalars(M)
    touches = header(I).floor_state == FLOOR_TOUCHED
    return not touches and state.yields == 0.0


@inlined
def blows_end(M, edge):
    """Whether something takes what an element's folds throw to and fro: its material, where
    something pulls it taut; down to `FOLDS_WITHIN` water, or for flexible cable that is pulled
    taut the steps. (What cable of little bending stiffness folds by itself, the mesh follows.)"""
    state = scalars(M)
    pulled = edge.pulled != 0.0
    if pulled and edge.damping_full > 0.0:
        return True
    if state.tolerance < FOLDS_WITHIN:
        return False
    return state.undamped == 0.0 or (pulled and edge.flexible != 0.0)


@kernel
def choose_law(I, M, node, promised):
    """Under what pressure an element bends aside, by the largest tension so far.

    A lay with slack is limp once it is pressed. Legs of moorings and loads that land would snap
    until no step was small enough: their cable folds by `sea_floor.least_bending`.
    """
    state = scalars(M)
    edge = edge_of(I, M, node)
    limp = state.yields > 0.0 and is_laid_slack(I, edge)
    t0, t1 = tension_of(I, M, node).mean, tension_of(I, M, node).slope
    if not limp and edge.bears > 0.0 and folds(M, edge, t0, t1):
        return  # a stiffer one would be pressed by what it has been shortened by
    edge.bears = 0.0
    edge.yields = 0.0
    if limp:
        edge.yields = BORNE * may_be_wrong(I, M, edge)
    elif may_fold(I, M) and blows_end(M, edge):
        hang_limp(I, M, edge, promised)
        # What bends bears a pressure, and goes on bearing it: less would be a blow from nowhere.
        if edge.flexible == 0.0 and folds(M, edge, t0, t1):
            edge.bears = promised + abs(t1) - t0


@kernel
def least_yields(I, M):
    """The least pressure that shortens a limp element to nothing [N]."""
    least = math.inf
    for node in range(1, header(I).nodes):
        edge = edge_of(I, M, node)
        if is_laid_slack(I, edge):
            least = min(least, BORNE * may_be_wrong(I, M, edge))
    return least


@kernel
def choose_all(I, M, promised):
    """`choose_law` for all elements, by what pulls them taut now and whether a lay is slack."""
    head = header(I)
    state = scalars(M)
    state.yields = 0.0
    if head.lays_slack != 0 and state.time > 0.0 and has_slack(I, M):
        state.yields = least_yields(I, M)
    hangs = may_fold(I, M)
    hung = view(M, spare_row(I, ROW_HUNG), head.nodes)
    if hangs:
        find_hung(I, M)
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            edge_of(I, M, node).pulled = hung[node] if hangs else 0.0
            choose_law(I, M, node, promised)


@kernel
def forget_limp(I, M):
    """No cable bends aside within elements."""
    head = header(I)
    scalars(M).yields = 0.0
    for node in range(1, head.nodes):
        edge_of(I, M, node).yields = 0.0


@kernel
def damp_slack(I, M, node, promised):
    """Choose the damping that an element which may be slack has in the next step: that of its
    material where it is taut, as what is slack closes without stretching it."""
    edge = edge_of(I, M, node)
    t0 = tension_of(I, M, node).mean
    t1 = tension_of(I, M, node).slope
    if is_limp(edge) and t0 < abs(t1):
        mean, moment = strain_rate(I, M, node)
        slowest = SLOWEST_FOLD / scalars(M).period
        damp_evenly(edge, edge.yields / max(abs(mean), abs(moment), slowest))
    elif edge.damping_full != 0.0 and (edge.flexible != 0.0 or edge.yields != 0.0):
        holds = edge.bears if edge.yields != 0.0 else holds_straight(I, M, edge)
        mean, moment = strain_rate(I, M, node)
        b0 = 0.0
        b1 = 0.0
        b2 = 0.0
        for g in range(3):
            tension = max(0.0, t0 + t1 * P1[g] + holds)
            damping = edge.damping_full * min(1.0, tension / promised)
            rate = mean + 3.0 * moment * P1[g]
            if damping * rate < -tension:
                damping = -tension / rate
            b0 += WEIGHT[g] * damping
            b1 += WEIGHT_P1[g] * damping
            b2 += WEIGHT_P1[g] * P1[g] * damping
        edge.damping = b0
        edge.damping_01 = 3.0 * b1
        edge.damping_11 = 9.0 * b2
    else:
        damp_evenly(edge, edge.damping_full)


@kernel
def follow_limp(I, M):
    """What bends aside in the next step, and what damping elements have in it, from the state.

    Cable has so much of its material's that T + D is not below what its bending bears where T
    vanishes; as it is pulled taut D comes with T, within what tensions may be wrong by. What is
    taut stays as it was chosen: of a line below one point, until its mesh changes.
    """
    head = header(I)
    promises = scalars(M).largest_tension <= 1e300
    promised = promised_tension(M)
    anew = head.parts != 0 or head.lays_slack != 0 or head.chosen == 0
    if promises and anew:
        choose_all(I, M, promised)
    head.chosen = 1
    folds_now = may_fold(I, M)
    material = head.payout == 0
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        edge = edge_of(I, M, node)
        t0, t1 = tension_of(I, M, node).mean, tension_of(I, M, node).slope
        stays = t0 - abs(t1) > promised or (edge.yields == 0.0 and not folds_now)
        if stays and (edge.damping_full == 0.0 or edge.flexible == 0.0):
            damp_evenly(edge, edge.damping_full)
            continue
        if not material:
            count = 2 * head.dimension * head.nodes
            q = view(M, head.position, count)
            v = view(M, head.velocity, count)
            material_top(I, M, q, v, view(M, head.acceleration, count))
            material = True
        if promises and not anew:
            choose_law(I, M, node, promised)
        damp_slack(I, M, node, promised)
