"""What scenes of one line and scenes of systems have in common, for code that serves both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from cablemodel.scene.environment import Environment
    from cablemodel.scene.line import Cable, CableType
    from cablemodel.scene.schema import Solver


class CableScene(Protocol):
    """Cables in water, of any number of lines."""

    @property
    def environment(self) -> Environment: ...
    @property
    def cable_types(self) -> Mapping[str, CableType]: ...
    @property
    def solver(self) -> Solver: ...
    @property
    def cables(self) -> Sequence[Cable]:
        """Those that are out at t = 0."""

    @property
    def drum_cables(self) -> Sequence[Cable]:
        """Those on a drum."""

    @property
    def line_length(self) -> float:
        """Unstretched length of the line, of several of the longest [m]."""

    @property
    def place(self) -> tuple[float, float, float]:
        """Where it is: the tow point, or the first vessel, at t = 0 [m]."""
