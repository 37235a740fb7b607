"""``cablemodel check`` and ``cablemodel schema``: what a scene holds, and what one may hold."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from cablemodel.cli.errors import reported
from cablemodel.cli.numbers import readable
from cablemodel.cli.plausibility import (
    scene_warnings,
    start_warnings,
    system_start_warnings,
    system_warnings,
)
from cablemodel.cli.run import JsonOption, SceneArgument, SetOption, explained_start, fixed
from cablemodel.solvers.protocol import FINER

if TYPE_CHECKING:
    from cablemodel.model import CableModel, CableState
    from cablemodel.scene import Scene
    from cablemodel.scene.line import LineItem
    from cablemodel.systems import SystemScene

_AT_THE_VESSEL = 1e-3
"""A line that lies as near to its beginning [m] begins on the floor."""
_BENDS = 3.0
"""Times tau L: a touchdown's bend that reaches less far is not shown; errors of 3 % there."""
_INSTANTS = 201
"""At which the speed of the tow point is looked at."""


@reported
def check(
    scene: SceneArgument,
    overrides: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Say what a scene holds, what will be skipped, its first tensions, and what looks wrong."""
    from cablemodel.errors import StaticsError
    from cablemodel.model import CableModel
    from cablemodel.results.simulate import end_of
    from cablemodel.scene import load_scene
    from cablemodel.scene.load import is_system, read_content

    if is_system(read_content(scene)[2]):
        _check_system(scene, overrides or (), as_json=as_json)
        return
    loaded = load_scene(scene, overrides or ())
    end_of(loaded)  # a run that is refused
    try:
        with explained_start(quiet=as_json), _start_warnings() as caught:
            model = CableModel(loaded)
            report = _report(loaded, model)
        report["warnings"] += [str(warning.message) for warning in caught]
    except StaticsError:
        # What looks wrong may well be why.
        _print_warnings(scene_warnings(loaded))
        raise
    if as_json:
        typer.echo(json.dumps(report))
    else:
        _print_report(report)


@contextmanager
def _start_warnings() -> Iterator[list[warnings.WarningMessage]]:
    """Warnings of starts, as they come."""
    from cablemodel.errors import StartWarning

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", StartWarning)
        yield caught


def _check_system(source: Any, overrides: Iterable[str], *, as_json: bool) -> None:
    """Print what a system is made of, and its start."""
    from cablemodel.systems import SystemModel, load_system
    from cablemodel.systems.words import at_start, topology

    scene = load_system(source, overrides)
    with explained_start(quiet=as_json), _start_warnings() as caught:
        model = SystemModel(scene)
    parts, start = list(topology(scene)), list(at_start(model))
    around = list(_surroundings(scene))
    looks_wrong = [*system_warnings(scene), *system_start_warnings(model)]
    looks_wrong += [str(warning.message) for warning in caught]
    if as_json:
        found = {
            "title": scene.title,
            "topology": parts,
            "surroundings": around,
            "duration": scene.run.duration,
            "output_interval": scene.run.output_interval,
            "start": start,
            "elements": model.statistics["elements"],
            "warnings": looks_wrong,
        }
        typer.echo(json.dumps(found))
        return
    elements = _accuracy(int(model.statistics["elements"]), scene.solver.as_written())
    run = f"run: {scene.run.duration:g} s, output every {scene.run.output_interval:g} s"
    for line in [scene.title, *parts, *around, run, f"elements: {elements}"]:
        if line:
            typer.echo(line)
    for line in ["At the start:", *start]:
        typer.echo(line)
    _print_warnings(looks_wrong)
    if not looks_wrong:
        typer.echo("No warnings.")


def _surroundings(scene: SystemScene) -> Iterator[str]:
    """Waves, and what of the rest there is none of: a line of text for each."""
    waves = _waves(scene)
    if waves is not None:
        yield f"waves: {waves}"
    around = scene.environment
    missing = [
        word
        for word, given in (
            ("current", around.current), ("waves", around.waves), ("sea floor", around.floor),
        )
        if given is None
    ]  # fmt: skip
    if missing:
        yield f"none in the scene: {', '.join(missing)}"


@reported
def schema(
    system: Annotated[
        bool, typer.Option("--system", help="Of systems: scenes with lines.")
    ] = False,
) -> None:
    """Print the JSON schema of scenes, from which editors check and complete."""
    from cablemodel.scene import Scene, scene_json_schema
    from cablemodel.systems import SystemScene

    typer.echo(json.dumps(scene_json_schema(SystemScene if system else Scene), indent=2))


@reported
def keys(
    path: Annotated[
        str,
        typer.Argument(
            help="A part of the scene, as vessel or line.body.",
            metavar="PART",
            show_default=False,
        ),
    ] = "",
    system: Annotated[
        bool, typer.Option("--system", help="Of systems: scenes with lines.")
    ] = False,
) -> None:
    """Say which keys a scene may have, or a part of it, with units, defaults and meanings."""
    from rich.console import Console
    from rich.table import Table

    from cablemodel.scene import Scene, scene_json_schema
    from cablemodel.scene.reference import definition, keys_of
    from cablemodel.systems import SystemScene

    found = definition(scene_json_schema(SystemScene if system else Scene), path)
    rows = Table("key", "value", "default", "meaning", title=path or None, title_justify="left")
    for key in keys_of(found):
        default = "" if key.default == "as below" else key.default
        texts = (key.name, key.kind, default, key.meaning)
        rows.add_row(*(text.replace("`", "") for text in texts))
    console = Console(markup=False, highlight=False)
    for paragraph in found.get("description", "").split("\n\n"):
        console.print(" ".join(paragraph.split()))
    console.print(rows)


def _report(scene: Scene, model: CableModel) -> dict[str, Any]:
    state = model.state()
    rates = [row.rate for row in scene.payout.rate]
    return {
        "title": scene.title,
        "line_length": scene.line_length,
        "line": [_item(scene, item) for item in scene.line],
        "drum": [_item(scene, item) for item in scene.payout.drum],
        "payout_rate": [min(rates), max(rates)],
        "payout_rate_at_start": scene.rate_at_start,
        "end": scene.end.kind,
        "vessel": _vessel(scene),
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
            **_floor(scene, model, state),
        },
        "warnings": [*scene_warnings(scene), *start_warnings(scene, model, state)],
    }


def _waves(scene: Scene | SystemScene) -> str | None:
    """The sea in words."""
    from cablemodel.scene.sea import sea

    field = sea(scene)
    if field is None:
        return None
    waves = scene.environment.waves
    assert waves is not None
    if waves.regular is not None:
        kind = f"regular, {waves.regular.height:g} m high, {field.period:g} s"
    elif waves.components is not None:
        kind = (
            f"{len(field.amplitude)} components, significant height {field.significant_height:.3g} "
            f"m, the largest of {field.period:.3g} s"
        )
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


def _vessel(scene: Scene) -> dict[str, Any]:
    """Where the tow point begins and ends, and how fast it is."""
    motion, end = scene.motion(), scene.run.duration
    places, velocities = motion.track(np.linspace(0.0, end, _INSTANTS))
    speeds = np.linalg.norm(velocities, axis=1).tolist()
    return {
        "position": places[0].tolist(),
        "position_at_end": places[-1].tolist(),
        "speed": speeds[0],
        "highest_speed": max(speeds),
    }


def _floor(scene: Scene, model: CableModel, state: CableState) -> dict[str, Any]:
    """How the cable lies at the start, or how far above the floor it hangs at its nodes."""
    floor = scene.environment.floor
    if floor is None:
        return {}
    gaps = [float(z - floor.height(float(x), float(y))) for x, y, z in state.position]
    touches = model.floor_length > 0.0
    return {
        "floor_length": model.floor_length,
        "floor_clearance": 0.0 if touches else min(gaps),
        "touchdown_position": model.touchdown_position.tolist() if touches else None,
    }


def _item(scene: Scene, item: LineItem) -> dict[str, Any]:
    cable, body = item.cable, item.body
    if cable is not None:
        weight = (scene.cable_types[cable.type].submerged_weight or 0.0) * cable.length
        return {
            "cable": cable.type,
            "model": cable.model,
            "length": cable.length,
            "submerged_weight": weight,
        }
    assert body is not None
    return {"body": body.name or "", "mass": body.mass, "submerged_weight": body.submerged_weight}


def _skipped(scene: Scene, model: CableModel) -> list[str]:
    """What will not be computed, and because of what."""
    skipped = []
    if model.planar:
        skipped.append("the third dimension: everything stays in one vertical plane")
    bending = any(
        scene.cable_types[cable.type].bending_stiffness > 0.0 and cable.model != "cable"
        for cable in scene.cables
    )
    if not bending and scene.environment.floor is None:
        skipped.append("bending: no cable of this line has any")
    elif not bending:
        skipped.append("bending: no cable of this line has any, and gets some only on the floor")
    if model.floor_length > 0.0:
        skipped += _bend_of_a_landing(scene)
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


def _bend_of_a_landing(scene: Scene) -> list[str]:
    """Said where the bend at the touchdown is too short for the tolerance: its curvature, and the
    floor's force there, are a few per cent off from `_BENDS` times tau L on, and soon all of it."""
    from cablemodel.solvers.finite_element.start.scales import is_flexible
    from cablemodel.solvers.finite_element.start.sea_floor import touchdown_layer

    cable, accuracy = scene.cables[-1], scene.solver.tolerance
    if scene.solver.method != "finite_element" or is_flexible(scene, cable):
        return []
    reach = touchdown_layer(scene, cable)
    finer = reach / (_BENDS * scene.line_length)
    if accuracy <= finer:
        return []
    return [
        f"the bend where cable lands, and its largest curvature: it reaches {reach:.2g} m, and "
        f"places are right to {accuracy * scene.line_length:.2g} m; a tolerance of {finer:.1g} "
        "shows it"
    ]


def _print_report(report: dict[str, Any]) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    console = Console(highlight=False)
    table = Table(title=escape(report["title"] or "Scene"), title_justify="left", show_header=False)
    table.add_column(style="dim")
    table.add_column()
    start = report["start"]
    tip = ", ".join(map(fixed, start["tip_position"]))
    table.add_row("line, from the vessel", "\n".join(escape(_words(i)) for i in report["line"]))
    if report["drum"]:
        table.add_row("on the drum", "\n".join(escape(_words(i)) for i in report["drum"]))
    lowest, highest = report["payout_rate"]
    if lowest or highest:
        span = f"{lowest:g} m/s" if lowest == highest else f"{lowest:g} to {highest:g} m/s"
        table.add_row("pay-out", span)
    table.add_row("far end", report["end"])
    table.add_row("tow point", _voyage(report["vessel"]))
    if report["waves"]:
        table.add_row("waves", report["waves"])
    table.add_row("run", f"{report['duration']:g} s, output every {report['output_interval']:g} s")
    table.add_row("elements", _accuracy(report["elements"], report["solver"]))
    table.add_row("skipped", "\n".join(report["skipped"]) or "nothing")
    table.add_row("start", _start(report))
    table.add_row("  top tension", f"{fixed(start['top_tension'])} N")
    table.add_row(
        "  tension along the cable",
        f"{fixed(start['tension_min'])} to {fixed(start['tension_max'])} N",
    )
    table.add_row("  far end (x, y, z)", f"({tip}) m")
    if "floor_length" in start:
        table.add_row("  sea floor", _rest(start, report["vessel"]["position"]))
    console.print(table)
    _print_warnings(report["warnings"])
    if not report["warnings"]:
        console.print("No warnings.")


def _print_warnings(found: list[str]) -> None:
    from rich.console import Console
    from rich.markup import escape

    console = Console(highlight=False)
    for warning in found:
        console.print(f"[yellow]warning:[/yellow] {escape(warning)}", soft_wrap=True)


def _start(report: dict[str, Any]) -> str:
    """What the state at t = 0 is."""
    speed, rate = report["vessel"]["speed"], report["payout_rate_at_start"]
    if report["initial"] != "static":
        return "given shape"
    if speed == 0.0:
        return "static equilibrium"
    paid = f", with a pay-out of {readable(rate)} m/s" if rate else ""
    return f"steady state at {readable(speed)} m/s{paid}"


def _voyage(vessel: dict[str, Any]) -> str:
    """The tow point's motion in words."""
    begin, end = (", ".join(map(readable, vessel[k])) for k in ("position", "position_at_end"))
    if vessel["highest_speed"] == 0.0:
        return f"({begin}) m, at rest"
    speed, highest = readable(vessel["speed"]), readable(vessel["highest_speed"])
    speeds = (
        f"{speed} m/s" if speed == highest else f"{speed} m/s at the start, up to {highest} m/s"
    )
    return f"({begin}) m, {speeds}; at the end ({end}) m"


def _rest(start: dict[str, Any], vessel: list[float]) -> str:
    if start["touchdown_position"] is None:
        return f"nothing touches it, nearest {readable(start['floor_clearance'])} m above it"
    lies = f"{readable(start['floor_length'])} m on it"
    if math.dist(start["touchdown_position"], vessel) < _AT_THE_VESSEL:
        return f"{lies}, from the tow point on"
    return f"{lies}, touchdown at ({', '.join(map(fixed, start['touchdown_position']))}) m"


def _accuracy(elements: int, solver: dict[str, Any]) -> str:
    """How many elements there are, and what they are for."""
    if solver["method"] == "direct_integration":
        spacing, step = solver["node_spacing"], solver["time_step"]
        return f"{elements} intervals of {spacing:g} m, steps of {step:g} s (direct integration)"
    text = f"{elements} for a tolerance of {solver['tolerance']:g}"
    if "accuracy" in solver:
        text += f" (an accuracy of {solver['accuracy']:g} is asked for)"
    if solver.get("error_estimate"):
        text += f", whose errors a run at {solver['tolerance'] / FINER:g} estimates"
    return text


def _words(item: dict[str, Any]) -> str:
    weight = f"{readable(item['submerged_weight'])} N in water"
    if "cable" in item:
        return f"{item['length']:g} m of cable {item['cable']} ({item['model']}), {weight}"
    name = f" {item['body']}" if item["body"] else ""
    return f"body{name}, {item['mass']:g} kg, {weight}"
