"""A ROS domain of one's own, so that demos and tests which run side by side do not hear each other.

This works on Linux only. The claim is a socket in the abstract namespace, which vanishes with its process.
"""

from __future__ import annotations

import os
import socket
from typing import Final

from contact_dynamics.nodes.domain_ports import FIRST_PORT, PORTS_OF_DOMAIN, ports_in_use

_DOMAINS: Final = 100
"""Number of ROS domains to choose from. Domains 1 to 100 use ports below the ephemeral ones of Linux."""


def claim_domain() -> int:
    """Return a ROS_DOMAIN_ID that no other process here uses or has claimed. It is kept until this one ends.

    Raises:
        RuntimeError: all domains are in use.
    """
    in_use = _domains_in_use()
    for offset in range(_DOMAINS):
        domain = 1 + (os.getpid() + offset) % _DOMAINS
        if domain not in in_use and _claim(domain):
            return domain
    raise RuntimeError(f"one of the ROS domains 1 to {_DOMAINS} must be free, got all in use")


def _claim(domain: int) -> bool:
    claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        claim.bind(f"\0contact_dynamics ROS domain {domain}")
    except OSError:
        claim.close()
        return False
    claim.detach()  # stays open until the process ends
    return True


def _domains_in_use() -> set[int]:
    """Return the domains on whose ports any process listens."""
    return {(port - FIRST_PORT) // PORTS_OF_DOMAIN for port in ports_in_use()}
