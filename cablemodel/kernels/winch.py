"""Winches: at what rate lines pass them, until when, and how far a step may go."""

from .access import cable_of, header, rate_of, scalars, winch_of
from .compile import kernel
from .layout import LIVE, LIVE_NOT, LIVE_RETURNS
from .passing import next_mark

FASTEST_GROWTH = 20.0  # in a step, of the top element or of what is out of a body, by its length


@kernel
def commanded_rate(I, M, n, t):
    """Commanded rate of a winch just after t, its slope, and the time until which they hold."""
    winch = winch_of(I, M, n)
    if winch.live != LIVE_NOT:
        live = winch.live_rate
        if t < live.end:
            slope = (live.last - live.first) / (live.end - live.begin)
            return live.first + slope * (t - live.begin), slope, live.end
        return live.last, 0.0, 1e300
    first = int(winch.first_rate)
    count = int(winch.rates)
    if count == 0:
        return 0.0, 0.0, 1e300
    now = rate_of(I, M, first)
    if t < now.time:
        return now.rate, 0.0, now.time
    for k in range(first, first + count - 1):
        now = rate_of(I, M, k)
        then = rate_of(I, M, k + 1)
        if t < then.time:
            slope = (then.rate - now.rate) / (then.time - now.time)
            return now.rate + slope * (t - now.time), slope, then.time
    return rate_of(I, M, first + count - 1).rate, 0.0, 1e300


@kernel
def drive_winch(I, M, n, t_end, given, target):
    """The caller's rate for a step to t_end, or back to the scene's where none is given: linear
    from the present command. Returns whether cable may pass."""
    winch = winch_of(I, M, n)
    if not given and winch.live != LIVE:
        winch.live = LIVE_NOT
        return False
    time = scalars(M).time
    present, _slope, _until = commanded_rate(I, M, n, time)
    if not given:
        winch.live = LIVE_NOT
        target, _slope, _until = commanded_rate(I, M, n, t_end)
    winch.live = LIVE if given else LIVE_RETURNS
    live = winch.live_rate
    live.begin = time
    live.end = t_end
    live.first = present
    live.last = target
    if present == 0.0 and target == 0.0:
        return False
    header(I).payout = 1
    return True


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


@kernel
def begin_rate(I, M, n, stop):
    """Set a winch's rate for the next step; returns the time by which the step must end.

    Rates hold until the next kink of the command, and not beyond the end of the drum or the
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
            if zero <= time + 1e-12 * (1.0 + abs(time)):
                sign = slope  # it turns round now: what is left of the rate is round-off
            elif zero < stop:
                stop = zero
    most = winch.travel_most - winch.travel
    least = winch.travel - winch.travel_least
    winch.at_limit = 0.0
    if sign > 0.0 and most <= 1e-12 * (1.0 + abs(winch.travel_most)):
        winch.at_limit = 1.0
    elif sign < 0.0 and least <= 1e-12 * (1.0 + abs(winch.travel_least)):
        winch.at_limit = -1.0
    if winch.at_limit != 0.0:
        winch.rate = 0.0
        winch.slope = 0.0
        return stop
    winch.rate = rate
    winch.slope = slope
    tau = 1e300
    if sign > 0.0:
        tau = first_crossing(min(most, next_mark(I, M, n, True)), rate, slope)
    elif sign < 0.0:
        tau = first_crossing(min(least, next_mark(I, M, n, False)), -rate, -slope)
    if tau < 1e299:
        stop = min(stop, time + tau)
    return stop


@kernel
def begin_payout(I, M, stop):
    """Set the rates of all winches for the next step: the time by which it must end, and the
    largest jumps of a rate [m/s] and of its slope [m/s2]."""
    jump = 0.0
    largest = 0.0
    for n in range(header(I).winch_count):
        winch = winch_of(I, M, n)
        if winch.node < 0.0:
            continue
        rate = winch.rate
        slope = winch.slope
        stop = begin_rate(I, M, n, stop)
        jump = max(jump, abs(winch.rate - rate))  # one stops dead at an end
        winch.kink = winch.slope - slope
        largest = max(largest, abs(winch.kink))
    return stop, jump, largest


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
