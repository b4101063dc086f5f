# SPDX-License-Identifier: Apache-2.0
"""One planar body strikes at several contacts at once, under the laws of `orders`.

The plane is put into space, where the body gets equal moments about all axes. Such a body moves in the plane
as the planar one does, so the laws are the same and are written once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.orders import several_impact
from contact_dynamics.impact.several.result import SeveralContactsLaw, SeveralImpact
from contact_dynamics.plane.lifting import planar_in_space
from contact_dynamics.tolerances import VELOCITY_TOLERANCE

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
    several_contacts_law: SeveralContactsLaw = SeveralContactsLaw.SEQUENTIAL,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    axes_W: ArrayLike = _X_AND_Y,
) -> SeveralImpact:
    """Return what the impact of a planar body at all its contacts does, under a named law.

    Args:
        body: Mass and angular inertia.
        velocity: The velocity of the body just before.
        contacts: All contacts that touch, approaching or not. There is at least one.
        several_contacts_law: The law for several contacts.
        restitution_law: What the coefficients of restitution mean. ENERGETIC only goes with SEQUENTIAL.
        velocity_tolerance: m/s, > 0. A contact that approaches less fast does not strike.
        axes_W: (2, 3), the plane's x and y axes in world axes. The answer is in world axes, and the centre
            of mass is at the world's origin.

    Raises:
        SeparatingContactError: every contact separates.
        InvalidFieldError: `several_impact` refuses a field, or the axes are not two unit vectors at right
            angles.
    """
    spatial = planar_in_space(body, velocity, contacts, axes_W=axes_W)
    return several_impact(
        *spatial,
        several_contacts_law=several_contacts_law,
        restitution_law=restitution_law,
        velocity_tolerance=velocity_tolerance,
    )
