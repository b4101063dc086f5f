# SPDX-License-Identifier: Apache-2.0
"""Messages that robots publish become states: frames, covariances, and velocities from poses alone."""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import (
    PoseStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
    TwistWithCovarianceStamped,
)
from nav_msgs.msg import Odometry

from contact_dynamics.errors import FrameMismatchError, InvalidFieldError
from contact_dynamics.motion.velocity_estimate import slope_noise
from contact_dynamics.nodes.state_sources import ADAPTERS
from contact_dynamics.questions.uncertain_state import KnownState, UncertainState, state_of
from contact_dynamics.recording.definitions import find_definition
from contact_dynamics.recording.message_types import message_types
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rigid_body.published_frame import state_of_center_of_mass
from contact_dynamics.rotations.many import rotation_vectors, turned
from contact_dynamics.rotations.one import rotation_matrix
from msg_adapters.odometry import ODOMETRY, odometry_from_body_state
from msg_adapters.pose import POSE, POSE_WITH_COVARIANCE, RIGID_BODIES, TF
from msg_adapters.pose_twist import POSE_TWIST_WITH_COVARIANCE
from msg_adapters.stamps import stamp_to_msg
from msg_adapters.state_adapter import SourceSettings, StateAdapter
from msg_adapters.transforms import TransformTree

MS = 1_000_000  # ns
CENTER = np.array([0.1, -0.03, 0.02])  # m
STATE = BodyState(
    p_WB_W=[0.4, -0.2, 1.0], q_WB=[0.28, 0.28, 0.1, 0.9131265], v_WB_W=[1.0, 0.2, -0.5],
    w_WB_W=[1.0, 5.0, -2.0], stamp_ns=7 * MS,
)  # fmt: skip
ROUNDING = 1e-14  # a few operations on numbers near 1


def settings(p_FB_F: np.ndarray = CENTER, window: float = 0.05) -> SourceSettings:
    return SourceSettings(
        body_name="brick",
        body_frame="brick_link",
        world_frame="world",
        p_FB_F=p_FB_F,
        velocity_window=window,
        static=TransformTree(),
    )


def transforms(*each: TransformStamped) -> Any:
    """A tf2_msgs/TFMessage as a log describes it: the package has no wheel."""
    stamped = find_definition("geometry_msgs/msg/TransformStamped").text
    heading = f"{'=' * 80}\nMSG: geometry_msgs/TransformStamped"
    text = f"geometry_msgs/TransformStamped[] transforms\n{heading}\n{stamped}"
    return message_types("tf2_msgs/msg/TFMessage", text)["tf2_msgs/TFMessage"](transforms=list(each))


def transform(
    parent: str, child: str, stamp_ns: int, p: Sequence[float], q: Sequence[float]
) -> TransformStamped:
    msg = TransformStamped(child_frame_id=child)
    msg.header.frame_id, msg.header.stamp = parent, stamp_to_msg(stamp_ns)
    at, turn = msg.transform.translation, msg.transform.rotation
    at.x, at.y, at.z = map(float, p)
    turn.x, turn.y, turn.z, turn.w = map(float, q)
    return msg


def unit(*q: float) -> np.ndarray:
    return np.array(q) / math.hypot(*q)


def matrix(p: Sequence[float], q: np.ndarray) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation_matrix(q), p
    return T


CAMERA = ([0.5, -1.0, 2.0], unit(0.3, -0.2, 0.5, 0.7))
"""Where a camera stands in the world."""


def same_state(one: KnownState | None, other: BodyState, atol: float = ROUNDING) -> None:
    assert one is not None
    found = state_of(one)
    assert found.stamp_ns == other.stamp_ns
    for name in ("p_WB_W", "v_WB_W", "w_WB_W"):
        np.testing.assert_allclose(getattr(found, name), getattr(other, name), rtol=0.0, atol=atol)
    assert abs(found.q_WB @ other.q_WB) == pytest.approx(1.0, abs=atol)


def test_every_source_has_a_case_here() -> None:
    """`test_states` has those of poses with twists, which are as old as the package."""
    here = {id(each) for each in globals().values() if isinstance(each, StateAdapter)}
    assert [name for name, adapter in ADAPTERS.items() if id(adapter) not in here] == ["pose_twist"]


# Frames


def test_a_frame_is_found_up_and_down_the_tree() -> None:
    """World and tool meet in the base, as an arm that calibrates its camera publishes it."""
    tree = TransformTree()
    base_world, base_tool = ([1.0, 0.0, 0.5], unit(0.1, 0.2, 0.3, 1.0)), ([0.0, 2.0, 0.1], unit(1, 0, 0, 1))
    tree.add(transforms(transform("base", "world", 0, *base_world)), is_static=True)
    tree.add(
        transforms(
            transform("base", "arm", 5, *base_tool), transform("arm", "tool", 5, [0, 0, 1], [0, 0, 0, 1])
        ),
        is_static=False,
    )
    found = tree.pose("tool", in_frame="world", stamp_ns=5, field="frame")
    expected = np.linalg.inv(matrix(*base_world)) @ matrix(*base_tool) @ matrix([0, 0, 1], np.eye(4)[3])
    np.testing.assert_allclose(matrix(found.p, found.q), expected, rtol=0.0, atol=ROUNDING)
    with pytest.raises(
        FrameMismatchError,
        match=r"frame must be .*, got 'tool', whose frame 'tool' was last published at 5 ns",
    ):
        tree.pose("tool", in_frame="world", stamp_ns=6, field="frame")
    with pytest.raises(
        FrameMismatchError, match=r"frame must be 'world', or a frame with a known.*, got 'cup'"
    ):
        tree.pose("cup", in_frame="world", stamp_ns=5, field="frame")


def test_a_tree_that_bites_its_tail_has_an_end() -> None:
    tree = TransformTree()
    tree.add(
        transforms(
            transform("a", "b", 0, [1, 0, 0], [0, 0, 0, 1]), transform("b", "a", 0, [1, 0, 0], [0, 0, 0, 1])
        ),
        is_static=True,
    )
    with pytest.raises(FrameMismatchError):
        tree.pose("a", in_frame="world", stamp_ns=0, field="frame")


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        (
            transform("world", "", 0, [0, 0, 0], [0, 0, 0, 1]),
            r"transforms\[0\]\.child_frame_id must be .*, got nothing",
        ),
        (
            transform("world", "a", 0, [0, 0, math.nan], [0, 0, 0, 1]),
            r"transforms\[0\]\.transform\.translation",
        ),
        (transform("world", "a", 0, [0, 0, 0], [0, 0, 0, 0]), r"transforms\[0\]\.transform\.rotation"),
    ],
)
def test_a_transform_without_sense_is_refused(bad: TransformStamped, words: str) -> None:
    with pytest.raises(InvalidFieldError, match=words):
        TransformTree().add(transforms(bad), is_static=True)


def test_states_in_a_cameras_frame_are_turned_into_the_world() -> None:
    """The camera stands still, and its transform is known before the state or not at all."""
    known = settings()
    (read,) = ODOMETRY.readers(known)
    T = matrix(*CAMERA)
    inner = np.linalg.inv(T)
    R = inner[:3, :3]
    seen = BodyState(
        p_WB_W=R @ STATE.p_WB_W + inner[:3, 3],
        q_WB=_q_of(R @ rotation_matrix(STATE.q_WB)),
        v_WB_W=R @ STATE.v_WB_W,
        w_WB_W=R @ STATE.w_WB_W,
        stamp_ns=STATE.stamp_ns,
    )
    msg = odometry_from_body_state(seen, world_frame="camera", child_frame="brick_link", p_FB_F=CENTER)
    with pytest.raises(FrameMismatchError, match=r"header\.frame_id must be 'world'.*, got 'camera'"):
        read(msg)
    known.static.add(transforms(transform("world", "camera", 0, *CAMERA)), is_static=True)
    same_state(read(msg), STATE)


def _q_of(R: np.ndarray) -> np.ndarray:
    w = 0.5 * math.sqrt(1.0 + np.trace(R))
    return np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 4.0 * w * w]) / (4.0 * w)


# Covariances


def random_covariance(seed: int) -> np.ndarray:
    root = np.random.default_rng(seed).normal(size=(6, 6))
    return 1e-8 * root @ root.T


def numbers(covariance: np.ndarray) -> array[float]:
    return array("d", covariance.ravel().tolist())


def covariance_by_differences(p: np.ndarray, v: np.ndarray, w: np.ndarray, *, body_axes: bool) -> np.ndarray:
    """The derivative of the state by what is published, as differences of the conversion itself."""
    pose, twist, q = random_covariance(1), random_covariance(2), STATE.q_WB
    h = 1e-6

    def state(x: np.ndarray) -> np.ndarray:
        q_x = turned(q[None], x[None, 3:6])[0]
        axes = rotation_matrix(q_x) if body_axes else np.eye(3)
        made = state_of_center_of_mass(
            p_WF_W=p + x[:3], q_WF=q_x, v_WF_W=axes @ (v + x[6:9]), w_WF_W=axes @ (w + x[9:]),
            p_FB_F=CENTER, stamp_ns=0,
        )  # fmt: skip
        turn = rotation_vectors(made.q_WB[None], q)[0]
        return np.concatenate([made.p_WB_W, turn, made.v_WB_W, made.w_WB_W])

    J = np.column_stack([(state(h * e) - state(-h * e)) / (2.0 * h) for e in np.eye(12)])
    both = np.zeros((12, 12))
    both[:6, :6], both[6:, 6:] = pose, twist
    return J @ both @ J.T


@pytest.mark.parametrize("source", ["odometry", "body", "world"])
def test_published_covariances_become_that_of_the_centre_of_mass(source: str) -> None:
    msg = odometry_from_body_state(STATE, world_frame="world", child_frame="brick_link", p_FB_F=CENTER)
    p = np.array([msg.pose.pose.position.x, msg.pose.pose.position.y, msg.pose.pose.position.z])
    v, w = (np.array([x.x, x.y, x.z]) for x in (msg.twist.twist.linear, msg.twist.twist.angular))
    msg.pose.covariance, msg.twist.covariance = numbers(random_covariance(1)), numbers(random_covariance(2))
    if source == "odometry":
        found = ODOMETRY.readers(settings())[0](msg)
    else:
        if source == "world":
            R = rotation_matrix(STATE.q_WB)
            v, w = R @ v, R @ w
        pose, twist = (
            PoseWithCovarianceStamped(header=msg.header, pose=msg.pose),
            TwistWithCovarianceStamped(),
        )
        twist.header.stamp, twist.twist.covariance = msg.header.stamp, msg.twist.covariance
        twist.header.frame_id = "brick_link" if source == "body" else "world"
        (linear, angular) = twist.twist.twist.linear, twist.twist.twist.angular
        linear.x, linear.y, linear.z = v.tolist()
        angular.x, angular.y, angular.z = w.tolist()
        read_pose, read_twist = POSE_TWIST_WITH_COVARIANCE.readers(settings())
        assert read_twist(twist) is None
        found = read_pose(pose)
    assert isinstance(found, UncertainState)
    same_state(found, STATE)
    expected = covariance_by_differences(p, v, w, body_axes=source != "world")
    # Differences over 1e-6 leave 1e-10 of each derivative.
    np.testing.assert_allclose(found.covariance, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("unknown", ["zeros", "minus one", "no covariance"])
def test_a_covariance_that_is_none_leaves_the_state(unknown: str) -> None:
    msg = odometry_from_body_state(STATE, world_frame="world", child_frame="brick_link", p_FB_F=CENTER)
    known = np.eye(6)
    if unknown == "zeros":
        known = np.zeros((6, 6))
    elif unknown == "minus one":
        known[0, 0] = -1.0
    else:
        known[1, 1] = -1.0
    msg.pose.covariance, msg.twist.covariance = numbers(known), numbers(np.eye(6))
    found = ODOMETRY.readers(settings())[0](msg)
    assert isinstance(found, BodyState)


def test_odometry_of_another_frame_than_the_bodys_is_refused() -> None:
    """Its pose and twist would be taken for those of the body."""
    (read,) = ODOMETRY.readers(settings())
    known = {"world_frame": "world", "p_FB_F": CENTER}
    assert read(odometry_from_body_state(STATE, child_frame="brick_link", **known)) is not None
    assert read(odometry_from_body_state(STATE, child_frame="", **known)) is not None
    allowed = "child_frame_id must be 'brick_link'.*, got 'base_link'"
    with pytest.raises(FrameMismatchError, match=allowed):
        read(odometry_from_body_state(STATE, child_frame="base_link", **known))


# Poses alone


def flying(t: float, p_FB_F: np.ndarray = CENTER) -> tuple[PoseStamped, BodyState]:
    """A body that flies and turns about a fixed axis, as a pose of its frame, and its state."""
    turn = np.array([0.6, 0.0, 0.8]) * 5.0 * t
    q = turned(np.array([[0.0, 0.0, 0.0, 1.0]]), turn[None])[0]
    center = np.array([1.0 + 2.0 * t, 0.0, 1.0 + 3.0 * t - 0.5 * 9.81 * t * t])
    state = BodyState(
        p_WB_W=center, q_WB=q, v_WB_W=[2.0, 0.0, 3.0 - 9.81 * t], w_WB_W=[3.0, 0.0, 4.0],
        stamp_ns=1000 * MS + round(1e9 * t),
    )  # fmt: skip
    msg = PoseStamped()
    msg.header.frame_id, msg.header.stamp = "world", stamp_to_msg(state.stamp_ns)
    origin = center - rotation_matrix(q) @ p_FB_F
    msg.pose.position.x, msg.pose.position.y, msg.pose.position.z = origin.tolist()
    turned_to = msg.pose.orientation
    turned_to.x, turned_to.y, turned_to.z, turned_to.w = q.tolist()
    return msg, state


def test_a_flight_of_poses_has_its_velocity_without_delay() -> None:
    """A quadratic is exact in flight. Stamps of whole nanoseconds at 3 m/s leave 1e-7 m/s."""
    (read,) = POSE.readers(settings(np.zeros(3)))
    for i in range(20):
        msg, state = flying(0.004 * i, np.zeros(3))
        found = read(msg)
        assert (found is None) == (i < 4), "five poses, before there is a velocity"
        if found is not None:
            same_state(found, state, atol=1e-6)


def test_a_lever_costs_what_its_own_curve_costs() -> None:
    """A circle of 0.1 m at 5 rad/s is no quadratic: the slope is wrong by r w^3 T^2 / 10 and less."""
    (read,) = POSE.readers(settings())
    for i in range(20):
        msg, state = flying(0.004 * i)
        found = read(msg)
    assert found is not None
    bound = 0.11 * 5.0**3 * 0.05**2 / 10.0
    assert 0.0 < np.abs(state_of(found).v_WB_W - state.v_WB_W).max() < bound


def test_noise_of_poses_becomes_that_of_velocities() -> None:
    """By the formula of the filter, for a steady rate."""
    (read,) = POSE_WITH_COVARIANCE.readers(settings(np.zeros(3)))
    for i in range(30):
        plain, _ = flying(0.005 * i, np.zeros(3))
        msg = PoseWithCovarianceStamped(header=plain.header)
        msg.pose.pose = plain.pose
        msg.pose.covariance = numbers(np.diag([1e-6] * 3 + [4e-6] * 3))
        found = read(msg)
    assert isinstance(found, UncertainState)
    deviations = np.sqrt(found.covariance.diagonal())
    frames = 11  # 50 ms at 200 Hz, and the newest
    np.testing.assert_allclose(deviations[:6], [1e-3] * 3 + [2e-3] * 3, rtol=1e-12)
    for part, noise in ((deviations[6:9], 1e-3), (deviations[9:], 2e-3)):
        np.testing.assert_allclose(part, slope_noise(frames=frames, rate=200.0, noise=noise), rtol=1e-9)


def test_poses_that_come_late_or_after_a_gap() -> None:
    (read,) = POSE.readers(settings())
    stamps = [0.0, 0.01, 0.02, 0.03, 0.04]
    found = [read(flying(t)[0]) for t in stamps]
    assert found[-1] is not None
    assert read(flying(0.035)[0]) is None, "an older one changes nothing"
    assert read(flying(0.04)[0]) is None, "nor the same again"
    assert read(flying(0.5)[0]) is None, "after ten windows of silence it begins anew"


def test_poses_after_a_clock_was_set_back_become_states_again() -> None:
    """Of who publishes, such as a camera's computer that is told the time late, or of a simulation."""
    (read,) = POSE.readers(settings(np.zeros(3)))
    before = [read(flying(3600.0 + 0.01 * i)[0]) for i in range(5)]
    assert before[-1] is not None
    found = [read(flying(0.01 * i, np.zeros(3))[0]) for i in range(20)]
    assert [state is None for state in found] == [i < 8 for i in range(20)]
    same_state(found[-1], flying(0.19, np.zeros(3))[1], atol=1e-6)


def test_a_second_publisher_that_is_behind_does_not_blind_the_first_one() -> None:
    (read,) = POSE.readers(settings())
    found = [read(flying(t)[0]) for i in range(20) for t in (10.0 + 0.01 * i, 0.01 * i)]
    assert all(state is not None for state in found[8::2])
    assert all(state is None for state in found[1::2])


def test_half_a_turn_within_the_window_is_refused() -> None:
    """A body at 5 rad/s turns by half a turn in 0.63 s."""
    (read,) = POSE.readers(settings(window=0.7))
    for i in range(50):
        read(flying(0.0125 * i)[0])
    words = r"pose\.orientation must be less than half a turn.*, got a turn by 3\.19 rad within 0\.638 s"
    with pytest.raises(InvalidFieldError, match=words):
        [read(flying(0.0125 * i)[0]) for i in (50, 51, 52)]


def test_half_a_turn_while_poses_are_missing_is_refused() -> None:
    """A body at 5 rad/s turns by 3.5 rad in 0.7 s, which look like 2.8 rad backwards."""
    (read,) = POSE.readers(settings(window=0.15))
    for i in range(20):
        read(flying(0.01 * i)[0])
    words = r"pose\.orientation must be less than half.*, got 0\.71 s without a pose, at about 5 rad/s"
    with pytest.raises(InvalidFieldError, match=words):
        read(flying(0.9)[0])


# Trees and lists of bodies


def test_a_bodys_frame_in_the_tree_is_its_pose() -> None:
    """The arm's link comes in the same message, the camera's stands still, and others do not matter."""
    known = settings(np.zeros(3))
    known.static.add(transforms(transform("world", "camera", 0, *CAMERA)), is_static=True)
    (read,) = TF.readers(known)
    found: KnownState | None = None
    for i in range(12):
        _, state = flying(0.004 * i, np.zeros(3))
        inner = np.linalg.inv(matrix(*CAMERA)) @ matrix(state.p_WB_W, state.q_WB)
        seen = transform("camera", "brick_link", state.stamp_ns, inner[:3, 3].tolist(), _q_of(inner[:3, :3]))
        assert read(transforms(transform("world", "cup", state.stamp_ns, [0, 0, 0], [0, 0, 0, 1]))) is None
        found = read(transforms(seen))
    same_state(found, state, atol=1e-6)


def test_a_moving_frame_of_another_time_is_refused_by_name() -> None:
    (read,) = TF.readers(settings())
    with pytest.raises(
        FrameMismatchError,
        match=r"child_frame_id must be .*, got 'brick_link', whose frame 'gripper' was last",
    ):
        read(
            transforms(
                transform("world", "gripper", 1 * MS, [0, 0, 0], [0, 0, 0, 1]),
                transform("gripper", "brick_link", 2 * MS, [0, 0, 0], [0, 0, 0, 1]),
            )
        )


def test_a_body_is_found_in_the_list_of_a_motion_capture() -> None:
    """`mocap4r2_msgs` as a log describes it, without the markers' own fields, which nothing reads."""
    header, pose = find_definition("std_msgs/msg/Header").text, find_definition("geometry_msgs/msg/Pose").text
    parts = (
        "std_msgs/Header header\nuint32 frame_number\nRigidBody[] rigidbodies",
        "MSG: mocap4r2_msgs/RigidBody\nstring rigid_body_name\ngeometry_msgs/Pose pose",
        f"MSG: std_msgs/Header\n{header}",
        f"MSG: geometry_msgs/Pose\n{pose}",
    )
    text = f"\n{'=' * 80}\n".join(parts)
    types = message_types("mocap4r2_msgs/msg/RigidBodies", text)
    (read,) = RIGID_BODIES.readers(settings(np.zeros(3)))
    found: KnownState | None = None
    for i in range(12):
        plain, state = flying(0.004 * i, np.zeros(3))
        bodies = [
            types["mocap4r2_msgs/RigidBody"](rigid_body_name=name, pose=plain.pose)
            for name in ("cup", "brick_link")
        ]
        found = read(types["mocap4r2_msgs/RigidBodies"](header=plain.header, rigidbodies=bodies))
        assert read(types["mocap4r2_msgs/RigidBodies"](header=plain.header, rigidbodies=bodies[:1])) is None
    same_state(found, state, atol=1e-6)


def test_odometry_without_covariance_is_a_plain_state() -> None:
    msg = odometry_from_body_state(STATE, world_frame="world", child_frame="brick_link", p_FB_F=CENTER)
    assert isinstance(msg, Odometry)
    found = ODOMETRY.readers(settings())[0](msg)
    assert isinstance(found, BodyState)
    same_state(found, STATE)
