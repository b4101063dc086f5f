# SPDX-License-Identifier: Apache-2.0
"""A flight ends at the first contact with planes and obstacles.

`earliest` finds the next landing of a body in its world, with all contacts there. `plane_arrival` finds the
first time at a plane. Both use `acceleration_bounds`, which says for how long nothing can touch.
`search_work` limits their work.
"""

from contact_dynamics.landing.earliest import Landing, next_landing
from contact_dynamics.landing.plane_arrival import FirstContact, first_contact
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "FirstContact",
    "Landing",
    "first_contact",
    "next_landing",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
