# SPDX-License-Identifier: Apache-2.0
"""A bag's ``metadata.yaml`` is as rosbag2 of Jazzy writes it (version 9). The MCAP file has the same text.

The code writes the YAML without a library, since the form is fixed and short. JSON strings are valid YAML.
"""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

METADATA_FILE: Final = "metadata.yaml"
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
        qos: Lines of a YAML list of profiles, `qos_lines`.
    """

    name: str
    type_name: str
    type_hash: str
    qos: tuple[str, ...]


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


def metadata_lines(bag: BagSummary) -> list[str]:
    """Return the YAML of the bag's metadata: the text of the MCAP record named ``rosbag2``."""
    start_ns = min(file.start_ns for file in bag.files)
    end_ns = max(file.end_ns for file in bag.files)
    message_count = sum(sum(file.counts.values()) for file in bag.files)
    return [
        "version: 9",
        "storage_identifier: mcap",
        *_span(start_ns, end_ns, message_count),
        f"topics_with_message_count:{'' if bag.topics else ' []'}",
        *(line for topic in bag.topics for line in _indented(_topic_lines(topic, bag.files))),
        'compression_format: ""',
        'compression_mode: ""',
        "relative_file_paths:",
        *(f"  - {_quoted(file.name)}" for file in bag.files),
        "files:",
        *(line for file in bag.files for line in _indented(_file_lines(file))),
        f"custom_data:{'' if bag.custom_data else ' ~'}",
        *(f"  {_quoted(key)}: {_quoted(value)}" for key, value in bag.custom_data.items()),
        "ros_distro: jazzy",
    ]


def custom_data_of(text: str) -> dict[str, str]:
    """Return the writer's record of the run from the text of a ``metadata.yaml`` of ours.

    It is empty where the text has none, or one that somebody else wrote.
    """
    _, _, after = text.partition("\n  custom_data:\n")
    found: dict[str, str] = {}
    for line in after.splitlines():
        if not line.startswith("    "):
            break
        try:
            found |= json.loads(f"{{{line}}}")
        except ValueError:
            return {}
    return found


def metadata_file_text(bag: BagSummary) -> str:
    """Return the text of ``metadata.yaml``: the same lines under rosbag2's outermost key."""
    return "\n".join(["rosbag2_bagfile_information:", *_indented(metadata_lines(bag)), ""])


def _span(start_ns: int, end_ns: int, message_count: int) -> list[str]:
    return [
        "duration:",
        f"  nanoseconds: {end_ns - start_ns}",
        "starting_time:",
        f"  nanoseconds_since_epoch: {start_ns}",
        f"message_count: {message_count}",
    ]


def _file_lines(file: FileSummary) -> list[str]:
    return [
        f"- path: {_quoted(file.name)}",
        *_indented(_span(file.start_ns, file.end_ns, sum(file.counts.values()))),
    ]


def _topic_lines(topic: TopicSummary, files: Sequence[FileSummary]) -> list[str]:
    return [
        "- topic_metadata:",
        f"    name: {_quoted(topic.name)}",
        f"    type: {_quoted(topic.type_name)}",
        "    serialization_format: cdr",
        "    offered_qos_profiles:",
        *(f"      {line}" for line in topic.qos),
        f"    type_description_hash: {_quoted(topic.type_hash)}",
        f"  message_count: {sum(file.counts.get(topic.name, 0) for file in files)}",
    ]


def _indented(lines: Sequence[str]) -> list[str]:
    return [f"  {line}" for line in lines]


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
