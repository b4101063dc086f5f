# SPDX-License-Identifier: Apache-2.0
"""Events found in made motion whose truth is known: when, how many are missed, how many are invented."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from contact_dynamics.measured.events import EventKind, FoundEvent, find_events
from contact_dynamics.shapes import cylinder
from contact_dynamics.world import Body
from evaluation.made_motion import (
    BALL,
    BRICK,
    P_NOISE,
    Bounces,
    bounces,
    only_motion,
    recording_of,
    slide,
    world_of,
)
from oracles.bouncing_toss import RATE
from sweeps import seeds

SEEDS = range(5)


@cache
def bounced(seed: int) -> tuple[Bounces, list[FoundEvent]]:
    """A bouncing ball, and the events that are found of it."""
    made = bounces(seed=seed)
    return made, find_events(only_motion(made.recording))


def of_kind(events: list[FoundEvent], kind: EventKind) -> list[FoundEvent]:
    return [event for event in events if event.kind is kind]


@seeds(SEEDS, slow=range(5, 205))
def test_every_bounce_is_found_and_none_is_invented(seed: int) -> None:
    _, events = bounced(seed)
    counts = {kind: len(of_kind(events, kind)) for kind in EventKind}
    assert counts == {
        EventKind.FLIGHT: 4,
        EventKind.LANDING: 4,
        EventKind.IMPACT: 3,
        EventKind.REST: 1,
        EventKind.SLIDING: 0,
    }


def test_times_of_contacts_are_off_by_no_more_than_they_say() -> None:
    scores = []
    for seed in SEEDS:
        made, events = bounced(seed)
        landings = of_kind(events, EventKind.LANDING)
        for event, truth in zip(landings, made.strikes, strict=True):
            scores.append((event.time - truth) / event.time_std)
        # three are where two flights meet, the last is between two frames
        assert [event.time_std < 0.1 / RATE for event in landings] == [True, True, True, False]
    assert np.abs(scores).max() < 4.0
    assert 0.5 < np.std(scores) < 1.6


def test_velocities_after_an_impact_are_off_by_no_more_than_they_say() -> None:
    scores = []
    for seed in SEEDS:
        made, events = bounced(seed)
        impacts = of_kind(events, EventKind.IMPACT)
        for event, truth in zip(impacts, made.velocities_after, strict=True):
            fallen = truth[:3] - [0.0, 0.0, 9.81 * event.duration]
            scores.append((event.state.v_WB_W - fallen) / event.velocity_std)
            assert 0.0 <= event.duration < 2.0 / RATE
    assert np.abs(scores).max() < 5.0
    assert 0.6 < np.std(scores) < 1.4


def test_a_rest_begins_where_the_body_stops() -> None:
    for seed in SEEDS:
        made, events = bounced(seed)
        (rest,) = of_kind(events, EventKind.REST)
        # windows begin every quarter of their 50 ms; in the 10 ms before the stop it moves by a millimetre
        assert made.rest - 0.01 < rest.since < made.rest + 0.02
        assert rest.mode == "f"
        assert rest.surface == "floor"


@pytest.mark.parametrize("friction", [0.15, 0.3, 0.6])
def test_a_slide_is_found_from_landing_to_stop(friction: float) -> None:
    for seed in range(2):
        made = slide(friction=friction, seed=seed)
        events = find_events(only_motion(made.recording))
        (landing,) = of_kind(events, EventKind.LANDING)
        (sliding,) = of_kind(events, EventKind.SLIDING)
        (rest,) = of_kind(events, EventKind.REST)
        assert landing.time == pytest.approx(made.landing, abs=2.0 / RATE)
        assert of_kind(events, EventKind.IMPACT) == []
        assert made.landing - 1.0 / RATE <= sliding.since < made.landing + 0.03
        assert made.landing < sliding.time < made.stop
        assert sliding.mode == "cccc"
        # the windows at the end of the slide count as rest once they are as slow as noise and MODE_SPEED
        assert made.stop - 0.06 < rest.since < made.stop + 0.03
        assert rest.mode == "ffff"


def test_a_body_that_is_carried_has_no_events() -> None:
    """A hand moves it above the floor, faster and slower; nothing falls, touches or rests."""
    times = np.arange(480) / RATE
    p = np.column_stack([0.5 * np.sin(3.0 * times), 0.2 * times, 0.8 + 0.1 * np.cos(5.0 * times)])
    q = np.tile([0.0, 0.0, 0.0, 1.0], (len(times), 1))
    recording = recording_of(BRICK, world_of(BRICK), times, p, q)
    assert find_events(only_motion(recording)) == []


def test_a_catch_in_the_air_is_a_flight_without_a_landing() -> None:
    times = np.arange(120) / RATE
    height = np.where(times < 0.3, 2.0 - 0.5 * 9.81 * times**2, 2.0 - 0.5 * 9.81 * 0.3**2)
    p = np.column_stack([np.zeros_like(times), np.zeros_like(times), height])
    q = np.tile([0.0, 0.0, 0.0, 1.0], (len(times), 1))
    recording = recording_of(BALL, world_of(BALL), times, p, q)
    assert [event.kind for event in find_events(only_motion(recording))] == [EventKind.FLIGHT]


def test_a_cylinder_rests_on_its_rim() -> None:
    """It has no corners; nothing but the noise moves it."""
    random = np.random.default_rng(3)
    times = np.arange(48) / RATE
    p = [0.1, 0.2, 0.05] + P_NOISE * random.standard_normal((len(times), 3))
    q = np.tile([0.0, 0.0, 0.0, 1.0], (len(times), 1))
    can = Body(name="can", mass_properties=BRICK.mass_properties, shape=cylinder(radius=0.04, length=0.1))
    (event,) = find_events(only_motion(recording_of(can, world_of(can), times, p, q)))
    assert event.kind is EventKind.REST
    assert set(event.mode) == {"f"}
    assert event.since == times[0]


def test_a_rolling_ball_neither_rests_nor_slides() -> None:
    times = np.arange(240) / RATE
    angle = 2.0 * times
    p = np.column_stack([0.08 * angle, np.zeros_like(times), np.full_like(times, 0.08)])
    q = np.column_stack(
        [np.zeros_like(times), np.sin(0.5 * angle), np.zeros_like(times), np.cos(0.5 * angle)]
    )
    recording = recording_of(BALL, world_of(BALL), times, p, q)
    assert find_events(only_motion(recording)) == []
