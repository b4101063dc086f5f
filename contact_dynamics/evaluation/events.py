"""All events of a measured body, in the order of time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.evaluation.flight_events import flight_events
from contact_dynamics.evaluation.mode_events import mode_events

if TYPE_CHECKING:
    from contact_dynamics.evaluation.found_event import FoundEvent
    from contact_dynamics.evaluation.motion import MeasuredMotion


def find_events(motion: MeasuredMotion) -> list[FoundEvent]:
    """Return the flights, landings, impacts, rests and slides of a body; `docs/evaluate.md` has the criteria.

    Neither landings nor modes are found of a body without a shape, or in a world without surfaces.
    """
    flights, events = flight_events(motion)
    return sorted([*events, *mode_events(motion, flights)], key=lambda event: (event.since, event.time))
