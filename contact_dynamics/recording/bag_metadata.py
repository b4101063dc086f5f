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
    from collections.abc import Iterable, Mapping, Sequence

    from contact_dynamics.recording.definitions import TypeDefinition
    from contact_dynamics.recording.qos import OfferedQos

METADATA_FILE: Final = "metadata.yaml"
BAG_KEY: Final = "rosbag2_bagfile_information"  # its outermost key
RUN_RECORD: Final = "contact_dynamics"  # the MCAP metadata record that says how the run was made
OFFERED_QOS: Final = "offered_qos_profiles"  # in the metadata of a channel, as rosbag2 names it
TYPE_HASH: Final = "topic_type_hash"  # beside it
CHECKSUM_KEY: Final = "checksum"  # in that record, because MCAP gives metadata none


@dataclass(frozen=True, slots=True, kw_only=True)
class DeclaredTopic:
    """A topic of a bag: its absolute name, its type, and what its publishers offer."""

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
    """Return the record of the run: how it was made, and a checksum."""
    return {**run, CHECKSUM_KEY: _checksum(run)}


def unsealed_run(record: Mapping[str, str]) -> dict[str, str] | None:
    """Return how the run was made, or None if the checksum is missing or does not match."""
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
                    # rosbags refuses the whole folder if this is not its own hash of the text. It cannot be
                    # for an event, which is written out as a message. The channel has the true hash.
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
