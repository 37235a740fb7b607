"""The log as others read it: mcap, rosbags, mcap-ros2-support; values exact."""

import cProfile
import io
import os
import signal
import subprocess
import sys
import textwrap
import time
import zlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap.records import Chunk, MessageIndex
from mcap.stream_reader import StreamReader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

import cablemodel as cm
from cablemodel import variables
from cablemodel.results.log import writer as writer_module
from cablemodel.results.log.writer import LogWriter
from cablemodel.scene import Scene, load_scene

EPOCH = 1_700_000_000_000_000_000
STORE = get_typestore(Stores.ROS2_JAZZY)


@pytest.fixture
def log(full_scene: Scene, swinging_cable: Any, tmp_path: Path) -> Path:
    """Three steps of a scene that has everything, with outputs at 0, 0.3 and 0.6 s."""
    path = tmp_path / "run.mcap"
    model = swinging_cable(full_scene)
    with LogWriter(path, full_scene, epoch=EPOCH) as writer:
        writer.write_outputs(model)
        for _ in range(2):
            model.step(0.3, vessel_velocity=(0.1, 1 / 3, 0.0))
            writer.write_step(model, 0.3, given={"vessel_velocity"})
            writer.write_outputs(model)
        writer.close(model.statistics)
    return path


def decoded(path: Path, topic: str) -> list[Any]:
    """Messages of a topic by mcap's reader and rosbags' deserialiser."""
    with path.open("rb") as file:
        found = make_reader(file, validate_crcs=True).iter_messages([topic])
        return [STORE.deserialize_cdr(m.data, schema.name) for schema, _, m in found if schema]


def test_the_file_begins_with_the_scene_and_the_versions(log: Path) -> None:
    with log.open("rb") as file:
        records = StreamReader(file, emit_chunks=True).records
        kinds = [type(record).__name__ for record in records]
    assert kinds[:3] == ["Header", "Attachment", "Metadata"]
    with log.open("rb") as file:
        reader = make_reader(file)
        assert reader.get_header().profile == "ros2"
        attachment = next(reader.iter_attachments())
        assert attachment.name == "scene.yaml"
        metadata = next(reader.iter_metadata()).metadata
    for key in ("cablemodel", "numpy", "numba", "python", "platform", "cpu", "solver"):
        assert metadata[key]
    assert metadata["schema_version"] == "1"
    assert metadata["epoch_ns"] == str(EPOCH)


def test_the_scene_in_the_file_is_the_scene_of_the_run(log: Path, full_scene: Scene) -> None:
    with log.open("rb") as file:
        text = next(make_reader(file).iter_attachments()).data.decode()
    assert load_scene(text) == full_scene


def test_channels_are_those_of_the_table(log: Path, full_scene: Scene) -> None:
    with log.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    found = {c.topic: summary.schemas[c.schema_id].name for c in summary.channels.values()}
    expected = variables.topics_of(full_scene)
    own = {"/cable/applied_inputs": variables.ARRAY, "/cable/state": variables.ARRAY}
    assert found == {**expected, **own}
    assert len(expected) == len({row.topic for row in variables.OUTPUTS})


def test_channels_say_what_rosbag2_asks_for(log: Path) -> None:
    with log.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    for channel in summary.channels.values():
        schema = summary.schemas[channel.schema_id]
        assert channel.message_encoding == "cdr"
        assert schema.encoding == "ros2msg"
        assert channel.metadata["topic_type_hash"] == STORE.hash_rihs01(schema.name)
        (qos,) = yaml.safe_load(channel.metadata["offered_qos_profiles"])
        assert qos["reliability"] == "reliable"
        assert qos["history"] == "keep_last"


def test_the_type_hash_of_a_point_cloud_is_that_of_ros2(log: Path) -> None:
    # As printed by `ros2 topic info --verbose` on Jazzy.
    digest = "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"
    with log.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    hashes = {c.topic: c.metadata["topic_type_hash"] for c in summary.channels.values()}
    assert hashes["/cable/nodes"] == digest


def test_float_topics_are_exact(log: Path, full_scene: Scene, swinging_cable: Any) -> None:
    model = swinging_cable(full_scene)
    model.step(0.3)
    for row in variables.OUTPUTS:
        if row.message == variables.FLOAT64:
            messages = decoded(log, row.resolved_topic)
            assert len(messages) == 3
            assert messages[1].data == getattr(model, row.python), row.python


def test_what_is_said_of_being_slack_is_exact(
    log: Path, full_scene: Scene, swinging_cable: Any
) -> None:
    model = swinging_cable(full_scene)
    run, before, after = cm.open_run(log), *decoded(log, "/cable/slack")[1:3]
    labels = before.layout.dim[0].label.split(",")
    assert labels == ["time", "longest", "since", "start", "end"]
    assert np.isnan(before.data[2:]).all()
    model.step(0.6)
    for label, value in zip(labels, after.data, strict=True):
        assert value == getattr(model, f"slack_{label}") == run[f"slack_{label}"][2]


def test_vectors_and_stamps_are_exact(log: Path, full_scene: Scene, swinging_cable: Any) -> None:
    model = swinging_cable(full_scene)
    model.step(0.3)

    def xyz(vector: Any) -> list[float]:
        return [vector.x, vector.y, vector.z]

    wrench = decoded(log, "/cable/top_wrench")[1]
    assert xyz(wrench.wrench.force) == model.top_force.tolist()
    assert xyz(wrench.wrench.torque) == model.top_moment.tolist()
    assert wrench.header.frame_id == "tow_point"
    assert (wrench.header.stamp.sec, wrench.header.stamp.nanosec) == (1_700_000_000, 300_000_000)
    end = decoded(log, "/cable/end_odom")[1]
    assert xyz(end.pose.pose.position) == model.tip_position.tolist()
    assert xyz(end.twist.twist.linear) == model.tip_velocity.tolist()
    assert end.pose.pose.orientation.w == 1.0
    assert not np.any(end.pose.covariance)
    assert not np.any(end.twist.covariance)
    assert xyz(decoded(log, "/cable/floor_force")[1].wrench.force) == model.floor_force.tolist()
    point = xyz(decoded(log, "/cable/touchdown")[1].point)
    assert np.array_equal(point, model.touchdown_position, equal_nan=True)
    poses = decoded(log, "/cable/bodies")[1].poses
    assert [xyz(pose.position) for pose in poses] == [b.position.tolist() for b in model.bodies]
    for pose, body in zip(poses, model.bodies, strict=True):
        q = pose.orientation
        turned = [
            1 - 2 * (q.y**2 + q.z**2), 2 * (q.x * q.y + q.z * q.w), 2 * (q.x * q.z - q.y * q.w)
        ]  # fmt: skip
        assert np.allclose(turned, body.direction, rtol=0, atol=1e-14)


def test_the_point_cloud_is_the_state_in_single_precision(
    log: Path, full_scene: Scene, swinging_cable: Any
) -> None:
    model = swinging_cable(full_scene)
    model.step(0.3)
    state = model.state()
    cloud = decoded(log, "/cable/nodes")[1]
    names = [field.name for field in cloud.fields]
    assert names == ["x", "y", "z", "tension", "curvature", "s"]
    assert [field.offset for field in cloud.fields] == [0, 4, 8, 12, 16, 20]
    assert (cloud.height, cloud.width, cloud.point_step) == (1, 9, 24)
    assert cloud.row_step == len(cloud.data) == 9 * 24
    values = cloud.data.view("<f4").reshape(9, 6)
    expected = np.column_stack([state.position, state.tension, state.curvature, state.s])
    assert np.array_equal(values, expected.astype(np.float32))
    assert cloud.is_dense
    assert not cloud.is_bigendian


def test_states_are_exact_and_labelled(log: Path, full_scene: Scene, swinging_cable: Any) -> None:
    model = swinging_cable(full_scene)
    model.step(0.3)
    state = model.state()
    message = decoded(log, "/cable/state")[1]
    labels = message.layout.dim[0].label.split(",")
    rows, nodes = (dimension.size for dimension in message.layout.dim)
    assert (rows, nodes) == (len(labels), 9)
    assert [dimension.stride for dimension in message.layout.dim] == [rows * nodes, nodes]
    assert message.data[0] == 0.3
    values = message.data[message.layout.data_offset :].reshape(rows, nodes)
    by_label = dict(zip(labels, values, strict=True))
    assert np.array_equal(by_label["position.z"], state.position[:, 2])
    assert np.array_equal(by_label["velocity.x"], state.velocity[:, 0])
    assert np.array_equal(by_label["bending_moment"], state.bending_moment)
    assert np.array_equal(by_label["on_floor"], state.on_floor)


def test_applied_inputs_are_exact_and_say_what_was_given(log: Path) -> None:
    messages = decoded(log, "/cable/applied_inputs")
    assert len(messages) == 2
    labels = messages[0].layout.dim[0].label.split(",")
    values = dict(zip(labels, messages[1].data.tolist(), strict=True))
    assert (values["time"], values["step"]) == (0.6, 0.3)
    assert values["vessel_velocity.y"] == 1 / 3
    assert values["vessel_velocity_given"] == 1.0
    assert values["payout_rate_given"] == 0.0
    assert values["payout_rate"] == 0.1
    assert np.isnan(values["current.x"])


def test_rosbags_opens_the_file_as_a_bag(log: Path, full_scene: Scene) -> None:
    with AnyReader([log]) as reader:
        assert {c.topic for c in reader.connections} >= set(variables.topics_of(full_scene))
        (top,) = [c for c in reader.connections if c.topic == "/cable/tension_top"]
        values = [reader.deserialize(raw, top.msgtype).data for _, _, raw in reader.messages([top])]
    assert np.array_equal(values, cm.open_run(log).top_tension)


def test_mcap_ros2_support_decodes_every_message(log: Path) -> None:
    from mcap_ros2 import decoder

    with log.open("rb") as file:
        reader = make_reader(file, decoder_factories=[decoder.DecoderFactory()])
        found = list(reader.iter_decoded_messages())
    count = len(variables.topics_of(cm.open_run(log).scene))
    assert len(found) == 3 * (count + 1) + 2
    tensions = [
        item.decoded_message.data for item in found if item.channel.topic == "/cable/tension_top"
    ]
    assert np.array_equal(tensions, cm.open_run(log).top_tension)


def test_messages_are_byte_for_byte_those_of_a_serialiser(log: Path) -> None:
    """Templates with numbers put in are what serialising a message object would have given."""
    topics = set()
    with log.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            decoded_message = STORE.deserialize_cdr(message.data, schema.name)
            assert bytes(STORE.serialize_cdr(decoded_message, schema.name)) == message.data
            topics.add(channel.topic)
    assert len(topics) == len(variables.topics_of(cm.open_run(log).scene)) + 2


def test_a_chunk_lasts_at_most_one_simulated_second(
    simple_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    path = tmp_path / "run.mcap"
    cm.simulate(simple_scene, log=path, model=swinging_cable(simple_scene))
    with path.open("rb") as file:
        chunks = [r for r in StreamReader(file, emit_chunks=True).records if isinstance(r, Chunk)]
    # Samples every 0.3 s: four fit into a second; values, shapes and states have their own chunks.
    assert len(chunks) == 3 * 9
    assert all(c.message_end_time - c.message_start_time < 1_000_000_000 for c in chunks)
    assert all(c.compression == "zstd" and c.uncompressed_crc != 0 for c in chunks)


def test_a_chunk_has_little_more_than_64_kilobytes(
    simple_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    path = tmp_path / "run.mcap"
    model = swinging_cable(simple_scene, nodes=200)
    with LogWriter(path, simple_scene) as writer:
        for _ in range(20):
            model.step(0.01)
            writer.write_outputs(model)
        writer.close()
    with path.open("rb") as file:
        chunks = [r for r in StreamReader(file, emit_chunks=True).records if isinstance(r, Chunk)]
    sample = 200 * (len(variables.STATE_LABELS) * 8 + 24) + 4000
    assert len(chunks) >= 4
    assert all(c.uncompressed_size < 64 * 1024 + sample for c in chunks)


def test_a_sample_is_in_the_file_after_a_second_by_the_clock(
    simple_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    path = tmp_path / "run.mcap"
    model = swinging_cable(simple_scene)
    with LogWriter(path, simple_scene) as writer:
        writer.write_outputs(model)
        assert len(cm.open_run(path).time) == 0
        deadline = time.monotonic() + 10.0
        while len(cm.open_run(path).time) == 0 and time.monotonic() < deadline:
            time.sleep(0.1)
        run = cm.open_run(path)
        assert run.time.tolist() == [0.0]
        assert not run.complete
        writer.close()


def test_a_killed_process_leaves_what_was_flushed(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    code = f"""
        import os, signal, sys
        sys.path.insert(0, {os.fspath(Path(__file__).parent)!r})
        from conftest import SIMPLE, SwingingCable
        from cablemodel.results.log.writer import LogWriter
        from cablemodel.scene import load_scene
        scene = load_scene(SIMPLE)
        model = SwingingCable(scene)
        writer = LogWriter({os.fspath(path)!r}, scene)
        for _ in range(35):
            model.step(0.1)
            writer.write_outputs(model)
        os.kill(os.getpid(), signal.SIGKILL)
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(code)], check=False)
    assert done.returncode == -signal.SIGKILL
    run = cm.open_run(path)
    assert not run.complete
    assert "end of the file is missing" in run.reason
    # 3.5 s were made; chunks of one simulated second are closed when the next one begins.
    assert 29 <= len(run.time) <= 35


def test_statistics_and_indexes_close_the_file(log: Path) -> None:
    with log.open("rb") as file:
        summary = make_reader(file).get_summary()
        records = list(
            StreamReader(io.BytesIO(log.read_bytes()), emit_chunks=True, validate_crcs=True).records
        )
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == sum(cm.open_run(log)._source.log.counts().values())
    assert summary.statistics.message_start_time == EPOCH
    assert summary.statistics.message_end_time == EPOCH + 600_000_000
    assert len(summary.chunk_indexes) == 3
    assert [index.name for index in summary.metadata_indexes] == ["cablemodel", "cablemodel_end"]
    assert summary.attachment_indexes[0].name == "scene.yaml"
    assert any(isinstance(record, MessageIndex) for record in records)


def test_attachments_carry_their_checksum(log: Path) -> None:
    with log.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    index = summary.attachment_indexes[0]
    record = log.read_bytes()[index.offset : index.offset + index.length]
    assert zlib.crc32(record[9:-4]) == int.from_bytes(record[-4:], "little") != 0


def test_writing_to_nowhere_is_a_clear_error(simple_scene: Scene, tmp_path: Path) -> None:
    with pytest.raises(cm.LogError, match=r"cannot write the log .*missing"):
        LogWriter(tmp_path / "missing" / "run.mcap", simple_scene)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_disk_is_a_clear_error(simple_scene: Scene, swinging_cable: Any) -> None:
    model = swinging_cable(simple_scene)
    with pytest.raises(cm.LogError, match="No space left"):
        cm.simulate(simple_scene, log="/dev/full", model=model)


def test_a_closed_log_takes_no_more(
    simple_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    writer = LogWriter(tmp_path / "run.mcap", simple_scene)
    writer.close()
    with pytest.raises(cm.LogError, match="is closed"):
        writer.write_outputs(swinging_cable(simple_scene))


def test_limits_are_those_of_the_contract() -> None:
    assert writer_module.CHUNK_BYTES == 64 * 1024
    assert writer_module.CHUNK_SIMULATED_SECONDS == 1.0
    assert writer_module.CHUNK_WALL_SECONDS == 1.0


def test_logging_a_sample_takes_few_calls(
    simple_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    """64 stations, step and outputs: calls of functions, which no other load changes.

    What they cost in time is measured by ``python -m benchmarks.logs``.
    """
    source = swinging_cable(simple_scene, nodes=64)
    source.step(0.05)
    state = source.state()
    names = [row.python for row in variables.outputs_of(simple_scene) if "." not in row.python]
    values = {name: getattr(source, name) for name in [*names, "applied_inputs"]}
    model: Any = SimpleNamespace(**values, time=0.0, scene=simple_scene)
    model.numbers = lambda: model
    profile = cProfile.Profile()
    with LogWriter(tmp_path / "run.mcap", simple_scene) as writer:
        profile.enable()
        for _ in range(200):
            model.time += 0.05
            writer.write_step(model, 0.05)
            writer.write_outputs(model, state)
        profile.disable()
        writer.close()
    calls = sum(entry.callcount for entry in profile.getstats()) / 200
    assert calls <= 220
