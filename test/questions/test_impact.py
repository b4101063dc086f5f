# SPDX-License-Identifier: Apache-2.0
"""Questions about impacts, asked in Python, beside what momentum and the laws of restitution say."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.errors import (
    InvalidFieldError,
    NoContactError,
    NotSupportedError,
    OutOfPlaneError,
    SeparatingContactError,
)
from contact_dynamics.impact import ImpactOutcome, SequenceEnd, SeveralContactsLaw
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import (
    Context,
    ImpactQuestion,
    InTime,
    Problem,
    PublishedState,
    StateStore,
    UncertainState,
)
from contact_dynamics.questions.effort import excerpt
from contact_dynamics.questions.impact import answer
from contact_dynamics.tumbling import free_motion
from questions.known_world import (
    CONTEXT,
    CUBE,
    FRICTION,
    GRAVITY,
    MASS,
    MOMENT,
    RESTITUTION,
    SIDE,
    WORLD,
    below,
    state,
)

ROUNDING = 1e-12  # a few operations on numbers of order 1 to 10
HALF = 0.5 * SIDE
SLIDING = state(v=(5.0, 0.0, -1.0))  # fast enough to slide throughout
HINT = "does the normal point into the first body"
TWO_FEET = ContactSet(
    p_WC_W=[[-HALF, 0, 1 - HALF], [HALF, 0, 1 - HALF]], normals_W=[0, 0, 1], frictions=0, restitutions=0
)


def test_a_body_a_state_and_contacts_are_enough() -> None:
    """Straight below the centre the normal impulse is m (1 + e) v, and friction is mu times it."""
    found = answer(ImpactQuestion(body=CUBE, state=SLIDING, contacts=below()))
    normal = MASS * (1.0 + RESTITUTION)
    expected = [-FRICTION * normal, 0.0, normal]
    np.testing.assert_allclose(found.impact.impulses_W, [expected], rtol=0.0, atol=ROUNDING)
    assert found.impact.outcome is ImpactOutcome.SLIDES
    np.testing.assert_allclose(
        found.impact.state.v_WB_W, [5.0 - FRICTION * normal / MASS, 0.0, RESTITUTION], rtol=0.0, atol=ROUNDING
    )
    spin = FRICTION * normal * HALF / MOMENT
    np.testing.assert_allclose(found.impact.state.w_WB_W, [0.0, spin, 0.0], rtol=0.0, atol=1e-11)
    before = 0.5 * MASS * 26.0
    assert found.impact.kinetic_energy_before == pytest.approx(before, rel=1e-14)
    after = 0.5 * MASS * (found.impact.state.v_WB_W @ found.impact.state.v_WB_W) + 0.5 * MOMENT * spin**2
    assert found.impact.kinetic_energy_after == pytest.approx(after, rel=1e-12)
    assert not found.impact.creates_energy
    assert (found.problem, found.plane, found.other, found.seconds_to_contact) == (
        Problem.SPATIAL,
        None,
        None,
        0.0,
    )


def test_the_plane_says_what_space_says() -> None:
    question = ImpactQuestion(body=CUBE, state=SLIDING, contacts=below())
    space = answer(question).impact
    found = answer(replace(question, problem=Problem.PLANAR))
    assert found.plane is not None
    assert abs(found.plane.normal_W[1]) == pytest.approx(1.0)
    for name in ("impulses_W", "compression_impulses_W", "velocities_before_W", "velocities_after_W"):
        np.testing.assert_allclose(getattr(found.impact, name), getattr(space, name), rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(found.impact.state.w_WB_W, space.state.w_WB_W, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(found.impact.path_W[-1], space.path_W[-1], rtol=0.0, atol=1e-11)
    assert found.impact.path_events[0] is space.path_events[0]
    assert found.impact.kinetic_energy_after == pytest.approx(space.kinetic_energy_after, rel=1e-12)


def test_a_body_in_flight_lands_first() -> None:
    found = answer(ImpactQuestion(body="cube", state=state(), horizon=1.0), CONTEXT)
    seconds = math.sqrt(2.0 * (1.0 - HALF) / GRAVITY)
    assert found.seconds_to_contact == pytest.approx(seconds, abs=ROUNDING)
    assert found.state.v_WB_W[2] == pytest.approx(-GRAVITY * seconds, abs=1e-11)
    assert found.contacts.surfaces == ("floor",) * 4
    assert found.impact.outcome is not None
    with pytest.raises(NoContactError, match=r"touches no surface within the horizon of 0\.1 s"):
        answer(ImpactQuestion(body="cube", state=state(), horizon=0.1), CONTEXT)


@pytest.mark.parametrize("times", [(40, 50), (30, 36, 50), (20, 30)], ids=["at", "between", "before"])
def test_the_newest_state_of_a_second_body_is_that_at_the_time_of_the_first(times: tuple[int, ...]) -> None:
    """It falls freely. A worker, which has only an excerpt of the states, uses the same."""
    lid, thrown = replace(CUBE, name="lid"), state(1.0 - SIDE, v=(0.0, 0.0, 1.0))
    store, motion = StateStore(history=1.0, timeout=0.5), free_motion(CUBE, thrown)
    for ms in times:
        store.add("lid", replace(motion.state_at(1e-3 * ms), stamp_ns=ms * 10**6))
    first = state(v=(0.0, 0.0, -2.0), stamp_ns=40 * 10**6)
    store.add("cube", first)
    known = Context(world=replace(WORLD, bodies=(CUBE, lid)), states=store)
    question = ImpactQuestion(body="cube", state=first, other="lid", contacts=below())
    published = replace(question, state=PublishedState())
    for asked, context in ((question, known), (published, known), (published, excerpt(published, known))):
        other = answer(asked, context).other
        assert other is not None
        assert other.state.stamp_ns == 40 * 10**6
        np.testing.assert_allclose(other.state.p_WB_W, motion.state_at(0.04).p_WB_W, rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(other.state.v_WB_W, motion.state_at(0.04).v_WB_W, rtol=0.0, atol=1e-12)


def test_two_feet_at_once_or_in_turn() -> None:
    """Without restitution and friction both feet stop the fall together. In turn, orders differ."""
    question = ImpactQuestion(body=CUBE, state=state(v=(0.0, 0.0, -1.0)), contacts=TWO_FEET)
    at_once = replace(question, several_contacts_law=SeveralContactsLaw.SIMULTANEOUS)
    found = answer(at_once).impact
    np.testing.assert_allclose(found.impulses_W[:, 2], [0.5 * MASS, 0.5 * MASS], rtol=0.0, atol=1e-9)
    assert (found.outcome, len(found.path_W), len(found.compression_impulses_W)) == (None, 0, 0)
    in_turn = answer(replace(question, include_orders=True)).impact
    assert in_turn.outcome is not None
    assert in_turn.path_W.shape == (len(in_turn.path_events), 3)
    assert in_turn.orders[0] == ()  # both feet tie, and strike as one
    assert {order[0] for order in in_turn.orders[1:]} == {0, 1}
    assert in_turn.order_velocities_W.shape == (len(in_turn.orders), 6)
    assert in_turn.impulses_W[:, 2].sum() == pytest.approx(MASS, abs=1e-6)


def test_strikes_in_time_begin_at_the_first() -> None:
    """A plate that lands on one edge rocks over to the other within milliseconds."""
    tilted = state(v=(0.0, 0.0, -1.0), w=(0.0, 0.4, 0.0))
    law = InTime(strike_window=0.05, max_strikes=20)
    found = answer(ImpactQuestion(body="cube", state=tilted, several_contacts_law=law), CONTEXT)
    strikes = found.impact.strikes
    assert len(strikes) > 1
    assert strikes[0].seconds == 0.0
    assert list(np.diff([strike.seconds for strike in strikes]) >= 0.0) == [True] * (len(strikes) - 1)
    np.testing.assert_array_equal(strikes[0].state_before.p_WB_W, found.state.p_WB_W)
    np.testing.assert_array_equal(strikes[-1].state_after.v_WB_W, found.impact.state.v_WB_W)
    total = sum(strike.impulse_W for strike in strikes)
    np.testing.assert_allclose(found.impact.impulses_W.sum(axis=0), total, rtol=0.0, atol=ROUNDING)
    assert found.impact.end in SequenceEnd
    assert {strike.contact for strike in strikes} <= set(range(len(found.contacts)))


def test_an_uncertain_landing_carries_its_covariance_to_the_strike() -> None:
    tilted = replace(state(), q_WB=[0, math.sin(0.3), 0, math.cos(0.3)], w_WB_W=[3.0, 0, 0])
    uncertain = UncertainState(state=tilted, covariance=np.diag([1e-6] * 6 + [1e-4] * 3 + [1e-2] * 3))
    found = answer(ImpactQuestion(body="cube", state=uncertain, include_covariance=True), CONTEXT)
    assert found.seconds_to_contact > 0.0
    impact = found.impact
    assert impact.outcome_probabilities is not None
    assert impact.outcome_probabilities.sum() + impact.miss_probability == pytest.approx(1.0, abs=ROUNDING)
    assert impact.outcome is not None
    assert impact.outcome_probabilities[impact.outcome] > 0.0
    assert impact.covariance is not None
    np.testing.assert_allclose(impact.covariance, impact.covariance.T, rtol=0.0, atol=1e-15)
    assert np.linalg.eigvalsh(impact.covariance).min() > -ROUNDING


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"state": state(v=(0.0, 0.0, 1.0))}, SeparatingContactError, rf"{HINT}.*v_n = 1 m/s"),
        (
            {"contacts": below().subset([0, 0]), "state": state(v=(0.0, 0.0, 1.0))},
            SeparatingContactError,
            rf"{HINT}.*v_n >= 1 m/s at every contact",
        ),
        ({"contacts": below().subset([])}, NoContactError, "contacts must be .*, got none"),
        (
            {"other": CUBE, "other_state": SLIDING, "include_orders": True},
            NotSupportedError,
            "with a second body",
        ),
        (
            {"other": CUBE, "other_state": SLIDING, "contacts": None},
            NotSupportedError,
            "of two bodies must be given",
        ),
        (
            {"several_contacts_law": InTime(), "problem": Problem.PLANAR},
            NotSupportedError,
            "problem must be SPATIAL",
        ),
        ({"include_covariance": True}, InvalidFieldError, r"state\.covariance must be .*, got none"),
        (
            {
                "problem": Problem.PLANAR,
                "plane": PlaneOfMotion(normal_W=[0, -1, 0]),
                "state": state(v=(0.0, 0.5, -1.0)),
            },
            OutOfPlaneError,
            "state must be .*, got 0.5 m/s out of the plane",
        ),
        (
            {"several_contacts_law": InTime(strike_window=1e-6), "state": state(v=(0.0, 0.0, 1.0))},
            SeparatingContactError,
            f"{HINT}.*none that strikes",
        ),
    ],
)
def test_what_cannot_be_answered_is_named(
    change: dict[str, object], error: type[Exception], words: str
) -> None:
    question = replace(ImpactQuestion(body=CUBE, state=SLIDING, contacts=below()), **change)  # type: ignore[arg-type]
    with pytest.raises(error, match=words):
        answer(question, Context())


@pytest.mark.parametrize(
    ("fields", "condition"),
    [
        ({"other_state": SLIDING}, "other is given"),
        ({"horizon": 1.0, "contacts": below()}, "contacts are detected"),
        ({"plane": PlaneOfMotion(normal_W=[0, -1, 0])}, "problem is PLANAR"),
        ({"out_of_plane_tolerance": 1e-3, "problem": Problem.SPATIAL}, "problem is PLANAR"),
    ],
)
def test_a_value_that_would_be_ignored_is_an_error(fields: dict[str, Any], condition: str) -> None:
    name = next(iter(fields))
    with pytest.raises(InvalidFieldError, match=f"^{name} must be left out unless {condition}, got"):
        ImpactQuestion(body=CUBE, state=SLIDING, **fields)
