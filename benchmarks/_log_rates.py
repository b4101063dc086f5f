# SPDX-License-Identifier: Apache-2.0
"""Rates of the log: writing beside the bare writer of mcap, reading, and decoding without ROS.

All times are processor time of the process. The least of several rounds counts, and ours and the bare writer
take turns, so that other work on the machine plays little part.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mcap.writer import CompressionType, Writer

from benchmarks._quotes import quote
from contact_dynamics.recording import BagReader, BagWriter, decode_without_ros
from contact_dynamics.recording.definitions import find_definition

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

ROUNDS: Final = 5
TOPIC: Final = "/brick/odometry"
TYPE: Final = "nav_msgs/msg/Odometry"
_CHUNK_BYTES: Final = 256 * 1024  # as ours


def rates(messages: Sequence[bytes]) -> None:
    """Print and offer the rates for some serialised Odometry."""
    size = len(messages[0])
    with tempfile.TemporaryDirectory() as folder:
        ours, bare = _alternating(
            lambda number: _write_ours(Path(folder) / f"ours{number}", messages),
            lambda number: _write_bare(Path(folder) / f"bare{number}.mcap", messages),
        )
        log = BagReader(Path(folder) / "ours0")
        found = list(log.messages())
        reading, decoding = _alternating(
            lambda _: sum(1 for _ in log.messages()),
            lambda _: sum(decode_without_ros(message) is not None for message in found),
        )
    count = len(messages)
    for name, seconds in (
        ("writer", ours),
        ("bare_writer", bare),
        ("reader", reading),
        ("decoder", decoding),
    ):
        print(f"{name}: {count / seconds:.0f} messages/s, {1e-6 * size * count / seconds:.0f} MB/s")
        quote(f"recording.{name}", 1e-3 * count / seconds, "thousand messages/s")
        quote(f"recording.{name}.bytes", 1e-6 * size * count / seconds, "MB/s")


def _write_ours(folder: Path, messages: Sequence[bytes]) -> None:
    with BagWriter(folder) as writer:
        writer.add_topic(TOPIC, TYPE)
        for number, data in enumerate(messages):
            writer.write(TOPIC, data, log_time_ns=number)


def _write_bare(path: Path, messages: Sequence[bytes]) -> None:
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=_CHUNK_BYTES, compression=CompressionType.ZSTD)
        writer.start(profile="ros2")
        schema = writer.register_schema(TYPE, "ros2msg", find_definition(TYPE).text.encode())
        channel = writer.register_channel(TOPIC, "cdr", schema)
        for number, data in enumerate(messages):
            writer.add_message(channel, log_time=number, data=data, publish_time=number)
        writer.finish()


def _alternating(*works: Callable[[int], object]) -> list[float]:
    """Return the least time of each work, s."""
    least = [float("inf")] * len(works)
    for number in range(ROUNDS):
        for index, work in enumerate(works):
            begin = time.process_time()
            work(number)
            least[index] = min(least[index], time.process_time() - begin)
    return least
