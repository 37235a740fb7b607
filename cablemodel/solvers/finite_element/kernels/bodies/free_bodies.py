"""Free bodies: rigid, six degrees of freedom, with lines at several of their points.

Unknowns of a body are the place r of its reference point and a rotation vector theta, which turns
it from a fixed attitude (rotation.py): six, as of a node of cable, whose place in the tree of nodes
it takes. Where a line comes to it from the tree's root, the reference point is that line's end and
r is shared, as at a hinge. Other lines begin at arms: their first nodes' places follow from r and
theta, and forces there go to the body.

With v and Omega the velocity of the reference point and the angular velocity, both in the body's
axes, momentum p = M11 v + M12 Omega and angular momentum L = M21 v + M22 Omega about that point:

    dp/dt + Omega x p = F,   dL/dt + Omega x L + v x p = N

(Kirchhoff's equations: Lamb, Hydrodynamics, section 124). They hold for the body's own inertia with
its velocity, and for that of the water with its velocity through the water. Conjugate to theta is
T^T N. Drag goes by the whole speed of the water at the centre of drag, along each axis with that
axis's area. A foil has lift and drag by its angle of attack, from a table, as far as it is wet.
"""

import math

from cablemodel.solvers.finite_element.kernels.bodies.hulls import depth_below, wet_hull
from cablemodel.solvers.finite_element.kernels.bodies.rotation import (
    convective_spin,
    cross,
    to_body_axes,
    to_earth_axes,
    turn_and_rates,
)
from cablemodel.solvers.finite_element.kernels.element.tables import WEIGHT
from cablemodel.solvers.finite_element.kernels.floor.feet import add_feet
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import cubic_end
from cablemodel.solvers.finite_element.kernels.water.waves import water_at, wave_at, wet_at
from cablemodel.solvers.finite_element.kernels.water.wetting import OUTER, share_at
from cablemodel.solvers.shared.access import (
    arm_of,
    foil_of,
    foil_row_at,
    free_body_of,
    header,
    new_motion,
    scalars,
    vector,
)
from cablemodel.solvers.shared.compile import kernel, own_numbers, view
from cablemodel.solvers.shared.environment import current_at, surge_at
from cablemodel.solvers.shared.layout import (
    BODY_CELLS,
    FLOOR_TOUCHED,
    FOIL_ROW_WORDS,
    HULL_CYLINDER,
    HULL_NONE,
)

FAR = 0.5  # rotation vector from which on it counts from the present attitude [rad]
BODY_STEP = 1e-6  # of the differences for a body's derivatives, in radians and in its size

wrench = own_numbers(6)
"""wrench(): zeros, a force and a moment or what is conjugate to a rotation vector."""


@kernel
def set_body_motion(row, M, x, v, a, at):
    """Axes, rates and motion of the reference point into a body's row. x, v, a: `at` is its node's
    first word."""
    out = row.motion
    theta = view(x, at + 3, 3)
    rate = view(v, at + 3, 3)
    second = view(a, at + 3, 3)
    turn_and_rates(row.rotation, theta, out.turn, out.rates)
    to_earth_axes(out.rates, rate, out.spin)
    convective_spin(theta, rate, out.spin_rate)
    of_second = vector()
    to_earth_axes(out.rates, second, of_second)
    for i in range(3):
        out.spin_rate[i] += of_second[i]
        out.reference.position[i] = x[at + i]
        out.reference.velocity[i] = v[at + i]
        out.reference.acceleration[i] = a[at + i]


@kernel
def point_of_body(m, place, out):
    """Motion of a point of a body, from its reference point in its axes, at the BodyMotion m."""
    reference = m.reference
    earth = vector()
    turning = vector()  # Omega x place
    inward = vector()
    to_earth_axes(m.turn, place, earth)
    for i in range(3):
        out.position[i] = reference.position[i] + earth[i]
    cross(m.spin, place, turning)
    to_earth_axes(m.turn, turning, earth)
    for i in range(3):
        out.velocity[i] = reference.velocity[i] + earth[i]
    cross(m.spin, turning, inward)
    cross(m.spin_rate, place, turning)
    for i in range(3):
        inward[i] += turning[i]
    to_earth_axes(m.turn, inward, earth)
    for i in range(3):
        out.acceleration[i] = reference.acceleration[i] + earth[i]


@kernel
def follow_bodies(I, M, q, v, a):
    """Motion of all bodies from the state, and of the ends of lines at their arms into it."""
    head = header(I)
    for body in range(head.free_count):
        row = free_body_of(I, M, body)
        set_body_motion(row, M, q, v, a, 6 * int(row.node))
    end = new_motion()
    for n in range(head.arm_count):
        arm = arm_of(I, M, n)
        if arm.body < 0.0:
            continue  # its line is cut off
        row = free_body_of(I, M, int(arm.body))
        at = 6 * int(arm.node)
        point_of_body(row.motion, arm.place, end)
        for i in range(3):
            q[at + i] = end.position[i]
            v[at + i] = end.velocity[i]
            a[at + i] = end.acceleration[i]


@kernel
def on_the_way(begin, end, first, last, t):
    """An input at time t that goes linearly from one value to the next, between two times."""
    if t >= end:
        return last
    return first + (last - first) * max(0.0, (t - begin) / (end - begin))


@kernel
def add_inertia(matrix, v, spin, gain, spin_rate, share, out):
    """Add share of dp/dt + Omega x p and dL/dt + Omega x L + v x p to out (6)."""
    momentum = vector()
    angular = vector()
    turned = vector()
    carried = vector()
    for i in range(6):
        value = 0.0
        rate = 0.0
        for j in range(3):
            first = matrix[6 * i + j]
            second = matrix[6 * i + 3 + j]
            value += first * v[j] + second * spin[j]
            rate += first * gain[j] + second * spin_rate[j]
        if i < 3:
            momentum[i] = value
        else:
            angular[i - 3] = value
        out[i] += share * rate
    cross(spin, momentum, turned)
    for i in range(3):
        out[i] += share * turned[i]
    cross(spin, angular, turned)
    cross(v, momentum, carried)
    for i in range(3):
        out[3 + i] += share * (turned[i] + carried[i])


@kernel
def add_force(force, place, sign, out):
    """Add sign times a force at a place, and its moment, to out (6): body's axes."""
    moment = vector()
    cross(place, force, moment)
    for i in range(3):
        out[i] += sign * force[i]
        out[3 + i] += sign * moment[i]


@kernel
def foil_coefficients(M, table, rows, angle):
    """Lift and drag coefficients at an angle of attack [rad], by a cubic between two rows."""
    low = 0
    high = rows - 1
    while high - low > 1:
        middle = (low + high) // 2
        if foil_row_at(M, table + FOIL_ROW_WORDS * middle).angle <= angle:
            low = middle
        else:
            high = middle
    a = foil_row_at(M, table + FOIL_ROW_WORDS * low)
    b = foil_row_at(M, table + FOIL_ROW_WORDS * high)
    h = b.angle - a.angle
    x = (angle - a.angle) / h
    n0, n1, _d0, _d1 = cubic_end(0, x, h)
    n2, n3, _d2, _d3 = cubic_end(1, x, h)
    lift = n0 * a.lift + n1 * a.lift_slope + n2 * b.lift + n3 * b.lift_slope
    drag = n0 * a.drag + n1 * a.drag_slope + n2 * b.drag + n3 * b.drag_slope
    return lift, drag


@kernel
def add_foil(M, foil, table, t, flow, spin, wet, out):
    """Subtract a foil's lift and drag from out. flow: velocity of the water past the reference
    point, body's axes; wet: share of the foil."""
    place = foil.place
    turning = vector()  # what it adds to the flow: -Omega x place
    cross(place, spin, turning)
    given = foil.deflection
    angle = on_the_way(given.begin, given.end, given.first, given.last, t)
    c = math.cos(angle)
    s = math.sin(angle)
    chord = foil.chord
    span = foil.span
    above = vector()
    cross(chord, span, above)
    against = 0.0
    up = 0.0
    for i in range(3):
        u = flow[i] + turning[i]
        # Leading edge up: chord and normal turn about the span.
        against -= u * (c * chord[i] + s * above[i])
        up += u * (c * above[i] - s * chord[i])
    speed = math.sqrt(against * against + up * up)
    if speed == 0.0:
        return
    attack = math.atan2(up, against)
    lift, drag = foil_coefficients(M, table + int(foil.table), int(foil.rows), attack)
    # Drag along the flow in the plane across the span, lift at right angles to it.
    force = wet * foil.area * speed
    forward = force * (lift * up - drag * against)
    normal = force * (lift * against + drag * up)
    load = vector()
    for i in range(3):
        load[i] = forward * (c * chord[i] + s * above[i])
        load[i] += normal * (c * above[i] - s * chord[i])
    add_force(load, place, -1.0, out)


@kernel
def foil_wet(foil, m, place, depth):
    """Share of a foil that is wet, by its own depth, as of an upright square of its area.

    m: motion of its body, of which a place (3, block's coordinates) is so deep [m].
    """
    earth = vector()
    to_earth_axes(m.turn, foil.place, earth)
    share, _rate = share_at(depth + place[2] - m.reference.position[2] - earth[2], foil.reach)
    return share


@kernel
def add_pressure_of_waves(I, M, body, wet, displaced, at_middle, middle, f):
    """Subtract from f (6, body's axes) what Froude and Krylov's force on a cylinder, by Gauss
    at three places of its wet length, is more than by the water's acceleration at its middle.

    Of an upright one the force upwards is then the wave's pressure at the keel, though that falls
    much over the draught. wet: share of it; displaced: mass of the water in whose place that is
    [kg]; at_middle: the acceleration there, earth frame; middle: the place, body's axes.
    """
    head = header(I)
    row = free_body_of(I, M, body)
    m = row.motion
    slot = 3 * head.capacity + head.body_count + BODY_CELLS * body
    away = 0.5 * wet * row.hull_height * OUTER
    force = vector()
    own = vector()
    place = vector()
    water = water_at()
    for side in range(2):
        for i in range(3):
            place[i] = middle[i]
        place[2] += away if side == 0 else -away
        to_earth_axes(m.turn, place, own)
        for i in range(3):
            own[i] += m.reference.position[i]
        wave_at(I, M, own[0], own[1], own[2], row.radius, slot + 1 + side, water)
        for i in range(3):
            force[i] = displaced * WEIGHT[0] * water.acceleration[i]
        to_body_axes(m.turn, force, own)
        add_force(own, place, -1.0, f)
        for i in range(3):
            force[i] = displaced * WEIGHT[0] * at_middle[i]
        to_body_axes(m.turn, force, own)
        add_force(own, middle, 1.0, f)


@kernel
def gain_of(m, velocity, acceleration, v, gain):
    """Velocity in the body's axes, and its rate there, from both in the earth's."""
    turned = vector()
    to_body_axes(m.turn, velocity, v)
    to_body_axes(m.turn, acceleration, gain)
    cross(m.spin, v, turned)
    for i in range(3):
        gain[i] -= turned[i]


@kernel
def body_forces(I, M, body, t, out):
    """Inertia minus loads of a body at the motion in its row: force in the earth's frame, and what
    is conjugate to theta, 6 words. t: time [s]."""
    head = header(I)
    state = scalars(M)
    row = free_body_of(I, M, body)
    m = row.motion
    turn = m.turn
    spin = m.spin
    spin_rate = m.spin_rate
    reference = m.reference
    f = wrench()  # all of it, body's axes
    place = vector()
    flow = vector()  # velocity of the water
    surge = vector()  # acceleration of the water
    to_earth_axes(turn, row.buoyancy_centre, place)
    for i in range(3):
        place[i] += reference.position[i]
    current_at(I, M, place[2], flow)
    if head.surge != 0:
        surge_at(I, M, place[2], surge)
    wet = 1.0
    hull = row.hull != HULL_NONE
    buoyancy_centre = vector()
    for i in range(3):
        buoyancy_centre[i] = row.buoyancy_centre[i]
    if hull:
        centre = vector()
        to_earth_axes(turn, row.hull_centre, centre)
        for i in range(3):
            centre[i] += reference.position[i]
        wet = wet_hull(I, M, body, centre, buoyancy_centre)
        # Waves carry what is wet of it: their pressure falls with its depth, not the hull's.
        to_earth_axes(turn, buoyancy_centre, place)
        for i in range(3):
            place[i] += reference.position[i]
    foils = int(row.foil_count)
    depth = 1e300
    water = water_at()
    if head.wave_count != 0:
        slot = 3 * head.capacity + head.body_count + BODY_CELLS * body
        reach = row.radius
        if foils != 0:
            reach += row.size
        depth = wave_at(I, M, place[0], place[1], place[2], reach, slot, water)
        if not hull:
            wet_at(depth, row.radius, water)
            wet = water.wet
        for i in range(3):
            flow[i] += water.velocity[i]
            surge[i] += water.acceleration[i]
    elif hull and foils != 0:
        depth = depth_below(I, M, place[0], place[1], place[2])
    # Its own inertia.
    v = vector()
    gain = vector()
    gain_of(m, reference.velocity, reference.acceleration, v, gain)
    add_inertia(row.solid, v, spin, gain, spin_rate, 1.0, f)
    # That of the water, by what moves through it.
    through = vector()
    faster = vector()
    for i in range(3):
        through[i] = reference.velocity[i] - flow[i]
        faster[i] = reference.acceleration[i] - surge[i]
    gain_of(m, through, faster, v, gain)
    add_inertia(row.added, v, spin, gain, spin_rate, wet, f)
    # Weight, buoyancy with the acceleration of the water (Froude and Krylov).
    force = vector()  # earth frame
    own = vector()  # body's axes
    force[2] = -row.weight
    to_body_axes(turn, force, own)
    add_force(own, row.centre, -1.0, f)
    lift = wet * row.buoyancy
    for i in range(3):
        force[i] = lift * surge[i] / state.gravity if state.gravity > 0.0 else 0.0
    force[2] += lift
    to_body_axes(turn, force, own)
    add_force(own, buoyancy_centre, -1.0, f)
    if row.hull == HULL_CYLINDER and head.wave_count != 0 and lift > 0.0:
        displaced = lift / state.gravity
        add_pressure_of_waves(I, M, body, wet, displaced, water.acceleration, buoyancy_centre, f)
    # Drag.
    turning = vector()
    past = vector()  # velocity of the water past the centre of drag, then past the reference point
    cross(spin, row.drag_centre, turning)
    square = 0.0
    square_of_spin = 0.0
    for i in range(3):
        past[i] = -v[i] - turning[i]
        square += past[i] * past[i]
        square_of_spin += spin[i] * spin[i]
    speed = wet * math.sqrt(square)
    spins = wet * math.sqrt(square_of_spin)
    for i in range(3):
        own[i] = row.drag[i] * speed * past[i]
        f[3 + i] += row.turn_drag[i] * spins * spin[i]
    add_force(own, row.drag_centre, -1.0, f)
    for i in range(3):
        past[i] = -v[i]
    for n in range(foils):
        foil = foil_of(I, M, int(row.first_foil) + n)
        share = foil_wet(foil, m, place, depth)
        if share > 0.0:
            add_foil(M, foil, head.foil_table, t, past, spin, share, f)
    if head.foot_count != 0 and head.floor_state == FLOOR_TOUCHED:
        add_feet(I, M, body, f)
    # What the caller pushes with, at the body's own origin.
    given = row.force
    pushed = wrench()
    for i in range(6):
        pushed[i] = on_the_way(given.begin, given.end, given.first[i], given.last[i], t)
    to_body_axes(turn, view(pushed, 0, 3), own)
    add_force(own, row.origin, -1.0, f)
    to_body_axes(turn, view(pushed, 3, 3), own)
    for i in range(3):
        f[3 + i] -= own[i]
    to_earth_axes(turn, view(f, 0, 3), view(out, 0, 3))
    to_body_axes(m.rates, view(f, 3, 3), view(out, 3, 3))  # T^T


@kernel
def arm_moment(arm, m, force, out):
    """What a force at an arm is, conjugate to theta: T^T (place x R^T force)."""
    own = vector()
    moment = vector()
    to_body_axes(m.turn, force, own)
    cross(arm.place, own, moment)
    to_body_axes(m.rates, moment, out)


@kernel
def follow_turn(arm, m, j, out):
    """How an arm's place follows component j of its body's rotation vector, (3,) [m]."""
    turn = vector()
    way = vector()
    for i in range(3):
        turn[i] = m.rates[3 * i + j]  # a column of T
    cross(turn, arm.place, way)
    to_earth_axes(m.turn, way, out)


@kernel
def follow_at_body(I, M, row, body, force, q, v, a):
    """How what a closure or a clamp has at a body, in its row `place`, follows the body's rotation
    vector, into `follows`; and how the moment of a constant force does, by central differences,
    into the body's diagonal block."""
    way = vector()
    moment = vector()
    node = int(body.node)
    at = 6 * node
    D = view(M, header(I).diagonal + 36 * node, 36)
    for j in range(3):
        kept = q[at + 3 + j]
        for side in range(2):
            e = BODY_STEP if side == 0 else -BODY_STEP
            q[at + 3 + j] = kept + e
            set_body_motion(body, M, q, v, a, at)
            arm_moment(row, body.motion, force, moment)
            for i in range(3):
                D[6 * (3 + i) + 3 + j] += moment[i] / (2.0 * e)
        q[at + 3 + j] = kept
    set_body_motion(body, M, q, v, a, at)
    for j in range(3):
        follow_turn(row, body.motion, j, way)
        for i in range(3):
            row.follows[3 * i + j] = way[i]


@kernel
def free_residual(I, M, t, out):
    """Add the bodies' inertia and loads to the forces, and take over those at their arms."""
    head = header(I)
    f = wrench()
    moment = vector()
    for body in range(head.free_count):
        at = 6 * int(free_body_of(I, M, body).node)
        body_forces(I, M, body, t, f)
        for i in range(6):
            out[at + i] += f[i]
    for n in range(head.arm_count):
        arm = arm_of(I, M, n)
        if arm.body < 0.0:
            continue  # its line is cut off
        row = free_body_of(I, M, int(arm.body))
        end = 6 * int(arm.node)
        at = 6 * int(row.node)
        force = view(out, end, 3)
        arm_moment(arm, row.motion, force, moment)
        for i in range(3):
            out[at + i] += force[i]
            out[at + 3 + i] += moment[i]
            arm.force[i] = force[i]
            force[i] = 0.0


@kernel
def free_jacobian(I, M, t, q, v, a, ca, cv):
    """Add the bodies' derivatives, by central differences, to the diagonal blocks of their nodes;
    and leave at each arm how its place follows theta, for the elimination.

    The state is as in the last residual; forces at arms are those of that.
    """
    head = header(I)
    f = wrench()
    moment = vector()
    way = vector()
    for body in range(head.free_count):
        row = free_body_of(I, M, body)
        node = int(row.node)
        at = 6 * node
        D = view(M, head.diagonal + 36 * node, 36)
        for j in range(6):
            step = BODY_STEP * (row.size if j < 3 else 1.0)
            x0 = q[at + j]
            v0 = v[at + j]
            a0 = a[at + j]
            for side in range(2):
                e = step if side == 0 else -step
                q[at + j] = x0 + e
                v[at + j] = v0 + cv * e
                a[at + j] = a0 + ca * e
                set_body_motion(row, M, q, v, a, at)
                body_forces(I, M, body, t, f)
                for n in range(head.arm_count):
                    arm = arm_of(I, M, n)
                    if j >= 3 and int(arm.body) == body:
                        # Of a line that goes on pulling so at the arm.
                        arm_moment(arm, row.motion, arm.force, moment)
                        for i in range(3):
                            f[3 + i] += moment[i]
                for i in range(6):
                    D[6 * i + j] += f[i] / (2.0 * e)
            q[at + j] = x0
            v[at + j] = v0
            a[at + j] = a0
        set_body_motion(row, M, q, v, a, at)
    for n in range(head.arm_count):
        arm = arm_of(I, M, n)
        if arm.body < 0.0:
            continue  # its line is cut off
        row = free_body_of(I, M, int(arm.body))
        to = head.lower + 36 * int(arm.node) + 18  # beside Z
        for j in range(3):
            follow_turn(arm, row.motion, j, way)
            for i in range(3):
                M[to + 3 * i + j] = way[i]


@kernel
def count_turns_anew(I, M, q, v, a):
    """Rotation vectors that have become large count from the present attitudes on."""
    head = header(I)
    for body in range(head.free_count):
        row = free_body_of(I, M, body)
        at = 6 * int(row.node)
        square = 0.0
        for i in range(3):
            square += q[at + 3 + i] ** 2
        if square < FAR * FAR:
            continue
        set_body_motion(row, M, q, v, a, at)
        m = row.motion
        for i in range(9):
            row.rotation[i] = m.turn[i]
        for i in range(3):
            q[at + 3 + i] = 0.0
            v[at + 3 + i] = m.spin[i]
            a[at + 3 + i] = m.spin_rate[i]
        set_body_motion(row, M, q, v, a, at)
        head.factored = 0
        head.has_history = 0


@kernel
def push_bodies(I, M, t_end, forces):
    """Let the outside forces and torques (bodies, 6) be reached linearly at the end of a step."""
    time = scalars(M).time
    for body in range(header(I).free_count):
        given = free_body_of(I, M, body).force
        for i in range(6):
            first = on_the_way(given.begin, given.end, given.first[i], given.last[i], time)
            given.first[i] = first
            given.last[i] = forces[6 * body + i]
        given.begin = time
        given.end = t_end


@kernel
def deflect_foils(I, M, t_end, angles, foils):
    """Let the deflections of the foils be reached linearly at the end of a step."""
    time = scalars(M).time
    for n in range(foils):
        given = foil_of(I, M, n).deflection
        given.first = on_the_way(given.begin, given.end, given.first, given.last, time)
        given.last = angles[n]
        given.begin = time
        given.end = t_end
