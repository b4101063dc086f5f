# SPDX-License-Identifier: Apache-2.0
"""Recordings that our server never wrote: by rosbags and by mcap, in every form that rosbag2 has."""

from __future__ import annotations

import random
import sqlite3
import struct
import tracemalloc
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
import zstandard
from mcap.writer import CompressionType, Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import Stores, get_typestore

from contact_dynamics.recording import (
    BagReader,
    BagWriter,
    DamagedLogWarning,
    NotALogError,
    decode_without_ros,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    PoseCdr = Callable[[int, float], bytes]

POSE = "geometry_msgs/msg/PoseStamped"
SECOND_NS = 1_000_000_000
COUNT = 600


def rosbags_bag(
    folder: Path, pose_cdr: PoseCdr, *, storage: StoragePlugin, mode: CompressionMode = CompressionMode.NONE
) -> None:
    """A bag of poses, one a second, as rosbags writes it."""
    store = get_typestore(Stores.ROS2_JAZZY)
    writer = RosbagsWriter(folder, version=9, storage_plugin=storage)
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        poses = writer.add_connection("/pose", POSE, typestore=store)
        other = writer.add_connection("/other", POSE, typestore=store)
        for number in range(COUNT):
            data = pose_cdr(number, float(number))
            writer.write(poses if number % 2 == 0 else other, number * SECOND_NS, data)


def assert_poses(found: list[Any], numbers: range) -> None:
    """The messages are the poses of those numbers, with their contents."""
    assert [message.log_time_ns // SECOND_NS for message in found] == list(numbers)
    assert {message.type_name for message in found} == {POSE}
    decoded = [decode_without_ros(message) for message in found]
    assert [pose.pose.position.x for pose in decoded] == [float(number) for number in numbers]


@pytest.mark.parametrize("mode", [CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE])
@pytest.mark.parametrize("storage", StoragePlugin)
def test_every_form_of_rosbag2_is_read(
    tmp_path: Path, pose_cdr: PoseCdr, storage: StoragePlugin, mode: CompressionMode
) -> None:
    rosbags_bag(tmp_path / "bag", pose_cdr, storage=storage, mode=mode)
    reader = BagReader(tmp_path / "bag")
    assert_poses(list(reader.messages()), range(COUNT))
    assert_poses(list(reader.messages({"/other"})), range(1, COUNT, 2))
    within = reader.messages(start_ns=100 * SECOND_NS, end_ns=200 * SECOND_NS)
    assert_poses(list(within), range(100, 200))
    assert reader.damage is None
    assert reader.run() == {}
    assert BagReader(reader.paths[0]).paths == reader.paths


@pytest.mark.parametrize("compression", CompressionType)
def test_files_of_another_tool_in_a_folder_of_several(
    tmp_path: Path, pose_cdr: PoseCdr, compression: CompressionType
) -> None:
    """The writer of mcap itself, with its chunks, which has no idea of ROS; and a channel that is no CDR."""
    for part in range(3):
        with (tmp_path / f"run_{part}.mcap").open("wb") as stream:
            writer = Writer(stream, chunk_size=4096, compression=compression)
            writer.start()
            schema = writer.register_schema(POSE, "ros2msg", pose_text(tmp_path))
            json = writer.register_schema("Note", "jsonschema", b"{}")
            channel = writer.register_channel("/pose", "cdr", schema)
            notes = writer.register_channel("/notes", "json", json)
            for number in range(200 * part, 200 * part + 200):
                time_ns = number * SECOND_NS
                writer.add_message(channel, time_ns, pose_cdr(number, float(number)), time_ns)
                writer.add_message(notes, time_ns, b"{}", time_ns)
            writer.finish()
    reader = BagReader(tmp_path)
    assert_poses(list(reader.messages({"/pose"})), range(COUNT))
    assert_poses(
        list(reader.messages({"/pose"}, start_ns=190 * SECOND_NS, end_ns=410 * SECOND_NS)), range(190, 410)
    )
    assert {message.type_name for message in reader.messages({"/notes"})} == {""}
    assert reader.damage is None


def pose_text(folder: Path) -> bytes:
    """The text of a pose's type, as a log has it."""
    if not (folder / "text").exists():
        with BagWriter(folder / "text") as writer:
            writer.add_topic("/pose", POSE)
    return BagReader(folder / "text").definitions()[POSE].encode()


def test_a_span_of_times_is_read_by_the_index(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    """All chunks outside the span are damaged, and nobody notices."""
    with BagWriter(tmp_path / "log") as writer:
        writer.add_topic("/pose", POSE)
        for number in range(COUNT):
            writer.write("/pose", pose_cdr(number, float(number)), log_time_ns=number * SECOND_NS)
            if number % 50 == 49:
                writer.flush()
    data = bytearray(writer.path.read_bytes())
    places = [at for at in range(len(data)) if data.startswith(b"zstd", at)]
    for chunk, at in enumerate(places[: COUNT // 50]):
        if chunk not in {4, 5}:
            data[at + 20] ^= 0xFF
    writer.path.write_bytes(data)
    reader = BagReader(tmp_path / "log")
    assert_poses(list(reader.messages(start_ns=210 * SECOND_NS, end_ns=290 * SECOND_NS)), range(210, 290))
    assert reader.damage is None
    with pytest.warns(DamagedLogWarning):
        assert len(list(reader.messages())) == 100


def test_a_bag_from_before_types_were_stored(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    rosbags_bag(tmp_path / "bag", pose_cdr, storage=StoragePlugin.SQLITE3)
    (path,) = BagReader(tmp_path / "bag").paths
    with sqlite3.connect(path) as database:
        database.execute("DROP TABLE message_definitions")
    database.close()
    assert_poses(list(BagReader(path).messages()), range(COUNT))


def test_other_databases_and_files_are_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "text.db3").write_text("hello")
    with pytest.raises(NotALogError, match=r"text\.db3 is not an SQLite file"):
        list(BagReader(tmp_path / "text.db3").messages())
    with sqlite3.connect(tmp_path / "other.db3") as database:
        database.execute("CREATE TABLE dogs (name TEXT)")
    database.close()
    with pytest.raises(NotALogError, match=r"other\.db3: no bag of rosbag2: its tables are dogs"):
        list(BagReader(tmp_path / "other.db3").messages())
    # A view that never ends is no table of messages.
    with sqlite3.connect(tmp_path / "endless.db3") as database:
        database.execute("CREATE TABLE topics (id, name, type, serialization_format)")
        database.execute(
            "CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM n) "
            "SELECT id, 1 AS topic_id, id AS timestamp, zeroblob(100) AS data FROM n"
        )
    database.close()
    with pytest.raises(NotALogError, match=r"endless\.db3: no bag of rosbag2"):
        list(BagReader(tmp_path / "endless.db3").messages())
    (tmp_path / "text.mcap.zstd").write_bytes(b"hello")
    with pytest.raises(NotALogError):
        list(BagReader(tmp_path / "text.mcap.zstd").messages())


def test_a_cut_database_gives_what_can_be_reached(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    """Cut between pages, and within the last one: only errors of ours come."""
    rosbags_bag(tmp_path / "bag", pose_cdr, storage=StoragePlugin.SQLITE3)
    (path,) = BagReader(tmp_path / "bag").paths
    whole = path.read_bytes()
    cut = tmp_path / "cut.db3"
    most = 0
    for size in [*range(0, len(whole), 4096), *range(len(whole) - 3000, len(whole), 177)]:
        cut.write_bytes(whole[:size])
        most = max(most, len(_readable(cut)))
    assert most > COUNT // 2


def test_a_damaged_page_costs_its_rows(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    rosbags_bag(tmp_path / "bag", pose_cdr, storage=StoragePlugin.SQLITE3)
    (path,) = BagReader(tmp_path / "bag").paths
    whole = path.read_bytes()
    damaged = tmp_path / "damaged.db3"
    middle = whole.index(pose_cdr(300, 300.0)) // 4096 * 4096
    damaged.write_bytes(whole[:middle] + b"\xff" * 4096 + whole[middle + 4096 :])
    reader = BagReader(damaged)
    with pytest.warns(DamagedLogWarning, match="rows from"):
        found = [message.log_time_ns // SECOND_NS for message in reader.messages()]
    assert found[:250] == list(range(250))
    assert found[-200:] == list(range(COUNT - 200, COUNT))
    assert 300 not in found


@pytest.mark.parametrize("storage", StoragePlugin)
@pytest.mark.parametrize("mode", [CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE])
def test_flipped_bits_give_named_errors_and_no_more(
    tmp_path: Path, pose_cdr: PoseCdr, storage: StoragePlugin, mode: CompressionMode
) -> None:
    rosbags_bag(tmp_path / "bag", pose_cdr, storage=storage, mode=mode)
    (path,) = BagReader(tmp_path / "bag").paths
    whole = path.read_bytes()
    draw = random.Random(5)
    flipped = tmp_path / f"flipped{''.join(path.suffixes)}"
    for _ in range(15):
        data = bytearray(whole)
        data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
        flipped.write_bytes(data)
        _readable(flipped)


def _readable(path: Path) -> list[bytes]:
    """What can be read of a damaged recording; whatever is wrong with it has a name of ours."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DamagedLogWarning)
        try:
            return [message.data for message in BagReader(path).messages()]
        except NotALogError:
            return []


def test_a_message_that_unpacks_to_a_gigabyte_takes_no_memory(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    packer = zstandard.ZstdCompressor().compressobj()
    bomb = b"".join(packer.compress(bytes(1024 * 1024)) for _ in range(1024)) + packer.flush()
    with BagWriter(tmp_path / "log") as writer:
        writer.add_topic("/pose", POSE)
        writer.write("/pose", bomb, log_time_ns=1, publish_time_ns=1)
        writer.write("/pose", pose_cdr(2, 2.0), log_time_ns=2)
    tracemalloc.start()
    try:
        reader = BagReader(tmp_path / "log")
        with pytest.warns(DamagedLogWarning, match="a packed message"):
            assert [message.log_time_ns for message in reader.messages()] == [2]
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 200 * 1024 * 1024  # three times the largest message that is unpacked


def test_an_index_that_lies_costs_no_more_than_its_lies(tmp_path: Path, pose_cdr: PoseCdr) -> None:
    """The index of the last chunk names a place where no chunk is; a reading by times says so."""
    with BagWriter(tmp_path / "log") as writer:
        writer.add_topic("/pose", POSE)
        for number in range(100):
            writer.write("/pose", pose_cdr(number, float(number)), log_time_ns=number * SECOND_NS)
            if number % 50 == 49:
                writer.flush()
    data = bytearray(writer.path.read_bytes())
    index = struct.pack("<QQ", 50 * SECOND_NS, 99 * SECOND_NS)
    at = data.rindex(index) + len(index)
    data[at : at + 8] = struct.pack("<Q", 2**63)
    footer = len(data) - 8 - 4
    data[footer : footer + 4] = bytes(4)  # zero: the summary has no checksum
    writer.path.write_bytes(data)
    reader = BagReader(tmp_path / "log")
    with pytest.warns(DamagedLogWarning, match="the file ends here"):
        found = list(reader.messages(start_ns=0))
    assert_poses(found, range(50))
