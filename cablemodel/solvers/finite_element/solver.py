"""The finite elements as a solver: their block, and what is read off it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers import library as entry
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.failures import MEANING
from cablemodel.solvers.finite_element.start.from_scene import build
from cablemodel.solvers.protocol import FloatArray, OfBlock, PlacedBody
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.scene import Scene


class FiniteElementSolver(OfBlock):
    """Mixed cubic elements, adaptive in time: docs/engine.md."""

    memory: Block

    def __init__(
        self, scene: Scene, *, planar: bool | None = None, sleep: bool | None = None
    ) -> None:
        self.scene = scene
        self.memory = build(scene, planar=planar)
        if sleep is False:
            self.memory.header.sleep = 0

    def step(self, end: float, inputs: FloatArray) -> int:
        memory = self.memory
        status: int = entry.step(memory.ints, memory.reals, end, inputs)
        while status == at.NO_CAPACITY:  # the state is as it was before the step
            memory.grow()
            status = entry.step(memory.ints, memory.reals, end, inputs)
        return status

    def explain(self, status: int) -> tuple[str, str]:
        return MEANING[status]

    def failed_arc(self) -> float:
        node = min(self.memory.failed_node, int(self._header.nodes) - 1)
        return float(self._all_arcs()[node])

    def summary(self, out: FloatArray) -> None:
        memory = self.memory
        entry.summary(memory.ints, memory.reals, out)

    def sample(self, stations: FloatArray, out: FloatArray) -> int:
        return int(entry.sample(self._ints, self._reals, stations, out))

    def node_arcs(self) -> FloatArray:
        joints = self.memory.integers(Header.joint, int(self._header.nodes))
        return np.asarray(self._all_arcs()[joints == 0], dtype=np.float64)

    def _all_arcs(self) -> FloatArray:
        """Arc lengths of all nodes from the vessel (nodes,) [m]."""
        nodes = int(self._header.nodes)
        edges = self.memory.array(Header.edges, nodes, at.EDGE_WORDS)
        arcs = edges[:, at.Edge.start] + edges[:, at.Edge.length] + self.memory.winch.paid
        arcs[0] = 0.0
        arcs[1] = edges[1, at.Edge.length]
        if self._header.rigid > 0 and nodes > 2:
            # The first bit of a body that comes is no cable, though the top element covers it.
            arcs[1] = edges[2, at.Edge.start] + self.memory.winch.paid
        # Rounding must not put a node beyond the end of the line, where there is no station.
        return np.asarray(np.minimum(arcs, arcs[-1]), dtype=np.float64)

    def bodies(self) -> list[PlacedBody]:
        rows: NDArray[np.float64] = self.memory.array(
            Header.bodies, int(self._header.body_count), at.BODY_WORDS
        )
        items = self.scene.line_and_drum
        arcs = self._all_arcs()
        placed = []
        motion = np.zeros((len(rows), at.STATION_WORDS))
        if self._header.rigid > 0:
            entry.bodies(self._ints, self._reals, motion.reshape(-1))
        for index in np.argsort(rows[:, at.Body.node], kind="stable"):
            row = rows[index]
            node = int(row[at.Body.node])
            if node < 0:
                continue
            body = items[int(row[at.Body.item])].body
            assert body is not None
            if row[at.Body.length] > 0.0:
                found = at.Station(motion[index])
            else:
                out = np.empty(at.STATION_WORDS)
                self.sample(arcs[node : node + 1].copy(), out)
                found = at.Station(out)
            placed.append(PlacedBody(body.name, found.position, found.velocity, found.tangent))
        return placed

    @property
    def planar(self) -> bool:
        return bool(self._header.dimension == 2)

    @property
    def elements(self) -> int:
        joints = self.memory.integers(Header.joint, int(self._header.nodes))
        return int(np.count_nonzero(joints[1:] == 0))

    @property
    def asleep(self) -> int:
        return int(self._header.asleep)
