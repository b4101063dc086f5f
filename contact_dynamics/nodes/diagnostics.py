"""Tells how the server is, once a second on /diagnostics, to people and to monitors."""

from __future__ import annotations

import statistics
from collections import deque
from typing import TYPE_CHECKING, Final

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.qos import QoSProfile

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rclpy.node import Node

    from contact_dynamics.nodes.self_check import SelfCheck
    from contact_dynamics.nodes.topic_faults import TopicTraffic
    from contact_dynamics.recording.recorder import RecorderStatus
    from msg_adapters.status import Response

QOS: Final = QoSProfile(depth=10)
_REMEMBERED: Final = 1000  # answers whose times are told


class AnswerTimes:
    """How long the last answers took, and how many there were by status."""

    def __init__(self) -> None:
        """Begin without any."""
        self.answers = 0
        self.refusals = 0
        self.faults = 0
        self._seconds: deque[float] = deque(maxlen=_REMEMBERED)

    def note(self, response: Response) -> None:
        """Note a response that is sent."""
        self.answers += 1
        self.refusals += response.status != response.OK
        self.faults += response.status == response.INTERNAL_ERROR  # type: ignore[attr-defined]
        self._seconds.append(response.computation_time)

    def values(self) -> dict[str, str]:
        """Return what is told of them."""
        times = sorted(self._seconds)
        slow = times[-max(1, len(times) // 100)] if times else 0.0
        return {
            "answers": str(self.answers),
            "of them refused": str(self.refusals),
            "of them faults of the server": str(self.faults),
            "time of an answer, median, ms": f"{1e3 * statistics.median(times):.3f}" if times else "",
            "time of an answer, slowest of 100, ms": f"{1e3 * slow:.3f}" if times else "",
        }


class Diagnostics:
    """Publishes the state of a node."""

    def __init__(self, node: Node) -> None:
        """Begin to publish."""
        self._node = node
        self._name = node.get_fully_qualified_name().lstrip("/")
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", QOS)

    def publish(self, *statuses: DiagnosticStatus) -> None:
        """Publish statuses, stamped by the node's clock."""
        array = DiagnosticArray(status=list(statuses))
        array.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(array)

    def remove(self) -> None:
        """End publishing."""
        self._node.destroy_publisher(self._publisher)

    def of_topics(
        self, topics: Iterable[TopicTraffic], faults: Mapping[tuple[str, str], int]
    ) -> DiagnosticStatus:
        """Return the state of the topics: a warning where one is silent or something was lost or refused."""
        values, wrong = {}, []
        for traffic in topics:
            age = "never" if traffic.age is None else f"{traffic.age:.3f}"
            values[f"{traffic.topic}: messages"] = str(traffic.received)
            values[f"{traffic.topic}: rate, Hz"] = f"{traffic.rate:.1f}"
            values[f"{traffic.topic}: age of the newest, s"] = age
            values[f"{traffic.topic}: lost"] = str(traffic.lost)
            if traffic.is_silent:
                wrong.append(f"{traffic.topic} is silent")
        for (topic, kind), count in faults.items():
            values[f"{topic}: {kind}"] = str(count)
        return self._status("states", values, wrong)

    def of_answers(self, times: AnswerTimes, waiting: int) -> DiagnosticStatus:
        """Return the state of the services: a warning where answers met faults of the server."""
        values = {**times.values(), "hard questions that wait": str(waiting)}
        return self._status("answers", values, [f"{times.faults} faults"] if times.faults else [])

    def of_self_check(self, check: SelfCheck, successions: int) -> DiagnosticStatus:
        """Return the state of the self-check: a warning where the last one failed."""
        values = {
            "checks heard": str(check.heard),
            "checks in turn not heard": str(check.unheard),
            "times that the server joined anew": str(successions),
        }
        return self._status("self-check", values, ["messages may not arrive"] if check.unheard else [])

    def of_log(self, status: RecorderStatus | None) -> DiagnosticStatus:
        """Return the state of the log: a warning where it met a problem."""
        if status is None:
            return self._status("log", {"log": "off"}, [])
        values = {"written": str(status.written), "lost": str(status.lost), "waiting": str(status.waiting)}
        return self._status("log", values, [status.problem] if status.problem else [])

    def _status(self, part: str, values: Mapping[str, str], wrong: list[str]) -> DiagnosticStatus:
        return DiagnosticStatus(
            level=DiagnosticStatus.WARN if wrong else DiagnosticStatus.OK,
            name=f"{self._name}: {part}",
            message="; ".join(wrong) or "ok",
            hardware_id="",
            values=[KeyValue(key=key, value=value) for key, value in values.items()],
        )
