"""Vessels that the waves move: displacement response amplitude operators (RAOs).

Each component of the sea, a cos(theta) at the vessel's place, moves each degree of freedom by
a (A cos theta + B sin theta): surge and sway along the vessel's heading, heave, roll, pitch and
yaw. A and B depend on the heading of the waves from the bow, between whose rows they are linear;
the heading changes slowly against the waves.
"""

import math

from .compile import kernel, view
from .layout import (
    F_MEAN,
    F_RAOS,
    I_WAVES,
    O_RAOS,
    O_WAVES,
    RAO_HEADINGS,
    RAO_WORDS,
    S_WAVE_RAMP,
    S_WAVE_X,
    S_WAVE_Y,
    W_AMPLITUDE,
    W_FREQUENCY,
    W_NUMBER,
    W_PHASE,
)


@kernel
def ramp_of_waves(M, t):
    """Share of the waves that has come up at time t, and its two derivatives."""
    whole = M[S_WAVE_RAMP]
    if t <= 0.0:
        return 0.0, 0.0, 0.0
    if t >= whole:
        return 1.0, 0.0, 0.0
    x = t / whole
    share = x * x * x * (10.0 + x * (6.0 * x - 15.0))
    rise = 30.0 * x * x * (1.0 - x) ** 2 / whole
    return share, rise, 60.0 * x * (1.0 + x * (2.0 * x - 3.0)) / (whole * whole)


@kernel
def add_response(I, M, row, t, out):
    """Add what the waves do to a frame's place and angles (18 words: each with two derivatives).

    F_MEAN holds these without it. row: the frame's.
    """
    mean = view(M, row + F_MEAN, 18)
    count = I[I_WAVES]
    share, rise, bend = ramp_of_waves(M, t)
    if share == 0.0:
        return
    yaw = mean[11]
    x = (math.atan2(M[S_WAVE_Y], M[S_WAVE_X]) - yaw) * RAO_HEADINGS / (2.0 * math.pi)
    low = math.floor(x)
    part = x - low
    first = I[O_RAOS] + (int(M[row + F_RAOS]) - 1) * RAO_HEADINGS * count * RAO_WORDS
    near = first + int(low) % RAO_HEADINGS * count * RAO_WORDS
    far = first + (int(low) + 1) % RAO_HEADINGS * count * RAO_WORDS
    way = M[S_WAVE_X] * mean[0] + M[S_WAVE_Y] * mean[1]
    speed = M[S_WAVE_X] * mean[3] + M[S_WAVE_Y] * mean[4]
    gain = M[S_WAVE_X] * mean[6] + M[S_WAVE_Y] * mean[7]
    c = math.cos(yaw)
    s = math.sin(yaw)
    surge, surge_rate, surge_gain = 0.0, 0.0, 0.0
    for freedom in range(6):
        u, du, ddu = 0.0, 0.0, 0.0
        for n in range(count):
            number = M[I[O_WAVES] + W_NUMBER * count + n]
            frequency = M[I[O_WAVES] + W_FREQUENCY * count + n]
            a = M[I[O_WAVES] + W_AMPLITUDE * count + n]
            phase = number * way - frequency * t + M[I[O_WAVES] + W_PHASE * count + n]
            rate = number * speed - frequency
            at = n * RAO_WORDS + 2 * freedom
            even = (1.0 - part) * M[near + at] + part * M[far + at]
            odd = (1.0 - part) * M[near + at + 1] + part * M[far + at + 1]
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
            turn, twist = mean[14], mean[17]
            for axis in range(2):
                along = c if axis == 0 else s
                across = -s if axis == 0 else c
                r = along * surge + across * u
                v = along * surge_rate + across * du
                side = (-s if axis == 0 else c) * surge + (-c if axis == 0 else -s) * u
                drift = (-s if axis == 0 else c) * surge_rate + (-c if axis == 0 else -s) * du
                out[axis] += r
                out[3 + axis] += v + turn * side
                out[6 + axis] += along * surge_gain + across * ddu + 2.0 * turn * drift
                out[6 + axis] += twist * side - turn * turn * r
        elif freedom == 2:
            out[2] += u
            out[5] += du
            out[8] += ddu
        else:
            out[9 + freedom - 3] += u
            out[12 + freedom - 3] += du
            out[15 + freedom - 3] += ddu
