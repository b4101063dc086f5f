# SPDX-License-Identifier: Apache-2.0
"""Reads a log in writing order: a rosbag2 folder or one of its files, from this package or any other writer.

The files are MCAP or SQLite (``.db3``), split or not, compressed by file, by message or not at all. The
reader verifies every MCAP checksum. It skips damaged parts and reads everything else (`mcap_messages`),
including all complete chunks of a log that a crash or a full disk cut short. `BagReader.losses` lists what is
missing, and the reader warns once for each file (`DamagedLogWarning`).

It needs no ROS. Messages are bytes, and `message_types` turns them into message objects if their packages are
installed.
"""

from __future__ import annotations

import re
import warnings
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.bag_metadata import BAG_KEY, METADATA_FILE
from contact_dynamics.recording.definitions import standard_definition
from contact_dynamics.recording.errors import DamagedLogWarning, NotALogError, UnfinishedLogWarning
from contact_dynamics.recording.file_messages import (
    SUFFIXES,
    Loss,
    Span,
    Topic,
    unpacked_file,
    unpacked_message,
)
from contact_dynamics.recording.sqlite_messages import SqliteMessages
from contact_dynamics.validation_types import checks_types

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from contact_dynamics.recording.file_messages import StoredMessage
    from contact_dynamics.recording.mcap_messages import McapMessages

_MAX_TOLD: Final = 5  # number of damaged places that are listed one by one
_NAME: Final = re.compile(
    # Since ROS 2 Lyrical a file is named <number>_<bag>_<time>, and before it <bag>_<number>.
    r"(^(?P<first>\d+)_.*_\d{4}(_\d\d){2}-\d\d(_\d\d){2}|(_(?P<number>\d+))?)"
    r"(?P<kind>\.mcap|\.db3)(\.zstd|\.zst|\.lz4)?$"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class LoggedMessage:
    """One message as it was logged.

    Attributes:
        topic: The topic's name with its leading slash.
        type_name: "package/msg/Name" or "package/srv/Name_Event".
        data: The serialised message (CDR).
        log_time_ns: When the message was received, ns since the epoch.
        publish_time_ns: When its source made it, ns since the epoch.
        definition: The type definition in the log, empty unless its encoding is MCAP's ros2msg.
    """

    topic: str
    type_name: str
    data: bytes = field(repr=False)
    log_time_ns: int
    publish_time_ns: int
    definition: str = field(default="", repr=False)


class BagReader:
    """A log to read from. Each call of a method reads the files again."""

    @checks_types
    def __init__(self, path: str | Path) -> None:
        """Find the files of a log.

        Args:
            path: a bag folder, whose files are read in the order of their numbers, or one such file.

        Raises:
            NotALogError: there is no such file.
        """
        path = Path(path)
        self.paths = _files_of(path) if path.is_dir() else [path]
        self.run_is_later = False  # whether the last record of the run is newer than the log's beginning
        self.losses: list[Loss] = []  # the unreadable stretches that the last reading has met so far
        if not self.paths or not self.paths[0].is_file():
            found = "no MCAP file here, and no .db3 file" if path.exists() else "no such file or folder"
            raise NotALogError(f"{path}: {found}")

    def __repr__(self) -> str:
        """Return the files' names and their size."""
        return f"BagReader of {', '.join(str(path) for path in self.paths)} ({self.size} bytes)"

    @property
    def size(self) -> int:
        """The size of all files together, bytes."""
        return sum(path.stat().st_size for path in self.paths)

    @property
    def damage(self) -> str | None:
        """A description of the damage that the last reading met, or None if there was none."""
        described = [
            _described(path, losses)
            for path in self.paths
            if (losses := [loss for loss in self.losses if loss.path == path])
        ]
        return "\n".join(described) or None

    def messages(
        self, topics: Collection[str] | None = None, *, start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[LoggedMessage]:
        """Yield the messages in the order in which they were written.

        Events of services come after messages that were received while the answer was made. `log_time_ns`
        has the order in which everything happened.

        Args:
            topics: the topics to read. None means all.
            start_ns: the earliest log time, ns since the epoch. Earlier messages are left out. If a file has
                an index, only the chunks that it names are read.
            end_ns: the end of the log times, ns. Messages of this time or later are left out.
        """
        given = {"start_ns": start_ns, "end_ns": end_ns}
        span = Span(**{name: time_ns for name, time_ns in given.items() if time_ns is not None})
        self.losses = []
        for path in self.paths:
            with self._opened(path) as file:
                for message in file.messages(topics, span):
                    made = self._made(path, message)
                    if made is not None:
                        yield made

    def topics(self) -> list[Topic]:
        """Return the topics that the log describes before its first message or at its end."""
        self.losses = []
        found: dict[str, Topic] = {}
        for path in self.paths:
            with self._opened(path) as file:
                found |= {topic.name: topic for topic in file.topics()}
        return list(found.values())

    def definitions(self) -> dict[str, str]:
        """Return the text of each type that the log describes before its first message or at its end.

        Texts in encodings other than MCAP's ros2msg are left out.
        """
        return {topic.type_name: topic.definition for topic in self.topics() if topic.definition}

    def extent(self) -> tuple[int, int]:
        """Return the first and the last log time, ns since the epoch; both are zero without messages.

        They come from the index of each file. If the last file has none, the last time is that of its first
        message.
        """
        self.losses = []
        found: list[tuple[int, int]] = []
        for path in self.paths:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DamagedLogWarning)  # reported when the messages are read
                with self._opened(path) as file:
                    extent = file.extent()
            if extent is not None:
                found.append(extent)
        if not found:
            return 0, 0
        return min(start_ns for start_ns, _ in found), max(end_ns for _, end_ns in found)

    def run(self) -> dict[str, str]:
        """Return the writer's record of its run.

        If the record in the first file is damaged, return that of a later file, or of the bag's
        ``metadata.yaml``, and set `run_is_later`. The record is empty if none is intact.
        """
        self.losses = []
        self.run_is_later = False
        for path in self.paths:
            with self._opened(path) as file:
                run = file.run()
            if run is not None:
                return run
            self.run_is_later = True
        return self._run_of_metadata() if self.losses else {}

    def _run_of_metadata(self) -> dict[str, str]:
        """Return the record in ``metadata.yaml`` if that file describes the first file."""
        import yaml  # only damaged logs need it

        path = self.paths[0]
        try:
            bag = yaml.safe_load((path.parent / METADATA_FILE).read_text(encoding="utf-8"))[BAG_KEY]
            run: dict[str, str] = bag["custom_data"] or {}
            return run if path.name in bag["relative_file_paths"] else {}
        except (OSError, ValueError, LookupError, TypeError, yaml.YAMLError):
            return {}

    def _made(self, path: Path, stored: StoredMessage) -> LoggedMessage | None:
        topic, data, log_time_ns, publish_time_ns = stored
        if data[:1] != b"\0":  # no serialised message: perhaps a compressed one
            try:
                data = unpacked_message(data)
            except InvalidFieldError as error:
                self.losses.append(
                    Loss(path=path, begin=0, end=path.stat().st_size, messages=1, reason=str(error))
                )
                return None
        return LoggedMessage(
            topic=topic.name,
            type_name=topic.type_name,
            data=data,
            log_time_ns=log_time_ns,
            publish_time_ns=publish_time_ns,
            definition=topic.definition or standard_definition(topic.type_name),
        )

    @contextmanager
    def _opened(self, path: Path) -> Iterator[McapMessages | SqliteMessages]:
        """Open a file, and report at the end what was lost."""
        from contact_dynamics.recording.mcap_messages import McapMessages  # mcap is optional for a server

        with unpacked_file(path) as (plain, cut):
            match = _NAME.search(path.name)
            is_sqlite = match is not None and match["kind"] == ".db3"
            with SqliteMessages(plain) if is_sqlite else McapMessages(plain) as file:
                before = len(self.losses)
                try:
                    yield file
                finally:  # this happens also if the reading ends early
                    losses = [replace(loss, path=path) for loss in file.losses]
                    if cut is not None:
                        losses.append(
                            Loss(path=path, begin=0, end=path.stat().st_size, messages=None, reason=cut)
                        )
                    self.losses += losses
                    if self.losses[before:]:
                        told = _described(path, self.losses[before:])
                        warnings.warn(told, kind_of(self.losses[before:]), stacklevel=4)


def _files_of(folder: Path) -> list[Path]:
    """Return the files of a bag. If a compressed file was unpacked beside it, use the unpacked one."""
    matches = {path: match for path in folder.iterdir() if (match := _NAME.search(path.name)) is not None}
    files = [path for path in matches if path.suffix not in SUFFIXES or path.with_suffix("") not in matches]
    return sorted(
        files, key=lambda path: (int(matches[path]["first"] or matches[path]["number"] or 0), path.name)
    )


def kind_of(losses: list[Loss]) -> type[DamagedLogWarning]:
    """Return the kind of damage: a damaged log, or one that only lacks its end."""
    return UnfinishedLogWarning if all(loss.begin == loss.end for loss in losses) else DamagedLogWarning


def _described(path: Path, losses: list[Loss]) -> str:
    if kind_of(losses) is UnfinishedLogWarning:
        read = losses[0].end
        return f"{path} is still being written, or its writer was killed; all {read} bytes of it were read"
    told = "; ".join(str(loss) for loss in losses[:_MAX_TOLD])
    more = f"; and {len(losses) - _MAX_TOLD} places more" if len(losses) > _MAX_TOLD else ""
    return f"{path} is damaged or was cut short, all but this was read: {told}{more}"
