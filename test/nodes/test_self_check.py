# SPDX-License-Identifier: Apache-2.0
"""A server that messages do not reach any more notices it, and joins the domain anew."""

from __future__ import annotations

import contextlib
import json
import os
import re
import resource
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from nav_msgs.msg import Odometry
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.context import Context
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher

from contact_dynamics.nodes import self_check
from contact_dynamics.nodes.fast_dds import VARIABLE
from contact_dynamics.nodes.inbox import InboxNode
from contact_dynamics.nodes.self_check import SelfCheck
from contact_dynamics.nodes.situations import Situation
from contact_dynamics.recording import BagReader
from contact_dynamics_interfaces.srv import PredictImpact, PredictTumbling
from running_server import DOMAIN_ID, PATIENCE_S, PATIENT, ROOT, Client, process, wait_for

IN_SHARED_MEMORY = """<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="shared" is_default_profile="true"><rtps><name>any</name></rtps></participant>
</profiles>
"""
"""A user's profile takes the place of ours, by which the server has no port in shared memory."""

LEAST_PORT = 7400 + 250 * DOMAIN_ID
"""The least port of DDS in the domain of this test run."""


@pytest.fixture
def in_shared_memory(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Start processes with a profile by which they receive in shared memory."""
    profile = tmp_path_factory.mktemp("profile") / "in_shared_memory.xml"
    profile.write_text(IN_SHARED_MEMORY, encoding="utf-8")
    monkeypatch.setenv(VARIABLE, str(profile))


def remove_ports(pid: int) -> int:
    """Remove the files in which a process receives messages, as logind does; return how many there were."""
    opened = [str(path.readlink()) for path in Path(f"/proc/{pid}/fd").iterdir() if path.exists()]
    locks = [re.fullmatch(r"(.*/)fastrtps_port(\d+)_el", path) for path in opened]
    own = [(lock[1], int(lock[2])) for lock in locks if lock is not None]
    own = [(folder, port) for folder, port in own if LEAST_PORT <= port < LEAST_PORT + 250]
    for folder, port in own:
        for name in (f"fastrtps_port{port}", f"fastrtps_port{port}_el", f"sem.fastrtps_port{port}_mutex"):
            (Path(folder) / name).unlink()
    return len(own)


def falling() -> PredictImpact.Request:
    request = PredictImpact.Request(body_name="brick", state_source=PredictImpact.Request.STATE_EXPLICIT)
    request.state.pose.position.z = 0.5
    return request


def set_parameter(client: Client, parameter: Parameter) -> None:
    setter = client.node.create_client(SetParametersAtomically, "/contact_dynamics/set_parameters_atomically")
    assert setter.wait_for_service(30.0)
    request = SetParametersAtomically.Request(parameters=[parameter.to_parameter_msg()])
    future = setter.call_async(request)
    client.spin_until(future.done)
    assert future.result().result.successful


@pytest.mark.usefixtures("in_shared_memory")
def test_a_server_whose_ports_are_removed_joins_anew_with_its_parameters(tmp_path: Path) -> None:
    arguments = ["--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args"]
    arguments += ["-p", f"log_directory:={tmp_path}", "-p", "self_check_period:=1.0"]
    with process("server", *arguments, ready="ready") as server:
        client = Client()
        set_parameter(client, Parameter("surface.floor.friction", value=0.125))
        reports: list[DiagnosticArray] = []
        client.node.create_subscription(DiagnosticArray, "/diagnostics", reports.append, 10)
        client.spin_until(lambda: reports)
        assert remove_ports(server.pid) == 1
        client.spin_until(lambda: "messages may not arrive" in reports[-1].status[-1].message)
        assert reports[-1].status[-1].level == DiagnosticStatus.ERROR
        client.close()
        printed = wait_for(server, "joins the domain anew") + wait_for(server, "ready")
        assert "self_check" not in printed
        assert "a process that joined the domain sent a message, and it was not received" in printed
        client = Client()
        try:
            assert client.ask(falling()).contacts.frictions[0] == 0.125
        finally:
            client.close()
    before, after = sorted(tmp_path.iterdir())
    assert "joined_anew" not in BagReader(before).run()
    run = BagReader(after).run()
    assert run["joined_anew"] == "1"
    assert json.loads(run["parameters"])["surface.floor.friction"] == 0.125


@pytest.mark.usefixtures("in_shared_memory")
def test_a_server_joins_anew_without_surfaces_and_without_a_disk(tmp_path: Path) -> None:
    """It answered before without any surface, and after its disk was gone; so it does afterwards.

    The file of parameters still describes the surface that was taken away.
    """
    link, disk = tmp_path / "logs", tmp_path / "disk"
    disk.mkdir()
    link.symlink_to(disk)
    arguments = ["--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args"]
    arguments += ["-p", f"log_directory:={link}", "-p", "self_check_period:=1.0"]
    with process("server", *arguments, ready="ready") as server:
        client = Client()
        set_parameter(client, Parameter("surfaces", Parameter.Type.STRING_ARRAY, []))
        client.close()
        link.unlink()
        link.symlink_to(tmp_path / "gone")
        assert remove_ports(server.pid) == 1
        printed = wait_for(server, "joins the domain anew") + wait_for(server, "ready: bodies brick; log off")
        assert "no log is written: log_directory must be" in printed
        reports: list[DiagnosticArray] = []
        client = Client()
        try:
            assert "touches no surface" in client.ask(falling()).message
            client.node.create_subscription(DiagnosticArray, "/diagnostics", reports.append, 10)
            client.spin_until(lambda: reports)
        finally:
            client.close()
    (log,) = (each for each in reports[0].status if each.name.endswith("log"))
    assert log.message.startswith("no log is written: log_directory must be")
    assert int({pair.key: pair.value for pair in log.values}["lost"]) > 0


def test_a_server_that_hears_goes_on(tmp_path: Path) -> None:
    arguments = ["--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args"]
    arguments += ["-p", f"log_directory:={tmp_path}", "-p", "self_check_period:=0.5"]
    with process("server", *arguments, ready="ready"):
        client = Client()
        try:
            heard: list[int] = []
            anew = 0

            def note(array: DiagnosticArray) -> None:
                nonlocal anew
                for status in array.status:
                    values = {each.key: each.value for each in status.values}
                    if status.name.endswith(": self-check"):
                        heard.append(int(values["checks received"]))
                        # A starved machine may miss two checks once. A server that took itself for deaf
                        # again and again would never have heard two.
                        anew = int(values["times that the server rejoined"])
                        assert anew <= 1

            client.node.create_subscription(DiagnosticArray, "/diagnostics", note, 10)
            client.spin_until(lambda: heard and heard[-1] >= 2)
        finally:
            client.close()
    assert len(list(tmp_path.iterdir())) == 1 + anew


@pytest.fixture
def listener() -> Iterator[InboxNode]:
    context = Context()
    rclpy.init(context=context, domain_id=DOMAIN_ID)
    node = InboxNode("listener", context=context)
    yield node
    node.destroy_node()
    rclpy.shutdown(context=context)


def told(check: SelfCheck, until: Callable[[], object]) -> str:
    """What a check says until something is so."""
    said = ""
    deadline = time.monotonic() + PATIENCE_S
    while not until():
        assert time.monotonic() < deadline
        said += check.look(is_suspicious=False)
        time.sleep(0.01)
    return said


def test_checks_leave_no_files_in_the_log_folder_of_ros(
    listener: InboxNode, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path))
    check = SelfCheck(listener, 0.0)
    assert told(check, lambda: check.heard) == ""
    check.end()
    assert list(tmp_path.iterdir()) == []


def test_a_machine_without_room_for_the_process_of_a_check_does_not_end_the_server(
    listener: InboxNode,
) -> None:
    check = SelfCheck(listener, 0.0)
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    lowest_free = os.dup(0)
    os.close(lowest_free)
    resource.setrlimit(resource.RLIMIT_NOFILE, (lowest_free, before[1]))
    try:
        said = check.look(is_suspicious=False)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)
    assert said.startswith("the self-check could not be made: [Errno 24] Too many open files")
    assert check.present() == [Situation.NOT_CHECKED.present(problem=said)]
    assert check.unheard == 0
    assert told(check, lambda: check.heard) == ""
    assert check.present() == []
    check.end()


def test_a_check_whose_process_hangs_is_told_and_the_next_one_is_made(
    listener: InboxNode, monkeypatch: pytest.MonkeyPatch
) -> None:
    check = SelfCheck(listener, 0.0)
    assert check.look(is_suspicious=False) == ""
    (hanging,) = children()
    os.kill(hanging, signal.SIGSTOP)
    monkeypatch.setattr(self_check, "LONGEST_S", 0.1)
    said = told(check, lambda: hanging not in children())
    assert said == "the self-check could not be made, since its process does not end within 0.1 s"
    monkeypatch.undo()
    assert told(check, lambda: check.heard) == ""
    check.end()


def children() -> list[int]:
    """The processes of checks that this process has started, from any of its threads."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):  # it ended meanwhile
            parent = int((folder / "stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()[1])
            if parent == os.getpid() and b"self_check" in (folder / "cmdline").read_bytes():
                found.append(int(folder.name))
    return found


def test_a_topic_that_falls_silent_while_somebody_publishes_is_subscribed_to_anew(tmp_path: Path) -> None:
    arguments = ["--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args"]
    arguments += ["-p", f"log_directory:={tmp_path}", "-p", PATIENT]
    with process("server", *arguments, ready="ready") as server:
        client = Client()
        try:
            states = client.publisher(Odometry, "/brick/odometry")
            publish(client, states)
            question = PredictTumbling.Request(body_name="brick", times=[0.0])
            client.spin_until(lambda: client.ask(question).status == 0)
            (before,) = client.node.get_subscriptions_info_by_topic("/brick/odometry")
            assert "1 publisher but no messages: subscribing again" in wait_for(server, "again")
            client.spin_until(lambda: endpoints(client) not in ([], [bytes(before.endpoint_gid)]))
            client.spin_until(lambda: states.get_subscription_count() == 1)
            client.wait_until_found()
            publish(client, states)
            client.spin_until(lambda: client.ask(question).status == 0)
        finally:
            client.close()


def endpoints(client: Client) -> list[bytes]:
    return [
        bytes(each.endpoint_gid) for each in client.node.get_subscriptions_info_by_topic("/brick/odometry")
    ]


def publish(client: Client, states: Publisher) -> None:
    msg = Odometry(child_frame_id="brick")
    msg.header.frame_id, msg.header.stamp = "world", client.node.get_clock().now().to_msg()
    states.publish(msg)
