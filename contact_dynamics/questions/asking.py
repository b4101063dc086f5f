"""One function answers every kind of question."""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

from contact_dynamics.questions import contact_modes, impact, toss, tumbling
from contact_dynamics.questions.contact_mode_question import ContactModeQuestion
from contact_dynamics.questions.impact_question import ImpactQuestion
from contact_dynamics.questions.toss import TossQuestion
from contact_dynamics.questions.tumbling import TumblingQuestion

if TYPE_CHECKING:
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.context import Context
    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.questions.tumbling import TumblingAnswer


@overload
def ask(question: TumblingQuestion, context: Context | None = None) -> TumblingAnswer: ...
@overload
def ask(question: ImpactQuestion, context: Context | None = None) -> ImpactAnswer: ...
@overload
def ask(question: ContactModeQuestion, context: Context | None = None) -> ContactModeAnswer: ...
@overload
def ask(question: TossQuestion, context: Context | None = None) -> TossAnswer: ...
def ask(
    question: TumblingQuestion | ImpactQuestion | ContactModeQuestion | TossQuestion,
    context: Context | None = None,
) -> TumblingAnswer | ImpactAnswer | ContactModeAnswer | TossAnswer:
    """Answer a question, as the service of its kind does.

    Args:
        question: What is asked.
        context: What is known: bodies by name, surfaces, published states, defaults. If it is None, nothing
            is known but what the question says.

    Raises:
        ContactDynamicsError: something is asked for that is not known, not allowed or not supported. The
            message names it.
    """
    if isinstance(question, TumblingQuestion):
        return tumbling.answer(question, context)
    if isinstance(question, ImpactQuestion):
        return impact.answer(question, context)
    if isinstance(question, ContactModeQuestion):
        return contact_modes.answer(question, context)
    return toss.answer(question, context)
