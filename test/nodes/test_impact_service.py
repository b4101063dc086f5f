# SPDX-License-Identifier: Apache-2.0
"""Impacts over the service: two bodies, several contacts at once, the next landing, beside known answers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from geometry_msgs.msg import Vector3

from contact_dynamics_interfaces.msg import BodyState, Impact
from contact_dynamics_interfaces.srv import PredictImpact
from message_words import says
from running_server import Client

G = 9.80665


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
    request.include_orders = True
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


# Strikes in time


def rows(values: list[float], width: int) -> np.ndarray:
    return np.array(values).reshape(-1, width)


def tilted_brick_in_time(*, height: float = 0.3) -> PredictImpact.Request:
    """Tilted by 2 degrees about y: one edge lands, and the other a few milliseconds later."""
    request = falling_brick(height=height, tilt=0.035)
    request.several_contacts_law = request.SEQUENTIAL_IN_TIME
    return request


def test_a_tilted_brick_strikes_with_one_edge_and_then_with_the_other(client: Client) -> None:
    answer = client.ask(tilted_brick_in_time())
    assert answer.status == answer.OK, answer.message
    impact = answer.impact
    times = np.array(impact.strike_times)
    m = len(times)
    assert m > 3
    assert answer.problem == PredictImpact.Request.SPATIAL
    assert impact.several_contacts_law == PredictImpact.Request.SEQUENTIAL_IN_TIME
    assert times[0] == 0.0
    assert (np.diff(times) >= 0.0).all()
    assert 1e-3 < np.diff(times).max() < 0.05
    # All arrays have a row a strike, and contacts are those that the answer lists.
    contacts = rows(answer.contacts.positions, 3)
    assert len(contacts) > 2  # corners of both edges
    assert set(impact.strike_contacts) <= set(range(len(contacts)))
    assert answer.contacts.surface_names == ["floor"] * len(contacts)
    assert len(impact.strike_outcomes) == m
    positions, impulses = rows(impact.strike_positions, 3), rows(impact.strike_impulses, 3)
    before, after = rows(impact.strike_velocities_before, 6), rows(impact.strike_velocities_after, 6)
    assert len(positions) == len(impulses) == len(before) == len(after) == m
    assert abs(positions[:, 2]).max() < 2e-6
    # Corners that strike as one share an impulse, and have the same velocities before and after it.
    first = np.append(True, (np.diff(times) > 0.0) | (np.diff(before, axis=0) != 0.0).any(axis=1))
    of_group = np.add.reduceat(impulses, np.flatnonzero(first))
    np.testing.assert_allclose(0.4 * (after - before)[first, :3], of_group, atol=1e-12)
    assert 1 < first.sum() < m
    # Between strikes it falls freely.
    waits = np.diff(times[first])
    np.testing.assert_allclose(before[first][1:, 2] - after[first][:-1, 2], -G * waits, atol=1e-9)
    body = rows(impact.strike_body_positions, 3)[first]
    fall = after[first][:-1, 2] * waits - 0.5 * G * waits**2
    np.testing.assert_allclose(np.diff(body[:, 2]), fall, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(rows(impact.strike_body_orientations, 4), axis=1), 1.0)
    # What is said of the whole is what the strikes say.
    totals = np.zeros_like(contacts)
    np.add.at(totals, list(impact.strike_contacts), impulses)
    np.testing.assert_allclose(rows(impact.impulses, 3), totals, atol=1e-15)
    np.testing.assert_allclose(before[0, :3], numbers(answer.state_before.linear_velocity))
    np.testing.assert_allclose(after[-1, :3], numbers(impact.state_after.linear_velocity))
    stamps = [
        msg.header.stamp.sec + 1e-9 * msg.header.stamp.nanosec
        for msg in (answer.state_before, impact.state_after)
    ]
    assert stamps[0] == pytest.approx(answer.time_to_contact, abs=1e-8)
    assert stamps[1] - stamps[0] == pytest.approx(times[-1], abs=1e-8 * m)
    assert not impact.creates_energy
    assert len(impact.path_contacts) == len(impact.path_events) == len(rows(impact.path, 3))


def test_the_window_and_the_number_of_strikes_end_a_sequence(client: Client) -> None:
    request = tilted_brick_in_time()
    request.strike_window = 1e-4
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert answer.impact.sequence_end == Impact.NOTHING_STRIKES
    assert len(set(answer.impact.strike_contacts)) == 2  # the edge that landed
    request = tilted_brick_in_time()
    request.max_strikes = 1
    answer = client.ask(request)
    assert answer.impact.sequence_end == Impact.MAX_STRIKES
    assert not answer.impact.converged
    assert len(answer.impact.strike_times) == 2  # both corners of the edge, which strike as one


def test_a_ball_that_is_dropped_on_an_explicit_contact_comes_to_rest(client: Client) -> None:
    """All rebounds together take 2 e v / (g (1 - e))."""
    request = PredictImpact.Request()
    ball(request)
    request.several_contacts_law = request.SEQUENTIAL_IN_TIME
    request.contacts.restitutions = [0.5]
    request.state.linear_velocity.z = -0.2
    request.strike_window = 0.1
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    impact = answer.impact
    assert impact.sequence_end == Impact.CHATTERS
    assert list(impact.staying_contacts) == [0]
    assert impact.limit_time == pytest.approx(2.0 * 0.5 * 0.2 / (G * 0.5), abs=1e-11)
    flights = 2.0 * 0.2 * 0.5 ** np.arange(1, len(impact.strike_times)) / G
    np.testing.assert_allclose(np.diff(impact.strike_times), flights, atol=1e-11)
    assert answer.time_to_contact == 0.0


def test_without_restitution_the_contact_stays(client: Client) -> None:
    request = PredictImpact.Request()
    ball(request)
    request.several_contacts_law = request.SEQUENTIAL_IN_TIME
    request.contacts.restitutions = [0.0]
    request.state.linear_velocity.z = -0.2
    answer = client.ask(request)
    assert answer.impact.sequence_end == Impact.STAYS
    assert list(answer.impact.staying_contacts) == [0]
    assert answer.impact.limit_time == 0.0


def test_a_contact_that_leaves_strikes_when_it_comes_back(client: Client) -> None:
    """A body thrown up from the floor does not strike at once, which other laws refuse. In time it does."""
    request = PredictImpact.Request()
    ball(request)
    request.state.linear_velocity.z = 0.1
    assert client.ask(request).status == PredictImpact.Response.SEPARATING
    request.several_contacts_law = request.SEQUENTIAL_IN_TIME
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert answer.time_to_contact == pytest.approx(2.0 * 0.1 / G, abs=1e-12)
    assert answer.state_before.linear_velocity.z == pytest.approx(-0.1, abs=1e-12)
    request.strike_window = 0.01
    answer = client.ask(request)
    assert answer.status == answer.SEPARATING
    assert "comes back within the strike_window of 0.01 s" in answer.message


@pytest.mark.parametrize(
    ("field", "value", "expected"),
    [
        ("problem", PredictImpact.Request.PLANAR, "problem must be ..., got PLANAR"),
        ("include_orders", True, "include_orders must be ..., got true"),
        ("include_covariance", True, "include_covariance must be ..., got true"),
        ("other_body_name", "cat", "got 'cat'"),
    ],
)
def test_what_strikes_in_time_are_not_asked_with(
    client: Client, field: str, value: object, expected: str
) -> None:
    request = tilted_brick_in_time()
    setattr(request, field, value)
    answer = client.ask(request)
    assert answer.status in {answer.NOT_SUPPORTED, answer.UNKNOWN_BODY}
    assert says(answer.message, expected)


@pytest.mark.parametrize(("field", "found"), [("strike_window", -2.0), ("strike_window", math.nan)])
def test_a_window_that_is_none(client: Client, field: str, found: list[float]) -> None:
    request = tilted_brick_in_time()
    setattr(request, field, found)
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD
    assert f"{field} must be " in answer.message


# Several contacts in a plane, and between two bodies


def rocking_block(request: PredictImpact.Request) -> float:
    """Housner's block, turning about its left feet; return the share of spin that it keeps."""
    half_width, half_height, mass, w = 0.1, 0.4, 3.0, 2.0
    request.state_source, request.contact_source = request.STATE_EXPLICIT, request.CONTACTS_EXPLICIT
    request.inertia.m = mass
    request.inertia.ixx = request.inertia.iyy = mass * (half_width**2 + half_height**2) / 3.0
    request.inertia.izz = mass * 2.0 * half_width**2 / 3.0
    request.state.pose.position.z = half_height
    request.state.linear_velocity.x, request.state.linear_velocity.z = w * half_height, -w * half_width
    request.state.angular_velocity.y = w
    feet = [[x, y, 0.0] for x in (-half_width, half_width) for y in (-half_width, half_width)]
    request.contacts.positions = [x for foot in feet for x in foot]
    request.contacts.normals = [0.0, 0.0, 1.0] * 4
    request.contacts.frictions = [5.0] * 4
    request.contacts.restitutions = [0.0] * 4
    return 1.0 - 1.5 * half_width**2 / (half_width**2 + half_height**2)


@pytest.mark.parametrize("law", ["SEQUENTIAL", "SIMULTANEOUS"])
def test_several_contacts_in_a_plane(client: Client, law: str) -> None:
    """Housner 1963: a block that rocks over keeps 1 - 3/2 sin^2(alpha) of its spin."""
    request = PredictImpact.Request()
    kept = rocking_block(request)
    request.problem = request.PLANAR
    request.several_contacts_law = getattr(request, law)
    request.include_orders = True
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert answer.problem == request.PLANAR
    assert abs(answer.plane_normal.y) == 1.0
    after = answer.impact.state_after
    np.testing.assert_allclose(numbers(after.angular_velocity), [0.0, 2.0 * kept, 0.0], atol=1e-8)
    assert answer.impact.converged
    assert answer.impact.contact_velocities_after[2] > 0.0  # the left feet lift off
    outcomes = rows(answer.impact.order_velocities, 6)
    assert len(outcomes) == len(answer.impact.orders) > 1
    np.testing.assert_allclose(outcomes[:, 4], 2.0 * kept, atol=1e-8)


def test_feet_beside_the_plane_are_refused(client: Client) -> None:
    request = PredictImpact.Request()
    rocking_block(request)
    request.problem = request.PLANAR
    request.contacts.positions[1] = -0.03
    answer = client.ask(request)
    assert answer.status == answer.OUT_OF_PLANE
    assert "beside the plane" in answer.message


@pytest.mark.parametrize(("law", "restitution"), [("NEWTON", 0.5), ("POISSON", 0.5), ("POISSON", 1.0)])
def test_a_plate_that_falls_on_another_with_four_corners(
    client: Client, law: str, restitution: float
) -> None:
    """The impact is central by symmetry, so equal plates end with (1 - e)/2 and (1 + e)/2 of the velocity."""
    request = PredictImpact.Request()
    request.state_source, request.contact_source = request.STATE_EXPLICIT, request.CONTACTS_EXPLICIT
    request.restitution_law = getattr(request, law)
    request.several_contacts_law = request.SIMULTANEOUS
    request.inertia.m, request.inertia.ixx, request.inertia.iyy, request.inertia.izz = 2.0, 0.1, 0.1, 0.2
    request.other_inertia = request.inertia
    request.state.linear_velocity.z = -1.0
    other = BodyState()
    other.pose.position.z = -0.1
    request.other_state = [other]
    corners = [[x, y, -0.05] for x in (-0.2, 0.2) for y in (-0.2, 0.2)]
    request.contacts.positions = [x for corner in corners for x in corner]
    request.contacts.normals = [0.0, 0.0, 1.0] * 4
    request.contacts.frictions = [0.4] * 4
    request.contacts.restitutions = [restitution] * 4
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    first, second = answer.impact.state_after, answer.impact.other_state_after[0]
    share = 0.5 * (1.0 - restitution)
    np.testing.assert_allclose(numbers(first.linear_velocity), [0.0, 0.0, -share], atol=1e-11)
    np.testing.assert_allclose(numbers(second.linear_velocity), [0.0, 0.0, share - 1.0], atol=1e-11)
    np.testing.assert_allclose(numbers(second.angular_velocity), 0.0, atol=1e-10)
    np.testing.assert_allclose(rows(answer.impact.contact_velocities_after, 3)[:, 2], restitution, atol=1e-10)
    # In turn, corner by corner, momentum and angular momentum of the two stay as they are.
    request.several_contacts_law = request.SEQUENTIAL
    answer = client.ask(request)
    assert answer.impact.converged
    first, second = answer.impact.state_after, answer.impact.other_state_after[0]
    total = np.array(numbers(first.linear_velocity)) + numbers(second.linear_velocity)
    np.testing.assert_allclose(total, [0.0, 0.0, -1.0], atol=1e-12)
    assert answer.impact.kinetic_energy_after <= 1.0 + 1e-12
    request.include_orders = True
    answer = client.ask(request)
    assert answer.status == answer.NOT_SUPPORTED
    assert says(answer.message, "with a second body (other), problem must be")


def test_the_energetic_law_is_not_one_at_once(client: Client) -> None:
    request = falling_brick(height=0.1)
    request.several_contacts_law = request.SIMULTANEOUS
    request.restitution_law = request.ENERGETIC
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD
    assert says(
        answer.message, "restitution_law must be POISSON or NEWTON for SIMULTANEOUS..., got ENERGETIC"
    )


def test_over_a_corner_that_stays_it_goes_on_where_asked(client: Client) -> None:
    """The lower edge chatters to rest before the other one is down; held, the brick falls flat over it."""
    request = falling_brick(height=0.06, tilt=0.35)
    request.state.angular_velocity.z = 0.5  # so that no two corners strike at one instant
    request.several_contacts_law = request.SEQUENTIAL_IN_TIME
    request.strike_window = 0.1
    ended = client.ask(request)
    assert ended.status == ended.OK, ended.message
    assert ended.impact.sequence_end == Impact.CHATTERS
    request.hold_step = 0.001
    held = client.ask(request)
    assert held.status == held.OK, held.message
    done = len(ended.impact.strike_times)
    assert list(held.impact.strike_contacts)[:done] == list(ended.impact.strike_contacts)
    assert len(held.impact.strike_times) > done
    assert held.impact.sequence_end == Impact.STAYS
    assert len(held.impact.staying_contacts) >= 3  # it lies flat
    np.testing.assert_allclose(list(held.impact.strike_times)[:done], ended.impact.strike_times, atol=1e-12)
    request.hold_step = -0.001
    assert client.ask(request).status == held.INVALID_FIELD


def test_a_brick_that_tips_over_its_edge_strikes_when_it_is_down(client: Client) -> None:
    """It rests on one edge, tilted by 0.1: held there it falls about it, and the other edge strikes.

    The upper edge, twice as far from the lower one as the centre, falls with some 3/2 g where the lower
    one sticks and by more where it slides, so that free fall from its height takes about as long.
    """
    tilt = 0.1
    height = 0.025 * math.cos(tilt) + 0.075 * math.sin(tilt)
    request = falling_brick(height=height, tilt=tilt)
    request.several_contacts_law = request.SEQUENTIAL_IN_TIME
    request.strike_window = 0.2
    answer = client.ask(request)
    assert answer.status == answer.NO_CONTACT
    assert "hold_step continues beyond it" in answer.message
    request.hold_step = 0.001
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    fall = math.sqrt(2.0 * 0.15 * math.sin(tilt) / G)
    assert 0.7 * fall < answer.time_to_contact < 1.5 * fall
    first = answer.impact.strike_contacts[0]
    assert answer.contacts.positions[3 * first] < 0.0  # the edge that was up, at -x
    assert answer.impact.sequence_end == Impact.STAYS  # and then it lies flat
