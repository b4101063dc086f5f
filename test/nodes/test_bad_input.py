# SPDX-License-Identifier: Apache-2.0
"""Bad input over the services: each gets its error by field and value, and the node serves on."""

from __future__ import annotations

import math
import signal
from collections.abc import Callable, Iterator
from copy import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Inertia, Point
from nav_msgs.msg import Odometry

from changed_requests import put
from contact_dynamics_interfaces.msg import BodyState, BodyStates, ContactSet
from contact_dynamics_interfaces.srv import (
    PredictContactMode,
    PredictImpact,
    PredictImpactBatch,
    PredictToss,
    PredictTumbling,
    PredictTumblingBatch,
)
from message_words import says
from running_server import ROOT, Client, process

SERVICES = (PredictContactMode, PredictImpact, PredictTumbling)
ARGUMENTS = ("--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args")


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


def from_geometry(request: Any) -> None:
    """Ask for contacts of a body without a shape."""
    request.contact_source, request.contacts = request.CONTACTS_FROM_GEOMETRY, ContactSet()


def until_contact(request: Any) -> None:
    """Ask when a body without a shape lands."""
    request.sampling, request.times = request.UNTIL_CONTACT, []


def unread_state(request: Any) -> None:
    """Fill in a state and ask about the newest one of a known body."""
    request.body_name = "brick"
    request.state_source, request.state.pose.position.z = request.STATE_NEWEST, 0.5


def unchecked(z: Any) -> Point:
    """Return a point as a client makes it that has not set ROS_PYTHON_CHECK_FIELDS."""
    point = Point(check_fields=False)
    point.z = z
    return point


EVERY_SERVICE = [
    (
        unread_state,
        "INVALID_FIELD",
        "state.pose.position.z must be left out unless state_source is STATE_EXPLICIT (1), got 0.5",
    ),
    (
        put("state.pose.position", unchecked(2)),
        "INVALID_FIELD",
        "state.pose.position.z must be a number of normal size, got ... (rclpy sends this for an int",
    ),
    (
        put("state.pose.position", unchecked(np.float32(0.5))),
        "INVALID_FIELD",
        "state.pose.position.z must be a number of normal size, got 5.2",
    ),
    (put("state.covariance", [5e-324] * 144), "INVALID_FIELD", "state.covariance[0] must be a number"),
    (put("state.pose.position.x", math.nan), "INVALID_FIELD", "got [nan ... ROS_PYTHON_CHECK_FIELDS=1"),
    (put("inertia.m", math.nan), "INVALID_FIELD", "got nan (rclpy sends this for an int"),
    (put("inertia.m", -1.0), "INVALID_FIELD", "inertia.m must be > 0..., got -1.0"),
    (put("inertia.m", math.nan), "INVALID_FIELD", "inertia.m must be ..., got nan"),
    (put("inertia.m", math.inf), "INVALID_FIELD", "inertia.m must be ..., got inf"),
    (put("inertia.m", 0.0), "INVALID_FIELD", "inertia.m must be ..., got 0.0"),
    (put("inertia.ixx", 3.0), "INVALID_FIELD", "I1 + I2 >= I3"),
    (put("inertia.ixy", 5.0), "INVALID_FIELD", "positive definite"),
    (put("inertia.com.x", math.nan), "INVALID_FIELD", "inertia.com"),
    (
        put("state.pose.orientation.w", 0.5),
        "INVALID_FIELD",
        "state.pose.orientation must be ..., got [0.0, 0.0, 0.0, 0.5] of norm 0.5",
    ),
    (put("state.pose.orientation.w", 0.0), "INVALID_FIELD", "must be a unit quaternion"),
    (put("state.pose.position.x", math.nan), "INVALID_FIELD", "state.pose.position must be"),
    (put("state.linear_velocity.y", math.inf), "INVALID_FIELD", "state.linear_velocity must be"),
    (put("state.angular_velocity.z", math.nan), "INVALID_FIELD", "state.angular_velocity must be"),
    (put("state.header.frame_id", "map"), "FRAME_MISMATCH", "must be 'world'..., got 'map'"),
    (
        put("state.covariance", [0.0] * 36),
        "INVALID_FIELD",
        "state.covariance must be ..., got 36 numbers",
    ),
    (put("body_name", "cat"), "UNKNOWN_BODY", "must be one of the known bodies ('brick'), got 'cat'"),
    (put("body_name", "x" * 1000), "TOO_LARGE", "body_name must be ..., got 1000 characters"),
    (put("state_source", 7), "INVALID_FIELD", "state_source must be ..., got 7"),
    (published, "INVALID_FIELD", "body_name must be ..., got nothing"),
]
CONTACTS = [
    (
        put("contacts.normals", [0.0, 0.0, 0.0]),
        "INVALID_FIELD",
        "contacts.normals[0] must be a unit..., got [0.0, 0.0, 0.0]",
    ),
    (put("contacts.normals", [0.0, math.nan, 1.0]), "INVALID_FIELD", "contacts.normals"),
    (put("contacts.normals", [0.0, 1.0]), "INVALID_FIELD", "contacts.normals must be 3..., got 2 numbers"),
    (put("contacts.positions", []), "INVALID_FIELD", "contacts.positions must be 3..., got 0 numbers"),
    (
        put("contacts.frictions", [-0.1]),
        "INVALID_FIELD",
        "contacts.frictions[0] must be >= 0..., got -0.1",
    ),
    (put("contacts.frictions", [math.nan]), "INVALID_FIELD", "contacts.frictions"),
    (
        put("contacts.restitutions", [1.5]),
        "INVALID_FIELD",
        "contacts.restitutions[0] must be in [0, 1]..., got 1.5",
    ),
    (put("contacts.restitutions", [-0.5]), "INVALID_FIELD", "contacts.restitutions[0]"),
    (
        put("contacts.surface_velocities", [1.0, 0.0]),
        "INVALID_FIELD",
        "contacts.surface_velocities must be 3",
    ),
    (moving_in_a_plane, "NOT_SUPPORTED", "contacts must have surfaces at rest in a plane of motion"),
    (put("contacts.kinds", [3]), "INVALID_FIELD", "contacts.kinds[0] must be ..., got 3"),
    (put("contacts.kinds", [2]), "INVALID_FIELD", "contacts.body_curvatures must be ..., got 0 numbers"),
    (put("contact_source", 9), "INVALID_FIELD", "contact_source must be ..., got 9"),
    (
        from_geometry,
        "NO_CONTACT",
        "since body '' has no shape ... body.NAME.sphere: [0.03], or give contacts",
    ),
    (
        put("contact_source", 0),
        "INVALID_FIELD",
        "contacts.positions must be ..., got [0.0, 0.0, -1.0]",
    ),
    (put("velocity_tolerance", -0.5), "INVALID_FIELD", "velocity_tolerance must be >= 0, got -0.5"),
    (put("velocity_tolerance", math.nan), "INVALID_FIELD", "velocity_tolerance must be ..., got nan"),
    (put("problem", 9), "INVALID_FIELD", "problem must be ..., got 9"),
]


def out_of_plane(request: Any) -> None:
    """Spin about an axis in the plane: the contact moves out of it by 1 m/s per rad/s."""
    request.problem = request.PLANAR
    request.plane_normal.y = 1.0
    request.state.angular_velocity.x = 0.25


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
    (PredictImpact, lying, "NO_CONTACT", "touches 'floor' and does not approach it"),
    (PredictImpact, on_an_edge_in_time, "NO_CONTACT", "set hold_step to continue"),
    (PredictImpact, thrown_up_in_time, "SEPARATING", "comes back within the strike_window of 0.01 s"),
    (
        PredictImpact,
        in_time(problem=PredictImpact.Request.PLANAR),
        "NOT_SUPPORTED",
        "problem must be ..., got PLANAR",
    ),
    (PredictImpact, in_time(include_orders=True), "NOT_SUPPORTED", "include_orders must be ..., got true"),
    (
        PredictImpact,
        in_time(include_covariance=True),
        "NOT_SUPPORTED",
        "include_covariance must be ..., got true",
    ),
    (
        PredictContactMode,
        lambda request: setattr(touching(request, 65), "problem", request.SPATIAL),
        "TOO_LARGE",
        "contacts must be ..., got 65",
    ),
    (
        PredictContactMode,
        lambda request: setattr(touching(request, 17), "uncertainty_normals", [1e-6]),
        "TOO_LARGE",
        "17 contacts",
    ),
    (
        PredictContactMode,
        put("uncertainty_points", [1e-3, 1e-3]),
        "INVALID_FIELD",
        "must be one number, or one for each of 1 contacts",
    ),
    (
        PredictContactMode,
        put("uncertainty_points", [-1e-3]),
        "INVALID_FIELD",
        "uncertainty_points must be ..., got -0.001",
    ),
    (PredictContactMode, many_facets, "TOO_LARGE", "fewer friction_facets"),
    (PredictTumbling, strong_torque, "INVALID_FIELD", "no further than 6000 steps of the integrator"),
    (PredictTumbling, endless_search, "INVALID_FIELD", "duration must be ..., got 1.59155e+09 turns"),
    (PredictTumbling, long_covariance, "INVALID_FIELD", "times must be at most 30 with cov..., got 39.7887"),
]
"""Questions that make sense, and cannot be answered."""

CASES = [
    *BEYOND_REASON,
    *[(service, *case) for service in SERVICES for case in EVERY_SERVICE],
    *[(service, *case) for service in (PredictContactMode, PredictImpact) for case in CONTACTS],
    *[
        (
            service,
            out_of_plane,
            "OUT_OF_PLANE",
            "state must be ..., got 0.25 m/s out of the plane with normal [0.0, 1.0, 0.0]",
        )
        for service in (PredictContactMode, PredictImpact)
    ],
    (
        PredictImpact,
        put("contacts.restitutions", []),
        "INVALID_FIELD",
        "contacts.restitutions must be in [0, 1] at each contact of an impact, got none",
    ),
    (PredictContactMode, put("applied_wrench.force.x", math.nan), "INVALID_FIELD", "applied_wrench.force"),
    (
        PredictContactMode,
        put("friction_facets", 2),
        "INVALID_FIELD",
        "friction_facets must be a whole number >= 3 and <= 32..., got 2",
    ),
    (
        PredictContactMode,
        put("friction_facets", 33),
        "INVALID_FIELD",
        "friction_facets must be ..., got 33",
    ),
    (PredictContactMode, margin_length, "INVALID_FIELD", "margin_length must be ..., got -2"),
    (PredictContactMode, put("gravity", 5), "INVALID_FIELD", "gravity must be ..., got 5"),
    (PredictImpact, put("state.linear_velocity.z", 1.0), "SEPARATING", "v_n = 1 m/s"),
    (PredictImpact, put("restitution_law", 3), "INVALID_FIELD", "restitution_law must be ..., got 3"),
    (
        PredictImpact,
        put("include_covariance", value=True),
        "INVALID_FIELD",
        "state.covariance must be ..., got none",
    ),
    (
        PredictImpact,
        put("other_body_name", "brick"),
        "NO_STATE",
        "none has been received on /brick/odometry (0 pub",
    ),
    (
        PredictImpact,
        far_other,
        "INVALID_FIELD",
        "other_state[0].linear_velocity must be finite, got [inf 0. 0.]",
    ),
    (PredictImpact, put("other_body_name", "cat"), "UNKNOWN_BODY", "got 'cat'"),
    (PredictImpact, put("other_inertia.m", -1.0), "INVALID_FIELD", "other_inertia.m must be ..., got -1.0"),
    (PredictImpact, put("other_inertia.m", 1.0), "INVALID_FIELD", "positive definite"),
    (
        PredictImpact,
        put("several_contacts_law", 7),
        "INVALID_FIELD",
        "several_contacts_law must be ..., got 7",
    ),
    (
        PredictImpact,
        crooked_plane,
        "INVALID_FIELD",
        "plane_normal must be ..., got [0.0, 2.0, 0.0] of norm 2",
    ),
    (
        PredictTumbling,
        put("times", [0.0, -0.1]),
        "INVALID_FIELD",
        "times[1] must be ascending..., got 0.1 s before times[0]",
    ),
    (
        PredictTumbling,
        put("times", [-0.1, 0.1]),
        "INVALID_FIELD",
        "times[0] must be >= 0..., got -0.1",
    ),
    (PredictTumbling, put("times", []), "INVALID_FIELD", "times must be at least one time..., got none"),
    (PredictTumbling, put("times", [0.0, math.nan]), "INVALID_FIELD", "times"),
    (
        PredictTumbling,
        put("fit_window", 0.1),
        "INVALID_FIELD",
        "fit_window must be left out unless..., got 0.1",
    ),
    (
        PredictTumbling,
        put("linear_drag", -0.1),
        "INVALID_FIELD",
        "linear_drag must be >= 0..., got -0.1",
    ),
    (
        PredictTumbling,
        until_contact,
        "NO_CONTACT",
        "body '' must have ... body.NAME.inertia: [0.0] and body.NAME.sphere",
    ),
    (
        PredictTumbling,
        put("sampling", 3),
        "INVALID_FIELD",
        "times must be left out unless..., got [0.0, 0.1]",
    ),
    (
        PredictTumbling,
        put("sampling", 4),
        "INVALID_FIELD",
        "plane_normal must be ..., got [0.0, 0.0, 0.0] of norm 0",
    ),
    (PredictTumbling, put("sampling", 17), "INVALID_FIELD", "sampling must be ..., got 17"),
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


@pytest.mark.parametrize(
    ("service", "change", "code", "words"), CASES, ids=lambda value: getattr(value, "__name__", None)
)
def test_bad_input_is_named_and_the_next_good_request_answered(
    client: Client, service: Any, change: Callable[[Any], None], code: str, words: str
) -> None:
    request = good(service)
    change(request)
    answer = client.ask(request)
    assert answer.status == getattr(answer, code), answer.message
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


def bad_rate(request: Any) -> None:
    request.sampling, request.times = request.AT_RATE, []
    request.rate = -5.0


def too_long(request: Any) -> None:
    request.sampling, request.times = request.AT_RATE, []
    request.rate, request.duration = 1000.0, 1e9


@pytest.mark.parametrize(
    ("change", "code", "words"),
    [(bad_rate, "INVALID_FIELD", "rate must be ..., got -5.0"), (too_long, "TOO_LARGE", "1e+12 samples")],
)
def test_absurd_sampling(client: Client, change: Callable[[Any], None], code: str, words: str) -> None:
    request = good(PredictTumbling)
    change(request)
    answer = client.ask(request)
    assert answer.status == getattr(answer, code)
    assert says(answer.message, words)


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


def test_states_that_are_stale_or_make_no_sense(tmp_path: Path) -> None:
    """A stale state is refused with its age. One with a NaN, in another frame or too far away is not kept.

    Nor is one that spins beyond reason. NumPy once warned of each such state again after each answer, and of
    questions that overflow.
    """
    with process("server", *ARGUMENTS, "-p", f"log_directory:={tmp_path}", ready="ready") as server:
        client = Client()
        try:
            publish_nonsense(client)
            flood(client)
        finally:
            client.close()
        server.send_signal(signal.SIGINT)
        assert server.stdout is not None
        printed = server.stdout.read()
        assert "message ignored" in printed
        assert "RuntimeWarning" not in printed


def publish_nonsense(client: Client) -> None:
    publisher = client.publisher(Odometry, "/brick/odometry")
    nonsense = Odometry()
    nonsense.header.frame_id = "world"
    nonsense.header.stamp = client.node.get_clock().now().to_msg()
    nonsense.twist.twist.linear.x = math.nan
    elsewhere = Odometry()
    elsewhere.header.stamp = nonsense.header.stamp
    elsewhere.header.frame_id = "map"
    far = Odometry()
    far.header = nonsense.header
    far.pose.pose.position.x = 1e300
    spins = Odometry()
    spins.header = nonsense.header
    spins.twist.twist.angular.x = 1e9
    old = Odometry()
    old.header.frame_id = "world"
    old.header.stamp.sec = nonsense.header.stamp.sec - 3
    publisher.publish(b"\0\1\0\0no message at all")
    for each in (nonsense, elsewhere, far, spins, old):
        publisher.publish(each)
    request = PredictTumbling.Request(body_name="brick", times=[0.1])
    answers: list[Any] = []

    def stale() -> bool:
        answers.append(client.ask(request))
        return answers[-1].status == answers[-1].STALE_STATE

    client.spin_until(stale)
    assert all(answer.status in (answer.NO_STATE, answer.STALE_STATE) for answer in answers)
    assert says(answers[-1].message, "must be at most 0.5 s old (state_timeout), got")
    asked = PredictTumbling.Request(body_name="brick", times=[0.1])
    asked.state_source, asked.stamp = asked.STATE_AT_STAMP, old.header.stamp
    assert client.ask(asked).status == 0


def flood(client: Client) -> None:
    states = client.publisher(Odometry, "/brick/odometry")
    msg = Odometry(child_frame_id="brick")
    msg.header.frame_id, msg.header.stamp = "world", client.node.get_clock().now().to_msg()
    far = PredictTumblingBatch.Request(body_name="brick", times=[1e300])
    far.states = BodyStates(
        positions=[0.0, 0.0, 1.0],
        orientations=[0.0, 0.0, 0.0, 1.0],
        linear_velocities=[1e30, 0.0, -1.0],
        angular_velocities=[0.0, 3.0, 0.0],
    )
    for number in (math.inf, 1e308, math.nan):
        for _ in range(20):
            msg.twist.twist.linear.x = msg.twist.twist.angular.y = number
            msg.pose.covariance[0] = number
            states.publish(msg)
            assert client.ask(far).status != 0
