"""A file that only grows, nothing of it held back in the process, so that a kill loses nothing written.

Python's own buffered file keeps what a full disk refused and refuses to be closed then; this one does
neither, and can be cut back to where it was last whole.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


class AppendFile:
    """What ``mcap.writer.Writer`` asks of a stream: ``write``, ``tell``, ``flush``."""

    def __init__(self, path: Path) -> None:
        """Create the file; `FileExistsError` where one stands."""
        self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
        self._size = 0

    def write(self, data: bytes | bytearray | memoryview) -> int:
        """Hand all of ``data`` to the operating system; `OSError` where the disk refuses."""
        rest = memoryview(data)
        while rest:
            count = os.write(self._descriptor, rest)
            self._size += count
            rest = rest[count:]
        return len(data)

    def tell(self) -> int:
        """Return the number of bytes written."""
        return self._size

    def flush(self) -> None:
        """Do nothing: nothing is held back."""

    def cut_back(self, size: int) -> None:
        """Drop everything behind the first ``size`` bytes."""
        os.ftruncate(self._descriptor, size)
        os.lseek(self._descriptor, size, os.SEEK_SET)
        self._size = size

    def close(self) -> None:
        """Close the file."""
        os.close(self._descriptor)
