# SPDX-License-Identifier: Apache-2.0
"""`contact-dynamics recover` rewrites a damaged or unfinished log so that every reader accepts it.

The readable part is written to a new folder: the same topics, types and messages, with an index, an end, and
a matching ``metadata.yaml``. The damaged log is not changed.
"""

from __future__ import annotations

import sys
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import ContactDynamicsError, NotSupportedError
from contact_dynamics.recording.bag_file import BagFile
from contact_dynamics.recording.bag_metadata import (
    METADATA_FILE,
    DeclaredTopic,
    file_text_of,
    metadata_of,
    offered_qos,
)
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.definitions import TypeDefinition
from contact_dynamics.recording.errors import LogExistsError
from contact_dynamics.recording.file_messages import Span, unpacked_file
from contact_dynamics.recording.limits import Compression
from contact_dynamics.recording.mcap_messages import McapMessages
from contact_dynamics.replay.arguments import recover_parser
from contact_dynamics.replay.progress import Progress

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from contact_dynamics.recording.bag_metadata import FileSummary
    from contact_dynamics.recording.file_messages import Loss, Topic

REFUSED: Final = 2  # exit code if nothing was written


def main(arguments: list[str]) -> int:
    """Rewrite a log and return the exit code."""
    parser = recover_parser()
    given = parser.parse_args(arguments)
    if given.log is None:  # argparse would report this before a mistyped option
        parser.error("a LOG is required")
    path = Path(given.log)
    named = path.resolve() if path.name in {"", ".."} else path  # . and .. are no names
    folder = (
        Path(given.output) if given.output else named.with_name(f"{named.name.partition('.')[0]}_recovered")
    )
    progress = Progress(str(path))
    try:
        messages, losses = recover(
            path, folder, on_progress=lambda count: progress.tell(count, f"{count} messages")
        )
    except (ContactDynamicsError, OSError) as error:
        print(f"contact-dynamics recover: {error}", file=sys.stderr)
        return REFUSED
    finally:
        progress.end()
    print(f"{folder}: {messages} messages")
    for loss in losses:
        print(f"  lost of {loss.path}: {loss}")
    return 0


_TOLD_EVERY: Final = 1000  # messages


def recover(
    path: Path, folder: Path, *, on_progress: Callable[[int], object] = lambda _: None
) -> tuple[int, list[Loss]]:
    """Write the readable part of a log to a new folder; return the number of messages, and the losses.

    ``on_progress`` is called now and then with the number of messages written.

    Raises:
        NotALogError: the path is not a log.
        NotSupportedError: the log is SQLite, which SQLite's own tools repair.
        LogExistsError: the folder exists.
        OSError: a write failed.
    """
    paths = BagReader(path).paths
    for each in paths:
        if ".db3" in each.name:
            message = f"{each} must be MCAP, got SQLite, which `sqlite3 {each.name} .recover` repairs"
            raise NotSupportedError(message)
    try:
        folder.mkdir(parents=True)
    except FileExistsError as error:
        raise LogExistsError(f"{folder} exists; a log is never overwritten") from error
    try:
        return _rewritten(paths, folder, on_progress)
    except BaseException:
        with suppress(OSError):
            folder.rmdir()  # which it can be if nothing was written
        raise


def _rewritten(
    paths: Sequence[Path], folder: Path, on_progress: Callable[[int], object]
) -> tuple[int, list[Loss]]:
    run: dict[str, str] = {}  # the record of the latest file that has one
    losses: list[Loss] = []
    summaries: list[FileSummary] = []
    topics: dict[str, DeclaredTopic] = {}
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
    metadata = metadata_of(summaries, topics.values(), run)
    (folder / METADATA_FILE).write_text(file_text_of(metadata), encoding="utf-8")
    return written, losses


def _rewrite(
    damaged: McapMessages,
    target: Path,
    run: dict[str, str],
    topics: dict[str, DeclaredTopic],
    *,
    on_written: Callable[[int], object],
) -> FileSummary:
    """Rewrite one file, add its topics to those of the log, and return its summary."""
    file = BagFile(target, run={"version": "unknown", **run}, compression=Compression.ZSTD, opened_ns=0)
    defined: dict[str, Topic] = {}
    try:
        for count, message in enumerate(damaged.messages(None, Span()), start=1):
            topic = message.topic
            if defined.get(topic.name) != topic:
                defined[topic.name] = topic
                topics[topic.name] = _declared(topic)
                file.add_topic(topics[topic.name])
            file.write(
                topic.name,
                message.data,
                log_time_ns=message.log_time_ns,
                publish_time_ns=message.publish_time_ns,
            )
            if count % _TOLD_EVERY == 0:
                on_written(count)
        file.flush()
        file.finish(metadata_of([file.summary], [topics[name] for name in defined], run))
    finally:
        file.close()
    return file.summary


def _declared(topic: Topic) -> DeclaredTopic:
    definition = TypeDefinition(
        type_name=topic.type_name,
        text=topic.definition,
        type_hash=topic.type_hash,
        begins_with_stamp=False,  # the times of the messages are known
    )
    return DeclaredTopic(name=topic.name, definition=definition, qos=tuple(offered_qos(topic.qos)))
