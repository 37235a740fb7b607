"""Systems of parts: what the caller drives, and what is read of bodies, frames and lines' ends."""

import math

from cablemodel.solvers.finite_element.kernels.bodies.frames import drive_frame
from cablemodel.solvers.finite_element.kernels.bodies.free_bodies import (
    deflect_foils,
    point_of_body,
    push_bodies,
)
from cablemodel.solvers.finite_element.kernels.bodies.rotation import (
    angles_of,
    cross,
    to_earth_axes,
)
from cablemodel.solvers.finite_element.kernels.element.tension_along import tension_range
from cablemodel.solvers.finite_element.kernels.outputs.stations import station_in_element
from cablemodel.solvers.finite_element.kernels.outputs.summary import end_forces, read_floor
from cablemodel.solvers.shared.access import (
    constraint_of,
    cut_of,
    edge_of,
    frame_input_at,
    frame_of,
    free_body_of,
    header,
    new_motion,
    part_motion_at,
    scalars,
    station_at,
    summary_at,
    vector,
)
from cablemodel.solvers.shared.compile import kernel, view
from cablemodel.solvers.shared.inputs import drive_winch
from cablemodel.solvers.shared.layout import (
    EXACTLY,
    FRAME_INPUTS,
    HELD_BY_FRAME,
    PART_WORDS,
    STATION_WORDS,
    PartMotion,
)
from cablemodel.solvers.shared.summary import clear_floor

WRENCH = PartMotion.wrench.word


@kernel
def drive_parts(I, M, t_end, motion, forces, angles, rates, orders):
    """Inputs of a step to t_end: see entry.drive."""
    head = header(I)
    for n in range(head.frame_count):
        drive_frame(I, M, frame_of(I, M, n), t_end, frame_input_at(motion, FRAME_INPUTS * n))
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
def tension_ranges(I, M, elements, out):
    """Lowest and highest tension of elements, as stations have it: 2 words of each."""
    end_forces(I, M)
    for n in range(len(elements)):
        out[2 * n], out[2 * n + 1] = tension_range(I, M, int(elements[n]))


@kernel
def floor_of_line(I, M, elements, out):
    """What the floor does to a line: see entry.floor_of_line."""
    found = summary_at(out, 0)
    clear_floor(found, math.nan)
    if header(I).floor_kind != 0:
        read_floor(I, M, elements, found)


@kernel
def parts_motion(I, M, bodies, frames):
    """Motion of all bodies and frames, and the lines' forces and moments on frames about their
    origins: a PartMotion each."""
    head = header(I)
    state = scalars(M)
    end_forces(I, M)
    motion = new_motion()
    for n in range(head.free_count):
        row = free_body_of(I, M, n)
        m = row.motion
        found = part_motion_at(bodies, PART_WORDS * n)
        point_of_body(m, row.origin, motion)
        for i in range(3):
            found.position[i] = motion.position[i] + state.origin[i]
            found.velocity[i] = motion.velocity[i]
            found.acceleration[i] = motion.acceleration[i]
        for i in range(9):
            found.axes[i] = m.turn[i]
        to_earth_axes(m.turn, m.spin, found.angular_velocity)
        to_earth_axes(m.turn, m.spin_rate, found.angular_acceleration)
        angles_of(found.axes, found.attitude)
        found.wrench[:] = 0.0
    for n in range(head.frame_count):
        frame = frame_of(I, M, n)
        found = part_motion_at(frames, PART_WORDS * n)
        for i in range(3):
            found.position[i] = frame.motion.position[i]
            found.velocity[i] = frame.motion.velocity[i]
            found.acceleration[i] = frame.motion.acceleration[i]
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
    arm = vector()
    of_force = vector()
    of_clamp = vector()
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.kind != HELD_BY_FRAME:
            continue
        at = 6 * int(row.node)
        origin = frame_of(I, M, int(row.frame)).motion.position
        to = words * int(row.frame) + first
        force = view(M, head.residual + at, 3)
        for i in range(3):
            arm[i] = M[place + at + i] + state.origin[i] - origin[i]
            of_clamp[i] = 0.0
        cross(arm, force, of_force)
        if row.clamped == EXACTLY:
            cross(view(M, place + at + 3, 3), view(M, head.residual + at + 3, 3), of_clamp)
        for i in range(3):
            out[to + i] -= force[i]
            out[to + 3 + i] -= of_force[i] + of_clamp[i]
