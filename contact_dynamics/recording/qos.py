# SPDX-License-Identifier: Apache-2.0
"""The quality of service of a topic, which a bag has as YAML: a list of what each of its publishers offers.

rosbag2 fails on a map that lacks one of the nine keys. JSON is YAML.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Final

from contact_dynamics.constants import NS_PER_S

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


_DURATIONS: Final = ("deadline", "lifespan", "liveliness_lease_duration")


def offers_of(qos: Any) -> tuple[OfferedQos, ...]:
    """Return one or several offers: rclpy's ``QoSProfile`` or `OfferedQos` each, or None for the default."""
    given = qos if isinstance(qos, (list, tuple)) else [OfferedQos() if qos is None else qos]
    return tuple(each if isinstance(each, OfferedQos) else _of_profile(each) for each in given)


def _of_profile(profile: Any) -> OfferedQos:
    words = {name: getattr(profile, name).name.lower() for name in _WORDS}
    durations = {name: getattr(profile, name).nanoseconds for name in _DURATIONS}
    avoids: bool = profile.avoid_ros_namespace_conventions
    return OfferedQos(depth=profile.depth, avoid_ros_namespace_conventions=avoids, **words, **durations)


def qos_maps(offers: tuple[OfferedQos, ...]) -> list[dict[str, Any]]:
    """Return offers as the maps that a bag has of them."""
    return [
        {
            name: dict(zip(("sec", "nsec"), divmod(value, NS_PER_S), strict=True))
            if name in _DURATIONS
            else value
            for name, value in asdict(each).items()
        }
        for each in offers
    ]


def offered_qos(text: str) -> list[OfferedQos]:
    """Return what publishers offered, by the YAML list that a bag has for a topic.

    What cannot be read is left out, as is what the list does not say.
    """
    import yaml  # only bags of others need it

    try:
        listed = yaml.safe_load(text)
    except (yaml.YAMLError, RecursionError):
        return []
    maps = listed if isinstance(listed, list) else []
    return [_profile(each) for each in maps if isinstance(each, dict)]


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
    for name in _DURATIONS:
        duration = found.get(name)
        if isinstance(duration, dict) and {type(duration.get(key)) for key in ("sec", "nsec")} == {int}:
            given[name] = min(duration["sec"] * NS_PER_S + duration["nsec"], FOREVER_NS)
    return OfferedQos(**given)
