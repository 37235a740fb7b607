"""How far a run may be wrong, while it runs: the same line or system at a quarter of the tolerance,
stepped beside it; in halves of the caller's steps where these limit both runs.

The results are those of a run without an estimate, bit by bit. Its error is taken to be twice what
the two differ by: where lines fold or crack errors fall only as the root of the tolerance, and the
finer run has half of them (docs/engine/errors.md).
"""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from cablemodel.errors import StaticsError
from cablemodel.solvers.finite_element.solver import FiniteElementSolver
from cablemodel.solvers.protocol import FINER, FloatArray, Memory
from cablemodel.solvers.shared import layout as at

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.solvers.finite_element.block import Block

Kind = TypeVar("Kind")

_ORDER = 0.5
"""The slowest convergence: errors as this power of the tolerance."""
FACTOR = 1.0 / (1.0 - FINER**-_ORDER)
"""Error over difference, with that convergence: 2."""
_ESTIMATE_PARTS = 101
PLACES: FloatArray = np.array(
    [0.5 - 0.5 * math.cos(math.pi * k / _ESTIMATE_PARTS) for k in range(_ESTIMATE_PARTS + 1)]
)
"""Parts of the line at which shapes and tensions are compared. The ends' parts are the shortest; a
prime, for then no place but the ends is at a round number, as bodies are, where a tension jumps and
rounding would choose the side. The cosine is that of the C library, as in the FMU: NumPy's own may
differ in the last digit."""


def finer(scene: Kind) -> Kind:
    """A scene, of one line or of a system, at the tolerance that its runs are judged by."""
    own: Any = scene
    changes = {"tolerance": own.solver.tolerance / FINER, "error_estimate": False}
    judge: Kind = own.model_copy(update={"solver": own.solver.model_copy(update=changes)})
    return judge


def estimated(
    places: FloatArray, others: FloatArray, tensions: FloatArray, other_tensions: FloatArray
) -> tuple[float, float]:
    """Errors of positions [m] and tensions [N]: the largest, of places (n, 3) and tensions (m,) of
    a run and of the finer one."""
    difference = np.linalg.norm(places - others, axis=1)
    pulls = np.abs(tensions - other_tensions)
    return FACTOR * float(difference.max()), FACTOR * float(pulls.max())


def step_in_halves(block: Block) -> None:
    """Make a block's run one to judge others by, even where the caller's steps limit both."""
    block.scalars.halves = 1.0


class EstimatingSolver(FiniteElementSolver):
    """The finite elements, and the same at a quarter of the tolerance beside them."""

    def __init__(
        self, scene: Scene, *, planar: bool | None = None, sleep: bool | None = None
    ) -> None:
        super().__init__(scene, planar=planar, sleep=sleep)
        self._finer: FiniteElementSolver | None = None
        with contextlib.suppress(StaticsError):  # without a start of the finer run: no estimate
            self._finer = FiniteElementSolver(finer(scene), planar=planar, sleep=sleep)
            step_in_halves(self._finer.memory)

    @property
    def memories(self) -> tuple[Memory, ...]:
        beside = self._finer.memories if self._finer is not None else ()
        return (*super().memories, *beside)

    def step(self, end: float, inputs: FloatArray) -> int:
        # A finer run that could not make a step stays behind for good: there is no estimate then.
        beside = self._beside
        status = super().step(end, inputs)
        if beside is not None and status == at.OK:
            beside.step(end, inputs)
        return status

    @property
    def _beside(self) -> FiniteElementSolver | None:
        """The finer run, if it stands where this one does."""
        other = self._finer
        if other is None or other.memory.scalars.time != self.memory.scalars.time:
            return None
        return other

    def errors(self) -> tuple[float, float]:
        beside = self._beside
        if beside is None:
            return math.nan, math.nan
        words = np.zeros((2, at.SUMMARY_WORDS))
        self.summary(words[0])
        beside.summary(words[1])
        stations = PLACES * np.min(words[:, at.Summary.line_length])
        shapes = np.empty((2, len(stations), at.STATION_WORDS))
        self.sample(stations, shapes[0].reshape(-1))
        beside.sample(stations, shapes[1].reshape(-1))
        tops = words[:, at.Summary.top_tension, None]
        return estimated(*shapes[:, :, at.Station.position.span], *tops)
