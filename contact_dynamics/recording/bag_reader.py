"""Reads a log: a bag folder or a bare ``.mcap``, ours or rosbag2's, in the order in which it was written.

The reader checks every checksum. It skips what is damaged and reads everything else (`mcap_walk`), also all
whole chunks of a log that a crash or a full disk cut short. `BagReader.losses` then says what is missing, and
the reader warns once for each file (`DamagedLogWarning`).

It needs no ROS. Messages are bytes, and `decoding` turns them into message objects if their packages are
installed.
"""

from __future__ import annotations

import re
import warnings
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mcap.records import Channel, Message, Metadata, Schema

from contact_dynamics.recording.bag_metadata import RUN_RECORD, unsealed_run
from contact_dynamics.recording.errors import DamagedLogWarning, NotALogError
from contact_dynamics.recording.mcap_file import McapFile
from contact_dynamics.recording.mcap_summary import Summary
from contact_dynamics.recording.mcap_walk import Loss, McapWalk

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from contact_dynamics.recording.mcap_walk import WalkedRecord

_MOST_TOLD: Final = 5  # places of damage that are told one by one
_SPLIT_NUMBER: Final = re.compile(r"_(\d+)\.mcap$")


@dataclass(frozen=True, slots=True, kw_only=True)
class LoggedMessage:
    """One message as it was logged.

    Attributes:
        topic: The topic's name with its leading slash.
        type_name: "package/msg/Name" or "package/srv/Name_Event".
        data: The serialised message (CDR).
        log_time_ns: When the message was received, ns since the epoch.
        publish_time_ns: When its source made it, ns since the epoch.
        definition: The text of its type in the log, in MCAP's ros2msg form; empty if it has another form.
    """

    topic: str
    type_name: str
    data: bytes
    log_time_ns: int
    publish_time_ns: int
    definition: str = field(default="", repr=False)


class BagReader:
    """A log to read from. Each call of a method reads the file again."""

    def __init__(self, path: str | Path) -> None:
        """Find the files of a log.

        Args:
            path: a bag folder, whose ``.mcap`` files are read in the order of their numbers, or one such
                file.

        Raises:
            NotALogError: there is no such file.
        """
        path = Path(path)
        self.paths = sorted(path.glob("*.mcap"), key=_split_number) if path.is_dir() else [path]
        self.losses: list[Loss] = []  # what the last reading had to pass over, by then
        if not self.paths or not self.paths[0].is_file():
            raise NotALogError(f"{path}: no MCAP file here")

    @property
    def damage(self) -> str | None:
        """The damage that the last reading met, in words, or None if all was whole."""
        described = [
            _described(path, losses)
            for path in self.paths
            if (losses := [loss for loss in self.losses if loss.path == path])
        ]
        return "\n".join(described) or None

    def messages(self, topics: Collection[str] | None = None) -> Iterator[LoggedMessage]:
        """Yield the messages, of all topics or of the given ones, in the order in which they were written.

        Events of services come after messages that were received while the answer was made. `log_time_ns`
        has the order in which everything happened.
        """
        self.losses = []
        for path in self.paths:
            with self._walk(path) as walk:
                definitions = _Definitions(walk)
                undefined = 0
                for record in walk.records():
                    if isinstance(record, Message):
                        channel = definitions.channel(record.channel_id)
                        if channel is None:
                            undefined += 1
                        elif topics is None or channel[0] in topics:
                            yield LoggedMessage(
                                topic=channel[0],
                                type_name=channel[1],
                                data=record.data,
                                log_time_ns=record.log_time,
                                publish_time_ns=record.publish_time,
                                definition=channel[2],
                            )
                    else:
                        definitions.add(record)
                if undefined:
                    walk.lose_undefined(undefined)

    def definitions(self) -> dict[str, str]:
        """Return the text of each type that the log describes before its first message or at its end.

        Texts in another form than MCAP's ros2msg are left out.
        """
        self.losses = []
        schemas: list[Schema] = []
        for path in self.paths:
            with self._walk(path) as walk:
                for record in walk.records():
                    if isinstance(record, Message):
                        break
                    if isinstance(record, Schema):
                        schemas.append(record)
                schemas += (walk.summary or Summary()).schemas.values()
        return {schema.name: text for schema in schemas if (text := _ros2msg(schema))}

    def run(self) -> dict[str, str]:
        """Return the writer's record of its run. It is empty if the record is missing or damaged."""
        self.losses = []
        for path in self.paths:
            with self._walk(path) as walk:
                for record in walk.records():
                    if isinstance(record, Metadata) and record.name == RUN_RECORD:
                        run = unsealed_run(record.metadata)
                        if run is not None:
                            return run
                        walk.lose_run()
        return {}

    @contextmanager
    def _walk(self, path: Path) -> Iterator[McapWalk]:
        """Open a file to walk through, and say at the end what was lost."""
        with path.open("rb") as stream:
            walk = McapWalk(McapFile(path, stream, path.stat().st_size))
            try:
                yield walk
            finally:  # also where the reading ends early: what was passed over until then
                losses = walk.losses
                if losses:
                    self.losses += losses
                    warnings.warn(_described(path, losses), DamagedLogWarning, stacklevel=4)


class _Definitions:
    """Channels and schemas of one file. The file's summary has those that a lost chunk defined."""

    def __init__(self, walk: McapWalk) -> None:
        self._walk = walk
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._known: dict[int, tuple[str, str, str] | None] = {}

    def add(self, record: WalkedRecord) -> None:
        """Keep a record if it is a definition."""
        if isinstance(record, Schema):
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            self._channels[record.id] = record
            self._known.pop(record.id, None)

    def channel(self, channel_id: int) -> tuple[str, str, str] | None:
        """Return topic, type and its text, which may both be empty, or None if the channel is not defined."""
        if channel_id not in self._known:
            self._known[channel_id] = self._find(channel_id)
        return self._known[channel_id]

    def _find(self, channel_id: int) -> tuple[str, str, str] | None:
        channel = self._channels.get(channel_id) or self._summary.channels.get(channel_id)
        if channel is None or channel.schema_id == 0:
            return None if channel is None else (channel.topic, "", "")
        schema = self._schemas.get(channel.schema_id) or self._summary.schemas.get(channel.schema_id)
        if schema is None:
            return None
        return channel.topic, schema.name, _ros2msg(schema)

    @property
    def _summary(self) -> Summary:
        return self._walk.summary or Summary()


def _ros2msg(schema: Schema) -> str:
    return schema.data.decode(errors="replace") if schema.encoding == "ros2msg" else ""


def _described(path: Path, losses: list[Loss]) -> str:
    told = "; ".join(str(loss) for loss in losses[:_MOST_TOLD])
    more = f"; and {len(losses) - _MOST_TOLD} places more" if len(losses) > _MOST_TOLD else ""
    return f"{path} is damaged or was cut short, all but this was read: {told}{more}"


def _split_number(path: Path) -> tuple[int, str]:
    match = _SPLIT_NUMBER.search(path.name)
    return (int(match[1]) if match else 0, path.name)
