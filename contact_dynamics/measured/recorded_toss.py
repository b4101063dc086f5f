# SPDX-License-Identifier: Apache-2.0
"""In a recorded toss a tracking system measured a body that flew, bounced and came to rest.

Velocities are estimates from past poses alone (`velocity_estimate`), by the same method for every source. So
a prediction from them was possible at that moment.

It is assumed that there is one body and one surface, that z is up in the world, and that the body is a box
whose tracked frame has its origin at the centre of mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.constants import ns_after
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.velocity_estimate import frames_in_window, slope_noise
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.tolerances import UNIT_LENGTH_TOLERANCE
from contact_dynamics.validation import check_array, check_positive

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, Surface


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Toss(Record):
    """A recorded toss of one box-shaped body onto one surface. Sample k is row k of each array.

    Attributes:
        source: Where the numbers come from, in words.
        body: Mass properties and corners. Its published frame is B itself.
        box_size: (3,), m, full side lengths along the body's axes.
        surface: The surface on which it falls, with friction and restitution.
        gravity_W: (3,), m/s^2, world axes.
        rate: Rate of the samples, Hz.
        position_noise: Standard deviation of each coordinate of a measured position, m.
        times: (n,), s, increasing.
        p_WB_W: (n, 3), m, centre of mass in the world.
        q_WB: (n, 4), unit quaternions x, y, z, w: body coordinates into world coordinates.
        v_WB_W: (n, 3), m/s, velocity of the centre of mass, world axes, estimated from the past.
        w_WB_W: (n, 3), rad/s, angular velocity, world axes, estimated from the past.

    Raises:
        InvalidFieldError: arrays have unequal lengths, a number is not finite, times do not increase, a
            quaternion is not unit, or a rate or noise is not > 0.
    """

    source: str
    body: Body
    box_size: FloatArray
    surface: Surface
    gravity_W: FloatArray
    rate: float
    position_noise: float
    orientation_noise: (
        float  # rad, standard deviation of each component of a measured orientation's rotation error
    )
    times: FloatArray
    p_WB_W: FloatArray
    q_WB: FloatArray
    v_WB_W: FloatArray
    w_WB_W: FloatArray

    def __post_init__(self) -> None:
        """Check every field, and normalise the quaternions to rounding."""
        n = len(self.times)
        object.__setattr__(self, "box_size", check_array("box_size", self.box_size, (3,)))
        object.__setattr__(self, "gravity_W", check_array("gravity_W", self.gravity_W, (3,)))
        for name in ("rate", "position_noise", "orientation_noise"):
            object.__setattr__(self, name, check_positive(name, getattr(self, name)))
        object.__setattr__(self, "times", check_array("times", self.times, (n,)))
        for name in ("p_WB_W", "v_WB_W", "w_WB_W"):
            object.__setattr__(self, name, check_array(name, getattr(self, name), (n, 3)))
        if n < 2 or float(np.diff(self.times).min()) <= 0.0:
            raise InvalidFieldError("times", self.times, "two or more times, each later than the one before")
        q_WB = check_array("q_WB", self.q_WB, (n, 4))
        norms = np.linalg.norm(q_WB, axis=1)
        for row in np.flatnonzero(abs(norms - 1.0) > UNIT_LENGTH_TOLERANCE)[:1]:
            raise InvalidFieldError(f"q_WB[{row}]", q_WB[row].tolist(), "a unit quaternion")
        q_WB = q_WB / norms[:, None]
        q_WB.flags.writeable = False
        object.__setattr__(self, "q_WB", q_WB)

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.times)

    @property
    def surfaces(self) -> tuple[Surface]:
        """The surface, as the only one."""
        return (self.surface,)

    def state(self, sample: int, *, epoch_ns: int = 0) -> BodyState:
        """Return one sample as a state, stamped with its time after ``epoch_ns`` (ns)."""
        return BodyState(
            p_WB_W=self.p_WB_W[sample],
            q_WB=self.q_WB[sample],
            v_WB_W=self.v_WB_W[sample],
            w_WB_W=self.w_WB_W[sample],
            stamp_ns=ns_after(epoch_ns, float(self.times[sample])),
        )

    @property
    def velocity_noise(self) -> float:
        """Standard deviation of one component of the estimated linear velocity with a full window, m/s."""
        return slope_noise(frames=frames_in_window(self.rate), rate=self.rate, noise=self.position_noise)

    @property
    def angular_velocity_noise(self) -> float:
        """Standard deviation of one component of the estimated angular velocity with a full window, rad/s."""
        return slope_noise(frames=frames_in_window(self.rate), rate=self.rate, noise=self.orientation_noise)

    @property
    def contact_speed_noise(self) -> float:
        """Standard deviation of the farthest corner's estimated velocity, m/s, in its worst direction."""
        reach = float(np.linalg.norm(self.body.vertices_B, axis=1).max(initial=0.0))
        return math.hypot(self.velocity_noise, reach * self.angular_velocity_noise)
