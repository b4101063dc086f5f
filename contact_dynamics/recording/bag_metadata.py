# SPDX-License-Identifier: Apache-2.0
"""The content of a bag's ``metadata.yaml``, as rosbag2 of Jazzy writes it (version 9), in JSON (valid YAML).

The MCAP file has the same in a record of its own. The quality of service of a topic is YAML too: a list of
the offers of its publishers. rosbag2 fails on a map that lacks one of the nine keys.
"""

from __future__ import annotations

import json
import zlib
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.constants import NS_PER_S

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from contact_dynamics.recording.definitions import TypeDefinition

METADATA_FILE: Final = "metadata.yaml"
BAG_KEY: Final = "rosbag2_bagfile_information"  # its outermost key
RUN_RECORD: Final = "contact_dynamics"  # the MCAP metadata record that describes the run
OFFERED_QOS: Final = "offered_qos_profiles"  # in the metadata of a channel, as rosbag2 names it
TYPE_HASH: Final = "topic_type_hash"  # beside it
CHECKSUM_KEY: Final = "checksum"  # in that record, because MCAP gives metadata none
FOREVER_NS: Final = 2**63 - 1  # an unlimited duration


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
"""The names of policies by their numbers in rmw, which bags from before ROS 2 Jazzy contain."""


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
    """Return offers as maps in a bag's format."""
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
    """Return the offers of publishers in the YAML list that a bag has for a topic.

    Unreadable and missing entries are left out.
    """
    import yaml  # only other writers' bags need it

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


@dataclass(frozen=True, slots=True, kw_only=True)
class DeclaredTopic:
    """A topic of a bag: its absolute name, its type, and the offers of its publishers."""

    name: str
    definition: TypeDefinition
    qos: tuple[OfferedQos, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class FileSummary:
    """One file of a bag."""

    name: str  # its path relative to the folder
    start_ns: int  # log time of the earliest message, ns since the epoch
    end_ns: int  # log time of the latest message
    counts: Mapping[str, int]  # messages by topic
    size: int  # bytes


def sealed_run(run: Mapping[str, str]) -> dict[str, str]:
    """Return the record of the run with a checksum."""
    return {**run, CHECKSUM_KEY: _checksum(run)}


def unsealed_run(record: Mapping[str, str]) -> dict[str, str] | None:
    """Return the record of the run without its checksum, or None if that is missing or does not match."""
    run = {key: value for key, value in record.items() if key != CHECKSUM_KEY}
    return run if record.get(CHECKSUM_KEY) == _checksum(run) else None


def _checksum(run: Mapping[str, str]) -> str:
    return f"{zlib.crc32(json.dumps(dict(run), sort_keys=True).encode()):08x}"


def file_text_of(metadata: Mapping[str, Any]) -> str:
    """Return the text of ``metadata.yaml``, which has the metadata under rosbag2's outermost key."""
    return json.dumps({BAG_KEY: metadata}, indent=2, ensure_ascii=False) + "\n"


def metadata_of(
    files: Sequence[FileSummary], topics: Iterable[DeclaredTopic], run: Mapping[str, str]
) -> dict[str, Any]:
    """Return rosbag2's metadata of files, the oldest first, and topics, with the record of the run."""
    start_ns = min(file.start_ns for file in files)
    end_ns = max(file.end_ns for file in files)
    return {
        "version": 9,
        "storage_identifier": "mcap",
        **_span(start_ns, end_ns, sum(sum(file.counts.values()) for file in files)),
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": topic.name,
                    "type": topic.definition.type_name,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": qos_maps(topic.qos),
                    # rosbags rejects the whole folder if this is not its own hash of the text, which it
                    # cannot be for an event that is written as a message. The channel has the true hash.
                    "type_description_hash": ""
                    if topic.definition.is_service_event
                    else topic.definition.type_hash,
                },
                "message_count": sum(file.counts.get(topic.name, 0) for file in files),
            }
            for topic in topics
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file.name for file in files],
        "files": [
            {"path": file.name, **_span(file.start_ns, file.end_ns, sum(file.counts.values()))}
            for file in files
        ],
        "custom_data": dict(run) or None,
        "ros_distro": "jazzy",
    }


def _span(start_ns: int, end_ns: int, message_count: int) -> dict[str, Any]:
    return {
        "duration": {"nanoseconds": end_ns - start_ns},
        "starting_time": {"nanoseconds_since_epoch": start_ns},
        "message_count": message_count,
    }
