# SPDX-License-Identifier: Apache-2.0
"""How often recorded strikes are in their regions, the second one by the flight before it alone.

A strike is found in a recording where a flight follows it. Second strikes often have none: another corner
comes down soon after. Which ones have a flight depends on how the toss went, so that regions that are counted
on them alone are counted on a choice. The flight before the second strike is there after nearly every first
strike that is found. Where it would end is measured without anything that comes after.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from benchmarks._quotes import quote
from contact_dynamics.measured.flight_fit import FEWEST_FRAMES, fit_flight
from contact_dynamics.measured.flights import SPAN
from contact_dynamics.rotations.many import matrices_of, rotation_vectors
from contact_dynamics.toss import TossEventKind, toss

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.measured.flights import Strike
    from contact_dynamics.measured.motion import MeasuredMotion
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.toss import TossDistribution
    from contact_dynamics.toss.distribution import EventRegions, Region
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World

LATEST: Final = 0.3
"""s after the middle of the flight. No recorded cube flies so long between strikes."""


class Early(NamedTuple):
    """A toss as it is known early: a fitted state, its covariance, and its time by the recording's clock."""

    observed: Observed
    gravity_W: FloatArray  # (3,), m/s^2, as its own first flight shows it
    state: BodyState
    covariance: FloatArray
    by_gravity: tuple[float, float]
    seconds: float


class Arrival(NamedTuple):
    """When a flight arrives, s by the recording's clock, with which corner, and where it is then."""

    seconds: float
    corner: int
    state: BodyState


def strikes(early: list[Early], world: World, predicted: Callable[[Early], TossDistribution]) -> None:
    """Print how often the first and the second strike are in their regions."""
    held: dict[str, list[FloatArray]] = {}
    corners: dict[int, list[float]] = {1: [], 2: []}
    apart: list[float] = []
    brief = 0
    for one in early:
        told = predicted(one)
        found = _with_flights(one.observed)[: len(told.strikes)]
        corners[1] += [_chance(told, 1, strike.corner) for strike in found[:1]]
        for number, strike in enumerate(found, start=1):
            for name, region, value in _values(one, strike, told.strikes[number - 1], world):
                # What is known only where a flight follows counts apart from what is known of more tosses.
                key = f"{number}.{name}" if number == 1 or name in {"velocity", "spin"} else f"chosen.{name}"
                held.setdefault(key, []).append(region.holds([value])[0])
        if len(told.strikes) > 1 and _between(told) < SPAN:
            brief += 1
        elif len(told.strikes) > 1 and (arrival := second_arrival(one.observed, world, one.gravity_W)):
            for name, region, value in _before(one, arrival.seconds, arrival.state, told.strikes[1]):
                held.setdefault(f"2.{name}", []).append(region.holds([value])[0])
            corners[2].append(_chance(told, 2, arrival.corner))
            apart += [arrival.seconds - strike.time for strike in found[1:]]
    print(f"Shares of measured values in the regions of 50 and 90 %, from {len(early)} early states\n")
    _print_shares(held)
    off = 1e3 * float(np.sqrt(np.mean(np.square(apart))))
    print("\n'chosen' are the second strikes that a flight follows. Their times by the flights on both sides")
    print(f"differ from those by the flight before by {off:.1f} ms")
    print(f"{brief} tosses strike twice before a recording could show a flight")
    quote("tosses.chosen.apart", off, "ms")
    quote("tosses.brief", brief, digits=3)
    quote("tosses.count", len(early), "", digits=3)
    for number, shares in corners.items():
        print(f"\nstrike {number}: the corner that struck had {100 * np.mean(shares):.0f} % on average")
        quote(f"tosses.{number}.corner", 100.0 * float(np.mean(shares)), "%")


def _print_shares(held: dict[str, list[FloatArray]]) -> None:
    print(f"{'strike':16}  {'tosses':>6}  {'50 %':>5}  {'90 %':>5}")
    for key, rows in sorted(held.items()):
        half, most = 100.0 * np.mean(rows, axis=0)
        print(f"{key:16}  {len(rows):>6}  {half:5.0f}  {most:5.0f}")
        quote(f"tosses.{key}.half", half, "%")
        quote(f"tosses.{key}.most", most, "%")
        quote(f"tosses.{key}.count", len(rows), digits=3)


def _between(told: TossDistribution) -> float:
    """Return the mean time between the first strike and the second, s."""
    first, second = (float(each.seconds.mean[0]) for each in told.strikes[:2])
    return second - first


def _with_flights(observed: Observed) -> list[Strike]:
    """Return the first two strikes, as far as they are the first ones and flights follow them."""
    found: list[Strike] = []
    for strike, flight in zip(observed.strikes[:2], observed.flights, strict=False):
        if not flight.start <= strike.frames_before.start < flight.stop:
            break
        found.append(strike)
    return found


def _chance(told: TossDistribution, number: int, corner: int) -> float:
    return sum(b.probability for b in told.branches if (b.strike, b.corner) == (number, corner))


def _values(
    one: Early, strike: Strike, regions: EventRegions, world: World
) -> list[tuple[str, Region, FloatArray]]:
    time = strike.time
    moved = about_its_centre(one.observed.motion, world, one.gravity_W)
    before = fit_flight(moved, strike.frames_before).at(time).state
    after = fit_flight(moved, strike.frames_after, reference=strike.frames_after.start).at(time).state
    return [
        *_before(one, time, before, regions),
        ("velocity", regions.velocity, after.v_WB_W),
        ("spin", regions.spin, after.w_WB_W),
    ]


def _before(
    one: Early, time: float, state: BodyState, regions: EventRegions
) -> list[tuple[str, Region, FloatArray]]:
    """Return the time and the pose of a strike, with their regions."""
    return [
        ("time", regions.seconds, np.array([time - one.seconds])),
        ("place", regions.position, state.p_WB_W),
        ("attitude", regions.turn, rotation_vectors(state.q_WB[None], regions.q_WB)[0]),
    ]


def about_its_centre(motion: MeasuredMotion, world: World, gravity_W: FloatArray) -> MeasuredMotion:
    """Return a motion of the tracked origin as that of the world's body, under a gravity of its own."""
    body = world.bodies[0]
    return replace(
        motion,
        body=body,
        world=replace(motion.world, gravity_W=gravity_W),
        p_WB_W=motion.p_WB_W + matrices_of(motion.q_WB) @ body.p_FB_F,
    )


def second_arrival(observed: Observed, world: World, gravity_W: FloatArray) -> Arrival | None:
    """Return where the flight after the first strike arrives, or None if the recording has none.

    Its last frame is left out, since the body may touch in it.
    """
    strike, flights = observed.strikes[0], observed.flights
    after = next((each for each in flights if each.start <= strike.frames_after.start < each.stop), None)
    if after is None or after.stop - 1 - strike.frames_after.start < FEWEST_FRAMES:
        return None
    frames = slice(strike.frames_after.start, after.stop - 1)
    middle = (frames.start + frames.stop) // 2
    motion = about_its_centre(observed.motion, world, gravity_W)
    state = fit_flight(motion, frames, reference=middle).at(float(motion.times[middle])).state
    went = toss(
        world.bodies[0],
        state,
        replace(world, gravity_W=gravity_W),
        horizon=LATEST,
        max_events=1,
        max_alternatives=0,
    )
    if not went.events or went.events[0].kind != TossEventKind.STRIKES:
        return None
    event = went.events[0]
    return Arrival(float(motion.times[middle]) + event.seconds, event.corners[0], event.state)
