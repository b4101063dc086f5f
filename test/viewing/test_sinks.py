# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import sys
from pathlib import Path

import pytest
import rerun as rr

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.viewing.ports import LOCAL
from contact_dynamics.viewing.sinks import NowhereToDrawError, OpenRecording, Sinks, ViewerMode
from viewing.drawn import read_drawn


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
    url = f"rerun+http://{LOCAL}:{free_port}/proxy"
    sinks = Sinks(rrd_path=str(path), viewer=ViewerMode.CONNECT, url=url)
    recording = OpenRecording(sinks, on_problem=problems.append)
    draw(recording)
    assert recording.close()
    assert problems == [f"no viewer listens at {url}: [Errno 111] Connection refused"]
    assert recording.viewer_failed
    assert holds_the_point(path)


def test_a_viewer_that_hangs_does_not_keep_the_process(tmp_path: Path, silent_viewer: int) -> None:
    """In a process of its own, because rerun waits for such a viewer when a process ends."""
    import subprocess

    path = tmp_path / "a.rrd"
    script = f"""
import os
import rerun as rr
from contact_dynamics.viewing.sinks import OpenRecording, Sinks, ViewerMode
url = "rerun+http://{LOCAL}:{silent_viewer}/proxy"
sinks = Sinks(rrd_path={str(path)!r}, viewer=ViewerMode.CONNECT, url=url)
recording = OpenRecording(sinks, on_problem=lambda text: print(text, flush=True))
for _ in range(1000):
    recording.stream.log("point", rr.Points3D([[1.0, 2.0, 3.0]]), static=True)
os._exit(7 if recording.close(timeout=0.5) else 0)
"""
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=root, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "the viewer did not take all that was drawn within 0.5 s" in done.stdout
    assert holds_the_point(path)


def test_serving_is_for_this_machine_alone(free_port: int) -> None:
    recording = OpenRecording(Sinks(viewer=ViewerMode.SERVE, port=free_port), on_problem=print)
    try:
        draw(recording)
        listening = f":{free_port:04X} 00000000:0000 0A"
        tables = "".join(Path(f"/proc/net/{kind}").read_text(encoding="ascii") for kind in ("tcp", "tcp6"))
        addresses = [line.split()[1] for line in tables.splitlines() if listening in line]
        assert addresses == [f"0100007F:{free_port:04X}"]
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
    url = f"rerun+http://{LOCAL}:{free_port}/proxy"
    with pytest.raises(NowhereToDrawError, match=r"nowhere to draw to: no viewer listens at .*refused"):
        OpenRecording(Sinks(viewer=ViewerMode.CONNECT, url=url), on_problem=print)


DRAWS_FOR_EVER = """
import sys
from pathlib import Path
from contact_dynamics.viewing.measured import set_time
from contact_dynamics.viewing.sinks import OpenRecording, Sinks
import rerun as rr

def resident():
    return int(Path("/proc/self/statm").read_text().split()[1])

recording = OpenRecording(Sinks(rrd_path=sys.argv[1]), on_problem=print)
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
"""


def test_memory_does_not_grow_with_the_answers_that_were_drawn(tmp_path: Path) -> None:
    """What an answer of 20 things leaves behind in a process of its own.

    An index at the end of the file, which stays in memory until then, would make that 12 KB,
    and 50 KB for the visualizer's own answers, which have many kinds of parts. Without it there are 0.1 KB.
    """
    import resource
    import subprocess

    path = tmp_path / "long.rrd"
    command = [sys.executable, "-c", DRAWS_FOR_EVER, str(path)]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""  # rerun warns of a file without an index, which is meant
    assert float(done.stdout) * resource.getpagesize() < 2e3
    assert len(read_drawn(path).values["/part_0", "LineStrips3D:strips"]) == 4 * 60


@pytest.mark.parametrize("memory", ["", "much", "1 GB", "-1GB", "1gb", "50 %"])
def test_a_memory_that_is_no_size_is_refused(memory: str) -> None:
    with pytest.raises(InvalidFieldError, match=r"viewer_memory must be a size such as 500MB.*, got .*"):
        Sinks(viewer=ViewerMode.SERVE, memory=memory)
