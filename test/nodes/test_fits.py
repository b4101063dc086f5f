# SPDX-License-Identifier: Apache-2.0
"""Fits to published states over the services."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from itertools import count
from pathlib import Path

import numpy as np
import pytest
from nav_msgs.msg import Odometry

from contact_dynamics_interfaces.srv import PredictTumbling
from message_words import says
from running_server import Client, server_and_client

G = 9.80665
RATE = 100.0
COUNT = 12  # states of a fit
BEGINS_NS = (time.time_ns() - 60_000_000_000 + each for each in count(0, 3_000_000_000))
"""When the states of a test begin: more than a fit looks back after those of the test before it."""


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    with server_and_client(Path(tmp_path_factory.mktemp("log"))) as client:
        yield client


def test_a_fit_to_the_last_states_does_not_care_for_a_bad_velocity(client: Client) -> None:
    """Exact poses of a free fall with spin about z, published with velocities that are all wrong."""
    publisher = client.publisher(Odometry, "/brick/odometry")
    begin_ns = next(BEGINS_NS)
    spin, rise = 4.0, 2.0
    for i in range(COUNT):
        t = i / RATE
        msg = Odometry()
        stamp_ns = begin_ns + round(1e9 * t)
        msg.header.stamp.sec, msg.header.stamp.nanosec = divmod(stamp_ns, 1_000_000_000)
        msg.header.frame_id = "world"
        msg.pose.pose.position.z = 1.0 + rise * t - 0.5 * G * t * t
        msg.pose.pose.orientation.z = math.sin(0.5 * spin * t)
        msg.pose.pose.orientation.w = math.cos(0.5 * spin * t)
        msg.twist.twist.linear.x = 9.0
        publisher.publish(msg)
    last = (COUNT - 1) / RATE
    request = PredictTumbling.Request(body_name="brick", fit_window=1.0, times=[0.0], include_covariance=True)
    request.state_source, request.stamp = request.STATE_AT_STAMP, msg.header.stamp
    answers = []

    def all_arrived() -> bool:
        answers.append(client.ask(request))
        return answers[-1].fit_count == COUNT

    client.spin_until(all_arrived)
    answer = answers[-1]
    assert answer.status == answer.OK, answer.message
    velocity, rate = answer.state.linear_velocity, answer.state.angular_velocity
    fitted = [velocity.x, velocity.y, velocity.z - (rise - G * last), rate.x, rate.y, rate.z - spin]
    # Stamps are whole nanoseconds: 0.5 ns of 3 m/s over 0.1 s, and rounding of the fit, are some 1e-7.
    np.testing.assert_allclose(fitted, 0.0, atol=1e-6)
    assert answer.fit_position_residual < 1e-8
    assert answer.fit_orientation_residual < 1e-8
    assert len(answer.trajectory.covariances) == 144
    at_stamp = PredictTumbling.Request.STATE_AT_STAMP
    raw = client.ask(
        PredictTumbling.Request(body_name="brick", times=[0.0], state_source=at_stamp, stamp=msg.header.stamp)
    )
    assert raw.state.linear_velocity.x != pytest.approx(0.0, abs=1.0)
    assert raw.fit_count == 0


def test_fits_are_of_flights_under_the_forces_asked_for(client: Client) -> None:
    """Poses of a body that floats: with gravity the fit finds it falling."""
    publisher = client.publisher(Odometry, "/brick/odometry")
    begin_ns = next(BEGINS_NS)
    for i in range(COUNT):
        msg = Odometry()
        msg.header.stamp.sec, msg.header.stamp.nanosec = divmod(begin_ns + i * 10_000_000, 1_000_000_000)
        msg.header.frame_id = "world"
        msg.pose.pose.position.z = 1.0 + 0.02 * i
        publisher.publish(msg)
    request = PredictTumbling.Request(body_name="brick", fit_window=0.115, times=[0.0])
    request.state_source, request.stamp = request.STATE_AT_STAMP, msg.header.stamp
    request.gravity = request.GRAVITY_NONE
    answers = []

    def all_arrived() -> bool:
        answers.append(client.ask(request))
        return answers[-1].fit_count == COUNT

    client.spin_until(all_arrived)
    assert answers[-1].fit_position_residual < 1e-8
    assert answers[-1].state.linear_velocity.z == pytest.approx(2.0, abs=1e-6)
    request.gravity = request.GRAVITY_AS_CONFIGURED
    falling = client.ask(request)
    assert falling.status == falling.NOT_IN_FLIGHT
    assert says(
        falling.message, "fit_window must be ..., got 12 states of a body that does not fall: it rests"
    )
    # What keeps it at its speed: a force as large as its weight, or as its weight and drag.
    request.applied_wrench.force.z = 0.4 * G
    held = client.ask(request)
    assert held.method == held.CLOSED_FORM
    assert held.fit_position_residual < 1e-8
    request.linear_drag, request.applied_wrench.force.z = 0.2, 0.4 * G + 0.2 * 2.0
    dragged = client.ask(request)
    assert dragged.status == dragged.OK, dragged.message
    assert (dragged.method, dragged.fit_count) == (dragged.INTEGRATED, 12)
    assert dragged.fit_position_residual < 1e-8
    assert dragged.state.linear_velocity.z == pytest.approx(2.0, abs=1e-6)


def test_a_window_that_holds_too_little_is_refused(client: Client) -> None:
    request = PredictTumbling.Request(body_name="brick", fit_window=1e-6, times=[0.0])
    answer = client.ask(request)
    assert answer.status in {answer.INVALID_FIELD, answer.STALE_STATE}
    if answer.status == answer.INVALID_FIELD:
        assert says(answer.message, "fit_window must be at least 3..., got 1 states")


def test_a_fit_keeps_the_direction_of_a_spin_of_more_than_half_a_turn_between_states(
    client: Client,
) -> None:
    """400 rad/s at 120 Hz is 0.53 turns from state to state: poses alone look like 354 rad/s backwards."""
    publisher = client.publisher(Odometry, "/brick/odometry")
    begin_ns = next(BEGINS_NS)
    rate, spin = 120.0, 400.0
    noise = np.random.default_rng(7).normal(scale=1.0, size=COUNT)  # rad/s, of a gyroscope
    for i in range(COUNT):
        t = i / rate
        msg = Odometry()
        msg.header.stamp.sec, msg.header.stamp.nanosec = divmod(begin_ns + round(1e9 * t), 1_000_000_000)
        msg.header.frame_id = "world"
        msg.pose.pose.position.z = 1.0 + 2.0 * t - 0.5 * G * t * t
        msg.pose.pose.orientation.z = math.sin(0.5 * spin * t)
        msg.pose.pose.orientation.w = math.cos(0.5 * spin * t)
        msg.twist.twist.linear.z = 2.0 - G * t
        msg.twist.twist.angular.z = spin + noise[i]
        publisher.publish(msg)
    request = PredictTumbling.Request(body_name="brick", fit_window=0.095, times=[0.0])
    request.state_source, request.stamp = request.STATE_AT_STAMP, msg.header.stamp
    answers = []

    def all_arrived() -> bool:
        answers.append(client.ask(request))
        return answers[-1].fit_count == COUNT

    client.spin_until(all_arrived)
    assert answers[-1].status == answers[-1].OK, answers[-1].message
    # Half a nanosecond of each stamp, over 0.09 s, turns by some 1e-6 of the rate.
    assert answers[-1].state.angular_velocity.z == pytest.approx(spin, rel=1e-5)
