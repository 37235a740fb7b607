"""The equations of motion made linear about a state: what a line and a system have in common.

Places, velocities and accelerations of all nodes follow the free motions z, the levels l of what
drives the nodes, and the inputs u, which are rates of levels:

    q = Z z + Q l,  v = Z z' + Z_v z + Q_v l,  a = Z z'' + Z_a z + Z_b z' + Q_a l + U u.

Z_v and so on are there where bodies or clamps turn. With that, what the residual changes by is
K q + C v + M a and what levels and inputs do beside; what is left over Z gives z''. In Newton's
matrix bodies feel the same current at another depth: what they feel there is added.
"""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import CableModelError
from cablemodel.linear.model import LinearModel, Names, solved
from cablemodel.linear.parts import Drives, Outputs, Response, Turning, Winding, of_axes
from cablemodel.solvers import library as entry
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.linearisation import free_motions, matrices
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Winch

FloatArray = NDArray[np.float64]

SIZE = 6
"""Unknowns of a node in space: place and slope."""
LENGTH_STEP, RATE_STEP = 1e-5, 1e-4
"""Of central differences of the residual: of an element's length [1], of rates and speeds [SI]."""
DEPTH_STEP = 1e-4
"""The same, of heights [m], and of the slopes' [1]: tables of currents are of metres."""

TOLD = 1e-2
"""Of a stiffness: rounded by more than that, it tells nothing of what it holds."""


def winch_of(block: Block, number: int) -> Winch:
    """A winch of a block by its number."""
    return Winch(block.reals, int(block.header.winches) + number * at.WINCH_WORDS)


class Equations(ABC):
    """Derivatives of the equations of motion at a state, in space.

    Args:
        block: of the state, the equations' own: it is changed.
        windings: its winches that may turn both ways.
    """

    def __init__(self, block: Block, windings: Sequence[Winding]) -> None:
        self.block = block
        self.windings = list(windings)
        self.nodes, self.time = int(block.header.nodes), float(block.scalars.time)
        self._let_current_rest()
        self._begin()
        basis, self.names = free_motions(block)
        self.basis: FloatArray = basis.toarray()
        self._make_matrices()
        entry.assemble(block.ints, block.reals, 0.0, 0.0)  # gradients and compliances stay there
        # One unit of each unknown of the basis: what of places and slopes it is, but for places
        # that follow others.
        own = self.basis.copy()
        own.reshape(self.nodes, SIZE, -1)[self._follows(), :3] = 0.0
        self.dual = solved(own.T @ own, own.T)

    def _make_matrices(self) -> None:
        self.mass, self.damping, self.stiffness = (part.toarray() for part in matrices(self.block))
        self._let_current_depend_on_depth()
        for winding in self.windings:
            self._let_matter_pass(winding)

    def _let_current_depend_on_depth(self) -> None:
        """Add to the stiffness what the current of another depth drags bodies.

        Only drag depends on it. By central differences, of what drag adds to the residual: tensions
        would round them.
        """
        block, size = self.block, self.nodes * SIZE
        head = block.header
        if head.current_kind == 0 or head.depth_count < 2 or head.body_count + head.free_count == 0:
            return
        still = copy.deepcopy(block)
        edges = still.array(Header.edges, self.nodes, at.EDGE_WORDS)
        bodies = still.array(Header.bodies, int(block.header.body_count), at.BODY_WORDS)
        edges[:, at.Edge.drag_normal] = edges[:, at.Edge.drag_tangential] = 0.0
        bodies[:, at.Body.drag] = bodies[:, at.Body.drag_axial] = 0.0
        for body in range(int(block.header.free_count)):
            free = at.FreeBody(still.reals, int(block.header.free_bodies) + body * at.FREE_WORDS)
            free.drag[:] = free.turn_drag[:] = 0.0
            free.foil_count = 0.0
        known = self.stiffness - matrices(still)[2].toarray()
        places = [part.array(Header.position, size) for part in (block, still)]

        def drag(unknown: int, by: float) -> FloatArray:
            found = []
            for part, place in zip((block, still), places, strict=True):
                kept = place[unknown]
                place[unknown] += by
                forces, rest = np.zeros(size), np.zeros(self.nodes * 2)
                entry.residual(part.ints, part.reals, forces, rest)
                place[unknown] = kept
                found.append(forces)
            return found[0] - found[1]

        for unknown in range(2, size, 3):  # heights of places, and of slopes
            change = (drag(unknown, DEPTH_STEP) - drag(unknown, -DEPTH_STEP)) / (2.0 * DEPTH_STEP)
            self.stiffness[:, unknown] += change - known[:, unknown]

    @abstractmethod
    def _begin(self) -> None:
        """Look at the state before the matrices are made."""

    @abstractmethod
    def drives(self) -> Drives:
        """What drives the nodes, but for winches and the current."""

    @abstractmethod
    def own_acceleration(self) -> FloatArray:
        """Of nodes that are held: what of it is there because inputs are not zero, (unknowns,)."""

    @abstractmethod
    def carried(self) -> FloatArray:
        """Velocity of nodes that places are counted from, (unknowns,)."""

    @abstractmethod
    def outputs(self, response: Response, drives: Drives) -> Outputs:
        """All outputs."""

    def turning(self) -> Turning | None:
        """None: nothing turns that nodes follow."""
        return None

    def _follows(self) -> NDArray[np.bool_]:
        """Nodes whose place is that of another one, or follows it, (nodes,)."""
        joint = self.block.integers(Header.joint, self.nodes)
        return np.asarray((joint == at.JOINT_HINGE) | (joint == at.JOINT_ARM))

    def _let_rest(self, ramp: at.VectorRamp | at.WrenchRamp | at.Ramp) -> None:
        """Stay at the present value."""
        span = ramp.end - ramp.begin
        part = min(1.0, max(0.0, (self.time - ramp.begin) / span)) if span > 0.0 else 1.0
        if isinstance(ramp, at.Ramp):
            ramp.first = ramp.last = ramp.first + part * (ramp.last - ramp.first)
        else:
            now = (1.0 - part) * np.array(ramp.first) + part * np.array(ramp.last)
            ramp.first[:] = ramp.last[:] = now
        ramp.begin, ramp.end = self.time, self.time + 1.0

    def _let_current_rest(self) -> None:
        head, live = self.block.header, self.block.scalars.live_current
        self._let_rest(live)
        self.current = np.array(live.first)
        if head.current_kind == 0:
            head.current_kind = 1
        if self.windings:
            head.payout = 1

    def _let_matter_pass(self, winding: Winding) -> None:
        """Matrices by the nodes' velocities and accelerations at the winch, not by the matter's.

        What runs past is (r_t + v r', ...), as kernels/mesh/payout.py has it: here its derivatives.
        """
        rate, slope = winding.rate, winding.slope
        if rate == slope == 0.0:
            return
        winch = winch_of(self.block, winding.number)
        h, way, node = float(winch.top_length), float(winch.way), int(winch.node)
        other = node + 1 if way > 0.0 else int(self.block.integers(Header.parent, self.nodes)[node])
        # Slopes are counted away from the winch.
        r0, d0, r1, d1 = np.diag([1.0, way, 1.0, way])
        second = (6.0 * (r1 - r0) / h - 4.0 * d0 - 2.0 * d1) / h
        third = (12.0 * (r0 - r1) / h + 6.0 * d0 + 6.0 * d1) / h**2
        longer = -rate / h**2 * (12.0 * (r1 - r0) / h - 4.0 * d0 - 2.0 * d1)
        signs = np.array([[1.0], [way]])
        velocity = signs * np.array([rate * d0, rate * second])  # by q
        by_place = np.array([rate**2 * second, 2.0 * rate * longer + rate**2 * third])
        by_place += slope * np.array([d0, second])
        by_speed = signs * np.array([2.0 * rate * d0, 2.0 * rate * second])
        axes = np.eye(3)
        near = np.arange(SIZE) + SIZE * node
        both = np.concatenate([near, np.arange(SIZE) + SIZE * other])
        damping, mass = self.damping[:, near].copy(), self.mass[:, near]
        self.stiffness[:, both] += damping @ np.kron(velocity, axes) + mass @ np.kron(
            signs * by_place, axes
        )
        self.damping[:, both] += mass @ np.kron(by_speed, axes)

    def residual(self, *, condensed: bool = True) -> FloatArray:
        """What the equations of motion leave at the block's state, (nodes SIZE,) [N, N m].

        condensed: with the tensions that belong to the stretch, not those of the state.
        """
        block, nodes = self.block, self.nodes
        forces, rest = np.zeros(nodes * SIZE), np.zeros(nodes * 2)
        entry.residual(block.ints, block.reals, forces, rest)
        return forces + self._of_stretch(rest) if condensed else forces

    def _of_stretch(self, rest: FloatArray) -> FloatArray:
        """B^T S of what is left of the constraints (nodes 2,), (nodes SIZE,)."""
        block, nodes = self.block, self.nodes
        gradient = block.array(Header.gradient, nodes, 2, 2, SIZE)
        s = block.array(Header.compliance, nodes, 3)
        r0, r1 = rest.reshape(nodes, 2).T
        z = np.array([s[:, 0] * r0 + s[:, 1] * r1, s[:, 1] * r0 + s[:, 2] * r1]).T
        joint = block.integers(Header.joint, nodes)
        z[joint != at.JOINT_NONE] = 0.0
        z[0] = 0.0
        force = np.einsum("nc,nkci->nki", z, gradient)
        for node in np.flatnonzero(joint == at.JOINT_BODY):  # one force along its axis
            pull = s[node, 0] * r0[node] * gradient[node, 0, 0, :3]
            force[node, 1, :3] = pull
            force[node, 0, :3] = -pull
        out = np.zeros((nodes, SIZE))
        out += force[:, 1]
        np.add.at(out, block.integers(Header.parent, nodes), force[:, 0])
        return out.reshape(-1)

    def by(self, change: Callable[[Block, float], None], step: float) -> FloatArray:
        """Derivative of the residual to a number, by central differences: (nodes SIZE,).

        change: adds to it, in a block.
        """
        kept = self.block.image.copy()
        found = []
        for sign in (1.0, -1.0):
            change(self.block, sign * step)
            found.append(self.residual())
            self.block.image[:] = kept
        return (found[0] - found[1]) / (2.0 * step)

    def _add_winches(self, drives: Drives) -> None:
        for winding in self.windings:
            number, prefix = winding.number, winding.prefix

            def length(of: Block, by: float, number: int = number) -> None:
                winch_of(of, number).top_length += by

            def rate(of: Block, by: float, number: int = number) -> None:
                winch_of(of, number).rate += by

            def slope(of: Block, by: float, number: int = number) -> None:
                winch_of(of, number).slope += by

            edge = float(winch_of(self.block, number).top_length)
            drives.level(
                f"{prefix}line_length",
                winding.length,
                residual=self.by(length, LENGTH_STEP * edge),
                grows_by=f"{prefix}payout_rate",
            )
            drives.level(f"{prefix}payout_rate", winding.rate, residual=self.by(rate, RATE_STEP))
            drives.input(
                f"{prefix}payout_acceleration",
                f"{prefix}payout_rate",
                residual=self.by(slope, RATE_STEP),
            )

    def _add_current(self, drives: Drives) -> None:
        for axis, value in enumerate(self.current):

            def flow(of: Block, by: float, axis: int = axis) -> None:
                live = of.scalars.live_current
                live.first[axis] += by
                live.last[axis] += by

            def surge(of: Block, by: float, axis: int = axis) -> None:
                of.scalars.live_current.last[axis] += by

            name = of_axes("current")[axis]
            drives.level(name, value, residual=self.by(flow, RATE_STEP))
            drives.input(of_axes("current_rate")[axis], name, residual=self.by(surge, RATE_STEP))

    def _all_drives(self) -> Drives:
        drives = self.drives()
        self._add_winches(drives)
        self._add_current(drives)
        return drives

    def _by_all(self, drives: Drives, turning: Turning | None) -> tuple[FloatArray, ...]:
        """The residual by places, rates, levels and inputs, while no free motion gets faster."""
        z = self.basis
        by_place, by_rate = self.stiffness @ z, self.damping @ z
        if turning is not None:
            by_place += self.damping @ turning.velocity + self.mass @ turning.acceleration
            by_rate += self.mass @ turning.by_rate
        moved, sped, pushed, beside = drives.by_levels()
        pushed_by_input, beside_input = drives.by_inputs()
        return (
            by_place,
            by_rate,
            self.stiffness @ moved + self.damping @ sped + self.mass @ pushed + beside,
            self.mass @ pushed_by_input + beside_input,
        )

    def linear_model(self, others: Mapping[str, FloatArray] | None = None) -> LinearModel:
        """About the state. others: more inputs, each with what the residual changes by."""
        z, drives, turning = self.basis, self._all_drives(), self.turning()
        present = self.residual(condensed=False)
        # What the motion leaves when all that drives it goes on evenly.
        even = present - self.mass @ self.own_acceleration()
        for winding in self.windings:
            column = drives.inputs.index(f"{winding.prefix}payout_acceleration")
            even -= drives.of_inputs[column][1] * winding.slope
        for name, column_of_other in (others or {}).items():
            drives.input(name, "", residual=column_of_other)
        by_place, *others_of_all = self._by_all(drives, turning)
        whole = np.column_stack([by_place, *others_of_all, even])
        # Accelerations by place, velocity, levels, inputs; then those that the state has itself.
        answer = -solved(z.T @ self.mass @ z, z.T @ whole)
        now = self.block.array(Header.acceleration, self.nodes * SIZE).copy()
        n, k, m = z.shape[1], len(drives.levels), len(drives.inputs)
        chain, operating = drives.growth(), np.array(drives.values)
        a = np.zeros((2 * n + k, 2 * n + k))
        a[:n, n : 2 * n] = np.eye(n)
        a[n : 2 * n] = answer[:, : 2 * n + k]
        a[2 * n :, 2 * n :] = chain
        b = np.zeros((2 * n + k, m))
        b[n : 2 * n] = answer[:, 2 * n + k : -1]
        for column, name in enumerate(drives.driven):
            if name:
                b[2 * n + drives.levels.index(name), column] = 1.0
        speed = self.block.array(Header.velocity, self.nodes * SIZE) - self.carried()
        left = answer[:, -1]
        drift = np.concatenate([self.dual @ speed, self.dual @ now + left, chain @ operating])
        reaction = whole + self.mass @ z @ answer
        moved, sped = drives.by_levels()[:2]
        none = np.zeros((len(z), m))
        response = Response(
            place=np.column_stack([z, np.zeros_like(z), moved, none]),
            velocity=np.column_stack(
                [np.zeros_like(z) if turning is None else turning.velocity, z, sped, none]
            ),
            force=reaction[:, :-1],
            rest=reaction[:, -1],
            change=reaction[:, -1] - present,
            answer=answer[:, :-1],
            first_level=2 * n,
        )
        found = self.outputs(response, drives)
        rows = np.vstack(found.rows)
        return LinearModel(
            a,
            b,
            rows[:, : 2 * n + k],
            rows[:, 2 * n + k :],
            drift,
            np.array(found.values),
            (*self.names, *(rate_of(name) for name in self.names), *drives.levels),
            tuple(drives.inputs),
            tuple(drives.driven),
            tuple(found.names),
            operating,
            self.time,
            self._free(z.T @ by_place) if others is None else (),
        )

    def _free(self, stiffness: FloatArray) -> Names:
        """States that nothing holds, the freest first: what the stiffness is rounded by would move
        them by a share of `TOLD` of what it holds them by."""
        try:
            compliance = np.abs(np.diag(np.linalg.inv(stiffness)))
        except np.linalg.LinAlgError:
            return ()  # whatever needs the inverse says so
        moved = compliance * self.rounding(stiffness)
        order = np.argsort(-moved)
        return tuple(self.names[k] for k in order[moved[order] > TOLD])

    def rounding(self, stiffness: FloatArray) -> FloatArray:
        """What each free motion's own stiffness is wrong by, (motions,) [SI]."""
        return np.asarray(np.finfo(float).eps * np.abs(np.diag(stiffness)))


def rate_of(name: str) -> str:
    """Name of a state's rate."""
    for place, rate in (
        ("slope", "slope_rate"),
        ("position", "velocity"),
        ("rotation", "rotation_rate"),
        ("motion", "motion_rate"),
    ):
        name = name.replace(place, rate)
    return name


def refuse(block: Block, what: str, slack_at: Callable[[int], str]) -> None:
    """What has no linear model.

    Args:
        block: of the state.
        what: it is linear about, in words.
        slack_at: says of a node whose element is slack what is slack, and where.

    Raises:
        CableModelError: it says why.
    """
    head = block.header
    if head.wave_count:
        raise not_linear(f"waves drive {what}, and its matrices change with them")
    if head.floor_state == at.FLOOR_TOUCHED or head.asleep:
        raise not_linear(
            f"{what} touches the sea floor, where contact begins and ends, and friction sticks or "
            "slides"
        )
    nodes = int(head.nodes)
    edges = block.array(Header.edges, nodes, at.EDGE_WORDS)[1:]
    tension = block.array(Header.tension, nodes, 2)[1:, 0]
    elements = block.integers(Header.joint, nodes)[1:] == at.JOINT_NONE
    slack = elements & (edges[:, at.Edge.bending] == 0.0) & (tension < 0.0)
    if slack.any():
        raise not_linear(
            f"{slack_at(int(np.argmax(slack)) + 1)}: without bending stiffness nothing holds it "
            "there"
        )


def not_linear(reason: str) -> CableModelError:
    """The error of what has no linear model."""
    return CableModelError(f"linearise: {reason}")
