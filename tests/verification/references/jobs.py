"""Answers to ordinary jobs that no code of this project made: springs, masses, force balances."""

import numpy as np
from scipy.integrate import solve_ivp

LENGTH, STIFFNESS = 110.0, 150e6


CABLE_MASS = 14.0


LOAD, ADDED = 20_000.0, 10_000.0


def lumped_load(times, pieces=20):
    """Top tension [N] of `scenes/winch_stop.yaml` at times [s] from the winch's first slow-down on:
    the wire is lumped masses on springs, the load drags along its axis."""
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
        stretch_rates, (0.0, times[-1]), start, "DOP853", t_eval=times, rtol=1e-9, atol=1e-9
    )
    ramp = np.clip(times, 0.0, 0.2)
    return spring * (solved.y[0] - 0.5 * ramp + 0.5 * 2.5 * ramp**2)


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
