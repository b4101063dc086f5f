"""The first time at which a moving body touches an obstacle: advancing only where it cannot touch.

At any time one plane separates the two (`obstacle_contact`); while all of the body's corners stay above it
the body touches nothing, and for how long they must is known as in `first_contact`. The search goes there,
takes the plane that separates best then, and goes on (conservative advancement; Mirtich, Impulse-based
dynamic simulation of rigid body systems, Berkeley 1996). A touch is found within `GRAZING_DEPTH`, and no
deeper one is missed.

Not covered: what hovers so close and so long that `MOST_STEPS` do not get it past (`NotSupportedError`);
shapes that `obstacle_contact` does not cover.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.motion_bounds import bounds_of, free_for
from contact_dynamics.obstacle_contact import check_covered, site_of, touches_of
from contact_dynamics.rigid_body import rotation_matrix
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, GRAZING_DEPTH
from contact_dynamics.validation import check_not_negative

if TYPE_CHECKING:
    from contact_dynamics.convex_shape import ConvexShape
    from contact_dynamics.motion_bounds import Motion
    from contact_dynamics.obstacle import Obstacle

MOST_STEPS: Final = 5_000
"""Some second of computing; a toss takes ten to a hundred."""


def first_touch(motion: Motion, shape_B: ConvexShape, obstacle: Obstacle, *, horizon: float) -> float | None:
    """Return the first time in [0, horizon], s, at which a body touches an obstacle and does not leave it.

    One that touches at time 0 does so at once unless it leaves; then the time at which it comes back counts.
    None: it does not touch. An empty shape never does.

    Raises:
        InvalidFieldError: horizon < 0, or an integrated motion that does not get as far as the search has to.
        NotSupportedError: a shape with rims or rounded corners, or a body that hovers.
    """
    until = check_not_negative("horizon", horizon)
    if shape_B.is_empty:
        return None
    check_covered(shape_B)
    arms = np.sqrt(np.einsum("ij,ij->i", shape_B.vertices, shape_B.vertices))
    now = 0.0
    for _ in range(MOST_STEPS):
        sample = motion.sample(now)
        p_WB_W, R_WB = np.array(sample.p_WB_W), rotation_matrix(np.array(sample.q_WB))
        v_WB_W, w_WB_W = np.array(sample.v_WB_W), np.array(sample.w_WB_W)
        site = site_of(shape_B, p_WB_W, R_WB, obstacle)
        bound = bounds_of(motion, site.normal_W)(now)
        pulls = bound.fall + arms * bound.turning
        arms_W = shape_B.vertices @ R_WB.T
        if site.gap <= GRAZING_DEPTH:
            touches = touches_of(shape_B, p_WB_W, R_WB, obstacle, DISTANCE_TOLERANCE)
            points = np.array([touch.p_WC_W for touch in touches]).reshape(-1, 3)
            velocities = v_WB_W + np.cross(w_WB_W, points - p_WB_W)
            if not (velocities @ site.normal_W > 0.0).all():
                return now
            pull = float(pulls.max())
            step = math.sqrt(2.0 * GRAZING_DEPTH / pull) if pull > 0.0 else _LEAVING
        else:
            heights = (p_WB_W + arms_W) @ site.normal_W - (site.level + shape_B.rounding)
            rates = (v_WB_W + np.cross(w_WB_W, arms_W)) @ site.normal_W
            step = float(free_for(heights, rates, pulls).min())
        if now >= until:
            return None
        now = min(now + step, bound.until, until)
    message = (
        f"obstacle {obstacle.name!r}: found a body close to it until {now:g} s, allowed is one that passes"
    )
    raise NotSupportedError(message)


_LEAVING: Final = 1e-5
"""s, the step away from an obstacle where nothing pulls towards it."""
