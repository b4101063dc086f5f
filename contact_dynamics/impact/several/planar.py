"""Several contacts of one planar body at once: the laws of `several`, in the plane.

The plane is put into space, where nothing couples it to the motion out of it: a body that is isotropic there
moves in the plane as the planar one does, so that the laws are the same and are written once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.orders import several_impact
from contact_dynamics.impact.several.result import SeveralContactsLaw, SeveralImpact
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tolerances import VELOCITY_TOLERANCE
from contact_dynamics.validation import check_array

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity

_X_AND_Y: Final = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def planar_several_impact(
    body: PlanarBody,
    velocity: PlanarVelocity,
    contacts: Sequence[PlanarContact],
    *,
    law: SeveralContactsLaw = SeveralContactsLaw.SEQUENTIAL,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    axes_W: ArrayLike = _X_AND_Y,
) -> SeveralImpact:
    """Return what the impact of a planar body at all its contacts does, under a named law.

    Args:
        body: Mass and angular inertia.
        velocity: Of the body just before.
        contacts: All that touch, approaching or not; at least one.
        law: The law for several contacts.
        restitution_law: What the coefficients of restitution mean; ENERGETIC only with SEQUENTIAL.
        velocity_tolerance: m/s, > 0. A contact that approaches less fast does not strike.
        axes_W: (2, 3), the plane's x and y in world axes, in which the answer is given; the centre of mass is
            its origin.

    Raises:
        SeparatingContactError: every contact separates.
        InvalidFieldError: as `several_impact`.
    """
    spatial = planar_in_space(body, velocity, contacts, axes_W=axes_W)
    return several_impact(
        *spatial, law=law, restitution_law=restitution_law, velocity_tolerance=velocity_tolerance
    )


def planar_in_space(
    body: PlanarBody, velocity: PlanarVelocity, contacts: Sequence[PlanarContact], *, axes_W: ArrayLike
) -> tuple[MassProperties, BodyState, ContactSet]:
    """Return a problem in space that moves as a planar one does, with the plane's x and y, (2, 3)."""
    axes = check_array("axes_W", axes_W, (2, 3))
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
        restitutions=np.array([contact.restitution for contact in contacts]),
    )
    return MassProperties(mass=body.mass, I_B=body.inertia * np.eye(3)), state, touching
