# SPDX-License-Identifier: Apache-2.0
"""States that a server must not believe, over real DDS: refused, counted and told, also to who asks."""

from __future__ import annotations

import math
import signal
import time
from pathlib import Path
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock

from contact_dynamics.nodes.inbox import InboxNode, Taken
from contact_dynamics.nodes.situations import FaultLimits, Part, Situation
from contact_dynamics.nodes.state_sources import BodyReader, StateSource
from contact_dynamics.nodes.state_subscriptions import LATCHED_QOS, StateTopic
from contact_dynamics.nodes.topic_faults import TopicFaults, TopicTraffic
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.replay.verify import verify_log
from contact_dynamics_interfaces.msg import BodyStates
from contact_dynamics_interfaces.srv import PredictTumbling, PredictTumblingBatch
from message_words import says
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg
from nodes.monitor import monitored, odometry
from running_server import DOMAIN_ID, PATIENCE_S, ROOT, Client, process, wait_for

SHALLOW = QoSProfile(depth=10)
SILENT_AFTER_S = 2.0  # two looks of the server, so that one between them finds the topic alive again
PUBLISHED = 3000  # three times what the server's queue holds
HOUR_NS = 3_600_000_000_000


def newest_ns(client: Client) -> int:
    answer = client.ask(PredictTumbling.Request(body_name="brick", times=[0.0]))
    return stamp_ns_from_msg(answer.state.header.stamp) if answer.status == answer.OK else -1


def test_a_simulated_clock_judges_states_from_its_first_message_on(tmp_path: Path) -> None:
    """That none comes is reported. Clocks that are no messages, or before zero, are ignored and told."""
    simulated = ("--ros-args", "-p", "use_sim_time:=true")
    with monitored(tmp_path, *simulated, log=False, state_timeout=1000.0) as (server, monitor):
        client = monitor.client
        monitor.wait(Situation.NO_CLOCK)
        states = client.publisher(Odometry, "/brick/odometry")
        clock = client.publisher(Clock, "/clock")
        states.publish(odometry(5 * HOUR_NS))  # nothing is from the future yet
        client.spin_until(lambda: newest_ns(client) == 5 * HOUR_NS)
        clock.publish(serialize_message(Clock())[:5])
        wait_for(server, "/clock: message ignored: ")
        clock.publish(Clock(clock=stamp_to_msg(HOUR_NS)))
        client.spin_until(lambda: newest_ns(client) == -1)  # it is ahead of the clock now
        negative = Clock()
        negative.clock.sec = -5
        clock.publish(negative)
        wait_for(server, "/clock: message ignored: clock.sec must be >= 0, got -5")
        states.publish(odometry(5 * HOUR_NS))
        states.publish(odometry(HOUR_NS))
        client.spin_until(lambda: newest_ns(client) == HOUR_NS)
        told = wait_for(server, "got 14400.000 s ahead of the clock")
        assert "/brick/odometry: message ignored: stamp must be" in told
        monitor.wait_until_over(Part.STATES, "no time was received")


def test_each_topic_and_kind_of_fault_has_a_throttle_of_its_own() -> None:
    told: list[str] = []
    now = [0.0]
    refused = TopicFaults(told.append, clock=lambda: now[0])
    for _ in range(3):
        refused.refuse("/a", ValueError("bad"))
    refused.refuse("/b", ValueError("bad"))
    refused.refuse("/a", RuntimeError("worse"))
    now[0] = FaultLimits().warn_every
    refused.refuse("/a", ValueError("bad"))
    assert told == [
        "/a: message ignored: bad (1 such so far)",
        "/b: message ignored: bad (1 such so far)",
        "/a: message ignored: worse (1 such so far)",
        "/a: message ignored: bad (4 such so far)",
    ]


def test_a_machine_clock_that_jumps_makes_no_topic_silent_and_no_rate_wrong() -> None:
    now, told = [100.0], list[str]()
    traffic = TopicTraffic(
        topic="/a", faults=TopicFaults(told.append, clock=lambda: now[0]), one_publisher=True
    )
    number = 0
    for jump_ns in (0, HOUR_NS, -HOUR_NS):
        for _ in range(50):
            number += 1
            now[0] += 0.02
            traffic.note(Taken(b"", int(1e9 * now[0]) + jump_ns, number))
        traffic.look(1, awake_for=now[0])
        assert traffic.age == 0.0
        assert not traffic.is_silent
    assert math.isclose(traffic.rate, 50.0, rel_tol=1e-9)
    now[0] += 3.0
    traffic.look(1, awake_for=now[0])
    assert traffic.is_silent
    assert told == ["/a: nothing came for 3.0 s (1 such so far)"]


def test_transforms_that_stand_still_are_told_once_and_their_topic_is_not_silent_for_that() -> None:
    """They come over real DDS, and the clock that counts silence goes on. `tf2_msgs` has no wheel."""
    now, told = [100.0], list[str]()
    context = Context()
    rclpy.init(context=context, domain_id=DOMAIN_ID)
    node = InboxNode("listener", context=context)
    source = StateSource(
        topic="/standing",
        full_name="/standing",
        type_name="geometry_msgs/msg/TransformStamped",
        readers=(BodyReader("", lambda _: None),),
        is_latched=True,
    )
    topic = StateTopic(
        node,
        source,
        states=StateStore(history=5.0, timeout=1.0),
        record=lambda *_: None,
        offered=lambda *_: None,
        faults=TopicFaults(told.append, clock=lambda: now[0]),
    )
    (before,) = node.inbox
    publisher = node.create_publisher(TransformStamped, "/standing", LATCHED_QOS)
    publisher.publish(TransformStamped())
    deadline = time.monotonic() + PATIENCE_S
    while not topic.traffic.received:
        assert time.monotonic() < deadline
        node.take_messages()
    for _ in range(10):
        now[0] += 1000.0
        topic.look(awake_for=now[0])
        assert not topic.traffic.is_silent
    assert told == []
    assert node.inbox == [before]
    node.destroy_node()
    rclpy.shutdown(context=context)


def test_what_got_lost_fell_silent_and_has_two_publishers_is_told(tmp_path: Path) -> None:
    """The server stands still while more comes than its queue holds; /diagnostics has the counts."""
    reports: list[DiagnosticArray] = []
    with monitored(tmp_path, log=False, state_timeout=1000.0, silent_after=SILENT_AFTER_S) as (
        server,
        monitor,
    ):
        client = monitor.client
        client.node.create_subscription(DiagnosticArray, "/diagnostics", reports.append, 10)
        states = client.publisher(Odometry, "/brick/odometry", SHALLOW)
        states.publish(odometry())
        client.spin_until(lambda: newest_ns(client) > 0)
        server.send_signal(signal.SIGSTOP)
        stopped = time.monotonic()
        for _ in range(PUBLISHED):
            states.publish(odometry())
        time.sleep(max(0.0, stopped + 1.25 * SILENT_AFTER_S - time.monotonic()))
        server.send_signal(signal.SIGCONT)
        told = wait_for(server, "/brick/odometry: messages were lost before they were received")
        client.spin_until(lambda: bool(reports) and counted(reports[-1], "lost") > 0)
        assert "/brick/odometry: messages were lost" in reports[-1].status[0].message
        received = counted(reports[-1], "messages")
        assert received + counted(reports[-1], "lost") <= PUBLISHED + 1
        if "/brick/odometry: nothing came for " not in told:  # while DDS repeated what was not taken
            wait_for(server, "/brick/odometry: nothing came for ")
        second = client.publisher(Odometry, "/brick/odometry", SHALLOW)
        wait_for(server, "/brick/odometry: 2 publishers send states of one body")
        client.spin_until(lambda: "/brick/odometry is silent" in reports[-1].status[0].message)
        stamp_ns = time.time_ns()
        states.publish(odometry(stamp_ns))
        client.spin_until(lambda: newest_ns(client) >= stamp_ns)  # else it may leave unsent
        for each in (states, second):
            client.node.destroy_publisher(each)
        told = wait_for(server, "/brick/odometry: nobody publishes any more")
        assert "nothing came for" not in told
        assert "[INFO]" in told.splitlines()[-1]


def counted(report: DiagnosticArray, what: str) -> int:
    """A count of the brick's topic in a report."""
    values = {pair.key: pair.value for status in report.status for pair in status.values}
    return int(values.get(f"/brick/odometry: {what}", "0"))


PARCEL = (
    "bodies:=[brick, parcel]",
    "body.parcel.mass:=1.0",
    "body.parcel.inertia:=[0.0]",
    "body.parcel.sphere:=[0.05]",
)
ARGUMENTS = (
    *("--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", "-p", "use_sim_time:=true"),
    *(each for parameter in PARCEL for each in ("-p", parameter)),
)


def asked(client: Client, body_name: str) -> Any:
    return client.ask(PredictTumbling.Request(body_name=body_name, times=[0.0]))


def newest(client: Client) -> Any:
    return asked(client, "brick")


def ask_beyond_reason(client: Client) -> None:
    """A question whose numbers overflow, of which NumPy would warn."""
    far = PredictTumblingBatch.Request(body_name="brick", times=[1e300])
    far.states = BodyStates(
        positions=[0.0, 0.0, 1.0],
        orientations=[0.0, 0.0, 0.0, 1.0],
        linear_velocities=[1e30, 0.0, -1.0],
        angular_velocities=[0.0, 3.0, 0.0],
    )
    assert client.ask(far).status != 0


def test_no_state_says_what_became_of_those_that_came(tmp_path: Path) -> None:
    """Nor is a state kept that makes no sense, or is NumPy's warning of it printed."""
    ready = "ready: bodies brick, parcel (no state topic); log"
    with process("server", *ARGUMENTS, "-p", f"log_directory:={tmp_path}", ready=ready) as server:
        client = Client()
        try:
            states = client.publisher(Odometry, "/brick/odometry")
            clock = client.publisher(Clock, "/clock")

            def wait_for(words: str) -> None:
                client.spin_until(lambda: says(newest(client).message, words))

            clock.publish(Clock(clock=stamp_to_msg(2 * HOUR_NS)))
            wait_for(
                "no state of 'brick': none has been received on /brick/odometry (1 publisher); "
                "publish states there, or set state_source: 1 (STATE_EXPLICIT) and provide the field state"
            )
            assert says(
                asked(client, "parcel").message, "no topic ... set body.parcel.odometry_topic, or set"
            )
            states.publish(odometry(2 * HOUR_NS, frame="map"))
            wait_for("1 message received; the last was rejected ... s ago because header.frame_id must be")
            states.publish(b"\0\1\0\0no message at all")
            wait_for("2 messages received; ... ago because data must be a..., got 24 bytes")
            states.publish(odometry(4 * HOUR_NS))
            wait_for("3 messages received; the last was rejected ... because stamp must be ..., got 7200")
            for number, nonsense in enumerate((math.nan, math.inf, 1e308, 1e300, 1e9)):
                msg = odometry(2 * HOUR_NS)
                msg.pose.covariance[0] = msg.pose.pose.position.x = nonsense
                msg.twist.twist.linear.x = msg.twist.twist.angular.y = nonsense
                states.publish(msg)
                wait_for(f"{4 + number} messages received; the last was rejected ... because")
                ask_beyond_reason(client)
            states.publish(odometry(2 * HOUR_NS))
            client.spin_until(lambda: newest(client).status == 0)
            states.publish(odometry(2 * HOUR_NS, frame="map"))
            clock.publish(Clock(clock=stamp_to_msg(2 * HOUR_NS + 1_000_000_000)))
            wait_for("the latest state of 'brick' must be at most 0.5 s old (state_timeout), got 1.000 s")
            wait_for("later messages were rejected, the last ... s ago because header.frame_id must be")
            clock.publish(Clock(clock=stamp_to_msg(HOUR_NS)))
            wait_for("10 messages received; the stored states were discarded when the clock was set back")
            states.publish(odometry(HOUR_NS))
            client.spin_until(lambda: newest(client).status == 0)
        finally:
            client.close()
        server.send_signal(signal.SIGINT)
        assert server.stdout is not None
        printed = server.stdout.read()
    assert "message ignored" in printed
    assert "RuntimeWarning" not in printed
    (log,) = tmp_path.iterdir()
    assert verify_log(log).agrees
