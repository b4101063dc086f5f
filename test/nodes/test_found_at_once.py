# SPDX-License-Identifier: Apache-2.0
"""A node that starts again after it was killed is found, and hears, as soon as it can be."""

from __future__ import annotations

import errno
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from contact_dynamics.nodes.fast_dds import (
    FIRST_OFFSET,
    IS_VERSION_3,
    PORTS,
    VARIABLE,
    first_port,
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
