"""Rigid bodies of finite length on massless lines and below towed ones: ODEs of a few unknowns."""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

GRAVITY = 9.80665
DENSITY = 1025.0


@dataclass(frozen=True)
class Body:
    """A rigid body of revolution, as a scene describes it [SI]."""

    mass: float
    submerged_weight: float
    half_length: float
    centre_offset: float = 0.0
    rotary_inertia: float = 0.0
    added_mass: float = 0.0
    added_mass_axial: float = 0.0
    drag_area: float = 0.0
    drag_area_axial: float = 0.0

    @property
    def buoyancy(self):
        """Upward force at the middle [N]."""
        return self.mass * GRAVITY - self.submerged_weight

    @property
    def arm(self):
        """From the inner attachment to the centre of gravity [m]."""
        return (1.0 + self.centre_offset) * self.half_length


def chain(bodies, lengths, stiffness, start, times):
    """Bodies hung one below the other on massless springs, in a vertical plane and in vacuum.

    Newton's and Euler's equations of each body, with its inner attachment (x, z) and its angle
    from the downward vertical as unknowns; a spring pulls from the outer end of the last one.

    start: (n, 3) attachment and angle; returns (times, n, 3).
    """
    count = len(bodies)

    def rate(_t, y):
        place, velocity = y[: 3 * count].reshape(-1, 3), y[3 * count :].reshape(-1, 3)
        axis = np.array([np.sin(place[:, 2]), -np.cos(place[:, 2])]).T
        above = np.zeros((count, 2))
        above[1:] = place[:-1, :2]
        for k in range(1, count):
            above[k] += 2.0 * bodies[k - 1].half_length * axis[k - 1]
        reach = place[:, :2] - above
        size = np.linalg.norm(reach, axis=1)
        pull = -(stiffness * (size / lengths - 1.0) / size)[:, None] * reach
        acceleration = np.zeros((count, 3))
        for k, body in enumerate(bodies):
            across = np.array([np.cos(place[k, 2]), np.sin(place[k, 2])])
            mass, arm = body.mass, body.arm
            below = -pull[k + 1] if k + 1 < count else np.zeros(2)
            matrix = np.zeros((3, 3))
            matrix[:2, :2] = mass * np.eye(2)
            matrix[:2, 2] = matrix[2, :2] = mass * arm * across
            matrix[2, 2] = mass * arm**2 + body.rotary_inertia
            force = np.zeros(3)
            force[:2] = mass * arm * velocity[k, 2] ** 2 * axis[k] + pull[k] + below
            force[1] -= body.submerged_weight
            force[2] = across @ (2.0 * body.half_length * below)
            force[2] += across[1] * (body.half_length * body.buoyancy - arm * mass * GRAVITY)
            acceleration[k] = np.linalg.solve(matrix, force)
        return np.array([*y[3 * count :], *acceleration.ravel()])

    y0 = np.concatenate([np.ravel(start), np.zeros(3 * count)])
    solution = solve_ivp(
        rate, (0.0, times[-1]), y0, method="Radau", rtol=1e-9, atol=1e-11, t_eval=times
    )
    return solution.y[: 3 * count].T.reshape(len(times), count, 3)


def centre_and_end(body, state):
    """Centre of gravity and outer end (x, z) of a body whose attachment and angle are given."""
    axis = np.array([np.sin(state[2]), -np.cos(state[2])])
    return state[:2] + body.arm * axis, state[:2] + 2.0 * body.half_length * axis


def towed_below(body, cable, length, speed, bending=0.0):
    """A body at the end of a cable towed at a constant speed along x.

    The body's attitude by moments about its attachment, with that of a cable that bends, whose
    elastica is integrated through its layer of sqrt(EI/T). Then the cable from there upwards as an
    ODE of internal force and position (rtol 1e-12).

    Returns centre of gravity and axis (3,) relative to the tow point, and the top force's size.
    """
    normal = 0.5 * DENSITY * body.drag_area
    axial = 0.5 * DENSITY * body.drag_area_axial

    def drag(direction, across, along):
        flow = np.array([-speed, 0.0])
        ut = flow @ direction
        un = flow - ut * direction
        return across * np.linalg.norm(un) * un + along * abs(ut) * ut * direction

    def attitude(angle):
        return np.array([np.sin(angle), -np.cos(angle)])

    def pull(angle):
        return drag(attitude(angle), normal, axial) - np.array([0.0, body.submerged_weight])

    def moment(angle):
        """Of all loads about the attachment; the cable must hold it [N m]."""
        across = np.array([np.cos(angle), np.sin(angle)])
        water = drag(attitude(angle), normal, axial) + np.array([0.0, body.buoyancy])
        weight = np.array([0.0, -body.mass * GRAVITY])
        return float(across @ (body.half_length * water + body.arm * weight))

    diameter, stiffness = cable["diameter"], cable["axial_stiffness"]
    across = 0.5 * DENSITY * cable["drag_normal"] * diameter
    along = 0.5 * DENSITY * cable["drag_tangential"] * np.pi * diameter

    def rate(_s, y):
        size = np.linalg.norm(y[:2])
        tangent, stretch = y[:2] / size, 1.0 + size / stiffness
        load = np.sqrt(stretch) * drag(tangent, across, along)
        load[1] -= cable["submerged_weight"]
        return [*load, *(stretch * tangent)]

    def layer(_s, y):
        """The same for an elastica: y = (force, position, angle, d(angle)/ds)."""
        size = np.linalg.norm(y[:2])
        tangent, stretch = attitude(y[4]), 1.0 + (y[:2] @ attitude(y[4])) / stiffness
        load = np.sqrt(stretch) * drag(tangent, across, along)
        load[1] -= cable["submerged_weight"]
        turn = np.arctan2(y[0], -y[1]) - y[4]
        return [*load, *(stretch * tangent), y[5], -stretch * size * np.sin(turn) / bending]

    if bending == 0.0:
        angle = brentq(moment, -2.0, 0.5, xtol=1e-15)
        start, begin = np.array([*pull(angle), 0.0, 0.0]), 0.0
    else:
        # The layer grows like exp(s / sqrt(EI/T)) unless it starts at the right angle: bisection
        # on the side to which it diverges, from where the cable alone would hold the body.
        def ends(angle):
            first = [*pull(angle), 0.0, 0.0, angle, -moment(angle) / bending]
            reach = 16.0 * np.sqrt(bending / np.linalg.norm(pull(angle)))
            away = lambda _s, y: abs(np.arctan2(y[0], -y[1]) - y[4]) - 1.0  # noqa: E731
            away.terminal = True
            found = solve_ivp(layer, (0.0, reach), first, rtol=1e-11, atol=1e-13, events=away)
            return np.arctan2(found.y[0, -1], -found.y[1, -1]) - found.y[4, -1], found

        low, high = -1.5, 0.5
        sign = ends(low)[0]
        for _ in range(60):
            angle = 0.5 * (low + high)
            if ends(angle)[0] * sign > 0.0:
                low = angle
            else:
                high = angle
        _, found = ends(angle)
        # Half of the way out the layer has decayed to 3e-4 and what was wrong has not grown yet.
        middle = int(np.searchsorted(found.t, 0.5 * found.t[-1]))
        start, begin = found.y[:4, middle], found.t[middle]
    axis = attitude(angle)
    solution = solve_ivp(rate, (begin, length), start, method="DOP853", rtol=1e-12, atol=1e-12)
    end = solution.y[2:, -1]
    centre = end + body.arm * axis
    return (
        np.array([centre[0], 0.0, centre[1]]),
        np.array([axis[0], 0.0, axis[1]]),
        float(np.linalg.norm(solution.y[:2, -1])),
    )


def free_spin(inertia, start, duration):
    """Euler's equations of a body that nothing turns: angular velocity in its own axes over time.

    inertia: principal moments (3,); start: angular velocity at t = 0 (3,). A function of the time.
    """
    return solve_ivp(
        lambda _t, w: np.cross(inertia * w, w) / inertia,
        (0.0, duration),
        start,
        rtol=1e-11,
        atol=1e-12,
        dense_output=True,
    ).sol
