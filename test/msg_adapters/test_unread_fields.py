# SPDX-License-Identifier: Apache-2.0
"""Each field of a request changes the question or is refused by its name: nothing is ignored."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Iterator
from typing import Any

import pytest
from geometry_msgs.msg import Inertia, Vector3, Wrench

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics_interfaces.msg import BodyState
from contact_dynamics_interfaces.srv import (
    PredictBodiesContactMode,
    PredictContactMode,
    PredictContactModeBatch,
    PredictImpact,
    PredictImpactBatch,
    PredictToss,
    PredictTumbling,
    PredictTumblingBatch,
)
from message_values.shared import same
from msg_adapters.batches import (
    contact_modes_question_from_msg,
    impacts_question_from_msg,
    tumblings_question_from_msg,
)
from msg_adapters.bodies_contact_mode import bodies_contact_mode_question_from_msg
from msg_adapters.contact_mode import contact_mode_question_from_msg
from msg_adapters.impact import impact_question_from_msg
from msg_adapters.toss import toss_question_from_msg
from msg_adapters.tumbling import tumbling_question_from_msg
from questions.known_world import WORLD

FROM_MSG = {
    PredictBodiesContactMode: bodies_contact_mode_question_from_msg,
    PredictContactMode: contact_mode_question_from_msg,
    PredictContactModeBatch: contact_modes_question_from_msg,
    PredictImpact: impact_question_from_msg,
    PredictImpactBatch: impacts_question_from_msg,
    PredictToss: toss_question_from_msg,
    PredictTumbling: tumbling_question_from_msg,
    PredictTumblingBatch: tumblings_question_from_msg,
}


def _explicit(name: str = "") -> BodyState:
    state = BodyState(body_name=name)
    state.linear_velocity.x = 1.0
    return state


def _one_contact(msg: Any) -> Any:
    msg.positions, msg.normals = [0.0, 0.0, -0.1], [0.0, 0.0, 1.0]
    msg.frictions, msg.restitutions = [0.3], [0.2]
    return msg


def _values(field: str, request: Any) -> Any:
    """Return a value of a field that is allowed and not its default."""
    message = copy.deepcopy(getattr(request, field))
    if field == "state":
        message.linear_velocity.x = 1.0
    elif field in MESSAGES and isinstance(message, list):
        message = MESSAGES[field]
    elif field == "stamp":
        message.sec = 3
    elif field in {"inertia", "other_inertia"}:
        message.m = message.ixx = message.iyy = message.izz = 3.0
    elif field == "contacts":
        _one_contact(message)
    elif field == "applied_wrench":
        message.torque.y = 2.0
    elif field in {"plane_normal", "plane_point", "body_point"}:
        message.x, message.y, message.z = 0.0, 1.0, 0.0
    elif field == "states":
        message.positions, message.orientations = [0.0, 0.0, 2.0], [0.0, 0.0, 0.0, 1.0]
        message.linear_velocities = message.angular_velocities = [0.0, 1.0, 0.0]
    else:
        return LISTED.get(field, FLAT.get(type(message), [0.25]))
    return message


SLAB = Inertia(m=1.0, ixx=1.0, iyy=1.0, izz=1.0)
MESSAGES: dict[str, Any] = {
    "other_state": [_explicit()],
    "states": [_explicit("cube"), BodyState(body_name="slab")],
    "inertias": [Inertia(m=3.0, ixx=3.0, iyy=3.0, izz=3.0), SLAB],
    "applied_wrenches": [Wrench(torque=Vector3(y=2.0)), Wrench()],
}
FLAT: dict[type, Any] = {bool: True, int: 1, float: 0.25, str: "cube"}
LISTED: dict[str, Any] = {
    "friction_facets": 12,
    "max_strikes": 7,
    "max_alternatives": 3,
    "strikes": 3,
    "stamps_ns": [5],
    "parameter_covariance": [1e-4 * (i == j) for i in range(6) for j in range(6)],
    "forces": [1.0, 0.0, 0.0],
    "torques": [1.0, 0.0, 0.0],
    "contact_counts": [1],
    "contact_bodies": [1],
    "other_bodies": [1],
    "contact_positions": [0.0, 0.0, 0.1],
    "contact_normals": [0.0, 0.6, 0.8],
}
CHOICES = {
    "state_source": (0, 1, 2),
    "contact_source": (0, 1),
    "problem": (0, 1, 2),
    "sampling": (0, 1, 2, 3, 4),
    "several_contacts_law": (0, 1, 2),
    "include_margins": (False, True),
    "include_statics": (False, True),
    "include_geometry_margins": (False, True),
    "samples": (0, 5),
    "other_body_name": ("", "cube"),
}


def requests_of(service: Any) -> Iterator[Any]:
    """Yield a request for each combination of a service's flags. All else that may be left out is."""
    flags = {name: values for name, values in CHOICES.items() if hasattr(service.Request(), name)}
    if "several_contacts_law" in flags and not hasattr(service.Request(), "SEQUENTIAL_IN_TIME"):
        flags["several_contacts_law"] = (0, 1)
    for chosen in itertools.product(*flags.values()):
        request = service.Request(body_name="cube")
        for name, value in zip(flags, chosen, strict=True):
            setattr(request, name, value)
        if getattr(request, "contact_source", 0) == 1:
            _one_contact(request.contacts).frictions = [0.7]
        if hasattr(request, "lasting_factors"):
            request.lasting_factors = [1.5]
        if hasattr(request, "sampling"):
            request.applied_wrench.force.x = 1.0  # a zero wrench is the same in all axes
            if request.sampling == request.UNTIL_PLANE:
                request.plane_normal.z = 1.0
            request.times = [0.1] if request.sampling == request.AT_TIMES else []
            request.stamps_ns = [3] if request.sampling == request.AT_STAMPS else []
        if hasattr(request, "states"):
            request.states = _values("states", request)
            request.states.positions = [0.0, 0.0, 1.0]
            if hasattr(request, "times"):
                request.times = [0.1]
            else:
                request.contact_positions, request.contact_normals = [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]
                request.frictions, request.restitutions = [0.3], [0.2]
        yield request


def _requests_about_two() -> Iterator[PredictBodiesContactMode.Request]:
    """The cube, and a slab that is not configured, with a contact of the cube with the world."""
    for source in CHOICES["state_source"]:
        request = PredictBodiesContactMode.Request(state_source=source, inertias=[Inertia(), SLAB])
        request.states = [BodyState(body_name="cube"), BodyState(body_name="slab")]
        request.contact_bodies, request.other_bodies = [0], [-1]
        _one_contact(request.contacts).frictions = [0.7]
        yield request


def question_or_error(service: Any, request: Any) -> Any:
    try:
        return FROM_MSG[service](request, world=WORLD, world_frame="world")
    except InvalidFieldError as error:
        return error


@pytest.mark.parametrize("service", FROM_MSG)
def test_a_value_in_any_field_counts_or_is_refused_by_the_fields_name(service: Any) -> None:
    """Under every combination of the flags. A question is another one if any part of it differs."""
    read, refused = set(), set()
    of_two = service is PredictBodiesContactMode
    for request in _requests_about_two() if of_two else requests_of(service):
        question = FROM_MSG[service](request, world=WORLD, world_frame="world")
        for field in request.get_fields_and_field_types():
            value = _values(field, request)
            if field in CHOICES or field == "body_name" or same(getattr(request, field), value):
                continue
            changed = copy.deepcopy(request)
            setattr(changed, field, value)
            other = question_or_error(service, changed)
            if isinstance(other, InvalidFieldError):
                named = other.field.split(".")[0].split("[")[0]
                assert named == field or (field, named) == ("other_state", "other_body_name"), str(other)
                refused.add(field)
            else:
                assert not same(other, question), f"{field} is ignored in {request}"
                read.add(field)
    fields = set(service.Request().get_fields_and_field_types()) - {*CHOICES, "body_name"}
    assert read == fields, "each field counts under some flags"
    assert (refused != set()) == (service not in {PredictImpactBatch, PredictTumblingBatch})


@pytest.mark.parametrize("value", [0.25, float("nan"), float("inf")])
def test_the_part_of_a_message_that_has_a_value_is_named(value: float) -> None:
    request = PredictTumbling.Request(body_name="cube", times=[0.1])
    request.state.pose.position.z = value
    with pytest.raises(InvalidFieldError) as caught:
        tumbling_question_from_msg(request, world=WORLD, world_frame="world")
    assert str(caught.value) == (
        f"state.pose.position.z must be left out unless state_source is STATE_EXPLICIT (1), got {value} "
        "(set state_source: 1 to use it)"
    )


def test_a_flag_that_would_make_a_field_count_is_named() -> None:
    request = PredictContactMode.Request(body_name="cube", margin_length=0.1)
    with pytest.raises(InvalidFieldError, match=r"got 0.1 \(set include_margins: true to use it\)$"):
        contact_mode_question_from_msg(request, world=WORLD, world_frame="world")


@pytest.mark.parametrize("field", ["state", "other_state"])
def test_a_state_that_names_another_body_is_refused(field: str) -> None:
    """It would be taken for the state of the body that the request names."""
    request = PredictImpact.Request(body_name="cube", other_body_name="cube", state_source=1)
    request.other_state = [BodyState(body_name="cube")]
    request.state.body_name = "cube"
    state = request.state if field == "state" else request.other_state[0]
    impact_question_from_msg(request, world=WORLD, world_frame="world")
    state.body_name = "ball"
    with pytest.raises(InvalidFieldError, match=r"body_name must be 'cube', or left out, got 'ball'"):
        impact_question_from_msg(request, world=WORLD, world_frame="world")
