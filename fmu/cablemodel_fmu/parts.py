"""A system in an FMU: its variables, and its section of the model file; see c/system.c.

Names are those of cablemodel/variables.py. Value references count through inputs, through the
vessels, and through outputs, each in the order of that table.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cablemodel.scene.line import Cable
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.record import dtype_of
from cablemodel.systems.built import Built
from cablemodel.systems.equilibrium import first_along
from cablemodel.systems.guess import standing
from cablemodel.systems.motion import first_angles, turning
from cablemodel.systems.scene import SystemScene
from cablemodel.systems.tables import lengths_of
from cablemodel.variables import (
    CUT_OUTPUTS,
    FREE_BODY_PARAMETERS,
    SYSTEM_LENGTHS,
    VESSEL_CHOICE,
    VESSEL_STARTS,
    Variable,
    inputs_of_system,
    outputs_of,
)
from cablemodel_fmu.file_records import PartRow
from cablemodel_fmu.model_file import name_bytes
from cablemodel_fmu.shared_numbers import (
    OF_FREE,
    VR_PARAMETER,
    VR_SYSTEM_CHOICE,
    VR_SYSTEM_INPUT,
    VR_SYSTEM_OUTPUT,
    VR_SYSTEM_START,
)
from cablemodel_fmu.signals import (
    LARGEST,
    LONGEST,
    SHORTEST,
    Coefficient,
    Coefficients,
    Signal,
    axes_of,
    controls,
    length_of,
)

_FORCE = 1e15
_ALLOWED = {**LARGEST, "rad": 1e4, "rad/s": 1e3, "N": _FORCE, "N.m": _FORCE, "": 1e9}
"""What an input may be, by its unit, either way: what is larger is a mistake."""


def signals_of(
    scene: SystemScene, stations: int, values: tuple[bool, int, int], constants: list[Coefficient]
) -> list[Signal]:
    """All variables of a system.

    values: start values of use_scene_inputs, of what moves each vessel, and of input.timing.
    """
    scene_inputs, _, timing = controls(*values)
    return [
        scene_inputs,
        timing,
        *choices(scene, values[1]),
        *starts(scene),
        *(item.signal for item in constants),
        *inputs(scene),
        *outputs(scene, stations),
    ]


def choices(scene: SystemScene, by: int) -> list[Signal]:
    """Of each vessel or driven end: which inputs move it."""
    return [
        Signal(
            VESSEL_CHOICE.fmu.replace("NAME", name), VR_SYSTEM_CHOICE + n, "Enumeration",
            "parameter", "fixed", "", f"{name}: {VESSEL_CHOICE.quantity}", float(by),
            type="VesselInput",
        )
        for n, name in enumerate(scene.vessels)
    ]  # fmt: skip


def is_movable(scene: SystemScene) -> bool:
    """Whether vessels' starts may be set: friction holds bodies that stand on the sea floor where
    the scene puts them, which the block does not know, and what has been laid."""
    return not standing(scene) and not any(scene.runs_alone(name) for name in scene.winches)


def starts(scene: SystemScene) -> list[Signal]:
    """Of each vessel or driven end: place, velocity and attitude at the start, bounded by
    themselves where they may not be set."""
    found: list[Signal] = []
    for name in scene.vessels:
        for row in VESSEL_STARTS:
            field = row.fmu.removeprefix("NAME.start_").removesuffix("[i]")
            for i, value in enumerate(_starts(scene, name, field), start=1):
                most = _ALLOWED[row.unit]
                found.append(
                    Signal(
                        row.fmu.replace("NAME", name).replace("[i]", f"[{i}]"),
                        VR_SYSTEM_START + len(found),
                        "Real",
                        "parameter",
                        "fixed",
                        row.unit,
                        f"{name}: {row.quantity}, {axes_of(row.unit)[i - 1]}",
                        value,
                        -most if is_movable(scene) else value,
                        most if is_movable(scene) else value,
                    )
                )
    return found


def coefficients(scene: SystemScene, built: Built) -> list[Coefficient]:
    """Of cable types; of bodies in lines, counted from each line's beginning, and of those on each
    winch's drum, in the order in which they leave; of free bodies, but
    for the weights of those that stand on the floor or displace water by their hulls."""
    found = Coefficients(scene)
    found.add_types(scene, {cable.type for cable in (*scene.cables, *scene.drum_cables)})
    for row, mass in enumerate(built.tree.masses):
        found.add_body(f"{mass.owner}.body[{mass.number}].", mass.body, row)
    drag, weight = FREE_BODY_PARAMETERS
    rho, floor = scene.environment.water_density, scene.environment.floor
    for index, (name, free) in enumerate(scene.bodies.items()):
        for i, area in enumerate(free.drag_area if rho > 0.0 else ()):
            word = at.FreeBody.drag.word + i
            signal = drag.fmu.replace("NAME", name).replace("[i]", f"[{i + 1}]")
            found.add(drag, signal, area, OF_FREE, word, index, 0.5 * rho)
        if free.submerged_weight is not None and (floor is None or free.feet == ()):
            signal, word = weight.fmu.replace("NAME", name), at.FreeBody.buoyancy.word
            found.add(weight, signal, free.submerged_weight, OF_FREE, word, index, -1.0, None)
    return found.rows


def lengths(scene: SystemScene, built: Built, first: int) -> list[Coefficient]:
    """Of the cables of each line, from its beginning, and of those on each winch's drum, in the
    order in which they leave. first: how many parameters come before them.

    Branches stay where they are: what is before one is the scene's.
    """
    of_line, on_drum = SYSTEM_LENGTHS
    places: list[tuple[str, Cable, int, bool]] = []
    for name, line in scene.lines.items():
        cables = [item.cable for item in line.items if item.cable is not None]
        branches = [end.at or 0.0 for other in scene.lines.values() for end in other.ends
                    if end.line == name]  # fmt: skip
        arc = 0.0
        for number, cable in enumerate(cables, start=1):
            fixed = any(place > arc + 1e-9 for place in branches)
            places.append((name, cable, number, fixed))
            arc += cable.length
    for name, winch in scene.winches.items():
        for number, cable in enumerate(winch.drum_cables, start=1):
            places.append((name, cable, number, False))
    movable = is_movable(scene)
    found: list[Coefficient] = []
    rows = lengths_of(scene, built.tree).reshape(-1, at.LENGTH_WORDS)
    for (name, cable, number, fixed), row in zip(places, rows, strict=True):
        entry = of_line if row[at.CableLength.winch] < 0.0 else on_drum
        settable = movable and not fixed
        signal = Signal(
            entry.fmu.replace("NAME", name).replace("[n]", f"[{number}]"),
            VR_PARAMETER + first + len(found),
            "Real",
            "parameter",
            "fixed",
            entry.unit,
            f"{name}: {entry.quantity}",
            cable.length,
            cable.length * (SHORTEST if settable else 1.0),
            cable.length * (LONGEST if settable else 1.0),
        )
        found.append(length_of(scene, cable, signal, row))
    return found


def inputs(scene: SystemScene) -> list[Signal]:
    """Inputs of vessels, bodies, foils, winches and cuts, at their values at the start."""
    found: list[Signal] = []
    for part, row in inputs_of_system(scene):
        values = _starts(scene, part, row.python)
        command = row.python == "cut"
        axes = axes_of(row.unit, row.python)
        for i, value in enumerate(values, start=1):
            most = _ALLOWED[row.unit]
            words = row.quantity + ("" if command else ", reached at the end of a step")
            found.append(
                Signal(
                    row.fmu.replace("NAME", part).replace("[i]", f"[{i}]"),
                    VR_SYSTEM_INPUT + len(found),
                    "Real",
                    "input",
                    "discrete" if command else "continuous",
                    row.unit,
                    f"{part}: {words}" + (f", {axes[i - 1]}" if row.shape else ""),
                    value,
                    -most,
                    most,
                )
            )
    return found


def _starts(scene: SystemScene, part: str, field: str) -> list[float]:
    """An input's numbers at the start: those of the scene's own motion, no force, no cut."""
    if field == "cut":
        return [0.0]
    if field == "rate":
        return [scene.winches[part].rate_at_start]
    if field == "deflection":
        body, _, foil = part.partition(".")
        return [scene.bodies[body].foils[foil].deflection]
    if part not in scene.vessels:
        return [0.0, 0.0, 0.0]
    vessel = scene.vessels[part]
    position, velocity, _ = vessel.motion().evaluate(0.0)
    rates = at.Polynomial(turning(vessel)[0], at.Piece.data.word).velocity
    found = {
        "position": position,
        "velocity": velocity,
        "attitude": np.array(first_angles(vessel)),
        "attitude_rate": rates,
    }
    return [float(value) for value in found[field]]


def outputs(scene: SystemScene, stations: int) -> list[Signal]:
    """Outputs of lines, bodies, vessels, winches and cuts."""
    jump = {row.quantity for row in CUT_OUTPUTS}
    found: list[Signal] = []
    for row in outputs_of(scene):
        variability = "discrete" if row.quantity.partition(": ")[2] in jump else "continuous"
        names = list(row.fmu_names(stations=stations))
        for name, words in zip(names, _descriptions(row, stations, len(names)), strict=True):
            found.append(
                Signal(
                    name,
                    VR_SYSTEM_OUTPUT + len(found),
                    "Real",
                    "output",
                    variability,
                    row.unit,
                    words,
                )
            )
    return found


def _descriptions(row: Variable, stations: int, count: int) -> Iterator[str]:
    along = "stations" in row.shape
    places = (
        [f", point {k} of {stations} from its beginning" for k in range(1, stations + 1)]
        if along
        else [""]
    )
    axes = [f", {axis}" for axis in axes_of(row.unit)] if row.shape[-1:] == (3,) else [""]
    for place in places if count else []:
        for axis in axes:
            yield f"{row.quantity}{place}{axis}"


def section(scene: SystemScene, built: Built, by: int) -> NDArray[np.int64]:
    """What the shared library needs to know of the parts, in the order of c/system.c."""
    names = list(scene.lines)
    rows = [_row(signal) for signal in (*inputs(scene), *choices(scene, by), *starts(scene))]
    rows += [_row(Signal(name, 0, "", "", "", "", "", 0.0)) for name in (*names, *scene.bodies)]
    segments = [2 * names.index(part.line) + part.backward for part in built.tree.segments]
    return np.concatenate(
        [np.array([len(names)], dtype="<i8"), *rows, np.array(segments, dtype="<i8")]
    )


def first_shape(scene: SystemScene) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """First shape of a system, and the image of its block along that; nothing where its start may
    not be set."""
    if not is_movable(scene):
        return np.zeros(0), np.zeros(0, dtype=np.int64)
    built, shape = first_along(scene)
    return shape, built.block.image.copy()


def _row(signal: Signal) -> NDArray[np.int64]:
    """A PartRow."""
    assert signal.start is not None
    most = _ALLOWED[signal.unit] if signal.maximum is None else signal.maximum
    least = -most if signal.minimum is None else signal.minimum
    row = np.array([(signal.start, least, most, name_bytes(signal.name))], dtype_of(PartRow))
    return np.frombuffer(row.tobytes(), "<i8")


def fastest_vessel(scene: SystemScene) -> float:
    """The largest speed that the scene gives a vessel [m/s]."""
    return max(
        (
            math.sqrt(sum(float(x) ** 2 for x in velocity))
            for vessel in scene.vessels.values()
            for velocity in vessel.motion().typical_velocities()
        ),
        default=0.0,
    )


def longest_arm(scene: SystemScene) -> float:
    """The largest distance of a point from the origin of its vessel or body [m]."""
    places = [vessel.points for vessel in scene.vessels.values()]
    places += [body.points for body in scene.bodies.values()]
    return max((math.hypot(*place) for named in places for place in named.values()), default=0.0)


def ports_of(scene: SystemScene) -> list[tuple[str, str, str]]:
    """Of each vessel, for the Open Simulation Platform: name, force, velocity."""
    return [(name, f"{name}.force", f"{name}.velocity_input") for name in scene.vessels]
