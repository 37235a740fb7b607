"""A scene as text, with what is not that of the deck as its first comment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


def written(
    scene: Mapping[str, Any],
    environment: Mapping[str, float],
    moving: Mapping[str, Any],
    comment: str,
    left: Sequence[str],
    source: str,
) -> str:
    """The scene in YAML; environment: gravity [m/s2], density [kg/m3], depth [m] and friction;
    moving: its current and waves, by their keys."""
    import yaml

    from cablemodel.scene.text import SceneDumper

    class Dumper(SceneDumper):
        """Numbers of a place stand in a row."""

    def row(dumper: yaml.SafeDumper, values: list[Any]) -> yaml.Node:
        flow = all(isinstance(value, float) for value in values)
        return dumper.represent_sequence("tag:yaml.org,2002:seq", values, flow_style=flow)

    Dumper.add_representer(list, row)
    floor = {"z": -environment["wtrdpth"], "friction": environment["frictioncoefficient"]}
    data: dict[str, Any] = {"title": f"From {source or 'a MoorDyn deck'}"}
    data["environment"] = {
        "gravity": environment["g"], "water_density": environment["rho"], "floor": floor, **moving,
    }  # fmt: skip
    lines = [f"# {comment} Not as in the deck:"]
    lines += [f"# - {' '.join(item.split())}" for item in left] or ["# - nothing"]
    body = yaml.dump({**data, **scene}, Dumper=Dumper, sort_keys=False, allow_unicode=True)
    return "\n".join(lines) + "\n" + body


def cable_of(kind: Mapping[str, Any], length: float) -> dict[str, Any]:
    """An item of a line: a length [m] of a type that was read."""
    cable: dict[str, Any] = {"type": kind["name"], "length": length}
    if kind["bending_stiffness"] > 0.0:
        cable["model"] = "elastica"  # MoorDyn's line bends everywhere
    return {"cable": cable}


def type_of(kind: Mapping[str, Any]) -> dict[str, Any]:
    """What ``cable_types`` has of a type that was read."""
    return {key: value for key, value in kind.items() if key != "name"}
