# SPDX-License-Identifier: Apache-2.0
"""This file turns a planar problem into a problem in space with the same motion.

The body in space has equal moments of inertia about all axes. Then nothing couples its motion in the plane to
motion out of it, and it moves in the plane as the planar body does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact.contact import ContactSet, all_or_none
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tolerances import UNIT_LENGTH_TOLERANCE
from contact_dynamics.validation import check_array

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity


def planar_in_space(
    body: PlanarBody, velocity: PlanarVelocity, contacts: Sequence[PlanarContact], *, axes_W: ArrayLike
) -> tuple[MassProperties, BodyState, ContactSet]:
    """Return a problem in space that moves as a planar one does, with the plane's x and y, (2, 3).

    Raises:
        InvalidFieldError: the axes are not two unit vectors at right angles.
    """
    axes = check_array("axes_W", axes_W, (2, 3))
    unit = np.abs(axes).max() <= 1.0 + UNIT_LENGTH_TOLERANCE
    if not unit or np.abs(axes @ axes.T - np.eye(2)).max() > UNIT_LENGTH_TOLERANCE:
        raise InvalidFieldError("axes_W", axes.tolist(), "two unit vectors at right angles")
    state = BodyState(
        p_WB_W=np.zeros(3),
        q_WB=np.array([0.0, 0.0, 0.0, 1.0]),
        v_WB_W=np.array(velocity.v) @ axes,
        w_WB_W=velocity.w * np.cross(axes[0], axes[1]),
    )
    touching = ContactSet(
        p_WC_W=np.array([contact.r for contact in contacts]).reshape(-1, 2) @ axes,
        normals_W=np.array([contact.normal for contact in contacts]).reshape(-1, 2) @ axes,
        frictions=np.array([contact.friction for contact in contacts]),
        restitutions=all_or_none([contact.restitution for contact in contacts]),
    )
    return MassProperties(mass=body.mass, I_B=body.inertia * np.eye(3)), state, touching
