# SPDX-License-Identifier: Apache-2.0
"""A client that listens to /diagnostics of a server of its own, for tests that wait for a situation."""

from __future__ import annotations

import os
import re
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from types import MappingProxyType
from typing import Any

import yaml
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point
from nav_msgs.msg import Odometry

from contact_dynamics.demo.processes import claim_domain
from contact_dynamics.nodes.log import Log
from contact_dynamics.nodes.situations import Level, Part, Situation
from contact_dynamics_interfaces.srv import PredictImpact
from msg_adapters.stamps import stamp_to_msg
from running_server import ROOT, Client, process


def odometry(
    stamp_ns: int | None = None, *, frame: str = "world", child: str = "brick", x: float = 0.0
) -> Odometry:
    """A state a metre up, now unless it says when."""
    msg = Odometry(child_frame_id=child)
    msg.pose.pose.position = Point(check_fields=False)  # ``x`` may be an int, as where nobody checks
    msg.header.frame_id = frame
    msg.header.stamp = stamp_to_msg(time.time_ns() if stamp_ns is None else stamp_ns)
    msg.pose.pose.position.x, msg.pose.pose.position.z = x, 1.0
    return msg


def hang(log: Log) -> Callable[[], None]:
    """Let each write of a log block, as a disk does that hangs; return what lets the one that hangs fail."""
    full, writing = os.pipe()
    os.set_blocking(writing, False)
    with suppress(BlockingIOError):
        while True:
            os.write(writing, bytes(4096))
    os.set_blocking(writing, True)
    assert log._recorder is not None
    os.dup2(writing, log._recorder._writer._file._file._descriptor)

    def fail() -> None:
        os.close(full)
        os.close(writing)

    return fail


def hard() -> PredictImpact.Request:
    """A landing of a body that spins so fast that the search for it takes seconds."""
    request = PredictImpact.Request(body_name="brick", state_source=PredictImpact.Request.STATE_EXPLICIT)
    request.state.pose.position.z = 1.0
    spin = request.state.angular_velocity
    spin.x, spin.y, spin.z = 1e9, 1e8, 1e8
    return request


def parameters_file(folder: Path, values: dict[str, Any]) -> Path:
    """Write parameters of all nodes."""
    path = folder / "server.yaml"
    path.write_text(yaml.safe_dump({"/**": {"ros__parameters": values}}), encoding="utf-8")
    return path


class Monitor:
    """A client that listens to /diagnostics."""

    def __init__(self, client: Client) -> None:
        self.client = client
        self._reports: list[DiagnosticArray] = []
        client.node.create_subscription(DiagnosticArray, "/diagnostics", self._reports.append, 10)

    def wait(self, situation: Situation, *words: str, work: Callable[[], object] = int) -> str:
        """Wait until a situation is reported at its level, with such words; return the whole message.

        ``work`` is done meanwhile, again and again.
        """
        (message,) = self.wait_all((situation, *words), work=work)
        return message

    def wait_all(self, *expected: tuple[Any, ...], work: Callable[[], object] = int) -> list[str]:
        """Wait until each of some situations is reported with its words, all at once or in turn."""
        found: dict[int, str] = {}

        def are_reported() -> bool:
            work()
            for part, level, message in self._statuses():
                for number, (situation, *words) in enumerate(expected):
                    pattern = re.sub(r"\\\{.*?\\\}", ".*", re.escape(situation.value.text))
                    if part is not situation.value.part or not re.search(pattern, message):
                        continue
                    if all(each in message for each in words):
                        assert level >= situation.value.level
                        found[number] = message
            return len(found) == len(expected)

        self.client.spin_until(are_reported)
        return [found[number] for number in range(len(expected))]

    def wait_until_over(self, part: Part, words: str, *, work: Callable[[], object] = int) -> None:
        """Wait until a report of a part has no such words."""

        def is_over() -> bool:
            work()
            messages = [message for of, _, message in self._statuses() if of is part]
            return bool(messages) and not any(words in message for message in messages)

        self.client.spin_until(is_over)

    def wait_until_ok(self, part: Part, *, work: Callable[[], object] = int) -> None:
        """Wait until a status is OK."""

        def is_ok() -> bool:
            work()
            return (part, Level.OK, "ok") in self._statuses()

        self.client.spin_until(is_ok)

    def _statuses(self) -> list[tuple[Part, Level, str]]:
        """The statuses that came since the last look."""
        reports, self._reports[:] = list(self._reports), []
        return [
            (Part(each.name.rpartition(": ")[2]), Level(each.level[0]), each.message)
            for report in reports
            for each in report.status
        ]


@contextmanager
def monitored(
    folder: Path,
    *arguments: str,
    ready: str = "ready",
    at_start: Callable[[subprocess.Popen[str]], object] = lambda _: None,
    settings: Mapping[str, str] = MappingProxyType({}),
    **changes: Any,
) -> Iterator[tuple[subprocess.Popen[str], Monitor]]:
    """A server of the commented configuration with some changes, and a monitor of it.

    ``at_start`` is called before the monitor waits for the server's services. The server has ``settings`` in
    its environment.
    """
    domain_id = claim_domain()  # since another server of the same name is a situation
    parameters = yaml.safe_load((ROOT / "config" / "server.yaml").read_text(encoding="utf-8"))
    parameters["/**"]["ros__parameters"] |= changes
    path = parameters_file(folder, parameters["/**"]["ros__parameters"])
    workers = ("--ros-args", "-p", f"workers:={changes.get('workers', 0)}")
    given = ("--params-file", str(path), *arguments, *workers)
    with process("server", *given, ready=ready, domain_id=domain_id, settings=settings) as server:
        at_start(server)
        client = Client(domain_id=domain_id)
        try:
            yield server, Monitor(client)
        finally:
            client.close()
