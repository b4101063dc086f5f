# SPDX-License-Identifier: Apache-2.0
"""Ports of this and other machines: whether a viewer listens there, or one can be served."""

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
    with (
        contextlib.suppress(OSError),
        socket.create_connection((host, port), timeout=_CONNECT_S) as connection,
    ):
        connection.sendall(_HTTP2_GREETING)
        header = connection.recv(_HEADER)
        return len(header) > 3 and header[3] == _SETTINGS
    return False
