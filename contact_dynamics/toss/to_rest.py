"""Samples of a toss that go on to rest, each as a toss does, in blocks that several processes can share.

The samples of a block have their flights, impacts and steps done in arrays (`together`). How arrays round can
depend on their length, so which samples make a block depends on nothing but how many there are. The numbers
are then those of one process, however many share the work.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.numerics.vectors import norm
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.shapes.convex import ConvexShape
from contact_dynamics.tolerances import SAMPLED_PHASE_ERROR
from contact_dynamics.toss.following import Following, Run
from contact_dynamics.toss.result import TossEnd, TossEventKind
from contact_dynamics.toss.solid import as_rows
from contact_dynamics.toss.together import together
from contact_dynamics.toss.uncertainty import Samples
from contact_dynamics.validation import check_whole

if TYPE_CHECKING:
    from collections.abc import Iterator
    from concurrent.futures import Executor

    from contact_dynamics.impact.law import RestitutionLaw
    from contact_dynamics.impact.several.result import SeveralContactsLaw
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.law_spread import KickOfOne, LawSpread
    from contact_dynamics.toss.solid import Numbers, Solid, Touch
    from contact_dynamics.toss.strikes_of_many import ManyStrikes
    from contact_dynamics.validation import FloatArray

BLOCK: Final = 250
"""About so many samples make a block. Blocks of half the size take a tenth longer in all."""

_MAX_EVENTS: Final = 500


class Followed(NamedTuple):
    """How a sample goes on.

    Attributes:
        rests: Whether it comes to rest.
        seconds: s after the first state, when it ends.
        y: The 13 numbers of its state then.
        normal_B: The normal of the flat on which it rests, body axes.
        strikes: Its first strikes from here on, as many as the tree lacks: times, s, contacts and the states
            after them.
    """

    rests: bool
    seconds: float
    y: Numbers
    normal_B: Vector3
    strikes: list[tuple[float, Touch, Numbers]]


class _Block(NamedTuple):
    """Samples that go on together, as they are handed to a process.

    Attributes:
        solid: What they have in common.
        samples: What differs between them.
        now: (n,), s, the times of their states.
        states: (n, 13), their states.
        lacking: (n,), how many strikes the tree lacks.
        kicks: What the law's own spread does to each of them, or None.
        law: What the coefficients of restitution mean.
        several_contacts_law: The law for several contacts that strike at one instant.
        horizon: s, how far they are followed.
    """

    solid: Solid
    samples: Samples
    now: FloatArray
    states: FloatArray
    lacking: list[int]
    kicks: list[KickOfOne | None]
    law: RestitutionLaw
    several_contacts_law: SeveralContactsLaw
    horizon: float


def check_processes(processes: Any) -> int | Executor:
    """Return a number of processes, or an executor, as they are."""
    from concurrent.futures import Executor

    if isinstance(processes, Executor):
        return processes
    try:
        return check_whole("processes", processes, 1)
    except InvalidFieldError:
        allowed = "a whole number >= 1, or an executor of concurrent.futures"
        raise InvalidFieldError("processes", processes, allowed) from None


def followed_to_rest(
    solid: Solid,
    samples: Samples,
    told: ManyStrikes,
    spread: LawSpread,
    *,
    law: RestitutionLaw,
    several_contacts_law: SeveralContactsLaw,
    horizon: float,
    processes: int | Executor,
) -> dict[int, Followed]:
    """Return how samples go on after their strikes in arrays, by their numbers, if they are not over.

    Args:
        solid: The body and the flats.
        samples: What differs between samples.
        told: The strikes up to where they go on.
        spread: The law's own spread.
        law: What the coefficients of restitution mean.
        several_contacts_law: The law for several contacts that strike at one instant.
        horizon: s, how far they are followed.
        processes: How many processes share the work, or an executor.
    """
    going = np.flatnonzero(told.now < horizon)
    if len(going) == 0:
        return {}
    states = np.hstack(told.last)
    strikes = (told.corners >= 0).sum(axis=0)
    blocks = [
        _Block(
            solid=solid,
            samples=Samples(*(rows[which] for rows in samples)),
            now=told.now[which],
            states=states[which],
            lacking=(len(told.seconds) - strikes[which]).tolist(),
            kicks=[None if spread.is_none else spread.of_one(i) for i in which.tolist()],
            law=law,
            several_contacts_law=several_contacts_law,
            horizon=horizon,
        )
        for which in np.array_split(going, max(round(len(going) / BLOCK), 1))
    ]
    done = (one for block in _done(blocks, processes) for one in block)
    return dict(zip(going.tolist(), done, strict=True))


def _done(blocks: list[_Block], processes: int | Executor) -> Iterator[list[Followed]]:
    """Return what becomes of blocks, in their order."""
    if len(blocks) == 1 or processes == 1:
        yield from map(_block_followed, blocks)
    elif isinstance(processes, int):
        from concurrent.futures import ProcessPoolExecutor
        from multiprocessing import get_context

        # Spawned: a fork would copy the locks of this process's threads.
        context = get_context("spawn")
        with ProcessPoolExecutor(min(processes, len(blocks)), mp_context=context) as pool:
            yield from pool.map(_block_followed, blocks)
    else:
        yield from processes.map(_block_followed, blocks)


def _block_followed(block: _Block) -> list[Followed]:
    runs = [_begun(block, i) for i in range(len(block.now))]
    together([run.go() for run in runs])
    return [
        _followed(run, now, lacking)
        for run, now, lacking in zip(runs, block.now.tolist(), block.lacking, strict=True)
    ]


def _followed(run: Run, began: float, lacking: int) -> Followed:
    struck = [event for event in run.events if event.kind == TossEventKind.STRIKES]
    return Followed(
        rests=run.end == TossEnd.RESTS,
        seconds=began + run.now,
        y=run.y,
        normal_B=run.resting_normal_B(),
        strikes=[(began + event.seconds, event.touching[0], event.y) for event in struck[:lacking]],
    )


def _begun(block: _Block, i: int) -> Run:
    """Return the toss that one sample goes on with."""
    solid, samples = block.solid, block.samples
    inertia, corners = samples.inertias_B[i], samples.corners_B[i]
    flats = tuple(
        flat._replace(friction=mu, restitution=e, strike_friction=struck)
        for flat, mu, e, struck in zip(
            solid.flats,
            samples.lasting_frictions[i].tolist(),
            samples.restitutions[i].tolist(),
            samples.frictions[i].tolist(),
            strict=True,
        )
    )
    points = tuple((x, y, z) for x, y, z in corners.tolist())
    mine = solid._replace(
        inertia=as_rows(inertia.tolist()),
        inverse=as_rows(np.linalg.inv(inertia).tolist()),
        corners=points,
        reach=max(map(norm, points)) + solid.rounding,
        flats=flats,
    )
    p, q, v, w = np.split(block.states[i], [3, 7, 10])
    state = BodyState(p_WB_W=p, q_WB=q / np.linalg.norm(q), v_WB_W=v, w_WB_W=w)
    following = Following(
        mine,
        MassProperties(mass=solid.mass, I_B=inertia),
        ConvexShape(vertices=corners, rounding=solid.rounding),
        block.law,
        several_contacts_law=block.several_contacts_law,
        horizon=block.horizon - float(block.now[i]),
        max_events=_MAX_EVENTS,
        error=SAMPLED_PHASE_ERROR,
        kick=block.kicks[i],
        flat_after=block.lacking[i],
        thorough=False,
        has_pieces=False,
    )
    return Run(following, state, ())
