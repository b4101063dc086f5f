# SPDX-License-Identifier: Apache-2.0
"""The errors that misuse raises. There is one root, and one class for each cause.

Messages name the field, what is allowed and the value received. An expected physical outcome (separating,
inconsistent, ambiguous) is a result and never an error.
"""

from __future__ import annotations

import inspect
from typing import Final


class ContactDynamicsError(Exception):
    """Base class of all errors that this package raises intentionally."""


class InvalidFieldError(ContactDynamicsError, ValueError):
    """A field has an invalid value: NaN, a negative mass, a quaternion that is not a unit quaternion.

    Attributes:
        field: Name of the field.
        found: Value received.
        allowed: Allowed values: the part of the message between "must be" and "got".
        hint: Hint at the end of the message, or an empty string.
    """

    def __init__(self, field: str, found: object, allowed: str, hint: str = "") -> None:
        super().__init__(f"{field} must be {allowed}, got {_short(found)}{hint and f' ({hint})'}")
        self.field = field
        self.found = found
        self.allowed = allowed
        self.hint = hint

    def __reduce__(self) -> tuple[type[InvalidFieldError], tuple[str, str, str, str]]:
        """Return how to make it again, in another process, with what was found as text."""
        return type(self), (self.field, _short(self.found), self.allowed, self.hint)


class WrongTypeError(InvalidFieldError, TypeError):
    """The type of an argument or a field differs from its annotation."""


class UnknownArgumentError(ContactDynamicsError, TypeError):
    """A call has an argument of an unknown name, or lacks a required one. The message suggests a name."""


class TooLargeError(InvalidFieldError):
    """A list is longer than its limit, or a computation exceeds a limit on its work."""


class NotInFlightError(InvalidFieldError):
    """A flight was to be fitted to states of a body that strikes something, rests, slides or is carried."""


class OutOfPlaneError(InvalidFieldError):
    """A planar problem deviates from its plane of motion by more than the tolerance."""


class SeparatingContactError(InvalidFieldError):
    """An impact was requested at a contact that separates."""


NORMAL_HINT: Final = "does the normal point into the first body?"
"""What to ask of a contact that separates, and would strike if its normal were the opposite one."""


class NoContactError(ContactDynamicsError):
    """A question requires contacts, but nothing touches or will touch."""


class NoShapeError(NoContactError):
    """The body has no shape that could touch anything."""


class UnknownBodyError(ContactDynamicsError):
    """A name is not among the configured bodies."""


class NoStateError(ContactDynamicsError):
    """No state of the body is available, or none at the requested time."""


class StaleStateError(ContactDynamicsError):
    """The newest state is older than the configured limit."""


class FrameMismatchError(ContactDynamicsError):
    """The frame of a message is not the expected one."""


class NotSupportedError(ContactDynamicsError):
    """This version does not support a part of the question, which the message names."""


class UndecidedError(NotSupportedError):
    """Rounding error prevents a decision, because the case is degenerate up to the last digits."""


class BusyError(ContactDynamicsError):
    """Too many questions are queued."""


class TookTooLongError(ContactDynamicsError):
    """The answer took longer than its deadline."""


class ConcaveShapeWarning(UserWarning):
    """The corners are those of a concave body. Shapes are convex, so the convex hull is used."""


class ImplausibleBodyWarning(UserWarning):
    """The mass of a body from a file cannot lie inside its shape, as with lengths in millimetres."""


class FarContactWarning(UserWarning):
    """A contact is beyond the reach of the body's shape: the state or the contact is wrong."""


def frames_to_caller() -> int:
    """Return the number of frames from the function that warns to the first one outside of this package."""
    count, frame = 0, inspect.currentframe()
    while frame is not None and str(frame.f_globals.get("__name__")).startswith(_PACKAGE):
        count, frame = count + 1, frame.f_back
    return count


_PACKAGE: Final = __name__.partition(".")[0] + "."
_LONGEST_SHOWN: Final = 120


def _short(value: object) -> str:
    text = " ".join(str(value).split()) or "nothing"
    return text if len(text) <= _LONGEST_SHOWN else text[: _LONGEST_SHOWN - 3] + "..."
