"""As in `launch_ros.actions`."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import yaml
from launch import value


class Node:
    """A process; `command` is what `launch_ros` would run, behind the executable."""

    def __init__(
        self, *, package: str, executable: str, namespace: Any = "", name: str | None = None,
        parameters: tuple[Any, ...] | list[Any] = (), arguments: tuple[str, ...] | list[str] = (),
        condition: Any = None, output: str = "log", respawn: Any = False,
        respawn_delay: float = 0.0,
    ) -> None:  # fmt: skip
        self.package, self.executable = package, executable
        self._namespace, self._name, self._parameters = namespace, name, parameters
        self._arguments, self._condition = arguments, condition

    def wanted(self, given: dict[str, str]) -> bool:
        return self._condition is None or bool(value(self._condition, given))

    def command(self, given: dict[str, str]) -> list[str]:
        rules = [] if self._name is None else ["-r", f"__node:={self._name}"]
        namespace = value(self._namespace, given)
        if namespace:
            rules += ["-r", f"__ns:=/{namespace.strip('/')}"]
        for item in self._parameters:
            rules += ["--params-file", self._file(value(item, given), given)]
        return [*self._arguments, "--ros-args", *rules]

    def _file(self, item: Any, given: dict[str, str]) -> str:
        """A file of parameters, which a dictionary becomes."""
        if isinstance(item, str):
            return item
        values = {key: value(entry, given) for key, entry in item.items()}
        with tempfile.NamedTemporaryFile("w", suffix=".yaml", delete=False) as file:
            yaml.safe_dump({"/**": {"ros__parameters": values}}, file)
        return str(Path(file.name))


class LifecycleNode(Node):
    """A node with a name and a namespace."""

    def __init__(self, *, name: str, namespace: Any, **others: Any) -> None:
        super().__init__(name=name, namespace=namespace, **others)
