"""Write docs/scene.md, the reference of every key of a scene, from the schema.

Run by ``make docs``; a test fails when the page is not what the schema says.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cablemodel.scene import scene_json_schema

PAGE = Path(__file__).parent / "scene.md"

INTRODUCTION = """\
# Scene file

For those who write scenes. This page lists every key of the YAML file, from the schema in the code.
`cablemodel new` writes a first scene, `cablemodel import moordyn` takes one from a MoorDyn deck,
ready ones are in [scenes](../scenes). `cablemodel check SCENE` tells whether a file is right before
anything is computed.

- **Units** are SI. Any number may also be text with a unit: `12000 ft`, `6 kn`, `180 deg`,
  `1.2 t/m3`.
- **Axes**: x east, y north, z up; the still water surface is z = 0. Angles count from x
  counter-clockwise, in radians unless a unit says otherwise. Arc length is unstretched, from the
  vessel outwards.
- **Errors** name the key by its path (`line.0.cable.length`), what stands there, and what may;
  unknown keys and units of another dimension are errors.
- Numbers and booleans are those of YAML 1.2: `1e6` is a number, `010` is ten, `on` is text.
- **Tables** over time hold their first value before and their last value after. Files that a scene
  names are looked for in the folder of the scene.
- On the command line, `--set PATH=VALUE` replaces any value: `--set line.0.cable.length=50`.

A scene needs `cable_types` and `line`; everything else has a default. An empty one is none.

```yaml
cable_types:
  rope: {diameter: 12 mm, mass: 0.1, axial_stiffness: 1 MN}
line:
  - cable: {type: rope, length: 100}
vessel:
  velocity: [2 kn, 0 kn, 0 kn]
```
"""

SECTIONS = {
    "Scene": "The whole file",
    "Environment": "`environment`",
    "Current": "`environment.current`",
    "CurrentPoint": "Row of `environment.current.table`",
    "Waves": "`environment.waves`",
    "RegularWave": "`environment.waves.regular`",
    "JonswapWaves": "`environment.waves.jonswap`",
    "Floor": "`environment.floor`",
    "FloorPoint": "Row of `environment.floor.depth_table`",
    "CableType": "`cable_types.NAME`",
    "LineItem": "Item of `line` and `payout.drum`",
    "Cable": "`cable`",
    "Body": "`body`",
    "End": "`end`",
    "Connection": "`vessel.connection` and `end.connection`",
    "Initial": "`initial`",
    "Vessel": "`vessel`",
    "VelocityPoint": "Row of `vessel.velocity`",
    "Leg": "Item of `vessel.path`",
    "Straight": "`straight`",
    "Turn": "`turn`",
    "Payout": "`payout`",
    "RatePoint": "Row of `payout.rate`",
    "Solver": "`solver`",
    "RunSettings": "`run`",
}


def scene_reference() -> str:
    """The page as text."""
    schema = scene_json_schema()
    definitions: dict[str, Any] = {**schema["$defs"], "Scene": schema}
    unknown = set(definitions) ^ set(SECTIONS)
    if unknown:
        raise SystemExit(f"SECTIONS and the schema differ in {sorted(unknown)}")
    parts = [INTRODUCTION]
    for name, title in SECTIONS.items():
        parts.append(_section(title, definitions[name]))
    return "\n".join(parts)


def _section(title: str, schema: dict[str, Any]) -> str:
    word = None
    description = schema.get("description", "")
    if "anyOf" in schema:  # a word or a mapping
        word = schema["anyOf"][0]["const"]
        schema = schema["anyOf"][1]
    lines = [f"## {title}", "", description]
    if word is not None:
        lines += ["", f"The word `{word}`, or a mapping:"]
    lines += ["", "|key|value|default|meaning|", "|---|---|---|---|"]
    return "\n".join([*lines, *_rows(schema)]) + "\n"


def _rows(schema: dict[str, Any], above: str = "") -> list[str]:
    """A row for every key, each followed by those of mappings that have no section of their own."""
    lines = []
    required = set(schema.get("required", ()))
    for key, field in schema["properties"].items():
        path = f"{above}{key}"
        needed = "required in it" if above else "required"
        default = needed if key in required else _default(field)
        meaning = field.get("description", "").replace("|", "\\|")
        kind = " ".join(part for part in (_kind(field), _unit(field)) if part)
        lines.append(f"|`{path}`|{kind}|{default}|{meaning}|")
        for part in (field, *field.get("anyOf", ())):
            if "properties" in part:
                lines += _rows(part, f"{path}.")
    return lines


def _default(field: dict[str, Any]) -> str:
    default = field.get("default")
    if default is None:
        return ""
    if isinstance(default, dict) and "$ref" in field:
        return "as below"
    return f"`{_yaml(default)}`" if not isinstance(default, str) or " " not in default else default


def _yaml(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_yaml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_yaml, value)) + "]"
    return (
        f"{value:g}" if isinstance(value, float) and value < 1000 and value % 1 == 0 else f"{value}"
    )


def _unit(field: dict[str, Any]) -> str:
    units = [str(part["unit"]) for part in (field, *field.get("anyOf", ())) if "unit" in part]
    return f"[{units[0]}]" if units else ""


def _kind(field: dict[str, Any]) -> str:
    """What kind of value, with its bounds."""
    if "enum" in field:
        return " or ".join(f"`{word}`" for word in field["enum"])
    if "$ref" in field:
        return "mapping"
    if "anyOf" in field:
        kinds = []
        for part in field["anyOf"]:
            kind = _kind(part)
            # Every number may be text with a unit: said once, at the top.
            if part.get("type") not in ("null", "string") and kind not in kinds:
                kinds.append(kind)
        if {"type": "string"} in field["anyOf"] and not any("number" in kind for kind in kinds):
            kinds.insert(0, "text")
        return " or ".join(kinds)
    kind = field.get("type", "")
    if kind == "array":
        size = field.get("minItems") if field.get("minItems") == field.get("maxItems") else None
        return f"list of {size} numbers" if size else "list"
    if kind == "object":
        return "mapping"
    if kind in ("number", "integer"):
        bounds = [
            f"{sign} {_yaml(field[word])}"
            for word, sign in (
                ("exclusiveMinimum", ">"),
                ("minimum", "≥"),
                ("exclusiveMaximum", "<"),
                ("maximum", "≤"),
            )
            if word in field
        ]
        name = "number" if kind == "number" else "whole number"
        return " ".join([name, ", ".join(bounds)]).strip()
    return "text" if kind == "string" else kind


if __name__ == "__main__":
    PAGE.write_text(scene_reference(), encoding="utf-8")
    print(f"wrote {PAGE}")
