# SPDX-License-Identifier: Apache-2.0
"""Logs are read as they were written; with flipped bits, wrong lengths and cut ends, all but the damage is.

The files are a real session's, and those of other writers: with attachments, without chunks or checksums.
"""

from __future__ import annotations

import random
import struct
import tracemalloc
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import pytest
from mcap.opcode import Opcode
from mcap.writer import CompressionType, Writer

from contact_dynamics.recording import (
    BagReader,
    BagWriter,
    DamagedLogWarning,
    NotALogError,
    UnfinishedLogWarning,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from contact_dynamics.recording import LoggedMessage, Loss

    PoseCdr = Callable[[int, float], bytes]

POSE = "geometry_msgs/msg/PoseStamped"
MAGIC = b"\x89MCAP0\r\n"
HEAD = 9  # bytes of a record before its content: kind and length
FLIPS = 2  # of each record's head, and as many of its content
CHUNKS, PER_CHUNK = 4, 12
HUGE = 1 << 60
MEMORY = 16 * 1024 * 1024  # bytes; the files have less than one


@dataclass(frozen=True, kw_only=True)
class Record:
    """Where a record stands in a file."""

    kind: int
    begin: int
    end: int


def records_in(data: bytes) -> list[Record]:
    """All records of a whole file, to its very end."""
    records, position = [], len(MAGIC)
    while position < len(data) - len(MAGIC):
        kind, length = struct.unpack_from("<BQ", data, position)
        records.append(Record(kind=kind, begin=position, end=position + HEAD + length))
        position = records[-1].end
    return records


def read(path: Path, data: bytes) -> tuple[list[LoggedMessage], list[Loss]]:
    """The messages of damaged data, and the warnings about the log; any other warning raises."""
    path.write_bytes(data)
    reader = BagReader(path)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        messages = list(reader.messages())
    assert len(caught) == (reader.damage is not None)
    is_cut = all(loss.begin == loss.end for loss in reader.losses)
    expected = UnfinishedLogWarning if is_cut else DamagedLogWarning
    assert all(warning.category is expected for warning in caught)
    assert (reader.damage is not None) == bool(reader.losses)
    return messages, reader.losses


def by_chunk(data: bytes, path: Path) -> list[list[LoggedMessage]]:
    """The messages of each chunk of a whole file."""
    messages, losses = read(path, data)
    assert losses == []
    counts: list[int] = []
    for record in records_in(data):
        if record.kind == Opcode.CHUNK:
            counts.append(0)
        elif record.kind == Opcode.MESSAGE_INDEX:
            counts[-1] += (record.end - record.begin - HEAD - 6) // 16
    assert sum(counts) == len(messages)
    ends = [sum(counts[: number + 1]) for number in range(len(counts))]
    return [messages[end - count : end] for end, count in zip(ends, counts, strict=True)]


def flips(data: bytes) -> Iterator[tuple[Record, int, int]]:
    """Bits of every record, of its head and of its content."""
    draw = random.Random(7)
    for record in records_in(data):
        places = [draw.randrange(record.begin, record.begin + HEAD) for _ in range(FLIPS)]
        places += [draw.randrange(record.begin + HEAD, record.end) for _ in range(FLIPS)]
        for place in [record.begin, *places]:
            yield record, place, 1 << draw.randrange(8)


@pytest.fixture
def log(tmp_path: Path, pose_cdr: PoseCdr) -> Path:
    with BagWriter(tmp_path / "log", run={"mass": "0.37"}) as writer:
        writer.add_topic("/pose", POSE)
        writer.add_topic("/other", POSE)
        for index in range(CHUNKS * PER_CHUNK):
            topic = "/pose" if index % 2 == 0 else "/other"
            writer.write(topic, pose_cdr(index, float(index)), log_time_ns=2000 - index)
            if index % PER_CHUNK == PER_CHUNK - 1:
                writer.flush()
    return writer.path


def write_otherwise(path: Path, pose_cdr: PoseCdr, **options: Any) -> bytes:
    """A file of the library's writer, with attachments and metadata between the chunks."""
    writer = Writer(str(path), **options)
    writer.start(profile="ros2", library="another")
    schema = writer.register_schema(POSE, "ros2msg", b"std_msgs/Header header\n")
    channel = writer.register_channel("/pose", "cdr", schema)
    for index in range(3 * PER_CHUNK):
        writer.add_message(channel, log_time=index, data=pose_cdr(index, 1.0), publish_time=index)
        if index % PER_CHUNK == PER_CHUNK - 1:
            writer.add_attachment(index, index, f"picture{index}", "image/png", bytes(range(200)))
            writer.add_metadata(f"note{index}", {"of": "somebody"})
    writer.finish()
    return path.read_bytes()


def check_flips(data: bytes, path: Path) -> None:
    """A flipped bit costs at most the chunk that contains it, and causes a warning."""
    chunks = by_chunk(data, path)
    begins = [record.begin for record in records_in(data) if record.kind == Opcode.CHUNK]
    kinds = set()
    for record, place, bit in flips(data):
        damaged = bytearray(data)
        damaged[place] ^= bit
        messages, losses = read(path, damaged)
        kinds.add(record.kind)
        where = f"bit {bit:#04x} of byte {place}, in {record}"
        assert losses, where
        lost = sum(loss.messages or 0 for loss in losses)
        if record.kind == Opcode.CHUNK and lost:
            number = begins.index(record.begin)
            assert lost == len(chunks[number]), where
            assert any(loss.begin <= place < loss.end for loss in losses), where
            expected = [message for chunk in chunks[:number] + chunks[number + 1 :] for message in chunk]
        else:  # also the times in a chunk's head, which only repeat those of its messages
            expected = [message for chunk in chunks for message in chunk]
            assert lost == 0, where
        assert messages == expected, where
    assert {record.kind for record in records_in(data)} == kinds


def test_gives_back_what_was_written_in_that_order(log: Path, pose_cdr: PoseCdr) -> None:
    reader = BagReader(log.parent)
    messages = list(reader.messages())
    assert [message.data for message in messages] == [
        pose_cdr(i, float(i)) for i in range(CHUNKS * PER_CHUNK)
    ]
    assert [message.publish_time_ns for message in messages] == list(range(CHUNKS * PER_CHUNK))
    assert messages[0].log_time_ns == 2000
    assert {message.type_name for message in messages} == {POSE}
    assert reader.damage is None
    assert reader.run()["mass"] == "0.37"


def test_bare_file_and_choice_of_topics(log: Path) -> None:
    messages = list(BagReader(log).messages({"/other"}))
    assert len(messages) == CHUNKS * PER_CHUNK // 2
    assert {message.topic for message in messages} == {"/other"}


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


def test_a_flipped_bit_of_a_real_log_costs_its_chunk_at_most(real_log: Any, tmp_path: Path) -> None:
    data = real_log.path.read_bytes()
    assert len(by_chunk(data, tmp_path / "flipped.mcap")) > 1
    check_flips(data, tmp_path / "flipped.mcap")


@pytest.mark.parametrize("compression", list(CompressionType))
def test_a_flipped_bit_of_another_writers_log_costs_its_chunk_at_most(
    tmp_path: Path, pose_cdr: PoseCdr, compression: CompressionType
) -> None:
    path = tmp_path / "other.mcap"
    options = {"chunk_size": 1500, "compression": compression, "enable_data_crcs": True}
    check_flips(write_otherwise(path, pose_cdr, **options), path)


def test_the_first_bytes_may_be_damaged_too(log: Path, tmp_path: Path) -> None:
    data = log.read_bytes()
    for place in range(len(MAGIC)):
        messages, losses = read(tmp_path / "flipped.mcap", data[:place] + b"?" + data[place + 1 :])
        assert len(messages) == CHUNKS * PER_CHUNK
        assert [loss.messages for loss in losses] == [0]
    with pytest.raises(NotALogError):
        read(tmp_path / "flipped.mcap", b"??" + data[2:])


@pytest.mark.parametrize(
    "options",
    [{"use_chunking": False, "enable_data_crcs": True}, {"use_chunking": False}, {"enable_crcs": False}],
    ids=["no chunks", "neither chunks nor checksums", "no checksums"],
)
def test_files_without_chunks_or_checksums_are_read_and_never_raise(
    tmp_path: Path, pose_cdr: PoseCdr, options: dict[str, bool]
) -> None:
    path = tmp_path / "other.mcap"
    data = write_otherwise(path, pose_cdr, **options)
    messages, losses = read(path, data)
    assert (len(messages), losses) == (3 * PER_CHUNK, [])
    for record, place, bit in flips(data):
        damaged = bytearray(data)
        damaged[place] ^= bit
        messages, losses = read(path, damaged)
        assert losses or "enable_data_crcs" not in options, record


def test_every_cut_gives_the_whole_chunks_before_it(log: Path, tmp_path: Path) -> None:
    """Every byte at the end, and many before, but for the texts in the summary."""
    data, cut = log.read_bytes(), tmp_path / "cut.mcap"
    chunks, records = by_chunk(data, cut), records_in(data)
    ends = [record.end for record in records if record.kind == Opcode.CHUNK]
    closing = next(record.begin for record in records if record.kind == Opcode.DATA_END)
    sizes = [*range(100, ends[-1], 23), *range(ends[-1], closing + 60, 3)]
    sizes += [*range(closing + 60, len(data) - 120, 61), *range(len(data) - 120, len(data))]
    for size in sizes:
        messages, losses = read(cut, data[:size])
        before = sum(end <= size for end in ends)
        assert messages == [message for chunk in chunks[:before] for message in chunk], size
        (loss,) = losses
        assert loss.end == size
        assert loss.messages in (None, 0)


def test_channels_that_a_lost_chunk_defined_are_found_in_the_summary(log: Path, tmp_path: Path) -> None:
    """The first chunk defines all channels. Nothing else does in a log that was also cut: a warning."""
    data = bytearray(log.read_bytes())
    (first, *_) = [record for record in records_in(data) if record.kind == Opcode.CHUNK]
    data[first.end - 1] ^= 1
    messages, losses = read(tmp_path / "damaged.mcap", data)
    assert [message.log_time_ns for message in messages] == [
        2000 - index for index in range(PER_CHUNK, CHUNKS * PER_CHUNK)
    ]
    assert {(message.topic, message.type_name) for message in messages} == {("/pose", POSE), ("/other", POSE)}
    assert [(loss.begin, loss.messages) for loss in losses] == [(first.begin, PER_CHUNK)]
    messages, losses = read(tmp_path / "damaged.mcap", data[:-1])
    assert messages == []
    assert losses[-1].messages == (CHUNKS - 1) * PER_CHUNK
    assert "channels" in losses[-1].reason


def test_lengths_beyond_all_measure_take_no_memory(log: Path, tmp_path: Path) -> None:
    """The length of each record, and those of the chunks' contents: once huge, once just within the file."""
    data = log.read_bytes()
    places = [record.begin + 1 for record in records_in(data)]
    for record in records_in(data):
        if record.kind == Opcode.CHUNK:
            places += [
                record.begin + HEAD + 16,
                record.begin + HEAD + 36,
            ]  # of the data, with and without zstd
    whole, _ = read(tmp_path / "wrong.mcap", data)
    tracemalloc.start()
    try:
        for place in places:
            for length in (HUGE, 2**64 - 1, 2**63, len(data) - place - 8, 0):
                wrong = data[:place] + struct.pack("<Q", length) + data[place + 8 :]
                if wrong != data:
                    messages, losses = read(tmp_path / "wrong.mcap", wrong)
                    assert losses
                    assert len(messages) >= len(whole) - PER_CHUNK
                    assert set(messages) <= set(whole)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < MEMORY


def test_how_the_run_was_made_is_told_right_or_not_at_all(log: Path, tmp_path: Path) -> None:
    data, path = log.read_bytes(), tmp_path / "damaged.mcap"
    good = BagReader(log).run()
    assert good["mass"] == "0.37"
    (record, *_) = [record for record in records_in(data) if record.kind == Opcode.METADATA]
    for place in range(record.begin, record.end):
        damaged = bytearray(data)
        damaged[place] ^= 1 << place % 8
        path.write_bytes(damaged)
        reader = BagReader(path)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run = reader.run()
        # the length of the last text says nothing that the length of the record does not
        assert (run, len(caught)) in [({}, 1), (good, 0)]
        assert (reader.damage is None) == bool(run)


def test_damage_is_told_also_to_those_who_stop_before_the_end(log: Path, tmp_path: Path) -> None:
    data = bytearray(log.read_bytes())
    chunks = [record for record in records_in(data) if record.kind == Opcode.CHUNK]
    data[chunks[1].end - 1] ^= 1
    (tmp_path / "damaged.mcap").write_bytes(data)
    reader = BagReader(tmp_path / "damaged.mcap")
    messages = reader.messages()
    for _ in range(2 * PER_CHUNK):
        next(messages)
    with pytest.warns(
        DamagedLogWarning, match=f"bytes {chunks[1].begin} to {chunks[2].begin}, {PER_CHUNK} messages"
    ):
        messages.close()
    assert [loss.messages for loss in reader.losses] == [PER_CHUNK]
