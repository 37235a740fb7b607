"""Messages of a system's outputs: of lines, bodies and vessels by their names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from cablemodel import variables

if TYPE_CHECKING:
    from cablemodel.model import CableState
    from cablemodel.results.log.messages import Messages
    from cablemodel.systems import SystemModel


def encode_parts(
    messages: Messages,
    topics: Iterable[str],
    stamp: int,
    model: SystemModel,
    shapes: Mapping[str, CableState],
    labels: tuple[str, ...],
) -> list[tuple[str, bytes]]:
    """Messages of output topics (the table's or resolved names, with that of all outputs over
    time, ``variables.OUTPUTS_TOPIC``) at a stamp [ns].

    shapes: of the model. labels: ``variables.output_labels`` of its scene.
    """
    wanted = {variables.resolved(topic): topic for topic in topics}
    everything = wanted.pop(variables.resolved(variables.OUTPUTS_TOPIC), None)
    rows = [row for row in variables.outputs_of(model.scene) if row.message != variables.CLOUD]
    over_time = everything or any(row.resolved_topic in wanted for row in rows)
    outputs: dict[str, Any] = model.outputs(shapes) if over_time else {}
    parts = model.motions if over_time else {}
    found: list[tuple[str, bytes]] = []
    for row in variables.outputs_of(model.scene):
        topic = wanted.pop(row.resolved_topic, None)  # several rows may stand in one message
        if topic is None:
            continue
        name = row.python.partition(".")[0]
        if row.message == variables.CLOUD:
            data = messages.cloud(stamp, shapes[name])
        elif row.message == variables.FLOAT64:
            data = messages.float64(float(outputs[row.python]))
        elif row.message == variables.ARRAY:
            slack = [float(outputs[f"{name}.slack_{key}"]) for key in variables.SLACK_LABELS]
            data = messages.row(variables.SLACK_LABELS, np.array(slack))
        elif row.message == variables.ODOMETRY:
            data = messages.part_odometry(stamp, name, parts[name])
        elif row.message == variables.POINT:
            data = messages.point(stamp, outputs[row.python])
        elif name in shapes:
            data = messages.wrench(stamp, outputs[row.python])
        else:
            wrench = np.concatenate([outputs[f"{name}.force"], outputs[f"{name}.moment"]])
            data = messages.part_wrench(stamp, name, parts[name].axes, wrench)
        found.append((topic, data))
    if everything:
        values = [np.array([model.time]), *(np.atleast_1d(outputs[row.python]) for row in rows)]
        found.append((everything, messages.row(labels, np.concatenate(values))))
    return found
