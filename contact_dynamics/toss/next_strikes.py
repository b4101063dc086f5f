# SPDX-License-Identifier: Apache-2.0
"""Computes the next strikes of the samples of a toss.

For each strike, every sample has a flight (`flight`), an impact (`impacts`), and a random change of the
velocities after it by the scatter of the impact law (`law_spread`). A sample with a low rebound continues as
a single toss (`to_rest`), since several corners may strike or stay in contact.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from contact_dynamics.impact.several.result import SeveralContactsLaw
from contact_dynamics.impact.spatial.response import Strike
from contact_dynamics.numerics.vectors import dot
from contact_dynamics.records import NamedInt
from contact_dynamics.tolerances import SAMPLED_ARRIVAL
from contact_dynamics.toss.flight import Descent
from contact_dynamics.toss.impacts import routh
from contact_dynamics.toss.solid import approaches, low_corners
from contact_dynamics.toss.strike import Unsettled, strike

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from contact_dynamics.impact.law import RestitutionLaw
    from contact_dynamics.numerics.arithmetic import FloatArray
    from contact_dynamics.toss.law_spread import LawSpread
    from contact_dynamics.toss.solid import Solid
    from contact_dynamics.toss.uncertainty import Samples

FEWEST_AT_ONCE: Final = 32
"""Smallest number of samples for which later strikes are computed together. Fewer continue separately."""

MAX_FURTHER: Final = 50
"""Largest number of strikes computed beyond those returned. Bodies that still bounce continue separately."""


class SampleEnd(NamedInt):
    """Reason why a sample has no further strike."""

    FOLLOWED = 0
    """The sample has all requested strikes."""
    STAYS = 1
    """The rebound of the last contact is negligible, and it stays closed."""
    FLIES = 2
    """The sample has no contact until the horizon."""
    ENDS = 3
    """The sample was simulated to its end, and has no further strike."""


class ManyStrikes(NamedTuple):
    """The next strikes of n samples, d of each.

    Attributes:
        seconds: (d, n), s after the initial state; NaN without a strike.
        surfaces: (d, n), index of the plane that is struck, or -1.
        corners: (d, n), index of the striking corner, or -1.
        states: (d, n, 13), states after the strikes.
        ends: (n,), values of `SampleEnd`.
        now: (n,), s, times of the last states.
        last: (n, 13), last states.
        solid: Body and planes of a sample.
        rows: (n, m), parameters that differ between samples (`Solid.take`).
    """

    seconds: FloatArray
    surfaces: NDArray[np.int64]
    corners: NDArray[np.int64]
    states: FloatArray
    ends: NDArray[np.int64]
    now: FloatArray
    last: FloatArray
    solid: Solid
    rows: FloatArray

    def solid_of(self, i: int) -> Solid:
        """Return the body and the planes of sample ``i``."""
        return self.solid.sample(self.rows.data, i)


def next_strikes(
    solid: Solid,
    samples: Samples,
    *,
    law: RestitutionLaw,
    spread: LawSpread,
    depth: int,
    horizon: float,
    further: bool = False,
    together: SeveralContactsLaw = SeveralContactsLaw.SEQUENTIAL,
) -> ManyStrikes:
    """Return the next ``depth`` strikes of samples, within ``horizon`` s.

    Args:
        solid: Body and planes. Corners, friction and restitution are replaced by those of the samples.
        samples: Sampled parameters and states.
        law: Law of restitution.
        spread: Scatter of the impact law.
        depth: Number of strikes to return.
        horizon: Duration of the simulation, s.
        further: True to compute later strikes as well, for the last states only, while at least
            `FEWEST_AT_ONCE` samples still bounce.
        together: Law for several contacts that strike at one instant.
    """
    n = len(samples.p_WB_W)
    state = np.hstack([samples.p_WB_W, samples.q_WB, samples.v_WB_W, samples.w_WB_W])
    now = np.zeros(n)
    ends = np.full(n, SampleEnd.FOLLOWED, dtype=np.int64)
    many = ManyStrikes(
        seconds=np.full((depth, n), np.nan),
        surfaces=np.full((depth, n), -1, dtype=np.int64),
        corners=np.full((depth, n), -1, dtype=np.int64),
        states=np.full((depth, n, 13), np.nan),
        ends=ends,
        now=now,
        last=state,
        solid=solid,
        rows=_rows_of(samples),
    )
    flights = Flights(many, spread, law, together)
    going = np.arange(n)
    for k in range(depth + (MAX_FURTHER if further else 0)):
        if len(going) < (FEWEST_AT_ONCE if k >= depth else 1):
            break
        parts, rebounds = np.empty(len(going), dtype=np.int64), np.empty(len(going))
        drawn = np.zeros((n, 0)) if spread.is_none else spread.draw()
        views: list[Any] = [
            each.data for each in (going, samples.gravities_W, drawn, state, now, parts, rebounds)
        ]
        flights.fly(horizon, *views)
        arrived = parts >= 0
        over, going, parts = going[~arrived], going[arrived], parts[arrived]
        slow = rebounds[arrived] ** 2 <= 2.0 * solid.settling * math.sqrt(dot(solid.gravity, solid.gravity))
        if k < depth:
            ends[over] = SampleEnd.FLIES
            ends[going[slow]] = SampleEnd.STAYS
            many.seconds[k, going], many.states[k, going] = now[going], state[going]
            many.surfaces[k, going], many.corners[k, going] = np.divmod(parts, solid.count)
        going = going[~slow]
    return many


class Flights:
    """Computes flights of samples to their next strikes."""

    def __init__(
        self, many: ManyStrikes, spread: LawSpread, law: RestitutionLaw, together: SeveralContactsLaw
    ) -> None:
        self.solid, self.rows = many.solid_of(0), many.rows.data
        self.law, self.together = law, together
        self.kicks = [] if spread.is_none else spread.kicks
        self.descent, self.impact = Descent(self.solid), Strike(law)

    def fly(  # noqa: PLR0917
        self,
        horizon: float,
        which: Any,
        gravities: Any,
        drawn: Any,
        states: Any,
        now: Any,
        parts: Any,
        rebounds: Any,
    ) -> None:
        """Compute one flight and its strike for some samples. The last four arguments are written.

        Args:
            horizon: Latest end of a flight, s.
            which: (m,), indices of the samples.
            gravities: (n, 3), m/s^2, gravity of all samples.
            drawn: (n, 10), random numbers from `LawSpread.draw`.
            states: (n, 13), states, which become those after the strikes.
            now: (n,), s, times of the states.
            parts: (m,), index of the plane times the number of corners, plus the index of the striking
                corner; or -1.
            rebounds: (m,), m/s, normal velocities of these corners after the strikes.
        """
        solid, descent = self.solid, self.descent
        for j in range(len(which)):
            i = which[j]
            solid.take(self.rows, i)
            gravity = (gravities[i, 0], gravities[i, 1], gravities[i, 2])
            descent.set_out(solid, gravity, [states[i, k] for k in range(13)])
            seconds = descent.run(0.0, horizon - now[i])
            descent.look(seconds)
            now[i] += seconds
            y = descent.state()
            part = descent.striking(SAMPLED_ARRIVAL)
            parts[j], rebounds[j] = part, 0.0
            if part >= 0:
                touch = (part // solid.count, part % solid.count)
                touching = [each for _, each in low_corners(solid, y, SAMPLED_ARRIVAL, 0.0)]
                if len(touching) > 1:
                    strikes = strike(
                        solid,
                        y,
                        touching,
                        self.impact,
                        self.law,
                        approaches(solid, y, touching),
                        Unsettled(),
                        self.together,
                        None,
                    )
                    after, staying = strikes.y, bool(strikes.staying)
                    if self.kicks and not strikes.settled:
                        numbers = [drawn[i, k] for k in range(10)]
                        after = self.kicks[i].changed(solid, y, after, touching, numbers)
                        staying = False
                    y = after
                    rebounds[j] = 0.0 if staying else min(approaches(solid, y, touching))
                else:
                    after, _ = routh(self.impact, solid, y, touch, True)  # noqa: FBT003
                    if self.kicks:
                        numbers = [drawn[i, k] for k in range(10)]
                        kick = self.kicks[i]
                        after = kick.changed(solid, y, after, [touch], numbers)
                    y = after
                    rebounds[j] = approaches(solid, y, [touch])[0]
            for k in range(13):
                states[i, k] = y[k]


def _rows_of(samples: Samples) -> FloatArray:
    """Return the parameters of samples in the layout of `Solid.take`."""
    materials = [samples.lasting_frictions, samples.restitutions, samples.frictions]
    parts = [samples.inertias_B, np.linalg.inv(samples.inertias_B), samples.corners_B, np.stack(materials, 2)]
    return np.hstack([part.reshape(len(part), -1) for part in parts])
