"""Files that a picture is drawn into, one after the other. Each begins with the picture as it is then."""

from __future__ import annotations

from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING

import rerun as rr

if TYPE_CHECKING:
    from contact_dynamics.viewing.kept_recording import KeptRecording


class RrdFiles:
    """The files of one picture: picture.rrd, and once that is full picture_1.rrd, picture_2.rrd and so on."""

    def __init__(self, picture: KeptRecording, path: str, *, size: int, most: int) -> None:
        """Draw a picture into a file, which is replaced.

        Args:
            picture: The picture.
            path: The first file.
            size: Bytes. A file that is larger is followed by the next one. 0 means that there is one file.
            most: The newest files that stay. 0 means all.

        Raises:
            OSError: the file cannot be written.
        """
        self._picture = picture
        self._first = Path(path)
        self._size = size
        self._most = most
        self._count = 0
        self._written: deque[Path] = deque()
        self._place = picture.open(self._next())

    def roll(self) -> None:
        """Begin the next file if this one is full."""
        if self._size == 0 or self._written[-1].stat().st_size < self._size:
            return
        self._picture.reopen(self._place, self._next())
        while self._most and len(self._written) > self._most:
            self._written.popleft().unlink(missing_ok=True)

    def _next(self) -> rr.FileSink:
        path = self._first
        if self._count:
            path = path.with_name(f"{path.stem}_{self._count}{path.suffix}")
        with path.open("wb"):  # rerun itself only logs that it cannot write
            pass
        self._count += 1
        self._written.append(path)
        # The footer, an index of all that was drawn, stays in memory until the end: 50 KB an answer.
        return rr.FileSink(path, write_footer=False)
