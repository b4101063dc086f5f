# SPDX-License-Identifier: Apache-2.0
"""A gap is a time of which a log has no messages, because its disk refused them."""

from __future__ import annotations

import json
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.constants import NS_PER_S

if TYPE_CHECKING:
    from collections.abc import Sequence

_KEY: Final = "gaps"  # in the record of the run


class Gap(NamedTuple):
    """A time in which messages were lost.

    Attributes:
        from_ns: When the first of them was received, ns since the epoch.
        until_ns: When the log went on, ns since the epoch.
        lost: Number of messages.
    """

    from_ns: int
    until_ns: int
    lost: int

    def __str__(self) -> str:
        """Return in words what is missing."""
        began = datetime.fromtimestamp(self.from_ns / NS_PER_S, timezone.utc)
        seconds = (self.until_ns - self.from_ns) / NS_PER_S
        return f"{self.lost} messages of {seconds:.1f} s from {began:%Y-%m-%d %H:%M:%S} UTC are missing"


def record_of_gaps(gaps: Sequence[Gap]) -> dict[str, str]:
    """Return what the record of the run says of gaps."""
    return {_KEY: json.dumps([gap._asdict() for gap in gaps])} if gaps else {}
