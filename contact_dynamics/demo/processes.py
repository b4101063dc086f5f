# SPDX-License-Identifier: Apache-2.0
"""The demo's processes. They run in a ROS domain of their own, and are all stopped whatever happens.

The domain of one's own keeps demos and tests which run side by side from hearing each other. It works on
Linux only. The claim is a socket in the abstract namespace, which vanishes with its process.
"""

from __future__ import annotations

import contextlib
import os
import re
import signal
import socket
import subprocess
import sys
from typing import TYPE_CHECKING, Final

from contact_dynamics.nodes.fast_dds import FIRST_PORT, PORTS_OF_DOMAIN, ports_in_use

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


STOP_PATIENCE_S: Final = 10.0
"""Time that a process has to finish its files after SIGINT before it is killed, s."""

_COMPLAINT: Final = re.compile(r"\b(?:WARN|ERROR|FATAL)\b|^Traceback")
_LEVEL: Final = re.compile(r"^\[")  # what begins a message of ROS's or rerun's log


class Processes(contextlib.AbstractContextManager["Processes"]):
    """The child processes of one run. Leaving the context stops all of them, the newest first."""

    def __init__(self, log_folder: Path) -> None:
        """Give every child the same ROS domain on this machine alone, and a file for what it prints."""
        self._log_folder = log_folder
        self._running: list[tuple[str, subprocess.Popen[bytes]]] = []
        self._heard: dict[str, int] = {}  # bytes of what each has printed that were looked at for complaints
        self.ros_environment = {
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_DOMAIN_ID": str(claim_domain()),
        }
        self._environment = {**os.environ, **self.ros_environment, "PYTHONUNBUFFERED": "1"}

    def __exit__(self, *_error: object) -> None:
        """Stop all processes."""
        self.close()

    def start(self, verb: str, arguments: Sequence[str]) -> subprocess.Popen[bytes]:
        """Start a verb of the command line. Its output goes to a file."""
        command = [sys.executable, "-m", "contact_dynamics", verb, *arguments]
        with (self._log_folder / f"{verb}.txt").open("wb") as output:
            # A session of its own: Ctrl-C reaches the children through us alone, and each closes its files in
            # order.
            process = subprocess.Popen(
                command,
                env=self._environment,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        self._running.append((verb, process))
        self._heard[verb] = 0
        return process

    def all_alive(self) -> bool:
        """Return True, or raise `RuntimeError` if a process has failed."""
        for verb, process in self._running:
            if process.poll() not in {None, 0}:
                raise RuntimeError(
                    f"{verb} ended with exit code {process.returncode}:\n{self.printed_by(verb)}"
                )
        return True

    def printed_by(self, verb: str) -> str:
        """Return what a process that is not shown has printed so far."""
        return (self._log_folder / f"{verb}.txt").read_text(encoding="utf-8", errors="replace")

    def new_complaints(self) -> list[str]:
        """Return the warnings of the processes since the last call, as whole lines, each with its verb.

        A warning may have several lines. It goes on up to the next message.
        """
        found = []
        for verb, heard in self._heard.items():
            path = self._log_folder / f"{verb}.txt"
            if path.stat().st_size == heard:
                continue
            with path.open("rb") as printed:
                printed.seek(heard)
                new = printed.read()
            new = new[: new.rfind(b"\n") + 1]  # the rest is still being written
            self._heard[verb] = heard + len(new)
            complains = False
            for line in new.decode(errors="replace").splitlines():
                complains = bool(_COMPLAINT.search(line)) or (complains and not _LEVEL.match(line))
                if complains:
                    found.append(f"{verb}: {line}")
        return found

    def close(self) -> None:
        """Ask all processes to finish, wait for each, and kill the one that does not.

        All are asked at once. A server that waited for the visualizer to end would find the states silent.
        """
        for _, process in reversed(self._running):
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
        while self._running:
            _, process = self._running.pop()
            if process.poll() is None:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(STOP_PATIENCE_S)
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


_DOMAINS: Final = 100
"""Number of ROS domains to choose from. Domains 1 to 100 use ports below the ephemeral ones of Linux."""


def claim_domain() -> int:
    """Return a ROS_DOMAIN_ID that no other process here uses or has claimed. It is kept until this one ends.

    Raises:
        RuntimeError: all domains are in use.
    """
    in_use = _domains_in_use()
    for offset in range(_DOMAINS):
        domain = 1 + (os.getpid() + offset) % _DOMAINS
        if domain not in in_use and _claim(domain):
            return domain
    raise RuntimeError(f"one of the ROS domains 1 to {_DOMAINS} must be free, got all in use")


def _claim(domain: int) -> bool:
    claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        claim.bind(f"\0contact_dynamics ROS domain {domain}")
    except OSError:
        claim.close()
        return False
    claim.detach()  # stays open until the process ends
    return True


def _domains_in_use() -> set[int]:
    """Return the domains on whose ports any process listens."""
    return {(port - FIRST_PORT) // PORTS_OF_DOMAIN for port in ports_in_use()}
