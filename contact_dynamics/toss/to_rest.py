# SPDX-License-Identifier: Apache-2.0
"""Simulates samples of a toss until they rest, in one or several processes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.tolerances import SAMPLED_PHASE_ERROR
from contact_dynamics.toss.result import TossEnd, TossEventKind
from contact_dynamics.toss.simulation import Simulation, TossSettings
from contact_dynamics.validation import check_whole

if TYPE_CHECKING:
    from collections.abc import Iterable
    from concurrent.futures import Executor

    from contact_dynamics.impact.law import RestitutionLaw
    from contact_dynamics.impact.several.result import SeveralContactsLaw
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.law_spread import LawSpread
    from contact_dynamics.toss.next_strikes import ManyStrikes
    from contact_dynamics.toss.solid import Numbers, Touch

PART: Final = 100
"""Number of samples that a process receives at a time. They take about as long as the start of a process."""

_MAX_EVENTS: Final = 500


class Followed(NamedTuple):
    """The end of a sample.

    Attributes:
        rests: True if the sample comes to rest.
        seconds: Time of the end, s after the initial state.
        y: State at that time, 13 numbers.
        normal_B: Normal of the plane on which the body rests, body axes.
        strikes: The next strikes, as many as the tree still needs: times, s, contacts, and states after them.
    """

    rests: bool
    seconds: float
    y: Numbers
    normal_B: Vector3
    strikes: list[tuple[float, Touch, Numbers]]


class _Going(NamedTuple):
    """A sample to be simulated, which can be sent to a process.

    Attributes:
        settings: Settings of its simulation. ``flat_after`` is the number of strikes that the tree still
            needs.
        y: State from which it continues, 13 numbers.
        began: Time of that state, s after the initial state.
    """

    settings: TossSettings
    y: Numbers
    began: float


def check_processes(processes: Any) -> int | Executor:
    """Return ``processes`` if it is a whole number >= 1 or an executor, and raise an error otherwise."""
    from concurrent.futures import Executor

    if isinstance(processes, Executor):
        return processes
    try:
        return check_whole("processes", processes, 1)
    except InvalidFieldError:
        allowed = "a whole number >= 1, or an executor of concurrent.futures"
        raise InvalidFieldError("processes", processes, allowed) from None


def followed_to_rest(
    many: ManyStrikes,
    spread: LawSpread,
    *,
    law: RestitutionLaw,
    several_contacts_law: SeveralContactsLaw,
    horizon: float,
    processes: int | Executor,
) -> dict[int, Followed]:
    """Return the ends of all samples that have not reached the horizon, by sample number.

    Args:
        many: The samples and their strikes so far.
        spread: Scatter of the impact law.
        law: Law of restitution.
        several_contacts_law: Law for several contacts that strike at one instant.
        horizon: Duration of the simulation, s.
        processes: Number of processes, or an executor.
    """
    going = np.flatnonzero(many.now < horizon).tolist()
    began, states = many.now.tolist(), many.last.tolist()
    lacking = (many.corners < 0).sum(axis=0).tolist()
    tosses = []
    for i in going:
        settings = TossSettings(
            many.solid_of(i),
            law,
            several_contacts_law=several_contacts_law,
            horizon=horizon - began[i],
            max_events=_MAX_EVENTS,
            error=SAMPLED_PHASE_ERROR,
            kick=None if spread.is_none else spread.of_one(i),
            flat_after=lacking[i],
            thorough=False,
            has_pieces=False,
        )
        tosses.append(_Going(settings, states[i], began[i]))
    return dict(zip(going, _done(tosses, processes), strict=True))


def _done(tosses: list[_Going], processes: int | Executor) -> Iterable[Followed]:
    """Return the ends of samples, in their order."""
    if len(tosses) < 1.5 * PART or processes == 1:
        return map(_followed, tosses)
    if not isinstance(processes, int):
        return processes.map(_followed, tosses, chunksize=PART)
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    # A forked process would copy locks that threads of this process hold.
    count = min(processes, -(-len(tosses) // PART))
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        return list(pool.map(_followed, tosses, chunksize=PART))


def _followed(one: _Going) -> Followed:
    run = Simulation(one.settings, one.y)
    end = run.to_end()
    struck = [event for event in run.events if event.kind == TossEventKind.STRIKES]
    return Followed(
        rests=end == TossEnd.RESTS,
        seconds=one.began + run.now,
        y=run.y,
        normal_B=run.resting_normal_B(),
        strikes=[
            (one.began + event.seconds, event.touching[0], event.y)
            for event in struck[: one.settings.flat_after]
        ],
    )
