"""Write docs/scene.md, the reference of every key of a scene, from the schema.

Run by ``make docs``; a test fails when the page is not what the schema says.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cablemodel.scene import scene_json_schema
from cablemodel.scene.reference import keys_of, word_of

PAGE = Path(__file__).parent / "scene.md"

INTRODUCTION = """\
# Scene file

For those who write scenes. This page lists every key of the YAML file, from the schema in the code.
`cablemodel new` writes a first scene, `cablemodel import moordyn` takes one from a MoorDyn deck,
ready ones are in [scenes](../scenes). `cablemodel keys vessel` prints the same for a part of it,
and `cablemodel check SCENE` tells whether a file is right before anything is computed.

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
    "WaveComponents": "`environment.waves.components`",
    "WaveComponent": "Row of `environment.waves.components`",
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
    description = schema.get("description", "")
    word, mapping = word_of(schema)
    lines = [f"## {title}", "", description]
    if word:
        lines += ["", f"The word `{word}`, or a mapping:"]
    lines += ["", "|key|value|default|meaning|", "|---|---|---|---|"]
    for key in keys_of(mapping):
        meaning = key.meaning.replace("|", "\\|")
        lines.append(f"|`{key.name}`|{key.kind}|{key.default}|{meaning}|")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PAGE.write_text(scene_reference(), encoding="utf-8")
    print(f"wrote {PAGE}")
