"""The MCAP file of a log: records, chunks, indexes.

The writer of the ``mcap`` library puts the messages of all channels into one chunk, so that to read
a number a reader decompresses every shape that was logged with it. Here channels belong to groups,
and each group has chunks of its own: the numbers over time of a long log are read without touching
its shapes and states. Every MCAP reader orders messages by the indexes, which say where they are.
Records other than messages, chunks and their indexes are made by the library.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable, Mapping
from typing import IO

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

MAGIC = b"\x89MCAP0\r\n"

_MESSAGE = struct.Struct("<BQHIQQ")
"""Opcode, length, channel, sequence, log time, publish time; then the message."""
_MESSAGE_FIXED = 22
_CHUNK = struct.Struct("<BQQQQII4sQ")
"""Opcode, length, first and last stamp, uncompressed size and CRC, compression, length of data."""
_CHUNK_FIXED = _CHUNK.size - 9
_INDEX = struct.Struct("<BQHI")
_COMPRESSION = "zstd"


class _Group:
    """Messages of some channels that are in no closed chunk yet."""

    def __init__(self) -> None:
        self.records = bytearray()
        self.indexes: dict[int, list[int]] = {}
        """Channel to stamp, offset, stamp, offset, ..."""
        self.first = 0
        self.last = 0

    def clear(self) -> None:
        self.records = bytearray()
        self.indexes = {}


class Container:
    """Writes MCAP records to a binary stream; what is not closed in a chunk is not in it yet.

    Args:
        stream: open for writing bytes, at its start.
        profile: of the header: what conventions the file follows.
        library: of the header: who wrote it.

    Every method may raise the stream's OSError.
    """

    def __init__(self, stream: IO[bytes], *, profile: str, library: str) -> None:
        self._stream = stream
        self._offset = 0
        self._crc = 0
        self._compressor = zstandard.ZstdCompressor()
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._group_of: list[_Group] = []
        self._sequences: list[int] = []
        self._groups: dict[str, _Group] = {}
        self._chunks: list[ChunkIndex] = []
        self._attachments: list[AttachmentIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._span: tuple[int, int] | None = None
        self._put(MAGIC)
        self._put(_bytes([Header(profile, library)]))

    def attach(self, time: int, name: str, media_type: str, data: bytes) -> None:
        """Attach a file; ``time`` is when it was made [ns since 1970]."""
        at, size = self._put(_bytes([Attachment(time, time, name, media_type, data)]))
        index = AttachmentIndex(at, size, time, time, len(data), name, media_type)
        self._attachments.append(index)

    def add_metadata(self, name: str, metadata: Mapping[str, str]) -> None:
        at, size = self._put(_bytes([Metadata(name, dict(metadata))]))
        self._metadata.append(MetadataIndex(at, size, name))

    def add_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Define a message type; gives its number."""
        schema = Schema(id=len(self._schemas) + 1, data=data, encoding=encoding, name=name)
        self._schemas.append(schema)
        return schema.id

    def add_channel(
        self, topic: str, encoding: str, schema: int, metadata: Mapping[str, str], group: str
    ) -> int:
        """Define a channel whose messages go into the chunks of a group; gives its number.

        Groups are written in the order in which they are first named.
        """
        channel = Channel(len(self._channels) + 1, topic, encoding, dict(metadata), schema)
        # A reader that goes through a file without its end must know a channel before its
        # messages: the definitions stand in the first chunk of the group.
        home = self._groups.setdefault(group, _Group())
        known = {c.schema_id for c, g in zip(self._channels, self._group_of, strict=True)
                 if g is home}  # fmt: skip
        if schema not in known:
            home.records += _bytes([self._schemas[schema - 1]])
        home.records += _bytes([channel])
        self._channels.append(channel)
        self._group_of.append(home)
        self._sequences.append(0)
        return channel.id

    def add_message(self, channel: int, stamp: int, data: bytes) -> int:
        """Add a message to the open chunk of its group; gives the size [bytes] of that chunk."""
        group = self._group_of[channel - 1]
        records = group.records
        index = group.indexes.get(channel)
        if index is None:
            if not group.indexes:
                group.first = group.last = stamp
            index = group.indexes[channel] = []
        if stamp > group.last:
            group.last = stamp
        elif stamp < group.first:
            group.first = stamp
        index += (stamp, len(records))
        sequence = self._sequences[channel - 1]
        self._sequences[channel - 1] = sequence + 1
        size = _MESSAGE_FIXED + len(data)
        records += _MESSAGE.pack(Opcode.MESSAGE, size, channel, sequence & _U32, stamp, stamp)
        records += data
        return len(records)

    @property
    def counts(self) -> dict[int, int]:
        """Messages of every channel so far."""
        return {channel + 1: count for channel, count in enumerate(self._sequences)}

    def close_chunks(self) -> None:
        """Close the open chunk of every group and hand all to the operating system."""
        for group in self._groups.values():
            if group.indexes:
                self._close_chunk(group)
        self._stream.flush()

    def finish(self) -> None:
        """Close the chunks, and write what makes the file quick to read. Does not close it."""
        self.close_chunks()
        self._put(_bytes([DataEnd(self._crc)]))
        start = self._offset
        summary = RecordBuilder()
        offsets: list[McapRecord] = []
        for opcode, records in self._summary():
            at = summary.count
            for record in records:
                record.write(summary)
            if summary.count > at:
                offsets.append(SummaryOffset(opcode, start + at, summary.count - at))
        offset_start = start + summary.count
        for record in offsets:
            record.write(summary)
        data = _content(summary)
        head = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offset_start)
        footer = Footer(start, offset_start, zlib.crc32(head, zlib.crc32(data)))
        self._put(data + _bytes([footer]) + MAGIC)
        self._stream.flush()

    def _summary(self) -> list[tuple[Opcode, Iterable[McapRecord]]]:
        first, last = self._span or (0, 0)
        counts = {channel: count for channel, count in self.counts.items() if count}
        statistics = Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(self._channels),
            channel_message_counts=counts,
            chunk_count=len(self._chunks),
            message_count=sum(self._sequences),
            metadata_count=len(self._metadata),
            message_start_time=first,
            message_end_time=last,
            schema_count=len(self._schemas),
        )
        return [
            (Opcode.SCHEMA, self._schemas),
            (Opcode.CHANNEL, self._channels),
            (Opcode.STATISTICS, [statistics]),
            (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.ATTACHMENT_INDEX, self._attachments),
            (Opcode.METADATA_INDEX, self._metadata),
        ]

    def _close_chunk(self, group: _Group) -> None:
        records, first, last = bytes(group.records), group.first, group.last
        compressed = self._compressor.compress(records)
        head = _CHUNK.pack(
            Opcode.CHUNK, _CHUNK_FIXED + len(compressed), first, last, len(records),
            zlib.crc32(records), len(_COMPRESSION), _COMPRESSION.encode(), len(compressed),
        )  # fmt: skip
        at = self._offset
        size = len(head) + len(compressed)
        data = [head, compressed]
        places = {}
        end = at + size
        for channel, entries in group.indexes.items():
            length = 8 * len(entries)
            places[channel] = end
            data.append(_INDEX.pack(Opcode.MESSAGE_INDEX, 6 + length, channel, length))
            data.append(struct.pack(f"<{len(entries)}Q", *entries))
            end += _INDEX.size + length
        self._put(b"".join(data))
        self._chunks.append(
            ChunkIndex(
                chunk_length=size,
                chunk_start_offset=at,
                compression=_COMPRESSION,
                compressed_size=len(compressed),
                message_end_time=last,
                message_index_length=end - at - size,
                message_index_offsets=places,
                message_start_time=first,
                uncompressed_size=len(records),
            )
        )
        span = self._span or (first, last)
        self._span = min(span[0], first), max(span[1], last)
        group.clear()

    def _put(self, data: bytes) -> tuple[int, int]:
        """Write; gives where it begins and how long it is."""
        at = self._offset
        self._stream.write(data)
        self._crc = zlib.crc32(data, self._crc)
        self._offset += len(data)
        return at, len(data)


_U32 = 0xFFFFFFFF


def _bytes(records: Iterable[McapRecord]) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return _content(builder)


def _content(builder: RecordBuilder) -> bytes:
    found: bytes = builder.end()  # type: ignore[no-untyped-call]
    return found
