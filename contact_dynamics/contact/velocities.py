# SPDX-License-Identifier: Apache-2.0
"""This file takes noise out of the velocities of contacts in space, so that some count as at rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.tolerances import VELOCITY_TOLERANCE
from contact_dynamics.validation import check_magnitude, check_not_negative

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray


def spatial_contact_velocities(
    state: BodyState, contacts: ContactSet, *, velocity_tolerance: float = VELOCITY_TOLERANCE
) -> FloatArray:
    """Return the velocities of the body's contact points, (n, 3), m/s, world axes.

    A normal or tangential part within ``velocity_tolerance``, m/s, is an exact 0.

    Raises:
        InvalidFieldError: the tolerance is negative, or a velocity or the distance of a contact from the
            centre of mass is beyond `LARGEST_NUMBER`.
    """
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    check_speeds(state, contacts)
    velocities = state.velocity_of_point(contacts.p_WC_W)
    along = np.einsum("ij,ij->i", velocities, contacts.normals_W)
    across = velocities - along[:, None] * contacts.normals_W
    along[np.abs(along) <= tolerance] = 0.0
    across[np.linalg.norm(across, axis=1) <= tolerance] = 0.0
    cleaned: FloatArray = across + along[:, None] * contacts.normals_W
    return cleaned


def check_speeds(state: BodyState, contacts: ContactSet) -> None:
    """Refuse velocities, and distances of contacts from the centre of mass, beyond `LARGEST_NUMBER`."""
    check_magnitude("v_WB_W", state.v_WB_W)
    check_magnitude("w_WB_W", state.w_WB_W)
    check_magnitude("p_WC_W", contacts.p_WC_W - state.p_WB_W)
