# SPDX-License-Identifier: Apache-2.0
"""Tumbling over the service: times, stamps, contacts, planes, drag, Poinsot, beside known motions."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from nav_msgs.msg import Path as RosPath
from scipy.spatial.transform import Rotation

from contact_dynamics_interfaces.msg import Poinsot
from contact_dynamics_interfaces.srv import PredictTumbling
from message_words import says
from running_server import Client

G = 9.80665


def spinning(
    *, w: tuple[float, float, float], moments: tuple[float, float, float]
) -> PredictTumbling.Request:
    request = PredictTumbling.Request(state_source=PredictTumbling.Request.STATE_EXPLICIT)
    request.inertia.m = 2.0
    request.inertia.ixx, request.inertia.iyy, request.inertia.izz = moments
    spin = request.state.angular_velocity
    spin.x, spin.y, spin.z = w
    return request


def test_an_axisymmetric_top_precesses_steadily(client: Client) -> None:
    """About L at |L| / I_1, while it spins about its axis by (1/I_3 - 1/I_1) L cos(tilt)."""
    request = spinning(w=(0.3, 0.0, 2.0), moments=(0.2, 0.2, 0.1))
    request.times = [0.0, 0.5, 40.0]
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert answer.method == answer.CLOSED_FORM
    L = np.array([0.06, 0.0, 0.2])
    size = float(np.linalg.norm(L))
    for t, q in zip(
        answer.trajectory.times, np.array(answer.trajectory.orientations).reshape(-1, 4), strict=True
    ):
        about_L = Rotation.from_rotvec(t * L / 0.2)
        about_axis = Rotation.from_rotvec([0.0, 0.0, t * (2.0 - 0.2 / 0.2)])
        error = (Rotation.from_quat(q).inv() * about_L * about_axis).magnitude()
        assert error < 1e-13  # of 100 rad turned, by SciPy's own products of rounded rotations
    picture = answer.poinsot
    assert picture.regime == Poinsot.AXISYMMETRIC
    np.testing.assert_allclose(picture.angular_momentum, L, atol=1e-15)
    energy = 0.5 * (0.2 * 0.09 + 0.1 * 4.0)
    assert picture.rotational_energy == pytest.approx(energy, rel=1e-14)
    assert picture.invariable_plane_distance == pytest.approx(2.0 * energy / size, rel=1e-14)
    np.testing.assert_allclose(picture.principal_moments, [0.1, 0.2, 0.2], rtol=1e-15)


def test_gravity_bends_the_path_and_can_be_left_out(client: Client) -> None:
    request = spinning(w=(0.0, 0.0, 0.0), moments=(0.1, 0.1, 0.1))
    request.state.linear_velocity.x = 3.0
    request.times = [2.0]
    np.testing.assert_allclose(client.ask(request).trajectory.positions, [6.0, 0.0, -2.0 * G], atol=1e-13)
    request.gravity = request.GRAVITY_NONE
    np.testing.assert_allclose(client.ask(request).trajectory.positions, [6.0, 0.0, 0.0], atol=1e-13)


def test_positions_are_those_of_the_published_frame(client: Client) -> None:
    """Spin about z with the centre of mass at rest: the frame's origin circles it."""
    request = spinning(w=(0.0, 0.0, math.pi), moments=(0.1, 0.1, 0.1))
    request.gravity = request.GRAVITY_NONE
    request.inertia.com.x = 0.5
    request.times = [0.0, 0.5, 1.0]
    positions = np.array(client.ask(request).trajectory.positions).reshape(-1, 3)
    np.testing.assert_allclose(positions, [[0.0, 0.0, 0.0], [0.5, -0.5, 0.0], [1.0, 0.0, 0.0]], atol=1e-15)


def test_stamps_reach_into_the_past(client: Client) -> None:
    request = spinning(w=(0.0, 0.0, 1.0), moments=(0.1, 0.1, 0.1))
    request.gravity = request.GRAVITY_NONE
    request.state.linear_velocity.x = 1.0
    request.state.header.stamp.sec = 1_795_000_000
    request.sampling = request.AT_STAMPS
    request.stamps_ns = [1_794_999_999_500_000_000, 1_795_000_000_250_000_001]
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    np.testing.assert_allclose(answer.trajectory.times, [-0.5, 0.250000001], atol=1e-16)
    assert answer.trajectory.header.stamp == request.state.header.stamp
    positions = np.array(answer.trajectory.positions).reshape(-1, 3)
    np.testing.assert_allclose(positions[:, 0], [-0.5, 0.250000001], atol=1e-15)


def test_until_the_first_contact(client: Client) -> None:
    request = PredictTumbling.Request(body_name="brick", state_source=PredictTumbling.Request.STATE_EXPLICIT)
    request.state.pose.position.z = 0.025 + 0.5 * G * 0.4**2
    request.sampling, request.rate = request.UNTIL_CONTACT, 100.0
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert (answer.event, answer.event_surface) == (answer.CONTACT, "floor")
    assert answer.event_time == pytest.approx(0.4, abs=1e-12)
    assert answer.trajectory.times[-1] == answer.event_time
    assert len(answer.trajectory.times) in {41, 42}  # 0.40 itself is a sample or the event
    assert answer.event_point.z == pytest.approx(0.0, abs=1e-12)
    assert answer.event_velocity.z == pytest.approx(-0.4 * G, abs=1e-11)


def test_without_contact_the_trajectory_goes_to_its_end(client: Client) -> None:
    request = PredictTumbling.Request(body_name="brick", state_source=PredictTumbling.Request.STATE_EXPLICIT)
    request.state.pose.position.z = 50.0
    request.sampling, request.rate, request.duration = request.UNTIL_CONTACT, 10.0, 1.0
    answer = client.ask(request)
    assert (answer.event, len(answer.trajectory.times)) == (answer.NONE, 11)
    assert math.isnan(answer.event_time)


def test_until_a_point_of_the_body_reaches_a_plane(client: Client) -> None:
    """A point 0.5 m out on x of a body that turns about y: it goes down as 0.5 sin(w t)."""
    request = spinning(w=(0.0, 2.0, 0.0), moments=(0.1, 0.1, 0.1))
    request.gravity = request.GRAVITY_NONE
    request.sampling, request.rate, request.duration = request.UNTIL_PLANE, 50.0, 5.0
    request.body_point.x = 0.5
    request.plane_point.z = -0.25
    request.plane_normal.z = 1.0
    answer = client.ask(request)
    assert answer.event == answer.PLANE_REACHED
    assert answer.event_time == pytest.approx(math.pi / 12.0, abs=1e-13)  # sin = 1/2
    point, velocity = answer.event_point, answer.event_velocity
    np.testing.assert_allclose([point.x, point.z], [0.25 * math.sqrt(3.0), -0.25], atol=1e-13)
    np.testing.assert_allclose([velocity.x, velocity.z], [-0.5, -0.5 * math.sqrt(3.0)], atol=1e-12)


def test_with_drag_it_is_integrated_and_says_so(client: Client) -> None:
    request = spinning(w=(0.0, 0.0, 3.0), moments=(0.1, 0.1, 0.1))
    request.linear_drag, request.linear_angular_drag = 0.5, 0.02
    request.times = [1.0, 3.0]
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert answer.method == answer.INTEGRATED
    assert answer.poinsot.regime == Poinsot.UNKNOWN
    k = 0.5 / 2.0
    falling = [-G / k * (1.0 - math.exp(-k * t)) for t in (1.0, 3.0)]
    velocities = np.array(answer.trajectory.linear_velocities).reshape(-1, 3)
    np.testing.assert_allclose(velocities[:, 2], falling, rtol=1e-11)
    spins = np.array(answer.trajectory.angular_velocities).reshape(-1, 3)
    np.testing.assert_allclose(spins[:, 2], [3.0 * math.exp(-0.2 * t) for t in (1.0, 3.0)], rtol=1e-11)


def test_a_torque_in_body_axes_spins_up_and_a_force_alone_stays_in_closed_form(client: Client) -> None:
    request = spinning(w=(0.0, 0.0, 1.0), moments=(0.1, 0.1, 0.2))
    request.applied_wrench.torque.z = 0.4
    request.wrench_in_body_axes = True
    request.times = [2.0]
    answer = client.ask(request)
    assert answer.method == answer.INTEGRATED
    assert answer.trajectory.angular_velocities[2] == pytest.approx(5.0, rel=1e-12)
    pulled = spinning(w=(0.0, 0.0, 1.0), moments=(0.1, 0.1, 0.2))
    pulled.applied_wrench.force.z = 2.0 * G
    pulled.times = [2.0]
    answer = client.ask(pulled)
    assert answer.method == answer.CLOSED_FORM
    np.testing.assert_allclose(answer.trajectory.positions, 0.0, atol=1e-14)


def test_poinsots_picture_holds_where_only_forces_act(client: Client) -> None:
    request = spinning(w=(0.3, -0.5, 1.2), moments=(0.1, 0.14, 0.19))
    request.times, request.curve_points = [3.0], 10
    free = client.ask(request)
    request.linear_drag, request.applied_wrench.force.x, request.wrench_in_body_axes = 0.5, 1.0, True
    dragged = client.ask(request)
    assert dragged.method == dragged.INTEGRATED
    assert dragged.poinsot == free.poinsot
    np.testing.assert_allclose(
        dragged.trajectory.orientations, free.trajectory.orientations, rtol=0.0, atol=1e-11
    )
    request.linear_angular_drag = 1e-6
    assert client.ask(request).poinsot.regime == Poinsot.UNKNOWN


def test_first_contact_under_drag(client: Client) -> None:
    """Falling from rest with linear drag: z = z0 - (g/k) (t - (1 - e^(-k t)) / k), solved for the floor."""
    request = PredictTumbling.Request(body_name="brick", state_source=PredictTumbling.Request.STATE_EXPLICIT)
    k, t = 0.8, 0.7
    request.linear_drag = k * 0.4  # kg, as configured
    request.state.pose.position.z = 0.025 + G / k * (t + math.expm1(-k * t) / k)
    request.sampling, request.rate = request.UNTIL_CONTACT, 100.0
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert (answer.method, answer.event) == (answer.INTEGRATED, answer.CONTACT)
    assert answer.event_surface == "floor"
    assert answer.event_time == pytest.approx(t, abs=1e-9)
    assert answer.event_velocity.z == pytest.approx(G / k * math.expm1(-k * t), abs=1e-8)
    assert answer.trajectory.times[-1] == answer.event_time


def test_a_plane_is_reached_while_a_torque_spins_up(client: Client) -> None:
    """A point 0.5 m out on x, turning down about y by N t^2 / 2 I from rest, 30 degrees far."""
    request = spinning(w=(0.0, 0.0, 0.0), moments=(0.1, 0.1, 0.1))
    request.gravity = request.GRAVITY_NONE
    request.applied_wrench.torque.y = 0.3
    request.sampling, request.rate, request.duration = request.UNTIL_PLANE, 50.0, 2.0
    request.body_point.x, request.plane_point.z, request.plane_normal.z = 0.5, -0.25, 1.0
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    assert (answer.method, answer.event) == (answer.INTEGRATED, answer.PLANE_REACHED)
    t = math.sqrt(2.0 * 0.1 / 0.3 * math.pi / 6.0)
    assert answer.event_time == pytest.approx(t, abs=1e-9)
    assert answer.event_velocity.z == pytest.approx(-0.5 * math.cos(math.pi / 6.0) * 3.0 * t, abs=1e-8)


def test_what_a_torque_spins_up_beyond_reason_is_refused(client: Client) -> None:
    request = spinning(w=(0.0, 0.0, 0.1), moments=(0.1, 0.1, 0.1))
    request.applied_wrench.torque.z = 100.0
    request.times = [60.0]
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD
    assert says(
        answer.message, "times must be no further than 6000 steps of the integrator reach..., got 60 s"
    )


def test_an_endless_search_is_refused_rather_than_begun(client: Client) -> None:
    """A body that spins for ever, never touching."""
    request = spinning(w=(0.0, 0.0, 10.0), moments=(0.1, 0.1, 0.1))
    request.gravity = request.GRAVITY_NONE
    request.sampling, request.duration, request.plane_normal.z = request.UNTIL_PLANE, 1e9, 1.0
    request.state.pose.position.z = 1.0
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD
    assert says(answer.message, "duration must be ..., got 1.59155e+09 turns")


@pytest.mark.parametrize(
    ("field", "spoil"),
    [
        ("times", lambda r: r.times.append(1e18)),
        ("angular_velocity", lambda r: setattr(r.state.angular_velocity, "x", 1e200)),
        ("inertia", lambda r: setattr(r.inertia, "ixx", 1e-200)),
        ("position", lambda r: setattr(r.state.pose.position, "x", -1e300)),
        ("include_covariance|state.covariance", lambda r: setattr(r, "include_covariance", True)),
    ],
)
def test_numbers_beyond_reason_are_refused_by_name(client: Client, field: str, spoil: object) -> None:
    request = spinning(w=(0.1, 0.2, 3.0), moments=(0.1, 0.12, 0.15))
    request.times = [1.0]
    spoil(request)
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD
    assert re.search(field, answer.message)


def test_curves_of_poinsots_picture_on_request(client: Client) -> None:
    request = spinning(w=(0.3, -0.5, 1.2), moments=(0.1, 0.14, 0.19))
    request.times = [0.0]
    picture = client.ask(request).poinsot
    assert (len(picture.polhode), len(picture.herpolhode), len(picture.curve_times)) == (0, 0, 0)
    request.curve_points = 101
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    picture, I_B = answer.poinsot, np.diag([0.1, 0.14, 0.19])
    curve, plane = np.array(picture.polhode).reshape(101, 3), np.array(picture.herpolhode).reshape(101, 3)
    np.testing.assert_allclose(
        np.einsum("ni,ij,nj->n", curve, I_B, curve), 2.0 * picture.rotational_energy, rtol=1e-13
    )
    L = np.array(picture.angular_momentum)
    np.testing.assert_allclose(plane @ L / np.linalg.norm(L), picture.invariable_plane_distance, rtol=1e-13)
    np.testing.assert_allclose(np.linalg.norm(curve, axis=1), np.linalg.norm(plane, axis=1), rtol=1e-12)
    assert picture.curve_times[-1] - picture.curve_times[0] == pytest.approx(
        picture.polhode_period, rel=1e-12
    )
    request.curve_points = 1_000_000
    answer = client.ask(request)
    assert answer.status == answer.TOO_LARGE
    assert says(answer.message, "curve_points must be at most 10000..., got 1000000")


def test_hours_under_drag_are_refused_rather_than_computed(client: Client) -> None:
    request = spinning(w=(0.0, 0.0, 10.0), moments=(0.1, 0.1, 0.1))
    request.linear_drag, request.times = 0.1, [3600.0]
    answer = client.ask(request)
    assert answer.status == answer.INVALID_FIELD
    assert (
        "times must be at most 100 under torque or drag, got 5729.58 turns of the body ahead"
        in answer.message
    )


def test_flips_near_the_middle_axis_are_told(client: Client) -> None:
    request = spinning(w=(1e-3, 10.0, 0.0), moments=(1e-4, 2e-4, 2.8e-4))
    request.gravity = request.GRAVITY_NONE
    request.times = [0.0]
    picture = client.ask(request).poinsot
    flips = np.array(picture.flip_times)
    assert len(flips) == 3
    np.testing.assert_allclose(np.diff(flips), 0.5 * picture.polhode_period, rtol=1e-12)
    assert np.isnan(picture.flip_time_deviations).all()
    assert picture.sensitivity > 100.0
    request.times = (flips + 0.5 * np.append(np.diff(flips), 0.0)).tolist()[:2]
    tilt = np.array(client.ask(request).trajectory.orientations).reshape(-1, 4)
    along = Rotation.from_quat(tilt).apply([0.0, 1.0, 0.0])[:, 1]
    assert along[0] * along[1] < 0.0  # between two flips it points one way, after the next the other


def test_the_longest_trajectory_arrives_whole(client: Client) -> None:
    request = spinning(w=(1.0, 2.0, 3.0), moments=(0.1, 0.2, 0.25))
    request.sampling, request.rate, request.duration = request.AT_RATE, 1999.9, 10.0
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    n = len(answer.trajectory.times)
    assert n == 20_000
    assert len(answer.trajectory.orientations) == 4 * n
    norms = np.linalg.norm(np.array(answer.trajectory.orientations).reshape(-1, 4), axis=1)
    np.testing.assert_allclose(norms, 1.0, atol=1e-15)


def test_a_path_for_rviz_is_published_while_somebody_listens(client: Client) -> None:
    paths: list[RosPath] = []
    topic = "/contact_dynamics/predicted_path"
    subscription = client.node.create_subscription(RosPath, topic, paths.append, 1)
    request = spinning(w=(0.0, 0.0, 2.0), moments=(0.1, 0.2, 0.25))
    request.gravity = request.GRAVITY_NONE
    request.state.linear_velocity.x = 1.0
    request.sampling, request.rate, request.duration = request.AT_RATE, 1000.0, 1.0

    def heard() -> bool:
        client.ask(request)
        return bool(paths)

    client.spin_until(heard)
    client.node.destroy_subscription(subscription)
    path = paths[0]
    assert path.header.frame_id == "world"
    assert 2 < len(path.poses) <= 200
    assert [path.poses[0].pose.position.x, path.poses[-1].pose.position.x] == [0.0, 1.0]
    assert path.poses[-1].header.stamp.sec == 1
    assert path.poses[-1].pose.orientation.z == pytest.approx(math.sin(1.0), abs=1e-14)
