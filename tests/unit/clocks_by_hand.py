"""Clocks of a machine that a test sets and lets pass, and the time base that reads them."""

from __future__ import annotations

from cablemodel_ros.timebase import RealTime
from cablemodel_ros.times import Monotonic, Stamp


class Clocks:
    """The system's and the monotonic clock; they begin far apart, as on a real machine."""

    def __init__(self, ros: float = 1000.0, up: float = 7.0) -> None:
        self.ros, self.monotonic = Stamp(0) + ros, Monotonic(0) + up
        self.timebase = RealTime(lambda: self.ros, lambda: self.monotonic)

    def wait(self, seconds: float) -> None:
        """Both pass."""
        self.ros, self.monotonic = self.ros + seconds, self.monotonic + seconds

    def set(self, seconds: float) -> None:
        """Somebody sets the system's clock."""
        self.ros += seconds
