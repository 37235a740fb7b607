"""The method of 1998 as a solver: its block, and what is read off it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cablemodel.solvers.direct import library as entry
from cablemodel.solvers.direct.block import DirectBlock
from cablemodel.solvers.direct.build import build
from cablemodel.solvers.direct.failures import explain
from cablemodel.solvers.direct.kernels import layout as own
from cablemodel.solvers.protocol import FloatArray, IntArray, OfBlock, PlacedBody
from cablemodel.solvers.shared import layout as at

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.line import Body


class DirectSolver(OfBlock):
    """Direct integration after Sun & Leonard 1998: docs/theory.md."""

    memory: DirectBlock

    def __init__(self, scene: Scene, *, planar: bool | None = None) -> None:
        self.scene = scene
        self.memory = build(scene, planar=planar)
        items = scene.line_and_drum
        self._bodies: list[Body] = [item.body for item in items if item.body is not None]

    def step(self, end: float, inputs: FloatArray) -> int:
        return int(entry.step(self._ints, self._reals, end, inputs))

    def explain(self, status: int) -> tuple[str, str]:
        return explain(status)

    def failed_arc(self) -> float:
        arcs = self._all_arcs()
        return float(arcs[min(self.memory.failed_node, len(arcs) - 1)])

    def summary(self, out: FloatArray) -> None:
        entry.summary(self._ints, self._reals, out)

    def sample(self, stations: FloatArray, out: FloatArray) -> int:
        return int(entry.sample(self._ints, self._reals, stations, out))

    def node_arcs(self) -> FloatArray:
        arcs = np.unique(self._all_arcs())
        laid = float(self._reals[own.OwnScalars.laid])
        return np.append(arcs, arcs[-1] + laid) if laid > 0.0 else arcs

    @property
    def _sections(self) -> IntArray:
        """Rows of the sections, and the one behind the last that names the body at the end."""
        count = int(self._ints[own.OwnHeader.section_count])
        return self.memory.integers(own.OwnHeader.sections, count + 1, own.SECTION_WORDS)

    @property
    def _nodes(self) -> int:
        return int(self._sections[:-1, own.Section.count].sum())

    def _all_arcs(self) -> FloatArray:
        """Arc lengths of all nodes of the mesh from the vessel (nodes,) [m]."""
        lengths = self.memory.array(own.OwnHeader.length, self._nodes).copy()
        lengths[self._sections[:-1, own.Section.first]] = 0.0
        return np.asarray(np.cumsum(lengths), dtype=np.float64)

    def bodies(self) -> list[PlacedBody]:
        out = np.zeros((len(self._bodies), at.STATION_WORDS))
        entry.bodies(self._ints, self._reals, out.reshape(-1))
        placed = []
        for row in self._sections:
            index = int(row[own.Section.point])
            if index < 0 and row[own.Section.count] and row[own.Section.kind] == own.RIGID:
                index = int(row[own.Section.body])
            if index >= 0:
                found = at.Station(out[index])
                name = self._bodies[index].name
                placed.append(PlacedBody(name, found.position, found.velocity, found.tangent))
        return placed

    @property
    def planar(self) -> bool:
        return bool(self._ints[own.OwnHeader.planar])

    @property
    def elements(self) -> int:
        return self._nodes - int(self._ints[own.OwnHeader.section_count])

    @property
    def asleep(self) -> int:
        return 0
