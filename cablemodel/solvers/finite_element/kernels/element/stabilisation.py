"""How stiff each element's third strain mode is: a number, since tension has two modes only.

Full axial stiffness would lock an element that bends: its cubic cannot be run along at an even
speed, and what that misses would become tension. A few times a typical tension suffice to hold the
mode. But then it has a frequency of its own, 6.5 sqrt(S / m) / h, and where elements are long that
is one of the line's motions along itself: a load that rings on eight elements rings with it.
While something rings the mode is made as stiff as puts its frequency above the line's own,
EA (h / L)^2, as long as what bending makes of it stays below tau of the element's tension. As it
becomes so, the mode's tension goes on: what it is strained by becomes its strain at rest. And what
its stiffness makes of a motion slower than the ring is forgotten: bends change, and the modes'
strains with them, from element to element; held, they would be tensions that no cable has. When
nothing rings any more that stiffness is forgotten, by halves; but where nothing damps a line: a
split or a winch stirs a soft mode, and that would last.

A line that is drawn taut after its start may carry thousands of times as much: what its tension
differs by from one element to the next would stretch half of each element by tenths and shorten
the other.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.scales import least_stiffness, line_length
from cablemodel.solvers.finite_element.kernels.element.stretch import strains, third_strain
from cablemodel.solvers.finite_element.kernels.element.tables import ELEMENT_RIGID, STABILISATION
from cablemodel.solvers.finite_element.kernels.mesh.payout import set_top_length
from cablemodel.solvers.shared.access import (
    body_of,
    cable_of,
    constraint_of,
    edge_of,
    header,
    scalars,
    tension_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel

TWICE = 2.0  # what is wanted over what is there: no change for less
HALF = 0.5  # what is left of a ring's memory as its stiffness is halved
STRETCH_STRAIGHT = 1e-9  # strain that bending makes below which it makes none
SLOWLY = 0.1  # of that share: what pieces of split elements forget of how they are stretched
FORGOTTEN = 1e-14  # strain at rest below which there is none


@kernel
def strain_of_bend(I, M, node):
    """Amplitude of the third strain mode in the element above a node if its slopes were stretched
    as the element is: what bending alone makes of it [-]."""
    head = header(I)
    dimension = head.dimension
    mean, _moment, third = strains(I, M, node, 1.0, 1.0)
    above = 0.0
    below = 0.0
    for i in range(dimension):
        above += M[head.position + dimension * (2 * I[head.parent + node] + 1) + i] ** 2
        below += M[head.position + dimension * (2 * node + 1) + i] ** 2
    if above * below == 0.0:
        return third
    p0 = (1.0 + mean) / math.sqrt(above)
    p1 = (1.0 + mean) / math.sqrt(below)
    return strains(I, M, node, p0, p1)[2]


@kernel
def ringing_stiffness(I, M, edge):
    """That with which an element's own frequency is above those of its line [N]. Where waves are
    followed it is in all elements that of the longest there may be, which has all of EA."""
    stiffness = stiffness_of_ring(I, M, edge)
    head = header(I)
    if head.axial_waves != 0:
        sound = edge.length * edge.length * edge.mass * edge.compliance
        for n in range(head.constraint_count):
            row = constraint_of(I, M, n)
            if row.wave > 0.0:
                part = min(sound / row.wave_element**2, 1.0)
                stiffness = max(stiffness, part / edge.compliance)
    return stiffness


@kernel
def stiffness_of_ring(I, M, edge):
    """The same where none do."""
    part = min(edge.length / line_length(I, M, edge), 1.0)
    return part * part / edge.compliance


@kernel
def unlocked_stiffness(I, M, node):
    """That with which what bending leaves in the mode is tau of the element's tension [N]."""
    strain = abs(strain_of_bend(I, M, node)) + STRETCH_STRAIGHT
    return scalars(M).tolerance * abs(tension_of(I, M, node).mean) / strain


@kernel
def stabilise(I, M):
    """By the tensions of a start, in all elements; whether anything was changed."""
    head = header(I)
    state = scalars(M)
    largest = 0.0
    for node in range(head.nodes):
        largest = max(largest, abs(tension_of(I, M, node).mean))
    state.third_mode = max(state.third_mode, STABILISATION * largest)
    changed = 0
    for n in range(1, head.nodes + head.cable_count):
        edge = edge_of(I, M, n) if n < head.nodes else cable_of(I, M, n - head.nodes).edge
        if edge.compliance > 0.0 and least_stiffness(M, edge) != edge.stabilisation:
            edge.stabilisation = least_stiffness(M, edge)
            changed = 1
    for index in range(head.body_count):
        body = body_of(I, M, index)
        if body.length > 0.0 and largest > 0.0:
            body.compliance = min(body.compliance, body.length / (ELEMENT_RIGID * largest))
    return changed


@kernel
def rings_taut(I, M):
    """Whether something rings, and leaves its line taut: by less than the tension there."""
    head = header(I)
    if head.axial_waves != 0:
        return True
    if head.rings == 0:
        return False
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if 0.0 < row.ring < row.ring_about:
            return True
    return False


@kernel
def wanted_stiffness(I, M, node, edge, tension, rings, over):
    """What an element's mode should have [N], beside what it has; tension: its own, if that has
    outgrown those of the start; rings: `rings_taut`; over: nothing has for a while."""
    stiffness = edge.stabilisation
    least = least_stiffness(M, edge)
    carried = carried_stiffness(edge, tension)
    if over:
        return max(least, carried, HALF * stiffness)
    wanted = max(stiffness, carried)
    if not rings and stiffness <= TWICE * least:
        return wanted
    ringing = ringing_stiffness(I, M, edge)
    if ringing > least:
        most = max(unlocked_stiffness(I, M, node), least)
        if stiffness > TWICE * most and stiffness > STABILISATION * tension:
            return most
        if rings and min(ringing, most) > TWICE * stiffness:
            wanted = max(wanted, min(ringing, most))
    return wanted


@kernel
def soften(I, M):
    """Take back what waves have stiffened, as none run along any more: cable may fold now."""
    head = header(I)
    for node in range(1, head.nodes):
        edge = edge_of(I, M, node)
        if I[head.joint + node] != 0 or edge.compliance == 0.0:
            continue
        wanted = max(least_stiffness(M, edge), stiffness_of_ring(I, M, edge))
        if wanted < edge.stabilisation:
            edge.third_rest *= wanted / edge.stabilisation
            edge.stabilisation = wanted
            head.factored = 0
            head.has_history = 0


@inlined
def forget_stretch(edge, share):
    """Forget a share of what a piece of a split element is stretched by at rest."""
    edge.stretch_rest *= 1.0 - share
    edge.moment_rest *= 1.0 - share
    if abs(edge.stretch_rest) + abs(edge.moment_rest) < FORGOTTEN * edge.length:
        edge.stretch_rest = 0.0
        edge.moment_rest = 0.0


@inlined
def carried_stiffness(edge, tension):
    """What a tension that has outgrown those of the start asks for [N]."""
    return min(STABILISATION * tension, 1.0 / edge.compliance)


@kernel
def relax_third(I, M, node, edge, tension, share):
    """Let a share of the tension be forgotten that a mode has only as it is stiff for a ring: it
    may hold no strain that goes with the bend. tension: as in `carried_stiffness`."""
    more = edge.stabilisation - max(least_stiffness(M, edge), carried_stiffness(edge, tension))
    if more > 0.0:
        edge.third_rest += share * (more * third_strain(I, M, node) - edge.third_rest)


@kernel
def follow_third_mode(I, M, dt):
    """After a step of dt, or as a ring begins, 0: stiffness that does not fit.

    As it becomes stiffer the mode's tension goes on: what it is strained by becomes its strain at
    rest. As it becomes softer that strain stays, and no energy is made.
    """
    head = header(I)
    state = scalars(M)
    share = dt / (dt + state.period)
    turned = dt / (dt + 1.0 / math.sqrt(state.axial))
    taut = state.largest_tension > state.third_mode
    rings = rings_taut(I, M)
    if not taut and not rings and state.stiffened == 0.0:
        return  # all but the few lines that are drawn taut, or ring
    if head.payout != 0:
        set_top_length(I, M, state.time)
    state.rang = 1.0 if rings else (1.0 - share) * state.rang
    over = 0.0 < state.rang < HALF and state.undamped == 0.0
    if over:
        state.rang = 0.0
    state.stiffened = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        edge = edge_of(I, M, node)
        if edge.compliance == 0.0:
            continue
        stiffness = edge.stabilisation
        tension = tension_of(I, M, node).mean if taut else 0.0
        outgrown = tension if tension > stiffness or over else 0.0
        if rings:
            relax_third(I, M, node, edge, tension, turned)
        else:
            edge.third_rest *= 1.0 - share
        if abs(edge.third_rest) < FORGOTTEN * stiffness:
            edge.third_rest = 0.0
        forget_stretch(edge, SLOWLY * share)
        wanted = wanted_stiffness(I, M, node, edge, outgrown, rings, over)
        if wanted > stiffness:
            strain = third_strain(I, M, node)
            if not rings:
                # What bends as it is drawn taut stays soft: by the tension over tau of the length.
                more = 10.0 * share * state.tolerance * tension / max(strain * strain, 1e-20)
                wanted = min(wanted, stiffness + more)
            edge.third_rest += (wanted - stiffness) * strain
        elif wanted < stiffness:
            edge.third_rest *= wanted / stiffness
            if over and wanted == HALF * stiffness:
                state.rang = 1.0  # there is more to forget
        rests = edge.third_rest != 0.0 or edge.stretch_rest != 0.0 or edge.moment_rest != 0.0
        if wanted > least_stiffness(M, edge) or rests:
            state.stiffened = 1.0
        if wanted != stiffness:
            edge.stabilisation = wanted
            head.factored = 0
            head.has_history = 0
