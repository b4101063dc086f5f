# SPDX-License-Identifier: Apache-2.0
"""Reads the messages of an MCAP file. For a span of times it reads only the chunks that the index names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mcap.records import Channel, Message, Metadata, Schema

from contact_dynamics.recording.bag_metadata import OFFERED_QOS, RUN_RECORD, TYPE_HASH, unsealed_run
from contact_dynamics.recording.file_messages import StoredMessage, Topic
from contact_dynamics.recording.mcap_file import McapFile, Summary
from contact_dynamics.recording.mcap_walk import McapWalk

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path

    from typing_extensions import Self

    from contact_dynamics.recording.file_messages import Loss, Span
    from contact_dynamics.recording.mcap_walk import WalkedRecord

_ENCODINGS: Final = frozenset({"cdr", ""})
"""How messages that are read may be encoded. Some writers leave it out."""


class McapMessages:
    """An MCAP file that is read as a `MessageFile`."""

    def __init__(self, path: Path) -> None:
        """Name the file, which is opened later."""
        self._path = path

    def __enter__(self) -> Self:
        """Open the file.

        Raises:
            NotALogError: it does not begin as an MCAP file.
        """
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
        """What could not be read by now."""
        return self._walk.losses

    def messages(self, topics: Collection[str] | None, span: Span) -> Iterator[StoredMessage]:
        """Yield the messages of some topics, or of all, in the order in which they were written."""
        definitions = _Definitions(self._walk)
        undefined = 0
        everything = span == (None, None)
        for record in self._walk.records() if everything else self._walk.records_within(span):
            if not isinstance(record, Message):
                definitions.add(record)
                continue
            if not everything and record.log_time not in span:
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

    def definitions(self) -> dict[str, str]:
        """Return the text of each type that is described before the first message or at the end."""
        schemas: list[Schema] = []
        for record in self._walk.records():
            if isinstance(record, Message):
                break
            if isinstance(record, Schema):
                schemas.append(record)
        schemas += (self._walk.summary or Summary()).schemas.values()
        return {schema.name: text for schema in schemas if (text := _ros2msg(schema))}

    def extent(self) -> tuple[int, int] | None:
        """Return the first and the last log time, ns, or None without messages; see `MessageFile`."""
        chunks = (self._walk.summary or Summary()).chunks
        filled = [chunk for chunk in chunks if chunk.message_end_time > 0]
        if filled:
            return min(c.message_start_time for c in filled), max(c.message_end_time for c in filled)
        messages = (record for record in self._walk.records() if isinstance(record, Message))
        first = next(messages, None)
        return None if first is None else (first.log_time, first.log_time)

    def run(self) -> dict[str, str] | None:
        """Return the record of the run that made it, or None if there is none that is whole."""
        for record in self._walk.records():
            if isinstance(record, Metadata) and record.name == RUN_RECORD:
                run = unsealed_run(record.metadata)
                if run is not None:
                    return run
                self._walk.lose_run()
        return None


class _Definitions:
    """Channels and schemas of one file. The file's summary has those that a lost chunk defined."""

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
        return Topic(channel.topic, schema.name, _ros2msg(schema), offered, type_hash)

    @property
    def _summary(self) -> Summary:
        return self._walk.summary or Summary()


def _ros2msg(schema: Schema) -> str:
    return schema.data.decode(errors="replace") if schema.encoding == "ros2msg" else ""
