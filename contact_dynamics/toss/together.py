"""Many tosses that go on together: work of one kind that they wait for is done in arrays.

Steps come first, those of the kind that most tosses wait for, then flights. Impacts are done once all tosses
wait for one, because only large groups of them save time. A toss does not depend on the others, so the order
does not matter.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contact_dynamics.toss.flight import AskedFlight
from contact_dynamics.toss.flights_of_many import fly_together
from contact_dynamics.toss.impacts_of_many import strike_together
from contact_dynamics.toss.one_impact import AskedImpact
from contact_dynamics.toss.phase_step import AskedStep
from contact_dynamics.toss.steps_of_many import step_together

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from contact_dynamics.toss.asked import Asked, Kind

FEWEST_STEPS: Final = 12
"""Steps below which one after the other is faster than all at once."""

FEWEST_IMPACTS: Final = 12
"""The same of impacts."""

FEWEST_FLIGHTS: Final = 16
"""The same of flights."""

_FIRST: Final = {"step": 2, "flight": 1, "impact": 0}
"""What is done before other work."""


def together(tosses: list[Iterator[Asked]]) -> None:
    """Do all work that tosses ask for."""
    waiting: dict[Kind, list[tuple[Iterator[Asked], Asked]]] = {}
    ready: Iterable[Iterator[Asked]] = tosses
    while True:
        for toss in ready:
            for asked in toss:
                if asked.kind is not None:
                    waiting.setdefault(asked.kind, []).append((toss, asked))
                    break
                asked.work()
        if not waiting:
            return
        group = waiting.pop(max(waiting, key=lambda kind: (_FIRST[kind[0]], len(waiting[kind]))))
        _work([asked for _, asked in group])
        ready = [toss for toss, _ in group]


def _work(group: list[Asked]) -> None:
    """Do work of one kind."""
    steps = [asked for asked in group if isinstance(asked, AskedStep)]
    flights = [asked for asked in group if isinstance(asked, AskedFlight)]
    impacts = [asked for asked in group if isinstance(asked, AskedImpact)]
    if len(steps) >= FEWEST_STEPS:
        step_together(steps)
    elif len(flights) >= FEWEST_FLIGHTS:
        fly_together(flights)
    elif len(impacts) >= FEWEST_IMPACTS:
        strike_together(impacts)
    else:
        for asked in group:
            asked.work()
