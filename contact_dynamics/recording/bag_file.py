# SPDX-License-Identifier: Apache-2.0
"""Writes one MCAP file of a log; `bag_writer.BagWriter` writes a folder of them."""

from __future__ import annotations

import contextlib
import json
import os
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.recording.bag_metadata import (
    OFFERED_QOS,
    RUN_RECORD,
    TYPE_HASH,
    FileSummary,
    qos_maps,
    sealed_run,
)
from contact_dynamics.recording.limits import Compression

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from contact_dynamics.recording.bag_metadata import DeclaredTopic, OfferedQos

CHUNK_BYTES: Final = 256 * 1024


class BagFile:
    """A file that grows by complete chunks. Methods raise `OSError` if a write fails.

    After the first failure the file is cut back to its state after the last `flush`, which is readable, and
    `failure` contains the reason.
    """

    def __init__(
        self, path: Path, *, run: Mapping[str, str], compression: Compression, opened_ns: int
    ) -> None:
        """Create a file, which must not exist, and write the record of the run at its head.

        ``opened_ns`` is the present time, ns since the epoch; the file's time span begins and ends there
        until the first message.
        """
        from mcap.writer import CompressionType, Writer  # optional: without it, the server writes no log

        self.path = path
        self.failure: str | None = None
        self.start_ns: int | None = None
        self._end_ns = opened_ns
        self._opened_ns = opened_ns
        self._counts: dict[str, int] = {}  # messages given, by topic
        self._safe_counts: dict[str, int] = {}  # messages in the file
        self._defined: dict[tuple[str, str, tuple[OfferedQos, ...]], int] = {}  # channels
        self._channels: dict[str, int] = {}  # the current ones, by topic
        self._schemas: dict[str, int] = {}
        self._file = AppendFile(path)
        self._safe_size = 0
        self._writer: Any = Writer(  # Any: the library is only partly typed
            self._file,  # type: ignore[arg-type]  # has what the library calls: write, tell, flush
            chunk_size=CHUNK_BYTES,
            compression=CompressionType[compression.name],
            enable_data_crcs=True,
        )
        try:
            self._writer.start(profile="ros2", library=f"contact_dynamics {run['version']}")
            self._writer.add_metadata(RUN_RECORD, sealed_run(run))
            self._safe_size = self._file.tell()
        except OSError:
            self._file.close()
            path.unlink(missing_ok=True)
            raise

    @property
    def size(self) -> int:
        """The current size of the file, bytes, without the chunk that is still being filled."""
        return self._file.tell()

    @property
    def summary(self) -> FileSummary:
        """Summary of the flushed content, which survives the death of this process."""
        return FileSummary(
            name=self.path.name,
            # Before the first message the start is when the file was opened, not the end of time as rosbag2
            # has it: should the process be killed, `ros2 bag play` starts its clock there.
            start_ns=self._opened_ns if self.start_ns is None else self.start_ns,
            end_ns=self._end_ns,
            counts=dict(self._safe_counts),
            size=self.size,
        )

    def add_topic(self, topic: DeclaredTopic) -> None:
        """Write a topic's definition, which applies to its messages from now on."""
        name, definition, qos = topic.name, topic.definition, topic.qos
        with self._cut_back_on_failure():
            type_name = definition.type_name
            if type_name not in self._schemas:
                text = definition.text.encode()
                self._schemas[type_name] = self._writer.register_schema(type_name, "ros2msg", text)
            key = (name, type_name, qos)
            if key not in self._defined:  # a file has 65535 channels at most, and publishers come and go
                self._defined[key] = self._writer.register_channel(
                    topic=name,
                    message_encoding="cdr",
                    schema_id=self._schemas[type_name],
                    metadata={OFFERED_QOS: json.dumps(qos_maps(qos)), TYPE_HASH: definition.type_hash},
                )
            self._channels[name] = self._defined[key]
        self._counts.setdefault(name, 0)
        self._safe_counts.setdefault(name, 0)

    def write(self, topic: str, data: bytes, *, log_time_ns: int, publish_time_ns: int) -> None:
        """Append a message of a topic that was added."""
        try:  # a context manager would take a tenth of the time to log a message
            self._writer.add_message(
                channel_id=self._channels[topic],
                log_time=log_time_ns,
                data=data,
                publish_time=publish_time_ns,
            )
        except Exception as error:
            self._cut_back(error)
            raise
        self._counts[topic] += 1
        if self.start_ns is None:
            self.start_ns = self._end_ns = log_time_ns
        else:
            self.start_ns, self._end_ns = min(self.start_ns, log_time_ns), max(self._end_ns, log_time_ns)

    def flush(self) -> None:
        """Write all messages so far to the file, where they survive the death of this process."""
        with self._cut_back_on_failure():
            self._writer.flush()
            self._mark_safe()

    def sync(self) -> None:
        """Wait until all flushed data are on the disk, where they survive the death of the machine."""
        with self._cut_back_on_failure():
            self._file.sync()

    def finish(self, metadata: Mapping[str, Any]) -> None:
        """Write rosbag2's own record, the index and the end."""
        with self._cut_back_on_failure():
            self._writer.flush()
            self._mark_safe()
            self._writer.add_metadata(
                "rosbag2", {"serialized_metadata": json.dumps(metadata, ensure_ascii=False)}
            )
            self._writer.finish()
            self._safe_size = self._file.tell()
            self._file.sync()

    def close(self) -> None:
        """Close the file as it is."""
        self._file.close()

    def _mark_safe(self) -> None:
        self._safe_size = self._file.tell()
        self._safe_counts = dict(self._counts)

    @contextlib.contextmanager
    def _cut_back_on_failure(self) -> Iterator[None]:
        try:
            yield
        except Exception as error:
            self._cut_back(error)
            raise

    def _cut_back(self, error: Exception) -> None:
        """Cut the file back to its last complete state."""
        self.failure = f"an earlier write failed: {error}"
        with contextlib.suppress(OSError):
            self._file.cut_back(self._safe_size)


class AppendFile:
    """An append-only stream with the methods that ``mcap.writer.Writer`` needs.

    It is unbuffered, so a kill loses nothing that was written. Python's buffered file keeps data that a full
    disk rejected, and then cannot be closed. This stream can be closed, and cut back to its last complete
    state.
    """

    def __init__(self, path: Path) -> None:
        """Create the file. If it exists, raise `FileExistsError`."""
        self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
        self._size = 0

    def write(self, data: bytes | bytearray | memoryview) -> int:
        """Pass all of ``data`` to the operating system, or raise `OSError` if the write fails."""
        rest = memoryview(data)
        while rest:
            count = os.write(self._descriptor, rest)
            self._size += count
            rest = rest[count:]
        return len(data)

    def tell(self) -> int:
        """Return the number of bytes written."""
        return self._size

    def flush(self) -> None:
        """Do nothing: the stream is unbuffered."""

    def sync(self) -> None:
        """Wait until all written data are on the disk, or raise `OSError` if that fails."""
        os.fdatasync(self._descriptor)

    def cut_back(self, size: int) -> None:
        """Truncate the file to ``size`` bytes."""
        os.ftruncate(self._descriptor, size)
        os.lseek(self._descriptor, size, os.SEEK_SET)
        self._size = size

    def close(self) -> None:
        """Close the file."""
        os.close(self._descriptor)
