# SPDX-License-Identifier: Apache-2.0
"""rerun's own viewer, without a window, dies and comes back, hangs or is there again at once."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from rerun.experimental import ViewerClient

from contact_dynamics.viewing.kept_recording import APPLICATION, KeptRecording
from contact_dynamics.viewing.measured import set_time
from contact_dynamics.viewing.sinks import MAX_BEHIND, LiveViewer, OpenRecording, Sinks, ViewerMode
from contact_dynamics.viewing.viewer_process import LOCAL, local_url
from viewing.drawn import STAMP_NS
from viewing.viewers import listens, rerun_at, wait_until


@contextlib.contextmanager
def viewer(port: int, *arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """A viewer without a window that listens at a port, and is killed at the end."""
    with rerun_at(port, "--headless", *arguments) as process:
        wait_for(lambda: listens(port), process)
        yield process


def wait_for(done: Callable[[], bool], viewer: subprocess.Popen[bytes]) -> None:
    """Wait for something that needs a viewer. Without a driver for Vulkan, that listens and then ends."""

    def is_done_or_ended() -> bool:
        if viewer.poll() is not None:
            pytest.skip("NOT TESTED: a viewer that returns. It needs `apt install mesa-vulkan-drivers`.")
        return done()

    wait_until(is_done_or_ended)


pytestmark = pytest.mark.skipif(
    not hasattr(ViewerClient, "get_recording_schema"),
    reason="NOT TESTED: this rerun's viewer does not say what it has",
)

STATIC, NEWEST = "/ground", "/newest"


def shown(port: int) -> set[str]:
    """The entities that a viewer has of our picture."""
    try:
        client = ViewerClient.connect(local_url(port))
        ours = [each for each in client.get_state().recordings if APPLICATION in str(each.store_id)]
        return {
            one.entity_path for each in ours for one in client.get_recording_schema(each.store_id).entities
        }
    except Exception:  # noqa: BLE001  while it starts and has no recording, it raises several untyped errors
        return set()


def draw(recording: OpenRecording) -> None:
    recording.stream.log(STATIC, rr.Points3D([[1.0, 2.0, 3.0]]), static=True)
    set_time(recording.stream, STAMP_NS)
    recording.stream.log(NEWEST, rr.Points3D([[1.0, 2.0, 3.0]]))


def free_ports() -> tuple[int, int]:
    with socket.socket() as one, socket.socket() as other:
        for probe in (one, other):
            probe.bind((LOCAL, 0))
        return one.getsockname()[1], other.getsockname()[1]


@pytest.fixture
def closing() -> Iterator[contextlib.ExitStack]:
    """It closes the recordings also where a test is skipped."""
    with contextlib.ExitStack() as stack:
        yield stack


def test_one_that_is_drawn_to_gets_the_picture_again(free_port: int, closing: contextlib.ExitStack) -> None:
    told: list[str] = []
    url = local_url(free_port)
    with viewer(free_port) as first:
        recording = OpenRecording(Sinks(viewer=ViewerMode.CONNECT, url=url), on_problem=told.append)
        closing.callback(recording.close)
        draw(recording)
        wait_for(lambda: {STATIC, NEWEST} <= shown(free_port), first)

    def has_heard(words: str) -> bool:
        recording.tend()
        return any(words in each for each in told)

    wait_until(lambda: has_heard(f"no viewer listens at {url} any more"))
    recording.stream.log("/meanwhile", rr.Points3D([[1.0, 2.0, 3.0]]))
    with viewer(free_port) as second:
        wait_for(lambda: has_heard(f"a viewer listens at {url} again"), second)
        wait_for(lambda: {STATIC, NEWEST, "/meanwhile"} <= shown(free_port), second)
        recording.stream.log("/later", rr.Points3D([[1.0, 2.0, 3.0]]))
        wait_for(lambda: "/later" in shown(free_port), second)
        assert recording.close()
    assert len(told) == 2


def test_one_that_looks_at_what_is_served_gets_the_picture_again(closing: contextlib.ExitStack) -> None:
    """Also when more was drawn than the memory holds: what stands still and the newest are not dropped."""
    served, port = free_ports()
    recording = OpenRecording(Sinks(viewer=ViewerMode.SERVE, port=served, memory="1MB"), on_problem=print)
    closing.callback(recording.close)
    draw(recording)
    fill = np.random.default_rng(1).normal(size=(20_000, 3))  # 240 kB, which does not compress
    for _ in range(2):
        with viewer(port, "--connect", local_url(served)) as looking:
            wait_for(lambda: STATIC in shown(port), looking)
        for i in range(40):  # 10 MB
            recording.stream.log(f"/fill/{i}", rr.Points3D(fill))
        recording.stream.flush()
        recording.stream.log("/last", rr.Points3D([[1.0, 2.0, 3.0]]))
    with viewer(port, "--connect", local_url(served)) as looking:
        wait_for(lambda: {STATIC, "/last"} <= shown(port), looking)
        assert "/fill/0" not in shown(port)  # the memory has its limit
    assert recording.close()


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


def fill(recording: KeptRecording, count: int) -> None:
    for i in range(count):
        set_time(recording, STAMP_NS + i)
        recording.log("fill", FILL)


def test_nothing_is_drawn_to_it_until_it_goes_on(server: subprocess.Popen[bytes], free_port: int) -> None:
    told: list[str] = []
    url = local_url(free_port)
    recording = KeptRecording()
    viewer = LiveViewer(recording, url, on_problem=told.append)
    for _ in range(2 * MAX_BEHIND):  # it keeps up
        fill(recording, 1)
        viewer.look()
        time.sleep(0.01)
    assert told == []
    server.send_signal(signal.SIGSTOP)
    fill(recording, 100)  # more than the sockets take
    for _ in range(MAX_BEHIND):
        viewer.look()
    assert told == [f"the viewer at {url} does not respond; it receives the picture once it does"]
    assert viewer.hangs
    before = resident()
    fill(recording, 500)  # 120 MB
    assert resident() - before < 60e6
    server.send_signal(signal.SIGCONT)

    def goes_on() -> bool:
        viewer.look()
        return not viewer.hangs

    wait_until(goes_on)
    assert told[1:] == [f"the viewer at {url} responds again and has the picture"]
    fill(recording, 1)
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
