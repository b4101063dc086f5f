# SPDX-License-Identifier: Apache-2.0
"""A question over a real server and the same question in Python: one answer, to the last bit.

That a service passes on what is asked and answered is shown here, for each service and option. What is
right is shown where it is computed.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import Path as RosPath

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.uncertainty import ContactUncertainty
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.motion.forces import ConstantWrench, Drag, WrenchAxes
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import (
    AtRate,
    AtStamps,
    ContactModeQuestion,
    Context,
    ImpactQuestion,
    InTime,
    Problem,
    TossQuestion,
    TossSampling,
    TumblingQuestion,
    UncertainState,
    UntilContact,
    UntilPlane,
    ask,
)
from contact_dynamics.questions.many import ManyImpactsQuestion, ManyStates, ManyTumblingsQuestion
from contact_dynamics.questions.many_contact_modes import ManyContactModesQuestion
from contact_dynamics.questions.services import SERVICES, service_of
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.world import Body
from contact_dynamics_interfaces.srv import PredictTumbling
from running_server import ROOT, Client

PARAMETERS = read_server_parameters(ParameterFile(ROOT / "config" / "server.yaml"))
CONTEXT = Context(world=PARAMETERS.world, defaults=PARAMETERS.defaults)
ROD = Body(
    name="",
    mass_properties=MassProperties(mass=1.5, I_B=np.diag([0.3, 0.4, 0.5])),
    p_FB_F=[0.02, -0.01, 0.03],
)
TOSSED = BodyState(
    p_WB_W=[0.1, -0.2, 1.0],
    q_WB=[0.5, -0.5, 0.5, 0.5],
    v_WB_W=[1.0, 0.3, -0.5],
    w_WB_W=[1.0, 6.0, 2.0],
    stamp_ns=12_345_678_901,
)
LEVEL = BodyState(
    p_WB_W=[0.0, 0.0, 0.025], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0], stamp_ns=77
)
TILTED = replace(LEVEL, p_WB_W=[0.0, 0.0, 0.06], q_WB=[0, np.sin(0.17), 0, np.cos(0.17)])
UNCERTAIN = UncertainState(
    state=TOSSED, covariance=np.diag([1e-6] * 3 + [1e-5] * 3 + [1e-4] * 3 + [1e-3] * 3)
)
FEET = ContactSet(
    p_WC_W=[[-0.1, 0.0, 0.5], [0.3, 0.1, 0.5]],
    normals_W=[[0, 0, 1]] * 2,
    frictions=[0.5, 0.1],
    restitutions=[0.2, 0.8],
    surfaces=("left", "right"),
)
MANY = ManyStates(
    p_WB_W=[[0, 0, 1.0], [0.5, 0, 1.0]],
    q_WB=[[0, 0, 0, 1]] * 2,
    v_WB_W=[[0.3, 0, -1.0], [0, 0, 2.0]],
    w_WB_W=[[0, 3.0, 0]] * 2,
)
PUSHED = ContactModeQuestion(body="brick", state=LEVEL, force_W=[0.75, 0, 0])
QUESTIONS: dict[str, Any] = {
    "until contact": TumblingQuestion(body="brick", state=TOSSED, sampling=UntilContact()),
    "under forces, uncertain": TumblingQuestion(
        body=ROD,
        state=UNCERTAIN,
        sampling=AtRate(rate=20.0, duration=0.5),
        wrench=ConstantWrench(force=[0.5, 0, 0], torque=[0, 0, 0.25], axes=WrenchAxes.BODY),
        drag=Drag(linear=0.1),
        include_covariance=True,
    ),
    "until a plane, with curves": TumblingQuestion(
        body=ROD,
        state=TOSSED,
        sampling=UntilPlane(plane_point=[0, 0, 0.2], plane_normal=[0, 0, 1], body_point=[0.1, 0, 0]),
        curve_points=7,
    ),
    "at stamps, without weight": TumblingQuestion(
        body=ROD, state=TOSSED, sampling=AtStamps(stamps_ns=[12_000_000_000]), gravity_W=[0, 0, 0]
    ),
    "a landing": ImpactQuestion(body="brick", state=TOSSED),
    "orders": ImpactQuestion(body=ROD, state=TOSSED, contacts=FEET, include_orders=True),
    "in time": ImpactQuestion(
        body="brick", state=TILTED, several_contacts_law=InTime(strike_window=0.1, hold_step=0.001)
    ),
    "at once": ImpactQuestion(
        body="brick",
        state=TOSSED,
        restitution_law=RestitutionLaw.NEWTON,
        several_contacts_law=SeveralContactsLaw.SIMULTANEOUS,
    ),
    "in a plane": ImpactQuestion(
        body=ROD,
        state=replace(LEVEL, p_WB_W=[0, 0, 0.8], v_WB_W=[1.0, 0, -2.0], w_WB_W=[0, 2.0, 0]),
        contacts=FEET.subset([0]),
        problem=Problem.PLANAR,
        plane=PlaneOfMotion(normal_W=[0, -1, 0]),
        out_of_plane_tolerance=1e-3,
    ),
    "two bodies": ImpactQuestion(
        body=ROD, state=TOSSED, other="brick", other_state=LEVEL, contacts=FEET.subset([1])
    ),
    "probable outcomes": ImpactQuestion(
        body=ROD, state=UNCERTAIN, contacts=FEET.subset([1]), include_covariance=True
    ),
    "margins, wrenches, statics": replace(
        PUSHED, include_margins=True, include_wrenches=True, include_statics=True
    ),
    "in space": replace(
        PUSHED, force_W=[1.0, 1.0, 0], include_margins=True, include_wrenches=True, friction_facets=4
    ),
    "settled by an impact": ContactModeQuestion(
        body=ROD, state=TOSSED, contacts=FEET, problem=Problem.SPATIAL, include_impact=True
    ),
    "uncertain contacts": ContactModeQuestion(
        body=ROD,
        state=replace(LEVEL, p_WB_W=[0, 0, 0.8]),
        contacts=FEET,
        problem=Problem.SPATIAL,
        uncertainty=ContactUncertainty(frictions=0.1),
        include_geometry_margins=True,
    ),
    "a toss": TossQuestion(
        body="brick", state=UNCERTAIN, sampling=TossSampling(count=5, seed=3), max_alternatives=1
    ),
    "many impacts": ManyImpactsQuestion(
        body="brick",
        states=MANY,
        p_WC_W=[[0.05, 0, 0.98], [0.5, 0, 0.98]],
        normals_W=[[0, 0, 1.0]],
        frictions=[0.3],
        restitutions=[0.5],
    ),
    "many tumblings": ManyTumblingsQuestion(body="brick", states=MANY, seconds=[0.25, 0.5]),
    "many contact modes": ManyContactModesQuestion(
        asked=replace(PUSHED, force_W=[0, 0, 0], include_margins=True),
        forces_W=[[0, 0, 0], [0.3, 0, 0], [2.0, 0, 0]],
        torques_W=np.zeros((3, 3)),
    ),
}


def contents(msg: Any) -> Any:
    """Return all that a message says, numbers as they are, without the time that it took."""
    if hasattr(msg, "get_fields_and_field_types"):
        names = [name for name in msg.get_fields_and_field_types() if name != "computation_time"]
        return {name: contents(getattr(msg, name)) for name in names}
    if isinstance(msg, str | bool | int):
        return msg
    if isinstance(msg, float):
        return msg.hex()
    return [contents(each) for each in (msg.tolist() if hasattr(msg, "tolist") else msg)]


def test_every_service_is_asked() -> None:
    assert {service_of(each).name for each in QUESTIONS.values()} == {each.name for each in SERVICES}


@pytest.mark.parametrize("name", QUESTIONS)
def test_a_server_answers_as_python_does(client: Client, name: str) -> None:
    """The question is read back from its request, since the position of a body goes over by another point."""
    question = QUESTIONS[name]
    service = service_of(question)
    request = service.question_to_msg(question, world=CONTEXT.world, world_frame="world")
    answer = ask(service.question_of(request, world=CONTEXT.world, world_frame="world"), CONTEXT)
    here: Any = service.answer_to_msg(answer, world_frame="world", into=service.service_type.Response())
    response = client.ask(request)
    assert response.status == response.OK, response.message
    assert contents(response) == contents(here)


def test_a_path_for_rviz_is_published_while_somebody_listens(client: Client) -> None:
    paths: list[RosPath] = []
    topic = "/contact_dynamics/predicted_path"
    subscription = client.node.create_subscription(RosPath, topic, paths.append, 1)
    request = PredictTumbling.Request(body_name="brick", state_source=PredictTumbling.Request.STATE_EXPLICIT)
    request.gravity, request.state.linear_velocity.x = request.GRAVITY_NONE, 1.0
    request.state.angular_velocity.z = 2.0
    request.sampling, request.rate, request.duration = request.AT_RATE, 1000.0, 1.0

    def heard() -> bool:
        client.ask(request)
        return bool(paths)

    client.spin_until(heard)
    client.node.destroy_subscription(subscription)
    path = paths[0]
    assert path.header.frame_id == "world"
    assert 2 < len(path.poses) <= 200
    assert [path.poses[0].pose.position.x, path.poses[-1].pose.position.x] == [0.0, 1.0]
    assert path.poses[-1].header.stamp.sec == 1
    assert path.poses[-1].pose.orientation.z == pytest.approx(np.sin(1.0), abs=1e-14)
