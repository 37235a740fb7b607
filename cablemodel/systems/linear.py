"""The linear model of a system: lines, bodies and vessels by the user's names.

Vessels are driven by place and attitude, which all nodes at their points follow. What only one
vessel and no anchor holds is counted from that vessel, so that a steady tow is an equilibrium.
Bodies turn from their present attitude, about their own axes.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from cablemodel.linear.equations import (
    RATE_STEP,
    SIZE,
    Equations,
    not_linear,
    refuse,
    winch_of,
)
from cablemodel.linear.parts import Drives, Outputs, Response, Turning, Winding, of_axes
from cablemodel.solvers import library as entry
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel.solvers.shared.record import Record
from cablemodel.systems.linear_outputs import TURN_STEP, SystemOutputs, law_of

if TYPE_CHECKING:
    from cablemodel.linear.model import LinearModel
    from cablemodel.systems.model import SystemModel

FloatArray = NDArray[np.float64]
Row = TypeVar("Row", bound=Record)

STEP = 1e-6
"""Of the kernels' differences for a body's derivatives (free_bodies.py)."""
FORCE_STEP = 1.0
"""Of those by outside forces and torques, which the residual is linear in [N, N m]."""
SPEED_STEP = 1e-6
"""Of those by bodies' velocities: drag on a body at rest is not smooth [m/s, rad/s]."""
_ROOTS = at.JOINT_ROOT, at.JOINT_ROOT_FREE


def linear_model(model: SystemModel) -> LinearModel:
    """The linear model of a system about its present state; see `SystemModel.linearise`."""
    return SystemEquations(model).linear_model()


class SystemEquations(Equations):
    """Derivatives of a system's equations of motion at a model's state; the model stays."""

    def __init__(self, model: SystemModel) -> None:
        self.built = built = copy.deepcopy(model.built)
        self.scene = model.scene
        for name, time in model.cuts.items():
            if time is not None:
                raise not_linear(f"the cut {name} has been made, at {time:g} s: what it left falls")

        def slack_at(node: int) -> str:
            line, arc = built.where(node)
            return f"{line} is slack, {arc:.6g} m from its beginning"

        refuse(built.block, "the system", slack_at)
        windings = []
        for number, (name, winch) in enumerate(model.scene.winches.items()):
            row = winch_of(built.block, number)
            if row.travel_least < row.travel < row.travel_most:
                length = model.lines[winch.line].length
                windings.append(
                    Winding(number, f"{name}.", length, float(row.rate), float(row.slope))
                )
        super().__init__(built.block, windings)
        self.names = self._own_names()

    def _begin(self) -> None:
        """Inputs rest, rotation vectors begin anew, and what nodes follow is looked up."""
        block, count = self.block, SIZE * self.nodes
        head = block.header
        self.q, self.v, self.a = (
            block.array(word, count)
            for word in (Header.position, Header.velocity, Header.acceleration)
        )
        self.frames = _rows(block, at.Frame, head.frames, head.frame_count)
        self.bodies = _rows(block, at.FreeBody, head.free_bodies, head.free_count)
        self.foils = _rows(block, at.Foil, head.foils, head.foil_count)
        self.arms = _rows(block, at.Arm, head.arms, head.arm_count)
        self.closures = _rows(block, at.Closure, head.closures, head.closure_count)
        self.held = _rows(block, at.Constraint, head.constraints, head.constraint_count)
        for ramp in (*(b.force for b in self.bodies), *(f.deflection for f in self.foils)):
            self._let_rest(ramp)
        self._let_frames_go_on()
        super().residual(condensed=False)
        for body in self.bodies:
            first = SIZE * int(body.node) + 3
            motion = body.motion
            body.rotation[:] = motion.turn
            self.q[first : first + 3] = 0.0
            self.v[first : first + 3] = motion.spin
            self.a[first : first + 3] = motion.spin_rate
        before = self.a.copy()
        kept = self.block.image.copy()
        entry.place_supports(block.ints, block.reals)
        self._unwanted = before - self.a
        self.block.image[:] = kept
        self.shifts = self._shifts_of_frames()

    def _make_matrices(self) -> None:
        super()._make_matrices()
        for body in self.bodies:
            first = SIZE * int(body.node)
            own = slice(first, first + SIZE)
            for word in range(first, first + SIZE):

                def move(_block: Block, by: float, word: int = word) -> None:
                    self.v[word] += by

                self.damping[own, word] = self.by(move, SPEED_STEP)[own]

    def _let_frames_go_on(self) -> None:
        """Evenly: place and angles by the present rates."""
        words = np.zeros((len(self.frames), at.FRAME_INPUTS))
        entry.frame_motion(self.block.ints, self.block.reals, words.reshape(-1))
        self.levels = [
            {
                "position": now.position.copy(),
                "velocity": now.velocity.copy(),
                "attitude": now.attitude.copy(),
                "attitude_rate": now.attitude_rate.copy(),
            }
            for now in (at.FrameInput(row) for row in words)
        ]
        for frame, now in zip(self.frames, self.levels, strict=True):
            frame.live = frame.turn_live = at.LIVE
            for piece, place, rate in (
                (frame.piece, "position", "velocity"),
                (frame.turn_piece, "attitude", "attitude_rate"),
            ):
                piece.start, piece.end, piece.kind = self.time, self.time + 1.0, at.POLYNOMIAL
                piece.data[:] = 0.0
                law = law_of(piece)
                law.position[:], law.velocity[:] = now[place], now[rate]

    def _shifts_of_frames(self) -> list[NDArray[np.intp]]:
        """Nodes that are counted from each frame: those at its points, and what only it holds."""
        block, nodes = self.block, self.nodes
        parent, joint = (block.integers(w, nodes) for w in (Header.parent, Header.joint))
        tree = np.arange(nodes)
        for node in range(1, nodes):
            if joint[node] not in _ROOTS:
                tree[node] = tree[parent[node]]
        for end in self.closures:
            if end.node >= 0.0:
                other = end.other if end.body < 0.0 else self.bodies[int(end.body)].node
                tree[tree == tree[int(end.node)]] = tree[int(other)]
        owner = np.full(nodes, -1)
        held = {int(row.node): row for row in self.held}
        for part in np.unique(tree):
            rows = [row for node, row in held.items() if tree[node] == part]
            if rows and all(row.kind == at.HELD_BY_FRAME for row in rows):
                owner[tree == part] = min(int(row.frame) for row in rows)
        for node, row in held.items():
            owner[node] = int(row.frame) if row.kind == at.HELD_BY_FRAME else -1
        return [np.flatnonzero(owner == n) for n in range(len(self.frames))]

    def _shift(self, frame: int, axis: int) -> FloatArray:
        column = np.zeros(SIZE * self.nodes)
        column[SIZE * self.shifts[frame] + axis] = 1.0
        return column

    def own_acceleration(self) -> FloatArray:
        """That of vessels beside what their present turning gives."""
        return self._unwanted

    def carried(self) -> FloatArray:
        """By the vessels that places are counted from."""
        found = np.zeros(SIZE * self.nodes)
        for n, now in enumerate(self.levels):
            for axis in range(3):
                found += self._shift(n, axis) * now["velocity"][axis]
        return found

    def residual(self, *, condensed: bool = True) -> FloatArray:
        """As of a line; forces at bodies' arms stay in the rows of their nodes."""
        found = super().residual(condensed=condensed)
        for arm in self.arms:
            if arm.body < 0.0:
                continue
            body = self.bodies[int(arm.body)]
            force, end, to = np.array(arm.force), SIZE * int(arm.node), SIZE * int(body.node)
            turn = np.array(body.motion.turn).reshape(3, 3)
            rates = np.array(body.motion.rates).reshape(3, 3)
            found[end : end + 3] += force
            found[to : to + 3] -= force
            found[to + 3 : to + 6] -= rates.T @ np.cross(arm.place, turn.T @ force)
        return found

    def rounding(self, stiffness: FloatArray) -> FloatArray:
        """That of bodies is a difference of forces over a step of `STEP` (free_bodies.py)."""
        found = super().rounding(stiffness)
        part = np.finfo(float).eps / STEP
        for body in self.bodies:
            node, size = int(body.node), float(body.size)
            pull = float(body.weight + body.buoyancy)
            pull += sum(
                float(np.linalg.norm(arm.force))
                for arm in self.arms
                if arm.body >= 0.0 and int(self.bodies[int(arm.body)].node) == node
            )
            moves = self.basis[SIZE * node : SIZE * node + SIZE] ** 2
            scale = np.repeat([pull / size, pull * size], 3)
            found += part * (scale @ moves)
        return found

    def differences(
        self, change: Callable[[float], None], step: float, read: Callable[[], FloatArray]
    ) -> FloatArray:
        """Derivative of what is read by a change; the block stays."""
        kept = self.block.image.copy()
        found = []
        for sign in (1.0, -1.0):
            change(sign * step)
            found.append(read())
            self.block.image[:] = kept
        return np.asarray((found[0] - found[1]) / (2.0 * step))

    def _motion_when_placed(self) -> FloatArray:
        entry.place_supports(self.block.ints, self.block.reals)
        return np.array([self.q, self.v, self.a])

    def turning(self) -> Turning | None:
        """At the ends of lines at bodies, and at clamps."""
        shape = SIZE * self.nodes, self.basis.shape[1]
        found = Turning(*(np.zeros(shape) for _ in range(3)))
        ends: list[at.Arm | at.Closure] = [*self.arms, *self.closures]
        for end in ends:
            if end.node >= 0.0 and end.body >= 0.0:
                body = self.bodies[int(end.body)]
                first = SIZE * int(body.node)
                turns = self.basis[first + 3 : first + SIZE]
                words = slice(SIZE * int(end.node), SIZE * int(end.node) + 3)
                parts = _turned_with(np.array(end.place), body.motion)
                found.velocity[words] = parts[0] @ turns
                found.acceleration[words] = parts[1] @ turns
                found.by_rate[words] = parts[2] @ turns
        for row in self.held:
            if row.kind != at.HELD_BY_FRAME or row.clamped != at.EXACTLY:
                continue
            frame, along = self.frames[int(row.frame)], np.array(row.direction)
            turned = np.cross(frame.spin, along)
            faster = np.cross(frame.spin, turned) + np.cross(frame.spin_rate, along)
            words = slice(SIZE * int(row.node) + 3, SIZE * int(row.node) + 6)
            longer = along @ self.basis[words]
            found.velocity[words] = np.outer(turned, longer)
            found.acceleration[words] = np.outer(faster, longer)
            found.by_rate[words] = 2.0 * np.outer(turned, longer)
        return found

    def drives(self) -> Drives:
        """Vessels, what pushes bodies, foils."""
        found = Drives(SIZE * self.nodes)
        for n, name in enumerate(self.scene.vessels):
            self._add_frame(found, n, name)
        for name, body in zip(self.scene.bodies, self.bodies, strict=True):
            self._add_pushes(found, name, body)
        names = [f"{name}.{foil}" for name, b in self.scene.bodies.items() for foil in b.foils]
        for name, foil in zip(names, self.foils, strict=True):

            def deflect(_block: Block, by: float, ramp: at.Ramp = foil.deflection) -> None:
                ramp.first += by
                ramp.last += by

            level = f"{name}.deflection"
            found.level(level, foil.deflection.last, residual=self.by(deflect, RATE_STEP))
            found.input(f"{level}_rate", level)
        return found

    def _add_frame(self, found: Drives, n: int, name: str) -> None:
        frame, now = self.frames[n], self.levels[n]
        laws = {"position": law_of(frame.piece), "attitude": law_of(frame.turn_piece)}

        def followed(kind: str, field: str, axis: int, step: float, share: float) -> FloatArray:
            """Motion of held nodes by a component of a law."""

            def change(by: float) -> None:
                getattr(laws[kind], field)[axis] += share * by

            return self.differences(change, step, self._motion_when_placed)

        for kind, rate, prefix in (
            ("position", "velocity", ""),
            ("attitude", "attitude_rate", "attitude_"),
        ):
            step = 1.0 if kind == "position" else TURN_STEP
            for field, level in (("position", kind), ("velocity", rate)):
                for axis, label in enumerate(of_axes(f"{name}.{level}")):
                    q, v, a = followed(kind, field, axis, step, 1.0)
                    if kind == "position":
                        shift = self._shift(n, axis)
                        q, v = (shift, v) if field == "position" else (q, shift)
                    found.level(
                        label,
                        now[level][axis],
                        place=q,
                        velocity=v,
                        acceleration=a,
                        grows_by=of_axes(f"{name}.{rate}")[axis] if level == kind else None,
                    )
            for axis, label in enumerate(of_axes(f"{name}.{prefix}acceleration")):
                # The second power's coefficient is half of the acceleration.
                pushed = followed(kind, "second", axis, step, 0.5)[2]
                if kind == "position":
                    pushed = self._shift(n, axis)
                found.input(label, of_axes(f"{name}.{rate}")[axis], acceleration=pushed)

    def _add_pushes(self, found: Drives, name: str, body: at.FreeBody) -> None:
        for i in range(6):
            kind = "torque" if i >= 3 else "force"

            def push(_block: Block, by: float, i: int = i) -> None:
                body.force.first[i] += by
                body.force.last[i] += by

            level = of_axes(f"{name}.{kind}")[i % 3]
            found.level(level, body.force.last[i], residual=self.by(push, FORCE_STEP))
            found.input(of_axes(f"{name}.{kind}_rate")[i % 3], level)

    def outputs(self, response: Response, drives: Drives) -> Outputs:
        """Those of a run that are smooth, by the names of `SystemModel.outputs`."""
        return SystemOutputs(self, response, drives).found

    def forces_of_elements(self, response: Response) -> FloatArray:
        """Force rows without what point bodies add to their nodes."""
        head = self.block.header
        kept, count = (self.mass, self.damping, self.stiffness), int(head.body_count)
        if count == 0:
            return response.force
        head.body_count = 0
        self._make_matrices()
        found = np.column_stack(self._by_all(self._all_drives(), self.turning()))
        found += self.mass @ self.basis @ response.answer
        head.body_count = count
        self.mass, self.damping, self.stiffness = kept
        return found

    def _own_names(self) -> tuple[str, ...]:
        """Of the states: nodes by their lines, from each one's beginning, and bodies."""
        labels = dict(self._labels())
        found = []
        for name in self.names:
            if not name.startswith("nodes["):
                found.append(name)
                continue
            number, _, rest = name.removeprefix("nodes[").partition("].")
            label, is_body = labels[int(number)]
            found.append(f"{label}.{rest.replace('slope', 'rotation') if is_body else rest}")
        return tuple(found)

    def _labels(self) -> Iterator[tuple[int, tuple[str, bool]]]:
        """Node, and its name and whether it is that of a body."""
        bodies = {
            int(node): name
            for node, name in zip(self.built.body_nodes(), self.scene.bodies, strict=True)
        }
        parent = self.block.integers(Header.parent, self.nodes)
        joint = self.block.integers(Header.joint, self.nodes)
        arcs: dict[str, list[tuple[float, int]]] = {}
        for line in self.scene.lines:
            elements = self.built.elements(line)
            for node, start, length, backward in zip(
                elements.node, elements.start, elements.length, elements.backward, strict=True
            ):
                near, far = (start + length, start) if backward else (start, start + length)
                arcs.setdefault(line, []).append((float(far), int(node)))
                above = int(parent[node])
                if joint[above] != at.JOINT_NONE or above == 0:
                    arcs[line].append((float(near), above))
        for node, name in bodies.items():
            yield node, (name, True)
        for line, places in arcs.items():
            for number, (_arc, node) in enumerate(sorted(places)):
                yield node, (f"{line}.nodes[{number}]", False)


def _rows(block: Block, kind: type[Row], first: int, count: int) -> list[Row]:
    """The rows of a table of a block, by its first word."""
    return [kind(block.reals, int(first) + kind.WORDS * n) for n in range(int(count))]


def _turned_with(place: FloatArray, motion: at.BodyMotion) -> tuple[FloatArray, ...]:
    """How velocity and acceleration of a body's place follow its rotation vector, and the latter
    its rate, (3, 3) each, where that vector is zero: Omega = (1 - [theta]/2) d(theta)/dt there, and
    its rate has a part of the second order as well (kernels/bodies/rotation.py)."""
    turn = np.array(motion.turn).reshape(3, 3)
    spin, faster = np.array(motion.spin), np.array(motion.spin_rate)
    moved = np.cross(spin, place)
    pushed = np.cross(faster, place) + np.cross(spin, moved)
    columns: list[list[FloatArray]] = [[], [], []]
    for axis in np.eye(3):
        of_spin = -0.5 * np.cross(axis, spin)
        of_rate = -0.5 * np.cross(axis, faster) + np.cross(spin, np.cross(axis, spin)) / 6.0
        columns[0].append(np.cross(axis, moved) + np.cross(of_spin, place))
        columns[1].append(
            np.cross(axis, pushed)
            + np.cross(of_rate, place)
            + np.cross(of_spin, moved)
            + np.cross(spin, np.cross(of_spin, place))
        )
        columns[2].append(np.cross(axis, moved) + np.cross(spin, np.cross(axis, place)))
    return tuple(turn @ np.array(found).T for found in columns)
