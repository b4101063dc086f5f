# SPDX-License-Identifier: Apache-2.0
"""Yields the requests of a log in the order of their arrival, each after the states known by then.

A log contains states in the order of their arrival, but the events of a call follow the states that arrived
while the response was computed. The file is therefore read twice in parallel: one reading finds the calls,
and the other follows with the states up to the ``log_time`` of each request. Memory holds one message, and
the calls that wait for the response to an earlier one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.cdr import decode_without_ros
from contact_dynamics.recording.definitions import EVENT_SUFFIX
from contact_dynamics.recording.file_messages import Span
from contact_dynamics.recording.service_calls import EVENT_TOPIC_SUFFIX, ServiceCall, service_calls

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from typing import Any

    from contact_dynamics.recording.bag_reader import BagReader, LoggedMessage

CLOCK: Final = "/clock"
INTERFACES: Final = "contact_dynamics_interfaces/srv/"
MONITOR_EVENT: Final = "contact_dynamics_interfaces/msg/MonitorEvent"
EVERYTHING: Final = Span()  # the whole log


def in_order(
    calls_from: BagReader, states_from: BagReader, topics: Collection[str], *, span: Span = EVERYTHING
) -> Iterator[LoggedMessage | ServiceCall]:
    """Yield a span of the messages of some topics, and each call at the arrival of its request.

    The same log is opened twice: ``calls_from`` for the calls, and ``states_from`` for the messages.
    """
    states = states_from.messages(topics, **span._asdict())
    state = next(states, None)
    messages = calls_from.messages(**span._asdict())
    for call in service_calls(message for message in messages if is_event_of_ours(message)):
        if call.request_event is not None:
            while state is not None and state.log_time_ns <= call.request_event.log_time_ns:
                yield state
                state = next(states, None)
        yield call
    while state is not None:  # messages after the last request
        yield state
        state = next(states, None)


def part_of(event: LoggedMessage, part: str) -> Any:
    """Return the "request" or the "response" in an event.

    Raise `InvalidFieldError` if there is none, since the service was introspected without contents.
    """
    contents: list[Any] = getattr(decode_without_ros(event), part)
    if not contents:
        raise InvalidFieldError(event.topic, f"an event without its {part}", "introspection with contents")
    return contents[0]


def is_event_of_ours(message: LoggedMessage) -> bool:
    """Return whether a message is an event of a service of this package."""
    return (
        message.topic.endswith(EVENT_TOPIC_SUFFIX)
        and message.type_name.startswith(INTERFACES)
        and message.type_name.endswith(EVENT_SUFFIX)
    )
