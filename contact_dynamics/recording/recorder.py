"""A recorder writes a log beside a running server. To hand over a message takes µs and never raises.

Every 100 ms (sooner above 1 MiB) a thread takes the messages that wait, writes and flushes them. So a kill of
the process costs at most that much. Every second it waits until the disk itself has them, so a loss of power
costs little more. `Recorder.settle` returns when that is done for all that was handed over before.

The queue has a limit in bytes. If the disk stalls, messages wait until there are `MAX_WAITING_BYTES`. Newer
ones are then dropped and counted, to spare the server's memory.

If a write fails (a full disk), the log ends where it was last whole, and messages from then on are counted as
lost. ``on_problem`` is called once with the first problem, and `Recorder.status` can be read at any time.
"""

from __future__ import annotations

import contextlib
import logging
import threading
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.closing import ClosedAtTheEnd

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from contact_dynamics.recording.bag_writer import BagWriter

FLUSH_EVERY_S: Final = 0.1
SYNC_EVERY_S: Final = 1.0
MAX_WAITING_BYTES: Final = 64 * 1024 * 1024  # a minute of Odometry at 1 kHz

_ITEM_BYTES: Final = 200  # what a message waiting costs beside its data
_WAKE_BYTES: Final = 1024 * 1024  # waiting bytes that wake the thread before its time
_SETTLE_WAITS: Final = 10  # in so many parts the disk is waited for; a process that stands still loses one


@dataclass(frozen=True, slots=True, kw_only=True)
class RecorderStatus:
    """The state of the log. Every message is written, lost or waiting.

    Attributes:
        written: Number of messages in the file, which a kill cannot lose.
        lost: Number of messages dropped because the disk failed, the queue was full, or they were invalid.
        waiting: Number of messages that are not in the file yet.
        most_waiting_bytes: The most memory that waiting messages have taken so far, bytes.
        problem: The first problem, or None if there was none.
    """

    written: int
    lost: int
    waiting: int
    most_waiting_bytes: int
    problem: str | None


class _Item(NamedTuple):
    topic: str
    data: bytes
    log_time_ns: int
    publish_time_ns: int | None


class _RunChange(NamedTuple):
    run: Mapping[str, str]


class Recorder(ClosedAtTheEnd):
    """A thread that owns a `BagWriter` whose topics are declared. It is a context manager."""

    def __init__(
        self,
        writer: BagWriter,
        *,
        on_problem: Callable[[str], object] | None = None,
        max_waiting_bytes: int = MAX_WAITING_BYTES,
    ) -> None:
        """Start the thread.

        Args:
            writer: the log. Nobody else may use it from here on.
            on_problem: a function that the thread calls once, with the first problem. The default warns
                through `logging`.
            max_waiting_bytes: if this much waits, newer messages are dropped and counted.
        """
        self.folder = writer.folder
        self._writer = writer
        self._on_problem = on_problem or logging.getLogger(__name__).warning
        self._max_waiting_bytes = max_waiting_bytes
        self._lock = threading.Lock()
        self._items: list[_Item | _RunChange] = []
        self._qos: dict[str, Any] = {}  # by topic, to be declared anew
        self._waiting_bytes = 0
        self._most_waiting_bytes = 0
        self._given = 0
        self._written = 0
        self._lost = 0
        self._problem: str | None = None
        self._dead = False
        self._closing = False
        self._wake = threading.Event()
        self._settled = threading.Condition(self._lock)
        self._asked_to_settle = False
        self._on_disk = 0  # number of the messages given that are on the disk itself, or lost
        self._thread = threading.Thread(target=self._run, name="contact_dynamics log", daemon=True)
        self._thread.start()

    @property
    def status(self) -> RecorderStatus:
        """The state of the log now."""
        with self._lock:
            return RecorderStatus(
                written=self._written,
                lost=self._lost,
                waiting=self._given - self._written - self._lost,
                most_waiting_bytes=self._most_waiting_bytes,
                problem=self._problem,
            )

    def record(
        self, topic: str, data: bytes, *, log_time_ns: int, publish_time_ns: int | None = None
    ) -> None:
        """Hand over one message from any thread, with the arguments of `BagWriter.write`. It never raises."""
        size = _size(data)
        with self._lock:
            self._given += 1
            waiting = self._waiting_bytes + size
            open_ = not self._dead and not self._closing
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
            self._report(
                f"the disk does not keep up: {most} bytes wait, newer messages are dropped"
                if size <= most
                else f"{topic}: a message of {size} bytes is not logged, since at most {most} may wait"
            )

    def set_qos(self, topic: str, qos: Any) -> None:
        """Declare another quality of service of a topic; see `BagWriter.set_qos`. It never raises."""
        with self._lock:
            self._qos[topic] = qos

    def change_run(self, run: Mapping[str, str]) -> None:
        """Let the files that begin after the messages handed over so far say that the run is made so."""
        with self._lock:
            if not self._dead and not self._closing:
                self._items.append(_RunChange(run))

    def settle(self, *, timeout_s: float = 10.0) -> bool:
        """Wait until the disk itself has all messages handed over so far. Return whether it has them.

        It does not if the log has ended, or if the disk hangs for longer than ``timeout_s``. While the whole
        process stands still, as on a starved machine, it is not the disk that hangs, and little time counts.
        """
        with self._lock:
            given = self._given
            self._asked_to_settle = True
        self._wake.set()
        with self._settled:
            for _ in range(_SETTLE_WAITS):
                part_s = timeout_s / _SETTLE_WAITS
                if self._settled.wait_for(lambda: self._dead or self._on_disk >= given, part_s):
                    break
            return not self._dead and self._on_disk >= given

    def close(self, *, timeout_s: float = 10.0) -> RecorderStatus:
        """Write all waiting messages, finish the file, and return the status. Later messages count as lost.

        If the disk hangs for longer than ``timeout_s``, the method returns, and the status says that messages
        wait.
        """
        with self._lock:
            self._closing = True
        self._wake.set()
        self._thread.join(timeout_s)
        return self.status

    def _run(self) -> None:
        try:
            closing = False
            synced_s = time.monotonic()
            while not closing:
                self._wake.wait(FLUSH_EVERY_S)
                self._wake.clear()
                with self._lock:
                    closing = self._closing  # once it is set, nothing is added behind these items
                    items, self._items = self._items, []
                    qos, self._qos = self._qos, {}
                    given = self._given
                    must_sync, self._asked_to_settle = self._asked_to_settle, False
                for topic, offers in qos.items():
                    self._writer.set_qos(topic, offers)
                if items or qos:
                    self._write(items)
                if given > self._on_disk and (must_sync or time.monotonic() >= synced_s + SYNC_EVERY_S):
                    self._writer.sync()
                    synced_s = time.monotonic()
                    self._tell_settled(given)
            self._writer.close()
            self._tell_settled(given)
        except Exception as error:  # noqa: BLE001  whatever it is, it ends the log and not the server
            self._die(error)

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
            self._report(f"a message was not logged: {error}")
            return False
        return True

    def _die(self, error: Exception) -> None:
        with self._lock:
            self._dead = True
            self._items = []
            self._waiting_bytes = 0
            self._written = self._writer.safe_count
            self._lost = self._given - self._written
            self._settled.notify_all()
        self._report(f"the log {self.folder} ends here: {error}")
        with contextlib.suppress(Exception):
            self._writer.close()

    def _report(self, problem: str) -> None:
        with self._lock:
            first = self._problem is None
            if first:
                self._problem = problem
        if first:
            with contextlib.suppress(Exception):
                self._on_problem(problem)


def _size(data: object) -> int:
    # The writer refuses what is not bytes.
    return _ITEM_BYTES + (len(data) if isinstance(data, bytes) else 0)
