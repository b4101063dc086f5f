"""This file lists the services: which question each answers, and the adapters on both sides of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol, TypeAlias, TypeVar

from contact_dynamics.questions import contact_modes, impact, many, many_contact_modes, toss, tumbling
from contact_dynamics_interfaces.srv import (
    PredictContactMode,
    PredictContactModeBatch,
    PredictImpact,
    PredictImpactBatch,
    PredictToss,
    PredictTumbling,
    PredictTumblingBatch,
)
from msg_adapters.batches import (
    impacts_answer_to_msg,
    impacts_question_from_msg,
    tumblings_answer_to_msg,
    tumblings_question_from_msg,
)
from msg_adapters.contact_mode import contact_mode_answer_to_msg
from msg_adapters.contact_mode_batch import contact_modes_answer_to_msg, contact_modes_question_from_msg
from msg_adapters.impact import impact_answer_to_msg
from msg_adapters.questions import (
    contact_mode_question_from_msg,
    impact_question_from_msg,
    tumbling_question_from_msg,
)
from msg_adapters.toss import toss_answer_to_msg, toss_question_from_msg
from msg_adapters.tumbling import tumbling_answer_to_msg

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.questions.knowledge import Knowledge
    from contact_dynamics.world import World
    from msg_adapters.status import Response

Request: TypeAlias = object
"""A message, of which only its adapter knows what it holds."""

Question = TypeVar("Question")
Answer = TypeVar("Answer")
Question_co = TypeVar("Question_co", covariant=True)
Answer_contra = TypeVar("Answer_contra", contravariant=True)


class ServiceType(Protocol):
    """What rosidl makes of a service's file."""

    Response: Callable[[], Response]
    Event: type


class FromMsg(Protocol[Question_co]):
    """Makes a question of a request."""

    def __call__(self, request: Request, /, *, world: World, world_frame: str) -> Question_co:
        """Return the question."""


class ToMsg(Protocol[Answer_contra]):
    """Makes a response of an answer."""

    def __call__(self, answer: Answer_contra, /, *, world_frame: str, into: Response) -> Response:
        """Return the response, which is the one to fill."""


class Elsewhere(Protocol):
    """Has questions answered that take long."""

    def __call__(
        self,
        answer: Callable[[Question, Knowledge], Answer],
        question: Question,
        knowledge: Knowledge,
        fill: Callable[[Answer], object],
    ) -> bool:
        """Have a question answered, and call ``fill`` with its answer later; return False if it is quick."""


class Serve(Protocol):
    """Answers a request."""

    def __call__(
        self,
        request: Request,
        response: Response,
        knowledge: Knowledge,
        *,
        world_frame: str,
        elsewhere: Elsewhere | None = None,
    ) -> bool:
        """Fill the response, or raise a `ContactDynamicsError` that says what is wrong with the request.

        Returns:
            Whether the response is filled. Otherwise it will be, when the answer comes from elsewhere.
        """


@dataclass(frozen=True, slots=True, kw_only=True)
class Service:
    """A service of the server.

    Attributes:
        service_type: Its type.
        name: Its name below the node's, which is that of its type as ROS writes names of topics.
        serve: Answers a request.
    """

    service_type: ServiceType
    name: str
    serve: Serve

    @property
    def type_name(self) -> str:
        """Return the name of its type."""
        return "".join(part.capitalize() for part in self.name.split("_"))


def _serving(
    from_msg: FromMsg[Question], answer: Callable[[Question, Knowledge], Answer], to_msg: ToMsg[Answer]
) -> Serve:
    """Return what takes a request the whole way: to a question, to its answer, to the response."""

    def serve(
        request: Request,
        response: Response,
        knowledge: Knowledge,
        *,
        world_frame: str,
        elsewhere: Elsewhere | None = None,
    ) -> bool:
        question = from_msg(request, world=knowledge.world, world_frame=world_frame)

        def fill(answered: Answer) -> None:
            to_msg(answered, world_frame=world_frame, into=response)

        if elsewhere is not None and elsewhere(answer, question, knowledge, fill):
            return False
        fill(answer(question, knowledge))
        return True

    return serve


SERVICES: Final = (
    Service(
        service_type=PredictContactMode,
        name="predict_contact_mode",
        serve=_serving(contact_mode_question_from_msg, contact_modes.answer, contact_mode_answer_to_msg),
    ),
    Service(
        service_type=PredictImpact,
        name="predict_impact",
        serve=_serving(impact_question_from_msg, impact.answer, impact_answer_to_msg),
    ),
    Service(
        service_type=PredictTumbling,
        name="predict_tumbling",
        serve=_serving(tumbling_question_from_msg, tumbling.answer, tumbling_answer_to_msg),
    ),
    Service(
        service_type=PredictToss,
        name="predict_toss",
        serve=_serving(toss_question_from_msg, toss.answer, toss_answer_to_msg),
    ),
    Service(
        service_type=PredictImpactBatch,
        name="predict_impact_batch",
        serve=_serving(impacts_question_from_msg, many.answer_impacts, impacts_answer_to_msg),
    ),
    Service(
        service_type=PredictTumblingBatch,
        name="predict_tumbling_batch",
        serve=_serving(tumblings_question_from_msg, many.answer_tumblings, tumblings_answer_to_msg),
    ),
    Service(
        service_type=PredictContactModeBatch,
        name="predict_contact_mode_batch",
        serve=_serving(
            contact_modes_question_from_msg, many_contact_modes.answer, contact_modes_answer_to_msg
        ),
    ),
)
