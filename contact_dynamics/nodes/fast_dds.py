# SPDX-License-Identifier: Apache-2.0
"""A fault of Fast DDS 2.14 that users would notice, and how our nodes get around it.

The whole file can go when a killed process and a new one no longer trouble the others without it:
`test/nodes/test_found_at_once.py` and `python -m benchmarks.kills` measure that. With another middleware
nothing here acts.

A process that is killed can leave a lock behind in shared memory, the default on one machine, that blocks
whoever writes to it next, and others go on to write into its memory for one to three seconds, also if a new
process has its port by then. So by the profile of our nodes messages come in over UDP, at a port that differs
at each start: at the port of a killed process, others answer the new one a second later. The node announces
itself every `_ANNOUNCED_EVERY_S` instead of every three seconds, since a restarted client mostly misses the
first announcement. Messages that nobody confirmed are announced again every `_ASKED_EVERY_S` instead of every
three seconds: a restarted client has the port of the killed one, so that it misses the first answers. A
user's own profile takes the place of this one.
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


IS_VERSION_3: Final = int(version("rclpy").partition(".")[0]) > 7
"""Whether Fast DDS is that of Kilted or newer, which renamed what its profiles are found and made of."""

VARIABLE: Final = "FASTDDS_DEFAULT_PROFILES_FILE" if IS_VERSION_3 else "FASTRTPS_DEFAULT_PROFILES_FILE"
_IN_THIS_FOLDER: Final = "DEFAULT_FASTDDS_PROFILES.xml" if IS_VERSION_3 else "DEFAULT_FASTRTPS_PROFILES.xml"

_ANNOUNCED_EVERY_S: Final = 0.5
"""s. 64 small messages a second to this machine, which take half a thousandth of a processor."""

_ASKED_EVERY_S: Final = 0.1  # s. Only writers with unconfirmed messages ask.

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
    <times><{period}><sec>0</sec><nanosec>{asked_every_ns}</nanosec></{period}></times>
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
        period="heartbeat_period" if IS_VERSION_3 else "heartbeatPeriod",
    )
    with ExitStack() as stack:
        with suppress(OSError):  # where no file can be written, Fast DDS goes by its own choice
            file = stack.enter_context(tempfile.NamedTemporaryFile("w", suffix=".xml"))
            file.write(text)
            file.flush()
            os.environ[VARIABLE] = file.name
            stack.callback(os.environ.pop, VARIABLE)
        yield
