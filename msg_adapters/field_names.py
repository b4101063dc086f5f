# SPDX-License-Identifier: Apache-2.0
"""Renames the fields in errors, since messages and parameters have other names for them than the package."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING, Final, TypeVar

from contact_dynamics.errors import InvalidFieldError

if TYPE_CHECKING:
    from collections.abc import Mapping

FIELDS: Final = {
    "I_B": "inertia",
    "contacts.p_WC_W": "contacts.positions",
    "force_W": "applied_wrench.force",
    "gravity_W": "gravity",
    "normal_W": "normal",
    "normals_W": "contacts.normals",
    "p_FB_F": "center_of_mass",
    "p_WB_W": "position",
    "p_WC_W": "contacts.positions",
    "p_WS_W": "point",
    "q_WB": "orientation",
    "q_WF": "orientation",
    "seconds": "times",
    "torque_W": "applied_wrench.torque",
    "v_WB_W": "linear_velocity",
    "vertices_B": "vertices",
    "vertices_W": "vertices",
    "w_WB_W": "angular_velocity",
}
"""The fields of messages and parameters, by the package's arguments."""

CONTACT_FIELDS: Final = {
    "p_WC_W": "contacts.positions",
    "normals_W": "contacts.normals",
    "frictions": "contacts.frictions",
    "static_frictions": "contacts.static_frictions",
    "restitutions": "contacts.restitutions",
    "surfaces": "contacts.surface_names",
    "body_curvatures": "contacts.body_curvatures",
    "surface_curvatures": "contacts.surface_curvatures",
    "surface_velocities_W": "contacts.surface_velocities",
    "surface_angular_velocities_W": "contacts.surface_angular_velocities",
    "surface_accelerations_W": "contacts.surface_accelerations",
}
"""The fields of the message of contacts, by those of a contact set."""

WRENCH_FIELDS: Final = {
    "force": "applied_wrench.force",
    "torque": "applied_wrench.torque",
    "force_W": "applied_wrench.force",
    "torque_W": "applied_wrench.torque",
}
"""The request's fields of a wrench, by the package's arguments."""

Refused = TypeVar("Refused", bound=Exception)


def renamed(error: Refused, names: Mapping[str, str] = FIELDS) -> Refused:
    """Return the same error with other names of its fields, or the error itself if it has none of them.

    Words around a field's name remain, as in "candidate 3: q_WB" and "q_WB[3]".
    """
    if not isinstance(error, InvalidFieldError):
        return error
    field = _pattern(tuple(names)).sub(lambda found: names[found.group()], error.field)
    return error if field == error.field else type(error)(field, error.found, error.allowed, error.hint)


@lru_cache
def _pattern(names: tuple[str, ...]) -> re.Pattern[str]:
    longest_first = sorted(names, key=len, reverse=True)
    return re.compile(rf"(?<![\w.])(?:{'|'.join(map(re.escape, longest_first))})\b")
