"""Vessels and a scene's cables as a system of FMUs (SSP 1.0): a start for one's own.

A vessel is c/vessel/vessel.c: a mass with thrust along x and quadratic resistance. Its velocity or
position (`vessel_input` of the export) moves the tow point, or a vessel of the scene; the force of
what hangs there pulls at it.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cablemodel.scene import Scene
from cablemodel.scene.motion import VesselMotion
from cablemodel.systems.scene import SystemScene
from cablemodel_fmu.archive import write_archive

VESSEL = "vessel"
VESSEL_GUID = "{5b0a3c5e-6f0e-4e0e-9d0c-2c7c6f0f5a11}"
MOVING = {
    "velocity": ("velocity",), "position": ("position",),
    "position and velocity": ("velocity", "position"),
}  # fmt: skip
"""Outputs of a vessel that are connected, by what `vessel.input` begins as."""
_OUTPUTS = {"velocity": "m/s", "position": "m"}
_PARAMETERS = {
    "mass": (5000.0, "kg", "mass"),
    "thrust": (300.0, "N", "thrust along x"),
    "resistance": (200.0, "kg/m", "resistance over the square of the speed"),
}
_AXES = ("x (east)", "y (north)", "z (up)")
_SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
_SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
_SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"


Connection = tuple[tuple[str, str], tuple[str, str]]
"""(component, output), (component, input)."""


@dataclass(frozen=True)
class Craft:
    """A vessel of an exported system."""

    name: str
    """Of its component."""
    force: str
    """Output of the cable's FMU that pulls at it."""
    inputs: tuple[tuple[str, str], ...]
    """Its outputs (velocity, position), and the inputs of the cable's FMU that they move."""
    motion: VesselMotion
    """Of the scene: it starts with that."""


def crafts(scene: Scene | SystemScene, vessel_input: str = "velocity") -> list[Craft]:
    """One for a tow point, or one for each vessel of a system; vessel_input: what moves them."""
    moving = MOVING[vessel_input]
    if isinstance(scene, Scene):
        inputs = tuple((name, f"vessel.{name}") for name in moving)
        return [Craft(VESSEL, "force.top", inputs, scene.motion())]
    return [
        Craft(
            f"{VESSEL}_{name}",
            f"{name}.force",
            tuple((output, f"{name}.{output}_input") for output in moving),
            vessel.motion(),
        )
        for name, vessel in scene.vessels.items()
    ]


def connections(vessels: Sequence[Craft]) -> list[Connection]:
    """What is connected of vessels and the cable."""
    return [
        pair
        for craft in vessels
        for i in (1, 2, 3)
        for pair in (
            *(
                ((craft.name, f"{output}[{i}]"), ("cable", f"{moved}[{i}]"))
                for output, moved in craft.inputs
            ),
            (("cable", f"{craft.force}[{i}]"), (craft.name, f"force[{i}]")),
        )
    ]


def vessel_fmu(target: Path, libraries: Mapping[str, bytes]) -> Path:
    """Write the vessel's FMU. libraries: paths in it, binaries/linux64/vessel.so, to contents."""
    return write_archive(target, {"modelDescription.xml": vessel_description(), **libraries})


def vessel_description() -> bytes:
    """modelDescription.xml of the vessel; references as in vessel.c."""
    root = ElementTree.Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": VESSEL,
            "guid": VESSEL_GUID,
            "description": "A vessel with mass, thrust along x and quadratic resistance",
            "variableNamingConvention": "structured",
        },
    )
    capabilities = {"canHandleVariableCommunicationStepSize": "true"}
    capabilities["canNotUseMemoryManagementFunctions"] = "true"
    ElementTree.SubElement(root, "CoSimulation", {"modelIdentifier": VESSEL, **capabilities})
    units = ElementTree.SubElement(root, "UnitDefinitions")
    for unit, base in (
        ("N", {"kg": "1", "m": "1", "s": "-2"}), ("m", {"m": "1"}),
        ("m/s", {"m": "1", "s": "-1"}), ("kg", {"kg": "1"}), ("kg/m", {"kg": "1", "m": "-1"}),
    ):  # fmt: skip
        element = ElementTree.SubElement(units, "Unit", {"name": unit})
        ElementTree.SubElement(element, "BaseUnit", base)
    ElementTree.SubElement(root, "DefaultExperiment", {"startTime": "0", "stepSize": "0.1"})
    variables = ElementTree.SubElement(root, "ModelVariables")
    outputs = []

    def add(name: str, causality: str, unit: str, words: str, start: float | None) -> None:
        variable = ElementTree.SubElement(
            variables,
            "ScalarVariable",
            {
                "name": name,
                "valueReference": str(len(variables)),
                "description": words,
                "causality": causality,
                "variability": "fixed" if causality == "parameter" else "continuous",
            },
        )
        value = {} if start is None else {"start": repr(start)}
        ElementTree.SubElement(variable, "Real", {"unit": unit, **value})
        if causality == "output":
            outputs.append(str(len(variables)))

    for i, axis in enumerate(_AXES, start=1):
        add(f"force[{i}]", "input", "N", f"force of a cable on the vessel, {axis}", 0.0)
    for name, unit in _OUTPUTS.items():
        for i, axis in enumerate(_AXES, start=1):
            add(f"{name}[{i}]", "output", unit, f"{name}, {axis}", None)
    for name, (value, unit, words) in _PARAMETERS.items():
        add(name, "parameter", unit, words, value)
    for name, unit in _OUTPUTS.items():
        for i, axis in enumerate(_AXES, start=1):
            add(f"start_{name}[{i}]", "parameter", unit, f"{name} at the start, {axis}", 0.0)
    structure = ElementTree.SubElement(root, "ModelStructure")
    for part in ("Outputs", "InitialUnknowns"):
        element = ElementTree.SubElement(structure, part)
        for index in outputs:
            ElementTree.SubElement(element, "Unknown", {"index": index})
    return _text(root)


def export_system(
    scene: Scene | SystemScene,
    cable: Path,
    target: Path,
    libraries: Mapping[str, bytes],
    vessel_input: str = "velocity",
) -> Path:
    """Write a system of vessels and the cable of an FMU.

    Args:
        scene: what the FMU was exported from: vessels start with its motion.
        cable: the FMU.
        libraries: of the vessel, paths in its FMU to contents.
        vessel_input: which inputs of the FMU move its vessels, as it was exported.
    """
    vessel = target.with_name(target.name + ".vessel")
    try:
        vessel_fmu(vessel, libraries)
        files = {
            "SystemStructure.ssd": structure(scene, vessel_input),
            "resources/cable.fmu": cable.read_bytes(),
            "resources/vessel.fmu": vessel.read_bytes(),
        }
    finally:
        vessel.unlink(missing_ok=True)
    return write_archive(target, files)


def structure(scene: Scene | SystemScene, vessel_input: str = "velocity") -> bytes:
    """SystemStructure.ssd: the components, their connectors, what is connected."""
    for prefix, name in (("ssd", _SSD), ("ssc", _SSC), ("ssv", _SSV)):
        ElementTree.register_namespace(prefix, name)
    title = scene.title or "Cable"
    root = ElementTree.Element(f"{{{_SSD}}}SystemStructureDescription",
                               {"version": "1.0", "name": title})  # fmt: skip
    system = ElementTree.SubElement(root, f"{{{_SSD}}}System", {"name": "tow"})
    elements = ElementTree.SubElement(system, f"{{{_SSD}}}Elements")
    vessels = crafts(scene, vessel_input)
    pairs = connections(vessels)
    for craft in vessels:
        _component(elements, craft.name, VESSEL, pairs, _values(craft))
    _component(elements, "cable", "cable", pairs, {})
    connected = ElementTree.SubElement(system, f"{{{_SSD}}}Connections")
    for (start, output), (end, reached) in pairs:
        ElementTree.SubElement(
            connected,
            f"{{{_SSD}}}Connection",
            {
                "startElement": start,
                "startConnector": output,
                "endElement": end,
                "endConnector": reached,
            },
        )
    experiment = {"startTime": "0", "stopTime": repr(scene.run.duration)}
    ElementTree.SubElement(root, f"{{{_SSD}}}DefaultExperiment", experiment)
    return _text(root)


def _values(craft: Craft) -> dict[str, float]:
    """Of a vessel's parameters."""
    position, velocity, _ = craft.motion.evaluate(0.0)
    values = {name: value for name, (value, _, _) in _PARAMETERS.items()}
    for name, vector in (("velocity", velocity), ("position", position)):
        values |= {f"start_{name}[{i}]": float(x) for i, x in enumerate(vector, start=1)}
    return values


def _component(
    parent: ElementTree.Element,
    name: str,
    fmu: str,
    pairs: Sequence[Connection],
    values: Mapping[str, float],
) -> None:
    component = ElementTree.SubElement(
        parent,
        f"{{{_SSD}}}Component",
        {"name": name, "type": "application/x-fmu-sharedlibrary",
         "source": f"resources/{fmu}.fmu"},
    )  # fmt: skip
    connectors = ElementTree.SubElement(component, f"{{{_SSD}}}Connectors")
    ends = (end for start, reached in pairs for end in ((start, "output"), (reached, "input")))
    for (owner, connector), kind in ends:
        if owner == name:
            element = ElementTree.SubElement(
                connectors, f"{{{_SSD}}}Connector", {"name": connector, "kind": kind}
            )
            ElementTree.SubElement(element, f"{{{_SSC}}}Real")
    if values:
        bindings = ElementTree.SubElement(component, f"{{{_SSD}}}ParameterBindings")
        binding = ElementTree.SubElement(bindings, f"{{{_SSD}}}ParameterBinding")
        inline = ElementTree.SubElement(binding, f"{{{_SSD}}}ParameterValues")
        attributes = {"version": "1.0", "name": f"of the {name}"}
        chosen = ElementTree.SubElement(inline, f"{{{_SSV}}}ParameterSet", attributes)
        parameters = ElementTree.SubElement(chosen, f"{{{_SSV}}}Parameters")
        for parameter, value in values.items():
            row = ElementTree.SubElement(parameters, f"{{{_SSV}}}Parameter", {"name": parameter})
            ElementTree.SubElement(row, f"{{{_SSV}}}Real", {"value": repr(value)})


def _text(root: ElementTree.Element) -> bytes:
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"
