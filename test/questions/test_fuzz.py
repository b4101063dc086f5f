# SPDX-License-Identifier: Apache-2.0
"""Whatever is asked, the answer is one, or an error of this package that says what is wrong."""

from __future__ import annotations

import contextlib
import warnings
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.questions import TossQuestion, ask
from questions import fuzzed

CONTEXT = fuzzed.context()
FLATS = fuzzed.knowledge_of_flats()
KINDS = (
    fuzzed.tumbling_questions,
    fuzzed.impact_questions,
    fuzzed.contact_mode_questions,
    fuzzed.bodies_contact_mode_questions,
    fuzzed.many_tumblings_questions,
    fuzzed.many_impacts_questions,
    fuzzed.many_contact_modes_questions,
    fuzzed.toss_questions,
)
CASES = 10_000


@st.composite
def questions(draw: st.DrawFn) -> Any:
    """Return a question of any kind; None where one of its constructors refuses, which they may."""
    try:
        return draw(draw(st.sampled_from(KINDS))())
    except ContactDynamicsError:
        return None


def check_answered(question: Any) -> None:
    """Any other exception than the package's own fails the test."""
    if question is None:
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # numbers that overflow are not hidden in an answer
        with contextlib.suppress(ContactDynamicsError):
            ask(question, FLATS if isinstance(question, TossQuestion) else CONTEXT)


HASTE = settings(
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.large_base_example],
)


@settings(HASTE, max_examples=60)
@given(questions())
def test_any_question_is_answered_or_refused_by_name(question: Any) -> None:
    check_answered(question)


@pytest.mark.slow
@settings(HASTE, max_examples=CASES)
@given(questions())
def test_ten_thousand_questions_are_answered_or_refused_by_name(question: Any) -> None:
    check_answered(question)
