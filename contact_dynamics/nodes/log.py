"""The server's log: what its subscriptions and services carry, handed to a recorder as bytes."""

from __future__ import annotations

import time
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING

from contact_dynamics.recording.bag_writer import BagWriter
from contact_dynamics.recording.recorder import Recorder

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rclpy.qos import QoSProfile


def new_log_folder(directory: str) -> Path:
    """Return a folder that does not exist yet, named by the time, in ``directory`` or where the process was started."""
    name = datetime.now(timezone.utc).astimezone().strftime("contact_dynamics_%Y_%m_%d-%H_%M_%S")
    folder = Path(directory) / name
    number = 1
    while folder.exists():
        number += 1
        folder = Path(directory) / f"{name}_{number}"
    return folder


class Log:
    """Records bytes under topics that are declared before the first message; without a folder it records nothing."""

    def __init__(
        self, folder: Path | None, *, run: Mapping[str, str], on_problem: Callable[[str], object]
    ) -> None:
        """Create the folder. Raises `OSError` where it cannot be made: a log that was asked for and fails at the start is told."""
        self._writer = BagWriter(folder, run=run) if folder is not None else None
        self._recorder: Recorder | None = None
        self._on_problem = on_problem

    def add_topic(self, topic: str, type_name: str, qos: QoSProfile) -> None:
        """Declare a topic, before `start`."""
        if self._writer is not None:
            self._writer.add_topic(topic, type_name, qos)

    def start(self) -> None:
        """Begin to record."""
        if self._writer is not None:
            self._recorder = Recorder(self._writer, on_problem=self._on_problem)

    def record(self, topic: str, data: bytes) -> None:
        """Record a message as received now."""
        if self._recorder is not None:
            self._recorder.record(topic, data, log_time_ns=time.time_ns())

    def close(self) -> str:
        """Finish the file; return in words where it is and how complete."""
        if self._recorder is None or self._writer is None:
            return "no log was written"
        status = self._recorder.close()
        lost = f", {status.lost} lost: {status.problem}" if status.lost else ""
        return f"log: {self._writer.path} ({status.written} messages{lost})"
