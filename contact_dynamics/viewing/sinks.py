# SPDX-License-Identifier: Apache-2.0
"""Opens the places where the picture goes: a file, a viewer that is started, served or connected to, or both.

All network addresses are of this machine (127.0.0.1) unless a URL names another. If a viewer dies or hangs
later, the picture still goes into the file, and closing waits for the viewer a few seconds at most. A viewer
that is opened again at the same place gets what stands in the picture. What is served stays in a memory of
limited size, for viewers that come later.

rerun's web viewer is served to browsers on this machine by rerun's executable, as a process of its own.
rerun's library would serve it to the whole network.

A viewer that is drawn to may die and come back, or hang and go on. rerun itself draws no more to a viewer
that has gone, also when one listens there again. And it keeps in memory, without bound, what a viewer that
hangs does not take.

Files follow one after the other, and each begins with the picture as it is then. rerun writes no more into a
file after one failure, such as a full disk, and says so only on the console. Then the next file begins as
soon as there is room for it.
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

_TEND_S: Final = 1.0  # between two looks at a file's size, and at whether a viewer is back


class ViewerMode(Enum):
    """The way in which a viewer gets the picture."""

    NONE = "none"
    SPAWN = "spawn"
    SERVE = "serve"
    CONNECT = "connect"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sinks:
    """The places to draw to.

    Raises:
        InvalidFieldError: the memory is not a size.
    """

    rrd_path: str = ""  # file to write, which is replaced. If it is empty, no file is written.
    # Bytes. When a file is larger, the next one begins, with _1, _2 and so on in its name. 0 means that there
    # is one file.
    rrd_size: int = 0
    rrd_files: int = 0  # the newest files that stay, where there are several. 0 means all.
    viewer: ViewerMode = ViewerMode.NONE
    port: int = DEFAULT_PORT  # port of the viewer that is started, or that is served
    url: str = ""  # URL of the viewer to connect to, such as rerun+http://127.0.0.1:9876/proxy
    # memory of the viewer that is started, or of what is served, as rerun takes it: `2GB`, `50%`.
    memory: str = "1GiB"
    # Port of the web viewer beside what is served. `NO_WEB_PORT` means that there is none.
    web_port: int = NO_WEB_PORT

    def __post_init__(self) -> None:
        """Check what rerun would refuse too late."""
        if not _MEMORY.fullmatch(self.memory):
            raise InvalidFieldError("viewer_memory", repr(self.memory), "a size such as 500MB, 2GiB or 25%")


class NowhereToDrawError(ContactDynamicsError):
    """A viewer was asked for without a file, and cannot be reached. The message says why."""


class OpenRecording:
    """A recording that is open to its sinks."""

    def __init__(self, sinks: Sinks, *, on_problem: Callable[[str], object]) -> None:
        """Open the sinks. If a viewer cannot be reached, a message says so, and the file is still written.

        Raises:
            OSError: the file cannot be written.
            NowhereToDrawError: a viewer was asked for without a file, and there is none.
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
            message = f"nowhere to draw to: {self._problem}"
            raise NowhereToDrawError(message)
        if self._problem:
            on_problem(self._problem)

    @property
    def viewer_failed(self) -> bool:
        """Whether the viewer that was asked for could not be reached, or has failed since."""
        return bool(self._problem) or (self._process is not None and self._process.failed)

    def tend(self) -> None:
        """Begin the next file if this one is full, and give the picture to a viewer that is back.

        It is to be called now and then, by who draws.
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
        """Write what is left and leave the viewer, which stays open. Return whether it took everything.

        If it did not within ``timeout``, s, or if a file could not be written, rerun would wait for ever when
        the process exits.
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
        """Serve the picture, and return where."""
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
        """Return the URL of a viewer that listens, or an empty string after noting why there is none."""
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
    """Make rerun raise an error for what it cannot draw, instead of a warning."""
    rr.set_strict_mode(True)


_END_S: Final = 2.0


class WebViewer:
    """A web viewer at a port of this machine, that looks at what is served at a URL."""

    def __init__(self, port: int, url: str, *, on_problem: Callable[[str], object]) -> None:
        """Serve it. If that is not possible, a message says so, and ``address`` is empty."""
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
            # Words are chosen for rerun's dark look, which the native viewer has.
            self.address = f"http://{LOCAL}:{port}/?url={quote(url, safe='')}&theme=dark"

    def close(self) -> None:
        """Serve it no longer."""
        if self._process is not None:
            self._process.terminate()
            try:
                self._process.wait(_END_S)
            except subprocess.TimeoutExpired:
                self._process.kill()


MAX_BEHIND: Final = 30
"""Looks at a viewer, of which each finds that it has not taken all that was drawn. Then it hangs."""

_VIEWER_PATIENCE_S: Final = 0.01  # a viewer that takes what is drawn has taken it within a millisecond


class LiveViewer:
    """A viewer at a URL.

    Attributes:
        hangs: Whether nothing is drawn to it, because it has not taken what was drawn before.
    """

    def __init__(self, picture: KeptRecording, url: str, *, on_problem: Callable[[str], object]) -> None:
        """Draw a picture to the viewer that listens at a URL."""
        self._picture = picture
        self._url = url
        self._on_problem = on_problem
        self._place = picture.open(rr.GrpcSink(url))
        self._is_gone = self.hangs = False
        self._behind = 0  # the looks since it has taken all

    def look(self) -> None:
        """Find out whether the viewer lives and keeps up, and give the picture to one that is back."""
        if self._is_gone or self.hangs:
            if speaks_http2(*host_and_port(self._url)):  # one that hangs does not greet
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
        # Other errors are that not all was taken in time.
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
        """Return rerun's reason why the viewer has not taken all, or an empty string if it has."""
        try:
            self._place.flush(timeout_sec=_VIEWER_PATIENCE_S)
        except RuntimeError as error:
            return str(error)
        return ""


_ROOM: Final = 10**6  # bytes that there must be room for where a file begins
_FILE_PATIENCE_S: Final = 1.0  # with a file that has not grown


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
        """Draw a picture into a file, which is replaced, or raise `OSError`.

        A file that is larger than ``size``, bytes, is followed by the next one, and the newest ``most`` files
        stay; 0 means that there is one file, and that all stay. ``on_problem`` is told, in words, when a file
        cannot be written any more, and when the picture continues.
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
            self._on_problem(f"the picture continues in {self._written[-1]}")
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
            place.flush(timeout_sec=_FILE_PATIENCE_S)
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
