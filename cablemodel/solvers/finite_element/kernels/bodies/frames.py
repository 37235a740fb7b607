"""Frames that move as prescribed: vessels with their points, driven ends.

A frame's origin and its roll, pitch and yaw follow pieces of motion, as the tow point of a scene of
one line does (`environment.evaluate_piece`), or what the caller gives for a step.
"""

import math

from cablemodel.solvers.finite_element.kernels.bodies.raos import add_response
from cablemodel.solvers.finite_element.kernels.bodies.rotation import attitude, cross, to_earth_axes
from cablemodel.solvers.shared.access import (
    constraint_of,
    frame_input_at,
    frame_of,
    header,
    motion_piece_at,
    new_motion,
    scalars,
    vector,
)
from cablemodel.solvers.shared.compile import kernel
from cablemodel.solvers.shared.environment import begin_cubic, evaluate_piece
from cablemodel.solvers.shared.layout import (
    EXACTLY,
    FRAME_INPUTS,
    GIVEN_POSITION,
    GIVEN_RATE,
    GIVEN_VELOCITY,
    HELD_BY_FRAME,
    LIVE,
    LIVE_NOT,
    LIVE_RETURNS,
    PIECE_WORDS,
)

STOP_SEEN = 0.8  # of a step's tolerance: a jump times dt^2, which makes an eighth of it an error


@kernel
def piece_at(M, first, count, t):
    """Word of the piece with start < t <= end among `count` from word `first` on."""
    k = 0
    while k < count - 1 and t > motion_piece_at(M, first + k * PIECE_WORDS).end:
        k += 1
    return first + k * PIECE_WORDS


@kernel
def evaluate_frame(I, M, row, t, turning, out):
    """Motion of a frame's origin, or that of its angles, at time t."""
    if (row.turn_live if turning else row.live) != LIVE_NOT:
        evaluate_piece(M, row.turn_piece if turning else row.piece, t, out)
        return
    own_pieces(I, M, row, t, turning, out)
    for i in range(3):
        out.position[i] += row.shift[(3 if turning else 0) + i]


@kernel
def own_pieces(I, M, row, t, turning, out):
    """The same by the frame's own pieces, without the shift; angles that have none are zero."""
    head = header(I)
    count = int(row.turn_count if turning else row.count)
    if count == 0:
        for i in range(3):
            out.position[i] = 0.0
            out.velocity[i] = 0.0
            out.acceleration[i] = 0.0
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
        angles = new_motion()
        evaluate_frame(I, M, row, t, True, angles)
        turn_frame(row, angles)
        evaluate_frame(I, M, row, t, False, row.motion)


@kernel
def turn_frame(row, angles):
    """Axes and turning of a frame by the motion of its angles."""
    attitude(
        angles.position,
        angles.velocity,
        angles.acceleration,
        row.rotation,
        row.spin,
        row.spin_rate,
    )


@kernel
def move_frames_on(I, M):
    """The same as the next step begins, by the pieces that begin there."""
    state = scalars(M)
    move_frames(I, M, state.time + state.smallest_step)


@kernel
def take_motion(motion, other):
    """Make a Motion the same as another."""
    for i in range(3):
        motion.position[i] = other.position[i]
        motion.velocity[i] = other.velocity[i]
        motion.acceleration[i] = other.acceleration[i]


@kernel
def move_in_waves(I, M, row, t):
    """The same of one that the waves move."""
    evaluate_frame(I, M, row, t, False, row.mean)
    evaluate_frame(I, M, row, t, True, row.mean_angles)
    take_motion(row.moved, row.mean)
    take_motion(row.moved_angles, row.mean_angles)
    add_response(I, M, row, t)
    turn_frame(row, row.moved_angles)
    take_motion(row.motion, row.moved)


@kernel
def point_motion(M, constraint, frame, out):
    """Motion of a frame's point, its place in the block's coordinates."""
    state = scalars(M)
    motion = frame.motion
    arm = vector()
    turning = vector()  # what the frame's spin adds to the velocity
    inward = vector()  # and to the acceleration
    to_earth_axes(frame.rotation, constraint.position, arm)
    cross(frame.spin, arm, turning)
    cross(frame.spin, turning, inward)
    for i in range(3):
        out.position[i] = motion.position[i] + arm[i] - state.origin[i]
        out.velocity[i] = motion.velocity[i] + turning[i]
        out.acceleration[i] = motion.acceleration[i] + inward[i]
    cross(frame.spin_rate, arm, turning)
    for i in range(3):
        out.acceleration[i] += turning[i]


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
def turn_slope(row, frame, q, v, a, at):
    """Slope at a clamp that turns, and its rates: along the direction u, d = g u with a free g.

    q, v, a: from word `at` on the slope; of each what lies along u tells g, dg/dt and its rate.
    """
    u = row.direction
    turn = vector()  # du/dt
    turn_rate = vector()
    faster = vector()
    cross(frame.spin, u, turn)
    cross(frame.spin, turn, turn_rate)
    cross(frame.spin_rate, u, faster)
    g = 0.0
    rate = 0.0
    second = 0.0
    bent = 0.0
    for i in range(3):
        turn_rate[i] += faster[i]
        g += u[i] * q[at + i]
        rate += u[i] * v[at + i]
        second += u[i] * a[at + i]
        bent += u[i] * turn_rate[i]
    second -= g * bent
    for i in range(3):
        q[at + i] = g * u[i]
        v[at + i] = rate * u[i] + g * turn[i]
        a[at + i] = second * u[i] + 2.0 * rate * turn[i] + g * turn_rate[i]


@kernel
def is_a_stop(M, piece, dt):
    """Whether the start of a piece of motion is worth to land on, instead of a step of dt over it.

    A jump of the acceleration that a step smears over makes an error of about jump dt^2 / 8; below
    a tenth of the tolerance it is not, unless that, or a jump of the jerk, makes the line ring.
    """
    state = scalars(M)
    if piece.velocity_jump > 0.0:
        return True
    if piece.acceleration_jump * dt * dt > STOP_SEEN * state.time_tolerance:
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
def frames_jump(I, M):
    """The most by which the acceleration of a frame's point is another one than the state's
    [m/s2]; `move_frames_on` has been called."""
    head = header(I)
    motion = new_motion()
    largest = 0.0
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.kind != HELD_BY_FRAME:
            continue
        frame = frame_of(I, M, int(row.frame))
        point_motion(M, row, frame, motion)
        at = head.acceleration + 6 * int(row.node)
        changed = 0.0
        for i in range(3):
            changed += (motion.acceleration[i] - M[at + i]) ** 2
        largest = max(largest, changed)
    return largest**0.5


@kernel
def read_frames(I, M, out):
    """How all frames move at the present time, without what waves add: a FrameInput of each."""
    now = new_motion()
    for n in range(header(I).frame_count):
        row = frame_of(I, M, n)
        found = frame_input_at(out, FRAME_INPUTS * n)
        evaluate_frame(I, M, row, scalars(M).time, False, now)
        for i in range(3):
            found.position[i] = now.position[i]
            found.velocity[i] = now.velocity[i]
        evaluate_frame(I, M, row, scalars(M).time, True, now)
        for i in range(3):
            found.attitude[i] = now.position[i]
            found.attitude_rate[i] = now.velocity[i]


@kernel
def drive_frame(I, M, row, t_end, wanted):
    """Make a frame's live pieces what the caller asks for at the end of a step, a FrameInput.

    Of place and attitude, what is not given follows its own pieces, back to which it comes within
    a step. Angles are reached by the shorter way.
    """
    state = scalars(M)
    now = new_motion()
    own = new_motion()
    given = int(wanted.given)
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
        evaluate_frame(I, M, row, time, turning == 1, now)
        if kind == 0:
            own_pieces(I, M, row, t_end, turning == 1, own)
        law = begin_cubic(row.turn_piece if turning == 1 else row.piece, time, t_end)
        place = wanted.attitude if turning == 1 else wanted.position
        velocity = wanted.attitude_rate if turning == 1 else wanted.velocity
        for i in range(3):
            p0 = now.position[i]
            v0 = now.velocity[i]
            v1 = velocity[i]
            c2 = 0.0
            c3 = 0.0
            if kind >= 2:
                p1 = place[i]
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
                v1 = own.velocity[i]
                c2 = 0.5 * (v1 - v0) / dt
                row.shift[3 * turning + i] = p0 + 0.5 * (v0 + v1) * dt - own.position[i]
            law.position[i] = p0
            law.velocity[i] = v0
            law.second[i] = c2
            law.third[i] = c3
        if turning == 1:
            row.turn_live = LIVE if kind != 0 else LIVE_RETURNS
        else:
            row.live = LIVE if kind != 0 else LIVE_RETURNS
