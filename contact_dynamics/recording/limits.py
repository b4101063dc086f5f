# SPDX-License-Identifier: Apache-2.0
"""A log that is written for weeks has limits: how it is cut into files and packed, and which are kept."""

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
    """The ways in which chunks can be packed, by MCAP's names."""

    NONE = "none"
    LZ4 = "lz4"
    ZSTD = "zstd"


@dataclass(frozen=True, slots=True, kw_only=True)
class LogLimits:
    """The limits of a log's files. By default there are none.

    Attributes:
        compression: How chunks are packed.
        file_bytes: A file that has this size is finished, and another one begins. None means no limit.
        file_seconds: s. The same for the time that a file spans. None means no limit.
        kept_bytes: The oldest files are deleted, so that all files together stay below this size. It has room
            for two files of ``file_bytes`` at least. None means that no file is deleted.

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


UNLIMITED: Final = LogLimits()  # one file that grows as long as the log is written
