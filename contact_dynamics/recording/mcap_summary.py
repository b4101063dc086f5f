# SPDX-License-Identifier: Apache-2.0
"""An MCAP file ends with a summary, which has its own checksum."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import Final

from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Schema

from contact_dynamics.recording.mcap_file import HEAD, MAGIC, McapFile, demand, parsed

_FOOTER: Final = struct.Struct("<BQQQI")  # head, start of the summary and of its offsets, checksum
_CHECKSUM_BYTES: Final = 4
_INDEX_BYTES: Final = 15  # bytes of a message index beside its entries, with its head
_ENTRY_BYTES: Final = 16  # bytes of an entry, which belongs to one message


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """Definitions by their numbers, and where the chunks are."""

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    chunks: tuple[ChunkIndex, ...] = ()

    def messages_between(self, begin: int, end: int) -> int | None:
        """Return how many messages the chunks have that begin in a stretch, or None without an index."""
        chunks = [chunk for chunk in self.chunks if begin <= chunk.chunk_start_offset < end]
        if any(chunk.message_index_length == 0 for chunk in chunks):
            return None
        return sum(
            (chunk.message_index_length - _INDEX_BYTES * len(chunk.message_index_offsets)) // _ENTRY_BYTES
            for chunk in chunks
        )


def read_summary(file: McapFile) -> Summary:
    """Return the summary of a file. It is empty if the writer made none.

    Raises:
        DamagedError: the file's end is not there, or not whole.
    """
    stop = file.size - _FOOTER.size - len(MAGIC)
    tail = file.bytes_at(max(0, stop), _FOOTER.size + len(MAGIC))
    demand(stop > 0 and tail.endswith(MAGIC), "the end of the file")
    kind, length, start, _, checksum = _FOOTER.unpack(tail[: _FOOTER.size])
    demand(kind == Opcode.FOOTER and length == _FOOTER.size - HEAD.size, "the footer")
    begin = start or stop
    demand(len(MAGIC) < begin <= stop, "the footer")
    found = file.checksum(begin, file.size - len(MAGIC) - _CHECKSUM_BYTES)
    demand(checksum in (0, found), "the checksum of the summary")
    return _parsed_summary(file, begin, stop)


def _parsed_summary(file: McapFile, position: int, stop: int) -> Summary:
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    chunks: list[ChunkIndex] = []
    while position < stop:
        kind, begin, position = file.head(position)
        if kind == Opcode.SCHEMA:
            schema = parsed(Schema, file.content(begin, position))
            schemas[schema.id] = schema
        elif kind == Opcode.CHANNEL:
            channel = parsed(Channel, file.content(begin, position))
            channels[channel.id] = channel
        elif kind == Opcode.CHUNK_INDEX:
            chunks.append(parsed(ChunkIndex, file.content(begin, position)))
    return Summary(schemas=schemas, channels=channels, chunks=tuple(chunks))
