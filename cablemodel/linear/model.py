"""A linear model of a line or a system about a state, with names: what controllers and estimators
are made of.

About any state, steady or not, small deviations of places and slopes q obey

    M q'' + C q' + K q + sum of R_w w = 0,

where M, C and K are the Newton matrix's parts and R_w are the residual's derivatives to what drives
the line. |r'| = 1 + strain(T) makes this a descriptor system; tensions are eliminated through the
elements' compliances, which the Newton matrix does already: K has the axial stiffness, and the
model the line's axial waves. `LinearModel.reduced` takes these out, quasi-statically.

What steps take as inputs (velocity of the tow point, pay-out rate, current) are states here, since
steps vary them linearly; the inputs are their rates. All places are counted from the tow point, so
that a steady tow is an equilibrium. A line that moves otherwise is linearised at one
instant: `drift` and `offset` say how it goes on by itself.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import CableModelError
from cablemodel.extras import require

FloatArray = NDArray[np.float64]
Names = tuple[str, ...]


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
    driven: Names
    """Of each input the level that it is the rate of, (inputs,)."""
    outputs: Names
    """By the names of docs/variables.md: ``top_tension``, ``bodies[0].position.z``; of a system
    ``port.start_tension``, ``plate.position.z``."""
    operating: FloatArray
    """Levels at the state, for the last states in their order: their names are `levels`."""
    time: float
    """Of the state [s]."""
    free: Names = ()
    """States that nothing holds, as the turn of a body about the one line on which it hangs."""

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
            driven=tuple(self.driven[k] for k in columns),
            outputs=tuple(self.outputs[k] for k in rows),
        )

    def gains(self) -> FloatArray:
        """What levels do to the outputs in the end, (outputs, levels), by themselves.

        Of a velocity the steady tow's: all places but ``vessel_position`` then go on with the tow
        point, and their own gains are from there. Of a pay-out rate what it does beside the
        length, which grows meanwhile.

        Raises:
            CableModelError: something moves freely, so that it does not end.
        """
        self._ends("gains")
        line = len(self.states) - len(self.operating)
        steady = self._steady(solved(self.A[:line, :line], np.eye(line)))
        return np.asarray(self.C[:, line:] + self.C[:, :line] @ steady)

    def _ends(self, what: str) -> None:
        if self.free:
            raise CableModelError(
                f"{what}: nothing holds {self.free[0]}, so motions of it have no end: give it a "
                "line, weight or flow that does"
            )

    def _steady(self, inverse: FloatArray) -> FloatArray:
        """Of the line's own states by levels: X of A X + A_levels = X chain, where levels go on."""
        line = len(inverse)
        still = -inverse @ self.A[:line, line:]
        return np.asarray(still + inverse @ (still @ self.A[line:, line:]))

    def reduced(self, count: int) -> LinearModel:
        """With the `count` slowest modes of the line (one more where a pair would be cut), by modal
        truncation; the others follow at once, so that `gains` stay as they are.

        States are modal coordinates, ``mode 0`` and so on (of a pair real and imaginary part).

        Raises:
            CableModelError: a number that is not allowed, or something moves freely.
        """
        self._ends("reduced")
        line = len(self.states) - len(self.operating)
        if not 0 < count <= line:
            raise CableModelError(f"reduced: {count} modes; allowed: 1 to {line}")
        inner = self.A[:line, :line]
        # Of the inverse the slow modes are the large ones: they do not drown in axial stiffness.
        inverse = solved(inner, np.eye(line))
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
        """Of steps of dt [s] as a model makes them, exactly by the matrix exponential."""
        linalg = require("scipy.linalg", extra="analysis", what="a discrete linear model")
        if not 0.0 < dt < np.inf:
            raise CableModelError(f"discrete: a step of {dt!r} s; give a positive one")
        n, m = self.B.shape
        joint = np.zeros((n + m + 1, n + m + 1))
        joint[:n] = np.column_stack([self.A, self.B, self.drift])
        a, b, d = np.split(linalg.expm(joint * dt)[:n], [n, n + m], axis=1)
        # The rate of an input is what is missing to the value at the end, over the step.
        names = self.driven
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

    u are the inputs of `step`, values reached at the end of the step, less `operating`,
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


def _places(known: Names, wanted: Iterable[str] | None, kind: str) -> list[int]:
    if wanted is None:
        return list(range(len(known)))
    places = []
    for name in wanted:
        if name not in known:
            raise CableModelError(f"no {kind} {name!r}; there are {', '.join(known)}")
        places.append(known.index(name))
    return places


def solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
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
