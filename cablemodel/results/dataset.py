"""A run as an xarray dataset: everything in it, with units and descriptions."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from cablemodel import variables
from cablemodel.extras import require
from cablemodel.results.columns import STATE_FIELDS, input_fields

if TYPE_CHECKING:
    import xarray

    from cablemodel.results.run import Run


def dataset(run: Run) -> xarray.Dataset:
    """Outputs, states and applied inputs of a run, with ``units`` and ``long_name``.

    Dimensions: ``time``; ``state_time`` and ``node`` of exact states; ``step_time`` (the end of
    each step) of applied inputs; ``axis`` (x, y, z); ``body``. Of a system each line has nodes of
    its own: ``port_state_tension`` is over ``state_time`` and ``port_node``.

    Raises:
        CableModelError: xarray is not installed.
    """
    require("xarray", extra="export", what="to_xarray")
    import xarray

    data: dict[str, Any] = {}
    for name in run.names:
        variable = run.variable(name)
        dimensions = ["time"]
        dimensions += ["body" if length == "bodies" else "axis" for length in variable.shape]
        attributes = {"units": variable.unit or "1", "long_name": variable.quantity}
        data[name.replace(".", "_")] = (dimensions, run[name], attributes)
    derived = [(name, 1) for name in variables.DERIVED]
    for line, states in run.shapes.items():
        before, node = (f"{line}_state_", f"{line}_node") if line else ("", "node")
        for name, components in (*variables.STATE_FIELDS, *derived):
            unit, quantity = STATE_FIELDS[name]
            dimensions = ["state_time", node, *(["axis"] if components == 3 else [])]
            attributes = {"units": unit, "long_name": f"{line}: {quantity}" if line else quantity}
            data[before + name] = (dimensions, getattr(states, name), attributes)
    inputs = run.applied_inputs
    for name, (unit, quantity, labels) in input_fields(run.scene).items():
        if name == "time":
            continue  # the coordinate
        columns = [inputs[label] for label in labels]
        values: Any = np.stack(columns, axis=1) if len(labels) == 3 else columns[0]
        if name.endswith("_given"):
            values = values > 0.5
        dimensions = ["step_time", *(["axis"] if len(labels) == 3 else [])]
        attributes = {"units": unit or "1", "long_name": quantity}
        data[f"applied_{name.replace('.', '_')}"] = (dimensions, values, attributes)
    times = next(iter(run.shapes.values())).time
    coordinates = {
        "time": ("time", run.time, {"units": "s", "long_name": "time of outputs"}),
        "state_time": (
            "state_time", times, {"units": "s", "long_name": "time of exact states"},
        ),
        "step_time": (
            "step_time", inputs["time"], {"units": "s", "long_name": "end of the step"},
        ),
        "axis": ("axis", ["x", "y", "z"], {"long_name": "east, north, up"}),
    }  # fmt: skip
    return xarray.Dataset(data, coords=coordinates, attrs=_attributes(run))


def _attributes(run: Run) -> dict[str, str]:
    """What was run, by what, and how it went."""
    return {
        "title": run.scene.title or "",
        "scene": run.scene.to_yaml(),
        "complete": "yes" if run.complete else f"no: {run.reason}",
        "statistics": json.dumps(run.statistics, default=str),
        "provenance": json.dumps(run.metadata),
    }
