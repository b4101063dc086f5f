# SPDX-License-Identifier: Apache-2.0
"""The end of a flight: the first contact with planes and obstacles.

`next_landing` returns the next landing of a body in its world, with all contacts; a landing on an edge or a
face has several. `next_meeting` returns the first contact of two bodies in flight, and `first_contact` the
first arrival at a plane.

The modules of this package are internal. `earliest` contains `next_landing`, `meeting` contains
`next_meeting`, and `plane_arrival` contains `first_contact`. All use `acceleration_bounds`, which bounds the
time for which nothing can touch.
`search_work` limits their work.
"""

from contact_dynamics.landing.earliest import Landing, next_landing
from contact_dynamics.landing.meeting import Meeting, next_meeting
from contact_dynamics.landing.plane_arrival import FirstContact, first_contact
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "FirstContact",
    "Landing",
    "Meeting",
    "first_contact",
    "next_landing",
    "next_meeting",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
