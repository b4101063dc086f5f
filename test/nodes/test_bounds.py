# SPDX-License-Identifier: Apache-2.0
"""Questions that once silenced the server, over real DDS: each is refused by name, the next one answered."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import Odometry

from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling
from message_words import says
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg
from running_server import PATIENT, Client, server_and_client


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    with server_and_client(Path(tmp_path_factory.mktemp("log")), parameters=[PATIENT]) as client:
        yield client


def put_fast_spin(vector: Any) -> None:
    vector.x, vector.y, vector.z = 1e9, 1e8, 1e8


def fast_spin() -> Any:
    request = explicit(PredictImpact)
    request.state.pose.position.z = 1.0
    put_fast_spin(request.state.angular_velocity)
    return request


def thousand_contacts() -> Any:
    request = explicit(PredictImpact)
    request.state.linear_velocity.x, request.state.linear_velocity.z = 1.0, -1.0
    velocity = request.state.angular_velocity
    velocity.x, velocity.y, velocity.z = 1.0, 2.0, 3.0
    request.contact_source, request.several_contacts_law = request.CONTACTS_EXPLICIT, request.SIMULTANEOUS
    angles = np.linspace(0.0, 2.0 * np.pi, 1000, endpoint=False)
    points = np.column_stack([0.05 * np.cos(angles), 0.04 * np.sin(angles), 0.0 * angles])
    request.contacts.positions = points.ravel().tolist()
    request.contacts.normals = [0.0, 0.0, 1.0] * 1000
    request.contacts.frictions, request.contacts.restitutions = [0.3] * 1000, [0.5] * 1000
    return request


def carried_under_strong_drag() -> Any:
    request = explicit(PredictTumbling)
    request.state.angular_velocity.x = 1.0
    request.state.covariance = (1e-6 * np.eye(12)).ravel().tolist()
    request.linear_drag, request.include_covariance = 1000.0, True
    request.times = []
    request.sampling, request.duration, request.rate = request.AT_RATE, 10.0, 10.0
    return request


def explicit(service: Any) -> Any:
    """A question about the brick on the floor."""
    request = service.Request(body_name="brick")
    request.state_source = request.STATE_EXPLICIT
    request.state.pose.position.z = 0.025
    if service is PredictTumbling:
        request.times = [0.0]
    return request


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (fast_spin, "horizon must be ..., got more than 50000 steps of the search"),
        (thousand_contacts, "contacts must be ..., got 1000 contacts at once"),
        (carried_under_strong_drag, "times must be ..., got 10 s, which takes"),
    ],
)
def test_a_question_without_end_is_refused_and_the_next_is_answered(
    client: Client, make: Callable[[], Any], words: str
) -> None:
    answer = client.ask(make())
    assert answer.status == answer.TOO_LARGE, answer.message
    assert says(answer.message, words)
    after = client.ask(explicit(PredictTumbling))
    assert after.status == after.OK, after.message


def test_a_published_spin_without_sense_is_not_believed_and_silences_nobody(client: Client) -> None:
    states = client.publisher(Odometry, "/brick/odometry")
    msg = Odometry(child_frame_id="brick")
    msg.header.frame_id = "world"
    msg.pose.pose.position.z = 1.0
    put_fast_spin(msg.twist.twist.angular)
    sane_ns = time.time_ns()
    for stamp_ns, spin in ((sane_ns, 1.0), (sane_ns + 1, 1e9)):
        msg.header.stamp = stamp_to_msg(stamp_ns)
        msg.twist.twist.angular.x = spin
        msg.twist.twist.angular.y = msg.twist.twist.angular.z = 0.1 * spin
        states.publish(msg)
    answers: list[Any] = []

    def came() -> bool:
        answers.append(client.ask(PredictTumbling.Request(body_name="brick", times=[0.0])))
        return answers[-1].status == answers[-1].OK

    client.spin_until(came)
    assert stamp_ns_from_msg(answers[-1].state.header.stamp) == sane_ns


def test_valid_questions_that_were_internal_errors_are_answered_or_refused(client: Client) -> None:
    leaving = explicit(PredictContactMode)
    leaving.state.linear_velocity.z, leaving.include_margins = 0.5, True
    answer = client.ask(leaving)
    assert answer.status == answer.OK, answer.message
    window = client.ask(PredictTumbling.Request(body_name="brick", fit_window=1e300))
    assert window.status != window.INTERNAL_ERROR, window.message
    far = explicit(PredictImpact)
    far.contact_source = far.CONTACTS_EXPLICIT
    far.state.linear_velocity.z = -1.0
    far.contacts.positions, far.contacts.normals = [1.7e308, 0.0, 0.0], [0.0, 0.0, 1.0]
    far.contacts.frictions, far.contacts.restitutions = [0.3], [0.5]
    refused = client.ask(far)
    assert refused.status == refused.INVALID_FIELD, refused.message
    assert says(refused.message, "contacts.positions must be ..., got 1.7e+308 m")
