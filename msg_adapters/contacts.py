# SPDX-License-Identifier: Apache-2.0
"""Converts `contact_dynamics_interfaces/ContactSet` to a contact set and back."""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.contact import MAX_CONTACTS, ContactSet
from contact_dynamics.contact.curvature import Curvatures, alike
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics_interfaces.msg import ContactSet as ContactSetMsg
from msg_adapters.field_names import CONTACT_FIELDS, renamed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from contact_dynamics.validation import FloatArray


_MOTION: Final = ("surface_velocities", "surface_angular_velocities", "surface_accelerations")
"""The fields of a surface that moves. In a contact set, their names end in the world's axes."""


def contacts_from_msg(msg: ContactSetMsg) -> ContactSet:
    """Return the contacts.

    Raise `InvalidFieldError` if arrays have unequal lengths, curvatures are without the kind CURVED, or the
    contacts are invalid; `TooLargeError` if there are more than `MAX_CONTACTS`.
    """
    n = len(msg.frictions)
    if max(n, len(msg.positions) // 3, len(msg.normals) // 3) > MAX_CONTACTS:
        raise TooLargeError(
            "contacts", f"{max(n, len(msg.positions) // 3)} contacts", f"at most {MAX_CONTACTS}"
        )
    body_curvatures, surface_curvatures = _sides(msg)
    try:
        return ContactSet(
            p_WC_W=_rows("contacts.positions", msg.positions, n),
            normals_W=_rows("contacts.normals", msg.normals, n),
            frictions=np.asarray(msg.frictions),
            restitutions=np.asarray(msg.restitutions) if msg.restitutions or n == 0 else None,
            surfaces=tuple(msg.surface_names),
            static_frictions=np.asarray(msg.static_frictions) if msg.static_frictions else None,
            body_curvatures=body_curvatures,
            surface_curvatures=surface_curvatures,
            **{
                f"{field}_W": _optional_rows(f"contacts.{field}", getattr(msg, field), n) for field in _MOTION
            },
        )
    except InvalidFieldError as error:
        raise renamed(error, CONTACT_FIELDS) from None


def contacts_to_msg(contacts: ContactSet, *, into: ContactSetMsg | None = None) -> ContactSetMsg:
    """Return the contacts as a message, which is new unless an empty one to fill is given."""
    msg = ContactSetMsg() if into is None else into
    msg.positions = flat(contacts.p_WC_W)
    msg.normals = flat(contacts.normals_W)
    msg.frictions = flat(contacts.frictions)
    if contacts.restitutions is not None:
        msg.restitutions = flat(contacts.restitutions)
    if contacts.static_frictions is not None:
        msg.static_frictions = flat(contacts.static_frictions)
    msg.surface_names = list(contacts.surfaces)
    if contacts.surfaces_move:
        for field in _MOTION:
            if (motion := getattr(contacts, f"{field}_W")) is not None:
                setattr(msg, field, flat(motion))
    if contacts.body_curvatures is None and contacts.surface_curvatures is None:
        return msg
    n = len(contacts)
    body, surface = (
        alike(n, default) if side is None else side
        for side, default in ((contacts.body_curvatures, math.inf), (contacts.surface_curvatures, 0.0))
    )
    sides = np.column_stack([body.along, body.across, surface.along, surface.across])
    kinds = np.full(n, ContactSetMsg.CURVED, dtype=np.uint8)
    kinds[(sides == (math.inf, math.inf, 0.0, 0.0)).all(axis=1)] = ContactSetMsg.POINT_ON_FLAT
    kinds[(sides == (0.0, 0.0, math.inf, math.inf)).all(axis=1)] = ContactSetMsg.FLAT_ON_POINT
    msg.kinds = kinds.tolist()
    for name, side in (("body", body), ("surface", surface)):
        setattr(msg, f"{name}_curvatures", flat(side.along))
        setattr(msg, f"{name}_curvature_directions", flat(side.directions_W))
        setattr(msg, f"{name}_curvatures_across", flat(side.across))
    return msg


def flat(values: FloatArray) -> array[float]:
    """Return numbers as a flat `array.array`, which message fields accept without checking each element."""
    return array("d", np.asarray(values, dtype=np.float64).tobytes())


def rows(numbers: Sequence[float], width: int = 3) -> FloatArray:
    """Return the numbers of a flat field, each ``width`` of them as a row, (n, width)."""
    return np.array(numbers, dtype=np.float64).reshape(-1, width)


def _sides(msg: ContactSetMsg) -> tuple[Curvatures | None, Curvatures | None]:
    """Return the curvatures of body and surface, or None for points on flats, as most contacts are."""
    if not (
        msg.kinds
        or msg.body_curvatures
        or msg.body_curvatures_across
        or msg.body_curvature_directions
        or msg.surface_curvatures
        or msg.surface_curvatures_across
        or msg.surface_curvature_directions
    ):
        return None, None
    n = len(msg.frictions)
    kinds = np.array(msg.kinds, dtype=np.uint8)
    if len(kinds) not in {0, n}:
        raise InvalidFieldError("contacts.kinds", f"{len(kinds)} kinds", f"{n}, or none")
    for i in np.flatnonzero(kinds > ContactSetMsg.CURVED)[:1]:
        raise InvalidFieldError(
            f"contacts.kinds[{i}]", kinds[i], "POINT_ON_FLAT (0), FLAT_ON_POINT (1) or CURVED (2)"
        )
    return (
        _curvatures(msg, "body", kinds, point=ContactSetMsg.POINT_ON_FLAT),
        _curvatures(msg, "surface", kinds, point=ContactSetMsg.FLAT_ON_POINT),
    )


def _curvatures(msg: ContactSetMsg, side: str, kinds: NDArray[np.uint8], *, point: int) -> Curvatures | None:
    """Return the curvatures of one side. It is a point at contacts of the kind ``point``."""
    n = len(msg.frictions)
    fields = (f"{side}_curvatures", f"{side}_curvatures_across", f"{side}_curvature_directions")
    along, across, directions = (np.array(getattr(msg, field), dtype=np.float64) for field in fields)
    curved = kinds == ContactSetMsg.CURVED
    if not curved.any():
        if len(kinds) == 0 and np.any(along):
            raise InvalidFieldError("contacts.kinds", "none, with curvatures", "CURVED (2) where they hold")
        if not kinds.any():
            return None
    elif len(along) != n:
        raise InvalidFieldError(
            f"contacts.{fields[0]}", f"{len(along)} numbers", f"{n}, one for each contact"
        )
    if (len(across), len(directions)) not in {(0, 0), (n, 3 * n)}:
        raise InvalidFieldError(
            f"contacts.{fields[1]}",
            f"{len(across)} numbers and {len(directions)} of directions",
            f"{n} and {3 * n}, or none of either",
        )
    named = np.where(kinds == point, math.inf, 0.0)
    along = np.where(curved, along, named) if curved.any() else named
    try:
        return Curvatures(
            along=along,
            across=np.where(curved, across, named) if len(across) > 0 else along,
            directions_W=directions.reshape(-1, 3) if len(across) > 0 else np.zeros((n, 3)),
        )
    except InvalidFieldError as error:
        names = zip(("along", "across", "directions_W"), fields, strict=True)
        raise renamed(error, {ours: f"contacts.{field}" for ours, field in names}) from None


def _optional_rows(field: str, values: array[float], n: int) -> FloatArray | None:
    return _rows(field, values, n) if values else None


def _rows(field: str, values: array[float], n: int) -> FloatArray:
    if len(values) != 3 * n:
        raise InvalidFieldError(field, f"{len(values)} numbers", f"{3 * n}, three for each of {n} frictions")
    return np.asarray(values).reshape(n, 3)
