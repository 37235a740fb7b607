"""Spells without tension of a line: what begins and ends one, in both solvers.

A spell begins as the mean tension of a piece comes to 0. It is over as the lowest one of the line
comes to a threshold: what is folded pulls a little, by its own inertia, and most of all while it
is pulled straight.

Steps count, and within a step the lowest tension is taken as linear until it is none: nothing
depends on the times at which anybody looks.
"""

from cablemodel.solvers.shared.access import line_of
from cablemodel.solvers.shared.compile import kernel

TAUT = 0.02  # of a line's largest tension at the start, or of its weight: no fold pulls like that
SLACK_LOWEST = 0.5  # of its lowest tension at the start, where that is less
NONE = 1e300  # tension of what has no cable off the floor


@kernel
def taut_from(lowest, largest, weight):
    """The tension above which a line is taut again, from those at its start, and its weight."""
    threshold = TAUT * max(largest, weight)
    return min(threshold, SLACK_LOWEST * lowest) if lowest > 0.0 else threshold


@kernel
def count_step(line, time, dt):
    """Count a step of dt from `time` on, by the line's lowest tensions before and after it, and by
    the rate before it: what bends aside falls no further than to nothing."""
    before = line.before
    after = line.after
    begin = 0.0
    end = 1.0
    if line.slack == 0.0:
        if before > 0.0 and after > 0.0:
            return
        if before > 0.0:
            begin = before / max(before - after, -dt * line.rate)
        line.since = time + begin * dt
        line.slack = 1.0
    if after > line.threshold:
        low = min(before, line.threshold)  # on another mesh it may have become taut
        end = (line.threshold - low) / (after - low)
        line.slack = 0.0
    line.total += (end - begin) * dt
    line.longest = max(line.longest, time + end * dt - line.since)


@kernel
def read_slack(I, M, found):
    """What a Summary says of it."""
    line = line_of(I, M, 0)
    found.slack_time = line.total
    found.slack_longest = line.longest
    found.slack_since = line.since
    found.slack_start = line.first
    found.slack_end = line.last
