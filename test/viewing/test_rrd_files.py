# SPDX-License-Identifier: Apache-2.0
"""Files that follow each other when they are full."""

from __future__ import annotations

import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader

from contact_dynamics.viewing.kept_recording import KeptRecording
from contact_dynamics.viewing.measured import set_time
from contact_dynamics.viewing.sinks import RrdFiles
from viewing.drawn import STAMP_NS, read_drawn

SIZE = 100_000
FILL = np.random.default_rng(1).normal(size=(20_000, 3))  # 240 kB, which does not compress


def draw_files(folder: Path, *, size: int, most: int, full: int) -> list[str]:
    """Draw so that so many files are full, and return the names of those that are there."""
    recording = KeptRecording()
    files = RrdFiles(recording, str(folder / "drive.rrd"), size=size, most=most, on_problem=pytest.fail)
    recording.log("ground", rr.Points3D([[0.0, 0.0, 0.0]]), static=True)
    for i in range(full):
        set_time(recording, STAMP_NS + i)
        recording.log("fill", rr.Points3D(FILL))
        recording.log("number", rr.Scalars(float(i)))
        recording.flush()
        files.roll()
        files.roll()  # the next one is not full yet
        recording.log("fill", rr.Clear(recursive=False))
    recording.disconnect()
    return sorted(path.name for path in folder.iterdir())


def test_each_file_begins_with_what_stands(tmp_path: Path) -> None:
    """What fills a file stands when it is full, so the next is full at once: here it is cleared before."""
    names = draw_files(tmp_path, size=SIZE, most=0, full=2)
    assert names[:2] == ["drive.rrd", "drive_1.rrd"]
    for name in names:
        drawn = read_drawn(tmp_path / name)
        assert drawn.last("/ground", "Points3D:positions") == [[0.0, 0.0, 0.0]]
    numbers = [read_drawn(tmp_path / name).values.get(("/number", "Scalars:scalars"), []) for name in names]
    assert numbers[0] == [(STAMP_NS, [0.0])]
    assert numbers[1][0] == (STAMP_NS, [0.0])  # it stands when the file begins


def test_they_are_parts_of_one_recording(tmp_path: Path) -> None:
    names = draw_files(tmp_path, size=SIZE, most=0, full=2)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # files without an index are read whole
        entries = [entry for name in names for entry in RrdReader(tmp_path / name).recordings()]
    assert len(entries) == len(names) == 3
    assert len({entry.recording_id for entry in entries}) == 1


def test_the_oldest_files_go(tmp_path: Path) -> None:
    names = draw_files(tmp_path, size=SIZE, most=2, full=4)
    assert len(names) == 2
    assert "drive.rrd" not in names


@pytest.mark.parametrize("size", [0, 100_000_000])
def test_without_a_size_or_below_it_there_is_one_file(tmp_path: Path, size: int) -> None:
    assert draw_files(tmp_path, size=size, most=1, full=3) == ["drive.rrd"]


def test_a_file_that_is_deleted_is_followed_by_the_next(tmp_path: Path) -> None:
    recording, told = KeptRecording(), []
    path = tmp_path / "drive.rrd"
    files = RrdFiles(recording, str(path), size=SIZE, most=0, on_problem=told.append)
    path.unlink()
    files.roll()
    recording.log("later", rr.Points3D([[1.0, 2.0, 3.0]]), static=True)
    recording.disconnect()
    assert "/later" in read_drawn(tmp_path / "drive_1.rrd").entities
    assert told == []


DRAWS_BEYOND_THE_END_OF_THE_DISK = """
import os, resource, sys, time
import numpy as np
import rerun as rr
from contact_dynamics.viewing.measured import set_time
from contact_dynamics.viewing.sinks import RrdFiles
from contact_dynamics.viewing.kept_recording import KeptRecording

recording = KeptRecording()
files = RrdFiles(
    recording, sys.argv[1], size=int(sys.argv[2]), most=0, on_problem=lambda text: print(text, flush=True)
)
fill = rr.Points3D(np.random.default_rng(1).normal(size=(20_000, 3)))

def draw(step):
    set_time(recording, 1_760_000_000_000_000_000 + step)
    recording.log("fill", fill)
    recording.log("fill", rr.Clear(recursive=False))
    recording.log("number", rr.Scalars(float(step)))
    time.sleep(0.2)
    files.roll()

draw(0)
unlimited = resource.getrlimit(resource.RLIMIT_FSIZE)
resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, unlimited[1]))  # as if no room were left
for step in range(1, 6):
    draw(step)
resource.setrlimit(resource.RLIMIT_FSIZE, unlimited)
draw(6)
draw(7)
files.check()
recording.disconnect()
print(files.hold_all, flush=True)
os._exit(0)  # as who draws does where something could not be written
"""


def test_after_the_disk_was_full_the_picture_goes_on_in_the_next_file(tmp_path: Path) -> None:
    """By itself, rerun would write nothing more, also once there is room again."""
    path, root = tmp_path / "drive.rrd", Path(__file__).parents[2]
    command = [sys.executable, "-c", DRAWS_BEYOND_THE_END_OF_THE_DISK, str(path), "0"]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    first, second, third, last = done.stdout.splitlines()
    assert first == f"{path} cannot be written any more"
    assert second.startswith("the picture has no next file: ")
    assert third == f"the picture continues in {tmp_path / 'drive_1.rrd'}"
    assert last == "False"
    numbers = read_drawn(tmp_path / "drive_1.rrd").series("/number", "Scalars:scalars")
    assert numbers.tolist() == [6.0, 7.0]
