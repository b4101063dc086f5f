# SPDX-License-Identifier: Apache-2.0
"""Rewrites a damaged or unfinished log, so that every reader takes it.

What `mcap_walk` reads is written into a new folder: the same topics, types and messages, with an index and an
end, and a ``metadata.yaml`` that fits. The damaged log stays as it is.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mcap.records import Channel, Message, Metadata, Schema

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.recording.bag_file import BagFile
from contact_dynamics.recording.bag_metadata import (
    METADATA_FILE,
    OFFERED_QOS,
    RUN_RECORD,
    TYPE_HASH,
    BagSummary,
    TopicSummary,
    metadata_file_text,
    metadata_lines,
    unsealed_run,
)
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.definitions import EVENT_SUFFIX, TypeDefinition
from contact_dynamics.recording.errors import LogExistsError
from contact_dynamics.recording.limits import Compression
from contact_dynamics.recording.mcap_file import McapFile
from contact_dynamics.recording.mcap_summary import Summary
from contact_dynamics.recording.mcap_walk import McapWalk
from contact_dynamics.recording.packed import unpacked_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from contact_dynamics.recording.bag_metadata import FileSummary
    from contact_dynamics.recording.file_messages import Loss

_TOLD_EVERY: Final = 1000  # messages


@dataclass(frozen=True, slots=True, kw_only=True)
class Recovered:
    """What came of a recovery.

    Attributes:
        folder: The new log.
        messages: Number of messages in it.
        losses: What of the damaged log could not be read.
    """

    folder: Path
    messages: int
    losses: tuple[Loss, ...]


def recover(path: Path, folder: Path, *, on_progress: Callable[[int], object] = lambda _: None) -> Recovered:
    """Write what can be read of a log into a new folder.

    Args:
        path: the log: its folder, or one of its files.
        folder: the new folder.
        on_progress: a function that is told now and then how many messages were written.

    Raises:
        NotALogError: it is no log.
        NotSupportedError: it is SQLite, which its own tools repair.
        LogExistsError: the folder exists.
        OSError: the disk refuses.
    """
    paths = BagReader(path).paths
    for each in paths:
        if ".db3" in each.name:
            message = f"{each} must be MCAP, got SQLite, which `sqlite3 {each.name} .recover` repairs"
            raise NotSupportedError(message)
    try:
        folder.mkdir(parents=True)
    except FileExistsError as error:
        message = f"{folder} exists; a log is never overwritten"
        raise LogExistsError(message) from error
    try:
        return _rewritten(paths, folder, on_progress)
    except BaseException:
        with suppress(OSError):
            folder.rmdir()  # which it can be if nothing was written
        raise


def _rewritten(paths: Sequence[Path], folder: Path, on_progress: Callable[[int], object]) -> Recovered:
    run: dict[str, str] = {}
    losses: list[Loss] = []
    summaries: list[FileSummary] = []
    topics: dict[str, TopicSummary] = {}
    written = 0
    for number, each in enumerate(paths):
        with unpacked_file(each) as (plain, _), plain.open("rb") as stream:
            walk = McapWalk(McapFile(each, stream, plain.stat().st_size))
            rewriting = _Rewriting(walk, folder / f"{folder.name}_{number}.mcap", run=run)
            for count in rewriting.write():
                on_progress(written + count)
            summary = rewriting.finish()
            run = rewriting.run
            losses += walk.losses
        written += sum(summary.counts.values())
        summaries.append(summary)
        topics |= rewriting.topics
    bag = BagSummary(files=summaries, topics=list(topics.values()), custom_data=run)
    (folder / METADATA_FILE).write_text(metadata_file_text(bag), encoding="utf-8")
    return Recovered(folder=folder, messages=written, losses=tuple(losses))


class _Rewriting:
    """One file that is written anew. The new one begins when the record of the run has come, or a message."""

    def __init__(self, walk: McapWalk, path: Path, *, run: dict[str, str]) -> None:
        self.run = run  # what the files before have told, until this one does
        self.topics: dict[str, TopicSummary] = {}
        self._walk = walk
        self._path = path
        self._file: BagFile | None = None
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._names: dict[int, str | None] = {}  # by channel; None where nothing defines it

    def write(self) -> Iterator[int]:
        """Write all that is whole, and yield now and then how many messages that was."""
        count = undefined = 0
        for record in self._walk.records():
            if isinstance(record, Schema):
                self._schemas[record.id] = record
            elif isinstance(record, Channel):
                self._channels[record.id] = record
                self._names.pop(record.id, None)
            elif isinstance(record, Metadata):
                if record.name == RUN_RECORD and self._file is None:
                    self.run = unsealed_run(record.metadata) or self.run
            elif isinstance(record, Message):
                name = self._name_of(record.channel_id)
                if name is None:
                    undefined += 1
                    continue
                self._opened().write(
                    name, record.data, log_time_ns=record.log_time, publish_time_ns=record.publish_time
                )
                count += 1
                if count % _TOLD_EVERY == 0:
                    yield count
        if undefined:
            self._walk.lose_undefined(undefined)

    def finish(self) -> FileSummary:
        """End the new file and return what is in it."""
        file = self._opened()
        try:
            file.flush()
            bag = BagSummary(files=[file.summary], topics=list(self.topics.values()), custom_data=self.run)
            file.finish("\n".join(metadata_lines(bag)))
        finally:
            file.close()
        return file.summary

    def _opened(self) -> BagFile:
        if self._file is None:
            run = {"version": "unknown", **self.run}
            self._file = BagFile(self._path, run=run, compression=Compression.ZSTD, opened_ns=0)
        return self._file

    def _name_of(self, channel_id: int) -> str | None:
        if channel_id not in self._names:
            self._names[channel_id] = self._define(channel_id)
        return self._names[channel_id]

    def _define(self, channel_id: int) -> str | None:
        """Define a channel in the new file as in the old one; its summary helps where a chunk is lost."""
        summary = self._walk.summary or Summary()
        channel = self._channels.get(channel_id) or summary.channels.get(channel_id)
        if channel is None:
            return None
        schema = self._schemas.get(channel.schema_id) or summary.schemas.get(channel.schema_id)
        if schema is None:
            return None
        qos = tuple(channel.metadata.get(OFFERED_QOS, "").splitlines()) or ("[]",)
        known = self.topics.get(channel.topic)
        if known is None or known.qos != qos:
            type_hash = channel.metadata.get(TYPE_HASH, "")
            definition = TypeDefinition(
                type_name=schema.name,
                text=schema.data.decode(errors="replace"),
                type_hash=type_hash,
                begins_with_stamp=False,  # the times of the messages are known
            )
            self._opened().add_topic(channel.topic, definition, qos)
            self.topics[channel.topic] = TopicSummary(
                name=channel.topic,
                type_name=schema.name,
                type_hash="" if schema.name.endswith(EVENT_SUFFIX) else type_hash,
                qos=qos,
            )
        return channel.topic
