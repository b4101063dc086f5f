# SPDX-License-Identifier: Apache-2.0
"""Collects contacts of many recordings as arrays: corners at rest, strikes with both sides' velocities.

The flight on each side of a strike is fitted over its last or first part. The velocity of the mass centre is
linear in the centre's offset and in gravity, so its slopes are kept. The angular velocity depends on the
ratios of moments alone, and nearly linearly; its slopes are numerical, where the ratios are free.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.measured.flight_fit import fit_flight
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import MassProperties
from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.tolerances import SMALLEST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.calibration.first_flights import IntArray
    from contact_dynamics.calibration.model import Described
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.measured.motion import MeasuredMotion
    from contact_dynamics.validation import FloatArray


SAME_HEIGHT: Final = 0.15
"""Share of the half size within which the lowest corners at rest count as one face or edge."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Touching(Record):
    """Corners in contact at n times, at rest or at strikes."""

    recordings: IntArray  # (n,), numbers of the recordings
    surfaces: IntArray  # (n,), of the surfaces
    corners: IntArray  # (n,), of the corners
    p_W: FloatArray  # (n, 3), m, places of the configured mass centre
    q_WB: FloatArray  # (n, 4)
    stds: FloatArray  # (n,), m, of a height by the noise of measurement

    def __len__(self) -> int:
        """Return the number of moments."""
        return len(self.recordings)

    def heights(self, described: Described) -> FloatArray:
        """Return the corners' heights above their surfaces, (n,), m."""
        points = self.p_W + np.einsum("nij,nj->ni", matrices_of(self.q_WB), described.corners[self.corners])
        above = np.einsum(
            "ni,ni->n", points - described.points[self.surfaces], described.normals[self.surfaces]
        )
        heights: FloatArray = above - described.rounding
        return heights


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Side(Record):
    """The flights on one side of n strikes, at the times of the strikes."""

    velocities_W: FloatArray  # (n, 3), m/s, of the configured mass centre without gravity and offset
    by_center: FloatArray  # (n, 3, 3), 1/s, how they change with the centre's offset in body axes
    by_gravity: FloatArray  # (n,), s, how they change with gravity
    spins_W: FloatArray  # (n, 3), rad/s
    by_ratio: FloatArray  # (n, 3, 2), rad/s, how these change with the logarithms of both ratios of moments
    velocity_stds: FloatArray  # (n,), m/s
    spin_stds: FloatArray  # (n, 3), rad/s
    # (n, 2), by how much residuals of positions and orientations exceed the stated noise, >= 1.
    factors: FloatArray

    def velocities(self, center: FloatArray, gravity_W: FloatArray) -> FloatArray:
        """Return the mass centres' velocities, (n, 3), for an offset, (3,), and gravity of each strike."""
        found: FloatArray = self.velocities_W + self.by_center @ center + self.by_gravity[:, None] * gravity_W
        return found

    def spins(self, ratios: FloatArray) -> FloatArray:
        """Return the angular velocities, (n, 3), for changes of both ratios' logarithms."""
        spins: FloatArray = self.spins_W + self.by_ratio @ ratios
        return spins


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Strikes(Touching):
    """All strikes of all recordings, with the flights on both sides."""

    times: FloatArray  # (n,), s
    before: Side
    after: Side


def strikes_of(observed: Sequence[Observed], *, ratios: FloatArray | None) -> Strikes:
    """Return the strikes of all recordings, in their order.

    ``ratios``, (2, 2), are the logarithms of both ratios of moments between which derivatives by them are
    taken, or None where these are not free.
    """
    found = [(number, each, strike) for number, each in enumerate(observed) for strike in each.strikes]
    states = [(strike.before, strike.after) for _, _, strike in found]
    before, after = (
        _side([_fitted(each.motion, frames(strike), strike.time, ratios) for _, each, strike in found])
        for frames in (attrgetter("frames_before"), attrgetter("frames_after"))
    )
    places = [0.5 * (before.state.p_WB_W + after.state.p_WB_W) for before, after in states]
    return Strikes(
        recordings=np.array([number for number, _, _ in found], dtype=int),
        surfaces=np.array([strike.surface for _, _, strike in found], dtype=int),
        corners=np.array([strike.corner for _, _, strike in found], dtype=int),
        times=np.array([strike.time for _, _, strike in found]),
        q_WB=np.array([before.state.q_WB for before, _ in states]).reshape(-1, 4),
        p_W=np.array(places).reshape(-1, 3),
        stds=np.array([0.5 * float(np.hypot(a.position_std, b.position_std)) for a, b in states]),
        before=before,
        after=after,
    )


def _fitted(motion: MeasuredMotion, frames: slice, time: float, ratios: FloatArray | None) -> tuple[Any, ...]:
    """Return a row of each field of a `Side`."""
    since = motion.times[frames] - time
    slope = np.linalg.pinv(np.column_stack([np.ones_like(since), since]))[1]
    R = matrices_of(motion.q_WB[frames])
    reference = int(np.argmin(np.abs(since))) + frames.start
    found = fit_flight(motion, frames, reference=reference).at(time)
    by_ratio = np.zeros((3, 2))
    for k, near in enumerate([] if ratios is None else ratios.tolist()):
        low, high = (
            fit_flight(_with_ratio(motion, k, log), frames, reference=reference).at(time).state.w_WB_W
            for log in near
        )
        by_ratio[:, k] = (high - low) / max(near[1] - near[0], SMALLEST)
    unit = float(np.linalg.norm(slope))  # a velocity has this noise where positions have 1
    factors = [
        found.velocity_std / (unit * motion.position_noise),
        float(np.median(found.angular_velocity_std)) / (unit * motion.orientation_noise),
    ]
    return (
        slope @ motion.p_WB_W[frames],
        np.einsum("n,nij->ij", slope, R),
        -0.5 * float(slope @ np.square(since)),
        found.state.w_WB_W,
        by_ratio,
        found.velocity_std,
        found.angular_velocity_std,
        np.maximum(factors, 1.0),
    )


def _side(rows: Sequence[tuple[Any, ...]]) -> Side:
    shapes = ((3,), (3, 3), (), (3,), (3, 2), (), (3,), (2,))
    columns = [np.array([row[k] for row in rows]).reshape(-1, *shape) for k, shape in enumerate(shapes)]
    return Side(**{field.name: column for field, column in zip(fields(Side), columns, strict=True)})


def _with_ratio(motion: MeasuredMotion, ratio: int, logarithm: float) -> MeasuredMotion:
    """Return the motion of a body with one ratio of moments changed."""
    E = np.diag(np.exp(0.5 * logarithm * np.eye(3)[ratio + 1]))
    properties = motion.body.mass_properties
    changed = MassProperties(mass=properties.mass, I_B=E @ properties.I_B @ E)
    return replace(motion, body=replace(motion.body, mass_properties=changed))


def at_rests(observed: Sequence[Observed], described: Described, half_size: float) -> Touching:
    """Return the corners on which the bodies rest, those within `SAME_HEIGHT` of the lowest one."""
    rows = []
    for number, each in enumerate(observed):
        if each.rest is None or len(described.points) == 0:
            continue
        state, surface = each.rest.state, each.rest_surface
        points = state.p_WB_W + described.corners @ state.R_WB.T
        heights = (points - described.points[surface]) @ described.normals[surface]
        low = np.flatnonzero(heights < heights.min() + SAME_HEIGHT * half_size)
        std = np.hypot(each.rest.position_std, half_size * each.rest.orientation_std.max())
        rows += [(number, surface, int(k), state.p_WB_W, state.q_WB, std) for k in low]
    return Touching(
        recordings=np.array([row[0] for row in rows], dtype=int),
        surfaces=np.array([row[1] for row in rows], dtype=int),
        corners=np.array([row[2] for row in rows], dtype=int),
        p_W=np.array([row[3] for row in rows]).reshape(-1, 3),
        q_WB=np.array([row[4] for row in rows]).reshape(-1, 4),
        stds=np.array([row[5] for row in rows], dtype=float),
    )
