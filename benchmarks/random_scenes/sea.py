"""Waves for a drawn scene: the water gets a surface, and the tow point a height over it."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np

from benchmarks.random_scenes.chance import COUNT, decades, latin_hypercube
from benchmarks.scenes import GRAVITY

STEEPEST = 0.06
"""Height of a wave over its length in deep water, at most: they break at 0.14 [-]."""


@functools.cache
def _hypercube(number: int) -> np.ndarray:
    return latin_hypercube(5, 80 + number)


def add_waves(scene: dict[str, Any], place: int) -> str:
    """Put a drawn scene into a sea, by its place among those in waves; returns the sea's kind.

    Regular waves or a JONSWAP sea, of 3 to 15 s, up to :data:`STEEPEST` and a fifth of the depth
    high. The tow point is up to 2 m below and 5 m above still water, by a third of the length at
    most; all that is given relative to it goes with it.
    """
    kind, period, height, level, heading = _hypercube(place // COUNT)[place % COUNT].tolist()
    length = sum(item["cable"]["length"] for item in scene["line"] if "cable" in item)
    rise = min(-2.0 + 7.0 * level, length / 3.0)
    environment, vessel = scene["environment"], scene["vessel"]
    vessel["position"][2] += rise
    floor = environment.get("floor")
    depth = math.inf
    if floor is not None:
        floor["z"] += rise
        depth = -floor["z"]
    if "end" in scene:
        scene["end"]["anchor"][2] += rise
    seconds = decades(period, 3.0, 15.0)
    highest = min(STEEPEST * GRAVITY * seconds**2 / (2.0 * math.pi), 0.2 * depth)
    part = 30.0 ** (height - 1.0)
    waves = {"direction": 2.0 * math.pi * heading}
    if kind < 0.6:
        word = "regular"
        waves |= {"height": highest * part, "period": seconds}
    else:
        word = "jonswap"
        waves |= {"hs": 0.6 * highest * part, "tp": seconds, "seed": place}
    environment["waves"] = {word: waves}
    return word
