# SPDX-License-Identifier: Apache-2.0
"""Two faults of Fast DDS 2.14 that users would notice, and how our nodes get around them.

The whole file can go when a killed process and a new one no longer trouble the others without it:
`test/nodes/test_found_at_once.py` and `python -m benchmarks.kills` measure that. With another middleware
nothing here acts.

A process that is killed. In shared memory, the default on one machine, it can leave a lock behind that blocks
whoever writes to it next, and others go on to write into its memory for one to three seconds, also if a new
process has its port by then. So by the profile of our nodes messages come in over UDP, at a port that differs
at each start: at the port of a killed process, others answer the new one a second later. The node announces
itself every `_ANNOUNCED_EVERY_S` instead of every three seconds, since a restarted client mostly misses the
first announcement. Messages that nobody confirmed are announced again every `_ASKED_EVERY_S` instead of every
three seconds: a restarted client has the port of the killed one, so that it misses the first answers. A
user's own profile takes the place of this one.

A process that joins says who it is, and each other one answers that at once. Fast DDS begins to listen only
after it has told all of them, so it misses the answers of those that are quick. They say it again every three
seconds, and until then a client that waits for a server gets nothing from it. So a process that has joined
sends one more message of the discovery (OMG, DDSI-RTPS 2.2, sections 8.5.3 and 9.6): a participant that has
only an ear, at the port where this process listens by now. The others tell it who they are, forget it after
`_LEASE_S`, and do not show it, since it has no nodes and no topics.
"""

from __future__ import annotations

import os
import re
import socket
import struct
import tempfile
import time
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import NS_PER_S

if TYPE_CHECKING:
    from collections.abc import Iterator

FIRST_PORT: Final = 7400
"""First port of domain 0."""

PORTS_OF_DOMAIN: Final = 250

FIRST_DISCOVERY: Final = 10
"""Port at which the first participant of a machine discovers others, counted from the first of the domain."""

PORTS_OF_PARTICIPANT: Final = 2
"""Ports that a participant takes. Each is that of the participant before it and this many more."""

_TABLES: Final = (Path("/proc/net/udp"), Path("/proc/net/udp6"))
_LOCAL_PORT: Final = re.compile(r"^ *\d+: [0-9A-F]+:([0-9A-F]{4}) ", re.MULTILINE)


def first_port(domain_id: int) -> int:
    """Return the first port of a domain."""
    return FIRST_PORT + PORTS_OF_DOMAIN * domain_id


def ports_in_use() -> set[int]:
    """Return the ports on which any process listens."""
    text = "\n".join(table.read_text(encoding="ascii") for table in _TABLES if table.is_file())
    return {int(port, 16) for port in _LOCAL_PORT.findall(text)}


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
    import rclpy  # here, for others look at ports without ROS

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


VARIABLE: Final = "FASTRTPS_DEFAULT_PROFILES_FILE"
_IN_THIS_FOLDER: Final = "DEFAULT_FASTRTPS_PROFILES.xml"

_ANNOUNCED_EVERY_S: Final = 0.5
"""s. 64 small messages a second to this machine, which take half a thousandth of a processor."""

_ASKED_EVERY_S: Final = 0.1
"""s. Only a writer some of whose messages are not confirmed asks."""

FIRST_OFFSET: Final = 101
"""Ports count from the first one of the domain. Below are those that Fast DDS chooses for 45 participants."""

PORTS: Final = 60
"""They are `PORTS_OF_PARTICIPANT` apart, and end so far below the next domain that ten further participants
find one."""

_PROFILE: Final = """<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="contact_dynamics" is_default_profile="true">
    <rtps>
      <builtin>
        <discovery_config>
          <leaseAnnouncement><sec>0</sec><nanosec>{announced_every_ns}</nanosec></leaseAnnouncement>
        </discovery_config>
      </builtin>
      <defaultUnicastLocatorList><locator><udpv4/></locator></defaultUnicastLocatorList>
      <port><offsetd3>{offset}</offsetd3></port>
    </rtps>
  </participant>
  <data_writer profile_name="contact_dynamics_writer" is_default_profile="true">
    <times><heartbeatPeriod><sec>0</sec><nanosec>{asked_every_ns}</nanosec></heartbeatPeriod></times>
  </data_writer>
</profiles>
"""


@contextmanager
def profile_of_fast_dds() -> Iterator[None]:
    """Give participants that are made meanwhile the profile, unless the user has one.

    The environment is as before afterwards, so that processes that are started later do not inherit it.
    """
    if os.environ.get(VARIABLE) or Path(_IN_THIS_FOLDER).exists():
        yield
        return
    text = _PROFILE.format(
        offset=FIRST_OFFSET + PORTS_OF_PARTICIPANT * (int(time.monotonic()) % PORTS),
        announced_every_ns=round(NS_PER_S * _ANNOUNCED_EVERY_S),
        asked_every_ns=round(NS_PER_S * _ASKED_EVERY_S),
    )
    with ExitStack() as stack:
        with suppress(OSError):  # where no file can be written, Fast DDS goes by its own choice
            file = stack.enter_context(tempfile.NamedTemporaryFile("w", suffix=".xml"))
            file.write(text)
            file.flush()
            os.environ[VARIABLE] = file.name
            stack.callback(os.environ.pop, VARIABLE)
        yield
