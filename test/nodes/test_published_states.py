# SPDX-License-Identifier: Apache-2.0
"""Questions about published states over real DDS: several servers at once, each configured in another way."""

from __future__ import annotations

import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock

from contact_dynamics.nodes.log import Log
from contact_dynamics.recording import BagReader, UnfinishedLogWarning
from contact_dynamics.recording.limits import LogLimits
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling
from message_words import says
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg
from nodes.monitor import parameters_file
from oracles.rigid_flight import about, matrix
from running_server import PATIENCE_S, ROOT, Client, process, wait_for

BRICK_FILE = ROOT / "config" / "server.yaml"
BEST_EFFORT = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)
GRAVITY = 9.80665  # m/s^2
PATIENT = 1e4  # s, how old a state may be: on a loaded machine this file takes long
OFFSET = np.array([0.1, -0.03, 0.02])  # m, centre of mass of club and disc in their published frames
AT_ORIGIN = STILL = np.zeros(3)
MOMENTS = (0.001, 0.002, 0.0025)
ROUNDING = 1e-12  # a few operations on numbers of order 1 to 10


def stamps_ns() -> Iterator[int]:
    """Stamps of which each is the newest, 10 ms later than the one before.

    They begin when the first state is made, and not when pytest collects this file: a slow machine comes here
    half an hour later. The first is 10 s old, so that a quick test does not publish states of the future.
    """
    yield from count(time.time_ns() - 10_000_000_000, 10_000_000)


STAMPS_NS = stamps_ns()


@dataclass(frozen=True, kw_only=True)
class Body:
    """A state of a body as a test publishes it: pose of its frame, twist in its axes at its origin."""

    p: np.ndarray = field(default_factory=lambda: np.array([0.1, -0.2, 1.0]))
    q: np.ndarray = field(default_factory=lambda: about((2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0), 0.7))
    v: np.ndarray = field(default_factory=lambda: np.array([0.4, 0.1, -0.3]))
    w: np.ndarray = field(default_factory=lambda: np.array([1.0, 5.0, -2.0]))
    stamp_ns: int = field(default_factory=lambda: next(STAMPS_NS))

    def odometry(self, frame: str) -> Odometry:
        msg = Odometry(child_frame_id=frame)
        fill(msg.pose.pose, self.p, self.q)
        fill_twist(msg.twist.twist, self.v, self.w)
        msg.header.frame_id = "world"
        msg.header.stamp = stamp_to_msg(self.stamp_ns)
        return msg

    def pose(self) -> PoseStamped:
        msg = PoseStamped()
        fill(msg.pose, self.p, self.q)
        msg.header.frame_id = "world"
        msg.header.stamp = stamp_to_msg(self.stamp_ns)
        return msg

    def twist(self, frame: str) -> TwistStamped:
        R = np.eye(3) if frame != "world" else matrix(self.q)
        msg = TwistStamped()
        fill_twist(msg.twist, R @ self.v, R @ self.w)
        msg.header.frame_id = frame
        msg.header.stamp = stamp_to_msg(self.stamp_ns)
        return msg

    def velocity_of_centre(self, offset: np.ndarray) -> np.ndarray:
        """Velocity of a centre of mass at ``offset`` in the body's frame, world axes."""
        return matrix(self.q) @ (self.v + np.cross(self.w, offset))


def fill(pose: Any, p: np.ndarray, q: np.ndarray) -> None:
    pose.position.x, pose.position.y, pose.position.z = p.tolist()
    pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w = q.tolist()


def fill_twist(twist: Any, v: np.ndarray, w: np.ndarray) -> None:
    twist.linear.x, twist.linear.y, twist.linear.z = v.tolist()
    twist.angular.x, twist.angular.y, twist.angular.z = w.tolist()


def xyz(vector: Any) -> np.ndarray:
    return np.array([vector.x, vector.y, vector.z])


def xyzw(quaternion: Any) -> np.ndarray:
    return np.array([quaternion.x, quaternion.y, quaternion.z, quaternion.w])


def rows(numbers: Any, columns: int) -> np.ndarray:
    return np.array(numbers).reshape(-1, columns)


@dataclass(frozen=True, kw_only=True)
class Servers:
    """Servers that run at the same time and log to one folder, and a client of each."""

    brick: Client  # of the commented configuration, but for a patience with loaded machines
    robot: Client  # of a server in the namespace /robot1, whose bodies have their centre of mass elsewhere
    logs: Path


@pytest.fixture(scope="module")
def servers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Servers]:
    logs = tmp_path_factory.mktemp("logs")
    parameters: dict[str, Any] = {"bodies": ["club", "disc"], "state_timeout": PATIENT}
    for name in parameters["bodies"]:
        parameters[f"body.{name}.mass"] = 0.5
        parameters[f"body.{name}.inertia"] = [*MOMENTS, 0.0, 0.0, 0.0]
        parameters[f"body.{name}.center_of_mass"] = OFFSET.tolist()
    parameters["body.club.odometry_topic"] = "club/odometry"
    parameters["body.disc.pose_topic"] = "disc/pose"
    parameters["body.disc.twist_topic"] = "disc/twist"
    parameters["body.disc.frame"] = "disc_link"
    robot_file = parameters_file(tmp_path_factory.mktemp("config"), parameters)
    log = ["-p", f"log_directory:={logs}"]
    remaps = ["-r", "__ns:=/robot1", "-r", "club/odometry:=/mocap/club"]
    remaps += ["-p", "qos_overrides./mocap/club.subscription.reliability:=best_effort"]
    with ExitStack() as stack:
        started = [
            stack.enter_context(process("server", "--params-file", file, "--ros-args", *log, *arguments))
            for file, arguments in (
                (str(BRICK_FILE), ["-p", f"state_timeout:={PATIENT}"]),
                (str(robot_file), remaps),
            )
        ]
        for each in started:
            wait_for(each, "ready")
        brick, robot = stack.enter_context(clients("", "/robot1"))
        yield Servers(brick=brick, robot=robot, logs=logs)


@contextmanager
def clients(*namespaces: str) -> Iterator[list[Client]]:
    """A client of the server in each namespace; they look for it at once, as that can take seconds."""
    with ThreadPoolExecutor(len(namespaces)) as pool:
        joined = list(pool.map(Client, namespaces))
    try:
        yield joined
    finally:
        for client in joined:
            client.close()


def known(client: Client, body_name: str, stamp_ns: int) -> Any:
    """Ask until the newest state is the one with that stamp, as states and questions go by different ways."""
    answers: list[Any] = []

    def came() -> bool:
        answers.append(client.ask(PredictTumbling.Request(body_name=body_name, times=[0.0, 0.25, 0.5])))
        return stamp_ns_from_msg(answers[-1].state.header.stamp) == stamp_ns

    client.spin_until(came)
    return answers[-1]


def check_state(msg: Any, body: Body, offset: np.ndarray = AT_ORIGIN) -> None:
    """The state in a response is the one published: its pose, and the velocity of the centre of mass."""
    np.testing.assert_allclose(xyz(msg.pose.position), body.p, atol=ROUNDING)
    np.testing.assert_allclose(xyzw(msg.pose.orientation), body.q, atol=ROUNDING)
    np.testing.assert_allclose(xyz(msg.linear_velocity), body.velocity_of_centre(offset), atol=ROUNDING)
    np.testing.assert_allclose(xyz(msg.angular_velocity), matrix(body.q) @ body.w, atol=ROUNDING)
    assert stamp_ns_from_msg(msg.header.stamp) == body.stamp_ns
    assert msg.header.frame_id == "world"


def check_origins(trajectory: Any, body: Body) -> None:
    """The centre of mass, elsewhere than the origin of the published frame, falls freely."""
    R, t = matrix(body.q), np.array(trajectory.times)[:, None]
    fall = np.array([0.0, 0.0, -0.5 * GRAVITY]) * t * t
    centres = body.p + R @ OFFSET + body.velocity_of_centre(OFFSET) * t + fall
    turned = [matrix(q) @ OFFSET for q in rows(trajectory.orientations, 4)]
    np.testing.assert_allclose(rows(trajectory.positions, 3) + turned, centres, atol=ROUNDING)


def test_tumbling_from_the_newest_state(servers: Servers) -> None:
    client = servers.brick
    states = client.publisher(Odometry, "/brick/odometry")
    bodies = [Body(p=np.array([0.1 * i, 0.0, 1.0])) for i in range(3)]
    for body in (bodies[0], bodies[2], bodies[1]):  # the newest is the one with the latest stamp
        states.publish(body.odometry("brick"))
    answer = known(client, "brick", bodies[2].stamp_ns)
    assert answer.status == answer.OK
    assert says(answer.message, "at sample 2 'brick' would be 0.3... m deep in 'floor'")
    check_state(answer.state, bodies[2])
    assert list(answer.trajectory.times) == [0.0, 0.25, 0.5]


@pytest.mark.parametrize("service", [PredictContactMode, PredictImpact, PredictTumbling])
def test_the_newest_state_is_answered_as_the_same_one_that_is_given(servers: Servers, service: Any) -> None:
    """A brick in the air, or one that lies on the floor."""
    client = servers.brick
    states = client.publisher(Odometry, "/brick/odometry")
    body = Body()
    if service is PredictContactMode:
        body = replace(body, p=np.array([0.1, 0.2, 0.025]), q=about((0.0, 0.0, 1.0), 0.4), v=STILL, w=STILL)
    states.publish(body.odometry("brick"))
    state = known(client, "brick", body.stamp_ns).state
    check_state(state, body)
    newest = service.Request(body_name="brick")
    given = service.Request(body_name="brick", state_source=service.Request.STATE_EXPLICIT, state=state)
    if service is PredictTumbling:
        newest.times = given.times = [0.0, 0.1]
    answer = client.ask(newest)
    assert answer.status == answer.OK, answer.message
    other = client.ask(given)
    other.computation_time = answer.computation_time
    assert str(answer) == str(other)


def test_the_longest_trajectory_arrives_whole(servers: Servers) -> None:
    """2.2 MB of numbers, four times what Fast DDS's shared memory holds at once."""
    client = servers.brick
    request = PredictTumbling.Request(body_name="brick", state_source=PredictTumbling.Request.STATE_EXPLICIT)
    request.state.linear_velocity.x = 0.5
    request.state.angular_velocity.y = 3.0
    request.times = np.linspace(0.0, 2.0, 20_000).tolist()
    for _ in range(3):
        answer = client.ask(request)
        assert answer.status == answer.OK, answer.message
        trajectory = answer.trajectory
        np.testing.assert_array_equal(trajectory.times, request.times)
        assert len(trajectory.orientations) == 4 * 20_000
        assert len(trajectory.angular_velocities) == 3 * 20_000
        t = np.array(request.times)
        parabola = np.column_stack([0.5 * t, 0.0 * t, -0.5 * GRAVITY * t * t])
        np.testing.assert_allclose(rows(trajectory.positions, 3), parabola, atol=1e-12)


@pytest.mark.usefixtures("servers")
def test_four_clients_at_once_lose_no_answer() -> None:
    """Each asks 50 times without waiting, and each answer is that of its question."""
    with clients("", "", "", "") as four:
        futures = []
        for number in range(50):
            for index, client in enumerate(four):
                request = PredictTumbling.Request(body_name="brick", times=[float(index), number + 10.0])
                request.state_source = request.STATE_EXPLICIT
                futures.append((client.begin_to_ask(request), list(request.times)))
        for index, client in enumerate(four):
            own = [future for future, _ in futures[index::4]]
            client.spin_until(lambda own=own: all(future.done() for future in own))
        assert [list(future.result().trajectory.times) for future, _ in futures] == [t for _, t in futures]


def test_odometry_of_a_body_whose_centre_of_mass_is_elsewhere(servers: Servers) -> None:
    """In a namespace, on a topic that is remapped, from a driver that sends best effort."""
    client = servers.robot
    states = client.publisher(Odometry, "/mocap/club", BEST_EFFORT)
    body = Body()
    for _ in range(5):  # one of them may get lost
        states.publish(body.odometry("club"))
    answer = known(client, "club", body.stamp_ns)
    assert answer.status == answer.OK, answer.message
    assert answer.state.body_name == "club"
    check_state(answer.state, body, OFFSET)
    check_origins(answer.trajectory, body)


@pytest.mark.parametrize("frame", ["disc_link", "world"])
@pytest.mark.parametrize("pose_first", [True, False])
def test_pose_and_twist_of_one_stamp_are_a_state(servers: Servers, *, frame: str, pose_first: bool) -> None:
    client = servers.robot
    poses = client.publisher(PoseStamped, "/robot1/disc/pose")
    twists = client.publisher(TwistStamped, "/robot1/disc/twist")
    body = Body()
    if pose_first:
        poses.publish(body.pose())
        twists.publish(body.twist(frame))
    else:
        twists.publish(body.twist(frame))
        poses.publish(body.pose())
    poses.publish(Body().pose())  # half a state is none
    answer = known(client, "disc", body.stamp_ns)
    assert answer.status == answer.OK, answer.message
    check_state(answer.state, body, OFFSET)
    check_origins(answer.trajectory, body)


def test_services_stand_in_the_namespace(servers: Servers) -> None:
    expected = {
        f"{namespace}/contact_dynamics/{service}"
        for service in ("predict_contact_mode", "predict_impact", "predict_tumbling")
        for namespace in ("", "/robot1")
    }
    node = servers.robot.node
    servers.robot.spin_until(lambda: expected <= {name for name, _ in node.get_service_names_and_types()})
    unknown = servers.robot.ask(PredictTumbling.Request(body_name="brick", times=[0.0]))
    assert unknown.status == unknown.UNKNOWN_BODY
    assert "'club', 'disc'" in unknown.message


def test_without_simulated_time_nobody_minds_a_clock_that_jumps(servers: Servers) -> None:
    client, body = servers.brick, Body()
    client.publisher(Odometry, "/brick/odometry").publish(body.odometry("brick"))
    known(client, "brick", body.stamp_ns)
    clock = client.node.create_publisher(Clock, "/clock", BEST_EFFORT)
    for hour in (2, 3, 1):
        clock.publish(Clock(clock=stamp_to_msg(hour * 3_600_000_000_000)))
        answer = client.ask(PredictTumbling.Request(body_name="brick", times=[0.0]))
        assert answer.status == answer.OK, answer.message


def topics_of(folder: Path) -> set[str]:
    """Topics of the messages in a log that is still being written."""
    with pytest.warns(UnfinishedLogWarning, match="is still being written"):
        return {message.topic for message in BagReader(folder).messages()}


def test_servers_in_one_folder_have_a_log_each(servers: Servers) -> None:
    """Read while it is written: what was asked is in the file after 0.1 s."""
    for client in (servers.brick, servers.robot):
        client.ask(PredictTumbling.Request())
    folders = list(servers.logs.iterdir())
    assert len(folders) == 2
    expected = {f"{ns}/contact_dynamics/predict_tumbling/_service_event" for ns in ("", "/robot1")}
    deadline = time.monotonic() + PATIENCE_S
    found: list[set[str]] = []
    while time.monotonic() < deadline:
        found = [topics_of(folder) & expected for folder in folders]
        if all(found):
            break
        time.sleep(0.1)
    assert [len(topics) for topics in found] == [1, 1]
    assert set().union(*found) == expected


def test_logs_begun_at_the_same_moment_do_not_meet(tmp_path: Path) -> None:
    problems: list[str] = []

    def log(number: int) -> Path | None:
        log = Log(
            str(tmp_path),
            run={"number": str(number)},
            limits=LogLimits(),
            on_problem=problems.append,
            on_notice=problems.append,
        )
        log.start()
        log.close()
        return log.folder

    with ThreadPoolExecutor(8) as pool:
        folders = list(pool.map(log, range(8)))
    assert len(set(folders)) == 8
    assert sorted(BagReader(str(folder)).run()["number"] for folder in folders) == [str(n) for n in range(8)]
    assert problems == []
