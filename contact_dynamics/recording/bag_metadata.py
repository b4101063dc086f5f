# SPDX-License-Identifier: Apache-2.0
"""A bag's ``metadata.yaml`` has what rosbag2 of Jazzy writes (version 9), as JSON, which is YAML.

The MCAP file has the same, in a record of its own.
"""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.recording.qos import qos_maps

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from contact_dynamics.recording.qos import OfferedQos

METADATA_FILE: Final = "metadata.yaml"
BAG_KEY: Final = "rosbag2_bagfile_information"  # its outermost key
RUN_RECORD: Final = "contact_dynamics"  # the MCAP metadata record that says how the run was made
OFFERED_QOS: Final = "offered_qos_profiles"  # in the metadata of a channel, as rosbag2 names it
TYPE_HASH: Final = "topic_type_hash"  # beside it
CHECKSUM_KEY: Final = "checksum"  # in that record, because MCAP gives metadata none


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicSummary:
    """The entry of ``metadata.yaml`` for one topic.

    Attributes:
        name: The topic's name with its leading slash.
        type_name: "package/msg/Name" or "package/srv/Name_Event".
        type_hash: "RIHS01_..." or empty.
        qos: What its publishers offer.
    """

    name: str
    type_name: str
    type_hash: str
    qos: tuple[OfferedQos, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class FileSummary:
    """The entry of ``metadata.yaml`` for one file.

    Attributes:
        name: The file's path relative to the folder.
        start_ns: Log time of the earliest message, ns since the epoch.
        end_ns: Log time of the latest message, ns since the epoch.
        counts: Number of messages by topic.
    """

    name: str
    start_ns: int
    end_ns: int
    counts: Mapping[str, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class BagSummary:
    """The content of ``metadata.yaml`` for a bag.

    Attributes:
        files: The files, the oldest first.
        custom_data: The writer's record of the run.
    """

    files: Sequence[FileSummary]
    topics: Sequence[TopicSummary]
    custom_data: Mapping[str, str]


def sealed_run(run: Mapping[str, str]) -> dict[str, str]:
    """Return the record of the run: how it was made, and a checksum."""
    return {**run, CHECKSUM_KEY: _checksum(run)}


def unsealed_run(record: Mapping[str, str]) -> dict[str, str] | None:
    """Return how the run was made, or None if the checksum is missing or does not match."""
    run = {key: value for key, value in record.items() if key != CHECKSUM_KEY}
    return run if record.get(CHECKSUM_KEY) == _checksum(run) else None


def _checksum(run: Mapping[str, str]) -> str:
    return f"{zlib.crc32(json.dumps(dict(run), sort_keys=True).encode()):08x}"


def metadata_text(bag: BagSummary) -> str:
    """Return the text of the MCAP record named ``rosbag2``."""
    return json.dumps(_metadata(bag), ensure_ascii=False)


def metadata_file_text(bag: BagSummary) -> str:
    """Return the text of ``metadata.yaml``: the same under rosbag2's outermost key."""
    content = {BAG_KEY: _metadata(bag)}
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def _metadata(bag: BagSummary) -> dict[str, Any]:
    start_ns = min(file.start_ns for file in bag.files)
    end_ns = max(file.end_ns for file in bag.files)
    return {
        "version": 9,
        "storage_identifier": "mcap",
        **_span(start_ns, end_ns, sum(sum(file.counts.values()) for file in bag.files)),
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": topic.name,
                    "type": topic.type_name,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": qos_maps(topic.qos),
                    "type_description_hash": topic.type_hash,
                },
                "message_count": sum(file.counts.get(topic.name, 0) for file in bag.files),
            }
            for topic in bag.topics
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file.name for file in bag.files],
        "files": [
            {"path": file.name, **_span(file.start_ns, file.end_ns, sum(file.counts.values()))}
            for file in bag.files
        ],
        "custom_data": dict(bag.custom_data) or None,
        "ros_distro": "jazzy",
    }


def _span(start_ns: int, end_ns: int, message_count: int) -> dict[str, Any]:
    return {
        "duration": {"nanoseconds": end_ns - start_ns},
        "starting_time": {"nanoseconds_since_epoch": start_ns},
        "message_count": message_count,
    }
