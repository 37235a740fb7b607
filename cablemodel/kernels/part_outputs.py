"""Systems of parts: what the caller drives, and what is read of bodies, frames and lines' ends."""

from .compile import kernel, view
from .frames import drive_frame, evaluate_frame
from .free_bodies import deflect_foils, push_bodies
from .layout import (
    C_NODE,
    CONSTRAINT_WORDS,
    CUT_ORDERED,
    CUT_WORDS,
    E_LENGTH,
    EDGE_WORDS,
    F_POSITION,
    FRAME_INPUTS,
    FRAME_WORDS,
    FREE_WORDS,
    I_CONSTRAINTS,
    I_CUTS,
    I_FOILS,
    I_FRAMES,
    I_FREE,
    M_GAIN,
    M_PLACE,
    M_SPEED,
    M_SPIN,
    M_SPIN_RATE,
    M_TURN,
    O_CONSTRAINT,
    O_CUTS,
    O_EDGE,
    O_FRAMES,
    O_FREE,
    O_MOTION,
    O_RESIDUAL,
    PART_WORDS,
    S_BASE,
    S_TIME,
    STATION_WORDS,
    Y_MOTION,
    Y_ORIGIN,
)
from .outputs import end_forces, station_in_element
from .rotation import cross, to_earth_axes


@kernel
def drive_parts(I, M, t_end, motion, forces, angles, orders):
    """Inputs of a step to t_end: see entry.drive."""
    for n in range(I[I_FRAMES]):
        row = I[O_FRAMES] + n * FRAME_WORDS
        given = int(motion[FRAME_INPUTS * n])
        target = motion[FRAME_INPUTS * n + 1 : FRAME_INPUTS * (n + 1)]
        drive_frame(I, M, row, t_end, given, target, view(M, I[O_MOTION] + 28, 18))
    push_bodies(I, M, t_end, forces)
    deflect_foils(I, M, t_end, angles, I[I_FOILS])
    for n in range(I[I_CUTS]):
        if orders[n] != 0.0:
            M[I[O_CUTS] + n * CUT_WORDS + CUT_ORDERED] = 1.0


@kernel
def frame_motion(I, M, n, out):
    """Place and angles of a frame, without what waves add, and two derivatives of each (18)."""
    row = I[O_FRAMES] + n * FRAME_WORDS
    evaluate_frame(I, M, row, M[S_TIME], False, out[0:9])
    evaluate_frame(I, M, row, M[S_TIME], True, out[9:18])


@kernel
def element_stations(I, M, elements, fractions, out):
    """State at fractions of elements: rows of STATION_WORDS, as outputs.sample_stations."""
    end_forces(I, M)
    for n in range(len(elements)):
        node = int(elements[n])
        s = fractions[n] * M[I[O_EDGE] + node * EDGE_WORDS + E_LENGTH]
        station_in_element(I, M, node, fractions[n], s, out, STATION_WORDS * n)


@kernel
def parts_motion(I, M, bodies, frames, ends):
    """Motion of all bodies and frames (PART_WORDS words each), and the forces
    that the supports exert at the nodes that are held, 3 words each in the order of constraints."""
    end_forces(I, M)
    for n in range(I[I_FREE]):
        row = I[O_FREE] + n * FREE_WORDS
        m = view(M, row + Y_MOTION, 33)
        origin = view(M, row + Y_ORIGIN, 3)
        w = view(M, I[O_MOTION] + 28, 15)
        out = bodies[PART_WORDS * n : PART_WORDS * (n + 1)]
        turn = m[M_TURN : M_TURN + 9]
        spin = m[M_SPIN : M_SPIN + 3]
        to_earth_axes(turn, origin, w[0:3])
        cross(spin, origin, w[3:6])
        to_earth_axes(turn, w[3:6], w[6:9])
        cross(spin, w[3:6], w[9:12])
        cross(m[M_SPIN_RATE : M_SPIN_RATE + 3], origin, w[3:6])
        for i in range(3):
            out[i] = m[M_PLACE + i] + w[i] + M[S_BASE + i]
            out[3 + i] = m[M_SPEED + i] + w[6 + i]
            w[3 + i] += w[9 + i]
        to_earth_axes(turn, w[3:6], w[0:3])
        for i in range(3):
            out[6 + i] = m[M_GAIN + i] + w[i]
        for i in range(9):
            out[9 + i] = turn[i]
        to_earth_axes(turn, spin, out[18:21])
        to_earth_axes(turn, m[M_SPIN_RATE : M_SPIN_RATE + 3], out[21:24])
    for n in range(I[I_FRAMES]):
        for i in range(PART_WORDS):
            frames[PART_WORDS * n + i] = M[I[O_FRAMES] + n * FRAME_WORDS + F_POSITION + i]
    for n in range(I[I_CONSTRAINTS]):
        node = int(M[I[O_CONSTRAINT] + n * CONSTRAINT_WORDS + C_NODE])
        for i in range(3):
            ends[3 * n + i] = M[I[O_RESIDUAL] + 6 * node + i]
