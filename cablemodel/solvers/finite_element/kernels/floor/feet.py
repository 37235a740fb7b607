"""Free bodies on the sea floor: places of a body that touch it, its feet.

The law is that of the cable's contact (contact.py): each foot bears its part of the body's weight
at rest where it just touches, and friction holds it by a bristle.
"""

from cablemodel.solvers.finite_element.kernels.bodies.rotation import (
    cross,
    to_body_axes,
    to_earth_axes,
)
from cablemodel.solvers.finite_element.kernels.floor.contact import (
    along_floor,
    contact_law,
    damping_time,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at
from cablemodel.solvers.shared.access import foot_of, free_body_of, header, scalars, vector
from cablemodel.solvers.shared.compile import kernel, own_record
from cablemodel.solvers.shared.record import Record, reals


class FootOnFloor(Record):
    """A foot at the motion in its body's row, in the block's coordinates."""

    place = reals(3, "where it is", "m")
    normal = reals(3, "of the floor below it")
    velocity = reals(3, "of it", "m/s")


foot_on_floor = own_record(FootOnFloor)


@kernel
def place_foot(I, M, foot, at):
    """Place of a foot, the floor's normal and its velocity, at the motion in its body's row;
    returns its gap [m]."""
    m = free_body_of(I, M, int(foot.body)).motion
    turning = vector()
    cross(m.spin, foot.place, turning)
    to_earth_axes(m.turn, turning, at.velocity)
    to_earth_axes(m.turn, foot.place, at.place)
    for i in range(3):
        at.place[i] += m.reference.position[i]
        at.velocity[i] += m.reference.velocity[i]
    return gap_at(I, M, at.place, at.normal)


@kernel
def lowest_foot(I, M):
    """The least gap of all feet [m]; far above without any."""
    lowest = 1e300
    at = foot_on_floor()
    for n in range(header(I).foot_count):
        lowest = min(lowest, place_foot(I, M, foot_of(I, M, n), at))
    return lowest


@kernel
def feet_are_near(I, M, depth, step, lengths):
    """Whether a foot is within so many sizes of its body of the floor, or comes there in a step."""
    at = foot_on_floor()
    for n in range(header(I).foot_count):
        foot = foot_of(I, M, n)
        gap = place_foot(I, M, foot, at)
        size = free_body_of(I, M, int(foot.body)).size
        if gap < depth + lengths * size + step * max(0.0, -at.velocity[2]):
            return True
    return False


@kernel
def add_feet(I, M, body, f):
    """Subtract the floor's forces on a body's feet from f (6), body's axes."""
    head = header(I)
    state = scalars(M)
    depth = state.floor_depth
    m = free_body_of(I, M, body).motion
    at = foot_on_floor()
    normal = at.normal
    bristle = vector()
    owner = free_body_of(I, M, body)
    heavy = max(owner.weight - owner.buoyancy, 1e-300)
    force = vector()
    own = vector()  # that force in the body's axes
    moment = vector()
    for n in range(head.foot_count):
        foot = foot_of(I, M, n)
        if int(foot.body) != body:
            continue
        gap = place_foot(I, M, foot, at)
        if gap >= depth:
            continue
        load = foot.load
        share, _stiffness, _energy = contact_law(gap, depth)
        ahead = damping_time(M, load * foot.pressed, load / heavy * owner.solid[0])
        speed = 0.0
        for i in range(3):
            speed += at.velocity[i] * normal[i]
            bristle[i] = at.place[i] - foot.rest[i] + ahead * at.velocity[i]
        press = load * share * max(0.0, 1.0 - state.landing_damping * speed)
        length = along_floor(bristle, normal, 3)
        stiffness = foot.friction * load * foot.pressed / state.bristle
        if stiffness * length > foot.friction * press:
            stiffness = foot.friction * press / length
        for i in range(3):
            force[i] = press * normal[i] - stiffness * bristle[i]
        to_body_axes(m.turn, force, own)
        cross(foot.place, own, moment)
        for i in range(3):
            f[i] -= own[i]
            f[3 + i] -= moment[i]


@kernel
def settle_feet(I, M):
    """Draw the places of rest after feet that have slipped or left the floor (return mapping).

    A bristle is as stiff as the foot presses, at least as at rest: an impact would be over before
    one for the weight alone had been bent far enough. As it stiffens it keeps its force.
    """
    head = header(I)
    state = scalars(M)
    at = foot_on_floor()
    way = vector()
    for n in range(head.foot_count):
        foot = foot_of(I, M, n)
        gap = place_foot(I, M, foot, at)
        share, _stiffness, _energy = contact_law(gap, state.floor_depth)
        speed = 0.0
        for i in range(3):
            speed += at.velocity[i] * at.normal[i]
            way[i] = at.place[i] - foot.rest[i]
        press = share * max(0.0, 1.0 - state.landing_damping * speed)
        length = along_floor(way, at.normal, 3)
        pressed = max(1.0, press)
        # Over friction and load, as a length times what presses.
        force = min(foot.pressed * length, press * state.bristle)
        kept = force / (pressed * length) if length > 0.0 else 0.0
        foot.pressed = pressed
        for i in range(3):
            foot.rest[i] = at.place[i] - kept * way[i]


@kernel
def rest_feet(I, M):
    """Make the present places of feet those of rest; of feet that friction held while a start was
    sought, those from which it does so, or slips."""
    state = scalars(M)
    at = foot_on_floor()
    slipped = vector()
    for n in range(header(I).foot_count):
        foot = foot_of(I, M, n)
        place_foot(I, M, foot, at)
        for i in range(3):
            slipped[i] = at.place[i] - foot.rest[i]
        length = along_floor(slipped, at.normal, 3)
        limit = state.bristle if foot.friction != 0.0 else 0.0
        kept = 1.0 if length <= limit else limit / length
        for i in range(3):
            foot.rest[i] = at.place[i] - kept * slipped[i]
