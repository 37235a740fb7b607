"""Systems of parts: what the caller drives, and what is read of bodies, frames and lines' ends."""

from .access import (
    constraint_of,
    cut_of,
    edge_of,
    frame_of,
    free_body_of,
    header,
    part_motion_at,
    scalars,
    station_at,
)
from .compile import kernel, view
from .frames import drive_frame
from .free_bodies import deflect_foils, push_bodies
from .layout import (
    EXACTLY,
    FRAME_INPUTS,
    HELD_BY_FRAME,
    PART_WORDS,
    STATION_WORDS,
    PartMotion,
)
from .outputs import end_forces, station_in_element
from .rotation import angles_of, cross, to_earth_axes
from .winch import drive_winch

WRENCH = PartMotion.wrench.word


@kernel
def drive_parts(I, M, t_end, motion, forces, angles, rates, orders):
    """Inputs of a step to t_end: see entry.drive."""
    head = header(I)
    for n in range(head.frame_count):
        row = frame_of(I, M, n)
        given = int(motion[FRAME_INPUTS * n])
        target = motion[FRAME_INPUTS * n + 1 : FRAME_INPUTS * (n + 1)]
        drive_frame(I, M, row, t_end, given, target, view(M, head.motion + 28, 18))
    push_bodies(I, M, t_end, forces)
    deflect_foils(I, M, t_end, angles, head.foil_count)
    for n in range(head.winch_count):
        drive_winch(I, M, n, t_end, rates[2 * n] != 0.0, rates[2 * n + 1])
    for n in range(head.cut_count):
        if orders[n] != 0.0:
            cut_of(I, M, n).ordered = 1.0


@kernel
def element_stations(I, M, elements, fractions, out):
    """State at fractions of elements: rows of a Station, as outputs.sample_stations."""
    end_forces(I, M)
    for n in range(len(elements)):
        node = int(elements[n])
        s = fractions[n] * edge_of(I, M, node).length
        station_in_element(I, M, node, fractions[n], s, station_at(out, STATION_WORDS * n))


@kernel
def parts_motion(I, M, bodies, frames):
    """Motion of all bodies and frames, and the lines' forces and moments on frames about their
    origins: a PartMotion each."""
    head = header(I)
    state = scalars(M)
    end_forces(I, M)
    for n in range(head.free_count):
        row = free_body_of(I, M, n)
        m = row.motion
        origin = row.origin
        w = view(M, head.motion + 28, 15)
        found = part_motion_at(bodies, PART_WORDS * n)
        turn = m.turn
        spin = m.spin
        to_earth_axes(turn, origin, w[0:3])
        cross(spin, origin, w[3:6])
        to_earth_axes(turn, w[3:6], w[6:9])
        cross(spin, w[3:6], w[9:12])
        cross(m.spin_rate, origin, w[3:6])
        for i in range(3):
            found.position[i] = m.reference[i] + w[i] + state.origin[i]
            found.velocity[i] = m.reference[3 + i] + w[6 + i]
            w[3 + i] += w[9 + i]
        to_earth_axes(turn, w[3:6], w[0:3])
        for i in range(3):
            found.acceleration[i] = m.reference[6 + i] + w[i]
        for i in range(9):
            found.axes[i] = turn[i]
        to_earth_axes(turn, spin, found.angular_velocity)
        to_earth_axes(turn, m.spin_rate, found.angular_acceleration)
        angles_of(turn, found.attitude)
        found.wrench[:] = 0.0
    for n in range(head.frame_count):
        frame = frame_of(I, M, n)
        found = part_motion_at(frames, PART_WORDS * n)
        for i in range(3):
            found.position[i] = frame.motion[i]
            found.velocity[i] = frame.motion[3 + i]
            found.acceleration[i] = frame.motion[6 + i]
            found.angular_velocity[i] = frame.spin[i]
            found.angular_acceleration[i] = frame.spin_rate[i]
        for i in range(9):
            found.axes[i] = frame.rotation[i]
        angles_of(found.axes, found.attitude)
        found.wrench[:] = 0.0
    add_wrenches(I, M, head.position, frames, PART_WORDS, WRENCH)


@kernel
def add_wrenches(I, M, place, out, words, first):
    """Add the lines' forces and moments on frames about their origins, earth frame: 6 words from
    word `first` of a frame's row of `words`. place: word of the positions whose residual it is."""
    head = header(I)
    state = scalars(M)
    w = view(M, head.motion + 28, 9)
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.kind != HELD_BY_FRAME:
            continue
        node = int(row.node)
        origin = frame_of(I, M, int(row.frame)).motion
        at = words * int(row.frame) + first
        force = view(M, head.residual + 6 * node, 3)
        for i in range(3):
            w[i] = M[place + 6 * node + i] + state.origin[i] - origin[i]
        cross(w[0:3], force, w[3:6])
        for i in range(3):
            w[6 + i] = 0.0
        if row.clamped == EXACTLY:
            bend = view(M, head.residual + 6 * node + 3, 3)
            cross(view(M, place + 6 * node + 3, 3), bend, w[6:9])
        for i in range(3):
            out[at + i] -= force[i]
            out[at + 3 + i] -= w[3 + i] + w[6 + i]
