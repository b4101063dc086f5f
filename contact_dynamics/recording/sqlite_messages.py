# SPDX-License-Identifier: Apache-2.0
"""Reads the messages of a ``.db3`` file of rosbag2, which is an SQLite database.

SQLite has no checksums, so a flipped bit within a message is not detected. If the structure of the file is
damaged, the reader yields the messages that it can reach on both sides of the damage.
"""

from __future__ import annotations

import sqlite3
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.recording.errors import NotALogError
from contact_dynamics.recording.file_messages import MAX_BYTES, Loss, Span, StoredMessage, Topic

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path

    from typing_extensions import Self

_HEADER: Final = b"SQLite format 3\0"
_NEXT_ROWS: Final = (
    "SELECT id, topic_id, timestamp, data FROM messages "
    "WHERE id > ? AND id <= ? AND topic_id IN ({}) ORDER BY id"
)
_QOS: Final = "offered_qos_profiles"
_TOPICS: Final = "SELECT id, name, type, serialization_format, offered_qos_profiles FROM topics"
_TOPICS_OF_DASHING: Final = "SELECT id, name, type, serialization_format, '' FROM topics"
_SPANNED: Final = " AND timestamp >= ? AND timestamp < ?"
_MAX_ID: Final = 2**63 - 1


class SqliteMessages:
    """A database to read from, with the methods of `McapMessages`."""

    def __init__(self, path: Path) -> None:
        """Set the file, which `__enter__` opens."""
        self._path = path
        self.losses: list[Loss] = []

    def __enter__(self) -> Self:
        """Open the file, or raise `NotALogError` if it is not a database of rosbag2."""
        with self._path.open("rb") as stream:
            if stream.read(len(_HEADER)) != _HEADER:
                raise NotALogError(f"{self._path} is not an SQLite file")
        self._database = self._opened()
        return self

    def __exit__(self, *_error: object) -> None:
        """Close the file."""
        self._database.close()

    def messages(self, topics: Collection[str] | None, span: Span) -> Iterator[StoredMessage]:
        """Yield the messages of some topics, or of all, in the order in which they were written."""
        known = {
            number: topic
            for number, topic in self._topics().items()
            if topics is None or topic.name in topics
        }
        ids = ", ".join(str(number) for number in known)
        query = _NEXT_ROWS.format(ids)
        bounds: tuple[int, ...] = ()
        if span != Span():
            query, bounds = query.replace(" ORDER", f"{_SPANNED} ORDER"), span
        for _, topic_id, timestamp, data in self._rows(query, bounds):
            if isinstance(timestamp, int) and isinstance(data, bytes):
                yield StoredMessage(known[topic_id], data, timestamp, timestamp)

    def topics(self) -> list[Topic]:
        """Return the topics of the file."""
        return list(self._topics().values())

    def extent(self) -> tuple[int, int] | None:
        """Return the first and the last log time, ns, or None without messages that can be reached."""
        with suppress(sqlite3.Error):
            for start_ns, end_ns in self._database.execute(
                "SELECT min(timestamp), max(timestamp) FROM messages"
            ):
                return None if start_ns is None else (int(start_ns), int(end_ns))
        return None

    def run(self) -> None:
        """Return None, because the server writes no database."""

    def _opened(self) -> sqlite3.Connection:
        """Return a read-only connection, which does not even apply the journal that a killed writer left."""
        address = self._path.resolve().as_uri()
        error: Exception | None = None
        for options in ("mode=ro", "mode=ro&immutable=1"):  # the latter for read-only folders
            database = sqlite3.connect(f"{address}?{options}", uri=True, check_same_thread=False)
            try:
                if hasattr(database, "setlimit"):  # not yet in Python 3.10
                    database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_BYTES)
                tables = database.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
                found = {name for (name,) in tables}
            except sqlite3.Error as caught:
                database.close()
                error = caught
                continue
            if {"messages", "topics"} <= found:
                return database
            database.close()
            message = f"{self._path}: no bag of rosbag2: its tables are {', '.join(sorted(found)) or 'none'}"
            raise NotALogError(message)
        raise NotALogError(f"{self._path}: {error}") from None

    def _definitions(self) -> dict[str, str]:
        """Return the text of each type. Bags from before ROS 2 Iron have none."""
        with suppress(sqlite3.Error):
            rows = self._database.execute(
                "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
            )
            return {str(name): str(text) for name, encoding, text in rows if encoding == "ros2msg" and text}
        return {}

    def _topics(self) -> dict[int, Topic]:
        texts = self._definitions()
        try:
            columns = {row[1] for row in self._database.execute("PRAGMA table_info(topics)")}
            rows = self._database.execute(_TOPICS if _QOS in columns else _TOPICS_OF_DASHING).fetchall()
        except sqlite3.Error as error:
            self._lose(f"the table of topics: {error}")
            return {}
        return {
            int(number): Topic(str(name), str(kind), texts.get(str(kind), ""), str(qos))
            for number, name, kind, encoding, qos in rows
            if encoding == "cdr" and isinstance(number, int)
        }

    def _rows(self, query: str, bounds: tuple[int, ...]) -> Iterator[Any]:
        """Yield rows by their number. After damage, skip ahead in growing steps until rows are readable."""
        last, end = 0, self._last_id()
        step = 1
        while last < end:
            try:
                for row in self._database.execute(query, (last, end, *bounds)):
                    last, step = row[0], 1
                    yield row
            except sqlite3.Error as error:  # noqa: PERF203  an error ends one query, not the rows
                self._lose(f"rows from {last + 1} on, as far as they cannot be reached: {error}")
                last, step = last + step, 2 * step
            else:
                return

    def _last_id(self) -> int:
        with suppress(sqlite3.Error):
            for (number,) in self._database.execute("SELECT max(id) FROM messages"):
                return number if isinstance(number, int) else 0
        return min(_MAX_ID, self._path.stat().st_size)  # no file has more rows than bytes

    def _lose(self, reason: str) -> None:
        loss = Loss(path=self._path, begin=0, end=self._path.stat().st_size, messages=None, reason=reason)
        if not self.losses or self.losses[-1].reason.partition(":")[2] != reason.partition(":")[2]:
            self.losses.append(loss)
