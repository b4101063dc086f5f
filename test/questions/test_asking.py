"""One call asks any question."""

from __future__ import annotations

from typing import Any

import pytest

from contact_dynamics.contact_modes import ModeVerdict
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.questions import ContactModeQuestion, ImpactQuestion, TumblingQuestion, ask
from questions.known_world import CONTEXT, CUBE, RESTING, below, state


def test_each_kind_is_answered() -> None:
    assert len(ask(TumblingQuestion(body=CUBE, state=state())).trajectory) == 201
    falling = ImpactQuestion(body=CUBE, state=state(v=(0.0, 0.0, -1.0)), contacts=below())
    assert ask(falling).seconds_to_contact == 0.0
    assert ask(ContactModeQuestion(body="cube", state=RESTING), CONTEXT).verdict is ModeVerdict.UNIQUE


def test_what_is_no_question_is_refused() -> None:
    nothing: Any = "where?"
    with pytest.raises(InvalidFieldError, match="question must be a TumblingQuestion or an Imp"):
        ask(nothing)
