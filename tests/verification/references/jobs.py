"""Answers to ordinary jobs that no code of this project made: springs, masses, force balances."""

from functools import cache

import numpy as np
from scipy.integrate import solve_ivp

LENGTH, STIFFNESS = 110.0, 150e6


CABLE_MASS = 14.0


LOAD, ADDED = 20_000.0, 10_000.0


def lumped_load(times, pieces=20):
    """Top tension [N] of docs/jobs/winch_stop.yaml at times [s] from the winch's first slow-down
    on: the wire is lumped masses on springs, the load drags along its axis."""
    spring = STIFFNESS * pieces / LENGTH
    ramp = np.clip(times, 0.0, 0.2)
    uppermost = _lumped_load(times[-1], pieces)(times)[0]
    return spring * (uppermost - 0.5 * ramp + 0.5 * 2.5 * ramp**2)


@cache
def _lumped_load(duration, pieces):
    """Places and speeds of the lumped masses, as a function of times."""
    piece = LENGTH / pieces
    spring = STIFFNESS / piece
    weight = CABLE_MASS * 9.80665 - 1025.0 * 9.80665 * np.pi * 0.03**2
    masses = np.full(pieces, CABLE_MASS * piece)
    masses[-1] = 0.5 * CABLE_MASS * piece + LOAD + ADDED
    weights = np.full(pieces, weight * piece)
    weights[-1] = 0.5 * weight * piece + 170e3

    def stretch_rates(t, state):
        place, speed = state[:pieces], state[pieces:]  # downwards, from where the top would be
        ramp = np.clip(t, 0.0, 0.2)
        paid = 0.5 * ramp - 0.5 * 2.5 * ramp**2
        pull = spring * np.diff(np.concatenate([[paid], place]))
        drag = np.zeros(pieces)
        drag[-1] = 0.5 * 1025.0 * 6.0 * abs(speed[-1]) * speed[-1]
        force = weights - pull - drag
        force[:-1] += pull[1:]
        return np.concatenate([speed, force / masses])

    below = np.cumsum(weights[::-1])[::-1].copy()
    below -= 0.5 * 1025.0 * 6.0 * 0.5**2
    start = np.concatenate([np.cumsum(below / spring), np.full(pieces, 0.5)])
    solved = solve_ivp(
        stretch_rates, (0.0, duration), start, "DOP853", dense_output=True, rtol=1e-9, atol=1e-9
    )
    return solved.sol


@cache
def tension_only_wire(rates, duration, pieces=20):
    """Highest tension [N] of a load on a wire that cannot push, whose top moves at rates(t)."""
    length, stiffness, mass = 50.0, 180e6, 17.0
    piece = length / pieces
    spring = stiffness / piece
    weight = mass * 9.80665 - 1025.0 * 9.80665 * np.pi * 0.032**2
    masses = np.full(pieces, mass * piece)
    masses[-1] = 0.5 * mass * piece + 80e3
    weights = np.full(pieces, weight * piece)
    weights[-1] = 0.5 * weight * piece + 170e3
    below = np.cumsum(weights[::-1])[::-1]
    step = 0.2 * piece / np.sqrt(stiffness / mass)
    damping = 0.3 * np.sqrt(spring * mass * piece)
    times = np.arange(0.0, duration, step)
    top, tops = 0.0, rates(times)
    place = -np.arange(1, pieces + 1) * piece - np.cumsum(below / spring)
    speed = np.zeros(pieces)
    highest = 0.0
    for up in tops:
        top += up * step
        stretch = -np.diff(np.concatenate([[top], place])) - piece
        force = spring * stretch - damping * np.diff(np.concatenate([[up], speed]))
        pull = np.where(stretch > 0.0, np.maximum(force, 0.0), 0.0)
        highest = max(highest, pull[0])
        net = pull - weights
        net[:-1] -= pull[1:]
        net[-1] -= 0.5 * 1025.0 * 80.0 * abs(speed[-1]) * speed[-1]
        speed += step * net / masses
        place += step * speed
    return highest


def heave(times):
    """Speed of a tip that heaves by 2 m in 6 s, come up within 20 s [m/s]."""
    times = np.asarray(times)
    up = np.minimum(times / 20.0, 1.0)
    return 2.0 * 2.0 * np.pi / 6.0 * up * np.sin(2.0 * np.pi * times / 6.0)


def towed_depth(cable: dict, weight: float, drag: float, speed: float, length: float):
    """Depth [m] of a body and top tension [N] of a steady straight-ahead tow: balance of forces
    along a cable without bending, from the body upwards."""
    rho, d = 1025.0, cable["diameter"]
    w = (cable["mass"] - rho * np.pi / 4 * d**2) * 9.80665

    def slopes(s, state):
        tension, angle = state[:2]  # from the horizontal
        across, along = speed * np.sin(angle), speed * np.cos(angle)
        normal = 0.5 * rho * cable["drag_normal"] * d * across**2
        tangential = 0.5 * rho * cable["drag_tangential"] * np.pi * d * along**2
        stretch = 1.0 + tension / cable["axial_stiffness"]
        return [
            w * np.sin(angle) + tangential,
            (w * np.cos(angle) - normal) / tension,
            stretch * np.sin(angle),
        ]

    start = [np.hypot(weight, drag), np.arctan2(weight, drag), 0.0]
    tension, _, depth = solve_ivp(slopes, (0.0, length), start, rtol=1e-10, atol=1e-9).y[:, -1]
    return depth, tension


KNOT = 1852.0 / 3600.0


FIBRE = {
    "diameter": 0.017, "mass": 0.55, "axial_stiffness": 8e6, "bending_stiffness": 20,
    "drag_normal": 1.5, "drag_tangential": 0.005,
}  # fmt: skip


def zajac(speed: float, depth: float) -> tuple[float, float]:
    """Top tension [N] and length [m] of a lay at the critical angle a, w cos a = D sin^2 a, without
    tension at the touchdown: its weight less the drag along it."""
    weight = FIBRE["mass"] * 9.80665 - 1025.0 * 9.80665 * np.pi / 4 * FIBRE["diameter"] ** 2
    drag = 0.5 * 1025.0 * FIBRE["drag_normal"] * FIBRE["diameter"] * speed**2
    cosine = (-weight + np.sqrt(weight**2 + 4.0 * drag**2)) / (2.0 * drag)
    slip = speed * (1.0 - cosine)
    along = 0.5 * 1025.0 * FIBRE["drag_tangential"] * np.pi * FIBRE["diameter"] * slip**2
    length = depth / np.sqrt(1.0 - cosine**2)
    return weight * depth - along * length, length


GRAVITY, DENSITY = 9.80665, 1025.0


class Kind:
    """A cable of a scene's data, as the equations below need it."""

    def __init__(self, data: dict, gravity: float = GRAVITY) -> None:
        area = np.pi / 4 * data["diameter"] ** 2
        self.mass = data["mass"]
        self.added = DENSITY * area * data.get("added_mass", 1.0)
        self.weight = data.get("submerged_weight", (data["mass"] - DENSITY * area) * gravity)
        self.stiffness = data["axial_stiffness"]
        self.normal = 0.5 * DENSITY * data.get("drag_normal", 1.0) * data["diameter"]
        self.tangential = 0.5 * DENSITY * data.get("drag_tangential", 0.01) * np.pi
        self.tangential *= data["diameter"]

    def drag(self, tangent, flow, stretch):
        """Force [N/m] of relative water velocity flow (3,) [m/s]."""
        along = flow @ tangent
        across = flow - along * tangent
        force = self.normal * np.linalg.norm(across) * across
        return (force + self.tangential * abs(along) * along * tangent) * np.sqrt(stretch)


def body_force(weight, area, flow):
    """Of a sphere's drag and weight (3,) [N]; area: drag area times coefficient [m2]."""
    return 0.5 * DENSITY * area * np.linalg.norm(flow) * flow - np.array([0.0, 0.0, weight])


def hanging_line(items, water, top, end=None):
    """Static line of cables and sphere-like bodies below (or above) its first point at `top` (3,).

    items: (Kind, length) and (weight, drag area) from the far end inwards, the first one a body;
    water(z) the relative velocity of the water (3,). Integrates force and place from the far end,
    whose depth is sought. Returns the far end's place, the force at the top (3,), places (n, 3).
    """
    from scipy.optimize import brentq

    def run(depth):
        force, place, shape = np.zeros(3), np.array([0.0, 0.0, depth]), []
        for one, other in items:
            if not isinstance(one, Kind):
                force = force - body_force(one, other, water(place[2]))
                continue

            def slopes(_s, y, kind=one):
                pull = np.linalg.norm(y[3:])
                tangent = y[3:] / pull
                stretch = 1.0 + pull / kind.stiffness
                load = kind.drag(tangent, water(y[2]), stretch) - [0.0, 0.0, kind.weight]
                return np.r_[stretch * tangent, -load]

            start = np.r_[place, force]
            found = solve_ivp(
                slopes, (0.0, other), start, "LSODA", rtol=1e-9, atol=1e-8,
                t_eval=np.linspace(0.0, other, 80),
            )  # fmt: skip
            place, force = found.y[:3, -1], found.y[3:, -1]
            shape.append(found.y[:3].T)
        return place, force, np.concatenate(shape)

    length = sum(other for one, other in items if isinstance(one, Kind))
    low, high = end or (top[2] - 1.05 * length, top[2])
    depth = brentq(lambda z: run(z)[0][2] - top[2], low, high, xtol=1e-6)
    place, force, shape = run(depth)
    shape = shape + (np.asarray(top) - place)
    return shape[0], force, shape


def steady_turn(kind, length, weight, area, mass, radius, speed):
    """Top tension [N] and place of a sphere-like body, from the centre of the circle on which the
    line's top at (radius, 0, 0) goes; all turns steadily. mass: with what water it moves [kg].

    In the frame that turns: drag of u = -W x r, inertia of W x (W x r); the end's place is sought.
    """
    from scipy.optimize import root

    rate = speed / radius

    def flow(r):
        return np.array([rate * r[1], -rate * r[0], 0.0])

    def inwards(r):  # acceleration
        return -(rate**2) * np.array([r[0], r[1], 0.0])

    def run(end):
        force = -body_force(weight, area, flow(end)) + mass * inwards(end)

        def slopes(_s, y):
            pull = np.linalg.norm(y[3:])
            tangent = y[3:] / pull
            stretch = 1.0 + pull / kind.stiffness
            load = kind.drag(tangent, flow(y[:3]), stretch) - [0.0, 0.0, kind.weight]
            moves = inwards(y[:3])
            across = moves - (moves @ tangent) * tangent
            return np.r_[stretch * tangent, kind.mass * moves + kind.added * across - load]

        return solve_ivp(slopes, (0.0, length), np.r_[end, force], "DOP853", rtol=1e-9, atol=1e-8)

    def missed(end):
        return run(end).y[:3, -1] - [radius, 0.0, 0.0]

    # From slow turns, where it hangs almost straight, to the one that is asked for.
    guess, asked = np.array([radius, -0.3 * length, -0.9 * length]), speed
    for share in (0.3, 0.45, 0.6, 0.7, 0.8, 0.9, 1.0):
        rate = share * asked / radius
        found = root(missed, guess, tol=1e-8)
        guess = found.x
    if not found.success:
        raise ArithmeticError(found.message)
    return float(np.linalg.norm(run(guess).y[3:, -1])), guess


def lumped_line(pieces, body, motion, start, times, floor=None, step=0.5):
    """Lumped masses on springs, for fast motions of a line with a sphere-like body at its end.

    pieces: (Kind, length, segments) from the top; body: mass with added mass [kg], weight [N], drag
    area times coefficient [m2]; motion(t): place and velocity of the top (3,); start (n + 1, 3) at
    rest against the top's velocity; a floor at z = `floor` is a stiff, damped spring below it.
    Returns places (len(times), n, 3) and the top's tension. Second order in the spacing.
    """
    kinds = [(kind, length / count) for kind, length, count in pieces for _ in range(count)]
    rest = np.array([h for _, h in kinds])
    stiff = np.array([kind.stiffness for kind, _ in kinds])
    halves = 0.5 * np.array([[k.mass * h, k.added * h, k.weight * h] for k, h in kinds])
    nodal = halves.copy()
    nodal[:-1] += halves[1:]
    normal = 0.5 * np.array([k.normal * h for k, h in kinds])
    tangential = 0.5 * np.array([k.tangential * h for k, h in kinds])
    normal[:-1] += normal[1:].copy()
    tangential[:-1] += tangential[1:].copy()
    mass, added, weight = nodal.T.copy()
    mass[-1] += body[0]
    weight[-1] += body[1]
    damping = 0.02 * np.sqrt(stiff * rest * np.array([k.mass for k, _ in kinds]) * rest) / rest
    count = len(kinds)

    def segments(t, y):
        state = y.reshape(count, 6)
        place, velocity = motion(t)
        r, v = np.vstack((place, state[:, :3])), np.vstack((velocity, state[:, 3:]))
        chord = np.diff(r, axis=0)
        distance = np.linalg.norm(chord, axis=1)
        way = chord / distance[:, None]
        speed = np.einsum("ij,ij->i", np.diff(v, axis=0), way)
        return r, v, way, stiff * np.maximum(distance / rest - 1.0, -1e-6) + damping * speed

    def slope(t, y):
        r, v, way, pull = segments(t, y)
        force = -pull[:, None] * way
        force[:-1] -= force[1:]
        tangent = way.copy()
        tangent[:-1] += way[1:]
        tangent /= np.linalg.norm(tangent, axis=1)[:, None]
        u = -v[1:]
        along = np.einsum("ij,ij->i", u, tangent)
        across = u - along[:, None] * tangent
        force += normal[:, None] * np.linalg.norm(across, axis=1)[:, None] * across
        force += (tangential * np.abs(along) * along)[:, None] * tangent
        force[:, 2] -= weight
        force[-1] += 0.5 * DENSITY * body[2] * np.linalg.norm(u[-1]) * u[-1]
        if floor is not None:
            sunk = np.maximum(floor - r[1:, 2], 0.0)
            force[:, 2] += weight * sunk / 0.05 - mass * 4.0 * (sunk > 0.0) * np.minimum(
                v[1:, 2], 0.0
            )
        lengthwise = np.einsum("ij,ij->i", force, tangent)[:, None] * tangent
        acceleration = lengthwise / mass[:, None] + (force - lengthwise) / (mass + added)[:, None]
        return np.hstack((v[1:], acceleration)).ravel()

    begin = np.hstack((np.asarray(start)[1:], np.tile(motion(0.0)[1], (count, 1)))).ravel()
    found = solve_ivp(
        slope, (0.0, times[-1]), begin, "LSODA", t_eval=times, rtol=1e-4, atol=1e-4,
        lband=11, uband=11, max_step=step,
    )  # fmt: skip
    if not found.success:
        raise ArithmeticError(found.message)
    places = found.y.T.reshape(len(times), count, 6)[:, :, :3]
    tops = np.array([segments(t, y)[3][0] for t, y in zip(times, found.y.T, strict=True)])
    return places, tops
