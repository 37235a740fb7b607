"""The FMU's variables: names from cablemodel/variables.py, value references as in c/cable.h."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.scene.schema import longest_stretch
from cablemodel.solvers.direct.block import DirectBlock
from cablemodel.solvers.direct.kernels import layout as direct
from cablemodel.solvers.finite_element.start.winch import lengths_of
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel.variables import INPUTS, Parameter, Variable, outputs_of, parameter
from cablemodel_fmu.shared_numbers import (
    OF_BODY,
    OF_CABLES,
    OF_DRUM,
    OF_LINE,
    VR_BODY,
    VR_ERROR,
    VR_PARAMETER,
    VR_START,
    VR_STATION,
    VR_SUMMARY,
    VR_USE_SCENE_INPUTS,
    VR_VELOCITY,
)

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.common import CableScene
    from cablemodel.scene.line import Body, Cable
    from cablemodel.solvers.finite_element.block import Block
    from cablemodel.systems.scene import SystemScene

    AnyBlock = Block | DirectBlock

# First word of a quantity: of the Summary of shared/layout.py, or of a row of the stations.
_SUMMARY = {name: field.word for name, field in at.Summary.FIELDS.items()} | {
    "top_force": at.Summary.wrench.word,
    "top_moment": at.Summary.wrench.word + 3,
}
_ERROR = {"position_error": 0, "tension_error": 1}
_AXES = ("x (east)", "y (north)", "z (up)")
_ANGLES = ("roll", "pitch", "yaw")
_STATION = {
    "state.position": at.Station.position.word,
    "state.tension": at.Station.tension.word,
    "state.curvature": at.Station.curvature.word,
}
_BODY = {
    "bodies.position": at.Station.position.word,
    "bodies.direction": at.Station.tangent.word,
}

LARGEST = {"m": 1e7, "m/s": 1e3}
"""Of inputs, by their unit, either way."""

SHORTEST, LONGEST = 0.5, 2.0
"""Lengths that may be set, in units of the scene's: elements keep their number, which is right for
the exported length."""
ROOM = LONGEST / SHORTEST
"""Of a drum's cable, in elements of the line: there is room for the longest beside the shortest."""

# Words of the coefficients in the rows of cables (elements or materials) and of bodies.
_WORDS = {
    "drag_normal": at.Edge.drag_normal.word,
    "drag_tangential": at.Edge.drag_tangential.word,
    "added_mass": at.Edge.added_mass.word,
    "submerged_weight": at.Edge.weight.word,
    "body.drag_coefficient": at.Body.drag.word,
    "body.drag_coefficient_axial": at.Body.drag_axial.word,
    "body.submerged_weight": at.Body.weight.word,
}
_DIRECT_WORDS = {
    "drag_normal": direct.Material.normal.word,
    "drag_tangential": direct.Material.tangential.word,
    "added_mass": direct.Material.added_mass.word,
    "submerged_weight": direct.Material.weight.word,
    "body.drag_coefficient": direct.RigidBody.drag.word,
    "body.drag_coefficient_axial": direct.RigidBody.drag_axial.word,
    "body.submerged_weight": direct.RigidBody.weight.word,
}


@dataclass(frozen=True)
class Signal:
    """A scalar variable of the FMU."""

    name: str
    reference: int
    kind: str
    """Real, Boolean or Enumeration."""
    causality: str
    variability: str
    unit: str
    description: str
    start: float | None = None
    minimum: float | None = None
    maximum: float | None = None
    nominal: float | None = None
    """Its usual size, where that is not 1."""
    type: str = ""
    """Of an enumeration."""


@dataclass(frozen=True)
class Coefficient:
    """A parameter that is a number, and what it is in the block; see Parameter in c/cable.h."""

    signal: Signal
    kind: int
    word: int
    """Of a coefficient: word = factor times value. Of a length on a drum of a system: the winch."""
    index: int
    """Cable type, row of the body table, or row of the cable table."""
    factor: float
    """Of a length of the line: its part in the typical tension [N/m]."""
    reach: float = 0.0
    """Of a length of the line: how far it can reach when stretched, in lengths. Of one on a drum of
    a system: 1 where the scene counts its elements."""


def axes_of(unit: str, name: str = "") -> tuple[str, ...]:
    """Words for the three components of a vector, of an attitude, or of ``attitude_rate``: rates of
    its angles are not the angular velocity."""
    return _ANGLES if unit == "rad" or name == "attitude_rate" else _AXES


def inputs(starts: list[float]) -> list[Signal]:
    """vessel.velocity, vessel.position, payout.rate, current.velocity: references 0 to 9."""
    signals: list[Signal] = []
    for item in INPUTS:
        names = [item.fmu.replace("[i]", f"[{i}]") for i in (1, 2, 3)] if item.shape else [item.fmu]
        for number, name in enumerate(names):
            reference = VR_VELOCITY + len(signals)
            axis = f", {_AXES[number]}" if item.shape else ""
            signals.append(
                Signal(
                    name,
                    reference,
                    "Real",
                    "input",
                    "continuous",
                    item.unit,
                    f"{item.quantity}{axis}, reached at the end of a step",
                    starts[reference],
                    -LARGEST[item.unit],
                    LARGEST[item.unit],
                )
            )
    return signals


def outputs(scene: Scene, block: AnyBlock, stations: int) -> list[Signal]:
    """Every output that the scene has, in the table's order."""
    rows = body_rows(scene, block)
    return [
        Signal(name, reference, "Real", "output", "continuous", variable.unit, words)
        for variable in outputs_of(scene)
        for (name, reference), words in zip(
            _references(variable, stations, rows),
            _descriptions(variable, stations, _body_names(scene, block, rows)),
            strict=True,
        )
    ]


def with_nominals(
    signals: list[Signal],
    scene: Scene | SystemScene,
    tension: float,
    speed: float,
    arm: float = 0.0,
) -> list[Signal]:
    """The signals with their usual sizes: of a length, a tension, a speed of the scene.

    tension: a typical one [N]. speed: of vessel, current or pay-out, the largest of the scene's
    [m/s]; 0: nothing moves. arm: at which tensions act on parts of a system [m].
    """
    length = scene.line_length
    radius = min(10.0 * length, max(scene.cable_types[c.type].diameter for c in scene.cables) * 100)
    usual = {
        "N": tension,
        "N.m": tension * max(0.1 * radius, arm),
        "m": length,
        "m/s": max(speed, 0.1),
        "1/m": 1.0 / radius,
        "rad": 1.0,
        "rad/s": 0.1,
        "s": scene.run.duration,
    }
    found = []
    for signal in signals:
        nominal = usual.get(signal.unit)
        if signal.causality == "parameter":
            nominal = abs(signal.start) if signal.start else nominal
        found.append(
            replace(signal, nominal=_rounded(nominal))
            if nominal is not None and signal.kind == "Real"
            else signal
        )
    return found


def _rounded(value: float) -> float:
    """To one digit: a nominal value says a size."""
    return float(f"{value:.0e}")


def _descriptions(variable: Variable, stations: int, bodies: list[str]) -> list[str]:
    """Of every scalar of a variable: importers show it where nobody sees the others' indices."""
    if not variable.fmu:
        return []
    places = [""]
    if variable.python in _STATION:
        places = [f", point {k} of {stations} from the vessel" for k in range(1, stations + 1)]
    elif variable.python in _BODY:
        places = [
            f", {j} of {len(bodies)} from the vessel" + (f" ({name})" if name else "")
            for j, name in enumerate(bodies, start=1)
        ]
    axes = [f", {axis}" for axis in _AXES] if _width(variable) == len(_AXES) else [""]
    return [f"{variable.quantity}{place}{axis}" for place in places for axis in axes]


def _body_names(scene: Scene, block: AnyBlock, rows: list[int]) -> list[str]:
    items = scene.line_and_drum
    bodies = [items[_items(block)[row]].body for row in rows]
    return [(body.name or "") if body is not None else "" for body in bodies]


def _width(variable: Variable) -> int:
    """Scalars of a variable at one place."""
    return variable.shape[-1] if variable.shape and isinstance(variable.shape[-1], int) else 1


def _references(variable: Variable, stations: int, rows: list[int]) -> list[tuple[str, int]]:
    names = list(variable.fmu_names(bodies=len(rows), stations=stations))
    width = _width(variable)
    key = variable.python
    if not names:
        return []
    if key in _SUMMARY:
        return [(name, VR_SUMMARY + _SUMMARY[key] + i) for i, name in enumerate(names)]
    if key in _ERROR:
        return [(name, VR_ERROR + _ERROR[key]) for name in names]
    tables = {**dict.fromkeys(_STATION, VR_STATION), **dict.fromkeys(_BODY, VR_BODY)}
    if key not in tables:
        raise KeyError(f"the FMU does not give {key} yet")
    word = {**_STATION, **_BODY}[key]
    places = rows if key in _BODY else range(stations)
    return [
        (name, tables[key] + at.STATION_WORDS * places[n // width] + word + n % width)
        for n, name in enumerate(names)
    ]


def controls(scene_inputs: bool, vessel_input: int, timing: int) -> list[Signal]:
    """What decides who drives, and how: references from VR_USE_SCENE_INPUTS on."""
    return [
        Signal(
            row.fmu, VR_USE_SCENE_INPUTS + n, kind, "parameter", "fixed", "", row.quantity, start,
            type=name,
        )
        for n, (row, kind, start, name) in enumerate(
            (
                (parameter("use_scene_inputs"), "Boolean", float(scene_inputs), ""),
                (parameter("vessel.input"), "Enumeration", float(vessel_input), "VesselInput"),
                (parameter("input.timing"), "Enumeration", float(timing), "InputTiming"),
            )
        )
    ]  # fmt: skip


def starts(inputs_at_start: list[float], *, movable: bool, level: bool = False) -> list[Signal]:
    """vessel.start_position, vessel.start_velocity: references from VR_START on.

    inputs_at_start: start values of the ten inputs. Where they may not be set they are bounded by
    themselves.
    """
    found: list[Signal] = []
    for name, first in (("vessel.start_position[i]", 3), ("vessel.start_velocity[i]", 0)):
        row = parameter(name)
        for i, axis in enumerate(_AXES):
            value = inputs_at_start[first + i]
            most = LARGEST[row.unit]
            settable = movable or (level and first == 3 and i < 2)
            found.append(
                Signal(
                    name.replace("[i]", f"[{i + 1}]"),
                    VR_START + len(found),
                    "Real",
                    "parameter",
                    "fixed",
                    row.unit,
                    f"{row.quantity}, {axis}",
                    value,
                    -most if settable else value,
                    most if settable else value,
                )
            )
    return found


def coefficients(scene: Scene, block: AnyBlock) -> list[Coefficient]:
    """Tunable coefficients of cable types and bodies."""
    found = Coefficients(scene, _DIRECT_WORDS if isinstance(block, DirectBlock) else _WORDS)
    used = {cable.type for cable in scene.cables}
    used |= {cable.type for cable in scene.drum_cables}
    found.add_types(scene, used)
    items = scene.line_and_drum
    for number, row in enumerate(body_rows(scene, block), start=1):
        body = items[_items(block)[row]].body
        assert body is not None
        found.add_body(f"body[{number}].", body, row)
    return found.rows


class Coefficients:
    """Tunable coefficients, with value references from VR_PARAMETER on."""

    def __init__(self, scene: CableScene, words: dict[str, int] = _WORDS) -> None:
        self.rows: list[Coefficient] = []
        self._words = words
        self._rho = scene.environment.water_density

    def add(
        self, row: Parameter, name: str, value: float, kind: int, word: int, index: int,
        factor: float, least: float | None = 0.0,
    ) -> None:  # fmt: skip
        """One by its name."""
        signal = Signal(
            name,
            VR_PARAMETER + len(self.rows),
            "Real",
            "parameter",
            "tunable",
            row.unit,
            row.quantity,
            value,
            least,
        )
        self.rows.append(Coefficient(signal, kind, word, index, factor))

    def add_types(self, scene: CableScene, used: set[str]) -> None:
        """Those of the cable types that are used."""
        rho = self._rho
        for index, (name, kind) in enumerate(scene.cable_types.items()):
            if name not in used:
                continue
            half = 0.5 * rho * kind.diameter
            factors = {
                "drag_normal": half,
                "drag_tangential": half * math.pi,
                "added_mass": 0.25 * rho * math.pi * kind.diameter**2,
            }
            factors = {**(factors if rho > 0.0 else {}), "submerged_weight": 1.0}
            for field, factor in factors.items():
                self.add(
                    parameter(f"cable_types.K.{field}"),
                    f"cable_types.{_identifier(name)}.{field}",
                    getattr(kind, field),
                    OF_CABLES,
                    self._words[field],
                    index,
                    factor,
                    None if field == "submerged_weight" else 0.0,
                )

    def add_body(self, prefix: str, body: Body, index: int) -> None:
        """Those of a body in a line, by its row of the body table."""
        rho = self._rho
        factors = {
            "drag_coefficient": 0.5 * rho * body.drag_area,
            "drag_coefficient_axial": 0.5 * rho * body.drag_area_axial,
        }
        factors = {**{k: x for k, x in factors.items() if x > 0.0}, "submerged_weight": 1.0}
        for field, factor in factors.items():
            self.add(
                parameter(f"body[j].{field}"),
                prefix + field,
                getattr(body, field),
                OF_BODY,
                self._words[f"body.{field}"],
                index,
                factor,
                None if field == "submerged_weight" else 0.0,
            )


def lengths(scene: Scene, first: int) -> list[Coefficient]:
    """Lengths of the cables of line and drum; first: how many parameters come before them.

    The rows of the cable table begin at the line's far end; see
    cablemodel/solvers/finite_element/start/winch.py.
    """
    found: list[Coefficient] = []
    settable = is_settable(scene)
    rows = lengths_of(scene).reshape(-1, at.LENGTH_WORDS)
    for n, (cable, row) in enumerate(zip((*scene.cables, *scene.drum_cables), rows, strict=True)):
        inboard = n >= len(scene.cables)
        entry = parameter("drum.cable[n].length" if inboard else "line.cable[n].length")
        number = n + 1 - (len(scene.cables) if inboard else 0)
        signal = Signal(
            entry.fmu.replace("[n]", f"[{number}]"),
            VR_PARAMETER + first + n,
            "Real",
            "parameter",
            "fixed",
            entry.unit,
            entry.quantity,
            cable.length,
            cable.length * (SHORTEST if settable else 1.0),
            cable.length * (LONGEST if settable else 1.0),
        )
        found.append(length_of(scene, cable, signal, row))
    return found


def length_of(
    scene: CableScene, cable: Cable, signal: Signal, row: NDArray[np.float64]
) -> Coefficient:
    """What the FMU knows of a cable's length; row: its CableLength."""
    of = at.CableLength
    index, tension = int(row[of.row]), float(row[of.tension])
    if row[of.winch] < 0.0:
        stretch = longest_stretch(scene.cable_types[cable.type])
        return Coefficient(signal, OF_LINE, 0, index, tension, stretch)
    return Coefficient(signal, OF_DRUM, int(row[of.winch]), index, tension, float(row[of.counted]))


def is_settable(scene: Scene) -> bool:
    """Whether lengths and the tow point's start may be set: not those of a line that starts from a
    given shape, or over a floor, where what lies on it depends on how it was laid."""
    if scene.environment.floor is not None:
        return False
    return scene.initial.kind == "static" or (
        scene.initial.kind == "straight" and scene.end.kind == "free"
    )


def is_level(scene: Scene) -> bool:
    """Whether the tow point's start may be moved along a level floor, and what lies with it."""
    floor = scene.environment.floor
    if floor is None or floor.z is None or any(floor.slope):
        return False
    return scene.initial.kind == "static" and scene.end.kind == "free"


def body_rows(scene: Scene, block: AnyBlock) -> list[int]:
    """Rows of the block's body table in the order of body[1], body[2], ...: from the vessel
    outwards as if all were out, so that the drum's, which come off near the vessel, are first."""
    items = _items(block)
    line = [row for row, item in enumerate(items) if item < len(scene.line)]
    drum = [row for row, item in enumerate(items) if item >= len(scene.line)]
    line.sort(key=lambda row: items[row])
    drum.sort(key=lambda row: -items[row])
    return drum + line


def _items(block: AnyBlock) -> list[int]:
    """Place of each body of the block's table in the scene: in its line, then in its drum."""
    if isinstance(block, DirectBlock):
        of_direct = (int(block.ints[direct.OwnHeader.body_count]), direct.BODY_WORDS)
        return [
            int(row[direct.RigidBody.item])
            for row in block.array(direct.OwnHeader.bodies, *of_direct)
        ]
    rows = block.array(Header.bodies, int(block.header.body_count), at.BODY_WORDS)
    return [int(row[at.Body.item]) for row in rows]


def _identifier(name: str) -> str:
    """A cable type's name in FMI's structured names: quoted unless it is an identifier."""
    if re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name):
        return name
    return "'" + re.sub(r"['\\]", "_", name) + "'"
