"""Vessels that the waves move: displacement response amplitude operators (RAOs).

Each component of the sea, a cos(theta) at the vessel's place, moves each degree of freedom by
a (A cos theta + B sin theta): surge and sway along the vessel's heading, heave, roll, pitch and
yaw. A and B depend on the heading of the waves from the bow, between whose rows they are linear;
the heading changes slowly against the waves.
"""

import math

from cablemodel.solvers.finite_element.kernels.water.airy import column
from cablemodel.solvers.shared.access import (
    header,
    scalars,
    wave_response_at,
)
from cablemodel.solvers.shared.compile import kernel, view
from cablemodel.solvers.shared.layout import (
    RAO_WORDS,
    RESPONSE_WORDS,
    W_AMPLITUDE,
    W_FREQUENCY,
    W_NUMBER,
    W_PHASE,
)

UP, YAW = 2, 2  # of a place, and of roll, pitch and yaw


@kernel
def ramp_of_waves(M, t):
    """Share of the waves that has come up at time t, and its two derivatives."""
    state = scalars(M)
    whole = state.wave_ramp
    if t <= 0.0:
        return 0.0, 0.0, 0.0
    if t >= whole:
        return 1.0, 0.0, 0.0
    x = t / whole
    share = x * x * x * (10.0 + x * (6.0 * x - 15.0))
    rise = 30.0 * x * x * (1.0 - x) ** 2 / whole
    return share, rise, 60.0 * x * (1.0 + x * (2.0 * x - 3.0)) / (whole * whole)


@kernel
def between_headings(I, M, row, heading):
    """Numbers of a frame's headings before and after one [rad], and how far it is between them."""
    turn = 2.0 * math.pi
    first = header(I).raos + int(row.raos) - 1
    last = int(row.headings) - 1
    x = heading - turn * math.floor(heading / turn)
    if x < M[first]:
        x += turn
    low = last
    while low > 0 and M[first + low] > x:
        low -= 1
    high = low + 1 if low < last else 0
    after = M[first + high] + (turn if low == last else 0.0)
    return low, high, (x - M[first + low]) / (after - M[first + low])


@kernel
def add_response(I, M, row, t):
    """Add what the waves do to the motions `moved` and `moved_angles` of a frame's row."""
    head = header(I)
    state = scalars(M)
    mean = row.mean
    turning = row.mean_angles
    moved = row.moved
    angles = row.moved_angles
    count = head.wave_count
    share, rise, bend = ramp_of_waves(M, t)
    if share == 0.0:
        return
    yaw = turning.position[YAW]
    low, high, part = between_headings(I, M, row, math.atan2(state.wave_y, state.wave_x) - yaw)
    first = head.raos + int(row.raos) - 1 + int(row.headings)
    near = first + low * count * RAO_WORDS
    far = first + high * count * RAO_WORDS
    way = state.wave_x * mean.position[0] + state.wave_y * mean.position[1]
    speed = state.wave_x * mean.velocity[0] + state.wave_y * mean.velocity[1]
    gain = state.wave_x * mean.acceleration[0] + state.wave_y * mean.acceleration[1]
    c = math.cos(yaw)
    s = math.sin(yaw)
    numbers = view(M, column(I, W_NUMBER), count)
    frequencies = view(M, column(I, W_FREQUENCY), count)
    amplitudes = view(M, column(I, W_AMPLITUDE), count)
    phases = view(M, column(I, W_PHASE), count)
    surge, surge_rate, surge_gain = 0.0, 0.0, 0.0
    for freedom in range(6):
        u, du, ddu = 0.0, 0.0, 0.0
        for n in range(count):
            number = numbers[n]
            frequency = frequencies[n]
            a = amplitudes[n]
            phase = number * way - frequency * t + phases[n]
            rate = number * speed - frequency
            at = n * RAO_WORDS + RESPONSE_WORDS * freedom
            before = wave_response_at(M, near + at)
            beyond = wave_response_at(M, far + at)
            even = (1.0 - part) * before.even + part * beyond.even
            odd = (1.0 - part) * before.odd + part * beyond.odd
            cosine = math.cos(phase)
            sine = math.sin(phase)
            value = a * (even * cosine + odd * sine)
            turned = a * (odd * cosine - even * sine)
            u += value
            du += rate * turned
            ddu += number * gain * turned - rate * rate * value
        ddu = share * ddu + 2.0 * rise * du + bend * u
        du = share * du + rise * u
        u = share * u
        if freedom == 0:
            surge, surge_rate, surge_gain = u, du, ddu
        elif freedom == 1:
            # Surge and sway turn with the vessel's heading.
            turn, twist = turning.velocity[YAW], turning.acceleration[YAW]
            for axis in range(2):
                along = c if axis == 0 else s
                across = -s if axis == 0 else c
                r = along * surge + across * u
                v = along * surge_rate + across * du
                side = (-s if axis == 0 else c) * surge + (-c if axis == 0 else -s) * u
                drift = (-s if axis == 0 else c) * surge_rate + (-c if axis == 0 else -s) * du
                moved.position[axis] += r
                moved.velocity[axis] += v + turn * side
                moved.acceleration[axis] += along * surge_gain + across * ddu + 2.0 * turn * drift
                moved.acceleration[axis] += twist * side - turn * turn * r
        elif freedom == 2:
            moved.position[UP] += u
            moved.velocity[UP] += du
            moved.acceleration[UP] += ddu
        else:
            angles.position[freedom - 3] += u
            angles.velocity[freedom - 3] += du
            angles.acceleration[freedom - 3] += ddu
