"""As in `launch.conditions`."""

from __future__ import annotations

from typing import Any

from launch import value


class IfCondition:
    def __init__(self, predicate: Any) -> None:
        self.predicate = predicate

    def of(self, given: dict[str, str]) -> bool:
        return {"true": True, "false": False}[value(self.predicate, given).lower()]
