"""The winch: at what rate the line passes the tow point, until when, and how far a step may go."""

from .access import cable_of, header, scalars
from .compile import kernel
from .passing import next_mark

FASTEST_GROWTH = 20.0  # in a step, of the top element or of what is out of a body, by its length


@kernel
def commanded_rate(I, M, t):
    """Commanded rate just after t, its slope, and the time until which they hold."""
    head = header(I)
    state = scalars(M)
    if head.rate_live == 1:
        t0 = state.live_rate[0]
        t1 = state.live_rate[1]
        if t < t1:
            slope = (state.live_rate[3] - state.live_rate[2]) / (t1 - t0)
            return state.live_rate[2] + slope * (t - t0), slope, t1
        return state.live_rate[3], 0.0, 1e300
    table = head.rates
    count = head.rate_count
    if count == 0:
        return 0.0, 0.0, 1e300
    if t < M[table]:
        return M[table + 1], 0.0, M[table]
    for k in range(count - 1):
        t1 = M[table + 2 * k + 2]
        if t < t1:
            t0 = M[table + 2 * k]
            r0 = M[table + 2 * k + 1]
            slope = (M[table + 2 * k + 3] - r0) / (t1 - t0)
            return r0 + slope * (t - t0), slope, t1
    return M[table + 2 * count - 1], 0.0, 1e300


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
def begin_payout(I, M, stop):
    """Set the rate of the next step; returns the time by which the step must end.

    Rates hold until the next kink of the command, and not beyond the end of the drum or the
    shortest length: there the rate is clamped to zero until the command turns round. Bodies of
    finite length are met where their turn comes.
    """
    head = header(I)
    state = scalars(M)
    time = state.time
    rate, slope, until = commanded_rate(I, M, time)
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
    most = state.travel_most - state.travel
    least = state.travel - state.travel_least
    head.clamped = 0
    if sign > 0.0 and most <= 1e-12 * (1.0 + abs(state.travel_most)):
        head.clamped = 1
    elif sign < 0.0 and least <= 1e-12 * (1.0 + abs(state.travel_least)):
        head.clamped = -1
    if head.clamped != 0:
        state.payout_rate = 0.0
        state.payout_slope = 0.0
        return stop
    state.payout_rate = rate
    state.payout_slope = slope
    tau = 1e300
    if sign > 0.0:
        tau = first_crossing(min(most, next_mark(I, M, True)), rate, slope)
    elif sign < 0.0:
        tau = first_crossing(min(least, next_mark(I, M, False)), -rate, -slope)
    if tau < 1e299:
        stop = min(stop, time + tau)
    return stop


@kernel
def longest_payout_step(I, M, dt):
    """A step that changes the top element by at most its nominal length, or half of its own.

    What has just begun to come out grows by a multiple of its own length.
    """
    head = header(I)
    state = scalars(M)
    row = cable_of(I, M, head.top_cable)
    rate = abs(state.payout_rate + 0.5 * state.payout_slope * dt)
    rate = max(rate, abs(state.payout_rate))
    if rate == 0.0:
        return dt
    room = min(row.nominal, FASTEST_GROWTH * state.top_length)
    if state.payout_rate < 0.0 or (state.payout_rate == 0.0 and state.payout_slope < 0.0):
        room = 0.5 * state.top_length
    return min(dt, room / rate)


@kernel
def paid_since(M, tau):
    """What has passed the tow point in tau since `time`, at the step's rate [m]."""
    state = scalars(M)
    return tau * (state.payout_rate + 0.5 * state.payout_slope * tau)
