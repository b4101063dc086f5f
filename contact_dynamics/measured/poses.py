"""Flights are found in the measured poses of one body, from whichever source they come."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body


class MeasuredPoses(Protocol):
    """The poses of one body in the order of time, and how well they are measured. A `Toss` is one."""

    def __len__(self) -> int:
        """Return the number of samples."""

    @property
    def body(self) -> Body:
        """The body, whose centre of mass the positions are of."""

    @property
    def gravity_W(self) -> FloatArray:
        """Acceleration of gravity, (3,), m/s^2, world axes."""

    @property
    def rate(self) -> float:
        """Rate of the samples, Hz."""

    @property
    def position_noise(self) -> float:
        """Standard deviation of each coordinate of a measured position, m."""

    @property
    def orientation_noise(self) -> float:
        """Standard deviation of each component of a measured orientation's rotation error, rad."""

    @property
    def times(self) -> FloatArray:
        """Times of the samples, (n,), s, increasing."""

    @property
    def p_WB_W(self) -> FloatArray:
        """Positions of the centre of mass, (n, 3), m, world."""

    @property
    def q_WB(self) -> FloatArray:
        """Unit quaternions, (n, 4), x, y, z, w: body coordinates into world coordinates."""
