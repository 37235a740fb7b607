"""What an FMU says about itself: a page, licences, a picture, and its ports for OSP."""

from __future__ import annotations

import itertools
import struct
import xml.etree.ElementTree as ElementTree
import zlib
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.variables import is_system

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.systems.model import SystemModel
    from cablemodel.systems.scene import SystemScene
    from cablemodel_fmu.signals import Signal

_OSP = "https://open-simulation-platform.com/OspModelDescription/1.0.0"

_STYLE = """
body { font: 16px/1.5 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; }
table { border-collapse: collapse; } th, td { text-align: left; padding: .2em .8em .2em 0;
border-bottom: 1px solid #ddd; vertical-align: top; } pre { background: #f4f4f4; padding: 1em;
overflow-x: auto; }
"""

_NOTES = """
<p>An ocean cable that hangs from a vessel, for co-simulation (FMI 2.0). Units are SI; axes are
x east, y north, z up, with still water at z = 0. It needs no Python and no other software.</p>
<h2>Inputs</h2>
<ul>
<li>As it starts, the schedules in the scene below drive what no input is set for: an input that is
connected takes their place. <code>use_scene_inputs</code> set to true: inputs are ignored, and a
warning says so. False: the inputs drive.</li>
<li><code>input.timing</code> 1: a value is the one reached at the end of a communication step; it
varies linearly from its present value. 2: a value holds at the start of the step, and goes on as in
the step before. With input derivatives set, the value at the end of the step follows from them;
they hold for one step.</li>
<li><code>vessel.start_position</code> and <code>vessel.start_velocity</code>, set before the
initialization ends, say where the tow point starts and how fast.</li>
<li><code>vessel.input</code>: 1 velocity, 2 position (no drift against the vessel's own model),
3 both.</li>
<li><code>current.velocity</code> is added to the scene's current at every depth.</li>
<li><code>payout.rate</code> is clamped to zero where the drum is empty or the shortest length is
reached; <code>payout.applied</code> is what the winch does. A warning tells of a drum that is
empty.</li>
</ul>
<h2>Parameters</h2>
<p>Coefficients are tunable: before the start they change the static equilibrium, later they take
effect at the next communication step. Lengths of cables are fixed when the initialization ends;
the state at the start is found for them. The tolerance is that of the scene.</p>
<h2>Derivatives</h2>
<p><code>force.top</code> and <code>tension.top</code> have output derivatives of order 1, and
directional derivatives by <code>vessel.velocity</code> and <code>vessel.position</code>: of the
force at the end of the last step by the values that were set for it.</p>
"""

_SYSTEM_NOTES = """
<p>Ocean cables between vessels, bodies and anchors, for co-simulation (FMI 2.0). Units are SI; axes
are x east, y north, z up, with still water at z = 0. It needs no Python and no other software.</p>
<h2>Inputs</h2>
<ul>
<li>As it starts, the schedules in the scene below drive what no input is set for: a vessel whose
inputs are connected follows them. <code>use_scene_inputs</code> set to true: inputs are ignored,
and a warning says so. False: the inputs drive.</li>
<li><code>input.timing</code> 1: a value is the one reached at the end of a communication step; it
varies linearly from its present value. 2: a value holds at the start of the step, and goes on as in
the step before. With input derivatives set, the value at the end of the step follows from them;
they hold for one step.</li>
<li><code>NAME.input</code> of each vessel or driven end: 1 velocity and rates of roll, pitch and
yaw, 2 position and attitude, 3 all of them. Of place and attitude, what is not connected follows
the scene.</li>
<li><code>NAME.start_position</code>, <code>NAME.start_velocity</code> and
<code>NAME.start_attitude</code>, set before the initialization ends, say where a vessel starts and
how fast; with another velocity than the scene's it goes straight on until it is driven.</li>
<li>Outside forces and torques act on bodies at their origins; axes are the earth's.</li>
<li>A <code>NAME.cut</code> above 0.5 makes the cut as the next step begins, once;
<code>NAME.time</code> says when it was made, and is not a number before.</li>
</ul>
<h2>Parameters</h2>
<p>Coefficients are tunable: before the start they change the static equilibrium, later they take
effect at the next communication step. Lengths of cables are fixed when the initialization ends;
the state at the start is found for them, branches stay where they are. Cables and bodies in a line
are counted from its beginning.</p>
<h2>Outputs</h2>
<p>Forces and moments of the lines on a vessel are about its origin, all in the earth's axes.</p>
"""

_STEPS = """
<h2>Steps</h2>
<p>Of any length. A step that cannot be made is discarded with a message; the state is then as
before the step. State can be saved, restored, and moved to another process.</p>
"""

TOW_POINT = [("tow point", "force.top", "vessel.velocity")]
"""Of a scene of one line: name of its port, force, velocity."""


def index_html(scene: Scene | SystemScene, signals: Sequence[Signal]) -> str:
    """documentation/index.html: what it is, how to use it, all variables, the scene, licences."""
    title = escape(scene.title or "Cable")
    notes = (_SYSTEM_NOTES if is_system(scene) else _NOTES) + _STEPS
    rows = "\n".join(
        "<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>".format(
            escape(signal.name),
            signal.causality if signal.variability != "tunable" else "tunable parameter",
            escape(signal.unit or "-"),
            "" if signal.start is None else f"{signal.start:g}",
            escape(signal.description),
        )
        for signal in signals
    )
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f"<style>{_STYLE}</style></head><body>\n<h1>{title}</h1>\n{notes}"
        "<h2>Variables</h2>\n<table><tr><th>name</th><th>kind</th><th>unit</th><th>start</th>"
        f"<th>meaning</th></tr>\n{rows}\n</table>\n"
        f"<h2>Scene</h2>\n<pre>{escape(scene.to_yaml())}</pre>\n"
        "<h2>Licences</h2>\n<p>cablemodel: Apache License 2.0. FMI header files: copyright "
        "MODELISAR consortium and Modelica Association Project FMI, 2-Clause BSD License. What the "
        "Zig tool chain links into the libraries: its compiler runtime (MIT), and on Windows the "
        "start-up code of mingw-w64 (ZPL 2.1). The full "
        'texts are in <a href="licenses/">licenses</a>.</p>\n</body></html>\n'
    )


def licences() -> dict[str, bytes]:
    """Texts of the licences of all that the FMU's libraries are made from."""
    folder = Path(__file__).parent / "licenses"
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def osp_description(
    signals: Sequence[Signal], ports: Sequence[tuple[str, str, str]] = TOW_POINT
) -> bytes:
    """Ports for the Open Simulation Platform (OSP-IS 1.0): force out, velocity in.

    ports: name, output of the force and input of the velocity. Only names that the FMU has are
    written. The schema wants simple groups before ports, all names
    different, and a force and a velocity of opposite causality in a port.
    """
    names = {signal.name for signal in signals}
    ElementTree.register_namespace("", _OSP)
    root = ElementTree.Element(f"{{{_OSP}}}OspModelDescription", {"version": "1.0"})
    groups = ElementTree.SubElement(root, f"{{{_OSP}}}VariableGroups")
    if "current.velocity[1]" in names:
        _group(groups, "LinearVelocity", "current", "current.velocity", names)
        _group(groups, "LinearDisplacement", "vessel position", "vessel.position", names)
    for name, force, velocity in ports:
        port = ElementTree.SubElement(groups, f"{{{_OSP}}}LinearMechanicalPort", {"name": name})
        vessel = "vessel" if ports is TOW_POINT else name
        _group(port, "Force", f"cable force on the {vessel}", force, names)
        _group(port, "LinearVelocity", f"{vessel} velocity", velocity, names)
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"


def _group(
    parent: ElementTree.Element, kind: str, name: str, variable: str, names: set[str]
) -> None:
    group = ElementTree.SubElement(parent, f"{{{_OSP}}}{kind}", {"name": name})
    for i in (1, 2, 3):
        reference = f"{variable}[{i}]"
        if reference not in names:
            raise KeyError(reference)
        ElementTree.SubElement(group, f"{{{_OSP}}}Variable", {"ref": reference})


Places = list[NDArray[np.float64]]


def _shown(scene: Any, system: SystemModel | None) -> tuple[Places, Places, Places, bool]:
    """At the start: lines (200, 3) each, vessels and bodies (3,) each [m], whether some cable is on
    the floor."""
    from cablemodel.model import CableModel

    def along(part: Any, length: float) -> Any:
        return part.sample(np.linspace(0.0, length, 200))

    if system is not None:
        states = [along(line, line.length) for line in system.lines.values()]
        marks = [vessel.position for vessel in system.vessels.values()]
        bodies = [body.position for body in system.bodies.values()]
        laid = any(state.on_floor.any() for state in states)
    else:
        model = CableModel(scene)
        states = [along(model, model.line_length)]
        marks = [states[0].position[0]]
        bodies = [body.position for body in model.bodies]
        laid = scene.environment.floor is not None and model.floor_length > 0.0
    return [state.position for state in states], marks, bodies, laid


def picture(
    scene: Scene | SystemScene,
    system: SystemModel | None = None,
    width: int = 200,
    height: int = 200,
) -> bytes:
    """model.png: the cables at their start, from the side: bodies, vessels, water, floor.

    Lines of three pixels with smooth edges: it is an icon, and small. system: at its start, where
    the scene is one.
    """
    lines, vessels, bodies, laid = _shown(scene, system)
    points = np.concatenate(lines)
    along = points[:, :2] - points[0, :2]
    spread = along[np.argmax(np.linalg.norm(along, axis=1))]
    direction = spread / max(float(np.linalg.norm(spread)), 1e-12)

    def from_side(places: Any) -> NDArray[np.float64]:
        places = np.asarray(places, dtype=np.float64).reshape(-1, 3)
        return np.stack([(places[:, :2] - points[0, :2]) @ direction, places[:, 2]], axis=-1)

    line = from_side(points)
    low, high = line.min(axis=0), line.max(axis=0)
    size = max(float(np.max(high - low)), 1e-9)
    scale = 0.7 * min(width, height) / size
    middle = 0.5 * (low + high)

    def pixels(places: NDArray[np.float64]) -> NDArray[np.float64]:
        x = 0.5 * width + scale * (places[:, 0] - middle[0])
        return np.stack([x, 0.5 * height - scale * (places[:, 1] - middle[1])], axis=-1)

    columns, rows = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    image = np.full((height, width, 3), 255.0)

    def paint(cover: NDArray[np.float64], colour: tuple[int, int, int]) -> None:
        image[:] += cover[..., None] * (np.array(colour, dtype=float) - image)

    surface = float(pixels(np.array([[0.0, 0.0]]))[0, 1])
    if scene.environment.water_density > 100.0:
        paint(np.clip(rows - surface + 0.5, 0.0, 1.0), (214, 234, 246))
    if laid:
        ground = float(pixels(line[[int(np.argmin(line[:, 1]))]])[0, 1])
        paint(np.clip(rows - ground - 1.0, 0.0, 1.0), (205, 188, 158))
    for own in lines:
        distance = _distance(columns, rows, pixels(from_side(own)))
        paint(np.clip(2.0 - distance, 0.0, 1.0), (16, 42, 67))
    marks = [(place, 5.0, (196, 64, 32)) for place in pixels(from_side(vessels))]
    marks += [(place, 4.0, (16, 42, 67)) for place in pixels(from_side(bodies))]
    for (x, y), radius, colour in marks:
        paint(np.clip(radius + 0.5 - np.hypot(columns - x, rows - y), 0.0, 1.0), colour)
    return _png(np.rint(image).astype(np.uint8))


def _distance(
    columns: NDArray[np.float64], rows: NDArray[np.float64], line: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Of every pixel from a polyline (n, 2) [pixels]; infinite where it is more than two."""
    nearest = np.full(columns.shape, np.inf)
    for (x0, y0), (x1, y1) in itertools.pairwise(line):
        across, down = (
            slice(max(int(min(ends)) - 3, 0), max(int(max(ends)) + 3, 0))
            for ends in ((x0, x1), (y0, y1))
        )
        near, x, y = nearest[down, across], columns[down, across] - x0, rows[down, across] - y0
        dx, dy = x1 - x0, y1 - y0
        part = np.clip((x * dx + y * dy) / max(dx * dx + dy * dy, 1e-12), 0.0, 1.0)
        np.minimum(near, np.hypot(x - part * dx, y - part * dy), out=near)
    return nearest


def _png(image: NDArray[np.uint8]) -> bytes:
    """An 8-bit RGB image (rows, columns, 3) as a PNG file."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    rows, columns, _ = image.shape
    lines = np.concatenate([np.zeros((rows, 1), np.uint8), image.reshape(rows, -1)], axis=1)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(lines.tobytes(), 9))
        + chunk(b"IEND", b"")
    )
