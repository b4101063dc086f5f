# SPDX-License-Identifier: Apache-2.0
"""The measured states of one body in an interval without gaps, in which flights and contacts are found.

The noise of the poses is given by the source or estimated from their scatter. Fourth differences remove
smooth motion (a parabola completely, a tumbling rotation nearly) and contain white noise enlarged by
sqrt(70). Their median absolute value, divided by 0.6745, is the standard deviation of normal noise; strikes
are too rare to affect the median. Noise that is correlated in time, for example by a filter, is
underestimated.
"""

from __future__ import annotations

import itertools
import math
from array import array
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.constants import seconds_since, to_seconds
from contact_dynamics.questions.uncertain_state import UncertainState, state_of
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import states_of_rows
from contact_dynamics.rotations.many import rotation_vectors
from contact_dynamics.tolerances import LEAST_ORIENTATION_NOISE, LEAST_POSITION_NOISE
from contact_dynamics.validation import check_at_rest
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from contact_dynamics.measured.recorded_toss import Toss
    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World

    IntArray = NDArray[np.int64]

FEWEST_STATES: Final = 12
"""Shorter intervals contain no flight that could be predicted, and too few differences to estimate noise."""

GAP: Final = 5.0  # median spacings of states. A longer gap ends an interval.
_ENLARGED: Final = math.sqrt(70.0)  # factor on white noise in fourth differences: 1 + 16 + 36 + 16 + 1
_MEDIAN: Final = 0.6745  # median of the absolute value of a standard normal variable


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MeasuredMotion(Record):
    """The states of one body in an interval without gaps; sample k is row k of each array."""

    body: Body  # with its shape
    world: World  # the world that the body moves in
    epoch_ns: int  # the stamp at time 0, ns
    stamps_ns: IntArray  # (n,), ns, ascending
    arrivals_ns: IntArray  # (n,), arrival times of the states, ns, on the clock of the stamps
    times: FloatArray  # (n,), s after the epoch
    p_WB_W: FloatArray  # (n, 3), m, centre of mass in the world
    q_WB: FloatArray  # (n, 4), unit quaternions x, y, z, w: body coordinates into world coordinates
    v_WB_W: FloatArray  # (n, 3), m/s, as published, world axes
    w_WB_W: FloatArray  # (n, 3), rad/s, as published, world axes
    # (n, 12, 12), as in `UncertainState`; NaN for states without covariance, and empty if all are.
    covariances: FloatArray
    rate: float  # rate of the states, Hz
    position_noise: float  # standard deviation of each coordinate of a position, m
    orientation_noise: float  # that of each component of an orientation's rotation error, rad

    def __post_init__(self) -> None:
        """Reject a world with moving surfaces."""
        check_at_rest("world", self.world, "measured motions")

    def __len__(self) -> int:
        """Return the number of states."""
        return len(self.times)

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
        return int(self.stamps_ns[sample])

    def state(self, sample: int) -> KnownState:
        """Return a published state, with its covariance if it has one."""
        return self.states([sample])[0]

    def states(self, samples: Sequence[int]) -> list[KnownState]:
        """Return the published states of several samples."""
        rows = [getattr(self, name)[samples] for name in ("p_WB_W", "q_WB", "v_WB_W", "w_WB_W")]
        states = states_of_rows(np.hstack(rows), self.stamps_ns[samples].tolist())
        if len(self.covariances) == 0:
            return [*states]
        return [
            state
            if math.isnan(self.covariances[sample, 0, 0])
            else UncertainState(state=state, covariance=self.covariances[sample])
            for sample, state in zip(samples, states, strict=True)
        ]

    def known_by(self, asked_ns: int, *, since: int = 0) -> IntArray:
        """Return the samples, from ``since`` on, that were stamped and had arrived by a time, ns."""
        end = int(np.searchsorted(self.stamps_ns, asked_ns, side="right"))
        return since + np.flatnonzero(self.arrivals_ns[since:end] <= asked_ns)

    def part(self, begin: int, stop: int) -> MeasuredMotion:
        """Return the states of a range of samples, with unchanged times."""
        return replace(self, **{name: getattr(self, name)[begin:stop] for name in COLUMNS})


MeasuredPoses: TypeAlias = "MeasuredMotion | Toss"
"""The poses of one body in the order of time, with their noise."""

COLUMNS: Final = ("stamps_ns", "arrivals_ns", "times", "p_WB_W", "q_WB", "v_WB_W", "w_WB_W", "covariances")
"""The fields of a motion with one row per state."""

_STATE: Final = 13  # numbers: position, quaternion, linear and angular velocity
_LATEST_NS: Final = 2**63 - 1  # a damaged log may contain later arrivals


class StateColumns:
    """The states of one body in the order of their arrival, stored as arrays of eight bytes per number."""

    def __init__(self, states: Iterable[KnownState] = (), arrivals_ns: Iterable[int] = ()) -> None:
        """Store states with their arrival times, ns, on the clock of the stamps."""
        self._numbers, self._stamps_ns, self._arrivals_ns = array("d"), array("q"), array("q")
        self._covariances: dict[int, FloatArray] = {}
        for state, arrival_ns in zip(states, arrivals_ns, strict=True):
            self.add(state, arrival_ns)

    def __len__(self) -> int:
        """Return the number of states."""
        return len(self._stamps_ns)

    def add(self, known: KnownState, arrival_ns: int) -> None:
        """Add a state with its arrival time, ns."""
        state = state_of(known)
        if isinstance(known, UncertainState):
            self._covariances[len(self)] = known.covariance
        self._stamps_ns.append(state.stamp_ns)
        self._arrivals_ns.append(min(arrival_ns, _LATEST_NS))
        for part in (state.p_WB_W, state.q_WB, state.v_WB_W, state.w_WB_W):
            self._numbers.frombytes(part.tobytes())

    def extend(self, stamps_ns: IntArray, numbers: FloatArray, arrivals_ns: Sequence[int]) -> None:
        """Add n states without covariances, with stamps, (n,), ns, and arrival times, (n,), ns."""
        self._stamps_ns.frombytes(stamps_ns.tobytes())
        self._numbers.frombytes(numbers.tobytes())
        self._arrivals_ns.extend(min(arrival_ns, _LATEST_NS) for arrival_ns in arrivals_ns)

    def know_at_stamps(self) -> None:
        """Set each arrival time to the stamp."""
        self._arrivals_ns = self._stamps_ns[:]

    @property
    def stamps_ns(self) -> IntArray:
        """The stamps, (n,), ns."""
        return np.array(self._stamps_ns, dtype=np.int64)

    @property
    def arrivals_ns(self) -> IntArray:
        """The arrival times, (n,), ns."""
        return np.array(self._arrivals_ns, dtype=np.int64)

    @property
    def numbers(self) -> FloatArray:
        """The states, (n, 13): position, quaternion, linear and angular velocity."""
        return np.frombuffer(self._numbers).reshape(-1, _STATE)

    @property
    def covariances(self) -> FloatArray:
        """The covariances, (n, 12, 12), NaN where a state has none, or (0, 12, 12) if none has one."""
        found = np.full((len(self) if self._covariances else 0, 12, 12), math.nan)
        for row, covariance in self._covariances.items():
            found[row] = covariance
        return found


def motions_of(
    body: Body,
    world: World,
    states: StateColumns,
    *,
    noise: tuple[float, float] | None = None,
    epoch_ns: int | None = None,
) -> list[MeasuredMotion]:
    """Return the states of a body in intervals without gaps.

    The states may be in any order; of several with the same stamp, the last one is used. Times are relative
    to ``epoch_ns``, ns, by default the first stamp. The noise (m for each coordinate of a position, rad for
    each component of an orientation error) is estimated if it is None.
    """
    stamps_ns, reverse = np.unique(states.stamps_ns[::-1], return_index=True)
    if len(stamps_ns) < FEWEST_STATES:
        return []
    order = len(states) - 1 - reverse
    numbers, covariances = states.numbers[order], states.covariances
    steps_ns = np.diff(stamps_ns)
    spacing_ns = float(np.median(steps_ns))
    epoch_ns = int(stamps_ns[0]) if epoch_ns is None else epoch_ns
    whole = MeasuredMotion(
        body=body,
        world=world,
        epoch_ns=epoch_ns,
        stamps_ns=stamps_ns,
        arrivals_ns=states.arrivals_ns[order],
        times=seconds_since(epoch_ns, stamps_ns.tolist()),
        p_WB_W=numbers[:, :3],
        q_WB=numbers[:, 3:7],
        v_WB_W=numbers[:, 7:10],
        w_WB_W=numbers[:, 10:],
        covariances=covariances[order] if len(covariances) else covariances,
        rate=1.0 / to_seconds(round(spacing_ns)),
        position_noise=math.nan,
        orientation_noise=math.nan,
    )
    breaks = np.flatnonzero(steps_ns > GAP * spacing_ns) + 1
    motions = []
    for begin, end in itertools.pairwise([0, *breaks.tolist(), len(whole)]):
        if end - begin >= FEWEST_STATES:
            part = whole.part(begin, end)
            position, orientation = noise or estimated_noise(part.p_WB_W, part.q_WB)
            motions.append(replace(part, position_noise=position, orientation_noise=orientation))
    return motions


def estimated_noise(p_WB_W: FloatArray, q_WB: FloatArray) -> tuple[float, float]:
    """Return the noise, m and rad, of evenly spaced poses, (n, 3) and (n, 4), n > 4."""
    turns = rotation_vectors(q_WB[1:], q_WB[:-1])
    position = float(np.median(np.abs(np.diff(p_WB_W, n=4, axis=0)))) / (_MEDIAN * _ENLARGED)
    orientation = float(np.median(np.abs(np.diff(turns, n=3, axis=0)))) / (_MEDIAN * _ENLARGED)
    return max(position, LEAST_POSITION_NOISE), max(orientation, LEAST_ORIENTATION_NOISE)
