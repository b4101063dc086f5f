# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import http.client
import resource
import subprocess
import sys
from pathlib import Path

import pytest
import rerun as rr

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.viewing.sinks import NowhereToDrawError, OpenRecording, Sinks, ViewerMode, WebViewer
from contact_dynamics.viewing.viewer_process import LOCAL, local_url, serving_problem
from viewing.drawn import read_drawn
from viewing.viewers import PATIENCE_S, listeners, listens, wait_until


def draw(recording: OpenRecording) -> None:
    recording.stream.log("point", rr.Points3D([[1.0, 2.0, 3.0]]), static=True)


def holds_the_point(path: Path) -> bool:
    return read_drawn(path).last("/point", "Points3D:positions") == [[1.0, 2.0, 3.0]]


def test_a_file_holds_what_is_drawn(tmp_path: Path) -> None:
    path, problems = tmp_path / "a.rrd", []
    recording = OpenRecording(Sinks(rrd_path=str(path)), on_problem=problems.append)
    draw(recording)
    assert recording.close()
    assert recording.description == str(path)
    assert holds_the_point(path)
    assert problems == []


def test_a_file_that_cannot_be_written_is_told_at_once(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="nowhere"):
        OpenRecording(Sinks(rrd_path=str(tmp_path / "nowhere" / "a.rrd")), on_problem=print)


def test_a_viewer_that_is_not_there_leaves_the_file(tmp_path: Path, free_port: int) -> None:
    path, problems = tmp_path / "a.rrd", []
    url = local_url(free_port)
    sinks = Sinks(rrd_path=str(path), viewer=ViewerMode.CONNECT, url=url)
    recording = OpenRecording(sinks, on_problem=problems.append)
    draw(recording)
    assert recording.close()
    assert problems == [f"no viewer listens at {url}: [Errno 111] Connection refused"]
    assert recording.viewer_failed
    assert holds_the_point(path)


def test_serving_is_for_this_machine_alone(free_port: int) -> None:
    recording = OpenRecording(Sinks(viewer=ViewerMode.SERVE, port=free_port), on_problem=print)
    try:
        draw(recording)
        assert listeners(free_port) == {f"0100007F:{free_port:04X}"}
    finally:
        assert recording.close()


def test_a_taken_port_is_told(tmp_path: Path, silent_viewer: int) -> None:
    problems: list[str] = []
    sinks = Sinks(rrd_path=str(tmp_path / "a.rrd"), viewer=ViewerMode.SERVE, port=silent_viewer)
    recording = OpenRecording(sinks, on_problem=problems.append)
    assert recording.close()
    assert len(problems) == 1
    assert f"the picture is not served at port {silent_viewer}: " in problems[0]
    assert "Address already in use" in problems[0]


def test_a_viewer_alone_that_is_not_there_is_an_error(free_port: int) -> None:
    """To draw to nowhere would look like a success."""
    url = local_url(free_port)
    with pytest.raises(NowhereToDrawError, match=r"nowhere to draw to: no viewer listens at .*refused"):
        OpenRecording(Sinks(viewer=ViewerMode.CONNECT, url=url), on_problem=print)


DRAWS_FOR_EVER_AND_TO_A_VIEWER_THAT_HANGS = """
import os, sys
from pathlib import Path
from contact_dynamics.viewing.measured import set_time
from contact_dynamics.viewing.sinks import OpenRecording, Sinks, ViewerMode
import rerun as rr

def resident():
    return int(Path("/proc/self/statm").read_text().split()[1])

recording = OpenRecording(Sinks(rrd_path=sys.argv[1], rrd_footer=False), on_problem=print)
pages = []
for answer in range(4 * 60):
    set_time(recording.stream, 1_760_000_000_000_000_000 + answer)
    for part in range(20):
        recording.stream.log(f"part_{part}", rr.LineStrips3D([[[0, 0, answer], [1, 0, part]]]))
    recording.stream.flush()  # answers come one by one
    if answer % 60 == 59:
        pages.append(resident())
recording.close()
print((pages[3] - pages[1]) / (2 * 60))

sinks = Sinks(rrd_path=sys.argv[2], viewer=ViewerMode.CONNECT, url=sys.argv[3])
recording = OpenRecording(sinks, on_problem=lambda text: print(text, flush=True))
for _ in range(1000):
    recording.stream.log("point", rr.Points3D([[1.0, 2.0, 3.0]]), static=True)
sys.stdout.flush()
os._exit(7 if recording.close(timeout=0.5) else 0)
"""


def test_a_process_neither_keeps_what_it_drew_nor_is_kept_by_a_viewer_that_hangs(
    tmp_path: Path, silent_viewer: int
) -> None:
    """What an answer of 20 things leaves behind in memory, and what ends of itself, in a process of its own.

    An index at the end of the file, which stays in memory until then, would make that 12 KB an answer, and
    50 KB for the visualizer's own answers, which have many kinds of parts. Without it there are 0.1 KB. And
    rerun waits for a viewer that hangs when a process ends.
    """
    long, hung, url = tmp_path / "long.rrd", tmp_path / "hung.rrd", local_url(silent_viewer)
    script = DRAWS_FOR_EVER_AND_TO_A_VIEWER_THAT_HANGS
    command = [sys.executable, "-c", script, str(long), str(hung), url]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert "file_sink" not in done.stderr  # rerun warns of a file without an index, which is meant
    left, told = done.stdout.splitlines()
    assert float(left) * resource.getpagesize() < 2e3
    assert len(read_drawn(long).values["/part_0", "LineStrips3D:strips"]) == 4 * 60
    assert told == "the viewer did not take all that was drawn within 0.5 s"
    assert holds_the_point(hung)


@pytest.mark.parametrize("memory", ["", "much", "1 GB", "-1GB", "1gb", "50 %"])
def test_a_memory_that_is_no_size_is_refused(memory: str) -> None:
    with pytest.raises(InvalidFieldError, match=r"viewer_memory must be a size such as 500MB.*, got .*"):
        Sinks(viewer=ViewerMode.SERVE, memory=memory)


def page(port: int) -> bytes:
    """What a browser gets, as soon as something listens."""
    wait_until(lambda: listens(port))
    connection = http.client.HTTPConnection(LOCAL, port, timeout=PATIENCE_S)
    connection.request("GET", "/")
    content = connection.getresponse().read()
    connection.close()
    return content


def test_a_browser_of_this_machine_finds_it_until_it_is_closed(free_port: int) -> None:
    problems: list[str] = []
    served = "rerun%2Bhttp%3A%2F%2F127.0.0.1%3A1%2Fproxy"
    web = WebViewer(free_port, "rerun+http://127.0.0.1:1/proxy", on_problem=problems.append)
    try:
        assert web.address == f"http://{LOCAL}:{free_port}/?url={served}&theme=dark"
        assert b"<title>Rerun Viewer</title>" in page(free_port)
        assert listeners(free_port) == {f"0100007F:{free_port:04X}"}
    finally:
        web.close()
    assert serving_problem(free_port) == ""
    assert problems == []


def test_the_picture_is_served_although_the_browsers_port_is_taken(
    free_port: int, silent_viewer: int
) -> None:
    problems: list[str] = []
    sinks = Sinks(viewer=ViewerMode.SERVE, port=free_port, web_port=silent_viewer)
    recording = OpenRecording(sinks, on_problem=problems.append)
    assert recording.description == f"served at rerun+http://{LOCAL}:{free_port}/proxy"
    assert not recording.viewer_failed
    assert recording.close()
    (problem,) = problems
    assert problem.startswith(f"the web viewer is not served at port {silent_viewer}: ")
    assert "Address already in use" in problem
