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
    """Return the outcome of an impact of a planar body at all its contacts, under the chosen laws.

    Args:
        body: Mass and angular inertia.
        velocity: Velocity of the body just before the impact.
        contacts: All touching contacts, whether or not they approach; at least one.
        several_contacts_law: Law for several contacts.
        restitution_law: Law of restitution. ENERGETIC requires SEQUENTIAL.
        velocity_tolerance: m/s, > 0. A contact that approaches more slowly does not strike.
        axes_W: (2, 3), the x and y axes of the plane in world axes. The result is in world axes, with the
            centre of mass at the origin of the world.

    Raises:
        SeparatingContactError: all contacts separate.
        InvalidFieldError: `several_impact` rejects a field, or the axes are not orthogonal unit vectors.
    """
    spatial = planar_in_space(body, velocity, contacts, axes_W=axes_W)
    return several_impact(
        *spatial,
        several_contacts_law=several_contacts_law,
        restitution_law=restitution_law,
        velocity_tolerance=velocity_tolerance,
    )
