"""An event that was found in what was measured: what happened, when, where, and how well that is known."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from contact_dynamics.constants import ns_after
from contact_dynamics.records import Record

if TYPE_CHECKING:
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray


class EventKind(Enum):
    """What kinds of events are found; `docs/evaluate.md` has the criteria."""

    FLIGHT = "flight"
    """The body flies: poses that one free flight explains."""
    LANDING = "landing"
    """First contact: a flight ends at a surface."""
    IMPACT = "impact"
    """A flight ends at a surface and another begins soon after."""
    REST = "rest"
    """The body touches, and no contact moves."""
    SLIDING = "sliding"
    """The body touches, no contact leaves or approaches, and one slides at least."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FoundEvent(Record):
    """One event of one body.

    Attributes:
        kind: What happened.
        body: The body's name.
        surface: The surface's name; empty for a flight.
        since: s after the epoch. For a flight, a rest and a slide its beginning; otherwise that of the flight
            before.
        first_sample: The sample at ``since``: no state before it belongs to a question about this event.
        time: s after the epoch, when it is compared: near the end of a flight, a rest or a slide; the time of
            a landing or an impact.
        time_ns: The same as a stamp, ns.
        time_std: Standard deviation of ``time``, s; zero where it is that of a sample.
        state: The state at ``time``; of an impact, ``duration`` later.
        position_std: m, standard deviation of each coordinate of its position.
        orientation_std: (3,), rad, of its rotation vector.
        velocity_std: m/s, of each component.
        angular_velocity_std: (3,), rad/s.
        gap: m, height of the body's lowest point above the surface then; negative below it.
            It is None without a flat.
        duration: s, from the first contact of an impact to the beginning of the flight after it; 0 otherwise.
        mode: The letters of the contacts of a rest or a slide, as measured; empty otherwise.
    """

    kind: EventKind
    body: str
    surface: str
    since: float
    first_sample: int
    time: float
    time_ns: int
    time_std: float
    state: BodyState
    position_std: float
    orientation_std: FloatArray
    velocity_std: float
    angular_velocity_std: FloatArray
    gap: float | None = None
    duration: float = 0.0
    mode: str = ""

    def asked_ns(self, horizon: float) -> int:
        """Return when a question is asked that is ``horizon``, s, ahead of the event, ns."""
        return ns_after(self.time_ns, -horizon)
