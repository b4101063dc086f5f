# SPDX-License-Identifier: Apache-2.0
"""The errors that misuse raises. There is one root, and one class for each cause.

Messages name the field, what is allowed and the value received. An expected physical outcome (separating,
inconsistent, ambiguous) is a result and never an error.
"""

from __future__ import annotations

import inspect
from typing import Final


class ContactDynamicsError(Exception):
    """Root of all errors that this project raises on purpose."""


class InvalidFieldError(ContactDynamicsError, ValueError):
    """A field has a value that is not allowed: NaN, a negative mass, a quaternion that is not unit, ...

    Attributes:
        field: The field.
        found: The value received.
        allowed: What the field must be: the words of the message between "must be" and "got".
        hint: What may be wrong or help, at the end of the message. It may be empty.
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
    """An argument or a field has another type than its annotation says: a `Body` for a `MassProperties`."""


class UnknownArgumentError(ContactDynamicsError, TypeError):
    """A call has no argument of that name, or requires another one. The message names what was meant."""


class TooLargeError(InvalidFieldError):
    """A list is longer than the stated limit."""


class OutOfPlaneError(InvalidFieldError):
    """A planar question is about something that leaves the plane of motion by more than the tolerance."""


class SeparatingContactError(InvalidFieldError):
    """An impact was asked for at a contact whose bodies move apart."""


NORMAL_HINT: Final = "does the normal point into the first body?"
"""What to ask of a contact that separates, and would strike if its normal were the opposite one."""


class NoContactError(ContactDynamicsError):
    """A question was asked about contacts, but nothing touches or will touch."""


class NoShapeError(NoContactError):
    """The body that was asked about has no shape that could touch anything."""


class UnknownBodyError(ContactDynamicsError):
    """A name is not among the configured bodies."""


class NoStateError(ContactDynamicsError):
    """No state of the body is known, or none at the time asked for."""


class StaleStateError(ContactDynamicsError):
    """The newest state is older than the configured limit."""


class FrameMismatchError(ContactDynamicsError):
    """A message's frame is not the one expected."""


class NotSupportedError(ContactDynamicsError):
    """The interface can carry the question, but this version does not answer it. The message says what."""


class UndecidedError(NotSupportedError):
    """The answer depends on rounding, because the case is degenerate to the last digits."""


class BusyError(ContactDynamicsError):
    """So many questions wait already that another one would wait too long."""


class TookTooLongError(ContactDynamicsError):
    """The answer did not come within the time that it was given."""


class ConcaveShapeWarning(UserWarning):
    """The corners are those of a concave body. Shapes are convex, and the convex hull is used."""


class ImplausibleBodyWarning(UserWarning):
    """The mass of a body from a file cannot lie inside its shape, as where lengths are in millimetres."""


class FarContactWarning(UserWarning):
    """A contact is farther from a body than its shape reaches: the state or the contact is wrong."""


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
