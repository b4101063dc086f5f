# SPDX-License-Identifier: Apache-2.0
"""Many states at once have the answers of as many single questions, to rounding."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from contact_dynamics import BodyState, ContactSet, RestitutionLaw
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.questions import AtTimes, Context, ImpactQuestion, TumblingQuestion, ask
from contact_dynamics.questions.effort import excerpt
from contact_dynamics.questions.many import MAX_STATES, ManyImpactsQuestion, ManyStates, ManyTumblingsQuestion
from message_values.shared import same
from questions.known_world import CUBE, WORLD

COUNT = 40
KNOWN = Context(world=WORLD)
NOTHING = np.zeros((0, 3))


def drawn(seed: int = 28) -> ManyStates:
    """States of a body that is thrown about."""
    draw = np.random.default_rng(seed)
    q = draw.normal(size=(COUNT, 4))
    return ManyStates(
        p_WB_W=draw.normal(size=(COUNT, 3)),
        q_WB=q / np.linalg.norm(q, axis=1)[:, None],
        v_WB_W=draw.normal(size=(COUNT, 3)),
        w_WB_W=10.0 * draw.normal(size=(COUNT, 3)),
    )


def single(states: ManyStates, i: int) -> BodyState:
    return BodyState(
        p_WB_W=states.p_WB_W[i], q_WB=states.q_WB[i], v_WB_W=states.v_WB_W[i], w_WB_W=states.w_WB_W[i]
    )


def test_many_tumblings_are_as_many_single_ones() -> None:
    states, seconds = drawn(), np.linspace(0.0, 2.0, COUNT)
    found = ask(ManyTumblingsQuestion(body="cube", states=states, seconds=seconds), KNOWN)
    for i in range(COUNT):
        question = TumblingQuestion(
            body="cube", state=single(states, i), sampling=AtTimes(times=[seconds[i]])
        )
        alone = ask(question, KNOWN).trajectory
        np.testing.assert_allclose(found.states.p_WB_W[i], alone.p_WB_W[0], rtol=0.0, atol=1e-14)
        assert abs(found.states.q_WB[i] @ alone.q_WB[0]) == pytest.approx(1.0, abs=1e-14)
        np.testing.assert_allclose(found.states.w_WB_W[i], alone.w_WB_W[0], rtol=0.0, atol=1e-13)


def test_a_worker_needs_no_published_states_for_a_batch() -> None:
    question = ManyTumblingsQuestion(body="cube", states=drawn(3), seconds=np.array([0.5]))
    assert same(ask(question, excerpt(question, KNOWN)), ask(question, KNOWN))


@pytest.mark.parametrize("law", RestitutionLaw)
def test_many_impacts_are_as_many_single_ones(law: RestitutionLaw) -> None:
    """And where the contact leaves, the single question says so and the batch counts it."""
    states = drawn()
    points = states.p_WB_W - [0.05, 0.02, 0.1]
    question = ManyImpactsQuestion(
        body="cube", states=states, p_WC_W=points, normals_W=np.array([[0.0, 0.0, 1.0]]),
        frictions=np.array([0.4]), restitutions=np.linspace(0.0, 1.0, COUNT), restitution_law=law,
    )  # fmt: skip
    found = ask(question, KNOWN)
    assert 5 < found.separates.sum() < COUNT - 5
    for i in range(COUNT):
        if found.separates[i]:
            np.testing.assert_array_equal(found.states.v_WB_W[i], states.v_WB_W[i])
            np.testing.assert_array_equal(found.impulses_W[i], np.zeros(3))
            continue
        contact = ContactSet(
            p_WC_W=points[i : i + 1], normals_W=[[0.0, 0.0, 1.0]], frictions=[0.4],
            restitutions=question.restitutions[i : i + 1],
        )  # fmt: skip
        alone = ask(
            ImpactQuestion(body="cube", state=single(states, i), contacts=contact, restitution_law=law), KNOWN
        ).impact
        assert ImpactOutcome(found.outcomes[i]) is alone.outcome
        # The lever, of 0.1 m from points up to 3 m away, is rounded otherwise on its way.
        np.testing.assert_allclose(found.states.v_WB_W[i], alone.state.v_WB_W, rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(found.impulses_W[i], alone.impulses_W[0], rtol=0.0, atol=1e-12)


def test_no_state_and_no_impact_are_answered() -> None:
    none = ManyStates(p_WB_W=NOTHING, q_WB=np.zeros((0, 4)), v_WB_W=NOTHING, w_WB_W=NOTHING)
    asked = ManyTumblingsQuestion(body=CUBE, states=none, seconds=np.array([0.5]))
    assert len(ask(asked).states) == 0
    up = drawn()
    up = replace(up, v_WB_W=np.tile([0.0, 0.0, 9.0], (COUNT, 1)), w_WB_W=np.zeros((COUNT, 3)))
    question = ManyImpactsQuestion(
        body=CUBE, states=up, p_WC_W=up.p_WB_W, normals_W=np.array([[0.0, 0.0, 1.0]]),
        frictions=np.array([0.4]), restitutions=np.array([0.0]),
    )  # fmt: skip
    assert ask(question).separates.all()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"frictions": np.ones(3)}, "frictions must be 40, or one for all.*, got 3 rows"),
        (
            {"normals_W": np.tile([0.0, 0.0, 1.0], (2, 1))},
            "normals_W must be 40, or one for all.*, got 2 rows",
        ),
        ({"p_WC_W": np.ones((2, 3))}, "p_WC_W must be .*, got shape"),
        ({"restitution_law": "newton"}, "restitution_law must be .* got 'newton'"),
    ],
)
def test_what_is_not_allowed_is_named(changes: dict[str, Any], words: str) -> None:
    fields: dict[str, Any] = {
        "p_WC_W": np.zeros((COUNT, 3)), "normals_W": np.array([[0.0, 0.0, 1.0]]),
        "frictions": np.array([0.4]), "restitutions": np.array([0.5]),
    }  # fmt: skip
    with pytest.raises(InvalidFieldError, match=words):
        ManyImpactsQuestion(body="cube", states=drawn(), **{**fields, **changes})


def test_more_states_than_are_answered_are_counted() -> None:
    rows = np.zeros((MAX_STATES + 1, 3))
    with pytest.raises(TooLargeError, match=r"states must be at most 10000.*, got 10001 states"):
        ManyStates(p_WB_W=rows, q_WB=np.zeros((MAX_STATES + 1, 4)), v_WB_W=rows, w_WB_W=rows)
