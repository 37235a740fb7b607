"""As in `launch_ros.parameter_descriptions`."""

from __future__ import annotations

from typing import Any

import yaml
from launch import value


class ParameterValue:
    def __init__(self, thing: Any, value_type: type) -> None:
        self.thing, self.kind = thing, value_type

    def of(self, given: dict[str, str]) -> Any:
        found = value(self.thing, given)
        found = found if self.kind is str else yaml.safe_load(found)
        assert isinstance(found, self.kind)
        return found
