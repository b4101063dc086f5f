"""Impacts over the service: two bodies, several contacts at once, the next landing, beside known answers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from geometry_msgs.msg import Vector3

from contact_dynamics_interfaces.msg import BodyState, Impact
from contact_dynamics_interfaces.srv import PredictImpact
from running_server import Client, server_and_client

G = 9.80665


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    with server_and_client(Path(tmp_path_factory.mktemp("log"))) as client:
        yield client


def numbers(vector: Vector3) -> list[float]:
    return [vector.x, vector.y, vector.z]


def ball(request: PredictImpact.Request, *, mass: float = 1.0) -> None:
    """A solid ball of radius 0.1 m at the origin, one contact below it."""
    request.inertia.m = mass
    request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 0.4 * mass * 0.01
    request.state_source, request.contact_source = request.STATE_EXPLICIT, request.CONTACTS_EXPLICIT
    request.contacts.positions = [0.0, 0.0, -0.1]
    request.contacts.normals = [0.0, 0.0, 1.0]
    request.contacts.frictions = [0.5]
    request.contacts.restitutions = [0.8]


def test_a_ball_with_spin_grips_and_bounces_forward(client: Client) -> None:
    """Grip: the contact's tangential velocity v - w r ends at zero, (2/7) of it taken by the velocity."""
    request = PredictImpact.Request()
    ball(request)
    request.state.linear_velocity.z = -2.0
    request.state.angular_velocity.y = 10.0  # the contact moves by -w r = -1 m/s along x
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    after = answer.impact.state_after
    np.testing.assert_allclose(numbers(after.linear_velocity), [2.0 / 7.0, 0.0, 1.6], atol=1e-12)
    np.testing.assert_allclose(
        numbers(after.angular_velocity), [0.0, 10.0 - 5.0 * 10.0 / 7.0 * 1.0, 0.0], atol=1e-11
    )
    assert answer.impact.outcome == Impact.STICKS_IN_COMPRESSION
    assert not answer.impact.creates_energy


@pytest.mark.parametrize("law", ["POISSON", "NEWTON", "ENERGETIC"])
def test_two_balls_conserve_momentum_and_exchange_velocities(client: Client, law: str) -> None:
    """Central impact of equal balls with e = 1: Newton's cradle of two."""
    request = PredictImpact.Request()
    ball(request)
    request.restitution_law = getattr(request, law)
    request.contacts.restitutions = [1.0]
    request.state.linear_velocity.z = -3.0
    request.other_inertia = request.inertia
    other = BodyState()
    other.pose.position.z = -0.2
    other.linear_velocity.z = 1.0
    request.other_state = [other]
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    first, second = answer.impact.state_after, answer.impact.other_state_after[0]
    np.testing.assert_allclose(numbers(first.linear_velocity), [0.0, 0.0, 1.0], atol=1e-13)
    np.testing.assert_allclose(numbers(second.linear_velocity), [0.0, 0.0, -3.0], atol=1e-13)
    assert answer.impact.kinetic_energy_after == pytest.approx(5.0, abs=1e-12)
    assert answer.other_state_before[0].linear_velocity.z == 1.0


def falling_brick(*, height: float, tilt: float = 0.0) -> PredictImpact.Request:
    request = PredictImpact.Request(body_name="brick", state_source=PredictImpact.Request.STATE_EXPLICIT)
    request.state.pose.position.z = height
    request.state.pose.orientation.y, request.state.pose.orientation.w = (
        math.sin(tilt / 2),
        math.cos(tilt / 2),
    )
    return request


def test_a_brick_that_lands_flat_strikes_with_four_corners(client: Client) -> None:
    request = falling_brick(height=0.025 + 0.5 * G * 0.3**2)
    request.several_contacts_law = request.SIMULTANEOUS
    request.restitution_law = request.NEWTON
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert answer.time_to_contact == pytest.approx(0.3, abs=1e-12)
    assert len(answer.contacts.frictions) == 4
    after = answer.impact.state_after
    np.testing.assert_allclose(numbers(after.linear_velocity), [0.0, 0.0, 0.45 * G * 0.3], atol=1e-9)
    np.testing.assert_allclose(numbers(after.angular_velocity), 0.0, atol=1e-9)
    assert answer.impact.outcome == Impact.NOT_TOLD
    assert list(answer.impact.path) == []


def test_in_sequence_no_corner_approaches_afterwards_and_the_orders_spread(client: Client) -> None:
    request = falling_brick(height=0.025 + 0.5 * G * 0.3**2)
    request.want_orders = True
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    impact = answer.impact
    assert impact.converged
    assert np.array(impact.contact_velocities_after).reshape(-1, 3)[:, 2].min() >= -1e-8
    impulse = np.array(impact.impulses).reshape(-1, 3).sum(axis=0)
    gained = np.array(numbers(impact.state_after.linear_velocity)) - [0.0, 0.0, -G * 0.3]
    np.testing.assert_allclose(impulse, 0.4 * gained, atol=1e-12)
    outcomes = np.array(impact.order_velocities).reshape(-1, 6)
    assert len(impact.orders) == len(outcomes) > 1
    assert np.ptp(outcomes, axis=0).max() > 1e-3  # mechanics does not decide, and the answer says so
    path = np.array(impact.path).reshape(-1, 3)
    assert len(path) == len(impact.path_events) == len(impact.path_contacts)


def test_a_brick_on_its_corner_lands_with_that_corner(client: Client) -> None:
    request = falling_brick(height=1.0, tilt=0.6)
    request.state.angular_velocity.x = 3.0
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert len(answer.contacts.frictions) == 1
    assert answer.contacts.surface_names == ["floor"]
    assert abs(answer.contacts.positions[2]) < 1e-9
    assert answer.state_before.header.stamp.nanosec == pytest.approx(answer.time_to_contact * 1e9, abs=1.0)
    assert answer.impact.contact_velocities_after[2] > 0.0
    assert answer.impact.kinetic_energy_after < answer.impact.kinetic_energy_before


def test_a_brick_at_rest_strikes_nothing(client: Client) -> None:
    answer = client.ask(falling_brick(height=0.025))
    assert answer.status == answer.NO_CONTACT
    assert "touches 'floor' and does not approach it" in answer.message


def test_beyond_the_horizon_nothing_is_struck(client: Client) -> None:
    request = falling_brick(height=100.0)
    request.horizon = 0.5
    answer = client.ask(request)
    assert answer.status == answer.NO_CONTACT
    assert "touches no surface within the horizon of 0.5 s" in answer.message
