# SPDX-License-Identifier: Apache-2.0
"""A topic of a log that is being written: its type, its quality of service, and the times of its messages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from contact_dynamics.recording.bag_metadata import TopicSummary
from contact_dynamics.recording.cdr_stamp import event_stamp_ns, leading_stamp_ns
from contact_dynamics.recording.qos import OfferedQos, qos_lines

if TYPE_CHECKING:
    from contact_dynamics.recording.definitions import TypeDefinition


@dataclass(frozen=True, slots=True, kw_only=True)
class DeclaredTopic:
    """A topic whose messages a log takes.

    Attributes:
        name: The topic's name with its leading slash.
        definition: Its type.
        qos: Lines of a YAML list of profiles, `qos_yaml`.
    """

    name: str
    definition: TypeDefinition
    qos: tuple[str, ...]

    @property
    def summary(self) -> TopicSummary:
        """The topic's entry of ``metadata.yaml``."""
        return TopicSummary(
            name=self.name,
            type_name=self.definition.type_name,
            # rosbags refuses the whole folder if this is not its own hash of the text. It cannot be for an
            # event, which is written out as a message. The channel has the true hash.
            type_hash="" if self.definition.is_service_event else self.definition.type_hash,
            qos=self.qos,
        )

    def stamp_ns(self, data: bytes, *, otherwise_ns: int) -> int:
        """Return the stamp with which a serialised message begins, ns, or another time if it has none."""
        if self.definition.is_service_event:
            stamp_ns = event_stamp_ns(data)
        elif self.definition.begins_with_stamp:
            stamp_ns = leading_stamp_ns(data)
        else:
            return otherwise_ns
        return max(0, stamp_ns)  # MCAP has no time before the epoch, but the message itself keeps its stamp


def qos_yaml(qos: Any) -> tuple[str, ...]:
    """Return the lines of a quality of service, or of each in a list, as `BagWriter.add_topic` takes it."""
    offers = qos if isinstance(qos, (list, tuple)) else [OfferedQos() if qos is None else qos]
    return tuple(qos_lines(offers))
