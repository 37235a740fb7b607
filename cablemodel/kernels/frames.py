"""Frames that move as prescribed: vessels with their points, driven ends.

A frame's origin and its roll, pitch and yaw follow pieces of motion, as the tow point of a scene of
one line does (`environment.evaluate_piece`), or what the caller gives for a step.
"""

from .compile import kernel, view
from .environment import evaluate_piece
from .layout import (
    C_CLAMPED,
    C_DIRECTION,
    C_FRAME,
    C_KIND,
    C_NODE,
    C_OWN_DIRECTION,
    C_POINT,
    C_POSITION,
    CONSTRAINT_WORDS,
    EXACTLY,
    F_ACCELERATION,
    F_COUNT,
    F_FIRST,
    F_LIVE,
    F_MEAN,
    F_MOVED,
    F_PIECE,
    F_POSITION,
    F_RAOS,
    F_ROTATION,
    F_SHIFT,
    F_SPIN,
    F_SPIN_RATE,
    F_TURN_COUNT,
    F_TURN_FIRST,
    F_TURN_LIVE,
    F_TURN_PIECE,
    F_VELOCITY,
    FRAME_WORDS,
    I_CONSTRAINTS,
    I_FRAMES,
    LIVE,
    LIVE_NOT,
    LIVE_RETURNS,
    O_ACCELERATION,
    O_CONSTRAINT,
    O_FRAME_PIECES,
    O_FRAMES,
    P_ACCELERATION_JUMP,
    P_DATA,
    P_END,
    P_KIND,
    P_START,
    P_VELOCITY_JUMP,
    PIECE_WORDS,
    S_BASE,
    S_TIME,
    S_TIME_TOLERANCE,
)
from .raos import add_response
from .rotation import attitude, cross, to_earth_axes


@kernel
def piece_at(M, first, count, t):
    """Word of the piece with start < t <= end among `count` from word `first` on."""
    k = 0
    while k < count - 1 and t > M[first + k * PIECE_WORDS + P_END]:
        k += 1
    return first + k * PIECE_WORDS


@kernel
def evaluate_frame(I, M, row, t, turning, out):
    """Position of a frame's origin, or its angles, with two derivatives at time t: 9 words."""
    if M[row + (F_TURN_LIVE if turning else F_LIVE)] != LIVE_NOT:
        evaluate_piece(M, row + (F_TURN_PIECE if turning else F_PIECE), t, out)
        return
    own_pieces(I, M, row, t, turning, out)
    for i in range(3):
        out[i] += M[row + F_SHIFT + (3 if turning else 0) + i]


@kernel
def own_pieces(I, M, row, t, turning, out):
    """The same by the frame's own pieces, without the shift; angles that have none are zero."""
    count = int(M[row + (F_TURN_COUNT if turning else F_COUNT)])
    if count == 0:
        for i in range(9):
            out[i] = 0.0
        return
    first = I[O_FRAME_PIECES] + PIECE_WORDS * int(M[row + (F_TURN_FIRST if turning else F_FIRST)])
    evaluate_piece(M, piece_at(M, first, count, t), t, out)


@kernel
def move_frames(I, M, t):
    """Place, attitude and their rates of all frames at time t into their rows."""
    for n in range(I[I_FRAMES]):
        row = I[O_FRAMES] + n * FRAME_WORDS
        if M[row + F_RAOS] != 0.0:
            move_in_waves(I, M, row, t)
            continue
        evaluate_frame(I, M, row, t, True, view(M, row + F_POSITION, 9))
        angles = view(M, row + F_POSITION, 9)
        attitude(
            angles[0:3],
            angles[3:6],
            angles[6:9],
            view(M, row + F_ROTATION, 9),
            view(M, row + F_SPIN, 3),
            view(M, row + F_SPIN_RATE, 3),
        )
        evaluate_frame(I, M, row, t, False, angles)


@kernel
def move_in_waves(I, M, row, t):
    """The same of one that the waves move."""
    mean = view(M, row + F_MEAN, 18)
    evaluate_frame(I, M, row, t, False, mean[0:9])
    evaluate_frame(I, M, row, t, True, mean[9:18])
    out = view(M, row + F_MOVED, 18)
    for i in range(18):
        out[i] = mean[i]
    add_response(I, M, row, t, out)
    attitude(
        out[9:12],
        out[12:15],
        out[15:18],
        view(M, row + F_ROTATION, 9),
        view(M, row + F_SPIN, 3),
        view(M, row + F_SPIN_RATE, 3),
    )
    for i in range(9):
        M[row + F_POSITION + i] = out[i]


@kernel
def point_motion(M, constraint, frame, out, w):
    """Position (block's coordinates), velocity and acceleration of a frame's point, 9 words.

    constraint, frame: words of their rows. w: 9 words.
    """
    arm = w[0:3]
    to_earth_axes(view(M, frame + F_ROTATION, 9), view(M, constraint + C_POSITION, 3), arm)
    spin = view(M, frame + F_SPIN, 3)
    cross(spin, arm, w[3:6])
    cross(spin, w[3:6], w[6:9])
    for i in range(3):
        out[i] = M[frame + F_POSITION + i] + arm[i] - M[S_BASE + i]
        out[3 + i] = M[frame + F_VELOCITY + i] + w[3 + i]
        out[6 + i] = M[frame + F_ACCELERATION + i] + w[6 + i]
    cross(view(M, frame + F_SPIN_RATE, 3), arm, w[6:9])
    for i in range(3):
        out[6 + i] += w[6 + i]


@kernel
def turn_clamps(I, M):
    """Directions of clamps in the earth's frame, as their frames have turned."""
    for n in range(I[I_CONSTRAINTS]):
        row = I[O_CONSTRAINT] + n * CONSTRAINT_WORDS
        if M[row + C_KIND] == C_POINT and M[row + C_CLAMPED] == EXACTLY:
            frame = I[O_FRAMES] + int(M[row + C_FRAME]) * FRAME_WORDS
            own = view(M, row + C_OWN_DIRECTION, 3)
            to_earth_axes(view(M, frame + F_ROTATION, 9), own, view(M, row + C_DIRECTION, 3))


@kernel
def turn_slope(M, row, frame, q, v, a, at, w):
    """Slope at a clamp that turns, and its rates: along the direction u, d = g u with a free g.

    q, v, a: from word `at` on the slope; of each what lies along u tells g, dg/dt and its rate.
    w: 9 words.
    """
    u = view(M, row + C_DIRECTION, 3)
    spin = view(M, frame + F_SPIN, 3)
    cross(spin, u, w[0:3])  # du/dt
    cross(spin, w[0:3], w[3:6])
    cross(view(M, frame + F_SPIN_RATE, 3), u, w[6:9])
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
def next_frame_stop(I, M, stop, dt):
    """A time to land on exactly before `stop`, as step_size.next_stop, of all frames' pieces."""
    time = M[S_TIME]
    for n in range(I[I_FRAMES]):
        row = I[O_FRAMES] + n * FRAME_WORDS
        for turning in range(2):
            if M[row + (F_TURN_LIVE if turning == 1 else F_LIVE)] != LIVE_NOT:
                continue
            count = int(M[row + (F_TURN_COUNT if turning == 1 else F_COUNT)])
            first = int(M[row + (F_TURN_FIRST if turning == 1 else F_FIRST)])
            for k in range(1, count):
                piece = I[O_FRAME_PIECES] + (first + k) * PIECE_WORDS
                start = M[piece + P_START]
                if start <= time or start >= stop or start > time + dt:
                    continue
                if (
                    M[piece + P_VELOCITY_JUMP] > 0.0
                    or M[piece + P_ACCELERATION_JUMP] * dt * dt > 0.8 * M[S_TIME_TOLERANCE]
                ):
                    stop = start
    return stop


@kernel
def frames_jump(I, M, w):
    """The most by which the acceleration of a frame's point is another one than the state's
    [m/s2]. w: 18 words; `move_frames` has been called."""
    largest = 0.0
    for n in range(I[I_CONSTRAINTS]):
        row = I[O_CONSTRAINT] + n * CONSTRAINT_WORDS
        if M[row + C_KIND] != C_POINT:
            continue
        frame = I[O_FRAMES] + int(M[row + C_FRAME]) * FRAME_WORDS
        point_motion(M, row, frame, w[0:9], w[9:18])
        at = I[O_ACCELERATION] + 6 * int(M[row + C_NODE])
        changed = 0.0
        for i in range(3):
            changed += (w[6 + i] - M[at + i]) ** 2
        largest = max(largest, changed)
    return largest**0.5


@kernel
def drive_frame(I, M, row, t_end, given, target, w):
    """Make a frame's live pieces what the caller asks for at the end of a step.

    given: of its place 1 a velocity, 2 a position, 3 both, and 4 times as much of its attitude;
    what has none follows its own pieces, back to which it comes within a step. target: position,
    angles, velocity and rates of the angles at t_end (3 words each). w: 18 words.
    """
    time = M[S_TIME]
    dt = t_end - time
    for turning in range(2):
        live = row + (F_TURN_LIVE if turning == 1 else F_LIVE)
        kind = (given >> 2 if turning == 1 else given) & 3
        if kind == 0 and M[live] != LIVE:
            M[live] = LIVE_NOT
            continue
        evaluate_frame(I, M, row, time, turning == 1, w[0:9])
        if kind == 0:
            own_pieces(I, M, row, t_end, turning == 1, w[9:18])
        piece = row + (F_TURN_PIECE if turning == 1 else F_PIECE)
        for i in range(3):
            p0 = w[i]
            v0 = w[3 + i]
            v1 = target[6 + 3 * turning + i]
            c2 = 0.0
            c3 = 0.0
            if kind >= 2:
                mean = (target[3 * turning + i] - p0) / dt
                if kind == 2:
                    v1 = mean
                c2 = (3.0 * mean - 2.0 * v0 - v1) / dt
                c3 = (v0 + v1 - 2.0 * mean) / (dt * dt)
            elif kind == 1:
                c2 = 0.5 * (v1 - v0) / dt
            else:
                v1 = w[12 + i]
                c2 = 0.5 * (v1 - v0) / dt
                M[row + F_SHIFT + 3 * turning + i] = p0 + 0.5 * (v0 + v1) * dt - w[9 + i]
            M[piece + P_DATA + i] = p0
            M[piece + P_DATA + 3 + i] = v0
            M[piece + P_DATA + 6 + i] = c2
            M[piece + P_DATA + 9 + i] = c3
            M[piece + P_DATA + 12 + i] = 0.0
        M[piece + P_START] = time
        M[piece + P_END] = t_end
        M[piece + P_KIND] = 0.0
        M[live] = LIVE if kind != 0 else LIVE_RETURNS
