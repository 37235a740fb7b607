"""Winches: at what rate lines pass them, until when, and how far a step may go."""

from cablemodel.solvers.finite_element.kernels.mesh.body_passage import next_mark
from cablemodel.solvers.shared.access import cable_of, cut_of, header, scalars, winch_of
from cablemodel.solvers.shared.compile import inlined, kernel, outlined
from cablemodel.solvers.shared.inputs import commanded_rate
from cablemodel.solvers.shared.layout import CUT_WITHIN
from cablemodel.solvers.shared.numbers import RELATIVE_ROUNDING

FASTEST_GROWTH = 20.0  # in a step, of the top element or of what is out of a body, by its length


@kernel
def first_crossing(gap, rate, slope):
    """Smallest tau > 0 at which rate tau + slope tau^2 / 2 = gap (gap > 0); 1e300: never."""
    if slope == 0.0:
        if rate > 0.0:
            return gap / rate
        return 1e300
    inside = rate * rate + 2.0 * slope * gap
    if inside < 0.0:
        return 1e300
    root = inside**0.5
    if rate + root <= 0.0:
        return 1e300
    return 2.0 * gap / (rate + root)


@inlined
def out_of(winch, place):
    """How far a place of a winch's cables, counted as their `leaves`, is out of it [m]."""
    return winch.travel - winch.off_drum * (place - winch.start)


@inlined
def is_due(M, row):
    """Whether a cut is to be made, by a command or a time that has come."""
    return row.ordered != 0.0 or row.time <= scalars(M).time


@kernel
def next_cut(I, M, winch):
    """Way of a winch to where what has been cut on its drum leaves it [m]; 1e300: nothing has."""
    cable = cable_of(I, M, int(winch.cable))
    way = 1e300
    for n in range(header(I).cut_count):
        row = cut_of(I, M, n)
        if row.done < 1e300 or row.side != CUT_WITHIN or not is_due(M, row):
            continue
        out = out_of(winch, row.arc)
        if out < 0.0 and cable_of(I, M, int(row.segment)).chain == cable.chain:
            way = min(way, cable.shortest - out)
    return way


@kernel
def begin_rate(I, M, n, stop):
    """Set a winch's rate for the next step; returns the time by which the step must end.

    Rates hold until the next breakpoint of the command, and not beyond the end of the drum or the
    shortest length: there the rate is clamped to zero until the command turns round. Bodies of
    finite length are met where their turn comes.
    """
    winch = winch_of(I, M, n)
    time = scalars(M).time
    rate, slope, until = commanded_rate(I, M, n, time)
    stop = min(stop, until)
    if rate == 0.0:
        sign = slope
    else:
        sign = rate
        if rate * slope < 0.0:
            zero = time - rate / slope
            if zero <= time + RELATIVE_ROUNDING * (1.0 + abs(time)):
                sign = slope  # it turns round now: what is left of the rate is round-off
            elif zero < stop:
                stop = zero
    most = winch.travel_most - winch.travel
    least = winch.travel - winch.travel_least
    winch.at_limit = 0.0
    if sign > 0.0 and most <= RELATIVE_ROUNDING * (1.0 + abs(winch.travel_most)):
        winch.at_limit = 1.0
    elif sign < 0.0 and least <= RELATIVE_ROUNDING * (1.0 + abs(winch.travel_least)):
        winch.at_limit = -1.0
    if winch.at_limit != 0.0:
        winch.rate = 0.0
        winch.slope = 0.0
        return stop
    winch.rate = rate
    winch.slope = slope
    tau = 1e300
    if sign > 0.0:
        mark = min(next_mark(I, M, n, True), next_cut(I, M, winch))
        tau = first_crossing(min(most, mark), rate, slope)
    elif sign < 0.0:
        tau = first_crossing(min(least, next_mark(I, M, n, False)), -rate, -slope)
    if tau < 1e299:
        stop = min(stop, time + tau)
    return stop


@kernel
def begin_payout(I, M, stop):
    """Set the rates of all winches for the next step: the time by which it must end, and the
    largest jump of a rate [m/s]."""
    jump = 0.0
    for n in range(header(I).winch_count):
        winch = winch_of(I, M, n)
        if winch.node < 0.0:
            continue
        rate = winch.rate
        slope = winch.slope
        stop = begin_rate(I, M, n, stop)
        jump = max(jump, abs(winch.rate - rate))  # one stops dead at an end
        winch.acceleration_jump = winch.slope - slope
    return stop, jump


@outlined
def slope_jump(I, M):
    """By how much the acceleration of a winch in the next step is another one than in the last
    [m/s2], at most."""
    largest = 0.0
    for n in range(header(I).winch_count):
        winch = winch_of(I, M, n)
        if winch.node >= 0.0:
            largest = max(largest, abs(winch.acceleration_jump))
    return largest


@kernel
def longest_payout_step(I, M, dt):
    """A step that changes top elements by at most their nominal length, or half of their own.

    What has just begun to come out grows by a multiple of its own length.
    """
    for n in range(header(I).winch_count):
        winch = winch_of(I, M, n)
        rate = abs(winch.rate + 0.5 * winch.slope * dt)
        rate = max(rate, abs(winch.rate))
        if rate == 0.0 or winch.node < 0.0:
            continue
        nominal = cable_of(I, M, int(winch.cable)).nominal
        room = min(nominal, FASTEST_GROWTH * winch.top_length)
        if winch.rate < 0.0 or (winch.rate == 0.0 and winch.slope < 0.0):
            room = 0.5 * winch.top_length
        dt = min(dt, room / rate)
    return dt


@kernel
def paid_since(winch, tau):
    """What has passed a winch in tau since `time`, at the step's rate [m]."""
    return tau * (winch.rate + 0.5 * winch.slope * tau)
