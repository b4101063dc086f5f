# SPDX-License-Identifier: Apache-2.0
"""A node is found on this machine, also one that starts again after it was killed."""

from __future__ import annotations

import errno
import os
import re
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

import pytest

from contact_dynamics.command_line import DISCOVERY_RANGE
from contact_dynamics.demo.processes import claim_domain
from contact_dynamics.nodes.fast_dds import (
    FIRST_OFFSET,
    IS_VERSION_3,
    PORTS,
    PORTS_OF_DOMAIN,
    VARIABLE,
    first_port,
    ports_in_use,
    profile_of_fast_dds,
)
from running_server import DOMAIN_ID, PATIENCE_S, ROOT, environment, process, wait_for

ARGUMENTS = ["--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", "-p", "log:=false"]
STAYS = """
import rclpy
from contact_dynamics_interfaces.srv import PredictTumbling

rclpy.init()
node = rclpy.create_node("stays")
client = node.create_client(PredictTumbling, "/contact_dynamics/predict_tumbling")
client.wait_for_service()
rclpy.spin_until_future_complete(node, client.call_async(PredictTumbling.Request()))
print("answered", flush=True)
input()
"""


def ports_in_memory(pid: int) -> set[int]:
    """Return the ports of shared memory at which a process receives or to which it has sent."""
    return {int(port) for port in re.findall(r"/fastrtps_port(\d+)", Path(f"/proc/{pid}/maps").read_text())}


@pytest.mark.skipif(IS_VERSION_3, reason="NOT RUN: the profile for clients is one of Fast DDS 2")
def test_what_a_kill_could_leave_locked_in_shared_memory_is_not_used() -> None:
    """Nothing is sent to a server through it, and nothing to a client with the profile for it."""
    profile = ROOT / "config" / "fast_dds_back_at_once.xml"
    with process("server", *ARGUMENTS, ready="ready") as server:
        for variables, is_in_memory in (({}, True), ({VARIABLE: str(profile)}, False)):
            before = ports_in_memory(server.pid)
            with subprocess.Popen(
                [sys.executable, "-c", STAYS],
                cwd=ROOT,
                env=environment() | variables,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            ) as client:
                wait_for(client, "answered")
                assert bool(ports_in_memory(server.pid) - before) is is_in_memory
                ports = ports_in_memory(client.pid)
                of_servers = {first_port(DOMAIN_ID) + FIRST_OFFSET + each for each in range(2 * PORTS)}
                assert bool(ports) is is_in_memory  # the client has one of its own
                assert not ports & of_servers
                client.communicate("end\n", timeout=PATIENCE_S)


def test_the_environment_is_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    with profile_of_fast_dds():
        assert "<leaseAnnouncement><sec>0</sec><nanosec>500000000<" in Path(os.environ[VARIABLE]).read_text()
    assert VARIABLE not in os.environ


def test_where_no_file_can_be_written_there_is_no_profile(monkeypatch: pytest.MonkeyPatch) -> None:
    def is_full(*_: object, **__: object) -> object:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr(tempfile, "NamedTemporaryFile", is_full)
    with profile_of_fast_dds():
        assert VARIABLE not in os.environ


def test_the_profile_of_the_user_stays(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv(VARIABLE, "mine.xml")
    with profile_of_fast_dds():
        assert os.environ[VARIABLE] == "mine.xml"
    assert os.environ[VARIABLE] == "mine.xml"
    monkeypatch.delenv(VARIABLE)
    monkeypatch.chdir(tmp_path)
    (tmp_path / f"DEFAULT_{VARIABLE.partition('_')[0]}_PROFILES.xml").touch()
    with profile_of_fast_dds():
        assert VARIABLE not in os.environ


FIRST_DISCOVERY = 10  # the port at which the first participant of a machine discovers others, in the domain
SERVER = ("server", "--ros-args", "-p", "log:=false", "-p", "workers:=0")
PYTHON = (sys.executable, "-m", "contact_dynamics")
SCRIPT = (str(Path(sys.executable).with_name("contact-dynamics")),)
EXECUTABLE = (sys.executable, str(ROOT / "executables" / "server"), *SERVER[1:])
TRAY = str(ROOT / "config" / "tray.yaml")
BLOCK = (*PYTHON, "block_publisher", "tray", "--ros-args", "--params-file", TRAY)
ASKS_FOR_MORE = {DISCOVERY_RANGE: "SUBNET"}
STARTS: list[tuple[tuple[str, ...], dict[str, str]]] = [
    ((*SCRIPT, *SERVER), {}),
    (EXECUTABLE, {DISCOVERY_RANGE: ""}),  # which ROS takes as if it were not set
    (BLOCK, {}),
    ((*PYTHON, *SERVER), ASKS_FOR_MORE),
]


def test_a_node_listens_to_other_machines_only_where_that_is_asked_for() -> None:
    """Whoever looks beyond this machine listens to multicast, at the first port of the domain."""
    with ExitStack() as stack:
        asked: dict[int, bool] = {}
        for command, variables in STARTS:
            domain_id = claim_domain()
            given = environment(domain_id)
            given.pop(DISCOVERY_RANGE)
            started = stack.enter_context(
                subprocess.Popen(
                    command,
                    cwd=ROOT,
                    env=given | variables,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                )
            )
            stack.callback(started.kill)
            asked[domain_id] = variables == ASKS_FOR_MORE
        deadline = time.monotonic() + PATIENCE_S
        while not all(map(has_joined, asked)):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        assert {domain_id: first_port(domain_id) in ports_in_use() for domain_id in asked} == asked


def has_joined(domain_id: int) -> bool:
    """Whether some process has the ports of a participant by now, which it takes after that of multicast."""
    first = first_port(domain_id)
    return any(first + FIRST_DISCOVERY <= port < first + PORTS_OF_DOMAIN for port in ports_in_use())
