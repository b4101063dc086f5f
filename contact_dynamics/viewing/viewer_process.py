# SPDX-License-Identifier: Apache-2.0
"""Runs rerun's viewer in a separate process, reports its output when it fails, and probes ports of viewers.

The executable in rerun's wheel is started directly. `python -m rerun` would fail with an ImportError if
`RERUN_APP_ONLY` is set (rerun 0.39 to 0.41), and `rerun` need not be on the PATH.

The viewer listens before it has a window, so it counts as open once it draws. Its output goes to an unnamed
file, because the viewer outlives this process.
"""

from __future__ import annotations

import contextlib
import os
import re
import socket
import subprocess
import tempfile
import threading
import time
from importlib.util import find_spec
from pathlib import Path
from typing import IO, TYPE_CHECKING, Final
from urllib.parse import urlsplit

if TYPE_CHECKING:
    from collections.abc import Callable


LOCAL: Final = "127.0.0.1"
DEFAULT_PORT: Final = 9876

_CONNECT_S: Final = 1.0
_HTTP2_GREETING: Final = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + bytes([0, 0, 0, 4, 0, 0, 0, 0, 0])
_HEADER: Final = 9  # bytes of a frame's header: its length, type, flags and stream (RFC 9113, 4.1)
_SETTINGS: Final = 4  # type of the frame that an HTTP/2 server begins with (RFC 9113, 3.4 and 6.5)


def local_url(port: int) -> str:
    """Return the URL of a viewer at a port of this machine, as rerun writes it."""
    return f"rerun+http://{LOCAL}:{port}/proxy"


def host_and_port(url: str) -> tuple[str, int]:
    """Return host and port of a viewer's URL, or the defaults of rerun."""
    parts = urlsplit(url)
    return parts.hostname or LOCAL, parts.port or DEFAULT_PORT


def connection_problem(host: str, port: int) -> str:
    """Return the system's reason why a connection to a port fails, or an empty string if it succeeds."""
    try:
        with socket.create_connection((host, port), timeout=_CONNECT_S):
            return ""
    except OSError as error:
        return str(error)


def serving_problem(port: int) -> str:
    """Return the system's reason why a port cannot be bound, or an empty string if it can."""
    try:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as rerun does
            probe.bind((LOCAL, port))
            return ""
    except OSError as error:
        return str(error)


def speaks_http2(host: str, port: int) -> bool:
    """Return whether a gRPC server, such as rerun's viewer, listens there."""
    with (
        contextlib.suppress(OSError),
        socket.create_connection((host, port), timeout=_CONNECT_S) as connection,
    ):
        connection.sendall(_HTTP2_GREETING)
        header = connection.recv(_HEADER)
        return len(header) > 3 and header[3] == _SETTINGS
    return False


_START_S: Final = 15.0
_WINDOW_S: Final = 5.0  # s, after which a viewer that listens and still lives counts as open
_POLL_S: Final = 0.05
_DRAWS: Final = "wgpu adapter"  # the viewer logs this once it has a window and a graphics adapter
_MAX_WORDS: Final = 4  # number of the viewer's output lines that are reported
_COLORS: Final = re.compile(r"\x1b\[[0-9;]*m")
_NO_SCREEN: Final = re.compile(r"\bDISPLAY\b.* (?:is|are) (?:not )?set")
_ADVICE_WITHOUT_SCREEN: Final = (
    "rerun's viewer has no screen to open on, since neither DISPLAY nor WAYLAND_DISPLAY is set; "
    "draw into a file, or serve the picture to a viewer on another machine"
)
_LOGGED: Final = re.compile(r"^\S+ +(?:TRACE|DEBUG|INFO|WARN|ERROR) ")


class ViewerProcess:
    """A viewer that was started, or was already listening."""

    def __init__(self, port: int, *, memory: str, on_problem: Callable[[str], object]) -> None:
        """Start a viewer, unless one listens at the port, and wait until it is open.

        It drops the oldest data beyond the limit ``memory``, in rerun's format: `2GB`, `50%`. If it is not
        open, ``problem`` contains the reason; otherwise it is empty. ``on_problem`` is called with
        descriptions of later problems.
        """
        self._port = port
        self._memory = memory
        self._on_problem = on_problem
        self._failed = False
        self.problem = self._start()

    @property
    def failed(self) -> bool:
        """Whether it could not be started, or has failed since."""
        return bool(self.problem) or self._failed

    def _start(self) -> str:
        if not connection_problem(LOCAL, self._port):
            if speaks_http2(LOCAL, self._port):
                return ""
            return f"port {self._port} is taken by something that does not answer as rerun's viewer does"
        executable = viewer_executable()
        output = tempfile.TemporaryFile()  # noqa: SIM115  the viewer's, for as long as it lives
        try:
            process = subprocess.Popen(  # noqa: S603  rerun's own program
                [
                    *(executable, "--bind", LOCAL, "--port", str(self._port)),
                    *("--memory-limit", self._memory, "--expect-data-soon"),
                ],
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                # The awaited line has the level info.
                env={**os.environ, "RERUN_APP_ONLY": "true", "RUST_LOG": "info"},
            )
        except OSError as error:
            output.close()
            return f"rerun's viewer cannot be started: {error}"
        problem = self._wait(process, output)
        if problem:
            output.close()
        else:
            threading.Thread(target=self._watch, args=[process, output], daemon=True).start()
        return problem

    def _wait(self, process: subprocess.Popen[bytes], output: IO[bytes]) -> str:
        deadline = time.monotonic() + _START_S
        listens_since: float | None = None
        while time.monotonic() < deadline:
            if process.poll() is not None:
                return _how_it_ended(process, output)
            now = time.monotonic()
            if listens_since is None:
                listens_since = None if connection_problem(LOCAL, self._port) else now
            elif _DRAWS in _printed(output) or now - listens_since > _WINDOW_S:
                return ""
            time.sleep(_POLL_S)
        process.kill()
        process.wait()
        return f"rerun's viewer did not listen at port {self._port} within {_START_S:g} s: {_words(output)}"

    def _watch(self, process: subprocess.Popen[bytes], output: IO[bytes]) -> None:
        with output:
            if process.wait() != 0:  # 0 means closed by the user
                self._failed = True
                self._on_problem(_how_it_ended(process, output))


def _how_it_ended(process: subprocess.Popen[bytes], output: IO[bytes]) -> str:
    words = _words(output)
    if _NO_SCREEN.search(words):
        return _ADVICE_WITHOUT_SCREEN
    return f"rerun's viewer ended with exit code {process.returncode}: {words}"


def _printed(output: IO[bytes]) -> str:
    # The viewer writes where this file's offset is, so it must not be moved.
    size = os.fstat(output.fileno()).st_size
    return _COLORS.sub("", os.pread(output.fileno(), size, 0).decode(errors="replace"))


def _words(output: IO[bytes]) -> str:
    """Return the viewer's last output lines, which contain the reason of its end."""
    lines = [line.strip() for line in _printed(output).splitlines() if line.strip()]
    begins = [i for i, line in enumerate(lines) if line.startswith(("Error:", "thread '"))]
    if begins:
        lines = [line for line in lines[begins[-1] :] if not _LOGGED.match(line)]
        return " ".join(lines[:_MAX_WORDS])
    return " ".join(lines[-_MAX_WORDS:]) or "it printed nothing"


def viewer_executable() -> str:
    """Return the path of the viewer in rerun's wheel, or the path in `RERUN_CLI_PATH`, as rerun does."""
    named = os.environ.get("RERUN_CLI_PATH")
    if named:
        return named
    spec = find_spec("rerun_cli")
    folders = (spec.submodule_search_locations if spec else None) or ["rerun_cli"]
    return str(Path(folders[0]) / "rerun")
