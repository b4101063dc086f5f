"""Many tosses that go on together: work of one kind that they wait for is done in arrays.

Impacts are done once all tosses wait for one, because only large groups of them save time, and steps before,
those of the kind that most tosses wait for. A toss does not depend on the others, so the order does not
matter.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

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
        group = waiting.pop(max(waiting, key=lambda kind: (kind[0] == "step", len(waiting[kind]))))
        _work([asked for _, asked in group])
        ready = [toss for toss, _ in group]


def _work(group: list[Asked]) -> None:
    """Do work of one kind."""
    steps = [asked for asked in group if isinstance(asked, AskedStep)]
    impacts = [asked for asked in group if isinstance(asked, AskedImpact)]
    if len(steps) >= FEWEST_STEPS:
        step_together(steps)
    elif len(impacts) >= FEWEST_IMPACTS:
        strike_together(impacts)
    else:
        for asked in group:
            asked.work()
