# SPDX-License-Identifier: Apache-2.0
"""A server whose output nobody reads goes on answering, also when it has much to say."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
from pathlib import Path

from contact_dynamics_interfaces.srv import PredictTumbling
from running_server import PATIENCE_S, ROOT, Client, environment, process

PIPE_BYTES = 4096
"""The smallest size of a pipe. A few messages fill it, where the usual size takes a server a minute."""

EACH = 10
"""With so many messages to each of seven services, ROS complains several times as much as that pipe holds."""


def test_a_server_whose_output_nobody_reads_goes_on_answering() -> None:
    arguments = ["--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", "-p", "log:=false"]
    with process("server", *arguments, ready="ready") as server:
        assert server.stdout is not None
        fcntl.fcntl(server.stdout, fcntl.F_SETPIPE_SZ, PIPE_BYTES)
        client = Client()
        try:
            raw = str(Path(__file__).with_name("raw_requests.py"))
            paths = [str(ROOT), str(ROOT / "test")]
            subprocess.run(
                [sys.executable, raw, str(EACH), "12"],
                cwd=ROOT,
                env={**environment(), "PYTHONPATH": os.pathsep.join(paths)},
                check=True,
                stdout=subprocess.DEVNULL,
                timeout=2.0 * PATIENCE_S,
            )
            request = PredictTumbling.Request(body_name="brick", times=[0.1])
            request.state_source = PredictTumbling.Request.STATE_EXPLICIT
            request.state.pose.orientation.w = 1.0
            assert client.ask(request).status == PredictTumbling.Response.OK
        finally:
            client.close()
        assert not fcntl.fcntl(server.stdout, fcntl.F_GETFL) & os.O_NONBLOCK


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
