"""`contact_dynamics_interfaces/ContactSet` to a contact set and back."""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact import MOST_CONTACTS, ContactSet
from contact_dynamics.errors import InvalidFieldError, NotSupportedError, TooLargeError
from contact_dynamics_interfaces.msg import ContactSet as ContactSetMsg

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


def contacts_from_msg(msg: ContactSetMsg) -> ContactSet:
    """Return the contacts.

    Raises:
        InvalidFieldError: arrays of unequal length, or as `ContactSet`. TooLargeError: more than
        `MOST_CONTACTS` contacts. NotSupportedError: moving surfaces, or other contact kinds than a point of
        the body on a flat of the world.
    """
    n = len(msg.frictions)
    if max(n, len(msg.positions) // 3, len(msg.normals) // 3) > MOST_CONTACTS:
        raise TooLargeError(
            "contacts", f"{max(n, len(msg.positions) // 3)} contacts", f"at most {MOST_CONTACTS}"
        )
    for field in ("surface_velocities", "surface_accelerations", "body_curvatures", "surface_curvatures"):
        if np.any(np.asarray(getattr(msg, field))):
            raise NotSupportedError(f"contacts.{field}: found numbers, allowed is none in this version")
    if any(kind != ContactSetMsg.POINT_ON_FLAT for kind in msg.kinds):
        message = "contacts.kinds: found others, allowed is POINT_ON_FLAT (0) in this version"
        raise NotSupportedError(message)
    return ContactSet(
        p_WC_W=_rows("contacts.positions", msg.positions, n),
        normals_W=_rows("contacts.normals", msg.normals, n),
        frictions=np.array(msg.frictions),
        restitutions=np.array(msg.restitutions),
        surfaces=tuple(msg.surface_names),
    )


def contacts_to_msg(contacts: ContactSet) -> ContactSetMsg:
    """Return the contacts as a message."""
    return ContactSetMsg(
        positions=flat(contacts.p_WC_W),
        normals=flat(contacts.normals_W),
        frictions=flat(contacts.frictions),
        restitutions=flat(contacts.restitutions),
        surface_names=list(contacts.surfaces),
    )


def flat(values: FloatArray) -> array[float]:
    """Return numbers as the flat `array.array` that message fields take without a check of each element."""
    numbers = array("d")
    numbers.frombytes(np.ascontiguousarray(values, dtype=np.float64).tobytes())
    return numbers


def _rows(field: str, values: array[float], n: int) -> FloatArray:
    if len(values) != 3 * n:
        raise InvalidFieldError(field, f"{len(values)} numbers", f"{3 * n}, three for each of {n} frictions")
    return np.array(values).reshape(n, 3)
