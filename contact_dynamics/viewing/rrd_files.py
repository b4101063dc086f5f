# SPDX-License-Identifier: Apache-2.0
"""Files that a picture is drawn into, one after the other. Each begins with the picture as it is then.

rerun writes no more into a file after one failure, such as a full disk, and says so only on the console. Then
the next file begins as soon as there is room for it.
"""

from __future__ import annotations

from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING, Final

import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Callable
    from io import FileIO

    from contact_dynamics.viewing.kept_recording import KeptRecording

_ROOM: Final = 10**6  # bytes that there must be room for where a file begins
_PATIENCE_S: Final = 1.0  # with a file that has not grown


class RrdFiles:
    """The files of one picture: picture.rrd, and once that is full picture_1.rrd, picture_2.rrd and so on.

    Attributes:
        hold_all: Whether all that was drawn was written.
    """

    def __init__(
        self,
        picture: KeptRecording,
        path: str,
        *,
        size: int,
        most: int,
        on_problem: Callable[[str], object],
    ) -> None:
        """Draw a picture into a file, which is replaced.

        Args:
            picture: The picture.
            path: The first file.
            size: Bytes. A file that is larger is followed by the next one. 0 means that there is one file.
            most: The newest files that stay. 0 means all.
            on_problem: A function that is told, in words, when a file cannot be written any more, and when
                the picture goes on.

        Raises:
            OSError: the file cannot be written.
        """
        self._picture = picture
        self._first = Path(path)
        self._size = size
        self._most = most
        self._on_problem = on_problem
        self.hold_all = True
        self._told = False
        self._bytes = -1  # the newest file had when it was last looked at
        self._count = 0
        self._written: deque[Path] = deque()
        self._place: rr.RecordingStream | None = picture.open(self._next())

    def roll(self) -> None:
        """Begin the next file if this one is full, or cannot be written any more."""
        self.check()
        if self._place is not None and not self._is_full():
            return
        try:
            sink = self._next()
        except OSError as error:
            if not self._told:
                self._on_problem(f"the picture has no next file: {error}; it is tried again")
            self._told = True
            return
        self._told = False
        if self._place is None:
            self._place = self._picture.open(sink)
            self._on_problem(f"the picture goes on in {self._written[-1]}")
        else:
            self._picture.reopen(self._place, sink)
        while self._most and len(self._written) > self._most:
            self._written.popleft().unlink(missing_ok=True)

    def check(self) -> None:
        """Find out whether the newest file is still written."""
        if self._place is None or self._is_written(self._place):
            return
        self._picture.leave(self._place)
        self._place, self.hold_all = None, False
        self._on_problem(f"{self._written[-1]} cannot be written any more")

    def _is_written(self, place: rr.RecordingStream) -> bool:
        before, self._bytes = self._bytes, self._length()
        if self._bytes != before:
            return True
        try:
            place.flush(timeout_sec=_PATIENCE_S)
        except RuntimeError:
            return False
        return True

    def _is_full(self) -> bool:
        return self._size > 0 and not 0 <= self._length() < self._size

    def _length(self) -> int:
        """Return the bytes of the newest file, or -1 if it is gone."""
        try:
            return self._written[-1].stat().st_size
        except OSError:
            return -1

    def _next(self) -> rr.FileSink:
        path = self._first
        if self._count:
            path = path.with_name(f"{path.stem}_{self._count}{path.suffix}")
        with path.open("wb", buffering=0) as file:  # rerun itself only logs that it cannot write
            if path.is_file():
                try:
                    _write_zeros(file)
                finally:
                    file.truncate(0)
        self._count += 1
        self._written.append(path)
        # The footer, an index of all that was drawn, stays in memory until the end: 50 KB an answer.
        return rr.FileSink(path, write_footer=False)


def _write_zeros(file: FileIO) -> None:
    """Write into a file as much as there must be room for, or raise an `OSError`."""
    left = _ROOM
    while left > 0:  # what is nearly full takes a part
        left -= file.write(bytes(left))
