"""The profile by which Fast DDS makes the participant of a node, so that one which starts again hears soon.

It says two things. Messages come at a port that nobody left behind. Processes of one machine hand messages
over in shared memory that belongs to such a port. Those that sent to a process that was killed go on to write
into its memory until they notice, one to three seconds later, also if another process has its port by then.
At a port of its own, it hears them at once.

And the node says who it is every `_ANNOUNCED_EVERY_S` instead of every three seconds. A client that starts
again misses the first time more often than not (`introductions.py` says why), and has no answer before the
second.

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

if TYPE_CHECKING:
    from collections.abc import Iterator

VARIABLE: Final = "FASTRTPS_DEFAULT_PROFILES_FILE"
_IN_THIS_FOLDER: Final = "DEFAULT_FASTRTPS_PROFILES.xml"

_ANNOUNCED_EVERY_S: Final = 0.5
"""s. 64 small messages a second to this machine, which take half a thousandth of a processor."""

_FIRST_PORT: Final = 7400
_DOMAIN_PORTS: Final = 250
FIRST_OFFSET: Final = 101
"""Ports count from the first one of the domain. Below are those of Fast DDS's choice for 45 participants."""

PORTS: Final = 60
"""They are two apart, and end so far below the next domain that ten further participants find one."""

_SHARED_MEMORY: Final = Path("/dev/shm")  # noqa: S108  Fast DDS has no other place

_PROFILE: Final = """<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="contact_dynamics" is_default_profile="true">
    <rtps>
      <builtin>
        <discovery_config>
          <leaseAnnouncement><sec>0</sec><nanosec>{nanoseconds}</nanosec></leaseAnnouncement>
        </discovery_config>
      </builtin>
      <port><offsetd3>{offset}</offsetd3></port>
    </rtps>
  </participant>
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
    nanoseconds = round(NS_PER_S * _ANNOUNCED_EVERY_S)
    text = _PROFILE.format(offset=_free_offset(domain_id), nanoseconds=nanoseconds)
    with ExitStack() as stack:
        with suppress(OSError):  # where no file can be written, Fast DDS goes by its own choice
            file = stack.enter_context(tempfile.NamedTemporaryFile("w", suffix=".xml"))
            file.write(text)
            file.flush()
            os.environ[VARIABLE] = file.name
            stack.callback(os.environ.pop, VARIABLE)
        yield


def _free_offset(domain_id: int) -> int:
    """Return the offset of a port that has no file, or if there is none, of another one than a second ago."""
    now = int(time.monotonic())
    offsets = [FIRST_OFFSET + 2 * ((now + each) % PORTS) for each in range(PORTS)]
    first = _FIRST_PORT + _DOMAIN_PORTS * domain_id
    free = (each for each in offsets if not (_SHARED_MEMORY / f"fastrtps_port{first + each}").exists())
    return next(free, offsets[0])
