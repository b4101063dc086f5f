# SPDX-License-Identifier: Apache-2.0
"""A question over a real server and the same question in Python: one answer, to the last bit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.motion.forces import ConstantWrench, Drag, WrenchAxes
from contact_dynamics.questions import (
    AtRate,
    ContactModeQuestion,
    Context,
    Defaults,
    ImpactQuestion,
    Problem,
    TumblingQuestion,
    UncertainState,
    UntilContact,
    contact_modes,
    impact,
    tumbling,
)
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.world import Body, Surface, World, box_vertices
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling
from msg_adapters.contact_mode import contact_mode_answer_to_msg
from msg_adapters.contacts import contacts_to_msg
from msg_adapters.geometry import mass_properties_to_msg
from msg_adapters.impact import impact_answer_to_msg
from msg_adapters.tumbling import tumbling_answer_to_msg
from running_server import Client

# As config/server.yaml, which the server runs with, says.
BRICK = Body(
    name="brick",
    mass_properties=MassProperties(mass=0.4, I_B=np.diag([0.000353333, 0.000833333, 0.00102])),
    vertices_B=box_vertices([0.15, 0.09, 0.05]),
)
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.45)
CONTEXT = Context(
    world=World(bodies=(BRICK,), surfaces=(FLOOR,), gravity_W=[0.0, 0.0, -9.80665]),
    defaults=Defaults(velocity_tolerance=1e-9, distance_tolerance=1e-6, out_of_plane_tolerance=1e-6),
)
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
COVARIANCE = np.diag([1e-6] * 3 + [1e-5] * 3 + [1e-4] * 3 + [1e-3] * 3)
FEET = ContactSet(
    p_WC_W=[[-0.1, 0.0, 0.5], [0.3, 0.1, 0.5]],
    normals_W=[[0, 0, 1]] * 2,
    frictions=[0.5, 0.1],
    restitutions=[0.2, 0.8],
    surfaces=("left", "right"),
)


def say_state(msg: Any, state: BodyState, body: Body) -> None:
    """Fill a message with a state of a body, by its published frame."""
    p_WF_W = state.p_WB_W - state.R_WB @ body.p_FB_F if body.p_FB_F.any() else state.p_WB_W
    msg.header.stamp.sec, msg.header.stamp.nanosec = divmod(state.stamp_ns, 1_000_000_000)
    msg.pose.position.x, msg.pose.position.y, msg.pose.position.z = p_WF_W.tolist()
    q = msg.pose.orientation
    q.x, q.y, q.z, q.w = state.q_WB.tolist()
    v, w = msg.linear_velocity, msg.angular_velocity
    v.x, v.y, v.z = state.v_WB_W.tolist()
    w.x, w.y, w.z = state.w_WB_W.tolist()


def about(service: Any, body: Body, state: BodyState, **fields: Any) -> Any:
    """Return a request about a body, known or described, in an explicit state."""
    request = service.Request(state_source=service.Request.STATE_EXPLICIT, **fields)
    if body is BRICK:
        request.body_name = "brick"
    else:
        request.inertia = mass_properties_to_msg(body.mass_properties, body.p_FB_F)
    say_state(request.state, state, body)
    return request


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


def check_same(client: Client, request: Any, in_python: Any) -> None:
    """Compare the server's answer with the one that was found here."""
    response = client.ask(request)
    assert (response.status, response.message) == (response.OK, in_python.message)
    assert contents(response) == contents(in_python)


def exact(state: BodyState, body: Body) -> BodyState:
    """Return a state as the server reads it, when its position went over by the published frame."""
    if not body.p_FB_F.any():
        return state
    lever = state.R_WB @ body.p_FB_F
    return BodyState(
        p_WB_W=(state.p_WB_W - lever) + lever,
        q_WB=state.q_WB,
        v_WB_W=state.v_WB_W,
        w_WB_W=state.w_WB_W,
        stamp_ns=state.stamp_ns,
    )


def tumbling_asked_twice() -> Iterator[tuple[Any, TumblingQuestion]]:
    """Yield requests about tumbling with the same questions in Python."""
    contact = about(PredictTumbling, BRICK, TOSSED, sampling=PredictTumbling.Request.UNTIL_CONTACT)
    yield contact, TumblingQuestion(body="brick", state=TOSSED, sampling=UntilContact())
    pushed = about(
        PredictTumbling,
        ROD,
        TOSSED,
        sampling=PredictTumbling.Request.AT_RATE,
        rate=20.0,
        duration=0.5,
        wrench_in_body_axes=True,
        linear_drag=0.1,
        include_covariance=True,
    )
    pushed.applied_wrench.force.x, pushed.applied_wrench.torque.z = 0.5, 0.25
    pushed.state.covariance = COVARIANCE.ravel().tolist()
    yield (
        pushed,
        TumblingQuestion(
            body=ROD,
            state=UncertainState(state=exact(TOSSED, ROD), covariance=COVARIANCE),
            sampling=AtRate(rate=20.0, duration=0.5),
            wrench=ConstantWrench(force=[0.5, 0, 0], torque=[0, 0, 0.25], axes=WrenchAxes.BODY),
            drag=Drag(linear=0.1),
            include_covariance=True,
        ),
    )


def test_tumbling(client: Client) -> None:
    for request, question in tumbling_asked_twice():
        answer = tumbling.answer(question, CONTEXT)
        check_same(client, request, tumbling_answer_to_msg(answer, world_frame="world"))


def impacts_asked_twice() -> Iterator[tuple[Any, ImpactQuestion]]:
    """Yield requests about impacts with the same questions in Python."""
    yield about(PredictImpact, BRICK, TOSSED), ImpactQuestion(body="brick", state=TOSSED)
    on_feet = about(PredictImpact, ROD, TOSSED, contact_source=1, include_orders=True)
    contacts_to_msg(FEET, into=on_feet.contacts)
    yield (
        on_feet,
        ImpactQuestion(body=ROD, state=exact(TOSSED, ROD), contacts=FEET, include_orders=True),
    )


def test_impact(client: Client) -> None:
    for request, question in impacts_asked_twice():
        answer = impact.answer(question, CONTEXT)
        check_same(client, request, impact_answer_to_msg(answer, world_frame="world"))


def modes_asked_twice() -> Iterator[tuple[Any, ContactModeQuestion]]:
    """Yield requests about contact modes with the same questions in Python."""
    pushed = about(
        PredictContactMode, BRICK, LEVEL, include_margins=True, include_wrenches=True, include_statics=True
    )
    pushed.applied_wrench.force.x = 0.75
    yield (
        pushed,
        ContactModeQuestion(
            body="brick",
            state=LEVEL,
            force_W=[0.75, 0, 0],
            include_margins=True,
            include_wrenches=True,
            include_statics=True,
        ),
    )
    dropped = about(
        PredictContactMode,
        ROD,
        TOSSED,
        contact_source=1,
        problem=PredictContactMode.Request.SPATIAL,
        include_impact=True,
    )
    contacts_to_msg(FEET, into=dropped.contacts)
    yield (
        dropped,
        ContactModeQuestion(
            body=ROD, state=exact(TOSSED, ROD), contacts=FEET, problem=Problem.SPATIAL, include_impact=True
        ),
    )


def test_contact_modes(client: Client) -> None:
    for request, question in modes_asked_twice():
        answer = contact_modes.answer(question, CONTEXT)
        check_same(client, request, contact_mode_answer_to_msg(answer, world_frame="world"))
