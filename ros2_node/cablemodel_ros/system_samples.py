"""What a step of a system publishes, as the bytes that go out and into the log: see `samples`."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

import numpy as np

from cablemodel import variables
from cablemodel.results.log.messages import Messages
from cablemodel.results.log.parts import encode_parts
from cablemodel_ros.samples import Message, topics
from cablemodel_ros.settings import Settings
from cablemodel_ros.times import Stamp

if TYPE_CHECKING:
    from cablemodel import SystemModel, SystemScene


class SystemSampler:
    """Makes the messages of a system (not thread-safe).

    Args:
        scene: scene of the model.
        settings: how many points ``~/LINE/nodes`` has.
    """

    def __init__(self, scene: SystemScene, settings: Settings) -> None:
        self._messages = Messages()
        self._fractions = np.linspace(0.0, 1.0, settings.stations)
        self._topics = (*topics(scene), variables.OUTPUTS_TOPIC)
        self._inputs, self._outputs = variables.input_labels(scene), variables.output_labels(scene)
        self._states = variables.state_topics_of(scene)
        clouds = {
            row.topic: row for row in variables.LINE_OUTPUTS if row.message == variables.CLOUD
        }
        self._clouds = {
            variables.topic_of_part(topic, line): line for topic in clouds for line in scene.lines
        }

    def step(self, model: SystemModel, step: float, given: dict[str, Any]) -> Message:
        """The exact record of what a step applied, ``~/applied_inputs``."""
        row = self._messages.row(self._inputs, model.input_row(step, given))
        return variables.APPLIED_INPUTS_TOPIC, row

    def outputs(
        self, model: SystemModel, stamp: Stamp, wanted: Collection[str] | None = None
    ) -> list[Message]:
        """All outputs of the table, with ``~/LINE/nodes`` at the stations; wanted: topics, None:
        all."""
        names = [topic for topic in self._topics if wanted is None or topic in wanted]
        found: list[Message] = []
        for topic in names:
            if topic in self._clouds:
                line = model.lines[self._clouds[topic]]
                state = line.sample(self._fractions * line.length)
                found.append((topic, self._messages.cloud(stamp.ns, state)))
        over_time = [topic for topic in names if topic not in self._clouds]
        if over_time:
            found += self._encoded(model, stamp, over_time, model.shapes())
        return found

    def record(self, model: SystemModel, stamp: Stamp) -> list[Message]:
        """All outputs with ``~/LINE/nodes`` at the model's own nodes, and the exact states: what
        ``cablemodel run`` logs at an output time."""
        shapes = model.shapes()
        exact = [
            (self._states[name], self._messages.state(model.time, state, name))
            for name, state in shapes.items()
        ]
        return [*self._encoded(model, stamp, self._topics, shapes), *exact]

    def _encoded(
        self, model: SystemModel, stamp: Stamp, names: Collection[str], shapes: dict[str, Any]
    ) -> list[Message]:
        return encode_parts(self._messages, names, stamp.ns, model, shapes, self._outputs)
