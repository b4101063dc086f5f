# SPDX-License-Identifier: Apache-2.0
"""Ports of this and other machines: whether a viewer listens there, and still lives, or one can be served."""

from __future__ import annotations

import contextlib
import socket
from typing import Final
from urllib.parse import urlsplit

LOCAL: Final = "127.0.0.1"
DEFAULT_PORT: Final = 9876

_CONNECT_S: Final = 1.0
_HTTP2_GREETING: Final = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + bytes([0, 0, 0, 4, 0, 0, 0, 0, 0])
_HEADER: Final = 9  # bytes of a frame's header: its length, type, flags and stream (RFC 9113, 4.1)
_SETTINGS: Final = 4  # type of the frame that an HTTP/2 server begins with (RFC 9113, 3.4 and 6.5)
_PING: Final = 6  # it is sent back with this flag (RFC 9113, 6.7)
_ACKNOWLEDGED: Final = 1


def local_url(port: int) -> str:
    """Return the URL of a viewer at a port of this machine, as rerun writes it."""
    return f"rerun+http://{LOCAL}:{port}/proxy"


def host_and_port(url: str) -> tuple[str, int]:
    """Return what a viewer's URL names, or the defaults of rerun."""
    parts = urlsplit(url)
    return parts.hostname or LOCAL, parts.port or DEFAULT_PORT


def connection_problem(host: str, port: int) -> str:
    """Return the system's reason why nothing is reached at a port, or an empty string if something is."""
    try:
        with socket.create_connection((host, port), timeout=_CONNECT_S):
            return ""
    except OSError as error:
        return str(error)


def serving_problem(port: int) -> str:
    """Return the system's reason why a port cannot be served at, or an empty string if it can."""
    try:
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as rerun does
            probe.bind((LOCAL, port))
            return ""
    except OSError as error:
        return str(error)


def speaks_http2(host: str, port: int) -> bool:
    """Return whether what listens there greets as gRPC's servers do. rerun's viewer is one."""
    with contextlib.suppress(OSError), _greeted(host, port) as connection:
        header = connection.recv(_HEADER)
        return len(header) > 3 and header[3] == _SETTINGS
    return False


class Presence:
    """A connection to a viewer on which nothing is asked. It ends when the viewer does.

    A viewer asks every few seconds whether its client is there, and closes the connection to one that does
    not answer.
    """

    def __init__(self, host: str, port: int) -> None:
        """Connect.

        Raises:
            OSError: nothing listens there.
        """
        self._connection = _greeted(host, port)
        self._connection.setblocking(False)  # noqa: FBT003  so is it named
        self._received = b""

    def lasts(self) -> bool:
        """Return whether the viewer still lives. This is to be asked more often than every ten seconds."""
        try:
            while part := self._connection.recv(4096):
                self._received += part
                self._answer()
        except BlockingIOError:
            return True
        except OSError:
            pass
        self.close()
        return False

    def _answer(self) -> None:
        """Answer the frames that have come whole, as far as they ask for it."""
        while len(self._received) >= _HEADER:
            end = _HEADER + int.from_bytes(self._received[:3], "big")
            if len(self._received) < end:
                return
            frame, self._received = self._received[:end], self._received[end:]
            kind, flags = frame[3], frame[4]
            if kind == _PING and not flags & _ACKNOWLEDGED:
                self._connection.sendall(frame[:4] + bytes([_ACKNOWLEDGED]) + frame[5:])

    def close(self) -> None:
        """End the connection."""
        self._connection.close()


def _greeted(host: str, port: int) -> socket.socket:
    connection = socket.create_connection((host, port), timeout=_CONNECT_S)
    try:
        connection.sendall(_HTTP2_GREETING)
    except OSError:
        connection.close()
        raise
    return connection
