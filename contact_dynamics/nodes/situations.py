# SPDX-License-Identifier: Apache-2.0
"""The situations that `/diagnostics` reports, each with its level and text.

A status is OK if none of its situations is present. A situation ends with its cause. An instantaneous one,
such as the loss of a message, is present for `RECENT_S` after it last occurred. `docs/diagnostics.md` has
this table for users. This file imports no ROS.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, IntEnum
from typing import Final, NamedTuple

RECENT_S: Final = 3.0
"""s. It is long enough for a monitor that checks every few seconds."""

NO_MCAP: Final = "no log is written, because the Python package mcap is not installed: pip install mcap"


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultLimits:
    """When faults are reported."""

    warn_every: float = 5.0  # s between two warnings of one kind about one topic
    silent_after: float = 2.0  # s without a message after which a topic counts as silent


class Level(IntEnum):
    """The severity of a situation, as in `diagnostic_msgs/DiagnosticStatus`."""

    OK = 0
    WARN = 1
    ERROR = 2


class Part(Enum):
    """The subject of a status."""

    STATES = "states"
    ANSWERS = "answers"
    EVENTS = "events"
    LOG = "log"


class Present(NamedTuple):
    """A situation that is present."""

    part: Part  # the status that reports it
    level: Level  # its level
    text: str  # what is reported


class Situation(Enum):
    """A situation. Its value contains names of values in the text."""

    NO_STATE_YET = Present(
        Part.STATES, Level.WARN, "no state of {body!r} received on {topics} ({publishers} publishers)"
    )
    NO_MATCH = Present(
        Part.STATES, Level.ERROR, "{topic}: {count} of {publishers} publishers cannot be received: {reason}"
    )
    ALL_REJECTED = Present(
        Part.STATES, Level.ERROR, "the states of {body!r} are rejected, the last because {reason}"
    )
    SOME_REJECTED = Present(
        Part.STATES, Level.WARN, "some states of {body!r} are rejected, the last because {reason}"
    )
    OLD = Present(
        Part.STATES,
        Level.ERROR,
        "the states of {body!r} are too old on arrival, the last by {age:.3f} s (state_timeout): "
        "do the clocks agree?",
    )
    SILENT = Present(Part.STATES, Level.WARN, "{topic} is silent")
    BODY_SILENT = Present(Part.STATES, Level.WARN, "no state of {body!r} is received any more on {topics}")
    LOST = Present(
        Part.STATES, Level.WARN, "{topic}: messages were lost before they were received, {count} so far"
    )
    SEVERAL_PUBLISHERS = Present(
        Part.STATES, Level.WARN, "{topic}: {publishers} publishers send states of one body"
    )
    TWIST_AXES = Present(
        Part.STATES,
        Level.WARN,
        "{topic}: the twist disagrees with the poses by {speed:.1f} m/s; in nav_msgs/Odometry it is in the "
        "axes of child_frame_id",
    )
    NO_CLOCK = Present(Part.STATES, Level.WARN, "use_sim_time is true and no time was received on /clock")
    SAME_NAME = Present(
        Part.ANSWERS, Level.ERROR, "another node has this name, and both answer the same requests"
    )
    FAULT = Present(Part.ANSWERS, Level.ERROR, "internal errors of the server, {count} so far")
    OVERLOADED = Present(
        Part.ANSWERS, Level.WARN, "requests were rejected as BUSY or TIMEOUT, {count} so far"
    )
    WORKERS = Present(Part.ANSWERS, Level.WARN, "{ready} of {count} workers are ready")
    CHANGED = Present(Part.EVENTS, Level.WARN, "the {coefficient} of {surface} has changed: {estimates}")
    NO_MCAP = Present(Part.LOG, Level.WARN, NO_MCAP)
    LOG_INTERRUPTED = Present(Part.LOG, Level.ERROR, "{problem}; {lost} messages are missing so far")
    LOG_DROPPING = Present(Part.LOG, Level.ERROR, "{problem}; {lost} messages are lost so far")
    LOG_REJECTING = Present(Part.LOG, Level.WARN, "{problem}")
    LOG_NOT_AWAITED = Present(
        Part.LOG, Level.WARN, "the disk took too long, and responses are sent before they are on it"
    )

    def present(self, **found: object) -> Present:
        """Return the present situation, with the values in its text."""
        return self.value._replace(text=self.value.text.format(**found))
