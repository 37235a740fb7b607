"""Read a log: complete, cut off anywhere, or damaged.

The file is walked record by record with the record definitions of the ``mcap`` library. Its own
readers stop at the first thing that a cut file lacks, and parse every message to give one topic;
here a topic is gathered by the chunks' indexes, which is what makes long logs open at once.
"""

from __future__ import annotations

import json
import struct
import zlib
from dataclasses import dataclass, field
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, Metadata, Schema
from mcap.stream_reader import get_chunk_data_stream
from numpy.typing import NDArray

from cablemodel import variables
from cablemodel.errors import LogError
from cablemodel.results.log.container import MAGIC
from cablemodel.results.log.messages import typestore
from cablemodel.results.log.writer import (
    METADATA_END,
    METADATA_START,
    SCENE_ATTACHMENT,
    SCHEMA_VERSION,
    SNAPSHOT_ATTACHMENT,
    SOURCE_ATTACHMENT,
    TOPIC_NAMES,
)

_RECORD_HEADER = struct.Struct("<BQ")
_CHUNK_HEAD = struct.Struct("<QQQII")
"""First and last stamp, uncompressed size and CRC, length of the compression's name."""
_MESSAGE_DATA = 31
"""Offset of a message's data from the start of its record."""
_LAST_KNOWN_OPCODE = 0x0F
_FIRST_PRIVATE_OPCODE = 0x80
_KEEP_BYTES = 256 * 2**20
"""Chunks stay decompressed in memory up to this size of all together."""


class Messages(NamedTuple):
    """Messages of one topic in the order of the file."""

    stamp: NDArray[np.int64]
    """Time stamps (n,) [ns]."""
    data: list[memoryview]
    """CDR bytes of each."""


@dataclass
class _Chunk:
    record: Chunk
    offset: int
    indexes: dict[int, NDArray[np.uint64]] = field(default_factory=dict)
    """Channel to (n, 2) stamps [ns] and offsets in the chunk."""
    content: bytes | None = None


class LogFile:
    """What a log holds.

    Attributes: ``scene_text`` (YAML in SI), ``source_text`` (as the user wrote it, or None),
    ``snapshot`` (the state that the file begins at, where that is not the scene's),
    ``metadata`` and ``end`` (records at the start and the end), ``epoch`` [ns], ``cut`` (whether
    the end of the file is missing), ``complete`` and ``reason``, ``names`` (topics of the table
    that have another name in the file: a node in a namespace wrote it).

    Raises:
        LogError: no such file, not a log of this project, by another schema version, or damaged.
    """

    def __init__(self, path: str | PathLike[str]) -> None:
        self.path = Path(path)
        try:
            self._data = memoryview(self.path.read_bytes())
        except OSError as error:
            raise LogError(f"cannot read the log {self.path}: {error.strerror}") from error
        self.scene_text = ""
        self.source_text: str | None = None
        self.snapshot: bytes | None = None
        self.metadata: dict[str, str] = {}
        self.end: dict[str, str] = {}
        self.cut = False
        self._chunks: list[_Chunk] = []
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._data_crc = 0
        self._keep = True
        self._walk()
        self._keep = sum(c.record.uncompressed_size for c in self._chunks) <= _KEEP_BYTES
        self._check_origin()
        if self.cut or not self._data_crc:
            # No checksum covers the whole file: trust only what a chunk's own one covers.
            for chunk in self._chunks:
                chunk.indexes = self._walk_chunk(chunk)
        self.names: dict[str, str] = json.loads(self.metadata.get(TOPIC_NAMES, "{}"))
        tables = {name: topic for topic, name in self.names.items()}
        self._ids = {tables.get(c.topic, c.topic): key for key, c in self._channels.items()}

    @property
    def epoch(self) -> int:
        """Time that stands for t = 0 [ns]."""
        return int(self.metadata["epoch_ns"])

    @property
    def complete(self) -> bool:
        """Whether the run went to its end and all of it is here."""
        return not self.cut and self.end.get("status") == "complete"

    @property
    def reason(self) -> str:
        """Why it is not complete; empty if it is."""
        if self.complete:
            return ""
        if self.cut:
            return "the end of the file is missing: the run was killed, or the copy was cut off"
        return self.end.get("reason") or "the log does not say how the run ended"

    @property
    def statistics(self) -> dict[str, Any]:
        """Numbers of the solver at the end; empty when it was not reached."""
        found: dict[str, Any] = json.loads(self.end.get("statistics", "{}"))
        return found

    @property
    def topics(self) -> dict[str, str]:
        """Topics of the table that are in the file, and their message types."""
        found = {topic: self._channels[key] for topic, key in self._ids.items()}
        return {topic: self._schemas[c.schema_id].name for topic, c in found.items()}

    def counts(self) -> dict[str, int]:
        """Number of messages of every topic."""
        return {topic: sum(len(index) for _, index in self._indexes(topic)) for topic in self._ids}

    def messages(self, topic: str) -> Messages:
        """All messages of a topic (``/cable/...``); none if it is not in the file."""
        stamps, data = [], []
        for chunk, index in self._indexes(topic):
            content = memoryview(self._content(chunk))
            for at in index[:, 1].tolist():
                end = at + 9 + _RECORD_HEADER.unpack_from(content, at)[1]
                data.append(content[at + _MESSAGE_DATA : end])
            stamps.append(index[:, 0])
        return Messages(np.concatenate([_NO_STAMPS, *stamps]).astype(np.int64), data)

    def stamps(self, topic: str) -> NDArray[np.int64]:
        """Time stamps (n,) [ns] of a topic's messages."""
        parts = [index[:, 0] for _, index in self._indexes(topic)]
        return np.concatenate([_NO_STAMPS, *parts]).astype(np.int64)

    def trailing_floats(self, topic: str, count: int) -> NDArray[np.float64]:
        """The last ``count`` 64-bit floats of every message of a topic, (n, count).

        The messages of the table end in their numbers, behind headers of one length.
        """
        parts = []
        for chunk, index in self._indexes(topic):
            content = np.frombuffer(self._content(chunk), np.uint8)
            at = index[:, 1].astype(np.int64)
            length = content[at[:, None] + np.arange(1, 9)].view("<u8")[:, 0].astype(np.int64)
            start = at + 9 + length - 8 * count
            if np.any(start < at + _MESSAGE_DATA):
                raise self._corrupt(chunk.offset, f"a message of {topic} is too short")
            parts.append(content[start[:, None] + np.arange(8 * count)].view("<f8"))
        return np.concatenate([np.empty((0, count)), *parts])

    def first_floats(self, topic: str) -> NDArray[np.float64]:
        """The first value (n,) of every ``Float64MultiArray`` of a topic.

        The labels in front of it are as long in every message of a topic.
        """
        parts = [np.empty(0)]
        before = -1
        for chunk, index in self._indexes(topic):
            content = np.frombuffer(self._content(chunk), np.uint8)
            at = index[:, 1].astype(np.int64)
            if before < 0:
                before = self._before_data(memoryview(self._content(chunk)), int(at[0]))
            start = at + _MESSAGE_DATA + before
            parts.append(content[start[:, None] + np.arange(8)].view("<f8")[:, 0])
        return np.concatenate(parts)

    def _before_data(self, content: memoryview, at: int) -> int:
        """Bytes before the values of the ``Float64MultiArray`` of the record at an offset."""
        end = at + 9 + _RECORD_HEADER.unpack_from(content, at)[1]
        message = content[at + _MESSAGE_DATA : end]
        decoded: Any = typestore().deserialize_cdr(message, variables.ARRAY)
        return len(message) - 8 * len(decoded.data)

    def arrays(self, topic: str) -> tuple[tuple[str, ...], list[NDArray[np.float64]]]:
        """Labels and values of every ``Float64MultiArray`` of a topic."""
        found = self.messages(topic).data
        if not found:
            return (), []
        first: Any = typestore().deserialize_cdr(found[0], variables.ARRAY)
        labels = tuple(first.layout.dim[0].label.split(","))
        before = len(found[0]) - 8 * len(first.data)
        return labels, [np.frombuffer(data, "<f8", offset=before) for data in found]

    def _indexes(self, topic: str) -> list[tuple[_Chunk, NDArray[np.uint64]]]:
        key = self._ids.get(topic)
        if key is None:
            return []
        return [(chunk, chunk.indexes[key]) for chunk in self._chunks if key in chunk.indexes]

    def _walk(self) -> None:
        """Find all records outside chunks."""
        data, size = self._data, len(self._data)
        if bytes(data[:8]) != MAGIC:
            if MAGIC.startswith(bytes(data[:8])):
                raise LogError(f"{self.path} is cut off before the scene: there is nothing in it")
            raise LogError(
                f"{self.path} is no MCAP file: a log is what `cablemodel run SCENE --log RUN.mcap` "
                "writes"
            )
        has_end = size >= 16 and bytes(data[-8:]) == MAGIC
        at = 8
        footer = False
        while not footer:
            body = at + 9
            if body > size:
                break
            opcode, length = _RECORD_HEADER.unpack_from(data, at)
            if opcode == 0 or _LAST_KNOWN_OPCODE < opcode < _FIRST_PRIVATE_OPCODE:
                if not any(data[at:]):  # blocks that were given to the file but never written
                    break
                raise self._corrupt(at, f"no record starts with {opcode:#04x}")
            if body + length > size:
                break
            if opcode == Opcode.FOOTER:
                footer = True
            else:
                self._take(opcode, at, body, body + length)
            at = body + length
        self.cut = not (footer and has_end and at == size - 8)
        if self.cut and (has_end or (footer and at + 8 <= size)):
            raise self._corrupt(
                at, "a record is longer than the file, or the file's end is damaged"
            )

    def _take(self, opcode: int, at: int, body: int, end: int) -> None:
        """One record of the file."""
        content = self._data[body:end]
        try:
            if opcode == Opcode.CHUNK:
                self._chunks.append(_Chunk(_chunk_record(content), at))
            elif opcode == Opcode.MESSAGE_INDEX:
                self._take_index(content)
            elif opcode == Opcode.ATTACHMENT:
                if zlib.crc32(content[:-4]) != int.from_bytes(content[-4:], "little"):
                    raise self._corrupt(at, "an attachment does not match its checksum")
                attachment = Attachment.read(_stream(content))
                if attachment.name == SCENE_ATTACHMENT:
                    self.scene_text = attachment.data.decode()
                elif attachment.name == SOURCE_ATTACHMENT:
                    self.source_text = attachment.data.decode()
                elif attachment.name == SNAPSHOT_ATTACHMENT:
                    self.snapshot = attachment.data
            elif opcode == Opcode.METADATA:
                metadata = Metadata.read(_stream(content))
                if metadata.name == METADATA_START:
                    self.metadata = metadata.metadata
                elif metadata.name == METADATA_END:
                    self.end = metadata.metadata
            elif opcode == Opcode.SCHEMA:
                schema = Schema.read(_stream(content))
                self._schemas[schema.id] = schema
            elif opcode == Opcode.CHANNEL:
                channel = Channel.read(_stream(content))
                self._channels[channel.id] = channel
            elif opcode == Opcode.DATA_END:
                (self._data_crc,) = struct.unpack("<I", content[:4])
                if self._data_crc and zlib.crc32(self._data[:at]) != self._data_crc:
                    raise self._corrupt(at, "the data do not match their checksum")
        except LogError:
            raise
        except Exception as error:  # whatever parsing of arbitrary bytes may raise
            raise self._corrupt(at, f"a record cannot be parsed ({error})") from error

    def _take_index(self, content: memoryview) -> None:
        if not self._chunks:
            raise ValueError("an index before the first chunk")
        channel, size = struct.unpack_from("<HI", content)
        entries = np.frombuffer(content[6 : 6 + size], "<u8").reshape(-1, 2)
        self._chunks[-1].indexes[channel] = entries

    def _check_origin(self) -> None:
        """Refuse a file that is not a log of this project, or by another version of it."""
        if not self.metadata or not self.scene_text:
            if self.cut:
                raise LogError(f"{self.path} is cut off before the scene: there is nothing in it")
            raise LogError(f"{self.path} is an MCAP file, but no log of cablemodel: no scene in it")
        version = self.metadata.get("schema_version", "")
        if version != SCHEMA_VERSION:
            writer = self.metadata.get("cablemodel", "of an unknown version")
            newer = version.isdecimal() and int(version) > int(SCHEMA_VERSION)
            advice = "install a newer cablemodel" if newer else f"read it with cablemodel {writer}"
            raise LogError(
                f"{self.path} has log schema version {version or 'unknown'} (by cablemodel "
                f"{writer}); this cablemodel reads version {SCHEMA_VERSION}: {advice}"
            )

    def _walk_chunk(self, chunk: _Chunk) -> dict[int, NDArray[np.uint64]]:
        """Indexes of a chunk from its content.

        Keeps the schemas and channels met on the way: a cut file has no other copy of them.
        """
        content = memoryview(self._content(chunk))
        found: dict[int, list[tuple[int, int]]] = {}
        at = 0
        while at < len(content):
            opcode, length = _RECORD_HEADER.unpack_from(content, at)
            if opcode == Opcode.MESSAGE:
                channel, _, stamp = struct.unpack_from("<HIQ", content, at + 9)
                found.setdefault(channel, []).append((stamp, at))
            elif opcode == Opcode.SCHEMA:
                schema = Schema.read(_stream(content[at + 9 : at + 9 + length]))
                self._schemas[schema.id] = schema
            elif opcode == Opcode.CHANNEL:
                read = Channel.read(_stream(content[at + 9 : at + 9 + length]))
                self._channels[read.id] = read
            at += 9 + length
        return {channel: np.array(entries, np.uint64) for channel, entries in found.items()}

    def _content(self, chunk: _Chunk) -> bytes:
        """Records of a chunk, decompressed and checked."""
        if chunk.content is not None:
            return chunk.content
        try:
            stream, size = get_chunk_data_stream(chunk.record, validate_crc=True)
            content = stream.read(size)
        except Exception as error:  # zstandard and mcap have no common base
            raise self._corrupt(chunk.offset, f"a chunk cannot be read ({error})") from error
        if len(content) != chunk.record.uncompressed_size:
            raise self._corrupt(chunk.offset, "a chunk has the wrong size")
        if self._keep:
            chunk.content = content
        return content

    def _corrupt(self, at: int, problem: str) -> LogError:
        return LogError(f"{self.path} is damaged at byte {at}: {problem}")


def _chunk_record(content: memoryview) -> Chunk:
    """A chunk whose data stay where they are: most are never read, and none is copied."""
    first, last, size, crc, length = _CHUNK_HEAD.unpack_from(content)
    start = _CHUNK_HEAD.size + length + 8
    compression = str(content[_CHUNK_HEAD.size : start - 8], "utf-8")
    data = content[start:]
    if len(data) != int.from_bytes(content[start - 8 : start], "little"):
        raise ValueError("its length is not that of its data")
    return Chunk(
        compression=compression,
        data=data,  # type: ignore[arg-type]  # what reads it takes any buffer
        message_end_time=last,
        message_start_time=first,
        uncompressed_crc=crc,
        uncompressed_size=size,
    )


_NO_STAMPS = np.empty(0, np.uint64)


def _stream(content: memoryview) -> ReadDataStream:
    return ReadDataStream(BytesIO(content))
