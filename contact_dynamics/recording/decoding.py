# SPDX-License-Identifier: Apache-2.0
"""Turns logged bytes into ROS message objects, if ROS and the message's package are installed."""

from __future__ import annotations

import importlib
from functools import cache
from typing import TYPE_CHECKING, Any

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.recording.definitions import EVENT_SUFFIX

if TYPE_CHECKING:
    from contact_dynamics.recording.bag_reader import LoggedMessage


@cache
def message_class(type_name: str) -> Any:
    """Return the class of ``package/msg/Name``, or the event class of ``package/srv/Name_Event``.

    Raises:
        InvalidFieldError: the name has another form, or its package is not installed.
    """
    try:
        package, folder, name = type_name.split("/")
        module = importlib.import_module(f"{package}.{folder}")
        if folder == "srv" and name.endswith(EVENT_SUFFIX):
            return getattr(module, name[: -len(EVENT_SUFFIX)]).Event
        return getattr(module, name)
    except (ValueError, ImportError, AttributeError) as error:
        raise InvalidFieldError(
            "type_name", type_name, f"an interface whose package is installed ({error})"
        ) from error


def decode(message: LoggedMessage) -> Any:
    """Return the logged ROS message. A service's event has ``info``, ``request`` and ``response``."""
    from rclpy.serialization import deserialize_message  # here, for logs are read without ROS too

    return deserialize_message(message.data, message_class(message.type_name))
