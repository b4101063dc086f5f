"""Opens the places where the picture goes: a file, a viewer that is started, served or connected to, or both.

All network addresses are of this machine (127.0.0.1) unless a URL names another. If a viewer dies or hangs
later, the picture still goes into the file, and closing waits for the viewer a few seconds at most.
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
    """The way in which a viewer gets the picture."""

    NONE = "none"
    SPAWN = "spawn"
    SERVE = "serve"
    CONNECT = "connect"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sinks:
    """The places to draw to.

    Attributes:
        rrd_path: File to write, which is replaced. If it is empty, no file is written.
        port: Port of the viewer that is started, or that is served.
        url: URL of the viewer to connect to, such as rerun+http://127.0.0.1:9876/proxy.
    """

    rrd_path: str = ""
    viewer: ViewerMode = ViewerMode.NONE
    port: int = DEFAULT_PORT
    url: str = ""


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
        """Write what is left and leave the viewer, which stays open. Return whether it took everything.

        If it did not within ``timeout``, s, rerun would wait for it for ever when the process exits.
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
        """Return the URL of a viewer that listens, or None after a message that says why there is none."""
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
    """Make rerun raise an error for what it cannot draw, instead of a warning."""
    rr.set_strict_mode(True)


def _serving_problem(port: int) -> str:
    """Return the system's reason why a port cannot be served at, or an empty string if it can."""
    try:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as rerun does
            probe.bind((LOCAL, port))
            return ""
    except OSError as error:
        return str(error)


def _local_url(port: int) -> str:
    return f"rerun+http://{LOCAL}:{port}/proxy"
