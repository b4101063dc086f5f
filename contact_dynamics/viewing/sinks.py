# SPDX-License-Identifier: Apache-2.0
"""Opens the sinks of the picture: a file, a viewer (started, served or connected to), or both.

All network addresses are on this machine (127.0.0.1) unless a URL names another. If a viewer dies or hangs
later, the file is still written, and closing waits for the viewer a few seconds at most. A viewer that is
restarted at the same address receives the current picture. Served data are kept in a buffer of limited size,
for viewers that connect later.

rerun's web viewer is served to browsers on this machine by rerun's executable, in a separate process, because
rerun's library would serve it to the whole network.

A connected viewer may die and return, or hang and recover. rerun itself does not reconnect to a viewer that
died, and buffers without bound the data that a hanging viewer does not accept.

A full file is followed by the next one, which begins with the current picture. After one failure, such as a
full disk, rerun stops writing a file and reports it only on the console. The next file then begins as soon as
there is room for it.
"""

from __future__ import annotations

import os
import re
import subprocess
import threading
import time
from collections import deque
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Final
from urllib.parse import quote

import rerun as rr

from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError
from contact_dynamics.viewing.kept_recording import KeptRecording
from contact_dynamics.viewing.viewer_process import (
    DEFAULT_PORT,
    LOCAL,
    ViewerProcess,
    connection_problem,
    host_and_port,
    local_url,
    serving_problem,
    speaks_http2,
    viewer_executable,
)

if TYPE_CHECKING:
    from collections.abc import Callable
    from io import FileIO


NO_WEB_PORT: Final = 0

_MEMORY: Final = re.compile(r"(\d+(\.\d+)?)(%|B|[kKMGT]B|[KMGT]iB)")

_TEND_S: Final = 1.0  # between two checks of a file's size, or for a viewer's return


class ViewerMode(Enum):
    """How a viewer receives the picture."""

    NONE = "none"
    SPAWN = "spawn"
    SERVE = "serve"
    CONNECT = "connect"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sinks:
    """The sinks to draw to.

    Raises:
        InvalidFieldError: the memory is not a size.
    """

    rrd_path: str = ""  # file to write, which is replaced. If it is empty, no file is written.
    # Bytes. Above this size the next file begins, with _1, _2 and so on in its name. 0 means a single file.
    rrd_size: int = 0
    rrd_files: int = 0  # number of newest files to keep. 0 means all.
    # Whether files end with rerun's footer, an index that is kept in memory: 50 to 100 KB for each answer.
    rrd_footer: bool = True
    viewer: ViewerMode = ViewerMode.NONE
    port: int = DEFAULT_PORT  # port of the viewer that is started, or that is served
    url: str = ""  # URL of the viewer to connect to, such as rerun+http://127.0.0.1:9876/proxy
    memory: str = "1GiB"  # of the started viewer or of the server, in rerun's format: `2GB`, `50%`
    web_port: int = NO_WEB_PORT  # port of the web viewer beside the server, if any

    def __post_init__(self) -> None:
        """Check values that rerun would reject too late."""
        if not _MEMORY.fullmatch(self.memory):
            raise InvalidFieldError("viewer_memory", repr(self.memory), "a size such as 500MB, 2GiB or 25%")


class NowhereToDrawError(ContactDynamicsError):
    """A viewer was requested without a file, and cannot be reached. The message contains the reason."""


class OpenRecording:
    """A recording with its open sinks."""

    def __init__(self, sinks: Sinks, *, on_problem: Callable[[str], object]) -> None:
        """Open the sinks. If a viewer cannot be reached, report it, and still write the file.

        Raise `OSError` if the file cannot be written, and `NowhereToDrawError` if a viewer was requested
        without a file, and there is none.
        """
        self.stream = KeptRecording()
        self._sinks = sinks
        self._on_problem = on_problem
        self._process: ViewerProcess | None = None
        self._viewer: LiveViewer | None = None
        self._files: RrdFiles | None = None
        self._web: WebViewer | None = None
        self._problem = ""
        self._tended = time.monotonic()
        self.description = ", ".join(self._open()) or "nowhere"
        if self._problem and not sinks.rrd_path:
            raise NowhereToDrawError(f"nowhere to draw to: {self._problem}")
        if self._problem:
            on_problem(self._problem)

    @property
    def viewer_failed(self) -> bool:
        """Whether the requested viewer could not be reached, or has failed since."""
        return bool(self._problem) or (self._process is not None and self._process.failed)

    def tend(self) -> None:
        """Begin the next file if this one is full, and send the picture to a viewer that has returned.

        The drawing code calls it regularly.
        """
        now = time.monotonic()
        if now < self._tended + _TEND_S:
            return
        self._tended = now
        if self._files is not None:
            self._files.roll()
        if self._viewer is not None:
            self._viewer.look()

    def close(self, *, timeout: float = 5.0) -> bool:
        """Write pending data and leave the viewer, which stays open; return whether all were accepted.

        If they were not within ``timeout``, s, or if a file could not be written, rerun would block for ever
        when the process exits.
        """
        if self._web is not None:
            self._web.close()
        if self._files is not None:
            self._files.check()
        thread = threading.Thread(target=self.stream.disconnect, daemon=True)
        thread.start()
        thread.join(timeout)
        if thread.is_alive():
            self._on_problem(f"the viewer did not take all that was drawn within {timeout:g} s")
        if self._viewer is not None and self._viewer.hangs:
            self._on_problem("the viewer hangs, and did not take all that was drawn")
            return False
        return not thread.is_alive() and (self._files is None or self._files.hold_all)

    def _open(self) -> list[str]:
        sinks, names = self._sinks, []
        if sinks.rrd_path:
            self._files = RrdFiles(
                self.stream,
                sinks.rrd_path,
                size=sinks.rrd_size,
                most=sinks.rrd_files,
                footer=sinks.rrd_footer,
                on_problem=self._on_problem,
            )
            names.append(sinks.rrd_path)
        url = self._viewer_url()
        if sinks.viewer is ViewerMode.SERVE:
            names += self._serve()
        elif url:
            self._viewer = LiveViewer(self.stream, url, on_problem=self._on_problem)
            names.append(f"viewer at {url}")
        return names

    def _serve(self) -> list[str]:
        """Serve the picture, and return its address."""
        sinks, url = self._sinks, local_url(self._sinks.port)
        problem = serving_problem(sinks.port)
        if problem:
            self._problem = f"the picture is not served at port {sinks.port}: {problem}"
            return []
        self.stream.open(rr.GrpcServerSink(bind_ip=LOCAL, port=sinks.port, server_memory_limit=sinks.memory))
        names = [f"served at {url}"]
        if sinks.web_port != NO_WEB_PORT:
            self._web = WebViewer(sinks.web_port, url, on_problem=self._on_problem)
            names += [f"in a browser at {self._web.address}"] if self._web.address else []
        return names

    def _viewer_url(self) -> str:
        """Return the URL of a listening viewer, or an empty string after reporting why there is none."""
        sinks = self._sinks
        if sinks.viewer is ViewerMode.CONNECT:
            problem = connection_problem(*host_and_port(sinks.url))
            if not problem:
                return sinks.url
            self._problem = f"no viewer listens at {sinks.url}: {problem}"
        elif sinks.viewer is ViewerMode.SPAWN:
            self._process = ViewerProcess(sinks.port, memory=sinks.memory, on_problem=self._on_problem)
            if not self._process.problem:
                return local_url(sinks.port)
            self._problem = self._process.problem
        return ""


def raise_errors() -> None:
    """Make rerun raise errors instead of warnings."""
    rr.set_strict_mode(True)


_END_S: Final = 2.0


class WebViewer:
    """A web viewer at a port of this machine, which shows the data served at a URL."""

    def __init__(self, port: int, url: str, *, on_problem: Callable[[str], object]) -> None:
        """Serve it. If that fails, report it and leave ``address`` empty."""
        self.address = ""
        self._process: subprocess.Popen[bytes] | None = None
        problem = serving_problem(port)
        try:
            if not problem:
                self._process = subprocess.Popen(  # noqa: S603  rerun's own program
                    [
                        viewer_executable(),
                        "--serve-web",
                        "--bind",
                        LOCAL,
                        "--web-viewer-port",
                        str(port),
                        url,
                    ],
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                    env={**os.environ, "RERUN_APP_ONLY": "true"},
                )
        except OSError as error:
            problem = str(error)
        if problem:
            on_problem(f"the web viewer is not served at port {port}: {problem}")
        else:
            # The colours suit rerun's dark theme, which the native viewer has.
            self.address = f"http://{LOCAL}:{port}/?url={quote(url, safe='')}&theme=dark"

    def close(self) -> None:
        """Stop serving it."""
        if self._process is not None:
            self._process.terminate()
            try:
                self._process.wait(_END_S)
            except subprocess.TimeoutExpired:
                self._process.kill()


MAX_BEHIND: Final = 30
"""Number of successive checks without all drawings accepted, after which a viewer counts as hanging."""

_VIEWER_PATIENCE_S: Final = 0.01  # a live viewer accepts data within a millisecond


class LiveViewer:
    """A viewer at a URL.

    Attributes:
        hangs: Whether drawing to it is suspended, because it has not accepted earlier data.
    """

    def __init__(self, picture: KeptRecording, url: str, *, on_problem: Callable[[str], object]) -> None:
        """Draw a picture to the viewer listening at a URL."""
        self._picture = picture
        self._url = url
        self._on_problem = on_problem
        self._place = picture.open(rr.GrpcSink(url))
        self._is_gone = self.hangs = False
        self._behind = 0  # number of checks since it has accepted all data

    def look(self) -> None:
        """Check whether the viewer is alive and keeps up, and send the picture to one that has returned."""
        if self._is_gone or self.hangs:
            if speaks_http2(*host_and_port(self._url)):  # a hanging viewer does not respond
                self._picture.reopen(self._place, rr.GrpcSink(self._url))
                back = (
                    "a viewer listens at {} again, and"
                    if self._is_gone
                    else "the viewer at {} responds again and"
                )
                self._is_gone = self.hangs = False
                self._on_problem(f"{back.format(self._url)} has the picture")
            return
        problem = self._problem()
        self._behind = self._behind + 1 if problem else 0
        # Other errors mean that not all data were accepted in time.
        self._is_gone = "severed" in problem or bool(
            problem and connection_problem(*host_and_port(self._url))
        )
        self.hangs = not self._is_gone and self._behind >= MAX_BEHIND
        if self._is_gone or self.hangs:
            self._behind = 0
            self._picture.leave(self._place)
        if self._is_gone:
            self._on_problem(f"no viewer listens at {self._url} any more: one that does gets the picture")
        elif self.hangs:
            self._on_problem(
                f"the viewer at {self._url} does not respond; it receives the picture once it does"
            )

    def _problem(self) -> str:
        """Return rerun's reason why the viewer has not accepted all data, or an empty string if it has."""
        try:
            self._place.flush(timeout_sec=_VIEWER_PATIENCE_S)
        except RuntimeError as error:
            return str(error)
        return ""


_ROOM: Final = 10**6  # bytes of free space required to begin a file
_FILE_PATIENCE_S: Final = 1.0  # with a file that has not grown


class RrdFiles:
    """The files of one picture: picture.rrd and, once it is full, picture_1.rrd, picture_2.rrd and so on.

    Attributes:
        hold_all: Whether all drawings were written.
    """

    def __init__(
        self,
        picture: KeptRecording,
        path: str,
        *,
        size: int,
        most: int,
        footer: bool = True,
        on_problem: Callable[[str], object],
    ) -> None:
        """Draw a picture into a file, which is replaced, or raise `OSError`.

        A file larger than ``size``, bytes, is followed by the next one, and the newest ``most`` files are
        kept; 0 means a single file, and all files. ``on_problem`` is called with a description when writing a
        file fails, and when the picture continues.
        """
        self._picture = picture
        self._first = Path(path)
        self._size = size
        self._most = most
        self._footer = footer
        self._on_problem = on_problem
        self.hold_all = True
        self._told = False
        self._bytes = -1  # size of the newest file at the last check
        self._count = 0
        self._written: deque[Path] = deque()
        self._place: rr.RecordingStream | None = picture.open(self._next())

    def roll(self) -> None:
        """Begin the next file if this one is full, or if writing to it failed."""
        self.check()
        if self._place is not None and (self._size <= 0 or 0 <= self._length() < self._size):
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
            self._on_problem(f"the picture continues in {self._written[-1]}")
        else:
            self._picture.reopen(self._place, sink)
        while self._most and len(self._written) > self._most:
            self._written.popleft().unlink(missing_ok=True)

    def check(self) -> None:
        """Check whether the newest file is still written."""
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
            place.flush(timeout_sec=_FILE_PATIENCE_S)
        except RuntimeError:
            return False
        return True

    def _length(self) -> int:
        """Return the size of the newest file, bytes, or -1 if it was removed."""
        try:
            return self._written[-1].stat().st_size
        except OSError:
            return -1

    def _next(self) -> rr.FileSink:
        path = self._first
        if self._count:
            path = path.with_name(f"{path.stem}_{self._count}{path.suffix}")
        with path.open("wb", buffering=0) as file:  # rerun itself only logs a failed write
            if path.is_file():
                try:
                    _write_zeros(file)
                finally:
                    file.truncate(0)
        self._count += 1
        self._written.append(path)
        return rr.FileSink(path, write_footer=self._footer)


def _write_zeros(file: FileIO) -> None:
    """Write zeros to check for free space, or raise `OSError`."""
    left = _ROOM
    while left > 0:  # a nearly full disk accepts only a part
        left -= file.write(bytes(left))
