# SPDX-License-Identifier: Apache-2.0
"""Rewrites a damaged or unfinished log, so that every reader takes it.

What can be read is written into a new folder: the same topics, types and messages, with an index and an end,
and a ``metadata.yaml`` that fits. The damaged log stays as it is.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.recording.bag_file import BagFile
from contact_dynamics.recording.bag_metadata import (
    METADATA_FILE,
    BagSummary,
    TopicSummary,
    metadata_file_text,
    metadata_text,
)
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.definitions import EVENT_SUFFIX, TypeDefinition
from contact_dynamics.recording.errors import LogExistsError
from contact_dynamics.recording.file_messages import Span, unpacked_file
from contact_dynamics.recording.limits import Compression
from contact_dynamics.recording.mcap_messages import McapMessages
from contact_dynamics.recording.qos import offered_qos

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from contact_dynamics.recording.bag_metadata import FileSummary
    from contact_dynamics.recording.file_messages import Loss, Topic

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
    run: dict[str, str] = {}  # what the files before have told, until one tells another
    losses: list[Loss] = []
    summaries: list[FileSummary] = []
    topics: dict[str, TopicSummary] = {}
    written = 0

    def told(count: int) -> None:
        on_progress(written + count)

    for number, each in enumerate(paths):
        with unpacked_file(each) as (plain, _):
            with McapMessages(plain) as damaged:
                run = damaged.run() or run
                lost = dict.fromkeys(damaged.losses)
            with McapMessages(plain) as damaged:
                target = folder / f"{folder.name}_{number}.mcap"
                summary = _rewrite(damaged, target, run, topics, on_written=told)
                lost |= dict.fromkeys(damaged.losses)
        losses += [replace(loss, path=each) for loss in lost]
        written += sum(summary.counts.values())
        summaries.append(summary)
    bag = BagSummary(files=summaries, topics=list(topics.values()), custom_data=run)
    (folder / METADATA_FILE).write_text(metadata_file_text(bag), encoding="utf-8")
    return Recovered(folder=folder, messages=written, losses=tuple(losses))


def _rewrite(
    damaged: McapMessages,
    target: Path,
    run: dict[str, str],
    topics: dict[str, TopicSummary],
    *,
    on_written: Callable[[int], object],
) -> FileSummary:
    """Write one file anew, add its topics to those of the log, and return what is in it."""
    file = BagFile(target, run={"version": "unknown", **run}, compression=Compression.ZSTD, opened_ns=0)
    defined: dict[str, Topic] = {}
    try:
        for count, message in enumerate(damaged.messages(None, Span()), start=1):
            topic = message.topic
            if defined.get(topic.name) != topic:
                defined[topic.name] = topic
                topics[topic.name] = _defined(file, topic)
            file.write(
                topic.name,
                message.data,
                log_time_ns=message.log_time_ns,
                publish_time_ns=message.publish_time_ns,
            )
            if count % _TOLD_EVERY == 0:
                on_written(count)
        file.flush()
        of_file = [topics[name] for name in defined]
        file.finish(metadata_text(BagSummary(files=[file.summary], topics=of_file, custom_data=run)))
    finally:
        file.close()
    return file.summary


def _defined(file: BagFile, topic: Topic) -> TopicSummary:
    """Define a topic in a new file as it was in the old one."""
    qos = tuple(offered_qos(topic.qos))
    definition = TypeDefinition(
        type_name=topic.type_name,
        text=topic.definition,
        type_hash=topic.type_hash,
        begins_with_stamp=False,  # the times of the messages are known
    )
    file.add_topic(topic.name, definition, qos)
    return TopicSummary(
        name=topic.name,
        type_name=topic.type_name,
        type_hash="" if topic.type_name.endswith(EVENT_SUFFIX) else topic.type_hash,
        qos=qos,
    )
