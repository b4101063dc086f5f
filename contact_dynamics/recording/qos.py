# SPDX-License-Identifier: Apache-2.0
"""rosbag2 writes quality of service as YAML maps with all nine keys, and fails on a partial one.

A topic has a list of them: what each of its publishers offers. The functions use only the attributes of
rclpy's ``QoSProfile``, so that writing a log needs no rclpy. Without rclpy, use `OfferedQos`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.constants import NS_PER_S

if TYPE_CHECKING:
    from collections.abc import Sequence

FOREVER_NS: Final = 2**63 - 1


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
    deadline: int = FOREVER_NS
    lifespan: int = FOREVER_NS
    liveliness: str = "automatic"
    liveliness_lease_duration: int = FOREVER_NS
    avoid_ros_namespace_conventions: bool = False


_WORDS: Final = {
    "history": ("system_default", "keep_last", "keep_all", "unknown"),
    "reliability": ("system_default", "reliable", "best_effort", "unknown", "best_available"),
    "durability": ("system_default", "transient_local", "volatile", "unknown", "best_available"),
    "liveliness": ("system_default", "automatic", "unknown", "manual_by_topic", "unknown", "best_available"),
}
"""The names of policies by their numbers in rmw, which stand in bags from before ROS 2 Jazzy."""


def qos_lines(offers: Sequence[Any]) -> list[str]:
    """Return the lines of a YAML list of what publishers offer: rclpy's ``QoSProfile`` or `OfferedQos` each.

    Without publishers, this is the line of an empty list.
    """
    return [line for qos in offers for line in _profile_lines(qos)] or ["[]"]


def offered_qos(text: str) -> list[OfferedQos]:
    """Return what publishers offered, by the YAML list that a bag has for a topic.

    What cannot be read is left out, as is what the list does not say.
    """
    import yaml  # only bags of others need it

    try:
        listed = yaml.safe_load(text)
    except (yaml.YAMLError, RecursionError):
        return []
    return [_profile(each) for each in listed if isinstance(each, dict)] if isinstance(listed, list) else []


def _profile(found: dict[str, Any]) -> OfferedQos:
    given: dict[str, Any] = {}
    for name, words in _WORDS.items():
        word = found.get(name)
        if isinstance(word, int) and 0 <= word < len(words):
            word = words[word]
        if word in words:
            given[name] = word
    if isinstance(found.get("depth"), int):
        given["depth"] = found["depth"]
    for name in ("deadline", "lifespan", "liveliness_lease_duration"):
        duration = found.get(name)
        if isinstance(duration, dict) and {type(duration.get(key)) for key in ("sec", "nsec")} == {int}:
            given[name] = min(duration["sec"] * NS_PER_S + duration["nsec"], FOREVER_NS)
    return OfferedQos(**given)


def _profile_lines(qos: Any) -> list[str]:
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
