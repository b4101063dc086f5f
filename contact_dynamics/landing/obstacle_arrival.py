"""The first time at which a moving body touches an obstacle: advancing only where it cannot touch.

At any time one plane separates the two (`obstacle_contact`); while the body stays above it, it touches
nothing, and for how long it must is known as in `first_contact`. The search goes there,
takes the plane that separates best then, and goes on (conservative advancement; Mirtich, Impulse-based
dynamic simulation of rigid body systems, Berkeley 1996). A touch is found within `GRAZING_DEPTH`, and no
deeper one is missed.

Not covered: what hovers so close and so long that `MOST_STEPS` do not get it past (`NotSupportedError`);
rims that come to edges and corners (`obstacle_contact`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.on_obstacles import site_of, touches_of
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.landing.plane_arrival import Descent
from contact_dynamics.landing.search_work import OBSTACLE_STEP, SearchWork
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, GRAZING_DEPTH, LEAVING_STEP
from contact_dynamics.validation import check_not_negative

if TYPE_CHECKING:
    from contact_dynamics.landing.acceleration_bounds import Motion
    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.shapes.obstacle import Obstacle

MOST_STEPS: Final = 5_000
"""Some second of computing; a toss takes ten to a hundred."""


def first_touch(
    motion: Motion,
    shape_B: ConvexShape,
    obstacle: Obstacle,
    *,
    horizon: float,
    work: SearchWork | None = None,
) -> float | None:
    """Return the first time in [0, horizon], s, at which a body touches an obstacle and does not leave it.

    One that touches at time 0 does so at once unless it leaves; then the time at which it comes back counts.
    None: it does not touch.

    Raises:
        InvalidFieldError: horizon < 0, an empty shape, or an integrated motion that does not get as far as
            the search has to.
        NotSupportedError: a rim that comes to an edge or a corner, or a body that hovers.
        TooLargeError: this search, and others that ``work`` counts, take too many steps together.
    """
    until = check_not_negative("horizon", horizon)
    if shape_B.is_empty:
        raise InvalidFieldError("shape_B", "nothing", "a shape, which can touch")
    now = 0.0
    for _ in range(MOST_STEPS):
        if work is not None:
            work.spend(OBSTACLE_STEP, now)
        sample = motion.sample(now)
        p_WB_W, R_WB = np.array(sample.p_WB_W), rotation_matrix(np.array(sample.q_WB))
        site = site_of(shape_B, p_WB_W, R_WB, obstacle)
        descent = Descent(motion, shape_B, site.level * site.normal_W, site.normal_W)
        bound = descent.bound_from(now)
        if site.gap <= GRAZING_DEPTH:
            touches = touches_of(shape_B, p_WB_W, R_WB, obstacle, DISTANCE_TOLERANCE)
            points = np.array([touch.p_WC_W for touch in touches]).reshape(-1, 3)
            velocities = np.array(sample.v_WB_W) + np.cross(sample.w_WB_W, points - p_WB_W)
            if not (velocities @ site.normal_W > 0.0).all():
                return now
            pull = bound.fall + descent.reach * bound.turning
            step = math.sqrt(2.0 * GRAZING_DEPTH / pull) if pull > 0.0 else LEAVING_STEP
        else:
            step = descent.free_for(descent.at(now), bound)
        if now >= until:
            return None
        now = min(now + step, bound.until, until)
    message = (
        f"obstacle {obstacle.name!r}: found a body close to it until {now:g} s, allowed is one that passes"
    )
    raise NotSupportedError(message)
