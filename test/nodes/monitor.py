# SPDX-License-Identifier: Apache-2.0
"""A client that listens to /diagnostics of a server of its own, for tests that wait for a situation."""

from __future__ import annotations

import re
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any

import yaml
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point
from nav_msgs.msg import Odometry

from contact_dynamics.demo.processes import claim_domain
from contact_dynamics.nodes.situations import Level, Part, Situation
from msg_adapters.stamps import stamp_to_msg
from running_server import ROOT, Client, process


def odometry(
    *,
    ahead_ns: int = 0,
    frame: str = "world",
    child: str = "brick",
    x: float = 0.0,
    is_stamped: bool = True,
) -> Odometry:
    msg = Odometry(child_frame_id=child)
    msg.pose.pose.position = Point(check_fields=False)  # ``x`` may be an int, as where nobody checks
    msg.header.frame_id = frame
    msg.header.stamp = stamp_to_msg(time.time_ns() + ahead_ns if is_stamped else 0)
    msg.pose.pose.position.x = x
    return msg


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
        pattern = re.escape(situation.value.text)
        pattern = re.sub(r"\\\{.*?\\\}", ".*", pattern)
        found: list[str] = []

        def is_reported() -> bool:
            work()
            for level, message in self._statuses(situation.value.part):
                if re.search(pattern, message) and all(each in message for each in words):
                    assert level >= situation.value.level
                    found.append(message)
            return bool(found)

        self.client.spin_until(is_reported)
        return found[-1]

    def wait_until_over(self, situation: Situation, words: str, *, work: Callable[[], object] = int) -> None:
        """Wait until a report has no such words."""

        def is_over() -> bool:
            work()
            statuses = self._statuses(situation.value.part)
            return bool(statuses) and not any(words in message for _, message in statuses)

        self.client.spin_until(is_over)

    def wait_until_ok(self, part: Part, *, work: Callable[[], object] = int) -> None:
        """Wait until a status is OK."""

        def is_ok() -> bool:
            work()
            return (Level.OK, "ok") in self._statuses(part)

        self.client.spin_until(is_ok)

    def _statuses(self, part: Part) -> list[tuple[Level, str]]:
        """The statuses of a part that came since the last look."""
        reports, self._reports[:] = list(self._reports), []
        return [
            (Level(each.level[0]), each.message)
            for report in reports
            for each in report.status
            if each.name.endswith(f": {part.value}")
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
    path = folder / "server.yaml"
    path.write_text(yaml.safe_dump(parameters), encoding="utf-8")
    workers = ("--ros-args", "-p", f"workers:={changes.get('workers', 0)}")
    given = ("--params-file", str(path), *arguments, *workers)
    with process("server", *given, ready=ready, domain_id=domain_id, settings=settings) as server:
        at_start(server)
        client = Client(domain_id=domain_id)
        try:
            yield server, Monitor(client)
        finally:
            client.close()
