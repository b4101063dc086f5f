# SPDX-License-Identifier: Apache-2.0
"""Publishes the condition of a node once a second on /diagnostics.

`situations` lists the causes of warnings and errors.
"""

from __future__ import annotations

import statistics
import time
from collections import deque
from typing import TYPE_CHECKING, Final

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.qos import QoSProfile

from contact_dynamics.nodes.situations import RECENT_S, Level, Part, Present, Situation

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rclpy.node import Node

    from contact_dynamics.nodes.topic_faults import TopicTraffic
    from contact_dynamics.recording.recorder import RecorderStatus
    from msg_adapters.status import Response

QOS: Final = QoSProfile(depth=10)
_REMEMBERED: Final = 1000  # number of responses whose times are reported


class AnswerTimes:
    """The durations of the latest responses, and the numbers of responses by status."""

    def __init__(self) -> None:
        """Create counters with the value zero."""
        self.answers = 0
        self.refusals = 0
        self.faults = 0
        self.overloads = 0
        self._seconds: deque[float] = deque(maxlen=_REMEMBERED)
        self._fault_at = self._overload_at = -RECENT_S  # s

    def note(self, response: Response, *, is_active: bool) -> None:
        """Count a sent response. An inactive server rejects all requests with BUSY, which is no overload."""
        now = time.monotonic()
        self.answers += 1
        self.refusals += response.status != response.OK
        if response.status == response.INTERNAL_ERROR:  # type: ignore[attr-defined]
            self.faults += 1
            self._fault_at = now
        if is_active and response.status in (response.BUSY, response.TIMEOUT):  # type: ignore[attr-defined]
            self.overloads += 1
            self._overload_at = now
        self._seconds.append(response.computation_time)

    def look(self) -> list[Present]:
        """Return the present situations."""
        now, present = time.monotonic(), list[Present]()
        if now - self._fault_at < RECENT_S:
            present.append(Situation.FAULT.present(count=self.faults))
        if now - self._overload_at < RECENT_S:
            present.append(Situation.OVERLOADED.present(count=self.overloads))
        return present

    def values(self) -> dict[str, str]:
        """Return the values to report."""
        times = sorted(self._seconds)
        slow = times[-max(1, len(times) // 100)] if times else 0.0
        return {
            "responses": str(self.answers),
            "rejected requests": str(self.refusals),
            "internal errors": str(self.faults),
            "computation time, median, ms": f"{1e3 * statistics.median(times):.3f}" if times else "",
            "computation time, 99th percentile, ms": f"{1e3 * slow:.3f}" if times else "",
        }


class Diagnostics:
    """Publishes the condition of a node."""

    def __init__(self, node: Node) -> None:
        """Begin to publish."""
        self._node = node
        self._name = node.get_fully_qualified_name().lstrip("/")
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", QOS)

    def publish(self, values: Mapping[Part, Mapping[str, str]], present: Iterable[Present]) -> None:
        """Publish a status for each part, stamped by the node's clock.

        A status contains the part's values, and those of the ``present`` situations that belong to it.
        """
        found = list(present)
        array = DiagnosticArray(
            status=[
                self._status(part, of_part, [each for each in found if each.part is part])
                for part, of_part in values.items()
            ]
        )
        array.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(array)

    def remove(self) -> None:
        """End publishing."""
        self._node.destroy_publisher(self._publisher)

    def _status(self, part: Part, values: Mapping[str, str], present: list[Present]) -> DiagnosticStatus:
        present.sort(key=lambda each: -each.level)  # the worst first
        level = present[0].level if present else Level.OK
        return DiagnosticStatus(
            level=bytes([level]),
            name=f"{self._name}: {part.value}",
            message="; ".join(each.text for each in present) or "ok",
            hardware_id="",
            values=[KeyValue(key=key, value=value) for key, value in values.items()],
        )


def values_of_topics(topics: Iterable[TopicTraffic], faults: Mapping[tuple[str, str], int]) -> dict[str, str]:
    """Return the values to report of topics, and the numbers of their faults."""
    values = {}
    for traffic in topics:
        age = "never" if traffic.age is None else f"{traffic.age:.3f}"
        values[f"{traffic.topic}: messages"] = str(traffic.received)
        values[f"{traffic.topic}: rate, Hz"] = f"{traffic.rate:.1f}"
        values[f"{traffic.topic}: age of the latest, s"] = age
        values[f"{traffic.topic}: lost"] = str(traffic.lost)
    for (topic, kind), count in faults.items():
        values[f"{topic}: {kind}"] = str(count)
    return values


def values_of_log(status: RecorderStatus | None) -> dict[str, str]:
    """Return the values to report of the log."""
    if status is None:
        return {"log": "off"}
    return {"written": str(status.written), "lost": str(status.lost), "waiting": str(status.waiting)}
