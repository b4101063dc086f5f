# SPDX-License-Identifier: Apache-2.0
"""Contacts are given or found from shapes. They have curvatures, velocities and friction.

`contact` has one contact and sets of them. `curvature` has the shapes of both sides where they touch, and
what velocities add to the accelerations there. `found` finds contacts from geometry, with the points where a
body touches a plane or a solid (`touches`). `velocities` says which contacts count as at rest, and warns of
those that a body cannot have. `friction` makes pyramids from friction cones. `uncertainty` says how well
contacts are known, and `noise` which of them touch and rest where the state is measured.
"""

from contact_dynamics.contact.contact import Contact, ContactSet
from contact_dynamics.contact.curvature import Curvatures
from contact_dynamics.contact.found import find_contacts
from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact.uncertainty import ContactUncertainty
from contact_dynamics.contact.velocities import spatial_contact_velocities
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "Contact",
    "ContactSet",
    "ContactUncertainty",
    "Curvatures",
    "find_contacts",
    "linearised_cone",
    "spatial_contact_velocities",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
