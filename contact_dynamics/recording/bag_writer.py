# SPDX-License-Identifier: Apache-2.0
"""Writes a log: a folder of MCAP files and the ``metadata.yaml`` that makes it a bag of rosbag2 (Jazzy).

Each file has these parts:

- The profile is ``ros2``.
- Each type has a schema with its full definition (`definitions`), so a reader does not need our packages.
- Each topic has a channel with its quality of service and type hash.
- Chunks are small and compressed (256 KiB, closed by each `BagWriter.flush`), so that a kill of the process
  loses only the messages since the last flush.
- A metadata record ``contact_dynamics`` at the head describes the run; rosbag2's own record is at the end.

`limits.LogLimits` determines when a new file begins and which files are kept. The index of a file grows with
each chunk and is freed with its file.

The writer is not thread-safe; `recorder.Recorder` owns one on its own thread. Messages are bytes as a
subscription with ``raw=True`` receives them. The result of ``rclpy.serialization.serialize_message`` ends in
random bytes and must not be logged. Flushed messages survive the death of the process, synchronised ones also
that of the machine.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import shutil
import time
from contextlib import AbstractContextManager
from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from contact_dynamics.constants import NS_PER_S
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.bag_file import BagFile
from contact_dynamics.recording.bag_metadata import (
    CHECKSUM_KEY,
    METADATA_FILE,
    DeclaredTopic,
    file_text_of,
    metadata_of,
    offers_of,
)
from contact_dynamics.recording.cdr import event_info, leading_stamp_ns
from contact_dynamics.recording.definitions import find_definition
from contact_dynamics.recording.errors import LogExistsError, LogFailedError
from contact_dynamics.recording.limits import UNLIMITED, LogLimits
from contact_dynamics.validation_types import checks_types
from contact_dynamics.version import version_of_this_package

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from contact_dynamics.recording.bag_metadata import FileSummary
    from contact_dynamics.recording.definitions import TypeDefinition

_LATEST_NS: Final = 2**63 - 1  # rosbag2 keeps times as int64
_SHORTEST_MESSAGE: Final = 5  # bytes: encapsulation, and one byte of content even in an empty message
_DELETED_KEY: Final = "deleted_files"  # in metadata.yaml: number of files deleted to keep the limit
_LEAST_ROOM: Final = 1_000_000  # bytes of free disk space required to resume a log
_METADATA_EVERY_S: Final = 5.0  # update period of the counts in metadata.yaml


_GAPS_KEY: Final = "gaps"  # in the record of the run


class Gap(NamedTuple):
    """A time in which messages were lost."""

    from_ns: int  # time of reception of the first of them, ns since the epoch
    until_ns: int  # time at which the log resumed, ns since the epoch
    lost: int  # number of messages

    def __str__(self) -> str:
        """Describe what is missing."""
        began = datetime.fromtimestamp(self.from_ns / NS_PER_S, timezone.utc)
        seconds = (self.until_ns - self.from_ns) / NS_PER_S
        return f"{self.lost} messages of {seconds:.1f} s from {began:%Y-%m-%d %H:%M:%S} UTC are missing"


def _record_of_gaps(gaps: Sequence[Gap]) -> dict[str, str]:
    """Return the run record's entry about gaps."""
    return {_GAPS_KEY: json.dumps([gap._asdict() for gap in gaps])} if gaps else {}


def _stamp_ns(definition: TypeDefinition, data: bytes, *, otherwise_ns: int) -> int:
    """Return the leading stamp of a serialised message, ns, or ``otherwise_ns`` if it has none."""
    if definition.is_service_event:
        stamp_ns = event_info(data).stamp_ns
    elif definition.begins_with_stamp:
        stamp_ns = leading_stamp_ns(data)
    else:
        return otherwise_ns
    return max(0, stamp_ns)  # MCAP has no times before the epoch; the message itself keeps its stamp


class BagWriter(AbstractContextManager["BagWriter"]):
    """A log that is being written, as a context manager. Methods raise `OSError` if a write fails."""

    @checks_types
    def __init__(
        self,
        folder: str | Path,
        *,
        run: Mapping[str, str] | None = None,
        limits: LogLimits = UNLIMITED,
        on_deleted: Callable[[str], object] | None = None,
    ) -> None:
        """Create ``folder`` and in it ``<folder>_0.mcap``.

        Args:
            folder: the folder of the log. Parents are made. If it exists, `LogExistsError` is raised.
            run: how the run was made (parameters, configuration), kept in the log beside the package's
                version.
            limits: when a file is finished, and which files are kept.
            on_deleted: a function that is called with a description each time the oldest file is deleted.
        """
        self._run = {"version": version_of_this_package(), **_checked_run(run or {})}
        self.folder = Path(folder)
        try:
            self.folder.mkdir(parents=True)
        except FileExistsError as error:
            raise LogExistsError(f"{self.folder} exists; a log is never overwritten") from error
        self._limits = limits
        self._on_deleted = on_deleted
        self._topics: dict[str, DeclaredTopic] = {}
        self._finished: list[FileSummary] = []
        self._deleted = 0  # files
        self._gaps: list[Gap] = []
        self._earlier_count = 0  # messages of the files before this one
        self._failure: str | None = None  # beside that of the file
        self._closed = False
        self._metadata_due_s = 0.0
        self._file = self._new_file(0)
        try:
            self._write_metadata_file()
        except OSError:
            self._file.close()
            raise

    def __exit__(self, *_error: object) -> None:
        """Close the log."""
        self.close()

    @property
    def path(self) -> Path:
        """The file that is being written."""
        return self._file.path

    @property
    def safe_count(self) -> int:
        """Number of messages that survive the death of this process."""
        return self._earlier_count + sum(self._file.summary.counts.values())

    def add_topic(self, name: str, type_name: str, qos: Any = None) -> None:
        """Declare a topic before its first message.

        Args:
            name: the topic's name with its leading slash. A service's events are at
                ``<service>/_service_event``.
            type_name: ``package/msg/Name``, or ``package/srv/Name_Event``.
            qos: the quality of service of the publisher, as rclpy's ``QoSProfile`` or an `OfferedQos`. None
                means the defaults of `OfferedQos`. A list contains the offers of several publishers; it is
                empty if none is known yet.

        Raises:
            InvalidFieldError: the name is taken or not absolute, or the type is not installed.
        """
        self._check_open()
        if not name.startswith("/") or name in self._topics:
            raise InvalidFieldError("topic", name, "an absolute name that is not declared yet")
        self._declare(DeclaredTopic(name=name, definition=find_definition(type_name), qos=offers_of(qos)))

    def set_qos(self, topic: str, qos: Any) -> None:
        """Declare another quality of service of a topic, as `add_topic` takes it, for messages from now on.

        Raises:
            InvalidFieldError: the topic is not declared.
        """
        self._check_open()
        self._declare(replace(self._declared(topic), qos=offers_of(qos)))

    def write(self, topic: str, data: bytes, *, log_time_ns: int, publish_time_ns: int | None = None) -> None:
        """Append one message.

        Args:
            topic: the name of a declared topic.
            data: the serialised message (CDR).
            log_time_ns: when the message was received, ns since the epoch.
            publish_time_ns: when its source made it, ns. None means the message's leading stamp, or the time
                of reception if it has no stamp.

        Raises:
            InvalidFieldError: an argument is not as described. The message is not written, and the log
                continues.
        """
        self._check_open()
        declared = self._declared(topic)
        if not isinstance(data, bytes) or len(data) < _SHORTEST_MESSAGE:
            raise InvalidFieldError(
                "data", data, f"bytes of a serialised message, at least {_SHORTEST_MESSAGE}"
            )
        log_time = _checked_time("log_time_ns", log_time_ns)
        if publish_time_ns is None:
            publish_time = _stamp_ns(declared.definition, data, otherwise_ns=log_time)
        else:
            publish_time = _checked_time("publish_time_ns", publish_time_ns)
        if self._is_full(log_time):
            self._next_file()
        self._file.write(topic, data, log_time_ns=log_time, publish_time_ns=publish_time)

    def change_run(self, run: Mapping[str, str]) -> None:
        """Replace the record of the run in all files that begin from now on, but not in the current one."""
        self._run = {"version": version_of_this_package(), **_checked_run(run)}

    def flush(self) -> None:
        """Bring all messages so far into the file, where a death of this process cannot take them."""
        self._check_open()
        self._file.flush()
        if time.monotonic() >= self._metadata_due_s:
            self._write_metadata_file()

    def resume(self, gap: Gap) -> None:
        """Continue in another file after a failed write; its record says what is missing.

        Args:
            gap: the time of which the log has no messages.

        Raises:
            OSError: writing still fails. The call may be repeated.
        """
        if shutil.disk_usage(self.folder).free < _LEAST_ROOM:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        before = self._gaps
        self._gaps = [*(each for each in before if each.from_ns != gap.from_ns), gap]
        try:
            file = self._begun_file(self._deleted + len(self._finished) + 1)
        except OSError:
            self._gaps = before
            raise
        self._failure = None
        self._leave(self._file, file)

    def sync(self) -> None:
        """Wait until the disk has all that was flushed, which then survives the death of the machine."""
        self._check_open()
        self._file.sync()

    def close(self) -> None:
        """Finish the file and ``metadata.yaml``, or only the latter after a failed write. May be repeated."""
        if self._closed:
            return
        self._closed = True
        try:
            if self._failure is None and self._file.failure is None:
                self._finish_file()
                self._write_metadata_file()
            else:
                with contextlib.suppress(OSError):
                    self._write_metadata_file()
        finally:
            self._file.close()

    def _declare(self, topic: DeclaredTopic) -> None:
        self._file.add_topic(topic)
        self._topics[topic.name] = topic
        self._metadata_due_s = 0.0

    def _declared(self, topic: str) -> DeclaredTopic:
        declared = self._topics.get(topic)
        if declared is None:
            raise InvalidFieldError("topic", topic, f"one of {sorted(self._topics)}")
        return declared

    def _new_file(self, number: int) -> BagFile:
        return BagFile(
            self.folder / f"{self.folder.name}_{number}.mcap",
            run={**self._run, **_record_of_gaps(self._gaps)},
            compression=self._limits.compression,
            opened_ns=time.time_ns(),
        )

    def _finish_file(self) -> None:
        self._file.flush()
        self._file.finish(self._metadata([self._file.summary]))

    def _is_full(self, log_time_ns: int) -> bool:
        """Return whether the file reaches its limit before a message with this log time."""
        begun_ns = self._file.start_ns
        if begun_ns is None:
            return False
        limits = self._limits
        if limits.file_bytes is not None and self._file.size >= limits.file_bytes:
            return True
        span = limits.file_seconds
        return span is not None and log_time_ns - begun_ns >= span * NS_PER_S

    def _next_file(self) -> None:
        """Finish the file, begin another one, and delete the oldest ones as the limit requires."""
        self._finish_file()
        self._leave(self._file, self._begun_file(self._deleted + len(self._finished) + 1))

    def _leave(self, file: BagFile, following: BagFile) -> None:
        """Continue in another file."""
        self._finished.append(file.summary)
        self._earlier_count += sum(file.summary.counts.values())
        file.close()
        self._file = following
        self._delete_oldest()

    def _begun_file(self, number: int) -> BagFile:
        """Return a new file with all topics. If writing fails, the file is removed."""
        try:
            file = self._new_file(number)
            try:
                for topic in self._topics.values():
                    file.add_topic(topic)
                file.flush()
            except OSError:
                file.close()
                file.path.unlink(missing_ok=True)
                raise
        except OSError as error:
            self._failure = f"the next file cannot be begun: {error}"
            raise
        return file

    def _delete_oldest(self) -> None:
        """Delete the oldest files until the new one fits within the limit."""
        limits = self._limits
        oldest: list[FileSummary] = []
        if limits.kept_bytes is not None and limits.file_bytes is not None:
            room = limits.kept_bytes - limits.file_bytes
            while self._finished and sum(file.size for file in self._finished) > room:
                oldest.append(self._finished.pop(0))
        self._deleted += len(oldest)
        self._write_metadata_file()  # first, so that it never names a file that is gone
        for file in oldest:
            (self.folder / file.name).unlink(missing_ok=True)
            if self._on_deleted is not None:
                self._on_deleted(
                    f"the log's oldest file {file.name} is deleted: "
                    f"{limits.kept_bytes} bytes are kept, as configured"
                )

    def _check_open(self) -> None:
        failure = self._failure or self._file.failure
        if self._closed or failure is not None:
            raise LogFailedError(f"{self.path}: {failure or 'the log is closed'}")

    def _metadata(self, files: Sequence[FileSummary]) -> dict[str, Any]:
        deleted = {_DELETED_KEY: str(self._deleted)} if self._deleted else {}
        run = {**self._run, **_record_of_gaps(self._gaps), **deleted}
        return metadata_of(files, self._topics.values(), run)

    def _write_metadata_file(self) -> None:
        part = self.folder / f".{METADATA_FILE}.part"
        try:
            metadata = self._metadata([*self._finished, self._file.summary])
            part.write_text(file_text_of(metadata), encoding="utf-8")
            part.replace(self.folder / METADATA_FILE)
        except OSError:
            part.unlink(missing_ok=True)
            raise
        self._metadata_due_s = time.monotonic() + _METADATA_EVERY_S


def _checked_time(field: str, value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= _LATEST_NS:
        raise InvalidFieldError(field, value, "an int from 0 to 2**63 - 1, nanoseconds since the epoch")
    return value


def _checked_run(run: Mapping[str, str]) -> Mapping[str, str]:
    for key, value in run.items():
        if not isinstance(key, str) or not isinstance(value, str):
            raise InvalidFieldError(f"run[{key!r}]", value, "text under a text key")
        if key == CHECKSUM_KEY:
            raise InvalidFieldError("run", key, "another key: this one is the log's own")
    return run
