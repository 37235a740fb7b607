"""A scene's sea as components: their frequencies, numbers and phases; the motion of the water.

Airy waves over a constant depth. The kernels (kernels/water/waves.py) sum the same components;
their motion in NumPy serves plots and tests.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import SceneProblem

if TYPE_CHECKING:
    from cablemodel.scene.common import CableScene
    from cablemodel.scene.environment import JonswapWaves, RegularWave, WaveComponents, Waves

FloatArray = NDArray[np.float64]

BREAKING = 0.142
"""Highest wave in units of its length, times tanh(kh) (Miche 1944)."""
_GRID = 20_000
_TAIL = 12.0
"""Highest frequency of the integral over the spectrum, in units of the peak's."""


@dataclass(frozen=True, eq=False)
class Sea:
    """Components of a sea; arrays (n,). Each is its own: two are not compared."""

    amplitude: FloatArray
    """[m]."""
    frequency: FloatArray
    """[rad/s]."""
    number: FloatArray
    """k [rad/m]."""
    direction: float
    """Of travel, from x counter-clockwise [rad]."""
    phase: FloatArray
    """At the origin at t = 0 [rad]: 0 is a crest."""
    depth: float
    """Of the water [m]; inf: deep."""
    ramp: float
    """Time in which it comes up from calm water [s]."""
    period: float
    """Of the wave, of the spectrum's peak, or of the largest component [s]."""
    length: float
    """Of a wave of this period [m]."""

    def __post_init__(self) -> None:
        for array in (self.amplitude, self.frequency, self.number, self.phase):
            array.setflags(write=False)  # one sea serves all that ask

    @property
    def significant_height(self) -> float:
        """Four times the standard deviation of the surface [m]."""
        return 4.0 * math.sqrt(0.5 * float(np.sum(self.amplitude**2)))

    @property
    def speed(self) -> float:
        """A high speed of the water at the surface [m/s]: of a wave of twice the rms height."""
        mirror = np.exp(-2.0 * self.number * self.depth)
        speeds = self.amplitude * self.frequency * (1.0 + mirror) / (1.0 - mirror)
        return 2.0 * float(np.sqrt(0.5 * np.sum(speeds**2)))

    def share(self, t: float) -> float:
        """Of the waves that has come up at time t: a quintic from 0 to 1."""
        if t <= 0.0 or self.ramp == 0.0:
            return float(t > 0.0)
        x = min(1.0, t / self.ramp)
        return x**3 * (10.0 + x * (6.0 * x - 15.0))

    def elevation(self, t: float, x: FloatArray | float = 0.0, y: FloatArray | float = 0.0) -> Any:
        """Height of the surface [m] at places x, y of any one shape."""
        theta = self._phases(t, np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        return self.share(t) * (self.amplitude * np.cos(theta)).sum(axis=-1)

    def head(self, t: float, points: FloatArray) -> FloatArray:
        """Pressure of the waves at points (n, 3) over rho g (n,) [m]; above z = 0 that at z = 0."""
        points = np.asarray(points, dtype=float)
        theta = self._phases(t, points[:, 0], points[:, 1])
        level = np.clip(points[:, 2], -self.depth, 0.0)[:, None]
        up = np.exp(self.number * level)
        mirror = np.exp(-2.0 * self.number * self.depth)
        found = self.amplitude * (up + mirror / up) / (1.0 + mirror) * np.cos(theta)
        return self.share(t) * np.asarray(found.sum(axis=1))

    def velocity(self, t: float, points: FloatArray) -> FloatArray:
        """Velocity of the water at points (n, 3), without current, (n, 3) [m/s]."""
        points = np.asarray(points, dtype=float)
        theta = self._phases(t, points[:, 0], points[:, 1])
        level = np.clip(points[:, 2], -self.depth, 0.0)[:, None]
        up = np.exp(self.number * level)
        mirror = np.exp(-2.0 * self.number * self.depth)
        speed = self.amplitude * self.frequency / (1.0 - mirror)
        along = (speed * (up + mirror / up) * np.cos(theta)).sum(axis=1)
        upward = (speed * (up - mirror / up) * np.sin(theta)).sum(axis=1)
        c, s = math.cos(self.direction), math.sin(self.direction)
        return self.share(t) * np.stack([c * along, s * along, upward], axis=1)

    def _phases(self, t: float, x: FloatArray, y: FloatArray) -> FloatArray:
        way = x * math.cos(self.direction) + y * math.sin(self.direction)
        return self.number * way[..., None] - self.frequency * t + self.phase


def sea(scene: CableScene) -> Sea | None:
    """The components of a scene's waves; None: it has none."""
    waves = scene.environment.waves
    if waves is None:
        return None
    return _sea(waves, water_depth(scene), scene.environment.gravity)


@lru_cache(maxsize=8)
def _sea(waves: Waves, depth: float, gravity: float) -> Sea:
    """Kept, since a start asks eight times and the bands of equal energy take 3 ms."""
    kind: RegularWave | JonswapWaves | WaveComponents
    if waves.regular is not None:
        kind = waves.regular
        period = kind.period
        amplitude = np.array([0.5 * kind.height])
        frequency = np.array([2.0 * math.pi / period])
        phase = np.array([kind.phase])
    elif waves.components is not None:
        kind = waves.components
        period = max(kind.rows, key=lambda row: row.amplitude).period
        amplitude = np.array([row.amplitude for row in kind.rows])
        frequency = 2.0 * math.pi / np.array([row.period for row in kind.rows])
        phase = np.array([row.phase for row in kind.rows])
    else:
        assert waves.jonswap is not None
        kind = waves.jonswap
        period = kind.tp
        frequency = _equal_energy(kind)
        amplitude = np.full(kind.components, kind.hs / math.sqrt(8.0 * kind.components))
        # RandomState's stream is frozen: the same seed gives the same sea with any NumPy.
        phase = 2.0 * math.pi * np.random.RandomState(kind.seed).random_sample(kind.components)
    return Sea(
        amplitude=amplitude,
        frequency=frequency,
        number=wave_number(frequency, depth, gravity),
        direction=kind.direction,
        phase=phase,
        depth=depth,
        ramp=period if waves.ramp is None else waves.ramp,
        period=period,
        length=2.0 * math.pi / float(wave_number(np.array(2.0 * math.pi / period), depth, gravity)),
    )


def water_depth(scene: CableScene) -> float:
    """Below the tow point, or the first vessel, at t = 0 [m]; inf without a floor."""
    floor = scene.environment.floor
    x, y, _ = scene.place
    return math.inf if floor is None else -floor.height(x, y)


def wave_number(frequency: FloatArray, depth: float, gravity: float) -> FloatArray:
    """k [rad/m] of w^2 = g k tanh(k h), by Newton's method in k h."""
    deep = np.asarray(frequency, dtype=float) ** 2 / gravity
    if not math.isfinite(depth):
        return deep
    target = deep * depth
    # Guo (2002): within 0.75 % at any depth.
    x = target / (1.0 - np.exp(-(target**1.25))) ** 0.4
    for _ in range(4):
        tanh = np.tanh(x)
        x -= (x * tanh - target) / (tanh + x * (1.0 - tanh**2))
    return np.asarray(x / depth)


def jonswap_shape(frequency: FloatArray, peak: float, gamma: float) -> FloatArray:
    """JONSWAP spectrum over frequency [rad/s], not scaled (Hasselmann et al. 1973)."""
    ratio = frequency / peak
    width = np.where(ratio <= 1.0, 0.07, 0.09)
    enhancement = gamma ** np.exp(-0.5 * ((ratio - 1.0) / width) ** 2)
    return np.asarray(ratio**-5.0 * np.exp(-1.25 * ratio**-4.0) * enhancement)


def _equal_energy(waves: JonswapWaves) -> FloatArray:
    """Frequencies of components of equal energy: medians of equal parts of the spectrum.

    No two are multiples of one another, so that the sea does not repeat.
    """
    peak = 2.0 * math.pi / waves.tp
    grid = peak * np.linspace(0.3, _TAIL, _GRID)
    density = jonswap_shape(grid, peak, waves.gamma)
    energy = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))])
    shares = (np.arange(waves.components) + 0.5) / waves.components
    return np.interp(shares, energy / energy[-1], grid)


def problems(scene: CableScene) -> Iterator[SceneProblem]:
    """Waves that cannot be: in a vacuum, without gravity, on dry land, or that break."""
    waves = scene.environment.waves
    if waves is None:
        return
    environment = scene.environment
    for name, value in (
        ("water_density", environment.water_density),
        ("gravity", environment.gravity),
    ):
        if value == 0.0:
            problem = f"there are no waves where environment.{name} is 0"
            yield SceneProblem("environment.waves", "waves", problem, "waves: null")
            return
    depth = water_depth(scene)
    if depth <= 0.0:
        problem = f"the water is {depth:g} m deep below the tow point"
        yield SceneProblem("environment.waves", "waves", problem, "a floor below z = 0")
        return
    if waves.regular is not None:
        path, height, period = "regular.height", waves.regular.height, waves.regular.period
    elif waves.components is not None:
        field = _sea(waves, depth, environment.gravity)
        height = min(2.0 * float(field.amplitude.sum()), field.significant_height)
        path, period = "components.rows", field.period
    else:
        assert waves.jonswap is not None
        path, height, period = "jonswap.hs", waves.jonswap.hs, waves.jonswap.tp
    number = float(wave_number(np.array(2.0 * math.pi / period), depth, environment.gravity))
    highest = BREAKING * 2.0 * math.pi / number * math.tanh(min(number * depth, 50.0))
    if height > highest:
        problem = f"waves of {period:g} s break at {highest:g} m"
        yield SceneProblem(f"environment.waves.{path}", height, problem, f"at most {highest:g} m")
