"""For how long, and where, some of the line has been slack, as shared/slack.py has it:
by the mean tensions of the intervals between nodes."""

from cablemodel.solvers.shared.access import header, line_of
from cablemodel.solvers.shared.layout import SLACK_NOWHERE, SLACK_UNKNOWN
from cablemodel.solvers.shared.slack import NONE, count_step, taut_from

from .access import material_row, own_header, section_of, start_of, unknowns_of
from .compile import kernel
from .layout import END_FREE, RIGID


@kernel
def set_threshold(I, M):
    """The tension above which the line is taut again, from the state at the start of a step."""
    own = own_header(I)
    weight = 0.0
    largest = 0.0
    lowest = NONE
    for index in range(own.section_count):
        section = section_of(I, M, index)
        if section.kind == RIGID:
            continue
        of_length = abs(material_row(I, M, section.material).weight)
        for node in range(section.first + 1, section.first + section.count):
            mean = 0.5 * (start_of(I, M, node - 1).f3 + start_of(I, M, node).f3)
            weight += of_length * M[own.old_length + node]
            largest = max(largest, abs(mean))
            lowest = min(lowest, mean)
    line = line_of(I, M, 0)
    line.threshold = taut_from(lowest, largest, weight)
    rigid = section_of(I, M, own.section_count - 1).kind == RIGID
    if own.end == END_FREE and not rigid and section_of(I, M, own.section_count).point < 0:
        line.threshold = 0.0


@kernel
def follow_slack(I, M, time, dt):
    """Count a step of dt from `time` on that has been made, where the line was slack in it."""
    own = own_header(I)
    head = header(I)
    line = line_of(I, M, 0)
    if head.slack == SLACK_UNKNOWN:
        set_threshold(I, M)
        head.slack = SLACK_NOWHERE
    line.before = NONE
    line.after = NONE
    begin = 0.0
    for index in range(own.section_count):
        section = section_of(I, M, index)
        if section.kind == RIGID:
            continue
        for node in range(section.first + 1, section.first + section.count):
            end = begin + M[own.length + node]
            before = 0.5 * (start_of(I, M, node - 1).f3 + start_of(I, M, node).f3)
            after = 0.5 * (unknowns_of(I, M, node - 1).f3 + unknowns_of(I, M, node).f3)
            line.before = min(line.before, before)
            line.after = min(line.after, after)
            if after <= 0.0 or before <= 0.0:
                if not line.first <= begin:
                    line.first = begin
                if not line.last >= end:
                    line.last = end
            begin = end
    count_step(line, time, dt)
