"""A wire in a bow between two ends that are held, of few elements, against lumped masses.

One end is lifted and stopped within a second, in a vacuum. The tension rings at 5 Hz, about four
turns a second of which each is as large as a fifth of the tension, and the transverse waves of that
frequency are shorter than the elements of a bow at rest.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import cablemodel as cm

Array = NDArray[np.float64]

LENGTH, SPAN = 104.0, 100.0
STIFFNESS, MASS, DAMPING, GRAVITY = 4e7, 3.0, 1e4, 9.80665
LIFT = ((0.0, 0.0), (0.5, 1.0), (1.0, 0.0))  # times, velocities upwards
UNTIL, INTERVAL = 2.0, 0.02
PIECES, STEP = 80, 1e-4  # of the lumped masses; twice as many take half the step [s]


def scene(tau: float, lift: tuple[tuple[float, float], ...] = LIFT) -> dict[str, Any]:
    """The wire, and what its first end does."""
    wire = {"diameter": 0.03, "mass": MASS, "axial_stiffness": STIFFNESS, "axial_damping": DAMPING}
    return {
        "environment": {"water_density": 0.0},
        "cable_types": {"wire": wire},
        "line": [{"cable": {"type": "wire", "length": LENGTH}}],
        "end": {"anchor": [SPAN, 0.0, 0.0]},
        "vessel": {"velocity": [{"t": t, "velocity": [0.0, 0.0, v]} for t, v in lift]},
        "solver": {"tolerance": tau},
        "run": {"duration": UNTIL, "output_interval": INTERVAL},
    }  # fmt: skip


def tensions(model: cm.CableModel) -> Array:
    """At the first end, at the outputs [N]."""
    found = []
    for k in range(1, round(UNTIL / INTERVAL) + 1):
        model.step_to(INTERVAL * k)
        found.append(model.top_tension)
    return np.array(found)


def forces(places: Array, speeds: Array, piece: float) -> tuple[Array, Array]:
    """On lumped masses [N], and the tensions between them [N]."""
    chords = np.diff(places, axis=0)
    lengths = np.linalg.norm(chords, axis=1)
    along = chords / lengths[:, None]
    faster = np.einsum("ij,ij->i", np.diff(speeds, axis=0), along)
    pulls = STIFFNESS * (lengths / piece - 1.0) + DAMPING * faster / piece
    found = np.zeros_like(places)
    found[:-1] += pulls[:, None] * along
    found[1:] -= pulls[:, None] * along
    found[:, 1] -= MASS * piece * GRAVITY
    return found, pulls


def at_rest(pieces: int) -> Array:
    """Places of lumped masses at rest, by Newton's method (pieces + 1, 2) [m]."""
    piece = LENGTH / pieces
    x = np.linspace(0.0, SPAN, pieces + 1)
    places = np.column_stack((x, 0.005 * x * (x - SPAN)))
    inner = slice(2, 2 * pieces)
    for _ in range(60):
        left, pulls = forces(places, np.zeros_like(places), piece)
        chords = np.diff(places, axis=0)
        lengths = np.linalg.norm(chords, axis=1)
        matrix = np.zeros((2 * pieces + 2,) * 2)
        for i in range(pieces):
            along = np.outer(chords[i], chords[i]) / lengths[i] ** 2
            held = max(pulls[i], 1.0) / lengths[i] * (np.eye(2) - along)
            block = STIFFNESS / piece * along + held
            a, b = slice(2 * i, 2 * i + 2), slice(2 * i + 2, 2 * i + 4)
            matrix[a, a] += block
            matrix[b, b] += block
            matrix[a, b] -= block
            matrix[b, a] -= block
        change = np.linalg.solve(matrix[inner, inner], left.ravel()[inner])
        places.ravel()[inner] += change * min(1.0, 1.0 / np.abs(change).max())
        if np.abs(change).max() < 1e-11:
            return places
    raise ArithmeticError("no shape at rest")


def lumped(pieces: int, step: float) -> Array:
    """Tension at the end that is lifted, at the outputs [N]: the classical Runge-Kutta scheme."""
    piece = LENGTH / pieces
    times, lifts = np.array(LIFT).T
    climbs = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(times) * (lifts[1:] + lifts[:-1]))))
    places = at_rest(pieces)
    speeds = np.zeros_like(places)
    mass = MASS * piece

    def rise(t: float) -> tuple[float, float]:
        k = int(np.clip(np.searchsorted(times, t, "right") - 1, 0, len(times) - 1))
        v = float(np.interp(t, times, lifts))
        return climbs[k] + 0.5 * (t - times[k]) * (lifts[k] + v), v

    def move(t: float, q: Array, v: Array) -> Array:
        q[0, 1], v[0, 1] = rise(t)
        found = forces(q, v, piece)[0] / mass
        found[0] = found[-1] = 0.0
        return found

    count = round(INTERVAL / step)
    found = []
    for k in range(round(UNTIL / INTERVAL)):
        for n in range(count):
            t = INTERVAL * k + step * n
            a1 = move(t, places, speeds)
            v1 = speeds + 0.5 * step * a1
            a2 = move(t + 0.5 * step, places + 0.5 * step * speeds, v1)
            v2 = speeds + 0.5 * step * a2
            a3 = move(t + 0.5 * step, places + 0.5 * step * v1, v2)
            v3 = speeds + step * a3
            a4 = move(t + step, places + step * v2, v3)
            places = places + step / 6.0 * (speeds + 2.0 * v1 + 2.0 * v2 + v3)
            speeds = speeds + step / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        places[0, 1], speeds[0, 1] = rise(INTERVAL * (k + 1))
        pulls = forces(places, speeds, piece)[1]
        # Half a mass lies between the end and the first piece's middle.
        found.append(1.5 * pulls[0] - 0.5 * pulls[1])
    return np.array(found)


def elements(model: cm.CableModel) -> int:
    return int(model.statistics["elements"])


def test_the_tension_is_that_of_lumped_masses() -> None:
    """They are off by the square of their spacing: by a third of the promise at most, together."""
    coarse, fine = lumped(PIECES, STEP), lumped(2 * PIECES, 0.5 * STEP)
    found = tensions(cm.CableModel(cm.load_scene(scene(1e-3))))
    missed = np.abs(found - fine - (fine - coarse) / 3.0)
    assert missed.max() < 10.0 * 1e-3 * fine.max()


@pytest.mark.parametrize("tau", [1e-3, 3e-4, 1e-4])
def test_the_tension_keeps_its_promise_on_a_mesh_that_follows_the_ring(tau: float) -> None:
    reference = scene(1e-5)
    reference["line"][0]["cable"]["elements"] = 200
    fine = tensions(cm.CableModel(cm.load_scene(reference)))
    found = tensions(cm.CableModel(cm.load_scene(scene(tau))))
    assert np.abs(found - fine).max() < 10.0 * tau * fine.max()


def test_what_starts_no_ring_keeps_its_elements() -> None:
    """Neither a lift that begins and ends slowly, nor the same one along a wire drawn taut."""
    slow = cm.CableModel(cm.load_scene(scene(1e-3, ((0.0, 0.0), (20.0, 0.05)))))
    at_first = elements(slow)
    tensions(slow)
    assert elements(slow) == at_first
    drawn = scene(1e-3)
    drawn["end"]["anchor"][0] = LENGTH + 0.02
    taut = cm.CableModel(cm.load_scene(drawn))
    at_first = elements(taut)
    tensions(taut)
    assert elements(taut) == at_first
