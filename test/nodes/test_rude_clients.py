# SPDX-License-Identifier: Apache-2.0
"""Clients that do what they should not, over real DDS: the others are answered, and the server ends well."""

from __future__ import annotations

import fcntl
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from contact_dynamics.demo.processes import claim_domain
from contact_dynamics_interfaces.srv import PredictTumbling
from running_server import PATIENCE_S, ROOT, SERVICES, Client, environment, process, wait_for

ARGUMENTS = ("--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", "-p", "log:=false")
EACH = 10
"""Messages to each of seven services, of which ROS complains several times as much as the pipe holds."""

PIPE_BYTES = 4096
"""The smallest size of a pipe. A few messages fill it, where the usual size takes a server a minute."""

LARGE = 100_000_000  # bytes
MEMORY_KB = 1_500_000  # far above what the server takes with such a request, and below what would end a robot


class Served(NamedTuple):
    """A server in a domain of its own, and a client."""

    server: subprocess.Popen[str]
    client: Client
    domain_id: int


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    """It goes on answering although it has more to say of each test than the pipe holds that nobody reads."""
    domain_id = claim_domain()
    with process("server", *ARGUMENTS, ready="ready", domain_id=domain_id) as server:
        assert server.stdout is not None
        fcntl.fcntl(server.stdout, fcntl.F_SETPIPE_SZ, PIPE_BYTES)
        client = Client(domain_id=domain_id)
        try:
            yield Served(server, client, domain_id)
        finally:
            client.close()
        assert not fcntl.fcntl(server.stdout, fcntl.F_GETFL) & os.O_NONBLOCK
    assert server.returncode == 0


def good(frame: str = "") -> Any:
    request = PredictTumbling.Request(state_source=PredictTumbling.Request.STATE_EXPLICIT, times=[0.1])
    request.inertia.m = request.inertia.ixx = request.inertia.iyy = request.inertia.izz = 1.0
    request.state.header.frame_id = frame
    return request


def test_bytes_that_are_no_requests_disturb_nobody_who_asks(served: Served) -> None:
    _, client, domain_id = served
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


def memory_kb(server: subprocess.Popen[str], kind: str) -> int:
    """Return a number of /proc/PID/status, kB."""
    status = Path(f"/proc/{server.pid}/status").read_text(encoding="ascii")
    (found,) = re.findall(rf"{kind}:\s+(\d+) kB", status)
    return int(found)


def test_a_request_of_a_hundred_megabytes_is_refused_in_a_short_message(served: Served) -> None:
    server, client, _ = served
    Path(f"/proc/{server.pid}/clear_refs").write_text("5", encoding="ascii")  # the peak is that from now on
    before = memory_kb(server, "VmRSS")
    answer = client.ask(good("x" * LARGE))
    assert answer.status == answer.FRAME_MISMATCH
    assert len(answer.message) < 2100
    after = client.ask(good())
    assert after.status == after.OK, after.message
    assert memory_kb(server, "VmHWM") - before < MEMORY_KB


def test_others_with_the_same_pipe_wait_as_before() -> None:
    reader, writer = os.pipe()
    code = "from contact_dynamics.nodes.own_process import never_wait_for_readers as f; f(); "
    code += "import os; print(os.get_blocking(1), os.get_blocking(2), flush=True)"
    with os.fdopen(reader) as printed:
        subprocess.run(
            [sys.executable, "-c", code],
            cwd=ROOT,
            check=True,
            stdout=writer,
            stderr=writer,
            timeout=PATIENCE_S,
        )
        assert printed.readline() == "False False\n"
        assert os.get_blocking(writer)
        os.close(writer)
