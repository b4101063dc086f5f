"""Quality of service in the form of rosbag2: YAML maps with all nine keys. rosbag2 fails on a partial one.

The functions use only the attributes of rclpy's ``QoSProfile``, so that writing a log needs no rclpy. Without
rclpy, use `OfferedQos`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from contact_dynamics.constants import NS_PER_S

_FOREVER_NS: Final = 2**63 - 1


@dataclass(frozen=True, slots=True, kw_only=True)
class OfferedQos:
    """A quality of service without rclpy. The defaults are those of an ordinary publisher.

    Attributes:
        history: One of keep_last, keep_all, system_default, unknown.
        depth: Number of messages kept, for keep_last.
        reliability: One of reliable, best_effort, system_default, best_available, unknown.
        durability: One of volatile, transient_local, system_default, best_available, unknown.
        deadline: Longest time between messages, ns.
        lifespan: Time after which messages expire, ns.
        liveliness: One of automatic, manual_by_topic, system_default, best_available, unknown.
        liveliness_lease_duration: Time after which a silent publisher counts as dead, ns.
        avoid_ros_namespace_conventions: Whether the topic's name is used without ROS's prefix.
    """

    history: str = "keep_last"
    depth: int = 10
    reliability: str = "reliable"
    durability: str = "volatile"
    deadline: int = _FOREVER_NS
    lifespan: int = _FOREVER_NS
    liveliness: str = "automatic"
    liveliness_lease_duration: int = _FOREVER_NS
    avoid_ros_namespace_conventions: bool = False


def qos_lines(qos: Any) -> list[str]:
    """Return the lines of a YAML list of one profile: rclpy's ``QoSProfile`` or an `OfferedQos`."""
    return [
        f"- history: {_word(qos.history)}",
        f"  depth: {qos.depth}",
        f"  reliability: {_word(qos.reliability)}",
        f"  durability: {_word(qos.durability)}",
        "  deadline:",
        *_duration_lines(qos.deadline),
        "  lifespan:",
        *_duration_lines(qos.lifespan),
        f"  liveliness: {_word(qos.liveliness)}",
        "  liveliness_lease_duration:",
        *_duration_lines(qos.liveliness_lease_duration),
        f"  avoid_ros_namespace_conventions: {'true' if qos.avoid_ros_namespace_conventions else 'false'}",
    ]


def _word(policy: Any) -> str:
    return str(policy if isinstance(policy, str) else policy.name).lower()


def _duration_lines(duration: Any) -> list[str]:
    nanoseconds = duration if isinstance(duration, int) else duration.nanoseconds
    return [f"    sec: {nanoseconds // NS_PER_S}", f"    nsec: {nanoseconds % NS_PER_S}"]
