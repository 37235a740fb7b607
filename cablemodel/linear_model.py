"""A linear model of a line about a state, with names: what controllers and estimators are made of.

About any state, steady or not, small deviations of places and slopes q obey

    M q'' + C q' + K q + sum of R_w w = 0,

where M, C and K are the Newton matrix's parts and R_w are the residual's derivatives to what drives
the line. |r'| = 1 + strain(T) makes this a descriptor system; tensions are eliminated through the
elements' compliances, which the Newton matrix does already: K has the axial stiffness, and the
model the line's axial waves. `LinearModel.reduced` takes these out, quasi-statically.

What `CableModel.step` takes as inputs (velocity of the tow point, pay-out rate, current) are states
here, since steps vary them linearly; the inputs are their rates. All places are counted from the
tow point, so that a steady tow is an equilibrium. A line that moves otherwise is linearised at one
instant: `drift` and `offset` say how it goes on by itself.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel import library as entry
from cablemodel.block import Block
from cablemodel.errors import CableModelError
from cablemodel.extras import require
from cablemodel.kernels import layout as at
from cablemodel.kernels.layout import Header
from cablemodel.linearisation import free_motions, matrices

if TYPE_CHECKING:
    from cablemodel.model import CableModel

FloatArray = NDArray[np.float64]
Names = tuple[str, ...]

_AXES = "xyz"
SIZE = 6
"""Unknowns of a node in space: place and slope."""
LENGTH_STEP, RATE_STEP = 1e-5, 1e-4
"""Of central differences of the residual: of an element's length [1], of rates and speeds [SI]."""


def _of(name: str) -> Names:
    return tuple(f"{name}.{axis}" for axis in _AXES)


@dataclass(frozen=True)
class LinearModel:
    """x' = drift + A x + B u, y = offset + C x + D u about a state of a line.

    x are deviations from that state, u the inputs themselves (accelerations, rates) and y the
    outputs themselves. Earth frame, SI units. `scipy.signal.StateSpace(m.A, m.B, m.C, m.D)` and
    `control.ss(m.A, m.B, m.C, m.D, inputs=list(m.inputs), outputs=list(m.outputs))` take it as it
    is.
    """

    A: FloatArray
    """(states, states)."""
    B: FloatArray
    """(states, inputs)."""
    C: FloatArray
    """(outputs, states)."""
    D: FloatArray
    """(outputs, inputs)."""
    drift: FloatArray
    """x' of the state itself while the inputs are zero, (states,): in a steady tow that of
    ``vessel_position`` alone."""
    offset: FloatArray
    """Outputs at the state itself while the inputs are zero, (outputs,)."""
    states: Names
    """The line's own, counted from the tow point, then the levels of what drives it."""
    inputs: Names
    """Rates of these levels: acceleration of the tow point and so on."""
    outputs: Names
    """By the names of docs/variables.md: ``top_tension``, ``bodies[0].position.z``."""
    operating: FloatArray
    """Levels at the state, for the last states in their order: their names are `levels`."""
    time: float
    """Of the state [s]."""

    @property
    def levels(self) -> Names:
        """The states that the inputs are rates of, or that follow from those."""
        return self.states[len(self.states) - len(self.operating) :]

    def only(
        self, inputs: Iterable[str] | None = None, outputs: Iterable[str] | None = None
    ) -> LinearModel:
        """The same with these inputs and outputs, in this order.

        Raises:
            CableModelError: there is none of that name; says which there are.
        """
        rows = _places(self.outputs, outputs, "output")
        columns = _places(self.inputs, inputs, "input")
        return replace(
            self,
            B=self.B[:, columns],
            C=self.C[rows],
            D=self.D[np.ix_(rows, columns)],
            offset=self.offset[rows],
            inputs=tuple(self.inputs[k] for k in columns),
            outputs=tuple(self.outputs[k] for k in rows),
        )

    def gains(self) -> FloatArray:
        """What levels do to the outputs in the end, (outputs, levels), by themselves.

        Of a velocity the steady tow's: all places but ``vessel_position`` then go on with the tow
        point, and their own gains are from there. Of a pay-out rate what it does beside the
        length, which grows meanwhile.
        """
        line = len(self.states) - len(self.operating)
        steady = self._steady(_solve(self.A[:line, :line], np.eye(line)))
        return np.asarray(self.C[:, line:] + self.C[:, :line] @ steady)

    def _steady(self, inverse: FloatArray) -> FloatArray:
        """Of the line's own states by levels: X of A X + A_levels = X chain, where levels go on."""
        line = len(inverse)
        still = -inverse @ self.A[:line, line:]
        return np.asarray(still + inverse @ (still @ self.A[line:, line:]))

    def reduced(self, count: int) -> LinearModel:
        """With the `count` slowest modes of the line (one more where a pair would be cut), by modal
        truncation; the others follow at once, so that `gains` stay as they are.

        States are modal coordinates, ``mode 0`` and so on (of a pair real and imaginary part).
        """
        line = len(self.states) - len(self.operating)
        if not 0 < count <= line:
            raise CableModelError(f"reduced: {count} modes; allowed: 1 to {line}")
        inner = self.A[:line, :line]
        # Of the inverse the slow modes are the large ones: they do not drown in axial stiffness.
        inverse = _solve(inner, np.eye(line))
        # Counted from the steady motion that belongs to the levels: following it is no lag.
        steady = self._steady(inverse)
        drives = np.column_stack([self.B, self.drift])
        drives = drives[:line] - steady @ drives[line:]
        values, left, right = _eig(inverse)
        order = np.argsort(-np.abs(values), kind="stable")
        upper = [k for k in order if values[k].imag >= 0.0]
        columns, rows, blocks = [], [], []
        names: list[str] = []
        for mode, k in enumerate(upper):
            if len(names) >= count:
                break
            v, w, value = right[:, k], left[:, k].conj(), 1.0 / values[k]
            w = w / (w @ v)
            if values[k].imag == 0.0:
                columns += [v.real]
                rows += [w.real]
                blocks.append(np.array([[value.real]]))
                names += [f"mode {mode}"]
            else:
                columns += [v.real, v.imag]
                rows += [2.0 * w.real, -2.0 * w.imag]
                blocks.append(np.array([[value.real, value.imag], [-value.imag, value.real]]))
                names += [f"mode {mode}, real", f"mode {mode}, imaginary"]
        basis, dual, modes = np.array(columns).T, np.array(rows), _diagonal(blocks)
        # The rest is what all modes would be at rest less what these are.
        rest = basis @ np.linalg.solve(modes, dual @ drives) - inverse @ drives
        levels, size = len(self.operating), len(names)
        a = np.zeros((size + levels, size + levels))
        a[:size, :size] = modes
        a[size:, size:] = self.A[line:, line:]
        driven, seen = dual @ drives, self.C[:, :line] @ rest
        return replace(
            self,
            A=a,
            B=np.vstack([driven[:, :-1], self.B[line:]]),
            C=np.column_stack(
                [self.C[:, :line] @ basis, self.C[:, line:] + self.C[:, :line] @ steady]
            ),
            D=self.D + seen[:, :-1],
            drift=np.concatenate([driven[:, -1], self.drift[line:]]),
            offset=self.offset + seen[:, -1],
            states=(*names, *self.levels),
        )

    def discrete(self, dt: float) -> DiscreteModel:
        """Of steps of dt [s] as `CableModel.step` makes them, exactly by the matrix exponential."""
        linalg = require("scipy.linalg", extra="analysis", what="a discrete linear model")
        if not 0.0 < dt < np.inf:
            raise CableModelError(f"discrete: a step of {dt!r} s; give a positive one")
        n, m = self.B.shape
        joint = np.zeros((n + m + 1, n + m + 1))
        joint[:n] = np.column_stack([self.A, self.B, self.drift])
        a, b, d = np.split(linalg.expm(joint * dt)[:n], [n, n + m], axis=1)
        # The rate of an input is what is missing to the value at the end, over the step.
        names = tuple(RATES[name] for name in self.inputs)
        places = [self.states.index(name) for name in names]
        picks = np.zeros((m, n))
        picks[np.arange(m), places] = 1.0
        first = n - len(self.operating)
        a, b = a - b @ picks / dt, b / dt
        return DiscreteModel(
            A=a,
            B=b,
            C=self.C @ a - self.D @ picks / dt,
            D=self.C @ b + self.D / dt,
            drift=d[:, 0],
            offset=self.offset + self.C @ d[:, 0],
            states=self.states,
            inputs=names,
            outputs=self.outputs,
            operating=self.operating[[place - first for place in places]],
            dt=dt,
        )


@dataclass(frozen=True)
class DiscreteModel:
    """x[k+1] = drift + A x[k] + B u[k]; y[k] = offset + C x[k] + D u[k] is read after that step.

    u are the inputs of `CableModel.step`, values reached at the end of the step, less `operating`,
    those at the state; x as in `LinearModel`, y the outputs themselves.
    """

    A: FloatArray
    B: FloatArray
    C: FloatArray
    D: FloatArray
    drift: FloatArray
    offset: FloatArray
    states: Names
    inputs: Names
    outputs: Names
    operating: FloatArray
    """Inputs at the state, (inputs,)."""
    dt: float
    """Length of a step [s]."""

    def responses(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Outputs after steps 1 to count from the state: by itself (count, outputs), and of a unit
        of each input in the first step alone (count, outputs, inputs).

        The inputs' deviations u give y[k] = free[k] + sum over j <= k of pulse[k - j] u[j].
        """
        free = np.empty((count, len(self.outputs)))
        pulse = np.empty((count, *self.D.shape))
        x, moved = np.zeros(len(self.states)), self.B
        for k in range(count):
            free[k] = self.offset + self.C @ x
            x = self.drift + self.A @ x
            pulse[k] = self.D if k == 0 else self.C @ moved
            if k:
                moved = self.A @ moved
        return free, pulse


RATES = {
    **dict(zip(_of("vessel_acceleration"), _of("vessel_velocity"), strict=True)),
    "payout_acceleration": "payout_rate",
    **dict(zip(_of("current_rate"), _of("current"), strict=True)),
}
"""Inputs of a linear model, and the input of a step that each is the rate of."""


def linear_model(model: CableModel) -> LinearModel:
    """The linear model of a line about its present state; see `CableModel.linearise`."""
    return Equations(model).linear_model()


class Equations:
    """Derivatives of the equations of motion at a model's state, in space; the model stays."""

    def __init__(self, model: CableModel) -> None:
        self.block = block = copy.deepcopy(model._finite_elements("linearise"))
        _refuse(model, block)
        entry.to_three_dimensions(block.ints, block.reals)
        head = block.header
        self.nodes, self.time = int(head.nodes), float(block.scalars.time)
        self.length = model.line_length
        self._begin_inputs()
        basis, self.names = free_motions(block)
        self.basis: FloatArray = basis.toarray()
        self.mass, self.damping, self.stiffness = (part.toarray() for part in matrices(block))
        if self.winds:
            self._let_matter_pass()
        entry.assemble(block.ints, block.reals, 0.0, 0.0)  # gradients and compliances stay there
        # One unit of each unknown of the basis: what of places and slopes it is.
        self.dual = (self.basis / np.sum(self.basis**2, axis=0)).T
        bodies = block.array(Header.bodies, int(head.body_count), at.BODY_WORDS)
        bodies = bodies[bodies[:, at.Body.node] >= 0.0]
        self._bodies = bodies[np.argsort(bodies[:, at.Body.node], kind="stable")]

    def _begin_inputs(self) -> None:
        """Inputs that rest at their present levels; what they are the levels of."""
        block, head, state = self.block, self.block.header, self.block.scalars
        live = state.live_current
        span = live.end - live.begin
        part = min(1.0, max(0.0, (self.time - live.begin) / span)) if span > 0.0 else 1.0
        self.current = (1.0 - part) * np.array(live.first) + part * np.array(live.last)
        if head.current_kind == 0:
            head.current_kind = 1
        live.begin, live.end = self.time, self.time + 1.0
        live.first[:] = live.last[:] = self.current
        first = block.array(Header.constraints, int(head.constraint_count), at.CONSTRAINT_WORDS)[0]
        # One that the winch may turn both ways; a clamp gives way to a spring when it first does.
        winch = block.winch
        self.winds = winch.travel_least < winch.travel < winch.travel_most and (
            bool(head.payout) or first[at.Constraint.clamped] == 0.0
        )
        self.rate = self.slope = 0.0
        if self.winds:
            head.payout = 1
            self.rate, self.slope = float(winch.rate), float(winch.slope)
        self.place, self.velocity, self.acceleration = (
            block.array(word, self.nodes, SIZE)[0, :3].copy()
            for word in (Header.position, Header.velocity, Header.acceleration)
        )

    def _let_matter_pass(self) -> None:
        """Matrices by the nodes' velocities and accelerations at the winch, not by the matter's.

        What runs past is (r_t + v r', ...), as kernels/payout.py has it: here its derivatives.
        """
        rate, slope = self.rate, self.slope
        if rate == slope == 0.0:
            return
        h = float(self.block.winch.top_length)
        r0, d0, r1, d1 = np.eye(4)
        second = (6.0 * (r1 - r0) / h - 4.0 * d0 - 2.0 * d1) / h
        third = (12.0 * (r0 - r1) / h + 6.0 * d0 + 6.0 * d1) / h**2
        longer = -rate / h**2 * (12.0 * (r1 - r0) / h - 4.0 * d0 - 2.0 * d1)
        velocity = np.array([rate * d0, rate * second])  # by q
        by_place = np.array([rate**2 * second, 2.0 * rate * longer + rate**2 * third])
        by_place += slope * np.array([d0, second])
        by_speed = np.array([2.0 * rate * d0, 2.0 * rate * second])
        axes = np.eye(3)
        near, both = slice(0, SIZE), slice(0, 2 * SIZE)
        damping, mass = self.damping[:, near].copy(), self.mass[:, near]
        self.stiffness[:, both] += damping @ np.kron(velocity, axes) + mass @ np.kron(
            by_place, axes
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

    def _shift(self) -> FloatArray:
        """Motions of all unknowns as the tow point moves, (nodes SIZE, 3): the line goes along,
        where nothing else holds it."""
        if int(self.block.header.constraint_count) > 1:
            return self._top()
        shift = np.zeros((self.nodes, SIZE, 3))
        shift[:, :3] = np.eye(3)
        return shift.reshape(-1, 3)

    def _top(self) -> FloatArray:
        """Places of node 0, and of hinges there, as the tow point moves alone, (nodes SIZE, 3)."""
        block = self.block
        parent, joint = (block.integers(w, self.nodes) for w in (Header.parent, Header.joint))
        top = np.zeros((self.nodes, SIZE, 3))
        top[0, :3] = np.eye(3)
        for node in range(1, self.nodes):
            if joint[node] == at.JOINT_HINGE:
                top[node] = top[parent[node]]
        return top.reshape(-1, 3)

    def drives(self) -> tuple[FloatArray, FloatArray, FloatArray, Names, FloatArray, Names]:
        """The residual by levels, by inputs, and how levels change by levels; names of levels,
        their values, and names of inputs."""
        shift, block = self._shift(), self.block
        levels = [self.stiffness @ shift, self.damping @ shift]
        inputs = [self.mass @ shift]
        names: list[str] = [*_of("vessel_position"), *_of("vessel_velocity")]
        origin = np.array([*block.scalars.origin])
        values = [self.place + origin, self.velocity]
        input_names = [*_of("vessel_acceleration")]
        if self.winds:
            edge = float(block.winch.top_length)

            def length(of: Block, by: float) -> None:
                of.winch.top_length += by

            def rate(of: Block, by: float) -> None:
                of.winch.rate += by

            def slope(of: Block, by: float) -> None:
                of.winch.slope += by

            levels += [
                self.by(length, LENGTH_STEP * edge)[:, None],
                self.by(rate, RATE_STEP)[:, None],
            ]
            inputs += [self.by(slope, RATE_STEP)[:, None]]
            names += ["line_length", "payout_rate"]
            values += [np.array([self.length, self.rate])]
            input_names += ["payout_acceleration"]
        for axis in range(3):

            def flow(of: Block, by: float, axis: int = axis) -> None:
                live = of.scalars.live_current
                live.first[axis] += by
                live.last[axis] += by

            def surge(of: Block, by: float, axis: int = axis) -> None:
                of.scalars.live_current.last[axis] += by

            levels.append(self.by(flow, RATE_STEP)[:, None])
            inputs.append(self.by(surge, RATE_STEP)[:, None])
        names += _of("current")
        values.append(self.current)
        input_names += _of("current_rate")
        count = len(names)
        chain = np.zeros((count, count))
        for rate_name, name in (
            *zip(_of("vessel_velocity"), _of("vessel_position"), strict=True),
            ("payout_rate", "line_length"),
        ):
            if rate_name in names:
                chain[names.index(name), names.index(rate_name)] = 1.0
        return (
            np.column_stack(levels),
            np.column_stack(inputs),
            chain,
            tuple(names),
            np.concatenate(values),
            tuple(input_names),
        )

    def linear_model(self, others: Mapping[str, FloatArray] | None = None) -> LinearModel:
        """About the state. others: more inputs, each with what the residual changes by."""
        z, others = self.basis, others or {}
        by_level, by_input, chain, levels, operating, inputs = self.drives()
        # What the motion leaves when the tow point and the winch go on evenly.
        even = self.residual(condensed=False) - self.mass @ self._top() @ self.acceleration
        if self.winds:
            even -= by_input[:, inputs.index("payout_acceleration")] * self.slope
        by_input = np.column_stack([by_input, *others.values()])
        inputs = (*inputs, *others)
        mass = z.T @ self.mass @ z
        # Accelerations by place, velocity, levels, inputs; then those that the state has itself.
        now = self.block.array(Header.acceleration, self.nodes * SIZE).copy()
        answer = -_solve(
            mass,
            np.column_stack(
                [
                    z.T @ self.stiffness @ z,
                    z.T @ self.damping @ z,
                    z.T @ by_level,
                    z.T @ by_input,
                    z.T @ even,
                ]
            ),
        )
        n, k, m = z.shape[1], len(levels), len(inputs)
        of_line, of_inputs, left = answer[:, : 2 * n + k], answer[:, 2 * n + k : -1], answer[:, -1]
        a = np.zeros((2 * n + k, 2 * n + k))
        a[:n, n : 2 * n] = np.eye(n)
        a[n : 2 * n] = of_line
        a[2 * n :, 2 * n :] = chain
        b = np.zeros((2 * n + k, m))
        b[n : 2 * n] = of_inputs
        for column, name in enumerate(inputs):
            if name not in others:
                b[2 * n + levels.index(RATES[name]), column] = 1.0
        shift = self._shift()
        speed = self.block.array(Header.velocity, self.nodes * SIZE) - shift @ self.velocity
        drift = np.concatenate([self.dual @ speed, self.dual @ now + left, chain @ operating])
        # Forces on the support: rows of node 0, and of hinges there.
        rows = self._top().T
        force = rows @ np.column_stack(
            [self.stiffness @ z, self.damping @ z, by_level, by_input]
        ) + rows @ self.mass @ z @ np.column_stack([of_line, of_inputs])
        pull = rows @ (even + self.mass @ z @ left)
        c, d, offset, outputs = self._outputs(n, levels, m, -force, -pull, operating, shift)
        dual = self.names
        return LinearModel(
            a,
            b,
            c,
            d,
            drift,
            offset,
            (*dual, *(_rate_of(name) for name in dual), *levels),
            inputs,
            outputs,
            operating,
            self.time,
        )

    def _outputs(
        self,
        n: int,
        levels: Names,
        m: int,
        force: FloatArray,
        pull: FloatArray,
        operating: FloatArray,
        shift: FloatArray,
    ) -> tuple[FloatArray, FloatArray, FloatArray, Names]:
        """C, D, offset and names: by places, velocities, levels and inputs."""
        block, nodes = self.block, self.nodes
        k = len(levels)
        position = block.array(Header.position, nodes, SIZE)
        velocity = block.array(Header.velocity, nodes, SIZE)
        origin = np.array([*block.scalars.origin])
        slope = position[0, 3:]
        size = np.linalg.norm(pull)
        if size == 0.0:
            raise CableModelError("linearise: no force at the tow point, so no top tension")
        sign = np.copysign(1.0, pull @ slope)
        rows = [force, (sign * pull / size) @ force]
        names = [*_of("top_force"), "top_tension"]
        values: list[FloatArray | float] = [*pull, sign * size]

        def place(weights: Sequence[tuple[int, float]], of_velocity: bool) -> FloatArray:
            at_nodes = np.zeros((3, nodes, SIZE))
            for node, weight in weights:
                at_nodes[:, node, :3] += weight * np.eye(3)
            flat = at_nodes.reshape(3, -1)
            row = np.zeros((3, 2 * n + k + m))
            (row[:, n : 2 * n] if of_velocity else row[:, :n])[:] = flat @ self.basis
            name = "vessel_velocity" if of_velocity else "vessel_position"
            first = 2 * n + levels.index(f"{name}.x")
            row[:, first : first + 3] = flat @ shift
            return row

        def value(weights: Sequence[tuple[int, float]], of: FloatArray) -> FloatArray:
            return np.asarray(sum(weight * of[node, :3] for node, weight in weights))

        tip = [(nodes - 1, 1.0)]
        rows += [place(tip, False), place(tip, True)]
        names += [*_of("tip_position"), *_of("tip_velocity")]
        values += [*(value(tip, position) + origin), *value(tip, velocity)]
        parent = block.integers(Header.parent, nodes)
        for number, body in enumerate(self._bodies):
            node = int(body[at.Body.node])
            weights = [(node, 1.0)]
            if body[at.Body.length] > 0.0:
                outer = 0.5 * (1.0 + body[at.Body.offset])
                weights = [(node, outer), (int(parent[node]), 1.0 - outer)]
            rows += [place(weights, False)]
            names += _of(f"bodies[{number}].position")
            values += [*(value(weights, position) + origin)]
        eye = np.zeros((k, 2 * n + k + m))
        eye[:, 2 * n : 2 * n + k] = np.eye(k)
        for row, name in enumerate(levels):
            if not name.startswith("current"):
                rows.append(eye[row])
                names.append(name)
                values.append(operating[row])
        stacked = np.vstack(rows)
        return (
            stacked[:, : 2 * n + k],
            stacked[:, 2 * n + k :],
            np.array([float(value) for value in values]),
            tuple(names),
        )


def _rate_of(name: str) -> str:
    return name.replace("slope", "slope_rate").replace("position", "velocity")


def _refuse(model: CableModel, block: Block) -> None:
    """What has no linear model.

    Raises:
        CableModelError: it says why.
    """
    head = block.header
    reason = None
    if head.wave_count:
        reason = "waves drive the line, and its matrices change with them"
    elif head.floor_state == at.FLOOR_TOUCHED or head.asleep:
        reason = (
            "the line touches the sea floor, where contact begins and ends, and friction sticks or "
            "slides"
        )
    elif block.winch.passing != 0.0:
        reason = "a body passes the tow point"
    if reason is None:
        nodes = int(head.nodes)
        edges = block.array(Header.edges, nodes, at.EDGE_WORDS)[1:]
        tension = block.array(Header.tension, nodes, 2)[1:, 0]
        elements = block.integers(Header.joint, nodes)[1:] == at.JOINT_NONE
        slack = elements & (edges[:, at.Edge.bending] == 0.0) & (tension < 0.0)
        if slack.any():
            first = edges[np.argmax(slack), at.Edge.start] + block.winch.paid
            reason = (
                f"the line is slack, {first:.6g} m from the vessel: without bending stiffness "
                "nothing holds it there"
            )
    if reason is not None:
        raise CableModelError(f"linearise: {reason}")


def _places(known: Names, wanted: Iterable[str] | None, kind: str) -> list[int]:
    if wanted is None:
        return list(range(len(known)))
    places = []
    for name in wanted:
        if name not in known:
            raise CableModelError(f"no {kind} {name!r}; there are {', '.join(known)}")
        places.append(known.index(name))
    return places


def _solve(matrix: FloatArray, right: FloatArray) -> FloatArray:
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        raise CableModelError(
            "linearise: something moves freely: give the line tension or bending stiffness"
        ) from None


def _eig(matrix: FloatArray) -> tuple[NDArray[np.complex128], ...]:
    linalg = require("scipy.linalg", extra="analysis", what="a reduced linear model")
    values, left, right = linalg.eig(matrix, left=True)
    return values.astype(complex), left.astype(complex), right.astype(complex)


def _diagonal(blocks: list[FloatArray]) -> FloatArray:
    size = sum(len(block) for block in blocks)
    matrix, start = np.zeros((size, size)), 0
    for block in blocks:
        end = start + len(block)
        matrix[start:end, start:end] = block
        start = end
    return matrix
