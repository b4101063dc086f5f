# SPDX-License-Identifier: Apache-2.0
"""Questions, answers, and one record for each service, with its types, adapters and answering function.

The server, the visualizer, replay, tables, plots and `ask` read these records. To add a service, add its
record here, beside its ``.srv``, its question and answer, and their adapters.

A record contains the import path of each function, which is imported when it is used: the server imports no
viewer, a table no server, and this file none of them.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Final, Generic, Protocol, TypeVar

from contact_dynamics.constants import ns_after
from contact_dynamics.errors import ContactDynamicsError, NotSupportedError
from contact_dynamics.questions.carried_surface import with_carried
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from contact_dynamics.questions.context import Context
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.world import Body, World

Result = TypeVar("Result")


class Answer(Record):
    """The base of all answers.

    Attributes:
        body_name: The name of the body that the question was about, which may be empty.
    """

    __slots__ = ()

    body_name: str

    @property
    def stamp_ns(self) -> int:
        """The stamp, ns, of the state that the question was about, or 0 without one."""
        if not hasattr(type(self), "state"):  # a record would look for a similar name
            return 0
        state = getattr(self, "state", None)
        return state.stamp_ns if isinstance(state, BodyState) else 0

    @property
    def predicted_motion(self) -> Trajectory | None:
        """The motion that is predicted from that state on, or None if none is."""
        return None

    @property
    def predicted_state(self) -> BodyState | None:
        """The state that is predicted and that may be measured later, or None if none is."""
        motion, stamp_ns = self.predicted_motion, self.stamp_ns
        if motion is None or len(motion) == 0:
            return None
        return BodyState(
            p_WB_W=motion.p_WB_W[-1],
            q_WB=motion.q_WB[-1],
            v_WB_W=motion.v_WB_W[-1],
            w_WB_W=motion.w_WB_W[-1],
            stamp_ns=stamp_ns and ns_after(stamp_ns, float(motion.seconds[-1])),
        )

    @property
    def is_after_impact(self) -> bool:
        """Whether that state is just after an impact. Otherwise it ends a motion without one."""
        return False


Answer_co = TypeVar("Answer_co", bound=Answer, covariant=True)


class Question(Record, Generic[Answer_co]):
    """The base of all questions, with the type of their answers.

    Attributes:
        body: The body, or the name of one of the known world. `about` has it.
    """

    __slots__ = ()

    body: Body | str

    ALLOWED = "a TumblingQuestion or an ImpactQuestion or a question of another kind"

    @property
    def about(self) -> Question[Answer]:
        """The question that names the body and its state, which may be part of this one."""
        return self

    @property
    def detects_contacts(self) -> bool:
        """Whether contacts with the surfaces of the world are detected."""
        return False


class ServiceType(Protocol):
    """The class that rosidl generates from a service file."""

    Request: type
    Response: type
    Event: type


class ImportedOnUse(Generic[Result]):
    """A function that is imported when it is first used."""

    def __init__(self, path: str) -> None:
        """Set its import path, "package.module:function" or "package.module:Class.function"."""
        self.module, _, self._name = path.partition(":")

    @cached_property
    def function(self) -> Callable[..., Result]:
        """The function itself."""
        found = import_module(self.module)
        for part in self._name.split("."):
            found = getattr(found, part)
        return found  # type: ignore[return-value]

    def __call__(self, *args: object, **options: object) -> Result:
        """Call the function."""
        return self.function(*args, **options)


@dataclass(frozen=True, slots=True, kw_only=True)
class Service:
    """A service of the server: what it is, what answers it, and how its answers are shown.

    What is optional concerns how answers are shown. By default, they are short texts, and one row of a table.

    Attributes:
        name: Its name below the node's, "predict_impact".
        type_name: The name of its type, "PredictImpact".
        kind: The kind of its answers, in words.
        digest: The digest of its fields (`replay.of_log`). A test compares it with the interface.
        question_type: The import path of the class of its questions, "package.module:Class".
        answer_type: The import path of the class of its answers.
        adapters: The import path of its adapters, "package.module:prefix". The names of the three functions
            begin with the prefix: ``prefix_question_from_msg`` and so on.
        answer: Answers a question. It is a function of a module, so that a worker can import it.
        is_quick: Returns whether a question is sure to be answered within 30 ms. By default, none is, and
            workers answer all of them.
        words: Puts an answer into words, with the most important first.
        draw: Draws an answer into a `viewing.picture.Picture`, at the stamp in its last argument, and returns
            what of `viewing.entities` is in view by then, and remarks for the words.
        figures: Yields the figures of an answer (`plots.figures`).
        cells: Yields the cells of each row of an answer in a table (`replay.rows`).
        question_from_msg: Makes a question of a request.
        answer_to_msg: Makes a response of an answer.
        answer_from_msg: Makes an answer of a response.
    """

    name: str
    type_name: str
    kind: str
    digest: str
    question_type: str
    answer_type: str
    adapters: str
    answer: ImportedOnUse[Answer]
    is_quick: ImportedOnUse[bool] | None = None
    words: ImportedOnUse[list[str]] | None = None
    draw: ImportedOnUse[tuple[list[str], list[str]]] | None = None
    figures: ImportedOnUse[Iterator[tuple[str, object]]] | None = None
    cells: ImportedOnUse[Iterator[dict[str, str | int | float | None]]] | None = None
    question_from_msg: ImportedOnUse[Question[Answer]] = field(init=False)
    answer_to_msg: ImportedOnUse[object] = field(init=False)
    answer_from_msg: ImportedOnUse[Answer] = field(init=False)

    def __post_init__(self) -> None:
        """Find the adapters."""
        for name in ("question_from_msg", "answer_to_msg", "answer_from_msg"):
            object.__setattr__(self, name, ImportedOnUse(f"{self.adapters}_{name}"))

    @property
    def service_type(self) -> ServiceType:
        """The class that rosidl makes of its file."""
        found: ServiceType = getattr(import_module("contact_dynamics_interfaces.srv"), self.type_name)
        return found

    def prepare(self) -> None:
        """Import everything that answers a request, so that the first one need not wait for it."""
        for each in (self.question_from_msg, self.answer, self.answer_to_msg, self.is_quick):
            if each is not None:
                each.function  # noqa: B018  it is imported by that

    def question_of(self, request: object, *, world: World, world_frame: str) -> Question[Answer]:
        """Return the question of a request.

        Raise `InvalidFieldError` if rclpy corrupted a number in it, or another `ContactDynamicsError` if
        `question_from_msg` rejects it.
        """
        _CHECK_NUMBERS(request)
        return self.question_from_msg(request, world=world, world_frame=world_frame)

    def is_answered_at_once(self, question: Question[Answer], context: Context) -> bool:
        """Return whether the answer is quick. A question that is rejected counts as quick."""
        try:
            return self.is_quick is not None and self.is_quick(question, context)
        except ContactDynamicsError:
            return True

    def in_words(self, answer: Answer) -> list[str]:
        """Return an answer as texts, the most important first."""
        return [answer.in_short()] if self.words is None else self.words(answer)


_CHECK_NUMBERS: Final = ImportedOnUse[None]("msg_adapters.rejected_fields:check_numbers")

SERVICES: Final = (
    Service(
        name="predict_contact_mode",
        type_name="PredictContactMode",
        kind="Contact modes",
        digest="a8f38e440b5d0b81",
        question_type="contact_dynamics.questions.contact_modes:ContactModeQuestion",
        answer_type="contact_dynamics.questions.contact_modes:ContactModeAnswer",
        adapters="msg_adapters.contact_mode:contact_mode",
        answer=ImportedOnUse("contact_dynamics.questions.contact_modes:answer"),
        is_quick=ImportedOnUse("contact_dynamics.questions.effort:are_quick_modes"),
        words=ImportedOnUse("contact_dynamics.diagrams.words:contact_modes_in_words"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.draw_contact_modes"),
        figures=ImportedOnUse("contact_dynamics.plots.figures:figures_of_modes"),
        cells=ImportedOnUse("contact_dynamics.replay.rows:cells_of_contact_modes"),
    ),
    Service(
        name="predict_impact",
        type_name="PredictImpact",
        kind="Impact",
        digest="d31da868030441ce",
        question_type="contact_dynamics.questions.impact_question:ImpactQuestion",
        answer_type="contact_dynamics.questions.impact_question:ImpactAnswer",
        adapters="msg_adapters.impact:impact",
        answer=ImportedOnUse("contact_dynamics.questions.impact:answer"),
        is_quick=ImportedOnUse("contact_dynamics.questions.effort:is_quick_impact"),
        words=ImportedOnUse("contact_dynamics.diagrams.words:impact_in_words"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.draw_impact"),
        figures=ImportedOnUse("contact_dynamics.plots.figures:figures_of_impact"),
        cells=ImportedOnUse("contact_dynamics.replay.rows:cells_of_impact"),
    ),
    Service(
        name="predict_tumbling",
        type_name="PredictTumbling",
        kind="Tumbling",
        digest="faff7ceb375e4674",
        question_type="contact_dynamics.questions.tumbling:TumblingQuestion",
        answer_type="contact_dynamics.questions.tumbling:TumblingAnswer",
        adapters="msg_adapters.tumbling:tumbling",
        answer=ImportedOnUse("contact_dynamics.questions.tumbling:answer"),
        is_quick=ImportedOnUse("contact_dynamics.questions.effort:is_quick_flight"),
        words=ImportedOnUse("contact_dynamics.diagrams.words:tumbling_in_words"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.draw_tumbling"),
        figures=ImportedOnUse("contact_dynamics.plots.figures:figures_of_tumbling"),
        cells=ImportedOnUse("contact_dynamics.replay.rows:cells_of_tumbling"),
    ),
    Service(
        name="predict_toss",
        type_name="PredictToss",
        kind="Toss",
        digest="e35b7c481b3592f2",
        question_type="contact_dynamics.questions.toss:TossQuestion",
        answer_type="contact_dynamics.questions.toss:TossAnswer",
        adapters="msg_adapters.toss:toss",
        answer=ImportedOnUse("contact_dynamics.questions.toss:answer"),
        words=ImportedOnUse("contact_dynamics.diagrams.words:toss_in_words"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.draw_toss"),
        figures=ImportedOnUse("contact_dynamics.plots.figures:figures_of_toss"),
        cells=ImportedOnUse("contact_dynamics.replay.rows:cells_of_toss"),
    ),
    Service(
        name="predict_impact_batch",
        type_name="PredictImpactBatch",
        kind="Impacts of many",
        digest="9638ca21106dfd4a",
        question_type="contact_dynamics.questions.many:ManyImpactsQuestion",
        answer_type="contact_dynamics.questions.many:ManyImpactsAnswer",
        adapters="msg_adapters.batches:impacts",
        answer=ImportedOnUse("contact_dynamics.questions.many:answer_impacts"),
        is_quick=ImportedOnUse("contact_dynamics.questions.effort:are_quick_impacts"),
        words=ImportedOnUse("contact_dynamics.diagrams.words:many_impacts_in_words"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.draw_many"),
        figures=ImportedOnUse("contact_dynamics.plots.figures:figures_of_many"),
        cells=ImportedOnUse("contact_dynamics.replay.rows:cells_of_impacts"),
    ),
    Service(
        name="predict_tumbling_batch",
        type_name="PredictTumblingBatch",
        kind="Tumbling of many",
        digest="f198a921773488f5",
        question_type="contact_dynamics.questions.many:ManyTumblingsQuestion",
        answer_type="contact_dynamics.questions.many:ManyTumblingsAnswer",
        adapters="msg_adapters.batches:tumblings",
        answer=ImportedOnUse("contact_dynamics.questions.many:answer_tumblings"),
        is_quick=ImportedOnUse("contact_dynamics.questions.effort:are_quick_flights"),
        words=ImportedOnUse("contact_dynamics.diagrams.words:many_tumblings_in_words"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.draw_many"),
        figures=ImportedOnUse("contact_dynamics.plots.figures:figures_of_many"),
        cells=ImportedOnUse("contact_dynamics.replay.rows:cells_of_tumblings"),
    ),
    Service(
        name="predict_contact_mode_batch",
        type_name="PredictContactModeBatch",
        kind="Contact modes of many",
        digest="17a1cfe71f2c77c8",
        question_type="contact_dynamics.questions.many_contact_modes:ManyContactModesQuestion",
        answer_type="contact_dynamics.questions.many_contact_modes:ManyContactModesAnswer",
        adapters="msg_adapters.batches:contact_modes",
        answer=ImportedOnUse("contact_dynamics.questions.many_contact_modes:answer"),
        is_quick=ImportedOnUse("contact_dynamics.questions.effort:are_quick_candidates"),
        words=ImportedOnUse("contact_dynamics.diagrams.words:many_contact_modes_in_words"),
        cells=ImportedOnUse("contact_dynamics.replay.rows:cells_of_many_contact_modes"),
    ),
    Service(
        name="predict_bodies_contact_mode",
        type_name="PredictBodiesContactMode",
        kind="Contact modes of bodies",
        digest="29037e72513e7510",
        question_type="contact_dynamics.questions.bodies_contact_modes:BodiesContactModeQuestion",
        answer_type="contact_dynamics.questions.bodies_contact_modes:BodiesContactModeAnswer",
        adapters="msg_adapters.bodies_contact_mode:bodies_contact_mode",
        answer=ImportedOnUse("contact_dynamics.questions.bodies_contact_modes:answer"),
        words=ImportedOnUse("contact_dynamics.diagrams.words:bodies_contact_modes_in_words"),
        draw=ImportedOnUse("contact_dynamics.viewing.picture:Picture.draw_bodies_contact_modes"),
        figures=ImportedOnUse("contact_dynamics.plots.figures:figures_of_bodies_modes"),
        cells=ImportedOnUse("contact_dynamics.replay.rows:cells_of_contact_modes"),
    ),
)
"""All services."""


def service_of_type(service_type: str) -> Service:
    """Return the service of a type, "package/srv/Name", or raise `NotSupportedError` if there is none."""
    for service in SERVICES:
        if service.type_name == service_type.rpartition("/")[2]:
            return service
    message = f"type must be one of {', '.join(each.type_name for each in SERVICES)}, got {service_type}"
    raise NotSupportedError(message)


def service_of(what: Question[Answer] | Answer) -> Service:
    """Return the service of a question or of an answer, or raise `NotSupportedError` if there is none."""
    path = f"{type(what).__module__}:{type(what).__qualname__}"
    for service in SERVICES:
        if path in {service.question_type, service.answer_type}:
            return service
    known = ", ".join(each.kind for each in SERVICES)
    raise NotSupportedError(f"a question or an answer must be of one of these kinds: {known}, got {path}")


def at_instant(question: Question[Answer], context: Context) -> Context:
    """Return the context of one question, with the carried surfaces at its instant.

    The instant is the stamp of the body's state, or the present if it has none. Surfaces carried by the body
    itself are left out, and so are all carried surfaces if no contacts are detected. Raise `NoStateError` if
    a carrying body has no state at that time, and `StaleStateError` if its latest state is too old.
    """
    if not context.carried:
        return context
    about = question.about
    if not about.detects_contacts:
        return replace(context, carried=())
    name = about.body if isinstance(about.body, str) else about.body.name
    now_ns = None if context.now_ns is None else context.now_ns()
    stamp_ns = getattr(getattr(about, "state", None), "stamp_ns", 0)
    if stamp_ns is None:  # the latest published state
        stamp_ns = context.states.newest(name, now_ns=now_ns).stamp_ns
    world, warnings, noise = with_carried(
        context.world,
        [each for each in context.carried if each.body_name != name],
        context.states,
        stamp_ns=stamp_ns or now_ns,
        now_ns=now_ns,
        max_extrapolation=context.defaults.max_extrapolation,
    )
    return replace(context, world=world, carried=(), notes=warnings, carrier_noise=noise)


def ask(question: Question[Answer_co], context: Context | None = None) -> Answer_co:
    """Answer a question, as the service of its kind does.

    Args:
        question: The question.
        context: Bodies by name, surfaces, published states and defaults. If it is None, the question must
            contain everything.

    Raises:
        ContactDynamicsError: the question refers to something unknown, is invalid, or is not supported. The
            message names it.
    """
    known = None if context is None else at_instant(question, context)
    return service_of(question).answer(question, known)  # type: ignore[return-value]  # of this question
