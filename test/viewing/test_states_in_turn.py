# SPDX-License-Identifier: Apache-2.0
"""States wait for their turn, are drawn as often as they may cost, and are there before an answer."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from contact_dynamics.questions import BodiesContactModeQuestion, ask
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.tumbling import free_motion
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.viewing.states_in_turn import (
    LONGEST_S,
    SHARE,
    SHORTEST_S,
    Pace,
    StatesInTurn,
    wait_after,
)
from contact_dynamics.world import World
from viewing.answers import tumbling_answer
from viewing.drawn import STAMP_NS, Canvas
from viewing.known import BODY, STATE, TWO_CONTACTS
from viewing.test_picture import an_impact

NAMES = ("brick", "ball", "rod")
POSE = "Transform3D:translation"


@pytest.fixture
def picture(canvas: Canvas) -> Picture:
    bodies = tuple(replace(BODY, name=name) for name in NAMES)
    return Picture(canvas.stream, World(bodies=bodies, surfaces=()), surface_side=1.0)


@pytest.fixture
def states(picture: Picture) -> StatesInTurn:
    return StatesInTurn(picture, guarded=lambda _, draw: draw())


def add(states: StatesInTurn, state: BodyState, *after_ns: int) -> None:
    for name in NAMES:
        for each in after_ns:
            states.add(name, replace(state, stamp_ns=STAMP_NS + each))


def test_all_are_drawn_by_their_stamps(canvas: Canvas, states: StatesInTurn) -> None:
    add(states, STATE, 3, 1, 2)
    assert states.count == 9
    states.draw()
    assert states.count == 0
    drawn = canvas.read()
    for name in NAMES:
        stamps = drawn.stamps(f"/world/bodies/{name}", POSE)
        assert [stamp - STAMP_NS for stamp in stamps] == [1, 2, 3]


def test_those_since_the_clock_was_set_back_are_drawn_after_the_others(
    picture: Picture, states: StatesInTurn
) -> None:
    back_ns = -60_000_000_000
    add(states, STATE, 1, 3, 2, back_ns + 5, back_ns, back_ns + 7, back_ns + 6)
    states.draw()
    assert states.count == 0
    assert picture.newest_stamp_ns() == STAMP_NS + back_ns + 7


def test_before_an_answer_only_what_it_needs_is_drawn(canvas: Canvas, states: StatesInTurn) -> None:
    add(states, STATE, 1, 2)
    states.draw_before(an_impact(STATE, TWO_CONTACTS, name="ball"))
    assert states.count == 4
    assert {name for name in NAMES if f"/world/bodies/{name}" in canvas.read().entities} == {"ball"}


def test_an_answer_about_several_bodies_needs_the_states_of_all(canvas: Canvas, states: StatesInTurn) -> None:
    add(states, STATE, 1, 2)
    question = BodiesContactModeQuestion(
        bodies=[replace(BODY, name=name) for name in ("ball", "rod")],
        states=[STATE, STATE],
        contacts=TWO_CONTACTS,
        pairs=[(0, None), (1, 0)],
    )
    states.draw_before(ask(question))
    assert states.count == 2
    assert {name for name in NAMES if f"/world/bodies/{name}" in canvas.read().entities} == {"ball", "rod"}


def test_an_answer_that_waited_has_no_states_before_it_that_came_after(
    canvas: Canvas, states: StatesInTurn
) -> None:
    for came_ns, after_ns in ((1000, 2), (1001, 1), (1003, 4), (1002, 3)):
        for name in NAMES:
            states.add(name, replace(STATE, stamp_ns=STAMP_NS + after_ns), came_ns=came_ns)
    states.draw_before(an_impact(STATE, TWO_CONTACTS, name="ball"), came_ns=1001)
    assert states.count == 10
    assert states.newest_stamp_ns() == STAMP_NS + 4
    stamps = canvas.read().stamps("/world/bodies/ball", POSE)
    assert [stamp - STAMP_NS for stamp in stamps] == [1, 2]


def test_curves_of_one_body_reach_to_those_of_the_next(
    canvas: Canvas, picture: Picture, states: StatesInTurn
) -> None:
    """The energy of a body is drawn up to the last state before the answer about another body."""
    short = free_motion(BODY.mass_properties, STATE).at([0.0, 1e-9])
    picture.show(tumbling_answer(STATE, short, body_name="brick"))
    add(states, STATE, 10, 20)
    answer = tumbling_answer(replace(STATE, stamp_ns=STAMP_NS + 30), short, body_name="ball")
    states.draw_before(answer)
    picture.show(answer)
    add(states, STATE, 40)
    states.draw()
    drawn = canvas.read()
    component = "Scalars:scalars"
    ns = {name: drawn.stamps(f"/energy/{name}/measured", component) for name in ("brick", "ball")}
    assert [stamp - STAMP_NS for stamp in ns["brick"]] == [10, 20]
    assert STAMP_NS + 40 in ns["ball"]


def test_states_that_wait_have_the_newest_stamp_too(picture: Picture, states: StatesInTurn) -> None:
    assert states.newest_stamp_ns() is None
    add(states, STATE, 5)
    assert states.newest_stamp_ns() == STAMP_NS + 5
    assert picture.newest_stamp_ns() is None
    states.draw()
    add(states, STATE, 7, 6)
    assert states.newest_stamp_ns() == STAMP_NS + 7
    assert picture.newest_stamp_ns() == STAMP_NS + 5


@pytest.mark.parametrize(
    ("took", "wait"),
    [
        (0.0, SHORTEST_S),
        (0.9 * SHARE * SHORTEST_S, SHORTEST_S),
        (SHARE * 0.2, 0.2),
        (1.1 * SHARE * LONGEST_S, LONGEST_S),
        (10.0, LONGEST_S),
    ],
)
def test_a_drawing_has_its_share_of_the_time(took: float, wait: float) -> None:
    assert wait_after(took) == pytest.approx(wait)


def test_a_dear_drawing_lets_the_next_wait() -> None:
    pace, begun = Pace(), time.monotonic()
    assert pace.is_due
    with pace.drawing():
        until = time.thread_time() + SHARE * 0.3
        while time.thread_time() < until:
            pass
    assert 0.3 <= pace.wait_s <= LONGEST_S
    was_due = pace.is_due
    assert not was_due or time.monotonic() > begun + 0.3 - SHORTEST_S  # the machine stood still
    time.sleep(pace.wait_s)
    assert pace.is_due


def test_a_drawing_that_fails_counts_too() -> None:
    pace = Pace()
    with pytest.raises(RuntimeError), pace.drawing():
        raise RuntimeError
    assert pace.wait_s == SHORTEST_S
