# SPDX-License-Identifier: Apache-2.0
"""Logs of several files: where one ends, what is kept, and that standard readers take them."""

from __future__ import annotations

import gc
import os
import signal
import struct
import subprocess
import sys
import tracemalloc
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
import yaml
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording import BagReader, BagWriter, Compression, LogLimits, Recorder

if TYPE_CHECKING:
    from collections.abc import Callable

    PoseCdr = Callable[[int, float], bytes]

POSE = "geometry_msgs/msg/PoseStamped"
POINT = "geometry_msgs/msg/Point"
SECOND_NS = 1_000_000_000
START_NS = 1_700_000_000 * SECOND_NS


def noise(number: int) -> bytes:
    """A point that no compression makes smaller."""
    return b"\0\1\0\0" + struct.pack("<q", number) + os.urandom(16)


def written(folder: Path, limits: LogLimits, *, count: int = 12_000, **options: Any) -> BagWriter:
    """A log of points at 1 kHz, flushed 10 times a second."""
    with BagWriter(folder, run={"mass": "0.4"}, limits=limits, **options) as writer:
        writer.add_topic("/point", POINT)
        writer.add_topic("/silent", POSE)
        for number in range(count):
            writer.write("/point", noise(number), log_time_ns=START_NS + number * SECOND_NS // 1000)
            if number % 100 == 99:
                writer.flush()
    return writer


def metadata_of(folder: Path) -> Any:
    return yaml.safe_load((folder / "metadata.yaml").read_text())["rosbag2_bagfile_information"]


def numbers_in(folder: Path) -> list[int]:
    """What `noise` numbered, by our reader, which must not find any damage."""
    reader = BagReader(folder)
    numbers = [struct.unpack_from("<q", message.data, 4)[0] for message in reader.messages()]
    assert reader.damage is None
    assert reader.run()["mass"] == "0.4"
    return numbers


def assert_standard_readers_take(folder: Path, numbers: list[int]) -> None:
    """Rosbags takes the folder, and the seeking reader of mcap each file, which says what it is by itself."""
    with AnyReader([folder]) as reader:
        found = [struct.unpack_from("<q", data, 4)[0] for _, _, data in reader.messages()]
    assert found == numbers
    metadata = metadata_of(folder)
    assert metadata["message_count"] == len(numbers)
    counts = {
        each["topic_metadata"]["name"]: each["message_count"]
        for each in metadata["topics_with_message_count"]
    }
    assert counts == {"/point": len(numbers), "/silent": 0}
    assert metadata["relative_file_paths"] == [file["path"] for file in metadata["files"]]
    assert sorted(metadata["relative_file_paths"]) == sorted(path.name for path in folder.glob("*.mcap"))
    for file in metadata["files"]:
        with (folder / file["path"]).open("rb") as stream:
            seeking = make_reader(stream, validate_crcs=True)
            times = [message.log_time for _, _, message in seeking.iter_messages()]
            records = {record.name for record in seeking.iter_metadata()}
        assert records == {"contact_dynamics", "rosbag2"}
        assert len(times) == file["message_count"] > 0
        assert times[0] == file["starting_time"]["nanoseconds_since_epoch"]
        assert times[-1] - times[0] == file["duration"]["nanoseconds"]


def test_a_file_ends_at_its_size(tmp_path: Path) -> None:
    written(tmp_path / "log", LogLimits(file_bytes=100_000))
    sizes = [path.stat().st_size for path in BagReader(tmp_path / "log").paths]
    assert len(sizes) > 4
    assert all(100_000 <= size < 115_000 for size in sizes[:-1])  # a chunk of 100 messages, and the index
    assert numbers_in(tmp_path / "log") == list(range(12_000))
    assert_standard_readers_take(tmp_path / "log", list(range(12_000)))


def test_a_file_ends_after_its_time(tmp_path: Path) -> None:
    written(tmp_path / "log", LogLimits(file_seconds=5.0))
    spans = [
        (file["message_count"], file["duration"]["nanoseconds"])
        for file in metadata_of(tmp_path / "log")["files"]
    ]
    assert spans == [(5000, 4_999_000_000), (5000, 4_999_000_000), (2000, 1_999_000_000)]
    assert numbers_in(tmp_path / "log") == list(range(12_000))
    assert_standard_readers_take(tmp_path / "log", list(range(12_000)))


def test_the_oldest_files_go_where_a_limit_is_reached(tmp_path: Path) -> None:
    told: list[str] = []
    limits = LogLimits(file_bytes=100_000, kept_bytes=250_000)
    written(tmp_path / "log", limits, on_deleted=told.append)
    names = sorted(path.name for path in (tmp_path / "log").glob("*.mcap"))
    assert sum((tmp_path / "log" / name).stat().st_size for name in names) < 250_000
    assert "log_0.mcap" not in names
    assert len(told) == int(metadata_of(tmp_path / "log")["custom_data"]["deleted_files"])
    assert "log_0.mcap is deleted: 250000 bytes are kept" in told[0]
    left = numbers_in(tmp_path / "log")
    assert left == list(range(left[0], 12_000))
    assert_standard_readers_take(tmp_path / "log", left)


@pytest.mark.parametrize("compression", Compression)
def test_chunks_are_packed_as_asked_for(tmp_path: Path, compression: Compression) -> None:
    written(tmp_path / "log", LogLimits(compression=compression), count=1000)
    (path,) = BagReader(tmp_path / "log").paths
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    expected = "" if compression is Compression.NONE else compression.value
    assert {chunk.compression for chunk in summary.chunk_indexes} == {expected}
    assert numbers_in(tmp_path / "log") == list(range(1000))
    assert_standard_readers_take(tmp_path / "log", list(range(1000)))


@pytest.mark.parametrize(
    ("field", "limits"),
    [
        ("file_bytes", {"file_bytes": 1000}),
        ("file_seconds", {"file_seconds": 0.0}),
        ("file_seconds", {"file_seconds": float("nan")}),
        ("kept_bytes", {"kept_bytes": 10**9}),
        ("kept_bytes", {"file_bytes": 10**6, "kept_bytes": 10**6}),
    ],
)
def test_limits_that_cannot_be_kept_are_refused(field: str, limits: dict[str, Any]) -> None:
    with pytest.raises(InvalidFieldError, match=field):
        LogLimits(**limits)


def test_the_memory_of_the_index_is_that_of_one_file(tmp_path: Path) -> None:
    """After eight files as much memory is in use as after two."""
    used = []
    with BagWriter(tmp_path / "log", limits=LogLimits(file_bytes=100_000)) as writer:
        writer.add_topic("/point", POINT)
        tracemalloc.start()
        try:
            name = writer.path
            while len(used) < 8:
                writer.write("/point", noise(0), log_time_ns=START_NS)
                writer.flush()
                if writer.path != name:
                    name = writer.path
                    gc.collect()  # not what other tests of this process have left
                    used.append(tracemalloc.get_traced_memory()[0])
        finally:
            tracemalloc.stop()
    # What stays of a file is its line in metadata.yaml: less than 2 kB. Its index took more than 200 kB.
    assert used[-1] - used[1] < 6 * 2000


# Without a free descriptor, the next file cannot be opened; the present one is finished all the same.
NO_NEXT_FILE = """
import os, resource, sys
from contact_dynamics.recording import BagWriter, LogFailedError, LogLimits
writer = BagWriter(sys.argv[1], limits=LogLimits(file_seconds=1.0))
writer.add_topic("/point", "geometry_msgs/msg/Point")
point = bytes([0, 1, 0, 0]) + bytes(24)
for number in range(10):
    writer.write("/point", point, log_time_ns=number)
resource.setrlimit(resource.RLIMIT_NOFILE, (3, resource.getrlimit(resource.RLIMIT_NOFILE)[1]))
try:
    writer.write("/point", point, log_time_ns=2_000_000_000)
except OSError as error:
    print(error.strerror, writer.safe_count)
try:
    writer.write("/point", point, log_time_ns=2_000_000_000)
except LogFailedError as error:
    print("the next file cannot be begun" in str(error))
resource.setrlimit(resource.RLIMIT_NOFILE, (100, resource.getrlimit(resource.RLIMIT_NOFILE)[1]))
writer.close()
"""


def test_a_next_file_that_cannot_be_opened_leaves_the_last_one_whole(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", NO_NEXT_FILE, tmp_path / "log"], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines() == ["Too many open files 10", "True"]
    reader = BagReader(tmp_path / "log")
    assert len(list(reader.messages())) == 10
    assert reader.damage is None
    assert metadata_of(tmp_path / "log")["message_count"] == 10


# Files of a second each, of a clock that runs fast, until it is killed.
KILLED = """
import sys, time
from contact_dynamics.recording import BagWriter, LogLimits, Recorder
writer = BagWriter(sys.argv[1], limits=LogLimits(file_seconds=1.0))
writer.add_topic("/point", "geometry_msgs/msg/Point")
recorder = Recorder(writer)
number = 0
while True:
    recorder.record("/point", bytes([0, 1, 0, 0]) + bytes(24), log_time_ns=1_000_000 * number)
    number += 1
    if number % 2500 == 0:
        print(recorder.settle(), recorder.status.written, number, flush=True)
"""


def test_what_was_settled_survives_a_kill_and_finished_files_are_whole(tmp_path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", KILLED, tmp_path / "log"], stdout=subprocess.PIPE, text=True
    ) as writing:
        assert writing.stdout is not None
        for _ in range(3):
            settled, count, number = writing.stdout.readline().split()
        writing.send_signal(signal.SIGKILL)
    assert settled == "True"
    reader = BagReader(tmp_path / "log")
    with pytest.warns(UserWarning, match="its writer was killed"):
        times = [message.log_time_ns for message in reader.messages()]
    assert times == [1_000_000 * number for number in range(len(times))]
    assert len(times) >= int(count) == int(number)
    assert {loss.path for loss in reader.losses} == {reader.paths[-1]}
    assert len(reader.paths) == len(metadata_of(tmp_path / "log")["files"])


def test_settling_a_log_that_has_ended_says_so(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    writer = BagWriter(tmp_path / "log")
    writer.add_topic("/pose", POSE)
    with Recorder(writer) as recorder:
        assert recorder.settle()
        recorder.record("/pose", pose_cdr(0, 0.0), log_time_ns=0)
        assert recorder.settle()
        assert recorder.status.written == 1
        os.close(writer._file._file._descriptor)  # the disk is gone
        recorder.record("/pose", pose_cdr(0, 0.0), log_time_ns=0)
        assert not recorder.settle()
    assert recorder.status.lost == 1
