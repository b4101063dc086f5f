# SPDX-License-Identifier: Apache-2.0
"""The policy for SROS 2 allows the server what a running server has, and nothing that it has not."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from rclpy.node import NodeNameNonExistentError

from contact_dynamics.demo.processes import claim_domain
from running_server import ROOT, Client, server_and_client

POLICY = ROOT / "config" / "sros2_policy.xml"
NODE = "/contact_dynamics"


@pytest.fixture
def client(tmp_path: Path) -> Iterator[Client]:
    with server_and_client(tmp_path, domain_id=claim_domain(), parameters=["use_sim_time:=true"]) as client:
        yield client


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


def interfaces(client: Client) -> tuple[set[str], set[str], set[str]]:
    """What the server publishes, what it subscribes to and its services, as ROS knows them now."""
    of_node = NODE[1:], "/"
    found = (
        client.node.get_publisher_names_and_types_by_node(*of_node),
        client.node.get_subscriber_names_and_types_by_node(*of_node),
        client.node.get_service_names_and_types_by_node(*of_node),
    )
    publishes, subscribes, serves = ({name for name, _ in each} for each in found)
    return publishes, subscribes, serves


def test_the_server_may_do_what_it_does_and_no_more(client: Client) -> None:
    expected = (
        allowed("topic", publish="ALLOW"),
        allowed("topic", subscribe="ALLOW") - {"/parameter_events"},
        allowed("service", reply="ALLOW"),
    )

    def are_found() -> bool:
        try:
            return interfaces(client) == expected
        except NodeNameNonExistentError:  # the name of a node comes after its services
            return False

    client.spin_until(are_found)
    time.sleep(0.2)  # an interface more may come last
    assert interfaces(client) == expected
