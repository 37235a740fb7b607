"""What a system is made of, in words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from cablemodel.scene.line import LineItem
from cablemodel.systems.model import SystemModel
from cablemodel.systems.scene import LineEnd, SystemScene


def _numbers(place: Iterable[float]) -> str:
    """A place to the millimetre."""
    return ", ".join(f"{round(value, 3) + 0.0:.6g}" for value in place)


def _place(end: LineEnd) -> str:
    if end.point is not None:
        return end.point + (" (clamped)" if end.clamped is not None else "")
    if end.anchor is not None:
        return f"an anchor at ({_numbers(end.anchor)}) m"
    if end.line is not None:
        return f"{end.line} at {end.at:g} m"
    return "a free end"


def _items(items: Iterable[LineItem]) -> str:
    """Cables and bodies in their order."""
    words = []
    for item in items:
        if item.cable is not None:
            words.append(f"{item.cable.length:g} m of {item.cable.type}")
        elif item.body is not None:
            words.append(f"body {item.body.name or ''}".strip())
    return ", ".join(words)


def topology(scene: SystemScene) -> Iterator[str]:
    """A line of text for every vessel, body, line and winch."""
    for name, vessel in scene.vessels.items():
        points = ", ".join(vessel.points) or "none"
        moves = "moved by the waves" if vessel.raos else "at rest"
        if vessel.path is not None or vessel.velocity is not None:
            moves = "moves"
        yield f"vessel {name}, {moves}: points {points}"
    for name, body in scene.bodies.items():
        tied = [
            f"{line_name}"
            for line_name, line in scene.lines.items()
            for end in line.ends
            if end.owner == name
        ]
        wings = f", foils {', '.join(body.foils)}" if body.foils else ""
        yield f"body {name}, {body.mass:g} kg: held by {', '.join(tied)}{wings}"
    for name, line in scene.lines.items():
        parts = _items(line.items)
        yield f"line {name}: from {_place(line.start)} to {_place(line.end)}: {parts}"
    for name, winch in scene.winches.items():
        place = "beginning" if winch.at == "start" else "end"
        drum = _items(winch.drum) or "nothing"
        yield f"winch {name}: at the {place} of {winch.line}, on its drum {drum}"


def at_start(model: SystemModel) -> Iterator[str]:
    """Tensions at the ends of all lines, and where bodies are."""
    for name, line in model.lines.items():
        ends = line.sample([0.0, line.length]).tension
        found = line.on_floor
        lies = f", {found.floor_length:.5g} m on the floor" if found.floor_length else ""
        yield f"{name}: {ends[0]:.5g} N at its beginning, {ends[1]:.5g} N at its end{lies}"
    for name, motion in model.bodies.items():
        yield f"{name}: at {_numbers(motion.position)} m"
