"""A log written beside a running server: handing over a message costs microseconds, and never an error.

A thread takes what has gathered every 100 ms (sooner above 1 MiB), writes it and flushes; so a kill of the
process costs at most that much. The queue has no length limit but a limit in bytes: should the disk stall,
messages wait until `MAX_WAITING_BYTES` wait already, and newer ones are then dropped and counted rather than
taking the server's memory.

A write that fails (a full disk) ends the log where it was last whole; messages from then on are counted as
lost. Whoever asked learns of it once, through ``on_problem``, and can read `Recorder.status` at any time.
Nothing raises into `Recorder.record`.
"""

from __future__ import annotations

import contextlib
import logging
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.errors import InvalidFieldError

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    from typing_extensions import Self

    from contact_dynamics.recording.bag_writer import BagWriter

FLUSH_EVERY_S: Final = 0.1
MAX_WAITING_BYTES: Final = 64 * 1024 * 1024  # a minute of Odometry at 1 kHz

_ITEM_BYTES: Final = 200  # what a message waiting costs beside its data
_WAKE_BYTES: Final = 1024 * 1024  # waiting bytes that wake the thread before its time


@dataclass(frozen=True, slots=True, kw_only=True)
class RecorderStatus:
    """How the log fares; every message given is written, lost or waiting.

    Attributes:
        written: Messages in the file, where a kill cannot take them.
        lost: Messages dropped: disk failed, queue full, or refused as invalid.
        waiting: Messages not in the file yet.
        most_waiting_bytes: High-water mark of the memory taken by messages waiting, bytes.
        problem: The first thing that went wrong, None while all is well.
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


class Recorder:
    """Owns a `BagWriter`, whose topics are declared, on a thread of its own; a context manager."""

    def __init__(
        self,
        writer: BagWriter,
        *,
        on_problem: Callable[[str], object] | None = None,
        max_waiting_bytes: int = MAX_WAITING_BYTES,
    ) -> None:
        """Start the thread.

        Args:
            writer: the log; nobody else touches it from here on.
            on_problem: told once, from the thread, of the first problem; default: a warning through
                `logging`.
            max_waiting_bytes: beyond this much, newer messages are dropped and counted.
        """
        self.folder = writer.folder
        self._writer = writer
        self._on_problem = on_problem or logging.getLogger(__name__).warning
        self._max_waiting_bytes = max_waiting_bytes
        self._lock = threading.Lock()
        self._items: list[_Item] = []
        self._waiting_bytes = 0
        self._most_waiting_bytes = 0
        self._given = 0
        self._written = 0
        self._lost = 0
        self._problem: str | None = None
        self._dead = False
        self._closing = False
        self._wake = threading.Event()
        self._thread = threading.Thread(target=self._run, name="contact_dynamics log", daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        """Return the recorder itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Write what waits and close the log."""
        self.close()

    @property
    def status(self) -> RecorderStatus:
        """How the log fares now."""
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
        """Hand over one message from any thread; arguments as of `BagWriter.write`. Never raises."""
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
            self._report(
                f"the disk does not keep up: {self._max_waiting_bytes} bytes wait, newer messages are dropped"
            )

    def close(self, *, timeout_s: float = 10.0) -> RecorderStatus:
        """Write all that waits, finish the file, and return how it went; later messages count as lost.

        A disk that hangs for longer than ``timeout_s`` is left to itself; the status then says that messages
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
            while not closing:
                self._wake.wait(FLUSH_EVERY_S)
                self._wake.clear()
                with self._lock:
                    closing = self._closing  # once it is set, nothing is added behind these items
                    items, self._items = self._items, []
                if items:
                    self._write(items)
            self._writer.close()
        except Exception as error:  # noqa: BLE001  whatever it is, it ends the log and not the server
            self._die(error)

    def _write(self, items: list[_Item]) -> None:
        refused = sum(not self._accepts(item) for item in items)
        self._writer.flush()
        with self._lock:
            self._waiting_bytes -= sum(_size(item.data) for item in items)
            self._written = self._writer.safe_count
            self._lost += refused

    def _accepts(self, item: _Item) -> bool:
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
    # What is not bytes is no concern here: the writer refuses it.
    return _ITEM_BYTES + (len(data) if isinstance(data, bytes) else 0)
