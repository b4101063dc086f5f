# SPDX-License-Identifier: Apache-2.0
"""Locates the records of an MCAP file, and reads the summary at its end."""

from __future__ import annotations

import io
import struct
import zlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Schema

if TYPE_CHECKING:
    from pathlib import Path
    from typing import BinaryIO

MAGIC: Final = b"\x89MCAP0\r\n"
HEAD: Final = struct.Struct("<BQ")  # the head of a record: its kind and the length of its content
WINDOW: Final = 1024 * 1024  # bytes searched at once

_LONGEST_CONTENT: Final = 16 * 1024 * 1024  # bytes, of a record that is neither chunk, message nor attachment


class DamagedError(Exception):
    """There is no intact record at a position of the file. This error never leaves the package."""


class McapFile:
    """The first ``size`` bytes of a file that is open for reading."""

    def __init__(self, path: Path, stream: BinaryIO, size: int) -> None:
        """Read from ``stream``, which the caller closes."""
        self.path = path
        self.size = size
        self._stream = stream

    def bytes_at(self, position: int, count: int) -> bytes:
        """Return this many bytes, or fewer at the end of the file."""
        if position >= self.size:
            return b""  # a damaged file can contain an impossible position
        self._stream.seek(position)
        return self._stream.read(max(0, min(count, self.size - position)))

    def number_at(self, position: int, width: int) -> int:
        """Return an unsigned number of this many bytes."""
        return int.from_bytes(self.bytes_at(position, width), "little")

    def checksum(self, begin: int, end: int) -> int:
        """Return the CRC32 of a stretch."""
        checksum = 0
        for position in range(begin, end, WINDOW):
            checksum = zlib.crc32(self.bytes_at(position, min(WINDOW, end - position)), checksum)
        return checksum

    def head(self, position: int) -> tuple[int, int, int]:
        """Return the kind of the record at a position, and the begin and end of its content.

        Raise `DamagedError` if the file ends before the record.
        """
        head = self.bytes_at(position, HEAD.size)
        if len(head) < HEAD.size:
            raise DamagedError("the file ends here, before its end")
        kind, length = HEAD.unpack(head)
        begin = position + HEAD.size
        if length > self.size - begin:
            raise DamagedError(f"a record claims {length} bytes, {self.size - begin} are left")
        return kind, begin, begin + length

    def content(self, begin: int, end: int) -> bytes:
        """Return the content of a record of a short kind, or raise `DamagedError` if it is too long."""
        if end - begin > _LONGEST_CONTENT:
            raise DamagedError(f"a record claims {end - begin} bytes")
        return self.bytes_at(begin, end - begin)


def demand(condition: bool, what: str) -> None:  # noqa: FBT001  as an assertion
    """Raise `DamagedError` with the text ``what`` unless the condition holds."""
    if not condition:
        raise DamagedError(f"{what} is wrong")


def parsed(record_type: Any, content: bytes) -> Any:
    """Return a record of the library, or raise `DamagedError` if its fields do not fill its length."""
    stream = ReadDataStream(io.BytesIO(content))
    try:
        record = record_type.read(stream)
    except Exception as error:  # on damaged bytes the library raises nearly any exception
        raise DamagedError(f"a {record_type.__name__} record is wrong: {error!r}") from error
    demand(stream.count == len(content), f"the length of a {record_type.__name__} record")
    return record


_FOOTER: Final = struct.Struct("<BQQQI")  # head, start of the summary and of its offsets, checksum
_CHECKSUM_BYTES: Final = 4
_INDEX_BYTES: Final = 15  # bytes of a message index beside its entries, with its head
_ENTRY_BYTES: Final = 16  # bytes of the entry for one message


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """Definitions by their numbers, and the index of the chunks."""

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    chunks: tuple[ChunkIndex, ...] = ()

    def messages_between(self, begin: int, end: int) -> int | None:
        """Return the number of messages in chunks that begin within a stretch, or None without an index."""
        chunks = [chunk for chunk in self.chunks if begin <= chunk.chunk_start_offset < end]
        if any(chunk.message_index_length == 0 for chunk in chunks):
            return None
        return sum(
            (chunk.message_index_length - _INDEX_BYTES * len(chunk.message_index_offsets)) // _ENTRY_BYTES
            for chunk in chunks
        )


def read_summary(file: McapFile) -> Summary:
    """Return a file's summary, empty if it has none; raise `DamagedError` if its end is damaged."""
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
