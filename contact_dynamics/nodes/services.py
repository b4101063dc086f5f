"""Each service has one record: what it is asked, what answers, how answers are read, drawn and listed.

The server, the visualizer, replay, tables and plots take what they need from here, so that a service is added
in one place. Functions are named by their place and imported when they are needed: the server imports no
viewer, and a log is checked before there are classes of its messages.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Final, Generic, Protocol, TypeAlias, TypeVar

from contact_dynamics.diagrams.words import (
    CONTACT_MODES,
    IMPACT,
    MANY_CONTACT_MODES,
    MANY_IMPACTS,
    MANY_TUMBLINGS,
    TOSS,
    TUMBLING,
)
from contact_dynamics.errors import NotSupportedError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from contact_dynamics.questions.contact_mode_question import ContactModeQuestion
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.context import Context
    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.questions.impact_question import ImpactQuestion
    from contact_dynamics.questions.many import (
        ManyImpactsAnswer,
        ManyImpactsQuestion,
        ManyTumblingsAnswer,
        ManyTumblingsQuestion,
    )
    from contact_dynamics.questions.many_contact_modes import ManyContactModesAnswer, ManyContactModesQuestion
    from contact_dynamics.questions.toss import TossAnswer, TossQuestion
    from contact_dynamics.questions.tumbling import TumblingAnswer, TumblingQuestion
    from contact_dynamics.rigid_body.body import BodyState
    from msg_adapters.status import Response

Request: TypeAlias = object
"""A message, of which only its adapter knows what it holds."""

Question: TypeAlias = (
    "ContactModeQuestion | ImpactQuestion | TumblingQuestion | TossQuestion"
    " | ManyImpactsQuestion | ManyTumblingsQuestion | ManyContactModesQuestion"
)
Answer: TypeAlias = (
    "ContactModeAnswer | ImpactAnswer | TumblingAnswer | TossAnswer"
    " | ManyImpactsAnswer | ManyTumblingsAnswer | ManyContactModesAnswer"
)
Result = TypeVar("Result")


class ServiceType(Protocol):
    """What rosidl makes of a service's file."""

    Request: Callable[[], object]
    Response: Callable[[], Response]
    Event: type


class Elsewhere(Protocol):
    """Has questions answered that take long."""

    def __call__(
        self,
        answer: Callable[[Question, Context], Answer],
        question: Question,
        context: Context,
        fill: Callable[[Answer], object],
    ) -> bool:
        """Have a question answered, and call ``fill`` with its answer later; return False if it is quick."""


class ImportedOnUse(Generic[Result]):
    """A function that is imported when it is used first."""

    def __init__(self, place: str) -> None:
        """Name it, as "package.module:function" or "package.module:Class.function"."""
        self.place = place

    @cached_property
    def function(self) -> Callable[..., Result]:
        """The function itself."""
        module, _, name = self.place.partition(":")
        found = import_module(module)
        for part in name.split("."):
            found = getattr(found, part)
        return found  # type: ignore[return-value]

    def __call__(self, *args: object, **options: object) -> Result:
        """Call the function."""
        return self.function(*args, **options)


@dataclass(frozen=True, slots=True, kw_only=True)
class Service:
    """A service of the server, and all that is known about it.

    Attributes:
        type_name: The name of its type, "PredictImpact".
        kind: The kind of its answers, in words.
        digest: The digest of its fields (`replay.same_definitions`). A test compares it with the interface.
        question_from_msg: Makes a question of a request.
        answer: Answers a question; a function that a worker imports.
        answer_to_msg: Makes a response of an answer.
        answer_from_msg: Makes an answer of a response.
        draw: Draws an answer; a method of `viewing.picture.Picture`.
        rows: Makes the cells of an answer for a table, as `replay.answer_rows` says.
        predicted: Returns the state that an answer predicts, which may be measured later. It is None if an
            answer predicts none, or none at a time of its own.
    """

    type_name: str
    kind: str
    digest: str
    question_from_msg: ImportedOnUse[Question]
    answer: ImportedOnUse[Answer]
    answer_to_msg: ImportedOnUse[Response]
    answer_from_msg: ImportedOnUse[Answer]
    draw: ImportedOnUse[None]
    rows: ImportedOnUse[Iterator[dict[str, str | int | float | None]]]
    predicted: ImportedOnUse[BodyState | None] | None

    @property
    def name(self) -> str:
        """Its name below the node's, which is that of its type as ROS writes names of topics."""
        return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", self.type_name).lower()

    @property
    def service_type(self) -> ServiceType:
        """The class that rosidl makes of its file."""
        found: ServiceType = getattr(import_module("contact_dynamics_interfaces.srv"), self.type_name)
        return found

    def prepare(self) -> None:
        """Import what answers a request, so that the first one does not wait for it."""
        for each in (self.question_from_msg, self.answer, self.answer_to_msg):
            each.function  # noqa: B018  it is imported by that

    def serve(
        self,
        request: Request,
        response: Response,
        context: Context,
        *,
        world_frame: str,
        elsewhere: Elsewhere | None = None,
    ) -> bool:
        """Fill the response, or raise a `ContactDynamicsError` that says what is wrong with the request.

        Returns:
            Whether the response is filled. Otherwise it will be, when the answer comes from elsewhere.
        """
        question = self.question_from_msg(request, world=context.world, world_frame=world_frame)

        def fill(answered: Answer) -> None:
            self.answer_to_msg(answered, world_frame=world_frame, into=response)

        if elsewhere is not None and elsewhere(self.answer.function, question, context, fill):
            return False
        fill(self.answer(question, context))
        return True


SERVICES: Final = (
    Service(
        type_name="PredictContactMode",
        kind=CONTACT_MODES,
        digest="c01e2bc54d5ecf14",
        question_from_msg=ImportedOnUse("msg_adapters.questions:contact_mode_question_from_msg"),
        answer=ImportedOnUse("contact_dynamics.questions.contact_modes:answer"),
        answer_to_msg=ImportedOnUse("msg_adapters.contact_mode:contact_mode_answer_to_msg"),
        answer_from_msg=ImportedOnUse("msg_adapters.contact_mode:contact_mode_answer_from_msg"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.show_contact_modes"),
        rows=ImportedOnUse("contact_dynamics.replay.answer_rows:row_of_contact_modes"),
        predicted=None,
    ),
    Service(
        type_name="PredictImpact",
        kind=IMPACT,
        digest="6fec62f9a6020c11",
        question_from_msg=ImportedOnUse("msg_adapters.questions:impact_question_from_msg"),
        answer=ImportedOnUse("contact_dynamics.questions.impact:answer"),
        answer_to_msg=ImportedOnUse("msg_adapters.impact:impact_answer_to_msg"),
        answer_from_msg=ImportedOnUse("msg_adapters.impact:impact_answer_from_msg"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.show_impact"),
        rows=ImportedOnUse("contact_dynamics.replay.answer_rows:row_of_impact"),
        predicted=ImportedOnUse("contact_dynamics.replay.answer_rows:predicted_by_impact"),
    ),
    Service(
        type_name="PredictTumbling",
        kind=TUMBLING,
        digest="faff7ceb375e4674",
        question_from_msg=ImportedOnUse("msg_adapters.questions:tumbling_question_from_msg"),
        answer=ImportedOnUse("contact_dynamics.questions.tumbling:answer"),
        answer_to_msg=ImportedOnUse("msg_adapters.tumbling:tumbling_answer_to_msg"),
        answer_from_msg=ImportedOnUse("msg_adapters.tumbling:tumbling_answer_from_msg"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.show_tumbling"),
        rows=ImportedOnUse("contact_dynamics.replay.answer_rows:row_of_tumbling"),
        predicted=ImportedOnUse("contact_dynamics.replay.answer_rows:predicted_by_tumbling"),
    ),
    Service(
        type_name="PredictToss",
        kind=TOSS,
        digest="e134e6cfc8c53f8d",
        question_from_msg=ImportedOnUse("msg_adapters.toss:toss_question_from_msg"),
        answer=ImportedOnUse("contact_dynamics.questions.toss:answer"),
        answer_to_msg=ImportedOnUse("msg_adapters.toss:toss_answer_to_msg"),
        answer_from_msg=ImportedOnUse("msg_adapters.toss:toss_answer_from_msg"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.show_toss"),
        rows=ImportedOnUse("contact_dynamics.replay.answer_rows:row_of_toss"),
        predicted=ImportedOnUse("contact_dynamics.replay.answer_rows:predicted_by_toss"),
    ),
    Service(
        type_name="PredictImpactBatch",
        kind=MANY_IMPACTS,
        digest="9638ca21106dfd4a",
        question_from_msg=ImportedOnUse("msg_adapters.batches:impacts_question_from_msg"),
        answer=ImportedOnUse("contact_dynamics.questions.many:answer_impacts"),
        answer_to_msg=ImportedOnUse("msg_adapters.batches:impacts_answer_to_msg"),
        answer_from_msg=ImportedOnUse("msg_adapters.batches:impacts_answer_from_msg"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.show_many"),
        rows=ImportedOnUse("contact_dynamics.replay.answer_rows:rows_of_impacts"),
        predicted=None,
    ),
    Service(
        type_name="PredictTumblingBatch",
        kind=MANY_TUMBLINGS,
        digest="f198a921773488f5",
        question_from_msg=ImportedOnUse("msg_adapters.batches:tumblings_question_from_msg"),
        answer=ImportedOnUse("contact_dynamics.questions.many:answer_tumblings"),
        answer_to_msg=ImportedOnUse("msg_adapters.batches:tumblings_answer_to_msg"),
        answer_from_msg=ImportedOnUse("msg_adapters.batches:tumblings_answer_from_msg"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.show_many"),
        rows=ImportedOnUse("contact_dynamics.replay.answer_rows:rows_of_tumblings"),
        predicted=None,
    ),
    Service(
        type_name="PredictContactModeBatch",
        kind=MANY_CONTACT_MODES,
        digest="4e9a384d6b1f41dd",
        question_from_msg=ImportedOnUse("msg_adapters.contact_mode_batch:contact_modes_question_from_msg"),
        answer=ImportedOnUse("contact_dynamics.questions.many_contact_modes:answer"),
        answer_to_msg=ImportedOnUse("msg_adapters.contact_mode_batch:contact_modes_answer_to_msg"),
        answer_from_msg=ImportedOnUse("msg_adapters.contact_mode_batch:contact_modes_answer_from_msg"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.show_many_contact_modes"),
        rows=ImportedOnUse("contact_dynamics.replay.answer_rows:rows_of_contact_modes"),
        predicted=None,
    ),
)


def service_of_type(service_type: str) -> Service:
    """Return the service of a type, which is given as "package/srv/Name".

    Raises:
        NotSupportedError: there is none.
    """
    for service in SERVICES:
        if service.type_name == service_type.rpartition("/")[2]:
            return service
    message = (
        f"service type must be one of {', '.join(each.type_name for each in SERVICES)}, got {service_type}"
    )
    raise NotSupportedError(message)
