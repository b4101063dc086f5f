# SPDX-License-Identifier: Apache-2.0
"""The server takes states from what robots publish: poses alone, covariances, adapters of one's own."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import (
    Pose,
    PoseArray,
    PoseStamped,
    PoseWithCovarianceStamped,
    TwistWithCovarianceStamped,
)

from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.nodes.state_sources import ENTRY_POINTS, adapter_of
from contact_dynamics_interfaces.srv import PredictTumbling
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg
from nodes.monitor import parameters_file
from running_server import PATIENT, ROOT, Client, process

VELOCITY = np.array([0.5, 0.0, 1.0])  # m/s, of all bodies
STEP_NS = 4_000_000
COUNT = 30  # poses, of 116 ms: the filter looks back for 50


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """A server whose bodies each have another source; the last two share a topic of an installed adapter."""
    folder = Path(tmp_path_factory.mktemp("sources"))
    installed = folder / "pose_array_source-0.1.0.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: pose-array-source\nVersion: 0.1.0\n")
    (installed / "entry_points.txt").write_text(
        f"[{ENTRY_POINTS}]\npose_array = pose_array_source:POSE_ARRAY\nbroken = pose_array_source:readers\n"
    )
    parameters: dict[str, Any] = {
        "bodies": ["posed", "certain", "one", "two"],
        "body.posed.pose_topic": "/posed/pose",
        "body.certain.source": "pose_twist_with_covariance",
        "body.certain.source_topics": ["/certain/pose", "/certain/twist"],
        "body.certain.frame": "certain",
    }
    for place, name in enumerate(("one", "two")):
        parameters |= {
            f"body.{name}.source": "pose_array",
            f"body.{name}.source_topics": ["/boxes"],
            f"body.{name}.frame": f"box_{place}",
            f"body.{name}.state_deviations": [1e-3, 1e-2, 0.1, 1.0],
        }
    for name in parameters["bodies"]:
        parameters |= {
            f"body.{name}.mass": 0.5,
            f"body.{name}.inertia": [0.001, 0.002, 0.0025, 0.0, 0.0, 0.0],
        }
    file = parameters_file(folder, {**parameters, "log_directory": str(folder / "logs")})
    with pytest.MonkeyPatch.context() as patch:
        for path in (folder, ROOT / "examples" / "pose_array_source"):
            patch.syspath_prepend(str(path))
        patch.setenv("PYTHONPATH", f"{folder}:{ROOT / 'examples' / 'pose_array_source'}:{ROOT}")
        with process("server", "--params-file", str(file), "--ros-args", "-p", PATIENT, ready="ready"):
            joined = Client()
            try:
                yield joined
            finally:
                joined.close()


def pose_at(seconds: float) -> Pose:
    """Where a body is that floats along."""
    pose = Pose()
    pose.position.x, pose.position.y, pose.position.z = (VELOCITY * seconds).tolist()
    return pose


def stamped(msg: Any, stamp_ns: int) -> Any:
    msg.header.frame_id, msg.header.stamp = "world", stamp_to_msg(stamp_ns)
    return msg


def publish_all(client: Client, body_name: str, publish: Callable[[int, Pose], None], **request: Any) -> Any:
    """Publish the flight of a body; return the answer about its newest state."""
    begin_ns = time.time_ns()
    for i in range(COUNT):
        publish(begin_ns + i * STEP_NS, pose_at(1e-9 * i * STEP_NS))
    last_ns = begin_ns + (COUNT - 1) * STEP_NS
    answers: list[Any] = []

    def came() -> bool:
        asked = PredictTumbling.Request(body_name=body_name, times=[0.0], **request)
        answers.append(client.ask(asked))
        return stamp_ns_from_msg(answers[-1].state.header.stamp) == last_ns

    client.spin_until(came)
    assert answers[-1].status == answers[-1].OK, answers[-1].message
    velocity = answers[-1].state.linear_velocity
    # Stamps are whole nanoseconds, and poses doubles: 1e-9 m over 50 ms.
    np.testing.assert_allclose([velocity.x, velocity.y, velocity.z], VELOCITY, rtol=0.0, atol=1e-6)
    return answers[-1]


def test_poses_alone_are_states_with_velocities_and_have_a_fit(client: Client) -> None:
    poses = client.publisher(PoseStamped, "/posed/pose")

    def publish(stamp_ns: int, pose: Pose) -> None:
        poses.publish(stamped(PoseStamped(pose=pose), stamp_ns))

    assert publish_all(client, "posed", publish).fit_count == 0
    asked = PredictTumbling.Request(body_name="posed", times=[0.0], fit_window=0.05)
    asked.gravity = asked.GRAVITY_NONE
    fitted = client.ask(asked)
    assert fitted.status == fitted.OK, fitted.message
    assert 3 <= fitted.fit_count <= COUNT
    assert fitted.fit_position_residual < 1e-8


def test_published_covariances_are_those_of_the_question(client: Client) -> None:
    """Without them a question with include_covariance needs a fit_window."""
    poses = client.publisher(PoseWithCovarianceStamped, "/certain/pose")
    twists = client.publisher(TwistWithCovarianceStamped, "/certain/twist")

    def publish(stamp_ns: int, pose: Pose) -> None:
        at, moving = PoseWithCovarianceStamped(), TwistWithCovarianceStamped()
        at.pose.pose, at.pose.covariance = pose, (1e-6 * np.eye(6)).ravel().tolist()
        linear = moving.twist.twist.linear
        linear.x, linear.y, linear.z = VELOCITY.tolist()
        moving.twist.covariance = (4e-6 * np.eye(6)).ravel().tolist()
        poses.publish(stamped(at, stamp_ns))
        twists.publish(stamped(moving, stamp_ns))

    answer = publish_all(client, "certain", publish, include_covariance=True)
    covariance = np.array(answer.trajectory.covariances).reshape(12, 12)
    np.testing.assert_allclose(covariance, np.diag([1e-6] * 6 + [4e-6] * 6), rtol=0.0, atol=1e-18)


def test_bodies_share_the_topic_of_an_installed_adapter(client: Client) -> None:
    arrays = client.publisher(PoseArray, "/boxes")

    def publish(stamp_ns: int, pose: Pose) -> None:
        beside = Pose()
        beside.position.x, beside.position.y = 2.0 * pose.position.x, 9.0
        arrays.publish(stamped(PoseArray(poses=[pose, beside]), stamp_ns))

    one = publish_all(client, "one", publish, include_covariance=True)
    variances = np.diag(np.reshape(one.trajectory.covariances, (12, 12)))
    np.testing.assert_allclose(variances, np.repeat([1e-6, 1e-4, 1e-2, 1.0], 3), rtol=1e-12)
    two = client.ask(PredictTumbling.Request(body_name="two", times=[0.0]))
    assert two.state.header.stamp == one.state.header.stamp
    assert two.state.pose.position.y == 9.0
    assert two.state.linear_velocity.x == pytest.approx(2.0 * VELOCITY[0], abs=1e-6)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("odometri", "body.cup.source must be one of odometry, pose_twist, .*, pose_array.*, got 'odometri'"),
        ("broken", "body.cup.source must be .*, got 'broken', which is a function"),
    ],
)
@pytest.mark.usefixtures("client")
def test_a_source_that_is_none_is_named(name: str, words: str) -> None:
    with pytest.raises(ConfigurationError, match=words):
        adapter_of(name, parameter="body.cup.source")
