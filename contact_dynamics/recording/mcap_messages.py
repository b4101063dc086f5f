# SPDX-License-Identifier: Apache-2.0
"""Reads the messages of an MCAP file. For a time span it reads only the chunks that the index lists.

Otherwise it walks through the file from front to back and yields only intact records. A chunk is verified by
its checksum, any other record by its lengths, each of which the file contains twice. The length of a damaged
record cannot be trusted, so the walk searches for the next intact record byte by byte; the bytes in between
are a `Loss`. The number of lost messages comes from the summary at the end of the file, which has a checksum
of its own.

The walk needs memory for the largest chunk and the summary, whatever lengths a damaged file claims.
"""

from __future__ import annotations

import re
import struct
import zlib
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from mcap.opcode import Opcode
from mcap.records import Channel, Message, Metadata, Schema

from contact_dynamics.recording.bag_metadata import OFFERED_QOS, RUN_RECORD, TYPE_HASH, unsealed_run
from contact_dynamics.recording.errors import NotALogError
from contact_dynamics.recording.file_messages import Loss, Span, StoredMessage, Topic, uncompressed
from contact_dynamics.recording.mcap_file import (
    HEAD,
    MAGIC,
    WINDOW,
    DamagedError,
    McapFile,
    Summary,
    demand,
    parsed,
    read_summary,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator
    from pathlib import Path

    from typing_extensions import Self


_ENCODINGS: Final = frozenset({"cdr", ""})
"""How messages that are read may be encoded. Some writers leave it out."""


class McapMessages:
    """An MCAP file to read from. `SqliteMessages` has the same methods."""

    def __init__(self, path: Path) -> None:
        """Set the file, which `__enter__` opens."""
        self._path = path

    def __enter__(self) -> Self:
        """Open the file, or raise `NotALogError` if it does not begin as an MCAP file."""
        self._stream = self._path.open("rb")
        try:
            self._walk = McapWalk(McapFile(self._path, self._stream, self._path.stat().st_size))
        except BaseException:
            self._stream.close()
            raise
        return self

    def __exit__(self, *_error: object) -> None:
        """Close the file."""
        self._stream.close()

    @property
    def losses(self) -> list[Loss]:
        """The losses so far."""
        return self._walk.losses

    def messages(self, topics: Collection[str] | None, span: Span) -> Iterator[StoredMessage]:
        """Yield the messages of some topics, or of all, in the order in which they were written."""
        definitions = _Definitions(self._walk)
        undefined = 0
        everything = span == Span()
        for record in self._walk.records() if everything else self._walk.records_within(span):
            if not isinstance(record, Message):
                definitions.add(record)
                continue
            if not everything and not span.start_ns <= record.log_time < span.end_ns:
                continue
            topic = definitions.topic(record.channel_id)
            if topic is None:
                undefined += 1
            elif topics is None or topic.name in topics:
                yield StoredMessage(topic, record.data, record.log_time, record.publish_time)
        if undefined:
            self._walk.lose_undefined(undefined)

    def topics(self) -> list[Topic]:
        """Return the topics that are described before the first message or at the end."""
        definitions = _Definitions(self._walk)
        numbers = {*(self._walk.summary or Summary()).channels}
        for record in self._walk.records():
            if isinstance(record, Message):
                break
            definitions.add(record)
            if isinstance(record, Channel):
                numbers.add(record.id)
        return [topic for number in sorted(numbers) if (topic := definitions.topic(number)) is not None]

    def extent(self) -> tuple[int, int] | None:
        """Return the first and the last log time, ns, or None without messages.

        Without an index the last time is unknown, and the first one takes its place.
        """
        chunks = (self._walk.summary or Summary()).chunks
        filled = [chunk for chunk in chunks if chunk.message_end_time > 0]
        if filled:
            return min(c.message_start_time for c in filled), max(c.message_end_time for c in filled)
        messages = (record for record in self._walk.records() if isinstance(record, Message))
        first = next(messages, None)
        return None if first is None else (first.log_time, first.log_time)

    def run(self) -> dict[str, str] | None:
        """Return the record of the run that made the file, or None if none is intact."""
        for record in self._walk.records():
            if isinstance(record, Metadata) and record.name == RUN_RECORD:
                run = unsealed_run(record.metadata)
                if run is not None:
                    return run
                self._walk.lose_run()
        return None


class _Definitions:
    """Channels and schemas of one file. Those that a lost chunk defined come from the file's summary."""

    def __init__(self, walk: McapWalk) -> None:
        self._walk = walk
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._known: dict[int, Topic | None] = {}

    def add(self, record: WalkedRecord) -> None:
        """Keep a record if it is a definition."""
        if isinstance(record, Schema):
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            self._channels[record.id] = record
            self._known.pop(record.id, None)

    def topic(self, channel_id: int) -> Topic | None:
        """Return the topic of a channel, or None if it is not defined."""
        if channel_id not in self._known:
            self._known[channel_id] = self._find(channel_id)
        return self._known[channel_id]

    def _find(self, channel_id: int) -> Topic | None:
        channel = self._channels.get(channel_id) or self._summary.channels.get(channel_id)
        if channel is None or channel.schema_id == 0:
            return None if channel is None else Topic(channel.topic, "", "")
        schema = self._schemas.get(channel.schema_id) or self._summary.schemas.get(channel.schema_id)
        if schema is None:
            return None
        if channel.message_encoding not in _ENCODINGS:
            return Topic(channel.topic, "", "")
        offered, type_hash = channel.metadata.get(OFFERED_QOS, ""), channel.metadata.get(TYPE_HASH, "")
        text = schema.data.decode(errors="replace") if schema.encoding == "ros2msg" else ""
        return Topic(channel.topic, schema.name, text, offered, type_hash)

    @property
    def _summary(self) -> Summary:
        return self._walk.summary or Summary()


_CHUNK: Final = struct.Struct("<QQQII")  # earliest and latest time, size, checksum, length of the next field
_MESSAGE: Final = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time
_DATA_END_BYTES: Final = 4
_LONGEST_NAME: Final = 32  # bytes, of a compression

# A chunk, a metadata record or the end of the data, of less than 2**40 bytes.
_PERHAPS_WHOLE: Final = re.compile(rb"[\x06\x0c\x0f](?=.{5}\x00\x00\x00)", re.DOTALL)

_DEFINING: Final[dict[int, Any]] = {Opcode.SCHEMA: Schema, Opcode.CHANNEL: Channel}

WalkedRecord: TypeAlias = Schema | Channel | Message | Metadata


class McapWalk:
    """One walk through a file. `losses` is complete once `records` is exhausted."""

    def __init__(self, file: McapFile) -> None:
        """Start at the head of the file.

        Raise `NotALogError` if it does not begin as an MCAP file. One damaged byte is allowed.
        """
        self._file = file
        self._losses: list[Loss] = []
        self._summary: Summary | None = None
        self._chunked = False
        self._unchecked = False  # whether messages outside of chunks were yielded, which have no checksum
        self._readers: dict[int, Callable[[int, int], list[WalkedRecord]]] = {
            Opcode.CHUNK: self._chunk,
            Opcode.MESSAGE_INDEX: self._message_index,
            Opcode.ATTACHMENT: self._attachment,
            Opcode.METADATA: lambda begin, end: [parsed(Metadata, self._file.content(begin, end))],
        }
        found = file.bytes_at(0, len(MAGIC))
        if len(found) < len(MAGIC) or sum(a != b for a, b in zip(found, MAGIC, strict=True)) > 1:
            raise NotALogError(f"{file.path} is not an MCAP file")
        if found != MAGIC:
            self._lose(0, len(MAGIC), "its first bytes are not those of an MCAP file", messages=0)

    def records(self) -> Iterator[WalkedRecord]:
        """Yield all intact records, except repetitions and indexes, in the order of the file."""
        position: int | None = len(MAGIC)
        while position is not None:
            found: list[WalkedRecord] = []
            try:
                kind, begin, end = self._file.head(position)
                if kind == Opcode.DATA_END:
                    self._check_data(position, begin, end)
                    self._check_end(end)
                    return
                found = self._whole(kind, begin, end)
            except DamagedError as error:
                damaged, position = position, self._find_whole(position + 1)
                self._lose(damaged, self._file.size if position is None else position, str(error))
            else:
                position = end
            yield from found

    def records_within(self, span: Span) -> Iterator[WalkedRecord]:
        """Yield the records of the chunks that have messages of a span, by the summary's index.

        A file without an index is walked through as a whole.
        """
        summary = self.summary
        if summary is None or not summary.chunks:
            yield from self.records()
            return
        begins = {
            chunk.chunk_start_offset
            for chunk in summary.chunks
            if chunk.message_end_time >= span.start_ns and chunk.message_start_time < span.end_ns
        }
        for position in sorted(begins):
            end = self._file.size
            found: list[WalkedRecord] = []
            try:
                kind, begin, end = self._file.head(position)
                demand(kind == Opcode.CHUNK, "the place of a chunk by the index")
                found = self._chunk(begin, end)
            except DamagedError as error:
                self._lose(position, end, str(error))
            yield from found

    @property
    def losses(self) -> list[Loss]:
        """The losses so far, with the number of messages if the summary contains it."""
        summary = self.summary if self._losses else None
        if summary is None:
            return list(self._losses)
        return [
            replace(loss, messages=summary.messages_between(loss.begin, loss.end))
            if loss.messages is None
            else loss
            for loss in self._losses
        ]

    @property
    def summary(self) -> Summary | None:
        """The summary at the end of the file, or None if it is missing or damaged."""
        if self._summary is None:
            try:
                self._summary = read_summary(self._file)
            except DamagedError:
                return None
        return self._summary

    def lose_undefined(self, count: int) -> None:
        """Add the loss of messages whose channel no intact record defines."""
        self._lose(0, self._file.size, "what defines their channels is lost", messages=count)

    def lose_run(self) -> None:
        """Add the loss of the record of the run, which is damaged."""
        self._lose(0, self._file.size, "the record of how the run was made fails its checksum", messages=0)

    def _lose(self, begin: int, end: int, reason: str, messages: int | None = None) -> None:
        self._losses.append(
            Loss(path=self._file.path, begin=begin, end=end, messages=messages, reason=reason)
        )

    def _whole(self, kind: int, begin: int, end: int) -> list[WalkedRecord]:
        """Return the content of a record, or raise `DamagedError` if it is not intact."""
        if kind in self._readers:
            return self._readers[kind](begin, end)
        if kind == Opcode.HEADER and begin == len(MAGIC) + HEAD.size:
            self._check_header(begin, end)
            return []
        if kind in _DEFINING and not self._chunked:  # a file has either chunks or bare messages
            return [parsed(_DEFINING[kind], self._file.content(begin, end))]
        if kind == Opcode.MESSAGE and not self._chunked:
            self._unchecked = True
            return [_message(self._file.bytes_at(begin, end - begin))]
        raise DamagedError(f"no record begins here: found kind {kind:#04x}")

    def _check_header(self, begin: int, end: int) -> None:
        for _ in range(2):  # profile and library
            begin += 4 + self._file.number_at(begin, 4)
        demand(begin == end, "the length of the header")

    def _chunk(self, begin: int, end: int) -> list[WalkedRecord]:
        head = self._file.bytes_at(begin, min(end - begin, _CHUNK.size))
        demand(len(head) == _CHUNK.size, "the head of a chunk")
        _, _, size, checksum, name_length = _CHUNK.unpack(head)
        demand(name_length <= _LONGEST_NAME, "the compression of a chunk")
        name = self._file.bytes_at(begin + _CHUNK.size, name_length)
        data_begin = begin + _CHUNK.size + name_length + 8
        demand(self._file.number_at(data_begin - 8, 8) == end - data_begin, "the length of a chunk")
        packed = self._file.bytes_at(data_begin, end - data_begin)
        try:
            data = uncompressed(name, packed, size)
        except Exception as error:  # on damaged bytes the libraries raise nearly any exception
            raise DamagedError(f"a chunk cannot be unpacked: {error}") from error
        demand(len(data) == size, "the size of a chunk")
        demand(checksum in (0, zlib.crc32(data)), "the checksum of a chunk")
        records = _chunk_records(data)
        self._unchecked |= checksum == 0
        self._chunked = True
        return records

    def _message_index(self, begin: int, end: int) -> list[WalkedRecord]:
        demand(self._file.number_at(begin + 2, 4) == end - begin - 6, "the length of a message index")
        return []

    def _attachment(self, begin: int, end: int) -> list[WalkedRecord]:
        position = begin + 16  # behind its times
        for width in (4, 4, 8):  # name, media type, data
            position += width + self._file.number_at(position, width)
            demand(position < end, "the length of an attachment")
        demand(position + 4 == end, "the length of an attachment")
        checksum = self._file.number_at(position, 4)
        demand(checksum in (0, self._file.checksum(begin, position)), "the checksum of an attachment")
        return []

    def _find_whole(self, start: int) -> int | None:
        """Return the position of the next intact chunk, metadata record or end of the data."""
        for window_start in range(start, self._file.size, WINDOW):
            window = self._file.bytes_at(window_start, WINDOW + HEAD.size)
            for match in _PERHAPS_WHOLE.finditer(window):
                position = window_start + match.start()
                if match.start() < WINDOW and self._is_whole(position):
                    return position
        return None

    def _is_whole(self, position: int) -> bool:
        try:
            kind, begin, end = self._file.head(position)
            if kind == Opcode.DATA_END:
                return end - begin == _DATA_END_BYTES and self._file.head(end)[0] in list(Opcode)
            self._whole(kind, begin, end)
        except DamagedError:
            return False
        return True

    def _check_data(self, position: int, begin: int, end: int) -> None:
        demand(end - begin == _DATA_END_BYTES, "the length of the end of the data")
        checksum = self._file.number_at(begin, _DATA_END_BYTES)
        if not self._losses and checksum not in (0, self._file.checksum(0, position)):
            concerned = "perhaps messages, which have no other" if self._unchecked else "no chunk"
            reason = f"the checksum of the data is wrong; that concerns {concerned}"
            self._lose(0, end, reason, messages=0)

    def _check_end(self, end: int) -> None:
        if not self._losses:
            try:
                self._summary = read_summary(self._file)
            except DamagedError as error:
                self._lose(end, self._file.size, f"all that only repeats what was read: {error}", messages=0)


def _message(content: bytes) -> Message:
    demand(len(content) >= _MESSAGE.size, "the length of a message")
    channel, sequence, log_time, publish_time = _MESSAGE.unpack_from(content)
    return Message(
        channel_id=channel,
        sequence=sequence,
        log_time=log_time,
        publish_time=publish_time,
        data=content[_MESSAGE.size :],
    )


def _chunk_records(data: bytes) -> list[WalkedRecord]:
    records: list[WalkedRecord] = []
    position = 0
    while position < len(data):
        demand(position + HEAD.size <= len(data), "a record within a chunk")
        kind, length = HEAD.unpack_from(data, position)
        begin, position = position + HEAD.size, position + HEAD.size + length
        demand(position <= len(data), "a record within a chunk")
        if kind == Opcode.MESSAGE:
            records.append(_message(data[begin:position]))
        elif kind in _DEFINING:
            records.append(parsed(_DEFINING[kind], data[begin:position]))
    return records
