# SPDX-License-Identifier: Apache-2.0
"""Matches the requests and responses of a log by client and sequence number.

A call can leave four events. This file uses the server's two: request received, response sent. The client's
two (request sent, response received) have the same contents, and exist only if the client is introspected
too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from contact_dynamics.recording.cdr import EventType, event_info
from contact_dynamics.recording.definitions import EVENT_SUFFIX
from contact_dynamics.recording.message_types import decode

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from contact_dynamics.recording.bag_reader import LoggedMessage

EVENT_TOPIC_SUFFIX: Final = "/_service_event"

MAX_HELD: Final = 10_000
"""Answered calls that wait for one before them. A request whose response was lost must not hold up all of a
log, nor fill the memory."""

_Key: TypeAlias = "tuple[str, bytes, int]"  # topic of the events, client, number of the request


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceCall:
    """One call of a service as its server logged it.

    Attributes:
        service: The service's name with its leading slash.
        service_type: "package/srv/Name".
        client_gid: 16 bytes that identify the client within its session.
        sequence_number: Number of the request among those of that client.
        request_event: The request, or None if the log begins later.
        response_event: The response, or None if it was never sent or the log ends earlier.
    """

    service: str
    service_type: str
    client_gid: bytes
    sequence_number: int
    request_event: LoggedMessage | None = None
    response_event: LoggedMessage | None = None

    def request(self) -> Any:
        """Return the request as a ROS message, or None if the log does not have it."""
        return _content(self.request_event, "request")

    def response(self) -> Any:
        """Return the response as a ROS message, or None if the log does not have it."""
        return _content(self.response_event, "response")


def service_calls(messages: Iterable[LoggedMessage], *, max_held: int = MAX_HELD) -> Iterator[ServiceCall]:
    """Yield the calls in the order of their requests.

    Responses can be sent out of order, so a call is held back until all calls before it have a response.
    Calls without a response are yielded at the end of the log, or when too many are held.

    Args:
        messages: the messages of a log. Those that are not service events are skipped.
        max_held: maximum number of answered calls that wait for an earlier one, >= 0.
    """
    open_calls: dict[_Key, ServiceCall] = {}  # in the order of their requests
    answered: set[_Key] = set()  # those of them that have a response
    for message in messages:
        if not message.topic.endswith(EVENT_TOPIC_SUFFIX):
            continue
        info = event_info(message.data)
        key = (message.topic, info.client_gid, info.sequence_number)
        call = open_calls.get(key) or ServiceCall(
            service=message.topic.removesuffix(EVENT_TOPIC_SUFFIX),
            service_type=message.type_name.removesuffix(EVENT_SUFFIX),
            client_gid=info.client_gid,
            sequence_number=info.sequence_number,
        )
        if info.event_type is EventType.REQUEST_RECEIVED:
            open_calls[key] = replace(call, request_event=message)
        elif info.event_type is EventType.RESPONSE_SENT:
            call = replace(call, response_event=message)
            if key not in open_calls:  # the log begins after the request
                yield call
                continue
            open_calls[key] = call
            answered.add(key)
        while open_calls:
            first = next(iter(open_calls))
            if first not in answered and len(answered) <= max_held:
                break
            answered.discard(first)
            yield open_calls.pop(first)
    yield from open_calls.values()


def _content(event: LoggedMessage | None, part: str) -> Any:
    contents = [] if event is None else getattr(decode(event), part)
    return contents[0] if contents else None  # empty where introspection gave metadata only
