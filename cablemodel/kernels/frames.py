"""Frames that move as prescribed: vessels with their points, driven ends.

A frame's origin and its roll, pitch and yaw follow pieces of motion, as the tow point of a scene of
one line does (`environment.evaluate_piece`), or what the caller gives for a step.
"""

import math

from .access import constraint_of, frame_of, header, motion_piece_at, scalars
from .compile import kernel
from .environment import evaluate_piece
from .layout import (
    EXACTLY,
    GIVEN_POSITION,
    GIVEN_RATE,
    GIVEN_VELOCITY,
    HELD_BY_FRAME,
    LIVE,
    LIVE_NOT,
    LIVE_RETURNS,
    PIECE_WORDS,
)
from .raos import add_response
from .rotation import attitude, cross, to_earth_axes


@kernel
def piece_at(M, first, count, t):
    """Word of the piece with start < t <= end among `count` from word `first` on."""
    k = 0
    while k < count - 1 and t > motion_piece_at(M, first + k * PIECE_WORDS).end:
        k += 1
    return first + k * PIECE_WORDS


@kernel
def evaluate_frame(I, M, row, t, turning, out):
    """Position of a frame's origin, or its angles, with two derivatives at time t: 9 words."""
    if (row.turn_live if turning else row.live) != LIVE_NOT:
        evaluate_piece(M, row.turn_piece if turning else row.piece, t, out)
        return
    own_pieces(I, M, row, t, turning, out)
    for i in range(3):
        out[i] += row.shift[(3 if turning else 0) + i]


@kernel
def own_pieces(I, M, row, t, turning, out):
    """The same by the frame's own pieces, without the shift; angles that have none are zero."""
    head = header(I)
    count = int(row.turn_count if turning else row.count)
    if count == 0:
        for i in range(9):
            out[i] = 0.0
        return
    first = head.frame_pieces + int(row.turn_first if turning else row.first) * PIECE_WORDS
    evaluate_piece(M, motion_piece_at(M, piece_at(M, first, count, t)), t, out)


@kernel
def frame_breaks(M, head, row, before, after):
    """Whether another piece of a frame's own motion begins between two times."""
    for turning in range(2):
        if (row.turn_live if turning else row.live) != LIVE_NOT:
            continue
        count = int(row.turn_count if turning else row.count)
        first = head.frame_pieces + int(row.turn_first if turning else row.first) * PIECE_WORDS
        if count > 1 and piece_at(M, first, count, before) != piece_at(M, first, count, after):
            return True
    return False


@kernel
def move_frames(I, M, t):
    """Place, attitude and their rates of all frames at time t into their rows."""
    head = header(I)
    for n in range(head.frame_count):
        row = frame_of(I, M, n)
        if row.raos != 0.0:
            move_in_waves(I, M, row, t)
            continue
        evaluate_frame(I, M, row, t, True, row.motion)
        angles = row.motion
        attitude(
            angles[0:3],
            angles[3:6],
            angles[6:9],
            row.rotation,
            row.spin,
            row.spin_rate,
        )
        evaluate_frame(I, M, row, t, False, angles)


@kernel
def move_frames_on(I, M):
    """The same as the next step begins, by the pieces that begin there."""
    state = scalars(M)
    move_frames(I, M, state.time + state.smallest_step)


@kernel
def move_in_waves(I, M, row, t):
    """The same of one that the waves move."""
    mean = row.mean
    evaluate_frame(I, M, row, t, False, mean[0:9])
    evaluate_frame(I, M, row, t, True, mean[9:18])
    out = row.moved
    for i in range(18):
        out[i] = mean[i]
    add_response(I, M, row, t, out)
    attitude(
        out[9:12],
        out[12:15],
        out[15:18],
        row.rotation,
        row.spin,
        row.spin_rate,
    )
    for i in range(9):
        row.motion[i] = out[i]


@kernel
def point_motion(M, constraint, frame, out, w):
    """Position (block's coordinates), velocity and acceleration of a frame's point, 9 words.

    constraint, frame: words of their rows. w: 9 words.
    """
    state = scalars(M)
    arm = w[0:3]
    to_earth_axes(frame.rotation, constraint.position, arm)
    spin = frame.spin
    cross(spin, arm, w[3:6])
    cross(spin, w[3:6], w[6:9])
    for i in range(3):
        out[i] = frame.motion[i] + arm[i] - state.origin[i]
        out[3 + i] = frame.motion[3 + i] + w[3 + i]
        out[6 + i] = frame.motion[6 + i] + w[6 + i]
    cross(frame.spin_rate, arm, w[6:9])
    for i in range(3):
        out[6 + i] += w[6 + i]


@kernel
def turn_clamps(I, M):
    """Directions of clamps in the earth's frame, as their frames have turned."""
    head = header(I)
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.kind == HELD_BY_FRAME and row.clamped == EXACTLY:
            frame = frame_of(I, M, int(row.frame))
            own = row.own_direction
            to_earth_axes(frame.rotation, own, row.direction)


@kernel
def turn_slope(M, row, frame, q, v, a, at, w):
    """Slope at a clamp that turns, and its rates: along the direction u, d = g u with a free g.

    q, v, a: from word `at` on the slope; of each what lies along u tells g, dg/dt and its rate.
    w: 9 words.
    """
    u = row.direction
    spin = frame.spin
    cross(spin, u, w[0:3])  # du/dt
    cross(spin, w[0:3], w[3:6])
    cross(frame.spin_rate, u, w[6:9])
    g = 0.0
    rate = 0.0
    second = 0.0
    bent = 0.0
    for i in range(3):
        w[3 + i] += w[6 + i]  # its second derivative
        g += u[i] * q[at + i]
        rate += u[i] * v[at + i]
        second += u[i] * a[at + i]
        bent += u[i] * w[3 + i]
    second -= g * bent
    for i in range(3):
        q[at + i] = g * u[i]
        v[at + i] = rate * u[i] + g * w[i]
        a[at + i] = second * u[i] + 2.0 * rate * w[i] + g * w[3 + i]


@kernel
def is_a_stop(M, piece, dt):
    """Whether the start of a piece of motion is worth to land on, instead of a step of dt over it.

    A jump of the acceleration that a step smears over makes an error of about jump dt^2 / 8; below
    a tenth of the tolerance it is not, unless that, or a jump of the jerk, makes the line ring.
    """
    state = scalars(M)
    if piece.velocity_jump > 0.0:
        return True
    if piece.acceleration_jump * dt * dt > 0.8 * state.time_tolerance:
        return True
    if state.heard == 0.0:
        return False
    jump = piece.acceleration_jump + piece.jerk_jump / state.heard_frequency
    return state.heard < jump <= state.heard_most


@kernel
def next_frame_stop(I, M, stop, dt):
    """A time to land on exactly before `stop`, as step_size.next_stop, of all frames' pieces."""
    head = header(I)
    state = scalars(M)
    time = state.time
    for n in range(head.frame_count):
        row = frame_of(I, M, n)
        for turning in range(2):
            if (row.turn_live if turning == 1 else row.live) != LIVE_NOT:
                continue
            count = int(row.turn_count if turning == 1 else row.count)
            first = int(row.turn_first if turning == 1 else row.first)
            for k in range(1, count):
                piece = motion_piece_at(M, head.frame_pieces + (first + k) * PIECE_WORDS)
                start = piece.start
                if start <= time or start >= stop or start > time + dt:
                    continue
                if is_a_stop(M, piece, dt):
                    stop = start
    return stop


@kernel
def frames_jump(I, M, w):
    """The most by which the acceleration of a frame's point is another one than the state's
    [m/s2]. w: 18 words; `move_frames_on` has been called."""
    head = header(I)
    largest = 0.0
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.kind != HELD_BY_FRAME:
            continue
        frame = frame_of(I, M, int(row.frame))
        point_motion(M, row, frame, w[0:9], w[9:18])
        at = head.acceleration + 6 * int(row.node)
        changed = 0.0
        for i in range(3):
            changed += (w[6 + i] - M[at + i]) ** 2
        largest = max(largest, changed)
    return largest**0.5


@kernel
def drive_frame(I, M, row, t_end, given, target, w):
    """Make a frame's live pieces what the caller asks for at the end of a step.

    given: bits of what the caller gives (GIVEN_...); of place and attitude, what has none follows
    its own pieces, back to which it comes within a step. target: position, angles, velocity and
    rates of the angles at t_end (3 words each). Angles are reached by the shorter way. w: 18 words.
    """
    state = scalars(M)
    time = state.time
    dt = t_end - time
    for turning in range(2):
        kind = (given // GIVEN_RATE if turning == 1 else given) & (GIVEN_VELOCITY | GIVEN_POSITION)
        if kind == 0 and (row.turn_live if turning == 1 else row.live) != LIVE:
            if turning == 1:
                row.turn_live = LIVE_NOT
            else:
                row.live = LIVE_NOT
            continue
        evaluate_frame(I, M, row, time, turning == 1, w[0:9])
        if kind == 0:
            own_pieces(I, M, row, t_end, turning == 1, w[9:18])
        piece = row.turn_piece if turning == 1 else row.piece
        for i in range(3):
            p0 = w[i]
            v0 = w[3 + i]
            v1 = target[6 + 3 * turning + i]
            c2 = 0.0
            c3 = 0.0
            if kind >= 2:
                p1 = target[3 * turning + i]
                if turning == 1:
                    p1 += 2.0 * math.pi * math.floor((p0 - p1) / (2.0 * math.pi) + 0.5)
                mean = (p1 - p0) / dt
                if kind == 2:
                    v1 = mean
                c2 = (3.0 * mean - 2.0 * v0 - v1) / dt
                c3 = (v0 + v1 - 2.0 * mean) / (dt * dt)
            elif kind == 1:
                c2 = 0.5 * (v1 - v0) / dt
            else:
                v1 = w[12 + i]
                c2 = 0.5 * (v1 - v0) / dt
                row.shift[3 * turning + i] = p0 + 0.5 * (v0 + v1) * dt - w[9 + i]
            piece.data[i] = p0
            piece.data[3 + i] = v0
            piece.data[6 + i] = c2
            piece.data[9 + i] = c3
            piece.data[12 + i] = 0.0
        piece.start = time
        piece.end = t_end
        piece.kind = 0.0
        if turning == 1:
            row.turn_live = LIVE if kind != 0 else LIVE_RETURNS
        else:
            row.live = LIVE if kind != 0 else LIVE_RETURNS
