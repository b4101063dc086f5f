# SPDX-License-Identifier: Apache-2.0
"""A workaround for faults of Fast DDS 2.14 after a process is killed. Other middleware is unaffected.

The file can be removed when killed and restarted processes no longer disturb others without it, which
`test/nodes/test_found_at_once.py` and `python -m benchmarks.kills` measure.

A killed process can leave a lock in shared memory, the default on one machine, which blocks the next writer.
Others continue to write to its memory for one to three seconds, even if a new process has its port. The
profile of our nodes therefore receives messages over UDP, at a port that differs at each start, because
others answer a process at the port of a killed one a second later. The node announces itself every
`_ANNOUNCED_EVERY_S` instead of every three seconds, since a restarted client usually misses the first
announcement. Unconfirmed messages are announced every `_ASKED_EVERY_S` instead of every three seconds,
because a restarted client at the port of the killed one misses the first responses. A profile of the user
replaces this one.
"""

from __future__ import annotations

import os
import re
import tempfile
import time
from contextlib import ExitStack, contextmanager, suppress
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import NS_PER_S

if TYPE_CHECKING:
    from collections.abc import Iterator

FIRST_PORT: Final = 7400  # first port of domain 0

PORTS_OF_DOMAIN: Final = 250

PORTS_OF_PARTICIPANT: Final = 2
"""Number of ports of a participant, which is the distance between the ports of two participants."""

_TABLES: Final = (Path("/proc/net/udp"), Path("/proc/net/udp6"))
_LOCAL_PORT: Final = re.compile(r"^ *\d+: [0-9A-F]+:([0-9A-F]{4}) ", re.MULTILINE)


def first_port(domain_id: int) -> int:
    """Return the first port of a domain."""
    return FIRST_PORT + PORTS_OF_DOMAIN * domain_id


def ports_in_use() -> set[int]:
    """Return the ports on which any process listens."""
    text = "\n".join(table.read_text(encoding="ascii") for table in _TABLES if table.is_file())
    return {int(port, 16) for port in _LOCAL_PORT.findall(text)}


IS_VERSION_3: Final = int(version("rclpy").partition(".")[0]) > 7
"""Whether Fast DDS is that of Kilted or newer, with other names of profiles and their elements."""

VARIABLE: Final = "FASTDDS_DEFAULT_PROFILES_FILE" if IS_VERSION_3 else "FASTRTPS_DEFAULT_PROFILES_FILE"
_IN_THIS_FOLDER: Final = "DEFAULT_FASTDDS_PROFILES.xml" if IS_VERSION_3 else "DEFAULT_FASTRTPS_PROFILES.xml"

_ANNOUNCED_EVERY_S: Final = 0.5
"""s. This sends 64 small messages per second to this machine, which use 0.05 % of a processor."""

_ASKED_EVERY_S: Final = 0.1  # s. Only writers with unconfirmed messages ask.

FIRST_OFFSET: Final = 101
"""Offset from the first port of the domain, above the ports that Fast DDS chooses for 45 participants."""

PORTS: Final = 60
"""Number of ports, `PORTS_OF_PARTICIPANT` apart. Ten further participants have room below the next domain."""

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
    <times><{period}><sec>0</sec><nanosec>{asked_every_ns}</nanosec></{period}></times>
  </data_writer>
</profiles>
"""


@contextmanager
def profile_of_fast_dds() -> Iterator[None]:
    """Set the profile for participants that are created in this context, unless the user has one.

    The environment is restored at the end, so that later processes do not inherit the profile.
    """
    if os.environ.get(VARIABLE) or Path(_IN_THIS_FOLDER).exists():
        yield
        return
    text = _PROFILE.format(
        offset=FIRST_OFFSET + PORTS_OF_PARTICIPANT * (int(time.monotonic()) % PORTS),
        announced_every_ns=round(NS_PER_S * _ANNOUNCED_EVERY_S),
        asked_every_ns=round(NS_PER_S * _ASKED_EVERY_S),
        period="heartbeat_period" if IS_VERSION_3 else "heartbeatPeriod",
    )
    with ExitStack() as stack:
        with suppress(OSError):  # without a file, Fast DDS uses its defaults
            file = stack.enter_context(tempfile.NamedTemporaryFile("w", suffix=".xml"))
            file.write(text)
            file.flush()
            os.environ[VARIABLE] = file.name
            stack.callback(os.environ.pop, VARIABLE)
        yield
