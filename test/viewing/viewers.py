# SPDX-License-Identifier: Apache-2.0
"""rerun's own programs, and who listens at a port."""

from __future__ import annotations

import contextlib
import os
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from contact_dynamics.viewing.viewer_process import LOCAL, connection_problem, viewer_executable

PATIENCE_S = 120.0


def wait_until(done: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not done():
        assert time.monotonic() < deadline, "it did not come to that"
        time.sleep(0.05)


@contextlib.contextmanager
def rerun_at(port: int, *arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """One of them, which is killed at the end. It may not listen yet."""
    command = [viewer_executable(), *arguments, "--bind", LOCAL, "--port", str(port)]
    environment = {**os.environ, "RERUN_APP_ONLY": "true"}
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(command, env=environment, stdin=quiet, stdout=quiet, stderr=quiet)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def listens(port: int) -> bool:
    """Whether something listens at a port of this machine."""
    return not connection_problem(LOCAL, port)


def listeners(port: int) -> set[str]:
    """The addresses at which something listens at a port, as hexadecimal numbers."""
    listening = f":{port:04X} 00000000:0000 0A"
    tables = [Path(f"/proc/net/{kind}").read_text(encoding="ascii") for kind in ("tcp", "tcp6")]
    return {line.split()[1] for each in tables for line in each.splitlines() if listening in line}
