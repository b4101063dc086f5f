"""A flight of a toss, in closed form, up to its first contact: a piece of work."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.landing.plane_arrival import Descent
from contact_dynamics.toss.mode_choice import state_of
from contact_dynamics.tumbling import Precision, free_motion

if TYPE_CHECKING:
    from contact_dynamics.landing.search_work import SearchWork
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.toss.solid import Numbers, Solid
    from contact_dynamics.tumbling import FreeMotion


class AskedFlight:
    """The flight from a state to the first contact with a flat, as a piece of work.

    Attributes:
        solid: The body and the flats.
        properties: Mass and inertia of the solid, as flights take them.
        shape: Its shape, as flights take it.
        y: The state at the beginning.
        stamp_ns: Its stamp.
        longest: s, after which the flight ends anyway.
        pause: s, after which arrivals are looked for.
        is_told: Whether the motion is asked for. If it is not, flights can be done together.
        motion: The motion, once the work is done, unless it was done together.
        seconds: s, how long the flight lasts, then.
        after: The state at its end, then.
    """

    __slots__ = (
        "after",
        "is_told",
        "longest",
        "motion",
        "pause",
        "properties",
        "search",
        "seconds",
        "shape",
        "solid",
        "stamp_ns",
        "y",
    )

    motion: FreeMotion
    seconds: float
    after: Numbers

    def __init__(
        self,
        solid: Solid,
        properties: MassProperties,
        shape: ConvexShape,
        y: Numbers,
        *,
        stamp_ns: int,
        longest: float,
        pause: float,
        search: SearchWork,
        is_told: bool,
    ) -> None:
        self.solid, self.properties, self.shape = solid, properties, shape
        self.y, self.stamp_ns = y, stamp_ns
        self.longest, self.pause = longest, pause
        self.search, self.is_told = search, is_told

    @property
    def kind(self) -> tuple[str, int] | None:
        """Flights of bodies with as many corners can be done together, if nobody asks for their motions."""
        return None if self.is_told else ("flight", len(self.solid.corners))

    def work(self) -> None:
        """Do this flight alone."""
        gravity = np.array(self.solid.gravity)
        state = state_of(self.y, self.stamp_ns)
        motion = free_motion(self.properties, state, gravity_W=gravity, precision=Precision.DOUBLE)
        begun, pause = motion, self.pause
        if pause > 0.0:
            begun = free_motion(
                self.properties, motion.state_at(pause), gravity_W=gravity, precision=Precision.DOUBLE
            )
        first = self.longest
        for flat in self.solid.flats:
            normal = np.array(flat.normal)
            found = Descent(begun, self.shape, flat.level * normal, normal).run(
                max(first - pause, 0.0), self.search
            )
            if found is not None:
                first = min(first, pause + found.seconds)
        sample = motion.sample(first)
        self.motion, self.seconds = motion, first
        self.after = [*sample.p_WB_W, *sample.q_WB, *sample.v_WB_W, *sample.w_WB_W]
