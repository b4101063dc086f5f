# SPDX-License-Identifier: Apache-2.0
"""A service that is added as a user would add one: how high does a body rise?

It has its question and answer, what answers it, its adapters, what shows its answers, and its record. A
service that is added for good has a ``.srv``. This one takes the place of `PredictTumbling`, whose request
and response have room for it.
"""

from __future__ import annotations

import atexit
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.questions import services
from contact_dynamics.questions.context import Context
from contact_dynamics.questions.services import Answer, ImportedOnUse, Question, Service
from contact_dynamics.questions.subject import NEWEST, StateSource, subject_of
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.tumbling import Trajectory, free_motion
from contact_dynamics.validation import FloatArray
from contact_dynamics.world import Body, World

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contact_dynamics.viewing.picture import Picture
    from contact_dynamics_interfaces.srv import PredictTumbling
    from msg_adapters.fields import AnswerTable

if TYPE_CHECKING:  # the server must not import a viewer
    from matplotlib.figure import Figure

    from contact_dynamics.viewing.picture import Picture

IMPORTED = "TOY_SERVICE_IMPORTED"
"""The environment variable that names a file for the viewers that a process has imported when it ends."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ApexQuestion(Question["ApexAnswer"]):
    """How high does a body rise?"""

    body: Body | str
    state: StateSource = NEWEST


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ApexAnswer(Answer):
    """The way to the highest point, as one sample there."""

    body_name: str
    p_FB_F: FloatArray
    state: BodyState
    trajectory: Trajectory

    @property
    def predicted_motion(self) -> Trajectory:
        """The way up."""
        return self.trajectory


def answer(question: ApexQuestion, context: Context | None = None) -> ApexAnswer:
    """Answer the question, for gravity along -z."""
    known = Context() if context is None else context
    subject = subject_of(question.body, question.state, known)
    gravity_W, state = known.world.gravity_W, subject.state
    motion = free_motion(subject.body.mass_properties, state, gravity_W=gravity_W)
    seconds = np.array([max(0.0, -state.v_WB_W[2] / gravity_W[2])])
    return ApexAnswer(
        body_name=subject.body.name, p_FB_F=subject.body.p_FB_F, state=state, trajectory=motion.at(seconds)
    )


def apex_question_from_msg(
    request: PredictTumbling.Request, *, world: World, world_frame: str
) -> ApexQuestion:
    """Return the question of a request."""
    from msg_adapters.asked_fields import asked_subject

    body, state = asked_subject(request, world, world_frame)
    return ApexQuestion(body=body, state=state)


def _answer_table() -> AnswerTable[ApexAnswer, PredictTumbling.Response]:
    from contact_dynamics_interfaces.srv import PredictTumbling
    from msg_adapters.fields import STATE, AnswerTable, Row
    from msg_adapters.tumbling import TRAJECTORY

    rows = Row("state", "state", STATE), Row("trajectory", "trajectory", TRAJECTORY)
    return AnswerTable(ApexAnswer, PredictTumbling.Response, *rows)


def apex_answer_to_msg(
    answer: ApexAnswer, *, world_frame: str, into: PredictTumbling.Response
) -> PredictTumbling.Response:
    """Write an answer into a response."""
    return _answer_table().response_of(answer, world_frame=world_frame, into=into)


def apex_answer_from_msg(msg: PredictTumbling.Response, *, world: World) -> ApexAnswer:
    """Return the answer of a response."""
    return _answer_table().answer_of(msg, world=world)


def words(answer: ApexAnswer) -> list[str]:
    """Return words for the time of the rise."""
    return [f"rises for {answer.trajectory.seconds[0]:.3g} s"]


def draw(picture: Picture, answer: ApexAnswer, stamp_ns: int) -> tuple[list[str], list[str]]:  # noqa: ARG001
    """Draw the highest point."""
    import rerun as rr

    picture.recording.log("world/apex", rr.Points3D(answer.trajectory.p_WB_W))
    return [], ["a point is drawn at the top"]


def figures(answer: ApexAnswer, **_: object) -> Iterator[tuple[str, Figure]]:
    """Yield a figure with the highest point."""
    from matplotlib.figure import Figure

    figure = Figure()
    figure.add_subplot().plot(*answer.trajectory.p_WB_W[0, [0, 2]], "o")
    yield "top", figure


APEX = Service(
    name="predict_apex",
    type_name="PredictTumbling",
    kind="Apex",
    digest=services.service_of_type("PredictTumbling").digest,
    question_type="toy_service:ApexQuestion",
    answer_type="toy_service:ApexAnswer",
    adapters="toy_service:apex",
    answer=ImportedOnUse("toy_service:answer"),
    words=ImportedOnUse("toy_service:words"),
    draw=ImportedOnUse("toy_service:draw"),
    figures=ImportedOnUse("toy_service:figures"),
)
PROGRAM = ("-c", "import sys, toy_service; sys.exit(toy_service.run())")
"""Arguments of Python that run the command line with this service in the table."""


def run() -> int:
    """Run the command line with this service in the table of services."""
    vars(services)["SERVICES"] = (
        *(each for each in services.SERVICES if each.type_name != APEX.type_name),
        APEX,
    )
    if IMPORTED in os.environ:
        viewers = {"rerun", "matplotlib"}
        told = Path(os.environ[IMPORTED])
        atexit.register(lambda: told.write_text(str(viewers & sys.modules.keys()), encoding="utf-8"))
    from contact_dynamics.command_line import main

    return main(sys.argv[1:])
