# SPDX-License-Identifier: Apache-2.0
"""rerun's own viewer: that it opens, and what is told when it does not."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
import rerun as rr
from rerun.experimental import ViewerClient

from contact_dynamics.viewing.sinks import OpenRecording, Sinks, ViewerMode
from contact_dynamics.viewing.viewer_process import LOCAL, viewer_executable
from viewing.drawn import read_drawn
from viewing.viewers import wait_until

NO_DISPLAY = "neither DISPLAY nor WAYLAND_DISPLAY is set; draw into a file"
DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET")


@pytest.fixture
def no_display(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in DISPLAYS:
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def display(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A display of this test alone."""
    if shutil.which("Xvfb") is None:
        pytest.skip("NOT TESTED: that a window opens. It needs `apt install xvfb mesa-vulkan-drivers`.")
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", "800x600x24", "-nolisten", "tcp"]
    server = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as number:
        monkeypatch.setenv("DISPLAY", f":{number.readline().strip()}")
    yield
    server.terminate()
    server.wait()


def spawned(tmp_path: Path, port: int, problems: list[str]) -> OpenRecording:
    sinks = Sinks(rrd_path=str(tmp_path / "a.rrd"), viewer=ViewerMode.SPAWN, port=port)
    recording = OpenRecording(sinks, on_problem=problems.append)
    recording.stream.log("point", rr.Points3D([[1.0, 2.0, 3.0]]), static=True)
    return recording


def viewers_at(port: int) -> list[int]:
    """Process ids of the viewers that were started for a port."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            arguments = (process / "cmdline").read_bytes().split(b"\0")
        except OSError:  # it has ended meanwhile
            continue
        if b"--bind" in arguments and str(port).encode() in arguments:
            found.append(int(process.name))
    return found


@pytest.mark.usefixtures("no_display", "display")
def test_the_viewer_opens_and_is_heard_when_it_is_killed(tmp_path: Path, free_port: int) -> None:
    problems: list[str] = []
    recording = spawned(tmp_path, free_port, problems)
    if problems and "WGPU error" in problems[0]:
        pytest.skip(f"NOT TESTED: that a window opens. Nothing draws here: {problems[0]}")
    assert problems == []
    assert not recording.viewer_failed
    (viewer,) = viewers_at(free_port)
    try:
        recording.stream.flush()
        shown = tmp_path / "shown.png"
        ViewerClient.connect(f"rerun+http://{LOCAL}:{free_port}/proxy").save_screenshot(str(shown))
        assert shown.read_bytes().startswith(b"\x89PNG")
        again: list[str] = []
        second = spawned(tmp_path, free_port, again)  # draws in the one that is open
        assert second.close()
        assert again == []
        assert viewers_at(free_port) == [viewer]
    finally:
        os.kill(viewer, signal.SIGKILL)
    wait_until(lambda: bool(problems))
    assert problems[0].startswith("rerun's viewer ended with exit code -9: ")
    assert recording.viewer_failed
    recording.close()


@pytest.mark.usefixtures("no_display")
def test_without_a_display_it_is_told_that_there_is_none(
    tmp_path: Path, free_port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It listens before it looks for a display, so that it listens is not enough."""
    folder = tmp_path / "with a space"
    folder.mkdir()
    (folder / "rerun").symlink_to(viewer_executable())
    monkeypatch.setenv("RERUN_CLI_PATH", str(folder / "rerun"))
    monkeypatch.setenv("PATH", "/nowhere")
    problems: list[str] = []
    recording = spawned(tmp_path, free_port, problems)
    assert recording.viewer_failed
    assert recording.close()
    assert len(problems) == 1
    assert problems[0].startswith("rerun's viewer has no screen to open on, since ")
    assert NO_DISPLAY in problems[0]
    assert "\x1b" not in problems[0]
    assert read_drawn(tmp_path / "a.rrd").last("/point", "Points3D:positions") == [[1.0, 2.0, 3.0]]


def test_the_viewer_is_that_of_the_library_which_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RERUN_CLI_PATH", raising=False)
    said = subprocess.run([viewer_executable(), "--version"], capture_output=True, text=True, check=True)
    assert f" {rr.__version__} " in said.stdout


def test_a_viewer_that_is_missing_is_named(
    tmp_path: Path, free_port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RERUN_CLI_PATH", str(tmp_path / "nowhere"))
    problems: list[str] = []
    assert spawned(tmp_path, free_port, problems).close()
    (problem,) = problems
    assert problem.startswith("rerun's viewer cannot be started: ")
    assert f"No such file or directory: '{tmp_path / 'nowhere'}'" in problem


def test_a_port_that_something_else_has_is_told(tmp_path: Path, free_port: int) -> None:
    problems: list[str] = []
    with socket.socket() as other:
        other.bind((LOCAL, free_port))
        other.listen()
        recording = spawned(tmp_path, free_port, problems)
    assert recording.close()
    assert problems == [f"port {free_port} is taken by something that does not answer as rerun's viewer does"]
