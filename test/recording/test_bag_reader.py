# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import pytest

from contact_dynamics.recording import BagReader, BagWriter, DamagedLogWarning, NotALogError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    PoseCdr = Callable[[int, float], bytes]

POSE = "geometry_msgs/msg/PoseStamped"
CHUNKS = 6
PER_CHUNK = 20


@pytest.fixture
def log(tmp_path: Path, pose_cdr: PoseCdr) -> Path:
    with BagWriter(tmp_path / "log", run={"body": "cube"}) as writer:
        writer.add_topic("/pose", POSE)
        writer.add_topic("/other", POSE)
        for index in range(CHUNKS * PER_CHUNK):
            topic = "/pose" if index % 2 == 0 else "/other"
            writer.write(topic, pose_cdr(index, float(index)), log_time_ns=1_000_000 - index)
            if index % PER_CHUNK == PER_CHUNK - 1:
                writer.flush()
    return writer.path


def test_gives_back_what_was_written_in_that_order(log: Path, pose_cdr: PoseCdr) -> None:
    reader = BagReader(log.parent)
    messages = list(reader.messages())
    assert [message.data for message in messages] == [
        pose_cdr(i, float(i)) for i in range(CHUNKS * PER_CHUNK)
    ]
    assert [message.publish_time_ns for message in messages] == list(range(CHUNKS * PER_CHUNK))
    assert messages[0].log_time_ns == 1_000_000
    assert {message.type_name for message in messages} == {POSE}
    assert reader.damage is None
    assert reader.run()["body"] == "cube"


def test_bare_file_and_choice_of_topics(log: Path) -> None:
    messages = list(BagReader(log).messages({"/other"}))
    assert len(messages) == CHUNKS * PER_CHUNK // 2
    assert {message.topic for message in messages} == {"/other"}


def test_every_cut_gives_the_whole_chunks_before_it(log: Path, tmp_path: Path) -> None:
    whole = log.read_bytes()
    counts = []
    for size in range(len(whole) - 1, 100, -97):
        cut = tmp_path / "cut.mcap"
        cut.write_bytes(whole[:size])
        reader = BagReader(cut)
        with pytest.warns(DamagedLogWarning, match="cut short"):
            counts.append(len(list(reader.messages())))
        assert reader.damage is not None
    assert counts[0] == CHUNKS * PER_CHUNK
    assert all(before >= after for before, after in pairwise(counts))
    assert {count % PER_CHUNK for count in counts} == {0}
    assert set(counts) == set(range(0, CHUNKS * PER_CHUNK + 1, PER_CHUNK))


@pytest.mark.parametrize("name", ["split_{}", "{}_split_2026_11_28-10_11_12", "{}_a_2_2026_11_28-10_11_59"])
def test_files_of_a_split_bag_come_in_the_order_of_their_numbers(
    name: str, tmp_path: Path, pose_cdr: PoseCdr
) -> None:
    """Since ROS 2 Lyrical, rosbag2 puts the number first and the time of the file last."""
    folder = tmp_path / "split"
    folder.mkdir()
    for number in (10, 2, 0):
        with BagWriter(tmp_path / f"part{number}") as writer:
            writer.add_topic("/pose", POSE)
            writer.write("/pose", pose_cdr(number, 0.0), log_time_ns=number)
        writer.path.rename(folder / f"{name.format(number)}.mcap")
    assert [message.log_time_ns for message in BagReader(folder).messages()] == [0, 2, 10]


def test_what_is_no_log_is_refused(tmp_path: Path) -> None:
    with pytest.raises(NotALogError, match="no MCAP file"):
        BagReader(tmp_path)
    with pytest.raises(NotALogError, match="no such file or folder"):
        BagReader(tmp_path / "missing.mcap")
    other = tmp_path / "other.mcap"
    other.write_text("something else entirely")
    with pytest.raises(NotALogError, match="not an MCAP file"):
        list(BagReader(other).messages())
