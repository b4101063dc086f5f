# SPDX-License-Identifier: Apache-2.0
"""A brick at rest whose states are published with noise: the server answers that it rests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from nav_msgs.msg import Odometry
from scipy.spatial.transform import Rotation

from contact_dynamics_interfaces.srv import PredictContactMode
from msg_adapters.stamps import stamp_to_msg
from running_server import Client, server_and_client

DEVIATIONS = [2e-4, 2e-3, 0.02, 0.2]  # m, rad, m/s, rad/s
DRAWS = 10
VARIANCES = np.repeat(np.square(DEVIATIONS), 3)


def odometry(stamp_ns: int, chance: np.random.Generator, *, has_covariance: bool) -> Odometry:
    """Return a noisy state of a brick that lies flat on the floor, turned about the vertical."""
    error = chance.normal(size=12) * np.sqrt(VARIANCES)
    turn = Rotation.from_rotvec(error[3:6]) * Rotation.from_rotvec([0.0, 0.0, chance.uniform(-3.0, 3.0)])
    msg = Odometry(child_frame_id="brick")
    msg.header.frame_id, msg.header.stamp = "world", stamp_to_msg(stamp_ns)
    at, q = msg.pose.pose.position, msg.pose.pose.orientation
    at.x, at.y, at.z = (np.array([0.1, 0.2, 0.025]) + error[:3]).tolist()
    q.x, q.y, q.z, q.w = turn.as_quat().tolist()
    v, w = msg.twist.twist.linear, msg.twist.twist.angular
    v.x, v.y, v.z = turn.inv().apply(error[6:9]).tolist()
    w.x, w.y, w.z = turn.inv().apply(error[9:]).tolist()
    if has_covariance:
        msg.pose.covariance = np.diag(VARIANCES[:6]).ravel()
        msg.twist.covariance = np.diag(VARIANCES[6:]).ravel()
    return msg


def share_at_rest(client: Client, *, has_covariance: bool, **asked: Any) -> float:
    """Return the share of draws for which the newest state is answered as a brick at rest on four feet."""
    states = client.publisher(Odometry, "/brick/odometry")
    chance, right = np.random.default_rng(24), 0
    for _ in range(DRAWS):
        msg = odometry(client.node.get_clock().now().nanoseconds, chance, has_covariance=has_covariance)
        states.publish(msg)
        answers: list[Any] = []

        def is_about_it(msg: Odometry = msg, answers: list[Any] = answers) -> bool:
            request = PredictContactMode.Request(body_name="brick", state_source=2, **asked)
            request.stamp = msg.header.stamp
            answers.append(client.ask(request))
            # Until the state has come, the stamp is ahead of those that have.
            return answers[-1].status == answers[-1].OK

        client.spin_until(is_about_it)
        answer = answers[-1]
        assert answer.status == answer.OK, answer.message
        rests = answer.verdict == answer.UNIQUE and [mode.mode for mode in answer.modes] == ["ffff"]
        right += rests
        assert len(answer.probable_modes) == len(answer.mode_probabilities)
        if asked.get("include_probabilities") and rests:
            assert answer.probable_modes[0] == "ffff"
            assert (
                0.3 < sum(answer.mode_probabilities) < 1.1
            )  # modes that are consistent together count twice
    return right / DRAWS


def test_a_published_or_configured_covariance_tells_noise_from_motion(
    tmp_path: Path,
) -> None:
    """Without them, no tolerance does."""
    with server_and_client(tmp_path, parameters=["state_timeout:=1000.0"]) as client:
        asked = {"include_margins": True, "include_probabilities": True}
        assert share_at_rest(client, has_covariance=True, **asked) >= (DRAWS - 1) / DRAWS
        tolerances = {"velocity_tolerance": 0.02, "distance_tolerance": 0.001}
        assert share_at_rest(client, has_covariance=False, **tolerances) < 0.2
    deviations = f"body.brick.state_deviations:={DEVIATIONS}"
    with server_and_client(tmp_path, parameters=["state_timeout:=1000.0", deviations]) as client:
        assert share_at_rest(client, has_covariance=False) >= (DRAWS - 1) / DRAWS
