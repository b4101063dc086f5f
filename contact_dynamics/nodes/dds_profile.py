"""The profile by which Fast DDS makes the participant of a node, so that one which starts again hears soon.

It says three things. Messages come at a port that nobody left behind. Processes of one machine hand messages
over in shared memory that belongs to such a port. Those that sent to a process that was killed go on to write
into its memory until they notice, one to three seconds later, also if another process has its port by then.
At a port of its own, it hears them at once.

And the node says who it is every `_ANNOUNCED_EVERY_S` instead of every three seconds. A client that starts
again misses the first time more often than not (`introductions.py` says why), and has no answer before the
second.

And what was sent and is not confirmed is asked about every `_ASKED_EVERY_S` instead of every three seconds.
A client that was killed and starts again takes the port of the one before, so that it misses the first
answers, and those that follow wait until it has these.

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
from contact_dynamics.nodes.domain_ports import PORTS_OF_PARTICIPANT, first_port, next_participant

if TYPE_CHECKING:
    from collections.abc import Iterator

VARIABLE: Final = "FASTRTPS_DEFAULT_PROFILES_FILE"
_IN_THIS_FOLDER: Final = "DEFAULT_FASTRTPS_PROFILES.xml"

_ANNOUNCED_EVERY_S: Final = 0.5
"""s. 64 small messages a second to this machine, which take half a thousandth of a processor."""

_ASKED_EVERY_S: Final = 0.1
"""s. Only a writer some of whose messages are not confirmed asks."""

FIRST_OFFSET: Final = 101
"""Ports count from the first one of the domain. Below are those of Fast DDS's choice for 45 participants."""

PORTS: Final = 60
"""They are `PORTS_OF_PARTICIPANT` apart. They end so far below the next domain that ten further participants
find one."""

_SHARED_MEMORY: Final = Path("/dev/shm")  # noqa: S108  Fast DDS has no other place

_PROFILE: Final = """<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="contact_dynamics" is_default_profile="true">
    <rtps>
      <builtin>
        <discovery_config>
          <leaseAnnouncement><sec>0</sec><nanosec>{announced_every_ns}</nanosec></leaseAnnouncement>
        </discovery_config>
      </builtin>
      <port><offsetd3>{offset}</offsetd3></port>
    </rtps>
  </participant>
  <data_writer profile_name="contact_dynamics_writer" is_default_profile="true">
    <times><heartbeatPeriod><sec>0</sec><nanosec>{asked_every_ns}</nanosec></heartbeatPeriod></times>
  </data_writer>
</profiles>
"""


@contextmanager
def profile_of_fast_dds(domain_id: int) -> Iterator[None]:
    """Let participants that are made in a domain meanwhile have the profile, unless the user has one.

    The environment is as before afterwards, so that processes that are started later do not inherit it.
    """
    if os.environ.get(VARIABLE) or Path(_IN_THIS_FOLDER).exists():
        yield
        return
    text = _PROFILE.format(
        offset=_free_offset(domain_id),
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


def _free_offset(domain_id: int) -> int:
    """Return the offset of a port that has no file, or if there is none, of another one than a second ago.

    It is the offset of the first participant. That of this process comes as many ports later as there are
    others before it.
    """
    now = int(time.monotonic())
    offsets = [FIRST_OFFSET + PORTS_OF_PARTICIPANT * ((now + each) % PORTS) for each in range(PORTS)]
    first = first_port(domain_id) + PORTS_OF_PARTICIPANT * next_participant(domain_id)
    free = (each for each in offsets if not (_SHARED_MEMORY / f"fastrtps_port{first + each}").exists())
    return next(free, offsets[0])
