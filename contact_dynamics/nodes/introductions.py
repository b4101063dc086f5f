"""Asks the processes of this machine to introduce themselves again to one that has just joined the domain.

A process that joins says who it is, and each other one answers that at once. Fast DDS 2.14 begins to listen
only after it has told all of them, so it misses the answers of those that are quick. They say it again every
three seconds, and until then a client that waits for a server gets nothing from it.

So a process that has joined sends one more message of the discovery (OMG, DDSI-RTPS 2.2, sections 8.5.3 and
9.6): a participant that has only an ear, at the port where this process listens by now. The others tell
it who they are, forget it after `_LEASE_S`, and do not show it, since it has no nodes and no topics.
"""

from __future__ import annotations

import os
import socket
import struct
from contextlib import suppress
from pathlib import Path
from typing import Final

import rclpy

from contact_dynamics.nodes.domain_ports import FIRST_DISCOVERY, PORTS_OF_PARTICIPANT, first_port

_DISCOVERY_RANGE: Final = "ROS_AUTOMATIC_DISCOVERY_RANGE"
_MAX_PARTICIPANTS: Final = 32
"""Participants of one machine that ROS looks for where it looks on this machine alone."""

_LEASE_S: Final = 1
_LOCALHOST: Final = "127.0.0.1"

_NO_VENDOR: Final = bytes(2)
_ANYBODY: Final = bytes(4)
_ANNOUNCER: Final = bytes.fromhex("000100c2")
_PARTICIPANT: Final = bytes.fromhex("000001c1")
_HEARS_WHO_IS_THERE: Final = 2  # the only one of the built-in endpoints that it has


def ask_for_introductions(domain_id: int) -> None:
    """Let all on this machine who are in a domain say again who they are, once this process has joined it."""
    if not rclpy.get_rmw_implementation_identifier().startswith("rmw_fastrtps"):
        return
    if os.environ.get(_DISCOVERY_RANGE) == "OFF":
        return
    first = first_port(domain_id) + FIRST_DISCOVERY
    ports = range(first, first + PORTS_OF_PARTICIPANT * _MAX_PARTICIPANTS, PORTS_OF_PARTICIPANT)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for own in _own_ports() & set(ports):
            message = _introduction(own)
            for port in ports:
                with suppress(OSError):  # nobody is at that port
                    sender.sendto(message, (_LOCALHOST, port))


def _own_ports() -> set[int]:
    """Return the ports at which this process receives datagrams."""
    ports = set()
    for path in Path("/proc/self/fd").iterdir():
        with suppress(OSError):  # it was closed meanwhile
            if str(path.readlink()).startswith("socket:"):
                with socket.socket(fileno=os.dup(int(path.name))) as own:
                    if (own.family, own.type) == (socket.AF_INET, socket.SOCK_DGRAM):
                        ports.add(own.getsockname()[1])
    return ports


def _introduction(port: int) -> bytes:
    """Return the message by which a participant that only hears introduces itself."""
    prefix = os.urandom(12)
    locator = struct.pack("<iI12x", 1, port) + socket.inet_aton(_LOCALHOST)
    parameters = [
        (0x0015, bytes([2, 2, 0, 0])),  # version of the protocol
        (0x0016, _NO_VENDOR + bytes(2)),
        (0x0050, prefix + _PARTICIPANT),
        (0x0032, locator),  # for discovery
        (0x0031, locator),  # for all else
        (0x0002, struct.pack("<iI", _LEASE_S, 0)),
        (0x0058, struct.pack("<I", _HEARS_WHO_IS_THERE)),
        (0x0001, b""),  # the end
    ]
    payload = bytes.fromhex("00030000")  # a list of parameters, little-endian
    payload += b"".join(struct.pack("<HH", number, len(value)) + value for number, value in parameters)
    data = struct.pack("<HH", 0, 16) + _ANYBODY + _ANNOUNCER + struct.pack("<iI", 0, 1) + payload
    header = b"RTPS" + bytes([2, 2]) + _NO_VENDOR + prefix
    return header + struct.pack("<BBH", 0x15, 0x05, len(data)) + data
