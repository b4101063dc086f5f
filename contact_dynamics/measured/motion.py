"""The measured states of one body in one stretch of time, as flights and contacts are found in them.

The noise of the poses is stated by the source or estimated from their scatter. Fourth differences remove what
is smooth (a parabola wholly, a tumbling rotation nearly) and leave white noise, enlarged by sqrt(70). Their
median absolute size, over 0.6745, is the standard deviation of normal noise, and strikes are too few to move
it. Noise that is correlated from state to state, as behind a filter, comes out too small.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from contact_dynamics.constants import seconds_since, to_seconds
from contact_dynamics.questions.uncertain_state import state_of
from contact_dynamics.records import Record
from contact_dynamics.rotations.many import rotation_vectors
from contact_dynamics.tolerances import LEAST_ORIENTATION_NOISE, LEAST_POSITION_NOISE
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World

FEWEST_STATES: Final = 12
"""Shorter stretches hold no flight that could be asked about, and too few differences for their noise."""

GAP: Final = 5.0
"""Median spacings of states. Where states are farther apart than this, a stretch ends."""

_ENLARGED: Final = math.sqrt(70.0)  # white noise in fourth differences: 1 + 16 + 36 + 16 + 1
_MEDIAN: Final = 0.6745  # median of the absolute value of a standard normal variable


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

    @property
    def surfaces(self) -> Sequence[Surface]:
        """The flat surfaces on which it may fall."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MeasuredMotion(Record):
    """One body's states without gaps; sample k is row k of each array.

    Attributes:
        body: The body, with its shape. world: The world that the body moves in. published: The states in the
        order of their stamps, which differ, with covariances where they had some. arrivals_ns: When each
        state was known, ns, on the clock of the stamps. epoch_ns: The stamp from which times count, ns.
        times: (n,), s after the epoch. p_WB_W: (n, 3), m, centre of mass in the world. q_WB: (n, 4), unit
        quaternions x, y, z, w: body coordinates into world coordinates. rate: Rate of the states, Hz.
        position_noise: Standard deviation of each coordinate of a position, m. orientation_noise: Standard
        deviation of each component of an orientation's rotation error, rad.
    """

    body: Body
    world: World
    published: tuple[KnownState, ...]
    arrivals_ns: tuple[int, ...]
    epoch_ns: int
    times: FloatArray
    p_WB_W: FloatArray
    q_WB: FloatArray
    rate: float
    position_noise: float
    orientation_noise: float

    def __len__(self) -> int:
        """Return the number of states."""
        return len(self.published)

    @property
    def gravity_W(self) -> FloatArray:
        """Acceleration of gravity, (3,), m/s^2, world axes."""
        return self.world.gravity_W

    @property
    def surfaces(self) -> list[Surface]:
        """The flat surfaces of the world."""
        return [surface for surface in self.world.surfaces if isinstance(surface, Surface)]

    def stamp_ns(self, sample: int) -> int:
        """Return the stamp of a state, ns."""
        return self.published[sample].stamp_ns

    def known_by(self, asked_ns: int, *, since: int = 0) -> list[KnownState]:
        """Return the states from sample ``since`` on that had been stamped and had arrived by then."""
        end = bisect_right(self.published, asked_ns, key=lambda state: state.stamp_ns)
        stamped = zip(self.published[since:end], self.arrivals_ns[since:end], strict=True)
        return [state for state, arrival in stamped if arrival <= asked_ns]


def motions_of(
    body: Body,
    world: World,
    states: Sequence[KnownState],
    *,
    arrivals_ns: Sequence[int],
    noise: tuple[float, float] | None = None,
) -> list[MeasuredMotion]:
    """Return a body's states in stretches without gaps.

    Args:
        body: The body.
        world: The world that it moves in.
        states: Its states in any order. Of several with one stamp, the last one counts.
        arrivals_ns: When each of them was known, ns, on the clock of the stamps.
        noise: Standard deviations of a position's coordinates, m, and of an orientation's components, rad.
            If it is None, they are estimated.
    """
    by_stamp = {state.stamp_ns: (state, arrival) for state, arrival in zip(states, arrivals_ns, strict=True)}
    ordered = [by_stamp[stamp] for stamp in sorted(by_stamp)]
    if len(ordered) < FEWEST_STATES:
        return []
    stamps = [state.stamp_ns for state, _ in ordered]
    steps_ns = [later - earlier for earlier, later in itertools.pairwise(stamps)]
    spacing_ns = float(np.median(steps_ns))
    breaks = [i + 1 for i, step in enumerate(steps_ns) if step > GAP * spacing_ns]
    motions = []
    for begin, end in itertools.pairwise([0, *breaks, len(ordered)]):
        if end - begin < FEWEST_STATES:
            continue
        stretch = ordered[begin:end]
        p_WB_W = np.array([state_of(state).p_WB_W for state, _ in stretch])
        q_WB = np.array([state_of(state).q_WB for state, _ in stretch])
        position_noise, orientation_noise = noise or estimated_noise(p_WB_W, q_WB)
        motions.append(
            MeasuredMotion(
                body=body,
                world=world,
                published=tuple(state for state, _ in stretch),
                arrivals_ns=tuple(arrival for _, arrival in stretch),
                epoch_ns=stamps[0],
                times=seconds_since(stamps[0], stamps[begin:end]),
                p_WB_W=p_WB_W,
                q_WB=q_WB,
                rate=1.0 / to_seconds(round(spacing_ns)),
                position_noise=position_noise,
                orientation_noise=orientation_noise,
            )
        )
    return motions


def estimated_noise(p_WB_W: FloatArray, q_WB: FloatArray) -> tuple[float, float]:
    """Return the standard deviations, m and rad, of evenly spaced poses, (n, 3) and (n, 4), n > 4."""
    turns = rotation_vectors(q_WB[1:], q_WB[:-1])
    position = float(np.median(np.abs(np.diff(p_WB_W, n=4, axis=0)))) / (_MEDIAN * _ENLARGED)
    orientation = float(np.median(np.abs(np.diff(turns, n=3, axis=0)))) / (_MEDIAN * _ENLARGED)
    return max(position, LEAST_POSITION_NOISE), max(orientation, LEAST_ORIENTATION_NOISE)
