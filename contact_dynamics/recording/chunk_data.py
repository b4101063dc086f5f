# SPDX-License-Identifier: Apache-2.0
"""Unpacks the data of a chunk piece by piece, so that a damaged chunk with a huge size takes no memory."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

_PIECE: Final = 1024 * 1024  # bytes


def uncompressed(compression: bytes, data: bytes, size: int) -> bytes:
    """Return the unpacked data. Unpacking stops soon after ``size`` bytes.

    Raises:
        ValueError: MCAP has no such compression.
        Exception: the data are damaged. The class is that of the unpacking library.
    """
    if compression == b"":
        return data
    if compression == b"zstd":
        pieces = _zstd_pieces(data)
    elif compression == b"lz4":
        pieces = _lz4_pieces(data)
    else:
        message = f"compression must be zstd, lz4 or none, got {compression!r}"
        raise ValueError(message)
    found: list[bytes] = []
    for piece in pieces:
        found.append(piece)
        size -= len(piece)
        if size < 0:
            break
    return b"".join(found)


def _zstd_pieces(data: bytes) -> Iterator[bytes]:
    import zstandard  # it comes with the mcap library, as lz4 does, and a log needs one of them at most

    reader = zstandard.ZstdDecompressor().stream_reader(data)
    while piece := reader.read(_PIECE):
        yield piece


def _lz4_pieces(data: bytes) -> Iterator[bytes]:
    import lz4.frame

    decompressor: Any = lz4.frame.LZ4FrameDecompressor()
    piece = decompressor.decompress(data, max_length=_PIECE)
    while piece:
        yield piece
        piece = b"" if decompressor.eof else decompressor.decompress(b"", max_length=_PIECE)
