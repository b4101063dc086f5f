# SPDX-License-Identifier: Apache-2.0
"""The demo's child processes, which share an unused ROS domain and are always stopped at the end.

With a domain for each run, demos and tests that run simultaneously do not receive each other's messages. A
domain is claimed by a socket in Linux's abstract namespace, which disappears with its process.
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
"""Time between SIGINT, after which a process completes its files, and SIGKILL, s."""

_COMPLAINT: Final = re.compile(r"\b(?:WARN|ERROR|FATAL)\b|^Traceback")
_LEVEL: Final = re.compile(r"^\[")  # the beginning of a log message of ROS or rerun


class Processes(contextlib.AbstractContextManager["Processes"]):
    """The child processes of one run. Leaving the context stops all of them."""

    def __init__(self, log_folder: Path) -> None:
        """Choose the ROS domain of all children, on this machine only, and the folder of their output."""
        self._log_folder = log_folder
        self._running: list[tuple[str, subprocess.Popen[bytes]]] = []
        self._heard: dict[str, int] = {}  # bytes of the output of each that were searched for warnings
        self.ros_environment = {
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_DOMAIN_ID": str(claim_domain()),
        }
        self._environment = {**os.environ, **self.ros_environment, "PYTHONUNBUFFERED": "1"}

    def __exit__(self, *_error: object) -> None:
        """Stop all processes."""
        self.close()

    def start(self, verb: str, arguments: Sequence[str]) -> subprocess.Popen[bytes]:
        """Start a verb of the command line, and write its output to a file."""
        command = [sys.executable, "-m", "contact_dynamics", verb, *arguments]
        with (self._log_folder / f"{verb}.txt").open("wb") as output:
            # In a separate session, the child does not receive Ctrl-C directly, so `close` can stop all
            # children in order.
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
        """Return the output of a process so far."""
        return (self._log_folder / f"{verb}.txt").read_text(encoding="utf-8", errors="replace")

    def new_complaints(self) -> list[str]:
        """Return the lines of new warnings, each preceded by the verb of its process.

        A warning may have several lines; it ends at the next log message.
        """
        found = []
        for verb, heard in self._heard.items():
            path = self._log_folder / f"{verb}.txt"
            if path.stat().st_size == heard:
                continue
            with path.open("rb") as printed:
                printed.seek(heard)
                new = printed.read()
            new = new[: new.rfind(b"\n") + 1]  # the last line may be incomplete
            self._heard[verb] = heard + len(new)
            complains = False
            for line in new.decode(errors="replace").splitlines():
                complains = bool(_COMPLAINT.search(line)) or (complains and not _LEVEL.match(line))
                if complains:
                    found.append(f"{verb}: {line}")
        return found

    def close(self) -> None:
        """Interrupt all processes, wait for each, and kill those that do not end in time.

        All are interrupted at once: otherwise a server that outlives the publisher reports missing states.
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
"""Number of ROS domains to choose from: domains 1 to 100 use ports below Linux's ephemeral ports."""


def claim_domain() -> int:
    """Return a ROS_DOMAIN_ID that no other process on this machine uses, and claim it for this process.

    Raise `RuntimeError` if all domains are in use.
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
    """Return the domains whose ports are in use."""
    return {(port - FIRST_PORT) // PORTS_OF_DOMAIN for port in ports_in_use()}
