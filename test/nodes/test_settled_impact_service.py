# SPDX-License-Identifier: Apache-2.0
"""A question about contact modes goes on to the impact that settles it, and to the modes after that."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from contact_dynamics_interfaces.msg import Impact
from contact_dynamics_interfaces.srv import PredictContactMode
from running_server import Client

THETA = math.radians(75.0)
SHORT = 1e-6  # relative: what a wrench does to jammed contacts in the short time that it acts for
PROBLEMS = ["PLANAR", "SPATIAL"]


def asking(problem: str, points: list[tuple[float, float]], normals: list[float], mu: float) -> Any:
    """A ball-like body of m = I = 1 at the origin that touches the world in the plane of x and z."""
    request = PredictContactMode.Request(include_impact=True)
    request.problem = getattr(request, problem)
    request.inertia.m = request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 1.0
    request.state_source, request.contact_source = request.STATE_EXPLICIT, request.CONTACTS_EXPLICIT
    request.contacts.positions = [number for x, z in points for number in (x, 0.0, z)]
    request.contacts.normals = [number for n_z in normals for number in (0.0, 0.0, n_z)]
    request.contacts.frictions = [mu] * len(points)
    request.contacts.restitutions = [0.0] * len(points)
    request.plane_normal.y = -1.0 if problem == "PLANAR" else 0.0
    return request


def rows(numbers: Any) -> np.ndarray:
    return np.array(numbers).reshape(-1, 3)


def vector(msg: Any) -> np.ndarray:
    return np.array([msg.x, msg.y, msg.z])


def slot(problem: str) -> Any:
    """A point of the body slides along a slot, and turning presses it against the sides."""
    request = asking(problem, [(1.0, -3.0)] * 2, [1.0, -1.0], 2.0)
    request.inertia.m = 2.0
    request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 1.0 / 3.0
    request.state.linear_velocity.x, request.state.linear_velocity.z = 2.0, 1.0
    request.state.angular_velocity.y = 1.0  # -1 in the plane
    request.gravity = request.GRAVITY_NONE
    request.applied_wrench.force.x = request.applied_wrench.force.z = 3.0
    request.applied_wrench.torque.y = -1.0
    return request


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize(("restitution", "after"), [(0.0, "f"), (0.5, "s")])
def test_the_inconsistent_rod_comes_to_rest_or_leaves(
    client: Client, problem: str, restitution: float, after: str
) -> None:
    tip = (-4.0 * math.cos(THETA), -4.0 * math.sin(THETA))
    request = asking(problem, [tip], [1.0], math.tan(math.radians(30.0)))
    request.contacts.restitutions = [restitution]
    request.state.linear_velocity.x = -1.0
    answer = client.ask(request)
    assert (answer.verdict, len(answer.modes)) == (answer.INCONSISTENT, 0)
    (impact,) = answer.impact
    assert impact.outcome == Impact.STICKS_IN_COMPRESSION
    assert impact.jams
    # Sticking throughout restitution too, by hand: K I = the change of the tip's velocity.
    x, z = tip
    K = np.array([[1.0 + z * z, -x * z], [-x * z, 1.0 + x * x]])
    compression = np.linalg.solve(K, [1.0, 0.0])
    normal = (1.0 + restitution) * compression[1]
    friction = (1.0 - K[0, 1] * normal) / K[0, 0]
    np.testing.assert_allclose(impact.impulses, [friction, 0.0, normal], atol=1e-9)
    assert answer.verdict_after_impact == answer.UNIQUE
    assert [mode.mode for mode in answer.modes_after_impact] == [after]


@pytest.mark.parametrize("problem", PROBLEMS)
def test_a_point_that_jams_in_a_slot_stops_dead(client: Client, problem: str) -> None:
    request = slot(problem)
    answer = client.ask(request)
    assert (answer.status, answer.message) == (answer.OK, "")
    assert answer.verdict == answer.INCONSISTENT
    (impact,) = answer.impact
    assert impact.converged
    assert impact.several_contacts_law == 1  # SIMULTANEOUS
    # By hand: the point's inverse inertia takes its velocity (-1, 0) to zero.
    x, z = 1.0, -3.0
    K = np.eye(2) / 2.0 + 3.0 * np.array([[z * z, -x * z], [-x * z, x * x]])
    expected = np.linalg.solve(K, [1.0, 0.0])
    total = rows(impact.impulses).sum(axis=0)
    np.testing.assert_allclose(total, [expected[0], 0.0, expected[1]], atol=SHORT)
    np.testing.assert_allclose(impact.contact_velocities_after, 0.0, atol=1e-9)
    after = impact.state_after
    np.testing.assert_allclose(vector(after.linear_velocity), [2.0, 0.0, 1.0] + total / 2.0, atol=1e-9)
    assert impact.kinetic_energy_after < impact.kinetic_energy_before
    assert not impact.creates_energy
    assert [mode.mode for mode in answer.modes_after_impact] == ["ff"]
    assert answer.verdict_after_impact == answer.UNIQUE


@pytest.mark.parametrize("problem", PROBLEMS)
def test_two_feet_that_land_strike_in_turn_and_every_order_is_told(client: Client, problem: str) -> None:
    request = asking(problem, [(-1.0, -1.0), (1.0, -1.0)], [1.0, 1.0], 0.0)
    request.state.linear_velocity.z = -1.0
    answer = client.ask(request)
    assert (answer.verdict, list(answer.approaching_contacts)) == (answer.IMPACT, [0, 1])
    (impact,) = answer.impact
    # Without friction, with m = I = 1, an impulse p at a foot changes its v_n by 2 p, and the other's not.
    np.testing.assert_allclose(rows(impact.impulses), [[0.0, 0.0, 0.5]] * 2, atol=1e-12)
    np.testing.assert_allclose(vector(impact.state_after.linear_velocity), 0.0, atol=1e-12)
    assert sorted(impact.orders) == ["", "0,1", "1,0"]  # both at once, and each first
    np.testing.assert_allclose(np.array(impact.order_velocities), 0.0, atol=1e-12)
    assert answer.verdict_after_impact == answer.UNIQUE
    (mode,) = answer.modes_after_impact
    assert set(mode.mode) <= {"f"}
    np.testing.assert_allclose(rows(mode.contact_forces)[:, 2].sum(), 9.80665, rtol=1e-6)


def test_a_brick_that_falls_flat(client: Client) -> None:
    """Four contacts from geometry, with the configured restitution, in its plane of motion."""
    request = PredictContactMode.Request(body_name="brick", include_impact=True)
    request.state_source = request.STATE_EXPLICIT
    request.state.pose.position.z = 0.025
    request.state.linear_velocity.z = -1.0
    request.state.linear_velocity.x = 0.3
    answer = client.ask(request)
    assert (answer.problem, answer.verdict) == (request.PLANAR, answer.IMPACT)
    (impact,) = answer.impact
    assert impact.converged
    assert impact.kinetic_energy_after < impact.kinetic_energy_before
    assert (rows(impact.contact_velocities_after)[:, 2] >= -1e-9).all()
    jump = vector(impact.state_after.linear_velocity) - [0.3, 0.0, -1.0]
    np.testing.assert_allclose(rows(impact.impulses).sum(axis=0), 0.4 * jump, atol=1e-12)
    assert len(impact.orders) > 1
    outcomes = np.array(impact.order_velocities).reshape(-1, 6)
    np.testing.assert_allclose(outcomes[:, 1], 0.0, atol=1e-12)  # all in the plane
    assert len(answer.modes_after_impact) >= 1


def test_nothing_is_settled_that_was_not_asked_for_or_needs_none(client: Client) -> None:
    request = slot("PLANAR")
    request.include_impact = False
    answer = client.ask(request)
    assert (answer.verdict, len(answer.impact), len(answer.modes_after_impact)) == (2, 0, 0)
    resting = asking("PLANAR", [(-1.0, -1.0), (1.0, -1.0)], [1.0, 1.0], 0.5)
    answer = client.ask(resting)
    assert (answer.verdict, len(answer.impact), len(answer.modes_after_impact)) == (0, 0, 0)
