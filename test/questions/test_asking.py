# SPDX-License-Identifier: Apache-2.0
"""One call asks any question."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from contact_dynamics.contact_modes import ModeVerdict
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.questions import AtTimes, ContactModeQuestion, ImpactQuestion, TumblingQuestion, ask
from contact_dynamics.questions.many import ManyStates, ManyTumblingsQuestion
from questions.known_world import CONTEXT, CUBE, RESTING, below, state


def test_each_kind_is_answered() -> None:
    assert len(ask(TumblingQuestion(body=CUBE, state=state())).trajectory) == 201
    falling = ImpactQuestion(body=CUBE, state=state(v=(0.0, 0.0, -1.0)), contacts=below())
    assert ask(falling).seconds_to_contact == 0.0
    assert ask(ContactModeQuestion(body="cube", state=RESTING), CONTEXT).verdict is ModeVerdict.UNIQUE


def test_questions_about_many_states_are_answered_too() -> None:
    at = state()
    states = ManyStates(p_WB_W=[at.p_WB_W], q_WB=[at.q_WB], v_WB_W=[at.v_WB_W], w_WB_W=[at.w_WB_W])
    found = ask(ManyTumblingsQuestion(body=CUBE, states=states, seconds=np.array([0.1])))
    one = ask(TumblingQuestion(body=CUBE, state=at, sampling=AtTimes(times=[0.1]))).trajectory
    np.testing.assert_allclose(found.states.p_WB_W, one.p_WB_W, atol=1e-12)  # rounding of positions of 1 m


def test_what_is_no_question_is_refused() -> None:
    nothing: Any = "where?"
    with pytest.raises(InvalidFieldError, match="question must be a TumblingQuestion or an Imp"):
        ask(nothing)
