# SPDX-License-Identifier: Apache-2.0
"""The UDP ports of a ROS domain, at which its participants discover each other.

The numbers are those of OMG, DDSI-RTPS 2.2, section 9.6.1. Which ports are in use is known on Linux only.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

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
