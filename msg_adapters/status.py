# SPDX-License-Identifier: Apache-2.0
"""Converts errors to the status codes of services. Equal offsets in their ranges have the same meaning."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, Protocol

from contact_dynamics import errors
from msg_adapters.rejected_fields import in_fields

if TYPE_CHECKING:
    from collections.abc import Sequence

_CODE_NAMES: Final[tuple[tuple[type[errors.ContactDynamicsError], str], ...]] = (
    # A subclass must come before the class that it refines.
    (errors.TooLargeError, "TOO_LARGE"),
    (errors.NotInFlightError, "NOT_IN_FLIGHT"),
    (errors.OutOfPlaneError, "OUT_OF_PLANE"),
    (errors.SeparatingContactError, "SEPARATING"),
    (errors.InvalidFieldError, "INVALID_FIELD"),
    (errors.NoContactError, "NO_CONTACT"),
    (errors.UnknownBodyError, "UNKNOWN_BODY"),
    (errors.NoStateError, "NO_STATE"),
    (errors.StaleStateError, "STALE_STATE"),
    (errors.FrameMismatchError, "FRAME_MISMATCH"),
    (errors.NotSupportedError, "NOT_SUPPORTED"),
    (errors.BusyError, "BUSY"),
    (errors.TookTooLongError, "TIMEOUT"),
)


MAX_SAID: Final = 2000
"""Largest length of an error's message, which may quote a name of any length."""


_SHAPE_HINT: Final = (
    "a body that a request describes has mass and inertia only: name a configured one with a shape, such as "
    "body.NAME.mass, body.NAME.inertia: [0.0] and body.NAME.sphere: [0.03], or give contacts, with "
    "contact_source: 1, where the request has them"
)


class Response(Protocol):
    """The fields that every response has."""

    OK: int
    status: int
    message: str
    computation_time: float


def short(message: str) -> str:
    """Return a message without its middle if it is too long to read."""
    half = MAX_SAID // 2
    return message if len(message) <= MAX_SAID else f"{message[:half]} ... {message[-half:]}"


_WARNING: Final = "warning: "


def with_warnings(text: str, warnings: Sequence[str]) -> str:
    """Return the message of a response: its own text, then a line for each warning."""
    return "\n".join([*([text] if text else []), *(_WARNING + one for one in warnings)])


def without_warnings(message: str) -> tuple[str, tuple[str, ...]]:
    """Return the own text of a response's message, and its warnings."""
    lines = message.splitlines()
    warnings = tuple(line.removeprefix(_WARNING) for line in lines if line.startswith(_WARNING))
    return "\n".join(line for line in lines if not line.startswith(_WARNING)), warnings


def code_name(error: Exception) -> str:
    """Return the name of the status code of an error. A service without it has a wider one instead."""
    return next((name for kind, name in _CODE_NAMES if isinstance(error, kind)), "INTERNAL_ERROR")


def report_error(response: Response, error: Exception) -> None:
    """Write the status code and the message of an error to a response."""
    error = in_fields(error)
    if hasattr(response, "event_time"):
        response.event_time = math.nan  # there is no event; interfaces cannot have it as a default
    if isinstance(error, errors.NoShapeError):
        error = errors.NoShapeError(f"{error} ({_SHAPE_HINT})")
    known = (name for kind, name in _CODE_NAMES if isinstance(error, kind) and hasattr(response, name))
    name = next(known, "INTERNAL_ERROR")
    response.status = getattr(response, name)
    response.message = short(str(error) if name != "INTERNAL_ERROR" else f"{type(error).__name__}: {error}")
