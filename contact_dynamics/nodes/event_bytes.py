"""The event of an answer as bytes, for a log that has it before it leaves.

ROS publishes the event of a response only after the response has left. So a log that must have it before
makes the same event itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.serialization import serialize_message

from contact_dynamics.recording.cdr import cut_to_its_end
from contact_dynamics.recording.cdr_stamp import EventType
from contact_dynamics.recording.decoding import message_class
from contact_dynamics.recording.definitions import find_definition
from msg_adapters.stamps import stamp_to_msg

if TYPE_CHECKING:
    from msg_adapters.status import Response


class EventBytes:
    """Makes the events of one service."""

    def __init__(self, type_name: str) -> None:
        """Take the type of the events, "package/srv/Name_Event"."""
        self._definition = find_definition(type_name)
        self._class = message_class(type_name)

    def of_response(
        self, response: Response, *, client_gid: bytes, sequence_number: int, stamp_ns: int
    ) -> bytes:
        """Return the event that tells of a response.

        Args:
            response: the response.
            client_gid: the 16 bytes that identify the client.
            sequence_number: the number of the request among those of that client.
            stamp_ns: when it leaves, ns by the node's clock.
        """
        event = self._class(response=[response])
        event.info.event_type = int(EventType.RESPONSE_SENT)
        event.info.client_gid = list(client_gid)
        event.info.sequence_number = sequence_number
        stamp_to_msg(stamp_ns, into=event.info.stamp)
        data = serialize_message(event)
        return cut_to_its_end(data, type_name=self._definition.type_name, definition=self._definition.text)
