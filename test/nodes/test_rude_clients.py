# SPDX-License-Identifier: Apache-2.0
"""Clients that do what they should not, over real DDS: the others are answered, and the server ends well."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from contact_dynamics.demo.processes import claim_domain
from contact_dynamics_interfaces.srv import PredictTumbling
from running_server import PATIENCE_S, ROOT, SERVICES, Client, environment, process, wait_for

ARGUMENTS = ("--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", "-p", "log:=false")
EACH = 10  # messages to each service; a pipe that nobody reads takes no more of what ROS complains about them
LARGE = 100_000_000  # bytes
MEMORY_KB = 1_500_000  # far above what the server takes with such a request, and below what would end a robot


@contextmanager
def served() -> Iterator[tuple[subprocess.Popen[str], Client, int]]:
    """A server in a domain of its own, and a client."""
    domain_id = claim_domain()
    with process("server", *ARGUMENTS, ready="ready", domain_id=domain_id) as server:
        client = Client(domain_id=domain_id)
        try:
            yield server, client, domain_id
        finally:
            client.close()
    assert server.returncode == 0


def good(frame: str = "") -> Any:
    request = PredictTumbling.Request(state_source=PredictTumbling.Request.STATE_EXPLICIT, times=[0.1])
    request.inertia.m = request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 1.0
    request.state.header.frame_id = frame
    return request


def test_bytes_that_are_no_requests_disturb_nobody_who_asks() -> None:
    with served() as (_, client, domain_id):
        rude = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("raw_requests.py")), str(EACH), "12"],
            env={**environment(domain_id), "PYTHONPATH": f"{ROOT}:{ROOT / 'test'}"},
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            assert int(wait_for(rude, "\n")) == len(SERVICES)
            asked = 0
            while rude.poll() is None or not asked:
                answer = client.ask(good())
                assert answer.status == answer.OK, answer.message
                asked += 1
            assert rude.returncode == 0
        finally:
            rude.kill()
            rude.wait(PATIENCE_S)
            assert rude.stdout is not None
            rude.stdout.close()
        answer = client.ask(good())
        assert answer.status == answer.OK, answer.message


def test_a_request_of_a_hundred_megabytes_is_refused_in_a_short_message() -> None:
    with served() as (server, client, _):
        answer = client.ask(good("x" * LARGE))
        assert answer.status == answer.FRAME_MISMATCH
        assert len(answer.message) < 2100
        after = client.ask(good())
        assert after.status == after.OK, after.message
        status = Path(f"/proc/{server.pid}/status").read_text(encoding="ascii")
        (peak,) = re.findall(r"VmHWM:\s+(\d+) kB", status)
        assert int(peak) < MEMORY_KB


def test_who_comes_late_and_who_leaves_with_requests_pending_are_nothing_special() -> None:
    with served() as (_, client, domain_id):
        for _ in range(3):
            late = Client(domain_id=domain_id)  # it waits until it has had an answer
            answer = late.ask(good())
            assert answer.status == answer.OK, answer.message
            for _ in range(20):
                late.begin_to_ask(good())
            late.close()
            answer = client.ask(good())
            assert answer.status == answer.OK, answer.message


def test_two_servers_of_one_name_both_tell() -> None:
    domain_id = claim_domain()
    told = "another node has this name, and both answer the same requests"
    with process("server", *ARGUMENTS, ready="ready", domain_id=domain_id) as first:
        with process("server", *ARGUMENTS, ready="ready", domain_id=domain_id) as second:
            assert f"/contact_dynamics: {told}" in wait_for(first, told)
            assert f"/contact_dynamics: {told}" in wait_for(second, told)
        assert second.returncode == 0
        client = Client(domain_id=domain_id)
        try:
            answer = client.ask(good())
            assert answer.status == answer.OK, answer.message
        finally:
            client.close()
    assert first.returncode == 0
