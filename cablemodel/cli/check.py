"""``cablemodel check`` and ``cablemodel schema``: what a scene holds, and what one may hold."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cablemodel.cli.errors import reported
from cablemodel.cli.run import SceneArgument, SetOption, explained_start

if TYPE_CHECKING:
    from cablemodel.model import CableModel, CableState
    from cablemodel.scene import Scene
    from cablemodel.scene.line import CableType

_AIR = 100.0
"""Densities [kg/m3] below this are air; nothing is surprising about it above z = 0."""
_LARGE_STRAIN = 0.02
_ABOVE_WATER = 0.01
"""Height [m] by which a cable may stand above z = 0 without a word."""


@reported
def check(
    scene: SceneArgument,
    overrides: SetOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Say what a scene holds, what will be skipped, its first tensions, and what looks wrong."""
    from cablemodel.model import CableModel
    from cablemodel.scene import load_scene

    loaded = load_scene(scene, overrides or ())
    with explained_start(quiet=as_json):
        model = CableModel(loaded)
        report = _report(loaded, model)
    if as_json:
        typer.echo(json.dumps(report))
    else:
        _print_report(report)


@reported
def schema() -> None:
    """Print the JSON schema of scenes, from which editors check and complete."""
    from cablemodel.scene import scene_json_schema

    typer.echo(json.dumps(scene_json_schema(), indent=2))


def _report(scene: Scene, model: CableModel) -> dict[str, Any]:
    state = model.state()
    return {
        "title": scene.title,
        "line_length": scene.line_length,
        "line": [_item(scene, index) for index in range(len(scene.line))],
        "end": scene.end.kind,
        "initial": scene.initial.kind,
        "duration": scene.run.duration,
        "output_interval": scene.run.output_interval,
        "solver": scene.solver.as_written(),
        "elements": model.statistics["elements"],
        "planar": model.planar,
        "waves": _waves(scene),
        "skipped": _skipped(scene, model),
        "start": {
            "top_tension": model.top_tension,
            "tension_min": model.tension_min,
            "tension_max": model.tension_max,
            "tip_position": [float(value) for value in model.tip_position],
        },
        "warnings": _warnings(scene, model, state),
    }


def _waves(scene: Scene) -> str | None:
    """The sea in words."""
    from cablemodel.scene.sea import sea

    field = sea(scene)
    if field is None:
        return None
    waves = scene.environment.waves
    assert waves is not None
    if waves.regular is not None:
        kind = f"regular, {waves.regular.height:g} m high, {field.period:g} s"
    else:
        assert waves.jonswap is not None
        kind = (
            f"JONSWAP, significant height {waves.jonswap.hs:g} m, peak period {field.period:g} s, "
            f"{len(field.amplitude)} components, seed {waves.jonswap.seed}"
        )
    water = "deep water" if math.isinf(field.depth) else f"{field.depth:g} m of water"
    return (
        f"{kind}; {field.length:.4g} m long in {water}, going {math.degrees(field.direction):g} "
        f"degrees from x; from calm water within {field.ramp:g} s"
    )


def _item(scene: Scene, index: int) -> dict[str, Any]:
    cable, body = scene.line[index].cable, scene.line[index].body
    if cable is not None:
        weight = _weight(scene.cable_types[cable.type]) * cable.length
        return {
            "cable": cable.type,
            "model": cable.model,
            "length": cable.length,
            "submerged_weight": weight,
        }
    assert body is not None
    return {"body": body.name or "", "mass": body.mass, "submerged_weight": body.submerged_weight}


def _weight(kind: CableType) -> float:
    """Submerged weight [N/m]; reading the scene has resolved it."""
    return kind.submerged_weight or 0.0


def _skipped(scene: Scene, model: CableModel) -> list[str]:
    """What will not be computed, and because of what."""
    skipped = []
    if model.planar:
        skipped.append("the third dimension: everything stays in one vertical plane")
    bending = any(
        scene.cable_types[cable.type].bending_stiffness > 0.0 and cable.model != "cable"
        for cable in scene.cables
    )
    if not bending:
        skipped.append("bending: no cable of this line has any")
    for given, words in (
        (scene.environment.current is not None, "current: none in the scene"),
        (scene.environment.waves is not None, "waves: none in the scene; water is everywhere"),
        (scene.environment.floor is not None, "sea floor: none in the scene"),
        (bool(scene.bodies), "bodies: none in the line"),
        (any(row.rate != 0.0 for row in scene.payout.rate), "pay-out: the rate is 0"),
    ):
        if not given:
            skipped.append(words)
    return skipped


def _warnings(scene: Scene, model: CableModel, state: CableState) -> list[str]:
    """What is legal, but seldom meant."""
    found = []
    settings = scene.run
    if settings.output_interval > settings.duration:
        found.append(
            f"run.output_interval ({settings.output_interval:g} s) is longer than run.duration "
            f"({settings.duration:g} s): only the start and the end are output"
        )
    if scene.vessel.connection.kind == "clamped":
        first = scene.cables[0]
        if first.model == "cable" or scene.cable_types[first.type].bending_stiffness == 0.0:
            found.append(
                "vessel.connection is clamped, but the first cable has no bending: no effect"
            )
    used = {cable.type for cable in scene.cables}
    for name in sorted(scene.cable_types):
        kind = scene.cable_types[name]
        if name not in used:
            found.append(f"cable_types.{name} is not used in the line")
            continue
        if _weight(kind) < 0.0:
            found.append(f"cable type {name} floats: its submerged weight is {_weight(kind):g} N/m")
        strain = sum(
            c * model.tension_max ** (k + 1) for k, c in enumerate(kind.strain_coefficients)
        )
        if strain > _LARGE_STRAIN:
            found.append(
                f"cable type {name} would stretch by {100 * strain:.1f} % under the highest "
                f"tension at the start; is its axial stiffness right?"
            )
    above = float(state.position[:, 2].max())
    wet = scene.environment.water_density > _AIR and scene.environment.waves is None
    if wet and above > _ABOVE_WATER:
        found.append(
            f"the cable reaches {above:.3g} m above z = 0; without waves there is water "
            "everywhere, also there"
        )
    slack = 10.0 * scene.solver.tolerance * max(abs(model.tension_max), abs(model.tension_min))
    if model.tension_min < -slack:
        found.append(f"the cable is compressed at the start: {model.tension_min:.3g} N")
    return found


def _print_report(report: dict[str, Any]) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    console = Console(highlight=False)
    table = Table(title=escape(report["title"] or "Scene"), title_justify="left", show_header=False)
    table.add_column(style="dim")
    table.add_column()
    start = report["start"]
    tip = ", ".join(f"{value:.3f}" for value in start["tip_position"])
    kind = "static equilibrium" if report["initial"] == "static" else "given shape"
    table.add_row("line, from the vessel", "\n".join(escape(_words(i)) for i in report["line"]))
    table.add_row("far end", report["end"])
    if report["waves"]:
        table.add_row("waves", report["waves"])
    table.add_row("run", f"{report['duration']:g} s, output every {report['output_interval']:g} s")
    table.add_row("elements", _accuracy(report["elements"], report["solver"]))
    table.add_row("skipped", "\n".join(report["skipped"]) or "nothing")
    table.add_row("start", kind)
    table.add_row("  top tension", f"{start['top_tension']:,.3f} N")
    table.add_row(
        "  tension along the cable", f"{start['tension_min']:,.3f} to {start['tension_max']:,.3f} N"
    )
    table.add_row("  far end (x, y, z)", f"({tip}) m")
    console.print(table)
    for warning in report["warnings"]:
        console.print(f"[yellow]warning:[/yellow] {escape(warning)}", soft_wrap=True)
    if not report["warnings"]:
        console.print("No warnings.")


def _accuracy(elements: int, solver: dict[str, Any]) -> str:
    """How many elements there are, and what they are for."""
    if solver["method"] == "direct_integration":
        spacing, step = solver["node_spacing"], solver["time_step"]
        return f"{elements} intervals of {spacing:g} m, steps of {step:g} s (direct integration)"
    return f"{elements} for a tolerance of {solver['tolerance']:g}"


def _words(item: dict[str, Any]) -> str:
    weight = f"{item['submerged_weight']:,.4g} N in water"
    if "cable" in item:
        return f"{item['length']:g} m of cable {item['cable']} ({item['model']}), {weight}"
    name = f" {item['body']}" if item["body"] else ""
    return f"body{name}, {item['mass']:g} kg, {weight}"
