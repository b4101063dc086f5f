# SPDX-License-Identifier: Apache-2.0
"""Types that the readers of all file formats share, and decompression of files and messages.

Chunks of MCAP, and files and messages of rosbag2's compression modes FILE and MESSAGE, are decompressed piece
by piece, so that damaged data that claim a huge size take no memory. A compressed file is unpacked into a
temporary one, because readers need random access. A serialised message begins with a zero byte and compressed
data do not, so the first byte distinguishes them.
"""

from __future__ import annotations

import tempfile
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from contact_dynamics.errors import InvalidFieldError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import BinaryIO


class Topic(NamedTuple):
    """A topic of a log."""

    name: str
    type_name: str  # "package/msg/Name" or "package/srv/Name_Event"
    definition: str  # the type definition, empty unless its encoding is MCAP's ros2msg
    # The YAML list of the QoS that its publishers offered, for `bag_metadata.offered_qos`, or an empty text
    qos: str = ""
    type_hash: str = ""  # the hash of its type, "RIHS01_...", or an empty text


class StoredMessage(NamedTuple):
    """A message as stored in a file. Times are in ns since the epoch."""

    topic: Topic
    data: bytes
    log_time_ns: int
    publish_time_ns: int


class Span(NamedTuple):
    """A range of log times, ns since the epoch, by default all of them."""

    start_ns: int = -(2**63)  # the first time in it
    end_ns: int = 2**63 - 1  # the first time after it


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """A stretch of a log that could not be read.

    Attributes:
        begin: Its first byte.
        end: The byte after its last one, or its first byte if only the end of the log is missing.
        messages: Number of lost messages, by the file's summary, or None if there is no summary.
    """

    path: Path
    begin: int
    end: int
    messages: int | None
    reason: str

    def __str__(self) -> str:
        """Describe what is lost and why."""
        count = "an unknown number of" if self.messages is None else self.messages
        return f"bytes {self.begin} to {self.end}, {count} messages ({self.reason})"


MAGICS: Final = {b"\x28\xb5\x2f\xfd": b"zstd", b"\x04\x22\x4d\x18": b"lz4"}
"""The first bytes of compressed data, and MCAP's name of the compression."""

SUFFIXES: Final = (".zstd", ".zst", ".lz4")  # suffixes of compressed files
MAX_BYTES: Final = 64 * 1024 * 1024  # the size of the largest message that is decompressed, bytes
_PIECE: Final = 1024 * 1024  # bytes


def uncompressed(compression: bytes, data: bytes, size: int) -> bytes:
    """Return the decompressed data. Decompression stops soon after ``size`` bytes.

    Raise `ValueError` if MCAP does not define this compression, or an error of the decompression library if
    the data are damaged.
    """
    if compression == b"":
        return data
    found: list[bytes] = []
    for piece in _pieces(compression, BytesIO(data)):
        found.append(piece)
        size -= len(piece)
        if size < 0:
            break
    return b"".join(found)


def unpacked_message(data: bytes) -> bytes:
    """Return a message as it was serialised, or raise `InvalidFieldError` if it is damaged or too large."""
    compression = MAGICS.get(data[:4])
    if compression is None:
        return data
    try:
        found = uncompressed(compression, data, MAX_BYTES)
    except Exception as error:  # noqa: BLE001  damaged bytes make the libraries raise nearly anything
        raise InvalidFieldError("data", f"a packed message ({error})", "data that can be unpacked") from None
    if len(found) > MAX_BYTES:
        raise InvalidFieldError("data", "a packed message", f"at most {MAX_BYTES} bytes when unpacked")
    return found


@contextmanager
def unpacked_file(path: Path) -> Iterator[tuple[Path, str | None]]:
    """Yield the path of a file's content, and the reason if it ends early, else None.

    A compressed file is unpacked into a temporary one, which is deleted afterwards.
    """
    if path.suffix not in SUFFIXES:
        yield path, None
        return
    with path.open("rb") as packed, tempfile.NamedTemporaryFile(suffix=Path(path.stem).suffix) as plain:
        reason = None
        compression = MAGICS.get(packed.read(4), b"zstd")
        packed.seek(0)
        try:
            for piece in _pieces(compression, packed):
                plain.write(piece)
        except Exception as error:  # noqa: BLE001  see above
            reason = f"the rest cannot be unpacked: {error}"
        plain.flush()
        yield Path(plain.name), reason


def _pieces(compression: bytes, packed: BinaryIO) -> Iterator[bytes]:
    stream: Any
    if compression == b"zstd":
        import zstandard  # a dependency of mcap, like lz4; a log needs at most one of them

        stream = zstandard.ZstdDecompressor().stream_reader(packed, read_across_frames=True)
    elif compression == b"lz4":
        import lz4.frame

        stream = lz4.frame.LZ4FrameFile(packed)
    else:
        raise ValueError(f"compression must be zstd, lz4 or none, got {compression!r}")
    while piece := stream.read(_PIECE):
        yield piece
