"""Where the picture goes: a file, and a viewer that is started, served or connected to, or both at once.

All network ends are of this machine (127.0.0.1) unless a URL names another. A viewer that dies or hangs later
takes nothing with it: what is drawn goes on into the file, and closing waits for it a few seconds at most.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Final
from urllib.parse import urlsplit

import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Callable

APPLICATION: Final = "contact_dynamics"
LOCAL: Final = "127.0.0.1"
DEFAULT_PORT: Final = 9876

_START_S: Final = 15.0
_CONNECT_S: Final = 1.0
_POLL_S: Final = 0.05


class ViewerMode(Enum):
    """How a viewer comes to the picture."""

    NONE = "none"
    SPAWN = "spawn"
    SERVE = "serve"
    CONNECT = "connect"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sinks:
    """Where to draw to."""

    rrd_path: str = ""  # file to write, which is replaced; empty: none
    viewer: ViewerMode = ViewerMode.NONE
    port: int = DEFAULT_PORT  # of the viewer that is started, or that is served
    url: str = ""  # of the viewer to connect to, as rerun+http://127.0.0.1:9876/proxy


class OpenRecording:
    """A recording that is open to its sinks."""

    def __init__(self, sinks: Sinks, *, on_problem: Callable[[str], object]) -> None:
        """Open the sinks; a viewer that cannot be reached is told, the file is written all the same.

        Raises:
            OSError: the file cannot be written.
        """
        self.stream = rr.RecordingStream(APPLICATION)
        self._on_problem = on_problem
        self.description = ", ".join(self._open(sinks)) or "nowhere"

    def close(self, *, timeout: float = 5.0) -> bool:
        """Write what is left and let go of the viewer, which stays open; return whether it took all.

        Where it did not within ``timeout``, s, rerun would wait for it for ever when the process exits.
        """
        thread = threading.Thread(target=self._disconnect, daemon=True)
        thread.start()
        thread.join(timeout)
        if thread.is_alive():
            self._on_problem(f"the viewer did not take all that was drawn within {timeout:g} s")
        return not thread.is_alive()

    def _disconnect(self) -> None:
        self.stream.disconnect()

    def _open(self, sinks: Sinks) -> list[str]:
        opened: list[rr.sinks.LogSinkLike] = []
        names: list[str] = []
        if sinks.rrd_path:
            with open(sinks.rrd_path, "wb"):  # noqa: PTH123  rerun itself only logs that it cannot write
                pass
            opened.append(rr.FileSink(sinks.rrd_path))
            names.append(sinks.rrd_path)
        url = self._viewer_url(sinks)
        if sinks.viewer is ViewerMode.SERVE and _listens(LOCAL, sinks.port):
            self._on_problem(f"port {sinks.port} is taken: the picture is not served")
        elif sinks.viewer is ViewerMode.SERVE:
            opened.append(rr.GrpcServerSink(bind_ip=LOCAL, port=sinks.port))
            names.append(f"served at {_local_url(sinks.port)}")
        elif url:
            opened.append(rr.GrpcSink(url))
            names.append(f"viewer at {url}")
        if opened:
            self.stream.set_sinks(*opened)
        return names

    def _viewer_url(self, sinks: Sinks) -> str:
        """Return the URL of a viewer that listens, or nothing after having told why there is none."""
        if sinks.viewer is ViewerMode.CONNECT:
            parts = urlsplit(sinks.url)
            if _listens(parts.hostname or LOCAL, parts.port or DEFAULT_PORT):
                return sinks.url
            self._on_problem(f"no viewer listens at {sinks.url}")
        elif sinks.viewer is ViewerMode.SPAWN:
            problem = _start_viewer(sinks.port)
            if not problem:
                return _local_url(sinks.port)
            self._on_problem(problem)
        return ""


def _start_viewer(port: int) -> str:
    """Start a viewer of its own session, unless one listens already; return what went wrong, or nothing."""
    if _listens(LOCAL, port):
        return ""
    viewer = subprocess.Popen(  # noqa: S603  our own program
        [sys.executable, "-m", "rerun", "--bind", LOCAL, "--port", str(port), "--expect-data-soon"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        env={**os.environ, "RERUN_APP_ONLY": "true"},
    )
    deadline = time.monotonic() + _START_S
    while time.monotonic() < deadline:
        if _listens(LOCAL, port):
            return ""
        if viewer.poll() is not None:
            return f"the viewer ended at once with exit code {viewer.returncode}: is there a display?"
        time.sleep(_POLL_S)
    return f"the viewer did not listen at port {port} within {_START_S:g} s"


def _listens(host: str, port: int) -> bool:
    try:
        with socket.create_connection((host, port), timeout=_CONNECT_S):
            return True
    except OSError:
        return False


def _local_url(port: int) -> str:
    return f"rerun+http://{LOCAL}:{port}/proxy"
