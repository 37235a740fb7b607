"""Outputs of a system's linear model, by the names of `SystemModel.outputs`: those that are
smooth."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.linear.equations import SIZE, winch_of
from cablemodel.linear.parts import Drives, Outputs, Response, Winding, of_axes
from cablemodel.solvers import library as entry
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.systems.linear import SystemEquations

FloatArray = NDArray[np.float64]

TURN_STEP = 1e-4
"""Of central differences of what turns [rad]."""
_MOTION = ("position", "attitude", "velocity", "angular_velocity")


def law_of(piece: at.Piece) -> at.Polynomial:
    """The polynomial of a piece of motion."""
    return at.Polynomial(piece.data, 0)


class SystemOutputs:
    """Tensions of lines, motions of bodies and vessels, forces on vessels, winches."""

    def __init__(self, equations: SystemEquations, response: Response, drives: Drives) -> None:
        self._of, self._response, self._drives = equations, response, drives
        self.found = Outputs()
        self._add_tensions()
        self._add_motions()
        for n, name in enumerate(equations.scene.vessels):
            self._add_wrench(n, name)
        for winding in equations.windings:
            self._add_winch(winding)

    def _level(self, name: str) -> FloatArray:
        return self._response.level(self._drives.levels.index(name))

    def _add_tensions(self) -> None:
        forces = self._of.forces_of_elements(self._response)
        self._of.residual(condensed=False)  # which leaves forces at the ends of elements
        for name in self._of.scene.lines:
            for side, kind in enumerate(("start_tension", "end_tension")):
                row, value = self._end_tension(forces, name, side)
                self.found.add(f"{name}.{kind}", row, value)

    def _end_tension(
        self, forces: FloatArray, line: str, side: int
    ) -> tuple[FloatArray, np.float64]:
        """Of a line's end: row and value."""
        response, block, nodes = self._response, self._of.block, self._of.nodes
        elements = self._of.built.elements(line)
        place = -1 if side else 0
        element = int(elements.node[place])
        # Which end of the element it is, by the tree.
        child = bool(side) is not bool(elements.backward[place])
        node = element if child else int(block.integers(Header.parent, nodes)[element])
        sign = 1.0 if child else -1.0
        words = slice(SIZE * node, SIZE * node + 3)
        own = slice(SIZE * node + 3, SIZE * node + 6)
        reaction = block.array(Header.end_force, nodes, 2, 3)[element, int(child)]
        force = reaction + sign * response.change[words]
        by = sign * forces[words]
        slope = self._of.q[own]
        along, size = slope / np.linalg.norm(slope), np.linalg.norm(slope)
        across = (force - along * (along @ force)) / size
        return along @ by + across @ response.place[own], along @ force

    def _parts(self) -> FloatArray:
        """Outputs of bodies, then of vessels: place, attitude, velocity, angular velocity."""
        bodies = np.zeros((len(self._of.bodies), at.PART_WORDS))
        frames = np.zeros((len(self._of.frames), at.PART_WORDS))
        entry.parts(
            self._of.block.ints, self._of.block.reals, bodies.reshape(-1), frames.reshape(-1)
        )
        rows = np.vstack([bodies, frames])
        return np.array([[getattr(at.PartMotion(row), key) for key in _MOTION] for row in rows])

    def _add_motions(self) -> None:
        values, response, of = self._parts(), self._response, self._of

        def by(change: Callable[[float], None], number: int) -> FloatArray:
            def read() -> FloatArray:
                difference = self._parts()[number] - values[number]
                difference[1] = np.remainder(difference[1] + np.pi, 2.0 * np.pi) - np.pi
                return np.asarray(difference)

            return self._of.differences(change, TURN_STEP, read)

        for number, (name, body) in enumerate(zip(of.scene.bodies, of.bodies, strict=True)):
            rows = np.zeros((4, 3, response.place.shape[1]))
            for j in range(SIZE):
                word = SIZE * int(body.node) + j
                for state, moves in ((of.q, response.place), (of.v, response.velocity)):

                    def change(by: float, word: int = word, state: FloatArray = state) -> None:
                        state[word] += by

                    rows += by(change, number)[:, :, None] * moves[word]
            self._add_motion(name, rows, values[number])
        for n, name in enumerate(of.scene.vessels):
            number = len(of.bodies) + n
            rows = np.zeros((4, 3, response.place.shape[1]))
            place, turn = law_of(of.frames[n].piece), law_of(of.frames[n].turn_piece)
            for level, words in (
                ("position", place.position),
                ("velocity", place.velocity),
                ("attitude", turn.position),
                ("attitude_rate", turn.velocity),
            ):
                for axis in range(3):

                    def move(by: float, words: FloatArray = words, axis: int = axis) -> None:
                        words[axis] += by

                    column = self._level(of_axes(f"{name}.{level}")[axis])
                    rows += by(move, number)[:, :, None] * column
            self._add_motion(name, rows, values[number])

    def _add_motion(self, name: str, rows: FloatArray, values: FloatArray) -> None:
        for key, row, value in zip(_MOTION, rows, values, strict=True):
            self.found.add(of_axes(f"{name}.{key}"), row, value)

    def _add_wrench(self, n: int, name: str) -> None:
        """Force and moment of the lines on a vessel, as kernels/outputs/part_outputs.py adds them
        up."""
        response = self._response
        columns = response.place.shape[1]
        rows, values = np.zeros((2, 3, columns)), np.zeros((2, 3))
        origin = np.array([*self._of.block.scalars.origin]) - self._of.levels[n]["position"]
        own = np.array([self._level(label) for label in of_axes(f"{name}.position")])
        for row in self._of.held:
            if row.kind != at.HELD_BY_FRAME or int(row.frame) != n:
                continue
            words = slice(SIZE * int(row.node), SIZE * int(row.node) + 3)
            force, arm = response.rest[words], self._of.q[words] + origin
            rows[0] -= response.force[words]
            values[0] -= force
            rows[1] -= _cross(arm, response.force[words])
            rows[1] += _cross(force, response.place[words] - own)
            values[1] -= np.cross(arm, force)
            if row.clamped == at.EXACTLY:
                words = slice(words.stop, words.stop + 3)
                force, slope = response.rest[words], self._of.q[words]
                rows[1] -= _cross(slope, response.force[words])
                rows[1] += _cross(force, response.place[words])
                values[1] -= np.cross(slope, force)
        for kind, row_of_kind, value in zip(("force", "moment"), rows, values, strict=True):
            self.found.add(of_axes(f"{name}.{kind}"), row_of_kind, value)

    def _add_winch(self, winding: Winding) -> None:
        """Rate and lengths; a line that winches hold at both ends has both lengths."""
        winches, prefix = list(self._of.scene.winches.values()), winding.prefix
        lengths = [
            self._level(f"{other.prefix}line_length")
            for other in self._of.windings
            if winches[other.number].line == winches[winding.number].line
        ]
        row = winch_of(self._of.block, winding.number)
        rate, own = (self._level(f"{prefix}{key}") for key in ("payout_rate", "line_length"))
        self.found.add(f"{prefix}payout_rate", rate, winding.rate)
        self.found.add(f"{prefix}line_length", np.sum(lengths, axis=0), winding.length)
        self.found.add(f"{prefix}drum_length", -own, float(row.paid_most - row.paid))


def _cross(vector: FloatArray, columns: FloatArray) -> FloatArray:
    """Cross products of a vector and columns, (3, n)."""
    return np.cross(vector, columns.T).T
