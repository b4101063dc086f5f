"""Writes a log: a folder with one MCAP file and the ``metadata.yaml`` that makes it a bag of rosbag2 (Jazzy).

The file has these parts:

- The profile is ``ros2``.
- Each type has a schema with its full definition (`definitions`), so a reader does not need our packages.
- Each topic has a channel with its quality of service and type hash.
- Chunks are small and compressed (256 KiB, closed by each `BagWriter.flush`), so that a kill of the process
  costs only what came since the last flush.
- A metadata record ``contact_dynamics`` at the head says how the run was made. rosbag2's own is at the end.

The writer is not thread-safe. `recorder.Recorder` owns one on its own thread. Messages are bytes as a
subscription with ``raw=True`` gives them. The result of ``rclpy.serialization.serialize_message`` ends in
random bytes and is not for logs. Writes survive the death of the process, but not that of the machine, since
there is no ``fsync``.
"""

from __future__ import annotations

import contextlib
import time
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mcap.writer import CompressionType, Writer

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.append_file import AppendFile
from contact_dynamics.recording.bag_metadata import (
    CHECKSUM_KEY,
    METADATA_FILE,
    RUN_RECORD,
    BagSummary,
    TopicSummary,
    metadata_file_text,
    metadata_lines,
    sealed_run,
)
from contact_dynamics.recording.cdr_stamp import event_stamp_ns, leading_stamp_ns
from contact_dynamics.recording.definitions import TypeDefinition, find_definition
from contact_dynamics.recording.errors import LogExistsError, LogFailedError
from contact_dynamics.recording.qos import OfferedQos, qos_lines

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from types import TracebackType

    from typing_extensions import Self

CHUNK_BYTES: Final = 256 * 1024

_LATEST_NS: Final = 2**63 - 1  # rosbag2 keeps times as int64
_SHORTEST_MESSAGE: Final = 5  # bytes: encapsulation and one of content, which even an empty message has
_METADATA_EVERY_S: Final = 5.0  # how old the counts of metadata.yaml may grow while writing


@dataclass(slots=True, kw_only=True)
class _Topic:
    channel_id: int
    definition: TypeDefinition
    qos: tuple[str, ...]
    count: int = 0  # messages given
    safe_count: int = 0  # of which in the file


class BagWriter:
    """A log that is being written, as a context manager. Methods raise `OSError` if the disk refuses."""

    def __init__(self, folder: str | Path, *, run: Mapping[str, str] | None = None) -> None:
        """Create ``folder`` and in it ``<folder>_0.mcap``.

        Args:
            folder: the folder of the log. Parents are made. If it exists, `LogExistsError` is raised.
            run: how the run was made (parameters, configuration), kept in the log beside the package's
                version.
        """
        self._run = {"version": _package_version(), **_checked_run(run or {})}
        self.folder = Path(folder)
        try:
            self.folder.mkdir(parents=True)
        except FileExistsError as error:
            raise LogExistsError(f"{self.folder} exists; a log is never overwritten") from error
        self.path = self.folder / f"{self.folder.name}_0.mcap"
        self._topics: dict[str, _Topic] = {}
        self._schemas: dict[str, int] = {}
        self._start_ns, self._end_ns = _LATEST_NS, 0
        self._opened_ns = time.time_ns()
        self._failure: str | None = None
        self._closed = False
        self._metadata_due_s = 0.0
        self._file = AppendFile(self.path)
        self._safe_size = 0
        self._writer: Any = Writer(  # Any: the library is typed in part only
            self._file,  # type: ignore[arg-type]  # has what the library calls: write, tell, flush
            chunk_size=CHUNK_BYTES,
            compression=CompressionType.ZSTD,
            enable_data_crcs=True,
        )
        try:
            self._begin()
        except OSError:
            self._file.close()
            raise

    def __enter__(self) -> Self:
        """Return the writer itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the log."""
        self.close()

    @property
    def safe_count(self) -> int:
        """Number of messages that a death of this process can no longer take."""
        return sum(topic.safe_count for topic in self._topics.values())

    def add_topic(self, name: str, type_name: str, qos: Any = None) -> None:
        """Declare a topic before its first message.

        Args:
            name: the topic's name with its leading slash. A service's events are at
                ``<service>/_service_event``.
            type_name: ``package/msg/Name``, or ``package/srv/Name_Event``.
            qos: the quality of service of the publisher, as rclpy's ``QoSProfile`` or an `OfferedQos`, whose
                defaults are taken for None.

        Raises:
            InvalidFieldError: the name is taken or not absolute, or the type is not installed.
        """
        self._check_open()
        if not name.startswith("/") or name in self._topics:
            raise InvalidFieldError("topic", name, "an absolute name that is not declared yet")
        definition = find_definition(type_name)
        qos_yaml = tuple(qos_lines(OfferedQos() if qos is None else qos))
        with self._cut_back_on_failure():
            if type_name not in self._schemas:
                text = definition.text.encode()
                self._schemas[type_name] = self._writer.register_schema(type_name, "ros2msg", text)
            channel = self._writer.register_channel(
                topic=name,
                message_encoding="cdr",
                schema_id=self._schemas[type_name],
                metadata={
                    "offered_qos_profiles": "\n".join(qos_yaml),
                    "topic_type_hash": definition.type_hash,
                },
            )
        self._topics[name] = _Topic(channel_id=channel, definition=definition, qos=qos_yaml)
        self._metadata_due_s = 0.0

    def write(self, topic: str, data: bytes, *, log_time_ns: int, publish_time_ns: int | None = None) -> None:
        """Append one message.

        Args:
            topic: the name of a declared topic.
            data: the serialised message (CDR).
            log_time_ns: when the message was received, ns since the epoch.
            publish_time_ns: when its source made it, ns. For None it is the stamp with which the message
                begins, or the time of reception if it has no stamp.

        Raises:
            InvalidFieldError: an argument is not as described. Nothing is written then, and the log goes on.
        """
        self._check_open()
        declared = self._topics.get(topic)
        if declared is None:
            raise InvalidFieldError("topic", topic, f"one of {sorted(self._topics)}")
        if not isinstance(data, bytes) or len(data) < _SHORTEST_MESSAGE:
            raise InvalidFieldError(
                "data", data, f"bytes of a serialised message, at least {_SHORTEST_MESSAGE}"
            )
        log_time = _checked_time("log_time_ns", log_time_ns)
        if publish_time_ns is None:
            publish_time = _stamp_within(declared.definition, data, otherwise_ns=log_time)
        else:
            publish_time = _checked_time("publish_time_ns", publish_time_ns)
        with self._cut_back_on_failure():
            self._writer.add_message(
                channel_id=declared.channel_id, log_time=log_time, data=data, publish_time=publish_time
            )
        declared.count += 1
        self._start_ns, self._end_ns = min(self._start_ns, log_time), max(self._end_ns, log_time)

    def flush(self) -> None:
        """Bring all messages so far into the file, where a death of this process cannot take them."""
        self._check_open()
        with self._cut_back_on_failure():
            self._writer.flush()
            self._mark_safe()
            if time.monotonic() >= self._metadata_due_s:
                self._write_metadata_file()

    def close(self) -> None:
        """Finish the file and ``metadata.yaml``, or only the latter after a failed write. Twice is fine."""
        if self._closed:
            return
        self._closed = True
        try:
            if self._failure is None:
                with self._cut_back_on_failure():
                    self._finish()
            else:
                with contextlib.suppress(OSError):
                    self._write_metadata_file()
        finally:
            self._file.close()

    def _begin(self) -> None:
        self._writer.start(profile="ros2", library=f"contact_dynamics {self._run['version']}")
        self._writer.add_metadata(RUN_RECORD, sealed_run(self._run))
        self._safe_size = self._file.tell()
        self._write_metadata_file()

    def _finish(self) -> None:
        self._writer.flush()
        self._mark_safe()
        self._writer.add_metadata(
            "rosbag2", {"serialized_metadata": "\n".join(metadata_lines(self._summary()))}
        )
        self._writer.finish()
        self._write_metadata_file()

    def _mark_safe(self) -> None:
        self._safe_size = self._file.tell()
        for topic in self._topics.values():
            topic.safe_count = topic.count

    @contextlib.contextmanager
    def _cut_back_on_failure(self) -> Iterator[None]:
        """On any failure, leave the file as it was after the last flush, when it was whole and readable."""
        try:
            yield
        except Exception as error:
            self._failure = f"an earlier write failed: {error}"
            with contextlib.suppress(OSError):
                self._file.cut_back(self._safe_size)
            raise

    def _check_open(self) -> None:
        if self._closed or self._failure is not None:
            raise LogFailedError(f"{self.path}: {self._failure or 'the log is closed'}")

    def _summary(self) -> BagSummary:
        # Before the first message the start is when the log was opened, not the end of time as rosbag2 has
        # it: should the process be killed, `ros2 bag play` starts its clock there.
        empty = self._start_ns > self._end_ns
        return BagSummary(
            file_name=self.path.name,
            start_ns=self._opened_ns if empty else self._start_ns,
            end_ns=self._opened_ns if empty else self._end_ns,
            topics=[_topic_summary(name, topic) for name, topic in self._topics.items()],
            custom_data=self._run,
        )

    def _write_metadata_file(self) -> None:
        part = self.folder / f".{METADATA_FILE}.part"
        try:
            part.write_text(metadata_file_text(self._summary()), encoding="utf-8")
            part.replace(self.folder / METADATA_FILE)
        except OSError:
            part.unlink(missing_ok=True)
            raise
        self._metadata_due_s = time.monotonic() + _METADATA_EVERY_S


def _topic_summary(name: str, topic: _Topic) -> TopicSummary:
    definition = topic.definition
    return TopicSummary(
        name=name,
        type_name=definition.type_name,
        # rosbags refuses the whole folder where this does not match its own hash of the text, which for an
        # event, written out as a message, it cannot; the true hash stands in the channel.
        type_hash="" if definition.is_service_event else definition.type_hash,
        qos=topic.qos,
        message_count=topic.safe_count,
    )


def _stamp_within(definition: TypeDefinition, data: bytes, *, otherwise_ns: int) -> int:
    read: Callable[[bytes], int] | None = None
    if definition.is_service_event:
        read = event_stamp_ns
    elif definition.begins_with_stamp:
        read = leading_stamp_ns
    if read is None:
        return otherwise_ns
    return max(0, read(data))  # MCAP has no time before the epoch; the message itself keeps its stamp


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


def _package_version() -> str:
    try:
        return version("contact_dynamics")
    except PackageNotFoundError:
        return "unknown"
