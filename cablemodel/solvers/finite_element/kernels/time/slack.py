"""For how long, and where, some of a line has been slack: has carried no tension.

What begins and ends a spell: cablemodel/solvers/shared/slack.py. Cable that the floor bears does
not count: friction lays it without tension, and for good.
"""

from cablemodel.solvers.finite_element.kernels.floor.floor_outputs import lying_gap
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at
from cablemodel.solvers.shared.access import (
    body_of,
    cable_of,
    closure_of,
    constraint_of,
    edge_of,
    free_body_of,
    header,
    line_of,
    scalars,
    spare_row,
    tension_at,
    tension_of,
    tension_rate_of,
    trial_tension_of,
    vector,
    winch_of,
)
from cablemodel.solvers.shared.compile import kernel, view
from cablemodel.solvers.shared.layout import (
    JOINT_ROOT,
    SLACK_NOWHERE,
    SLACK_SOMEWHERE,
    SLACK_UNKNOWN,
    TENSION_WORDS,
    SlackRows,
)
from cablemodel.solvers.shared.slack import NONE, count_step, taut_from

ROW_TIES = SlackRows.ties.word


@kernel
def line_row(I, M, node):
    """Row of the line of the element above a node."""
    return int(cable_of(I, M, int(edge_of(I, M, node).segment)).row)


@kernel
def lies(I, M, node, position):
    """Whether the floor bears the middle of an element; position: word of the nodes' places."""
    head = header(I)
    if head.floor_kind == 0:
        return False
    dimension = head.dimension
    p = position + 2 * dimension * I[head.parent + node]
    q = position + 2 * dimension * node
    eighth = 0.125 * edge_of(I, M, node).length
    middle = vector()
    for i in range(dimension):
        bow = eighth * (M[p + dimension + i] - M[q + dimension + i])
        middle[i] = 0.5 * (M[p + i] + M[q + i]) + bow
    return gap_at(I, M, middle, vector()) < lying_gap(I, M, node)


@kernel
def count_ties(I, M, ties):
    """How much holds each node: elements and joints, supports, bodies (nodes,)."""
    head = header(I)
    for node in range(head.nodes):
        ties[node] = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] < JOINT_ROOT:
            ties[node] += 1.0
            ties[I[head.parent + node]] += 1.0
    for n in range(head.constraint_count):
        ties[int(constraint_of(I, M, n).node)] += 1.0
    for n in range(head.body_count):
        node = int(body_of(I, M, n).node)
        if node >= 0:
            ties[node] += 1.0
    for n in range(head.free_count):
        ties[int(free_body_of(I, M, n).node)] += 1.0
    for n in range(head.closure_count):
        row = closure_of(I, M, n)
        if row.node >= 0.0 and row.clamp == 0.0:
            ties[int(row.node)] += 1.0
            if row.other >= 0.0:
                ties[int(row.other)] += 1.0


@kernel
def set_thresholds(I, M):
    """The tension above which each line is taut again, from the state: 0 of one with a free end,
    where tension is small at all times."""
    head = header(I)
    ties = view(M, spare_row(I, ROW_TIES), head.nodes)
    count_ties(I, M, ties)
    look_along(I, M, head.position, head.tension, False)
    for n in range(head.line_count):
        line = line_of(I, M, n)
        line.after = 0.0
        line.threshold = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            line = line_of(I, M, line_row(I, M, node))
            edge = edge_of(I, M, node)
            line.threshold += abs(edge.weight) * edge.length
            line.after = max(line.after, abs(tension_of(I, M, node).mean))
    for n in range(head.line_count):
        line = line_of(I, M, n)
        line.threshold = taut_from(line.before, line.after, line.threshold)
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        ends = ties[node] < 2.0 or ties[I[head.parent + node]] < 2.0
        if ends and not lies(I, M, node, head.position):
            line_of(I, M, line_row(I, M, node)).threshold = 0.0


@kernel
def extend(I, M, line, node, tension):
    """Take an element that is slack, where it is, into what its line has been slack of."""
    head = header(I)
    edge = edge_of(I, M, node)
    backward = cable_of(I, M, int(edge.segment)).backward != 0.0
    start = edge.start
    if backward:
        start = -start - edge.length
    if line.winch >= 0.0:
        start += winch_of(I, M, int(line.winch)).paid
    # From `near` to `far` along the tree its tension, linear within it, is none.
    near = 0.0
    far = 1.0
    there = tension_at(M, tension + TENSION_WORDS * node)
    push = -there.mean
    slope = there.slope
    if abs(slope) > push:
        if slope > 0.0:
            far = 0.5 + 0.5 * push / slope
        else:
            near = 0.5 + 0.5 * push / slope
    if backward:
        near, far = 1.0 - far, 1.0 - near
    begin = max(0.0, start + near * edge.length)
    end = start + far * edge.length
    if head.parts == 0 and I[head.parent + node] == 0 and near == 0.0:
        begin = 0.0  # the winch's element begins above the tow point
    if not line.first <= begin:
        line.first = begin
    if not line.last >= end:
        line.last = end


@kernel
def look_along(I, M, position, tension, after):
    """The lowest tension of each line into `after` or `before`, and where there is none.

    position, tension: words of the nodes' places and of the elements' tensions.
    """
    head = header(I)
    for n in range(head.line_count):
        line = line_of(I, M, n)
        if after:
            line.after = NONE
        else:
            line.before = NONE
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        line = line_of(I, M, line_row(I, M, node))
        mean = tension_at(M, tension + TENSION_WORDS * node).mean
        lowest = line.after if after else line.before
        if (mean <= 0.0 or mean < lowest) and not lies(I, M, node, position):
            if mean <= 0.0:
                extend(I, M, line, node, tension)
            if after:
                line.after = min(lowest, mean)
            elif mean < lowest:
                line.before = mean
                line.rate = tension_rate_of(I, M, node).mean


@kernel
def count_slack(I, M, dt):
    """Take the trial's step of dt, not yet accepted, into the times for which lines are slack."""
    head = header(I)
    state = scalars(M)
    if head.slack == SLACK_UNKNOWN:
        set_thresholds(I, M)
    look_along(I, M, head.position, head.tension, False)
    look_along(I, M, head.trial_position, head.trial_tension, True)
    head.slack = SLACK_NOWHERE
    for n in range(head.line_count):
        line = line_of(I, M, n)
        count_step(line, state.time, dt)
        if line.slack != 0.0:
            head.slack = SLACK_SOMEWHERE


@kernel
def any_slack(I, M):
    """Whether some cable off the floor has no tension in the trial."""
    head = header(I)
    for node in range(1, head.nodes):
        if trial_tension_of(I, M, node).mean <= 0.0 and I[head.joint + node] == 0:
            if not lies(I, M, node, head.trial_position):
                return True
    return False


@kernel
def follow_slack(I, M, dt):
    """Before the trial of a step of dt is accepted: count it where a line is slack in it."""
    head = header(I)
    if head.slack == SLACK_NOWHERE:
        tension = view(M, head.trial_tension, 2 * head.nodes)
        lowest = NONE
        for node in range(1, head.nodes):
            lowest = min(lowest, tension[2 * node])
        if lowest > 0.0 or not any_slack(I, M):
            return
    count_slack(I, M, dt)


@kernel
def forget_threshold(I, M, segment):
    """A line is cut: it has free ends from now on."""
    line_of(I, M, int(cable_of(I, M, segment).row)).threshold = 0.0
