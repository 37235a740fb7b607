"""Messages of a system's outputs: of lines, bodies and vessels by their names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from cablemodel import variables

if TYPE_CHECKING:
    from cablemodel.log.messages import Messages
    from cablemodel.model import CableState
    from cablemodel.systems import SystemModel


def encode_parts(
    messages: Messages,
    topics: Iterable[str],
    stamp: int,
    model: SystemModel,
    shapes: Mapping[str, CableState],
    labels: tuple[str, ...],
) -> list[tuple[str, bytes]]:
    """Messages of output topics (resolved) at a stamp [ns], and of ``variables.OUTPUTS_TOPIC``.

    shapes: of the model. labels: ``variables.output_labels`` of its scene.
    """
    wanted = set(topics)
    found: list[tuple[str, bytes]] = []
    outputs: dict[str, Any] = {}
    over_time = False
    parts = model.motions
    for row in variables.outputs_of(model.scene):
        topic = row.resolved_topic
        if topic not in wanted:
            continue
        wanted.discard(topic)  # several rows may stand in one message
        name = row.python.partition(".")[0]
        if row.message == variables.CLOUD:
            found.append((topic, messages.cloud(stamp, shapes[name])))
            continue
        if not over_time:
            outputs, over_time = model.outputs(shapes), True
        if row.message == variables.FLOAT64:
            data = messages.float64(float(outputs[row.python]))
        elif row.message == variables.ODOMETRY:
            data = messages.part_odometry(stamp, name, parts[name])
        else:
            wrench = np.concatenate([outputs[f"{name}.force"], outputs[f"{name}.moment"]])
            data = messages.part_wrench(stamp, name, parts[name].axes, wrench)
        found.append((topic, data))
    if over_time:
        values = [np.array([model.time])]
        values += [
            np.atleast_1d(outputs[row.python])
            for row in variables.outputs_of(model.scene)
            if row.message != variables.CLOUD
        ]
        topic = variables.resolved(variables.OUTPUTS_TOPIC)
        found.append((topic, messages.row(labels, np.concatenate(values))))
    return found
