"""States of a run at its output times, and applied inputs of its steps, as rows of numbers."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.shared.curves import hermite
from cablemodel.variables import (
    APPLIED_INPUT_FIELDS,
    APPLIED_INPUT_LABELS,
    INPUTS,
    STATE_FIELDS,
    STATE_LABELS,
    is_system,
    span,
)

if TYPE_CHECKING:
    from cablemodel.model import CableState
    from cablemodel.scene.wall_tension import Surroundings

Floats = NDArray[np.float64]

_SAME_PLACE = 1e-9
"""Part of its length by which nodes of a line are at one place."""

_ROW = {name: span(STATE_FIELDS, name) for name, _ in STATE_FIELDS}


def matrix_of(state: Any) -> Floats:
    """All fields of a state, (fields, nodes), in the order of ``variables.STATE_LABELS``."""
    matrix = np.empty((len(STATE_LABELS), len(state.s)))
    for name, _ in STATE_FIELDS:
        matrix[_ROW[name]] = np.asarray(getattr(state, name), float).T
    return matrix


def applied_values(model: Any, step: float, given: Collection[str] | Mapping[str, Any]) -> Floats:
    """What a step applied, in the order of ``variables.input_labels``.

    ``given`` names the inputs that the caller gave. As a mapping it has their values too, which are
    then kept rather than what evaluating the motion makes of them, a last bit of round-off away.
    """
    if is_system(model.scene):
        assert isinstance(given, Mapping)
        return np.asarray(model.input_row(step, given), dtype=np.float64)
    values = _UNKNOWN.copy()
    values[0], values[1] = model.time, step
    applied = model.applied_inputs
    for name, place in _APPLIED:
        value = applied.get(name)
        if value is not None:
            values[place] = value
    exact = given if isinstance(given, Mapping) else {}
    for item, place, at in _GIVEN:
        values[at] = item in given
        if exact.get(item) is not None:
            values[place] = exact[item]
    return values


_UNKNOWN = np.full(len(APPLIED_INPUT_LABELS), np.nan)
_APPLIED = [
    (name, span(APPLIED_INPUT_FIELDS, name))
    for name, _ in APPLIED_INPUT_FIELDS[2:]
    if not name.endswith("_given")
]
_GIVEN = [
    (
        item.python,
        span(APPLIED_INPUT_FIELDS, item.python),
        APPLIED_INPUT_LABELS.index(f"{item.python}_given"),
    )
    for item in INPUTS
]


def shapes_of(model: Any) -> dict[str, CableState]:
    """The present state of every line of a model by its name, which is "" where there is one."""
    return model.shapes() if is_system(model.scene) else {"": model.state()}


def by_label(rows: list[Floats], labels: Sequence[str]) -> dict[str, Floats]:
    """Rows of numbers, such as the inputs of all steps: label to values (rows,)."""
    table = np.array(rows).reshape(len(rows), len(labels))
    return {label: table[:, index] for index, label in enumerate(labels)}


def bodies_in_columns(samples: list[Floats], columns: int | None = None) -> Floats:
    """Vectors (bodies, 3) of the bodies that are out at each time, as one array (n, columns, 3).

    A body keeps its column: bodies come off the drum and go back onto it at the vessel, so that
    the last column is always the outermost one. NaN while a body is on the drum. ``columns`` is
    the most bodies of all samples if not given.
    """
    if columns is None:
        columns = max((len(sample) for sample in samples), default=0)
    table = np.full((len(samples), columns, 3), np.nan)
    for row, sample in zip(table, samples, strict=True):
        row[columns - len(sample) :] = sample
    return table


class States(Sequence["CableState"]):
    """States at the output times: ``states[i]`` is a :class:`~cablemodel.CableState`.

    ``states.position`` and the like are arrays over time and nodes. Nodes come and go while cable
    is paid out or a mesh adapts; where their number is not the same at all times, the arrays are
    at stations spaced evenly along the cable that is out at each time (as many as the most nodes).
    """

    def __init__(
        self,
        time: Floats,
        matrices: list[Floats] | Callable[[], list[Floats]],
        water: Surroundings | None = None,
    ) -> None:
        self.time = time
        """Times (nt,) [s]."""
        self._given = matrices
        self._water = water

    def in_water(self, water: Surroundings) -> States:
        """The same, which know what is around the line."""
        return States(self.time, self._given, water)

    @cached_property
    def _matrices(self) -> list[Floats]:
        return self._given() if callable(self._given) else self._given

    def __len__(self) -> int:
        return len(self.time)

    @overload
    def __getitem__(self, index: int) -> CableState: ...
    @overload
    def __getitem__(self, index: slice) -> list[CableState]: ...
    def __getitem__(self, index: int | slice) -> CableState | list[CableState]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        from cablemodel.model import CableState

        matrix = self._matrices[index]
        fields: dict[str, Any] = {name: _field(matrix, name) for name, _ in STATE_FIELDS}
        fields["on_floor"] = fields["on_floor"] > 0.5
        if self._water is not None:
            fields["water"] = self._water, float(fields["s"][-1])
        return CableState(time=float(self.time[index]), **fields)

    def __iter__(self) -> Iterator[CableState]:
        return (self[i] for i in range(len(self)))

    @property
    def s(self) -> Floats:
        """Unstretched arc length from the vessel (nt, n) [m]."""
        return self._array("s")

    @property
    def position(self) -> Floats:
        """Position (nt, n, 3) [m], east, north, up."""
        return self._array("position")

    @property
    def tangent(self) -> Floats:
        """Unit tangent away from the vessel (nt, n, 3)."""
        return self._array("tangent")

    @property
    def velocity(self) -> Floats:
        """Velocity of the material (nt, n, 3) [m/s]."""
        return self._array("velocity")

    @property
    def tension(self) -> Floats:
        """Effective tension (nt, n) [N]."""
        return self._array("tension")

    @property
    def wall_tension(self) -> Floats:
        """Wall tension (nt, n) [N]: see :attr:`CableState.wall_tension`."""
        if len({matrix.shape[1] for matrix in self._matrices}) > 1:
            return self.resampled(self.s.shape[1]).wall_tension
        found = [state.wall_tension for state in self]
        return np.stack(found) if found else np.empty((0, 0))

    @property
    def curvature(self) -> Floats:
        """Curvature (nt, n) [1/m]."""
        return self._array("curvature")

    @property
    def bending_moment(self) -> Floats:
        """Bending moment (nt, n) [N m]."""
        return self._array("bending_moment")

    @property
    def on_floor(self) -> NDArray[np.bool_]:
        """Whether a node touches the floor (nt, n)."""
        return self._array("on_floor") > 0.5

    @property
    def max_curvature(self) -> float:
        """Largest curvature of all nodes and times [1/m]; NaN without states."""
        largest = [np.max(matrix[_ROW["curvature"]]) for matrix in self._matrices]
        return float(max(largest, default=np.nan))

    @property
    def most_nodes(self) -> int:
        """Number of nodes, the most of all times."""
        return max((matrix.shape[1] for matrix in self._matrices), default=0)

    def chosen(self, indices: Iterable[int]) -> States:
        """The states of some of the times only."""
        at = np.fromiter(indices, int)
        matrices = self._matrices
        return States(self.time[at], [matrices[index] for index in at], self._water)

    def split(self, places: Sequence[float]) -> list[States]:
        """The states of the pieces between arc lengths within the line [m], in order. A node there
        is the end of one piece and the beginning of the next; of two, each has its own."""
        pieces: list[list[Floats]] = [[] for _ in range(len(places) + 1)]
        for whole in self._matrices:
            rest = whole
            for piece, place in zip(pieces, places, strict=False):
                here = np.flatnonzero(np.abs(rest[0] - place) <= _SAME_PLACE * whole[0, -1])
                if not len(here):
                    here = np.searchsorted(rest[0], [place])
                    rest = np.insert(rest, here, _resampled(rest, np.array([place])), axis=1)
                piece.append(rest[:, : here[0] + 1])
                rest = rest[:, here[-1] :]
            pieces[-1].append(rest)
        return [States(self.time, matrices) for matrices in pieces]

    def resampled(self, stations: int) -> States:
        """The states at ``stations`` points spaced evenly in s at each time.

        Positions by the cubic through nodes and tangents, all else linear between nodes.
        """
        return States(
            self.time,
            [
                _resampled(matrix, np.linspace(matrix[0, 0], matrix[0, -1], stations))
                for matrix in self._matrices
            ],
            self._water,
        )

    def _array(self, name: str) -> Floats:
        counts = {matrix.shape[1] for matrix in self._matrices}
        if len(counts) > 1:
            return self.resampled(max(counts))._array(name)
        if not counts:
            return np.empty((0, 0, 3) if _ROW[name].stop - _ROW[name].start == 3 else (0, 0))
        return np.stack([_field(matrix, name) for matrix in self._matrices])


def _field(matrix: Floats, name: str) -> Floats:
    rows = matrix[_ROW[name]]
    return rows[0] if len(rows) == 1 else rows.T


def state_at(state: CableState, s: Floats) -> CableState:
    """A state at other arc lengths (n,) [m], see :meth:`States.resampled`; beyond the ends of the
    line it is that of the ends. The state itself where it has these arc lengths."""
    if np.array_equal(state.s, s):
        return state
    inside = np.clip(s, state.s[0], state.s[-1])
    found = States(np.array([state.time]), [_resampled(matrix_of(state), inside)])[0]
    return replace(found, water=state.water)


def _resampled(matrix: Floats, at: Floats) -> Floats:
    """All rows at arc lengths (n,) within those of the nodes."""
    s = matrix[0]
    result = np.stack([np.interp(at, s, row) for row in matrix])
    # A mesh may have two nodes at one s (either side of a body): at its end, too.
    many = 1 + int(np.searchsorted(s, s[-1]))
    if many > 1:
        position, tangent = matrix[_ROW["position"], :many], matrix[_ROW["tangent"], :many]
        result[_ROW["position"]] = hermite(at, s[:many], position, tangent)[0]
    length = np.linalg.norm(result[_ROW["tangent"]], axis=0)
    result[_ROW["tangent"]] /= np.where(length > 0.0, length, 1.0)
    result[_ROW["on_floor"]] = result[_ROW["on_floor"]] > 0.5
    return result
