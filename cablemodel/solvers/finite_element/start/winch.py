"""The cables of line and drum in the order in which they leave."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.start.line import Line, hinged
from cablemodel.solvers.finite_element.start.scales import tension_per_length
from cablemodel.solvers.shared import layout as at

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.common import CableScene
    from cablemodel.scene.line import Cable

FloatArray = NDArray[np.float64]

WINCH_SPARE_NODES = 12
"""For joints at the vessel, and for a short line that is paid out again."""
JOINT_SPARE_NODES = 6
"""For each cable on the drum."""


@dataclass
class Winch:
    """The cables of line and drum in the order in which they leave, and what lies between them."""

    cables: list[Cable]
    nominal: list[float]
    bodies: list[int]
    """Row of the body at each one's lower end, -1: none."""
    hinges: list[bool]
    extra_nodes: int


def drum_rows(scene: Scene) -> list[int]:
    """Rows of the cable table of the drum's cables: one like that below it shares its row."""
    rows = []
    row, below = len(scene.cables) - 1, scene.cables[0]
    body = False
    for item in scene.payout.drum:
        cable = item.cable
        if cable is None:
            body = True
            continue
        if body or (below.type, below.model) != (cable.type, cable.model):
            row, below = row + 1, cable
        rows.append(row)
        body = False
    return rows


def lengths_of(scene: Scene) -> FloatArray:
    """Rows of CableLength: the line's cables from the vessel outwards, then the drum's."""
    cables = (*scene.cables, *scene.drum_cables)
    tensions = [*tension_per_length(scene), *(0.0 for _ in scene.drum_cables)]
    rows = [*range(len(scene.cables) - 1, -1, -1), *drum_rows(scene)]
    table = np.zeros((len(cables), at.LENGTH_WORDS))
    for n, (cable, row, tension) in enumerate(zip(cables, rows, tensions, strict=True)):
        fill_length(table[n], scene, cable)
        table[n, at.CableLength.row] = row
        table[n, at.CableLength.winch] = -1.0 if n < len(scene.cables) else 0.0
        table[n, at.CableLength.tension] = tension
    return table.reshape(-1)


def fill_length(row: FloatArray, scene: CableScene, cable: Cable) -> None:
    """What a CableLength says of a cable of a scene's length."""
    kind = scene.cable_types[cable.type]
    for word in (at.CableLength.first, at.CableLength.before, at.CableLength.length):
        row[word] = cable.length
    row[at.CableLength.softness] = kind.strain_coefficients[0]
    row[at.CableLength.mass] = kind.mass
    row[at.CableLength.drag] = scene.environment.water_density * kind.drag_normal * kind.diameter
    row[at.CableLength.counted] = cable.elements is not None


def winch_of(scene: Scene, line: Line, drum_room: float) -> Winch:
    """The cable table; bodies on the drum are added to the line's bodies."""
    elements = sum(1 for joint in line.joint[1:] if joint == 0)
    usual = scene.line_length / elements
    winch = Winch([], [], [], [], WINCH_SPARE_NODES)
    rows = {place: row for row, (_, _, place) in enumerate(line.bodies)}
    body = -1
    nominal = list(reversed(line.nominal))
    for place in range(len(scene.line) - 1, -1, -1):
        cable = scene.line[place].cable
        if cable is None:
            body = rows[place] if winch.cables else -1
            continue
        _add_cable(scene, winch, cable, nominal[len(winch.cables)], body)
        body = -1
    row = iter(drum_rows(scene))
    for index, item in enumerate(scene.payout.drum):
        if item.body is not None:
            line.bodies.append((-1, item.body, len(scene.line) + index))
            body = len(line.bodies) - 1
            winch.extra_nodes += 2
            continue
        cable = item.cable
        assert cable is not None
        size = usual if cable.elements is None else cable.length / cable.elements
        winch.extra_nodes += math.ceil(drum_room * cable.length / size) + JOINT_SPARE_NODES
        if next(row) == len(winch.cables):
            _add_cable(scene, winch, cable, size, body)
        elif cable.elements is not None:
            winch.nominal[-1] = size
        body = -1
    return winch


def _add_cable(scene: Scene, winch: Winch, cable: Cable, nominal: float, body: int) -> None:
    winch.hinges.append(bool(winch.cables) and hinged(scene, winch.cables[-1], cable, body >= 0))
    winch.cables.append(cable)
    winch.nominal.append(nominal)
    winch.bodies.append(body)
