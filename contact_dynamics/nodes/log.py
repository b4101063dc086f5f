# SPDX-License-Identifier: Apache-2.0
"""The server's log. It hands the messages of subscriptions and services to a recorder as bytes."""

from __future__ import annotations

import time
from datetime import datetime, timezone
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.nodes.situations import NO_MCAP, RECENT_S, Present, Situation
from contact_dynamics.recording.bag_writer import BagWriter
from contact_dynamics.recording.errors import LogExistsError
from contact_dynamics.recording.recorder import LogProblem, Recorder

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rclpy.qos import QoSProfile

    from contact_dynamics.recording.limits import LogLimits
    from contact_dynamics.recording.recorder import RecorderStatus

_SITUATIONS: Final = {
    LogProblem.INTERRUPTED: Situation.LOG_INTERRUPTED,
    LogProblem.DROPPING: Situation.LOG_DROPPING,
    LogProblem.REJECTING: Situation.LOG_REJECTING,
}
_SETTLES_IN_S: Final = 1.0  # how long an answer waits for the disk
_TRUSTS_AFTER_S: Final = 10.0  # how long answers do not wait for a disk that took longer


class Log:
    """Records bytes under topics that are declared before the first message, or nothing without directory."""

    def __init__(
        self,
        directory: str | None,
        *,
        run: Mapping[str, str],
        limits: LogLimits,
        on_problem: Callable[[str], object],
        on_notice: Callable[[str], object],
    ) -> None:
        """Create a folder in ``directory``, where empty means the current folder and None means no log.

        Without the library mcap, which ROS's package index does not have, no log is written either, and
        ``on_problem`` and `present` say so.

        Args:
            directory: where the folder of the log is made.
            run: how the run is made.
            limits: what bounds the files of the log.
            on_problem: told, from the log's thread, what goes wrong.
            on_notice: told, from the log's thread, of each file that ``limits`` cost, and of what is missing
                when a log that was interrupted goes on.

        Raises:
            ConfigurationError: the folder cannot be made, so that a log that was asked for is never missing
                silently.
        """
        self._lacks_mcap = directory is not None and find_spec("mcap") is None
        if self._lacks_mcap:
            on_problem(NO_MCAP)
            directory = None
        self._writer = None if directory is None else _new_bag(directory, run, limits, on_notice)
        self.folder = self._writer.folder if self._writer is not None else None
        self._recorder: Recorder | None = None
        self._on_problem = on_problem
        self._on_notice = on_notice
        self._hung = -_TRUSTS_AFTER_S  # when the disk took too long, s

    def add_topic(self, topic: str, type_name: str, qos: QoSProfile | None = None) -> None:
        """Declare a topic, before `start`. Without ``qos``, what its publishers offer is not known yet."""
        if self._writer is not None:
            self._writer.add_topic(topic, type_name, [] if qos is None else [qos])

    def set_qos(self, topic: str, offers: list[QoSProfile]) -> None:
        """Tell what the publishers of a topic offer, after `start`."""
        if self._recorder is not None:
            self._recorder.set_qos(topic, offers)

    def start(self) -> None:
        """Begin to record."""
        if self._writer is not None:
            self._recorder = Recorder(self._writer, on_problem=self._on_problem, on_resumed=self._on_notice)

    def record(
        self, topic: str, data: bytes, *, log_time_ns: int | None = None, publish_time_ns: int | None = None
    ) -> None:
        """Record a message as received at that time, ns since the epoch by this machine's clock, or now.

        The default of ``publish_time_ns`` is the stamp with which the message begins.
        """
        if self._recorder is not None:
            when_ns = time.time_ns() if log_time_ns is None else log_time_ns
            self._recorder.record(topic, data, log_time_ns=when_ns, publish_time_ns=publish_time_ns)

    def settle(self) -> None:
        """Wait until the disk itself has all that was recorded so far, but for a second at most.

        A disk that takes longer is told of, and is not waited for in the next ten seconds.
        """
        if self._recorder is None or time.monotonic() < self._hung + _TRUSTS_AFTER_S:
            return
        if self._recorder.settle(timeout_s=_SETTLES_IN_S) or self._recorder.status.is_interrupted:
            return
        self._hung = time.monotonic()
        self._on_problem(
            f"the disk took longer than {_SETTLES_IN_S:g} s: for {_TRUSTS_AFTER_S:g} s, answers leave "
            "before they are on it"
        )

    def change_run(self, run: Mapping[str, str]) -> None:
        """Let the files of the log that begin from now on say that the run is made so."""
        if self._recorder is not None:
            self._recorder.change_run(run)

    @property
    def status(self) -> RecorderStatus | None:
        """The state of the log now, or None if none is written."""
        return None if self._recorder is None else self._recorder.status

    def present(self) -> list[Present]:
        """Return what is wrong."""
        if self._recorder is None:
            return [Situation.NO_MCAP.present()] if self._lacks_mcap else []
        status, now, present = self._recorder.status, time.monotonic(), list[Present]()
        for kind, problem in status.problems.items():
            is_recent = now - problem.last < RECENT_S
            if is_recent or (kind is LogProblem.INTERRUPTED and status.is_interrupted):
                present.append(_SITUATIONS[kind].present(problem=problem.text, lost=status.lost))
        if now < self._hung + _TRUSTS_AFTER_S:
            present.append(Situation.LOG_NOT_AWAITED.present())
        return present

    def close(self) -> str:
        """Finish the file, and return in words where it is and whether messages are missing."""
        if self._recorder is None or self._writer is None:
            return "no log was written"
        status = self._recorder.close()
        lost = f", {status.lost} lost: {status.problem}" if status.lost else ""
        return f"log: {self._writer.path} ({status.written} messages{lost})"


def _new_bag(
    directory: str, run: Mapping[str, str], limits: LogLimits, on_notice: Callable[[str], object]
) -> BagWriter:
    """Return a bag in a folder named by the time. Servers that start at one time have different folders."""
    name = datetime.now(timezone.utc).astimezone().strftime("contact_dynamics_%Y_%m_%d-%H_%M_%S")
    number = 1
    try:
        # A link to a disk that is not mounted exists, and yet nothing can be made in it, under any name.
        parent = Path(directory).expanduser()
        parent.mkdir(parents=True, exist_ok=True)
        while True:
            folder = parent / (name if number == 1 else f"{name}_{number}")
            try:
                return BagWriter(folder, run=run, limits=limits, on_deleted=on_notice)
            except LogExistsError:
                number += 1
    except (OSError, RuntimeError) as error:  # the latter for the home of a user who is not there
        message = f"log_directory must be a folder to write to ({error}), got {directory!r}"
        raise ConfigurationError(message) from None
