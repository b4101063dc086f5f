"""Finds the first time at which a moving body touches an obstacle, by steps in which it cannot touch.

At any time one plane separates the two (`contact.on_obstacles`). While the body stays above this plane, it
does not touch. `acceleration_bounds` says for how long it must stay above. The search goes to the end of that
time, takes the plane that separates best then, and goes on (conservative advancement; Mirtich, Impulse-based
dynamic simulation of rigid body systems, Berkeley 1996). It finds a touch within `GRAZING_DEPTH`, and misses
no deeper one.

Not covered: a body that hovers so close and so long that the search needs more than `MAX_STEPS` steps
(`NotSupportedError`), and rims that come to edges and corners (`contact.on_obstacles`).
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

MAX_STEPS: Final = 5_000
"""Largest number of steps of a search, which take about a second. A toss takes ten to a hundred steps."""


def first_touch(
    motion: Motion,
    shape_B: ConvexShape,
    obstacle: Obstacle,
    *,
    horizon: float,
    work: SearchWork | None = None,
) -> float | None:
    """Return the first time in [0, horizon], s, at which a body touches an obstacle and does not leave it.

    If it touches at time 0 and does not leave, the time is 0. If it leaves, it is the time at which it comes
    back. The function returns None if the body does not touch.

    Raises:
        InvalidFieldError: the horizon is negative, the shape is empty, or an integrated motion does not reach
            as far as the search has to go.
        NotSupportedError: a rim comes to an edge or a corner, or the body hovers.
        TooLargeError: this search, and others that ``work`` counts, take too many steps together.
    """
    until = check_not_negative("horizon", horizon)
    if shape_B.is_empty:
        raise InvalidFieldError("shape_B", "nothing", "a shape, which can touch")
    now = 0.0
    for _ in range(MAX_STEPS):
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
    message = f"obstacle {obstacle.name!r}: the body must pass it, got a body close to it until {now:g} s"
    raise NotSupportedError(message)
