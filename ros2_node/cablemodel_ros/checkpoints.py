"""States of a session that are gone back to when a step cannot be made."""

from __future__ import annotations

from collections import deque
from typing import Any

EVERY = 1.0
"""Simulated seconds between two states that are kept."""
TRIES = 3
"""How often one place is tried before the session is given up."""
PASSED = 5.0
"""How far beyond a failure [s] it is taken to be passed."""


class Checkpoints:
    """The last good states of a model, and how often they were needed.

    Attributes: ``retries`` (all), ``gone_back`` (the last time, [s]).
    """

    def __init__(self) -> None:
        self._kept: deque[tuple[float, Any]] = deque(maxlen=TRIES + 1)
        self._failed_at = -1.0
        self._tries = 0
        self.retries = 0
        self.gone_back = 0.0

    def clear(self) -> None:
        """Forget all states: time begins anew."""
        self._kept.clear()
        self._failed_at, self._tries = -1.0, 0

    def keep(self, model: Any) -> None:
        """Called after every step: keeps a state when it is time."""
        if not self._kept or model.time >= self._kept[-1][0] + EVERY:
            self._kept.append((model.time, model.snapshot()))
        if self._tries and model.time > self._failed_at + PASSED:
            self._tries = 0

    def restore(self, model: Any) -> bool:
        """Go back, each time farther; False when that was done as often as makes sense."""
        if self._tries >= TRIES:
            return False
        if not self._tries:
            self._failed_at = model.time
        # The newest state may be the one that fails, or a hair before it.
        while len(self._kept) > 1 and model.time - self._kept[-1][0] < 0.5 * EVERY:
            self._kept.pop()
        if not self._kept:
            return False
        self._tries += 1
        self.retries += 1
        time, snapshot = self._kept[-1] if len(self._kept) == 1 else self._kept.pop()
        self.gone_back = model.time - time
        model.restore(snapshot)
        return True
