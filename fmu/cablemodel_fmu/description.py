"""``modelDescription.xml`` of an FMU (FMI 2.0.4, co-simulation)."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Sequence

from cablemodel_fmu.signals import Signal

MODEL_IDENTIFIER = "cablemodel"

# Units and their exponents of kg, m, s, rad.
UNITS = {
    "N": (1, 1, -2, 0),
    "N.m": (1, 2, -2, 0),
    "N/m": (1, 0, -2, 0),
    "m": (0, 1, 0, 0),
    "m2": (0, 2, 0, 0),
    "m/s": (0, 1, -1, 0),
    "1/m": (0, -1, 0, 0),
    "s": (0, 0, 1, 0),
    "rad": (0, 0, 0, 1),
    "rad/s": (0, 0, -1, 1),
    "1": (0, 0, 0, 0),
}

# What tools may show them in: a value in it is this factor times the value.
DISPLAY_UNITS = {
    "N": {"kN": 1e-3},
    "N.m": {"kN.m": 1e-3},
    "m/s": {"kn": 3600.0 / 1852.0},
    "m": {"km": 1e-3},
    "rad": {"deg": 180.0 / math.pi},
    "rad/s": {"deg/s": 180.0 / math.pi},
}

LARGE = {"N": ("kN", 1e4), "N.m": ("kN.m", 1e4)}
"""Display unit of what is usually larger than this."""

LOG_CATEGORIES = {
    "logStatusError": "refused calls",
    "logStatusFatal": "failures after which the instance is of no use (there are none)",
    "logStatusWarning": "warnings",
    "logStatusDiscard": "steps that could not be made, and why",
    "logEvents": "instantiation, initialization, termination",
    "logAll": "everything",
}

_START: dict[str, Callable[[float], str]] = {
    "Real": repr,
    "Boolean": lambda value: "true" if value else "false",
    "Enumeration": lambda value: str(int(value)),
}

VESSEL_INPUT = (
    ("velocity", "its velocity, reached at the end of each step"),
    ("position", "its position, at the mean velocity of each step"),
    ("position and velocity", "both: the cubic that meets them"),
)


INPUT_TIMING = (
    ("end", "a value is the one reached at the end of the step"),
    ("start", "a value holds at the start of the step, and goes on as in the step before"),
)

ENUMERATIONS = {"VesselInput": VESSEL_INPUT, "InputTiming": INPUT_TIMING}


def model_description(
    *,
    name: str,
    guid: str,
    description: str,
    version: str,
    signals: Sequence[Signal],
    step: float,
    stop: float,
    tolerance: float,
    date: str,
    author: str = "",
    derivatives: bool = True,
) -> bytes:
    """The XML file. Signals in the order in which tools show them.

    date: of the export, ISO 8601 in UTC. derivatives: whether forces have them, over time and by
    the motion of the tow point.
    """
    root = ElementTree.Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": name,
            "guid": guid,
            "description": description,
            "version": version,
            **({"author": author} if author else {}),
            "generationTool": f"cablemodel {version}",
            "generationDateAndTime": date,
            "variableNamingConvention": "structured",
            "numberOfEventIndicators": "0",
            "license": "Apache-2.0",
        },
    )
    ElementTree.SubElement(
        root,
        "CoSimulation",
        {
            "modelIdentifier": MODEL_IDENTIFIER,
            "needsExecutionTool": "false",
            "canHandleVariableCommunicationStepSize": "true",
            "canInterpolateInputs": "true",
            "maxOutputDerivativeOrder": "1" if derivatives else "0",
            "canRunAsynchronuously": "false",
            "canBeInstantiatedOnlyOncePerProcess": "false",
            "canNotUseMemoryManagementFunctions": "true",
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
            "providesDirectionalDerivative": "true" if derivatives else "false",
        },
    )
    _units(root, {signal.unit or "1" for signal in signals if signal.kind == "Real"})
    types = ElementTree.SubElement(root, "TypeDefinitions")
    for type_name, items in ENUMERATIONS.items():
        simple = ElementTree.SubElement(types, "SimpleType", {"name": type_name})
        enumeration = ElementTree.SubElement(simple, "Enumeration")
        for value, (word, meaning) in enumerate(items, start=1):
            attributes = {"name": word, "value": str(value), "description": meaning}
            ElementTree.SubElement(enumeration, "Item", attributes)
    logs = ElementTree.SubElement(root, "LogCategories")
    for category, meaning in LOG_CATEGORIES.items():
        ElementTree.SubElement(logs, "Category", {"name": category, "description": meaning})
    ElementTree.SubElement(
        root,
        "DefaultExperiment",
        {
            "startTime": "0",
            "stopTime": repr(stop),
            "stepSize": repr(step),
            "tolerance": repr(tolerance),
        },
    )
    variables = ElementTree.SubElement(root, "ModelVariables")
    for signal in signals:
        _variable(variables, signal)
    _structure(root, signals)
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"


def _units(root: ElementTree.Element, used: set[str]) -> None:
    definitions = ElementTree.SubElement(root, "UnitDefinitions")
    for unit, exponents in UNITS.items():
        if unit in used:
            element = ElementTree.SubElement(definitions, "Unit", {"name": unit})
            pairs = zip(("kg", "m", "s", "rad"), exponents, strict=True)
            base = {letter: str(power) for letter, power in pairs if power}
            ElementTree.SubElement(element, "BaseUnit", base)
            for name, factor in DISPLAY_UNITS.get(unit, {}).items():
                attributes = {"name": name, "factor": repr(factor)}
                ElementTree.SubElement(element, "DisplayUnit", attributes)


def _variable(parent: ElementTree.Element, signal: Signal) -> None:
    element = ElementTree.SubElement(
        parent,
        "ScalarVariable",
        {
            "name": signal.name,
            "valueReference": str(signal.reference),
            "description": signal.description,
            "causality": signal.causality,
            "variability": signal.variability,
        },
    )
    if signal.causality == "output":
        element.set("initial", "calculated")
    elif signal.causality == "parameter":
        element.set("initial", "exact")
    attributes: dict[str, str] = {}
    if signal.kind == "Enumeration":
        most = str(len(ENUMERATIONS[signal.type]))
        attributes = {"declaredType": signal.type, "min": "1", "max": most}
    elif signal.kind == "Real":
        attributes = {"unit": signal.unit or "1"}
        shown = display_unit(signal)
        if shown:
            attributes["displayUnit"] = shown
        if signal.nominal is not None:
            attributes["nominal"] = repr(signal.nominal)
        if signal.minimum is not None:
            attributes["min"] = repr(signal.minimum)
        if signal.maximum is not None:
            attributes["max"] = repr(signal.maximum)
    if signal.start is not None:
        attributes["start"] = _START[signal.kind](signal.start)
    ElementTree.SubElement(element, signal.kind, attributes)


def display_unit(signal: Signal) -> str:
    """What tools show a variable in, where that is not its unit: knots for what moves the vessel
    and the water, kilonewtons for large forces."""
    motion = ("vessel.velocity", "current.velocity")
    of_parts = (".velocity_input[", ".start_velocity[")
    if signal.name.startswith(motion) or any(word in signal.name for word in of_parts):
        return "kn"
    if signal.unit in ("rad", "rad/s"):
        return "deg" + signal.unit.removeprefix("rad")
    name, least = LARGE.get(signal.unit, ("", math.inf))
    return name if signal.nominal is not None and signal.nominal >= least else ""


def _structure(root: ElementTree.Element, signals: Sequence[Signal]) -> None:
    """An output depends on no input: inputs act through the next step. At the start it depends on
    the coefficients and lengths, for which the static equilibrium is found."""
    structure = ElementTree.SubElement(root, "ModelStructure")
    numbers = [
        n
        for n, signal in enumerate(signals, start=1)
        if signal.causality == "parameter" and signal.kind == "Real"
    ]
    at_start = {
        "dependencies": " ".join(str(n) for n in numbers),
        "dependenciesKind": " ".join("dependent" for _ in numbers),
    }
    always = {"dependencies": "", "dependenciesKind": ""}
    for list_name, attributes in (("Outputs", always), ("InitialUnknowns", at_start)):
        element = ElementTree.SubElement(structure, list_name)
        for n, signal in enumerate(signals, start=1):
            if signal.causality == "output":
                ElementTree.SubElement(element, "Unknown", {"index": str(n), **attributes})
