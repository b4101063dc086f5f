"""Takes the request or the response out of a service event, without ROS."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.cdr import decode_without_ros

if TYPE_CHECKING:
    from typing import Any

    from contact_dynamics.recording.bag_reader import LoggedMessage


def part_of(event: LoggedMessage, part: str) -> Any:
    """Return the request or the response that an event carries.

    Args:
        event: The event.
        part: "request" or "response".

    Raises:
        InvalidFieldError: the event carries none, since its service was introspected without contents.
    """
    contents: list[Any] = getattr(decode_without_ros(event), part)
    if not contents:
        raise InvalidFieldError(event.topic, f"an event without its {part}", "introspection with contents")
    return contents[0]
