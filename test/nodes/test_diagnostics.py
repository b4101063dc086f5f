# SPDX-License-Identifier: Apache-2.0
"""/diagnostics over real DDS: each situation of the table is reported as long as its cause is there."""

from __future__ import annotations

import contextlib
import math
import os
import re
import signal
import subprocess
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock

from contact_dynamics.nodes.situations import Part, Situation
from contact_dynamics_interfaces.srv import PredictImpact, PredictTumbling
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg
from nodes.monitor import Monitor, monitored, odometry
from running_server import ROOT, process, wait_for

BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
HOUR_NS = 3_600_000_000_000
OTHERS = ("pair", "late", "twice")
FOUR_BODIES = {
    "bodies": ["brick", *OTHERS],
    **{f"body.{name}.mass": 1.0 for name in OTHERS},
    **{f"body.{name}.inertia": [0.001, 0.001, 0.001, 0.0, 0.0, 0.0] for name in OTHERS},
    "body.pair.pose_topic": "/pair/pose",
    "body.pair.twist_topic": "/pair/twist",
    "body.late.odometry_topic": "/late/odometry",
    "body.twice.odometry_topic": "/twice/odometry",
    "body.twice.pose_topic": "/twice/pose",
    "state_timeout": 100.0,
    "silent_after": 1.0,
    "log": False,
}


@pytest.fixture(scope="module")
def monitor(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Monitor]:
    with monitored(tmp_path_factory.mktemp("config"), **FOUR_BODIES) as (_, monitor):
        yield monitor


@pytest.fixture
def states(monitor: Monitor) -> Iterator[Any]:
    """The one publisher of the brick's states."""
    made = monitor.client.publisher(Odometry, "/brick/odometry")
    yield made
    monitor.client.node.destroy_publisher(made)


def test_a_body_of_which_nothing_came(monitor: Monitor) -> None:
    monitor.wait(Situation.NO_STATE_YET, "'late' received on /late/odometry (0 publishers)")
    states = monitor.client.publisher(Odometry, "/late/odometry")
    monitor.wait_until_over(
        Situation.NO_STATE_YET, "'late'", work=lambda: states.publish(odometry(child="late"))
    )
    monitor.client.node.destroy_publisher(states)


def test_states_that_are_rejected(monitor: Monitor, states: Any) -> None:
    """All of them for each of some reasons, and then one in three."""
    for wrong, reason in (
        ({"frame": "map"}, "got 'map'"),
        ({"x": 2}, "(rclpy sends this for an int"),
        ({"is_stamped": False}, "stamp must be the time of the state, got 0 (fill in header.stamp"),
    ):
        reject = partial(states.publish, odometry(**wrong))
        monitor.wait(Situation.ALL_REJECTED, "'brick'", reason, work=reject)

    def publish() -> None:
        states.publish(odometry())
        states.publish(odometry(frame="map"))
        states.publish(odometry())

    monitor.wait(Situation.SOME_REJECTED, "'brick'", "got 'map'", work=publish)
    monitor.wait_until_over(Situation.SOME_REJECTED, "rejected", work=lambda: states.publish(odometry()))


def test_states_that_are_old_when_they_come(monitor: Monitor, states: Any) -> None:
    monitor.wait(Situation.OLD, "by 3600.", work=lambda: states.publish(odometry(ahead_ns=-HOUR_NS)))
    monitor.wait_until_over(Situation.OLD, "too old", work=lambda: states.publish(odometry()))


def test_a_twist_in_the_axes_of_the_world(monitor: Monitor, states: Any) -> None:
    """The body is turned by 90 degrees about z, and moves along x."""
    begun_ns = time.time_ns()

    def publish(*, is_right: bool) -> None:
        msg = odometry()
        turn, velocity = msg.pose.pose.orientation, msg.twist.twist.linear
        turn.z = turn.w = math.sqrt(0.5)
        msg.pose.pose.position.x = 3.0 * (stamp_ns_from_msg(msg.header.stamp) - begun_ns) / 1e9
        velocity.x, velocity.y = (0.0, -3.0) if is_right else (3.0, 0.0)
        states.publish(msg)

    words = "/brick/odometry: the twist disagrees with the poses by 4.2 m/s"
    monitor.wait(Situation.TWIST_AXES, words, work=lambda: publish(is_right=False))
    monitor.wait_until_over(Situation.TWIST_AXES, "the twist disagrees", work=lambda: publish(is_right=True))


def test_publishers_that_do_not_match(monitor: Monitor, states: Any) -> None:
    """The one cannot be received by a reliable subscription, and what the other sends is of another type."""
    node = monitor.client.node
    others = [
        node.create_publisher(Odometry, "/brick/odometry", BEST_EFFORT),
        node.create_publisher(PoseStamped, "/pair/twist", 10),
    ]

    def publish() -> None:
        states.publish(odometry())

    monitor.wait(Situation.NO_MATCH, "1 of 2 publishers cannot be received: Best effort", work=publish)
    monitor.wait(Situation.NO_MATCH, "/pair/twist: 1 of 1 publishers", "they send geometry", work=publish)
    for each in others:
        node.destroy_publisher(each)
    monitor.wait_until_over(Situation.NO_MATCH, "cannot be received", work=publish)


def test_a_second_publisher_of_a_body(monitor: Monitor, states: Any) -> None:
    second = monitor.client.node.create_publisher(Odometry, "/brick/odometry", 10)
    monitor.wait(Situation.SEVERAL_PUBLISHERS, "/brick/odometry: 2 publishers")
    monitor.client.node.destroy_publisher(second)
    monitor.wait_until_over(Situation.SEVERAL_PUBLISHERS, "publishers send")
    assert states.topic_name == "/brick/odometry"


def test_a_body_with_two_sources_that_both_publish(monitor: Monitor) -> None:
    states = monitor.client.publisher(Odometry, "/twice/odometry")
    poses = monitor.client.publisher(PoseStamped, "/twice/pose")
    monitor.wait(Situation.SEVERAL_PUBLISHERS, "/twice/odometry", " and ", "/twice/pose", ": 2 publishers")
    monitor.client.node.destroy_publisher(poses)
    monitor.wait_until_over(Situation.SEVERAL_PUBLISHERS, "publishers send")
    monitor.client.node.destroy_publisher(states)


def test_a_body_that_is_gone_from_a_shared_topic(monitor: Monitor) -> None:
    """Poses and twists come, and have no equal stamps any more, so that none of them makes a state."""
    poses = monitor.client.publisher(PoseStamped, "/pair/pose")
    twists = monitor.client.publisher(TwistStamped, "/pair/twist")

    def publish(apart_ns: int) -> None:
        pose, twist, now_ns = PoseStamped(), TwistStamped(), time.time_ns()
        for msg, stamp_ns in ((pose, now_ns), (twist, now_ns - apart_ns)):
            msg.header.frame_id, msg.header.stamp = "world", stamp_to_msg(stamp_ns)
        poses.publish(pose)
        twists.publish(twist)

    monitor.wait_until_over(Situation.BODY_SILENT, "'pair'", work=lambda: publish(0))
    monitor.wait(
        Situation.BODY_SILENT, "'pair'", "/pair/pose and /pair/twist", work=lambda: publish(1_000_003)
    )
    monitor.wait_until_over(Situation.BODY_SILENT, "'pair'", work=lambda: publish(0))
    for each in (poses, twists):
        monitor.client.node.destroy_publisher(each)


def test_a_second_server_of_the_same_name(monitor: Monitor) -> None:
    domain_id = monitor.client.node.context.get_domain_id()
    told = "/contact_dynamics: another node has this name, and both answer the same requests"
    with process("server", "--ros-args", "-p", "log:=false", ready="ready", domain_id=domain_id) as second:
        monitor.wait(Situation.SAME_NAME)
        assert told in wait_for(second, "another node has this name")
    assert second.returncode == 0
    monitor.wait_until_ok(Part.ANSWERS)


def test_a_simulated_clock_that_does_not_come(tmp_path: Path) -> None:
    arguments = ("--ros-args", "-p", "use_sim_time:=true")
    with monitored(tmp_path, *arguments, log=False) as (_, monitor):
        monitor.wait(Situation.NO_CLOCK)
        clock = monitor.client.publisher(Clock, "/clock")
        states = monitor.client.publisher(Odometry, "/brick/odometry")

        def publish() -> None:
            clock.publish(Clock(clock=stamp_to_msg(time.time_ns())))
            states.publish(odometry())

        monitor.wait_until_ok(Part.STATES, work=publish)


def hard() -> Any:
    """A landing of a body that spins so fast that the search for it takes seconds."""
    request = PredictImpact.Request(body_name="brick", state_source=PredictImpact.Request.STATE_EXPLICIT)
    request.state.pose.position.z = 1.0
    spin = request.state.angular_velocity
    spin.x, spin.y, spin.z = 1e9, 1e8, 1e8
    return request


def worker_of(server: subprocess.Popen[str]) -> int:
    """The process of the only worker of a server, which is the only child of one of its children."""
    parents = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):  # it ended meanwhile
            stat = (folder / "stat").read_text(encoding="ascii")
            parents[int(folder.name)] = int(stat.rsplit(")", 1)[1].split()[1])
    (worker,) = (pid for pid, parent in parents.items() if parents.get(parent) == server.pid)
    return worker


@pytest.fixture(scope="module")
def overloaded(
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[tuple[subprocess.Popen[str], Monitor]]:
    """A server with one worker, for which no question waits."""
    limits = {"workers": 1, "max_waiting": 0}
    arguments = ("--ros-args", "-p", "answer_deadline:=10.0")
    with monitored(tmp_path_factory.mktemp("config"), *arguments, log=False, **limits) as found:
        yield found


def test_a_fault_of_the_server(overloaded: tuple[subprocess.Popen[str], Monitor]) -> None:
    """Its worker is killed while it answers, as a machine short of memory does it."""
    server, monitor = overloaded
    slowed = PredictTumbling.Request(body_name="brick", times=[0.1], linear_drag=0.1)
    slowed.state_source = slowed.STATE_EXPLICIT
    monitor.client.spin_until(lambda: monitor.client.ask(slowed).status == 0)  # the worker is there
    answer = monitor.client.begin_to_ask(hard())
    time.sleep(0.5)  # less than the answer takes
    os.kill(worker_of(server), signal.SIGKILL)
    monitor.wait(Situation.FAULT, "1 so far")
    assert answer.result().status == answer.result().INTERNAL_ERROR
    monitor.wait_until_ok(Part.ANSWERS)


def test_questions_that_take_too_long(overloaded: tuple[subprocess.Popen[str], Monitor]) -> None:
    _, monitor = overloaded
    futures = [monitor.client.begin_to_ask(hard()) for _ in range(3)]
    monitor.wait(Situation.OVERLOADED, "2 so far")
    monitor.client.spin_until(lambda: all(each.done() for each in futures))
    monitor.wait_until_ok(Part.ANSWERS)


def test_a_server_without_mcap_answers_and_says_how_to_get_a_log(tmp_path: Path) -> None:
    """ROS's package index has no key for mcap, so that a server from binary packages starts without it."""
    (tmp_path / "sitecustomize.py").write_text("import sys; sys.modules['mcap'] = None", encoding="utf-8")
    path = os.pathsep.join(filter(None, (str(tmp_path), os.environ.get("PYTHONPATH"))))
    with monitored(tmp_path, log=True, log_directory=str(tmp_path), settings={"PYTHONPATH": path}) as (
        _,
        monitor,
    ):
        monitor.wait(Situation.NO_MCAP, "pip install mcap")
        question = PredictTumbling.Request(body_name="brick", times=[0.0])
        states = monitor.client.publisher(Odometry, "/brick/odometry")
        states.publish(odometry())
        monitor.client.spin_until(lambda: monitor.client.ask(question).status == 0)
    assert not any(each.is_dir() for each in tmp_path.iterdir() if each.name != "__pycache__")


def test_the_table_in_the_documents_is_that_of_the_code() -> None:
    page = (ROOT / "docs" / "diagnostics.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\S+) \| (\S+) \| `([^|]*)` \| [^|]+ \|$", page, re.MULTILINE)
    assert rows == [
        (row.part.value, row.level.name, re.sub(r"\{(\w+)[^}]*\}", r"<\1>", row.text))
        for row in (situation.value for situation in Situation)
    ]
