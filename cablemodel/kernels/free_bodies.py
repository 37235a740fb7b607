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
axis's area. A foil has lift and drag by its angle of attack, from a table.
"""

import math

from .access import arm_of, foil_of, free_body_of, header, scalars
from .compile import kernel, view
from .environment import current_at, surge_at
from .feet import add_feet
from .hulls import wet_hull
from .layout import (
    FLOOR_TOUCHED,
    FOIL_ANGLES,
    FOOT_SCRATCH,
    HULL_NONE,
)
from .rotation import convective_spin, cross, to_body_axes, to_earth_axes, turn_and_rates
from .waves import P_ACCELERATION, P_VELOCITY, P_WET, wave_at, wet_at

FAR = 0.5  # rotation vector from which on it counts from the present attitude [rad]
STEP = 1e-6  # of the differences for a body's derivatives, in radians and in its size


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
    w = out.reference
    convective_spin(theta, rate, out.spin_rate, w)
    to_earth_axes(out.rates, second, w)
    for i in range(3):
        out.spin_rate[i] += w[i]
    for i in range(3):
        out.reference[i] = x[at + i]
        out.reference[3 + i] = v[at + i]
        out.reference[6 + i] = a[at + i]


@kernel
def follow_bodies(I, M, q, v, a):
    """Motion of all bodies from the state, and of the ends of lines at their arms into it."""
    head = header(I)
    for body in range(head.free_count):
        row = free_body_of(I, M, body)
        set_body_motion(row, M, q, v, a, 6 * int(row.node))
    for n in range(head.arm_count):
        arm = arm_of(I, M, n)
        if arm.body < 0.0:
            continue  # its line is cut off
        row = free_body_of(I, M, int(arm.body))
        w = view(M, head.parts_work, 9)
        m = row.motion
        place = arm.place
        turn = m.turn
        spin = m.spin
        at = 6 * int(arm.node)
        to_earth_axes(turn, place, w[0:3])
        for i in range(3):
            q[at + i] = m.reference[i] + w[i]
        cross(spin, place, w[3:6])
        to_earth_axes(turn, w[3:6], w[0:3])
        for i in range(3):
            v[at + i] = m.reference[3 + i] + w[i]
        cross(spin, w[3:6], w[6:9])
        cross(m.spin_rate, place, w[3:6])
        for i in range(3):
            w[6 + i] += w[3 + i]
        to_earth_axes(turn, w[6:9], w[0:3])
        for i in range(3):
            a[at + i] = m.reference[6 + i] + w[i]


@kernel
def ramp(given, words, i, t):
    """Component i of an input that goes linearly from one value to the next: t0, t1, both."""
    t0 = given[0]
    t1 = given[1]
    start = given[2 + i]
    end = given[2 + words + i]
    if t >= t1:
        return end
    return start + (end - start) * max(0.0, (t - t0) / (t1 - t0))


@kernel
def add_inertia(matrix, v, spin, gain, spin_rate, share, out, w):
    """Add share of dp/dt + Omega x p and dL/dt + Omega x L + v x p to out (6). w: 15 words."""
    for i in range(6):
        value = 0.0
        rate = 0.0
        for j in range(3):
            first = matrix[6 * i + j]
            second = matrix[6 * i + 3 + j]
            value += first * v[j] + second * spin[j]
            rate += first * gain[j] + second * spin_rate[j]
        w[i] = value
        out[i] += share * rate
    cross(spin, w[0:3], w[6:9])
    cross(spin, w[3:6], w[9:12])
    cross(v, w[0:3], w[12:15])
    for i in range(3):
        out[i] += share * w[6 + i]
        out[3 + i] += share * (w[9 + i] + w[12 + i])


@kernel
def add_force(force, place, sign, out, w):
    """Add sign times a force at a place, and its moment, to out (6): body's axes. w: 3 words."""
    cross(place, force, w)
    for i in range(3):
        out[i] += sign * force[i]
        out[3 + i] += sign * w[i]


@kernel
def foil_coefficients(M, table, angle):
    """Lift and drag coefficients at an angle of attack [rad], by a cubic through four rows."""
    x = (angle + math.pi) * (FOIL_ANGLES - 1) / (2.0 * math.pi)
    k = math.floor(x)
    x -= k
    period = FOIL_ANGLES - 1
    w0 = -0.5 * x * (1.0 - x) * (1.0 - x)
    w1 = 1.0 + x * x * (1.5 * x - 2.5)
    w2 = x * (0.5 + x * (2.0 - 1.5 * x))
    w3 = -0.5 * x * x * (1.0 - x)
    lift = 0.0
    drag = 0.0
    for n in range(4):
        row = table + 2 * ((k - 1 + n) % period)
        weight = w0 if n == 0 else (w1 if n == 1 else (w2 if n == 2 else w3))
        lift += weight * M[row]
        drag += weight * M[row + 1]
    return lift, drag


@kernel
def add_foil(M, foil, table, t, flow, spin, out, w):
    """Subtract a foil's lift and drag from out. flow: velocity of the water past the reference
    point, body's axes. w: 15 words."""
    place = foil.place
    cross(place, spin, w[0:3])  # what the turning adds to the flow: -Omega x place
    angle = ramp(foil.deflection, 1, 0, t)
    c = math.cos(angle)
    s = math.sin(angle)
    chord = foil.chord
    span = foil.span
    cross(chord, span, w[3:6])
    against = 0.0
    up = 0.0
    for i in range(3):
        u = flow[i] + w[i]
        # Leading edge up: chord and normal turn about the span.
        against -= u * (c * chord[i] + s * w[3 + i])
        up += u * (c * w[3 + i] - s * chord[i])
    speed = math.sqrt(against * against + up * up)
    if speed == 0.0:
        return
    lift, drag = foil_coefficients(M, table + int(foil.table), math.atan2(up, against))
    # Drag along the flow in the plane across the span, lift at right angles to it.
    force = foil.area * speed
    forward = force * (lift * up - drag * against)
    normal = force * (lift * against + drag * up)
    for i in range(3):
        w[6 + i] = forward * (c * chord[i] + s * w[3 + i])
        w[6 + i] += normal * (c * w[3 + i] - s * chord[i])
    add_force(w[6:9], place, -1.0, out, w[9:12])


@kernel
def body_forces(I, M, body, t, out):
    """Inertia minus loads of a body at the motion in its row: force in the earth's frame, and what
    is conjugate to theta, 6 words. t: time [s]."""
    head = header(I)
    state = scalars(M)
    row = free_body_of(I, M, body)
    m = row.motion
    w = view(M, head.parts_work + 40, 60)
    turn = m.turn
    spin = m.spin
    spin_rate = m.spin_rate
    v = w[0:3]
    gain = w[3:6]
    water = w[6:9]
    pull = w[9:12]  # acceleration of the water
    f = w[12:18]
    s = w[18:33]
    place = w[33:36]
    for i in range(6):
        f[i] = 0.0
    for i in range(3):
        pull[i] = 0.0
    to_earth_axes(turn, row.buoyancy_centre, place)
    for i in range(3):
        place[i] += m.reference[i]
    current_at(I, M, place[2], water)
    if head.surge != 0:
        surge_at(I, M, place[2], pull)
    wet = 1.0
    hull = row.hull != HULL_NONE
    buoyancy_centre = row.buoyancy_centre
    if hull:
        to_earth_axes(turn, row.hull_centre, s[0:3])
        for i in range(3):
            s[i] += m.reference[i]
        wet = wet_hull(I, M, body, s[0:3])
        buoyancy_centre = view(M, head.parts_work + 100, 3)
        # Waves carry what is wet of it: their pressure falls with its depth, not the hull's.
        to_earth_axes(turn, buoyancy_centre, place)
        for i in range(3):
            place[i] += m.reference[i]
    if head.wave_count != 0:
        slot = 3 * head.capacity + head.body_count + body
        reach = row.radius
        depth = wave_at(I, M, place[0], place[1], place[2], reach, slot)
        at = head.motion
        if not hull:
            wet_at(I, M, depth, reach)
            wet = M[at + P_WET]
        for i in range(3):
            water[i] += M[at + P_VELOCITY + i]
            pull[i] += M[at + P_ACCELERATION + i]
    # Its own inertia.
    to_body_axes(turn, m.reference[3:6], v)
    to_body_axes(turn, m.reference[6:], gain)
    cross(spin, v, s[0:3])
    for i in range(3):
        gain[i] -= s[i]
    add_inertia(row.solid, v, spin, gain, spin_rate, 1.0, f, s)
    # That of the water, by what moves through it.
    for i in range(3):
        place[i] = m.reference[3 + i] - water[i]
        water[i] = m.reference[6 + i] - pull[i]
    to_body_axes(turn, place, v)
    to_body_axes(turn, water, gain)
    cross(spin, v, s[0:3])
    for i in range(3):
        gain[i] -= s[i]
    add_inertia(row.added, v, spin, gain, spin_rate, wet, f, s)
    # Weight, buoyancy with the acceleration of the water (Froude and Krylov).
    for i in range(3):
        place[i] = 0.0
    place[2] = -row.weight
    to_body_axes(turn, place, water)
    add_force(water, row.centre, -1.0, f, s)
    lift = wet * row.buoyancy
    for i in range(3):
        place[i] = lift * pull[i] / state.gravity if state.gravity > 0.0 else 0.0
    place[2] += lift
    to_body_axes(turn, place, water)
    add_force(water, buoyancy_centre, -1.0, f, s)
    # Drag.
    centre = row.drag_centre
    cross(spin, centre, s[0:3])
    speed = 0.0
    turning = 0.0
    for i in range(3):
        s[3 + i] = -v[i] - s[i]
        speed += s[3 + i] * s[3 + i]
        turning += spin[i] * spin[i]
    speed = wet * math.sqrt(speed)
    turning = wet * math.sqrt(turning)
    for i in range(3):
        water[i] = row.drag[i] * speed * s[3 + i]
        f[3 + i] += row.turn_drag[i] * turning * spin[i]
    add_force(water, centre, -1.0, f, s)
    for i in range(3):
        place[i] = -v[i]
    for n in range(int(row.foil_count)):
        foil = foil_of(I, M, int(row.first_foil) + n)
        add_foil(M, foil, head.foil_table, t, place, spin, f, s)
    if head.foot_count != 0 and head.floor_state == FLOOR_TOUCHED:
        add_feet(I, M, body, f, view(M, head.parts_work + FOOT_SCRATCH, 18))
    # What the caller pushes with, at the body's own origin.
    for i in range(3):
        place[i] = ramp(row.force, 6, i, t)
        s[6 + i] = ramp(row.force, 6, 3 + i, t)
    to_body_axes(turn, place, water)
    add_force(water, row.origin, -1.0, f, s)
    to_body_axes(turn, s[6:9], water)
    for i in range(3):
        f[3 + i] -= water[i]
    to_earth_axes(turn, f[0:3], out)
    to_body_axes(m.rates, f[3:6], water)  # T^T
    for i in range(3):
        out[3 + i] = water[i]


@kernel
def arm_moment(M, arm, m, force, out, w):
    """What a force at an arm is, conjugate to theta: T^T (place x R^T force). w: 6 words."""
    to_body_axes(m.turn, force, w[0:3])
    cross(arm.place, w[0:3], w[3:6])
    to_body_axes(m.rates, w[3:6], out)


@kernel
def free_residual(I, M, t, out):
    """Add the bodies' inertia and loads to the forces, and take over those at their arms."""
    head = header(I)
    f = view(M, head.parts_work + 16, 6)
    w = view(M, head.parts_work + 22, 12)
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
        arm_moment(M, arm, row.motion, force, w[0:3], w[3:9])
        for i in range(3):
            out[at + i] += force[i]
            out[at + 3 + i] += w[i]
            arm.force[i] = force[i]
            force[i] = 0.0


@kernel
def free_jacobian(I, M, t, q, v, a, ca, cv):
    """Add the bodies' derivatives, by central differences, to the diagonal blocks of their nodes;
    and leave at each arm how its place follows theta, for the elimination.

    The state is as in the last residual; forces at arms are those of that.
    """
    head = header(I)
    f = view(M, head.parts_work + 16, 6)
    w = view(M, head.parts_work + 22, 12)
    for body in range(head.free_count):
        row = free_body_of(I, M, body)
        node = int(row.node)
        at = 6 * node
        D = view(M, head.diagonal + 36 * node, 36)
        for j in range(6):
            step = STEP * (row.size if j < 3 else 1.0)
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
                        m = row.motion
                        arm_moment(M, arm, m, arm.force, w[0:3], w[3:9])
                        for i in range(3):
                            f[3 + i] += w[i]
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
        m = row.motion
        to = head.lower + 36 * int(arm.node) + 18  # beside Z
        for j in range(3):
            for i in range(3):
                w[i] = m.rates[3 * i + j]  # a column of T
            cross(w[0:3], arm.place, w[3:6])
            to_earth_axes(m.turn, w[3:6], w[0:3])
            for i in range(3):
                M[to + 3 * i + j] = w[i]


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
    head = header(I)
    state = scalars(M)
    for body in range(head.free_count):
        force = free_body_of(I, M, body).force
        follow_ramp(force, 6, state.time, t_end, forces, 6 * body)


@kernel
def deflect_foils(I, M, t_end, angles, foils):
    """Let the deflections of the foils be reached linearly at the end of a step."""
    state = scalars(M)
    for n in range(foils):
        deflection = foil_of(I, M, n).deflection
        follow_ramp(deflection, 1, state.time, t_end, angles, n)


@kernel
def follow_ramp(given, words, time, t_end, values, first):
    """An input of so many words goes on from its present value to another one at t_end."""
    for i in range(words):
        given[2 + i] = ramp(given, words, i, time)
    for i in range(words):
        given[2 + words + i] = values[first + i]
    given[0] = time
    given[1] = t_end
