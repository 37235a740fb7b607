"""The cables of line and drum in the order in which they leave."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cablemodel.instance.line import Line, hinged

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.line import Cable

SPARE_NODES = 12
"""For joints at the vessel, and for a short line that is paid out again."""
SHORTEST_LINE = 0.01
"""Of the initial length: what reel-in leaves out."""
SHORTEST_PIECE = 0.1
"""Of an element: cable that must be out before the joint below it leaves the drum."""


@dataclass
class Winch:
    """The cables of line and drum in the order in which they leave, and what lies between them."""

    cables: list[Cable]
    leaves: list[float]
    """Pay-out at which each one's vessel end passes the tow point [m]."""
    nominal: list[float]
    bodies: list[int]
    """Row of the body at each one's lower end, -1: none."""
    hinges: list[bool]
    extra_nodes: int
    most: float
    least: float


def winch_of(scene: Scene, line: Line, drum_room: float) -> Winch:
    """The cable table; bodies on the drum are added to the line's bodies."""
    total = scene.line_length
    elements = sum(1 for joint in line.joint[1:] if joint == 0)
    usual = total / elements
    winch = Winch([], [], [], [], [], SPARE_NODES, 0.0, 0.0)
    rows = {place: row for row, (_, _, place) in enumerate(line.bodies)}
    below = total
    body = -1
    nominal = list(reversed(line.nominal))
    for place in range(len(scene.line) - 1, -1, -1):
        item = scene.line[place]
        if item.cable is None:
            body = rows[place] if winch.cables else -1
            continue
        below -= item.cable.length
        _add_cable(winch, item.cable, -below, nominal[len(winch.cables)], body)
        body = -1
    for index, item in enumerate(scene.payout.drum):
        if item.body is not None:
            line.bodies.append((-1, item.body, len(scene.line) + index))
            body = len(line.bodies) - 1
            continue
        assert item.cable is not None
        winch.most += item.cable.length
        top = winch.cables[-1]
        winch.extra_nodes += math.ceil(drum_room * item.cable.length / usual) + 6
        if body < 0 and (top.type, top.model) == (item.cable.type, item.cable.model):
            winch.leaves[-1] = winch.most
        else:
            _add_cable(winch, item.cable, winch.most, usual, body)
        body = -1
    winch.least = -(total - SHORTEST_LINE * total)
    above = 0.0
    index = -1
    for item in scene.line:
        if item.cable is not None:
            above += item.cable.length
            index += 1
        elif item.body is not None and item.body.half_length > 0.0:
            # Not taken onto the drum: reel-in ends before it.
            winch.least = max(winch.least, SHORTEST_PIECE * line.nominal[index] - above)
            break
    return winch


def _add_cable(winch: Winch, cable: Cable, leaves: float, nominal: float, body: int) -> None:
    winch.hinges.append(bool(winch.cables) and hinged(winch.cables[-1], cable, body >= 0))
    winch.cables.append(cable)
    winch.leaves.append(leaves)
    winch.nominal.append(nominal)
    winch.bodies.append(body)
