"""A flight of a toss, in closed form, up to its first contact."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact_dynamics.landing.plane_arrival import Descent
from contact_dynamics.landing.search_work import SearchWork
from contact_dynamics.toss.solid import state_of
from contact_dynamics.tumbling import FreeMotion, Precision, free_motion

if TYPE_CHECKING:
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.toss.solid import Numbers, Solid


class Flight(NamedTuple):
    """A flight.

    Attributes:
        motion: The motion, which does not end by itself.
        seconds: s, how long the flight lasts.
        after: The state at its end.
    """

    motion: FreeMotion
    seconds: float
    after: Numbers


def flight(
    solid: Solid,
    properties: MassProperties,
    shape: ConvexShape,
    y: Numbers,
    *,
    stamp_ns: int,
    longest: float,
    pause: float,
) -> Flight:
    """Return the flight from a state to the first contact with a flat.

    Args:
        solid: The body and the flats.
        properties: Mass and inertia of the solid.
        shape: Its shape.
        y: The state at the beginning.
        stamp_ns: Its stamp.
        longest: s, after which the flight ends anyway.
        pause: s, after which arrivals are looked for.

    Raises:
        TooLargeError: the search for the end takes too many steps.
    """
    gravity, work = np.array(solid.gravity), SearchWork()
    state = state_of(y, stamp_ns)
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
