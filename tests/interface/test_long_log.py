"""A long log stays small, and opens quickly: an hour at 20 Hz of a cable of 64 nodes."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from cablemodel import variables
from cablemodel.results.cadence import Cadence
from cablemodel.results.log.reader import LogFile
from cablemodel.results.log.writer import LogWriter
from cablemodel.scene import Scene

OUTPUTS = 72_001
NODES = 64


def noisy(model: Any, random: np.random.Generator) -> list[Any]:
    """States with no two digits the same: what compresses least."""
    state = model.sample(np.linspace(0.0, model.line_length, NODES))
    found = []
    for _ in range(200):
        fields = {name: getattr(state, name) for name, _ in variables.STATE_FIELDS}
        for name in ("position", "tangent", "velocity", "tension", "curvature", "bending_moment"):
            fields[name] = fields[name] * random.uniform(0.999, 1.001, fields[name].shape)
        found.append(SimpleNamespace(**fields))
    return found


def write_an_hour(path: Path, scene: Scene, source: Any) -> None:
    source.step(0.05)
    random = np.random.default_rng(1)
    states = noisy(source, random)
    cadence = Cadence.of(OUTPUTS, NODES, 0.05)
    names = [row.python for row in variables.outputs_of(scene) if "." not in row.python]
    fields = {name: getattr(source, name) for name in names}
    model: Any = SimpleNamespace(**fields, time=0.0, scene=scene)
    model.numbers = lambda: model
    top_force = model.top_force
    with LogWriter(path, scene, epoch=0) as writer:
        for k, factor in enumerate(random.uniform(0.9, 1.1, OUTPUTS).tolist()):
            model.time = 0.05 * k
            model.top_tension, model.top_force = factor, factor * top_force
            model.tip_position = model.tip_velocity = model.top_force
            model.tension_max = model.tension_min = 2.0 * factor
            model.applied_inputs = {"vessel_velocity": model.top_force}
            if k:
                writer.write_step(model, 0.05)
            writer.write_outputs(
                model,
                states[k % len(states)],
                exact_state=k % cadence.states == 0,
                shape=k % cadence.shapes == 0,
            )
        writer.close()


@pytest.mark.slow
def test_an_hour_at_20_hz(simple_scene: Scene, swinging_cable: Any, tmp_path: Path) -> None:
    """At most 120 MB; no shape or state is read for its top tension."""
    hour = tmp_path / "hour.mcap"
    write_an_hour(hour, simple_scene, swinging_cable(simple_scene))
    assert hour.stat().st_size <= 120e6
    run = cm.open_run(hour)
    tension, at = run.top_tension, run.time
    log: LogFile = run._source.log
    read = [chunk for chunk in log._chunks if chunk.content is not None]
    state = next(c.id for c in log._channels.values() if c.topic == "/cable/state")
    nodes = next(c.id for c in log._channels.values() if c.topic == "/cable/nodes")
    assert read
    assert not any({state, nodes} & set(chunk.indexes) for chunk in read)
    assert np.array_equal(at, 0.05 * np.arange(OUTPUTS))
    assert len(tension) == OUTPUTS
    assert len(run.states) == 3601
    assert np.array_equal(run.states.time, at[::20])
