"""A flight of a toss, in closed form, up to its first contact."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.landing.plane_arrival import Descent
from contact_dynamics.tumbling import Precision, free_motion

if TYPE_CHECKING:
    from contact_dynamics.landing.search_work import SearchWork
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.toss.solid import Numbers, Solid
    from contact_dynamics.tumbling import FreeMotion


class Flight(NamedTuple):
    """A flight.

    Attributes:
        motion: The motion.
        seconds: s, how long it lasts.
        y: The state at its end.
    """

    motion: FreeMotion
    seconds: float
    y: Numbers


def flight(
    solid: Solid,
    properties: MassProperties,
    shape: ConvexShape,
    state: BodyState,
    *,
    longest: float,
    pause: float,
    work: SearchWork,
) -> Flight:
    """Return the flight from a state to the first contact with a flat, or of the longest time, s.

    Arrivals are looked for after a pause, s. ``properties`` and ``shape`` are those of the solid.
    """
    gravity = np.array(solid.gravity)
    motion = free_motion(properties, state, gravity_W=gravity, precision=Precision.DOUBLE)
    begun = motion
    if pause > 0.0:
        begun = free_motion(properties, motion.state_at(pause), gravity_W=gravity, precision=Precision.DOUBLE)
    first = longest
    for flat in solid.flats:
        normal = np.array(flat.normal)
        found = Descent(begun, shape, flat.level * normal, normal).run(max(first - pause, 0.0), work)
        if found is not None:
            first = min(first, pause + found.seconds)
    sample = motion.sample(first)
    return Flight(motion, first, [*sample.p_WB_W, *sample.q_WB, *sample.v_WB_W, *sample.w_WB_W])
