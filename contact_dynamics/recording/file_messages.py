# SPDX-License-Identifier: Apache-2.0
"""The readers of all kinds of files give these types to `bag_reader`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path

    from typing_extensions import Self


class Topic(NamedTuple):
    """A topic of a log.

    Attributes:
        name: Its name.
        type_name: Its type, "package/msg/Name" or "package/srv/Name_Event".
        definition: The text of the type, which is empty unless it has MCAP's form ros2msg.
        qos: The YAML list of what its publishers offered, which `qos.offered_qos` reads, or nothing.
        type_hash: The hash of its type, "RIHS01_...", or nothing.
    """

    name: str
    type_name: str
    definition: str
    qos: str = ""
    type_hash: str = ""


class StoredMessage(NamedTuple):
    """A message as a file has it. Times are in ns since the epoch."""

    topic: Topic
    data: bytes
    log_time_ns: int
    publish_time_ns: int


class Span(NamedTuple):
    """A stretch of log times, ns since the epoch. None means no end on that side."""

    start_ns: int | None = None  # the first time that belongs to it
    end_ns: int | None = None  # the first time after it

    def __contains__(self, log_time_ns: object) -> bool:
        """Return whether a time belongs to it."""
        if not isinstance(log_time_ns, int):
            return False
        return not self.is_before(log_time_ns) and not self.is_after(log_time_ns)

    def is_before(self, log_time_ns: int) -> bool:
        """Return whether a time is too early to belong to it."""
        return self.start_ns is not None and log_time_ns < self.start_ns

    def is_after(self, log_time_ns: int) -> bool:
        """Return whether a time is too late to belong to it."""
        return self.end_ns is not None and log_time_ns >= self.end_ns


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """A stretch of a log that could not be read.

    Attributes:
        begin: Its first byte.
        end: The byte after its last one, or its first byte if only the end of the log is missing.
        messages: Number of lost messages, by the file's summary, or None if there is no summary.
    """

    path: Path
    begin: int
    end: int
    messages: int | None
    reason: str

    def __str__(self) -> str:
        """Say what is lost and why."""
        count = "an unknown number of" if self.messages is None else self.messages
        return f"bytes {self.begin} to {self.end}, {count} messages ({self.reason})"


class MessageFile(Protocol):
    """A file that is open for reading. It is a context manager."""

    @property
    def losses(self) -> list[Loss]:
        """The stretches that could not be read so far."""

    def __enter__(self) -> Self:
        """Open the file."""

    def __exit__(self, *_error: object) -> None:
        """Close it."""

    def messages(self, topics: Collection[str] | None, span: Span) -> Iterator[StoredMessage]:
        """Yield the messages of some topics, or of all, in the order in which they were written."""

    def topics(self) -> list[Topic]:
        """Return the topics that the file describes before its first message or at its end."""

    def definitions(self) -> dict[str, str]:
        """Return the text of each type that the file describes, by the type's name."""

    def extent(self) -> tuple[int, int] | None:
        """Return the first and the last log time, ns, or None without messages.

        Where a file has no index, the last one is not known, and it is the first.
        """

    def run(self) -> dict[str, str] | None:
        """Return the record of the run that made it, or None if the record is missing or damaged."""
