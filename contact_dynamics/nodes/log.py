# SPDX-License-Identifier: Apache-2.0
"""The log of a node, which passes serialized messages of topics and services to a recorder."""

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
_SETTLES_IN_S: Final = 1.0  # longest time that a response waits for the disk
_TRUSTS_AFTER_S: Final = 10.0  # time for which responses do not wait after the disk took longer


class Log:
    """Records serialized messages of topics that are declared before the first one, or nothing."""

    def __init__(
        self,
        directory: str | None,
        *,
        run: Mapping[str, str],
        limits: LogLimits,
        on_problem: Callable[[str], object],
        on_notice: Callable[[str], object],
    ) -> None:
        """Create the folder of the log in ``directory``, by default in the working directory (an empty text).

        Raise `ConfigurationError` if it cannot be created. Without a directory (None), or without the library
        mcap, which is not in ROS's package index, no log is written; ``on_problem`` and `present` report a
        missing library. The log's thread calls ``on_problem`` with each problem, and ``on_notice`` with each
        file that is deleted because of the ``limits``, and with what is missing after an interruption.
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
        self._hung = -_TRUSTS_AFTER_S  # s, last time at which the disk took too long

    def add_topic(self, topic: str, type_name: str, qos: QoSProfile | None = None) -> None:
        """Declare a topic, before `start`. Without ``qos``, the QoS of its publishers is not known yet."""
        if self._writer is not None:
            self._writer.add_topic(topic, type_name, [] if qos is None else [qos])

    def set_qos(self, topic: str, offers: list[QoSProfile]) -> None:
        """Record the QoS that the publishers of a topic offer, after `start`."""
        if self._recorder is not None:
            self._recorder.set_qos(topic, offers)

    def start(self) -> None:
        """Begin to record."""
        if self._writer is not None:
            self._recorder = Recorder(self._writer, on_problem=self._on_problem, on_resumed=self._on_notice)

    def record(
        self, topic: str, data: bytes, *, log_time_ns: int | None = None, publish_time_ns: int | None = None
    ) -> None:
        """Record a message that was received at ``log_time_ns``, or now, ns since the epoch.

        The default of ``publish_time_ns`` is the leading stamp of the message.
        """
        if self._recorder is not None:
            when_ns = time.time_ns() if log_time_ns is None else log_time_ns
            self._recorder.record(topic, data, log_time_ns=when_ns, publish_time_ns=publish_time_ns)

    def settle(self) -> None:
        """Wait at most a second until all recorded messages are on the disk.

        If the disk takes longer, a warning is issued, and responses do not wait for the next ten seconds.
        """
        if self._recorder is None or time.monotonic() < self._hung + _TRUSTS_AFTER_S:
            return
        if self._recorder.settle(timeout_s=_SETTLES_IN_S) or self._recorder.status.is_interrupted:
            return
        self._hung = time.monotonic()
        self._on_problem(
            f"the disk took longer than {_SETTLES_IN_S:g} s: for {_TRUSTS_AFTER_S:g} s, responses "
            "are sent before they are on it"
        )

    def change_run(self, run: Mapping[str, str]) -> None:
        """Replace the record of the run in the files that begin from now on."""
        if self._recorder is not None:
            self._recorder.change_run(run)

    @property
    def status(self) -> RecorderStatus | None:
        """The current state of the log, or None if none is written."""
        return None if self._recorder is None else self._recorder.status

    def present(self) -> list[Present]:
        """Return the present situations that concern the log."""
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
        """Finish the file, and return a text with its path and the number of lost messages."""
        if self._recorder is None or self._writer is None:
            return "no log was written"
        status = self._recorder.close()
        lost = f", {status.lost} lost: {status.problem}" if status.lost else ""
        return f"log: {self._writer.path} ({status.written} messages{lost})"


def _new_bag(
    directory: str, run: Mapping[str, str], limits: LogLimits, on_notice: Callable[[str], object]
) -> BagWriter:
    """Create a bag in a new folder that is named after the present time."""
    name = datetime.now(timezone.utc).astimezone().strftime("contact_dynamics_%Y_%m_%d-%H_%M_%S")
    number = 1
    try:
        # A link to a disk that is not mounted exists, but no folder can be created in it.
        parent = Path(directory).expanduser()
        parent.mkdir(parents=True, exist_ok=True)
        while True:
            folder = parent / (name if number == 1 else f"{name}_{number}")
            try:
                return BagWriter(folder, run=run, limits=limits, on_deleted=on_notice)
            except LogExistsError:
                number += 1
    except (OSError, RuntimeError) as error:  # RuntimeError if there is no such user
        message = f"log_directory must be a folder to write to ({error}), got {directory!r}"
        raise ConfigurationError(message) from None
