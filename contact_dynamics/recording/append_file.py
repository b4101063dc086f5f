"""An append file only grows. The process holds nothing back, so a kill loses nothing that was written.

Python's own buffered file keeps data that a full disk refused, and then cannot be closed. This file does not
do that, and it can be cut back to where it was last whole.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


class AppendFile:
    """A stream with the methods that ``mcap.writer.Writer`` needs: ``write``, ``tell``, ``flush``."""

    def __init__(self, path: Path) -> None:
        """Create the file. If it exists, raise `FileExistsError`."""
        self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
        self._size = 0

    def write(self, data: bytes | bytearray | memoryview) -> int:
        """Hand all of ``data`` to the operating system. If the disk refuses, raise `OSError`."""
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
        """Do nothing, since nothing is held back."""

    def sync(self) -> None:
        """Wait until the disk itself has all that was written. If it refuses, raise `OSError`."""
        os.fdatasync(self._descriptor)

    def cut_back(self, size: int) -> None:
        """Drop everything behind the first ``size`` bytes."""
        os.ftruncate(self._descriptor, size)
        os.lseek(self._descriptor, size, os.SEEK_SET)
        self._size = size

    def close(self) -> None:
        """Close the file."""
        os.close(self._descriptor)
