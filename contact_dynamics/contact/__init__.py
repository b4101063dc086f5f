# SPDX-License-Identifier: Apache-2.0
"""Contacts, explicit or detected from shapes, with their friction, curvatures and velocities.

`Contact` and `ContactSet` are the types, `find_contacts` detects the contacts of a body with the surfaces of
a world, and `ContactUncertainty` contains the errors of contacts.

The modules of this package are internal. `contact` contains one contact and sets of contacts. `curvature`
contains the curvatures of body and surface at a contact, and the terms that velocities add to the
accelerations there. `found` detects contacts, with the points at which a body touches a plane or a solid
(`touches`). `velocities` determines which contacts count as at rest, and warns of contacts out of the body's
reach. `pairs` contains the contacts between several bodies. `friction` computes pyramids inside friction
cones. `uncertainty` contains the errors of contacts, and `noise` determines which contacts touch and are at
rest if the state is measured.
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
