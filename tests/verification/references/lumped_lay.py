"""Lays and anchored lines in heave by lumped masses: explicit, flexible, with Coulomb's friction on
a level floor.

Nothing of it is shared with the solvers: equal masses, springs that do not push, half of the drag
and added mass of each side, an explicit step far below the time in which a wave passes a spring.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.typing import NDArray

from tests.verification.references.moored import MooredCatenary

FloatArray = NDArray[np.float64]

FLOOR_GIVES = 0.01
"""By which cable at rest sinks into the floor [m]."""
FRICTION_HOLDS = 3e-4
"""Way on which friction takes hold of a lay [m]."""
ANCHORED_HOLDS = 2e-5
"""Of an anchored line, whose anchor feels what it lets through [m]."""


@njit(cache=True)
def _pull(x, z, u, w, i, own, out, cable):  # type: ignore[no-untyped-def]
    """Tension of the spring between masses i and i + 1, and its direction; own: its length."""
    dx, dz = x[i + 1] - x[i], z[i + 1] - z[i]
    length = math.hypot(dx, dz)
    rate = (u[i + 1] - u[i]) * dx + (w[i + 1] - w[i]) * dz
    rate = rate / length - out
    tension = max(0.0, cable[0] * (length - own) / own + cable[1] * rate / own)
    return tension, dx / length, dz / length


@njit(cache=True)
def _move(first, n, x, z, u, w, fx, fz, ax, az, owns, cable, step):  # type: ignore[no-untyped-def]
    """Move the masses from `first` on by their forces, but for the last one."""
    for i in range(first, n - 1):
        along = (fx[i] * ax[i] + fz[i] * az[i]) / (cable[3] * owns[i])
        across = (fz[i] * ax[i] - fx[i] * az[i]) / (cable[4] * owns[i])
        u[i] += step * (along * ax[i] - across * az[i])
        w[i] += step * (along * az[i] + across * ax[i])
        x[i] += step * u[i]
        z[i] += step * w[i]


@njit(cache=True)
def _forces(  # type: ignore[no-untyped-def]
    n, x, z, u, w, rest, spacing, top, out, cable, water, floor, fx, fz, ax, az, owns
):
    """Forces on n masses into fx, fz, directions along the line into ax, az, and how
    much cable is each one's into owns; the top tension."""
    weight = cable[2]
    fx[:n] = 0.0
    fz[:n] = 0.0
    tension = 0.0
    for i in range(n - 1):
        own, paid = (spacing, 0.0) if i < n - 2 else (top, out)
        tension, ax[i], az[i] = _pull(x, z, u, w, i, own, paid, cable)
        fx[i] += tension * ax[i]
        fz[i] += tension * az[i]
        fx[i + 1] -= tension * ax[i]
        fz[i + 1] -= tension * az[i]
    for i in range(n - 2, -1, -1):
        if i > 0:
            ax[i], az[i] = ax[i] + ax[i - 1], az[i] + az[i - 1]
        size = math.hypot(ax[i], az[i])
        ax[i], az[i] = ax[i] / size, az[i] / size
        owns[i] = spacing if 0 < i < n - 2 else 0.5 * (spacing + (top if i == n - 2 else 0.0))
        own = owns[i]
        along, across = u[i] * ax[i] + w[i] * az[i], w[i] * ax[i] - u[i] * az[i]
        across *= -water[0] * abs(across) * own
        along *= -water[1] * abs(along) * own
        fx[i] += along * ax[i] - across * az[i]
        fz[i] += along * az[i] + across * ax[i] - weight * own
        # The floor: a damped spring, and a slider behind one.
        hard = weight * own / FLOOR_GIVES
        press = -hard * (z[i] + floor[0]) - math.sqrt(hard * cable[4] * own) * w[i]
        if z[i] + floor[0] < 0.0 and press > 0.0:
            hold = floor[1] * weight * own / floor[2]
            most = floor[1] * press
            drawn = min(most, max(-most, hold * (x[i] - rest[i])))
            rest[i] = x[i] - drawn / hold
            fx[i] -= drawn
            fz[i] += press
        else:
            rest[i] = x[i]
    return tension


@njit(cache=True)
def _run(  # type: ignore[no-untyped-def]
    x,
    z,
    u,
    w,
    n,
    spacing,
    speed,
    rates,
    heave,
    period,
    ramp,
    cable,
    water,
    floor,
    step,
    outputs,
    every,
):
    """Top tensions at `outputs` times, `every` steps apart; x, z, u, w: from the far end on.
    rates: of pay-out, at every step."""
    room = len(x)
    fx, fz, ax, az, owns = np.zeros((5, room))
    rest = x.copy()
    tensions = np.zeros(outputs)
    top, start, rise = spacing, x[n - 1], z[n - 1]
    turn = 2.0 * math.pi / period
    for k in range(outputs * every):
        t, out = k * step, rates[k]
        u[n - 1] = speed
        w[n - 1] = -heave * turn * math.sin(turn * t) * min(1.0, t / ramp)
        x[n - 1], z[n - 1] = start + speed * t, rise
        tension = _forces(
            n, x, z, u, w, rest, spacing, top, out, cable, water, floor, fx, fz, ax, az, owns
        )
        _move(0, n, x, z, u, w, fx, fz, ax, az, owns, cable, step)
        rise += step * w[n - 1]
        top += step * out
        if (k + 1) % every == 0:
            tensions[k // every] = tension
        if top > 1.5 * spacing:
            # One more mass, where the cable between the ship and the last one has it.
            share = spacing / top
            dx, dz = x[n - 1] - x[n - 2], z[n - 1] - z[n - 2]
            length = math.hypot(dx, dz)
            x[n], z[n] = x[n - 1], z[n - 1]
            gone = u[n - 1] - out * dx / length, w[n - 1] - out * dz / length
            x[n - 1], z[n - 1] = x[n - 2] + share * dx, z[n - 2] + share * dz
            u[n - 1] = u[n - 2] + share * (gone[0] - u[n - 2])
            w[n - 1] = w[n - 2] + share * (gone[1] - w[n - 2])
            rest[n - 1] = x[n - 1]
            n += 1
            top -= spacing
    return tensions


def lay_in_heave(
    shape: FloatArray,
    length: float,
    *,
    kind: dict[str, float],
    speed: float,
    payout: float | Callable[[FloatArray], FloatArray],
    depth: float,
    friction: float,
    heave: float = 0.0,
    period: float = 10.0,
    ramp: float = 10.0,
    duration: float,
    interval: float = 0.1,
    density: float = 1025.0,
    gravity: float = 9.80665,
) -> FloatArray:
    """Top tensions [N] at the end of every interval [s] of a ship that heaves as it lays.

    Args:
        shape: places along the line at t = 0 at even distances, from the ship on (n, 2) [m].
        length: unstretched, of the line [m].
        kind: a cable type of a scene, with numbers, and axial damping.
        payout: rate [m/s], or what gives it at times (n,) [s].
        heave: -heave w sin(w t) min(1, t / ramp) is the ship's velocity upwards [m/s].
    """
    n, area = len(shape), 0.25 * math.pi * kind["diameter"] ** 2
    spacing = length / (n - 1)
    mass = kind["mass"]
    dead = mass + density * area  # across, with an added mass of what it displaces
    weight = (mass - density * area) * gravity
    drag = 0.5 * density * kind["diameter"]
    cable = np.array([kind["axial_stiffness"], kind["axial_damping"], weight, mass, dead])
    water = drag * np.array([kind["drag_normal"], math.pi * kind["drag_tangential"]])
    # Below what waves along a spring, and its damping, allow.
    step = min(0.25 * spacing * math.sqrt(mass / cable[0]), 0.25 * spacing**2 * mass / cable[1])
    every, outputs = math.ceil(interval / step), round(duration / interval)
    step = interval / every
    at = step * np.arange(outputs * every)
    rates = payout(at) if callable(payout) else np.full(len(at), payout)
    room = n + math.ceil(duration * float(rates.max()) / spacing) + 2
    x, z, u, w = np.zeros((4, room))
    x[:n], z[:n] = shape[::-1].T
    numbers = (
        speed,
        rates,
        heave,
        period,
        ramp,
        cable,
        water,
        np.array([depth, friction, FRICTION_HOLDS]),
    )
    tensions: FloatArray = _run(x, z, u, w, n, spacing, *numbers, step, outputs, every)
    return tensions


@njit(cache=True)
def _run_anchored(  # type: ignore[no-untyped-def]
    x, z, rest, spacing, speeds, cable, water, floor, step, outputs, every
):
    """Tensions of all springs (outputs, springs), from the anchor on, as x and z are. speeds: of
    the top, at every step (steps, 2)."""
    n = len(x)
    u, w, fx, fz, ax, az, owns = np.zeros((7, n))
    tensions = np.zeros((outputs, n - 1))
    for k in range(outputs * every):
        u[n - 1], w[n - 1] = speeds[k]
        if (k + 1) % every == 0:
            for i in range(n - 1):
                tensions[k // every, i], _, _ = _pull(x, z, u, w, i, spacing, 0.0, cable)
        _forces(
            n, x, z, u, w, rest, spacing, spacing, 0.0, cable, water, floor, fx, fz, ax, az, owns
        )
        _move(1, n, x, z, u, w, fx, fz, ax, az, owns, cable, step)
        x[n - 1] += step * u[n - 1]
        z[n - 1] += step * w[n - 1]
    return tensions


def anchored_masses(
    line: MooredCatenary,
    length: float,
    masses: int,
    motion: Callable[[FloatArray], FloatArray],
    *,
    kind: dict[str, float],
    depth: float,
    duration: float,
    interval: float,
    density: float = 1025.0,
) -> FloatArray:
    """Tensions [N] of all springs, from the anchor on, after every interval [s] (n, masses).

    Args:
        line: the start, from the anchor on.
        length: unstretched [m].
        motion: velocity away from the anchor and upwards (n, 2) [m/s] of the top at times (n,) [s].
        kind: a cable type of a scene, with numbers, axial damping and submerged weight.
    """
    s = np.linspace(0.0, length, masses + 1)
    spacing, area = length / masses, 0.25 * math.pi * kind["diameter"] ** 2
    mass, weight = kind["mass"], kind["submerged_weight"]
    cable = np.array(
        [kind["axial_stiffness"], kind["axial_damping"], weight, mass, mass + density * area]
    )
    drag = 0.5 * density * kind["diameter"]
    water = drag * np.array([kind["drag_normal"], math.pi * kind["drag_tangential"]])
    x, z = line.position(s).T.copy()
    lies = s < line.laid
    z = np.where(lies, -FLOOR_GIVES, z) - depth
    # Friction bears what tension loses from spring to spring.
    pull = np.diff(line.tension(s[:-1] + 0.5 * spacing), append=0.0, prepend=0.0)
    pull = np.where(lies & (s > 0.0), pull, 0.0)
    most = line.friction * weight * spacing
    rest = x - np.clip(pull / most, -1.0, 1.0) * ANCHORED_HOLDS
    step = min(
        0.25 * spacing * math.sqrt(mass / cable[0]),
        0.25 * spacing**2 * mass / cable[1],
        0.3 * math.sqrt(mass * ANCHORED_HOLDS / (line.friction * weight)),
    )
    every, outputs = math.ceil(interval / step), round(duration / interval)
    step = interval / every
    speeds = motion(step * np.arange(outputs * every))
    floor = np.array([depth, line.friction, ANCHORED_HOLDS])
    found: FloatArray = _run_anchored(
        x, z, rest, spacing, speeds, cable, water, floor, step, outputs, every
    )
    return found
