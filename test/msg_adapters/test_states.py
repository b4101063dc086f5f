# SPDX-License-Identifier: Apache-2.0
"""States as messages: frames, points and stamps survive the border; what makes no sense is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped, TwistStamped
from hypothesis import given
from hypothesis import strategies as st
from nav_msgs.msg import Odometry
from scipy.spatial.transform import Rotation

from contact_dynamics.errors import FrameMismatchError, InvalidFieldError
from contact_dynamics.questions import UncertainState
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics_interfaces.msg import BodyState as BodyStateMsg
from msg_adapters.body_state import body_state_from_msg, body_state_to_msg, known_state_from_msg
from msg_adapters.odometry import body_state_from_odometry, odometry_from_body_state
from msg_adapters.pose_twist import body_state_from_pose_twist

ROUNDING = 1e-13  # of numbers up to 10, through two rotations each way: some tens of units in the last place

numbers = st.floats(-10.0, 10.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)
quaternions = (
    st.tuples(*[st.floats(-1.0, 1.0)] * 4)
    .filter(lambda q: math.hypot(*q) > 0.1)
    .map(lambda q: np.array(q) / math.hypot(*q))
)
stamps = st.integers(0, 2**31 * 10**9 - 1)
states = st.builds(
    BodyState, p_WB_W=vectors, q_WB=quaternions, v_WB_W=vectors, w_WB_W=vectors, stamp_ns=stamps
)


def assert_same(found: BodyState, expected: BodyState) -> None:
    for field in ("p_WB_W", "q_WB", "v_WB_W", "w_WB_W"):
        np.testing.assert_allclose(
            getattr(found, field), getattr(expected, field), atol=ROUNDING * 10, rtol=0
        )
    assert found.stamp_ns == expected.stamp_ns


@given(state=states, p_FB_F=vectors)
def test_odometry_there_and_back(state: BodyState, p_FB_F: np.ndarray) -> None:
    msg = odometry_from_body_state(state, world_frame="map", child_frame="brick", p_FB_F=p_FB_F)
    assert (msg.header.frame_id, msg.child_frame_id) == ("map", "brick")
    assert_same(body_state_from_odometry(msg, world_frame="map", p_FB_F=p_FB_F), state)


@given(state=states, p_FB_F=vectors)
def test_body_state_there_and_back(state: BodyState, p_FB_F: np.ndarray) -> None:
    msg = body_state_to_msg(state, body_name="brick", world_frame="map", p_FB_F=p_FB_F)
    assert_same(body_state_from_msg(msg, world_frame="map", p_FB_F=p_FB_F), state)


def test_an_odometry_twist_is_in_the_child_frame_and_at_its_origin() -> None:
    """Turned 90 degrees about z, moving along its x, spinning about z, centre of mass 0.1 m ahead."""
    msg = Odometry()
    msg.header.frame_id = "world"
    msg.pose.pose.orientation.z = msg.pose.pose.orientation.w = math.sqrt(0.5)
    msg.twist.twist.linear.x = 2.0
    msg.twist.twist.angular.z = 3.0
    state = body_state_from_odometry(msg, world_frame="world", p_FB_F=np.array([0.1, 0.0, 0.0]))
    np.testing.assert_allclose(state.p_WB_W, [0.0, 0.1, 0.0], atol=1e-15)
    np.testing.assert_allclose(state.v_WB_W, [-0.3, 2.0, 0.0], atol=1e-15)  # w x r turns towards -x
    np.testing.assert_allclose(state.w_WB_W, [0.0, 0.0, 3.0], atol=1e-15)


@given(state=states, p_FB_F=vectors)
def test_the_published_point_moves_as_published(state: BodyState, p_FB_F: np.ndarray) -> None:
    """The Odometry twist against a finite difference of the published pose, by SciPy's rotations."""
    step = 1e-6  # s; the difference is good to about step * w^2 r (1e-6 * 300 * 20) and rounding / step
    msg = odometry_from_body_state(state, world_frame="world", child_frame="f", p_FB_F=p_FB_F)
    turned = Rotation.from_rotvec(0.5 * step * state.w_WB_W)
    attitude = Rotation.from_quat(state.q_WB)
    ahead, behind = turned * attitude, turned.inv() * attitude
    moved = step * state.v_WB_W - ahead.apply(p_FB_F) + behind.apply(p_FB_F)
    linear = msg.twist.twist.linear
    np.testing.assert_allclose(
        attitude.apply([linear.x, linear.y, linear.z]), moved / step, atol=1e-7, rtol=0
    )


def test_a_twist_in_the_body_frame_is_turned() -> None:
    pose, twist = PoseStamped(), TwistStamped()
    pose.header.frame_id = "world"
    pose.pose.orientation.z = pose.pose.orientation.w = math.sqrt(0.5)
    twist.header.frame_id = "brick"
    twist.twist.linear.x = 1.0
    state = body_state_from_pose_twist(
        pose, twist, world_frame="world", body_frame="brick", p_FB_F=np.zeros(3)
    )
    np.testing.assert_allclose(state.v_WB_W, [0.0, 1.0, 0.0], atol=1e-15)


def test_frames_that_do_not_match_are_refused() -> None:
    msg = Odometry()
    msg.header.frame_id = "map"
    with pytest.raises(FrameMismatchError, match=r"header\.frame_id must be 'world'.*, got 'map'"):
        body_state_from_odometry(msg, world_frame="world", p_FB_F=np.zeros(3))
    pose, twist = PoseStamped(), TwistStamped()
    pose.header.frame_id = "world"
    twist.header.frame_id = "tool"
    with pytest.raises(FrameMismatchError, match=r"twist header\.frame_id must be .*, got 'tool'"):
        body_state_from_pose_twist(pose, twist, world_frame="world", body_frame="brick", p_FB_F=np.zeros(3))
    state = BodyStateMsg()
    state.header.frame_id = "odom"
    with pytest.raises(FrameMismatchError, match=r"must be 'world'.*, got 'odom'"):
        body_state_from_msg(state, world_frame="world", p_FB_F=np.zeros(3))


def test_stamps_that_differ_are_refused() -> None:
    pose, twist = PoseStamped(), TwistStamped()
    pose.header.frame_id = twist.header.frame_id = "world"
    twist.header.stamp.nanosec = 1
    with pytest.raises(InvalidFieldError, match=r"twist header\.stamp must be .*, got 1 ns"):
        body_state_from_pose_twist(pose, twist, world_frame="world", body_frame="brick", p_FB_F=np.zeros(3))


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_numbers_that_are_not_finite_are_refused(bad: float) -> None:
    msg = BodyStateMsg()
    msg.linear_velocity.y = bad
    with pytest.raises(InvalidFieldError, match=r"^state\.linear_velocity must be finite, got"):
        body_state_from_msg(msg, world_frame="world", p_FB_F=np.zeros(3))


def test_a_quaternion_that_is_not_unit_is_refused() -> None:
    msg = BodyStateMsg()
    msg.pose.orientation.w = 0.9
    with pytest.raises(
        InvalidFieldError, match=r"state\.pose\.orientation must be a unit vector.* norm 0\.9"
    ):
        body_state_from_msg(msg, world_frame="world", p_FB_F=np.zeros(3))


def test_a_covariance_is_read_whole_or_refused() -> None:
    def read(msg: BodyStateMsg) -> BodyState | UncertainState:
        return known_state_from_msg(msg, world_frame="world", p_FB_F=np.zeros(3))

    assert isinstance(read(BodyStateMsg()), BodyState)
    matrix = np.diag(np.arange(12.0))
    found = read(BodyStateMsg(covariance=matrix.ravel().tolist()))
    assert isinstance(found, UncertainState)
    np.testing.assert_array_equal(found.covariance, matrix)
    with pytest.raises(InvalidFieldError, match=r"covariance must be none or 144.*, got 36 numbers"):
        read(BodyStateMsg(covariance=[0.0] * 36))
    with pytest.raises(InvalidFieldError, match=r"state\.covariance must be .*, got variances"):
        read(BodyStateMsg(covariance=(-matrix).ravel().tolist()))
