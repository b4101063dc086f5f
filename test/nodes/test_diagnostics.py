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
from pathlib import Path
from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy

from contact_dynamics.nodes.situations import Part, Situation
from contact_dynamics_interfaces.srv import PredictTumbling
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg
from nodes.monitor import Monitor, hard, monitored, odometry
from running_server import ROOT, process, wait_for

BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
HOUR_NS = 3_600_000_000_000
OTHERS = ("late", "old", "turned", "shared", "twice", "split", "pair")
BODIES = {
    "bodies": ["brick", *OTHERS],
    **{f"body.{name}.mass": 1.0 for name in OTHERS},
    **{f"body.{name}.inertia": [0.001, 0.001, 0.001, 0.0, 0.0, 0.0] for name in OTHERS},
    **{f"body.{name}.odometry_topic": f"/{name}/odometry" for name in OTHERS[:5]},
    "body.twice.pose_topic": "/twice/pose",
    **{f"body.{name}.{kind}_topic": f"/{name}/{kind}" for name in OTHERS[5:] for kind in ("pose", "twist")},
    "state_timeout": 100.0,
    "silent_after": 1.0,
    "log": False,
}


@pytest.fixture(scope="module")
def monitor(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Monitor]:
    with monitored(tmp_path_factory.mktemp("config"), **BODIES) as (_, monitor):
        yield monitor


class Body:
    """Publishes the states of a body."""

    def __init__(self, monitor: Monitor, name: str) -> None:
        self.name = name
        self._node = monitor.client.node
        self._begun_ns = time.time_ns()
        if name in {"split", "pair"}:
            self._made = [
                monitor.client.publisher(PoseStamped, f"/{name}/pose"),
                monitor.client.publisher(TwistStamped, f"/{name}/twist"),
            ]
        else:
            self._made = [monitor.client.publisher(Odometry, f"/{name}/odometry")]

    def publish(self, **wrong: Any) -> None:
        self._made[0].publish(odometry(child=self.name, **wrong))

    def publish_turned(self, *, is_right: bool) -> None:
        """The body is turned by 90 degrees about z, and moves along x."""
        msg = odometry(child=self.name)
        turn, velocity = msg.pose.pose.orientation, msg.twist.twist.linear
        turn.z = turn.w = math.sqrt(0.5)
        msg.pose.pose.position.x = 3.0 * (stamp_ns_from_msg(msg.header.stamp) - self._begun_ns) / 1e9
        velocity.x, velocity.y = (0.0, -3.0) if is_right else (3.0, 0.0)
        self._made[0].publish(msg)

    def publish_pair(self, *, apart_ns: int) -> None:
        pose, twist, now_ns = PoseStamped(), TwistStamped(), time.time_ns()
        for msg, stamp_ns in ((pose, now_ns), (twist, now_ns - apart_ns)):
            msg.header.frame_id, msg.header.stamp = "world", stamp_to_msg(stamp_ns)
        for publisher, msg in zip(self._made, (pose, twist), strict=True):
            publisher.publish(msg)

    def publish_good(self) -> None:
        if len(self._made) == 2:
            self.publish_pair(apart_ns=0)
        elif self.name == "turned":
            self.publish_turned(is_right=True)
        else:
            self.publish()

    def stop(self) -> None:
        for each in self._made:
            self._node.destroy_publisher(each)


def test_states_that_are_rejected(monitor: Monitor) -> None:
    """All of them for each of some reasons, and of one body one in three."""
    bodies = {name: Body(monitor, name) for name in ("brick", "old", "shared", "twice")}

    def publish() -> None:
        bodies["brick"].publish(frame="map")
        bodies["old"].publish(x=2)
        bodies["shared"].publish(stamp_ns=0)
        for wrong in ({}, {"frame": "map"}, {}):
            bodies["twice"].publish(**wrong)

    def publish_good() -> None:
        for each in bodies.values():
            each.publish_good()

    monitor.wait_all(
        (Situation.ALL_REJECTED, "'brick'", "got 'map'"),
        (Situation.ALL_REJECTED, "'old'", "(rclpy sends this for an int"),
        (Situation.ALL_REJECTED, "'shared'", "must be the time of the state, got 0 (fill in header.stamp"),
        (Situation.SOME_REJECTED, "'twice'", "got 'map'"),
        work=publish,
    )
    monitor.wait_until_over(Part.STATES, "rejected", work=publish_good)
    for each in bodies.values():
        each.stop()


def test_each_situation_of_states_is_reported_as_long_as_its_cause_is_there(monitor: Monitor) -> None:
    """A body for each, and all at once: reports come once a second.

    What one publisher sends is of another type, and another cannot be received by a reliable subscription.
    The poses and twists of a pair come, and have no equal stamps any more, so that none makes a state.
    """
    node = monitor.client.node
    of_another_type = node.create_publisher(PoseStamped, "/split/twist", 10)
    monitor.wait_all(
        (Situation.NO_STATE_YET, "'late' received on /late/odometry (0 publishers)"),
        (Situation.NO_MATCH, "/split/twist: 1 of 1 publishers", "they send geometry"),
    )
    node.destroy_publisher(of_another_type)
    bodies = {name: Body(monitor, name) for name in ("brick", *OTHERS)}

    def publish_good() -> None:
        for each in bodies.values():
            each.publish_good()

    monitor.wait_until_ok(Part.STATES, work=publish_good)
    wrong = [
        node.create_publisher(Odometry, "/brick/odometry", BEST_EFFORT),
        node.create_publisher(Odometry, "/shared/odometry", 10),
        node.create_publisher(PoseStamped, "/twice/pose", 10),
    ]

    def publish() -> None:
        for name in ("brick", "late", "split", "shared", "twice"):
            bodies[name].publish_good()
        bodies["old"].publish(stamp_ns=time.time_ns() - HOUR_NS)
        bodies["turned"].publish_turned(is_right=False)
        bodies["pair"].publish_pair(apart_ns=1_000_003)

    monitor.wait_all(
        (Situation.OLD, "'old'", "by 3600."),
        (Situation.TWIST_AXES, "/turned/odometry: the twist disagrees with the poses by 4.2 m/s"),
        (Situation.NO_MATCH, "/brick/odometry: 1 of 2 publishers cannot be received: Best effort"),
        (Situation.SEVERAL_PUBLISHERS, "/shared/odometry: 2 publishers"),
        (Situation.SEVERAL_PUBLISHERS, "/twice/odometry and /twice/pose: 2 publishers"),
        (Situation.BODY_SILENT, "'pair'", "/pair/pose and /pair/twist"),
        work=publish,
    )
    for each in wrong:
        node.destroy_publisher(each)
    monitor.wait_until_ok(Part.STATES, work=publish_good)
    for body in bodies.values():
        body.stop()


def test_a_second_server_of_the_same_name(monitor: Monitor) -> None:
    domain_id = monitor.client.node.context.get_domain_id()
    told = "/contact_dynamics: another node has this name, and both answer the same requests"
    with process("server", "--ros-args", "-p", "log:=false", ready="ready", domain_id=domain_id) as second:
        monitor.wait(Situation.SAME_NAME)
        assert told in wait_for(second, "another node has this name")
    assert second.returncode == 0
    monitor.wait_until_ok(Part.ANSWERS)


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
def overloaded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[subprocess.Popen[str], Monitor]]:
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
