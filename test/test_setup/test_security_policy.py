"""The policy for SROS 2 allows the server what a running server has, and nothing that it has not."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
import rclpy

from contact_dynamics.demo.ros_domain import claim_domain
from contact_dynamics.nodes.server import Server
from running_server import PATIENCE_S, ROOT

POLICY = ROOT / "config" / "sros2_policy.xml"
NODE = "/contact_dynamics"


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    rclpy.init(
        args=[
            "--ros-args", "--params-file", str(ROOT / "config" / "server.yaml"),
            "-p", f"log_directory:={tmp_path}", "-p", "use_sim_time:=true",
        ],
        domain_id=claim_domain(),
    )  # fmt: skip
    node = Server()
    yield node
    node.close()
    node.destroy_node()
    rclpy.shutdown()


def allowed(kind: str, **permission: str) -> set[str]:
    """The names of the server's profile with a permission."""
    profile = ET.parse(POLICY).getroot().find(f".//profile[@node='{NODE[1:]}']")
    assert profile is not None
    return {
        (name.text or "").replace("~", NODE)
        for group in profile.findall(f"{kind}s")
        if all(group.get(key) == value for key, value in permission.items())
        for name in group.findall(kind)
    }


def interfaces(server: Server) -> tuple[set[str], set[str], set[str]]:
    """What the server publishes, what it subscribes to and its services, as ROS knows them now."""
    of_node = server.get_name(), server.get_namespace()
    found = (
        server.get_publisher_names_and_types_by_node(*of_node),
        server.get_subscriber_names_and_types_by_node(*of_node),
        server.get_service_names_and_types_by_node(*of_node),
    )
    publishes, subscribes, serves = ({name for name, _ in each} for each in found)
    return publishes, subscribes, serves


def test_the_server_may_do_what_it_does_and_no_more(server: Server) -> None:
    expected = (
        allowed("topic", publish="ALLOW"),
        allowed("topic", subscribe="ALLOW") - {"/parameter_events"},
        allowed("service", reply="ALLOW"),
    )
    # ROS's graph learns of a node's interfaces a moment after the node has made them.
    give_up = time.monotonic() + PATIENCE_S
    while interfaces(server) != expected and time.monotonic() < give_up:
        time.sleep(0.05)
    time.sleep(0.2)  # an interface more may come last
    assert interfaces(server) == expected
