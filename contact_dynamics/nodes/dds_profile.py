"""The Fast DDS profile of our nodes, with which a killed process neither blocks nor delays the others.

Messages come in over UDP, also from the same machine. In shared memory, which is the default there, a
process that was killed can leave a lock behind that blocks whoever writes to it next, and others go on to
write into its memory for one to three seconds, also if a new process has its port by then.

They come in at a port that differs at each start. At the port of a killed process, which is the default,
others answer the new one a second later.

The node announces itself every `_ANNOUNCED_EVERY_S` instead of every three seconds. A restarted client mostly
misses the first announcement (`introductions.py` explains why) and gets no answer before the second.

Unacknowledged messages are announced again every `_ASKED_EVERY_S` instead of every three seconds. A restarted
client has the port of the killed one, so that it misses the first answers, and later ones wait for these.

A user's own profile takes the place of this one.
"""

from __future__ import annotations

import os
import tempfile
import time
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import NS_PER_S
from contact_dynamics.nodes.domain_ports import PORTS_OF_PARTICIPANT

if TYPE_CHECKING:
    from collections.abc import Iterator

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
