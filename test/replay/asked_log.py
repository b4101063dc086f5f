# SPDX-License-Identifier: Apache-2.0
"""A log of a real server for the tests of replay, and the command line without ROS."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry

from contact_dynamics_interfaces.msg import BodyState, BodyStates
from contact_dynamics_interfaces.srv import (
    PredictBodiesContactMode,
    PredictContactMode,
    PredictContactModeBatch,
    PredictImpact,
    PredictImpactBatch,
    PredictToss,
    PredictTumbling,
    PredictTumblingBatch,
)
from msg_adapters.stamps import stamp_to_msg
from running_server import ROOT, server_and_client

ROUNDS = 5
QUIET_S = 1.2  # before the last question
MANY = 3  # states or candidates of a question about many
BLOCKED = """
import sys
class NoRos:
    def find_spec(self, name, path=None, target=None):
        first = name.partition(".")[0]
        if first in {"rclpy", "rpyutils", "ament_index_python"} or first.endswith(("_msgs", "_interfaces")):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
sys.meta_path.insert(0, NoRos())
from contact_dynamics.command_line import main
sys.exit(main(sys.argv[1:]))
"""
"""The command line where no module of ROS can be found."""


def without_ros(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run `contact-dynamics replay` in a process in which nothing of ROS can be imported."""
    return subprocess.run(
        [sys.executable, "-c", BLOCKED, "replay", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT), "AMENT_PREFIX_PATH": ""},
    )


@dataclass(frozen=True, kw_only=True)
class Asked:
    """A log, and how many questions each service was asked."""

    log: Path
    counts: dict[str, int]

    @property
    def rows(self) -> int:
        """How many rows a table of it has."""
        batches = sum(count for name, count in self.counts.items() if name.endswith("Batch"))
        return sum(self.counts.values()) + (MANY - 1) * batches


def odometry(stamp: Any, number: int) -> Odometry:
    """A state of the brick in the air, tumbling."""
    msg = Odometry(child_frame_id="brick")
    msg.header.frame_id, msg.header.stamp = "world", stamp
    msg.pose.pose.position.x, msg.pose.pose.position.z = 0.1 * number, 1.0 + 0.01 * number
    half = 0.05 * number
    msg.pose.pose.orientation.x, msg.pose.pose.orientation.w = math.sin(half), math.cos(half)
    msg.twist.twist.linear.x, msg.twist.twist.angular.y = 0.3 * number, 1.0 + number
    return msg


def questions(number: int, now: Time) -> list[Any]:
    """What depends on the newest states, and what depends on the question alone; some are refused."""
    until = PredictTumbling.Request(body_name="brick", sampling=PredictTumbling.Request.UNTIL_CONTACT)
    fitted = PredictTumbling.Request(body_name="brick", fit_window=0.2, include_covariance=True)
    at_stamp = PredictTumbling.Request(body_name="brick", fit_window=0.02, include_covariance=True)
    at_stamp.state_source, at_stamp.stamp = at_stamp.STATE_AT_STAMP, now  # after the newest state
    standing = PredictContactMode.Request(
        state_source=PredictContactMode.Request.STATE_EXPLICIT, body_name="brick", include_margins=True
    )
    standing.state.pose.position.z = 0.025
    standing.applied_wrench.force.x = 0.2 * number
    return [
        until,
        fitted,
        *([] if number % 4 else [at_stamp]),
        PredictImpact.Request(body_name="brick"),
        standing,
        PredictImpact.Request(body_name=f"cat {number}"),
        *about_tosses(number),
        PredictTumbling.Request(body_name="ball", duration=math.nan if number % 2 else 0.1),
        *about_many(number),
        about_bodies(),
    ]


def about_tosses(number: int) -> list[Any]:
    """Tosses of the brick from where it is or is said to be, sampled too, and one that is refused."""
    if number % 4:  # they take a hundred times as long as the others
        return []
    sampled = PredictToss.Request(body_name="brick", samples=20, strikes=3, seed=number)
    sampled.state_source, sampled.state.pose.position.z = sampled.STATE_EXPLICIT, 0.3
    sampled.state.angular_velocity.x = 4.0
    sampled.state.covariance = (1e-4 * np.eye(12)).ravel().tolist()
    sampled.velocity_spread, sampled.spin_spread, sampled.height_spread = 0.02, 0.3, 0.001
    sampled.lasting_factors, sampled.lasting_factor_stds = [1.3], [0.1]
    return [
        PredictToss.Request(body_name="brick", max_alternatives=0, rate=10.0),
        sampled,
        PredictToss.Request(body_name="brick", samples=10_000),
    ]


def about_many(number: int) -> list[Any]:
    """Three states of the brick: of the impacts two strike, and one separates."""
    states = BodyStates(
        positions=[0.0, 0.0, 1.0, 0.5, 0.0, 1.0, 1.0, 0.0, 1.0 + 0.1 * number],
        orientations=[0.0, 0.0, 0.0, 1.0] * MANY,
        linear_velocities=[1.0, 0.0, -1.0, 0.0, 0.2, -2.0, 0.0, 0.0, 3.0],
        angular_velocities=[0.0, 3.0, 0.0] * MANY,
    )
    impacts = PredictImpactBatch.Request(body_name="brick", states=states, restitutions=[0.5])
    impacts.contact_positions = [0.05, 0.0, 0.98, 0.45, 0.0, 0.98, 1.0, 0.0, 0.98]
    impacts.contact_normals, impacts.frictions = [0.0, 0.0, 1.0], [0.1, 0.2, 0.3]
    flights = PredictTumblingBatch.Request(body_name="brick", states=states, times=[0.1, 0.2, 0.3])
    return [impacts, flights, *about_candidates(number)]


def about_candidates(number: int) -> list[Any]:
    """The brick that stands: under three wrenches, and on each of three sets of its four contacts."""
    explicit = PredictContactModeBatch.Request.STATE_EXPLICIT
    pushed = PredictContactModeBatch.Request(body_name="brick", state_source=explicit)
    pushed.state.pose.position.z = 0.025
    pushed.forces = [0.0, 0.0, 0.0, 0.1 + 0.01 * number, 0.0, 0.0, 9.0, 0.0, 0.0]
    standing = PredictContactModeBatch.Request(body_name="brick", state_source=explicit)
    standing.state.pose.position.z = 0.025
    standing.contact_source = PredictContactModeBatch.Request.CONTACTS_EXPLICIT
    standing.contacts.positions = [0.05, 0.0, 0.0, -0.05, 0.0, 0.0, 0.05, 0.0, 0.0, -0.02, 0.0, 0.0]
    standing.contacts.normals, standing.contacts.frictions = [0.0, 0.0, 1.0] * 4, [0.1, 0.2, 0.3, 0.4]
    standing.contacts.restitutions = [0.0] * 4
    standing.contacts.surface_names = ["floor", "floor", "table", "ramp"]
    standing.contact_counts = [2, 1, 1]
    return [pushed, standing]


def about_bodies() -> PredictBodiesContactMode.Request:
    """The brick and the ball, from topics of two kinds, which touch somewhere."""
    touching = PredictBodiesContactMode.Request(
        states=[BodyState(body_name=name) for name in ("brick", "ball")]
    )
    touching.contacts.positions, touching.contacts.normals = [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]
    touching.contacts.frictions, touching.velocity_tolerance = [0.3], 100.0
    touching.contact_bodies, touching.other_bodies = [1], [0]
    return touching


def configured(folder: Path) -> Path:
    """The commented configuration, with a ball whose pose and twist are published apart, and a crate."""
    text = (ROOT / "config" / "server.yaml").read_text(encoding="utf-8")
    assert "bodies: [brick]" in text
    ball = (
        "    body.ball.mass: 0.2\n    body.ball.inertia: [0.0]\n    body.ball.sphere: [0.04]\n"
        "    body.ball.pose_topic: ball/pose\n    body.ball.twist_topic: ball/twist\n"
        "    body.crate.mass: 1.0\n    body.crate.inertia: [0.0]\n    body.crate.box: [0.1, 0.1, 0.1]\n"
        "    body.crate.odometry_topic: crate/odometry\n"
    )
    file = folder / "server.yaml"
    text = text.replace("bodies: [brick]", "bodies: [brick, ball, crate]")
    # On a loaded machine a state may be old when its question comes. The one that is too old is 10 s late.
    assert "    state_timeout: 0.5\n" in text
    text = text.replace("    state_timeout: 0.5\n", "    state_timeout: 3.0\n")
    file.write_text(f"{text.rstrip()}\n\n{ball}", encoding="utf-8")
    return file


def session(folder: Path) -> Asked:
    """A session in which states and questions alternate, and the last is about a state that was too old."""
    counts: dict[str, int] = {}
    with server_and_client(folder / "logs", params_file=configured(folder)) as client:
        publishers = {
            "odometry": client.publisher(Odometry, "/brick/odometry"),
            "pose": client.publisher(PoseStamped, "/ball/pose"),
            "twist": client.publisher(TwistStamped, "/ball/twist"),
        }
        late = odometry(stamp_to_msg(client.node.get_clock().now().nanoseconds - 10_000_000_000), 0)
        late.child_frame_id = "crate"
        client.publisher(Odometry, "/crate/odometry").publish(late)

        def publish(number: int) -> None:
            stamp = client.node.get_clock().now().to_msg()
            publishers["odometry"].publish(odometry(stamp, number))
            pose, twist = PoseStamped(), TwistStamped()
            for msg in (pose, twist):
                msg.header.frame_id, msg.header.stamp = "world", stamp
            pose.pose.position.z, twist.twist.linear.y = 1.0 + 0.1 * number, 0.5
            publishers["twist"].publish(twist)
            publishers["pose"].publish(pose)

        def ask(request: Any) -> Any:
            name = type(request).__name__.removesuffix("_Request")
            counts[name] = counts.get(name, 0) + 1
            return client.ask(request)

        for number in range(ROUNDS):
            for step in range(4):
                publish(4 * number + step)
            for request in questions(number, client.node.get_clock().now().to_msg()):
                ask(request)
        time.sleep(QUIET_S)
        stale = ask(PredictImpact.Request(body_name="crate"))
        assert stale.status == PredictImpact.Response.STALE_STATE
    (log,) = (folder / "logs").iterdir()
    return Asked(log=log, counts=counts)
