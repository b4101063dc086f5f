# SPDX-License-Identifier: Apache-2.0
"""What publishers offer, in the log of a real server and from a log that is published."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import rclpy
import yaml
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from contact_dynamics.nodes.inbox import InboxNode
from contact_dynamics.recording import BagReader, BagWriter, OfferedQos
from contact_dynamics.recording.bag_metadata import offered_qos
from running_server import DOMAIN_ID, PATIENCE_S, ROOT, Client, environment, process

TOPIC = "/brick/odometry"
BEST_EFFORT = QoSProfile(depth=7, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=7, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def offers_in_metadata(folder: Path) -> list[dict[str, Any]]:
    """The offers that `ros2 bag` reads."""
    metadata = yaml.safe_load((folder / "metadata.yaml").read_text(encoding="utf-8"))
    topics = metadata["rosbag2_bagfile_information"]["topics_with_message_count"]
    found: list[dict[str, Any]] = []
    for topic in topics:
        if topic["topic_metadata"]["name"] == TOPIC:
            found = topic["topic_metadata"]["offered_qos_profiles"]
    return found


def test_the_log_says_what_publishers_offer(tmp_path: Path) -> None:
    arguments = ["--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args"]
    arguments += ["-p", f"log_directory:={tmp_path}"]
    arguments += ["-p", f"qos_overrides.{TOPIC}.subscription.reliability:=best_effort"]
    with process("server", *arguments, ready="ready"):
        (folder,) = tmp_path.iterdir()
        client = Client()
        publishers = [client.publisher(Odometry, TOPIC, qos) for qos in (BEST_EFFORT, LATCHED)]
        deadline = time.monotonic() + PATIENCE_S
        while len(offers_in_metadata(folder)) < 2 and time.monotonic() < deadline:
            publishers[0].publish(Odometry())
            time.sleep(0.05)
        client.close()
    first, second = sorted(offers_in_metadata(folder), key=lambda offer: str(offer["reliability"]))
    assert (first["reliability"], first["durability"]) == ("best_effort", "volatile")
    assert (second["reliability"], second["durability"]) == ("reliable", "transient_local")
    (topic,) = [topic for topic in BagReader(folder).topics() if topic.name == TOPIC]
    assert {offer.reliability for offer in offered_qos(topic.qos)} == {"best_effort", "reliable"}


def test_an_override_of_one_topic_leaves_the_others_as_they_were() -> None:
    """Rclpy writes the override into the profile that it is given, and all topics of states share theirs."""
    context = Context()
    rclpy.init(context=context, domain_id=DOMAIN_ID)
    override = Parameter("qos_overrides./first.subscription.depth", value=3)
    node = InboxNode("overridden", context=context, parameter_overrides=[override])
    qos = QoSProfile(depth=7)
    depths = [
        node.subscribe(Odometry, topic, lambda _: None, qos, may_override=True).qos_profile.depth
        for topic in ("/first", "/second")
    ]
    node.destroy_node()
    rclpy.shutdown(context=context)
    assert depths == [3, 7]
    assert qos.depth == 7


def test_a_log_is_published_as_it_was(tmp_path: Path) -> None:
    unknown = [OfferedQos(reliability="unknown")]
    expected: dict[str, tuple[list[Any], ReliabilityPolicy, DurabilityPolicy]] = {
        "/best_effort": ([BEST_EFFORT], ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.VOLATILE),
        "/several": ([BEST_EFFORT, LATCHED], ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL),
        "/unknown": (unknown, ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE),
        "/nothing": ([], ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE),
    }
    with BagWriter(tmp_path / "log") as writer:
        for topic, (offers, _, _) in expected.items():
            writer.add_topic(topic, "nav_msgs/msg/Odometry", offers)
            for number in range(100):
                data = bytes([0, 1, 0, 0]) + bytes(720)
                writer.write(topic, data, log_time_ns=100_000_000 * number)
    client = Client(wait=False)
    command = [sys.executable, "-m", "contact_dynamics", "replay", "publish", str(tmp_path / "log")]
    with subprocess.Popen([*command, "--loop", "--wait", "0"], cwd=ROOT, env=environment()) as publishing:
        found = {}
        for topic in expected:
            client.spin_until(lambda topic=topic: client.node.get_publishers_info_by_topic(topic))
            (each,) = client.node.get_publishers_info_by_topic(topic)
            found[topic] = each.qos_profile
        client.close()
        publishing.terminate()
    for topic, (_, reliability, durability) in expected.items():
        assert (found[topic].reliability, found[topic].durability) == (reliability, durability), topic
