# SPDX-License-Identifier: Apache-2.0
"""Contacts are given or found from shapes. They have curvatures, velocities and friction.

`contact` has one contact and sets of them, and `curvature` the shapes of both sides where they touch. `found`
finds contacts from geometry: `on_flats` where a body meets a plane, `on_obstacles` where it meets a solid.
`velocities` says which contacts count as at rest. `kinds` says what velocities add to the accelerations of
contacts. `friction` makes pyramids from friction cones. `uncertainty` says how well contacts are known, and
`noise` which of them touch and rest where the state is measured. `reach` warns of contacts that a body cannot
have.
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
