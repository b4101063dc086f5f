"""Where a flight ends: the first contact with planes and obstacles.

`earliest` has the next landing of a body in its world, with all contacts there. `plane_arrival` is the first
time at a plane, with `rim_descent` for rims, and `obstacle_arrival` that at an obstacle. All rely on
`acceleration_bounds`: for how long nothing can touch. `search_work` bounds how long they look.
"""

from contact_dynamics.landing.earliest import Landing, next_landing
from contact_dynamics.landing.plane_arrival import FirstContact, first_contact

__all__ = [
    "FirstContact",
    "Landing",
    "first_contact",
    "next_landing",
]


def __dir__() -> list[str]:
    return __all__
