# SPDX-License-Identifier: Apache-2.0
"""Contact modes in space over the service, and which problem AUTOMATIC takes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import Odometry

from contact_dynamics_interfaces.srv import PredictContactMode
from message_words import says
from running_server import Client, server_and_client

G = 9.80665
MASS = 0.4  # the configured brick's
BOX = np.array([0.15, 0.09, 0.05])
MU = 0.3  # the configured floor's
SOLVED = 1e-6  # relative: the library's linear programs are solved to 1e-9, and errors add up


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    with server_and_client(Path(tmp_path_factory.mktemp("log"))) as client:
        yield client


def brick_on_floor() -> PredictContactMode.Request:
    """The configured brick, flat on the configured floor, its contacts found from geometry."""
    request = PredictContactMode.Request(
        body_name="brick", state_source=PredictContactMode.Request.STATE_EXPLICIT
    )
    request.state.pose.position.z = 0.5 * BOX[2]
    return request


def explicit(points: list[tuple[float, ...]], mu: float) -> PredictContactMode.Request:
    """A ball-like body of mass 1 at the origin, on a level floor that it touches at points."""
    request = PredictContactMode.Request()
    request.inertia.m = request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 1.0
    request.state_source, request.contact_source = request.STATE_EXPLICIT, request.CONTACTS_EXPLICIT
    request.contacts.positions = [float(number) for point in points for number in point]
    request.contacts.normals = [0.0, 0.0, 1.0] * len(points)
    request.contacts.frictions = [mu] * len(points)
    request.contacts.restitutions = [0.0] * len(points)
    return request


def rows(numbers: Any) -> np.ndarray:
    return np.array(numbers).reshape(-1, 3)


def check_newton(answer: Any, mode: Any, force: np.ndarray, mass: float) -> None:
    """Forces and accelerations of a mode obey Newton's law, and forces lie in their cones."""
    forces = rows(mode.contact_forces)
    np.testing.assert_allclose(
        forces.sum(axis=0) + force, mass * np.array(mode.linear_acceleration), atol=SOLVED * mass * G
    )
    normal = np.einsum("ij,ij->i", forces, rows(answer.contacts.normals))
    across = np.linalg.norm(forces - normal[:, None] * rows(answer.contacts.normals), axis=1)
    assert (across <= np.array(answer.contacts.frictions) * normal + SOLVED * mass * G).all()


def test_a_brick_at_rest_in_space(client: Client) -> None:
    request = brick_on_floor()
    request.problem = request.SPATIAL
    answer = client.ask(request)
    assert (answer.status, answer.message) == (answer.OK, "")
    assert (answer.problem, answer.verdict) == (request.SPATIAL, answer.UNIQUE)
    (mode,) = answer.modes
    assert mode.mode == "ffff"
    assert mode.motion_unique
    assert not mode.forces_unique  # four feet: how they share the weight, rigid bodies do not say
    weight = np.array([0.0, 0.0, -MASS * G])
    check_newton(answer, mode, weight, MASS)
    moment = np.cross(rows(answer.contacts.positions) - [0.0, 0.0, 0.025], rows(mode.contact_forces))
    np.testing.assert_allclose(moment.sum(axis=0), 0.0, atol=SOLVED)
    np.testing.assert_array_equal(rows(mode.tangential_directions), 0.0)
    assert len(answer.kinematic_modes) == 10  # one and all feet, four edges, four corners
    assert set("".join(answer.kinematic_modes)) == {"c", "s"}
    assert answer.friction_facets == 8
    assert answer.out_of_plane_reason == ""
    assert math.isnan(answer.out_of_plane)
    assert answer.plane_normal.x == answer.plane_normal.y == answer.plane_normal.z == 0.0


def test_automatic_stays_in_the_plane_where_the_case_is_planar(client: Client) -> None:
    request = brick_on_floor()
    answer = client.ask(request)
    assert (answer.problem, answer.out_of_plane_reason) == (request.PLANAR, "")
    (mode,) = answer.modes
    assert mode.mode == "ffff"
    check_newton(answer, mode, np.array([0.0, 0.0, -MASS * G]), MASS)
    # Like contacts on the two sides of the plane carry equal shares, so that moments out of it balance.
    moment = np.cross(rows(answer.contacts.positions) - [0.0, 0.0, 0.025], rows(mode.contact_forces))
    np.testing.assert_allclose(moment.sum(axis=0), 0.0, atol=SOLVED)
    assert answer.friction_facets == 0


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_pushed_askew_it_sticks_or_slides_along_the_push(client: Client, share: float) -> None:
    """By Coulomb's law it slides once the push in any direction exceeds mu m g, and then a = F / m - mu g."""
    way = np.array([math.cos(0.5), math.sin(0.5), 0.0])
    push = share * MU * MASS * G * way
    request = brick_on_floor()
    force = request.applied_wrench.force
    force.x, force.y, force.z = push.tolist()
    answer = client.ask(request)
    assert answer.problem == request.SPATIAL
    assert "inertia" in answer.out_of_plane_reason, "the push is askew to the principal axes"
    (mode,) = answer.modes
    assert mode.mode == ("cccc" if share > 1.0 else "ffff")
    check_newton(answer, mode, push - [0.0, 0.0, MASS * G], MASS)
    expected = max(0.0, share - 1.0) * MU * G * way
    np.testing.assert_allclose(mode.linear_acceleration, expected, atol=SOLVED * G)
    if share > 1.0:
        np.testing.assert_allclose(rows(mode.tangential_directions), np.tile(way, (4, 1)), atol=1e-3)


def test_a_published_brick_that_spins_on_the_floor_is_braked(client: Client) -> None:
    """Each foot slides at right angles to its arm. The arms are equal, so friction brakes with mu m g."""
    publisher = client.publisher(Odometry, "/brick/odometry")
    state = Odometry()
    state.header.frame_id, state.child_frame_id = "world", "brick"
    state.header.stamp = client.node.get_clock().now().to_msg()
    state.pose.pose.position.z = 0.5 * BOX[2]
    state.twist.twist.angular.z = 5.0
    publisher.publish(state)
    request = PredictContactMode.Request(
        body_name="brick",
        state_source=PredictContactMode.Request.STATE_AT_STAMP,
        stamp=state.header.stamp,
    )
    answers: list[Any] = []

    def answered() -> bool:
        answers.append(client.ask(request))
        return bool(answers[-1].status != answers[-1].NO_STATE)

    client.spin_until(answered)
    answer = answers[-1]
    assert (answer.status, answer.message) == (answer.OK, "")
    assert answer.problem == request.SPATIAL
    assert "m/s out of the plane" in answer.out_of_plane_reason
    (mode,) = answer.modes
    assert mode.mode == "cccc"
    arms = rows(answer.contacts.positions) * [1.0, 1.0, 0.0]
    reach = 0.5 * math.hypot(BOX[0], BOX[1])
    np.testing.assert_allclose(
        rows(mode.tangential_directions), np.cross([0.0, 0.0, 1.0], arms) / reach, atol=1e-9
    )
    np.testing.assert_allclose(rows(answer.contact_velocities), np.cross([0.0, 0.0, 5.0], arms), atol=1e-9)
    expected = [0.0, 0.0, -MU * MASS * G * reach / 0.00102]
    np.testing.assert_allclose(mode.angular_acceleration, expected, rtol=SOLVED, atol=1e-4)
    np.testing.assert_allclose(mode.linear_acceleration, 0.0, atol=SOLVED * G)


TRIPOD = [(1.0, 0.0, -1.0), (-0.5, 0.8, -1.0), (-0.5, -0.6, -1.0)]


def test_a_tripod_has_no_plane_of_motion(client: Client) -> None:
    """The shares of the weight follow from three moments. One foot carries too little once it is pushed."""
    request = explicit(TRIPOD, 0.9)
    answer = client.ask(request)
    assert answer.problem == request.SPATIAL
    assert "beside the plane" in answer.out_of_plane_reason
    (mode,) = answer.modes
    assert (mode.mode, mode.motion_unique) == ("fff", True)
    shares = np.linalg.solve(np.vstack([np.ones(3), np.array(TRIPOD)[:, :2].T]), [G, 0.0, 0.0])
    np.testing.assert_allclose(rows(mode.contact_forces)[:, 2], shares, atol=SOLVED * G)
    # It tips about the edge of the last two feet at a force at the centre of m g times 0.5, their distance.
    for part, expected in ((0.999, "fff"), (1.001, "sff")):
        request.applied_wrench.force.x = -0.5 * part * G
        assert [found.mode for found in client.ask(request).modes] == [expected]


def test_a_planar_question_about_it_is_refused_only_where_the_plane_is_left(client: Client) -> None:
    request = explicit(TRIPOD, 0.9)
    request.problem = request.PLANAR
    request.plane_normal.y = -1.0
    assert (
        client.ask(request).status == PredictContactMode.Response.OK
    )  # as if its contacts were in the plane
    request.state.linear_velocity.y = 0.02
    answer = client.ask(request)
    assert answer.status == answer.OUT_OF_PLANE
    assert answer.message == (
        "state must be at most 1e-06 m/s, got 0.02 m/s out of the plane with normal [0.0, -1.0, 0.0]"
    )
    request.out_of_plane_tolerance = 0.05
    answer = client.ask(request)
    assert answer.status == answer.OK
    assert answer.out_of_plane == pytest.approx(0.02)
    request.problem = request.AUTOMATIC
    request.out_of_plane_tolerance = 0.0
    assert client.ask(request).problem == request.SPATIAL


def test_in_a_corner_normals_span_space(client: Client) -> None:
    request = explicit([(0.0, 0.0, -1.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0)], 0.0)
    request.contacts.normals = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    request.applied_wrench.force.x = -1.0
    request.applied_wrench.force.y = 2.0
    answer = client.ask(request)
    assert "span space" in answer.out_of_plane_reason
    (mode,) = answer.modes
    assert (mode.mode[0], mode.mode[2]) == ("c", "s")  # it stays on the floor and leaves one wall
    np.testing.assert_allclose(mode.linear_acceleration, [0.0, 2.0, 0.0], atol=SOLVED * G)
    np.testing.assert_allclose(rows(mode.contact_forces)[1], [1.0, 0.0, 0.0], atol=SOLVED * G)
    assert sorted(answer.kinematic_modes) == sorted(a + b + c for a in "cs" for b in "cs" for c in "cs"), (
        "three independent walls: every string"
    )


def test_space_has_the_lectures_indeterminacy_too(client: Client) -> None:
    theta = math.radians(75.0)
    request = explicit([(-4.0 * math.cos(theta), 0.0, -4.0 * math.sin(theta))], math.tan(math.radians(30.0)))
    request.problem = request.SPATIAL
    request.gravity = request.GRAVITY_NONE
    request.applied_wrench.force.x = -1.0
    answer = client.ask(request)
    assert answer.verdict == answer.INDETERMINATE
    by_letter = {mode.mode: mode for mode in answer.modes}
    assert set(by_letter) == {"c", "f"}
    np.testing.assert_allclose(by_letter["c"].contact_forces, 0.0, atol=SOLVED)
    np.testing.assert_allclose(by_letter["c"].tangential_directions, [-1.0, 0.0, 0.0], atol=1e-6)
    f_x, f_y, f_z = by_letter["f"].contact_forces
    assert (f_x, f_z) == pytest.approx((0.121870, 0.235294), abs=5e-7)  # PHYSICS: printed with 6 digits
    assert f_y == pytest.approx(0.0, abs=SOLVED)


@pytest.mark.parametrize("facets", [3, 16])
def test_facets_are_those_that_were_asked_for(client: Client, facets: int) -> None:
    request = explicit([(0.0, 0.0, -1.0)], 0.5)
    request.problem, request.friction_facets = request.SPATIAL, facets
    answer = client.ask(request)
    assert answer.friction_facets == facets
    assert [mode.mode for mode in answer.modes] == ["f"]


def test_statics_of_a_brick_that_is_pushed_askew(client: Client) -> None:
    """Friction alone holds it up to mu m g. The disturbance that it takes is what is left of that."""
    way = np.array([math.cos(0.5), math.sin(0.5), 0.0])
    for share, holds in ((0.9, True), (1.001, False)):
        request = brick_on_floor()
        request.include_statics, request.margin_length = True, 1e-3
        force = request.applied_wrench.force
        force.x, force.y, force.z = (share * MU * MASS * G * way).tolist()
        answer = client.ask(request)
        assert (answer.status, answer.message) == (answer.OK, "")
        assert answer.problem == request.SPATIAL
        held = answer.CERTAIN if holds else answer.NO
        assert (answer.equilibrium, answer.jammed, answer.wedged) == (held, held, answer.NO)
        if holds:
            # Torques cost all at so short a length: at most the way to the round cone.
            assert answer.stable_disturbance <= (1.0 - share) * MU * MASS * G / math.hypot(1.0, MU) + 1e-9
            assert answer.stable_disturbance > 0.0
        else:
            assert math.isnan(answer.stable_disturbance)


def test_margins_of_a_brick_in_space(client: Client) -> None:
    """At rest on four feet, the margin is the distance to the side of the friction cone or pyramid."""
    request = brick_on_floor()
    request.problem, request.include_margins, request.margin_length = request.SPATIAL, True, 1e-4
    request.friction_facets = 16
    answer = client.ask(request)
    (mode,) = answer.modes
    slope = MU * math.cos(math.pi / 16.0)
    low, high = (MASS * G * mu / math.hypot(1.0, mu) for mu in (slope, MU))
    assert low * (1.0 - 1e-3) <= mode.margin <= high * (1.0 + 1e-9)  # torques cost nearly all
    assert mode.margin_length == 1e-4
    assert np.linalg.norm(mode.margin_wrench[:3]) == pytest.approx(mode.margin, rel=1e-3)
    assert list(mode.margin_modes) == ["cccc"]
    # All that could leave the floor is refused, and what would lift the brick off it penetrates.
    assert sorted(answer.refused_modes) == sorted(set(answer.kinematic_modes) - {"cccc"})
    why = dict(zip(answer.refused_modes, answer.refusals, strict=True))
    off = dict(zip(answer.refused_modes, answer.refusal_amounts, strict=True))
    assert why["ssss"] == answer.PENETRATES
    assert off["ssss"] == pytest.approx(-G, rel=1e-9)


def test_margin_of_a_brick_that_begins_to_slide_askew(client: Client) -> None:
    """Back to the edge of its friction cones, which lean against the push, torques costing nearly all."""
    request = brick_on_floor()
    request.include_margins, request.margin_length = True, 1e-4
    request.applied_wrench.force.x = request.applied_wrench.force.y = 1.0
    answer = client.ask(request)
    assert (answer.status, answer.problem) == (answer.OK, request.SPATIAL)
    (mode,) = answer.modes
    assert mode.mode == "cccc"
    expected = (math.sqrt(2.0) - MU * MASS * G) / math.hypot(1.0, MU)
    assert mode.margin == pytest.approx(expected, rel=1e-3)
    assert list(mode.margin_modes) == ["ffff"]
    assert mode.margin_verdict == answer.UNIQUE


def test_sets_beyond_reason_are_refused_by_name_and_not_by_silence(client: Client) -> None:
    many = explicit([(1.0, 0.1 * i, -1.0) for i in range(1001)], 0.5)
    answer = client.ask(many)
    assert answer.status == answer.TOO_LARGE
    assert says(answer.message, "contacts must be at most 1000..., got 1001 contacts")
    ring = [2.0 * math.pi * i / 65 for i in range(65)]
    request = explicit([(math.cos(a), math.sin(a), -1.0) for a in ring], 0.5)
    request.problem = request.SPATIAL
    answer = client.ask(request)
    assert answer.status == answer.TOO_LARGE
    assert says(answer.message, "contacts must be ..., got 65")


@pytest.mark.parametrize(
    ("push", "lift", "torque"),
    [(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (-2.0, 1.0, 0.0), (0.0, 0.0, 0.35), (1.5, 0.0, -0.4), (0.5, 5.0, 0.0)],
    ids=["rests", "slides", "slides back", "tips", "tips and slides", "is lifted"],
)
def test_plane_and_space_agree_where_automatic_takes_the_plane(
    client: Client, push: float, lift: float, torque: float
) -> None:
    request = brick_on_floor()
    request.applied_wrench.force.x, request.applied_wrench.force.z = push, lift
    request.applied_wrench.torque.y = torque
    plane = client.ask(request)
    request.problem = request.SPATIAL
    space = client.ask(request)
    assert (plane.problem, space.problem) == (request.PLANAR, request.SPATIAL)
    assert plane.verdict == space.verdict == plane.UNIQUE
    (one,), (other,) = plane.modes, space.modes
    assert one.mode.translate(str.maketrans("lr", "cc")) == other.mode
    scale = SOLVED * (G + abs(push) / MASS + abs(torque) / 0.00083)
    np.testing.assert_allclose(one.linear_acceleration, other.linear_acceleration, atol=scale)
    np.testing.assert_allclose(one.angular_acceleration, other.angular_acceleration, atol=100.0 * scale)
