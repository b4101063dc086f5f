"""Where the picture goes: a file, and a viewer that is started, served or connected to, or both at once.

All network ends are of this machine (127.0.0.1) unless a URL names another. A viewer that dies or hangs later
takes nothing with it: what is drawn goes on into the file, and closing waits for it a few seconds at most.
"""

from __future__ import annotations

import socket
import threading
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Final
from urllib.parse import urlsplit

import rerun as rr

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.viewing.viewer_process import LOCAL, ViewerProcess, connection_problem

if TYPE_CHECKING:
    from collections.abc import Callable

APPLICATION: Final = "contact_dynamics"
DEFAULT_PORT: Final = 9876


class ViewerMode(Enum):
    """How a viewer comes to the picture."""

    NONE = "none"
    SPAWN = "spawn"
    SERVE = "serve"
    CONNECT = "connect"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sinks:
    """Where to draw to.

    Attributes:
        rrd_path: File to write, which is replaced; empty: none.
        port: Port of the viewer that is started, or that is served.
        url: URL of the viewer to connect to, such as rerun+http://127.0.0.1:9876/proxy.
    """

    rrd_path: str = ""
    viewer: ViewerMode = ViewerMode.NONE
    port: int = DEFAULT_PORT
    url: str = ""


class NowhereToDrawError(ContactDynamicsError):
    """A viewer was asked for and no file, and the viewer cannot be reached; the message says why."""


class OpenRecording:
    """A recording that is open to its sinks."""

    def __init__(self, sinks: Sinks, *, on_problem: Callable[[str], object]) -> None:
        """Open the sinks; a viewer that cannot be reached is told, the file is written all the same.

        Raises:
            OSError: the file cannot be written.
            NowhereToDrawError: a viewer was asked for alone, and there is none.
        """
        self.stream = rr.RecordingStream(APPLICATION)
        self._on_problem = on_problem
        self._viewer: ViewerProcess | None = None
        self._problem = ""
        self.description = ", ".join(self._open(sinks)) or "nowhere"
        if self._problem and not sinks.rrd_path:
            message = f"nowhere to draw to: {self._problem}"
            raise NowhereToDrawError(message)
        if self._problem:
            on_problem(self._problem)

    @property
    def viewer_failed(self) -> bool:
        """Whether the viewer that was asked for could not be reached, or has failed since."""
        return bool(self._problem) or (self._viewer is not None and self._viewer.failed)

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
            # The footer, an index of all that was drawn, stays in memory until the end: 50 KB an answer.
            opened.append(rr.FileSink(sinks.rrd_path, write_footer=False))
            names.append(sinks.rrd_path)
        url = self._viewer_url(sinks)
        problem = _serving_problem(sinks.port) if sinks.viewer is ViewerMode.SERVE else ""
        if problem:
            self._problem = f"the picture is not served at port {sinks.port}: {problem}"
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
            problem = connection_problem(parts.hostname or LOCAL, parts.port or DEFAULT_PORT)
            if not problem:
                return sinks.url
            self._problem = f"no viewer listens at {sinks.url}: {problem}"
        elif sinks.viewer is ViewerMode.SPAWN:
            self._viewer = ViewerProcess(sinks.port, on_problem=self._on_problem)
            if not self._viewer.problem:
                return _local_url(sinks.port)
            self._problem = self._viewer.problem
        return ""


def raise_errors() -> None:
    """Let rerun raise where it is given what it cannot draw, which it would only warn of."""
    rr.set_strict_mode(True)


def _serving_problem(port: int) -> str:
    """Return why a port cannot be served at, in the system's words, or nothing where it can."""
    try:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as rerun does
            probe.bind((LOCAL, port))
            return ""
    except OSError as error:
        return str(error)


def _local_url(port: int) -> str:
    return f"rerun+http://{LOCAL}:{port}/proxy"
