# SPDX-License-Identifier: Apache-2.0
"""Limits of a log that is written for weeks: how it is split and compressed, and which files are kept."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Final

from contact_dynamics.errors import InvalidFieldError

LEAST_FILE_BYTES: Final = 64 * 1024
"""The smallest limit of a file's size. With less, nearly every chunk would be a file of its own."""

LEAST_FILE_SECONDS: Final = 1.0  # s, the shortest limit of a file's time
FILES_KEPT: Final = 2  # the number of files for which a limit on all files must have room


class Compression(enum.Enum):
    """Compression of chunks, by MCAP's names."""

    NONE = "none"
    LZ4 = "lz4"
    ZSTD = "zstd"


@dataclass(frozen=True, slots=True, kw_only=True)
class LogLimits:
    """The limits of a log's files. By default there are none.

    Attributes:
        compression: Compression of chunks.
        file_bytes: Size at which a file is finished and another one begins. None means no limit.
        file_seconds: s, the same for the time span of a file. None means no limit.
        kept_bytes: Limit on the total size: the oldest files are deleted to stay below it. At least twice
            ``file_bytes``. None means that no file is deleted.

    Raises:
        InvalidFieldError: a limit is too small, or ``kept_bytes`` is given without ``file_bytes``.
    """

    compression: Compression = Compression.ZSTD
    file_bytes: int | None = None
    file_seconds: float | None = None
    kept_bytes: int | None = None

    def __post_init__(self) -> None:
        """Check the limits."""
        if self.file_bytes is not None and self.file_bytes < LEAST_FILE_BYTES:
            raise InvalidFieldError("file_bytes", self.file_bytes, f"at least {LEAST_FILE_BYTES}, or None")
        if self.file_seconds is not None and not self.file_seconds >= LEAST_FILE_SECONDS:
            raise InvalidFieldError(
                "file_seconds", self.file_seconds, f"at least {LEAST_FILE_SECONDS}, or None"
            )
        if self.kept_bytes is None:
            return
        if self.file_bytes is None:
            raise InvalidFieldError("kept_bytes", self.kept_bytes, "None, unless file_bytes is given too")
        if self.kept_bytes < FILES_KEPT * self.file_bytes:
            allowed = f"at least {FILES_KEPT} times file_bytes, which is {self.file_bytes}"
            raise InvalidFieldError("kept_bytes", self.kept_bytes, allowed)


UNLIMITED: Final = LogLimits()  # one file of unlimited size
