# SPDX-License-Identifier: Apache-2.0
"""Bad input over the services: each gets its error by field and value, and the node serves on."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from copy import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Inertia, Point

from changed_requests import put
from contact_dynamics_interfaces.msg import BodyState, BodyStates, ContactSet
from contact_dynamics_interfaces.srv import (
    PredictContactMode,
    PredictImpact,
    PredictImpactBatch,
    PredictToss,
    PredictTumbling,
)
from message_words import says
from running_server import Client

SERVICES = (PredictContactMode, PredictImpact, PredictTumbling)


def good(service: Any) -> Any:
    """A request that is answered: a unit body that falls onto, or rests at, one contact below it."""
    request = service.Request()
    request.inertia.m = request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 1.0
    request.state_source = request.STATE_EXPLICIT
    if service is PredictTumbling:
        request.times = [0.0, 0.1]
        return request
    request.contact_source = request.CONTACTS_EXPLICIT
    request.contacts.positions = [0.0, 0.0, -1.0]
    request.contacts.normals = [0.0, 0.0, 1.0]
    request.contacts.frictions = [0.5]
    request.contacts.restitutions = [0.5]
    if service is PredictImpact:
        request.state.linear_velocity.z = -1.0
    return request


def published(request: Any) -> None:
    """Ask about a published state, of a body without a name."""
    request.state_source, request.state = request.STATE_NEWEST, BodyState()


def moving_in_a_plane(request: Any) -> None:
    """A belt in a problem that is to be planar."""
    request.problem = request.PLANAR
    request.contacts.surface_velocities = [1.0, 0.0, 0.0]


def out_of_plane(request: Any) -> None:
    """Spin about an axis in the plane: the contact moves out of it by 1 m/s per rad/s."""
    request.problem = request.PLANAR
    request.plane_normal.y = 1.0
    request.state.angular_velocity.x = 0.25


def from_geometry(request: Any) -> None:
    """Ask for contacts of a body without a shape."""
    request.contact_source, request.contacts = request.CONTACTS_FROM_GEOMETRY, ContactSet()


def at_rate(rate: float, duration: float) -> Callable[[Any], None]:
    def change(request: Any) -> None:
        request.sampling, request.times = request.AT_RATE, []
        request.rate, request.duration = rate, duration

    return change


def until_contact(request: Any) -> None:
    """Ask when a body without a shape lands."""
    request.sampling, request.times = request.UNTIL_CONTACT, []


def unchecked(z: Any) -> Point:
    """Return a point as a client makes it that has not set ROS_PYTHON_CHECK_FIELDS."""
    point = Point(check_fields=False)
    point.z = z
    return point


EVERY_SERVICE = [
    (
        put("state.pose.position", unchecked(2)),
        "state.pose.position.z must be a number of normal size, got ... (rclpy sends this for an int",
    ),
    (put("state.covariance", [5e-324] * 144), "state.covariance[0] must be a number"),
    (put("state.pose.position.x", math.nan), "got [nan ... ROS_PYTHON_CHECK_FIELDS=1"),
    (put("inertia.m", math.nan), "got nan (rclpy sends this for an int"),
    (put("inertia.m", -1.0), "inertia.m must be > 0..., got -1.0"),
    (put("inertia.ixx", 3.0), "I1 + I2 >= I3"),
    (put("inertia.ixy", 5.0), "positive definite"),
    (put("inertia.com.x", math.nan), "inertia.com"),
    (
        put("state.pose.orientation.w", 0.5),
        "state.pose.orientation must be ..., got [0.0, 0.0, 0.0, 0.5] of norm 0.5",
    ),
    (put("state.linear_velocity.y", math.inf), "state.linear_velocity must be"),
    (put("state.angular_velocity.z", math.nan), "state.angular_velocity must be"),
    (put("state.header.frame_id", "map"), "must be 'world'..., got 'map'", "FRAME_MISMATCH"),
    (put("state.covariance", [0.0] * 36), "state.covariance must be ..., got 36 numbers"),
    (put("body_name", "cat"), "must be one of the known bodies ('brick'), got 'cat'", "UNKNOWN_BODY"),
    (put("body_name", "x" * 1000), "body_name must be ..., got 1000 characters", "TOO_LARGE"),
    (published, "body_name must be ..., got nothing"),
]
"""A change of a good request, words of the error, and its status unless that is INVALID_FIELD."""

CONTACTS = [
    (
        out_of_plane,
        "state must be ..., got 0.25 m/s out of the plane with normal [0.0, 1.0, 0.0]",
        "OUT_OF_PLANE",
    ),
    (put("contacts.normals", [0.0, 0.0, 0.0]), "contacts.normals[0] must be a unit..., got [0.0, 0.0, 0.0]"),
    (put("contacts.normals", [0.0, 1.0]), "contacts.normals must be 3..., got 2 numbers"),
    (put("contacts.positions", []), "contacts.positions must be 3..., got 0 numbers"),
    (put("contacts.frictions", [-0.1]), "contacts.frictions[0] must be >= 0..., got -0.1"),
    (put("contacts.restitutions", [1.5]), "contacts.restitutions[0] must be in [0, 1]..., got 1.5"),
    (put("contacts.surface_velocities", [1.0, 0.0]), "contacts.surface_velocities must be 3"),
    (moving_in_a_plane, "contacts must have surfaces at rest in a plane of motion", "NOT_SUPPORTED"),
    (put("contacts.kinds", [3]), "contacts.kinds[0] must be ..., got 3"),
    (put("contacts.kinds", [2]), "contacts.body_curvatures must be ..., got 0 numbers"),
    (
        from_geometry,
        "since body '' has no shape ... body.NAME.sphere: [0.03], or give contacts",
        "NO_CONTACT",
    ),
    (put("contact_source", 0), "contacts.positions must be ..., got [0.0, 0.0, -1.0]"),
    (put("velocity_tolerance", -0.5), "velocity_tolerance must be >= 0, got -0.5"),
]


def margin_length(request: Any) -> None:
    """A metric without sense, where it is used."""
    request.include_margins, request.margin_length = True, -2.0


def far_other(request: Any) -> None:
    """Strike a body whose velocity is infinite."""
    request.other_body_name, request.other_state = "brick", [BodyState()]
    request.other_state[0].linear_velocity.x = math.inf


def crooked_plane(request: Any) -> None:
    """A plane of motion whose normal is not a unit vector."""
    request.problem = request.PLANAR
    request.plane_normal.y = 2.0


def lying(request: Any, tilt: float = 0.0) -> Any:
    """Ask about the brick at rest on the floor, on one edge where it is tilted."""
    request.body_name, request.inertia, request.state = "brick", Inertia(), BodyState()
    request.contact_source, request.contacts = request.CONTACTS_FROM_GEOMETRY, ContactSet()
    request.state.pose.position.z = 0.025 * math.cos(tilt) + 0.075 * math.sin(tilt)
    orientation = request.state.pose.orientation
    orientation.y, orientation.w = math.sin(0.5 * tilt), math.cos(0.5 * tilt)
    return request


def on_an_edge_in_time(request: Any) -> None:
    lying(request, 0.1).several_contacts_law = request.SEQUENTIAL_IN_TIME
    request.strike_window = 0.2


def thrown_up_in_time(request: Any) -> None:
    """It comes back after 0.2 s."""
    request.several_contacts_law, request.strike_window = request.SEQUENTIAL_IN_TIME, 0.01
    request.state.linear_velocity.z = 1.0


def in_time(**fields: Any) -> Callable[[Any], None]:
    """Return what asks for strikes in time together with what they are not asked with."""

    def change(request: Any) -> None:
        request.several_contacts_law = request.SEQUENTIAL_IN_TIME
        for name, value in fields.items():
            setattr(request, name, value)

    return change


def touching(request: Any, count: int) -> Any:
    """Touch the floor at this many points of a circle."""
    angles = [2.0 * math.pi * i / count for i in range(count)]
    points = [number for each in angles for number in (math.cos(each), math.sin(each), -1.0)]
    request.contacts.positions, request.contacts.normals = points, [0.0, 0.0, 1.0] * count
    request.contacts.frictions, request.contacts.restitutions = [0.5] * count, [0.0] * count
    return request


def many_facets(request: Any) -> None:
    lying(request).problem = request.SPATIAL
    request.include_wrenches, request.friction_facets = True, 32


def strong_torque(request: Any) -> None:
    request.applied_wrench.torque.z, request.times = 1000.0, [60.0]


def endless_search(request: Any) -> None:
    """A body that spins for ever, never touching."""
    request.gravity, request.sampling, request.times = request.GRAVITY_NONE, request.UNTIL_PLANE, []
    request.duration, request.plane_normal.z, request.state.pose.position.z = 1e9, 1.0, 1.0
    request.state.angular_velocity.z = 10.0


def long_covariance(request: Any) -> None:
    request.state.covariance = (1e-6 * np.eye(12)).ravel().tolist()
    request.include_covariance, request.linear_drag = True, 0.5
    request.state.angular_velocity.z, request.times = 10.0, [25.0]


BEYOND_REASON = [
    (PredictImpact, lying, "touches 'floor' and does not approach it", "NO_CONTACT"),
    (PredictImpact, on_an_edge_in_time, "set hold_step to continue", "NO_CONTACT"),
    (PredictImpact, thrown_up_in_time, "comes back within the strike_window of 0.01 s", "SEPARATING"),
    (
        PredictImpact,
        in_time(problem=PredictImpact.Request.PLANAR),
        "problem must be ..., got PLANAR",
        "NOT_SUPPORTED",
    ),
    (PredictImpact, in_time(include_orders=True), "include_orders must be ..., got true", "NOT_SUPPORTED"),
    (
        PredictImpact,
        in_time(include_covariance=True),
        "include_covariance must be ..., got true",
        "NOT_SUPPORTED",
    ),
    (
        PredictContactMode,
        lambda request: setattr(touching(request, 65), "problem", request.SPATIAL),
        "contacts must be ..., got 65",
        "TOO_LARGE",
    ),
    (
        PredictContactMode,
        lambda request: setattr(touching(request, 17), "uncertainty_normals", [1e-6]),
        "17 contacts",
        "TOO_LARGE",
    ),
    (
        PredictContactMode,
        put("uncertainty_points", [1e-3, 1e-3]),
        "must be one number, or one for each of 1 contacts",
    ),
    (PredictContactMode, put("uncertainty_points", [-1e-3]), "uncertainty_points must be ..., got -0.001"),
    (PredictContactMode, many_facets, "fewer friction_facets", "TOO_LARGE"),
    (PredictTumbling, strong_torque, "no further than 6000 steps of the integrator"),
    (PredictTumbling, endless_search, "duration must be ..., got 1.59155e+09 turns"),
    (PredictTumbling, long_covariance, "times must be at most 30 with cov..., got 39.7887"),
]
"""Questions that make sense, and cannot be answered."""

OF_ONE_SERVICE = [
    (PredictTumbling, put("applied_wrench.force.x", math.nan), "applied_wrench.force"),
    (PredictContactMode, put("applied_wrench.torque.x", math.inf), "applied_wrench.torque"),
    (PredictTumbling, at_rate(-5.0, 1.0), "rate must be ..., got -5.0"),
    (PredictTumbling, at_rate(1000.0, 1e9), "1e+12 samples", "TOO_LARGE"),
    (
        PredictImpact,
        put("contacts.restitutions", []),
        "contacts.restitutions must be in [0, 1] at each contact of an impact, got none",
    ),
    (
        PredictContactMode,
        put("friction_facets", 2),
        "friction_facets must be a whole number >= 3 and <= 32..., got 2",
    ),
    (PredictContactMode, margin_length, "margin_length must be ..., got -2"),
    (PredictImpact, put("state.linear_velocity.z", 1.0), "v_n = 1 m/s", "SEPARATING"),
    (PredictImpact, put("include_covariance", value=True), "state.covariance must be ..., got none"),
    (
        PredictImpact,
        put("other_body_name", "brick"),
        "none has been received on /brick/odometry (0 pub",
        "NO_STATE",
    ),
    (PredictImpact, far_other, "other_state[0].linear_velocity must be finite, got [inf 0. 0.]"),
    (PredictImpact, put("other_body_name", "cat"), "got 'cat'", "UNKNOWN_BODY"),
    (PredictImpact, put("other_inertia.m", -1.0), "other_inertia.m must be ..., got -1.0"),
    (PredictImpact, crooked_plane, "plane_normal must be ..., got [0.0, 2.0, 0.0] of norm 2"),
    (PredictTumbling, put("times", [0.0, -0.1]), "times[1] must be ascending..., got 0.1 s before times[0]"),
    (PredictTumbling, put("times", [-0.1, 0.1]), "times[0] must be >= 0..., got -0.1"),
    (PredictTumbling, put("times", []), "times must be at least one time..., got none"),
    (PredictTumbling, put("times", [0.0, math.nan]), "times"),
    (PredictTumbling, put("fit_window", 0.1), "fit_window must be left out unless..., got 0.1"),
    (PredictTumbling, put("linear_drag", -0.1), "linear_drag must be >= 0..., got -0.1"),
    (
        PredictTumbling,
        until_contact,
        "body '' must have ... body.NAME.inertia: [0.0] and body.NAME.sphere",
        "NO_CONTACT",
    ),
    (PredictTumbling, put("sampling", 3), "times must be left out unless..., got [0.0, 0.1]"),
    (PredictTumbling, put("sampling", 4), "plane_normal must be ..., got [0.0, 0.0, 0.0] of norm 0"),
]

CASES = [
    *BEYOND_REASON,
    *OF_ONE_SERVICE,
    *[(service, *case) for service in SERVICES for case in EVERY_SERVICE],
    *[(service, *case) for service in (PredictContactMode, PredictImpact) for case in CONTACTS],
]


def says_nothing(answer: Any) -> bool:
    """Whether no field of a response whose status is not OK reads as an answer, as some of zero would."""
    if isinstance(answer, PredictContactMode.Response):
        return {answer.verdict, answer.verdict_after_impact} == {answer.NO_ANSWER}
    if isinstance(answer, PredictImpact.Response):
        impact = answer.impact
        return {impact.outcome, impact.sequence_end} == {impact.NO_ANSWER} and answer.time_to_contact == -1.0
    if isinstance(answer, PredictTumbling.Response):
        return math.isnan(answer.event_time)
    if isinstance(answer, PredictToss.Response):
        return (answer.toss.end, answer.toss.end_time) == (answer.toss.NO_ANSWER, -1.0)
    return True


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0].__name__}: {case[2][:40]}")
def test_bad_input_is_named_and_the_next_good_request_answered(client: Client, case: tuple[Any, ...]) -> None:
    service, change, words, *code = case
    request = good(service)
    change(request)
    answer = client.ask(request)
    assert answer.status == getattr(answer, *(code or ["INVALID_FIELD"])), answer.message
    assert says(answer.message, words)
    assert says_nothing(answer)
    after = client.ask(good(service))
    assert (after.status, after.message) == (after.OK, "")


INTERFACES = Path(__file__).parents[2] / "contact_dynamics_interfaces" / "srv"


def choices_of(service: Any) -> Iterator[tuple[str, list[str]]]:
    """The fields of a request that take one of its constants, with those constants, from the interface."""
    constants: list[str] = []
    text = (INTERFACES / f"{service.__name__}.srv").read_text(encoding="utf-8")
    for line in text.split("\n---")[0].splitlines():
        words = line.split("#")[0].split()
        if words[:1] == ["uint8"] and "=" in words:
            constants.append(f"{words[1]} ({words[3]})")
        elif words[:1] == ["uint8"]:
            yield words[1], constants
            constants = []


CHOICES = [(service, field, names) for service in SERVICES for field, names in choices_of(service)]


def test_the_interfaces_choices_were_found() -> None:
    assert {field for _, field, _ in CHOICES} == {
        "state_source",
        "contact_source",
        "gravity",
        "problem",
        "restitution_law",
        "several_contacts_law",
        "sampling",
    }


@pytest.mark.parametrize(("service", "field", "names"), CHOICES)
@pytest.mark.parametrize("value", [5, 250])
def test_an_unknown_constant_is_refused_with_the_known_ones(
    client: Client, service: Any, field: str, names: list[str], value: int
) -> None:
    request = good(service)
    setattr(request, field, value)
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD, answer.message
    assert says(answer.message, f"{field} must be ..., got {value}")
    assert len(names) >= 2
    assert all(name in answer.message for name in names)


@pytest.mark.parametrize("service", SERVICES)
def test_what_was_found_is_quoted_in_part_if_it_is_long(client: Client, service: Any) -> None:
    request = good(service)
    request.state.header.frame_id = "x" * 1_000_000
    response = client.ask(request)
    assert response.status == response.FRAME_MISMATCH
    assert says(response.message, "state.header.frame_id must be ..., got 'xxx")
    assert len(response.message) < 2100


@pytest.mark.parametrize("service", [*SERVICES, PredictToss])
def test_no_state_published_yet(client: Client, service: Any) -> None:
    request = service.Request(body_name="brick")
    if service is PredictTumbling:
        request.times = [0.0]
    answer = client.ask(request)
    assert answer.status == answer.NO_STATE
    assert "no state of 'brick': none has been received on /brick/odometry (0 publishers)" in answer.message
    assert says_nothing(answer)


def test_a_row_that_is_not_allowed_is_named(client: Client) -> None:
    count = 9
    states = BodyStates(
        positions=[0.0] * 3 * count,
        orientations=[0.0, 0.0, 0.0, 1.0] * count,
        linear_velocities=[0.0, 0.0, -1.0] * count,
        angular_velocities=[0.0] * 3 * count,
    )
    for field, value, words in (
        (
            "states.orientations",
            [0.0, 0.0, 0.0, 0.5] * count,
            "[0] must be a unit..., got [0.0, 0.0, 0.0, 0.5]",
        ),
        ("frictions", [0.1, 0.2], " must be 9, or one for all..., got 2 rows"),
        ("states.linear_velocities", [0.0] * 4, " must be rows of 3, got 4 numbers"),
    ):
        request = PredictImpactBatch.Request(body_name="brick", states=copy(states), restitutions=[0.5])
        request.contact_positions, request.contact_normals = [0.0, 0.0, -0.1] * count, [0.0, 0.0, 1.0]
        request.frictions = [0.3]
        put(field, value)(request)
        answer = client.ask(request)
        assert answer.status == answer.INVALID_FIELD
        assert says(answer.message, f"{field}{words}")
