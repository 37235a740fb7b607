"""The cables of line and drum in the order in which they leave."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cablemodel.solvers.finite_element.start.line import Line, hinged
from cablemodel.solvers.finite_element.start.scales import bodies_length

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.line import Cable

WINCH_SPARE_NODES = 12
"""For joints at the vessel, and for a short line that is paid out again."""
JOINT_SPARE_NODES = 6
"""For each cable on the drum."""
SHORTEST_LINE = 0.01
"""Of the initial length: what reel-in leaves out."""
SHORTEST_PIECE = 0.01
"""Of an element: cable that must be out before the joint below it leaves the drum."""
WINCH_FIRST_PIECE = 0.02
"""Of a body of finite length: cable that must be out before the body leaves the tow point."""
LEAST_PIECE = 1e-3
"""Of an element: the same where the body is short."""


@dataclass
class Winch:
    """The cables of line and drum in the order in which they leave, and what lies between them."""

    cables: list[Cable]
    leaves: list[float]
    """Travel of cable and bodies at which each one's vessel end passes the tow point [m]."""
    nominal: list[float]
    bodies: list[int]
    """Row of the body at each one's lower end, -1: none."""
    hinges: list[bool]
    shortest: list[float]
    """Length of each one below which its lower end stays on the drum, or at the tow point [m]."""
    extra_nodes: int
    most: float
    """Cable on the drum [m]."""
    most_travel: float
    least_travel: float


def winch_of(scene: Scene, line: Line, drum_room: float) -> Winch:
    """The cable table; bodies on the drum are added to the line's bodies."""
    total = scene.line_length
    elements = sum(1 for joint in line.joint[1:] if joint == 0)
    usual = total / elements
    winch = Winch([], [], [], [], [], [], WINCH_SPARE_NODES, 0.0, 0.0, 0.0)
    rows = {place: row for row, (_, _, place) in enumerate(line.bodies)}
    below = total + bodies_length(scene)
    body = -1
    nominal = list(reversed(line.nominal))
    for place in range(len(scene.line) - 1, -1, -1):
        item = scene.line[place]
        if item.body is not None:
            below -= 2.0 * item.body.half_length
            body = rows[place] if winch.cables else -1
            continue
        assert item.cable is not None
        below -= item.cable.length
        _add_cable(scene, winch, item.cable, -below, nominal[len(winch.cables)], body)
        body = -1
    for index, item in enumerate(scene.payout.drum):
        if item.body is not None:
            line.bodies.append((-1, item.body, len(scene.line) + index))
            body = len(line.bodies) - 1
            winch.most_travel += 2.0 * item.body.half_length
            winch.extra_nodes += 2
            continue
        cable = item.cable
        assert cable is not None
        winch.most += cable.length
        winch.most_travel += cable.length
        top = winch.cables[-1]
        size = usual if cable.elements is None else cable.length / cable.elements
        winch.extra_nodes += math.ceil(drum_room * cable.length / size) + JOINT_SPARE_NODES
        if body >= 0 or (top.type, top.model) != (cable.type, cable.model):
            _add_cable(scene, winch, cable, winch.most_travel, size, body)
        else:
            winch.leaves[-1] = winch.most_travel
            if cable.elements is not None:
                winch.nominal[-1] = size
        body = -1
    winch.least_travel = _least_travel(scene)
    _set_shortest(winch, line)
    return winch


def _least_travel(scene: Scene) -> float:
    """Travel at which reel-in ends: what is left is SHORTEST_LINE, and bodies within it [m]."""
    left = SHORTEST_LINE * scene.line_length
    bodies = 0.0
    for item in reversed(scene.line):
        if item.cable is None:
            assert item.body is not None
            bodies += 2.0 * item.body.half_length
        elif item.cable.length >= left:
            break
        else:
            left -= item.cable.length
    return bodies - bodies_length(scene) - scene.line_length * (1.0 - SHORTEST_LINE)


def _set_shortest(winch: Winch, line: Line) -> None:
    """How much of each cable is out before what lies below it leaves the tow point."""
    for index, nominal in enumerate(winch.nominal):
        row = winch.bodies[index]
        body = 0.0 if row < 0 else 2.0 * line.bodies[row][1].half_length
        length = nominal
        if index > 0:
            length = min(nominal, winch.leaves[index] - winch.leaves[index - 1] - body)
        shortest = SHORTEST_PIECE * length
        if body > 0.0:
            shortest = min(shortest, max(WINCH_FIRST_PIECE * body, LEAST_PIECE * nominal))
        winch.shortest.append(shortest)


def _add_cable(
    scene: Scene, winch: Winch, cable: Cable, leaves: float, nominal: float, body: int
) -> None:
    winch.hinges.append(bool(winch.cables) and hinged(scene, winch.cables[-1], cable, body >= 0))
    winch.cables.append(cable)
    winch.leaves.append(leaves)
    winch.nominal.append(nominal)
    winch.bodies.append(body)
