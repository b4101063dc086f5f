# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from contact_dynamics.recording import BagReader, BagWriter, Recorder, UnfinishedLogWarning

if TYPE_CHECKING:
    from collections.abc import Callable

    PoseCdr = Callable[[int, float], bytes]

POSE = "geometry_msgs/msg/PoseStamped"


def pose_log(folder: Path) -> BagWriter:
    writer = BagWriter(folder)
    writer.add_topic("/pose", POSE)
    return writer


class StuckWriter:
    """A log whose disk hangs, or fails, as the test says; counts like a `BagWriter`."""

    def __init__(self, error: Exception | None = None) -> None:
        self.folder = Path("stuck")
        self.go = threading.Event()
        self.error = error
        self.safe_count = 0
        self.taken = 0
        self.closed = False

    def write(self, *_: Any, **__: Any) -> None:
        self.go.wait(20.0)
        self.taken += 1

    def flush(self) -> None:
        if self.error is not None:
            raise self.error
        self.safe_count = self.taken

    def sync(self) -> None:
        pass

    def close(self) -> None:
        self.closed = True


def test_loses_nothing_from_many_threads_and_keeps_each_ones_order(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    threads, each = 8, 400
    problems: list[str] = []
    with Recorder(pose_log(tmp_path / "log"), on_problem=problems.append) as recorder:

        def give(thread: int) -> None:
            for index in range(each):
                recorder.record("/pose", pose_cdr(index, float(thread)), log_time_ns=thread * each + index)

        givers = [threading.Thread(target=give, args=(thread,)) for thread in range(threads)]
        for giver in givers:
            giver.start()
        for giver in givers:
            giver.join()
    status = recorder.status
    assert (status.written, status.lost, status.waiting, status.problem) == (threads * each, 0, 0, None)
    assert problems == []
    times = [message.log_time_ns for message in BagReader(tmp_path / "log").messages()]
    assert sorted(times) == list(range(threads * each))
    for thread in range(threads):
        own = [time_ns for time_ns in times if time_ns // each == thread]
        assert own == sorted(own)


def test_messages_reach_the_file_without_closing(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    with Recorder(pose_log(tmp_path / "log")) as recorder:
        recorder.record("/pose", pose_cdr(1, 2.0), log_time_ns=3)
        deadline = time.monotonic() + 90.0
        while recorder.status.written == 0 and time.monotonic() < deadline:
            time.sleep(0.01)
        with pytest.warns(UnfinishedLogWarning, match="is still being written"):
            (message,) = BagReader(tmp_path / "log").messages()
    assert message.data == pose_cdr(1, 2.0)


def test_refused_message_is_counted_reported_once_and_the_rest_goes_on(
    tmp_path: Path, pose_cdr: PoseCdr
) -> None:
    problems: list[str] = []
    with Recorder(pose_log(tmp_path / "log"), on_problem=problems.append) as recorder:
        recorder.record("/unknown", pose_cdr(0, 0.0), log_time_ns=0)
        recorder.record("/pose", "no bytes", log_time_ns=0)  # type: ignore[arg-type]
        recorder.record("/pose", pose_cdr(0, 0.0), log_time_ns=-1)
        recorder.record("/pose", pose_cdr(0, 0.0), log_time_ns=7)
    status = recorder.status
    assert (status.written, status.lost, status.waiting) == (1, 3, 0)
    assert len(problems) == 1
    assert "/unknown" in problems[0]
    assert "log_time_ns" in str(status.problem)  # the last one of the kind
    assert not status.is_interrupted


def test_failure_ends_the_log_and_not_the_caller() -> None:
    error = RuntimeError("a bug in a library")
    writer = StuckWriter(error)
    writer.go.set()
    problems: list[str] = []
    recorder = Recorder(writer, on_problem=problems.append)  # type: ignore[arg-type]
    recorder.record("/pose", b"first", log_time_ns=0)
    recorder.close()
    recorder.record("/pose", b"after", log_time_ns=0)
    assert (recorder.status.written, recorder.status.lost, recorder.status.waiting) == (0, 2, 0)
    assert len(problems) == 1
    assert str(error) in problems[0]
    assert writer.closed


def test_callback_that_raises_does_no_harm(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    def complain(problem: str) -> None:
        raise ValueError(problem)

    with Recorder(pose_log(tmp_path / "log"), on_problem=complain) as recorder:
        recorder.record("/unknown", pose_cdr(0, 0.0), log_time_ns=0)
        recorder.record("/pose", pose_cdr(0, 0.0), log_time_ns=0)
    assert (recorder.status.written, recorder.status.lost) == (1, 1)


def test_stalled_disk_costs_memory_up_to_the_bound_then_messages() -> None:
    writer = StuckWriter()
    problems: list[str] = []
    recorder = Recorder(writer, on_problem=problems.append, max_waiting_bytes=3000)  # type: ignore[arg-type]
    for _ in range(30):
        recorder.record("/pose", bytes(100), log_time_ns=0)
    status = recorder.status
    assert (status.lost, status.waiting, status.max_waiting_bytes) == (20, 10, 3000)
    assert len(problems) == 1
    assert "keep up" in problems[0]
    writer.go.set()
    status = recorder.close()
    assert (status.written, status.lost, status.waiting) == (10, 20, 0)


def test_a_message_that_is_too_large_is_not_taken_for_a_slow_disk(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    problems: list[str] = []
    with Recorder(pose_log(tmp_path / "log"), on_problem=problems.append, max_waiting_bytes=3000) as recorder:
        recorder.record("/pose", bytes(4000), log_time_ns=0)
        recorder.record("/pose", pose_cdr(0, 0.0), log_time_ns=0)
    assert problems == ["/pose: a message of 4200 bytes is not logged, since at most 3000 may wait"]
    assert (recorder.status.written, recorder.status.lost) == (1, 1)


def test_close_does_not_wait_for_a_hanging_disk_for_ever() -> None:
    writer = StuckWriter()
    recorder = Recorder(writer)  # type: ignore[arg-type]
    recorder.record("/pose", b"data", log_time_ns=0)
    assert recorder.close(timeout_s=0.3).waiting == 1
    writer.go.set()
    assert recorder.close().written == 1


STOOD_STILL = """
import sys
from pathlib import Path
from contact_dynamics.recording import Recorder

class Disk:
    folder, safe_count = Path("stuck"), 0
    def write(self, *_, **__): pass
    def flush(self): pass
    def sync(self):
        print("syncs", flush=True)
        sys.stdin.readline()
    def close(self): pass

recorder = Recorder(Disk())
recorder.record("/point", b"", log_time_ns=0)
print(recorder.settle(timeout_s=1.0), flush=True)
"""


def test_a_process_that_stood_still_longer_than_a_disk_may_take_waits_on_for_the_disk() -> None:
    """It once told of a disk that hangs, and answers then left before they were on it for 10 s."""
    with subprocess.Popen(
        [sys.executable, "-c", STOOD_STILL], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stdout.readline() == "syncs\n"
        process.send_signal(signal.SIGSTOP)
        time.sleep(1.1)
        process.stdin.write("\n")  # meanwhile the disk takes it
        process.stdin.flush()
        process.send_signal(signal.SIGCONT)
        assert process.stdout.readline() == "True\n"
