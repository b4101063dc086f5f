# SPDX-License-Identifier: Apache-2.0
"""rerun's own server, in the place of a viewer, hangs and goes on, or is there again at once."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import rerun as rr

from contact_dynamics.viewing.kept_recording import KeptRecording
from contact_dynamics.viewing.measured import set_time
from contact_dynamics.viewing.sinks import MAX_BEHIND, LiveViewer
from contact_dynamics.viewing.viewer_process import local_url
from viewing.drawn import STAMP_NS
from viewing.viewers import listens, rerun_at, wait_until

FILL = rr.Points3D(np.random.default_rng(1).normal(size=(20_000, 3)))  # 240 kB


@pytest.fixture
def server(free_port: int) -> Iterator[subprocess.Popen[bytes]]:
    with rerun_at(free_port, "--serve-grpc") as process:
        wait_until(lambda: listens(free_port))
        yield process


def resident() -> int:
    """The memory of this process, bytes."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def draw(recording: KeptRecording, count: int) -> None:
    for i in range(count):
        set_time(recording, STAMP_NS + i)
        recording.log("fill", FILL)


def test_nothing_is_drawn_to_it_until_it_goes_on(server: subprocess.Popen[bytes], free_port: int) -> None:
    told: list[str] = []
    url = local_url(free_port)
    recording = KeptRecording()
    viewer = LiveViewer(recording, url, on_problem=told.append)
    for _ in range(2 * MAX_BEHIND):  # it keeps up
        draw(recording, 1)
        viewer.look()
        time.sleep(0.01)
    assert told == []
    server.send_signal(signal.SIGSTOP)
    draw(recording, 100)  # more than the sockets take
    for _ in range(MAX_BEHIND):
        viewer.look()
    assert told == [f"the viewer at {url} does not respond; it receives the picture once it does"]
    assert viewer.hangs
    before = resident()
    draw(recording, 500)  # 120 MB
    assert resident() - before < 60e6
    server.send_signal(signal.SIGCONT)

    def goes_on() -> bool:
        viewer.look()
        return not viewer.hangs

    wait_until(goes_on)
    assert told[1:] == [f"the viewer at {url} responds again and has the picture"]
    draw(recording, 1)
    recording.flush(timeout_sec=10.0)
    recording.disconnect()


def test_one_that_is_there_again_before_anybody_looked_gets_the_picture(
    server: subprocess.Popen[bytes], free_port: int
) -> None:
    """Nothing is drawn meanwhile: rerun tells at once that the connection is severed."""
    told: list[str] = []
    recording = KeptRecording()
    viewer = LiveViewer(recording, local_url(free_port), on_problem=told.append)
    viewer.look()
    server.kill()
    server.wait()

    def are_told() -> bool:
        viewer.look()
        return len(told) == 2

    with rerun_at(free_port, "--serve-grpc"):
        wait_until(lambda: listens(free_port))
        wait_until(are_told)
        assert [each.split(" at ")[0] for each in told] == ["no viewer listens", "a viewer listens"]
        recording.flush(timeout_sec=10.0)
        recording.disconnect()
