# SPDX-License-Identifier: Apache-2.0
"""Writes a log beside a running server. Recording a message takes microseconds and never raises.

Every 100 ms (sooner above 1 MiB) a thread writes and flushes the queued messages, so that a kill of the
process loses at most these. Every second it synchronises the file with the disk, so that a power failure
loses little more. `Recorder.settle` returns when all messages recorded before it are on the disk.

The queue has a limit in bytes. If the disk stalls, messages wait until they fill `MAX_WAITING_BYTES`. Newer
ones are then dropped and counted, to limit the server's memory.

If a write fails (the disk is full), the file is cut back to its last complete state. Messages are counted as
lost until there is room again, which the thread checks every second. The log then continues in another file,
whose record says what is missing.

``on_problem`` is called when a problem of some kind begins, and again every minute while it lasts.
`Recorder.status` can be read at any time.
"""

from __future__ import annotations

import contextlib
import enum
import logging
import threading
import time
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.bag_writer import Gap

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from contact_dynamics.recording.bag_writer import BagWriter

FLUSH_EVERY_S: Final = 0.1
SYNC_EVERY_S: Final = 1.0
RESUME_EVERY_S: Final = 1.0
TELL_EVERY_S: Final = 60.0
MAX_WAITING_BYTES: Final = 64 * 1024 * 1024  # a minute of Odometry at 1 kHz

_ITEM_BYTES: Final = 200  # overhead of a waiting message
_WAKE_BYTES: Final = 1024 * 1024  # number of waiting bytes that wakes the thread early
_SETTLE_WAITS: Final = 10  # number of parts of the wait for the disk; a stall of the process uses up only one


class LogProblem(enum.Enum):
    """The kinds of problems of a log."""

    INTERRUPTED = "nothing is written"
    DROPPING = "messages wait too long"
    REJECTING = "messages are not fit to be written"


class Problem(NamedTuple):
    """A problem of a kind."""

    text: str  # description of the last occurrence
    last: float  # s, by `time.monotonic`, time of the last occurrence


@dataclass(frozen=True, slots=True, kw_only=True)
class RecorderStatus:
    """The state of the log. Every message is written, lost or waiting.

    Attributes:
        written: Number of messages in the file, which a kill cannot lose.
        lost: Number of messages dropped because the disk failed, the queue was full, or they were invalid.
        waiting: Number of messages that are not in the file yet.
        max_waiting_bytes: The most memory that waiting messages have taken so far, bytes.
        is_interrupted: Whether writing is suspended after a failure.
        problems: The problems so far, by their kind.
    """

    written: int
    lost: int
    waiting: int
    max_waiting_bytes: int
    is_interrupted: bool
    problems: Mapping[LogProblem, Problem]

    @property
    def problem(self) -> str | None:
        """A description of all problems so far, or None if there was none."""
        return "; ".join(each.text for each in self.problems.values()) or None


class _Item(NamedTuple):
    topic: str
    data: bytes
    log_time_ns: int
    publish_time_ns: int | None


class _RunChange(NamedTuple):
    run: Mapping[str, str]


class _Interruption(NamedTuple):
    from_ns: int  # since the epoch: messages received from then on are missing
    lost_before: int  # messages
    again: float  # s, on the monotonic clock: when to try to resume


class Recorder(AbstractContextManager["Recorder"]):
    """A thread that owns a `BagWriter` whose topics are declared. It is a context manager."""

    def __init__(
        self,
        writer: BagWriter,
        *,
        on_problem: Callable[[str], object] | None = None,
        on_resumed: Callable[[str], object] | None = None,
        max_waiting_bytes: int = MAX_WAITING_BYTES,
    ) -> None:
        """Start the thread.

        Args:
            writer: the log. Nobody else may use it from here on.
            on_problem: a function that is called with a description when a problem begins, and each minute
                while it lasts. The default warns through `logging`.
            on_resumed: the same, with a description of what is missing, when an interrupted log resumes.
            max_waiting_bytes: size of the queue above which newer messages are dropped and counted.
        """
        self.folder = writer.folder
        self._writer = writer
        self._on_problem = on_problem or logging.getLogger(__name__).warning
        self._on_resumed = on_resumed or logging.getLogger(__name__).warning
        self._max_waiting_bytes = max_waiting_bytes
        self._lock = threading.Lock()
        self._items: list[_Item | _RunChange] = []
        self._qos: dict[str, Any] = {}  # by topic, to be declared again
        self._waiting_bytes = 0
        self._most_waiting_bytes = 0
        self._given = 0
        self._written = 0
        self._lost = 0
        self._problems: dict[LogProblem, Problem] = {}
        self._told: dict[LogProblem, float] = {}  # when `on_problem` was called, s
        self._interruption: _Interruption | None = None
        self._dead = False
        self._closing = False
        self._wake = threading.Event()
        self._settled = threading.Condition(self._lock)
        self._asked_to_settle = False
        self._synced = time.monotonic()
        self._on_disk = 0  # number of recorded messages that are on the disk, or lost
        self._thread = threading.Thread(target=self._run, name="contact_dynamics log", daemon=True)
        self._thread.start()

    def __exit__(self, *_error: object) -> None:
        """Close the log."""
        self.close()

    @property
    def status(self) -> RecorderStatus:
        """The state of the log now."""
        with self._lock:
            return RecorderStatus(
                written=self._written,
                lost=self._lost,
                waiting=self._given - self._written - self._lost,
                max_waiting_bytes=self._most_waiting_bytes,
                is_interrupted=not self._is_writing(),
                problems=dict(self._problems),
            )

    def record(
        self, topic: str, data: bytes, *, log_time_ns: int, publish_time_ns: int | None = None
    ) -> None:
        """Record one message, from any thread, with the arguments of `BagWriter.write`. It never raises."""
        size = _size(data)
        with self._lock:
            self._given += 1
            waiting = self._waiting_bytes + size
            open_ = self._is_writing() and not self._closing
            taken = open_ and waiting <= self._max_waiting_bytes
            if taken:
                self._items.append(_Item(topic, data, log_time_ns, publish_time_ns))
                self._waiting_bytes = waiting
                self._most_waiting_bytes = max(self._most_waiting_bytes, waiting)
            else:
                self._lost += 1
        if taken and waiting > _WAKE_BYTES:
            self._wake.set()
        elif open_ and not taken:
            most = self._max_waiting_bytes
            if size <= most:
                text = f"the disk does not keep up: {most} bytes wait, newer messages are dropped"
                self._report(LogProblem.DROPPING, text)
            else:
                text = f"{topic}: a message of {size} bytes is not logged, since at most {most} may wait"
                self._report(LogProblem.REJECTING, text)

    def set_qos(self, topic: str, qos: Any) -> None:
        """Declare another quality of service of a topic; see `BagWriter.set_qos`. It never raises."""
        with self._lock:
            self._qos[topic] = qos

    def change_run(self, run: Mapping[str, str]) -> None:
        """Replace the record of the run in the files that begin after the messages recorded so far."""
        with self._lock:
            if not self._dead and not self._closing:
                self._items.append(_RunChange(run))

    def settle(self, *, timeout_s: float = 10.0) -> bool:
        """Wait until all messages recorded so far are on the disk, and return whether they are.

        They are not if the log is interrupted, or if the disk hangs for longer than ``timeout_s``. Time in
        which the whole process is stalled, as on an overloaded machine, hardly counts.
        """
        with self._lock:
            given = self._given
            self._asked_to_settle = True
        self._wake.set()
        with self._settled:
            for _ in range(_SETTLE_WAITS):
                part_s = timeout_s / _SETTLE_WAITS
                if self._settled.wait_for(lambda: not self._is_writing() or self._on_disk >= given, part_s):
                    break
            return self._is_writing() and self._on_disk >= given

    def close(self, *, timeout_s: float = 10.0) -> RecorderStatus:
        """Write all waiting messages, finish the file, and return the status. Later messages count as lost.

        If the disk hangs for longer than ``timeout_s``, the method returns with a status in which messages
        are waiting.
        """
        with self._lock:
            self._closing = True
        self._wake.set()
        self._thread.join(timeout_s)
        return self.status

    def _is_writing(self) -> bool:
        return self._interruption is None and not self._dead

    def _run(self) -> None:
        try:
            closing = False
            while not closing:
                closing = self._take() if self._interruption is None else self._resume()
            self._writer.close()
            self._tell_settled(self._given)
        except Exception as error:  # noqa: BLE001  whatever it is, it ends the log and not the server
            self._die(error)

    def _take(self) -> bool:
        """Write the waiting messages, and return whether to close the log now."""
        self._wake.wait(FLUSH_EVERY_S)
        self._wake.clear()
        with self._lock:
            closing = self._closing  # once it is set, nothing is added after these items
            items, self._items = self._items, []
            qos, self._qos = self._qos, {}
            given = self._given
            must_sync, self._asked_to_settle = self._asked_to_settle, False
        try:
            for topic, offers in qos.items():
                self._writer.set_qos(topic, offers)
            if items or qos:
                self._write(items)
            if given > self._on_disk and (must_sync or time.monotonic() >= self._synced + SYNC_EVERY_S):
                self._writer.sync()
                self._synced = time.monotonic()
                self._tell_settled(given)
        except OSError as error:
            with self._lock:
                self._qos = {**qos, **self._qos}
            self._interrupt(error, items)
        return closing

    def _resume(self) -> bool:
        """Try to resume after an interruption, and return whether to close the log now."""
        self._wake.wait(FLUSH_EVERY_S)
        self._wake.clear()
        with self._lock:
            interruption = self._interruption
            if self._closing or interruption is None or time.monotonic() < interruption.again:
                return self._closing
            self._interruption = None  # messages wait again, and are lost only if resuming fails
            lost = self._lost - interruption.lost_before
        gap = Gap(from_ns=interruption.from_ns, until_ns=time.time_ns(), lost=lost)
        try:
            self._writer.resume(gap)
        except OSError as error:
            self._interrupt(error, [], interruption)
            return False
        del self._told[LogProblem.INTERRUPTED]
        with contextlib.suppress(Exception):
            self._on_resumed(f"the log continues in {self._writer.path}: {gap}")
        return False

    def _tell_settled(self, given: int) -> None:
        with self._settled:
            self._on_disk = given
            self._settled.notify_all()

    def _write(self, items: list[_Item | _RunChange]) -> None:
        refused = sum(not self._accepts(item) for item in items)
        self._writer.flush()
        with self._lock:
            self._waiting_bytes -= sum(_size(item.data) for item in items if isinstance(item, _Item))
            self._written = self._writer.safe_count
            self._lost += refused

    def _accepts(self, item: _Item | _RunChange) -> bool:
        if isinstance(item, _RunChange):
            self._writer.change_run(item.run)
            return True
        try:
            self._writer.write(
                item.topic, item.data, log_time_ns=item.log_time_ns, publish_time_ns=item.publish_time_ns
            )
        except InvalidFieldError as error:
            self._report(LogProblem.REJECTING, f"a message was not logged: {error}")
            return False
        return True

    def _interrupt(
        self, error: OSError, items: list[_Item | _RunChange], before: _Interruption | None = None
    ) -> None:
        """Count the items as lost, and suspend writing; ``before`` is an interruption that continues."""
        with self._lock:
            dropped = [*items, *self._items]
            lost_before = self._lost
            self._drop()
            times = [each.log_time_ns for each in dropped if isinstance(each, _Item)]
            again = time.monotonic() + RESUME_EVERY_S
            self._interruption = (
                _Interruption(min(times, default=time.time_ns()), lost_before, again)
                if before is None
                else before._replace(again=again)
            )
        for each in dropped:
            if isinstance(each, _RunChange):
                self._writer.change_run(each.run)
        self._report(LogProblem.INTERRUPTED, f"the log {self._writer.path} is interrupted: {error}")

    def _die(self, error: Exception) -> None:
        with self._lock:
            self._dead = True
            self._drop()
        self._report(LogProblem.INTERRUPTED, f"the log {self.folder} ends here: {error}")
        with contextlib.suppress(Exception):
            self._writer.close()

    def _drop(self) -> None:
        """Count all waiting messages as lost."""
        self._items = []
        self._waiting_bytes = 0
        self._written = self._writer.safe_count
        self._lost = self._given - self._written
        self._settled.notify_all()

    def _report(self, kind: LogProblem, text: str) -> None:
        now = time.monotonic()
        with self._lock:
            self._problems[kind] = Problem(text, now)
            is_due = now >= self._told.get(kind, -TELL_EVERY_S) + TELL_EVERY_S
            if is_due:
                self._told[kind] = now
        if is_due:
            with contextlib.suppress(Exception):
                self._on_problem(text)


def _size(data: object) -> int:
    # The writer rejects anything but bytes.
    return _ITEM_BYTES + (len(data) if isinstance(data, bytes) else 0)
