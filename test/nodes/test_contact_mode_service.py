# SPDX-License-Identifier: Apache-2.0
"""Contact modes over the service: a block on an incline, with margins, wrench sets and statics."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_dynamics_interfaces.srv import PredictContactMode
from running_server import Client

SLOPE = math.radians(20.0)
NORMAL = np.array([-math.sin(SLOPE), 0.0, math.cos(SLOPE)])
UPHILL = np.array([math.cos(SLOPE), 0.0, math.sin(SLOPE)])
MASS, WIDTH, HEIGHT, G = 2.0, 0.4, 0.2, 9.80665


def block_on_incline(mu: float) -> PredictContactMode.Request:
    """A block of two feet, seen from the front. The foot downhill comes first."""
    request = PredictContactMode.Request()
    request.inertia.m = MASS
    request.inertia.ixx = request.inertia.iyy = request.inertia.izz = MASS * (WIDTH**2 + HEIGHT**2) / 12.0
    request.state_source, request.contact_source = request.STATE_EXPLICIT, request.CONTACTS_EXPLICIT
    feet = [-0.5 * WIDTH * UPHILL, 0.5 * WIDTH * UPHILL] - 0.5 * HEIGHT * NORMAL
    request.contacts.positions = feet.ravel().tolist()
    request.contacts.normals = [*NORMAL, *NORMAL]
    request.contacts.frictions = [mu, mu]
    request.contacts.restitutions = [0.0, 0.0]
    request.plane_normal.y = -1.0
    return request


def test_below_the_friction_angle_it_stays_and_the_margin_is_the_way_to_sliding(client: Client) -> None:
    mu = math.tan(math.radians(30.0))
    request = block_on_incline(mu)
    request.include_margins = request.include_statics = True
    answer = client.ask(request)
    assert (answer.status, answer.verdict, answer.problem) == (answer.OK, answer.UNIQUE, request.PLANAR)
    (mode,) = answer.modes
    assert mode.mode == "ff"
    assert not mode.forces_unique  # how the feet share friction, rigid bodies do not say
    forces = np.array(mode.contact_forces).reshape(2, 3)
    np.testing.assert_allclose(forces.sum(axis=0), [0.0, 0.0, MASS * G], atol=1e-9)
    # The wrench's distance from the edge of the friction cone of both feet, the change's moment being free to
    # choose: at most the distance in force alone.
    alone = MASS * G * math.sin(math.radians(10.0))
    assert 0.0 < mode.margin <= alone + 1e-9
    assert mode.margin_verdict == answer.UNIQUE
    assert mode.margin_modes[0] != "ff"
    assert (answer.equilibrium, answer.jammed, answer.wedged) == (answer.CERTAIN, answer.CERTAIN, answer.NO)
    assert answer.stable_disturbance == pytest.approx(mode.margin, rel=1e-9)


def test_a_wrench_just_beyond_the_margin_has_the_mode_that_was_foretold(client: Client) -> None:
    request = block_on_incline(math.tan(math.radians(30.0)))
    request.include_margins = True
    (mode,) = client.ask(request).modes
    for part, expected in ((0.999, ["ff"]), (1.001, list(mode.margin_modes))):
        force = part * np.array(mode.margin_wrench[:3])
        torque = part * np.array(mode.margin_wrench[3:])
        pushed = block_on_incline(math.tan(math.radians(30.0)))
        applied = pushed.applied_wrench
        applied.force.x, applied.force.y, applied.force.z = force.tolist()
        applied.torque.x, applied.torque.y, applied.torque.z = torque.tolist()
        assert [found.mode for found in client.ask(pushed).modes] == expected


def test_above_the_friction_angle_it_slides_down(client: Client) -> None:
    mu = math.tan(math.radians(10.0))
    answer = client.ask(block_on_incline(mu))
    (mode,) = answer.modes
    assert mode.mode == "ll"  # downhill is left
    expected = -G * (math.sin(SLOPE) - mu * math.cos(SLOPE)) * UPHILL
    np.testing.assert_allclose(mode.linear_acceleration, expected, atol=1e-9)
    np.testing.assert_allclose(mode.angular_acceleration, 0.0, atol=1e-9)
    assert math.isnan(mode.margin)
    assert answer.equilibrium == answer.NOT_ASKED


def test_seen_from_behind_left_and_right_change_places(client: Client) -> None:
    request = block_on_incline(math.tan(math.radians(10.0)))
    request.plane_normal.y = 1.0
    assert [mode.mode for mode in client.ask(request).modes] == ["rr"]


def test_every_mode_comes_with_the_wrenches_that_bring_it_about(client: Client) -> None:
    """Only sets of consistent modes contain the applied wrench. Generators are in their half-spaces."""
    request = block_on_incline(math.tan(math.radians(30.0)))
    request.include_wrenches = True
    answer = client.ask(request)
    assert sorted(found.mode for found in answer.wrench_sets) == sorted(answer.kinematic_modes)
    weight = np.array([0.0, 0.0, -MASS * G, 0.0, 0.0, 0.0])
    inside = []
    for found in answer.wrench_sets:
        sides = np.array(found.half_spaces).reshape(-1, 7)
        generators = np.array(found.generators).reshape(-1, 6)
        vertices = np.array(found.vertices).reshape(-1, 6)
        for vertex in vertices:
            assert (sides[:, :6] @ vertex <= sides[:, 6] + 1e-9).all()
        scales = np.abs(generators).max(axis=1, initial=1.0)
        assert (sides[:, :6] @ (generators / scales[:, None]).T <= 1e-9).all()
        if (sides[:, :6] @ weight <= sides[:, 6] + 1e-9).all():
            inside.append(found.mode)
    assert inside == ["ff"]


def test_a_body_in_flight_has_no_contact_and_says_so(client: Client) -> None:
    request = PredictContactMode.Request(
        body_name="brick", state_source=PredictContactMode.Request.STATE_EXPLICIT
    )
    request.state.pose.position.z = 1.0
    answer = client.ask(request)
    assert answer.status == answer.NO_CONTACT
    assert "no point of 'brick' is within 1e-06 m of a surface" in answer.message


def test_contacts_from_geometry_of_a_brick_on_the_floor(client: Client) -> None:
    request = PredictContactMode.Request(
        body_name="brick", state_source=PredictContactMode.Request.STATE_EXPLICIT
    )
    request.state.pose.position.z = 0.025
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert [mode.mode for mode in answer.modes] == ["ffff"]
    assert list(answer.contacts.surface_names) == ["floor"] * 4
    total = np.array(answer.modes[0].contact_forces).reshape(-1, 3).sum(axis=0)
    np.testing.assert_allclose(total, [0.0, 0.0, 0.4 * G], atol=1e-9)
